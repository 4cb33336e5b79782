#!/usr/bin/env python3
"""Void fractions of fixed beds in a tube beside correlations. usage: tube.py TABLE.md CHART.svg CHART.png NAME ...

NAME           KIND-FRICTION-SEED, with NAME.bed of scree-post bed
void fraction  mean over the section of the tube, between the heights below which 10 % and 90 % of the solid lie
q              diameter of the ball of equal volume over that of the tube; of rings that of the cylinder without its hole
"""
import csv
import json
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
from run_record import with_interval  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
TUBE, BORE = 30e-3, 0.6  # diameter of the tube [m]; inner over outer diameter of the rings
WORDS = {"ball": "balls", "cylinder": "cylinders", "ring": "rings"}
COLOURS = {"ball": "#2a6f97", "cylinder": "#bc6c25", "ring": "#606c38"}


def dixon(kind, q):
    """A. Dixon, Can. J. Chem. Eng. 66 (1988) 705."""
    if kind == "ball":
        return 0.40 + 0.05 * q + 0.412 * q**2
    cylinder = 0.36 + 0.10 * q + 0.7 * q**2
    return cylinder if kind == "cylinder" else 1 - (1 + 2 * (BORE - 0.5) ** 2 * (1.145 - q)) * (1 - BORE**2) * (1 - cylinder)


def benyahia(kind, q):
    """S. Benyahia, K. O'Neill, Part. Sci. Technol. 23 (2005) 169."""
    return {"ball": 0.390 + 1.740 / (1 / q + 1.140) ** 2, "cylinder": 0.373 + 1.703 / (1 / q + 0.611) ** 2}.get(kind)


def read(name):
    with open(f"{name}.bed/bed.json", encoding="utf-8") as file:
        bed = json.load(file)
    with open(f"{name}.bed/radial_void_fraction.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))[1:]
    rings = {key: np.array([float(row[key]) for row in rows]) for key in ("distance_from_wall_over_diameter", "distance_from_axis", "void_fraction")}
    return {"bulk": np.average(rings["void_fraction"], weights=rings["distance_from_axis"]), "bed": bed, "rings": rings}


beds = {}
for name in NAMES:
    kind, friction, _ = name.split("-")
    beds.setdefault((kind, float(friction)), []).append(read(name))

lines = ["| bodies | friction | void fraction | Dixon | Benyahia and O'Neill | contacts of a body: points, edges, faces | constraints | parted pairs | taken off by caps | runs |",
         "|---|---|---|---|---|---|---|---|---|---|"]
figure, axes = plt.subplots(figsize=(6.5, 3.8))
for (kind, friction), runs in beds.items():
    first = runs[0]["bed"]
    diameter = first["mean_diameter"] if kind != "ring" else first["mean_diameter"] / (1 - BORE**2) ** (1 / 3)
    q = diameter / TUBE
    other = benyahia(kind, q)
    mean = {key: np.mean([run["bed"]["contacts_per_particle"][key] for run in runs]) for key in ("point", "edge", "face")}
    lost = np.mean([1 - run["bed"]["volume_in_file"] / run["bed"]["solid_volume"] for run in runs])
    parted, left = (sum(run["bed"][key] for run in runs) for key in ("pairs_parted", "pairs_left"))
    lines.append(f"| {WORDS[kind]} | {friction:g} | {with_interval([run['bulk'] for run in runs], 3)} | {dixon(kind, q):.3f} | {'' if other is None else f'{other:.3f}'} | "
                 f"{mean['point']:.2f}, {mean['edge']:.2f}, {mean['face']:.2f} | {with_interval([run['bed']['constraints'] for run in runs], 2)} | "
                 f"{parted} of {parted + left} | {100 * lost:.2f} % | {len(runs)} |")
    if friction == min(f for k, f in beds if k == kind):
        rings = runs[0]["rings"]
        count = min(len(run["rings"]["void_fraction"]) for run in runs)
        axes.plot(rings["distance_from_wall_over_diameter"][:count], np.mean([run["rings"]["void_fraction"][:count] for run in runs], axis=0), color=COLOURS[kind],
                  linewidth=1.2, label=f"{WORDS[kind]}, friction {friction:g}")
axes.set_xlabel("distance from the wall over the diameter of equal volume")
axes.set_ylabel("void fraction")
axes.set_xlim(left=0)
axes.set_ylim(0, 1)
axes.legend(frameon=False)
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")
print("\n".join(lines))
