"""DistBug (Kamon and Rivlin, 1997): drives towards a goal; at an obstacle, follows its boundary until the free path towards the goal brings
the robot nearer to the goal than ever before. Arguments: the goal, X Y in mm.
"""
import sys
from math import atan2, cos, degrees, hypot, inf, radians, remainder, sin

from eye import *

NEAR = 260        # distance of an obstacle ahead at which the robot starts to follow its boundary, mm
KEEP = 220        # distance that the robot keeps from the boundary, mm
STEP = 100        # gain on the best distance to the goal so far for which the robot leaves the boundary, mm
HALF_WIDTH = 120  # half of the width that the robot needs, mm
SPEED = 200       # mm/s
BEAM = [(at, cos(radians(at)), abs(sin(radians(at)))) for at in range(-85, 86)]


def distance_at(direction):
    """Scanned distance in a direction, in degrees to the left."""
    return scan[(180 - direction) % 360]


def free_way(direction):
    """Distance that the robot can drive in a direction, mm."""
    way = 9999
    for at, along, across in BEAM:
        distance = distance_at(direction + at)
        if distance * across < HALF_WIDTH and distance * along < way:
            way = distance * along
    return way


def limited(value, limit):
    return round(max(-limit, min(limit, value)))


def follow():
    """Drives with the boundary at the left: its nearest point is kept at 90 degrees, at the distance KEEP."""
    direction = min(range(-45, 171), key=distance_at)
    off = direction - 90
    speed = max(0, limited(SPEED * (1 - abs(off) / 45), SPEED))
    VWSetSpeed(speed, limited(2.5 * off + 0.4 * (distance_at(direction) - KEEP), 90))


goal_x, goal_y = map(int, sys.argv[1:])
x, y, z, phi = SIMGetRobot(0)
VWSetPosition(x, y, phi)
LIDARSet(360, 0, 360)
is_following, nearest_yet = False, inf
while True:
    scan = list(LIDARGet())
    x, y, phi = VWGetPosition()
    to_goal = hypot(goal_x - x, goal_y - y)
    if to_goal < 20:
        break
    nearest_yet = min(nearest_yet, to_goal)
    turn = round(remainder(degrees(atan2(goal_y - y, goal_x - x)) - phi, 360))
    if is_following:
        way = free_way(turn)  # towards the goal
        is_nearer = to_goal - (way - NEAR) <= nearest_yet - STEP or way >= to_goal
        if way > NEAR and is_nearer and hypot(x - hit[0], y - hit[1]) > 100:
            is_following = False
    elif abs(turn) <= 20 and free_way(0) < min(NEAR, to_goal):
        is_following, hit = True, (x, y)
    if is_following:
        follow()
    elif abs(turn) > 20:
        VWSetSpeed(0, limited(3 * turn, 90))
    else:
        VWSetSpeed(round(to_goal / 2 + 20) if to_goal < 200 else SPEED, limited(2 * turn, 60))
    OSWait(20)
VWSetSpeed(0, 0)
