"""Checks the race: the last drive from the start to the goal, after the goal was found, passes as few cells as a shortest path.

The maze is the drawing of this seed in the report. The path is that of the true poses in the trace."""
import json
import sys

CELL = 0.36
START, GOAL = (0, 0), (5, 5)

report, trace = sys.argv[1:]
drawing = next(item["value"] for item in json.load(open(report))["drawn"] if item["path"] == "world.maze")
rows = [line for line in drawing.splitlines() if line.startswith("|")][::-1]  # from the lowest up


def is_open(cell, step):
    (x, y), (dx, dy) = cell, step
    if dx:
        return rows[y][2 * max(x, x + dx)] != "|"
    return rows[max(y, y + dy)][2 * x + 1] == " "  # `_` and the letter S stand above a wall


def fewest_steps():
    steps, queue = {START: 0}, [START]
    for cell in queue:
        for step in (1, 0), (-1, 0), (0, 1), (0, -1):
            next_cell = cell[0] + step[0], cell[1] + step[1]
            if next_cell not in steps and is_inside(next_cell) and is_open(cell, step):
                steps[next_cell] = steps[cell] + 1
                queue.append(next_cell)
    return steps[GOAL]


def is_inside(cell):
    return all(0 <= number < len(rows) for number in cell)


cells, times = [START], [0]
for line in open(trace):
    event = json.loads(line)
    if event["event"] == "pose" and event["robot"] == 1:
        cell = int(event["x_m"] / CELL), int(event["y_m"] / CELL)
        if cell != cells[-1]:
            cells.append(cell)
            times.append(event["t_s"])

fewest = fewest_steps()
last = max((index for index, cell in enumerate(cells) if cell == GOAL), default=0)
begin = max(index for index, cell in enumerate(cells[: last + 1]) if cell == START)
if GOAL not in cells[:begin]:
    verdict = {"passed": False, "message": "it does not race: from the start to the goal, when it has been at the goal before"}
else:
    end = cells.index(GOAL, begin)
    passed = end - begin == fewest
    message = f"{end - begin} steps from cell to cell, a shortest way has {fewest}"
    verdict = {"passed": passed, "message": message, "at_s": times[begin]}
print(json.dumps(verdict))
