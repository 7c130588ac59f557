"""Rays of the bench `rays` through Embree: python3 embree_rays.py FOLDER (filled by `ray-files FOLDER`).

Needs the wheels embreex and numpy. Walls are extruded to 1 m, two triangles each; rays run at half that height. Embree
computes in 32-bit floats; rays are handed over in batches, cast one at a time by Embree's single-ray query.

The bench `terrain` runs it as `embree_rays.py --mesh FOLDER REPEATS CHUNK MODE`, MODE being
`fast` or, for fewer leaks at shared edges, `robust`.
"""

import sys
import time
from pathlib import Path

try:
    import numpy as np
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene
except ImportError as error:
    sys.exit(f"{error}: install the wheels with `pip install embreex numpy`")

HEIGHT_M = 1.0
REPEATS = 50


def scene_of(walls):
    """Embree's scene of the walls, rows of (ax, ay, bx, by)."""
    low = np.zeros(len(walls))
    high = np.full(len(walls), HEIGHT_M)
    ax, ay, bx, by = walls.T
    corners = [np.stack(c, axis=1) for c in [(ax, ay, low), (bx, by, low), (bx, by, high), (ax, ay, high)]]
    first = np.stack([corners[0], corners[1], corners[2]], axis=1)
    second = np.stack([corners[0], corners[2], corners[3]], axis=1)
    scene = EmbreeScene()
    mesh = TriangleMesh(scene, np.concatenate([first, second]).astype(np.float32))
    return scene, mesh


def measure(scene, name, rays):
    origin = np.zeros((len(rays), 3), np.float32)
    origin[:, :2] = rays[:, 0:2]
    origin[:, 2] = 0.5 * HEIGHT_M
    direction = np.zeros((len(rays), 3), np.float32)
    direction[:, :2] = rays[:, 2:4]
    reach = rays[:, 4].astype(np.float32)
    seconds = []
    for _ in range(REPEATS):
        # With the query DISTANCE Embree overwrites its copy of the ranges with the distances found.
        start = time.perf_counter()
        found = scene.run(origin, direction, dists=reach.copy(), query="DISTANCE")
        seconds.append(time.perf_counter() - start)
    distance = np.asarray(found, dtype=np.float64)
    truth = rays[:, 5]
    met = np.isfinite(truth)
    error = np.abs(distance[met] - truth[met])
    lost = int(np.sum(error > 1e-3))
    rate = [len(rays) / t / 1e6 for t in (min(seconds), sorted(seconds)[REPEATS // 2])]
    print(
        f"{name}: best {rate[0]:.2f}, median {rate[1]:.2f} million rays/s; "
        f"{lost} of {int(met.sum())} hits off by over 1 mm, the others by at most "
        f"{np.max(error[error <= 1e-3], initial=0.0):.1e} m"
    )


def mesh(folder, repeats, chunk, mode):
    """Casts rays.f64 (origin, direction, range) at triangles.f64, writes distances.f64, prints seconds."""
    triangles = np.fromfile(folder / "triangles.f64", "<f8").reshape(-1, 3, 3)
    rays = np.fromfile(folder / "rays.f64", "<f8").reshape(-1, 7).astype(np.float32)
    scene = EmbreeScene(robust=mode == "robust")
    _mesh = TriangleMesh(scene, triangles.astype(np.float32))
    origin, direction = np.ascontiguousarray(rays[:, 0:3]), np.ascontiguousarray(rays[:, 3:6])
    distance = np.full(len(rays), np.inf)
    seconds = 0.0
    for first in range(0, len(rays), chunk):
        part = slice(first, first + chunk)
        least = np.inf
        for _ in range(repeats):
            reach = rays[part, 6].copy()
            start = time.perf_counter()
            found = scene.run(origin[part], direction[part], dists=reach, query="DISTANCE")
            least = min(least, time.perf_counter() - start)
        seconds += least
        distance[part] = found
    distance[distance >= rays[:, 6]] = np.inf
    distance.astype("<f8").tofile(folder / "distances.f64")
    print(seconds)


def main():
    if len(sys.argv) == 6 and sys.argv[1] == "--mesh":
        mesh(Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5])
        return
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    walls = np.fromfile(folder / "walls.f64", "<f8").reshape(-1, 4)
    scene, _mesh = scene_of(walls)
    for name in ["psd", "lidar"]:
        measure(scene, name, np.fromfile(folder / f"{name}.f64", "<f8").reshape(-1, 6))


main()
