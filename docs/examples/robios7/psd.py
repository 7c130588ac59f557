# Measures the distances ahead and to the left.
from eye import *

print(f"front {PSDGet(PSD_FRONT)} mm, left {PSDGet(PSD_LEFT)} mm")

# Prints
# front 1300 mm, left 900 mm
