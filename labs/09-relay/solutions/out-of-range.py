"""A mistake: robot 1 sends directly to robot 4, which is out of range, and the program does not detect that nothing arrives."""
import sys

from eye import *

RADIOInit()
OSWait(100)
if RADIOGetID() == 1:
    for word in sys.argv[1:]:
        RADIOSend(4, word)
        OSWait(100)
else:
    for wait in range(200):
        OSWait(10)
        if RADIOCheck():
            sender, word = RADIOReceive()
            print(word)
RADIORelease()
