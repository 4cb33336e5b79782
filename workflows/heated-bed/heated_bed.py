#!/usr/bin/env python3
"""Temperatures in the heated bed compared with thermocouples. usage: heated_bed.py TABLE.md CHART.svg CHART.png NAME...

Published: M. Beaulieu, thesis, Polytechnique Montreal (2020), at 40, 60 and 73 mm below the lid; the values at 500 to 4000 s are those that Lethe's
example "heated packed bed" compares with. Thermocouples scatter by .3 K; the band that is asked for is 2 K.
Each value is the mean over balls whose centres lie within two diameters of the axis and one diameter of the depth.
k_eff: of a half space whose surface is at the temperature of the lid, T = T_0 + (T_lid - T_0) erfc(x / (2 sqrt(a t))), k = a rho c (1 - porosity).
k and h: of a half space of conductivity k below a lid that gives h (T_lid - T), fitted to all balls deeper than two diameters (H. S. Carslaw, J. C.
Jaeger, Conduction of Heat in Solids, 1959, section 2.7): the bed without what happens at the lid.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.optimize import brentq, curve_fit  # noqa: E402
from scipy.special import erfc, erfcx  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TIMES = [500, 1000, 2000, 3000, 4000]
PUBLISHED = {40: [20.5, 22.5, 27.2, 30.9, 33.2], 60: [20.1, 20.3, 22.0, 24.3, 26.3], 73: [20.2, 20.3, 21.1, 22.5, 23.9]}  # mm: degC
BAND, ZERO, DIAMETER = 2.0, 273.15, 6.4e-3
COLOURS = {40: "#D55E00", 60: "#0072B2", 73: "#009E73"}
TABLE, SVG, PNG, *NAMES = sys.argv[1:]


def temperatures(run, depth, top):
    """Of the balls at a depth below the lid, against time [s], [degC], and how many balls they are the mean of."""
    place = run.frames[-1].bodies.position
    chosen = (np.hypot(place[:, 0], place[:, 1]) < 2 * DIAMETER) & (abs(top - place[:, 2] - depth) < DIAMETER)
    return np.array([[frame.time, frame.bodies.temperature[chosen].mean() - ZERO] for frame in run.frames]), int(chosen.sum())


def conductivity(density, heat_capacity, time, depth, ratio):
    """k_eff [W/(m K)] for which the half space has that share of the temperature of the lid; nan where it has none yet."""
    if not 1e-4 < ratio < 1:
        return float("nan")
    return density * heat_capacity * brentq(lambda a: erfc(depth / (2 * np.sqrt(a * time))) - ratio, 1e-12, 1e-2)


def bed_and_lid(bodies, top, time, density_heat, start, hot):
    """k [W/(m K)], its standard error and h [W/(m^2 K)]; None where the bed is too low for a half space."""
    depth = top - bodies.position[:, 2]
    inside = (depth > 2 * DIAMETER) & (depth < 0.75 * top)
    if top < 20 * DIAMETER:
        return None

    def half_space(x, k, h):
        reach = np.sqrt(k / density_heat * time)
        u = x / (2 * reach)
        return start + (hot - start) * (erfc(u) - np.exp(-u * u) * erfcx(u + h * reach / k))
    found, spread = curve_fit(half_space, depth[inside], bodies.temperature[inside] - ZERO, p0=(0.3, 10), bounds=(1e-4, 1e4))
    return found[0], np.sqrt(spread[0, 0]), found[1]


lines, notes = [], []
figure, plot = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for name in NAMES:
    run = scree.open(f"{name}.run")
    record = record_of(name)
    bodies = run.frames[-1].bodies
    steel = run.materials["steel"]
    lid = next(wall for wall in run.scene.walls.in_order if wall.name == "lid")
    drawn = next(wall for wall in case_of(record)["walls"] if wall["name"] == "lid")
    top = si(drawn["shape"]["plane"]["point"][2])
    width = np.ptp(bodies.position[:, 0]) + DIAMETER, np.ptp(bodies.position[:, 1]) + DIAMETER
    middle = (bodies.position[:, 2] > 2 * DIAMETER) & (bodies.position[:, 2] < top - 2 * DIAMETER)   # without the loose layers at both ends
    solid = bodies.volume[middle].sum() / (width[0] * width[1] * (top - 4 * DIAMETER))
    log = run.log
    start, hot = 20.0, 53.0
    notes.append(f"- {name}: {len(bodies.id)} balls, {1e3 * top:.1f} mm high, porosity {1 - solid:.3f}; {record['steps']} steps of {record['time'] / record['steps']:.3g} s, "
                 f"{record['wall_seconds']:.1f} s; largest Biot number {log['biot'].max():.2g}; heat stored less heat from the lid "
                 f"{abs(log['heat_balance'] - log['heat_balance'][0]).max() / log[f'wall{lid.id}_heat'][-1]:.1g} of it")
    depths = [depth for depth in PUBLISHED if 1e-3 * depth < top - DIAMETER] or [15, 25]   # of the small bed, with which nothing is compared
    fit = bed_and_lid(bodies, top, run.frames[-1].time, steel.density * steel.heat_capacity * solid, start, hot)
    if fit:
        verdict = ("" if not name.endswith("air") else "; measured 0.55 to 0.59: " + ("holds" if 0.55 - fit[1] <= fit[0] <= 0.59 + fit[1] else "**misses**"))
        notes.append(f"- {name}: the bed conducts {fit[0]:.3f} +- {fit[1]:.3f} W/(m K){verdict}; the lid gives {fit[2]:.1f} W/(m^2 K)")
    for depth in depths:
        series, count = temperatures(run, 1e-3 * depth, top)
        at = np.interp(TIMES, np.round(series[:, 0], 6), series[:, 1], right=np.nan)   # frames lie at multiples of the step
        off = np.abs(at - PUBLISHED.get(depth, np.nan))
        verdict = "" if np.isnan(off).any() else f"holds (at most {off.max():.1f} K off)" if off.max() <= BAND else f"**misses** by {off.max() - BAND:.1f} K"
        seen = series[-1]
        k = conductivity(steel.density * solid, steel.heat_capacity, seen[0], 1e-3 * depth, (seen[1] - start) / (hot - start))
        lines.append(f"| {name} | {depth} mm ({count} balls) | " + " | ".join("" if np.isnan(value) else f"{value:.1f}" for value in at) + f" | {k:.2f} | {verdict} |")
        if fit and name.endswith("air"):   # of the bed of this run, with its surface at the temperature of the lid
            times = np.linspace(1, series[-1, 0], 200)
            surface = start + (hot - start) * erfc(1e-3 * depth / (2 * np.sqrt(fit[0] / (steel.density * steel.heat_capacity * solid) * times)))
            plot.plot(times, surface, ":", color=COLOURS.get(depth, "#CC79A7"), label=f"{depth} mm, half space of this k, surface as the lid")
        plot.plot(series[:, 0], series[:, 1], "-" if name.endswith("air") else "--", color=COLOURS.get(depth, "#CC79A7"), label=f"{depth} mm, {'contacts and air' if name.endswith('air') else 'contacts alone'}")
for depth, published in PUBLISHED.items():
    k = conductivity(7747 * 0.584, 464, 4000, 1e-3 * depth, (published[-1] - 20) / 33)
    lines.append(f"| Beaulieu 2020 | {depth} mm | " + " | ".join(f"{value:.1f}" for value in published) + f" | {k:.2f} | |")
    plot.errorbar(TIMES, published, yerr=BAND, fmt="o", color=COLOURS[depth], markersize=5, capsize=3, label=f"{depth} mm, measured (band 2 K)")
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("Temperature [degC] at depths below the lid; k_eff [W/(m K)] of a half space with the last of them.\n\n| run | depth | " + " | ".join(f"{t} s" for t in TIMES)
               + " | k_eff | verdict |\n|---|---|" + "---|" * (len(TIMES) + 2) + "\n" + "\n".join(lines) + "\n\n" + "\n".join(notes) + "\n")
plot.set_xlabel("time [s]")
plot.set_ylabel("temperature [degC]")
plot.grid(alpha=0.3)
plot.legend(fontsize="x-small")
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
