# Finds edges in a camera image.
from eye import *

CAMInit(QQVGA)
edges = IPSobel(CAMGetGray())
print(f"{sum(edge > 100 for edge in edges)} edge pixels")

# Prints
# 632 edge pixels
