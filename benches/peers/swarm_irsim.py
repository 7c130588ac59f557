"""The swarm in IR-SIM: swarm_irsim.py FOLDER ROBOTS SECONDS LIMIT_S

Runs the scene of benches/src/swarm.rs with the controller of benches/swarm/swarm.c, for SECONDS of virtual time or until LIMIT_S of
wall-clock time have passed, and prints the result as JSON. It writes its world to FOLDER.

Differences from the scene: each robot has one lidar in its centre, whose eight beams have the directions of the PSDs; the distance of
a PSD from the centre is subtracted. Wheels are those of IR-SIM's differential kinematics, which reach the commanded speed at once.
Bodies that overlap at the end of a step are pushed apart (`collision_mode: contact`). Without this, robots would drive through each
other, 1.4 to 2.4 times as fast; in its mode `stop` they would stop forever at the first collision. Display and log are off.
"""

import contextlib
import io
import json
import math
import sys
import time
from pathlib import Path

try:
    with contextlib.redirect_stdout(io.StringIO()):
        import irsim
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}: install the wheels with `pip install ir-sim numpy`")

SLOT_S = 0.05
WARM_UP = 2
GOLDEN_ANGLE = 137.5
RADIUS = 0.09
FAR_MM = 2000
NEAR_MM = 300
SPEED = 0.3
RATE = 1.5
# PSDs of swarm.robi in the order of swarm.c: x and y in mm, angle in degrees.
PLACES = np.array(
    [(0, 80, 90), (57, 57, 45), (75, 30, 20), (80, 0, 0), (75, -30, -20), (57, -57, -45), (0, -80, -90), (-80, 0, 180)], float
)
ANGLES = np.radians(PLACES[:, 2])
OFFSETS_MM = PLACES[:, 0] * np.cos(ANGLES) + PLACES[:, 1] * np.sin(ANGLES)


class Program:
    """The program of one robot: the functions of swarm.c."""

    def __init__(self):
        self.turn = 0.0

    def command(self, distance_mm):
        """Speed in m/s and turning speed in rad/s."""
        ahead_mm = min(distance_mm[1:6])
        away = RATE if sum(distance_mm[0:3]) > sum(distance_mm[4:7]) else -RATE
        if ahead_mm > 2 * NEAR_MM:
            self.turn = 0.0
        elif self.turn == 0 and ahead_mm < NEAR_MM:
            self.turn = away
        return (SPEED * ahead_mm / FAR_MM, 0.2 * away) if self.turn == 0 else (0.0, self.turn)


def make(folder, count):
    """The environment with its robots on a grid."""
    columns = math.isqrt(count)
    width, height = columns, -(-count // columns)
    corners = [[0, 0], [width, 0], [width, height], [0, height], [0, 0]]
    world = {
        "world": {"width": width, "height": height, "step_time": SLOT_S, "sample_time": SLOT_S, "collision_mode": "contact"},
        "robot": [
            {
                "number": count,
                "distribution": {"name": "manual"},
                "state": [[i % columns + 0.5, i // columns + 0.5, math.radians(i * GOLDEN_ANGLE % 360)] for i in range(count)],
                "kinematics": {"name": "diff"},
                "shape": {"name": "circle", "radius": RADIUS},
                "vel_min": [-0.6, -5.24],
                "vel_max": [0.6, 5.24],
                "sensors": [{"name": "lidar2d", "range_max": (FAR_MM + 81) / 1000, "number": len(ANGLES), "angle_range": 6.0}],
            }
        ],
        "obstacle": [{"shape": {"name": "linestring", "vertices": corners}, "state": [0, 0, 0]}],
    }
    # JSON is also YAML.
    path = folder / "swarm.yaml"
    path.write_text(json.dumps(world))
    environment = irsim.make(str(path), headless=True, log_level="ERROR")
    for robot in environment.robot_list:
        robot.sensors[0].angle_list = ANGLES
        robot.sensors[0].init_geometry(robot.state[0:3])
        robot.sensor_step()
    return environment


def run_slot(environment, programs):
    commands = []
    for robot, program in zip(environment.robot_list, programs):
        distances_mm = np.rint(1000 * robot.sensors[0].range_data - OFFSETS_MM)
        commands.append(np.array(program.command(np.clip(distances_mm, 0, FAR_MM).tolist())))
    environment.step(commands, list(range(len(commands))))


def positions(environment):
    return np.array([robot.state[0:2, 0] for robot in environment.robot_list])


def overlap_mm(at):
    """The largest overlap of two robots, or of a robot with a wall."""
    columns = math.isqrt(len(at))
    size = np.array([columns, -(-len(at) // columns)])
    overlaps = [(RADIUS - at).max(), (at - size + RADIUS).max()]
    for robot in range(len(at) - 1):
        overlaps.append(2 * RADIUS - np.hypot(*(at[robot + 1 :] - at[robot]).T).min())
    return 1000 * max(overlaps)


def resident_kib():
    lines = Path("/proc/self/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS:")).split()[1])


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    count, slots, limit = int(sys.argv[2]), round(float(sys.argv[3]) / SLOT_S), float(sys.argv[4])
    environment = make(Path(sys.argv[1]), count)
    programs = [Program() for _ in range(count)]
    for _ in range(WARM_UP):
        run_slot(environment, programs)
    path, overlap, real, done = 0.0, 0.0, 0.0, 0
    while done < slots and real < limit:
        before = positions(environment)
        start = time.perf_counter()
        run_slot(environment, programs)
        real += time.perf_counter() - start
        after = positions(environment)
        path += np.linalg.norm(after - before, axis=1).sum()
        overlap = max(overlap, overlap_mm(after))
        done += 1
    simulated = done * SLOT_S
    result = {"sim_time_s": simulated, "real_time_s": real, "resident_kib": resident_kib()}
    print(json.dumps(result | {"speed_m_per_s": path / count / simulated, "overlap_mm": overlap}))


main()
