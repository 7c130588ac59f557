"""Drives along a spline through waypoints: complete it. Arguments: the waypoints, X Y each, in mm."""
import sys

from eye import *

numbers = list(map(int, sys.argv[1:]))
x, y, z, phi = SIMGetRobot(0)  # true pose of the robot, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
for to_x, to_y in zip(numbers[::2], numbers[1::2]):
    LCDPrintf("waypoint %d %d\n", to_x, to_y)
