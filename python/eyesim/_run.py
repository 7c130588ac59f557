"""Runs of scenes with robot programs."""

from __future__ import annotations

import importlib
import importlib.util
import json
import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._callable import Program, running
from ._errors import Error, ProgramError
from ._simulation import Picture, noise_of, settings_of, source

Code = str | os.PathLike[str] | Callable[..., object]
"""A robot's program: a file, or a function."""


def run(
    scene: str | os.PathLike[str],
    *,
    programs: Code | Mapping[int, Code] | None = None,
    seed: int | None = None,
    noise: str | os.PathLike[str] | None = None,
    slot: float | None = None,
    until: float | None = None,
    arguments: Mapping[int, str] | str | None = None,
    keys: Sequence[str] | str = (),
    set: dict[str, Any] | None = None,
    exec: str = "auto",
    workers: int | None = None,
    timeout: float | None = None,
    trace: bool = True,
) -> Run:
    """Runs a scene with its programs to its end, as `eyesim run` does.

    `scene` is a path, or a text with line breaks. `programs` is a program for the robots without one, or a dictionary from robot numbers
    to programs: files, or functions that call `eyesim.eye` and receive the words of `arguments`. `until` is the simulated time (s) at
    which the run ends. The other parameters are the options of `eyesim run` with the same names. Without `trace` the events are not kept.

    A failure of a file's program is a result, and is in the report. Raises `SceneError` for mistakes in the files, `Error` for wrong arguments
    and for programs that cannot be found or built, and after the run `ProgramError` for the first robot whose function has failed.
    """
    path, text = source(scene)
    functions: dict[Callable[..., object], Program] = {}
    programs = _named(programs, functions)
    if functions and workers not in (None, 1):
        raise Error(f"workers = {workers}: functions run one at a time, so expected 1")
    options: _native.RunOptions = {
        "seed": seed,
        "noise": noise_of(noise),
        "slot": slot,
        "until": until,
        "programs": _by_robot(programs, "="),
        "arguments": _by_robot(arguments, ":"),
        "keys": [keys] if isinstance(keys, str) else list(keys),
        "settings": settings_of(set),
        "exec": exec,
        "workers": 1 if functions else workers,
        "timeout": timeout,
        "functions": [(program.reference, program.name, program) for program in functions.values()],
    }
    with running(list(functions.values())):
        report, lines, svg = _native.run(path, text, options, trace)
    ended = Run(json.loads(report), lines, svg)
    _raise_failure(ended, list(functions.values()))
    return ended


def _named(programs: Code | Mapping[int, Code] | None, functions: dict[Callable[..., object], Program]) -> Any:
    """The programs, in which names replace functions; the functions are added to `functions`."""
    if isinstance(programs, Mapping):
        return {robot: _named(program, functions) for robot, program in programs.items()}
    if not callable(programs):
        return programs
    if programs not in functions:
        name = getattr(programs, "__name__", type(programs).__name__)
        count = sum(program.name == name for program in functions.values())
        functions[programs] = Program(f"{name}() {count + 1}" if count else f"{name}()", name, programs)
    return functions[programs].reference


def _raise_failure(ended: Run, programs: Sequence[Program]) -> None:
    robots = {number: robot for program in programs for number, robot in program.robots.items()}
    for told in ended.report["robots"]:
        if told["id"] in robots and told["outcome"] in ("failed", "timeout"):
            raise ProgramError(told["id"], told.get("reason") or told["outcome"], ended) from robots[told["id"]].error


def _by_robot(values: object, between: str) -> list[str]:
    if values is None:
        return []
    if isinstance(values, Mapping):
        return [f"{robot}{between}{os.fspath(value)}" for robot, value in values.items()]
    return [os.fspath(values)]  # type: ignore[call-overload]


class Run:
    """A finished run: its report, its events and its picture."""

    report: dict[str, Any]
    """The report, see docs/report.md."""

    def __init__(self, report: dict[str, Any], lines: bytes, svg: str) -> None:
        """For `run`."""
        self.report = report
        self._lines = lines
        self._svg = svg

    @property
    def digest(self) -> str:
        """Hash of all recorded events of the run."""
        return str(self.report["digest"])

    @property
    def trace(self) -> bytes:
        """The trace, a JSON object on each line, as in docs/trace.md; empty without `trace`."""
        return self._lines

    @cached_property
    def events(self) -> list[dict[str, Any]]:
        """All events in order of time."""
        objects = map(json.loads, self._lines.splitlines())
        return [it for it in objects if it["event"] not in ("header", "slot", "end")]

    def columns(self, kind: str = "pose", robot: int | None = None) -> dict[str, npt.NDArray[Any]]:
        """Events of one kind as arrays by the names of their fields, in order of time: `columns("pose")["x_m"]`."""
        rows = self._rows(kind, robot)
        names = list(dict.fromkeys(name for row in rows for name in row))
        return {name: _column([row.get(name) for row in rows]) for name in names}

    def table(self, kind: str = "pose", robot: int | None = None) -> Any:
        """Events of one kind as a data frame of polars, otherwise of pandas; raises `ImportError` if neither is installed."""
        rows = self._rows(kind, robot)
        if importlib.util.find_spec("polars"):
            # The types of columns depend on all rows, since values may be null.
            return importlib.import_module("polars").DataFrame(rows, infer_schema_length=None)
        return importlib.import_module("pandas").DataFrame(rows)

    def _rows(self, kind: str, robot: int | None) -> list[dict[str, Any]]:
        rows = [it for it in self.events if it["event"] == kind and robot in (None, it.get("robot"))]
        return [{name: value for name, value in row.items() if name != "event"} for row in rows]

    def plot(self) -> Picture:
        """The world and the robots' paths seen from above, as a picture that a notebook shows."""
        return Picture(self._svg)

    def _repr_svg_(self) -> str:
        return self._svg

    def __repr__(self) -> str:
        outcomes = ", ".join(f"r{robot['id']} {robot['outcome']}" for robot in self.report["robots"])
        return f"<eyesim.Run of {self.report['sim_time_s']} s: {outcomes}>"


def _column(values: list[Any]) -> npt.NDArray[Any]:
    is_plain = all(isinstance(value, (int, float, str, bool)) for value in values)
    if is_plain and values:
        return np.array(values)
    column = np.empty(len(values), object)
    column[:] = values
    return column
