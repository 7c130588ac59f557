"""Environments for Gymnasium: `Env` around any scene with one robot, `VectorEnv` for many at once, and tasks that are ready to use.

The import registers `eyesim/WallFollow-v0`; `gymnasium.make("eyesim.gym:eyesim/WallFollow-v0")` imports it.

An environment of n simulations calls the functions of its `Task` with arrays of n rows, `Env` with one row; so a task is written once.

- **Fresh starts.** Each episode begins as a new simulation of the scene, without any state of the previous one.
- **Seeds.** Episode e of an environment that was reset with seed s depends only on s and e. Simulation i of a `VectorEnv` that was
  reset with seed s has the episodes of an `Env` that was reset with s + i, whatever the number of simulations.
- **Ends.** `terminated` is the task's; `truncated` is its time limit.
- **Autoreset.** `VectorEnv` resets in the step that follows an end (`AutoresetMode.NEXT_STEP`): that step's action is not used, its reward
  is 0, and its observation is the first one of the new episode.
"""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space

from . import _native
from ._simulation import Floats, load

Observations = npt.NDArray[np.float32]
Flags = npt.NDArray[np.bool_]


class Readings(NamedTuple):
    """Observations of n robots after a step, one row each."""

    ranges: Floats
    """Readings of the range sensors, m, n x sensors; infinite where nothing is within range."""
    reach: Floats
    """Range of each sensor, m, n x sensors."""
    pose: Floats
    """True pose: x, y (m), heading (rad), n x 3."""
    speed: Floats
    """Forward speed derived from the wheels, m/s, n."""
    turn: Floats
    """Turning speed derived from the wheels, rad/s, n."""
    touched: Flags
    """True where a contact has begun in this step, n."""
    stalled: Flags
    """True where a robot is stalled, n."""
    steps: npt.NDArray[np.int64]
    """Steps of the episode so far, n."""


@dataclass(frozen=True)
class Limits:
    """Maximum speeds of n robots."""

    speed: Floats
    """m/s, n."""
    turn: Floats
    """rad/s, n."""


def relative_ranges(readings: Readings) -> Observations:
    """Range readings as fractions of the sensors' ranges, 0 to 1; 1 where nothing is within range."""
    parts = np.minimum(readings.ranges, readings.reach) / np.maximum(readings.reach, 1e-9)
    return cast(Observations, parts.astype(np.float32))


def relative_twist(actions: npt.NDArray[Any], limits: Limits) -> Floats:
    """Speed and turning speed from fractions of the maximum ones, -1 to 1; values beyond are clipped."""
    return cast(Floats, np.minimum(np.maximum(actions, -1.0), 1.0) * np.column_stack((limits.speed, limits.turn)))


def no_reward(readings: Readings, actions: npt.NDArray[Any]) -> Floats:
    """0 for every step."""
    return np.zeros(len(readings.speed))


def is_touching(readings: Readings) -> Flags:
    """True where a contact has begun in this step: the episode ends at its first contact."""
    return readings.touched


@dataclass(frozen=True)
class Task:
    """A scene, with functions for observations, commands and rewards."""

    scene: str | os.PathLike[str]
    """Path or text, as for `eyesim.load`."""
    observe: Callable[[Readings], npt.NDArray[Any]] = relative_ranges
    """Observations, a row for each robot."""
    act: Callable[[npt.NDArray[Any], Limits], Floats] = relative_twist
    """Speed (m/s) and turning speed (rad/s) of each robot, n x 2, from actions."""
    reward: Callable[[Readings, npt.NDArray[Any]], Floats] = no_reward
    """Reward of each robot for the step."""
    terminated: Callable[[Readings], Flags] = is_touching
    """True where the episode has ended."""
    horizon: int = 1000
    """Steps after which an episode is truncated."""
    period: float = 0.05
    """Simulated seconds of a step."""
    observation_space: spaces.Box | None = None
    """Space of a robot's observation; by default 0 to 1 for `relative_ranges`, otherwise unbounded."""
    action_space: spaces.Space[Any] | None = None
    """Space of a robot's action; by default two numbers from -1 to 1."""
    starts: Sequence[tuple[float, float, float]] = ()
    """Poses (m, m, rad) from which an episode draws one for each robot; by default robots start as in the scene."""
    jitter: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Maximum deviation from the start in x, y (m) and heading (rad), drawn for each episode."""
    noise: str | os.PathLike[str] | None = None
    """Noise profile: none, mild, real, harsh, course or a file; by default the scene's."""


_BEGIN, _REST = 1, 2
"""Kinds of step of a simulation other than 0, which drives."""


class Rows:
    """Simulations of a task side by side: arrays of readings with a row for each robot of each simulation."""

    def __init__(self, task: Task, count: int, threads: int | None = None) -> None:
        if not np.isfinite([number for start in task.starts for number in start]).all():
            raise ValueError(f"starts: {task.starts}: expected finite numbers")
        if not all(0 <= deviation < np.inf for deviation in task.jitter):
            raise ValueError(f"jitter: {task.jitter}: expected finite numbers from 0 on")
        self.task = task
        self.count = count
        self.simulation = load(task.scene, noise=task.noise)
        native = self.simulation._native
        self.batch = _native.Batch(native, count, list(task.starts), task.jitter, threads)
        self.robots, sensors = self.batch.shape
        self.limits = Limits(*np.tile([native.limits(number) for number in range(1, self.robots + 1)], (count, 1)).T)
        self._reach = np.tile(np.array(self.batch.reach()).reshape(self.robots, sensors), (count, 1))
        self._still = np.zeros((count * self.robots, 2))
        self._drive = np.zeros(count, np.uint8)
        self._begin = np.full(count, _BEGIN, np.uint8)
        self.action_space = task.action_space or spaces.Box(-1.0, 1.0, (2,), np.float32)
        if task.act is relative_twist and self.action_space.shape != (2,):
            raise ValueError(f"action_space: {self.action_space}: the default `act` needs two numbers; give an `act` for this space")
        self.observation_space = task.observation_space or self._observation_space(sensors)
        self.seed(int(np.random.SeedSequence().generate_state(1, np.uint64)[0]))

    def _observation_space(self, sensors: int) -> spaces.Box:
        if self.task.observe is relative_ranges:
            return spaces.Box(0.0, 1.0, (sensors,), np.float32)
        shape = np.shape(self.task.observe(self.begin()))[1:]
        return spaces.Box(-np.inf, np.inf, shape, np.float32)

    def seed(self, seed: int | Sequence[int | None] | None) -> None:
        """Seeds all simulations: the first with `seed`, the next with `seed + 1` and so on, or each with a given seed."""
        if seed is None:
            return
        if not isinstance(seed, (Sequence, np.ndarray)):
            first = operator.index(seed)
            seed = [first + index for index in range(self.count)]
        seeds = [own if own is None else operator.index(own) for own in seed]
        if len(seeds) != self.count:
            raise ValueError(f"{len(seeds)} seeds for {self.count} simulations: expected one for each")
        for index, own in enumerate(seeds):
            if own is not None:
                self.batch.seed(index, own % 2**64)

    def begin(self, begins: npt.NDArray[np.uint8] | None = None) -> Readings:
        """Begins new episodes in the marked simulations, by default in all; other simulations do not change."""
        parts = self._begin if begins is None else np.where(begins, _BEGIN, _REST).astype(np.uint8)
        return self._step(self._still, parts)

    def step(self, commands: Floats, begins: npt.NDArray[np.uint8] | None = None) -> Readings:
        """Steps all simulations; marked simulations begin a new episode instead."""
        return self._step(np.ascontiguousarray(commands, np.float64), self._drive if begins is None else begins)

    def _step(self, commands: Floats, parts: npt.NDArray[np.uint8]) -> Readings:
        rows, sensors = self._reach.shape
        numbers = np.empty((rows, sensors + 5))
        flags = np.empty((rows, 2), np.uint8)
        steps = np.empty(self.count, np.int64)
        self.batch.step(self.task.period, commands, parts, numbers, flags, steps)
        is_flagged = flags.view(np.bool_)
        return Readings(
            ranges=numbers[:, :sensors],
            reach=self._reach,
            pose=numbers[:, sensors : sensors + 3],
            speed=numbers[:, sensors + 3],
            turn=numbers[:, sensors + 4],
            touched=is_flagged[:, 0],
            stalled=is_flagged[:, 1],
            steps=steps if self.robots == 1 else np.repeat(steps, self.robots),
        )

    def observations(self, readings: Readings) -> npt.NDArray[Any]:
        """The task's observations, in the data type of their space."""
        rows = self._rows("observe", self.task.observe(readings), self.observation_space.shape)
        return rows.astype(self.observation_space.dtype, copy=False)

    def commands(self, actions: npt.NDArray[Any]) -> Floats:
        """The task's commands for the actions."""
        if self.action_space.shape is not None:
            self._rows("actions", actions, self.action_space.shape)
        return self._rows("act", self.task.act(actions, self.limits), (2,))

    def rewards(self, readings: Readings, actions: npt.NDArray[Any]) -> Floats:
        """The task's rewards."""
        return self._rows("reward", self.task.reward(readings, actions), ())

    def terminated(self, readings: Readings) -> Flags:
        """True where the task's episode has ended."""
        return self._rows("terminated", self.task.terminated(readings), ()).astype(np.bool_, copy=False)

    def _rows(self, name: str, values: Any, shape: tuple[int, ...]) -> npt.NDArray[Any]:
        """The values as an array. Raises `ValueError` unless it has a row of this shape for each robot."""
        rows, expected = np.asarray(values), (self.count * self.robots, *shape)
        if rows.shape != expected:
            raise ValueError(f"{name}: an array of shape {rows.shape}: expected {expected}, a row for each robot")
        return rows


def _task(scene: str | os.PathLike[str] | Task, options: dict[str, Any]) -> Task:
    return replace(scene, **options) if isinstance(scene, Task) else Task(scene, **options)


def _of_one_robot(rows: Rows) -> Rows:
    if rows.robots != 1:
        raise ValueError(f"the scene has {rows.robots} robots, expected one: see eyesim.pettingzoo for more")
    return rows


class Env(gymnasium.Env[npt.NDArray[Any], npt.NDArray[Any]]):
    """One robot in a scene: `Env(scene, observe=..., act=..., reward=...)`; the options are the same as for `Task`."""

    metadata = {"render_modes": []}

    def __init__(self, scene: str | os.PathLike[str] | Task, render_mode: None = None, **options: Any) -> None:
        """From a scene's path or text, or from a task."""
        self.task = _task(scene, options)
        self.render_mode = render_mode
        self._rows = _of_one_robot(Rows(self.task, 1, threads=1))
        self.observation_space = self._rows.observation_space
        self.action_space = self._rows.action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[npt.NDArray[Any], dict[str, Any]]:
        """Begins the next episode; with `seed`, the first one of that seed."""
        if seed is not None:
            super().reset(seed=seed)
            self._rows.seed(seed)
        return self._rows.observations(self._rows.begin())[0], {}

    def step(self, action: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], float, bool, bool, dict[str, Any]]:
        """Drives for one period."""
        actions = np.asarray(action)[None]
        readings = self._rows.step(self._rows.commands(actions))
        terminated = bool(self._rows.terminated(readings)[0])
        truncated = bool(readings.steps[0] >= self.task.horizon)
        reward = float(self._rows.rewards(readings, actions)[0])
        return self._rows.observations(readings)[0], reward, terminated, truncated, {}

    @property
    def digest(self) -> str:
        """Hash of all events recorded in this episode."""
        return self._rows.batch.digest(0)


class VectorEnv(gymnasium.vector.VectorEnv[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]]):
    """Many robots, each in its own scene; one call steps all of them on several threads. See the module for seeds and autoreset."""

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        scene: str | os.PathLike[str] | Task,
        num_envs: int = 1,
        threads: int | None = None,
        render_mode: None = None,
        **options: Any,
    ) -> None:
        """From a scene's path or text, or from a task; by default with a thread for each core."""
        self.task = _task(scene, options)
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._rows = _of_one_robot(Rows(self.task, num_envs, threads))
        self.single_observation_space = self._rows.observation_space
        self.single_action_space = self._rows.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._done = np.zeros(num_envs, np.uint8)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[npt.NDArray[Any], dict[str, Any]]:
        """Begins the next episode of each simulation; with `seed`, the first ones of these seeds."""
        super().reset(seed=seed if isinstance(seed, int) else None)
        self._rows.seed(seed)
        self._done[:] = 0
        return self._rows.observations(self._rows.begin()), {}

    def step(
        self, actions: npt.NDArray[Any]
    ) -> tuple[npt.NDArray[Any], Floats, Flags, Flags, dict[str, Any]]:
        """Drives all robots for one period; robots whose episode has ended begin the next one."""
        actions = np.asarray(actions)
        begins = self._done
        readings = self._rows.step(self._rows.commands(actions), begins)
        going = begins == 0
        terminated = self._rows.terminated(readings) & going
        truncated = (readings.steps >= self.task.horizon) & going
        reward = np.where(going, self._rows.rewards(readings, actions), 0.0)
        self._done = (terminated | truncated).astype(np.uint8)
        return self._rows.observations(readings), reward, terminated, truncated, {}

    def digest(self, index: int) -> str:
        """Hash of all events recorded in the current episode of simulation `index`."""
        return self._rows.batch.digest(index)


def _wall_follow(**options: Any) -> Env:
    return Env(WALL_FOLLOW, **options)


def _wall_follow_vector(num_envs: int = 1, **options: Any) -> VectorEnv:
    return VectorEnv(WALL_FOLLOW, num_envs, **options)


WALL_SCENE = """
[world]
file = "%sim%/worlds/obstacles.wld"

[[robot]]
type = "%sim%/robis/ring.robi"
x_mm = 700
y_mm = 350
heading_deg = 180
"""

_KEPT = 0.3
"""Distance to the wall with the maximum reward, m."""
_LEFT = 2, 3
"""The sensors of the robot `Ring` that point to the left."""


def _wall_reward(readings: Readings, actions: npt.NDArray[Any]) -> Floats:
    distance = np.minimum(*(readings.ranges[:, sensor] for sensor in _LEFT))
    closeness = np.exp(-(((np.minimum(distance, 9.0) - _KEPT) / 0.15) ** 2))
    return cast(Floats, readings.speed / 0.6 * closeness - 10.0 * readings.touched)


WALL_FOLLOW = Task(
    WALL_SCENE,
    reward=_wall_reward,
    horizon=600,
    starts=[
        (0.7, 0.35, np.pi),
        (3.2, 0.35, np.pi),
        (0.35, 1.0, np.pi / 2),
        (0.35, 2.2, np.pi / 2),
        (3.65, 3.0, -np.pi / 2),
        (3.65, 1.5, -np.pi / 2),
    ],
    jitter=(0.05, 0.05, 0.2),
    noise="mild",
)
"""`eyesim/WallFollow-v0`: a robot with eight range sensors follows the wall on its left for 30 s.

Reward of a step: (v / 0.6) exp(-((d - 0.3) / 0.15)^2), where v is the speed in m/s and d the smaller of the two readings to
the left in m; minus 10 if a contact begins, which ends the episode.
"""

gymnasium.register("eyesim/WallFollow-v0", entry_point=_wall_follow, vector_entry_point=_wall_follow_vector)
