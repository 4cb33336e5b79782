#!/usr/bin/env python3
"""Solid fraction of dice, at rest and after taps. usage: dice.py TABLE.csv SUMMARY.md CHART.svg CHART.png RUN...

RUN is SHAPE-SEED; RUN.scene.h5 and RUN.run are read. The fraction is counted by random points between one and a half diameters above
the floor and one diameter below the top of the bed, where neither orders the dice. Published values: J. Baker and A. Kudrolli, Phys. Rev. E 82 (2010) 061304, standard deviation 0.01.

Constraints of a die in the same part of the bed, before the taps and at the end of the run, at rest after the last one: of contacts in a point, along an edge and with a face 3, 5 and 6
with friction, shared by both dice; 1, 2 and 3 without friction, not shared (M. Neudecker, S. Ulrich, S. Herminghaus, M. Schroeter, Phys. Rev. Lett. 111
(2013) 028001). The kind is that of scree-post bed, from contact points that carry a force; and, as a measurement with a resolution sees it, from the places at the
edges of both dice that are within a gap of the other one. Only dice that touch count, with every gap.
"""
import csv
import json
import math
import os
import subprocess
import sys

import h5py
import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

LOOSE = {"tetrahedron": 0.51, "cube": 0.54, "octahedron": 0.52, "dodecahedron": 0.51, "icosahedron": 0.50}
DENSEST = {"tetrahedron": 0.64, "cube": 0.67, "octahedron": 0.64, "dodecahedron": 0.63, "icosahedron": 0.59}
COLOURS = {"tetrahedron": "#D55E00", "cube": "#0072B2", "octahedron": "#009E73", "dodecahedron": "#CC79A7", "icosahedron": "#56B4E9"}
SAMPLES = 100_000   # the fraction is then within 0.002
GAPS = (0.005, 0.01, 0.02)   # over the diameter; a voxel of the published tomograms is 0.023 of it
PATCH = 0.1                  # extent over the diameter from which on a contact is one along an edge or with a face: that of scree-post
KINDS = ("point", "edge", "face")
OF_KIND = {"point": (3, 1), "edge": (5, 2), "face": (6, 3)}   # with friction, without


def bulk_of(diameter, x):
    """Lowest and highest height of the bulk [m]."""
    return 1.5 * diameter, np.quantile(x[:, 2], 0.95) - diameter


def turned(turn, v):
    """Vectors N x 3, turned by a quaternion (w x y z)."""
    t = 2 * np.cross(turn[1:], v)
    return v + turn[0] * t + np.cross(turn[1:], t)


def edge_points(vertex, triangle, normal):
    """41 points of each edge between two faces, in axes of the die."""
    sides = {}
    for k, corners in enumerate(triangle):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            sides.setdefault(tuple(sorted((corners[a], corners[b]))), []).append(k)
    along = np.linspace(0, 1, 41)[:, None]
    return np.concatenate([vertex[a] + (vertex[b] - vertex[a]) * along for (a, b), (one, other) in sides.items() if normal[one] @ normal[other] < 0.999])


def kind_of(points, diameter):
    """By the largest distance of two points, and by the largest distance of a point from the line through these."""
    if len(points) < 2:
        return "point"
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    first, second = np.unravel_index(apart.argmax(), apart.shape)
    if apart[first, second] <= PATCH * diameter:
        return "point"
    line, r = (points[second] - points[first]) / apart[first, second], points - points[first]
    return "face" if np.linalg.norm(r - (r @ line)[:, None] * line, axis=1).max() > PATCH * diameter else "edge"


def constraints(run, number, die, width, x, q, ids):
    """Means over the dice of the bulk in a frame: contacts of each kind, constraints without friction, and with friction by the gap (0: points with a force).

    None without a bulk. die: normals and offsets of the faces, points of the edges, diameter.
    """
    normal, offset, edges, diameter = die
    low, high = bulk_of(diameter, x)
    bulk = set(ids[(x[:, 2] > low) & (x[:, 2] < high)].tolist())
    if high < low + 0.5 * diameter or not bulk:
        return None
    folder = f"{run}.bed-{number}"
    subprocess.run(["scree-post", "bed", f"{run}.run", "-o", folder, "--frame", str(number), "--parting", "none", "--jobs", "1"], check=True, stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "contacts.csv"), encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["body_a"]]   # the second row has units
    place = {body: row for row, body in enumerate(ids.tolist())}
    kinds, free, held = dict.fromkeys(KINDS, 0), 0, dict.fromkeys((0, *GAPS), 0.0)
    for row in rows:
        pair = int(row["body_a"]), int(row["body_b"])
        members = sum(body in bulk for body in pair)
        if members == 0:
            continue
        kinds[row["kind"]] += members
        free += members * OF_KIND[row["kind"]][1]
        if not all(body in place for body in pair):   # the floor, which has no degree of freedom; no die of the bulk is near
            for gap in held:
                held[gap] += members * OF_KIND[row["kind"]][0]
            continue
        held[0] += members * 0.5 * OF_KIND[row["kind"]][0]
        a, b = (place[body] for body in pair)
        away = x[a] - x[b]
        away[:2] -= width * np.round(away[:2] / width)
        points, gaps = [], []
        for mine, other, shift, back in ((a, b, away, 0), (b, a, -away, away)):
            world = turned(q[mine], edges) + shift
            points.append(world + back)
            gaps.append((turned(q[other] * [1, -1, -1, -1], world) @ normal.T - offset).max(axis=1))
        points, gaps = np.concatenate(points), np.concatenate(gaps)
        for gap in GAPS:
            held[gap] += members * 0.5 * OF_KIND[kind_of(points[gaps < gap * diameter], diameter)][0]
    return {**{kind: kinds[kind] / len(bulk) for kind in KINDS}, "frictionless": free / len(bulk), "friction": {gap: value / len(bulk) for gap, value in held.items()}}


def bulk_fraction(solid, width, diameter, x, q):
    """solid: unit normals and offsets of the faces; x, q: N x 3 and N x 4, centres and turns (w x y z)."""
    normal, offset, reach = solid
    low, high = bulk_of(diameter, x)
    if high < low + 0.5 * diameter:
        return math.nan   # too few dice for a bulk
    random = np.random.default_rng(1)
    points = np.column_stack([random.random((SAMPLES, 2)) * width, low + (high - low) * random.random(SAMPLES)])
    inside = np.zeros(SAMPLES, bool)
    for centre, turn in zip(x, q):
        d = points - centre
        d[:, :2] -= width * np.round(d[:, :2] / width)
        near = np.where(np.sum(d * d, axis=1) < reach ** 2)[0]
        t = 2 * np.cross(-turn[1:], d[near])
        local = d[near] + turn[0] * t + np.cross(-turn[1:], t)
        inside[near] |= np.all(local @ normal.T <= offset, axis=1)
    return float(inside.mean())


def read(run):
    """Of a run: the fraction before the taps and after 1, 2, 5, 10 ... of them, and the kinetic energy of a die before over m g d."""
    shape, seed = run.rsplit("-", 1)
    with h5py.File(f"{run}.scene.h5", "r") as file:
        vertex, triangle = file["shapes/shape_0000/vertices"][:], file["shapes/shape_0000/triangles"][:]
        scale = float(file["bodies/scale"][0])   # of all dice
        vertex, volume = scale * vertex, scale**3 * float(file["shapes/shape_0000"].attrs["volume"])
        settings = json.loads(file["settings"][()])
    density, friction = settings["materials"][0]["density"], settings["pairs"][0]["friction"]
    wall = settings["walls"][0]["motion"]
    width = settings["settings"]["domain"]["max"][0]
    normal = np.cross(vertex[triangle[:, 1]] - vertex[triangle[:, 0]], vertex[triangle[:, 2]] - vertex[triangle[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    solid = normal, np.sum(normal * vertex[triangle[:, 0]], axis=1), np.linalg.norm(vertex, axis=1).max()
    diameter = (6 / math.pi * volume) ** (1 / 3)
    die = *solid[:2], edge_points(vertex, triangle, normal), diameter

    every = settings["settings"]["output_every"]
    start = wall["table_time"][1] if len(wall["table_time"]) > 3 else settings["settings"]["duration"]
    with open(f"{run}.run/frames.hdf.series", encoding="utf-8") as file:
        frames = [(entry["time"], os.path.join(f"{run}.run", entry["name"])) for entry in json.load(file)["files"]]
    done = (len(wall["table_time"]) - 2) // 11   # eleven points for each tap
    fractions, held, count = {}, {}, 0
    for taps in (0, 1, 2, 5, 10, 20, 50, 100):
        if taps > done:
            break
        moment = start + taps * every
        time, path = min(frames, key=lambda frame: abs(frame[0] - moment))
        with h5py.File(path, "r") as file:
            x, q = file["VTKHDF/Points"][:], file["VTKHDF/PointData/quat"][:]
        count = len(x)
        fractions[taps] = bulk_fraction(solid, width, diameter, x, q)
    for taps, moment in ((0, start), (done, frames[-1][0])) if done else ((0, start),):   # at rest: after the last tap at the end of the run
        _, path = min(frames, key=lambda frame: abs(frame[0] - moment))
        with h5py.File(path, "r") as file:
            x, q, ids = file["VTKHDF/Points"][:], file["VTKHDF/PointData/quat"][:], file["VTKHDF/PointData/id"][:]
        number = int(path.rpartition("_")[2].partition(".")[0])
        held[taps] = constraints(run, number, die, width, x, q, ids), bulk_fraction(solid, width, diameter, x, q)
    with open(f"{run}.run/log.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if not row["step"].startswith("#")]
    before = min(rows, key=lambda row: abs(float(row["time"]) - start))
    kinetic = float(before["kinetic_translational"]) + float(before["kinetic_rotational"])
    pressed = max(float(row["max_depth_ratio"]) for row in rows)
    energy = kinetic / (count * density * volume * np.linalg.norm(settings["settings"]["gravity"]) * diameter)
    return {"shape": shape, "seed": int(seed), "count": count, "friction": friction, "kinetic_before": energy, "max_depth_ratio": pressed, "fractions": fractions,
            "constraints": held}


def values_of(held):
    """In the order of the columns; NaN without a bulk."""
    return [*(held[kind] for kind in KINDS), held["frictionless"], *held["friction"].values()] if held else [math.nan] * (len(KINDS) + 2 + len(GAPS))


def mean_text(values, digits):
    values = np.array(values)
    return f"{values.mean():.{digits}f}" + (f" +- {values.std(ddof=1):.{digits}f}" if len(values) > 1 else "")


table, summary, svg, png = sys.argv[1:5]
runs = [read(run) for run in sys.argv[5:]]
taps = list(runs[0]["fractions"])
counted = list(runs[0]["constraints"])
with open(table, "w", encoding="utf-8", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["shape", "seed", "count", "friction", "kinetic_over_mgd_before_taps", "max_depth_ratio"] + [f"fraction_after_{n}_taps" for n in taps]
                    + [f"{name}_after_{n}_taps" for n in counted for name in (*(f"{kind}_contacts" for kind in KINDS), "constraints_frictionless", "constraints",
                                                                     *(f"constraints_gap_{gap}" for gap in GAPS))])
    for run in runs:
        writer.writerow([run["shape"], run["seed"], run["count"], run["friction"], f"{run['kinetic_before']:.2g}", f"{run['max_depth_ratio']:.3f}"]
                        + [f"{run['fractions'][n]:.4f}" for n in taps]
                        + [f"{value:.4f}" for n in counted for value in values_of(run["constraints"][n][0])])

shapes = list(dict.fromkeys(run["shape"] for run in runs))
tapped = len(taps) > 1
columns = ["dice", "let down", "published, loose", "difference", *(f"{n} tap{'s' * (n > 1)}" for n in taps[1:])] + ["denser by", "published, densest"] * tapped
lines = [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
figure, axes = plt.subplots(figsize=(6.4, 4.2))
for place, shape in enumerate(shapes):
    values = np.array([[run["fractions"][n] for n in taps] for run in runs if run["shape"] == shape])
    mean = values.mean(axis=0)
    spread = values.std(axis=0, ddof=1) if len(values) > 1 else np.zeros(len(taps))
    cells = [f"{m:.3f} +- {s:.3f}" if len(values) > 1 else f"{m:.3f}" for m, s in zip(mean, spread)]
    cells[1:1] = [f"{LOOSE[shape]:.2f}", f"{mean[0] - LOOSE[shape]:+.3f}"]
    cells += [f"{mean[-1] - mean[0]:+.3f}", f"{DENSEST[shape]:.2f}"] * tapped
    lines.append(f"| {' | '.join([shape, *cells])} |")
    axes.errorbar(taps if tapped else place, mean, spread, fmt="o-", ms=4, capsize=2, color=COLOURS[shape], label=shape)
    beside = 0.012 * (place - 2)   # two published values are the same
    axes.errorbar(-0.1 + beside if tapped else place + 0.15, LOOSE[shape], 0.01, fmt="D", mfc="white", ms=6, capsize=3, color=COLOURS[shape])
    if tapped:
        axes.errorbar(taps[-1] * (1.25 + 3 * beside), DENSEST[shape], 0.01, fmt="D", mfc="white", ms=6, capsize=3, color=COLOURS[shape])
if tapped:
    axes.set_xscale("symlog", linthresh=1)
    axes.set_xticks(taps, [str(n) for n in taps])
    axes.minorticks_off()
    axes.set_xlabel("taps")
    axes.legend(frameon=False)
else:
    axes.set_xticks(range(len(shapes)), shapes)
axes.set_ylabel("solid fraction of the bulk")
axes.set_title(f"Dice let down{', then tapped' * tapped}; diamonds: published, loose{' and densest' * tapped}", fontsize=10)
axes.grid(alpha=0.3)
figure.tight_layout()
figure.savefig(svg)
figure.savefig(png, dpi=150)
columns = ["dice", "taps", "solid fraction, at rest", "constraints with friction, shared", *(f"gaps up to {gap:g} d" for gap in GAPS), "constraints without friction, not shared", "in points",
           "along edges", "with faces"]
lines += ["", f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
for shape in shapes:
    beds = [run for run in runs if run["shape"] == shape]
    for n in counted:
        point, edge, face, free, *held = np.array([values_of(run["constraints"][n][0]) for run in beds]).T
        cells = [shape, str(n), mean_text([run["constraints"][n][1] for run in beds], 3), *(mean_text(values, 1) for values in (*held, free)),
                 *(mean_text(values, 2) for values in (point, edge, face))]
        lines.append(f"| {' | '.join(cells)} |")
with open(summary, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
print("\n".join(lines))
