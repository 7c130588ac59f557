# Reads an analog input and the battery, and records ten values.
from eye import *

print(f"channel 1: {ANALOGRead(1)}, battery {ANALOGVoltage()}")
ANALOGRecord(1, 10)  # 10 ms at 1 kHz
OSWait(20)
values = ANALOGTransfer()
print(f"{len(values)} bytes, the first is {values[0]}")

# Prints
# channel 1: 820, battery 720
# 10 bytes, the first is 205
