#!/usr/bin/env python3
"""Slopes of heaps on the support. usage: heaps.py TABLE.md NAME...

The outline of a heap is the highest grain in each of eight rings of equal width, as far as grains lie on the support; its slope is that of the straight
line through them. Height and slope are means over the last tenth of the run, when nothing moves but single grains. Where nine tenths of all grains are still
on the support, a column stands and has no slope. Bond number: pull-off force of
two grains of the mean size, 3/2 pi w R*, over the weight of one.
"""
import math
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TABLE, *NAMES = sys.argv[1:]
RINGS, G = 8, 9.81


def outline(x, size, radius, edge):
    """Slope [degrees] and height of the grains above the support, and their number. Grains above the lower edge of the tube hang on it."""
    there = (x[:, 2] > 0) & (x[:, 2] < edge)
    x, size = x[there], size[there]
    r, top = np.hypot(x[:, 0], x[:, 1]), x[:, 2] + 0.5 * size
    edges = np.linspace(0, radius, RINGS + 1)
    rings = [(0.5 * (low + high), top[(r >= low) & (r < high)].max()) for low, high in zip(edges, edges[1:]) if ((r >= low) & (r < high)).any()]
    at, heights = np.array(rings).T
    return math.degrees(math.atan(-np.polyfit(at, heights, 1)[0])), top.max(), len(x)


lines = ["| w [J/m^2] | Bond number | slope [degrees] | height over the radius of the support | grains on it |", "|---|---|---|---|---|"]
for name in NAMES:
    record = record_of(name)
    case, run = case_of(record), scree.open(f"{name}.run")
    w, density = si(case["pairs"][0]["adhesion"]), si(case["materials"]["powder"]["density"])
    radius = si(case["walls"][0]["shape"]["cylinder"]["radius"])
    tube = case["walls"][1]
    starts, rises, low = (si(value) for value in (tube["motion"]["start"], tube["motion"]["translate"]["velocity"][2], tube["shape"]["cylinder"]["start"][2]))
    late = [frame for frame in run.frames if frame.time >= 0.9 * record["time"]]
    values = []
    for frame in late:
        size = (6 * frame.bodies.mass / (math.pi * density)) ** (1 / 3)
        values.append(outline(frame.bodies.position, size, radius, low + rises * max(0.0, frame.time - starts)))
    slope, height, count = np.mean(values, axis=0)
    mean = float(np.mean(size))
    bond = 1.5 * math.pi * w * 0.25 * mean / (density * math.pi / 6 * mean**3 * G)
    told = "a column stands" if count > 0.9 * len(run.frames[0].bodies.id) else f"{slope:.1f} +- {np.std([v[0] for v in values]):.1f}"
    lines.append(f"| {w:g} | {bond:.0f} | {told} | {height / radius:.2f} | {count:.0f} |")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
