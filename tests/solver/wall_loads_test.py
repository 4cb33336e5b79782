#!/usr/bin/env python3
"""Load maps and wear as a user meets them. usage: wall_loads_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import os
import shutil
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, frames_of, main, make_killed, outcome, pack, physics_of_log, run, same_frames  # noqa: E402

DRUM = """
seed = 2
gravity = [0, 0, -9.81]
[time]
duration = 0.1
step = 4e-5
[contact]
margin = "0.4 mm"
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = 2e4
restitution = 0.5
friction = 0.4
[shapes.ball]
sphere = { radius = "7 mm" }
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shapes = { ball = 2, rock = 1 }
material = "m"
count = 30
region = { cylinder = { start = [0, 0.01, 0], end = [0, 0.05, 0], radius = 0.065 } }
[[walls]]
name = "drum"
shape = { drum = { start = [0, 0, 0], end = [0, 0.06, 0], radius = 0.075, segments = 24, lifters = { count = 6, height = "6 mm", width = "8 mm" } } }
material = "m"
motion = { rotate = { axis = [0, 1, 0], centre = [0, 0, 0], rate = "60 rpm" } }
WORN
[[walls]]
name = "lid"
shape = { plate = { corner = [-0.04, 0.005, 0.0], side_a = [0.03, 0, 0.01], side_b = [0, 0.05, 0] } }
material = "m"
motion = { free = { guide = [0, 0, 1], mass = "0.2 kg", stroke = [-0.02, 0.03] } }
load_map = true
[output]
every = 0.02
contacts = false
checkpoint = 0.03
"""


def make_drum(name="drum", words='wear = { coefficient = 2e-7, every = "0.012 s" }', **changes):
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "12 mm, 10 mm, 9 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    text = DRUM.replace("WORN", words)
    for old, new in changes.items():
        text = text.replace(old, new)
    return pack(name, text)


def frames(folder):
    return frames_of(folder, ("loads", "wear"))


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart():
    make_drum()
    kept = None
    for ranks, threads in ((1, 1), (2, 2), (3, 1)):
        folder = f"r{ranks}.run"
        run(ranks, "drum.scene.h5", "-o", folder, threads=threads)
        found = outcome(folder)["state_hash"], physics_of_log(folder), outcome(folder)["wear"]
        kept = kept or found
        assert found == kept, f"{ranks} ranks: another run"
        same_frames(frames("r1.run"), frames(folder), "loads/impulse", f"{ranks} ranks")
    worn = outcome("r1.run")["wear"]
    assert len(worn) == 1 and worn[0]["volume"] > 1e-12 and 0 < worn[0]["depth"] < 4e-4, worn
    shutil.copytree("r1.run", "again.run")
    make_killed("again.run")
    run(2, "drum.scene.h5", "-o", "again.run", "--restart", "latest")
    assert outcome("again.run")["state_hash"] == kept[0] and physics_of_log("again.run") == kept[1]
    same_frames(frames("r1.run"), frames("again.run"), "loads/impulse", "after a restart")
    said = run(2, "verify", "r1.run", "--from", "start").stdout
    assert "the same, bit for bit" in said, said


def a_load_map_changes_nothing_that_moves():
    make_drum("with", 'load_map = true')
    make_drum("without", "", **{"load_map = true": ""})
    for name in ("with", "without"):
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    for f, g in zip(frames("with.run"), frames("without.run")):
        assert numpy.array_equal(f["x"], g["x"])


def a_map_follows_the_step():
    """A rock lies on a plate while another one, thrown up beside it, has the step change: the map adds up to the impulse of the wall."""
    text = """
gravity = [0, 0, -200]
[time]
duration = "30 ms"
step_control = "quantised"
steps_per_contact = 8
[contact]
margin = "0.3 mm"
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = "40 kN/m"
restitution = 0.5
friction = 0.5
[shapes.rock]
file = "rock.shape.h5"
[[bodies]]
shape = "rock"
material = "m"
position = [0, 0, "4.7 mm"]
[[bodies]]
shape = "rock"
material = "m"
position = ["60 mm", 0, "20 mm"]
velocity = [0, 0, "3 m/s"]
[[walls]]
name = "plate"
shape = { plate = { corner = [-0.1, -0.1, 0], side_a = [0.2, 0, 0], side_b = [0, 0.2, 0] } }
material = "m"
load_map = true
[output]
every = "1 ms"
"""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "12 mm, 10 mm, 9 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    pack("falls", text)
    run(1, "falls.scene.h5", "-o", "falls.run")
    with open("falls.run/steps.csv") as file:
        changes = [line.split(",") for line in file.read().splitlines()[1:] if not line.startswith("#")]
    log = physics_of_log("falls.run")
    named = log[0]
    rows = {row[named.index("time")]: row for row in log[1:] if not row[0].startswith("#")}
    last = list(rows.values())[-1]
    logged = numpy.array([float(last[named.index(f"wall2_impulse_{axis}")]) for axis in "xyz"])
    mapped = frames("falls.run")[-1]["loads/impulse"].sum(axis=0)
    assert len(changes) > 2, changes
    assert abs(logged[2]) > 1e-4 and numpy.abs(mapped - logged).max() < 1e-12 * abs(logged[2]), (mapped, logged, changes)


def wear_does_not_depend_on_output():
    make_drum("often")
    make_drum("seldom", **{"every = 0.02": "every = 0.1", "checkpoint = 0.03": "checkpoint = 0"})
    for name in ("often", "seldom"):
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    assert outcome("often.run")["state_hash"] == outcome("seldom.run")["state_hash"]


def a_worn_wall_can_be_used_again():
    make_drum()
    run(1, "drum.scene.h5", "-o", "drum.run")
    worn = outcome("drum.run")["wear"][0]
    with h5py.File(os.path.join("drum.run", worn["file"])) as file:
        group = next(iter(file["shapes"].values())) if "shapes" in file else file
        names = []
        group.visit(names.append)
        path = next(name for name in names if name.endswith("vertices"))
        vertices = group[path][()]
    # the file has what slid since the wall was last worn, too: less than in one interval of the run
    last, before = frames("drum.run")[-1], frames("drum.run")[-2]
    since = numpy.linalg.norm(vertices - last["wear/vertex"], axis=1).max()
    assert 0 < since < numpy.linalg.norm(last["wear/vertex"] - before["wear/vertex"], axis=1).max(), since
    slid = last["loads/sliding_work"][last["loads/wall"] == worn["wall"]].sum()
    assert abs(worn["volume"] - 2e-7 * slid) < 1e-12 * worn["volume"], (worn, slid)
    shape = 'shape = { drum = { start = [0, 0, 0], end = [0, 0.06, 0], radius = 0.075, segments = 24, lifters = { count = 6, height = "6 mm", width = "8 mm" } } }'
    assert shape in DRUM
    make_drum("next", **{shape: f'shape = {{ file = "drum.run/{worn["file"]}" }}'})
    run(1, "next.scene.h5", "-o", "next.run")
    assert outcome("next.run")["wear"][0]["volume"] > 0


def a_wall_is_worn_at_the_end_where_no_interval_ends_before():
    """The wall keeps its shape during such a run; the file of the worn wall has what slid on it, and pack says so."""
    make_drum(words='wear = { coefficient = 2e-7, every = "1 s" }')
    run(1, "drum.scene.h5", "-o", "drum.run")
    worn, last = outcome("drum.run")["wear"][0], frames("drum.run")[-1]
    slid = last["loads/sliding_work"][last["loads/wall"] == worn["wall"]].sum()
    assert slid > 1e-6 and abs(worn["volume"] - 2e-7 * slid) < 1e-12 * worn["volume"] and worn["depth"] > 0, (worn, slid)
    assert numpy.array_equal(last["wear/vertex"], frames("drum.run")[0]["wear/vertex"])


def triangles_as_small_as_asked_for_change_no_flat_wall():
    """A plate of 100 triangles bears what one of two does, and its map has so many cells."""
    found = {}
    for name, words in (("coarse", "load_map = true"), ("fine", 'load_map = true\ntriangle_size = "9 mm"')):
        make_drum(name, "", **{"load_map = true": words})
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
        found[name] = frames(f"{name}.run")[-1]
    coarse, fine = found["coarse"], found["fine"]
    assert len(coarse["loads/triangle"]) == 2 and len(fine["loads/triangle"]) >= 50, len(fine["loads/triangle"])
    assert numpy.abs(coarse["x"] - fine["x"]).max() < 1e-7
    total = [f["loads/impulse"].sum(axis=0) for f in (coarse, fine)]
    assert numpy.abs(total[0] - total[1]).max() < 1e-4 * numpy.abs(total[0]).max() > 0, total


def too_much_wear_at_a_time_is_told():
    make_drum(words='wear = { coefficient = 1e-4, every = "0.05 s" }')
    said = run(1, "drum.scene.h5", "-o", "deep.run", expect=5).stderr
    assert "wall 'drum' wears by" in said and "tenth of the margin" in said and "`every` of at most" in said, said


def mistakes_are_told_with_their_line():
    base = DRUM.replace("WORN", 'wear = { coefficient = 2e-7, every = "0.012 s" }')
    wear = 'wear = { coefficient = 2e-7, every = "0.012 s" }'
    plane = '[[walls]]\nshape = { plane = { point = [0, 0, -1], normal = [0, 0, 1] } }\nmaterial = "m"\n'
    round_wall = '[[walls]]\nshape = { cylinder_inside = { start = [0, 0, -1], end = [0, 0, 1], radius = 1 } }\nmaterial = "m"\n'
    wrong = [
        ("analytic map", base + plane + "load_map = true\n", ["load_map", "plane", "{ plate = ... }"]),
        ("analytic box", base + '[[walls]]\nshape = { box_inside = [[-1, -1, -1], [1, 1, 1]] }\nmaterial = "m"\nload_map = true\n',
         ["load_map", "box_inside", "{ box = ... }"]),
        ("analytic wear", base + round_wall + wear + "\n", ["wear", "cylinder_inside", "{ cylinder = ... }"]),
        ("analytic triangles", base + plane + 'triangle_size = "1 mm"\n', ["triangle_size", "plane", "{ plate = ... }"]),
        ("triangles of a file", base + '[[walls]]\nshape = { file = "rock.shape.h5" }\nmaterial = "m"\ntriangle_size = "1 mm"\n', ["triangle_size", "scree-mesher refine"]),
        ("too many triangles", base.replace("load_map = true", 'load_map = true\ntriangle_size = "1 um"'), ["triangle_size", "triangles", "larger size"]),
        ("no size", base.replace("load_map = true", "load_map = true\ntriangle_size = 0"), ["triangle_size", "> 0"]),
        ("no coefficient", base.replace("coefficient = 2e-7, ", ""), ["wear", "coefficient", "missing"]),
        ("no interval", base.replace(', every = "0.012 s"', ""), ["wear", "every", "missing"]),
        ("negative", base.replace("2e-7", "-2e-7"), ["coefficient", "-2e-07"]),
        ("unit", base.replace("2e-7", '"2e-7 m^3"'), ["coefficient", "a volume", "a volume per energy"]),
        ("word", base.replace("load_map = true", 'load_map = "yes"'), ["load_map", "true or false"]),
        ("unknown", base.replace("coefficient = 2e-7", "hardness = 3, coefficient = 2e-7"), ["hardness", "wear"]),
    ]
    for name, text, words in wrong:
        assert text != base, name
        said = pack("wrong", text, expect=2)
        assert [word for word in said.split() if word.startswith("wrong.toml:")], f"{name}: no line in {said}"
        for word in words:
            assert word in said, f"{name}: no '{word}' in {said}"


def the_plan_tells_maps_and_wear():
    make_drum()
    said = run(1, "drum.scene.h5", "--plan").stdout
    assert "'drum': " in said and "triangles" in said and "every 300 steps" in said, said
    make_drum("plain", "", **{"load_map = true": ""})
    said = run(1, "plain.scene.h5", "--plan").stdout
    assert "no wall has one" in said and "no wall wears" in said, said


main([the_same_bits_on_any_ranks_and_threads_and_after_a_restart, a_load_map_changes_nothing_that_moves, a_map_follows_the_step, wear_does_not_depend_on_output,
      a_worn_wall_can_be_used_again, a_wall_is_worn_at_the_end_where_no_interval_ends_before, triangles_as_small_as_asked_for_change_no_flat_wall, too_much_wear_at_a_time_is_told, mistakes_are_told_with_their_line, the_plan_tells_maps_and_wear])
