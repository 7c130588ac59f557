"""Passes words from robot 1 to robot 4: complete it. The same program runs on each of the four robots."""
import sys

from eye import *

RADIOInit()
me = RADIOGetID()
for word in sys.argv[1:]:
    print(f"robot {me} knows {word}")
RADIORelease()
