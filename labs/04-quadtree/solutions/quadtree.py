"""Plans with a quadtree: splits the floor into free squares, finds the shortest path from square to square with A*, and drives along their
centres. Arguments: the goal, then the pillars, X Y each, in mm.
"""
import heapq
import sys
from math import atan2, degrees, hypot, remainder

from eye import *

SIDE = 16    # cells in a row
CELL = 250   # mm
PIECE = 500  # maximum drive between two readings of odometry, mm


def split(row, column, size):
    """The free squares of a square: the square itself if it is free, none if it is occupied, otherwise those of its quarters."""
    cells = {(i, j) for i in range(row, row + size) for j in range(column, column + size)}
    if not cells & occupied:
        return [(row, column, size)]
    if cells <= occupied:
        return []
    half = size // 2
    quarters = [(row, column), (row, column + half), (row + half, column), (row + half, column + half)]
    return [square for i, j in quarters for square in split(i, j, half)]


def centre(square):
    row, column, size = square
    return (column + size / 2) * CELL, (row + size / 2) * CELL


def distance(a, b):
    (x, y), (to_x, to_y) = centre(a), centre(b)
    return hypot(to_x - x, to_y - y)


def are_neighbours(a, b):
    """True if two squares share a part of a side."""
    (row, column, size), (other_row, other_column, other_size) = a, b
    rows = min(row + size, other_row + other_size) - max(row, other_row)  # length that the sides share
    columns = min(column + size, other_column + other_size) - max(column, other_column)
    return (rows > 0 and columns == 0) or (rows == 0 and columns > 0)


def square_at(x, y):
    row, column = y // CELL, x // CELL
    return next((r, c, s) for r, c, s in squares if r <= row < r + s and c <= column < c + s)


def find_way(start, goal):
    """A*: the squares from `start` to `goal`."""
    queue, before, cost = [(distance(start, goal), start)], {start: None}, {start: 0}
    while queue:
        _, square = heapq.heappop(queue)
        if square == goal:
            break
        for other in squares:
            new = cost[square] + distance(square, other)
            if are_neighbours(square, other) and new < cost.get(other, float("inf")):
                cost[other], before[other] = new, square
                heapq.heappush(queue, (new + distance(other, goal), other))
    way = [goal]
    while before[way[-1]]:
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


goal_x, goal_y, *numbers = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
occupied = set()
for pillar_x, pillar_y in zip(numbers[::2], numbers[1::2]):
    occupied |= {(pillar_y // CELL - i, pillar_x // CELL - j) for i in (0, 1) for j in (0, 1)}
squares = split(0, 0, SIDE)
for square in squares:
    print("free %d %d %d" % square)
for square in find_way(square_at(x, y), square_at(goal_x, goal_y))[1:-1]:
    drive_to(*centre(square))
drive_to(goal_x, goal_y)
