"""Maps a room with the laser scanner: drives around along the walls, where there are no boxes, and scans every half metre.

A ray means that the cells along it are free and that the cell behind its end is occupied. Each cell counts both, and the greater number
decides, so single errors from readings and from the rounding of headings have no effect.
"""
from math import atan2, cos, degrees, hypot, radians, remainder, sin

from eye import *

COLUMNS, ROWS, CELL = 16, 12, 250  # cells in mm
STEP = 50    # distance between points on a ray, mm
MARGIN = 40  # distance before the end of a ray up to which the ray counts as free, mm
BEHIND = 25  # distance beyond the end of a ray of a point inside the obstacle, mm
CORNERS = (500, 500), (3500, 500), (3500, 2500), (500, 2500), (500, 500)

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


def drive_to(to_x, to_y):
    x, y, phi = VWGetPosition()
    VWTurn(round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360)), 90)
    VWWait()
    VWStraight(round(hypot(to_x - x, to_y - y)), 300)
    VWWait()


def symbol(free, occupied):
    return "?" if free + occupied == 0 else "#" if occupied > free else "."


x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
drive_to(*CORNERS[0])
for (from_x, from_y), (to_x, to_y) in zip(CORNERS, CORNERS[1:]):
    steps = int(hypot(to_x - from_x, to_y - from_y)) // 500
    for step in range(1, steps + 1):
        scan()
        drive_to(from_x + (to_x - from_x) * step / steps, from_y + (to_y - from_y) * step / steps)
for row in reversed(range(ROWS)):
    print("".join(map(symbol, free_count[row], occupied_count[row])))
