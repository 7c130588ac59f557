"""The score of the BARN challenge: 1 * OT / clip(AT, 2 OT, 8 OT) for a run that reaches the goal without a contact, else 0.

OT is the time at 2 m/s for the path that `generate.py` keeps free, whose length is in a comment of the world file; the
challenge takes the shortest path, which may be shorter. AT is the time at which the program ended. Arguments: the
world, the goal in millimetres, the report, the trace.
"""

import json
import math
import re
import sys

world, x, y, report, _ = sys.argv[1:]
optimal = float(re.search(r"length of the way: ([\d.]+)", open(world).read()).group(1)) / 2
robot = json.load(open(report))["robots"][0]
distance = math.hypot(robot["pose"]["x_m"] - float(x) / 1000, robot["pose"]["y_m"] - float(y) / 1000)
actual = robot["virtual_time_s"]
success = robot["outcome"] == "finished" and distance <= 0.3 and robot["contacts"] == 0
score = optimal / min(max(actual, 2 * optimal), 8 * optimal) if success else 0
message = f"score {score:.4f}: OT {optimal:.3f} s, AT {actual:.3f} s, {distance:.3f} m from the goal, {robot['contacts']} contacts"
print(json.dumps({"passed": success, "points": score, "message": message}))
