"""Checks the distance matrix that the program prints, the path that it prints, or the path that the robot drives.

Matrix: the last 8 lines with 8 whole numbers each: distances between the places in mm, -1 where the straight line from one to the other
passes through the square of 500 mm around a pillar. Path: the last line `way 0 3 7`, a shortest path from place 0 to place 7.
"""
import json
import math
import re
import sys

HALF, GOAL = 250, 7

question, report_path, trace = sys.argv[1:]
report = json.load(open(report_path))
drawn = {item["path"]: item["value"] for item in report["drawn"]}


def drawn_at(path):
    return drawn[path + ".x_mm"], drawn[path + ".y_mm"]


places = [drawn_at("robot.robot"), (500, 3500), (3500, 500), *(drawn_at(f"marker.1.{n}") for n in range(1, 5)), drawn_at("marker.2")]
pillars = [*(drawn_at(f"object.pillar.{n}") for n in range(1, 4)), (2000, 2000)]


def is_free(a, b):
    """True if the line from a to b passes through no pillar's square: each axis bounds the part of the line within the square."""
    for pillar in pillars:
        first, last = 0.0, 1.0
        for axis in 0, 1:
            way, offset = b[axis] - a[axis], pillar[axis] - a[axis]
            if way == 0:
                if abs(offset) >= HALF:
                    last = -1.0
            else:
                ends = sorted([(offset - HALF) / way, (offset + HALF) / way])
                first, last = max(first, ends[0]), min(last, ends[1])
        if first < last:
            return False
    return True


count = len(places)
exact = [[math.dist(a, b) if a == b or is_free(a, b) else math.inf for b in places] for a in places]
shortest = [row[:] for row in exact]
for k in range(count):
    for i in range(count):
        for j in range(count):
            shortest[i][j] = min(shortest[i][j], shortest[i][k] + shortest[k][j])
best = shortest[0][GOAL]

events = [event for event in map(json.loads, open(trace)) if event.get("robot") == 1]
lines = [event["text"] for event in events if event["event"] == "stdout"]
if question == "matrix":
    rows = [[int(word) for word in line.split()] for line in lines if re.fullmatch(r"\s*(-?\d+\s+){7}-?\d+\s*", line)][-count:]
    right = [[-1 if value == math.inf else value for value in row] for row in exact]
    wrong = [(i, j) for i, row in enumerate(rows) for j in range(count) if abs(row[j] - right[i][j]) > 1]
    passed, message = len(rows) == count and not wrong, f"all {count} rows"
    if len(rows) < count:
        message = f"{len(rows)} rows of {count} numbers are printed, the matrix has {count}"
    elif wrong:
        i, j = wrong[0]
        message = f"from place {i} to place {j}: {rows[i][j]}, not {right[i][j]:.0f}"
elif question == "way":
    ways = [line.split()[1:] for line in lines if re.fullmatch(r"\s*way(\s+[0-7])+\s*", line)]
    way = [int(word) for word in ways[-1]] if ways else []
    length = sum(exact[a][b] for a, b in zip(way, way[1:]))
    passed = way[:1] == [0] and way[-1:] == [GOAL] and length <= best + 1
    message = f"the way printed is {length:.0f} mm long, a shortest one {best:.0f} mm" if way else "no way is printed"
    if way and (way[0] != 0 or way[-1] != GOAL):
        message = f"the way printed does not lead from place 0 to place {GOAL}"
else:
    robot = report["robots"][0]
    length = 1000 * robot["path_m"]
    off = math.dist((1000 * robot["pose"]["x_m"], 1000 * robot["pose"]["y_m"]), places[GOAL])
    passed = off <= 80 and length <= 1.03 * best + 50
    message = f"{length:.0f} mm are driven, a shortest way has {best:.0f} mm" if off <= 80 else "it does not end at the goal"
print(json.dumps({"passed": passed, "message": message}))
