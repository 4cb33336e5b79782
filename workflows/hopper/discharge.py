#!/usr/bin/env python3
"""Flow of each run, and the exponent of Beverloo's law over their openings.
usage: discharge.py TABLE.md CHART.svg CHART.png NAME...

The flow W is the slope of the mass that was taken out below the hole, between a fifth of it and all of it: the first grains fall
before there is a steady flow. With k fixed at 1.4, the slope of ln W over ln(D - k d) is the exponent n; its interval is that of the fit.
"""
import math
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy import stats  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import case_of, record_of, si  # noqa: E402

OFFSET = 1.4   # Beverloo, Leniger and van de Velde (1961): the empty ring at the edge, in grain diameters
TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def run(name):
    record = record_of(name)
    removed = np.genfromtxt(f"{name}.run/removed.csv", delimiter=",", names=True, comments="#")
    return record, case_of(record), np.atleast_1d(removed["time"]), np.atleast_1d(removed["mass"])


rows = []
for name in NAMES:
    record, case, time, mass = run(name)
    size = case["populations"][0]["size"]
    grain = 0.5 * (si(size["min"]) + si(size["max"]))
    opening = 2 * si(case["walls"][1]["shape"]["disc"]["hole"])
    total = np.cumsum(mass)
    steady = total >= 0.2 * total[-1]
    flow = np.polyfit(time[steady], total[steady], 1)[0] if steady.sum() > 2 else math.nan
    rows.append((name, opening, grain, len(mass), flow, record["wall_seconds"]))

reduced = np.array([opening - OFFSET * grain for _, opening, grain, *_ in rows])
flows = np.array([row[4] for row in rows])
usable = (reduced > 0) & (flows > 0)
fit = stats.linregress(np.log(reduced[usable]), np.log(flows[usable])) if usable.sum() >= 2 else None
interval = stats.t.ppf(0.975, usable.sum() - 2) * fit.stderr if fit and usable.sum() > 2 else math.nan

with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| run | D [mm] | d [mm] | grains out | W [kg/s] | run time [s] |\n|---|---|---|---|---|---|\n")
    for name, opening, grain, count, flow, seconds in rows:
        file.write(f"| {name} | {opening * 1e3:.2f} | {grain * 1e3:.2f} | {count} | {flow:.4f} | {seconds:.0f} |\n")
    if fit:
        file.write(f"\nExponent n of W ~ (D - {OFFSET} d)^n: {fit.slope:.2f}" + ("" if math.isnan(interval) else f" +- {interval:.2f} (95 %)")
                   + "; Beverloo, Leniger and van de Velde (1961): 2.5.\n")

figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
plot.loglog(reduced * 1e3, flows * 1e3, "o", color="#0072B2", label="runs")
if fit:
    x = np.linspace(reduced[usable].min() * 0.9, reduced[usable].max() * 1.1, 50)
    plot.loglog(x * 1e3, 1e3 * np.exp(fit.intercept) * x**fit.slope, "-", color="#0072B2", label=f"fit, exponent {fit.slope:.2f}")
    middle = np.exp(np.mean(np.log(flows[usable]))) / np.exp(np.mean(np.log(reduced[usable]))) ** 2.5
    plot.loglog(x * 1e3, 1e3 * middle * x**2.5, "--", color="#D55E00", label="Beverloo, 2.5")
for axis in (plot.xaxis, plot.yaxis):  # about a decade: plain numbers
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 1.5, 2, 3, 5, 7)))
    axis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
    axis.set_minor_locator(matplotlib.ticker.NullLocator())
plot.set_xlabel(f"D - {OFFSET} d [mm]")
plot.set_ylabel("mass flow W [g/s]")
plot.grid(alpha=0.3, which="both")
plot.legend()
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
