"""Runs with programs, and the command `eyesim`, from the installed wheel."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import eyesim
import numpy as np
import pytest

HOME = eyesim.home()

SQUARE = """
[world]
floor_mm = [4000, 3000]

[[robot]]
type = "S4"
x_mm = 1000
y_mm = 1500
"""

PROGRAM = """
from eye import *
VWStraight(400, 200)
VWWait()
VWTurn(90, 60)
VWWait()
print("done at", *VWGetPosition())
"""


def command(*words, **environment):
    """Runs the command `eyesim` of this environment without compilers, cargo and node."""
    bare = {"PATH": "/nonexistent", "HOME": os.environ.get("HOME", "/"), **environment}
    eyesim_command = Path(sys.executable).parent / "eyesim"
    return subprocess.run([eyesim_command, *map(str, words)], capture_output=True, text=True, env=bare, timeout=300)


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    path = tmp_path_factory.mktemp("programs") / "corner.py"
    path.write_text(PROGRAM)
    return path


@pytest.fixture(scope="module")
def finished(program):
    return eyesim.run(SQUARE, programs=program, seed=5)


def test_a_run_gives_its_report(finished):
    [robot] = finished.report["robots"]
    assert robot["outcome"] == "finished" and finished.report["seed"] == 5
    assert robot["pose"]["x_m"] == pytest.approx(1.4, abs=1e-3)
    assert "finished" in repr(finished)


def test_events_are_columns(finished):
    poses = finished.columns("pose", robot=1)
    assert poses["x_m"].dtype == np.float64 and poses["x_m"][-1] == pytest.approx(1.4, abs=1e-3)
    assert np.all(np.diff(poses["t_s"]) > 0)
    assert finished.columns("pose", robot=2) == {}
    assert any("done at 400 0 90" in str(text) for text in finished.columns("stdout")["text"])


def test_a_run_is_repeated_to_the_bit(program, finished):
    again = eyesim.run(SQUARE, programs={1: program}, seed=5, workers=1, trace=False)
    assert again.digest == finished.digest and again.trace == b""


def test_the_command_gives_the_same_digest(program, finished, tmp_path):
    scene, report = tmp_path / "square.scene.toml", tmp_path / "report.json"
    scene.write_text(SQUARE)
    ran = command("run", scene, "--program", program, "--seed", 5, "--report", report)
    assert ran.returncode == 0, ran.stderr
    assert json.loads(report.read_text())["digest"] == finished.digest


def test_it_is_shown_as_a_picture(finished):
    assert finished._repr_svg_().startswith("<svg") and finished.plot().svg == finished._repr_svg_()


def test_mistakes_are_exceptions(tmp_path):
    with pytest.raises(eyesim.SceneError, match="`missing.py`"):
        eyesim.run(SQUARE + 'program = "missing.py"\n')
    with pytest.raises(eyesim.Error, match="auto, fiber, thread or process"):
        eyesim.run(SQUARE, exec="cloud")
    broken = tmp_path / "broken.py"
    broken.write_text("from eye import *\nraise ValueError('no')\n")
    [robot] = eyesim.run(SQUARE, programs=broken).report["robots"]
    assert robot["outcome"] != "finished" and "ValueError: no" in robot["reason"]


def test_the_demo_runs_without_compilers():
    ran = command("run", "--example", "demo")
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.count("wander.py  finished") == 4, ran.stdout
    ran = command("run", "--example", "nothing")
    assert ran.returncode == 2 and "demo" in ran.stderr


def test_everything_that_the_wheel_brings_is_read():
    for folder in ("worlds", "robis", "sims", "example-programs"):
        assert (HOME / folder).is_dir()
    scenes = sorted(str(path) for path in (HOME / "sims").iterdir() if path.suffix in (".sim", ".toml"))
    assert len(scenes) > 20
    checked = command("check", *scenes)
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_new_programs_run(tmp_path):
    made = command("new", "maze", "--lang", "python", "--path", tmp_path)
    assert made.returncode == 0, made.stderr
    ran = command("run", tmp_path / "maze" / "maze.sim", "--until", 5)
    assert ran.returncode == 0, ran.stderr


def test_without_a_compiler_it_says_what_to_install(tmp_path):
    square = HOME / "example-programs/square-c/square.c"
    scene = tmp_path / "square.scene.toml"
    scene.write_text(SQUARE + f'program = "{square}"\n')
    ran = command("run", scene, XDG_CACHE_HOME=str(tmp_path))
    if eyesim._host.zig():
        assert ran.returncode == 0 and "zig" in ran.stderr, ran.stderr
    else:
        assert ran.returncode == 2 and "eyesim-robots[c]" in ran.stderr, ran.stderr


def test_robots_in_processes_are_started_from_the_interpreter(tmp_path, request):
    if not (os.access("/usr/bin/cc", os.X_OK)):
        pytest.skip("needs a C compiler")
    scene = tmp_path / "square.scene.toml"
    scene.write_text(SQUARE + f'program = "{HOME}/example-programs/square-c/square.c"\n')
    runs = [eyesim.run(scene, exec=place) for place in ("fiber", "process")]
    assert runs[0].digest == runs[1].digest
    assert runs[1].report["robots"][0]["outcome"] == "finished"


def test_programs_of_strangers_run_in_a_sandbox(program, tmp_path):
    if " full: " not in command("doctor").stdout:
        pytest.skip("the kernel does not reach the full sandbox")
    (tmp_path / "a.scene.toml").write_text(SQUARE)
    (tmp_path / "a.c").write_text('#include "eyebot.h"\nint main(void) { VWStraight(400, 200); VWWait(); return 0; }\n')
    for robot in [program, *([tmp_path / "a.c"] if shutil.which("cc") else [])]:
        words = ["--program", f"1={robot}", "--sandbox", "--report", tmp_path / "report.json"]
        ran = command("run", tmp_path / "a.scene.toml", *words, PATH=os.environ["PATH"])
        assert ran.returncode == 0, ran.stderr
        report = json.loads((tmp_path / "report.json").read_text())
        assert report["sandbox"]["level"] == "full" and report["robots"][0]["outcome"] == "finished"


def test_keys_can_be_one_text(tmp_path):
    path = tmp_path / "press.py"
    path.write_text("from eye import *\nKEYWait(KEY1)\nKEYWait(KEY2)\n")
    for keys in ("1:KEY1, 2:KEY2", ["1:KEY1", "2:KEY2"]):
        [robot] = eyesim.run(SQUARE, programs=path, keys=keys).report["robots"]
        assert robot["outcome"] == "finished" and robot["virtual_time_s"] == pytest.approx(2.0, abs=0.1)


def test_columns_of_a_table_have_types_although_values_are_missing(tmp_path):
    polars = pytest.importorskip("polars")
    path = tmp_path / "halt.py"
    path.write_text("import sys\nfrom eye import *\nif OSMachineID() == 1:\n    sys.exit(3)\nOSWait(100000)\n")
    second = SQUARE[SQUARE.index("[[robot]]") :].replace("y_mm = 1500", "y_mm = 2500")
    codes = eyesim.run(SQUARE + second, programs=path, until=1.0).table("program_ended")["exit_code"]
    assert codes.dtype == polars.Int64 and codes.to_list() == [3, None]
