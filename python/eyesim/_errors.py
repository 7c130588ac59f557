"""Errors of eyesim."""

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ._run import Run


class Diagnostic(NamedTuple):
    """A mistake in a file."""

    severity: str
    """`error` or `warning`."""
    code: str
    """Kind of the mistake, which `eyesim explain` describes."""
    file: str
    line: int
    """Line from 1; 0 for a file as a whole."""
    column: int
    """Column in characters, from 1."""
    message: str
    expected: str

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        expected = f"; expected {self.expected}" if self.expected else ""
        return f"{place}: {self.severity}[{self.code}]: {self.message}{expected}"


def warn(rows: Sequence[tuple[str, str, str, int, int, str, str]]) -> None:
    """Issues a warning for each mistake in the files of a scene, at the line that calls `load` or `run`."""
    for row in rows:
        warnings.warn(str(Diagnostic(*row)), stacklevel=3)


class Error(Exception):
    """A wrong argument, or a run that is impossible."""


class ProgramError(Error):
    """A function that was a robot's program has failed; `__cause__` is the exception that it raised, if any."""

    robot: int
    """Number of the robot."""
    run: "Run"
    """The run, which continued to its end without that robot."""

    def __init__(self, robot: int, reason: str, run: "Run") -> None:
        super().__init__(f"robot {robot}: {reason}")
        self.robot, self.reason, self.run = robot, reason, run

    def __reduce__(self) -> tuple[type["ProgramError"], tuple[int, str, "Run"]]:
        return ProgramError, (self.robot, self.reason, self.run)


class SceneError(Error):
    """Mistakes in the files of a scene."""

    diagnostics: list[Diagnostic]
    """All mistakes, including warnings."""
    file: str
    """File of the first error."""
    line: int
    """Line of the first error, from 1; 0 for the file as a whole."""
    column: int
    """Column of the first error in characters, from 1."""

    def __init__(self, diagnostics: Sequence[tuple[str, str, str, int, int, str, str]]) -> None:
        self.diagnostics = [Diagnostic(*row) for row in diagnostics]
        errors = [it for it in self.diagnostics if it.severity == "error"] or self.diagnostics
        self.file, self.line, self.column = errors[0].file, errors[0].line, errors[0].column
        super().__init__("\n".join(map(str, errors)))

    def __reduce__(self) -> tuple[type["SceneError"], tuple[list[Diagnostic]]]:
        return SceneError, (self.diagnostics,)
