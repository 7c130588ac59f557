# Turns the camera to the left and back.
from eye import *

print(f"left: {SERVOSet(1, 255)}")
print(f"too far: {SERVOSet(1, 256)}")
SERVOSet(1, 128)

# Prints
# left: 0
# too far: 1
