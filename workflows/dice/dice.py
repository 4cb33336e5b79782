#!/usr/bin/env python3
"""Solid fraction of dice, at rest and after taps. usage: dice.py TABLE.csv SUMMARY.md CHART.svg CHART.png RUN...

RUN is SHAPE-SEED; RUN.scene.h5 and RUN.run are read. The fraction is counted by random points between one and a half diameters above
the floor and one diameter below the top of the bed, where neither orders the dice. Published values: J. Baker and A. Kudrolli, Phys. Rev. E 82 (2010) 061304, standard deviation 0.01.
"""
import csv
import json
import math
import os
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


def bulk_fraction(solid, width, diameter, x, q):
    """solid: unit normals and offsets of the faces; x, q: N x 3 and N x 4, centres and turns (w x y z)."""
    normal, offset, reach = solid
    low, high = 1.5 * diameter, np.quantile(x[:, 2], 0.95) - diameter
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

    every = settings["settings"]["output_every"]
    start = wall["table_time"][1] if len(wall["table_time"]) > 3 else settings["settings"]["duration"]
    with open(f"{run}.run/frames.hdf.series", encoding="utf-8") as file:
        frames = [(entry["time"], os.path.join(f"{run}.run", entry["name"])) for entry in json.load(file)["files"]]
    fractions, count = {}, 0
    for taps in (0, 1, 2, 5, 10, 20, 50, 100):
        moment = start + taps * every
        if moment > settings["settings"]["duration"] + every / 2:
            break
        time, path = min(frames, key=lambda frame: abs(frame[0] - moment))
        with h5py.File(path, "r") as file:
            x, q = file["VTKHDF/Points"][:], file["VTKHDF/PointData/quat"][:]
        count = len(x)
        fractions[taps] = bulk_fraction(solid, width, diameter, x, q)
    with open(f"{run}.run/log.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if not row["step"].startswith("#")]
    before = min(rows, key=lambda row: abs(float(row["time"]) - start))
    kinetic = float(before["kinetic_translational"]) + float(before["kinetic_rotational"])
    pressed = max(float(row["max_depth_ratio"]) for row in rows)
    energy = kinetic / (count * density * volume * np.linalg.norm(settings["settings"]["gravity"]) * diameter)
    return {"shape": shape, "seed": int(seed), "count": count, "friction": friction, "kinetic_before": energy, "max_depth_ratio": pressed, "fractions": fractions}


table, summary, svg, png = sys.argv[1:5]
runs = [read(run) for run in sys.argv[5:]]
taps = list(runs[0]["fractions"])
with open(table, "w", encoding="utf-8", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["shape", "seed", "count", "friction", "kinetic_over_mgd_before_taps", "max_depth_ratio"] + [f"fraction_after_{n}_taps" for n in taps])
    for run in runs:
        writer.writerow([run["shape"], run["seed"], run["count"], run["friction"], f"{run['kinetic_before']:.2g}", f"{run['max_depth_ratio']:.3f}"]
                        + [f"{run['fractions'][n]:.4f}" for n in taps])

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
with open(summary, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
print("\n".join(lines))
