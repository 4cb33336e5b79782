#!/usr/bin/env python3
"""Stress, volume and strength of a triaxial test. usage: strength.py TABLE.md CHART.svg CHART.png NAME ...

stress    of a direction: mean force of its two platens over the area between the other four, as it is then
strain    axial, from the moment at which the lower platen starts; volume strain is positive where grains dilate
strength  sin phi = (s1 - s3) / (s1 + s3): at its peak (mean of 1 % of strain), and at the end (mean of the last 5 %)
pressed   mean of the three stresses over that asked, just before the shear, and their largest difference
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
COLOURS = ["#2a6f97", "#bc6c25", "#606c38", "#7b2d8b"]


def read(name):
    """Strain, volume strain, s1, s3, and what the servos held before the shear."""
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    walls = {wall["name"]: wall for wall in case["walls"]}
    ids = {wall.name: wall.id for wall in run.scene.walls.in_order}
    log = run.log
    time = log["time"]
    starts = si(walls["-z"]["motion"]["start"])
    rises = si(walls["-z"]["motion"]["translate"]["velocity"][2]) * np.maximum(0, time - starts)
    at = {n: abs(si(walls[n]["shape"]["plane"]["point"]["xyz".index(n[1])])) for n in ids}
    length = {k: at["-" + k] + at["+" + k] - log[f"wall{ids['+' + k]}_way"] for k in "xyz"}
    length["z"] = length["z"] - rises
    force = {k: 0.5 * (log[f"wall{ids['+' + k]}_force_{k}"] - log[f"wall{ids['-' + k]}_force_{k}"]) for k in "xyz"}
    stress = {k: force[k] * length[k] / (length["x"] * length["y"] * length["z"]) for k in "xyz"}
    sheared = time >= starts
    before = time < starts
    strain = (rises / length["z"][before][-1])[sheared]
    volume = length["x"] * length["y"] * length["z"]
    held = np.array([force[k][before][-3:].mean() for k in "xyz"])
    servo = walls["+x"]["motion"]["servo"]
    asked = si(servo["stress"]) * si(servo["area"])
    return {"p": si(servo["stress"]), "strain": strain, "dilates": volume[sheared] / volume[before][-1] - 1,
            "s1": stress["z"][sheared], "s3": 0.5 * (stress["x"] + stress["y"])[sheared], "held": held / asked}


def angle(s1, s3):
    return np.degrees(np.arcsin((s1 - s3) / (s1 + s3)))


lines = ["| set stress | before shear: force / set force | peak friction angle | at axial strain | friction angle at the end | change of volume |", "| --- | --- | --- | --- | --- | --- |"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
peaks = []
for name, colour in zip(NAMES, COLOURS):
    r = read(name)
    strain, ratio = r["strain"], r["s1"] / r["s3"]
    held = f"{r['held'].min():.4f} to {r['held'].max():.4f}"
    if strain[-1] < 0.05:
        lines.append(f"| {1e-3 * r['p']:.0f} kPa | {held} | sheared by {100 * strain[-1]:.1f} % only | | | |")
        continue
    width = max(1, int(np.searchsorted(strain, 0.01)))
    smooth = np.convolve(angle(r["s1"], r["s3"]), np.ones(width) / width, mode="valid")
    top = int(smooth.argmax())
    end = strain > strain[-1] - 0.05
    peaks.append(smooth[top])
    lines.append(f"| {1e-3 * r['p']:.0f} kPa | {held} | {smooth[top]:.1f} degrees | {100 * strain[top + width // 2]:.0f} % | "
                 f"{angle(r['s1'], r['s3'])[end].mean():.1f} degrees | {100 * r['dilates'][-1]:+.1f} % |")
    left.plot(100 * strain, ratio, color=colour, linewidth=0.9, label=f"{1e-3 * r['p']:.0f} kPa")
    right.plot(100 * strain, 100 * r["dilates"], color=colour, linewidth=0.9, label=f"{1e-3 * r['p']:.0f} kPa")
left.set_ylabel("s1 / s3")
right.set_ylabel("volume strain [%]")
for axes in (left, right):
    axes.set_xlabel("axial strain [%]")
    if peaks:
        axes.legend(frameon=False)
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
if len(peaks) > 1:
    lines += ["", f"Strength at the peak over the pressures: {np.mean(peaks):.1f} degrees, {max(peaks) - min(peaks):.1f} degrees between them."]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Triaxial test\n\n" + "\n".join(lines) + "\n")
