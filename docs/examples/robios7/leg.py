# Walks for two seconds and reads a joint.
from eye import *

LEGSetSpeed(100, 0, 0)  # mm/s forward
OSWait(2000)
LEGSetSpeed(0, 0, 0)
knee, height = LEGGetJoint(1, 4), LEGGetHeight()
print(f"{LEGCount()} legs, knee {knee:.1f} degrees, body {height:.1f} mm up")

# Prints
# 2 legs, knee 29.3 degrees, body 1.1 mm up
