#!/usr/bin/env python3
"""Solid fraction and contacts of compressed beds, extrapolated to no pressure. usage: compression.py TABLE.md CHART.svg CHART.png SHARE,... NAME ...

NAME       KIND-SEED: NAME.run at the full stress, NAME-at-SHARE.run at that share of it
contacts   other bodies that a body touches, without rattlers
at none    the straight line of each bed through its values over the stress, at 0; intervals are 95 %, by Student's t over the seeds
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
from run_record import record_of, with_interval  # noqa: E402

TABLE, SVG, PNG, SHARES, *NAMES = sys.argv[1:]
SHARES = [1.0] + [float(share) for share in SHARES.split(",")]
COLOURS = {"ball": "#2a6f97", "rubbing-ball": "#61a5c2", "cube": "#bc6c25", "tetrahedron": "#606c38"}
WORDS = {"ball": "balls, no friction", "rubbing-ball": "balls, friction 0.3", "cube": "cubes, no friction", "tetrahedron": "tetrahedra, no friction"}
# solid fraction, contacts at no pressure: Agnolin and Roux, Phys. Rev. E 76 (2007) 061302, states A and D
PUBLISHED = {"ball": "0.639, 6.0", "rubbing-ball": "0.593, 4.5"}


def measure(name):
    run = scree.open(f"{name}.run")
    log, measures, record = run.log, run.frames[-1].measures(), record_of(name)
    pressure = (log["stress_xx"][-1] + log["stress_yy"][-1] + log["stress_zz"][-1]) / 3
    rate = max(np.abs(np.diff(log[f"strain_{a}"]) / np.diff(log["time"])).max() for a in "xyz")
    return {"p": pressure, "solid": log["solid_fraction"][-1], "z": measures["coordination_number_without_rattlers"], "rattlers": measures["rattler_fraction"],
            "steps": record["steps"], "seconds": record["wall_seconds"],
            "rate": rate}


kinds = {}
for name in NAMES:
    kinds.setdefault(name.rsplit("-", 1)[0], []).append([measure(name)] + [measure(f"{name}-at-{share}") for share in SHARES[1:]])

lines = ["| bodies | stress [kPa] | solid fraction | contacts of a body | rattlers | runs |", "|---|---|---|---|---|---|"]
ends = ["| bodies | solid fraction at no pressure | contacts at no pressure | published |", "|---|---|---|---|"]
figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.8))
for kind, beds in kinds.items():
    for n in range(len(SHARES)):
        row = [bed[n] for bed in beds]
        lines.append(f"| {WORDS[kind]} | {1e-3 * np.mean([r['p'] for r in row]):.3g} | {with_interval([r['solid'] for r in row], 4)} | {with_interval([r['z'] for r in row], 2)} | "
                     f"{100 * np.mean([r['rattlers'] for r in row]):.1f} % | {len(row)} |")
    zero = {key: [np.polyfit([r["p"] for r in bed], [r[key] for r in bed], 1)[1] for bed in beds] for key in ("solid", "z")}
    ends.append(f"| {WORDS[kind]} | {with_interval(zero['solid'], 4)} | {with_interval(zero['z'], 2)} | {PUBLISHED.get(kind, '')} |")
    for axes, key in ((left, "solid"), (right, "z")):
        for k, bed in enumerate(beds):
            axes.plot([1e-3 * r["p"] for r in bed], [r[key] for r in bed], "o-", color=COLOURS[kind], markersize=3, linewidth=0.9, label=None if k else WORDS[kind])
left.set_ylabel("solid fraction")
right.set_ylabel("contacts of a body, without rattlers")
for axes in (left, right):
    axes.set_xlabel("stress [kPa]")
    axes.set_xlim(left=0)
    axes.grid(alpha=0.25)
right.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1, 1))
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
everything = [r for beds in kinds.values() for bed in beds for r in bed]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Isotropic compression\n\n" + "\n".join(ends) + "\n\nIntervals: 95 %, over the seeds. The beds at each stress:\n\n" + "\n".join(lines) +
               f"\n\n{max(r['steps'] for r in everything)} steps and {max(r['seconds'] for r in everything):.0f} s a run at most; fastest rate of strain {max(r['rate'] for r in everything):.2g} 1/s.\n")
