# Moves this robot to another place and reads its true pose.
from eye import *

x, y, z, phi = SIMGetRobot(0)
SIMSetRobot(0, x + 200, y, z, 90)
OSWait(100)
x, y, z, phi = SIMGetRobot(0)
print(f"{SIMGetRobotCount()} robots, {SIMGetObjectCount()} object; x {x} mm, heading {phi} degrees")

# Prints
# 23 robots, 1 object; x 6800 mm, heading 90 degrees
