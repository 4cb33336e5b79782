#!/usr/bin/env python3
"""Way of the steel ball, beside other codes. usage: impact.py TABLE.md CHART.svg CHART.png NAME...

Published: displacement at 0, 10, 20, 30, 40 ms of LIGGGHTS and MUSEN (the rerun of the benchmark of Dosta and others, Comput. Phys. Commun. 296
(2024) 109066, that peclet-examples gives; the rates of the paper lie within 5 % of those). The demand is on beds of 25 000 and 50 000 balls.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import heights_of_heaviest, record_of  # noqa: E402

TIMES = np.array([0, 10, 20, 30, 40])  # ms
PUBLISHED = {25000: {"LIGGGHTS": [0, -50.7, -102.2, -138.4, -118.7], "MUSEN": [0, -50.5, -102.0, -138.0, -120.2]},
             50000: {"LIGGGHTS": [0, -50.7, -96.9, -121.3, -135.1], "MUSEN": [0, -50.5, -96.7, -121.5, -135.6]}}  # mm
# how far from LIGGGHTS the ball may be [mm]; after 30 ms in the bed of 25 000 it meets the floor, and small causes have large effects
ALLOWED = {25000: {10: 1, 20: 1, 30: 1}, 50000: {20: 1, 30: 2, 40: 2}}
TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def way(name):
    """Times [ms] and displacement [mm] of the heaviest body."""
    frames = scree.open(f"{name}.run").frames
    z = np.array(heights_of_heaviest(frames)[1])
    return np.array([frame.time for frame in frames]) * 1e3, (z - z[0]) * 1e3


lines = ["| run | code | " + " | ".join(f"{t} ms" for t in TIMES) + " | at the end | particle-steps/s | verdict |", "|---|---|" + "---|" * (len(TIMES) + 3)]
figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7"]
drawn = set()
for name, colour in zip(NAMES, COLOURS):
    record, (time, moved) = record_of(name), way(name)
    count = int(name.split("-")[1])
    at = np.interp(TIMES, time, moved, right=np.nan)
    verdict = ""
    if count in PUBLISHED:
        reference = dict(zip(TIMES, PUBLISHED[count]["LIGGGHTS"]))
        off = {t: abs(value - reference[t]) for t, value in zip(TIMES, at) if t in ALLOWED[count] and not np.isnan(value)}
        wrong = [f"{off[t]:.1f} mm off at {t} ms" for t in off if off[t] > ALLOWED[count][t]]
        verdict = "misses: " + ", ".join(wrong) if wrong else f"holds ({', '.join(f'{off[t]:.1f} mm at {t} ms' for t in off)})"
    speed = record["bodies"] * record["steps"] / record["wall_seconds"] if record["wall_seconds"] > 0 else float("nan")
    lines.append(f"| {name} | Scree | " + " | ".join("" if np.isnan(value) else f"{value:.1f}" for value in at)
                 + f" | {moved[-1]:.1f} at {time[-1]:.0f} ms | {speed:.2g} on {record['ranks']} x {record['threads']} cores | {verdict} |")
    plot.plot(time, moved, "-", color=colour, label=name)
    if count in PUBLISHED and count not in drawn:
        drawn.add(count)
        for code, values in PUBLISHED[count].items():
            lines.append(f"| | {code} | " + " | ".join(f"{value:.1f}" for value in values) + " | | | |")
            plot.plot(TIMES, values, "o" if code == "LIGGGHTS" else "x", color=colour, markersize=5, label=f"{code}, {count}")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("Displacement of the steel ball [mm].\n\n" + "\n".join(lines) + "\n")
plot.set_xlabel("time [ms]")
plot.set_ylabel("displacement [mm]")
plot.grid(alpha=0.3)
plot.legend(fontsize="small")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
