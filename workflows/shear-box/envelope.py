#!/usr/bin/env python3
"""Shear force against shear way, and the strength at several stresses. usage: envelope.py TABLE.md CHART.svg CHART.png SPLIT NAME ...

Forces on the plane of the split are those on the grains above it: along x what the upper half and the lid hold, along z the lid, the friction of the
sides of the upper half, and the weight of these grains. Stresses are these over the area of the box. The peak is the largest mean over 1 mm of way, the
end the mean of the last 2 mm. The line through the peaks has its cohesion free; the interval of both numbers is that of the fit.
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
from scree.intervals import student_quantile  # noqa: E402

TABLE, SVG, PNG, SPLIT, *NAMES = sys.argv[1:]
COLOURS = ["#2a6f97", "#bc6c25", "#606c38", "#7b2d8b"]


def read(name):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    walls = {wall["name"]: wall for wall in case["walls"]}
    ids = {wall.name: wall.id for wall in run.scene.walls.in_order}
    log, time = run.log, run.log["time"]
    motion, servo = walls["lower"]["motion"], walls["lid"]["motion"]["servo"]
    starts, speed, area = si(motion["start"]), si(motion["translate"]["velocity"][0]), si(servo["area"])
    force = {(wall, k): log[f"wall{ids[wall]}_force_{k}"] for wall in ids for k in "xz"}   # on the wall
    weight = []
    for frame in run.frames:
        bodies = frame.bodies
        mass = si(case["materials"]["sand"]["density"]) * np.pi / 6 * si(case["populations"][0]["size"]) ** 3
        weight.append(9.81 * mass * (bodies.position[:, 2] > float(SPLIT)).sum())
    above = np.interp(time, [frame.time for frame in run.frames], weight)
    shear = force["upper", "x"] + force["lid", "x"]
    normal = force["lid", "z"] + force["upper", "z"] + above
    after = time >= starts
    lid = -log[f"wall{ids['lid']}_way"]
    return {"asked": si(servo["stress"]), "way": speed * (time[after] - starts), "shear": shear[after] / area, "normal": normal[after] / area,
            "rises": (lid - lid[after][0])[after]}


def smooth(way, values, width):
    n = max(1, int(np.searchsorted(way, width)))
    return np.convolve(values, np.ones(n) / n, mode="valid")


lines = ["| stress of the lid | normal stress on the plane | peak shear stress | peak friction angle | at a way of | at the end | lid, at the end |", "|---|---|---|---|---|---|---|"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6), layout="constrained")
peaks = []
for name, colour in zip(NAMES, COLOURS):
    r = read(name)
    label = f"{1e-3 * r['asked']:.0f} kPa"
    left.plot(1e3 * r["way"], 1e-3 * r["shear"], color=colour, linewidth=0.9, label=label)
    if r["way"][-1] < 2.5e-3:
        lines.append(f"| {label} | | sheared by {1e3 * r['way'][-1]:.1f} mm only | | | | |")
        continue
    shear, normal = smooth(r["way"], r["shear"], 1e-3), smooth(r["way"], r["normal"], 1e-3)
    top = int((shear / normal).argmax())
    end = r["way"] > r["way"][-1] - 2e-3
    peaks.append((normal[top], shear[top]))
    lines.append(f"| {label} | {1e-3 * normal[top]:.1f} kPa | {1e-3 * shear[top]:.1f} kPa | {np.degrees(np.arctan2(shear[top], normal[top])):.1f} degrees | "
                 f"{1e3 * (r['way'][top] + 0.5e-3):.1f} mm | {np.degrees(np.arctan2(r['shear'][end].mean(), r['normal'][end].mean())):.1f} degrees | {1e3 * r['rises'][-1]:+.2f} mm |")
    right.plot(1e-3 * normal[top], 1e-3 * shear[top], "o", color=colour, label=label)
if len(peaks) > 2:
    x, y = 1e-3 * np.array(peaks).T
    (slope, cohesion), covariance = np.polyfit(x, y, 1, cov="unscaled")
    scatter = ((y - slope * x - cohesion) ** 2).sum() / (len(x) - 2)
    of_slope, of_cohesion = student_quantile(len(x) - 1) * np.sqrt(scatter * np.diag(covariance))
    angle = np.degrees(np.arctan(slope))
    lines += ["", f"Line through the peaks: friction angle {angle:.1f} +- {np.degrees(of_slope) / (1 + slope * slope):.1f} degrees, cohesion {cohesion:.1f} +- {of_cohesion:.1f} kPa."]
    reach = np.array([0, 1.1 * x.max()])
    right.plot(reach, cohesion + slope * reach, color="0.4", linestyle="--", linewidth=0.9)
left.set(xlabel="way of the lower half [mm]", ylabel="shear stress [kPa]")
right.set(xlabel="normal stress on the plane [kPa]", ylabel="peak shear stress [kPa]", xlim=(0, None), ylim=(0, None))
for axes in (left, right):
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False)
for path in (SVG, PNG):
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Shear box\n\n" + "\n".join(lines) + "\n")
