#!/usr/bin/env python3
"""Mixing and torque against turns of the shaft. usage: mixing.py TABLE.md CHART.svg CHART.png NAME ...

The index is that of scree-post (Lacey over cells of twelve tablets, two populations). Its distance from a random mixture falls as exp(-turns / N): the fit is
over all frames with an index below 0.95. The torque is that of the shaft about its axis, mean of the turns after the first half turn, with Student's
interval over half turns.
"""
import csv
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402
from scree.intervals import mean_interval  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
COLOURS = ["#2a6f97", "#bc6c25", "#606c38"]
MIXED = 0.95


def series_of(name):
    with open(f"{name}.statistics/series.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    column = next(key for key in rows[0] if key.split(" ")[0] == "mixing_index")
    time = next(key for key in rows[0] if key.split(" ")[0] == "time")
    found = [(float(row[time]), float(row[column])) for row in rows if row[column]]
    return np.array(found).T


lines = ["| speed | turns | mixing index: after one turn | at the end | constant N of 1 - M = exp(-turns / N) | torque on the shaft | power |", "|---|---|---|---|---|---|---|"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6), layout="constrained")
torques = []
for name, colour in zip(NAMES, COLOURS):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    motion = next(wall["motion"] for wall in case["walls"] if wall["name"] == "shaft")
    rate, start = si(motion["rotate"]["rate"]), si(motion["start"])
    label = f"{rate * 30 / np.pi:.0f} rpm"
    time, index = series_of(name)
    turns, moves = (time - start) * rate / (2 * np.pi), time >= start
    left.plot(turns[moves], index[moves], color=colour, linewidth=0.9, label=label)
    shaft = next(wall.id for wall in run.scene.walls.in_order if wall.name == "shaft")
    log = run.log
    turned = (log["time"] - start) * rate / (2 * np.pi)
    torque = -log[f"wall{shaft}_torque_x"]
    right.plot(turned[turned > 0], 1e3 * torque[turned > 0], color=colour, linewidth=0.5, label=label)
    halves = [torque[(turned >= at) & (turned < at + 0.5)].mean() for at in np.arange(0.5, turned[-1] - 0.49, 0.5)]
    drag = mean_interval(halves, is_signed=True)
    torques.append(drag)
    fits = moves & (index < MIXED) & (turns > 0.1)
    constant = -1 / np.polyfit(turns[fits], np.log(1 - index[fits]), 1)[0] if fits.sum() > 3 else np.nan
    after = f"{np.interp(1, turns, index):.2f}" if turns[-1] >= 1 else ""
    number = f"{1e3 * drag.value:.2f} +- {1e3 * drag.half:.2f} mN m" if drag.count > 1 else ""
    lines.append(f"| {label} | {turns[-1]:.2g} | {after} | {index[-1]:.2f} | {constant:.2f} | {number} | {'' if not number else f'{1e3 * drag.value * rate:.1f} mW'} |")
if len(torques) > 1 and torques[0].count > 1:
    ratio = torques[1].value / torques[0].value
    half = ratio * np.hypot(torques[0].half / torques[0].value, torques[1].half / torques[1].value)
    lines += ["", f"Torque at the higher speed over that at the lower: {ratio:.2f} +- {half:.2f}."]
left.set(xlabel="turns of the shaft", ylabel="mixing index", ylim=(0, 1.05))
right.set(xlabel="turns of the shaft", ylabel="torque on the shaft [mN m]")
for axes in (left, right):
    axes.legend(frameon=False)
for path in (SVG, PNG):
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Paddle mixer\n\n" + "\n".join(lines) + "\n")
