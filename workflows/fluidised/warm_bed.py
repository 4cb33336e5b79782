#!/usr/bin/env python3
"""Coupled run of Scree's engine, fluid.py and warm.py: hot air heats a bed at rest, then fluidises it.
usage: warm_bed.py NAME.scene.h5 NAME.run air.toml warm.toml NAME SPHERICITY SHARE

The scene has [heat]. SHARE: of the times of warm.toml; 1: all. Makes NAME.csv, one row for each `row` of warm.toml, NAME.profiles.csv, temperatures over the
height at the end of each step of warm.toml, and NAME.energy.md, the energy of both codes. On ranks as couple.py: the bodies are on all, the air is on rank 0.

In each window of air.toml: the flow, then the temperature of the air with the bodies as they are, then the steps of the bodies in air of this temperature.
What they took leaves the air in the next window. Energies are counted from the temperature of the air at the start. `outside` is the number of bodies above the
box of the air, which exchange nothing with it.
"""
import csv
import os
import sys
import tomllib

import numpy as np
from mpi4py import MPI

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from fluid import Fluid  # noqa: E402
from run_record import si  # noqa: E402
from warm import GasHeat  # noqa: E402

SCENE, RUN, AIR, WARM, NAME, SPHERICITY, SHARE = sys.argv[1:]
TOLERANCE = 1e-3   # of the heat that passed
comm = MPI.COMM_WORLD
with open(AIR, "rb") as file:
    air = tomllib.load(file)
with open(WARM, "rb") as file:
    warm = tomllib.load(file)
KELVIN, table, profiles = 273.15, [], []


def kelvin(text):
    return float(text.removesuffix("degC")) + KELVIN if text.endswith("degC") else si(text)


def gathered(bodies):
    """Arrays of all bodies by id on rank 0, so that the sums over them are the same bits on any number of ranks."""
    parts = comm.gather((bodies.id, bodies.position, bodies.velocity, bodies.volume, bodies.mass, bodies.temperature))
    if comm.rank:
        return np.empty(0, int), *5 * [np.empty((0, 3))]
    columns = [np.concatenate(column) for column in zip(*parts)]
    order = np.argsort(columns[0])
    return [column[order] for column in columns]


def row_of(time, velocity, gas, position, temperature):
    low, high = np.percentile(temperature, [5, 95])
    outlet = gas.T.x.array[gas.flow.grid[:, :, -1]].mean()
    return {"time": time, "velocity": velocity, "inlet": float(gas.inlet.value), "outlet": outlet, "mean": temperature.mean(), "deviation": temperature.std(), "low": low, "high": high,
            "top": np.sort(position[:, 2])[-20:].mean(), "outside": np.count_nonzero(position[:, 2] > gas.flow.high[2]), "taken": gas.to_bodies + gas.owed.sum(), "carried_in": gas.inflow, "carried_out": gas.outflow, "held": gas.held}


def profile_of(time, gas, position, temperature):
    """Mean temperatures of layers of a cell: of the air at the nodes, of the bodies by their centres."""
    flow = gas.flow
    z = flow.low[2] + np.arange(flow.cells[2] + 1) * flow.cell[2]
    layer = np.rint((position[:, 2] - flow.low[2]) / flow.cell[2]).astype(int)
    for k, height in enumerate(z):
        here = temperature[layer == k]
        yield {"time": time, "height": height, "air": gas.T.x.array[flow.grid[:, :, k]].mean(), "bodies": here.mean() if len(here) else np.nan, "count": len(here)}


with scree.Engine(SCENE, comm=comm, run=RUN) as engine:
    low, high = (np.array([si(x) for x in air[key]]) for key in ("low", "high"))
    count = max(1, round(si(air["window"]) / engine.dt))
    window, ramp = count * engine.dt, max(1, round(si(warm["ramp"]) / (count * engine.dt)))
    every = max(1, round(si(warm["row"]) / window))
    end, last, gas = si(warm["settle"]), 0.0, None
    engine.run_until(end)
    start, taken = engine.heat(), 0.0
    if not comm.rank:
        flow = Fluid(low, high, air["cells"], si(air["density"]), si(air["viscosity"]), window, engine.gravity, float(SPHERICITY))
        gas = GasHeat(flow, si(warm["heat_capacity"]), si(warm["conductivity"]), kelvin(warm["steps"][0][1]))
    for velocity, temperature_in, time in warm["steps"]:
        windows, velocity, end = 0, si(velocity), end + si(time) * float(SHARE)
        while engine.time < end - window / 2:
            ids, position, moving, volume, mass, temperature = gathered(engine.bodies)
            force, conductance, around = np.empty((0, 3)), np.empty(0), np.empty(0)
            if not comm.rank:
                flow.inflow.value = last + (velocity - last) * min(1, (windows + 1) / ramp)
                gas.inlet.value = kelvin(temperature_in)
                force = flow.exchange(position, moving, volume)
                if flow.relaxation_rate * (volume / mass).max() * window > 0.5:
                    sys.exit("warm_bed.py: the window is longer than half of the relaxation time of a body; shorten it")
                conductance, around = gas.exchange(position, moving, volume, temperature, float(SPHERICITY))
            engine.set_wrench(ids, force)   # rank 0 names all bodies
            engine.set_medium(ids, conductance, around)
            engine.step(count)
            heat = engine.take_medium_heat(ids)
            windows += 1
            if not comm.rank:
                gas.settle(heat)
                taken += heat.sum()
                if windows % every == 0 or engine.time >= end - window / 2:
                    table.append(row_of(engine.time, velocity, gas, position, temperature))
        last = velocity
        if not comm.rank:
            profiles += profile_of(engine.time, gas, position, temperature)
            print(", ".join(f"{name} {value:.5g}" for name, value in table[-1].items()), flush=True)
    engine.clear_heat()
    engine.run_until(engine.duration)   # the rest of the case, with the last forces
    heat = engine.heat()

if not comm.rank:
    for path, rows in ((f"{NAME}.csv", table), (f"{NAME}.profiles.csv", profiles)):
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)
    passed = heat.from_medium - start.from_medium
    rise = heat.stored - start.stored
    checks = [("bodies: rise of the heat stored", rise, "heat from the air, by the solver", passed, 1e-9),
              ("exchange: heat that each body took, summed", taken, "the same, by the solver", passed, 1e-12),
              ("exchange: heat that left the air, with what it owes", gas.to_bodies + gas.owed.sum(), "heat that the bodies took", taken, 1e-12),
              ("air: carried in - carried out - held", gas.inflow - gas.outflow - gas.held, "heat that left the air", gas.to_bodies, 1e-9),
              ("both: carried in - carried out", gas.inflow - gas.outflow, "held by the air + rise of the bodies; the air owes the last window", gas.held + rise, TOLERANCE)]
    lines = ["| balance | J | compared with | J | difference / heat that passed | tolerance |", "|---|---|---|---|---|---|"]
    lines += [f"| {name} | {found:.9g} | {other} | {expected:.9g} | {(found - expected) / passed:+.1e} | {tolerance:g} |" for name, found, other, expected, tolerance in checks]
    with open(f"{NAME}.energy.md", "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    print("\n".join(lines))
    sys.exit(any(not abs(found - expected) < tolerance * passed for _, found, _, expected, tolerance in checks))
