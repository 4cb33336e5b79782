#!/usr/bin/env python3
"""How many times faster Scree is than each program on the same input, with both errors. usage: ratios.py FOLDER TABLE.md CHART.svg CHART.png

FOLDER has what tests/benchmarks/peers/run wrote: triangles.csv, meshes.csv, scenes.csv, spheres.csv, as far as they were run.
"""
import csv
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "benchmarks", "peers"))
sys.dont_write_bytecode = True
import summary  # noqa: E402

FOLDER, TABLE, SVG, PNG = sys.argv[1:]


def rows_of(name):
    path = os.path.join(FOLDER, name + ".csv")
    if not os.path.exists(path):
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


# input, other program, ratio, Scree's error, the other's: errors as the part measures them (README of tests/benchmarks/peers)
ratios = []
triangles = rows_of("triangles")
for pairs in dict.fromkeys(row["pairs"] for row in triangles):
    own, *others = [row for row in triangles if row["pairs"] == pairs]
    for row in others:
        if not row["program"].startswith("Scree"):
            ratios.append((f"two triangles, {pairs}", row["program"], float(row["times_scree"]), own["error_max"], row["error_max"]))
meshes = rows_of("meshes")
for row in meshes:
    if row["program"].startswith("Scree"):
        other = next(r for r in meshes if (r["triangles"], r["gap"]) == (row["triangles"], row["gap"]) and not r["program"].startswith("Scree"))
        ratios.append((f"two rocks of {row['triangles']} triangles, gap {row['gap']} R: {row['program'].removeprefix('Scree ')}", other["program"],
                       float(row["fcl_over_it"]), row["error_max"], other["error_max"]))
scenes = summary.summarise(rows_of("scenes"))
for record in scenes:
    if record["program"] != "Scree" and "ratio" in record:
        own = next(r for r in scenes if (r["family"], r["state"], r["program"]) == (record["family"], record["state"], "Scree"))
        ratios.append((f"steps of a bed of {record['family']}, {record['state']}", record["program"], record["ratio"],
                       summary.text_of(own["depth_share"], ".1e"), summary.text_of(record["depth_share"], ".1e")))

with open(TABLE, "w", encoding="utf-8") as file:
    if ratios:
        file.write("| input | against | Scree is faster by | error of Scree | of the other |\n|---|---|---|---|---|\n")
        for name, program, ratio, own, other in ratios:
            file.write(f"| {name} | {program} | {ratio:.3g} | {own} | {other} |\n")
    else:
        file.write("No other program is installed; ./setup --peers installs them, then build again.\n")
    file.write("\n" + summary.table(scenes + summary.summarise(rows_of("spheres"))) + "\n")

figure, plot = plt.subplots(figsize=(9, 1.5 + 0.22 * len(ratios)), layout="constrained")
programs = list(dict.fromkeys(program for _, program, *_ in ratios))
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#999999", "#000000"]
for place, (name, program, ratio, *_) in enumerate(ratios):
    plot.barh(place, ratio - 1, left=1, color=COLOURS[programs.index(program) % len(COLOURS)])
    plot.text(ratio, place, f" {ratio:.3g}", va="center", fontsize=7)
plot.set_yticks(range(len(ratios)), [f"{name}: {program}" for name, program, *_ in ratios], fontsize=7)
plot.invert_yaxis()
plot.set_xscale("log")
plot.axvline(1, color="#000000", linewidth=1)
plot.set_xlabel("time of the other program over that of Scree" if ratios else "no other program is installed")
plot.grid(alpha=0.3, axis="x", which="both")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
