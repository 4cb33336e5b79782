#!/usr/bin/env python3
"""Checks of fluid.py without an engine; prints a table, and fails when a check misses its tolerance.

1. Pressure gradient in a fixed bed, void fraction 0.4, balls of 1 mm, air: the equation of S. Ergun (1952).
2. 1000 balls of 3 mm at random places, which move: pressure force = force on the balls + net outflow of momentum, once steady.
3. The same at rest: pressure drop = Ergun's equation (Wen and Yu) in the deposited void fraction.
4. The same in water at rest: force = buoyancy.
"""
import sys

import numpy as np
import ufl
from dolfinx import fem

from fluid import Fluid

AIR, WATER = {"density": 1.2, "viscosity": 1.8e-5}, {"density": 1000, "viscosity": 1e-3}
LOW, HIGH = np.array((-12e-3, -12e-3, -24e-3)), np.array((12e-3, 12e-3, 96e-3))
checks = []
for velocity in (0.2, 0.5, 1.0):
    flow = Fluid((0, 0, 0), (5e-3, 5e-3, 20e-3), (1, 1, 40), **AIR, window=1e3)
    flow.inflow.value, bed = velocity, np.ones(len(flow.node_volume))
    bed[flow.grid[:, :, 10:31]] = 0.4
    for _ in range(15):   # the slip in the drag is that of the window before
        flow.advance(bed, 1e-3, np.zeros((len(bed), 3)))
    z, p = flow.p_nodes[:, 2], flow.now.x.array[flow.p_rows]
    middle = (z > 7.4e-3) & (z < 12.6e-3)
    expected = 150 * 0.6**2 * 1.8e-5 * velocity / (0.4**3 * 1e-3**2) + 1.75 * 0.6 * 1.2 * velocity**2 / (0.4**3 * 1e-3)
    checks.append((f"pressure gradient at {velocity} m/s, Pa/m", -np.polyfit(z[middle], p[middle], 1)[0], expected, 1e-3))

random = np.random.default_rng(1)
place, moving, volume = random.uniform(LOW + (0, 0, 30e-3), HIGH - (0, 0, 10e-3), (1000, 3)), random.normal(0, 0.1, (1000, 3)), np.full(1000, np.pi / 6 * 3e-3**3)
for columns, factor in ((1, 1), (3, 1), (1, 0)):
    flow = Fluid(LOW, HIGH, (columns, columns, 40), **AIR, window=1e3, gravity=(0, 0, 0))
    flow.inflow.value = 1.0
    for _ in range(15):
        force = flow.exchange(place, factor * moving, volume)[:, 2].sum()
    u = ufl.split(flow.now)[0]
    outflow = fem.assemble_scalar(fem.form(flow.density * u[2] * ufl.dot(u, ufl.FacetNormal(flow.now.function_space.mesh)) * ufl.ds))
    checks.append((f"balls {'move' if factor else 'at rest'}, {columns} x {columns} columns: pressure force, N", flow.pressure_drop() * flow.area, force + outflow, 1e-3))
checks.append(("balls at rest: pressure drop, Pa", flow.pressure_drop(), flow.expected_drop(1.0), 1e-2))
flow = Fluid(LOW, HIGH, (1, 1, 40), **WATER, window=1e-3)
checks.append(("balls in water at rest: force, N", flow.exchange(place, 0 * place, volume)[:, 2].sum(), 9.81 * 1000 * volume.sum(), 1e-9))
print("| check | flow | expected | relative difference | tolerance |\n|---|---|---|---|---|")
for name, found, expected, tolerance in checks:
    print(f"| {name} | {found:.6g} | {expected:.6g} | {found / expected - 1:+.1e} | {tolerance:g} |")
sys.exit(any(not abs(found / expected - 1) < tolerance for _, found, expected, tolerance in checks))
