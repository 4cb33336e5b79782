#!/usr/bin/env python3
"""How far a column ran. usage: runout.py NAME BODIES.csv CONTACTS.csv TABLE.md CHART.svg CHART.png

The deposit is the largest set of grains that touch each other: single grains that roll away are not part of it. Its radius is the
mean over 24 sectors of the outermost surface of a grain. The column's height is that of its top grains just before the tube
moves, its radius that of its outermost grains.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.sparse import coo_matrix  # noqa: E402
from scipy.sparse.csgraph import connected_components  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import case_of, record_of, si  # noqa: E402

NAME, BODIES, CONTACTS, TABLE, SVG, PNG = sys.argv[1:]
SECTORS = 24
bodies = np.genfromtxt(BODIES, delimiter=",", names=True)
contacts = np.genfromtxt(CONTACTS, delimiter=",", names=True, usecols=("time", "body_a", "body_b"))
record = record_of(NAME)
case = case_of(record)
start = si(case["walls"][1]["motion"]["start"])
size = case["populations"][0]["size"]
radius = 0.25 * (si(size["min"]) + si(size["max"]))

times = np.unique(bodies["time"])
column = bodies[bodies["time"] == times[times <= start][-1]]
top = np.sort(column["z"])[-max(3, len(column) // 100):].mean() + radius
r_0 = np.quantile(np.hypot(column["x"], column["y"]), 0.99) + radius

last = bodies[bodies["time"] == times[-1]]
place = {int(body): i for i, body in enumerate(last["id"])}
end = contacts[contacts["time"] == contacts["time"].max()]
pairs = [(place[int(a)], place[int(b)]) for a, b in zip(end["body_a"], end["body_b"]) if int(a) in place and int(b) in place]  # walls are not in it
a, b = np.array(pairs, dtype=int).reshape(-1, 2).T
_, part = connected_components(coo_matrix((np.ones(len(a)), (a, b)), (len(last), len(last))), directed=False)
deposit = last[part == np.bincount(part).argmax()]
r = np.hypot(deposit["x"], deposit["y"]) + radius
sector = ((np.arctan2(deposit["y"], deposit["x"]) + np.pi) / (2 * np.pi) * SECTORS).astype(int) % SECTORS
edges = np.array([r[sector == s].max() for s in range(SECTORS) if (sector == s).any()])
r_end = edges.mean()

shape = top / r_0
found = (r_end - r_0) / r_0
published = 1.24 * shape if shape < 1.7 else 1.6 * np.sqrt(shape)
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| quantity | value |\n|---|---|\n")
    file.write(f"| height and radius of the column | {top * 1e3:.1f} mm, {r_0 * 1e3:.1f} mm: a = {shape:.2f} |\n")
    file.write(f"| radius of the deposit | {r_end * 1e3:.1f} mm (sd over {SECTORS} sectors {edges.std() * 1e3:.1f} mm) |\n")
    file.write(f"| grains in the deposit | {len(deposit)} of {len(last)}; 99 % of all lie within "
               f"{1e3 * (radius + np.quantile(np.hypot(last['x'], last['y']), 0.99)):.1f} mm |\n")
    file.write(f"| run-out (r_end - r_0) / r_0 | {found:.2f}; Lube and others (2004): {published:.2f}; {100 * (found / published - 1):+.0f} % |\n")
    file.write(f"| run time | {record['wall_seconds']:.0f} s |\n")

figure, plot = plt.subplots(figsize=(6.4, 3.2), layout="constrained")
for time, colour, label in ((column, "#56B4E9", "before"), (last, "#D55E00", "at the end")):
    plot.plot(np.hypot(time["x"], time["y"]) * 1e3, time["z"] * 1e3, ".", markersize=2, color=colour, label=label)
plot.axvline(r_end * 1e3, color="#000000", linewidth=1, label="radius of the deposit")
plot.axvline((1 + published) * r_0 * 1e3, color="#000000", linewidth=1, linestyle="--", label="Lube and others (2004)")
plot.set_xlabel("distance from the axis [mm]")
plot.set_ylabel("height [mm]")
plot.legend(markerscale=5, fontsize="small")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
