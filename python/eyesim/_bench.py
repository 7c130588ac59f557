"""`eyesim bench-env`: measures the speed and the memory of the environments and of environments by others."""

import argparse
import gc
import importlib
import importlib.util
import os
import time
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from . import gym

RANGE_FINDERS = 8


def main(words: list[str]) -> int:
    """Runs the command; prints a line for each measurement."""
    parser = argparse.ArgumentParser("eyesim bench-env", description=__doc__)
    parser.add_argument("--count", type=int, default=64, help="environments of a vector [default: 64]")
    parser.add_argument("--threads", type=int, help="threads of a vector [default: one for each core]")
    parser.add_argument("--seconds", type=float, default=3.0, help="length of each measurement [default: 3]")
    parser.add_argument("--scene", help="a scene with one robot [default: that of WallFollow-v0]")
    parser.add_argument("--peers", action="store_true", help="also CartPole of Gymnasium, and a robot in MuJoCo, if it is installed")
    parser.add_argument("--resets", type=int, default=0, help="resets between two looks at the memory [default: none]")
    parser.add_argument("--memory", type=int, default=0, help="environments whose memory is measured [default: none]")
    parser.add_argument("--all", action="store_true", help="--peers --resets 1000000 --memory 10000")
    options = parser.parse_args(words)
    if options.all:
        options.peers, options.resets, options.memory = True, options.resets or 1_000_000, options.memory or 10_000
    threads = options.threads or len(os.sched_getaffinity(0))
    task = gym.Task(options.scene) if options.scene else gym.WALL_FOLLOW
    if options.memory:
        _memory(task, options.memory)
    _environments(task, options.count, threads, options.seconds)
    if options.peers:
        _cart_pole(options.count, options.seconds)
        _mujoco(options.count, threads, options.seconds)
    if options.resets:
        _resets(task, options.count, threads, options.resets)
    return 0


def _environments(task: gym.Task, count: int, threads: int, seconds: float) -> None:
    vector = gym.VectorEnv(task, count, threads)
    actions = np.random.default_rng(0).uniform(-1, 1, (16, count, 2)).astype(np.float32)
    vector.reset(seed=0)
    _say_steps(count, _rate(lambda index: vector.step(actions[index % 16]), seconds), f"vector of {count}, {threads} threads")
    env = gym.Env(task)
    env.reset(seed=0)
    _say_steps(1, _rate(lambda index: env.step(actions[index % 16, 0]), seconds), "one alone")
    for noise in dict.fromkeys(("none", task.noise or "none")):
        batch = gym.Rows(replace(task, noise=noise), 1).batch
        for is_commanded in (False, True):
            start = time.process_time()
            steps, taken = batch.bench(task.period, seconds, threads, is_commanded)
            command = "and a command " if is_commanded else ""
            text = f"`Simulation` from Rust, {threads} threads, noise {noise}, all range sensors {command}in each step"
            _say_steps(steps, (1 / taken, 1 / (time.process_time() - start)), text)
    _say_resets(1, _rate(lambda index: env.reset(), seconds), "one alone")
    _say_resets(count, _rate(lambda index: vector.reset(), seconds), f"vector of {count}, {threads} threads")


def _cart_pole(count: int, seconds: float) -> None:
    import gymnasium

    env = gymnasium.make("CartPole-v1").unwrapped
    env.reset(seed=0)

    def step(index: int) -> None:
        if env.step(index % 2)[2]:
            env.reset()

    _say_steps(1, _rate(step, seconds), "CartPole-v1 of Gymnasium, one alone")
    vector = gymnasium.make_vec("CartPole-v1", num_envs=count, vectorization_mode="vector_entry_point")
    vector.reset(seed=0)
    actions = np.random.default_rng(0).integers(0, 2, (16, count))
    rate = _rate(lambda index: vector.step(actions[index % 16]), seconds)
    _say_steps(count, rate, f"CartPole-v1 of Gymnasium, vector of {count} in numpy")


def _mujoco(count: int, threads: int, seconds: float) -> None:
    if not importlib.util.find_spec("mujoco"):
        print("MuJoCo is not installed: pip install mujoco")
        return
    mujoco, rollout = importlib.import_module("mujoco"), importlib.import_module("mujoco.rollout")

    model = mujoco.MjModel.from_xml_string(_mujoco_robot())
    steps = round(0.05 / model.opt.timestep)
    controls = np.random.default_rng(0).uniform(-1, 1, (16, count, 1, model.nu)).repeat(steps, axis=2)
    data = mujoco.MjData(model)

    def step(index: int) -> None:
        data.ctrl[:] = controls[index % 16, 0, 0]
        mujoco.mj_step(model, data, steps)

    text = f"robot with {RANGE_FINDERS} range finders in MuJoCo, 50 ms in {steps} steps"
    _say_steps(1, _rate(step, seconds), f"{text}, one alone")
    state = np.zeros((count, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    mujoco.mj_getState(model, data, state[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state[:] = state[0]
    workers = [mujoco.MjData(model) for _ in range(threads)]
    with rollout.Rollout(nthread=threads) as pool:

        def roll(index: int) -> None:
            states, _ = pool.rollout(model, workers, state, controls[index % 16])
            state[:] = states[:, -1]

        _say_steps(count, _rate(roll, seconds), f"{text}, vector of {count}, {threads} threads")


def _mujoco_robot() -> str:
    """A disc of 0.2 m with sensors in eight directions that drives and turns in a room of 4 m with four boxes."""
    boxes = "".join(f'<geom type="box" size=".2 .2 .2" pos="{x} {y} .2"/>' for x in (-1, 1) for y in (-1, 1))
    walls = "".join(
        f'<geom type="box" size="{sx} {sy} .2" pos="{x} {y} .2"/>'
        for x, y, sx, sy in ((-2, 0, 0.05, 2), (2, 0, 0.05, 2), (0, -2, 2, 0.05), (0, 2, 2, 0.05))
    )
    angles = np.arange(RANGE_FINDERS) * 2 * np.pi / RANGE_FINDERS
    sites = "".join(f'<site name="s{index}" zaxis="{np.cos(a):.6f} {np.sin(a):.6f} 0" pos="0 0 .05"/>' for index, a in enumerate(angles))
    sensors = "".join(f'<rangefinder site="s{index}" cutoff="3"/>' for index in range(RANGE_FINDERS))
    return f"""
    <mujoco><option timestep="0.01" gravity="0 0 0"/>
      <worldbody>{walls}{boxes}
        <body pos="0 0 .05">
          <joint name="x" type="slide" axis="1 0 0" damping="1"/><joint name="y" type="slide" axis="0 1 0" damping="1"/>
          <joint name="turn" type="hinge" axis="0 0 1" damping=".1"/>
          <geom type="cylinder" size=".1 .04" mass="1"/><site name="body"/>{sites}
        </body>
      </worldbody>
      <actuator><motor site="body" gear="1 0 0 0 0 0"/><motor site="body" gear="0 0 0 0 0 .05"/></actuator>
      <sensor>{sensors}</sensor>
    </mujoco>"""


def _resets(task: gym.Task, count: int, threads: int, resets: int) -> None:
    """Prints the memory after the first hundredth, after half and after all of the resets."""
    vector = gym.VectorEnv(task, count, threads)
    actions = np.random.default_rng(0).uniform(-1, 1, (count, 2)).astype(np.float32)
    vector.reset(seed=0)
    marks = _marks(resets // count)
    for number in range(resets // count + 1):
        if number in marks:
            print(f"{_resident() / 2**20:14,.1f} MiB after {number * count:,} resets")
        vector.reset()
        vector.step(actions)


def _marks(rounds: int) -> Iterable[int]:
    return {rounds // 100, rounds // 2, rounds}


def _memory(task: gym.Task, count: int) -> None:
    gym.VectorEnv(task, 1)  # what all share
    before = _resident()
    vector = gym.VectorEnv(task, count)
    vector.reset(seed=0)
    vector.step(np.zeros((count, 2), np.float32))
    print(f"{(_resident() - before) / count / 1000:14,.1f} kB an environment, of {count:,} in one process")


def _resident() -> int:
    """Resident memory of this process, bytes."""
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _say_steps(count: int, rates: tuple[float, float], what: str) -> None:
    elapsed, used = (count * rate for rate in rates)
    print(f"{elapsed:14,.0f} steps a second, {used:11,.0f} a second of processor time: {what}", flush=True)


def _say_resets(count: int, rates: tuple[float, float], what: str) -> None:
    elapsed, used = (1e6 / rate / count for rate in rates)
    print(f"{elapsed:14,.1f} us a reset, {used:15,.1f} us of processor time: {what}", flush=True)


def _rate(act: Callable[[int], object], seconds: float) -> tuple[float, float]:
    """Calls of `act` per second of wall-clock time and per second of processor time, measured for `seconds`."""
    start, start_used = time.perf_counter(), time.process_time()
    count = 0
    while (elapsed := time.perf_counter() - start) < seconds:
        act(count)
        count += 1
    return count / elapsed, count / (time.process_time() - start_used)
