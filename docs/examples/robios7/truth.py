# Reads the true depth and the true label of the pixel in the middle.
from eye import *

CAMInit(QQVGA)
CAMGet()
depth, label = CAMGetDepth(), CAMGetLabels()
middle = 60 * QQVGA_X + QQVGA_X // 2
print(f"ahead: {'wall' if label[middle] == CAM_WALL else 'no wall'} in {depth[middle]:.0f} mm")

# Prints
# ahead: wall in 1320 mm
