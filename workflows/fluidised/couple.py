#!/usr/bin/env python3
"""Coupled run of Scree's engine and fluid.py: the velocity of the fluid rises in steps.
usage: couple.py NAME.scene.h5 NAME.run air.toml NAME.csv SPHERICITY STEPS

SPHERICITY is that of the bodies, for Ergun's equation. STEPS: only so many of the velocities of air.toml; 0: all, to the end of the case.
On several ranks (mpirun -n 2 python3 -m mpi4py couple.py ...) the bodies are on all, the fluid is on rank 0.
Each row of the table holds means over the second half of the time at one velocity [SI units]:
    pressure_force      pressure drop times area, without the hydrostatic part; _deviation: standard deviation of the windows
    force_on_bodies     of the fluid in +z, without buoyancy: equals pressure_force in a steady flow
    floor_load, weight  weight is less buoyancy: pressure_force + floor_load = weight when the bed is at rest
    expected_force      of Ergun's equation (Wen and Yu above eps 0.8) in the deposited void fraction
    expected_minimum    velocity at which the expected force equals the weight
    void_fraction       deposited, mean over the volume of the bodies; top: height of the bed
"""
import csv
import os
import sys
import tomllib

import numpy as np
from mpi4py import MPI
from scipy.optimize import brentq

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from fluid import Fluid  # noqa: E402
from run_record import si  # noqa: E402

SCENE, RUN, FLUID, TABLE, SPHERICITY, STEPS = sys.argv[1:]
COLUMNS = ("pressure_force", "force_on_bodies", "floor_load", "expected_force", "void_fraction", "top")
comm = MPI.COMM_WORLD
with open(FLUID, "rb") as file:
    settings = tomllib.load(file)
low, high = (np.array([si(x) for x in settings[key]]) for key in ("low", "high"))
density, table, last = si(settings["density"]), [], 0.0


def gathered(bodies):
    """Arrays of all bodies by id on rank 0, so that the sums over them are the same bits on any number of ranks."""
    parts = comm.gather((bodies.id, bodies.position, bodies.velocity, bodies.volume, bodies.mass))
    if comm.rank:
        return np.empty(0, int), *4 * [np.empty((0, 3))]
    columns = [np.concatenate(column) for column in zip(*parts)]
    order = np.argsort(columns[0])
    return [column[order] for column in columns]


with scree.Engine(SCENE, comm=comm, run=RUN) as engine:
    count = max(1, round(si(settings["window"]) / engine.dt))
    window, gravity = count * engine.dt, engine.gravity
    ramp, end = max(1, round(si(settings["ramp"]) / window)), si(settings["settle"])
    engine.run_until(end)
    flow = None if comm.rank else Fluid(low, high, settings["cells"], density, si(settings["viscosity"]), window, gravity, float(SPHERICITY))
    for velocity, time in settings["steps"][:int(STEPS) or None]:
        rows, velocity, end = [], si(velocity), end + si(time)
        while engine.time < end - window / 2:
            ids, position, moving, volume, mass = gathered(engine.bodies)
            force = np.empty((0, 3))
            if not comm.rank:
                flow.inflow.value = last + (velocity - last) * min(1, (len(rows) + 1) / ramp)
                force = flow.exchange(position, moving, volume)
                if flow.relaxation_rate * (volume / mass).max() * window > 0.5:
                    sys.exit("couple.py: the window is longer than half of the relaxation time of a body; shorten it")
            engine.set_wrench(ids, force)   # rank 0 names all bodies
            engine.step(count)
            floor = -engine.walls["box"].load[2]   # the sides of the box are vertical: along z they carry friction alone
            if not comm.rank:
                d = np.cbrt(6 / np.pi * volume.mean())
                top = np.sort(position[:, 2])[-20:].mean() + d / 2
                eps, solid = flow.eps.x.array, (1 - flow.eps.x.array) * flow.node_volume
                rows.append((flow.pressure_drop() * flow.area, force[:, 2].sum() + density * volume.sum() * gravity[2], floor,
                             flow.expected_drop(velocity) * flow.area, np.sum(eps * solid) / solid.sum(), top))
        if not comm.rank:
            later = np.array(rows)[len(rows) // 2:]
            weight = -gravity[2] * (mass.sum() - density * volume.sum())
            minimum = brentq(lambda u: flow.expected_drop(u) * flow.area - weight, 1e-4, 100)
            table.append({"velocity": velocity, "weight": weight, **dict(zip(COLUMNS, later.mean(axis=0))), "expected_minimum": minimum,
                          "pressure_force_deviation": later[:, 0].std()})
            print(", ".join(f"{name} {value:.5g}" for name, value in table[-1].items()), flush=True)
        last = velocity
    if STEPS == "0":
        engine.run_until(engine.duration)   # the rest of the case, with the last forces
if not comm.rank:
    with open(TABLE, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, table[0])
        writer.writeheader()
        writer.writerows(table)
