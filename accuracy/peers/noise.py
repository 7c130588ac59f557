"""Estimates the noise of a sensor, a drive, odometry and a radio from a trace alone, and sets each figure beside the number it should have.

Nothing of the project's code is used. The scene is accuracy/peers/noise/noise.scene.toml:

    eyesim run accuracy/peers/noise/noise.scene.toml --trace noise.jsonl
    python accuracy/peers/noise.py noise.jsonl

`z` is the difference in standard errors of the estimate. Exits with 1 if one is above 4: by chance that happens once in 2000 runs.
"""

import json
import math
import sys

import numpy as np

TICK = 0.01
SPEED = 0.3


def events(path, robot, kind):
    lines = (json.loads(line) for line in open(path))
    return [event for event in lines if event.get("robot") == robot and event["event"] == kind]


def share(name, count, of, expected):
    """A frequency against its probability."""
    error = math.sqrt(expected * (1 - expected) / of)
    return name, count / of, expected, error


def deviation(name, sample, expected):
    """A standard deviation against that of a normal distribution."""
    return name, np.std(sample, ddof=1), expected, expected / math.sqrt(2 * (len(sample) - 1))


def distances(path):
    true = 2.0 - 1.48
    readings = [event.get("distance_m") for event in events(path, 1, "distance")]
    values = np.array([value for value in readings if value is not None])
    sigma = math.hypot(0.001, 0.005 * true, 0.094 * true**2)
    middle = np.median(values)
    core = values[abs(values - middle) < 5 * sigma]
    # An outlier is anywhere in the range of 60 mm to 4 m of the scout's sensor, within the core by chance.
    far = 0.001 * (1 - 0.001) * (1 - 10 * sigma / (3.999 - 0.06))
    yield deviation("PSD: standard deviation, mm", 1e3 * core, 1e3 * sigma)
    yield "PSD: bias drawn once, mm", 1e3 * (middle - true), 0.0, 5.0
    yield share("PSD: no return", len(readings) - len(values), len(readings), 0.001)
    yield share("PSD: outliers", len(values) - len(core), len(readings), far)
    z = np.sort((core - core.mean()) / core.std())
    normal = np.array([0.5 * (1 + math.erf(value / math.sqrt(2))) for value in z])
    steps = np.arange(len(z) + 1) / len(z)
    largest = max(np.max(steps[1:] - normal), np.max(normal - steps[:-1]))
    # Lilliefors: mean and deviation are those of the sample, which shrinks the distance: 0.886 / sqrt(n) is exceeded by one in twenty.
    yield "PSD: distance from a normal law", largest, 0.0, 0.886 / math.sqrt(len(z)) / 2


def motion(path):
    poses = events(path, 2, "pose")
    steps = np.diff([pose["x_m"] for pose in poses])
    ticks = round(0.05 / TICK)
    sigma = 0.1 * SPEED * TICK * math.sqrt(ticks)
    yield deviation("drive: deviation of 50 ms, mm", 1e3 * steps, 1e3 * sigma)
    yield "drive: mean of 50 ms, mm", 1e3 * steps.mean(), 1e3 * SPEED * ticks * TICK, 1e3 * sigma / math.sqrt(len(steps))
    read = events(path, 2, "odometry")
    times, places = np.array([event["t_s"] for event in read]), np.array([event["x_m"] for event in read])
    scaled = []
    for begin, end, step in zip(times[1:], times[2:], np.diff(places)[1:]):
        bounds = np.arange(math.floor(begin / TICK), math.ceil(end / TICK) + 1) * TICK
        parts = np.diff(np.clip(bounds, begin, end))
        scaled.append((step - SPEED * (end - begin)) / math.sqrt((parts**2).sum()))
    yield deviation("odometry: deviation of the speed, mm/s", 1e3 * np.array(scaled), 1e3 * 0.02 * SPEED)


def radio(path):
    sent = {event["message"]: bytes(event["data"]) for event in events(path, 3, "radio_sent")}
    lost = [event for event in events(path, 4, "radio_lost") if event["cause"] == "packet"]
    arrived = events(path, 4, "radio_arrived")
    yield share("radio: messages lost, P_p", len(lost), len(lost) + len(arrived), 0.05)
    flipped, bits = 0, 0
    for event in events(path, 4, "radio_received"):
        was = sent[event["message"]]
        flipped += sum((a ^ b).bit_count() for a, b in zip(was, event["data"]))
        bits += 8 * len(was)
    yield share("radio: bits inverted, P_b", flipped, bits, 0.001)
    told = sum(event["bit_errors"] for event in arrived)
    yield "radio: bits inverted, as told", told, flipped, 0.25


def main():
    path, wrong = sys.argv[1], 0
    print(f"{'figure':<42} {'found':>12} {'expected':>12} {'z':>6}")
    for part in distances, motion, radio:
        for name, found, expected, error in part(path):
            z = (found - expected) / error
            wrong += abs(z) > 4
            print(f"{name:<42} {found:12.6g} {expected:12.6g} {z:6.2f}{'  DIFFERS' if abs(z) > 4 else ''}")
    sys.exit(1 if wrong else 0)


main()
