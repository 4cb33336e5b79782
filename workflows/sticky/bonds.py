#!/usr/bin/env python3
"""Angles of heaps and heights of columns against the Bond number. usage: bonds.py TABLE.md CHART.svg CHART.png NAME ...

angle     of the heap at the end, NAME.end/statistics.json; none where no cone fits: a column stands, or a lump lies
height    of what a tube that is pulled away fast leaves, over that before: 95 % of the grains' centres lie below
unconfined  strength: NAME-unconfined.run, the column pressed between smooth plates without tube and gravity: mean of both plates' forces over the
          cross section, which widens as the height is reduced; the largest mean over 2 % of the height up to a strain of 15 %, from the moment at which
          both plates are touched. A column of density rho stands up to 2 / (rho g) times this (4 c / (rho g) tan(45 + phi / 2), c and phi of a soil)
Rumpf     tensile strength Z Bo / 6 in rho g d (H. Rumpf 1958) of a bed with Z contacts a grain; times the tangent of the dry angle of friction,
          30 degrees, a cohesion c, with which a column stands up to 4 c / (rho g) tan(45 + 15 degrees)
"""
import json
import math
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
COLOURS = {"ball": "#0072B2", "rock": "#D55E00"}
SIZE, FRICTION, LEAVES = 4e-3, math.radians(30), 0.25   # m, rad, s: when the tube is pulled (case.toml)
TUBE, G = 15e-3, 9.81   # m, m/s^2: radius of the tube
STRAIN, SMOOTHED = 0.15, 0.02   # of the unconfined test, as in ASTM D 2166, and over how much of the height forces are averaged


def angle_of(name):
    with open(f"{name}.end/statistics.json", encoding="utf-8") as file:
        angle = json.load(file)["groups"]["all"].get("angle_of_repose")
    return angle["mean"] if angle else None


def height_of(frame):
    return np.quantile(frame.bodies.position[:, 2], 0.95)


def column_of(name):
    """Height left over the height before the tube leaves, that height in grains, and contacts a grain before."""
    run = scree.open(f"{name}.run")
    before = [frame for frame in run.frames if frame.time <= LEAVES][-1]
    touching = {(a, b) for a, b, n in zip(before.contacts.body_a, before.contacts.body_b, before.contacts.normal_force) if n != 0}   # a pair may have several contacts
    contacts = 2 * len(touching) / len(before.bodies.id)
    return height_of(run.frames[-1]) / height_of(before), height_of(before) / SIZE, contacts


def unconfined(name):
    """Strength [Pa], and the height in grains that stands by it; None without such a run."""
    if not os.path.exists(f"{name}-unconfined.run"):
        return None
    case, run = case_of(record_of(f"{name}-unconfined")), scree.open(f"{name}-unconfined.run")
    lid = case["walls"][1]
    plates = [wall.id for wall in run.scene.walls.in_order]
    time = run.log["time"]
    height = si(lid["shape"]["plane"]["point"][2]) + si(lid["motion"]["translate"]["velocity"][2]) * 0.5 * (time[1:] + time[:-1])
    forces = np.abs([np.diff(run.log[f"wall{plate}_impulse_z"]) / np.diff(time) for plate in plates])
    touched = np.argmax(forces.min(axis=0) > 0)
    start = height[touched]
    strain = 1 - height / start
    held = forces.mean(axis=0) / (math.pi * TUBE**2) * (1 - strain)
    width = max(1, int(SMOOTHED * start / (height[0] - height[1])))
    smooth = np.convolve(held[touched:], np.ones(width) / width, "valid")
    strength = smooth[strain[touched:][:len(smooth)] <= STRAIN].max()
    density = run.frames[0].bodies.mass.sum() / (math.pi * TUBE**2 * start)
    return strength, 2 * strength / (density * G) / SIZE


def number(value, form):
    return "" if value is None else format(value, form)


shapes, rows = {}, {}
for name in NAMES:
    _, shape, bond, *column = name.split("-")
    row = rows.setdefault((shape, float(bond)), {})
    row["column" if column else "angle"] = column_of(name) if column else angle_of(name)
    if column:
        row["unconfined"] = unconfined(name)
    shapes.setdefault(shape, []).append(float(bond))

lines = ["| grains | Bond number | angle of the heap [deg] | height of the column at the end / at the start | height at the start [grains] | unconfined strength [Pa] | "
         "height that stands by it [grains] | height that stands by Rumpf [grains] |", "|---|---|---|---|---|---|---|---|"]
for (shape, bond), row in rows.items():
    column = row.get("column")
    strength = column[2] * bond / 6 if column else None
    stands = 4 * strength * math.tan(FRICTION) * math.tan(math.pi / 4 + FRICTION / 2) if column else None
    angle = number(row.get("angle"), ".1f") or "no cone"
    pressed = row.get("unconfined") or (None, None)
    lines.append(f"| {shape} | {bond:g} | {angle} | {number(column and column[0], '.2f')} | {number(column and column[1], '.1f')} | {number(pressed[0], '.0f')} | "
                 f"{number(pressed[1], '.1f')} | {number(stands, '.1f')} |")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("# Grains that stick\n\n" + "\n".join(lines) + "\n")

figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6), layout="constrained")
for shape in shapes:
    points = [(bond, row) for (of, bond), row in rows.items() if of == shape]
    heaps = [(bond, row["angle"]) for bond, row in points if row.get("angle") is not None]
    left.plot(*zip(*heaps), "o-", color=COLOURS[shape], label=f"{shape}s") if heaps else None
    columns = [(bond, row["column"][0]) for bond, row in points if "column" in row]
    right.plot(*zip(*columns), "o-", color=COLOURS[shape], label=f"{shape}s") if columns else None
left.set_ylabel("angle of the heap [deg]")
right.set_ylabel("height of the column, end / start [-]")
right.set_ylim(0, 1.05)
for axes in (left, right):
    axes.set_xscale("symlog", linthresh=0.5)
    axes.set_xlim(-0.1, 26)
    axes.set_xticks([0, 0.5, 1, 5, 20], ["0", "0.5", "1", "5", "20"])
    axes.set_xlabel("Bond number")
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False)
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
