"""Repeats the comparison of ALDURO's planners with `harsh` noise, on terrains that `papers planner` does not use.

    python accuracy/peers/planner.py target/release/eyesim

The scene is that of `papers planner` (docs/papers.md, "The planner's equations"), on 120 terrains; terrains without a
path of sufficient clearance are not left out. Three robots walk over each: straight towards the goal, by A* alone, and
by A* with both equations. A walk fails if it ends farther than 1 m from the goal, or if a leg or the body touches
anything. The primary measure, fixed before the run, is the difference of the failures of the last two.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

SIM = Path(__file__).resolve().parents[2]
SEEDS = range(951000, 951120)
START, GOAL = (4, 20), (36, 4)
PLANNERS = ("straight", "none", "both")
NAMES = {"straight": "straight", "none": "A* alone", "both": "A*, Eq. 4 and 5"}

# Walks by the true bearing in whole degrees, at the planner's speed; gives up after 50 s without progress.
STRAIGHT = r"""
#include "eyebot.h"
#include <math.h>
#include <stdlib.h>
int main(int n, char **words) {
  double best = 1e9;
  int x, y, z, degrees, since = 0;
  SIMGetRobot(1, &x, &y, &z, &degrees);
  double first = remainder(degrees, 360);
  for (int i = 0; i < 2400; i++) {
    SIMGetRobot(1, &x, &y, &z, &degrees);
    double heading = remainder(degrees, 360);
    double dx = atof(words[1]) - x / 1000.0, dy = atof(words[2]) - y / 1000.0, distance = hypot(dx, dy);
    if (distance < 0.5) break;
    if (distance < best - 0.1) { best = distance; since = 0; } else if (++since > 200) break;
    double bearing = round(atan2(dy, dx) * 180 / M_PI - heading) * M_PI / 180;
    double turn = fmax(-5.7, fmin(5.7, 0.8 * (first - heading))), speed = fmin(distance, 0.3);
    LEGSetSpeed((int)(1000 * speed * cos(bearing)), (int)(1000 * speed * sin(bearing)), (int)lround(turn));
    OSWait(250);
  }
  LEGSetSpeed(0, 0, 0);
  return 0;
}
"""


def scene(seed, planner):
    corners = [[0, 0], [40000, 0], [40000, 40000], [0, 40000]]
    walls = "".join(f"[[world.wall]]\nfrom_mm = {corners[i]}\nto_mm = {corners[(i + 1) % 4]}\nheight_mm = 1000\n"
                    for i in range(4))
    clear = "".join(f"[[world.terrain.clear]]\nx_mm = {1000 * x}\ny_mm = {1000 * y}\nradius_mm = 3000\n"
                    for x, y in (START, GOAL))
    heading = math.degrees(math.atan2(GOAL[1] - START[1], GOAL[0] - START[0]))
    program, words = "straight.c", [str(value) for value in GOAL]
    if planner != "straight":
        program, words = SIM / "example-programs/alduro", [*words, planner]
    return (
        "[scene]\nuntil_s = 600\n[world]\nfloor_mm = [40000, 40000]\nsurface = { specular = 0 }\n"
        f'[world.terrain]\nfunction = "boulders"\nseed = {seed}\ncell_mm = 100\nrelief_mm = 200\nlength_mm = 4000\n'
        f"boulders = 40\nradius_mm = [500, 2000]\nheight_mm = [100, 1600]\n{clear}{walls}"
        f'[[robot]]\ntype = "{SIM}/robis/alduro.robi"\nprogram = "{program}"\narguments = {json.dumps(words)}\n'
        f"x_mm = {1000 * START[0]}\ny_mm = {1000 * START[1]}\nheading_deg = {heading:.3f}\n"
    )


def walk(seed, planner):
    """Whether the walk arrived, and its touches."""
    Path("x.scene.toml").write_text(scene(seed, planner))
    options = ["--seed", str(seed), "--noise", "harsh", "--trace", "x.jsonl", "--trace-only", "poses,touch,contact"]
    subprocess.run([EYESIM, "run", "x.scene.toml", *options], check=True, capture_output=True)
    events = [json.loads(line) for line in open("x.jsonl")]
    events = [event for event in events if event.get("robot") == 1]
    last = [(event["x_m"], event["y_m"]) for event in events if event["event"] == "pose"][-1]
    return math.dist(last, GOAL) <= 1, sum(event["event"] in ("touch", "contact") for event in events)


def interval(values):
    """Mean with its 95 % bootstrap interval."""
    generator = random.Random(951000)
    means = sorted(sum(generator.choices(values, k=len(values))) / len(values) for _ in range(10000))
    return f"{sum(values) / len(values):+.3f} ({means[250]:+.3f} to {means[9749]:+.3f})"


EYESIM = str(Path(sys.argv[1]).resolve())
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    Path("straight.c").write_text(STRAIGHT)
    walks = {planner: [walk(seed, planner) for seed in SEEDS] for planner in PLANNERS}
    os.chdir(SIM)
fails = {planner: [not arrived or touches > 0 for arrived, touches in walks[planner]] for planner in PLANNERS}
for planner in PLANNERS:
    arrived = sum(arrived for arrived, _ in walks[planner])
    touches = sum(touches for _, touches in walks[planner]) / len(SEEDS)
    print(f"{NAMES[planner]}: {arrived} of {len(SEEDS)} arrive, {len(SEEDS) - sum(fails[planner])} untouched; "
          f"{touches:.2f} touches of a walk")
for second, first in ("both", "none"), ("none", "straight"):
    failures = [int(a) - int(b) for a, b in zip(fails[second], fails[first])]
    touches = [a - b for (_, a), (_, b) in zip(walks[second], walks[first])]
    print(f"{NAMES[second]} minus {NAMES[first]}: failures {interval(failures)}, fewer on {failures.count(-1)} and "
          f"more on {failures.count(1)} terrains; touches {interval(touches)}")
