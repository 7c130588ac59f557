"""The command `eyesim`."""

import sys

from . import _native


def main() -> int:
    """Runs the command with this process's arguments; returns its exit code."""
    words = ["eyesim", *sys.argv[1:]]
    if words[1:2] == ["bench-env"]:
        from ._bench import main as bench

        return bench(words[2:])
    return _native.main(words)


if __name__ == "__main__":
    sys.exit(main())
