"""`eyesim bench-env`: measures the speed of the environments."""

import argparse
import os
import time
from collections.abc import Callable

import numpy as np

from . import gym


def main(words: list[str]) -> int:
    """Runs the command; prints steps a second of `WallFollow-v0` as a vector and alone, and the time of a reset."""
    parser = argparse.ArgumentParser("eyesim bench-env", description=__doc__)
    parser.add_argument("--count", type=int, default=64, help="environments of the vector [default: 64]")
    parser.add_argument("--threads", type=int, help="threads of the vector [default: one for each core]")
    parser.add_argument("--seconds", type=float, default=3.0, help="length of each measurement [default: 3]")
    parser.add_argument("--scene", help="a scene with one robot [default: that of WallFollow-v0]")
    options = parser.parse_args(words)
    task = gym.Task(options.scene) if options.scene else gym.WALL_FOLLOW
    vector = gym.VectorEnv(task, options.count, options.threads)
    actions = np.random.default_rng(0).uniform(-1, 1, (16, options.count, 2)).astype(np.float32)
    vector.reset(seed=0)
    steps, seconds = _repeat(lambda index: vector.step(actions[index % 16]), options.seconds)
    print(f"vector of {options.count}, {options.threads or os.cpu_count()} threads, observed: {vector.single_observation_space}")
    print(f"  {steps * options.count / seconds:12,.0f} steps a second")
    env = gym.Env(task)
    env.reset(seed=0)
    steps, seconds = _repeat(lambda index: env.step(actions[index % 16, 0]), options.seconds)
    print(f"  {steps / seconds:12,.0f} steps a second, one alone")
    resets, seconds = _repeat(lambda index: env.reset(), options.seconds)
    print(f"  {seconds / resets * 1e6:12,.1f} us a reset, one alone")
    return 0


def _repeat(act: Callable[[int], object], seconds: float) -> tuple[int, float]:
    """Number of calls of `act` within `seconds`, and the time they took."""
    start = time.perf_counter()
    count = 0
    while (elapsed := time.perf_counter() - start) < seconds:
        act(count)
        count += 1
    return count, elapsed
