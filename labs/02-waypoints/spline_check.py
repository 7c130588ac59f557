"""Checks the path: until it reaches the last waypoint, the robot's centre is never farther than 40 mm from the spline.

The spline is that of Catmull and Rom through the start and the waypoints: the tangent at each point is half of the vector from the
previous point to the next one. At the start the first point also serves as the previous one, and at the end the last one as the next one.
"""
import json
import math
import sys

MAX_DISTANCE, PARTS, COUNT = 0.04, 100, 5

report, trace = sys.argv[1:]
drawn = {item["path"]: item["value"] for item in json.load(open(report))["drawn"]}
names = ["robot.1"] + [f"marker.{n}" for n in range(1, COUNT + 1)]
points = [(drawn[name + ".x_mm"] / 1000, drawn[name + ".y_mm"] / 1000) for name in names]


def place(i, t):
    """Point of the spline between the points i and i + 1, at t from 0 to 1."""
    before, a, b, behind = points[max(i - 1, 0)], points[i], points[i + 1], points[min(i + 2, COUNT)]
    h = 2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2
    return tuple(h[0] * a[k] + h[1] * (b[k] - before[k]) / 2 + h[2] * b[k] + h[3] * (behind[k] - a[k]) / 2 for k in (0, 1))


spline = [place(i, part / PARTS) for i in range(COUNT) for part in range(PARTS)] + [points[-1]]
worst, at, done = 0.0, None, False
for line in open(trace):
    event = json.loads(line)
    if event["event"] == "pose" and event["robot"] == 1 and not done:
        pose = event["x_m"], event["y_m"]
        off = min(math.dist(pose, point) for point in spline)
        if off > worst:
            worst, at = off, event["t_s"]
        done = math.dist(pose, points[-1]) <= 0.06 and event["t_s"] > 5
message = f"at most {1000 * worst:.0f} mm from the spline, {1000 * MAX_DISTANCE:.0f} are allowed"
if not done:
    message = "it does not come to the last waypoint"
verdict = {"passed": done and worst <= MAX_DISTANCE, "message": message}
print(json.dumps(verdict | ({"at_s": at} if at else {})))
