# Writes text in colour, a menu and a circle to the display.
from eye import *

width, height = LCDGetSize()
LCDSetColor(YELLOW, BLACK)
LCDPrintf("Hello\n")
LCDSetPrintf(2, 4, "%d mm", 120)
row, column = LCDGetPos()
LCDMenu("GO", "", "", "END")
LCDCircle(width // 2, height // 2, 30, RED, 1)
print(f"{width} x {height} pixels, cursor in row {row}, column {column}")
print(f"middle 0x{LCDGetPixel(width // 2, height // 2):06X}")

# Prints
# 480 x 320 pixels, cursor in row 2, column 10
# middle 0xFF0000
