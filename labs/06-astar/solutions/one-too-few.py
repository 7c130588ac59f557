"""A mistake: the loop ends one place too early."""
import heapq
import sys
from math import atan2, degrees, dist, hypot, inf, remainder

from eye import *

PLACES = 8
GOAL = PLACES - 1
HALF = 250   # half the side of the square around a pillar, mm
PIECE = 500  # maximum drive between two readings of odometry, mm


def is_free(a, b):
    """True if the straight line passes through no square around a pillar."""
    for pillar in pillars:
        first, last = 0, 1  # ends of the part of the line within the square, 0 to 1
        for axis in 0, 1:
            way, offset = b[axis] - a[axis], pillar[axis] - a[axis]
            if way != 0:
                ends = (offset - HALF) / way, (offset + HALF) / way
                first, last = max(first, min(ends)), min(last, max(ends))
            elif abs(offset) >= HALF:
                last = -1
        if first < last:
            return False
    return True


def find_way():
    """A*: the places on a shortest path. The cost of a place is the path to it plus the straight distance from it to the goal."""
    queue, before, cost = [(dist(places[0], places[GOAL]), 0)], {0: None}, {0: 0}
    while queue:
        _, place = heapq.heappop(queue)
        if place == GOAL:
            break
        for other in range(PLACES):
            new = cost[place] + matrix[place][other]
            if matrix[place][other] >= 0 and new < cost.get(other, inf):
                cost[other], before[other] = new, place
                heapq.heappush(queue, (new + dist(places[other], places[GOAL]), other))
    way = [GOAL]
    while before[way[-1]] is not None:
        way.append(before[way[-1]])
    return way[::-1]


def drive_to(to_x, to_y):
    """Drives to a point in parts. Before each part, odometry gives the end of the previous one."""
    while True:
        x, y, phi = VWGetPosition()
        way = round(hypot(to_x - x, to_y - y))
        if way < 20:
            return
        turn = round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360))
        if turn != 0:
            VWTurn(turn, 90)
            VWWait()
        VWStraight(min(way, PIECE), 300)
        VWWait()


numbers = list(map(int, sys.argv[1:]))
points = list(zip(numbers[::2], numbers[1::2]))
places, pillars = points[:PLACES], points[PLACES:]
x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
matrix = [[dist(a, b) if a == b or is_free(a, b) else -1 for b in places] for a in places]
for row in matrix:
    print(" ".join(f"{distance:5.0f}" for distance in row))
way = find_way()
print("way", *way)
for place in way[1:-1]:
    drive_to(*places[place])
