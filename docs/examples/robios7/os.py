# A timer counts while the program waits.
from eye import *

ticks = 0


def count():
    global ticks
    ticks += 1


timer = OSAttachTimer(100, count)  # every 100 ms
OSWait(1050)
OSDetachTimer(timer)
print(f"robot {OSMachineID()}: {ticks} ticks in {OSGetCount()} ms")

# Prints
# robot 5: 10 ticks in 1050 ms
