"""Drives to each of four walls and turns left before it."""

from eye import *

NEAR_MM = 300

LCDSetColor(GREEN, BLACK)
LCDPrintf("@NAME@\n")

for wall in range(1, 5):
    VWSetSpeed(300, 0)  # mm/s, degrees/s
    while PSDGet(PSD_FRONT) > NEAR_MM:
        OSWait(50)
    VWSetSpeed(0, 0)
    LCDPrintf("wall %d: %d mm\n" % (wall, PSDGet(PSD_FRONT)))

    VWTurn(90, 60)
    VWWait()

x, y, phi = VWGetPosition()
LCDPrintf("x %d y %d mm\n" % (x, y))
