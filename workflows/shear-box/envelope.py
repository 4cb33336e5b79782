#!/usr/bin/env python3
"""Shear force against shear way, and the strength at several stresses. usage: envelope.py TABLE.md NUMBERS.json CHART.svg CHART.png SPLIT NAME ...

Forces on the plane of the split are those on the grains above it: along x what the upper half and the lid hold, along z the lid, the friction of the
sides of the upper half, and the weight of these grains. Stresses are these over the area of the box. The strength is the largest ratio of both among means over
1 mm of way. Where the middle of this mean lies in the last 1 mm of the way, the ratio may still rise: the strength is a lower bound, and is marked as one. The
end is the mean of the last 2 mm. The line through the strengths has its cohesion free; the interval of both numbers is that of the fit.
"""
import itertools
import json
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

COLOURS = ["#2a6f97", "#bc6c25", "#606c38", "#7b2d8b"]
WINDOW, END, LEAST = 1e-3, 2e-3, 2.5e-3   # of the means, of the end, and of a test that has both [m of way]
RISING = "largest at the end"
COLUMNS = ["stress of the lid", "normal stress on the plane", "shear stress on the plane", "friction angle, largest mean over 1 mm", "middle of this mean at a way of",
           "mean of the last 2 mm", "lid, at the end"]


def read(name, split):
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
        weight.append(9.81 * mass * (bodies.position[:, 2] > split).sum())
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


def angle_of(shear, normal):
    return float(np.degrees(np.arctan2(shear, normal)))


def strength(way, shear, normal):
    """The mean over 1 mm with the largest ratio of shear stress to normal stress; None of a way that is too short for one."""
    if way[-1] < LEAST:
        return None
    means, loads = smooth(way, shear, WINDOW), smooth(way, normal, WINDOW)
    top, end = int((means / loads).argmax()), way > way[-1] - END
    middle = float(way[top] + WINDOW / 2)
    return {"normal_stress": float(loads[top]), "shear_stress": float(means[top]), "angle": angle_of(means[top], loads[top]), "way": middle,
            "is_largest_at_end": bool(middle > way[-1] - WINDOW), "angle_at_end": angle_of(shear[end].mean(), normal[end].mean())}


def line_through(strengths):
    """The straight line through normal and shear stresses, with intervals of 95 %; None of fewer than three."""
    if len(strengths) < 3:
        return None
    x, y = np.array([(s["normal_stress"], s["shear_stress"]) for s in strengths]).T
    slope, cohesion = np.polyfit(x, y, 1)
    scatter = ((y - slope * x - cohesion) ** 2).sum() / (len(x) - 2)
    centred = ((x - x.mean()) ** 2).sum()
    quantile = student_quantile(len(x) - 1)
    of_slope, of_cohesion = quantile * np.sqrt(scatter / centred), quantile * np.sqrt(scatter * (1 / len(x) + x.mean() ** 2 / centred))
    return {"angle": float(np.degrees(np.arctan(slope))), "angle_ci95": float(np.degrees(of_slope) / (1 + slope * slope)), "slope": float(slope),
            "cohesion": float(cohesion), "cohesion_ci95": float(of_cohesion), "lower_bounds": sum(s["is_largest_at_end"] for s in strengths)}


def row(label, r, s):
    if s is None:
        return f"| {label} | | sheared by {1e3 * r['way'][-1]:.1f} mm only | | | | |"
    angle = f">= {s['angle']:.1f} degrees, {RISING}" if s["is_largest_at_end"] else f"{s['angle']:.1f} degrees"
    return (f"| {label} | {1e-3 * s['normal_stress']:.1f} kPa | {1e-3 * s['shear_stress']:.1f} kPa | {angle} | {1e3 * s['way']:.1f} mm | {s['angle_at_end']:.1f} degrees | "
            f"{1e3 * r['rises'][-1]:+.2f} mm |")


def main():
    table, numbers, svg, png, split, *names = sys.argv[1:]
    lines = [f"| {' | '.join(COLUMNS)} |", "|" + "---|" * len(COLUMNS)]
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6), layout="constrained")
    tests = []
    for name, colour in zip(names, itertools.cycle(COLOURS)):
        r = read(name, float(split))
        s = strength(r["way"], r["shear"], r["normal"])
        label = f"{1e-3 * r['asked']:g} kPa"
        lines.append(row(label, r, s))
        tests.append({"run": name, "lid_stress": r["asked"], "sheared_by": float(r["way"][-1]), "lid_rise": float(r["rises"][-1]), "strength": s})
        left.plot(1e3 * r["way"], r["shear"] / r["normal"], color=colour, linewidth=0.9, label=label)
        if s is None:
            continue
        right.plot(1e-3 * s["normal_stress"], 1e-3 * s["shear_stress"], "^" if s["is_largest_at_end"] else "o", color=colour,
                   markerfacecolor="none" if s["is_largest_at_end"] else colour, label=f"{label}, {RISING}" if s["is_largest_at_end"] else label)
    found = [test["strength"] for test in tests if test["strength"]]
    line = line_through(found)
    if line:
        lines += ["", f"Line through the strengths: friction angle {line['angle']:.1f} +- {line['angle_ci95']:.1f} degrees, cohesion {1e-3 * line['cohesion']:.1f} +- "
                      f"{1e-3 * line['cohesion_ci95']:.1f} kPa" + (f"; {line['lower_bounds']} of {len(found)} strengths are lower bounds" if line["lower_bounds"] else "") + "."]
        reach = np.array([0, 1.1 * max(s["normal_stress"] for s in found)])
        right.plot(1e-3 * reach, 1e-3 * (line["cohesion"] + line["slope"] * reach), color="0.4", linestyle="--", linewidth=0.9)
    left.set(xlabel="way of the lower half [mm]", ylabel="shear stress / normal stress")
    right.set(xlabel="normal stress on the plane [kPa]", ylabel="shear stress, largest mean [kPa]", xlim=(0, None), ylim=(0, None))
    for axes in (left, right):
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False)
    for path in (svg, png):
        figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
    with open(table, "w", encoding="utf-8") as page:
        page.write("# Shear box\n\n" + "\n".join(lines) + "\n")
    with open(numbers, "w", encoding="utf-8") as file:
        json.dump({"units": "SI, angles in degrees", "tests": tests, "line": line}, file, indent=1)


if __name__ == "__main__":
    main()
