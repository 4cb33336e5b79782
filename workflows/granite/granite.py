#!/usr/bin/env python3
"""Both strengths of bonded granite. usage: granite.py TABLE.md CHART.svg CHART.png KIND..., of the runs compress-KIND and split-KIND

modulus      slope of the stress of the plates over the strain of the cells in the middle of the core, from a tenth to a half of its strength. Strains are slopes of
             the displacement of cells over their place: what gives way at the plates is not in them
strength     largest mean force of both plates: over the section of the core; 2 P / (pi D t) of the disc
laboratory   Lac du Bonnet granite: D. O. Potyondy, P. A. Cundall, A bonded-particle model for rock, Int. J. Rock Mech. Min. Sci. 41 (2004) 1329
"""
import os
import sys

import h5py
import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402

SECTION, MIDDLE = np.pi * 0.016**2, 0.02
DISC = np.pi * 0.05 * 0.025 / 2
NAMES = {"cohesion": "cohesion as large as tension", "friction": "friction 1 of broken faces", "tangential": "tangential_ratio 0.25"}
TABLE, SVG, PNG, *KINDS = sys.argv[1:]


class Test:
    """A run's mean force of both plates."""
    def __init__(self, name):
        self.run = scree.open(f"{name}.run")
        log = self.run.log
        self.time, self.bonds = log["time"], log["bonds"]
        self.force = 0.5 * (log["wall2_force_z"] - log["wall1_force_z"])
        self.top = int(np.argmax(self.force))
        self.broken = self.bonds[0] - self.bonds[self.top]
        self.failed = self.force[self.top:].min() < 0.8 * self.force[self.top]


def elastic(name, test):
    """Young's modulus, Poisson's ratio, and strain over time of the core."""
    with h5py.File(f"{name}.scene.h5") as file:
        ids, x = file["bodies/id"][:], file["bodies/position"][:]
    in_scene = np.argsort(np.argsort(ids))
    middle = np.abs(x[:, 2]) < MIDDLE
    rows = []
    for frame in test.run.frames:
        if frame.time > test.time[test.top]:
            break
        moved = frame.bodies.position[np.argsort(frame.bodies.id)][in_scene] - x
        slope = [np.polyfit(x[middle, k], moved[middle, k], 1)[0] for k in range(3)]
        rows.append((-slope[2], 0.5 * (slope[0] + slope[1]), np.interp(frame.time, test.time, test.force) / SECTION))
    strain, wider, stress = np.array(rows).T
    part = (stress > 0.1 * stress.max()) & (stress < 0.5 * stress.max())
    if part.sum() < 2:
        return np.nan, np.nan, strain, stress
    return np.polyfit(strain[part], stress[part], 1)[0], np.polyfit(strain[part], wider[part], 1)[0], strain, stress


rows, curves = {}, {}
for kind in KINDS:
    core, disc = Test(f"compress-{kind}"), Test(f"split-{kind}")
    young, poisson, strain, stress = elastic(f"compress-{kind}", core)
    rows[kind] = (young / 1e9, poisson, core.force[core.top] / SECTION / 1e6, disc.force[disc.top] / DISC / 1e6, core.broken, disc.broken, core.failed and disc.failed)
    curves[kind] = strain, stress, disc

cuts = [kind for kind in KINDS if kind.isdigit()]


def line(name, values, failed):
    young, poisson, compressive, tensile = (np.array([v[k] for v in values]) for k in range(4))

    def mean(x, digits):
        return f"{x.mean():.{digits}f}" + (f" +- {x.std(ddof=1):.{digits}f}" if len(x) > 1 else "")
    return f"| {name}{'' if failed else ', not failed'} | {mean(young, 1)} | {mean(poisson, 3)} | {mean(compressive, 0)} | {mean(tensile, 1)} | {mean(compressive / tensile, 1)} |\n"


with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| | Young's modulus [GPa] | Poisson's ratio | compressive strength [MPa] | Brazilian strength [MPa] | ratio |\n|---|---|---|---|---|---|\n")
    file.write("| Lac du Bonnet granite | 69 | 0.26 | 200 | 9.3 | 21.5 |\n")
    file.write(line(f"cells, calibrated, {len(cuts)} cut{'s' if len(cuts) > 1 else ''}", [rows[kind] for kind in cuts], all(rows[kind][6] for kind in cuts)))
    for kind in KINDS:
        if kind not in cuts:
            file.write(line(NAMES[kind] + ", first cut", [rows[kind]], rows[kind][6]))
    file.write("\nBonds that have broken when the force is largest: " + ", ".join(f"{rows[kind][4]:.0f} and {rows[kind][5]:.0f} ({kind})" for kind in KINDS) + "\n")

figure, axes = plt.subplots(1, 3, figsize=(13, 4))
for kind, colour in zip(cuts, ("#0072B2", "#56B4E9", "#009E73")):
    strain, stress, disc = curves[kind]
    axes[0].plot(1e3 * strain, stress / 1e6, color=colour, label=f"cut {kind}")
    axes[1].plot(1e3 * disc.time, disc.force / DISC / 1e6, color=colour, label=f"cut {kind}")
axes[0].axline((0, 0), slope=69, color="0.5", lw=0.8, ls="--", label="granite, 69 GPa")
axes[0].axhline(200, color="0.5", lw=0.8, label="granite, 200 MPa")
axes[0].set(xlabel="strain [1e-3]", ylabel="stress [MPa]", title="compression, up to the largest force", xlim=(0, None), ylim=(0, 1.1 * max(200, *(rows[kind][2] for kind in cuts))))
axes[1].axhline(9.3, color="0.5", lw=0.8, label="granite, 9.3 MPa")
axes[1].set(xlabel="time [ms]", ylabel="2 P / (π D t) [MPa]", title="Brazilian test", ylim=(0, None))
for a in axes[:2]:
    a.legend(frameon=False)
marks = {"cohesion": "s", "friction": "^", "tangential": "D"}
for kind in KINDS:
    axes[2].plot(rows[kind][3], rows[kind][2], marks.get(kind, "o"), color="#D55E00" if kind in marks else "#0072B2", label=NAMES.get(kind, "calibrated" if kind == cuts[0] else None))
axes[2].plot(9.3, 200, "k*", ms=12, label="granite")
axes[2].set(xlabel="Brazilian strength [MPa]", ylabel="compressive strength [MPa]", title="both strengths", xlim=(0, 1.15 * max(9.3, *(r[3] for r in rows.values()))),
            ylim=(0, 1.15 * max(200, *(r[2] for r in rows.values()))))
axes[2].legend(frameon=False, fontsize=8)
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
