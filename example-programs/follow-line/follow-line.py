"""Follows a dark line on a light floor, once around. RoBIOS-7 in Python.

The camera looks down. In each of a few rows of the image the line is the run of dark pixels nearest to the column of the line in
the row before; the height and the tilt of the camera give the place on the floor of each pixel. The robot drives an arc through the
farthest of these places (pure pursuit).
"""

import sys
from math import cos, degrees, radians, sin, tan

from eye import *

WIDTH, HEIGHT = 160, 120  # QQVGA
FOCAL = WIDTH / 2 / tan(radians(30))  # in pixels: the field of view is 60 degrees wide
TILT = radians(-35)
CAMERA_X, CAMERA_Z = 62, 60  # position of the S4's camera, mm
ROWS = (70, 62, 54, 46, 38)  # rows of the image, from near to far
CONTRAST = 50  # minimum contrast between line and floor
SPEED = 200  # mm/s
ROUND = 360 + 90  # degrees: a lap turns the robot by 360; 90 more, since it may have started before a bend


def place(column, row):
    """The place on the floor that a pixel shows: mm ahead of the robot's middle and to its left."""
    left, up = (WIDTH / 2 - column - 0.5) / FOCAL, (HEIGHT / 2 - row - 0.5) / FOCAL
    ahead, down = cos(TILT) - up * sin(TILT), -sin(TILT) - up * cos(TILT)
    return CAMERA_X + ahead * CAMERA_Z / down, left * CAMERA_Z / down


def brightness(image, row):
    """A row of a grey image, as the median of three rows, which removes single wrong pixels."""
    above, here, below = (image[r * WIDTH : (r + 1) * WIDTH] for r in (row - 1, row, row + 1))
    return [sorted(levels)[1] for levels in zip(above, here, below)]


def dark_runs(levels):
    """First and last column of each run of dark pixels."""
    middle = (min(levels) + max(levels)) / 2
    if max(levels) - min(levels) < CONTRAST:
        return []
    runs, start = [], None
    for column, level in enumerate(levels + [255]):
        if level < middle and start is None:
            start = column
        elif level >= middle and start is not None:
            runs.append((start, column - 1))
            start = None
    return runs


def line(image, column):
    """Pixels of the line from near to far; `column` is its expected column in the nearest row."""
    found = []
    for row in ROWS:
        runs = dark_runs(brightness(image, row))
        if not runs:
            break
        column = min(((first + last) / 2 for first, last in runs), key=lambda middle: abs(middle - column))
        found.append((column, row))
    return found


def show(image, found):
    """Shows the image, with a cross on each place of the line."""
    LCDImageGray(image)
    for column, row in found:
        LCDLine(int(column) - 4, row, int(column) + 4, row, RED)
        LCDLine(int(column), row - 4, int(column), row + 4, RED)


def main():
    if CAMInit(QQVGA) != 0:
        return 1
    SERVOSet(2, round(255 * (degrees(TILT) + 90) / 180))
    OSWait(500)
    column, turned, last, lost = WIDTH / 2, 0, VWGetPosition()[2], 0
    while abs(turned) < ROUND:
        image = CAMGetGray()
        found = line(image, column)
        show(image, found)
        if found:
            column, lost = found[0][0], 0
            ahead, left = place(*found[-1])
            VWSetSpeed(SPEED, degrees(2 * left / (ahead**2 + left**2) * SPEED))
        else:
            lost += 1
            if lost == 50:
                LCDSetPrintf(11, 0, "the line is lost")
                return 2
        phi = VWGetPosition()[2]
        turned += (phi - last + 180) % 360 - 180
        last = phi
        LCDSetPrintf(10, 0, "turned %4d degrees" % turned)
    VWSetSpeed(0, 0)
    CAMRelease()
    LCDSetPrintf(11, 0, "once around")
    return 0


sys.exit(main())
