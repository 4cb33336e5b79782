#!/usr/bin/env python3
"""Chart of warm runs. usage: warm_chart.py CHART.svg CHART.png NAME...    of NAME.csv and NAME.profiles.csv"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

SVG, PNG, *NAMES = sys.argv[1:]
KELVIN, COLOURS = 273.15, ("#0072B2", "#D55E00", "#009E73")
figure, (times, heights) = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained", gridspec_kw={"width_ratios": (3, 2)})
for colour, name in zip(COLOURS, NAMES):
    t = np.genfromtxt(f"{name}.csv", delimiter=",", names=True)
    label = os.path.basename(name).removeprefix("warm-") + "s"
    times.fill_between(t["time"], t["low"] - KELVIN, t["high"] - KELVIN, color=colour, alpha=0.18, linewidth=0)
    times.plot(t["time"], t["mean"] - KELVIN, color=colour, label=f"{label}: mean, and 5 to 95 %")
    times.plot(t["time"], t["outlet"] - KELVIN, ":", color=colour, label=f"air at the outlet, {label}")
    p = np.genfromtxt(f"{name}.profiles.csv", delimiter=",", names=True)
    for moment, style in zip(np.unique(p["time"])[1:], ("-", "--")):   # not that of the cold air
        rows = p[(p["time"] == moment) & (p["count"] > 2)]
        heights.plot(rows["bodies"] - KELVIN, 1e3 * rows["height"], style, color=colour, label=f"{label}, {moment:.2f} s")
changes = np.flatnonzero(np.diff(t["velocity"]) > 0)
for k in changes:
    times.axvline(t["time"][k], color="grey", linewidth=0.8)
    times.annotate(f"at rest, {t['velocity'][k]:g} m/s ", (t["time"][k], 82), ha="right", color="grey", fontsize=9)
    times.annotate(f" fluidised, {t['velocity'][k + 1]:g} m/s", (t["time"][k], 82), ha="left", color="grey", fontsize=9)
times.plot(t["time"], t["inlet"] - KELVIN, color="black", linewidth=0.8, drawstyle="steps-pre", label="air at the inlet")
times.set(xlabel="time (s)", ylabel="temperature (°C)", ylim=(18, 87))
times.legend(frameon=False, fontsize=8, loc="lower right")
heights.set(xlabel="temperature of the bodies (°C)", ylabel="height (mm)", xlim=(18, 87))
heights.legend(frameon=False, fontsize=8)
figure.savefig(SVG)
figure.savefig(PNG, dpi=150)
