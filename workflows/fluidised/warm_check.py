#!/usr/bin/env python3
"""Checks of warm.py against closed forms; prints a table, and fails when a check misses its tolerance. usage: warm_check.py, in a folder of its own

1. Air through balls whose temperature is held, in plug flow: its difference to them decays as exp(-z / L), L = rho c U / (h a); with half the height of a
   cell the error halves.
2. Hot air through a column of cold balls that Scree's engine holds (heat.frozen): temperatures of balls and air after the front has gone half way, T. E. W.
   Schumann, J. Franklin Inst. 208 (1929) 405: with Y = z / L and Z = h a (t - z eps / U) / ((1 - eps) rho_s c_s) the balls have
   1 - Q1(sqrt(2 Y), sqrt(2 Z)), Q1 of Marcum, and the air the same plus exp(-Y - Z) I0(2 sqrt(Y Z)). The largest error of all balls and nodes, over the
   rise of the air; the mean of the balls; the energy of both codes.
The Nusselt number is constant here, and low: with Gunn's the front is as thin as a ball, and no cell resolves it.
"""
import os
import subprocess
import sys

import numpy as np
from scipy.special import ive
from scipy.stats import ncx2

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from fluid import Fluid  # noqa: E402
from warm import GasHeat, gunn  # noqa: E402

AIR, C_AIR, K_AIR = {"density": 1.2, "viscosity": 1.8e-5}, 1005, 0.026
SIDE, PITCH, D, COUNT = 4e-3, 3.2e-3, 3e-3, 120   # a column of balls, one in each layer
VOLUME, AREA = np.pi / 6 * D**3, np.pi * D**2
HEIGHT, EPS, U = COUNT * PITCH, 1 - VOLUME / (SIDE**2 * PITCH), 1.0   # superficial velocity
LENGTH = 0.04   # L, by the Nusselt number
NUSSELT = AIR["density"] * C_AIR * U * SIDE**2 * PITCH / (LENGTH * AREA) * D / K_AIR
COLD, HOT = 300.0, 350.0
places = np.column_stack([np.full(COUNT, SIDE / 2), np.full(COUNT, SIDE / 2), (np.arange(COUNT) + 0.5) * PITCH])
checks = []


def column(per_layer, window):
    """The air of the column at its steady flow, with cells of a pitch over per_layer."""
    flow = Fluid((0, 0, 0), (SIDE, SIDE, HEIGHT), (1, 1, COUNT * per_layer), **AIR, window=window, gravity=(0, 0, 0))
    for _ in range(15):
        flow.exchange(places, 0 * places, np.full(COUNT, VOLUME))
        flow.inflow.value = U / flow.eps.x.array[flow.grid[:, :, 0]].mean()   # bodies reach down to the inlet
    gas = GasHeat(flow, C_AIR, K_AIR, COLD, nusselt=lambda eps, re, pr: np.full(len(eps), NUSSELT))
    gas.inlet.value = HOT
    return flow, gas


# Gunn's correlation where its terms are known: a single ball at rest has the 2 of conduction into the rest of the space
checks.append(("Nusselt number of Gunn, single ball at rest", gunn(1.0, 0.0, 0.7), 2.0, 1e-12))
checks.append(("the same, eps 0.4, Re 100, Pr 0.7", gunn(0.4, 100.0, 0.7), 3.8 * (1 + 0.7 * 100**0.2 * 0.7 ** (1 / 3)) + 0.562 * 100**0.7 * 0.7 ** (1 / 3), 1e-12))

slopes = []
for per_layer in (1, 2):
    flow, gas = column(per_layer, 1e3)
    for _ in range(3):
        gas.exchange(places, 0 * places, np.full(COUNT, VOLUME), np.full(COUNT, COLD))
    z = flow.low[2] + np.arange(flow.cells[2] + 1) * flow.cell[2]
    above = gas.T.x.array[flow.grid].mean(axis=(0, 1)) - COLD
    middle = (z > 0.05 * HEIGHT) & (z < 0.6 * HEIGHT)
    slopes.append(-1 / np.polyfit(z[middle], np.log(above[middle]), 1)[0])
    checks.append((f"bodies of a held temperature, cells of {1e3 * flow.cell[2]:.1f} mm: length of decay of the air, m", slopes[-1], LENGTH, 1.5 * flow.cell[2] / LENGTH / 2))
checks.append(("the same, extrapolated to cells of no height", 2 * slopes[1] - slopes[0], LENGTH, 2e-3))

# the balls do not touch: they exchange heat with the air alone
with open("column.toml", "w", encoding="utf-8") as file:
    file.write(f"""
gravity = [0, 0, 0]
[time]
duration = 100
step = "1 ms"
[heat]
temperature = {COLD}
frozen = true
[contact]
margin = 0
[shapes.ball]
sphere = {{ radius = {D / 2} }}
[materials.glass]
density = 2500
heat_capacity = 20
conductivity = 1
[[pairs]]
between = ["glass", "glass"]
stiffness = 1e3
restitution = 0.5
[output]
every = 1
""" + "".join(f'\n[[bodies]]\nshape = "ball"\nmaterial = "glass"\nposition = [{x}, {y}, {z}]\n' for x, y, z in places.tolist()))
subprocess.run(["scree-decomposer", "pack", "column.toml", "-o", "column.scene.h5"], check=True, stdout=sys.stderr)
solid = 2500 * 20 * (1 - EPS)   # heat capacity of the balls in a unit volume of the bed
front = 0.5 * HEIGHT * (solid + EPS * AIR["density"] * C_AIR) / (AIR["density"] * C_AIR * U)   # when the mean of the front is at half the height
errors = []
for per_layer, window in ((1, 20e-3), (2, 10e-3)):
    flow, gas = column(per_layer, window)
    with scree.Engine("column.scene.h5") as engine:
        steps, ids = round(window / engine.dt), np.arange(COUNT)
        volume, taken = np.full(COUNT, VOLUME), 0.0
        begin, order = engine.heat(), np.argsort(engine.bodies.id)
        ids = engine.bodies.id[order]
        while engine.time < front:
            G, around = gas.exchange(places, 0 * places, volume, engine.bodies.temperature[order])
            engine.set_medium(ids, G, around)
            engine.step(steps)
            heat = engine.take_medium_heat(ids)
            gas.settle(heat)
            taken += heat.sum()
        balls, end, time = engine.bodies.temperature[order], engine.heat(), engine.time

    def schumann(z):
        """Balls and air at heights, over the rise."""
        y, later = z / LENGTH, np.maximum(0, AIR["density"] * C_AIR * U / LENGTH * (time - z * EPS / U) / solid)
        of_balls = ncx2.cdf(2 * later, 2, np.maximum(2 * y, 1e-12))
        return of_balls, of_balls + ive(0, 2 * np.sqrt(y * later)) * np.exp(-(np.sqrt(y) - np.sqrt(later)) ** 2)

    z = flow.low[2] + np.arange(flow.cells[2] + 1) * flow.cell[2]
    air = gas.T.x.array[flow.grid].mean(axis=(0, 1))
    expected, of_air = schumann(places[:, 2])[0], schumann(z)[1]
    errors.append(max(abs((balls - COLD) / (HOT - COLD) - expected).max(), abs((air - COLD) / (HOT - COLD) - of_air).max()))
    checks.append((f"Schumann, cells of {1e3 * flow.cell[2]:.1f} mm: largest error of balls and air, over the rise of the air", errors[-1], 0, 0.015 / per_layer))
    checks.append(("the same: mean rise of the balls, K", balls.mean() - COLD, (HOT - COLD) * expected.mean(), 5e-3))
    checks.append(("the same: air, carried in - carried out - held, J", gas.inflow - gas.outflow - gas.held, gas.to_bodies, 1e-9))
    checks.append(("the same: heat that left the air and that it owes, J", gas.to_bodies + gas.owed.sum(), taken, 1e-12))
    checks.append(("the same: rise of the heat of the balls, J", end.stored - begin.stored, taken, 1e-11))
print("| check | found | expected | relative difference (of 0: difference) | tolerance |\n|---|---|---|---|---|")
differences = [found / expected - 1 if expected else found for _, found, expected, _ in checks]
for (name, found, expected, tolerance), difference in zip(checks, differences):
    print(f"| {name} | {found:.6g} | {expected:.6g} | {difference:+.1e} | {tolerance:.2g} |")
sys.exit(any(not abs(difference) < tolerance for difference, (*_, tolerance) in zip(differences, checks)))
