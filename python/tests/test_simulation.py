"""Simulations without programs: values that are stepped, copied, observed; errors with locations."""

import copy
import math
import pickle
import subprocess
import sys
import threading

import eyesim
import numpy as np
import pytest

ROOM = """
[world]
floor_mm = [4000, 3000]
wall = [
    { from_mm = [4000, 0], to_mm = [4000, 3000] },
]

[[robot]]
type = "S4"
x_mm = 1000
y_mm = 1500
"""


def test_a_robot_drives_as_far_as_it_is_told():
    sim = eyesim.load(ROOM)
    robot = sim.robot(1)
    robot.drive(0.2)
    sim.step(1.0)
    assert sim.now == 1.0
    # 0.2 m/s for 1 s; the wheels follow their command at once.
    assert robot.pose == pytest.approx((1.2, 1.5, 0.0), abs=1e-9)
    assert robot.speed == pytest.approx((0.2, 0.0, 0.0), abs=1e-9)
    robot.go(0.0, math.pi / 2)
    while not robot.is_done:
        sim.step(0.05)
    assert robot.pose.phi == pytest.approx(math.pi / 2, abs=1e-9)
    assert robot.odometry == pytest.approx((0.2, 0.0, math.pi / 2), abs=1e-9)


def test_ranges_are_distances_to_walls():
    sim = eyesim.load(ROOM)
    robot = sim.robot()
    ranges = dict(zip(robot.range_sensors, robot.ranges()))
    ahead = next(name for name in ranges if "FRONT" in name)
    into = np.empty(len(ranges))
    assert robot.ranges(into) is into
    before = ranges[ahead]
    robot.go(0.5)
    sim.step(5.0)
    after = robot.ranges()[list(ranges).index(ahead)]
    assert np.isinf(before) or before - after == pytest.approx(0.5, abs=1e-6)
    assert after < 3.0 and np.array_equal(robot.ranges(), robot.observe()["ranges"])


def test_a_copy_continues_as_its_original():
    sim = eyesim.load(ROOM, seed=3, noise="real")
    sim.robot().drive(0.3, 0.4)
    sim.step(1.0)
    snapshot = sim.snapshot()
    digests = []
    for _ in range(2):
        sim.step(2.0)
        digests.append((sim.digest, sim.robot().pose, sim.robot().ranges().tolist()))
        sim.restore(snapshot)
    assert digests[0] == digests[1]
    assert sim.now == snapshot.now == 1.0
    assert eyesim.load(ROOM, seed=4, noise="real").digest != sim.digest
    sim.restore(sim)
    assert sim.now == 1.0


def test_a_copy_has_the_scene_and_the_programs():
    def program():
        pass

    sim = eyesim.load(ROOM)
    sim.robot().program(program)
    sim.step(1.0)
    assert sim.snapshot().run().report["robots"][0]["program"] == "program()"
    other = eyesim.load(ROOM.replace("[[robot]]", "[[robot]]\nname = 'other'"))
    other.restore(sim)
    sim.robot().program("no.c")
    assert other.run().report["robots"][0]["program"] == "program()"


def test_interventions_are_recorded_and_refused_with_a_reason():
    sim = eyesim.load(ROOM)
    sim.act("place_robot", robot=1, x_m=2.0, y_m=1.0, phi_rad=0.5)
    assert sim.robot().pose == pytest.approx((2.0, 1.0, 0.5))
    with pytest.raises(eyesim.Error, match="robot"):
        sim.act("place_robot", robot=9, x_m=2.0, y_m=1.0, phi_rad=0.5)
    with pytest.raises(eyesim.Error, match="unknown variant `jump`"):
        sim.act("jump")
    sim.act("place_robot", robot=np.int64(1), x_m=np.float32(1.5), y_m=np.float64(1.0), phi_rad=0)
    assert sim.robot().pose == (1.5, 1.0, 0.0)
    for wrong in (math.nan, np.float32(math.inf), object()):
        with pytest.raises(eyesim.Error, match="place_robot: expected texts, truth values and finite numbers, not "):
            sim.act("place_robot", robot=1, x_m=wrong, y_m=1.0, phi_rad=0.0)


def test_images_are_arrays():
    sim = eyesim.load(ROOM)
    robot = sim.robot()
    with pytest.raises(eyesim.Error):
        robot.depth()
    image = robot.image(80, 60)
    assert image.shape == (60, 80, 3) and image.dtype == np.uint8 and image.std() > 1
    depth, (kinds, numbers) = robot.depth(), robot.labels()
    assert depth.shape == kinds.shape == numbers.shape == (60, 80)
    assert np.array_equal(np.isinf(depth), kinds == 0)
    # The wall ahead, the only one, is 3 m from the robot's centre.
    assert set(np.unique(kinds)) >= {1, 2} and set(numbers[kinds == 2]) == {0}
    assert 2.5 < depth[kinds == 2].min() < 3.0


def test_mistakes_have_file_line_and_column(tmp_path):
    path = tmp_path / "room.scene.toml"
    path.write_text(ROOM.replace("x_mm = 1000", 'x_mm = "left"'))
    with pytest.raises(eyesim.SceneError) as caught:
        eyesim.load(path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(path), 10, 8)
    assert "room.scene.toml:10:8: error" in str(error)
    assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics
    with pytest.raises(eyesim.SceneError):
        eyesim.load(tmp_path / "missing.sim")
    with pytest.raises(eyesim.Error, match="is not a scene"):
        eyesim.load(tmp_path / "program.c")


@pytest.mark.parametrize("opened", [eyesim.load, eyesim.run])
def test_mistakes_that_do_not_prevent_a_run_are_warnings(opened, tmp_path):
    path = tmp_path / "quiet.toml"
    path.write_text("[range]\nsigma_mm = 1\n")
    with pytest.warns(UserWarning, match=r"quiet.toml:1:2: warning\[toml-key\]: unknown key `range`") as caught:
        opened(ROOM, noise=path)
    assert [it.filename for it in caught] == [__file__]


def test_a_noise_profile_can_be_a_path(tmp_path):
    path = tmp_path / "quiet.toml"
    path.write_text("[psd]\nsigma_mm = 1\n")
    assert eyesim.load(ROOM, noise=path).digest == eyesim.load(ROOM, noise=str(path)).digest


def test_wrong_arguments_are_refused():
    sim = eyesim.load(ROOM)
    with pytest.raises(IndexError, match="no robot 2: the scene has 1"):
        sim.robot(2)
    with pytest.raises(eyesim.Error, match="expected 0 to 1e9 seconds"):
        sim.step(-1)
    with pytest.raises(eyesim.Error, match="not a number"):
        sim.robot().drive(math.nan)
    with pytest.raises(eyesim.Error, match="has 2 motors, not 3"):
        sim.robot().wheels(1, 2, 3)
    with pytest.raises(eyesim.Error):
        eyesim.load(ROOM, slot=0)
    with pytest.raises(BufferError):
        sim.robot().ranges(np.empty(3, np.float32))
    with pytest.raises(BufferError):
        sim.robot().ranges(np.empty(99))


def test_other_threads_run_meanwhile():
    sim = eyesim.load(ROOM)
    sim.robot().drive(0.1, 1.0)
    counted = 0

    def step():
        sim.step(20_000.0)

    thread = threading.Thread(target=step)
    thread.start()
    while thread.is_alive():
        counted += 1
    thread.join()
    assert sim.now == 20_000.0 and counted > 100


def test_it_is_shown_as_a_picture():
    sim = eyesim.load(ROOM)
    assert sim._repr_svg_().startswith("<svg") and sim.plot()._repr_svg_() == sim.svg()
    before = sim.svg()
    sim.act("place_robot", robot=1, x_m=2.0, y_m=1.0, phi_rad=0.5)
    assert sim.svg() != before
    start = sim.svg()
    sim.act("add_robot", kind="S4", x_m=3.0, y_m=2.0, phi_rad=0.0)
    added = sim.svg()
    sim.act("remove_robot", robot=2)
    assert added != start and sim.svg() == start


def test_settings_change_the_scene():
    sim = eyesim.load(ROOM, set={"robot[0].x_mm": 500})
    assert sim.robot().pose.x == 0.5
    wall = {"from_mm": (0, np.int64(0)), "to_mm": np.array([0.0, 3e3])}
    sim = eyesim.load(ROOM, set={"world.wall": [wall], "robot[0].heading_deg": np.float64(180.0)})
    assert np.nanmin(sim.robot().ranges()) < 1.0
    for text in ('"\\', "\n\x7f\t", "a \U0001f916"):
        with pytest.raises(eyesim.SceneError):
            eyesim.load(ROOM, set={"world.file": text})
    with pytest.raises(eyesim.Error, match="set: None is not a value of TOML"):
        eyesim.load(ROOM, set={"robot[0].x_mm": None})


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy])
def test_a_copy_of_the_object_is_a_snapshot(copied):
    sim = eyesim.load(ROOM)
    other = copied(sim)
    other.step(1.0)
    assert (sim.now, other.now) == (0.0, 1.0)
    with pytest.raises(TypeError):
        pickle.dumps(sim)


def test_names_are_listed_before_they_are_used():
    names = subprocess.run([sys.executable, "-P", "-c", "import eyesim; print(*dir(eyesim))"], capture_output=True, text=True)
    assert set(eyesim.__all__) <= set(names.stdout.split())
