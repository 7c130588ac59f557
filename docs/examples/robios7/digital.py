# Reads an input line and sets an output line.
from eye import *

DIGITALSetup(1, 'i')
DIGITALSetup(2, 'o')
DIGITALWrite(2, 1)
print(f"line 1: {DIGITALRead(1)}, all lines: {DIGITALReadAll()}")

# Prints
# line 1: 1, all lines: 3
