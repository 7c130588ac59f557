# Waits for a key of the remote control.
from eye import *

key = IRTVGet()
print(f"code {key}{', the key OK' if key == IRTV_OK else ''}")

# Prints
# code 79, the key OK
