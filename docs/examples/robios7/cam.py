# Takes a colour image and shows it.
import sys

from eye import *

if CAMInit(QQVGA) != 0:
    sys.exit(1)
image = CAMGet()
LCDImage(image)
middle = 3 * (110 * QQVGA_X + QQVGA_X // 2)  # row 110 of 120
print(f"{len(image)} bytes; the floor ahead: red {image[middle]}")
CAMRelease()

# Prints
# 57600 bytes; the floor ahead: red 173
