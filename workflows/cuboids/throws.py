#!/usr/bin/env python3
"""The case of throws: boxes of each aspect with random orientation, velocity and spin. usage: throws.py CASE.toml PUBLISHED.csv COUNT SEED OUTPUT.toml [FIT.json]

Orientations are uniform. Velocities along the table and spins are normal, of the deviations below. Boxes start at the nodes of a square grid; every aspect
has its nodes everywhere in the grid. FIT.json holds restitution and friction of boxes and table, instead of those of the case.
"""
import json
import math
import os
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import numpy as np  # noqa: E402
from landing import name_of, published, scree  # noqa: E402

HEIGHT = 0.25   # of the centre above the table [m]
SPEED = 0.3     # along the table, standard deviation of each component [m/s]
SPIN = 20.0     # standard deviation of each component [rad/s]
APART = 0.7     # [m]

if len(sys.argv) not in (6, 7):
    raise SystemExit("usage: throws.py CASE.toml PUBLISHED.csv COUNT SEED OUTPUT.toml [FIT.json]")
CASE, PUBLISHED, COUNT, SEED, OUTPUT, *FIT = sys.argv[1:]
if not COUNT.isdecimal() or int(COUNT) < 1:
    raise SystemExit(f"throws.py: {COUNT} throws of each aspect: expected a whole number above 0")
count = int(COUNT)
case = scree.Case(CASE)
if FIT:
    with open(FIT[0], encoding="utf-8") as file:
        fit = json.load(file)
    case["pairs.0.restitution"], case["pairs.0.friction"] = fit["restitution"], fit["friction"]
aspects = sorted({1.0, *published(PUBLISHED)})   # the cube is not among the published ones
random = np.random.default_rng(int(SEED))
side = math.ceil(math.sqrt(count * len(aspects)))
nodes = random.permutation(side * side)
for k, aspect in enumerate(aspects):
    row, column = np.divmod(nodes[k * count:(k + 1) * count], side)
    turn = random.normal(size=(count, 4))
    case[f"shapes.{name_of(aspect)}.file"] = f"{name_of(aspect)}.shape.h5"
    case.add_bodies(name_of(aspect), "steel", np.column_stack([APART * (row - side / 2), APART * (column - side / 2), np.full(count, HEIGHT)]),
                    turn / np.linalg.norm(turn, axis=1)[:, None], np.column_stack([SPEED * random.normal(size=(count, 2)), np.zeros(count)]),
                    SPIN * random.normal(size=(count, 3)))
case.data["seed"] = int(SEED)
case.path = None   # the shapes lie next to the output
case.save(OUTPUT, check=count * len(aspects) <= 1000)   # scree-decomposer checks all of a large case in less time
