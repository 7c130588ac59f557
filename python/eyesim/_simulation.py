"""Simulations as values."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import Error

if TYPE_CHECKING:
    from ._run import Run

Program = TypeVar("Program")
Floats = npt.NDArray[np.float64]

SOURCE = "scene.scene.toml"
"""Name of a scene that is given as text, in messages; its extension marks it as TOML."""


class Pose(NamedTuple):
    """A pose in the plane, in the world's frame."""

    x: float
    """m"""
    y: float
    """m"""
    phi: float
    """Heading, counter-clockwise from x, -pi to pi, rad."""


class Speed(NamedTuple):
    """A velocity in the robot's frame."""

    v: float
    """Forward, m/s."""
    left: float
    """To the left, m/s."""
    omega: float
    """Turning speed, counter-clockwise, rad/s."""


def source(scene: str | os.PathLike[str]) -> tuple[str, str | None]:
    """Path and text of a scene; an argument with a line break is a text."""
    if isinstance(scene, str) and "\n" in scene:
        is_sim = not any(line.lstrip().startswith("[") for line in scene.splitlines())
        return ("scene.sim" if is_sim else SOURCE), scene
    return os.fspath(scene), None


def noise_of(noise: str | os.PathLike[str] | None) -> str | None:
    """A noise profile as text: a preset or the path of a file."""
    return None if noise is None else os.fspath(noise)


def settings_of(values: dict[str, Any] | None) -> list[str]:
    """Values of a TOML scene in the format of the command line."""
    return [f"{path}={_toml(value)}" for path, value in (values or {}).items()]


def _number(value: Any) -> Any:
    """A number of numpy as a number of Python; raises `TypeError` for other values."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{value!r} is not a number")


def _toml(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        # The escapes of JSON are valid in TOML, but JSON does not escape this control character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{_toml(str(key))} = {_toml(item)}' for key, item in value.items())}}}"
    raise Error(f"set: {value!r} is not a value of TOML; expected a number, a text, a truth value, a list or a dict of these")


def load(
    scene: str | os.PathLike[str],
    *,
    seed: int | None = None,
    noise: str | os.PathLike[str] | None = None,
    slot: float | None = None,
    set: dict[str, Any] | None = None,
) -> Simulation:
    """Opens a scene without its programs.

    `scene` is a path, or a text with line breaks (TOML, or the lines of a sim file). `seed`, `noise` (a preset or a file) and `slot` (s)
    override the scene's; `set` maps paths of values of a scene in TOML to values, such as `{"robot[0].x_mm": 500}`.

    Raises `SceneError` for mistakes in the files and `Error` for wrong arguments.
    """
    path, text = source(scene)
    opened = {"scene": scene, "seed": seed, "noise": noise, "slot": slot, "set": set}
    return Simulation(_native.Simulation(path, text, seed, noise_of(noise), slot, settings_of(set)), opened)


class Simulation:
    """Robots in a world, without programs: the caller steps it, commands its robots and reads their sensors.

    A copy by `snapshot` continues bit-identically to its original, and neither influences the other. While a method works, other
    threads of Python run; one simulation is used by one thread at a time.
    """

    def __init__(self, native: _native.Simulation, opened: dict[str, Any]) -> None:
        """For `load` and `snapshot`."""
        self._native = native
        self._opened = opened
        self._programs: dict[int, Any] = {}

    @property
    def now(self) -> float:
        """Current time, s."""
        return self._native.now

    @property
    def digest(self) -> str:
        """Hash of all events recorded up to the end of the last slot."""
        return self._native.digest

    @property
    def robots(self) -> list[Robot]:
        """The robots, in order of their numbers."""
        return [Robot(self, number) for number in range(1, self._native.robot_count + 1)]

    def robot(self, number: int = 1) -> Robot:
        """Robot `number`, from 1. Raises `IndexError` if there is none."""
        self._native.robot_name(number)
        return Robot(self, number)

    @property
    def objects(self) -> list[Pose]:
        """Poses of the movable objects."""
        return [Pose(*self._native.object_pose(number)) for number in range(1, self._native.object_count + 1)]

    def step(self, seconds: float = 0.05) -> None:
        """Advances the time by `seconds`, rounded up to a microsecond."""
        self._native.step(seconds)

    def act(self, do: str, **values: Any) -> None:
        """Performs an intervention of the window, by its name and values: `act("place_robot", robot=1, x_m=1, y_m=1, phi_rad=0)`.

        The names are those of recorded interventions (docs/trace.md). Raises `Error` for one that is refused; within a slot all are.
        """
        try:
            text = json.dumps({"do": do, **values}, default=_number, allow_nan=False)
        except (TypeError, ValueError):
            raise Error(f"{do}: expected texts, truth values and finite numbers, not {values}") from None
        self._native.act(text)

    def observe(self) -> dict[str, Any]:
        """All values except camera images: the time, the poses, speed, contacts and range readings of each robot, and the objects."""
        return {"now": self.now, "robots": [robot.observe() for robot in self.robots], "objects": self.objects}

    def snapshot(self) -> Simulation:
        """A copy of the whole state, with the robots' programs."""
        copy = Simulation(self._native.snapshot(), self._opened)
        copy._programs = dict(self._programs)
        return copy

    __copy__ = snapshot

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulation:
        return self.snapshot()

    def restore(self, snapshot: Simulation) -> None:
        """Restores the state of `snapshot`, with its robots' programs; `snapshot` does not change."""
        if snapshot is self:
            return
        self._native.restore(snapshot._native)
        self._opened, self._programs = snapshot._opened, dict(snapshot._programs)

    def run(self, **options: Any) -> Run:
        """Runs the scene from its beginning with the robots' programs, as `eyesim.run` does with these options.

        The programs are set by `Robot.program`, otherwise by the scene; seed, noise, slot and values are the ones given to `load`. This
        simulation is not changed. Raises the exceptions of `eyesim.run`.
        """
        from ._run import run

        return run(**{**self._opened, "programs": self._programs or None, **options})

    def svg(self) -> str:
        """The current state seen from above, as SVG."""
        return self._native.svg()

    def plot(self) -> Picture:
        """The current state seen from above, as a picture that a notebook shows."""
        return Picture(self.svg())

    def _repr_svg_(self) -> str:
        return self.svg()

    def __repr__(self) -> str:
        return f"<eyesim.Simulation at {self.now} s, {self._native.robot_count} robots>"


class Robot:
    """A robot of a simulation. Commands take effect, and readings are taken, at the simulation's current time."""

    def __init__(self, simulation: Simulation, number: int) -> None:
        """For `Simulation.robot`."""
        self._native = simulation._native
        self.simulation = simulation
        self.number = number

    @property
    def name(self) -> str:
        """Name of the robot's type."""
        return self._native.robot_name(self.number)

    @property
    def pose(self) -> Pose:
        """True pose of the centre."""
        return Pose(*self._native.pose(self.number))

    @property
    def odometry(self) -> Pose:
        """Pose by odometry, in the frame of the start."""
        return Pose(*self._native.odometry(self.number))

    @property
    def speed(self) -> Speed:
        """Velocity derived from the wheels."""
        return Speed(*self._native.speed(self.number))

    @property
    def max_speed(self) -> float:
        """Maximum speed, m/s."""
        return self._native.limits(self.number)[0]

    @property
    def max_turn(self) -> float:
        """Maximum turning speed, rad/s."""
        return self._native.limits(self.number)[1]

    @property
    def contacts(self) -> int:
        """Number of contacts that have begun so far."""
        return self._native.contacts(self.number)[0]

    @property
    def is_stalled(self) -> bool:
        """True if the robot is stalled: it is commanded to drive but cannot move."""
        return self._native.contacts(self.number)[1]

    @property
    def range_sensors(self) -> dict[str, float]:
        """Range of each range sensor, m, by its name, in the order of `ranges`."""
        return dict(self._native.range_sensors(self.number))

    def ranges(self, out: Floats | None = None) -> Floats:
        """Readings of the range sensors with their noise, m; infinite if nothing is within range. Fills `out` if it is given."""
        out = np.empty(len(self._native.range_sensors(self.number))) if out is None else out
        self._native.ranges(self.number, out)
        return out

    def image(self, width: int = 320, height: int = 240) -> npt.NDArray[np.uint8]:
        """Takes a colour image: rows from the top, columns, and red, green and blue from 0 to 255.

        It shows the world 16.667 ms ago, has the camera's noise, and is counted and recorded like an image of a program. Raises `Error` for a robot
        without a camera.
        """
        out = np.empty((height, width, 3), np.uint8)
        self._native.image(self.number, (width, height), out)
        return out

    def depth(self) -> npt.NDArray[np.float32]:
        """Depth of each pixel of the last image, m along the line of sight; infinite for the sky. Raises `Error` before an image."""
        out = np.empty(self._last_shape(), np.float32)
        self._native.depth(self.number, out)
        return out

    def labels(self) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint32]]:
        """For each pixel of the last image: the kind of the visible surface or body, and its number within the kind.

        Kinds: 0 sky, 1 ground, 2 wall (its index in the world's file, from 0), 3 fixed object (its index among all objects of the
        scene, from 0), 4 movable object and 5 robot (their numbers, from 1). Raises `Error` before an image.
        """
        kinds, numbers = np.empty(self._last_shape(), np.uint8), np.empty(self._last_shape(), np.uint32)
        self._native.labels(self.number, kinds, numbers)
        return kinds, numbers

    def drive(self, v: float, omega: float = 0.0) -> None:
        """Drives at `v` m/s and turns at `omega` rad/s until the next command, within the robot's limits."""
        self._native.drive(self.number, v, omega)

    def go(self, length: float, angle: float = 0.0, seconds: float = 0.0) -> None:
        """Drives a line, an arc or a turn of `length` m and `angle` rad and stops there, in `seconds` or as fast as it can."""
        self._native.go(self.number, length, angle, seconds)

    def wheels(self, *rates: float) -> None:
        """Turns the motors at these rates, rad/s, in the order of the drive."""
        self._native.wheels(self.number, list(rates))

    def halt(self) -> None:
        """Stops all motors."""
        self._native.halt(self.number)

    @property
    def is_done(self) -> bool:
        """True if the last `go` has ended."""
        return self._native.is_done(self.number)

    def program(self, program: Program) -> Program:
        """Sets this robot's program for `Simulation.run`: a file, or a function that calls those of `eyesim.eye`. Returns the program."""
        self.simulation._programs[self.number] = program
        return program

    def observe(self) -> dict[str, Any]:
        """Poses, speed, contacts and range readings."""
        return {
            "pose": self.pose,
            "odometry": self.odometry,
            "speed": self.speed,
            "contacts": self.contacts,
            "is_stalled": self.is_stalled,
            "ranges": self.ranges(),
        }

    def _last_shape(self) -> tuple[int, int]:
        width, height = self._native.image_size(self.number) or (0, 0)
        return height, width

    def __repr__(self) -> str:
        return f"<eyesim.Robot {self.number} ({self.name}) at {self.pose}>"


class Picture:
    """A picture that a notebook shows."""

    def __init__(self, svg: str) -> None:
        """From SVG text."""
        self.svg = svg

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture as an SVG file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)

    def _repr_svg_(self) -> str:
        return self.svg
