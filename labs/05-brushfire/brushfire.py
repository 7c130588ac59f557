"""Plans by brushfire and drives to the goal: complete it. Arguments: the goal, then the pillars, X Y each, in mm."""
import sys

from eye import *

goal_x, goal_y, *numbers = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)  # true pose of the robot, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
LCDPrintf("goal %d %d\n", goal_x, goal_y)
for pillar_x, pillar_y in zip(numbers[::2], numbers[1::2]):
    LCDPrintf("pillar %d %d\n", pillar_x, pillar_y)
