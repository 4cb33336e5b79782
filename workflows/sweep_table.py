#!/usr/bin/env python3
"""The table and the chart of a sweep. usage: sweep_table.py POINTS QUANTITY TABLE.csv CHART.svg CHART.png

POINTS is JSON: name of a run -> {"case": ..., key of the case: value, ...}. The numbers are the means over time of
NAME.statistics/statistics.json, of all bodies; error bars are 95 % intervals over replicas, or over time when there is one only.
"""
import csv
import json
import math
import re
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from scipy.stats import t as student  # noqa: E402

from run_record import record_of  # noqa: E402  beside this script

POINTS, QUANTITY, TABLE, *CHARTS = json.loads(sys.argv[1]), *sys.argv[2:]
UNITS = {"mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "ms": 1e-3, "us": 1e-6, "kN/m": 1e3, "MN/m": 1e6, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
MARKERS = "osD^vP*X"
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]   # Okabe and Ito (2008): told apart by all


def magnitude(text):
    """The value as a number for an axis, None for words; units of the same axis need not agree."""
    match = re.fullmatch(r'"?\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([^"]*)"?', text)
    return None if match is None else float(match[1]) * UNITS.get(match[2].strip(), 1)


def read(name):
    with open(f"{name}.statistics/statistics.json", encoding="utf-8") as file:
        numbers = json.load(file)["groups"]["all"]
    return numbers, record_of(name)


runs = {name: read(name) for name in POINTS}
keys = [key for key in next(iter(POINTS.values())) if key != "case"]
names = sorted(set().union(*(numbers for numbers, _ in runs.values())))
if QUANTITY not in names:
    sys.exit(f"sweep_table: there is no quantity '{QUANTITY}'; there are: {', '.join(names)}")

with open(TABLE, "w", newline="", encoding="utf-8") as file:
    table = csv.writer(file)
    table.writerow(["run", "case", *keys, "outcome", "steps", "wall_seconds", *(f"{name}_{kind}" for name in names for kind in ("mean", "ci95"))])
    for name, (numbers, record) in runs.items():
        row = [name, POINTS[name]["case"], *(POINTS[name][key] for key in keys), record["outcome"], record["steps"], record["wall_seconds"]]
        for quantity in names:
            entry = numbers.get(quantity, {})
            row += [entry.get("mean"), entry.get("ci95")]
        table.writerow(row)

# one line for each setting of all keys but the first, replicas taken together
axis = keys[0] if keys else "seed"
lines = {}
for name, (numbers, _) in runs.items():
    point = POINTS[name]
    label = ", ".join([point["case"]] + [f"{key} = {point[key]}" for key in keys[1:] if key != "seed"])
    entry = numbers.get(QUANTITY, {"mean": math.nan, "ci95": None})
    lines.setdefault(label, {}).setdefault(point.get(axis, "all"), []).append(entry)

figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
numeric = all(magnitude(value) is not None for line in lines.values() for value in line)
for number, (label, line) in enumerate(lines.items()):
    values = sorted(line, key=magnitude) if numeric else list(line)
    means, bars = [], []
    for value in values:
        samples = [entry["mean"] for entry in line[value]]
        mean = sum(samples) / len(samples)
        if len(samples) > 1:
            deviation = math.sqrt(sum((x - mean) ** 2 for x in samples) / (len(samples) - 1))
            bar = student.ppf(0.975, len(samples) - 1) * deviation / math.sqrt(len(samples))
        else:
            bar = line[value][0]["ci95"] or 0
        means.append(mean)
        bars.append(bar)
    places = [magnitude(value) for value in values] if numeric else values
    plot.errorbar(places, means, bars, marker=MARKERS[number % len(MARKERS)], color=COLOURS[number % len(COLOURS)], capsize=3, label=label)
unit = next(numbers[QUANTITY]["unit"] for numbers, _ in runs.values() if QUANTITY in numbers)
plot.set_xlabel(axis)
plot.set_ylabel(QUANTITY.replace("_", " ") + (f" [{unit}]" if unit not in ("", "-") else ""))
plot.grid(alpha=0.3)
if len(lines) > 1:
    plot.legend(fontsize="small")
for chart in CHARTS:
    figure.savefig(chart, dpi=150, metadata={"Date": None} if chart.endswith("svg") else None)
