"""Tries to refute five statements of the documentation with runs of the simulator, without the project's code.

    python accuracy/peers/refute.py target/release/eyesim

1. docs/noise.md: the standard deviation of a PSD with the preset `real` is 1.2 mm at 8 cm and 60.3 mm at 80 cm.
2. docs/noise.md: a drive of 1 m at 300 mm/s with a speed noise of 10 % ends with an error of 5.5 mm along the path, and
   5 degrees/s of turning noise change the heading by 0.9 degrees; for slots of any length.
3. docs/accuracy.md: a round robot stops at a wall at the time of the closed form.
4. docs/noise.md, earlier version: the slot length changes nothing, except contacts between moving bodies.
5. docs/noise.md: of the errors of a sonar with the preset `real`, 1.1 % are beyond 4 cm at 3 m, before the rounding to
   steps; an earlier version called sonars of `real` consistent with the manufacturer's figures at any distance.

Seeds and scenes are used nowhere else in the repository.
"""

import json
import math
import os
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

RADIUS = 0.093
SKIN = 1e-6

PROGRAMS = {
    "read.c": '#include "eyebot.h"\nint main(void) { for (int i = 0; i < 200; i++) { OSWait(61); PSDGet(1); } return 0; }\n',
    "drive.c": '#include "eyebot.h"\nint main(void) { VWStraight(1000, 300); VWWait(); return 0; }\n',
    "speed.c": '#include "eyebot.h"\n#include <stdlib.h>\n'
    "int main(int n, char **words) { VWSetSpeed(atoi(words[1]), 0); OSWait(20000); return 0; }\n",
    "echo.c": '#include "eyebot.h"\n'
    "int main(void) { for (int i = 0; i < 400; i++) { OSWait(61); PSDGet(1); } return 0; }\n",
    "listen.c": '#include "eyebot.h"\n'
    "int main(void) { RADIOInit(); for (int i = 0; i < 160; i++) { OSWait(61); PSDGet(1); } return 0; }\n",
}
NOISE = "[drive]\nv_sigma_percent = 10\nomega_sigma_deg_s = 5\n"


def run(program, at, noise="none", seed=1, wall=None, arguments=(), slot=10):
    """Events and report of a run of one robot that looks along x from `at`, in mm."""
    walls = f"wall = [{{ from_mm = {list(wall[0])}, to_mm = {list(wall[1])} }}]" if wall else ""
    Path("x.scene.toml").write_text(
        f"[scene]\nseed = 1\nuntil_s = 20\nslot_ms = {slot}\n[world]\nfloor_mm = [9000, 9000]\n{walls}\n"
        f'[[robot]]\ntype = "S4"\napi = 7\nprogram = "{program}"\narguments = {json.dumps(list(arguments))}\n'
        f"x_mm = {at[0]}\ny_mm = {at[1]}\n"
    )
    return simulate(noise, seed)


def simulate(noise, seed):
    """Events and report of a run of `x.scene.toml`."""
    options = ["--noise", noise, "--seed", str(seed), "--trace", "x.jsonl", "--report", "x.json"]
    subprocess.run([EYESIM, "run", "x.scene.toml", *options], check=True, capture_output=True)
    return [json.loads(line) for line in open("x.jsonl")], json.load(open("x.json"))


def readings(x, noise, seed):
    events, _ = run("read.c", (x, 4000), noise, seed, wall=((3000, 1000), (3000, 8000)))
    return {event["measured_s"]: event["distance_m"] for event in events if event["event"] == "distance"}


def psd():
    for target, bound in (0.08, 0.0025), (0.8, 0.1854):
        near = readings(2000, "none", 1)
        x = 2000 + round(1000 * (next(iter(near.values())) - target))
        truth = next(iter(readings(x, "none", 1).values()))
        errors, variances = [], []
        for seed in range(900001, 900121):
            values = [value - truth for value in readings(x, "real", seed).values() if value is not None]
            errors += values
            middle = statistics.median(values)
            spread = statistics.median(abs(value - middle) for value in values) / 0.6745
            variances.append(statistics.pvariance([value for value in values if abs(value - middle) < 6 * spread]))
        beyond = sum(abs(error) > bound for error in errors) / len(errors)
        sigma = 1000 * math.sqrt(statistics.mean(variances))
        print(f"PSD at {target} m: sigma of one sensor without outliers {sigma:.2f} mm; of all readings of 120 sensors "
              f"{100 * beyond:.1f} % have an error above {1000 * bound} mm")


def drive():
    Path("x.toml").write_text(NOISE)
    for noise, slot in ("x.toml", 10), ("x.toml", 50), ("real", 10):
        poses = [run("drive.c", (2000, 4500), noise, seed, slot=slot)[1]["robots"][0]["pose"]
                 for seed in range(910001, 910401)]
        along = 1000 * statistics.stdev(pose["x_m"] for pose in poses)
        across = 1000 * statistics.stdev(pose["y_m"] for pose in poses)
        heading = math.degrees(statistics.stdev(pose["phi_rad"] for pose in poses))
        name = "speed and turning noise alone" if noise == "x.toml" else "the whole preset `real`"
        print(f"drive of 1 m, {name}, slots of {slot} ms: sigma {along:.2f} mm along, {across:.1f} mm across, "
              f"{heading:.2f} degrees (400 seeds, standard error 3.5 %)")


def contact():
    generator = random.Random(77001)
    early = []
    while len(early) < 30:
        angle, gap = generator.uniform(-1.2, 1.2), generator.uniform(600, 2500)
        speed, slot = generator.randint(150, 400), generator.choice((2, 10, 50))
        normal = (math.cos(angle), math.sin(angle))
        foot = [4000 + gap * part for part in normal]
        ends = [(round(foot[0] - side * normal[1], 3), round(foot[1] + side * normal[0], 3)) for side in (3000, -3000)]
        if not all(0 <= value <= 9000 for end in ends for value in end):
            continue
        events, _ = run("speed.c", (4000, 4000), wall=ends, arguments=(str(speed), "0"), slot=slot)
        start = next(event["t_s"] for event in events if event["event"] == "drive_speed")
        touch = next((event["at_s"] for event in events if event["event"] == "contact"), None)
        if touch is None:  # farther than the robot drives
            continue
        (ax, ay), (bx, by) = ends
        length = math.hypot(bx - ax, by - ay)
        along = abs(by - ay) / length
        distance = abs((ax - 4000) * (by - ay) - (ay - 4000) * (bx - ax)) / length / 1000
        early.append(distance - RADIUS - speed / 1000 * along * (touch - start))
    print(f"contact with an oblique wall, 30 cases: at the recorded time the gap is {1e6 * min(early):.2f} to "
          f"{1e6 * max(early):.2f} um, with a skin of {1e6 * SKIN:.0f} um")


def mover(generator):
    """A program that sends a message and changes its speed every 83 to 217 ms, within 300 mm."""
    steps, place = "", 150
    for _ in range(80):
        speed, wait = generator.randint(50, 350), generator.randint(83, 217)
        speed *= 1 if place < 75 else -1 if place > 225 else generator.choice((-1, 1))
        place += speed * wait / 1000
        steps += f'RADIOSend(1, "x"); VWSetSpeed({speed}, 0); OSWait({wait}); '
    return f'#include "eyebot.h"\nint main(void) {{ RADIOInit(); {steps}return 0; }}\n'


def slots():
    for noise in "none", "real":
        reference = None
        for slot in 1, 10, 50, 200:
            near, still, delays, contacts, poses = {}, {}, {}, 0, {}
            for seed in range(920001, 920006):
                Path("move.c").write_text(mover(random.Random(seed)))
                robots = "".join(
                    f'[[robot]]\ntype = "S4"\napi = 7\nprogram = "{program}"\nx_mm = {x}\ny_mm = {y}\n'
                    for program, x, y in (("listen.c", 2000, 4500), ("move.c", 2450, 4500), ("listen.c", 2000, 7500)))
                Path("x.scene.toml").write_text(
                    f"[scene]\nseed = 1\nuntil_s = 12\nslot_ms = {slot}\n[world]\nfloor_mm = [9000, 9000]\n"
                    f"wall = [{{ from_mm = [2600, 7000], to_mm = [2600, 8000] }}]\n{robots}")
                for event in simulate(noise, seed)[0]:
                    name, robot = event["event"], event.get("robot")
                    if name == "distance":
                        (near if robot == 1 else still)[seed, event["measured_s"]] = event["distance_m"]
                    elif name == "radio_arrived" and event["arrived_s"] < 9:  # before the receiver's program ends
                        delays[seed, event["arrived_s"]] = event["t_s"] - event["arrived_s"]
                    elif name == "pose" and robot == 2 and noise == "none":
                        poses[seed, event["t_s"]] = event["x_m"], event["y_m"]
                    contacts += name == "contact"
            if reference is None:
                reference = near, still, delays, poses
            common = [instant for instant in near if None not in (near[instant], reference[0].get(instant))]
            errors = [abs(near[instant] - reference[0][instant]) for instant in common]
            same = [instant for instant in poses if instant in reference[3]]
            print(f"slots of {slot} ms against 1 ms, noise {noise}, {contacts} contacts: of {len(errors)} readings of "
                  f"a robot with commands {sum(error > 0 for error in errors)} differ, by at most "
                  f"{1000 * max(errors):.1f} mm; readings of a wall equal: {still == reference[1]}; arrivals of "
                  f"{len(delays)} messages equal: "
                  f"{delays.keys() == reference[2].keys()}; available {1000 * statistics.mean(delays.values()):.1f} ms "
                  f"after arrival, at most {1000 * max(delays.values()):.1f} ms"
                  + (f"; {len(same)} poses equal: {all(poses[at] == reference[3][at] for at in same)}" if same else ""))


def beyond(distance):
    """Fraction of a normal distribution beyond 40 mm, before and after rounding to steps of 10 mm; distance in mm."""
    normal = statistics.NormalDist(distance, math.hypot(5, 0.005 * distance))
    steps = range(round(distance / 10) - 4, round(distance / 10) + 5)
    inside = [step for step in steps if abs(10 * step - distance) <= 40]
    return (2 * (1 - normal.cdf(distance + 40)),
            1 - normal.cdf(10 * inside[-1] + 5) + normal.cdf(10 * inside[0] - 5))


def wilson(hits, count):
    share, z = hits / count, 1.96
    middle, half = share + z * z / (2 * count), z * math.sqrt(share * (1 - share) / count + (z / (2 * count)) ** 2)
    return [100 * (middle + side * half) / (1 + z * z / count) for side in (-1, 1)]


def sonar():
    for distance in 1000, 2000, 3000, 4000, 5000, 5900:
        errors = []
        for seed in range(930000 + distance, 930015 + distance):
            Path("x.scene.toml").write_text(
                "[scene]\nseed = 1\nuntil_s = 60\n[world]\nfloor_mm = [20000, 20000]\n"
                "wall = [{ from_mm = [10000, 0], to_mm = [10000, 20000] }]\n"
                '[[robot_type]]\nname = "P"\n[[robot_type.sonar]]\nname = "S"\nid = 1\nz_mm = 100\n'
                f'[[robot]]\ntype = "P"\nprogram = "echo.c"\napi = 7\nx_mm = {10000 - distance}\ny_mm = 10000\n')
            intervals = {int(event["measured_s"] / 0.06): event["distance_m"] for event in simulate("real", seed)[0]
                         if event["event"] == "distance"}
            errors += [abs(1000 * value - distance) for value in intervals.values() if value is not None and value < 6]
        hits = sum(error > 40.000001 for error in errors)
        low, high = wilson(hits, len(errors))
        before, after = (100 * share for share in beyond(distance))
        print(f"sonar at {distance} mm: {100 * hits / len(errors):.2f} % of {len(errors)} errors beyond 4 cm "
              f"({low:.2f} to {high:.2f}); normal errors before rounding {before:.2f} %, after {after:.2f} %")


EYESIM = str(Path(sys.argv[1]).resolve())
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for name, text in PROGRAMS.items():
        Path(name).write_text(text)
    psd()
    drive()
    contact()
    slots()
    sonar()
