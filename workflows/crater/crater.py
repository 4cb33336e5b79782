#!/usr/bin/env python3
"""Depths of craters, beside the law of Uehara, Ambroso, Ojha and Durian (Phys. Rev. Lett. 90 (2003) 194301). usage: crater.py TABLE.md CHART.svg CHART.png NAME...

Their law: d = 0.14 / mu (rho_b / rho_g)^(1/2) D^(2/3) H^(1/3). d: how deep the lowest point of the ball comes below the surface of the bed; H: its way
down from rest, the fall and d; rho_g: of the bed as a whole; mu: tangent of its angle of repose. Both exponents are fitted together, ln d = c + a ln H
+ b ln rho_b, with the 95 % intervals of the fit.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.stats import t as student  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, heights_of_heaviest, record_of, si  # noqa: E402

GRAVITY = 9.81
EXPONENTS = {"H": 1 / 3, "rho_b": 1 / 2}
ALLOWED = 0.05   # of an exponent
TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def radius_in(case, shape):
    return si(case["shapes"][shape]["sphere"]["radius"])


def bed_of(frame, ball, r):
    """Surface [m]: the mean, over squares two grains wide, of the top of the highest grain. Density of the bed as a whole [kg/m^3]."""
    grains = frame.bodies.id != ball
    x, mass = frame.bodies.position[grains], frame.bodies.mass[grains]
    low, high = x[:, :2].min(axis=0) - r, x[:, :2].max(axis=0) + r
    cells = np.maximum(1, np.floor((high - low) / (4 * r))).astype(int)
    cell = np.ravel_multi_index(tuple(np.minimum(cells - 1, ((x[:, :2] - low) / (high - low) * cells).astype(int)).T), cells)
    tops = np.full(cells.prod(), np.nan)
    for c in np.unique(cell):
        tops[c] = x[cell == c, 2].max() + r
    surface, floor = np.nanmean(tops), (x[:, 2] - r).min()
    return surface, mass.sum() / ((surface - floor) * np.prod(high - low))


def fall_of(name, case, grain):
    """Depth, whole way down [m], densities of ball and bed, the chart's line: time [ms] and depth [mm]. grain: radius of the grains [m]."""
    frames = scree.open(f"{name}.run").frames
    n, z = heights_of_heaviest(frames)
    first, radius, density = frames[0].bodies, radius_in(case, "ball"), si(case["materials"]["ball"]["density"])
    surface, bed_density = bed_of(frames[0], int(first.id[n]), grain)
    bottom = np.array(z) - radius
    depth = surface - bottom.min()
    fallen = first.velocity[n, 2] ** 2 / (2 * GRAVITY) + bottom[0] - surface
    return depth, fallen + depth, density, bed_density, 2 * radius, np.array([frame.time for frame in frames]) * 1e3, (surface - bottom) * 1e3


rows, points = [], []
figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
grain = radius_in(case_of(record_of("bed")), "grain")
for name in NAMES:
    record = record_of(name)
    depth, way, density, bed_density, diameter, time, below = fall_of(name, case_of(record), grain)
    points.append((depth, way, density, bed_density, diameter))
    rows.append(f"| {name} | {1e3 * way:.1f} | {density:.0f} | {1e3 * depth:.2f} | {depth / diameter:.2f} | {record['bodies']} | {record['steps']} | {record['wall_seconds']:.0f} |")
    left.plot(time, below, "-", label=name, linewidth=1.2)
depth, way, density, bed_density, diameter = np.array(points).T
scale = (density / bed_density) ** 0.5 * (100 * diameter) ** (2 / 3) * (100 * way) ** (1 / 3)  # cm, as the law has it
lines = ["| run | way down [mm] | density of the ball [kg/m^3] | depth [mm] | over diameter | bodies | steps | s |", "|---|---|---|---|---|---|---|---|", *rows, ""]
if len(points) > 3:
    matrix = np.column_stack([np.ones(len(points)), np.log(way), np.log(density)])
    fit, *_ = np.linalg.lstsq(matrix, np.log(depth), rcond=None)
    free = len(points) - 3
    residual = np.log(depth) - matrix @ fit
    error = np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix)) * (residual @ residual) / free) * student.ppf(0.975, free)
    for (what, exponent), value, half in zip(EXPONENTS.items(), fit[1:], error[1:]):
        verdict = "holds" if abs(value - exponent) <= ALLOWED else "misses"
        lines.append(f"Exponent of {what}: {value:.3f} +- {half:.3f}; published {exponent:.3f}: {verdict} (within {ALLOWED}).\n")
else:
    lines.append("Too few runs for exponents.\n")
factor = np.exp(np.mean(np.log(100 * depth / scale)))
lines.append(f"d = {factor:.3f} (rho_b / rho_g)^(1/2) D^(2/3) H^(1/3), lengths in cm, rho_g = {bed_density.mean():.0f} kg/m^3: the published 0.14 / mu with "
             f"mu = {0.14 / factor:.2f}, an angle of repose of {np.degrees(np.arctan(0.14 / factor)):.0f} degrees.")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
left.set_xlabel("time [ms]")
left.set_ylabel("lowest point of the ball below the surface [mm]")
left.invert_yaxis()
left.legend(fontsize="small", loc="upper right")
line = np.array([0, 1.05 * scale.max()])
right.plot(line, 10 * factor * line, "-", color="0.6", label="exponents 1/2, 2/3, 1/3")
for prefix, marker, colour in (("fall", "o", "#0072B2"), ("density", "s", "#D55E00")):
    own = [n for n, name in enumerate(NAMES) if name.startswith(prefix)]
    right.plot(scale[own], 1e3 * depth[own], marker, color=colour, label={"fall": "other falls", "density": "other densities"}[prefix])
right.set_xlabel("(rho_b / rho_g)^(1/2) D^(2/3) H^(1/3) [cm]")
right.set_ylabel("depth [mm]")
right.set_xlim(0)
right.set_ylim(0)
right.legend(fontsize="small")
for plot in (left, right):
    plot.grid(alpha=0.3)
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
