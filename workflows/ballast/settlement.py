#!/usr/bin/env python3
"""Settlement of a sleeper against load cycles. usage: settlement.py TABLE.md CHART.svg CHART.png PICTURE.png LOWEST HIGHEST FREQUENCY NAME ...

NAME.csv has time, load and height of the sleeper, from load.py. Settlement is that at the lowest load, since the start of the first cycle. s(N) = s1 (1 + C log10 N) is
fitted by least squares to all cycles. The stiffness of a cycle is the change of the load over the way of the sleeper, from the lowest to the highest load. The loss of a cycle is the area of
its loop; over all cycles it must be the dissipated energy of log.csv, with what bodies lose in height and what contacts store. Intervals are Student's over the seeds.
"""
import csv
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
sys.dont_write_bytecode = True
import scree  # noqa: E402
from load import RAMP, REST  # noqa: E402
from run_record import si, with_interval  # noqa: E402

TABLE, SVG, PNG, PICTURE, LOWEST, HIGHEST, FREQUENCY, *NAMES = sys.argv[1:]
COLOURS = ["#2a6f97", "#bc6c25", "#606c38", "#7b2d8b", "#9a031e"]
lowest, highest, frequency = si(LOWEST), si(HIGHEST), si(FREQUENCY)


def read(name):
    with open(f"{name}.csv", encoding="utf-8", newline="") as file:
        rows = np.array([[float(row[key]) for key in ("time", "load", "height")] for row in csv.DictReader(file)])
    time, load, height = rows.T
    if np.diff(time).max() > 1.5 * np.median(np.diff(time)):
        sys.exit(f"settlement.py: {name}.csv has no rows after {time[np.diff(time).argmax()]:.4g} s for {np.diff(time).max():.2g} s; remove {name}.run and run again")
    log = scree.open(f"{name}.run").log
    start = REST + RAMP
    cycles = int((log["time"][-1] - start) * frequency + 1e-3)
    if cycles < 1:
        sys.exit(f"settlement.py: {name} ends at {time[-1]:.3g} s, before the first cycle is over")
    ends = start + np.arange(cycles + 1) / frequency
    peaks = ends[:-1] + 0.5 / frequency
    at_rest, at_peak = np.interp(ends, time, height), np.interp(peaks, time, height)
    # work of the load in each cycle: trapezoids between the rows, with the ends of the cycle
    work = []
    for first, last in zip(ends[:-1], ends[1:]):
        inside = (time > first) & (time < last)
        f = np.concatenate([[np.interp(first, time, load)], load[inside], [np.interp(last, time, load)]])
        z = np.concatenate([[np.interp(first, time, height)], height[inside], [np.interp(last, time, height)]])
        work.append(-(0.5 * (f[1:] + f[:-1]) * np.diff(z)).sum())

    def change(*columns):
        return sum(np.interp(ends[-1], log["time"], log[column]) - np.interp(ends[0], log["time"], log[column]) for column in columns)

    return {"settlement": at_rest[0] - at_rest[1:], "stiffness": (highest - lowest) / (at_rest[:-1] - at_peak), "work": np.array(work), "dissipated": change("dissipated"),
            "fallen": -change("potential"), "stored": change("elastic", "elastic_tangential", "kinetic_translational", "kinetic_rotational"),
            "load": load[time >= start], "sunk": at_rest[0] - height[time >= start]}


runs = [read(name) for name in NAMES]
cycles = np.arange(1, len(runs[0]["settlement"]) + 1)
shown = [n for n in (1, 2, 5, 10, 20, 50, 100) if n <= cycles[-1]]
lines = ["| cycle | settlement [mm] | stiffness in loading [MN/m] | work of the load in the cycle [J] |", "|---|---|---|---|"]
for n in shown:
    lines.append(f"| {n} | {with_interval([1e3 * r['settlement'][n - 1] for r in runs], 2)} | {with_interval([1e-6 * r['stiffness'][n - 1] for r in runs], 2)} | "
                 f"{with_interval([r['work'][n - 1] for r in runs], 2)} |")
lines += ["", f"Beds: {len(runs)}; load {1e-3 * lowest:g} to {1e-3 * highest:g} kN at {frequency:g} Hz, {cycles[-1]} cycles."]
if len(cycles) > 4:
    fits = []
    for r in runs:
        slope, first = np.polyfit(np.log10(cycles), r["settlement"], 1)
        left = r["settlement"] - first - slope * np.log10(cycles)
        r["fit"] = first + slope * np.log10(cycles)
        fits.append((slope / first, 1 - left.var() / r["settlement"].var(), first, left.std() / (r["settlement"][-1])))
    constants, shares, firsts, errors = np.array(fits).T
    lines += ["", f"s(N) = s1 (1 + C log10 N): C = {with_interval(constants, 2)}, s1 = {with_interval(1e3 * firsts, 2)} mm; the line has {100 * shares.min():.1f} % of the variance or more, "
                  f"and is off by {100 * errors.max():.1f} % of the last settlement at most (rms)."]
    lines += ["", f"Stiffness of the last cycle over that of the first: {with_interval([r['stiffness'][-1] / r['stiffness'][0] for r in runs], 2)}. "
                  f"Work of the load in the last cycle over that in the first: {with_interval([r['work'][-1] / r['work'][0] for r in runs], 3)}."]
lines += ["", "| bed | area of all loops [J] | loss of height [J] | more stored at the end [J] | dissipated, by log.csv [J] | difference over dissipated |", "|---|---|---|---|---|---|"]
for name, r in zip(NAMES, runs):
    left = r["work"].sum() + r["fallen"] - r["stored"] - r["dissipated"]
    lines.append(f"| {name} | {r['work'].sum():.3f} | {r['fallen']:.3f} | {r['stored']:.3f} | {r['dissipated']:.3f} | {left / r['dissipated']:+.1e} |")
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Sleeper on ballast\n\n" + "\n".join(lines) + "\n")

figure, ((bed, left), (middle, right)) = plt.subplots(2, 2, figsize=(10, 7.4), layout="constrained")
shot = plt.imread(PICTURE)
seen = np.argwhere((shot[..., :3] < 0.97).any(axis=2))   # without the empty margins of the picture
(top, first), (bottom, last) = seen.min(axis=0), seen.max(axis=0)
bed.imshow(shot[top:bottom + 1, first:last + 1])
bed.set(title=f"{NAMES[0]} at the end")
bed.axis("off")
left.plot(1e3 * runs[0]["sunk"], 1e-3 * runs[0]["load"], color=COLOURS[0], linewidth=0.7)
left.set(xlabel="settlement of the sleeper [mm]", ylabel="load [kN]", title=f"Load and settlement, {NAMES[0]}")
for r, name, colour in zip(runs, NAMES, COLOURS * len(runs)):
    middle.semilogx(cycles, 1e3 * r["settlement"], "o", color=colour, markersize=3.5, label=name)
    if "fit" in r:
        middle.semilogx(cycles, 1e3 * r["fit"], color=colour, linewidth=0.9)
    right.plot(cycles, 1e-6 * r["stiffness"], "o-", color=colour, markersize=3.5, linewidth=0.9)
middle.set(xlabel="cycle N", ylabel="settlement [mm]", title="Lines: $s_1 (1 + C\\,\\log_{10} N)$", ylim=(0, None))
middle.set_xticks(shown, [str(n) for n in shown])
middle.minorticks_off()
middle.legend(frameon=False)
right.set(xlabel="cycle N", ylabel="stiffness in loading [MN/m]", title="Stiffness", xticks=shown, ylim=(0, None))
for path in (SVG, PNG):
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
