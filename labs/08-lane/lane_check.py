"""Checks the path: the robot's centre is never farther than 90 mm from the middle of the right lane, so its body stays in the lane.

The middle of the road is a rounded rectangle, as in worlds/road.wld; the middle of the right lane is 185 mm outside of it.
"""
import json
import math
import sys

MAX_DISTANCE = 0.09  # m


def off(x, y):
    """Distance from the middle of the lane, m."""
    x, y = abs(x - 3.0) - 1.3, abs(y - 2.0) - 0.3
    from_corner = math.hypot(max(x, 0), max(y, 0)) + min(max(x, y), 0)
    return abs(from_corner - 0.9 - 0.185)


report, trace = sys.argv[1:]
poses = [event for event in map(json.loads, open(trace)) if event["event"] == "pose" and event["robot"] == 1]
if not poses:
    verdict = {"passed": False, "message": "it never moves"}
else:
    worst = max(poses, key=lambda pose: off(pose["x_m"], pose["y_m"]))
    distance = off(worst["x_m"], worst["y_m"])
    message = f"{1000 * distance:.0f} mm from the middle of the lane, at most {1000 * MAX_DISTANCE:.0f} are allowed"
    verdict = {"passed": distance <= MAX_DISTANCE, "message": message, "at_s": worst["t_s"]}
print(json.dumps(verdict))
