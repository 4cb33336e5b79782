#!/usr/bin/env python3
"""Angle of the bed in a turning drum against the Bond number of its liquid bridges. usage: angles.py TABLE.md NUMBERS.json CHART.svg CHART.png NAME ...

Angle of the bed: of the line from the axis to the centre of mass to the vertical, which is that of a flat surface; means over the frames from FROM
turns on, with Student's interval over BLOCKS blocks of time. An avalanche starts at a maximum of this angle and ends at a minimum, where they are SWING or
more apart; means with Student's interval over the avalanches. The Bond number is the force of a bridge at touch over the weight of a ball.

Prediction of the angle at which an avalanche starts, without a fitted number: forces of bridges act as a pressure p_c on the grains, and grains slide at the
friction tan(theta_0) of the dry bed on the stress and this pressure (Badetti and others 2018). At the depth h of the flowing layer
    tan(theta) = tan(theta_0) (1 + p_c / (rho g h cos(theta))).
p_c = sum of force times distance over all bridges / (3 V), with the law of F from the gap of each bridge; h is from the surface, where the number of
balls is half of that in the bed, to where the velocity along the slope is zero, in the middle third of the drum. rho V is the mass of the bed.
"""
import json
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402
from prediction import predicted_start  # noqa: E402
from scree.intervals import mean_interval  # noqa: E402

TABLE, NUMBERS, SVG, PNG, *NAMES = sys.argv[1:]
BLOCKS, FROM, SWING = 8, 0.5, 5.0   # -, turns before the flow is steady, degrees


def crossing(x, y, level):
    """Largest x at which y passes a level, linear in between; NaN if it does not."""
    at = np.flatnonzero((y[:-1] - level) * (y[1:] - level) <= 0)
    if not len(at):
        return np.nan
    k = at[-1]
    return x[k] if y[k + 1] == y[k] else x[k] + (level - y[k]) / (y[k + 1] - y[k]) * (x[k + 1] - x[k])


def avalanches(angle):
    """Angles at which avalanches start, and at which they end."""
    starts, ends, high, low, rises = [], [], angle[0], angle[0], None
    for a in angle:
        high, low = max(high, a), min(low, a)
        if rises is not False and a < high - SWING:      # it has begun to fall: the maximum is behind
            starts += [high] if rises else []
            rises, low = False, a
        elif rises is not True and a > low + SWING:
            ends += [low] if rises is False else []
            rises, high = True, a
    return starts, ends


def flowing_depth(points, velocities, theta, radius, diameter):
    """Depth of the layer that flows down the slope [m]; points and velocities of the frames in the plane of the drum."""
    down, out = np.array([np.cos(theta), -np.sin(theta)]), np.array([np.sin(theta), np.cos(theta)])
    near = np.abs(points @ down) < radius / 3
    height, speed = points[near] @ out, velocities[near] @ down
    edges = np.arange(-radius, radius, diameter / 2)
    middle, count = 0.5 * (edges[1:] + edges[:-1]), np.histogram(height, edges)[0]
    inside = count > 0
    mean = np.histogram(height, edges, weights=speed)[0][inside] / count[inside]
    return crossing(middle, count.astype(float), 0.5 * np.median(count[inside])) - crossing(middle[inside], mean, 0.0)


def read(name):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    rate = si(case["walls"][0]["motion"]["rotate"]["rate"])
    first = FROM * 2 * np.pi / rate
    r, pair = si(case["shapes"]["ball"]["sphere"]["radius"]), case["pairs"][0]
    tension, volume = si(pair.get("surface_tension", 0)), si(pair.get("bridge_volume", 0))
    if run.frames[-1].time < first:
        first = 0.3 * run.frames[-1].time
    angle, force_way, bridges, points, velocities = [], [], [], [], []
    for frame in run.frames:
        if frame.time < first:
            continue
        bodies, contacts = frame.bodies, frame.contacts
        centre = (bodies.mass[:, None] * bodies.position).sum(axis=0) / bodies.mass.sum()
        angle.append(np.degrees(np.arctan2(-centre[0], -centre[2])))
        gap = np.maximum(0.0, -contacts.overlap[np.isin(contacts.body_a, bodies.id) & np.isin(contacts.body_b, bodies.id)])
        bridges.append(2 * len(gap) / len(bodies.id))
        if tension:
            x = 0.5 * gap / np.sqrt(volume / r)   # the law of the solver, Willett and others 2000
            force_way.append((2 * np.pi * r * tension / (1 + 2.1 * x + 10 * x * x) * (2 * r + gap)).sum())
        points.append(bodies.position[:, [0, 2]])
        velocities.append(bodies.velocity[:, [0, 2]])
    if len(angle) < BLOCKS:
        sys.exit(f"angles.py: {name} has {len(angle)} frames of steady flow; {BLOCKS} are needed")
    starts, ends = avalanches(angle)
    g, mass = 9.81, float(bodies.mass.sum())
    theta = mean_interval([block.mean() for block in np.array_split(np.array(angle), BLOCKS)], is_signed=True)
    depth = flowing_depth(np.concatenate(points), np.concatenate(velocities), np.radians(theta.value), si(case["walls"][0]["shape"]["drum"]["radius"]), 2 * r)
    last = run.frames[-1].bodies
    turning = last.velocity - np.cross([0, rate, 0], last.position)   # the drum turns about +y
    shown = np.column_stack([last.position, np.linalg.norm(turning, axis=1)])
    log = run.log
    steady = log["time"] >= first
    lever = -log["axis_torque@drum"][steady].mean() / (mass * g)   # of the centre of mass, from the torque on the drum
    with open(f"{name}.statistics/statistics.json", encoding="utf-8") as file:
        surface = json.load(file)["groups"]["all"].get("angle_of_repose", {})
    return {"bond": 2 * np.pi * r * tension / (g * float(bodies.mass[0])), "volume": volume, "content": volume * np.mean(bridges) / 2 / float(bodies.volume[0]), "theta": theta, "starts": starts, "ends": ends, "surface": surface, "shown": shown, "ball": r,
            "radius": si(case["walls"][0]["shape"]["drum"]["radius"]),
            "depth": depth / (2 * r), "neighbours": float(np.mean(bridges)), "stress": np.mean(force_way) / 3 / (mass * g * depth) if tension else 0.0, "lever": lever,
            "arm": float(-np.concatenate(points)[:, 0].mean())}


def of_avalanches(angles):
    return mean_interval(angles, is_signed=True) if len(angles) > 1 else None


def text(mean):
    return f"{mean.value:.1f} +- {mean.half:.1f}" if mean else ""


def surface_text(surface):
    return "" if surface.get("mean") is None else f"{surface['mean']:.1f} +- {surface['ci95']:.1f}"


runs = [read(name) for name in NAMES]
dry = next((r for r in runs if not r["bond"]), None)
if dry is None:
    sys.exit("angles.py: no dry run is given")
for r in runs:
    r["start"], r["end"] = of_avalanches(r["starts"]), of_avalanches(r["ends"])
zero = np.radians((dry["start"] or dry["theta"]).value)   # a short run has no avalanches
for r in runs:
    predicted = predicted_start(zero, r["stress"])
    r["predicted"] = None if predicted is None else np.degrees(predicted)

lines = ["| liquid | Bond number | volume of a bridge [mm^3] | liquid over solid, by volume [%] | bridges or contacts of a ball | mean angle of the bed [degrees] | of its surface, by `scree-post` | avalanches | "
         "they start at [degrees] | they end at [degrees] | flowing layer h [balls] | p_c / (rho g h) | predicted start [degrees] |", "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
for name, r in zip(NAMES, runs):
    lines.append(f"| {name if r['bond'] else 'none'} | {r['bond']:.2f} | {1e9 * r['volume']:g} | {100 * r['content']:.2g} | {r['neighbours']:.2f} | {r['theta'].value:.1f} +- {r['theta'].half:.1f} | "
                 f"{surface_text(r['surface'])} | {len(r['starts'])} | {text(r['start'])} | {text(r['end'])} | {r['depth']:.1f} | {r['stress']:.2f} | {'none' if r['predicted'] is None else format(r['predicted'], '.1f')} |")
volumes = [r["volume"] for r in runs if r["bond"]]
common = max(set(volumes), key=volumes.count) if volumes else None
series = sorted((r for r in runs if not r["bond"] or r["volume"] == common), key=lambda r: r["bond"])
lines += ["", "Torque on the drum over weight times arm of the centre of mass: "
              f"{min(r['lever'] / r['arm'] for r in runs):.3f} to {max(r['lever'] / r['arm'] for r in runs):.3f}."]
started = [r for r in series if r["start"]]
if len(started) > 2:
    steps = [f"{b.value - a.value:+.1f} +- {np.hypot(a.half, b.half):.1f}" for a, b in zip([r["start"] for r in started[:-1]], [r["start"] for r in started[1:]])]
    lines += ["", f"Growth of the angle at the start of avalanches from each Bond number to the next, bridges of {1e9 * common:g} mm^3 [degrees]: {', '.join(steps)}."]
    half = dry["start"].half
    misses = [f"{r['start'].value - r['predicted']:+.1f} +- {np.hypot(r['start'].half, half):.1f} at {r['bond']:.2g}" for r in started if r["bond"] and r["predicted"] is not None]
    lines += ["", f"Measured less predicted [degrees]: {', '.join(misses) or 'none'}."]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Wet drum\n\n" + "\n".join(lines) + "\n")


def entry(mean):
    return {"mean": float(mean.value), "ci95": float(mean.half)} if mean else None


with open(NUMBERS, "w", encoding="utf-8") as file:
    json.dump({"units": "SI, angles in degrees", "runs": [
        {"run": name, "bond_number": r["bond"], "bridge_volume": r["volume"], "liquid_over_solid_by_volume": float(r["content"]), "neighbours": r["neighbours"], "angle": entry(r["theta"]),
         "avalanches": len(r["starts"]), "start": entry(r["start"]), "end": entry(r["end"]), "flowing_layer_in_balls": None if np.isnan(r["depth"]) else float(r["depth"]),
         "bridge_pressure_over_weight": float(r["stress"]), "predicted_start": r["predicted"]} for name, r in zip(NAMES, runs)]}, file, indent=1)

figure = plt.figure(figsize=(10, 7), layout="constrained")
above, below = figure.subfigures(2, 1, height_ratios=[1, 1.1])
# balls at the end of three runs, by their speed in the drum that turns with them
pictured = [series[0], *series[1:][::-1][:1]] if len(series) < 4 else [series[0], series[len(series) // 2], series[-1]]
fastest = 1e3 * max(np.quantile(r["shown"][:, 3], 0.95) for r in pictured)
for axes, r in zip(above.subplots(1, len(pictured)), pictured):
    order = np.argsort(-r["shown"][:, 1])
    x, z, speed = r["shown"][order][:, [0, 2, 3]].T
    axes.add_patch(plt.Circle((0, 0), 1e3 * r["radius"], fill=False, color="0.5"))
    balls = EllipseCollection(*2 * [np.full(len(x), 2e3 * r["ball"])], np.zeros(len(x)), units="x", offsets=1e3 * np.column_stack([x, z]), transOffset=axes.transData,
                              array=1e3 * speed, cmap="viridis", edgecolor="0.2", linewidth=0.3)
    balls.set_clim(0, fastest)
    axes.add_collection(balls)
    axes.set(aspect="equal", xlim=(-1.03e3 * r["radius"], 1.03e3 * r["radius"]), ylim=(-1.03e3 * r["radius"], 1.03e3 * r["radius"]),
             title=f"Bond number {r['bond']:.2g}" if r["bond"] else "dry")
    axes.axis("off")
above.colorbar(balls, ax=above.axes, label="speed relative to the drum [mm/s]", shrink=0.8)
left, right = below.subplots(1, 2, width_ratios=[1.4, 1])
tensions = [r["bond"] for r in runs if r["bond"]]
liquid = max(set(tensions), key=tensions.count) if tensions else 0
others = sorted((r for r in runs if r["bond"] and r["bond"] == liquid), key=lambda r: r["volume"])
for axes, some, key, scale in ((left, series, "bond", 1), (right, others, "content", 100)):
    at = scale * np.array([r[key] for r in some])
    for quantity, mark, colour, label in (("start", "^", "#bc6c25", "avalanches start"), ("theta", "o", "#2a6f97", "mean"), ("end", "v", "#606c38", "avalanches end")):
        seen = [k for k, r in enumerate(some) if r[quantity]]
        axes.errorbar(at[seen], [some[k][quantity].value for k in seen], [some[k][quantity].half for k in seen], fmt=mark, color=colour, capsize=3, label=label)
    axes.plot(at, [np.nan if r["predicted"] is None else r["predicted"] for r in some], "--", color="0.4", label="start, predicted from the dry bed")
    axes.set(ylim=(15, 70))
left.set(xlabel="Bond number", ylabel="angle of the bed [degrees]", title=f"Bridges of {1e9 * common:g} mm$^3$" if common else "Dry")
left.legend(frameon=False, loc="upper left")
right.set(xlabel="liquid over solid, volumes [%]", title=f"Bond number {liquid:.2g}")
if len(others) > 1:
    right.set_xscale("log")
for path in (SVG, PNG):
    figure.savefig(path, dpi=150, metadata={"Date": None} if path.endswith(".svg") else None)
