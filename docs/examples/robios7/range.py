# Reads a sonar's distance and the energy of its echo.
from eye import *

print(f"sonar {PSDGet(4)} mm, echo {PSDGetSignal(4):.3f}")  # 4: the id in the companion

# Prints
# sonar 1300 mm, echo 0.592
