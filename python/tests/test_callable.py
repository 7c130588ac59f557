"""Functions as robot programs: the same runs as from files, errors with robot and line, and the environment of a program."""

import gc
import json
import os
import random
import signal
import sys
import threading
import time
from pathlib import Path

import eyesim
import eyesim.eye
import nbformat
import pytest
from eyesim import _callable
from eyesim.eye import *  # noqa: F403
from nbclient import NotebookClient
from time import sleep

from test_run import HOME, SQUARE, command

PAIR = SQUARE + """
[[robot]]
type = "S4"
x_mm = 1000
y_mm = 2200
"""

EXAMPLES = {
    "demo": (HOME / "sims/demo.sim", HOME / "example-programs/wander/wander.py"),
    "follow-line": (HOME / "sims/follow-line.sim", HOME / "example-programs/follow-line/follow-line.py"),
    "approach": (SQUARE, HOME / "example-programs/approach/approach.py"),
}


def as_function(path):
    """A function that runs the program in a file unchanged."""

    def program():
        exec(compile(path.read_bytes(), str(path), "exec"), {"__name__": "__main__"})

    program.__name__ = path.stem  # the name is recorded
    return program


def scene_of(scene, folder):
    """The scene as a file."""
    if isinstance(scene, Path):
        return scene
    path = folder / "square.scene.toml"
    path.write_text(scene)
    return path


def digest_of_command(scene, program, folder):
    report = folder / "report.json"
    given = () if isinstance(scene, Path) else ("--program", program)
    ran = command("run", scene_of(scene, folder), *given, "--report", report)
    assert ran.returncode == 0, ran.stderr
    return json.loads(report.read_text())["digest"]


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_program_does_the_same_everywhere(name, tmp_path):
    scene, path = EXAMPLES[name]
    robots = len(eyesim.load(scene).robots)
    of_command = digest_of_command(scene, path, tmp_path)
    of_file = eyesim.run(scene, programs={robot: path for robot in range(1, robots + 1)}).digest
    of_function = eyesim.run(scene, programs={robot: as_function(path) for robot in range(1, robots + 1)}).digest
    assert of_command == of_file == of_function


def test_it_does_the_same_in_a_notebook(tmp_path):
    scene, path = EXAMPLES["approach"]
    cells = [
        f"import eyesim\nscene = {str(scene_of(scene, tmp_path))!r}\neyesim.run(scene, programs={str(path)!r}).digest",
        "from eyesim.eye import *\nlog = []",
        "def approach():\n" + "".join(f"    {line}\n" for line in path.read_text().splitlines() if "import" not in line),
        "eyesim.run(scene, programs=approach).digest",
        "def fails():\n    print('not shown in the cell')\n    VWStraight(100, 100)\n    log.append(1 / 0)\neyesim.run(scene, programs=fails)",
        "eyesim.run(scene, programs=approach)",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    NotebookClient(notebook, timeout=120, kernel_name="python3", allow_errors=True).execute()
    of_file, _, _, of_function, failed, shown = (cell.outputs for cell in notebook.cells)
    assert of_file[0]["data"]["text/plain"] == of_function[0]["data"]["text/plain"]
    [error] = failed
    assert error["ename"] == "ProgramError" and error["evalue"].startswith("robot 1: ZeroDivisionError: division by zero at ")
    assert error["evalue"].endswith(":4")
    assert shown[0]["data"]["image/svg+xml"].startswith("<svg")


def test_functions_share_what_their_module_has():
    poses = {}

    def drive():
        VWStraight(100 * OSMachineID(), 200)
        VWWait()
        poses[OSMachineID()] = tuple(VWGetPosition())

    run = eyesim.run(PAIR, programs=drive)
    assert poses == {1: (100, 0, 0), 2: (200, 0, 0)}
    assert [robot["outcome"] for robot in run.report["robots"]] == ["finished"] * 2
    assert [robot["program"] for robot in run.report["robots"]] == ["drive()"] * 2
    # Programs run one at a time, in the same order each time.
    order = []

    def note():
        for _ in range(20):
            order.append(OSMachineID())
            OSWait(50)

    eyesim.run(PAIR, programs=note)
    first, order[:] = list(order), []
    eyesim.run(PAIR, programs=note)
    assert first == order and sorted(order) == [1] * 20 + [2] * 20
    with pytest.raises(eyesim.Error, match="functions run one at a time"):
        eyesim.run(PAIR, programs=note, workers=2)


def test_a_simulation_runs_the_programs_of_its_robots():
    sim = eyesim.load(PAIR, seed=3)

    @sim.robot(2).program
    def drive():
        VWStraight(300, 200)
        VWWait()

    run = sim.run(until=5)
    assert [robot["pose"]["x_m"] for robot in run.report["robots"]] == pytest.approx([1.0, 1.3], abs=1e-3)
    assert run.report["seed"] == 3 and sim.now == 0


def test_arguments_and_exit_code():
    def program(first, second):
        return sys.exit(int(first) + len(second))

    with pytest.raises(eyesim.ProgramError, match="robot 1: exit code 8") as failed:
        eyesim.run(SQUARE, programs=program, arguments="1:5 abc")
    assert failed.value.robot == 1 and failed.value.__cause__ is None


def test_an_exception_comes_back_with_robot_and_line():
    def fails():
        OSWait(100)
        if OSMachineID() == 2:
            raise ValueError("no")  # this line

    with pytest.raises(eyesim.ProgramError) as failed:
        eyesim.run(PAIR, programs=fails)
    line = fails.__code__.co_firstlineno + 3
    assert str(failed.value) == f"robot 2: ValueError: no at test_callable.py:{line}"
    assert failed.value.robot == 2 and isinstance(failed.value.__cause__, ValueError)
    assert failed.value.__cause__.__traceback__.tb_lineno == line
    run = failed.value.run
    assert [robot["outcome"] for robot in run.report["robots"]] == ["finished", "failed"]
    assert any("ValueError: no" in str(event.get("text")) for event in run.events if event.get("robot") == 2)


def test_an_exception_of_a_timer_is_raised_by_the_call_in_progress():
    def tick():
        raise KeyError("tick")

    def program():
        OSAttachTimer(100, tick)
        try:
            OSWait(1000)
        except KeyError:
            LCDPrintf("caught\n")
        counts.append(OSGetCount())

    counts = []
    eyesim.run(SQUARE, programs=program)
    assert counts == [pytest.approx(100, abs=20)]


def test_an_endless_loop_is_told():
    def loops():
        while True:
            pass  # here

    with pytest.raises(eyesim.ProgramError, match=r"robot 1: endless loop, .*test_callable\.py") as failed:
        eyesim.run(SQUARE, programs=loops, timeout=0.5)
    [robot] = failed.value.run.report["robots"]
    assert robot["outcome"] == "timeout"


def test_a_program_that_catches_its_end_is_left_behind():
    def catches():
        while True:
            try:
                OSWait(100)
            except BaseException:  # noqa: B036
                pass

    run = eyesim.run(SQUARE, programs=catches, until=5)
    assert run.report["robots"][0]["outcome"] == "running"
    # The program has stopped computing.
    used = time.process_time()
    time.sleep(0.5)
    assert time.process_time() - used < 0.4
    assert eyesim.run(SQUARE, programs=lambda: OSWait(10)).report["robots"][0]["outcome"] == "finished"


def test_ctrl_c_ends_an_endless_loop():
    def loops():
        while True:
            pass

    def waits():
        while True:
            OSWait(100)

    for program in loops, waits:
        pid, main = os.getpid(), threading.main_thread().ident
        timer = threading.Timer(0.5, lambda: signal.pthread_kill(main, signal.SIGINT))
        timer.start()
        start = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            eyesim.run(SQUARE, programs=program, until=1e8, timeout=100)
        assert time.monotonic() - start < 30
        timer.join()
        assert pid == os.getpid()
    # The next run works normally.
    assert eyesim.run(SQUARE, programs=lambda: OSWait(10)).report["robots"][0]["outcome"] == "finished"


def test_time_random_numbers_and_output_are_the_robots(capsys):
    seen = {}

    def program():
        start, precise = time.time(), time.perf_counter()
        sleep(1.5)
        time.sleep(0.5)
        seen[OSMachineID()] = (time.time() - start, time.perf_counter() - precise, random.random(), os.urandom(4))
        print("out", end="\n")
        print("err", file=sys.stderr)
        seen["input", OSMachineID()] = sys.stdin.read()

    state = random.getstate()
    start = time.perf_counter()
    first = eyesim.run(PAIR, programs=program, seed=1)
    assert random.getstate() == state and time.perf_counter() - start < 60
    numbers = dict(seen)
    assert seen[1][:2] == pytest.approx((2.0, 2.0), abs=0.01) and seen["input", 1] == ""
    assert seen[1][2:] != seen[2][2:]
    second = eyesim.run(PAIR, programs=program, seed=1)
    assert seen == numbers and first.digest == second.digest
    assert capsys.readouterr() == ("", "")
    assert "out" in first.columns("stdout", robot=1)["text"][0]
    assert eyesim.run(PAIR, programs=program, seed=2).digest != first.digest


def test_a_function_draws_the_numbers_of_a_file(tmp_path):
    source = "from eye import *\nimport os, random, time\nprint(random.random(), random.randint(1, 6), os.urandom(3))\ntime.sleep(0.3)\nprint(time.time(), random.gauss(0, 1))\n"
    path = tmp_path / "draws.py"
    path.write_text(source)
    of_file = eyesim.run(PAIR, programs=path, seed=4)
    of_function = eyesim.run(PAIR, programs=as_function(path), seed=4)
    assert of_file.digest == of_function.digest


def test_outside_of_a_run_it_says_so():
    with pytest.raises(RuntimeError, match="no simulator"):
        VWStraight(100, 100)
    errors = []

    def program():
        thread = threading.Thread(target=lambda: errors.append(pytest.raises(RuntimeError, OSWait, 10)))
        thread.start()
        thread.join()

    eyesim.run(SQUARE, programs=program)
    assert len(errors) == 1
    assert eyesim.eye.VGA_X == 640 and "VWStraight" in dir(eyesim.eye) and VWStraight.__doc__


def test_runs_with_functions_do_not_nest():
    def outer():
        eyesim.run(SQUARE, programs=lambda: None)

    with pytest.raises(eyesim.ProgramError, match="is going on in this process already"):
        eyesim.run(SQUARE, programs=outer)


def test_functions_and_files_drive_in_one_run(tmp_path):
    path = tmp_path / "file.py"
    path.write_text("from eye import *\nVWStraight(200, 200)\nVWWait()\n")

    def function():
        VWStraight(200, 200)
        VWWait()

    report = eyesim.run(PAIR, programs={1: path, 2: function}).report
    assert [robot["pose"]["x_m"] for robot in report["robots"]] == pytest.approx([1.2, 1.2], abs=1e-9)


def test_a_run_leaves_nothing_behind():
    def program():
        VWStraight(100, 100)

    def count():
        gc.collect()
        return sum(isinstance(it, _callable.Program) for it in gc.get_objects())

    before = count()
    for _ in range(3):
        eyesim.run(SQUARE, programs=program)
    assert count() == before
