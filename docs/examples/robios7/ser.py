# Sends text over a serial interface whose output is connected to its input.
from eye import *

SERInit(1, 9600, 0)  # interface, baud, no handshake
SERSend(1, "Hi", 2)
OSWait(10)
text = SERReceive(1)
print(f"received {len(text)} bytes: {text.decode()}")
SERClose(1)

# Prints
# received 2 bytes: Hi
