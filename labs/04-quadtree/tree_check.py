"""Checks the quadtree that the program prints: a line `free ROW COLUMN SIZE` for each free square, in cells, in any order.

The right tree follows from the positions of this seed's pillars in the report.
"""
import json
import re
import sys

SIDE, CELL, PILLARS = 16, 250, 5

report, trace = sys.argv[1:]
drawn = {item["path"]: item["value"] for item in json.load(open(report))["drawn"]}
occupied = set()
for n in range(1, PILLARS + 1):
    column, row = drawn[f"object.pillar.{n}.x_mm"] // CELL, drawn[f"object.pillar.{n}.y_mm"] // CELL
    occupied |= {(row - i, column - j) for i in (0, 1) for j in (0, 1)}


def free_squares(row, column, size):
    cells = {(row + i, column + j) for i in range(size) for j in range(size)}
    if not cells & occupied:
        return [(row, column, size)]
    if cells <= occupied:
        return []
    half = size // 2
    return [square for i in (0, half) for j in (0, half) for square in free_squares(row + i, column + j, half)]


printed = []
for line in open(trace):
    event = json.loads(line)
    if event["event"] == "stdout" and event["robot"] == 1:
        match = re.match(r"\s*free\s+(\d+)\s+(\d+)\s+(\d+)\s*$", event["text"])
        if match:
            printed.append(tuple(map(int, match.groups())))

right = free_squares(0, 0, SIDE)
missing, wrong = sorted(set(right) - set(printed)), sorted(set(printed) - set(right))
if sorted(printed) == sorted(right):
    message = f"all {len(right)} free squares"
elif wrong:
    message = "`free %d %d %d` is not a free square of the tree" % wrong[0]
elif missing:
    message = f"{len(missing)} of {len(right)} free squares are missing, such as `free %d %d %d`" % missing[0]
else:
    message = "a square is printed twice"
print(json.dumps({"passed": sorted(printed) == sorted(right), "message": message}))
