"""Checks the grid that the program prints, or the path of the robot.

Grid: the last 16 lines with 16 whole numbers each, from the top. An occupied cell has 1. Any other cell has 1 more than the minimum of its
four neighbours; cells beyond the floor count as occupied. Path: its minimum number over the cells of the robot's centre must be the maximum
that any path from the start to the goal has.
"""
import json
import sys

SIDE, CELL, PILLARS = 16, 250, 5

question, report, trace = sys.argv[1:]
drawn = {item["path"]: item["value"] for item in json.load(open(report))["drawn"]}
occupied = set()
for n in range(1, PILLARS + 1):
    column, row = drawn[f"object.pillar.{n}.x_mm"] // CELL, drawn[f"object.pillar.{n}.y_mm"] // CELL
    occupied |= {(row - i, column - j) for i in (0, 1) for j in (0, 1)}


def neighbours(cell):
    row, column = cell
    return [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]


def fire():
    cells = {(row, column) for row in range(SIDE) for column in range(SIDE)}
    number = {cell: 1 for cell in occupied}
    front = [cell for cell in cells if any(n not in cells or n in occupied for n in neighbours(cell)) and cell not in occupied]
    value = 2
    while front:
        number.update((cell, value) for cell in front)
        front = list({n for cell in front for n in neighbours(cell) if n in cells and n not in number})
        value += 1
    return number


def is_connected(start, goal, number, least):
    found, queue = {start}, [start]
    for cell in queue:
        for n in neighbours(cell):
            if number.get(n, 0) >= least and n not in found:
                found.add(n)
                queue.append(n)
    return goal in found


number = fire()
events = [event for event in map(json.loads, open(trace)) if event.get("robot") == 1]
if question == "grid":
    rows = []
    for event in events:
        words = event["text"].split() if event["event"] == "stdout" else []
        if len(words) == SIDE and all(word.isdigit() for word in words):
            rows.append([int(word) for word in words])
    printed, right = rows[-SIDE:], [[number[row, column] for column in range(SIDE)] for row in reversed(range(SIDE))]
    if len(printed) < SIDE:
        message = f"{len(rows)} rows of {SIDE} numbers are printed, the grid has {SIDE}"
    else:
        wrong = [(i, j) for i in range(SIDE) for j in range(SIDE) if printed[i][j] != right[i][j]]
        message = f"all {SIDE} rows"
        if wrong:
            i, j = wrong[0]
            message = f"row {i + 1} from the top, number {j + 1}: {printed[i][j]}, not {right[i][j]}"
    verdict = {"passed": printed == right, "message": message}
else:
    def cell_of(x, y):
        return int(y // CELL), int(x // CELL)

    goal = cell_of(drawn["marker.1.x_mm"], drawn["marker.1.y_mm"])
    start = cell_of(drawn["robot.robot.x_mm"], drawn["robot.robot.y_mm"])
    least = min(number[start], number[goal])
    while not is_connected(start, goal, number, least):
        least -= 1
    verdict = {"passed": False, "message": "it does not come to the goal"}
    for event in events:
        if event["event"] == "pose":
            cell = cell_of(1000 * event["x_m"], 1000 * event["y_m"])
            if number.get(cell, 0) < least:
                message = f"it comes to a cell with {number.get(cell, 0)}; there is a way along cells with {least} or more"
                verdict = {"passed": False, "message": message, "at_s": event["t_s"]}
                break
            if cell == goal:
                verdict = {"passed": True, "message": f"along cells with {least} or more"}
print(json.dumps(verdict))
