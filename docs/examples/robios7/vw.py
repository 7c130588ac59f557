# Drives straight, turns, and drives in an arc.
from eye import *

VWStraight(400, 200)  # mm, mm/s
VWWait()
VWTurn(90, 60)  # degrees, degrees/s
VWWait()
VWCurve(300, -90, 200)  # mm, degrees, mm/s
VWWait()
x, y, phi = VWGetPosition()
print(f"x {x} mm, y {y} mm, heading {phi} degrees")

# Prints
# x 591 mm, y 191 mm, heading 0 degrees
