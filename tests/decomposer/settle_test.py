#!/usr/bin/env python3
"""Beds of stiff balls are poured with softer contacts, and rest as the case has them. usage: settle_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import json
import math
import os
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, SOLVER, column, main, run  # noqa: E402

RADIUS, DENSITY, COUNT, SIDE = 0.5e-3, 2500.0, 40, 4e-3
CASE = """
seed = 1
[time]
duration = "5 ms"
{step}
[shapes.ball]
sphere = {{ radius = {radius} }}
[materials.glass]
density = {density}
{young}
[[pairs]]
between = ["glass", "glass"]
{stiffness}
restitution = 0.5
friction = 0.3
[contact]
law = "{law}"
[[populations]]
shape = "ball"
material = "glass"
count = {count}
method = "settle"
region = {{ box = [[0, 0, 0], [{side}, {side}, 0.01]] }}
[[walls]]
shape = {{ box_inside = [[0, 0, 0], [{side}, {side}, 0.015]] }}
material = "glass"
[output]
every = "1 ms"
"""
# started by the decomposer in place of the solver: notes the steps of each run and how stiff its contacts are
WRAPPER = """
import json, subprocess, sys
import h5py
with h5py.File(sys.argv[1]) as file:
    settings = json.loads(file["settings"][()])
code = subprocess.run([{solver!r}, *sys.argv[1:]]).returncode
if code == 0:
    with open(sys.argv[3] + "/run.json") as file:
        outcome = json.load(file)
    with open({log!r}, "a") as file:
        stiffness = settings["pairs"][0].get("stiffness", 0) or settings["materials"][0]["young"]
        file.write(json.dumps([outcome["steps"], outcome["step_size"], stiffness]) + "\\n")
sys.exit(code)
"""


said = {}   # by pack


def pack(name, **words):
    """Packs a bed; gives (steps, step size, stiffness) of each run of the solver."""
    values = {"step": "", "radius": RADIUS, "density": DENSITY, "young": "", "stiffness": "stiffness = 2e4", "law": "linear", "count": COUNT,
              "side": SIDE} | words
    with open(f"{name}.toml", "w") as file:
        file.write(CASE.format(**values))
    log = os.path.abspath(f"{name}.log")
    with open("wrapper.py", "w") as file:
        file.write(WRAPPER.format(solver=SOLVER, log=log))
    result = subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", f"{name}.toml", "-o", f"{name}.scene.h5", "--solver",
                             f"/usr/bin/python3 {os.path.abspath('wrapper.py')}"], capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    said[name] = result.stderr
    with open(log) as file:
        return [json.loads(line) for line in file]


def check_rest(name):
    """Run with the case's own law and step: nothing moves, and the floor carries the weight. Gives the mean overlap."""
    run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    with h5py.File(f"{name}.scene.h5") as file:
        count = len(file["bodies/id"])
        wall = json.loads(file["settings"][()])["walls"][0]["id"]
    assert count == COUNT, count
    mass = count * DENSITY * 4 / 3 * math.pi * RADIUS**3
    fall = mass * 9.81 * 2 * RADIUS
    kinetic = column(f"{name}.run", "kinetic_translational") + column(f"{name}.run", "kinetic_rotational")
    assert kinetic.max() < 1e-4 * fall, kinetic / fall
    assert kinetic[-1] < 1e-6 * fall, kinetic / fall
    force = column(f"{name}.run", f"wall{wall}_force_z")[-1]
    assert abs(-force / (mass * 9.81) - 1) < 0.01, (force, mass * 9.81)
    last = sorted(entry for entry in os.listdir(f"{name}.run") if entry.startswith("frame_"))[-1]
    with h5py.File(os.path.join(f"{name}.run", last)) as file:
        depth = file["contacts/depth"][:]
        top = file["VTKHDF/Points"][:, 2].max()
    assert depth.max() < 0.005 * 2 * RADIUS, depth.max()
    return count * 4 / 3 * math.pi * RADIUS**3 / (SIDE**2 * top), len(depth) / count


def stiff_beds_are_poured_softer_and_rest_with_the_law_of_the_case():
    for name, words, stiffness in [("linear", {}, 2e4), ("hertz", {"law": "hertz-mindlin", "young": "young = 1e9\npoisson = 0.2", "stiffness": ""}, 1e9)]:
        stages = pack(name, **words)
        stiffnesses = [stage[2] for stage in stages]
        assert stiffnesses[0] < stiffness / 16 and stiffnesses[-1] == stiffness, stiffnesses
        assert all(b <= 2.0001 * a and b >= a for a, b in zip(stiffnesses, stiffnesses[1:])), stiffnesses
        assert stages[0][1] > 3 * stages[-1][1], stages   # steps
        solid, contacts = check_rest(name)
        assert 0.3 < solid < 0.65 and 1.5 < contacts < 4, (solid, contacts)


def a_given_step_is_that_of_the_last_rest_only():
    stages = pack("given", step="step = 2e-7")
    assert stages[-1][1] == 2e-7 and stages[0][1] > 1e-6, stages
    check_rest("given")


def a_bed_that_is_soft_already_is_poured_as_it_is():
    stages = pack("soft", stiffness="stiffness = 300")   # below 16 times the 26 N/m that pouring needs
    assert {stage[2] for stage in stages} == {300}, stages


def balls_that_would_roll_on_without_end_come_to_rest():
    """A floor with room for balls to roll on, and nothing that resists it: 60 falls through the region were not enough."""
    fall = math.sqrt(2 * 0.01 / 9.81)
    thrown = "6\nvelocity = [0.05, 0.02, 0]"
    stages = pack("rolls", stiffness="stiffness = 3e3", count=thrown, side=0.3)
    assert "came to rest with a rolling friction of 0.01" in said["rolls"] and "not at rest" not in said["rolls"], said
    assert sum(steps * step for steps, step, _ in stages) < 40 * fall, stages
    pack("resists", stiffness="stiffness = 3e3\nrolling_friction = 0.05", count=thrown, side=0.3)
    assert "rolling friction" not in said["resists"] and "not at rest" not in said["resists"], said
    # a bed whose balls hold each other comes to rest by itself, as the case has it
    pack("holds", stiffness="stiffness = 3e3")
    assert "rolling friction" not in said["holds"] and "not at rest" not in said["holds"], said


main([stiff_beds_are_poured_softer_and_rest_with_the_law_of_the_case, a_given_step_is_that_of_the_last_rest_only,
      a_bed_that_is_soft_already_is_poured_as_it_is, balls_that_would_roll_on_without_end_come_to_rest])
