"""Functions as robot programs: each robot has its own module `eye`, which calls the simulator on the robot's thread."""

from __future__ import annotations

import ctypes
import io
import os
import random
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from types import CodeType, ModuleType, TracebackType
from typing import Any

from . import _native
from ._errors import Error

EYE = "<eye>"
"""File name in the stack frames of the modules `eye`."""

_OWN_FILES = {EYE, __file__, os.path.join(os.path.dirname(__file__), "eye.py")}
_OK, _STOP = 17, 18
_MAX_REFUSALS = 1000
"""Maximum number of calls of a program that must end but tries to continue."""

_code: CodeType | None = None
_robots: dict[int, _Robot] = {}
"""The robot of each thread that runs a program."""
_drawing: _Robot | None = None
"""The robot whose random stream the module `random` currently uses."""
_runs = threading.Lock()


class _Overdue(BaseException):
    """Ends a program that has not called the simulator in time."""


def new_eye() -> Any:
    """A new module `eye` with its own state."""
    global _code
    if _code is None:
        _code = compile(_native.eye_source(), EYE, "exec")
    module = ModuleType("eye")
    module.__file__ = EYE
    exec(_code, module.__dict__)
    return module


def present_eye() -> Any:
    """The module `eye` of the robot whose program the calling thread runs; `None` on other threads."""
    robot = _robots.get(threading.get_ident())
    return robot.eye if robot else None


class Program:
    """A function as a robot program. The simulator calls `run`, `call_back` and `stop`."""

    def __init__(self, reference: str, name: str, function: Callable[..., object]) -> None:
        """A run refers to the program by `reference`. The function is called with the robot's arguments."""
        self.reference = reference
        self.name = name
        self.function = function
        self.robots: dict[int, _Robot] = {}

    def run(self, number: int, arguments: Sequence[str], calls: _native.Calls) -> int | str:
        """Runs the function for a robot; returns its exit code, or the location at which it was stopped."""
        robot = self.robots[number] = _Robot(calls)
        return robot.run(self.function, arguments)

    def call_back(self, number: int, function: int) -> bool:
        """Calls a function that the robot's program has attached to a timer; returns false if the function raises."""
        robot = self.robots[number]
        robot.draw()
        return bool(robot.eye._called_back(function) == 0)

    def stop(self, number: int) -> None:
        """Ends the program of a robot that computes without calling the simulator."""
        robot = self.robots[number]
        robot.is_overdue = True
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(robot.thread), ctypes.py_object(_Overdue))


class _Robot:
    """A run of a program: the channel of its module `eye`, and its random stream."""

    def __init__(self, calls: _native.Calls) -> None:
        self.thread = threading.get_ident()
        self.error: BaseException | None = None
        self.is_overdue = False
        self.eye: Any = new_eye()
        self.eye._channel = self
        self.eye._own_files = _OWN_FILES
        self.eye._refuse = self._refuse
        # Other threads of this process do not belong to the program.
        self.eye._has_threads = lambda: False
        self.stdin = io.TextIOWrapper(io.BufferedReader(self.eye._Input()), encoding="utf-8", errors="replace")
        self._calls: _native.Calls | None = calls
        self._request = b""
        self._refusals = 0
        self._random: Any = None
        self._stopped_at: str | None = None

    def send(self, kind: int, body: bytes) -> None:
        """Stores a message of the module for `receive`."""
        self._request = body

    def receive(self) -> tuple[int, bytes]:
        """Makes the stored call; returns the kind and the body of the answer."""
        answer = None if self.is_overdue or self._calls is None else self._calls.call(self._request)
        if answer is not None:
            self.draw()
            return _OK, answer
        if self.is_overdue:
            self._refuse()
        return _STOP, b""

    def _refuse(self) -> None:
        self._refusals += 1
        if self._refusals > _MAX_REFUSALS:
            # The program catches the exception that should end it. It is abandoned, and its thread waits without
            # computing.
            threading.Event().wait()
        raise _Overdue if self.is_overdue else self.eye._Stop

    def draw(self) -> None:
        """Switches `random` from another robot's stream to the stream of this robot."""
        global _drawing
        if _drawing is not self and self._random is not None:
            if _drawing is not None:
                _drawing._random = random.getstate()
            random.setstate(self._random)
            _drawing = self

    def run(self, function: Callable[..., object], arguments: Sequence[str]) -> int | str:
        """See `Program.run`."""
        eye = self.eye
        path = getattr(getattr(function, "__code__", None), "co_filename", "")
        _robots[self.thread] = self
        try:
            self._random = random.Random(eye._call(eye._support_random, 1)[0]).getstate()
            self.draw()
            exit_code = int(eye._exit_code_of(lambda: self._call(function, arguments), path))
            if self.error:
                self.error.__traceback__ = _of_program(self.error.__traceback__)
            if self._stopped_at is None:
                for console in eye._consoles:
                    console.finish()
                return exit_code
        except eye._Stop:
            return 0
        except _Overdue as late:
            self._stopped_at = _place(late.__traceback__)
        finally:
            del _robots[self.thread]
            # The calls refer to the program, which refers to this object: a cycle that Python cannot collect.
            self._calls = None
        return self._stopped_at

    def _call(self, function: Callable[..., object], arguments: Sequence[str]) -> None:
        eye = self.eye
        try:
            function(*arguments)
        except (SystemExit, eye._Stop):
            raise
        except _Overdue as late:
            self._stopped_at = _place(late.__traceback__)
        except BaseException as error:
            if not eye._is_stopped:
                self.error = error
            raise


def _of_program(trace: TracebackType | None) -> TracebackType | None:
    """The part of a traceback that starts at the program's first frame."""
    while trace and trace.tb_frame.f_code.co_filename in _OWN_FILES:
        trace = trace.tb_next
    return trace


def _place(trace: TracebackType | None) -> str:
    """File and line of the program's innermost frame; empty if there is none."""
    place = ""
    while trace:
        if trace.tb_frame.f_code.co_filename not in _OWN_FILES:
            place = f"{os.path.basename(trace.tb_frame.f_code.co_filename)}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place


class _Stream:
    """A standard stream; on the thread of a program it is the robot's console."""

    def __init__(self, original: Any, own: Callable[[_Robot], Any]) -> None:
        self._original, self._own = original, own

    def _present(self) -> Any:
        robot = _robots.get(threading.get_ident())
        return self._own(robot) if robot else self._original

    def __getattr__(self, name: str) -> Any:
        return getattr(self._present(), name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._present())


def _surroundings() -> Iterator[tuple[Any, str, Any]]:
    """The names that a run replaces on the threads of programs: owner, name, replacement."""
    for name, own in (
        ("stdin", lambda robot: robot.stdin),
        ("stdout", lambda robot: robot.eye._consoles[0]),
        ("stderr", lambda robot: robot.eye._consoles[1]),
    ):
        yield sys, name, _Stream(getattr(sys, name), own)
    yield time, "sleep", _on_robots(time.sleep, lambda eye, seconds: eye._sleep(seconds))
    for owner, name in ((os, "urandom"), (random, "_urandom")):
        yield owner, name, _on_robots(os.urandom, lambda eye, size: eye._urandom(size))
    for name in new_eye()._CLOCKS:
        yield time, name, _on_robots(getattr(time, name), lambda eye: eye._now_us() / 1e6)
        yield time, f"{name}_ns", _on_robots(getattr(time, f"{name}_ns"), lambda eye: eye._now_us() * 1000)


def _on_robots(original: Callable[..., Any], own: Callable[..., Any]) -> Callable[..., Any]:
    """A function that calls `own` on the threads of programs, with the module `eye` as an additional first argument."""

    def call(*arguments: Any) -> Any:
        eye = present_eye()
        return original(*arguments) if eye is None else own(eye, *arguments)

    return call


@contextmanager
def _replaced(namespace: dict[str, Any], values: dict[str, Any]) -> Iterator[None]:
    """Replaces names of a module temporarily."""
    before = {name: namespace[name] for name in values}
    namespace.update(values)
    try:
        yield
    finally:
        namespace.update(before)


@contextmanager
def running(programs: Sequence[Program]) -> Iterator[None]:
    """Installs virtual time, consoles and random streams of robots for their functions during a run."""
    global _drawing
    if not programs:
        yield
        return
    if not _runs.acquire(blocking=False):
        raise Error("a run with functions as programs is going on in this process already")
    state = random.getstate()
    try:
        with ExitStack() as stack:
            owns = {}
            for owner, name, own in list(_surroundings()):
                owns[id(getattr(owner, name))] = own
                stack.enter_context(_replaced(vars(owner), {name: own}))
            # Names that a program's module has imported, such as `from time import sleep`.
            for module in [getattr(program.function, "__globals__", {}) for program in programs]:
                imported = {name: owns[id(value)] for name, value in module.items() if id(value) in owns}
                stack.enter_context(_replaced(module, imported))
            yield
    finally:
        _drawing = None
        random.setstate(state)
        _runs.release()
