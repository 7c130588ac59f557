"""Mows the lawn: complete it."""
from eye import *

x, y, z, phi = SIMGetRobot(0)  # the robot's place on the lawn: once, at the start
VWSetPosition(x, y, phi)       # from here on odometry tells it
VWStraight(100, 300)
VWWait()
