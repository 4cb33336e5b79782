#!/usr/bin/env python3
"""Stress ratio, volume and strength of rocks sheared in a periodic cell. usage: critical_state.py TABLE.md CHART.svg CHART.png NAME ...

strain    axial, ln(h_start / h): positive as the cell shortens
q / p     (s_z - s_lateral) / ((s_z + 2 s_lateral) / 3), s_lateral the mean of x and y
volume    ln(V_start / V): positive where the bed contracts
peak      the largest q / p of means over 2 % of strain; its friction angle by sin phi = (s_z - s_lateral) / (s_z + s_lateral)
critical  means over the last two fifths of the strain: one value of each run; intervals are 95 %, by Student's t, of the means over the seeds
"""
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
from scree.intervals import student_quantile  # noqa: E402
from run_record import case_of, record_of, si, with_interval  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
STYLES = {"dense": "-", "loose": "--"}
COLOURS = ["#2a6f97", "#bc6c25", "#606c38", "#7b2d8b", "#a4161a"]
GROUP = re.compile(r"(dense|loose)-([0-9]+)-([0-9]+)$")   # start, pressure [kPa], seed


def angle(ratio):
    """Friction angle [degrees] of a triaxial compression from q / p."""
    return np.degrees(np.arcsin(3 * ratio / (6 + ratio)))


def read(name):
    record = record_of(name)
    case, log = case_of(record), scree.open(f"{name}.run").log
    strain = log["strain_z"]
    lateral = 0.5 * (log["stress_xx"] + log["stress_yy"])
    ratio = 3 * (log["stress_zz"] - lateral) / (log["stress_zz"] + 2 * lateral)
    volume = log["strain_x"] + log["strain_y"] + strain
    grid = np.linspace(0, strain[-1], 201)
    width = max(1, round(0.02 / grid[1])) if grid[1] > 0 else 1
    smooth = np.convolve(np.interp(grid, strain, ratio), np.ones(width) / width, mode="valid")
    late = strain >= 0.6 * strain[-1]
    top = int(smooth.argmax())
    return {"strain": grid, "ratio": np.interp(grid, strain, ratio), "volume": np.interp(grid, strain, volume),
            "start": log["solid_fraction"][0], "peak": smooth[top], "peak_strain": grid[min(top + width // 2, 200)],
            "q_p": ratio[late].mean(), "solid": log["solid_fraction"][late].mean(), "lateral": lateral[late].mean() / si(case["cell"]["stress"]["x"]),
            "steps": record["steps"], "seconds": record["wall_seconds"], "error": np.abs(log["energy_error"]).max() / abs(log["cell_work"][-1])}


groups = {}
for name in NAMES:
    start, pressure, _ = GROUP.search(name).groups()
    groups.setdefault((start, int(pressure)), []).append(read(name))
pressures = sorted({pressure for _, pressure in groups})

lines = ["| start | lateral stress | solid fraction at the start | largest q/p | at axial strain | friction angle there | q/p at the end | friction angle at the end | solid fraction at the end | runs |",
         "|---|---|---|---|---|---|---|---|---|---|"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8))
for (start, pressure), runs in sorted(groups.items()):
    ends = max(r["strain"][-1] for r in runs)
    lines.append(f"| {start} | {pressure} kPa | {with_interval([r['start'] for r in runs], 3)} | {with_interval([r['peak'] for r in runs], 2)} | "
                 f"{100 * np.mean([r['peak_strain'] for r in runs]):.0f} % | {with_interval([angle(r['peak']) for r in runs], 1)} degrees | "
                 f"{with_interval([r['q_p'] for r in runs], 3)} | {with_interval([angle(r['q_p']) for r in runs], 1)} degrees | {with_interval([r['solid'] for r in runs], 4)} | {len(runs)} |")
    colour, style = COLOURS[pressures.index(pressure) % len(COLOURS)], STYLES[start]
    strain = np.linspace(0, min(r["strain"][-1] for r in runs), 201)
    for axes, key, factor in ((left, "ratio", 1), (right, "volume", 100)):
        curves = np.array([np.interp(strain, r["strain"], r[key]) for r in runs])
        axes.plot(100 * strain, factor * curves.mean(axis=0), style, color=colour, linewidth=1.1, label=f"{start}, {pressure} kPa")
left.set_ylabel("q / p")
right.set_ylabel("volume strain, contraction positive [%]")
for axes in (left, right):
    axes.set_xlabel("axial strain [%]")
    axes.grid(alpha=0.25)
right.legend(frameon=False, fontsize=8)
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)

everything = [r for runs in groups.values() for r in runs]
lines += ["", f"Axial strain up to {100 * ends:.0f} %; *at the end*: means over its last two fifths; intervals: 95 %, over the seeds."]
both = [pressure for pressure in pressures if len(groups.get(("dense", pressure), [])) > 1 and len(groups.get(("loose", pressure), [])) > 1]
if both:
    lines += ["", "| lateral stress | q/p, dense less loose | solid fraction, dense less loose |", "|---|---|---|"]
    for pressure in both:
        cells = []
        for key, digits in (("q_p", 3), ("solid", 4)):
            d, o = (np.array([r[key] for r in groups[start, pressure]]) for start in ("dense", "loose"))
            error = np.sqrt(d.var(ddof=1) / len(d) + o.var(ddof=1) / len(o))
            half = student_quantile(len(d) + len(o) - 1) * error
            cells.append(f"{d.mean() - o.mean():+.{digits}f} +- {half:.{digits}f}")
        lines.append(f"| {pressure} kPa | {' | '.join(cells)} |")
lines += ["", f"Lateral stress over that asked: {min(r['lateral'] for r in everything):.4f} to {max(r['lateral'] for r in everything):.4f}. Error of the energy balance over the work of the cell: at most "
          f"{max(r['error'] for r in everything):.0e}. {max(r['steps'] for r in everything)} steps a run, {max(r['seconds'] for r in everything):.0f} s at most."]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Critical state\n\n" + "\n".join(lines) + "\n")
