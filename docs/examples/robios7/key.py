# Waits for a key, then for a touch of the display.
from eye import *

LCDMenu("", "GO", "", "")
KEYWait(KEY2)
print(f"go, after {OSGetCount()} ms")
x, y = KEYGetXY()
print(f"touched at {x}, {y}")

# Prints
# go, after 1000 ms
# touched at 120, 40
