"""Drives along a spline through waypoints: the robot drives arcs to the point of the spline at the look-ahead distance (pure pursuit).
Arguments: the waypoints, X Y each, in mm.
"""
import sys
from math import atan2, degrees, dist, pi, radians, remainder, sin

from eye import *

PARTS = 50   # number of points of the spline between two waypoints
AHEAD = 100  # look-ahead distance, mm
SPEED = 200  # mm/s


def spline(before, a, b, behind, t):
    """A point of the spline of Catmull and Rom between a and b, at t from 0 to 1."""
    h = 2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2
    return [h[0] * a[k] + h[1] * (b[k] - before[k]) / 2 + h[2] * b[k] + h[3] * (behind[k] - a[k]) / 2 for k in (0, 1)]


numbers = list(map(int, sys.argv[1:]))
x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
points = [(x, y), *zip(numbers[::2], numbers[1::2])]
padded = points[:1] + points + points[-1:]
line = [spline(*padded[i:i + 4], part / PARTS) for i in range(len(points) - 1) for part in range(PARTS)] + [points[-1]]

target = 0
while True:
    x, y, phi = VWGetPosition()
    while target + 1 < len(line) and dist(line[target], (x, y)) < AHEAD:
        target += 1
    to_end, distance = dist(line[-1], (x, y)), dist(line[target], (x, y))
    angle = remainder(atan2(line[target][1] - y, line[target][0] - x) - radians(phi), 2 * pi)
    if target + 1 == len(line) and (to_end < 10 or abs(angle) > pi / 2):
        break  # at the last waypoint or past it
    if abs(angle) > pi / 6:  # at the start the spline may lead elsewhere
        VWTurn(round(degrees(angle)), 90)
        VWWait()
        continue
    curvature = 2 * sin(angle) / distance  # of the arc, 1/mm
    speed = SPEED if to_end > SPEED else 20 + to_end / 2
    VWSetSpeed(round(speed), round(degrees(speed * curvature)))
    OSWait(20)
VWSetSpeed(0, 0)
