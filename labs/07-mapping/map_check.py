"""Checks the last map that the program prints: 12 rows, from the top, of 16 cells: `#` occupied, `.` free, `?` unknown.

The truth follows from the positions of this seed's boxes in the report.
"""
import json
import sys

COLUMNS, ROWS, CELL = 16, 12, 250
RIGHT = 97  # minimum percentage

question, report, trace = sys.argv[1:]
drawn = {item["path"]: item["value"] for item in json.load(open(report))["drawn"]}
boxes = [(drawn[f"object.box.{n}.x_mm"], drawn[f"object.box.{n}.y_mm"]) for n in range(1, 6)]
truth = [["."] * COLUMNS for _ in range(ROWS)]
for x, y in boxes:
    for column in x // CELL - 1, x // CELL:
        for row in y // CELL - 1, y // CELL:
            truth[ROWS - 1 - row][column] = "#"

lines = []
for line in open(trace):
    event = json.loads(line)
    if event["event"] == "stdout" and event["robot"] == 1:
        text = event["text"].strip()
        if len(text) == COLUMNS and set(text) <= set("#.?"):
            lines.append(text)
printed = lines[-ROWS:]

pairs = [pair for row in zip(printed, truth) for pair in zip(*row)]
known = [pair for pair in pairs if pair[0] != "?"]
if len(printed) < ROWS:
    passed, message = False, f"{len(lines)} rows of {COLUMNS} cells are printed, a map has {ROWS}: rows of `#`, `.` and `?` alone, without blanks"
elif question == "printed":
    passed, message = 2 * len(known) >= len(pairs), f"{len(known)} of {len(pairs)} cells are known, half are asked for"
else:
    right = sum(found == true for found, true in known)
    of = len(pairs) if question == "complete" else max(1, len(known))
    found, there = known.count(("#", "#")), sum(row.count("#") for row in truth)
    passed = 100 * right >= RIGHT * of and 4 * found >= there
    what = "all cells" if question == "complete" else "the known cells"
    message = f"{100 * right / of:.1f} % of {what} are known and right, {RIGHT} % are asked for"
    wrong = [(row, column) for row in range(ROWS) for column in range(COLUMNS) if printed[row][column] not in (truth[row][column], "?")]
    if 4 * found < there:
        message += f"; of {there} cells of boxes {found} are `#`, a quarter is asked for"
    if wrong and not passed:
        row, column = wrong[0]
        message += f"; row {row + 1} from the top, column {column + 1} is `{truth[row][column]}`, not `{printed[row][column]}`"
print(json.dumps({"passed": passed, "message": message}))
