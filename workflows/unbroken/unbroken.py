#!/usr/bin/env python3
"""Piles of whole rocks and of rocks cut into cells that hold. usage: unbroken.py TABLE.md CHART.svg CHART.png whole-K... cut-K...

All are means over the mass, so that pieces count as the rock that they are of.
bed        just before the tube moves: its height is twice that of the centre of mass; solid fraction is the volume of the rocks over that of the tube up to there
heap       at the end: its height is four times that of the centre of mass and its radius 3/2 of the mean distance from the axis, those of a cone with these means; the angle
           is that of this cone
difference of the means, cut less whole, with two standard errors from the scatter of seeds
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
from run_record import case_of, record_of, si  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
MEASURES = ("height of the bed [mm]", "solid fraction of the bed", "height of the heap [mm]", "radius of the heap [mm]", "angle of the heap [degrees]")
DIGITS = (1, 4, 1, 1, 1)


def measure(name):
    record = record_of(name)
    case, run = case_of(record), scree.open(f"{name}.run")
    tube, density = case["walls"][1], si(case["materials"]["stone"]["density"])
    start, radius = si(tube["motion"]["start"]), si(tube["shape"]["cylinder"]["radius"])
    rows = []
    for frame in run.frames:
        b = frame.bodies
        rows.append((frame.time, np.average(b.position[:, 2], weights=b.mass), np.average(np.hypot(b.position[:, 0], b.position[:, 1]), weights=b.mass), b.mass.sum()))
    time, up, out, mass = np.array(rows).T
    settled = int(np.argmin(np.abs(time - start)))
    bed, heap, reach = 2 * up[settled], 4 * up[-1], 1.5 * out[-1]
    log = run.log
    kinetic = log["kinetic_translational"] + log["kinetic_rotational"]
    return {"values": (1e3 * bed, mass[settled] / density / (np.pi * radius**2 * bed), 1e3 * heap, 1e3 * reach, np.degrees(np.arctan2(heap, reach))), "time": time, "up": up, "out": out,
            "moves": kinetic[-1] / kinetic.max(), "steps": record["steps"], "seconds": record["wall_seconds"],
            "broken": log["bonds"][0] - log["bonds"][-1] if "bonds" in log else 0, "lost": 1 - mass[-1] / mass[0]}


runs = {name: measure(name) for name in NAMES}
groups = {kind: [runs[n] for n in NAMES if n.startswith(kind)] for kind in ("whole", "cut")}
values = {kind: np.array([r["values"] for r in group]) for kind, group in groups.items()}


def scatter(x):
    return x.std(axis=0, ddof=1) if len(x) > 1 else np.full(x.shape[1], np.nan)


with open(TABLE, "w", encoding="utf-8") as file:
    piles = [f"{len(group)} {kind} pile{'s' if len(group) > 1 else ''}" for kind, group in groups.items()]
    file.write(f"| mean +- scatter of single piles | {' | '.join(piles)} | difference |\n|---|---|---|---|\n")
    error = 2 * np.sqrt(sum(scatter(v)**2 / len(v) for v in values.values()))
    for k, (name, d) in enumerate(zip(MEASURES, DIGITS)):
        cells = [f"{v[:, k].mean():.{d}f}" + (f" +- {scatter(v)[k]:.{d}f}" if len(v) > 1 else "") for v in values.values()]
        difference = f"{values['cut'][:, k].mean() - values['whole'][:, k].mean():+.{d}f}" + (f" +- {error[k]:.{d}f}" if np.isfinite(error[k]) else "")
        file.write(f"| {name} | {' | '.join(cells)} | {difference} |\n")
    file.write("\n| | steps | wall time [s] | kinetic energy at the end over its peak | mass that rolled away | bonds that broke |\n|---|---|---|---|---|---|\n")
    for kind, group in groups.items():
        file.write(f"| {kind} | {np.mean([r['steps'] for r in group]):.0f} | {np.mean([r['seconds'] for r in group]):.0f} | {np.max([r['moves'] for r in group]):.1e} | "
                   f"{np.mean([r['lost'] for r in group]):.3f} | {sum(r['broken'] for r in group):.0f} |\n")

figure, axes = plt.subplots(1, 3, figsize=(13, 4))
for kind, colour in (("whole", "#0072B2"), ("cut", "#D55E00")):
    for k, r in enumerate(groups[kind]):
        label = kind if k == 0 else None
        axes[0].plot(1e3 * r["time"], 1e3 * r["up"], color=colour, lw=0.9, label=label)
        axes[1].plot(1e3 * r["time"], 1e3 * r["out"], color=colour, lw=0.9, label=label)
    axes[2].plot(values[kind][:, 1], values[kind][:, 4], "o" if kind == "whole" else "s", color=colour, label=kind)
axes[0].set(xlabel="time [ms]", ylabel="height [mm]", title="centre of mass", ylim=(0, None))
axes[1].set(xlabel="time [ms]", ylabel="distance [mm]", title="mean distance from the axis", ylim=(0, None))
axes[2].set(xlabel=MEASURES[1], ylabel=MEASURES[4], title="each pile")
axes[2].locator_params(axis="x", nbins=5)  # labels of four decimals
for a in axes:
    a.legend(frameon=False)
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
