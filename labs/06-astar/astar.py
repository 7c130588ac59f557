"""Finds a shortest path by A* and drives along it: complete it. Arguments: eight places, then the pillars, X Y each, in mm."""
import sys

from eye import *

PLACES = 8

numbers = list(map(int, sys.argv[1:]))
points = list(zip(numbers[::2], numbers[1::2]))
places, pillars = points[:PLACES], points[PLACES:]
x, y, z, phi = SIMGetRobot(0)  # true pose of the robot, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
LCDPrintf("places %s\n", str(places))
LCDPrintf("pillars %s\n", str(pillars))
