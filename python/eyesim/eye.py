"""RoBIOS-7 for functions as robot programs: `from eyesim.eye import *`.

Functions and constants are those of programs in files, which write `from eye import *`; that works here too, once this module has been
imported. On the thread of a robot's program they act on that robot. See docs/python.md and docs/python-package.md.
"""

import functools as _functools
import sys as _sys
from typing import Any as _Any

from . import _callable

_outside = _callable.new_eye()
"""Attributes outside a run: constants, and functions that raise an exception, since there is no simulator."""

__all__ = list(_outside.__all__)


def _present() -> _Any:
    return _callable.present_eye() or _outside


def _forward(name: str, function: _Any) -> _Any:
    @_functools.wraps(function)
    def call(*arguments: _Any, **named: _Any) -> _Any:
        return getattr(_present(), name)(*arguments, **named)

    return call


class _Library:
    """Stand-in for EyeSim VR's library, which programs load with ctypes."""

    def __getattr__(self, name: str) -> _Any:
        return getattr(_present().lib, name)

    __getitem__ = __getattr__


for _name in __all__:
    _value = vars(_outside).get(_name)
    if hasattr(_value, "__code__"):
        globals()[_name] = _forward(_name, _value)
lib = _Library()


def __getattr__(name: str) -> _Any:
    """Constants, variables that calls such as `CAMInit` set, and names that EyeSim VR's `eye.py` imports, unless the program has them."""
    if name in vars(_outside):
        return getattr(_present(), name)
    own = getattr(_outside, name)
    return _sys._getframe(1).f_globals.get(name, own)


_sys.modules.setdefault("eye", _sys.modules[__name__])
