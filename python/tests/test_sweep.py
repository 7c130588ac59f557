"""Suites case by case, and the engines of docs/sweeps.md that are installed."""

import json
import os
import pickle
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import eyesim
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/sweeps.md").read_text()

SCENE = """
[world]
floor_mm = [3000, 2000]

[[robot]]
type = "S4"
program = "drive.py"
x_mm = 500
y_mm = 500
"""

PROGRAM = """
import sys
from eye import *
gain = float(sys.argv[1]) if len(sys.argv) > 1 else 1
VWStraight(int(1000 * gain), 400)
VWWait()
print(f"METRIC error_mm={abs(1000 - VWGetPosition()[0])}")
"""

SUITE = """
[suite]
scene = "lab.scene.toml"
[matrix]
noise = ["none", "mild"]
seed = "1..6"
[[check]]
kind = "reach"
at_mm = [1500, 500]
within_mm = 20
"""


def block(name):
    """The file of the page with this name."""
    return re.search(rf"`{re.escape(name)}`:\n\n```\w+\n(.*?)```\n", PAGE, re.DOTALL)[1]


@pytest.fixture
def lab(tmp_path, monkeypatch):
    """Creates a working folder with a suite."""
    for name, text in [("lab.scene.toml", SCENE), ("drive.py", PROGRAM), ("lab.suite.toml", SUITE)]:
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    return tmp_path


def run(*words):
    """Runs a command and returns its output."""
    ran = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=600)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def expected():
    """The rows of one sweep, by their keys."""
    run("eyesim", "sweep", "lab.suite.toml", "-o", "whole", "-j", 1)
    return rows_of("whole")


def rows_of(folder):
    run("eyesim", "sweep", "merge", folder, "-o", "merged.jsonl")
    return rows_in("merged.jsonl")


def rows_in(file):
    rows = map(json.loads, Path(file).read_text().splitlines())
    return {row["key"]: row for row in rows}


def test_a_plan_has_the_cases_and_runs_them(lab):
    plan = pickle.loads(pickle.dumps(eyesim.plan("lab.suite.toml")))
    rows = expected()
    assert len(plan) == 12 and set(plan) == set(rows)
    assert all(plan[key] == row["case"] for key, row in rows.items())
    assert {key: eyesim.case(plan, key) for key in plan} == rows
    with ThreadPoolExecutor(3) as threads:
        assert list(threads.map(lambda key: eyesim.case(plan, key), plan)) == [rows[key] for key in plan]


def test_mistakes_of_plans_are_exceptions(lab):
    plan = eyesim.plan("lab.suite.toml")
    [first, *_] = plan
    with pytest.raises(eyesim.Error, match="no key `f00`"):
        eyesim.case(plan, "f00")
    with pytest.raises(eyesim.Error, match="nowhere.suite.toml"):
        eyesim.plan("nowhere.suite.toml")
    (lab / "drive.py").write_text(PROGRAM + "VWTurn(90, 60)\nVWWait()\n")
    with pytest.raises(eyesim.Error, match="are not those of the plan"):
        eyesim.case(plan, first)
    changed = eyesim.plan("lab.suite.toml")
    assert not set(changed) & set(plan)
    assert eyesim.case(changed, next(iter(changed)))["digest"]
    (lab / "lab.suite.toml").unlink()
    with pytest.raises(eyesim.Error, match="lab.suite.toml"):
        eyesim.case(plan, first)


def test_a_program_that_kills_its_process_is_a_row(lab):
    (lab / "drive.py").write_text("import os\nfrom eye import *\nOSWait(1)\nos.kill(os.getpid(), 9)\n")
    plan = eyesim.plan("lab.suite.toml")
    rows = [eyesim.case(plan, key) for key in list(plan)[:2]]
    assert [row["outcome"] for row in rows] == ["failed", "failed"] and "signal 9" in rows[0]["message"]


@pytest.mark.parametrize("engine, module", [("ray", "ray"), ("dask", "distributed")])
def test_engines_give_the_same_rows(lab, engine, module):
    pytest.importorskip(module)
    Path(f"sweep_{engine}.py").write_text(block(f"sweep_{engine}.py"))
    run(sys.executable, f"sweep_{engine}.py")
    assert rows_in("rows.jsonl") == expected()


def test_hyperqueue_gives_the_same_rows(lab):
    pytest.importorskip("hyperqueue")
    Path("sweep_hq.py").write_text(block("sweep_hq.py"))
    run(sys.executable, "sweep_hq.py")
    assert rows_of("out") == expected()


def test_slurm_gives_the_same_rows(lab):
    tools = ["slurmctld", "slurmd", "munged", "sbatch"]
    missing = [tool for tool in tools if not shutil.which(tool)]
    if missing or os.geteuid() != 0:
        pytest.skip(f"needs root and {', '.join(missing or tools)}")
    Path("sweep.sh").write_text(block("sweep.sh").replace("1-100", "1-8"))
    print(run(ROOT / "scripts/slurm-on-one-machine", "sbatch", "--wait", "sweep.sh"))
    run("eyesim", "sweep", "status", "out")
    assert len(list(Path("out").iterdir())) == 8
    assert rows_of("out") == expected()


def test_optuna_finds_the_gain(lab):
    pytest.importorskip("optuna")
    Path("tune.py").write_text(block("tune.py"))
    last = run(sys.executable, "tune.py").splitlines()[-1]
    gain, error = re.fullmatch(r"gain ([\d.]+), mean error ([\d.]+) mm", last).groups()
    assert abs(float(gain) - 1) < 0.1 and float(error) < 100


@pytest.mark.parametrize("module", ["duckdb", "pandas"])
def test_tables_are_read_as_they_are(lab, module):
    reader = pytest.importorskip(module)
    rows = expected()
    run("eyesim", "sweep", "merge", "whole", "-o", "rows.csv")
    if module == "pandas":
        frame = reader.read_csv("rows.csv")
        assert list(reader.read_json("merged.jsonl", lines=True).digest) == [row["digest"] for row in rows.values()]
    else:
        frame = reader.sql("select * from 'rows.csv'").df()
        reader.sql("copy 'rows.csv' to 'rows.parquet'")
        assert reader.sql("select count(*) from 'rows.parquet'").fetchone() == (12,)
    assert list(frame.key) == list(rows) and frame["r1.error_mm"].notna().all()
