#!/usr/bin/env python3
"""Cubes, tetrahedra and octahedra poured into a wide vessel and tapped: solid fraction of the bulk, before and after.

usage: dice.py BIN OUT [--shapes cube,tetra,octa] [--count N] [--taps N] [--friction F] [--seeds 1,2,3]

All dice have the volume of a ball of 1 cm. The vessel is periodic in x and y, so that no side wall orders the dice; the margin of
contact is 0.2 % of that diameter. Pouring is the decomposer's method "settle". A tap is a half sine of the floor, a seventh of the
diameter high in 10 ms; then the dice have 90 ms to come to rest. The fraction is counted by random points between one and a half
diameters above the floor and one below the top, where neither shows.
Reference: J. Baker and A. Kudrolli, Maximum and minimum stable random packings of Platonic solids, Phys. Rev. E 82 (2010) 061304.
"""
import argparse
import csv
import math
import os
import subprocess

import h5py
import numpy as np

DIAMETER, WIDTH, MARGIN = 0.01, 0.045, 2e-5
VOLUME = math.pi / 6 * DIAMETER**3
LOOSE = {"cube": 0.54, "tetra": 0.51, "octa": 0.52}
DENSEST = {"cube": 0.67, "tetra": 0.64, "octa": 0.64}
LIFT, PULSE, REST = DIAMETER / 7, 0.01, 0.09   # of a tap [m], [s], [s]


def mesh(name):
    """Vertices [m] and triangles, outward."""
    if name == "cube":
        a = VOLUME ** (1 / 3) / 2
        v = [(x, y, z) for z in (-a, a) for y in (-a, a) for x in (-a, a)]
        return v, [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    if name == "tetra":
        s = (6 * math.sqrt(2) * VOLUME) ** (1 / 3) / (2 * math.sqrt(2))
        return [(s, s, s), (s, -s, -s), (-s, s, -s), (-s, -s, s)], [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
    r = (3 * VOLUME / 4) ** (1 / 3)
    return ([(r, 0, 0), (-r, 0, 0), (0, r, 0), (0, -r, 0), (0, 0, r), (0, 0, -r)],
            [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])


def tap_table(taps):
    """Times [s] and heights [m] of the floor."""
    time, height = [0.0], [0.0]
    for tap in range(taps):
        start = tap * (PULSE + REST)
        for k in range(1, 9):
            time.append(start + PULSE * k / 8)
            height.append(LIFT * math.sin(math.pi * k / 8) if k < 8 else 0.0)
        time.append(start + PULSE + REST)
        height.append(0.0)
    return time, height


def case_text(name, seed, count, taps, friction):
    time, height = tap_table(max(taps, 1))
    depth = count * VOLUME / (0.5 * WIDTH**2)
    return f"""title = "dice: {name}"
seed = {seed}
[time]
duration = {max(taps * (PULSE + REST), 1e-6):g}
steps_per_contact = 20
[domain]
min = [0, 0, -0.02]
max = [{WIDTH}, {WIDTH}, {3 * depth + 0.1:g}]
periodic = ["x", "y"]
[shapes.die]
file = "{name}.shape.h5"
[materials.plastic]
density = 1200
[[pairs]]
between = ["plastic", "plastic"]
stiffness = 1.2e6
restitution = 0.3
friction = {friction}
[contact]
margin = {MARGIN}
[[populations]]
shape = "die"
material = "plastic"
count = {count}
method = "settle"
region = {{ box = [[0, 0, 0], [{WIDTH}, {WIDTH}, {depth + 4 * DIAMETER:g}]] }}
[[walls]]
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "plastic"
motion = {{ table = {{ time = {time}, position = {[[0, 0, h] for h in height]} }} }}
[output]
every = {PULSE + REST}
contacts = false
"""


def fraction(scene, frame=None, samples=200000):
    """Solid fraction of the bulk; positions from a frame when one is given."""
    with h5py.File(scene, "r") as file:
        x, q = file["bodies/position"][:], file["bodies/orientation"][:]
        vertex, triangle = file["shapes/shape_0000/vertices"][:], file["shapes/shape_0000/triangles"][:]
    if frame:
        with h5py.File(frame, "r") as file:
            order = np.argsort(file["VTKHDF/PointData/id"][:])
            x, q = file["VTKHDF/Points"][:][order], file["VTKHDF/PointData/quat"][:][order]
    normal = np.cross(vertex[triangle[:, 1]] - vertex[triangle[:, 0]], vertex[triangle[:, 2]] - vertex[triangle[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    offset = np.sum(normal * vertex[triangle[:, 0]], axis=1)
    reach = np.linalg.norm(vertex, axis=1).max()
    low, high = 1.5 * DIAMETER, np.quantile(x[:, 2], 0.95) - DIAMETER
    if not high > low + DIAMETER:
        return float("nan")   # too few dice for a bulk
    random = np.random.default_rng(1)
    points = np.column_stack([random.random((samples, 2)) * WIDTH, low + (high - low) * random.random(samples)])
    inside = np.zeros(samples, bool)
    for centre, turn in zip(x, q):
        d = points - centre
        d[:, :2] -= WIDTH * np.round(d[:, :2] / WIDTH)
        near = np.where(np.sum(d * d, axis=1) < reach**2)[0]
        t = 2 * np.cross(-turn[1:], d[near])
        local = d[near] + turn[0] * t + np.cross(-turn[1:], t)
        inside[near] |= np.all(local @ normal.T <= offset, axis=1)
    return float(inside.mean())


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("bin")
    words.add_argument("out")
    words.add_argument("--shapes", default="cube,tetra,octa")
    words.add_argument("--count", type=int, default=110)
    words.add_argument("--taps", type=int, default=50)
    words.add_argument("--friction", type=float, default=0.5)
    words.add_argument("--seeds", default="1")
    a = words.parse_args()
    os.makedirs(a.out, exist_ok=True)

    def tool(name, *arguments):
        subprocess.run([os.path.join(os.path.abspath(a.bin), name), *arguments], cwd=a.out, check=True)

    rows = []
    for name in a.shapes.split(","):
        vertices, triangles = mesh(name)
        with open(os.path.join(a.out, f"{name}.obj"), "w", encoding="ascii") as file:
            file.writelines("v %.17g %.17g %.17g\n" % tuple(v) for v in vertices)
            file.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in triangles)
        tool("scree-mesher", "import", f"{name}.obj", "-o", f"{name}.shape.h5", "--unit", "m")
        for seed in (int(s) for s in a.seeds.split(",")):
            stem = f"{name}-{seed}"
            with open(os.path.join(a.out, f"{stem}.toml"), "w", encoding="ascii") as file:
                file.write(case_text(name, seed, a.count, a.taps, a.friction))
            scene = os.path.join(a.out, f"{stem}.scene.h5")
            tool("scree-decomposer", "pack", f"{stem}.toml", "-o", f"{stem}.scene.h5")
            row = {"shape": name, "seed": seed, "count": a.count, "friction": a.friction, "poured": fraction(scene), "loose": LOOSE[name],
                   "taps": a.taps, "tapped": float("nan"), "densest": DENSEST[name]}
            if a.taps > 0:
                tool("scree-solver", f"{stem}.scene.h5", "-o", f"{stem}.run")
                last = sorted(f for f in os.listdir(os.path.join(a.out, f"{stem}.run")) if f.startswith("frame_"))[-1]
                row["tapped"] = fraction(scene, os.path.join(a.out, f"{stem}.run", last))
            rows.append(row)
            with open(os.path.join(a.out, "dice.csv"), "w", encoding="ascii", newline="") as file:
                table = csv.DictWriter(file, row.keys(), lineterminator="\n")
                table.writeheader()
                table.writerows({k: f"{v:.4f}" if isinstance(v, float) else v for k, v in r.items()} for r in rows)
            print(", ".join(f"{k} {v:.3f}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()), flush=True)


if __name__ == "__main__":
    main()
