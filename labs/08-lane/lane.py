"""Drives in the right lane of a road: complete it."""
from eye import *

CAMInit(QQVGA)
SERVOSet(2, 113)  # tilts the camera down by 10 degrees
OSWait(500)
LCDImageGray(CAMGetGray())
VWSetSpeed(100, 0)
OSWait(2000)
VWSetSpeed(0, 0)
