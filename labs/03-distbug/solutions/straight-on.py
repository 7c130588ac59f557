"""A mistake: the robot drives without reading its sensors."""
import sys
from math import atan2, degrees, hypot, remainder

from eye import *

goal_x, goal_y = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)
VWTurn(round(remainder(degrees(atan2(goal_y - y, goal_x - x)) - phi, 360)), 90)
VWWait()
VWStraight(round(hypot(goal_x - x, goal_y - y)), 200)
VWWait()
