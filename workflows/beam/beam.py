#!/usr/bin/env python3
"""Deflection of cantilevers of bonded cells, and bars that are bent until they break. usage: beam.py TABLE.md CHART.svg CHART.png HELD... -- BENT...

theory     S. Timoshenko, On the correction for shear of the differential equation for transverse vibrations of prismatic bars, Phil. Mag. 41 (1921) 744, at
           rest: P L^3 / (3 E I) + P L / (k G A) at the end of a cantilever, k = 5/6. Euler and Bernoulli have the first term alone
material   bonds with tangential_ratio = 1: Young's modulus that of the bonds, Poisson's ratio 0 (Bolander, Saito 1998). With 0.25: 0.609 of it and 0.196,
           those of periodic cells of evenly spread points that may move and turn
bent       slope of force over deflection, from a fifth to three fifths of the largest force. Modulus of rupture 3 P L / (2 b h^2)
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

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
HELD, BENT = NAMES[:NAMES.index("--")], NAMES[NAMES.index("--") + 1:]
SIDE, SPAN, LOAD = 0.02, 0.08, 10.0
LENGTH = 0.10202           # from the centre of one plate to that of the other: bonds reach to the centres of both bodies
AREA, INERTIA = SIDE**2, SIDE**4 / 12
OF_RATIO = {1.0: (1.0, 0.0), 0.25: (0.609, 0.196)}   # Young's modulus over that of the bonds, Poisson's ratio


class Material:
    def __init__(self, name):
        bond = case_of(record_of(name))["bonds"][0]
        self.ratio = float(bond.get("tangential_ratio", 0.25))
        share, poisson = OF_RATIO[self.ratio]
        self.young = share * si(bond["young"])
        self.bending, self.shear = self.young * INERTIA, 5 / 6 * self.young / (2 * (1 + poisson)) * AREA


def cantilever(m, x):
    """Deflection at a distance from the clamp: bending, and with shear."""
    bending = LOAD * x**2 * (3 * LENGTH - x) / (6 * m.bending)
    return bending, bending + LOAD * x / m.shear


def bent(m, x):
    """Deflection for a force of 1 N at a distance from the middle between two supports; zero at these, and straight beyond them."""
    a = np.minimum(np.abs(x), SPAN / 2)
    down = SPAN / 2 - a
    slope = SPAN**2 / (16 * m.bending)
    return down * (3 * SPAN**2 - 4 * down**2) / (48 * m.bending) + down / (2 * m.shear) - slope * (np.abs(x) - a)


class Bodies:
    """Of a run, in the order of the scene: where they were, how far they have moved, their volume."""
    def __init__(self, name):
        self.run = scree.open(f"{name}.run")
        with h5py.File(f"{name}.scene.h5") as file:
            self.id, self.x = file["bodies/id"][:], file["bodies/position"][:]
        self.by_id = np.argsort(np.argsort(self.id))

    def moved(self, frame):
        order = np.argsort(frame.bodies.id)
        self.mass = frame.bodies.mass[order][self.by_id]
        return frame.bodies.position[order][self.by_id] - self.x


def held(name):
    m, b = Material(name), Bodies(name)
    moved = b.moved(b.run.frames[-1])
    plate = int(np.argmax(b.x[:, 0]))
    pieces = np.abs(b.x[:, 0]) < 0.05
    before = b.moved(b.run.frames[-2])[plate, 2]
    bending, whole = cantilever(m, LENGTH)
    log = b.run.log
    down = -moved[plate, 2]
    return {"cells": int(pieces.sum()), "ratio": m.ratio, "bending": down / bending, "whole": down / whole, "late": abs(before / moved[plate, 2] - 1),
            "energy": log["bond"][-1] / (0.5 * LOAD * down), "x": b.x[pieces, 0] + LENGTH / 2, "z": -moved[pieces, 2], "material": m}


def broken(name):
    m, b = Material(name), Bodies(name)
    log = b.run.log
    force = log["wall3_force_z"]
    frames = [(f.time, b.moved(f)) for f in b.run.frames]
    ends, middle = np.abs(np.abs(b.x[:, 0]) - SPAN / 2) < 0.006, np.abs(b.x[:, 0]) < 0.006

    def sag(z):
        return np.average(z[ends], weights=b.mass[ends]) - np.average(z[middle], weights=b.mass[middle])
    sags = np.array([sag(moved[:, 2]) for _, moved in frames])
    loads = np.interp([t for t, _ in frames], log["time"], force)
    top = int(np.argmax(force))
    rising = (loads > 0.2 * force[top]) & (loads < 0.6 * force[top]) & (np.array([t for t, _ in frames]) < log["time"][top])
    slope = np.polyfit(sags[rising], loads[rising], 1)[0]
    fallen = top + int(np.argmax(force[top:] < 0.1 * force[top])) if (force[top:] < 0.1 * force[top]).any() else len(force) - 1
    with h5py.File(f"{name}.scene.h5") as file:
        bond = {n: file[f"bonds/{n}"][:] for n in ("a", "point_a")}
    row = {int(i): k for k, i in enumerate(b.id)}
    place = b.x[[row[int(i)] for i in bond["a"]]] + bond["point_a"]   # bodies are not turned at the start
    when = np.full(len(place), np.inf)
    for f in b.run.frames:
        with h5py.File(f"{name}.run/{os.path.basename(f.path)}") as file:
            holds = np.zeros(len(place), bool)
            holds[file["bonds/bond"][:]] = True
        when[~holds & ~np.isfinite(when)] = f.time
    gone = when <= log["time"][fallen] * (1 + 1e-9)
    tension = si(case_of(record_of(name))["bonds"][0]["tension"])
    return {"stiffness": -slope * sag(bent(m, b.x[:, 0])), "force": force[top], "rupture": 1.5 * force[top] * SPAN / SIDE**3 / tension,
            "broken": int(gone.sum()), "bonds": len(gone), "place": place[gone], "when": when[gone], "all": np.abs(place[:, 0]).mean(),
            "log": log, "sags": sags, "loads": loads, "slope": 1 / -sag(bent(m, b.x[:, 0]))}


def mean(x, digits=3):
    x = np.asarray(x)
    return f"{x.mean():.{digits}f}" + (f" +- {2 * x.std(ddof=1) / np.sqrt(len(x)):.{digits}f}" if len(x) > 1 else "")


bars, breaks = [held(name) for name in HELD], [broken(name) for name in BENT]
kinds = sorted({(-b["ratio"], b["cells"]) for b in bars})
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| cantilever | cuts | deflection over Timoshenko | over Euler and Bernoulli | energy of bonds over P w / 2 | change in the last 1 ms |\n"
               "|---|---|---|---|---|---|\n")
    for ratio, cells in kinds:
        of = [b for b in bars if (-b["ratio"], b["cells"]) == (ratio, cells)]
        file.write(f"| {cells} cells, tangential_ratio {-ratio:g} | {len(of)} | {mean([b['whole'] for b in of], 4)} | {mean([b['bending'] for b in of], 4)} | "
                   f"{mean([b['energy'] for b in of], 6)} | {max(b['late'] for b in of):.0e} |\n")
    file.write("\n| bent until it breaks | |\n|---|---|\n")
    file.write(f"| stiffness over Timoshenko's | {mean([b['stiffness'] for b in breaks])} |\n")
    file.write(f"| largest force [N] | {mean([b['force'] for b in breaks], 1)} |\n")
    file.write(f"| modulus of rupture over the tension of a bond | {mean([b['rupture'] for b in breaks])} |\n")
    file.write(f"| bonds that broke until the force has fallen to a tenth | {', '.join(str(b['broken']) for b in breaks)} of {breaks[0]['bonds']} |\n")
    file.write(f"| their distance from the middle, over the span | {mean([np.abs(b['place'][:, 0]).mean() / SPAN if b['broken'] else np.nan for b in breaks])} "
               f"(all: {breaks[0]['all'] / SPAN:.3f}) |\n")

figure, axes = plt.subplots(1, 3, figsize=(14, 4.2))
longest = max(b["cells"] for b in bars if b["ratio"] == min(c["ratio"] for c in bars))
x = np.linspace(0, LENGTH, 200)
for ratio, colour in ((1.0, "#0072B2"), (0.25, "#D55E00")):
    of = [b for b in bars if b["ratio"] == ratio and b["cells"] == longest][:1]
    for b in of:
        axes[0].plot(b["x"] * 1e3, b["z"] * 1e6, ".", ms=3, color=colour, label=f"cells, tangential_ratio {ratio:g}")
        axes[0].plot(x * 1e3, cantilever(b["material"], x)[1] * 1e6, "-" if ratio == 1 else "--", lw=1, color="0.2",
                     label="Timoshenko" if ratio == 1 else "Timoshenko, moduli of many cells")
axes[0].invert_yaxis()
axes[0].set(xlabel="from the clamp [mm]", ylabel="deflection [µm]", title=f"cantilever of {longest} cells under {LOAD:g} N")
axes[0].legend(frameon=False, loc="lower left")
for k, b in enumerate(breaks):
    axes[1].plot(b["sags"] * 1e6, b["loads"], "-", lw=1.2, color=("#0072B2", "#009E73", "#CC79A7")[k % 3], label=f"cut {k + 1}")
reach = np.array([0, 1.1 * max(b["force"] / b["slope"] for b in breaks)])
axes[1].plot(reach * 1e6, reach * breaks[0]["slope"], "--", lw=1, color="0.2", label="Timoshenko")
axes[1].set(xlabel="deflection of the middle [µm]", ylabel="force of the edge in the middle [N]", title="bent on two edges until it breaks", xlim=(0, 1.9 * reach[1] * 1e6),
            ylim=(0, None))
axes[1].legend(frameon=False, loc="center right")
for k, b in enumerate(breaks):
    axes[2].scatter(b["place"][:, 0] * 1e3, b["place"][:, 2] * 1e3, s=14, color=("#0072B2", "#009E73", "#CC79A7")[k % 3], label=f"cut {k + 1}")
for z in (-10, 10):
    axes[2].axhline(z, color="0.5", lw=0.8)
axes[2].plot([-3.5, 0, 3.5], [13.5, 10, 13.5], color="0.5", lw=0.8)
axes[2].set(aspect="equal", xlabel="from the middle of the bar [mm]", ylabel="height [mm]", title="where bonds broke", xlim=(-18, 18), ylim=(-12, 14))
axes[2].legend(frameon=False, loc="upper right")
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
