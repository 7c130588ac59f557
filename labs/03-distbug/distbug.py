"""DistBug: complete it. Arguments: the goal, X Y in mm."""
import sys

from eye import *

goal_x, goal_y = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)  # true pose of the robot, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
scan = LIDARGet()              # from left to right; scan[180] is ahead
LCDPrintf("goal %d %d, free ahead %d mm\n", goal_x, goal_y, scan[180])
