"""Drives to 300 mm before the wall, turns left, and leaves in an arc. RoBIOS-7 in Python."""

from eye import *

distance = PSDGet(PSD_FRONT)
LCDPrintf("wall: %d mm\n" % distance)

VWStraight(distance - 300, 200)
VWWait()
VWTurn(90, 60)
VWWait()
VWCurve(400, -90, 200)
VWWait()

x, y, phi = VWGetPosition()
LCDPrintf("x %d y %d" % (x, y))
