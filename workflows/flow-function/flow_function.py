#!/usr/bin/env python3
"""Strength of pressed samples without their mould, against the stress that pressed them. usage: flow_function.py TABLE.md CHART.svg CHART.png NAME ...

NAME       KIND-STRESS-SEED: NAME.run
pressed    stress of the lid before it stops, mean of its last tenth; lateral over axial stress, solid fraction then
strain     of the crushing: how far the floor has risen above where it stood as the sample was pressed, over the height of the pressed sample
stress     of the crushing: mean of the forces on floor and lid over the base of the mould
strength   largest stress of means over 0.5 % of strain, up to the end
ff_c       pressing stress over strength (Jenike, Storage and flow of solids, 1964)
Intervals are 95 %, by Student's t, over the seeds.
"""
import math
import os
import re
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from scree.intervals import mean_interval, student_quantile  # noqa: E402
from run_record import case_of, record_of, si, with_interval  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
KINDS = {"ball": "balls", "fine": "fine balls", "cube": "cubes", "elastic": "balls, contacts that do not yield"}
COLOURS = {"ball": "#2a6f97", "fine": "#bc6c25", "cube": "#606c38", "elastic": "#7b2d8b"}
GROUP = re.compile(r"([a-z]+)-([0-9]+)-([0-9]+)$")
SMOOTHED = 0.005    # strain
NO_STRENGTH = 100   # ff_c from which on a sample has no strength
# ff_c below which a powder does not flow, is very cohesive, cohesive, flows easily (Jenike)
CLASSES = (1, 2, 4, 10)


def read(name):
    record = record_of(name)
    case, run = case_of(record), scree.open(f"{name}.run")
    walls = {wall["name"]: wall for wall in case["walls"]}
    ids = {wall.name: wall.id for wall in run.scene.walls.in_order}
    log = run.log
    time = log["time"]

    def force(wall, axis):
        return np.abs(log[f"wall{ids[wall]}_force_{axis}"])

    width = {axis: si(walls["+" + axis]["shape"]["plane"]["point"]["xyz".index(axis)]) - si(walls["-" + axis]["shape"]["plane"]["point"]["xyz".index(axis)]) for axis in "xy"}
    base = width["x"] * width["y"]
    stops = si(walls["lid"]["motion"]["stop"])
    pressed = (time > 0.9 * stops) & (time < stops)
    height = si(walls["lid"]["shape"]["plane"]["point"][2]) - log[f"wall{ids['lid']}_way"][pressed][-1]
    axial = force("lid", "z")[pressed].mean() / base
    lateral = np.mean([force(side + axis, axis)[pressed].mean() / (base / width[axis] * height) for axis in "xy" for side in "-+"])
    table = walls["floor"]["motion"]["table"]
    rises = np.interp(time, [si(t) for t in table["time"]], [si(position[2]) for position in table["position"]])
    crushed = (time > si(table["time"][-2])) & (rises >= 0)
    strain = rises[crushed] / height
    stress = 0.5 * (force("lid", "z") + force("floor", "z"))[crushed] / base
    grid = np.linspace(strain[0], strain[-1], 401)
    stress = np.interp(grid, strain, stress)
    count = max(1, round(SMOOTHED / (grid[1] - grid[0])))
    smooth = np.convolve(stress, np.ones(count) / count, mode="valid")
    top = int(smooth.argmax())
    return {"strain": grid[count // 2:count // 2 + len(smooth)], "stress": smooth, "s1": axial, "ratio": lateral / axial, "strength": smooth[top], "at": grid[top + count // 2],
            "solid": sum(run.frames[0].bodies.volume) / (base * height), "asked": si(walls["lid"]["motion"]["servo"]["stress"]), "steps": record["steps"],
            "seconds": record["wall_seconds"], "grains": len(run.frames[0].bodies.id)}


groups = {}
for name in NAMES:
    kind, stress, _ = GROUP.search(name).groups()
    groups.setdefault((kind, int(stress)), []).append(read(name))
groups = dict(sorted(groups.items(), key=lambda item: (list(KINDS).index(item[0][0]), item[0][1])))

lines = ["| grains | number | pressed with | lateral over axial stress | solid fraction | strength without the mould | at a strain of | ff_c | runs |", "|---|---|---|---|---|---|---|---|---|"]
for (kind, stress), runs in groups.items():
    flows = with_interval([r["s1"] / r["strength"] for r in runs], 1) if NO_STRENGTH * max(r["strength"] for r in runs) > runs[0]["s1"] else f"above {NO_STRENGTH}"
    lines.append(f"| {KINDS[kind]} | {runs[0]['grains']} | {1e-3 * np.mean([r['s1'] for r in runs]):.2f} kPa | {with_interval([r['ratio'] for r in runs], 2)} | "
                 f"{with_interval([r['solid'] for r in runs], 3)} | {with_interval([1e-3 * r['strength'] for r in runs], 2)} kPa | {100 * np.mean([r['at'] for r in runs]):.1f} % | {flows} | {len(runs)} |")

balls = [(stress, r) for (kind, stress), runs in groups.items() if kind == "ball" for r in runs]
if len({stress for stress, _ in balls}) > 1 and len(balls) > 3:
    x, y = np.array([1e-3 * r["s1"] for _, r in balls]), np.array([1e-3 * r["strength"] for _, r in balls])
    # scatter grows with the strength: relative deviations are minimised
    matrix = np.stack([1 / y, x / y], axis=1)
    (offset, slope), *_ = np.linalg.lstsq(matrix, np.ones(len(y)), rcond=None)
    deviation = math.sqrt(((matrix @ [offset, slope] - 1) ** 2).sum() / (len(y) - 2))
    half = student_quantile(len(y) - 1) * deviation * np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix)))
    lines += ["", f"Straight line through the strengths of balls: {offset:.2f} +- {half[0]:.2f} kPa + ({slope:.3f} +- {half[1]:.3f}) x pressing stress."]
for kind in ("fine", "cube"):
    for (group, stress), runs in groups.items():
        if group == kind and ("ball", stress) in groups and len(runs) > 1 and len(groups["ball", stress]) > 1:
            mine, theirs = (mean_interval([r["strength"] for r in some], is_signed=True) for some in (runs, groups["ball", stress]))
            ratio = mine.value / theirs.value
            half = ratio * math.hypot(mine.half / mine.value, theirs.half / theirs.value)
            lines += ["", f"Strength of {KINDS[kind]} over that of balls, pressed with {stress} kPa: {ratio:.2f} +- {half:.2f}."]
everything = [r for runs in groups.values() for r in runs]
lines += ["", f"Pressing stress over that asked: {min(r['s1'] / r['asked'] for r in everything):.4f} to {max(r['s1'] / r['asked'] for r in everything):.4f}. "
          f"{max(r['steps'] for r in everything)} steps a run, {max(r['seconds'] for r in everything):.0f} s at most."]

figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8))
largest = max(stress for _, stress in groups)
for (kind, stress), runs in groups.items():
    strain = np.linspace(max(r["strain"][0] for r in runs), min(r["strain"][-1] for r in runs), 201)
    mean = np.mean([np.interp(strain, r["strain"], r["stress"]) for r in runs], axis=0)
    left.plot(100 * strain, 1e-3 * mean, color=COLOURS[kind], linewidth=0.6 + stress / largest, label=f"{KINDS[kind]}, {stress} kPa")
    right.plot([1e-3 * r["s1"] for r in runs], [1e-3 * r["strength"] for r in runs], "o", color=COLOURS[kind], markersize=4, fillstyle="none",
               label=None if any(group == kind and other < stress for group, other in groups) else KINDS[kind])
x = np.array([0, 1.15 * largest])
for bound in CLASSES:
    right.plot(x, x / bound, color="#888888", linewidth=0.7)
high = 1.25e-3 * max(max(r["strength"] for r in everything), 100)
right.set_ylim(-0.05 * high, high)
right.set_xlim(0, x[1])
for k, bound in enumerate(CLASSES):   # one below the other, where lines leave at the top
    at = min(x[1], high * bound) * (0.92 - 0.1 * (len(CLASSES) - 1 - k))
    leaves_right = high * bound > 0.9 * x[1]
    right.annotate(f"ff_c = {bound}", (at, at / bound), xytext=(-6 if leaves_right else 4, 0), textcoords="offset points", ha="right" if leaves_right else "left",
                   va="bottom" if leaves_right else "top", fontsize=7, color="#666666")
left.set_xlabel("strain [%]")
left.set_ylabel("stress [kPa]")
right.set_xlabel("pressing stress [kPa]")
right.set_ylabel("strength without the mould [kPa]")
for axes in (left, right):
    axes.grid(alpha=0.25)
    axes.legend(frameon=axes is right, fontsize=7, loc="upper left" if axes is left else "lower right")
left.set_ylim(min(0, left.get_ylim()[0]), 1.4 * left.get_ylim()[1])   # room for the legend
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Flow function\n\n" + "\n".join(lines) + "\n")
