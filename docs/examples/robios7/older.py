# Reads back the position of a servo.
from eye import *

SERVOSet(1, 200)
print(f"position {SERVOGet(1)}")

# Prints
# position 200
