"""The interpreter as the simulator's host: the commands that the simulator starts for robots, and the files of the package."""

import importlib.util
import os
import sys
import sysconfig
from pathlib import Path

from . import _native


def home() -> Path:
    """The folder for `%sim%`, with worlds, robis, sims and example programs; `$EYESIM_HOME` overrides it."""
    named = os.environ.get("EYESIM_HOME")
    return Path(named) if named else _own_home()


def zig() -> list[str]:
    """The compiler of the package `ziglang`, as a list of one word; empty if it is not installed."""
    package = importlib.util.find_spec("ziglang")
    found = [Path(folder) / "zig" for folder in (package and package.submodule_search_locations or ())]
    return [str(path) for path in found if path.is_file()]


def script() -> Path:
    """The file of the command `eyesim`."""
    beside = Path(sys.executable).parent / "eyesim"
    return beside if beside.exists() else Path(sysconfig.get_path("scripts")) / "eyesim"


def command() -> list[str]:
    """Command line that starts the command `eyesim`."""
    return [sys.executable, "-P", "-m", "eyesim"]


def describe() -> None:
    """Describes this process to the simulator."""
    installer = f"{sys.executable} -m pip install 'eyesim-robots[c]'"
    _native.describe_host(command(), script(), _own_home(), Path(sys.executable), zig(), installer)


def _own_home() -> Path:
    package = Path(__file__).resolve().parent
    installed = package / "home"
    # A checkout in which the package was built in place has the same folders two levels above.
    return installed if installed.is_dir() else package.parent.parent
