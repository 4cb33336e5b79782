#!/usr/bin/env python3
"""How far columns ran. usage: runout.py TABLE.md CHART.svg CHART.png NAME...

The radius r_0 of a column is that of its tube, its height twice that of its
centre of mass just before the tube moves. Seen from above, the deposit ends where grains cover less than half of the floor: r_end is the
outermost ring, half a grain wide, of which they cover half. What lies further out is single grains that rolled away. The interval (95 %) is that
of the mean over eight sectors.

Runs of the same name but for -coarse, -middle and -fine at the end are the same column of larger and smaller grains. The straight line through
them over (size of a grain) / r_0 tells where endless many grains would come to, as far as the line holds.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.stats import t as student  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import case_of, frame_at, record_of, si  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
SECTORS = 8
PIXELS = 8   # of a grain's diameter


def published(a):
    """(r_end - r_0) / r_0 of Lube, Huppert, Sparks and Hallworth, J. Fluid Mech. 508 (2004) 175."""
    return np.where(a < 1.7, 1.24 * a, 1.6 * np.sqrt(a))


def edges_of(positions, grain):
    """Radius of the deposit over all, then of each sector."""
    pixel, reach = grain / PIXELS, np.quantile(np.hypot(positions[:, 0], positions[:, 1]), 0.99) + grain
    n = int(np.ceil(reach / pixel))
    covered = np.zeros((2 * n + 1, 2 * n + 1), bool)
    offset = np.stack(np.meshgrid(*[np.arange(-PIXELS, PIXELS + 1)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    for place in positions[:, :2] / pixel + n:
        cells = np.round(place).astype(int) + offset
        cells = cells[(((cells - place) ** 2).sum(axis=1) <= (PIXELS / 2) ** 2) & (cells >= 0).all(axis=1) & (cells <= 2 * n).all(axis=1)]
        covered[cells[:, 0], cells[:, 1]] = True
    x, y = np.meshgrid(*[(np.arange(2 * n + 1) - n) * pixel] * 2, indexing="ij")
    ring = (np.hypot(x, y) / (grain / 2)).astype(int)
    sector = ((np.arctan2(y, x) + np.pi) / (2 * np.pi) * SECTORS).astype(int) % SECTORS

    def edge(chosen):
        share = np.bincount(ring[chosen], covered[chosen]) / np.maximum(1, np.bincount(ring[chosen]))
        return (np.flatnonzero(share[:int(reach / (grain / 2))] >= 0.5).max(initial=-1) + 1) * grain / 2
    return edge(np.ones_like(covered)), np.array([edge(sector == s) for s in range(SECTORS)])


def measure(name):
    record = record_of(name)
    case = case_of(record)
    size = case["populations"][0]["size"]
    grain = 0.5 * (si(size["min"]) + si(size["max"]))
    tube = case["walls"][1]
    r_0 = si(tube["shape"]["cylinder"]["radius"])
    column, end = frame_at(name, si(tube["motion"]["start"])), frame_at(name)
    r_end, edges = edges_of(end, grain)
    return {"name": name, "a": 2 * column[:, 2].mean() / r_0, "grain": grain / r_0, "count": len(column), "r_0": r_0, "run_out": r_end / r_0 - 1,
            "interval": student.ppf(0.975, SECTORS - 1) * edges.std(ddof=1) / np.sqrt(SECTORS) / r_0,
            "inside": (np.hypot(end[:, 0], end[:, 1]) <= r_end).sum(), "height": (np.sort(end[:, 2])[-max(3, len(end) // 500):].mean() + grain / 2) / r_0,
            "seconds": record["wall_seconds"], "column": column, "end": end}


runs = [measure(name) for name in NAMES]
STYLES = {"-coarse": ("o", "#56B4E9"), "-middle": ("^", "#009E73"), "-fine": ("s", "#0072B2"), "": ("o", "#0072B2")}
columns = {}
for run in runs:
    run["size"] = next(ending for ending in STYLES if run["name"].endswith(ending))
    columns.setdefault(run["name"].removesuffix(run["size"]), []).append(run)
limits = []
for name, sizes in columns.items():
    if len(sizes) < 2:
        continue
    grain, run_out, interval = (np.array([run[key] for run in sizes]) for key in ("grain", "run_out", "interval"))
    line, covariance = np.polyfit(grain, run_out, 1, w=1 / interval, cov="unscaled")
    limits.append({"name": name, "a": sizes[np.argmin(grain)]["a"], "run_out": line[1], "interval": np.sqrt(covariance[1, 1])})

with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| column | grains | grains across | height / radius a | (r_end - r_0) / r_0 | Lube and others (2004) | difference | grains inside r_end | height at the end / r_0 | run time [s] |\n"
               "|---|---|---|---|---|---|---|---|---|---|\n")
    for row in runs + limits:
        there = float(published(row["a"]))
        parts = [row["name"], str(row["count"]), f"{2 / row['grain']:.0f}"] if "count" in row else [f"{row['name']}, line to endless many", "", ""]
        parts += [f"{row['a']:.2f}", f"{row['run_out']:.2f} +- {row['interval']:.2f}", f"{there:.2f}", f"{100 * (row['run_out'] / there - 1):+.0f} %"]
        parts += [f"{row['inside']}", f"{row['height']:.2f}", f"{row['seconds']:.0f}"] if "inside" in row else ["", "", ""]
        file.write("| " + " | ".join(parts) + " |\n")

figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.8), layout="constrained")
for rows, style, colour, label in [([run for run in runs if run["size"] == size], *style, size[1:] + " grains") for size, style in STYLES.items()] + [
        (limits, "D", "#D55E00", "line to endless many grains")]:
    if rows:
        left.errorbar([row["a"] for row in rows], [row["run_out"] for row in rows], [row["interval"] for row in rows], fmt=style, color=colour, capsize=3, label=label)
a = np.linspace(0.3, 1.2 * max(run["a"] for run in runs) + 0.5, 200)
for low, high, label in ((0, 1.7, "Lube and others (2004)"), (1.7, np.inf, None)):
    part = a[(a >= low) & (a < high)]
    left.plot(part, published(part), "-", color="#000000", linewidth=1, label=label)
left.set_xlabel("height / radius of the column")
left.set_ylabel("(r_end - r_0) / r_0")
left.grid(alpha=0.3)
left.legend(fontsize="small")

shown = max(runs, key=lambda run: run["count"])
for positions, colour, label in ((shown["column"], "#56B4E9", "before"), (shown["end"], "#D55E00", "at the end")):
    right.plot(np.hypot(positions[:, 0], positions[:, 1]) / shown["r_0"], positions[:, 2] / shown["r_0"], ".", markersize=1.5, color=colour, label=label)
right.axvline(1 + shown["run_out"], color="#000000", linewidth=1, label="edge of the deposit")
right.axvline(1 + float(published(shown["a"])), color="#000000", linewidth=1, linestyle="--", label="Lube and others (2004)")
right.set_title(f"{shown['name']}: all grains", fontsize="medium")
right.set_xlabel("distance from the axis / r_0")
right.set_ylabel("height / r_0")
right.legend(markerscale=5, fontsize="small")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
