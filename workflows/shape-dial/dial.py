#!/usr/bin/env python3
"""The answers of one case with several shapes, against their cost. usage: dial.py TABLE.md TABLE.csv CHART.svg CHART.png NAME...

The first run is what the others are held against. Angles are means over the frames that statistics.json tells of, with their 95 % intervals;
the cost is the time of the run on the ranks and threads that it had.
"""
import csv
import json
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import record_of  # noqa: E402

TABLE, CSV, SVG, PNG, *NAMES = sys.argv[1:]
QUANTITIES = ["angle_of_repose", "coordination_number", "solid_fraction"]
COLUMNS = ["run", *(f"{name}{end}" for name in QUANTITIES for end in ("", "_ci95")), "steps", "seconds", "us_per_body_and_step"]


def row_of(name):
    with open(f"{name}.statistics/statistics.json", encoding="utf-8") as file:
        numbers = json.load(file)["groups"]["all"]
    record = record_of(name)
    row = {"run": name.removeprefix("dial-"), "steps": record["steps"], "seconds": record["wall_seconds"],
           "us_per_body_and_step": 1e6 * record["wall_seconds"] / record["steps"] / record["bodies"]}
    for quantity in QUANTITIES:
        entry = numbers.get(quantity, {})  # too few grains have no angle
        row[quantity], row[f"{quantity}_ci95"] = entry.get("mean"), entry.get("ci95")
    return row


def text(value, form):
    return "" if value is None else format(value, form)


rows = [row_of(name) for name in NAMES]
first = rows[0]
with open(CSV, "w", newline="", encoding="utf-8") as file:
    table = csv.DictWriter(file, COLUMNS)
    table.writeheader()
    table.writerows(rows)
with open(TABLE, "w", encoding="utf-8") as file:
    file.write(f"| shape | angle of repose [deg] | against {first['run']} | coordination number | solid fraction | steps | run time [s] | us a grain and step |\n"
               "|---|---|---|---|---|---|---|---|\n")
    for row in rows:
        angle = row["angle_of_repose"]
        off = None if angle is None or first["angle_of_repose"] is None else angle - first["angle_of_repose"]
        file.write(f"| {row['run']} | {text(angle, '.1f')} | {text(off, '+.1f')} | {text(row['coordination_number'], '.2f')} | {text(row['solid_fraction'], '.3f')} | "
                   f"{row['steps']} | {row['seconds']:.1f} | {row['us_per_body_and_step']:.2f} |\n")

COLOURS = ["#000000", "#0072B2", "#56B4E9", "#009E73", "#D55E00", "#E69F00", "#CC79A7"]
MARKERS = "osDv^P*X"
figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for number, row in enumerate(rows):
    if row["angle_of_repose"] is not None:
        plot.errorbar(row["seconds"], row["angle_of_repose"], row["angle_of_repose_ci95"] or 0, fmt=MARKERS[number % len(MARKERS)],
                      color=COLOURS[number % len(COLOURS)], capsize=3, label=row["run"])
if first["angle_of_repose"] is not None:
    plot.axhline(first["angle_of_repose"], color=COLOURS[0], linewidth=1, linestyle="--")
plot.set_xscale("log")
plot.set_xlabel("run time [s]")
plot.set_ylabel("angle of repose [deg]")
plot.grid(alpha=0.3, which="both")
if plot.get_legend_handles_labels()[0]:
    plot.legend(fontsize="small")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
