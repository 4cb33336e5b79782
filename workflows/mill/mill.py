#!/usr/bin/env python3
"""The load of a mill: its angles, the power it draws, what wears the liner, impacts. usage: mill.py TABLE.md CHART.svg CHART.png NAME ...

Angles are counted with the turn of the mill from its top; means over the second half of the run, two turns at most.
shoulder  where the load leaves the liner: the last direction in which the ring along the liner, two balls wide, holds half of what it holds in the
          bed (median from 180 to 270 degrees)
toe       the first such direction
chord     how steep the line from the toe to the shoulder is, if both lie on one circle: (shoulder + toe) / 2 - 180
centre    direction of the centre of mass below the axis, from the vertical
power     of the wall on the bodies, and weight times lever of the centre of mass times rate, which is the same where the load is steady
"""
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

TABLE, SVG, PNG, *NAMES = sys.argv[1:]
G = 9.81
MEASURED = {"shoulder": 303.0, "toe": 128.0, "third angle": 34.7}   # Kalala et al. (2008)
ROCKY = {"shoulder": 295.0, "toe": 132.0, "third angle": 36.05}     # Rocky DEM, verification manual 2.3
SECTORS = 360


def read(name):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    wall = case["walls"][0]
    drum = wall["shape"]["drum"]
    rim = si(drum["radius"]) - si(drum["lifters"]["height"])
    rate = si(wall["motion"]["rotate"]["rate"])
    end = run.frames[-1].time
    since = max(0.5 * end, end - 4 * np.pi / rate)
    frames = [frame for frame in run.frames if frame.time > since]
    length = si(case["domain"]["max"][1]) - si(case["domain"]["min"][1])
    masses = frames[-1].bodies.mass
    volume = masses.mean() / si(case["materials"]["ball"]["density"])
    wide = 2 * (6 * volume / np.pi) ** (1 / 3)   # two balls
    ring, centres, cells = np.zeros(SECTORS), [], 60
    density = np.zeros((cells, cells))
    reach = si(drum["radius"])
    for frame in frames:
        x = frame.bodies.position
        r, angle = np.hypot(x[:, 0], x[:, 2]), np.degrees(np.arctan2(x[:, 0], x[:, 2])) % 360
        ring += np.histogram(angle[(r > rim - wide) & (r < rim)], bins=SECTORS, range=(0, 360))[0]
        centres.append(np.average(x, axis=0, weights=frame.bodies.mass))
        density += np.histogram2d(x[:, 0], x[:, 2], bins=cells, range=[[-reach, reach]] * 2)[0]
    ring *= volume / len(frames) / (np.pi / SECTORS * (rim ** 2 - (rim - wide) ** 2) * length)
    around = 2 * int(0.5 * np.degrees(0.5 * wide / rim)) + 1   # sectors: a ball as seen from the axis
    smooth = np.convolve(np.r_[ring, ring, ring], np.ones(around) / around, "same")[SECTORS:2 * SECTORS]
    bed = np.median(smooth[180:270])
    filled = smooth > 0.5 * bed
    lowest = 200   # in the bed of any mill that carries its load up
    toe = next(a for a in range(lowest, 0, -1) if not filled[a]) + 1
    shoulder = next(a for a in range(lowest, 360) if not filled[a]) - 1
    centre = np.mean(centres, axis=0)
    log = run.log
    late = log["time"] > since
    power = log[f"wall{next(iter(run.scene.walls.in_order)).id}_power"][late].mean()
    lever = masses.sum() * G * abs(centre[0]) * rate
    return {"run": run, "rate": rate, "from": since, "to": end, "turns": (end - since) * rate / (2 * np.pi), "toe": float(toe), "shoulder": float(shoulder),
            "chord": 0.5 * (toe + shoulder) - 180, "centre": float(np.degrees(np.arctan2(-centre[0], -centre[2]))), "power": power, "lever": lever,
            "mass": masses.sum(), "bodies": len(masses), "smooth": smooth / bed, "density": density * volume / len(frames) / (length * (2 * reach / cells) ** 2),
            "reach": reach, "last": frames[-1]}


found = {name: read(name) for name in NAMES}
lines = ["| what | measured (Kalala) | Rocky | " + " | ".join(NAMES) + " |", "| --- | --- | --- |" + " --- |" * len(NAMES)]
for what, key in (("shoulder", "shoulder"), ("toe", "toe"), ("third angle", "chord")):
    lines.append(f"| {what} | {MEASURED[what]:g} | {ROCKY[what]:g} | " + " | ".join(f"{r[key]:.1f} ({r[key] - MEASURED[what]:+.1f})" for r in found.values()) + " |")
lines.append("| direction of the centre of mass | | | " + " | ".join(f"{r['centre']:.1f}" for r in found.values()) + " |")
lines.append("| power of the wall [W] | | | " + " | ".join(f"{r['power']:.4g}" for r in found.values()) + " |")
lines.append("| weight x lever x rate [W] | | | " + " | ".join(f"{r['lever']:.4g}" for r in found.values()) + " |")
lines.append("| power by mass [W/kg] | | | " + " | ".join(f"{r['power'] / r['mass']:.3g}" for r in found.values()) + " |")


def between(run, first, last):
    """Sums of a group of the frames between two of them."""
    return {name: last[name] - first[name] for name in last}


def losses(run, since):
    import h5py
    paths = [frame.path for frame in run.frames if frame.time > since]
    sums = []
    for path in (paths[0], paths[-1]):
        with h5py.File(path) as file:
            sums.append({name: file["losses"][name][()] for name in ("damping", "friction", "rolling")})
            a, b = file["losses/material_a"][()], file["losses/material_b"][()]
    return a, b, between(run, *sums)


def impacts(run, since):
    """Bins of energy between the first and the last frame of the steady part: (material_a, material_b) -> {energy: count}."""
    import h5py
    paths = [frame.path for frame in run.frames if frame.time > since]
    tables = []
    for path in (paths[0], paths[-1]):
        with h5py.File(path) as file:
            group = file["impacts"]
            tables.append({(int(a), int(b), float(low), float(high)): (int(n), int(s)) for a, b, low, high, n, s in
                           zip(*(group[name][()] for name in ("material_a", "material_b", "energy_from", "energy_to", "normal_count", "shear_count")))})
    return {key: (n - tables[0].get(key, (0, 0))[0], s - tables[0].get(key, (0, 0))[1]) for key, (n, s) in tables[1].items()}


for name, r in found.items():
    times = [frame.time for frame in r["run"].frames if frame.time > r["from"]]
    span = times[-1] - times[0]
    materials = list(r["run"].scene.materials)
    a, b, lost = losses(r["run"], r["from"])
    total = sum(values.sum() for values in lost.values())
    lines.append("")
    lines.append(f"{name}: {r['bodies']} bodies, {r['mass']:.0f} kg, {r['turns']:.1f} turns from {r['from']:.2f} s on. Of {total / span:.4g} W that contacts dissipate: "
                 + ", ".join(f"{100 * lost[cause][k] / total:.0f} % by {cause} between {materials[a[k]]} and {materials[b[k]]}"
                             for k in range(len(a)) for cause in ("damping", "friction") if lost[cause][k] > 0.005 * total) + ".")

figure, axes = plt.subplots(1, 3, figsize=(12, 3.7), gridspec_kw={"width_ratios": [1, 1.1, 1.2]})
first = found[NAMES[0]]
reach = first["reach"]
image = axes[0].imshow(np.ma.masked_less(first["density"].T, 1e-3), origin="lower", extent=[-reach, reach] * 2, cmap="magma_r", vmin=0, vmax=0.65)
figure.colorbar(image, ax=axes[0], label="solid fraction [-]", shrink=0.8)
turn = np.linspace(0, 2 * np.pi, 200)
axes[0].plot(reach * np.sin(turn), reach * np.cos(turn), color="#444444", linewidth=1)
for angles, colour, text in ((MEASURED, "#2a6f97", "measured"), ({"shoulder": first["shoulder"], "toe": first["toe"]}, "#2f9e44", NAMES[0])):
    for k, what in enumerate(("shoulder", "toe")):
        at = np.radians(angles[what])
        axes[0].plot([0, reach * np.sin(at)], [0, reach * np.cos(at)], color=colour, linewidth=1, label=text if k == 0 else None)
axes[0].legend(frameon=False, fontsize=7, loc="upper right")
axes[0].set_aspect("equal")
axes[0].set(xlabel="x [m]", ylabel="z [m]")
axes[0].set_title("mean solid fraction; lines: shoulder and toe", fontsize=9)
for (name, r), colour in zip(found.items(), ("#2f9e44", "#bc6c25")):
    axes[1].plot(np.arange(SECTORS) + 0.5, r["smooth"], color=colour, label=name)
for what in ("shoulder", "toe"):
    axes[1].axvline(MEASURED[what], color="#2a6f97", linestyle="--", linewidth=0.9)
axes[1].axhline(0.5, color="#999999", linewidth=0.6)
axes[1].set_xlabel("angle from the top, along the rotation [deg]")
axes[1].set_ylabel("solid fraction, liner ring / bed [-]")
axes[1].set_title("dashed: shoulder and toe as measured", fontsize=9)
axes[1].legend(frameon=False, fontsize=7)
styles = iter(["-", "--", ":", "-."] * 4)
for name, r in found.items():
    times = [frame.time for frame in r["run"].frames if frame.time > r["from"]]
    bins = impacts(r["run"], r["from"])
    for pair in sorted({key[:2] for key in bins}):
        largest = max(high for (a, b, low, high), counts in bins.items() if counts[0] > 0)
        rows = sorted((np.sqrt(low * high), counts[0] / (times[-1] - times[0]) / np.log2(high / low)) for (a, b, low, high), counts in bins.items()
                      if (a, b) == pair and counts[0] > 0 and high > 1e-9 * largest)
        if rows:
            what = "on the liner" if pair[0] != pair[1] else "among bodies"
            axes[2].plot(*zip(*rows), next(styles), linewidth=1, label=f"{name}, {what}")
axes[2].set_xscale("log")
axes[2].set_yscale("log")
axes[2].set_xlabel("energy of the impact along the normal [J]")
axes[2].set_ylabel("impacts per second and octave [1/s]")
axes[2].legend(frameon=False, fontsize=7)
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Mill\n\nAngles in degrees from the top, with the turn; the difference from the measurement in brackets.\n\n" + "\n".join(lines) + "\n")
