# Two robots: the one with the odd number sends, the other one receives.
from eye import *

RADIOInit()
if RADIOGetID() % 2 == 1:
    OSWait(100)  # until the other radio is on
    RADIOSend(0, "hello")
    OSWait(100)  # until the message is out
else:
    sender, text = RADIOReceive(100)
    print(f"from robot {sender}: {text}")
RADIORelease()

# Prints
# from robot 17: hello
