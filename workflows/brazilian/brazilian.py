#!/usr/bin/env python3
"""Stresses in the middle of a disc pressed across its diameter, and how it splits. usage: brazilian.py TABLE.md CHART.svg CHART.png SPLIT HELD...

stress     of a cell: sum of arm x force over its bonds, over its volume; mean over the cells with their centre within D/10 of the axis.
           Hertz (J. Timoshenko, J. N. Goodier, Theory of Elasticity, art. 41): 2 P / (pi D t) across the load, -3 times that along it
crack      bonds that broke up to the time at which the force has fallen to half: mean square of the component of their normals across the
           load, 1/3 where they have any direction; and how far from the loaded diameter they lie, 0.21 D for all bonds of a disc
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
from run_record import case_of, record_of, si  # noqa: E402

D, T = 0.05, 0.025
TABLE, SVG, PNG, SPLIT, *HELD = sys.argv[1:]


def turned(q, v):
    u, w = q[:, 1:], q[:, :1]
    t = 2 * np.cross(u, v)
    return v + w * t + np.cross(u, t)


class Cells:
    """Bodies and bonds of a run's scene."""
    def __init__(self, name):
        with h5py.File(f"{name}.scene.h5") as file:
            self.id, self.x, self.q = (file[f"bodies/{n}"][:] for n in ("id", "position", "orientation"))
            self.bond = {n: file[f"bonds/{n}"][:] for n in ("a", "b", "point_a", "point_b", "frame_a")}
        row = {int(i): k for k, i in enumerate(self.id)}
        self.a, self.b = (np.array([row[int(i)] for i in self.bond[n]]) for n in "ab")

    def places(self):
        """Centroids and normals of all bonds at the start."""
        q = self.q[self.a]
        return self.x[self.a] + turned(q, self.bond["point_a"]), turned(q, turned(self.bond["frame_a"], np.tile([1.0, 0, 0], (len(q), 1))))


def middle_stress(name):
    """Mean stress tensor in the middle at the end of a run, in units of 2 P / (pi D t)."""
    cells, run = Cells(name), scree.open(f"{name}.run")
    frame = run.frames[-1]
    order = np.argsort(frame.bodies.id)
    mass = frame.bodies.mass[order][np.argsort(np.argsort(cells.id))]
    with h5py.File(f"{name}.run/{os.path.basename(frame.path)}") as file:
        bond, force = file["bonds/bond"][:], file["bonds/force"][:]
    density = si(case_of(record_of(name))["materials"]["stone"]["density"])
    total = np.zeros((len(cells.id), 3, 3))
    for side, body, point in ((1, cells.a, "point_a"), (-1, cells.b, "point_b")):
        arm = turned(cells.q[body[bond]], cells.bond[point][bond])
        np.add.at(total, body[bond], side * arm[:, :, None] * force[:, None, :])
    near = np.hypot(cells.x[:, 0], cells.x[:, 2]) < D / 10
    stress = total[near].sum(axis=0) / (mass[near].sum() / density)
    log = run.log
    load = 0.5 * (log["wall2_force_z"][-1] - log["wall1_force_z"][-1])
    return 0.5 * (stress + stress.T) * np.pi * D * T / (2 * load), load, int(near.sum())


held = [middle_stress(name) for name in HELD]
across, along = np.array([h[0][0, 0] for h in held]), np.array([h[0][2, 2] for h in held])


def mean(x):
    return f"{x.mean():.3f}" + (f" +- {2 * x.std(ddof=1) / np.sqrt(len(x)):.3f}" if len(x) > 1 else "")


cells, run = Cells(SPLIT), scree.open(f"{SPLIT}.run")
log = run.log
force = 0.5 * (log["wall2_force_z"] - log["wall1_force_z"])
top = int(np.argmax(force))
fallen = top + int(np.argmax(force[top:] < 0.5 * force[top])) if (force[top:] < 0.5 * force[top]).any() else len(force) - 1
broke_at = np.full(len(cells.a), np.inf)
for frame in run.frames:
    with h5py.File(f"{SPLIT}.run/{os.path.basename(frame.path)}") as file:
        holds = np.zeros(len(broke_at), bool)
        holds[file["bonds/bond"][:]] = True
    broke_at[~holds & ~np.isfinite(broke_at)] = frame.time
place, normal = cells.places()
broken = broke_at <= log["time"][fallen] * (1 + 1e-9)
tension = si(case_of(record_of(SPLIT))["bonds"][0]["tension"])
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| middle of the disc | measured over 2 P / (pi D t) | Hertz | error |\n|---|---|---|---|\n")
    file.write(f"| stress across the load | {mean(across)} | 1 | {100 * (across.mean() - 1):+.1f} % |\n")
    file.write(f"| stress along the load | {mean(along)} | -3 | {100 * (along.mean() / -3 - 1):+.1f} % |\n\n")
    file.write(f"{len(held)} cuts, {np.mean([h[1] for h in held]):.0f} N, {np.mean([h[2] for h in held]):.0f} cells in the middle of each\n\n")
    file.write("| split | |\n|---|---|\n")
    file.write(f"| largest force [N] | {force[top]:.0f} |\n| 2 P / (pi D t) over the tension of a bond | {2 * force[top] / (np.pi * D * T) / tension:.2f} |\n")
    file.write(f"| bonds that broke until the force has fallen to half | {broken.sum()} of {len(broken)} |\n")
    file.write(f"| their normals across the load, mean square | {(normal[broken, 0]**2).mean():.2f} |\n")
    file.write(f"| their distance from the loaded diameter, over D | {np.abs(place[broken, 0]).mean() / D:.3f} (all: {np.abs(place[:, 0]).mean() / D:.3f}) |\n")

figure, axes = plt.subplots(1, 3, figsize=(13, 4))
axes[0].plot(log["time"] * 1e3, force / 1e3, color="#0072B2")
axes[0].set(xlabel="time [ms]", ylabel="force [kN]", title="force of the plates")
shown = axes[1].scatter(place[broken, 0] * 1e3, place[broken, 2] * 1e3, c=broke_at[broken] * 1e3, s=9, cmap="viridis")
turn = np.linspace(0, 2 * np.pi, 200)
axes[1].plot(25 * np.cos(turn), 25 * np.sin(turn), color="0.5", lw=0.8)
axes[1].set(aspect="equal", xlabel="x [mm]", ylabel="z [mm]", title="where bonds broke, pressed along z")
figure.colorbar(shown, ax=axes[1], label="time [ms]")
axes[2].plot(range(1, len(held) + 1), across, "o", color="#0072B2", label="across")
axes[2].plot(range(1, len(held) + 1), -along / 3, "s", color="#D55E00", label="along / -3")
axes[2].axhline(1, color="0.5", lw=0.8)
axes[2].set(xlabel="cut", ylabel="stress over 2 P / (π D t)", title="middle of the disc", ylim=(0, 1.5))
axes[2].legend(frameon=False)
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
