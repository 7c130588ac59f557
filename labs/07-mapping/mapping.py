"""Maps a room: complete it."""
from eye import *

COLUMNS, ROWS = 16, 12

x, y, z, phi = SIMGetRobot(0)  # the robot's place in the room: once, at the start
VWSetPosition(x, y, phi)       # from here on odometry tells it
distances = LIDARGet()         # from left to right; distances[180] is ahead
for row in range(ROWS):
    print("?" * COLUMNS)
