# Scans all around and looks for the nearest wall.
from eye import *

distances = LIDARGet()
nearest = min(range(360), key=lambda point: distances[point])
print(f"ahead {distances[180]} mm; nearest {distances[nearest]} mm at point {nearest}")

# Prints
# ahead 1400 mm; nearest 600 mm at point 0
