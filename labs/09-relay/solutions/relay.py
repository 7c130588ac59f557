"""Passes five words from robot 1 to robot 4 over a radio that reaches the next robot only and loses messages: stop-and-wait.

A word is sent with its number until the next robot acknowledges this number. The receiver recognises a repeated word by its number.
Messages: `3 word` is word 3, `ack 3` acknowledges it. Each robot takes all words before it passes them on.
"""
import sys

from eye import *

ROBOTS = 4
WORDS = 5
TIMEOUT = 100  # ms without an acknowledgement until a word is sent again
LINGER = 3000  # ms without a message at the end until the program ends, since the last acknowledgement may be lost

words = []
acknowledged = 0  # number of the last word that the next robot has acknowledged


def handle(timeout):
    """Waits for a message and handles it. Returns False if none arrives in time."""
    global acknowledged
    end = OSGetCount() + timeout
    while not RADIOCheck():
        if OSGetCount() >= end:
            return False
        OSWait(5)
    sender, text = RADIOReceive()
    kind, value = text.split()
    if kind == "ack" and sender == me + 1:
        if int(value) == acknowledged + 1:
            acknowledged = int(value)
    elif kind != "ack" and sender == me - 1:
        if int(kind) == len(words) + 1:
            words.append(value)
            if me == ROBOTS:
                print(value)
        RADIOSend(me - 1, f"ack {kind}")  # also for a repeated word, whose first acknowledgement was lost
    return True


def pass_on(number):
    while acknowledged < number:
        RADIOSend(me + 1, f"{number} {words[number - 1]}")
        while acknowledged < number and handle(TIMEOUT):
            pass


RADIOInit()
me = RADIOGetID()
OSWait(100)  # wait until all radios are on
if me == 1:
    words = sys.argv[1:]
while len(words) < WORDS:
    handle(TIMEOUT)
if me < ROBOTS:
    for number in range(1, WORDS + 1):
        pass_on(number)
while handle(LINGER):
    pass
RADIORelease()
