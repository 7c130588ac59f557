# Reads the counts of both wheels during a drive.
from eye import *

ENCODERReset(1)
ENCODERReset(2)
VWStraight(300, 200)  # mm, mm/s
VWWait()
print(f"left {ENCODERRead(1)}, right {ENCODERRead(2)} counts")

# Prints
# left 1591, right 1591 counts
