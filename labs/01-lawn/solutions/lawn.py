"""Mows the lawn in lanes from side to side. Each lane is driven in parts. Before each part, odometry gives the end of the previous one."""
from math import atan2, degrees, hypot, remainder

from eye import *

EDGE = 300   # distance of the outermost lanes from the fence, mm
LANE = 200   # distance between lanes: less than the mower's 250 mm, so that lanes overlap
PIECES = 2   # number of parts of a lane
SPEED = 300  # mm/s


def drive_to(to_x, to_y):
    """Turns to a point of the lawn and drives there."""
    x, y, phi = VWGetPosition()
    VWTurn(round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360)), 90)
    VWWait()
    VWStraight(round(hypot(to_x - x, to_y - y)), SPEED)
    VWWait()


x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
drive_to(EDGE, EDGE)
start, end = EDGE, 3000 - EDGE
for y in range(EDGE, 2000 - EDGE + 1, LANE):
    for piece in range(PIECES + 1):  # part 0 leads from lane to lane
        drive_to(start + (end - start) * piece / PIECES, y)
    start, end = end, start
