# Plays a tone to its end.
from eye import *

AUTone(440, 300)  # Hz, ms
while not AUCheckTone():
    OSWait(10)
print(f"silence after {OSGetCount()} ms")

# Prints
# silence after 300 ms
