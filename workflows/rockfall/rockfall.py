#!/usr/bin/env python3
"""Where fragments of boulders come to lie. usage: rockfall.py TABLE.md CHART.svg CHART.png RUN...

fragments   bodies that bonds hold together at the end of the run, and the share of the largest of them
run-out     x of the centre of mass of a fragment; the ditch is from 9.4 to 13.9 m. Of the mass: share that lies short of the ditch, in it, beyond
speed       of the centre of mass of all at the end, by which is seen whether they lie
"""
import csv
import os
import sys

import h5py
import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from slope import PROFILE  # noqa: E402

DITCH = PROFILE[6][0], PROFILE[8][0]
GROUND = np.array(PROFILE)

TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def fragment_of(scene, holding, ids):
    """Lowest id of the fragment of each body."""
    with h5py.File(scene) as file:
        a, b = file["bonds/a"][:][holding], file["bonds/b"][:][holding]
    of = {int(i): int(i) for i in ids}
    changed = True
    while changed:
        changed = False
        for i, j in zip(a.tolist(), b.tolist()):
            low = min(of[i], of[j])
            changed = changed or of[i] != low or of[j] != low
            of[i] = of[j] = low
    return np.array([of[int(i)] for i in ids])


rows, placed, paths = [], [], []
for name in NAMES:
    run = scree.open(f"{name}.run")
    frame = run.frames[-1]
    bodies = frame.bodies
    with h5py.File(f"{name}.run/{os.path.basename(frame.path)}") as file:
        of = fragment_of(f"{name}.scene.h5", np.sort(file["bonds/bond"][:]), bodies.id)
    mass, x = bodies.mass, bodies.position
    for fragment in np.unique(of):
        own = of == fragment
        placed.append(((mass[own, None] * x[own]).sum(axis=0) / mass[own].sum(), mass[own].sum()))
    paths.append(np.array([(f.bodies.mass[:, None] * f.bodies.position).sum(axis=0) / f.bodies.mass.sum() for f in run.frames]))
    with open(f"{name}.sizes.csv", encoding="utf-8") as file:
        sizes = np.array([float(r["mass"]) for r in csv.DictReader(file)])
    short, beyond = mass[x[:, 0] < DITCH[0]].sum() / mass.sum(), mass[x[:, 0] > DITCH[1]].sum() / mass.sum()
    speed = np.linalg.norm((mass[:, None] * bodies.velocity).sum(axis=0)) / mass.sum()
    assert len(sizes) == len(np.unique(of)), name   # two ways to the same fragments
    rows.append((name, len(sizes), sizes.max() / sizes.sum(), x[:, 0].max(), short, 1 - short - beyond, beyond, speed, run.log["fracture"][-1]))
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| boulder | fragments | largest | farthest x [m] | mass fraction before the ditch | in the ditch | beyond | speed at the end [m/s] | fracture [J] |\n|---|---|---|---|---|---|---|---|---|\n")
    for r in rows:
        file.write(f"| {r[0]} | {r[1]} | {r[2]:.2f} | {r[3]:.1f} | {r[4]:.2f} | {r[5]:.2f} | {r[6]:.2f} | {r[7]:.2f} | {r[8]:.0f} |\n")
figure, axes = plt.subplots(figsize=(11, 5.2))
axes.fill_between(GROUND[:, 0], GROUND[:, 1], -14, color="0.85")
for k, path in enumerate(paths):
    axes.plot(path[:, 0], path[:, 2], color=f"C{k}", lw=0.9, alpha=0.7)
points = np.array([p for p, m in placed])
axes.scatter(points[:, 0], points[:, 2], s=[60 * (m / max(m for _, m in placed)) ** (2 / 3) + 3 for _, m in placed], color="#D55E00", zorder=3, lw=0)
axes.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", xlim=(-3, max(20, points[:, 0].max() + 1)), title="paths of the centres of mass, and where fragments are at the end")
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
