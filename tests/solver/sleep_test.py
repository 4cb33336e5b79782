#!/usr/bin/env python3
"""Bodies that sleep (time.sleep) as a user meets them. usage: sleep_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import math
import os
import shutil
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, frames_of, main, make_killed, outcome, pack, physics_of_log, run, same_frames  # noqa: E402

# Rocks and balls that are poured, rest and sleep; a ball that comes late wakes some of them; then a plate pushes into the heap and stops,
# and an outlet takes out what it pushed away.
HEAP = """
seed = 5
gravity = [0, 0, -9.81]
[time]
duration = 1.1
step = 4e-5
sleep = true
[contact]
margin = "0.4 mm"
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 2e4
restitution = 0.4
friction = 0.5
rolling_friction = 0.1
[shapes.ball]
sphere = { radius = "6 mm" }
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shapes = { ball = 1, rock = 1 }
material = "stone"
count = 24
region = { box = [[-0.04, -0.025, 0.005], [0.035, 0.025, 0.07]] }
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "stone"
[[walls]]
name = "plate"
shape = { plate = { corner = [-0.075, -0.05, -0.01], side_a = [0, 0.1, 0], side_b = [0, 0, 0.08] } }
material = "stone"
motion = { translate = { velocity = [0.3, 0, 0] }, start = 0.92, stop = 1.05 }
[[inlets]]
name = "late"
shape = "ball"
material = "stone"
region = { box = [[-0.01, -0.01, 0.06], [0.01, 0.01, 0.09]] }
number_rate = 100
start = 0.6
count = 1
[[outlets]]
name = "edge"
region = { box = [[0.045, -1, -0.5], [1, 1, 0.5]] }
[output]
every = 0.05
checkpoint = 0.23
"""

# A heap that is poured into a tray, which holds it.
BED = """
seed = 7
gravity = [0, 0, -9.81]
[time]
duration = 0.9
step = 4e-5
sleep = true
[contact]
margin = "0.4 mm"
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 2e4
restitution = 0.4
friction = 0.5
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shape = "rock"
material = "stone"
count = 30
region = { box = [[-0.03, -0.03, 0.005], [0.03, 0.03, 0.09]] }
[[walls]]
name = "tray"
shape = { box_inside = [[-0.035, -0.035, 0], [0.035, 0.035, 0.5]] }
material = "stone"
[output]
every = 0.05
checkpoint = 0.2
"""

CRADLE = """
gravity = [0, 0, -9.81]
[time]
duration = {duration}
step = {step}
sleep = {sleep}
[contact]
law = "{law}"
margin = 0
{contact}
[materials.steel]
density = 7800
{material}
[materials.ice]
density = 1000
{material}
[[pairs]]
between = ["steel", "steel"]
restitution = 1
{pair}
[[pairs]]
between = ["steel", "ice"]
restitution = 1
{pair}
[shapes.ball]
sphere = {{ radius = 0.01 }}
{bodies}
[[walls]]
name = "floor"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "ice"
[output]
every = {every}
"""


def rock():
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "12 mm, 10 mm, 9 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)


def changed(text, changes):
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def log(folder):
    with open(os.path.join(folder, "log.csv"), encoding="utf-8") as file:
        return [{k: v for k, v in row.items()} for row in csv.DictReader(file)]


def column(folder, name):
    return numpy.array([float(row[name]) for row in log(folder)])


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart():
    rock()
    pack("heap", HEAP)
    kept = None
    for ranks, threads in ((1, 1), (2, 2), (3, 1)):
        folder = f"r{ranks}.run"
        run(ranks, "heap.scene.h5", "-o", folder, threads=threads)
        found = outcome(folder)["state_hash"], physics_of_log(folder)
        kept = kept or found
        for a, b in zip(kept[1], found[1]):
            assert a == b, f"{ranks} ranks: another run from {a[:2]}: {[(n, x, y) for n, x, y in zip(kept[1][0], a, b) if x != y]}"
        assert found == kept, f"{ranks} ranks: another end"
        same_frames(frames_of("r1.run", ("contacts",)), frames_of(folder, ("contacts",)), "x", f"{ranks} ranks")
    # they slept, the ball that came late woke some but not all, and what was pushed over the edge left
    asleep, bodies = column("r1.run", "asleep"), 25
    assert asleep.max() == bodies - 1, asleep
    assert 0 < asleep[-1] < bodies and (numpy.diff(asleep) < 0).any(), asleep
    assert column("r1.run", "removed_bodies")[-1] > 0
    for keep in (2, 3):
        shutil.copytree("r1.run", f"again{keep}.run")
        make_killed(f"again{keep}.run", keep=1)
        run(keep, "heap.scene.h5", "-o", f"again{keep}.run", "--restart", "latest")
        assert outcome(f"again{keep}.run")["state_hash"] == kept[0] and physics_of_log(f"again{keep}.run") == kept[1], keep
    said = run(2, "verify", "r1.run", "--from", "start").stdout
    assert "the same, bit for bit" in said, said


main([the_same_bits_on_any_ranks_and_threads_and_after_a_restart])
