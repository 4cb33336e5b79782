#!/usr/bin/env python3
"""Probabilities of boxes to land on a square face, against published ones. usage: cuboids.py PUBLISHED.csv FIT.json RUN TABLE.md CHART.svg CHART.png

Errors are one standard deviation of a binomial sample. The deviance is that of two binomial samples, summed over the published aspects, and divided by
their number less the two values that were fitted. A cube lands on each face alike, with any restitution and friction.
"""
import json
import math
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import matplotlib  # noqa: E402
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from landing import deviance, landed, published, scree  # noqa: E402
from scipy.optimize import minimize  # noqa: E402
from scipy.spatial import cKDTree  # noqa: E402

FITTED = 2                 # values: restitution, friction
MOST_DEVIANCE, MOST_RMS = 4.0, 0.03
INTERVAL = 1.96            # standard deviations of an interval of 95 %

if len(sys.argv) != 7:
    raise SystemExit("usage: cuboids.py PUBLISHED.csv FIT.json RUN TABLE.md CHART.svg CHART.png")
PUBLISHED, FIT, NAME, TABLE, SVG, PNG = sys.argv[1:]
thrown, found = published(PUBLISHED), landed(NAME)
with open(FIT, encoding="utf-8") as file:
    fit = json.load(file)
aspects = sorted(thrown)
if len(aspects) <= FITTED or set(aspects) - set(found) or 1.0 not in found or any(found[aspect][0] == 0 for aspect in found):
    raise SystemExit(f"cuboids.py: {NAME}.run has boxes at rest of {', '.join(f'{a:g}' for a in sorted(found) if found[a][0])}; expected all of 1, {', '.join(f'{a:g}' for a in aspects)}")


def error(n, k):
    """One standard deviation of k / n; of a probability that is half a throw away from 0 or 1, where no throw or every throw counts."""
    p = (k + 0.5) / (n + 1)
    return math.sqrt(p * (1 - p) / n)


def smooth(x, n, k, order):
    """Binomial fit of a polynomial of ln x to the logit of the probability: coefficients, deviance, rms of the differences, and the value at x = 1."""
    powers = np.vander(np.log(x), order + 1, increasing=True)

    def loss(c):
        p = 1 / (1 + np.exp(-np.clip(powers @ c, -30, 30)))
        return -2 * float((k * np.log(p) + (n - k) * np.log1p(-p)).sum())

    c = minimize(loss, np.zeros(order + 1), method="BFGS").x
    best = sum(2 * float((a * np.log(np.where(a > 0, a, 1) / n)).sum()) for a in (k, n - k))
    curve = 1 / (1 + np.exp(-powers @ c))
    return c, loss(c) + best, math.sqrt(np.mean((curve - k / n) ** 2)), 1 / (1 + math.exp(-c[0]))


lines = ["| aspect | published | throws | square face, Scree | throws | difference | difference over its error | deviance | in motion or on no face |", "|---" * 9 + "|"]
differences, parts = [], []
for aspect in sorted(found):
    n, k, left = found[aspect]
    p = k / n
    if aspect not in thrown:
        lines.append(f"| {aspect:.2f} | | | {p:.3f} +- {error(n, k):.3f} | {n} | | | | {left} |")
        continue
    m, j = thrown[aspect]
    q = j / m
    common = (j + k) / (m + n)
    scatter = math.sqrt(common * (1 - common) * (1 / m + 1 / n))
    differences.append(p - q)
    parts.append(deviance(m, j, n, k))
    lines.append(f"| {aspect:.2f} | {q:.3f} +- {error(m, j):.3f} | {m} | {p:.3f} +- {error(n, k):.3f} | {n} | {p - q:+.3f} | "
                 f"{(p - q) / scatter if scatter else 0:+.1f} | {parts[-1]:.1f} | {left} |")
total, freedom, rms = sum(parts), len(parts) - FITTED, math.sqrt(np.mean(np.square(differences)))
n, k, _ = found[1.0]
cube, its_error = k / n, math.sqrt(2 / 9 / n)
x, sizes = np.array(aspects), np.array([thrown[aspect] for aspect in aspects], float)
curves = {order + 1: smooth(x, sizes[:, 0], sizes[:, 1], order) for order in (2, 4)}
run = scree.open(f"{NAME}.run")
longest = 2 * max(float(np.linalg.norm(run.shapes[name].mesh.vertices, axis=1).max()) for name in run.shapes)
near = set().union(*(cKDTree(frame.bodies.position).query_pairs(longest) for frame in run.frames))
boxes = sum(row[0] + row[2] for row in found.values())
half = fit["fitted_on_half"]
count = len(aspects) // 2


def verdict(good):
    return "holds" if good else "misses"


lines += [
    "",
    f"Restitution {fit['restitution']:g} and friction {fit['friction']:g} are those of {len(fit['tried'])} tried pairs with the least deviance on all {len(aspects)} aspects "
    f"({fit['tried'][0]['throws']} throws for each pair, other ones than above).",
    "",
    "| measure | Scree | asked | |", "|---|---|---|---|",
    f"| deviance over {freedom} | {total:.1f} / {freedom} = {total / freedom:.2f} | at most {MOST_DEVIANCE:g} | {verdict(total / freedom <= MOST_DEVIANCE)} |",
    f"| rms of the differences | {rms:.4f} | at most {MOST_RMS:g} | {verdict(rms <= MOST_RMS)} |",
    f"| cube on its faces across x | {cube:.4f} +- {its_error:.4f} | 1/3 within {INTERVAL:g} errors | {verdict(abs(cube - 1 / 3) <= INTERVAL * its_error)} |",
    *(f"| published throws about their own smooth curve with {free} values | deviance {curve[1]:.0f}, rms {curve[2]:.3f}, cube {curve[3]:.3f} | | |"
      for free, curve in curves.items()),
    f"| boxes that move or rest on no face | {sum(row[2] for row in found.values())} of {boxes} | | |",
    f"| pairs of boxes that come closer than the longest box is long ({1e3 * longest:.0f} mm) in a frame | {len(near)}, of {boxes} boxes | | |",
    f"| largest overlap over the margin | {float(run.log['max_depth_ratio'].max()):.2f} | | |",
    "",
    "| restitution | friction | deviance, all aspects | every second aspect | the others |", "|---|---|---|---|---|",
    *(f"| {one['restitution']:g} | {one['friction']:g} | {one['deviance']:.1f} | {one['fitted_half']:.1f} | {one['other_half']:.1f} |" for one in fit["tried"]),
    "",
    f"Fitted on every second aspect alone (restitution {half['restitution']:g}, friction {half['friction']:g}), the deviance of the {count} others is {half['other_half']:.1f}"
    + (f"; of the throws above {sum(parts[1::2]):.1f}, rms {math.sqrt(np.mean(np.square(differences[1::2]))):.3f}."
       if all(half[key] == fit[key] for key in ("restitution", "friction")) else "."),
]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Square cuboidal dice\n\n" + "\n".join(lines) + "\n")

figure, axes = plt.subplots(figsize=(6.6, 4.2), layout="constrained")
every = np.array(sorted(found))
n, k = (np.array([found[aspect][i] for aspect in every], float) for i in (0, 1))
way = np.linspace(every[0], every[-1], 300)
c = smooth(every, n, k, 4)[0]
axes.plot(way, 1 / (1 + np.exp(-np.vander(np.log(way), 5, increasing=True) @ c)), color="#2a6f97", linewidth=0.8, label="smooth curve through Scree")
axes.errorbar(every, k / n, [error(*found[aspect][:2]) for aspect in every], fmt="o", ms=4, capsize=2, color="#2a6f97", label=f"Scree, {int(n.max())} throws each")
q = sizes[:, 1] / sizes[:, 0]
axes.errorbar(x, q, [error(*thrown[aspect]) for aspect in aspects], fmt="D", ms=5, mfc="white", capsize=3, color="#bc6c25", label="published")
axes.plot([1], [1 / 3], "+", ms=11, color="0.3", label="cube: 1/3")
axes.set(xlabel="third edge over edge of the square faces", ylabel="probability to land on a square face", ylim=(0, None))
axes.grid(alpha=0.3)
axes.legend(frameon=False)
for path in (SVG, PNG):
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
