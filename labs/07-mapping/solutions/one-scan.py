"""A mistake: one scan from the start does not see what is behind the boxes."""
from math import cos, radians, sin

from eye import *

COLUMNS, ROWS, CELL = 16, 12, 250  # cells in mm
STEP = 50    # distance between points on a ray, mm
MARGIN = 40  # distance before the end of a ray up to which the ray counts as free, mm
BEHIND = 25  # distance beyond the end of a ray of a point inside the obstacle, mm

free_count = [[0] * COLUMNS for _ in range(ROWS)]
occupied_count = [[0] * COLUMNS for _ in range(ROWS)]


def count(counts, x, y):
    if 0 <= x < COLUMNS * CELL and 0 <= y < ROWS * CELL:
        counts[int(y // CELL)][int(x // CELL)] += 1


def scan():
    x, y, phi = VWGetPosition()
    distances = LIDARGet()
    for i, distance in enumerate(distances):
        if distance == 9999:
            continue
        angle = radians(phi + 180 - i)  # from left to right, number 180 ahead
        dx, dy = cos(angle), sin(angle)
        for at in range(0, distance - MARGIN, STEP):
            count(free_count, x + at * dx, y + at * dy)
        count(occupied_count, x + (distance + BEHIND) * dx, y + (distance + BEHIND) * dy)


def symbol(free, occupied):
    return "?" if free + occupied == 0 else "#" if occupied > free else "."


x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
scan()
for row in reversed(range(ROWS)):
    print("".join(map(symbol, free_count[row], occupied_count[row])))
