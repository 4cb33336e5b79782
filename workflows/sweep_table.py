#!/usr/bin/env python3
"""The table and the chart of a sweep. usage: sweep_table.py POINTS QUANTITY TABLE.csv CHART.svg CHART.png

POINTS is JSON: name of a run -> {"case": ..., key of the case: value, ...}. The numbers are the means over time of
NAME.statistics/statistics.json, of all bodies and walls; error bars are 95 % intervals over replicas, or over time when there is one only.
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

from run_record import quantity_of, record_of  # noqa: E402  beside this script
from sweep_quantity import Wrong, all_numbers, entry_of, statistics_of  # noqa: E402

POINTS, QUANTITY, TABLE, *CHARTS = json.loads(sys.argv[1]), *sys.argv[2:]
MARKERS = "osD^vP*X"
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]   # Okabe and Ito (2008): told apart by all


def scale_of(values):
    """What places the values of an axis: text -> number, and the unit of the numbers. Where all have one unit they keep it, else they are
    in SI; a number alone is SI. None when one of them is a word, or when they are not of one kind."""
    known = [quantity_of(value.strip().strip('"')) for value in values]
    if None in known or len({powers for _, powers in known if any(powers)}) > 1:
        return None
    units = {re.sub(r"^[-+0-9.]+(?:[eE][-+]?[0-9]+)?", "", value.strip().strip('"')).strip() for value in values}
    factor = quantity_of("1 " + next(iter(units)))[0] if len(units) == 1 else 1
    numbers = {value: number / factor for value, (number, _) in zip(values, known)}
    return numbers, next(iter(units)) if len(units) == 1 else "SI"


def read(name):
    statistics = statistics_of(name)
    numbers = all_numbers(name, statistics)
    drawn = entry_of(QUANTITY, name, statistics)
    if drawn:
        numbers[QUANTITY] = drawn
    return numbers, record_of(name), statistics.get("gaps", {})


try:
    runs = {name: read(name) for name in POINTS}
except Wrong as reason:
    sys.exit(f"sweep_table: error: {reason}")
keys = [key for key in next(iter(POINTS.values())) if key != "case"]
names = sorted(set().union(*(numbers for numbers, _, _ in runs.values())))
for name, (_, _, gaps) in runs.items():
    if QUANTITY in gaps:
        print(f"sweep_table: note: {name}: {QUANTITY}: {gaps[QUANTITY]}", file=sys.stderr)
if QUANTITY not in names:
    sys.exit(f"sweep_table: error: there is no quantity '{QUANTITY}' in these runs; there are: {', '.join(names)}")

with open(TABLE, "w", newline="", encoding="utf-8") as file:
    table = csv.writer(file)
    table.writerow(["run", "case", *keys, "outcome", "steps", "wall_seconds", *(f"{name}_{kind}" for name in names for kind in ("mean", "ci95"))])
    for name, (numbers, record, _) in runs.items():
        row = [name, POINTS[name]["case"], *(POINTS[name][key] for key in keys), record["outcome"], record["steps"], record["wall_seconds"]]
        for quantity in names:
            entry = numbers.get(quantity, {})
            row += [entry.get("mean"), entry.get("ci95")]
        table.writerow(row)

# one line for each setting of all keys but the first, replicas taken together
axis = keys[0] if keys else "seed"
scale = scale_of(sorted({point[axis] for point in POINTS.values()})) if keys else None
lines = {}
for name, (numbers, _, _) in runs.items():
    point = POINTS[name]
    label = ", ".join([point["case"]] + [f"{key} = {point[key]}" for key in keys[1:] if key != "seed"])
    entry = numbers.get(QUANTITY, {"mean": math.nan, "ci95": None})
    place = scale[0][point[axis]] if scale else point.get(axis, "all")   # "10 mm" and "1 cm" are one place
    lines.setdefault(label, {}).setdefault(place, []).append(entry)

figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for number, (label, line) in enumerate(lines.items()):
    places = sorted(line) if scale else list(line)
    means, bars = [], []
    for place in places:
        samples = [entry["mean"] for entry in line[place]]
        mean = sum(samples) / len(samples)
        if len(samples) > 1:
            deviation = math.sqrt(sum((x - mean) ** 2 for x in samples) / (len(samples) - 1))
            bar = student.ppf(0.975, len(samples) - 1) * deviation / math.sqrt(len(samples))
        else:
            bar = line[place][0]["ci95"] or 0
        means.append(mean)
        bars.append(bar)
    plot.errorbar(places, means, bars, marker=MARKERS[number % len(MARKERS)], color=COLOURS[number % len(COLOURS)], capsize=3, label=label)
unit = next(numbers[QUANTITY]["unit"] for numbers, _, _ in runs.values() if QUANTITY in numbers)
plot.set_xlabel(axis + (f" [{scale[1]}]" if scale and scale[1] else ""))
plot.set_ylabel(QUANTITY.replace("_", " ") + (f" [{unit}]" if unit not in ("", "-") else ""))
plot.grid(alpha=0.3)
if len(lines) > 1:
    plot.legend(fontsize="small")
for chart in CHARTS:
    figure.savefig(chart, dpi=150, metadata={"Date": None} if chart.endswith("svg") else None)
