#!/usr/bin/env python3
"""Strength of rocks between plates, and how fine impacts break them. usage: crush.py TABLE.md CHART.svg CHART.png press-K... drop-V...

strength   of one rock: the largest mean force of both plates until half of its bonds are broken, over the square of its diameter. Corners
           that chip off before make small peaks of their own
modulus    of Weibull, by maximum likelihood with an interval of two standard errors (0.78 m / sqrt n: A. C. Cohen, Technometrics 7, 1965)
t10        share of the mass in fragments of less than a tenth of the rock's diameter; t4 and t2 of a quarter and a half. Cells are the finest
           fragments that there are: a tenth takes more than a thousand of them, and is left out below. Fitted with t = A (1 - exp(-b E)), E
           half the square of the speed (T. J. Napier-Munn et al., Mineral Comminution Circuits, 1996)
"""
import csv
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

DIAMETER = 0.02
TABLE, SVG, PNG, *NAMES = sys.argv[1:]
PRESSED, THROWN = [n for n in NAMES if n.startswith("press-")], [n for n in NAMES if n.startswith("drop-")]


def strength(log):
    """Force, the index of its peak, and whether the rock split."""
    force = 0.5 * (log["wall2_force_z"] - log["wall1_force_z"])
    split = log["bonds"] < 0.5 * log["bonds"][0]
    end = int(np.argmax(split)) if split.any() else len(force)
    return force, int(np.argmax(force[:end])), split.any()


def weibull(x):
    """Scale and modulus of greatest likelihood."""
    x = np.sort(np.asarray(x))
    logs, low, high = np.log(x / x.mean()), 0.05, 200.0

    def rises(m):
        w = np.exp(m * logs)
        return (w * logs).sum() / w.sum() - 1 / m - logs.mean()
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rises(middle) < 0 else (low, middle)
    return x.mean() * np.exp(low * logs).mean() ** (1 / low), low


def saturation(energy, t):
    """A and b of t = A (1 - exp(-b E)) of least squares: b on a grid, A linear."""
    best = (np.inf, 0.0, 0.0)
    for b in np.geomspace(0.05 / energy.max(), 20 / energy.min(), 2000):
        shape = 1 - np.exp(-b * energy)
        a = min(1.0, (shape @ t) / (shape @ shape))
        best = min(best, (float(((t - a * shape) ** 2).sum()), a, b))
    return best[1], best[2], np.sqrt(best[0] / len(t))


strengths, asked, curve, peaks = [], None, None, 0
for name in PRESSED:
    log = scree.open(f"{name}.run").log
    force, top, split = strength(log)
    peaks += split
    strengths.append(force[top] / DIAMETER**2)
    asked = case_of(record_of(name))["bonds"][0]["strength_scatter"]["weibull_modulus"]
    if curve is None:
        curve = 0.2e3 * log["time"], force, top
scale, modulus = weibull(strengths)
error = 2 * 0.78 * modulus / np.sqrt(len(strengths))

energy, fine, largest = [], [], []
for name in THROWN:
    speed = -si(case_of(record_of(name))["bodies"][0]["velocity"][2])
    with open(f"{name}.sizes.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    mass, diameter = np.array([float(r["mass"]) for r in rows]), np.array([float(r["diameter"]) for r in rows])
    cell = DIAMETER / sum(int(r["pieces"]) for r in rows) ** (1 / 3)
    parts = [n for n in (2, 4, 10) if cell < 0.9 * DIAMETER / n]
    energy.append(0.5 * speed**2)
    fine.append([mass[diameter < DIAMETER / n].sum() / mass.sum() for n in parts])
    largest.append(mass.max() / mass.sum())
energy, fine = np.array(energy), np.array(fine)
has_fit = len(energy) > 2
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("| rocks | split | median of F/d^2 [kPa] | Weibull modulus of F/d^2 | of the bonds |\n|---|---|---|---|---|\n")
    file.write(f"| {len(strengths)} | {peaks} | {np.median(strengths) / 1e3:.1f} | {modulus:.1f} +- {error:.1f} | {asked} |\n\n")
    file.write(f"| speed [m/s] | specific energy [J/kg] | {' | '.join(f't{n}' for n in parts)} | largest fragment |\n|---|---|{'---|' * len(parts)}---|\n")
    for e, t, m in zip(energy, fine, largest):
        file.write(f"| {np.sqrt(2 * e):g} | {e:g} | {' | '.join(f'{x:.3f}' for x in t)} | {m:.3f} |\n")
    fits = [saturation(energy, fine[:, k]) for k in range(len(parts))] if has_fit else []
    if has_fit:
        file.write("\n| t = A (1 - exp(-b E)) | A | b [kg/J] | root mean square of what is left |\n|---|---|---|---|\n")
        for n, (a, b, rest) in zip(parts, fits):
            file.write(f"| t{n} | {a:.3f} | {b:.3f} | {rest:.3f} |\n")

figure, axes = plt.subplots(1, 3, figsize=(13, 3.8))
axes[0].plot(curve[0], curve[1], color="#0072B2")
axes[0].plot(curve[0][curve[2]], curve[1][curve[2]], "o", color="#D55E00")
axes[0].set(xlabel="displacement of the plate [mm]", ylabel="force [N]", title="one rock between plates")
x = np.sort(strengths)
axes[1].plot(np.log(x / 1e3), np.log(-np.log(1 - (np.arange(1, len(x) + 1) - 0.5) / len(x))), "o", color="#0072B2")
line = np.array([x[0], x[-1]])
axes[1].plot(np.log(line / 1e3), modulus * np.log(line / scale), color="#D55E00", label=f"m = {modulus:.1f}")
axes[1].set(xlabel="ln(F/d² [kPa])", ylabel="ln ln 1/(1 - P)", title=f"{len(x)} rocks")
axes[1].legend(frameon=False)
for k, (n, mark, colour) in enumerate(zip(parts, "so^", ("#009E73", "#D55E00", "#0072B2"))):
    axes[2].plot(energy, fine[:, k], mark, color=colour, label=f"t{n}")
    if has_fit:
        e = np.linspace(0, energy.max(), 200)
        axes[2].plot(e, fits[k][0] * (1 - np.exp(-fits[k][1] * e)), color=colour)
axes[2].set(xlabel="specific energy [J/kg]", ylabel="mass fraction finer than d/n [-]", ylim=(0, 1.02), title="impacts on an anvil; lines: A (1 - exp(-b E))")
axes[2].legend(frameon=False)
figure.tight_layout()
figure.savefig(SVG)
figure.savefig(PNG, dpi=110)
