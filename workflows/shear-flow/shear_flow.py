#!/usr/bin/env python3
"""Friction and solid fraction of flows in a sheared cell against their inertial number. usage: shear_flow.py TABLE.md CHART.svg CHART.png NAME ...

NAME             KIND-NUMBER
inertial number  I = rate d sqrt(density / s_yy), d the diameter of the sphere of the same volume, of pentagons that of the circle of the same area,
                 s_yy the mean of the run
friction         s_xy / s_yy; solid fraction: both are means over the strain after the first quarter, in six blocks, of which come the intervals (95 %, Student's t)
at I = 0         the fit of friction and of 1 / solid fraction by a + b I^c over all inertial numbers of a kind, with four of them at least; its
                 interval: fits of values that scatter as the blocks do (parametric bootstrap: Efron and Tibshirani 1993, section 6.5)
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
from scree.intervals import mean_interval  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
WORDS = {"ball": "balls, no friction", "rubbing-ball": "balls, friction 0.5", "rock": "rocks, friction 0.5", "pentagon": "pentagons, no friction"}
COLOURS = {"ball": "#2a6f97", "rubbing-ball": "#61a5c2", "rock": "#bc6c25", "pentagon": "#6a994e"}
# friction at I = 0, and its tolerance. Balls: Peyneau and Roux, Phys. Rev. E 78 (2008) 011307: 5.76 +- 0.22 degrees. Pentagons: Azema, Radjai and
# Roux, Phys. Rev. E 91 (2015) 010202
PUBLISHED = {"ball": "0.101 +- 0.004, 0.64", "pentagon": "0.183 +- 0.008"}
BLOCKS = 6


def blocks(strain, values):
    """Means over equal parts of the strain after its first quarter."""
    ends = np.linspace(0.25 * strain[-1], strain[-1], BLOCKS + 1)
    return [values[(strain >= low) & (strain <= high)].mean() for low, high in zip(ends[:-1], ends[1:])]


def read(name):
    record, run = record_of(name), scree.open(f"{name}.run")
    case, log = case_of(record), run.log
    strain = np.abs(log["strain_xy"])
    solid = blocks(strain, log["solid_fraction"])
    bodies = run.frames[0].bodies
    density = si(case["materials"]["glass"]["density"])
    volume = np.mean(bodies.mass) / density
    is_layer = not run.frames[0].cell.period[2] > 0
    diameter = np.sqrt(4 / np.pi * volume / run.frames[0].cell.lengths[2]) if is_layer else np.cbrt(6 / np.pi * volume)
    friction = blocks(strain, log["stress_xy"] / log["stress_yy"])
    stress = np.mean(blocks(strain, log["stress_yy"]))
    rate = strain[-1] / log["time"][-1]
    return {"I": rate * diameter * np.sqrt(density / stress), "friction": friction, "solid": solid, "stress": stress / si(case["cell"]["stress"]["y"]), "strain": strain[-1],
            "steps": record["steps"], "seconds": record["wall_seconds"], "error": np.abs(log["energy_error"]).max() / abs(log["cell_work"][-1])}


def fitted(numbers, values):
    """a, b, c of a + b I^c with the least squares: linear in a and b, of a grid of c."""
    def by(power):
        matrix = np.stack([np.ones_like(numbers), numbers**power], axis=1)
        found = np.linalg.lstsq(matrix, values, rcond=None)[0]
        return ((matrix @ found - values) ** 2).sum(), (*found, power)
    return min(by(power) for power in np.linspace(0.2, 1.2, 101))[1]


def at_zero(numbers, samples):
    """The fit of the means, and the half width of the interval of its a: of 400 fits of means that scatter as theirs do (parametric bootstrap)."""
    numbers, means = np.array(numbers), np.array([np.mean(s) for s in samples])
    errors = np.array([np.std(s, ddof=1) / np.sqrt(len(s)) for s in samples])
    rng = np.random.default_rng(1)
    scattered = [fitted(numbers, means + errors * rng.standard_t(BLOCKS - 1, len(means)))[0] for _ in range(400)]
    low, high = np.quantile(scattered, (0.025, 0.975))
    return fitted(numbers, means), 0.5 * (high - low)


def text(values, digits):
    mean = mean_interval(values, is_signed=True)
    return f"{mean.value:.{digits}f} +- {mean.half:.{digits}f}"


kinds = {}
for name in NAMES:
    kinds.setdefault(name.rsplit("-", 1)[0], []).append(read(name))

lines = ["| bodies | inertial number | friction, s_xy / s_yy | solid fraction |", "|---|---|---|---|"]
ends = ["| bodies | friction at I = 0 | angle | solid fraction at I = 0 | published |", "|---|---|---|---|---|"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8))
for kind, runs in kinds.items():
    runs.sort(key=lambda r: r["I"])
    numbers = [r["I"] for r in runs]
    for r in runs:
        lines.append(f"| {WORDS[kind]} | {r['I']:.2g} | {text(r['friction'], 4)} | {text(r['solid'], 4)} |")
    for axes, key in ((left, "friction"), (right, "solid")):
        means = [mean_interval(r[key], is_signed=True) for r in runs]
        axes.errorbar(numbers, [m.value for m in means], [m.half for m in means], fmt="o", color=COLOURS[kind], markersize=4, capsize=2, linewidth=0.9, label=WORDS[kind])
    if len(runs) >= 4:
        (mu, b, c), half = at_zero(numbers, [r["friction"] for r in runs])
        (volume, e, f), half_volume = at_zero(numbers, [1 / np.array(r["solid"]) for r in runs])
        ends.append(f"| {WORDS[kind]} | {mu:.3f} +- {half:.3f} | {np.degrees(np.arctan(mu)):.1f} degrees | {1 / volume:.3f} +- {half_volume / volume**2:.3f} | {PUBLISHED.get(kind, '')} |")
        grid = np.geomspace(0.5 * min(numbers), 1.3 * max(numbers), 100)
        left.plot(grid, mu + b * grid**c, color=COLOURS[kind], linewidth=0.9)
        right.plot(grid, 1 / (volume + e * grid**f), color=COLOURS[kind], linewidth=0.9)
left.set_ylabel("friction, $s_{xy} / s_{yy}$")
left.set_ylim(bottom=0)
right.set_ylabel("solid fraction")
for axes in (left, right):
    axes.set_xscale("log")
    axes.set_xlabel("inertial number")
    axes.grid(alpha=0.25)
right.legend(frameon=False, fontsize=8)
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)

everything = [r for runs in kinds.values() for r in runs]
fits = ["\n".join(ends), ""] if len(ends) > 2 else []
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Shear flow\n\n" + "\n".join(fits + lines) + f"\n\nShear strain of {max(r['strain'] for r in everything):.3g}; means over the last three quarters, intervals of 95 % from six blocks of them. "
               f"Stress s_yy over that asked: {min(r['stress'] for r in everything):.3f} to {max(r['stress'] for r in everything):.3f}. "
               f"Error of the energy balance over the work of the cell: at most {max(r['error'] for r in everything):.0e}. "
               f"{max(r['steps'] for r in everything)} steps and {max(r['seconds'] for r in everything):.0f} s a run at most.\n")
