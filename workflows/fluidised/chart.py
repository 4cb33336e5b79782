#!/usr/bin/env python3
"""Table and chart of coupled runs. usage: chart.py TABLE.md CHART.svg CHART.png NAME.csv...

Minimum fluidisation velocity: the pressure force of the bed at rest, fitted by a u + b u^2, equals the weight.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

TABLE, SVG, PNG, *FILES = sys.argv[1:]

lines = ["| run | velocity m/s | pressure force / weight | Ergun / weight | force on bodies / pressure force | (pressure force + floor) / weight | void fraction | top mm |",
         "|---|---|---|---|---|---|---|---|"]
notes = [""]
figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for colour, path in zip(("#0072B2", "#D55E00", "#009E73"), FILES):
    name = os.path.basename(path).removesuffix(".csv")
    t = np.genfromtxt(path, delimiter=",", names=True, ndmin=1)
    u, share, expected = t["velocity"], t["pressure_force"] / t["weight"], t["expected_force"] / t["weight"]
    lines += [f"| {name} | {u[k]:g} | {share[k]:.4f} | {expected[k]:.4f} | {t['force_on_bodies'][k] / t['pressure_force'][k]:.5f} | "
              f"{share[k] + t['floor_load'][k] / t['weight'][k]:.4f} | {t['void_fraction'][k]:.3f} | {1e3 * t['top'][k]:.1f} |" for k in range(len(t))]
    plot.errorbar(u, share, t["pressure_force_deviation"] / t["weight"], fmt="o", color=colour, capsize=3, label=name)
    rest = np.logical_and.accumulate(t["pressure_force_deviation"] < 2e-3 * t["pressure_force"])   # a bed that moves makes the pressure fluctuate
    if rest.sum() < 2:
        continue
    terms = np.column_stack([u, u**2])
    (a, b), (c, d) = (np.linalg.lstsq(terms[rest], force[rest], rcond=None)[0] for force in (share, expected))
    minimum, by_ergun = (np.sqrt(a * a + 4 * b) - a) / (2 * b), t["expected_minimum"][rest][-1]
    notes.append(f"- {name}: minimum fluidisation velocity {minimum:.4f} m/s, by Ergun's equation in the deposited void fraction {by_ergun:.4f} m/s ({minimum / by_ergun - 1:+.2%}); "
                 f"pressure drop of the bed at rest within {abs(share / expected - 1)[rest].max():.2%} of Ergun's")
    line = np.linspace(0, minimum, 100)
    plot.plot(line, c * line + d * line**2, "--", color=colour, label=f"{name}, Ergun")
    plot.axvline(minimum, color=colour, linewidth=0.6)
plot.axhline(1, color="grey", linewidth=0.8)
plot.set(xlabel="superficial velocity (m/s)", ylabel="pressure drop x area / weight", xlim=(0, None), ylim=(0, None))
plot.legend(frameon=False)
figure.savefig(SVG)
figure.savefig(PNG, dpi=150)
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("\n".join(lines + notes) + "\n")
