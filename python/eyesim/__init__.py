"""eyesim: a simulator for mobile robots, modelled on EyeSim.

`load` opens a scene as a `Simulation`, a value that is stepped, commanded, observed, copied and restored; `run` runs a scene with its
robot programs; `plan` and `case` run the cases of a suite one by one. `eyesim.gym` has learning environments. Lengths are in m, angles in
rad (counter-clockwise), times in s.
"""

from importlib import import_module as _import
from typing import TYPE_CHECKING

from . import _host

if TYPE_CHECKING:
    from ._errors import Diagnostic, Error, ProgramError, SceneError
    from ._run import Run, run
    from ._simulation import Pose, Robot, Simulation, Speed, load
    from ._sweep import Plan, case, plan

__all__ = ["Diagnostic", "Error", "Plan", "Pose", "ProgramError", "Robot", "Run", "SceneError", "Simulation", "Speed"]
__all__ += ["case", "home", "load", "plan", "run"]

# The command and the processes of robots start without numpy: a module that needs numpy is imported when its name is
# first used.
_PLACES = {name: "_errors" for name in ("Diagnostic", "Error", "ProgramError", "SceneError")}
_PLACES |= {name: "_run" for name in ("Run", "run")}
_PLACES |= {name: "_sweep" for name in ("Plan", "case", "plan")}
_PLACES |= {name: "_simulation" for name in ("Pose", "Robot", "Simulation", "Speed", "load")}

home = _host.home
_host.describe()


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(_import(f"{__name__}.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
