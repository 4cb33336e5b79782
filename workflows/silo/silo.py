#!/usr/bin/env python3
"""Rates of discharge, beside other codes. usage: silo.py TABLE.md CHART.svg CHART.png NAME...

The rate is the slope of the number of balls that are out, over the time after a fifth of the run: the first balls fall before there is a steady
flow. Its interval (95 %) is that of the mean over eight equal parts of that time. Published: LIGGGHTS 24 504/s and MUSEN 24 245/s through the
large orifice, MUSEN 7737/s through the small one (the rerun of the benchmark of Dosta and others, Comput. Phys. Commun. 296 (2024) 109066, that
peclet-examples gives).
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.stats import t as student  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import case_of, record_of, si  # noqa: E402

PUBLISHED = {"large": 24.3e3, "small": 24.3e3 / 3.10}  # 1/s, demanded within 5 %
RATIO, RATIO_ALLOWED, ALLOWED = 3.10, 0.1, 0.05
DIAMETER = 4e-3   # m, of the published balls: others have no rate to be compared with
PARTS = 8
TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def rate(name):
    record = record_of(name)
    out = np.atleast_1d(np.genfromtxt(f"{name}.run/removed.csv", delimiter=",", names=True, comments="#"))
    time, end = np.sort(np.atleast_1d(out["time"])), record["time"]
    edges = np.linspace(0.2 * end, end, PARTS + 1)
    each = np.diff(np.searchsorted(time, edges)) / np.diff(edges)
    return record, time, each.mean(), student.ppf(0.975, PARTS - 1) * each.std(ddof=1) / np.sqrt(PARTS)


rows, rates = [], {}
figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for name, colour in zip(NAMES, ["#0072B2", "#D55E00"]):
    record, time, mean, interval = rate(name)
    orifice = name.split("-")[1]
    bed = case_of(record_of(f"bed-{orifice}"))
    published = si(bed["shapes"]["grain"]["sphere"]["radius"]) * 2 == DIAMETER
    verdict = ""
    if published:
        rates[orifice] = mean
        off = mean / PUBLISHED[orifice] - 1
        verdict = f"{'holds' if abs(off) <= ALLOWED else 'misses'}: {100 * off:+.1f} %"
        plot.plot([0, time[-1]], [0, PUBLISHED[orifice] * time[-1] / 1e3], "--", color=colour, label=f"{orifice} orifice, published rate")
    speed = record["bodies"] * record["steps"] / record["wall_seconds"]
    rows.append(f"| {name} | {len(time)} | {mean:.0f} +- {interval:.0f} | {f'{PUBLISHED[orifice]:.0f}' if published else ''} | {verdict} | {speed:.2g} on {record['ranks']} x {record['threads']} cores |")
    plot.plot(time, np.arange(1, len(time) + 1) / 1e3, "-", color=colour, label=f"{orifice} orifice, {name}")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| run | balls out | rate [1/s] | published | verdict | particle-steps/s at most |\n|---|---|---|---|---|---|\n" + "\n".join(rows) + "\n")
    if len(rates) == 2:
        ratio = rates["large"] / rates["small"]
        file.write(f"\nLarge over small: {ratio:.2f}; published {RATIO:.2f}: {'holds' if abs(ratio - RATIO) <= RATIO_ALLOWED else 'misses'} (within {RATIO_ALLOWED}).\n")
plot.set_xlabel("time [s]")
plot.set_ylabel("balls out [thousands]")
plot.grid(alpha=0.3)
plot.legend()
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
