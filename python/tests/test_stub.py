"""The stub `eye.pyi`: type checkers and editors know the names of `from eyesim.eye import *`, which exist only at run time.

`python -P python/tests/test_stub.py` writes it.
"""

import ctypes
import inspect
from pathlib import Path

import eyesim.eye

HEAD = '''"""RoBIOS-7 for functions as robot programs. `python/tests/test_stub.py` writes this file."""

import os as os
import sys as sys
from ctypes import *
from typing import Any

import ctypes as ctypes

lib: Any
np: Any
'''


def stub():
    names = sorted(set(eyesim.eye.__all__) - set(dir(ctypes)) - {"ctypes", "lib", "np", "os", "sys"})
    return HEAD + "".join(declaration(name, getattr(eyesim.eye, name)) for name in names)


def declaration(name, value):
    if not inspect.isfunction(value):
        kind = next((kind.__name__ for kind in (int, float, str) if isinstance(value, kind)), "Any")
        return f"{name}: {kind}\n"
    # Calls may also name the arguments as EyeSim VR does, so the signature of the function is only shown.
    shown = f"{name}{inspect.signature(value)}\n\n{inspect.getdoc(value) or ''}"
    text = "\n    ".join(shown.strip().splitlines()).replace("\n    \n", "\n\n")
    return f'def {name}(*arguments: Any, **named: Any) -> Any:\n    """{text}"""\n'


def test_the_stub_has_all_names():
    assert Path(eyesim.eye.__file__).with_suffix(".pyi").read_text() == stub(), "run `python -P python/tests/test_stub.py`"


if __name__ == "__main__":
    (Path(__file__).parents[1] / "eyesim" / "eye.pyi").write_text(stub())
