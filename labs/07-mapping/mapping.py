"""Maps a room: complete it."""
from eye import *

COLUMNS, ROWS = 16, 12

x, y, z, phi = SIMGetRobot(0)  # true pose of the robot in the room, read once, at the start
VWSetPosition(x, y, phi)       # from here on odometry gives the pose
distances = LIDARGet()         # from left to right; distances[180] is ahead
for row in range(ROWS):
    print("?" * COLUMNS)
