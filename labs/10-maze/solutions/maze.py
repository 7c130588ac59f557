"""Explores the maze by flood fill and races to the goal on a shortest path.

Each cell holds its number of steps to the goal, assuming no walls other than those seen so far. The robot goes to a neighbour that is
one step nearer. It goes to the goal and back until no shorter path through unknown sides can exist; then it races.

Directions are quarter turns to the left from the x axis: 0 right, 1 up, 2 left, 3 down.
"""
from math import atan2, degrees, hypot, remainder

from eye import *

SIZE = 6    # cells in a row
CELL = 360  # mm
NEAR = 250  # distance below which a wall belongs to the robot's own cell, mm
START, GOAL = (0, 0), (SIZE - 1, SIZE - 1)
STEPS = (1, 0), (0, 1), (-1, 0), (0, -1)

open_sides = {}  # (cell, direction): True if the side is open, False if it is a wall; unknown sides are missing
cell, direction = START, 1


def neighbour(cell, d):
    return cell[0] + STEPS[d][0], cell[1] + STEPS[d][1]


def look():
    """Records three sides of the robot's cell, which are also the opposite sides of its neighbours."""
    for turn, sensor in (0, PSD_FRONT), (1, PSD_LEFT), (3, PSD_RIGHT):
        d = (direction + turn) % 4
        open_sides[cell, d] = open_sides[neighbour(cell, d), (d + 2) % 4] = PSDGet(sensor) >= NEAR


def is_free(cell, d, hopeful):
    return open_sides.get((cell, d), hopeful) and all(0 <= number < SIZE for number in neighbour(cell, d))


def flood(goal, hopeful):
    """Steps from each cell to the goal; unknown sides are open if `hopeful`, else walls."""
    steps, queue = {goal: 0}, [goal]
    for at in queue:
        for d in range(4):
            if is_free(at, d, hopeful) and neighbour(at, d) not in steps:
                steps[neighbour(at, d)] = steps[at] + 1
                queue.append(neighbour(at, d))
    return steps


def downhill(steps, hopeful):
    """Direction of a neighbour that is nearer to the goal, straight on if possible; None at the goal."""
    for turn in range(4):
        d = (direction + turn) % 4
        if is_free(cell, d, hopeful) and steps.get(neighbour(cell, d), 9999) < steps[cell]:
            return d
    return None


def go(d, speed):
    """Drives to the neighbour in a direction. The target is the middle of its cell by odometry, so errors do not add up."""
    global cell, direction
    cell, direction = neighbour(cell, d), d
    to_x, to_y = (number * CELL + CELL // 2 for number in cell)
    x, y, phi = VWGetPosition()
    turn = round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360))
    if turn != 0:
        VWTurn(turn, 90)
        VWWait()
    VWStraight(round(hypot(to_x - x, to_y - y)), speed)
    VWWait()


def explore(goal):
    while True:
        look()
        d = downhill(flood(goal, True), True)
        if d is None:
            return
        go(d, 300)


VWSetPosition(CELL // 2, CELL // 2, 90)
while True:
    explore(GOAL)
    explore(START)
    steps = flood(GOAL, False)
    if flood(GOAL, True)[START] == steps[START]:
        break
LCDPrintf("race: %d steps\n", steps[START])
while cell != GOAL:
    go(downhill(steps, False), 400)
