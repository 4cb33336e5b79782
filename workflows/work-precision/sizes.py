#!/usr/bin/env python3
"""Of beds of bodies whose sizes differ by ten: what steps their contacts ask for. usage: sizes.py BIN OUT

Every pair is computed in every step, and the step is that of the smallest bodies. Were pairs of large bodies computed every second, fourth, eighth
step (by powers of two below their own critical step), a pass would cost what OUT/sizes.md says under "left". That is a bound: it takes the cost of a contact as
the same for all sizes, and neither the motion of bodies nor what such a scheme itself costs is in it. The critical step of a pair goes with the root of its
mass m* over its stiffness: one stiffness for all (`stiffness`), or one that grows with R* (`modulus`, Hertz).
"""
import os
import subprocess
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python"))
import scree  # noqa: E402

DENSITY = 2500.0
MOST = 8  # steps that a pair may wait
# name: populations (count, size), side of the box through which they fall, its height [m], time [s]
SPREAD = '{{ distribution = "{}", min = 0.004, max = 0.04{} }}'
BEDS = {
    "5 large, 2000 small": ([(2000, "0.004"), (5, "0.04")], 0.09, 0.2, 1.1),
    "even by mass": ([(1500, SPREAD.format("uniform", ', by = "mass"'))], 0.11, 0.5, 1.6),
    "even by number": ([(600, SPREAD.format("uniform", ""))], 0.18, 0.9, 2.0),
}
HEAD = """
seed = 1
gravity = [0, 0, -1]
[time]
duration = {time}
[domain]
min = [0, 0, -0.01]
max = [{side}, {side}, {height}]
periodic = ["x", "y"]
[contact]
margin = 0
[materials.glass]
density = {density}
[[pairs]]
between = ["glass", "glass"]
stiffness = 2e4
restitution = 0.3
friction = 0.5
[shapes.ball]
sphere = {{ radius = 0.5 }}
[output]
every = {time}
[[walls]]
name = "floor"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "glass"
"""
POPULATION = """
[[populations]]
shape = "ball"
material = "glass"
count = {count}
size = {size}
region = {{ box = [[0, 0, 0], [{side}, {side}, {height}]] }}
"""


def contacts_of(name, populations, side, height, time, tools, out):
    """Masses of all bodies, and of both of each contact; a wall's is infinite."""
    path = os.path.join(out, name.replace(" ", "-").replace(",", ""))
    with open(f"{path}.toml", "w", encoding="utf-8") as file:
        file.write(HEAD.format(side=side, height=height, time=time, density=DENSITY))
        for count, size in populations:
            file.write(POPULATION.format(count=count, size=size, side=side, height=height))
    subprocess.run([os.path.join(tools, "scree-decomposer"), "pack", f"{path}.toml", "-o", f"{path}.scene.h5"], check=True)
    subprocess.run([os.path.join(tools, "scree-solver"), f"{path}.scene.h5", "-o", f"{path}.run"], check=True)
    frame = scree.open(f"{path}.run").frames[-1]
    mass = dict(zip(frame.bodies.id.tolist(), frame.bodies.mass.tolist()))
    sides = [np.array([mass.get(body, np.inf) for body in column.tolist()]) for column in (frame.contacts.body_a, frame.contacts.body_b)]
    return np.array(list(mass.values())), *sides


def main():
    tools, out = sys.argv[1:]
    rows = []
    for name, bed in BEDS.items():
        masses, a, b = contacts_of(name, *bed, tools, out)
        for law, goes_with_size in (("one stiffness", 0), ("stiffness with R*", 1)):
            def step(a, b):
                radius = 1 / (a ** (-1 / 3) + b ** (-1 / 3))
                return np.sqrt(1 / (1 / a + 1 / b) / radius**goes_with_size)
            waits = np.minimum(2 ** np.floor(np.log2(step(a, b) / step(masses.min(), masses.min()) * (1 + 1e-9))), MOST)
            shares = [f"{100 * np.mean(waits >= least):.1f} %" for least in (2, 4, MOST)]
            rows.append([name, str(len(masses)), f"{len(a) / len(masses):.2f}", law, *shares, f"{np.mean(1 / waits):.3f}"])
    with open(os.path.join(out, "sizes.md"), "w", encoding="utf-8") as file:
        file.write("| bed | bodies | contacts a body | stiffness of contacts | contacts that could wait 2 steps | 4 | 8 | left |\n|---|---|---|---|---|---|---|---|\n")
        for row in rows:
            file.write("| " + " | ".join(row) + " |\n")


main()
