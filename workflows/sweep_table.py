#!/usr/bin/env python3
"""The tables and the chart of a sweep. usage: sweep_table.py POINTS QUANTITY TABLE.csv MEANS.csv CHART.svg CHART.png

POINTS is JSON: name of a run -> {"case": ..., key of the case: value, ...}. The numbers are the means over time of
NAME.statistics/statistics.json, of all bodies and walls.

    TABLE.csv   one row for each run: QUANTITY_mean over time, and QUANTITY_ci95, half of the 95 % interval of this mean within the run
    MEANS.csv   one row for each point: n seeds, QUANTITY_mean over the seeds, and QUANTITY_half, half of the 95 % interval over the seeds (Student's t). Empty where
                a run of the point has no such number; the half width is empty where there is one seed
    CHART       the rows of MEANS.csv. Bars are QUANTITY_half; of a point with one seed, QUANTITY_ci95 of its run. The chart says which
"""
import csv
import json
import math
import re
import sys
from pathlib import Path

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

from run_record import quantity_of, record_of  # noqa: E402  beside this script
from sweep_quantity import Wrong, all_numbers, entry_of, statistics_of  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "post" / "python"))
from scree.intervals import student_quantile  # noqa: E402

POINTS, QUANTITY, TABLE, MEANS, *CHARTS = json.loads(sys.argv[1]), *sys.argv[2:]
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


def number_of(name, quantity, kind="mean"):
    """A number of a run; None where the run has none."""
    value = runs[name][0].get(quantity, {}).get(kind)
    return value if value is not None and math.isfinite(value) else None


def place_of(value):
    """What a value is, whatever its unit: "10 mm" and "1 cm" are one place."""
    known = quantity_of(value.strip().strip('"'))
    return value if known is None else (float(f"{known[0]:.12g}"), known[1])


def over_seeds(names, quantity):
    """(mean, half of the 95 % interval) over the runs of a point; None for what there is not."""
    samples = [number_of(name, quantity) for name in names]
    if None in samples:
        return None, None
    mean, n = math.fsum(samples) / len(samples), len(samples)
    if n == 1:
        return mean, None
    return mean, student_quantile(n) * math.sqrt(math.fsum((x - mean) ** 2 for x in samples) / (n - 1) / n)


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

# a point is a case with values of all keys but the seed; a run that stands there twice, with the same seed, counts once
varied = [key for key in keys if key != "seed"]
points = {}   # what the values are -> {seed: run}
for name, point in POINTS.items():
    points.setdefault((point["case"], *(place_of(point[key]) for key in varied)), {}).setdefault(place_of(point.get("seed", "")), name)
points = [list(of_seed.values()) for of_seed in points.values()]
with open(MEANS, "w", newline="", encoding="utf-8") as file:
    table = csv.writer(file)
    table.writerow(["case", *varied, "n", *(f"{name}_{kind}" for name in names for kind in ("mean", "half"))])
    for of_point in points:
        point = POINTS[of_point[0]]
        table.writerow([point["case"], *(point[key] for key in varied), len(of_point), *(number for quantity in names for number in over_seeds(of_point, quantity))])

# one line for each setting of all keys but the first; a sweep of seeds alone has its runs, and their mean as a level
axis = (varied or ["seed"])[0]
scale = scale_of(sorted({point[axis] for point in POINTS.values()})) if keys else None
drawn = points if varied or not keys else [[name] for name in POINTS]
lines, seeds = {}, set()
for of_point in drawn:
    point = POINTS[of_point[0]]
    label = ", ".join([point["case"]] + [f"{key} = {point[key]}" for key in varied[1:]])
    mean, half = over_seeds(of_point, QUANTITY)
    bar = half if len(of_point) > 1 else number_of(of_point[0], QUANTITY, "ci95")
    place = scale[0][point[axis]] if scale else point.get(axis, "all")
    lines.setdefault(label, []).append((place, math.nan if mean is None else mean, bar or 0))
    seeds.add(len(of_point))

figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for number, (label, line) in enumerate(lines.items()):
    colour = COLOURS[number % len(COLOURS)]
    plot.errorbar(*zip(*(sorted(line) if scale else line)), marker=MARKERS[number % len(MARKERS)], color=colour, capsize=3, label=label)
    if drawn is not points:
        mean, half = over_seeds(points[number], QUANTITY)
        if half is not None:
            plot.axhspan(mean - half, mean + half, color=colour, alpha=0.15, linewidth=0)
            plot.axhline(mean, color=colour, linestyle="--", linewidth=0.8)
bars = ([f"over {' or '.join(map(str, sorted(seeds - {1})))} seeds"] if seeds - {1} else []) + (["within the run" if seeds == {1} else "within the run (one seed)"] if 1 in seeds else [])
plot.set_title(f"bars: 95 % interval {', '.join(bars)}" + ("; band: over seeds" if drawn is not points else ""), fontsize="small")
unit = next(numbers[QUANTITY]["unit"] for numbers, _, _ in runs.values() if QUANTITY in numbers)
plot.set_xlabel(axis + (f" [{scale[1]}]" if scale and scale[1] else ""))
plot.set_ylabel(QUANTITY.replace("_", " ") + (f" [{unit}]" if unit not in ("", "-") else ""))
plot.grid(alpha=0.3)
if len(lines) > 1:
    plot.legend(fontsize="small")
for chart in CHARTS:
    figure.savefig(chart, dpi=150, metadata={"Date": None} if chart.endswith("svg") else None)
