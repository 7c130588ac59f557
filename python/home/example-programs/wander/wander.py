"""Wanders about for 40 s and keeps away from walls and other robots. RoBIOS-7 in Python."""

from eye import *

SPEED = 250  # mm/s
RATE = 90  # degrees/s
NEAR, CLEAR = 300, 450  # mm

LCDPrintf("wandering\n")
turning = 0
while OSGetCount() < 40000:
    ahead, left, right = PSDGet(PSD_FRONT), PSDGet(PSD_LEFT), PSDGet(PSD_RIGHT)
    if turning and ahead > CLEAR:
        turning = 0
    elif not turning and ahead < NEAR:
        turning = RATE if left > right else -RATE  # and on to the same side until the way is clear
    if turning:
        VWSetSpeed(0, turning)
    else:
        # Turn away from the nearer side.
        VWSetSpeed(SPEED, 30 if right < 200 else -30 if left < 200 else 0)
    OSWait(50)
VWSetSpeed(0, 0)
LCDPrintf("done\n")
