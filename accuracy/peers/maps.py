"""Computes the errors of docs/papers/fusion.csv again, from traces and true heights alone.

Nothing of the project's code is used: the methods are written anew with numpy from their description in docs/papers.md. `papers fusion`
leaves traces, scenes and heights in its folder `runs`.

    python maps.py target/papers/fusion/runs docs/papers 127500 127501

Prints the error of each method beside the published one, in cm, and exits with 1 if two differ by half a unit of the tables' last digit,
0.05 cm, or more.
"""

import csv
import json
import sys
import tomllib
from pathlib import Path

import numpy as np

SIDE, TOP, LOOKS = 10.0, 2.5, 3
ASSUMED_HALF_ANGLE = np.radians(27.5)
ODOMETRY = (0.02, np.radians(0.5))


def membership(cosine):
    """Gain of the beam, -6 dB at the assumed half angle."""
    alpha = np.arccos(np.clip(cosine, -1, 1))
    return np.where(alpha > np.pi / 2, 0, np.exp(-2 * np.log(2) * (alpha / ASSUMED_HALF_ANGLE) ** 2))


def aperture(cut):
    return min(ASSUMED_HALF_ANGLE * np.sqrt(-np.log(cut) / (2 * np.log(2))), np.pi / 2)


def read_survey(folder, condition, seed):
    """All echoes of a survey: origins, directions, distances."""
    name = f"survey-{condition.replace(' ', '-')}-{seed}"
    scene = tomllib.loads((folder / f"{name}.scene.toml").read_text())
    sonars = {sonar["name"]: sonar for sonar in scene["robot_type"][0]["sonar"]}
    times, xs, ys, echoes = [], [], [], []
    for line in (folder / f"{name}.jsonl").open():
        event = json.loads(line)
        if event.get("robot") != 1:
            continue
        if event["event"] == "pose":
            times.append(event["t_s"]), xs.append(event["x_m"]), ys.append(event["y_m"])
        if event["event"] == "distance" and event.get("distance_m") is not None:
            echoes.append((event["measured_s"], event["device"], event["distance_m"]))
    when = np.array([echo[0] for echo in echoes])
    of = [sonars[echo[1]] for echo in echoes]
    pitch = np.radians([float(sonar["pitch_deg"]) for sonar in of])
    x, y = np.interp(when, times, xs), np.interp(when, times, ys)
    origin = np.stack([x, y + [sonar["y_mm"] / 1e3 for sonar in of], [sonar["z_mm"] / 1e3 for sonar in of]], axis=1)
    axis = np.stack([np.cos(pitch), 0 * pitch, np.sin(pitch)], axis=1)
    if condition == "odometry":
        scale, drift = ODOMETRY
        curvature = drift if seed % 2 == 0 else -drift
        heading = curvature * (1 + scale) * origin[:, 0]
        aside = origin[:, 1] - SIDE / 2
        sine, cosine = np.sin(heading), np.cos(heading)
        moved_x = sine / curvature - aside * sine
        moved_y = SIDE / 2 + (1 - cosine) / curvature + aside * cosine
        origin = np.stack([moved_x, moved_y, origin[:, 2]], axis=1)
        axis = np.stack([cosine * axis[:, 0], sine * axis[:, 0], axis[:, 2]], axis=1)
    return origin, axis, np.array([echo[2] for echo in echoes])


class Lattice:
    """Square cells over the terrain."""

    def __init__(self, cells):
        self.count = max(round(cells), 1)
        self.cell = SIDE / self.count

    def window(self, x, y, reach):
        """Cells within a reach of a point, as ranges of columns and rows."""
        low = lambda at: min(max(int(np.floor((at - reach) / self.cell)), 0), self.count)
        high = lambda at: max(min(int(np.floor((at + reach) / self.cell)) + 1, self.count), 0)
        return low(x), high(x), low(y), high(y)

    def place(self, x):
        return np.floor(x / self.cell).astype(int)


def activations(lattice, origin, axis, distance, cut):
    """Cells that a reading activates: columns, rows, weights, and the points of greatest membership with their heights.

    The membership is looked for at 3 x 3 points in each cell and at the rim of the cap above or below it.
    """
    least = np.cos(aperture(cut)) - 1e-9
    c0, c1, r0, r1 = lattice.window(origin[0], origin[1], distance)
    columns, rows = (part.ravel() for part in np.meshgrid(np.arange(c0, c1), np.arange(r0, r1)))
    cx, cy = (columns + 0.5) * lattice.cell, (rows + 0.5) * lattice.cell
    offsets = ((np.arange(LOOKS) + 0.5) / LOOKS - 0.5) * lattice.cell
    ox, oy = (part.ravel() for part in np.meshgrid(offsets, offsets))
    dx, dy = cx - origin[0], cy - origin[1]
    length = np.hypot(dx, dy)
    scale = np.divide(distance * (1 - 1e-9), length, out=np.zeros_like(length), where=length > 0)
    rim_x, rim_y = origin[0] + scale * dx, origin[1] + scale * dy
    on_rim = (length > 0) & (lattice.place(rim_x) == columns) & (lattice.place(rim_y) == rows)
    x = np.concatenate([cx[:, None] + ox, np.where(on_rim, rim_x, np.inf)[:, None]], axis=1)
    y = np.concatenate([cy[:, None] + oy, np.where(on_rim, rim_y, np.inf)[:, None]], axis=1)
    with np.errstate(invalid="ignore"):
        square = distance**2 - (x - origin[0]) ** 2 - (y - origin[1]) ** 2
        rise = -np.sqrt(np.maximum(square, 0))
        cosine = ((x - origin[0]) * axis[0] + (y - origin[1]) * axis[1] + rise * axis[2]) / distance
    cosine = np.where((square >= 0) & (cosine > 0), cosine, -1)
    best = np.argmax(np.where(cosine >= cosine.max(axis=1, keepdims=True) - 1e-12, np.arange(x.shape[1]), -1), axis=1)
    each = np.arange(len(columns))
    greatest = cosine[each, best]
    weight = np.where(greatest >= least, membership(greatest), 0)
    keep = (greatest >= least) & (weight >= cut)
    best, each = best[keep], each[keep]
    return columns[keep], rows[keep], weight[keep], x[each, best], y[each, best], origin[2] + rise[each, best]


def grid(lattice, readings, band, cut):
    """Certainties (empty, occupied) of cubes, after Moravec and Elfes."""
    cell, layers = lattice.cell, int(np.ceil(TOP / lattice.cell))
    empty = np.zeros((lattice.count, lattice.count, layers))
    occupied = np.zeros_like(empty)
    z = (np.arange(layers) + 0.5) * cell
    least = np.cos(aperture(cut))
    for origin, axis, distance in zip(*readings):
        reach = band * distance
        most = distance + reach + 1.5 * cell
        c0, c1, r0, r1 = lattice.window(origin[0], origin[1], most)
        dx = ((np.arange(c0, c1) + 0.5) * cell - origin[0])[:, None, None]
        dy = ((np.arange(r0, r1) + 0.5) * cell - origin[1])[None, :, None]
        dz = (z - origin[2])[None, None, :]
        r = np.sqrt(dx**2 + dy**2 + dz**2)
        cosine = (dx * axis[0] + dy * axis[1] + dz * axis[2]) / r
        half = reach + 0.5 * cell * (abs(dx) + abs(dy) + abs(dz)) / r
        gain = np.where(cosine >= least, membership(cosine), 0)
        is_free = r < distance - half
        freed = np.where(is_free, gain * (1 - (r / (distance - half)) ** 2), 0)
        own = (slice(c0, c1), slice(r0, r1))
        empty[own] += freed - empty[own] * freed
        hit = np.where(is_free, 0, gain * np.maximum(1 - ((r - distance) / half) ** 2, 0)) * (1 - empty[own])
        if hit.sum() > 0:
            hit /= hit.sum()
            occupied[own] += hit - occupied[own] * hit
    return empty, occupied, z


def grid_heights(lattice, readings, band, cut, projection):
    empty, occupied, z = grid(lattice, readings, band, cut)
    surplus = occupied - empty
    is_occupied = surplus > 0
    any_occupied = is_occupied.any(axis=2)
    if projection == "highest box":
        top = len(z) - 1 - np.argmax(is_occupied[:, :, ::-1], axis=2)
        height = z[top] + lattice.cell / 2
    elif projection == "likeliest box":
        height = z[len(z) - 1 - np.argmax(np.where(is_occupied, surplus, -1)[:, :, ::-1], axis=2)]
    else:
        weight = np.where(is_occupied, surplus, 0)
        total = weight.sum(axis=2)
        height = np.divide(weight @ z, total, out=np.zeros_like(total), where=total > 0)
    height = np.where(any_occupied, height, 0)
    return lambda x, y: height[lattice.place(x), lattice.place(y)]


def printed_heights(lattice, readings, cut, planes, ridge):
    """Eq. 3: one equation for each reading; without a ridge, that of the greatest evidence."""
    rules, values = [], []
    for origin, axis, distance in zip(*readings):
        columns, rows, weight, *_ = activations(lattice, origin, axis, distance, cut)
        if weight.sum() <= 0:
            continue
        point = origin + axis * distance
        share = weight / weight.sum()
        window = np.zeros((3 if planes else 1, lattice.count, lattice.count), dtype=np.float64)
        window[0, columns, rows] = share
        if planes:
            window[1, columns, rows] = share * (point[0] - (columns + 0.5) * lattice.cell)
            window[2, columns, rows] = share * (point[1] - (rows + 0.5) * lattice.cell)
        box = (columns.min(), columns.max() + 1, rows.min(), rows.max() + 1)
        rules.append((box, window[:, box[0] : box[1], box[2] : box[3]].copy()))
        values.append(max(point[2], 0.0))
    values, count = np.array(values), len(values)
    gram = np.zeros((count, count))
    for i, (a, first) in enumerate(rules):
        for j, (b, second) in enumerate(rules[: i + 1]):
            c0, c1, r0, r1 = max(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), min(a[3], b[3])
            if c0 < c1 and r0 < r1:
                cut_out = lambda box, part: part[:, c0 - box[0] : c1 - box[0], r0 - box[2] : r1 - box[2]]
                gram[i, j] = gram[j, i] = np.sum(cut_out(a, first) * cut_out(b, second))
    if ridge is None:
        eigen, vectors = np.linalg.eigh(gram)
        square = (vectors.T @ values) ** 2
        powers = range(-40, 41)

        def evidence(power):
            pivots = eigen + 2.0**power
            if (pivots <= 0).any():
                return -np.inf
            return -0.5 * (np.log(pivots).sum() + count * np.log((square / pivots).sum()))

        ridge = 2.0 ** max(powers, key=evidence)
    weights = np.linalg.solve(gram + ridge * np.eye(count), values)
    parameters = np.zeros((3 if planes else 1, lattice.count, lattice.count))
    for weight, (box, part) in zip(weights, rules):
        parameters[:, box[0] : box[1], box[2] : box[3]] += weight * part

    def height(x, y):
        column, row = lattice.place(x), lattice.place(y)
        own = parameters[:, column, row]
        if not planes:
            return own[0]
        return own[0] + own[1] * (x - (column + 0.5) * lattice.cell) + own[2] * (y - (row + 0.5) * lattice.cell)

    return height


def cells_heights(lattice, readings, cut, planes, above, sigma):
    """One equation for each cell: Kalman filters of its height, or of its height and slopes in units of cells."""
    size = 3 if planes else 1
    mean = np.zeros((lattice.count, lattice.count, size))
    variance = np.zeros((lattice.count, lattice.count, size, size))
    variance[:, :, 0, 0] = 1.0
    for slope in range(1, size):
        variance[:, :, slope, slope] = (0.5 * lattice.cell) ** 2
    for origin, axis, distance in zip(*readings):
        columns, rows, weight, x, y, height = activations(lattice, origin, axis, distance, cut)
        height = np.maximum(height, 0)
        factor = np.stack([np.ones_like(x), x / lattice.cell - columns - 0.5, y / lattice.cell - rows - 0.5], axis=1)[:, :size]
        own, spread = mean[columns, rows], variance[columns, rows]
        predicted = np.einsum("ci,ci->c", factor, own)
        error = height - predicted
        noise = sigma**2 / (weight * np.where(error > 0, above, 1))
        projected = np.einsum("cij,cj->ci", spread, factor)
        gain = projected / (np.einsum("ci,ci->c", factor, projected) + noise)[:, None]
        mean[columns, rows] = own + gain * error[:, None]
        variance[columns, rows] = spread - gain[:, :, None] * projected[:, None, :]

    def height_at(x, y):
        column, row = lattice.place(x), lattice.place(y)
        own = mean[column, row]
        factor = np.stack([np.ones_like(x), x / lattice.cell - column - 0.5, y / lattice.cell - row - 0.5], axis=-1)[..., :size]
        return (own * factor).sum(axis=-1)

    return height_at


def error(method, setting, survey, count, truth):
    """Root mean square error of a method's map, cm."""
    every = np.arange(count) * len(survey[2]) // count
    readings = tuple(part[every] for part in survey)
    *own, cut, cells = setting
    lattice = Lattice(cells)
    if method.startswith("grid"):
        height = grid_heights(lattice, readings, own[0], cut, method.split(", ")[1].replace("mean of boxes", "mean"))
    elif method.startswith("TSK"):
        height = printed_heights(lattice, readings, cut, "planes" in method, own[0] if own else None)
    else:
        height = cells_heights(lattice, readings, cut, "planes" in method, *own)
    at = (np.arange(100) + 0.5) * SIDE / 100
    x, y = np.meshgrid(at, at)
    return 100 * np.sqrt(np.mean((np.clip(height(x, y), 0, TOP) - truth) ** 2))


def main():
    runs, docs, seeds = Path(sys.argv[1]), Path(sys.argv[2]), [int(seed) for seed in sys.argv[3:]]
    settings = list(csv.reader((docs / "fusion-settings.csv").open()))[1:]
    head, *published = csv.reader((docs / "fusion.csv").open())
    wrong, compared = 0, 0
    for condition, count, seed, *errors in published:
        if int(seed) not in seeds:
            continue
        survey = read_survey(runs, condition, int(seed))
        truth = np.loadtxt(runs / f"heights-{seed}.csv", delimiter=",")
        for method, value in zip(head[3:], errors):
            words = next(row[2] for row in settings if row[0] == method and row[1] == count)
            ours = error(method, [float(word) for word in words.split()], survey, int(count), truth)
            differs = abs(ours - float(value)) >= 0.05
            wrong, compared = wrong + differs, compared + 1
            mark = "  DIFFERS" if differs else ""
            print(f"{condition:<11} {count:>3} {seed}  {method:<40} {ours:8.4f} {float(value):8.4f}{mark}", flush=True)
    print(f"{compared} errors compared, {wrong} differ by 0.05 cm or more")
    sys.exit(1 if wrong or not compared else 0)


main()
