#!/usr/bin/env python3
"""Impacts by energy and losses by cause as a user meets them. usage: impacts_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import os
import shutil
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, frames_of, main, make_killed, outcome, pack, physics_of_log, run, same_frames  # noqa: E402

# balls and rocks on a turning drum with lifters and a belt: damping, friction and rolling, among three materials
CASE = """
seed = 3
gravity = [0, 0, -9.81]
[time]
duration = 0.12
step = 4e-5
[contact]
margin = "0.4 mm"
[materials.stone]
density = 2500
[materials.glass]
density = 2200
[materials.steel]
density = 7800
[[pairs]]
between = ["stone", "stone"]
stiffness = 2e4
restitution = 0.4
friction = 0.5
rolling_friction = 0.05
[[pairs]]
between = ["stone", "glass"]
stiffness = 2e4
restitution = 0.5
friction = 0.4
[[pairs]]
between = ["stone", "steel"]
stiffness = 2e4
restitution = 0.5
friction = 0.4
rolling_friction = 0.1
[[pairs]]
between = ["glass", "glass"]
stiffness = 2e4
restitution = 0.8
friction = 0.2
[[pairs]]
between = ["glass", "steel"]
stiffness = 2e4
restitution = 0.7
friction = 0.3
[shapes.ball]
sphere = { radius = "7 mm" }
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shape = "ball"
material = "glass"
count = 15
region = { cylinder = { start = [0, 0.01, 0], end = [0, 0.05, 0], radius = 0.065 } }
[[populations]]
shapes = { ball = 1, rock = 1 }
material = "stone"
count = 15
region = { cylinder = { start = [0, 0.01, 0], end = [0, 0.05, 0], radius = 0.065 } }
[[walls]]
name = "drum"
shape = { drum = { start = [0, 0, 0], end = [0, 0.06, 0], radius = 0.075, segments = 24, lifters = { count = 6, height = "6 mm", width = "8 mm" } } }
material = "steel"
motion = { rotate = { axis = [0, 1, 0], centre = [0, 0, 0], rate = "90 rpm" } }
[[walls]]
name = "belt"
shape = { plate = { corner = [-0.04, 0.005, -0.03], side_a = [0.03, 0, 0.01], side_b = [0, 0.05, 0] } }
material = "steel"
surface = { velocity = ["0.3 m/s", 0, "0.1 m/s"] }
[output]
every = 0.02
contacts = false
checkpoint = 0.03
impacts = true
"""


def make(name="drum", **changes):
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "12 mm, 10 mm, 9 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    text = CASE
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    pack(name, text)


def frames(folder):
    return frames_of(folder, ("impacts", "losses"))


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart():
    make()
    kept = None
    for ranks, threads in ((1, 1), (2, 2), (3, 1)):
        folder = f"r{ranks}.run"
        run(ranks, "drum.scene.h5", "-o", folder, threads=threads)
        found = outcome(folder)["state_hash"], physics_of_log(folder)
        kept = kept or found
        assert found == kept, f"{ranks} ranks: another run"
        same_frames(frames("r1.run"), frames(folder), "losses/damping", f"{ranks} ranks")
    assert frames("r1.run")[-1]["impacts/normal_count"].sum() > 30
    shutil.copytree("r1.run", "again.run")
    make_killed("again.run")
    run(2, "drum.scene.h5", "-o", "again.run", "--restart", "latest")
    assert outcome("again.run")["state_hash"] == kept[0] and physics_of_log("again.run") == kept[1]
    same_frames(frames("r1.run"), frames("again.run"), "losses/damping", "after a restart")
    said = run(2, "verify", "r1.run", "--from", "start").stdout
    assert "the same, bit for bit" in said, said


def all_losses_together_are_those_of_the_log():
    make()
    run(1, "drum.scene.h5", "-o", "drum.run")
    last = None
    for frame in frames("drum.run"):
        parts = numpy.array([frame[f"losses/{cause}"] for cause in ("damping", "friction", "rolling")])
        assert abs(parts.sum() - frame["dissipated"]) <= 1e-12 * (abs(parts).sum() + abs(frame["dissipated"])), (parts.sum(), frame["dissipated"])
        last = parts
    # all three causes, and no rolling where the pair has none; materials stand in the order of their names
    glass, steel, stone = 0, 1, 2
    end = frames("drum.run")[-1]
    of = {pair: last[:, k] for k, pair in enumerate(zip(end["losses/material_a"].tolist(), end["losses/material_b"].tolist()))}
    assert of[(stone, stone)][2] > 0 and of[(steel, stone)][2] > 0 and of[(glass, glass)][2] == 0 and of[(glass, steel)][2] == 0, of
    assert of[(glass, stone)][0] > 0 and of[(glass, stone)][1] > 0 and (of[(steel, steel)] == 0).all(), of


def recording_changes_nothing_that_moves():
    make("with")
    make("without", **{"impacts = true": ""})
    for name in ("with", "without"):
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    for f, g in zip(frames("with.run"), frames("without.run")):
        assert numpy.array_equal(f["x"], g["x"])
        assert "losses/damping" not in g


def tables_and_report_say_it():
    make()
    run(1, "drum.scene.h5", "-o", "drum.run")
    post = os.path.join(BIN, "scree-post")
    subprocess.run([post, "statistics", "drum.run", "-o", "statistics"], check=True, env=ENV, capture_output=True, timeout=200)
    last = frames("drum.run")[-1]
    with open("statistics/losses.csv", newline="") as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#"))]
    end = rows[-1]["time"]
    assert numpy.isclose(sum(float(row["friction"]) for row in rows if row["time"] == end), last["losses/friction"].sum(), rtol=1e-8)
    with open("statistics/impacts.csv", newline="") as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#"))]
    first = frames("drum.run")[0]
    assert sum(int(row["normal_count"]) for row in rows) == last["impacts/normal_count"].sum() - sum(first.get("impacts/normal_count", [0]))
    assert {row["material_a"] for row in rows} | {row["material_b"] for row in rows} == {"stone", "glass", "steel"}
    assert os.path.getsize("statistics/impacts.svg") > 2000
    subprocess.run([post, "report", "drum.run", "-o", "report.html"], check=True, env=ENV, capture_output=True, timeout=200)
    with open("report.html", encoding="utf-8") as file:
        page = file.read()
    assert "Impacts by energy" in page and "glass - steel" in page


def mistakes_and_plan_are_told():
    make()
    said = run(1, "drum.scene.h5", "--plan").stdout
    assert "energies and losses by 6 pairs of materials" in said, said
    said = pack("wrong", CASE.replace("impacts = true", 'impacts = "all"'), expect=2)
    assert "wrong.toml:" in said and "impacts" in said and "true or false" in said, said


CUBE = """
gravity = [0, 0, 0]
[time]
duration = "8 ms"
[shapes.cube]
file = "cube.shape.h5"
PIECES
[materials.stone]
density = 2500
[materials.steel]
density = 7800
[[pairs]]
between = ["stone", "steel"]
stiffness = "100 kN/m"
restitution = 0.5
FRICTION
[[pairs]]
between = ["stone", "stone"]
stiffness = "100 kN/m"
restitution = 0.5
[contact]
margin = "0.1 mm"
surface = "outside"
[[bodies]]
shape = "cube"
material = "stone"
position = [0.013, -0.02, 0.0055]
velocity = [ALONG, 0, -0.5]
[[walls]]
name = "deck"
shape = { plate = { corner = [-0.5, -0.4, 0], side_a = [1, 0, 0], side_b = [0, 1, 0] } }
material = "steel"
load_map = true
[output]
every = "0.5 ms"
impacts = true
BONDS
"""


def pieces_that_strike_together_are_one_impact_of_the_whole_body():
    """A cube of 2.5 g that lands flat with 0.5 m/s brings m v^2 / 2, whole or cut into cells, whatever ranks these are on; and as much along the wall."""
    for words in (("generate", "box", "--size", "1 cm, 1 cm, 1 cm", "-o", "cube.shape.h5", "--name", "cube"),
                  ("fracture", "cube.shape.h5", "--cells", "12", "--evenly", "--inset", "0.1 mm", "-o", "pieces.shape.h5")):
        subprocess.run([os.path.join(BIN, "scree-mesher"), *words], check=True, env=ENV, capture_output=True)
    energy = 0.5 * 2500 * 1e-6 * 0.5**2
    for name, pieces, bonds, along in (("whole", "", "", 0), ("cut", 'pieces = "pieces.shape.h5"', '[[bonds]]\nwithin = "stone"\nyoung = "5 GPa"', 0),
                                       ("slides", 'pieces = "pieces.shape.h5"', '[[bonds]]\nwithin = "stone"\nyoung = "5 GPa"', 0.3)):
        pack(name, CUBE.replace("PIECES", pieces).replace("BONDS", bonds).replace("ALONG", str(along)).replace("FRICTION", "friction = 0.2" if along else ""))
        for ranks in (1, 3):
            folder = f"{name}{ranks}.run"
            run(ranks, f"{name}.scene.h5", "-o", folder)
            first = next(frame for frame in frames_of(folder, ("impacts", "loads")) if len(frame.get("impacts/normal_count", [])))
            assert first["impacts/normal_count"].sum() == 1, (folder, first["impacts/normal_count"])
            within = 1e-6 if name == "whole" else 0.01   # the vertices of the cells put the pressure a little beside the centre
            assert abs(first["impacts/normal_energy"].sum() / energy - 1) < within, (folder, first["impacts/normal_energy"].sum(), energy)
            assert abs(first["loads/impact_energy"].sum() / energy - 1) < within, (folder, first["loads/impact_energy"].sum(), energy)
            if along:   # the face does not roll: its mean slip is that of the centre, and half a cube above it turns it
                # a force at the face moves the centre by 1 / m, and turns the cube by its lever of half a side: 1 / m + (a / 2)^2 / (m a^2 / 6)
                expected = 0.5 * 2500 * 1e-6 * along**2 / (1 + 1.5)
                assert abs(first["impacts/shear_energy"].sum() / expected - 1) < 0.03, (folder, first["impacts/shear_energy"].sum(), expected)
        same_frames(frames_of(f"{name}1.run", ("impacts", "loads")), frames_of(f"{name}3.run", ("impacts", "loads")), "loads/impact_energy", "3 ranks")


main([the_same_bits_on_any_ranks_and_threads_and_after_a_restart, all_losses_together_are_those_of_the_log, recording_changes_nothing_that_moves,
      tables_and_report_say_it, pieces_that_strike_together_are_one_impact_of_the_whole_body, mistakes_and_plan_are_told])
