# Drives for a second with both motors at a tenth of their speed.
from eye import *

MOTORDrive(1, 10)  # percent
MOTORDrive(2, 10)
OSWait(1000)
MOTORDrive(1, 0)
MOTORDrive(2, 0)
print(f"no such motor: {MOTORDrive(5, 10)}")

# Prints
# no such motor: 1
