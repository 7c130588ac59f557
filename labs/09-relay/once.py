"""Checks the output of robot 4: with `words`, each line is a word of robot 1; with `order`, the lines are the words of
robot 1 in their order, each once."""
import json
import sys

what, report, trace = sys.argv[1:]
words = [item["value"] for item in json.load(open(report))["drawn"] if item["path"].startswith("robot.first.arguments")]
events = map(json.loads, open(trace))
printed = [event["text"].strip() for event in events if event["event"] == "stdout" and event["robot"] == 4]
passed = printed == words if what == "order" else set(printed) <= {*words, ""}
message = "robot 4 prints " + (", ".join(printed[:12]) or "nothing") + "; robot 1 has " + ", ".join(words)
print(json.dumps({"passed": passed, "message": message}))
