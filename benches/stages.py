"""Counts of callgrind a pixel, by the file of sim-core/src/camera from which each instruction comes:
stages.py BINARY SHORT LONG PIXELS. SHORT and LONG are files of two runs with --dump-instr=yes, and PIXELS is the number
of pixels that the longer run renders more. Inlined code counts for the innermost of these files, except `rays.rs`."""

import collections
import json
import subprocess
import sys


def costs(path, binary):
    """Events, and their counts by address in the binary."""
    events, found, names, own, last, is_call = [], collections.Counter(), {}, False, 0, False
    for line in open(path):
        if line.startswith("events:"):
            events = line.split()[1:]
        elif line.startswith(("ob=", "cob=")):
            key, _, name = line.split("=", 1)[1].strip().partition(" ")
            names.setdefault(key, name)
            if line.startswith("ob="):
                own = names[key].endswith("/" + binary.split("/")[-1])
        elif line.startswith("calls="):
            is_call = True
        elif line[0] in "0123456789+-*":
            address, _, *counts = line.split()
            step = 0 if address == "*" else int(address, 16)
            last = last + step if address[0] in "+-*" else step
            if not is_call:
                for event, count in zip(events, counts):
                    found[last if own else None, event] += int(count)
            is_call = False
    return found


binary, short, long, pixels = sys.argv[1:]
difference = costs(long, binary)
difference.subtract(costs(short, binary))
addresses = sorted({address for address, _ in difference if address is not None})
symbols = subprocess.run(
    ["llvm-symbolizer", "--obj=" + binary, "--inlines", "--output-style=JSON"],
    input="\n".join(map(hex, addresses)), capture_output=True, text=True, check=True,
).stdout.splitlines()
files = {None: "libraries"}
for address, line in zip(addresses, symbols):
    frames = [frame["FileName"].split("/src/camera/") for frame in json.loads(line).get("Symbol", [])]
    frames = [frame[-1] for frame in frames if len(frame) == 2]
    files[address] = next((frame for frame in frames if frame != "rays.rs"), "other")
table = collections.defaultdict(collections.Counter)
for (address, event), count in difference.items():
    for row in files[address], "all":
        table[row][event] += count
print(f"{'':<16} instructions  mispredictions  L1 misses")
for row, counts in sorted(table.items(), key=lambda row: -row[1]["Ir"]):
    columns = counts["Ir"], counts["Bcm"] + counts["Bim"], counts["D1mr"] + counts["D1mw"]
    print("{:<16} {:12.2f} {:15.3f} {:10.3f}".format(row, *(count / int(pixels) for count in columns)))
