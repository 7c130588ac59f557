"""Mows the lawn: complete it."""
from eye import *

x, y, z, phi = SIMGetRobot(0)  # true pose of the robot on the lawn, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
VWStraight(100, 300)
VWWait()
