"""Checks the output of robot 4: the five words of robot 1 in their order, each once, and no other line."""
import json
import sys

report, trace = sys.argv[1:]
words = [item["value"] for item in json.load(open(report))["drawn"] if item["path"].startswith("robot.first.arguments")]
events = map(json.loads, open(trace))
printed = [event["text"].strip() for event in events if event["event"] == "stdout" and event["robot"] == 4]
message = "robot 4 prints " + (", ".join(printed[:12]) or "nothing") + "; robot 1 has " + ", ".join(words)
print(json.dumps({"passed": printed == words, "message": message}))
