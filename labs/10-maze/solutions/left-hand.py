"""A mistake: the robot keeps the left hand on the wall. It finds the goal, but it has no map, so it cannot race."""
from math import atan2, degrees, hypot, remainder

from eye import *

CELL, NEAR, GOAL = 360, 250, (5, 5)
STEPS = (1, 0), (0, 1), (-1, 0), (0, -1)
cell, direction = (0, 0), 1

VWSetPosition(CELL // 2, CELL // 2, 90)
while cell != GOAL:
    if PSDGet(PSD_LEFT) >= NEAR:
        direction = (direction + 1) % 4
    elif PSDGet(PSD_FRONT) < NEAR:
        direction = (direction + (3 if PSDGet(PSD_RIGHT) >= NEAR else 2)) % 4
    cell = cell[0] + STEPS[direction][0], cell[1] + STEPS[direction][1]
    to_x, to_y = (number * CELL + CELL // 2 for number in cell)
    x, y, phi = VWGetPosition()
    VWTurn(round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360)), 90)
    VWWait()
    VWStraight(round(hypot(to_x - x, to_y - y)), 300)
    VWWait()
