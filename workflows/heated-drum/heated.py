#!/usr/bin/env python3
"""How the bed of a drum with a hot wall warms. usage: heated.py TABLE.md CHART.svg CHART.png NAME ... [--pictures FIRST.png LAST.png]

left share    (T_wall - T) / (T_wall - T_0) of the mean temperature T of the bed, by mass
heating time  of the exponential: one over the mean over turns of what the logarithm of the left share loses in a turn, over the time of a turn. The
              first turn is left out, in which the bed comes down and takes its shape; interval of 95 % by Student's t over turns
off           largest distance of the mean temperature from that exponential, after the first turn
mixed bed     heating time of a bed of one temperature: its heat capacity over the mean of the sum of what its contacts with the wall conduct. It is the
              lowest possible one where stones on the wall are warmer than the bed. What contacts conduct is computed here again from their forces in
              the frames, by the formulas of docs/user/theory.md; those forces include damping, which the solver leaves out. Inflow over that of the log
              is what this costs: the heat flow that follows from the contacts and temperatures of the frames over the mean of that of the log
The requirements stand in README.md.
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.stats import t as student  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
PICTURES = NAMES[NAMES.index("--pictures") + 1:] if "--pictures" in NAMES else []
NAMES = NAMES[:NAMES.index("--pictures")] if PICTURES else NAMES


def to_wall(contacts, bodies, wall):
    """Rows of the bodies that touch a wall, and the normal force of each on it [N]: of all points of the pair together."""
    at_wall = (contacts.body_a == wall) | (contacts.body_b == wall)
    ids = np.where(contacts.body_a == wall, contacts.body_b, contacts.body_a)[at_wall]
    push = (contacts.normal * contacts.normal_force[:, None])[at_wall]
    touching, pair = np.unique(ids, return_inverse=True)
    total = np.zeros((len(touching), 3))
    np.add.at(total, pair, push)
    return np.searchsorted(bodies.id, touching), np.linalg.norm(total, axis=1)


def read(name):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    wall = case["walls"][0]
    stone, steel = case["materials"]["stone"], case["materials"]["steel"]
    capacity, conductivity = si(stone["heat_capacity"]), si(stone["conductivity"])
    modulus = 1 / sum((1 - si(m["poisson"]) ** 2) / si(m["real_young"]) for m in (stone, steel))
    hot, start, turn = si(wall["temperature"]), si(case["heat"]["temperature"]), 2 * np.pi / si(wall["motion"]["rotate"]["rate"])
    drum = next(iter(run.scene.walls.in_order)).id
    time, mean, spread, conductance, inflow, touching, lead = [], [], [], [], [], [], []
    for frame in run.frames:
        bodies = frame.bodies
        rows, force = to_wall(frame.contacts, bodies, drum)
        radius = np.cbrt(0.75 * force * 0.5 * bodies.diameter[rows] / modulus)
        conducts = 2 * (2 * conductivity) * radius   # the surface of the wall has one temperature
        temperature = bodies.temperature
        time.append(frame.time)
        mean.append(np.average(temperature, weights=bodies.mass))
        spread.append(np.sqrt(np.average((temperature - mean[-1]) ** 2, weights=bodies.mass)))
        conductance.append(conducts.sum())
        inflow.append((conducts * (hot - temperature[rows])).sum())
        touching.append(len(rows) / len(bodies.id))
    time, mean, spread, conductance, inflow = map(np.array, (time, mean, spread, conductance, inflow))
    mass = bodies.mass.sum()
    log = run.log
    heat = log["heat@drum"]
    r = {"time": time, "mean": mean, "spread": spread, "hot": hot, "start": start, "turn": turn, "capacity": capacity, "heat_capacity": mass * capacity,
         "bodies": len(bodies.id), "mass": mass, "share": (hot - mean) / (hot - start), "touching": np.mean(touching), "biot": log["biot"].max(),
         "log_time": log["time"], "heat": heat, "steps": int(log["step"][-1]),
         "balance": np.abs(log["heat_balance"] - log["heat_balance"][0]).max() / log["heat"][0],
         "stored": abs(mass * capacity * (mean[-1] - start) / heat[-1] - 1)}
    turns = int(time[-1] / turn * (1 + 1e-3))
    if turns < 3:
        return r
    late = time > turn
    ln = np.log(r["share"])
    lost = -np.diff(np.interp(turn * np.arange(1, turns + 1), time, ln)) / turn
    rate, error = lost.mean(), student.ppf(0.975, len(lost) - 1) * lost.std(ddof=1) / np.sqrt(len(lost))
    r |= {"tau": 1 / rate, "tau_error": error / rate ** 2, "line": (np.mean(ln[late] + rate * time[late]), rate)}
    r["off"] = np.abs(mean - (hot - (hot - start) * np.exp(r["line"][0] - rate * time)))[late].max()
    sums = conductance[late]
    r |= {"conductance": sums.mean(), "mixed": r["heat_capacity"] / sums.mean()}
    logged = np.interp([time[late][0], time[-1]], log["time"], heat)
    r["inflow"] = inflow[late].mean() / ((logged[1] - logged[0]) / (time[-1] - time[late][0]))
    peak = int(spread.argmax())
    r |= {"peak": (spread[peak], time[peak]), "ratio": spread[late] / (hot - mean[late])}
    return r


found = {name: read(name) for name in NAMES}
WHAT = [
    ("bodies; steps", lambda r: f"{r['bodies']}; {r['steps']}"),
    ("heat capacity [J/(kg K)]", lambda r: f"{r['capacity']:g}"),
    ("mean temperature at the end [K]", lambda r: f"{r['mean'][-1]:.2f}"),
    ("spread at the end [K]", lambda r: f"{r['spread'][-1]:.2f}"),
    ("heating time [s]", lambda r: f"{r['tau']:.2f} +- {r['tau_error']:.2f}"),
    ("largest distance from the exponential [K]", lambda r: f"{r['off']:.2f}"),
    ("stones on the wall, share", lambda r: f"{r['touching']:.3f}"),
    ("sum of what contacts with the wall conduct [W/K]", lambda r: f"{r['conductance']:.5f}"),
    ("heating time of a mixed bed [s]", lambda r: f"{r['mixed']:.2f}"),
    ("heating time over that of a mixed bed", lambda r: f"{r['tau'] / r['mixed']:.3f}"),
    ("inflow over that of the log", lambda r: f"{r['inflow']:.3f}"),
    ("largest spread [K], when [s]", lambda r: f"{r['peak'][0]:.2f}, {r['peak'][1]:.1f}"),
    ("spread over T_wall - T: last turn; the turn before", lambda r: " ; ".join(f"{ratio_of_turn(r, back):.3f}" for back in (1, 2))),
    ("heat stored, less what the wall gave, over it", lambda r: f"{r['stored']:.1e}"),
    ("heat_balance of the log, over the heat at the start", lambda r: f"{r['balance']:.1e}"),
    ("largest Biot number", lambda r: f"{r['biot']:.2g}"),
]


def ratio_of_turn(r, back):
    """Mean of spread / (T_wall - T) over the last turn (1), the turn before (2)."""
    late = r["time"][r["time"] > r["turn"]]
    return r["ratio"][(late > late[-1] - back * r["turn"]) & (late <= late[-1] - (back - 1) * r["turn"] + 1e-9)].mean()


def cell(words, r):
    try:
        return words(r)
    except KeyError:   # fewer than three turns
        return ""


lines = ["| what | " + " | ".join(NAMES) + " |", "| --- |" + " --- |" * len(NAMES)]
lines += [f"| {what} | " + " | ".join(cell(words, r) for r in found.values()) + " |" for what, words in WHAT]
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Heated drum\n\n" + "\n".join(lines) + "\n")

COLOURS = dict(zip(NAMES, ("#bc6c25", "#2a6f97", "#2f9e44")))
same = [name for name in NAMES if found[name]["capacity"] == found[NAMES[0]]["capacity"]]
figure, axes = plt.subplots(2, 3, figsize=(12, 6.8), gridspec_kw={"width_ratios": [0.95, 1.1, 1.1]})
first = found[NAMES[0]]
for axis, picture, when in zip(axes[:, 0], PICTURES, ("after a fifth of the run", "at the end")):
    image = plt.imread(picture)[:, :, :3]
    ink = image.min(axis=2) < 0.99
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    axis.imshow(image[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1], interpolation="lanczos")
    axis.set_title(f"{NAMES[0]}, {when}", fontsize=9)
    scale = plt.cm.ScalarMappable(matplotlib.colors.Normalize(first["start"], first["hot"]), "viridis")
    figure.colorbar(scale, ax=axis, orientation="horizontal", label="temperature [K]", shrink=0.8, pad=0.03)
for axis in axes[:, 0]:
    axis.axis("off")

for name in same:
    r = found[name]
    axes[0, 1].fill_between(r["time"], r["mean"] - r["spread"], r["mean"] + r["spread"], color=COLOURS[name], alpha=0.15, linewidth=0)
    axes[0, 1].plot(r["time"], r["mean"], color=COLOURS[name], label=name)
    if "line" in r:
        late = r["time"] > r["turn"]
        axes[0, 1].plot(r["time"][late], r["hot"] - (r["hot"] - r["start"]) * np.exp(r["line"][0] - r["line"][1] * r["time"][late]), "k--", linewidth=0.7,
                        label=None if name != same[-1] else "exponential")
    axes[0, 2].plot(r["time"], r["spread"], color=COLOURS[name], label=name)
    # what the wall gave in each interval of the frames
    given = np.interp(r["time"], r["log_time"], r["heat"])
    wide = max(1, min(len(given) // 4, round(0.5 * r["turn"] / (r["time"][1] - r["time"][0]))))
    if len(given) > wide:
        flow = (given[wide:] - given[:-wide]) / (r["time"][wide:] - r["time"][:-wide])
        axes[1, 1].plot(0.5 * (r["time"][wide:] + r["time"][:-wide]), 1e3 * flow, color=COLOURS[name], label=name)
    if "conductance" in r:
        late = r["time"] > r["turn"]
        axes[1, 1].plot(r["time"][late], 1e3 * r["conductance"] * (r["hot"] - r["mean"][late]), ":", color=COLOURS[name])
axes[0, 1].axhline(first["hot"], color="#999999", linewidth=0.8)
axes[0, 1].text(first["time"][-1], first["hot"], "wall", color="#777777", fontsize=8, ha="right", va="bottom")
axes[0, 1].set(xlabel="time [s]", ylabel="temperature of the bed [K]")
axes[0, 1].set_title("mean, band: one standard deviation of bodies", fontsize=9)
axes[0, 2].set(xlabel="time [s]", ylabel="standard deviation [K]")
axes[0, 2].set_title("spread over bodies", fontsize=9)
axes[1, 1].set(xlabel="time [s]", ylabel="heat flow of the wall [mW]")
axes[1, 1].set_title("means over half a turn; dotted: mixed bed", fontsize=9)
for name in NAMES:
    r = found[name]
    axes[1, 2].plot(r["time"] / r["capacity"], r["share"], color=COLOURS[name], label=f"{name}, {r['capacity']:g} J/(kg K)")
axes[1, 2].set_yscale("log")
axes[1, 2].yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 3, 5, 7)))
axes[1, 2].yaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
axes[1, 2].yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
axes[1, 2].set_xlim(0, max(r["time"][-1] / r["capacity"] for r in found.values() if r["capacity"] == first["capacity"]))
axes[1, 2].set_ylim(0.9 * min(r["share"][-1] for r in (found[name] for name in same)), 1.03)
axes[1, 2].set(xlabel="time over heat capacity [s kg K/J]", ylabel="$(T_{wall} - T)\\ /\\ (T_{wall} - T_0)$")
axes[1, 2].set_title("left share, with two heat capacities", fontsize=9)
for axis in axes[:, 1:].flat:
    if axis.get_legend_handles_labels()[1]:
        axis.legend(frameon=False, fontsize=7)
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=110)
