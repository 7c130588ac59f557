"""Drives a lap in the right lane of a road: follows the line at the road's edge, half a lane beside it.

In one row of the camera's image the line is a short run of bright pixels. Height and tilt of the camera give the point on the floor that
a pixel shows. The robot drives an arc to the middle of the lane in that row (pure pursuit).
"""
from math import cos, degrees, pi, radians, sin, tan

from eye import *

LANE = 370     # width of the lane, mm
TILT = -10     # tilt of the camera, degrees
CAMERA_X = 62  # position of the S4's camera, mm
CAMERA_Z = 60
WIDTH, HEIGHT = 160, 120  # size of the image, pixels
ROW = 52       # row of the image that shows the floor about 0.55 m ahead
CONTRAST = 40  # minimum difference of brightness between road and line
WIDEST = 60    # maximum width of the line, mm
SPEED = 300    # mm/s
ROUND = 450    # degrees: a lap turns the robot by 360; 90 more, since it may have started before a bend

# Distance of the row on the floor, and width that a pixel shows there, mm. The camera has a field of view of 60 degrees.
focal = WIDTH / 2 / tan(pi / 6)
up = (HEIGHT / 2 - 0.5 - ROW) / focal
down = -sin(radians(TILT)) - up * cos(radians(TILT))
ahead = CAMERA_X + (cos(radians(TILT)) - up * sin(radians(TILT))) * CAMERA_Z / down
per_column = CAMERA_Z / down / focal


def find_line(image, last):
    """Position of the line nearest to its last position, in mm to the left; None if there is none."""
    rows = [image[row * WIDTH:(row + 1) * WIDTH] for row in (ROW - 1, ROW, ROW + 1)]
    levels = [sum(pixels) // 3 for pixels in zip(*rows)]  # so single wrong pixels have less effect
    darkest, brightest = min(levels), max(levels)
    if brightest - darkest < CONTRAST:
        return None
    lines, start = [], None
    for x in range(WIDTH + 1):
        is_bright = x < WIDTH and levels[x] > (darkest + brightest) / 2
        if is_bright and start is None:
            start = x
        if not is_bright and start is not None:
            if (x - start) * per_column <= WIDEST:
                lines.append((WIDTH / 2 - 0.5 - (start + x - 1) / 2) * per_column)
            start = None
    near = [line for line in lines if abs(line - last) < 0.4 * LANE]
    return min(near, key=lambda line: abs(line - last), default=None)


CAMInit(QQVGA)
SERVOSet(2, 255 * (TILT + 90) // 180)
OSWait(500)
line, turned, lost = -LANE / 2, 0, 0
last = VWGetPosition()[2]
while turned < ROUND and lost < 50:
    found = find_line(CAMGetGray(), line)
    if found is None:
        lost += 1
    else:
        line, lost = found, 0
        left = line + LANE / 2
        curvature = 2 * left / (ahead ** 2 + left ** 2)
        VWSetSpeed(SPEED, round(SPEED * degrees(curvature)))
    phi = VWGetPosition()[2]
    turned += (phi - last + 540) % 360 - 180
    last = phi
VWSetSpeed(0, 0)
