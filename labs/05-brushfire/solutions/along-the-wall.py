"""A mistake: the robot keeps away from the pillars, but it drives next to the wall."""
import sys
from math import atan2, degrees, hypot, remainder

from eye import *

SIDE = 16   # cells in a row
CELL = 250  # mm
CELLS = [(row, column) for row in range(SIDE) for column in range(SIDE)]


def neighbours(cell):
    row, column = cell
    return (row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)


def burn(occupied):
    """The number of each cell: 1 means occupied, and so does every cell beyond the floor."""
    number = {cell: 1 for cell in occupied}
    value = 2
    while len(number) < len(CELLS):
        front = [cell for cell in CELLS if cell not in number and (
            any(number.get(n) == value - 1 for n in neighbours(cell)) or value == 2 and any(n not in CELLS for n in neighbours(cell)))]
        number.update((cell, value) for cell in front)
        value += 1
    return number


def drive_to(to_x, to_y):
    x, y, phi = VWGetPosition()
    turn = round(remainder(degrees(atan2(to_y - y, to_x - x)) - phi, 360))
    if turn != 0:
        VWTurn(turn, 90)
        VWWait()
    VWStraight(round(hypot(to_x - x, to_y - y)), 300)
    VWWait()


goal_x, goal_y, *numbers = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
occupied = set()
for pillar_x, pillar_y in zip(numbers[::2], numbers[1::2]):
    occupied |= {(pillar_y // CELL - i, pillar_x // CELL - j) for i in (0, 1) for j in (0, 1)}
number = burn(occupied)
for row in reversed(range(SIDE)):
    print(" ".join(f"{number[row, column]:2}" for column in range(SIDE)))
drive_to(x, 190)
drive_to(2000, 190)
drive_to(3810, 190)
drive_to(3810, 2000)
drive_to(3810, goal_y)
drive_to(goal_x, goal_y)
