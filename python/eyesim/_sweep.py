"""Cases of a suite one by one, for engines that run functions on many machines, such as Ray and Dask."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

from . import _host
from ._errors import Error


class Plan(Mapping[str, str]):
    """The cases of a suite: a name for each row key, in the order of the suite.

    A plan can be pickled. It contains no files: where a case runs, the suite must be at the same path.
    """

    suite: str
    """Path of the suite from `folder`."""
    folder: Path
    """The working folder in which the plan was made."""
    digest: str
    """Hash of all keys."""

    def __init__(self, suite: str, folder: Path, names: dict[str, str]) -> None:
        """For `plan`."""
        self.suite, self.folder, self._names = suite, folder, names
        self.digest = hashlib.sha256("".join(names).encode()).hexdigest()

    def __getitem__(self, key: str) -> str:
        return self._names[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<eyesim.Plan of {self.suite}: {len(self)} cases>"


def plan(suite: str | os.PathLike[str]) -> Plan:
    """Reads a suite and builds its programs, as `eyesim sweep plan` does.

    Raises `Error` if a case cannot be run, with the mistakes in its files or the compiler's messages.
    """
    path, folder = os.fspath(suite), Path.cwd()
    words = [*_host.command(), "sweep", "plan", path]
    ran = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8")
    if ran.returncode != 0:
        raise Error(ran.stderr.strip().removeprefix("error: "))
    cases = map(json.loads, ran.stdout.splitlines())
    return Plan(path, folder, {case["key"]: case["case"] for case in cases})


def case(plan: Plan, key: str) -> dict[str, Any]:
    """Runs a case and returns its row, as in `eyesim sweep`.

    The first call in a process starts a separate eyesim process, which runs this and the following cases of the plan, isolated from each
    other; so a program cannot harm the caller. Threads that call concurrently have one process each.

    Raises `Error` if the plan has no such key, or if the case has a different key here, because the suite, its files or the version of
    eyesim differ from the plan's. A case that could not be run is a row with the outcome `error`.
    """
    if key not in plan:
        raise Error(f"the plan has no key `{key}`")
    place = (os.getpid(), plan.suite, plan.folder, plan.digest)
    try:
        runner = _idle.setdefault(place, []).pop()
    except IndexError:
        runner = _Runner(plan)
    try:
        row = runner.row(plan[key] if plan[key].isprintable() else key)
    except BaseException:
        runner.end()
        raise
    if row["key"] != key and row["outcome"] != "error":
        runner.end()
        raise Error(f"the case `{plan[key]}` has the key {row['key']} here: files or version are not those of the plan")
    _idle[place].append(runner)
    return row


class _Runner:
    """A process that runs cases of a plan; it ends with this process."""

    def __init__(self, plan: Plan) -> None:
        self._messages = tempfile.TemporaryFile("w+", encoding="utf-8")
        words = [*_host.command(), "sweep", "case", plan.suite, "-"]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self._messages}
        self._process = subprocess.Popen(words, cwd=plan.folder, encoding="utf-8", **pipes)  # type: ignore[call-overload]

    def row(self, word: str) -> dict[str, Any]:
        try:
            self._process.stdin.write(word + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            self._process.wait()
            self._messages.seek(0)
            message = self._messages.read().strip().removeprefix("error: ")
            raise Error(message or f"the process that runs cases ended with exit code {self._process.returncode}")
        return cast("dict[str, Any]", json.loads(line))

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        self._process.stdin.close()
        self._process.stdout.close()
        self._messages.close()


_idle: dict[tuple[int, str, Path, str], list[_Runner]] = {}
"""Processes that wait for a case, by the id of the process that started them, and by their plan. A forked process starts its own."""
