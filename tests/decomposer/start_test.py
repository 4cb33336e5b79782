#!/usr/bin/env python3
"""A case that starts from a run, through the tools. usage: start_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, column, main, make_killed, outcome, run  # noqa: E402

HEAD = """
seed = 3
[time]
duration = {duration}
stop_at_rest = {rests}
[shapes.cube]
file = "cube.shape.h5"
[shapes.ball]
sphere = {{ radius = 0.006 }}
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 2e4
restitution = 0.2
friction = 0.5
rolling_friction = 0.05
[output]
every = {every}
checkpoint = {checkpoint}
"""
MARGIN = '[contact]\nsurface = "outside"\nmargin = 2e-4\n'   # what a run had is taken over with its margins
BOX = """
[[walls]]
shape = { box_inside = [[-0.025, -0.025, 0], [0.025, 0.025, 0.2]] }
material = "stone"
"""
BED = """
[[populations]]
shapes = { cube = 1, ball = 1 }
material = "stone"
count = 24
region = { box = [[-0.024, -0.024, 0.001], [0.024, 0.024, 0.07]] }
"""
START = '[start]\nrun = "settle.run"\n'


def head(duration=0.02, rests=False, every=0.005, checkpoint=0.005):
    return HEAD.format(duration=duration, rests="true" if rests else "false", every=every, checkpoint=checkpoint)


def decompose(text, name, expect=0, says=()):
    with open(f"{name}.toml", "w") as file:
        file.write(text)
    result = subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", f"{name}.toml", "-o", f"{name}.scene.h5"], capture_output=True, text=True)
    said = result.stdout + result.stderr
    assert result.returncode == expect, f"{name}: exit {result.returncode}, expected {expect}\n{said}"
    for words in says:
        assert words in said, f"{name}: {words!r} is not in\n{said}"
    return said


BED_FOLDER = tempfile.TemporaryDirectory()


def settle():
    """A bed of cubes and balls at rest, in settle.run; made once."""
    if not os.path.exists(os.path.join(BED_FOLDER.name, "settle.run")):
        settle_bed()
        for name in ("cube.shape.h5", "settle.run"):
            shutil.move(name, os.path.join(BED_FOLDER.name, name))
    shutil.copy(os.path.join(BED_FOLDER.name, "cube.shape.h5"), ".")
    shutil.copytree(os.path.join(BED_FOLDER.name, "settle.run"), "settle.run")


def settle_bed():
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "cube", "--size", "0.01", "-o", "cube.shape.h5", "--name", "cube"], check=True,
                   capture_output=True)
    # longer than until a run would stop at rest: what still rocks then comes to rest, and rolling friction stops what rolls
    decompose(head(1, False, 0.02, 0.5) + MARGIN + BED + BOX, "settle")
    run(1, "settle.scene.h5", "-o", "settle.run")
    assert abs(state_of(frames_of("settle.run")[-1])[0]["v"]).max() < 5e-6


def frames_of(folder):
    return sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.startswith("frame_"))


def state_of(path):
    with h5py.File(path) as file:
        data = file["VTKHDF/PointData"]
        order = numpy.argsort(data["id"][:])
        bodies = {"id": data["id"][:][order], "x": file["VTKHDF/Points"][:][order], "v": data["velocity"][:][order], "q": data["quat"][:][order]}
        contacts = {name: file["contacts"][name][:] for name in file["contacts"]}
    # a wall has another id in another case, and with it another place among the two
    a, b = contacts["body_a"], contacts["body_b"]
    first = ~numpy.isin(a, bodies["id"])
    contacts["body_a"] = numpy.where(first, b, a)
    contacts["body_b"] = numpy.where(first | ~numpy.isin(b, bodies["id"]), -1, b)
    contacts["tangential_force"] = numpy.where(first[:, None], -1, 1) * contacts["tangential_force"]
    order = numpy.lexsort([contacts[name] for name in ("feature", "body_b", "body_a")])
    return bodies, {name: values[order] for name, values in contacts.items()}


def a_bed_at_rest_rests_on_from_its_checkpoint():
    settle()
    decompose(head() + START + BOX, "on", says=["24 bodies of ", "contacts keep their springs\n", "that of the run"])
    run(1, "on.scene.h5", "-o", "on.run")
    before, contacts_before = state_of(frames_of("settle.run")[-1])
    after, contacts = state_of(frames_of("on.run")[0])
    assert (before["id"] == after["id"]).all()
    for name in ("x", "v"):   # every bit, but for the rounding that was kept apart
        assert numpy.abs(before[name] - after[name]).max() <= 4e-16 * numpy.abs(before["x"]).max(), name
    weight = 24 * 2500 * 1e-6 * 9.81
    assert all((contacts[name] == contacts_before[name]).all() for name in ("body_a", "body_b", "feature"))
    for name in ("normal_force", "tangential_force"):
        assert numpy.abs(contacts[name] - contacts_before[name]).max() <= 1e-10 * weight, name
    # nothing moves, and no energy comes from anywhere: of what the bed would gain by falling its own diameter
    fall = weight * 0.01
    kinetic = column("on.run", "kinetic_translational") + column("on.run", "kinetic_rotational")
    assert kinetic.max() <= 1e-6 * fall, kinetic
    energy = kinetic + sum(column("on.run", name) for name in ("potential", "elastic", "elastic_tangential"))
    assert (energy - energy[0]).max() <= 1e-9 * fall, energy - energy[0]
    last, _ = state_of(frames_of("on.run")[-1])
    assert numpy.abs(last["x"] - after["x"]).max() <= 1e-5 * 0.01


def without_springs_it_is_disturbed():
    """The control of the test above: what the springs hold is not small."""
    settle()
    number = int(os.path.basename(frames_of("settle.run")[-1])[6:12])
    decompose(head() + START + f"frame = {number}\n" + BOX, "frame", says=["contacts start without"])
    run(1, "frame.scene.h5", "-o", "frame.run")
    decompose(head() + START + BOX, "on")
    run(1, "on.scene.h5", "-o", "on.run")
    moved = {}
    for name in ("frame", "on"):
        first, last = (state_of(frames_of(f"{name}.run")[k])[0]["x"] for k in (0, -1))
        moved[name] = numpy.abs(last - first).max()
    assert moved["frame"] > 100 * moved["on"], moved


ADDED = """
[shapes.pea]
sphere = { radius = 0.003 }
[[bodies]]
shape = "pea"
material = "stone"
position = [0, 0, 0.15]
[[populations]]
shape = "pea"
material = "stone"
count = 30
region = { box = [[-0.024, -0.024, 0.0], [0.024, 0.024, 0.08]] }
[[walls]]
name = "lid"
shape = { plane = { point = [0, 0, 0.19], normal = [0, 0, -1] } }
material = "stone"
"""


def what_a_case_adds_is_put_around_the_bodies_and_is_the_same_on_any_ranks():
    settle()
    decompose(head() + START + BOX + ADDED, "more")
    with h5py.File("more.scene.h5") as file, h5py.File("settle.run/scene.h5") as bed:
        bodies, ids = {name: file["bodies"][name][:] for name in file["bodies"]}, bed["bodies/id"][:]
        walls = [wall["id"] for wall in json.loads(file["settings"][()])["walls"]]
        largest = max([*ids, *(wall["id"] for wall in json.loads(bed["settings"][()])["walls"])])
        assert file.attrs["format_version"] == 4 and file["start"].attrs["bodies"] == 24
        shapes = [file["shapes"][name].attrs["name"] for name in file["shapes"]]
        record = json.loads(file["provenance"][()])
    assert (bodies["id"][:24] == numpy.sort(ids)).all() and min([*bodies["id"][24:], *walls]) == largest + 1
    assert len(set([*bodies["id"], *walls])) == 24 + 31 + 2
    assert sorted(shapes) == sorted(set(shapes)), shapes   # cube and ball are the same shapes as in the run
    paths = [entry["path"] for entry in record["inputs"]]
    assert any("settle.run/checkpoint_" in path for path in paths) and any(path.endswith("settle.run/scene.h5") for path in paths), paths
    hashes = {}
    for ranks in (1, 2, 4):
        run(ranks, "more.scene.h5", "-o", f"r{ranks}.run", threads=2 if ranks == 2 else 1)
        hashes[ranks] = outcome(f"r{ranks}.run")["state_hash"]
    make_killed("r2.run")
    run(3, "more.scene.h5", "-o", "r2.run", "--restart", "latest")
    hashes["restarted"] = outcome("r2.run")["state_hash"]
    assert len(set(hashes.values())) == 1, hashes
    assert outcome("r1.run")["start"]["bodies"] == 24
    run(1, "verify", "r1.run", "--from", "start")
    # no added body begins in contact
    _, contacts = state_of(frames_of("r1.run")[0])
    assert contacts["body_a"].max() < 24 + 1 and len(contacts["body_a"]) > 0
    plan = run(1, "more.scene.h5", "--plan").stdout
    assert "start from a run" in plan and "24 bodies of " in plan, plan
    subprocess.run([os.path.join(BIN, "scree-post"), "report", "r1.run", "-o", "r1.html"], check=True, capture_output=True)
    with open("r1.html") as file:
        assert "Started from" in file.read()


def a_chain_of_starts_never_uses_an_id_again():
    settle()
    decompose(head() + START + BOX + ADDED, "first")
    run(1, "first.scene.h5", "-o", "first.run")
    decompose(head() + START.replace("settle", "first") + BOX + ADDED.replace("0.0], [0.024, 0.024, 0.08]", "0.09], [0.024, 0.024, 0.14]")
              .replace("[0, 0, 0.15]", "[0, 0, 0.17]"), "second")
    with h5py.File("first.scene.h5") as first, h5py.File("second.scene.h5") as second:
        used = [*first["bodies/id"][:], *(wall["id"] for wall in json.loads(first["settings"][()])["walls"])]
        kept, new = second["bodies/id"][:55], [*second["bodies/id"][55:], *(wall["id"] for wall in json.loads(second["settings"][()])["walls"])]
        assert (kept == first["bodies/id"][:]).all() and min(new) > max(used), (used, new)
    run(2, "second.scene.h5", "-o", "second.run")


def renamed_materials_and_another_wall():
    settle()
    other = head().replace("materials.stone", 'materials."wet stone"').replace('"stone"', '"wet stone"')
    narrow = BOX.replace('"stone"', '"wet stone"').replace("0.2]]", "0.3]]")
    decompose(other + START + narrow, "lacks", 2, ['are of the material "stone", which this case does not have', "materials = "])
    said = decompose(other + START + 'materials = { stone = "wet stone" }\n' + narrow, "wet", says=[" do not", "which the run did not have there"])
    assert "contacts keep their springs" in said
    run(1, "wet.scene.h5", "-o", "wet.run")
    decompose(other + START + 'materials = { sand = "wet stone" }\n' + narrow, "sand", 2, ["materials.sand", "has no such material; it has stone"])
    decompose(other + START + 'materials = { stone = "sandstone" }\n' + narrow, "typo", 2, ["there is no material 'sandstone'"])


def a_wall_that_a_servo_moved_is_where_it_stood():
    """A lid presses 20 N on a soft ball, which is pressed further than kPressedIn; the next stage moves the lid at a given speed."""
    text = """
[time]
duration = {duration}
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = "100 kN/m"
restitution = 0.2
friction = 0.4
{what}
[[walls]]
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "m"
[[walls]]
name = "lid"
shape = {{ {shape} }}
position = [0, 0, {z!r}]
material = "m"
motion = {{ {motion} }}
"""
    plate = 'plate = { corner = ["-2 cm", "-2 cm", "11 mm"], side_a = ["4 cm", 0, 0], side_b = [0, "4 cm", 0] }'
    ball = '[shapes.ball]\nsphere = { radius = "5 mm" }\n[[bodies]]\nshape = "ball"\nmaterial = "m"\nposition = [0, 0, "5 mm"]\n'
    on = '[start]\nrun = "press.run"\n'
    slow = 'translate = { velocity = [0, 0, "-1 mm/s"] }'
    servo = 'servo = { direction = [0, 0, -1], force = "20 N", max_speed = "0.05 m/s" }'
    decompose(text.format(duration=0.1, what=ball, shape=plate, z=0.0, motion=servo), "press")
    run(1, "press.scene.h5", "-o", "press.run")
    way = outcome("press.run")["drives"][0]["way"]
    for name, z in (("there", -way), ("written", float(f"{-way:.13g}"))):
        said = decompose(text.format(duration=0.01, what=on, shape=plate, z=z, motion=slow), name, says=["keep their springs"])
        assert "do not" not in said and "which the run did not have there" not in said, said
    run(1, "there.scene.h5", "-o", "there.run")
    with open("there.run/log.csv") as log:
        lid = [name for name in log.read().split("\n")[0].split(",") if name.endswith("_force_z")][-1]
    force = column("there.run", lid)   # as it was left, and 50 N/s more as both contacts are pressed
    assert abs(force[0] - 20) < 0.5 and abs(force[-1] - 20 - 50 * 0.01) < 0.5, force
    decompose(text.format(duration=0.01, what=on, shape=plate, z=-way - 5e-4, motion=slow), "away", 3,
              [f"in press.run wall 'lid' stood at position = [0, 0, {-way!r}"[:60]])


MACHINE = """
[time]
duration = {duration}
step = 2e-5
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = "20 kN/m"
restitution = 0.3
friction = 0.4
[contact]
surface = "outside"
margin = "0.2 mm"
{start}
[shapes.cube]
file = "cube.shape.h5"
[shapes.ball]
sphere = {{ radius = "5 mm" }}
[[populations]]
shape = "cube"
material = "m"
count = 4
region = {{ box = [["-2 cm", "-2 cm", "-2 cm"], ["2 cm", "2 cm", "2 cm"]] }}
[[bodies]]                      # on the shaker
shape = "ball"
material = "m"
position = [0.2, 0, "5.2 mm"]
force = [0, 1e-4, 0]
[[bodies]]                      # below the lid
shape = "ball"
material = "m"
position = [0.3, 0, "5.2 mm"]
[[walls]]
name = "drum"
shape = {{ drum = {{ start = [0, "-3 cm", 0], end = [0, "3 cm", 0], radius = "4 cm", segments = 24 }} }}
material = "m"
motion = {{ rotate = {{ axis = [0, 1, 0], rate = "{rate} rpm" }} }}
[[walls]]
name = "shaker"
shape = {{ plate = {{ corner = [0.18, "-2 cm", 0], side_a = ["4 cm", 0, 0], side_b = [0, "4 cm", 0] }} }}
material = "m"
motion = {{ oscillate = {{ direction = [1, 0, 0], amplitude = "1 mm", frequency = "7 Hz" }} }}
[[walls]]
name = "table"
shape = {{ plate = {{ corner = [0.28, "-2 cm", 0], side_a = ["4 cm", 0, 0], side_b = [0, "4 cm", 0] }} }}
material = "m"
[[walls]]
name = "lid"
shape = {{ plate = {{ corner = [0.28, "-2 cm", "11 mm"], side_a = ["4 cm", 0, 0], side_b = [0, "4 cm", 0] }} }}
material = "m"
motion = {{ servo = {{ direction = [0, 0, -1], force = "1 N", max_speed = "0.02 m/s", stroke = [-0.01, "5 mm"] }} }}
[output]
every = 0.02
"""


def go_on(name, duration, of=None, rate=60, more="", expect=0, says=()):
    start = f'[start]\nrun = "{of}.run"\ncontinue = true\n{more}' if of else ""
    said = decompose(MACHINE.format(duration=duration, start=start, rate=rate), name, expect, says)
    if expect == 0:
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    return said


def walls_of(path):
    with h5py.File(path) as file:
        return file["walls/position"][:], file["walls/orientation"][:]


def angle(path, wall=0):
    """About y [rad], of a wall's frame."""
    w, _, y, _ = walls_of(path)[1][wall]
    return 2 * numpy.arctan2(y, w)


def populations_of(path):
    with h5py.File(path) as file:
        return dict(zip(file["bodies/id"][:].tolist(), file["bodies/population"][:].tolist()))


def bodies_stay_what_they_were_poured_or_placed():
    """Of populations, of [[bodies]], of an inlet and waiting at one: what is apparatus and what a particle stays so in a run that goes on."""
    settle()
    text = (head(0.02) + MARGIN + BED + BOX + '[[bodies]]\nshape = "ball"\nmaterial = "stone"\nposition = [0, 0, 0.15]\n[[inlets]]\nname = "feed"\n'
            'shapes = { ball = 1 }\nmaterial = "stone"\nnumber_rate = "400 1/s"\nlimit = 2\nregion = { box = [[-0.02, -0.02, 0.17], [0.02, 0.02, 0.19]] }\n')
    decompose(text, "first")
    run(1, "first.scene.h5", "-o", "first.run")
    before = populations_of("first.scene.h5")
    assert sorted(set(before.values())) == [-1, 0], before
    with h5py.File(sorted(name for name in (os.path.join("first.run", n) for n in os.listdir("first.run")) if "checkpoint_" in name)[-1]) as file:
        there = file["bodies/id"][:].tolist()
    assert len(there) > len(before), there
    for name, words, shift in (("on", text.replace("seed = 3", 'seed = 3\n[start]\nrun = "first.run"\ncontinue = true', 1), 0),
                               ("more", head() + MARGIN + '[start]\nrun = "first.run"\n' + BOX + BED.replace("count = 24", "count = 2").replace("0.001]", "0.16]").replace("0.07]", "0.19]"), 1)):
        decompose(words, name)
        after = populations_of(f"{name}.scene.h5")
        for i in there:
            expected = before.get(i, 1)   # of the inlet: one more than there were
            assert after[i] == (expected + shift if expected >= 0 else -1), (name, i, after[i], expected)
        assert sum(p == 0 for i, p in after.items() if i not in there) == (2 if shift else 0), after


def a_case_goes_on_where_its_run_ended():
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "cube", "--size", "0.01", "-o", "cube.shape.h5", "--name", "cube"], check=True, capture_output=True)
    go_on("whole", 0.32)
    go_on("first", 0.16)
    said = go_on("second", 0.08, "first", says=["6 bodies of "])
    assert "starts in contact" not in said and "start in contact" not in said and "is not used" not in said, said
    go_on("third", 0.08, "second")
    end, (positions, turned) = state_of(frames_of("third.run")[-1])[0], walls_of(frames_of("third.run")[-1])
    whole, (positions_whole, turned_whole) = state_of(frames_of("whole.run")[-1])[0], walls_of(frames_of("whole.run")[-1])
    assert numpy.abs(end["x"] - whole["x"]).max() < 1e-8, numpy.abs(end["x"] - whole["x"]).max(axis=1)
    assert numpy.abs(positions - positions_whole).max() < 1e-9, positions - positions_whole
    assert numpy.abs(turned - turned_whole).max() < 1e-9, turned - turned_whole
    assert abs(outcome("third.run")["start"]["clock"] - 0.24) < 1e-12, outcome("third.run")["start"]
    # at another speed: on from the same angle
    go_on("faster", 0.04, "first", rate=90)
    at_end, at_start, later = (angle(path) for path in (frames_of("first.run")[-1], frames_of("faster.run")[0], frames_of("faster.run")[-1]))
    assert abs(at_end - at_start) < 1e-12 and abs(later - at_start - 2 * numpy.pi * 1.5 * 0.04) < 1e-9, (at_end, at_start, later)
    # what stays behind
    said = go_on("fewer", 0.02, "first", more='leave_out = { sphere = { centre = [0.3, 0, 0], radius = "2 cm" } }\n', says=["5 bodies of ", "(1 left out)"])
    assert len(state_of(frames_of("fewer.run")[0])[0]["id"]) == 5 and outcome("fewer.run")["start"]["left_out"] == 1
    go_on("held", 0.02, "first", more='leave_out = { inside_wall = "drum" }\n', says=["2 bodies of ", "(4 left out)"])
    # sizes of a population that goes on are those of its bodies
    sized = MACHINE.replace("count = 4", 'count = 4\nsize = {{ distribution = "uniform", min = "8 mm", max = "10 mm" }}')
    first = decompose(sized.format(duration=0.02, start="", rate=60), "sized", says=["4 bodies, solid fraction", "sizes 0"])
    run(1, "sized.scene.h5", "-o", "sized.run")
    again = decompose(sized.format(duration=0.02, start='[start]\nrun = "sized.run"\ncontinue = true\n', rate=60), "again", says=["sizes 0"])
    sizes = [next(line for line in said.splitlines() if line.startswith("sizes 0")) for said in (first, again)]
    assert sizes[0] == sizes[1], sizes
    # what does not go on
    go_on("all", 0.02, "first", more='leave_out = { box = [[-1, -1, -1], [1, 1, 1]] }\n', expect=2, says=["start.leave_out: all 6 bodies of "])
    go_on("frame", 0.02, "first", more="frame = 1\n", expect=2, says=["continue goes on from a checkpoint"])
    text = MACHINE.format(duration=0.02, start='[start]\nrun = "first.run"\ncontinue = true\n', rate=60)
    decompose(text.replace('radius = "4 cm"', 'radius = "5 cm"'), "wider", 2, ["wall 'drum' has another surface than in "])
    decompose(text.replace('name = "table"', 'name = "desk"'), "other", says=["has no wall 'desk'", "this case has no wall 'table'"])
    decompose(text.replace("continue = true", "continue = 1"), "word", 2, ["continue"])


def bad_input_is_refused_by_name():
    settle()
    bodies, _ = state_of(frames_of("settle.run")[-1])
    top = int(numpy.argmax(bodies["x"][:, 2]))
    x = bodies["x"][top]
    clear = numpy.where(bodies["x"][:, 2] > 0.008, numpy.hypot(bodies["x"][:, 0], bodies["x"][:, 1]), numpy.inf)
    inside = bodies["x"][int(numpy.argmin(clear))]   # where a ball touches no wall
    overlapping = f'[[bodies]]\nshape = "ball"\nmaterial = "stone"\nposition = [{inside[0]}, {inside[1]}, {inside[2]}]\n'
    decompose(head() + START + BOX + overlapping, "in", 3, ["bodies[0]: overlaps body ", " of settle.run", "move it away"])
    cut = BOX + f'[[walls]]\nname = "knife"\nshape = {{ plane = {{ point = [0, 0, {x[2]}], normal = [0, 0, -1] }} }}\nmaterial = "stone"\n'
    decompose(head() + START + cut, "cut", 3, [": body ", " of settle.run overlaps ", "(wall 'knife')"])
    decompose(head() + MARGIN.replace("2e-4", "1e-2") + START + BOX, "wide", 3, ["wider here", "contact.margin = 0.0002"])
    decompose(head() + MARGIN.replace("2e-4", "1e-4") + START + BOX, "slim", says=["start apart by the difference"])
    decompose(head() + "[domain]\nmin = [-1, -1, 0]\nmax = [1, 1, 0.01]\n" + START + BOX, "out", 3, ["lies outside the domain"])
    decompose(head() + START.replace("settle", "nothing") + BOX, "none", 3, ["none.toml:", "start.run: there is no folder ", "nothing.run"])
    os.makedirs("empty.run")
    decompose(head() + START.replace("settle", "empty") + BOX, "empty", 3, ["is no folder of a run: it holds no scene.h5"])
    shutil.copytree("settle.run", "bare.run")
    for file in os.listdir("bare.run"):
        if file.startswith("checkpoint_"):
            os.remove(os.path.join("bare.run", file))
    decompose(head() + START.replace("settle", "bare") + BOX, "bare", 3, ["holds no checkpoint", "frame = N"])
    decompose(head() + START + "checkpoint = 1\n" + BOX, "step", 3, ["start.checkpoint = 1", "it holds those of "])
    decompose(head() + START + "frame = 99999\n" + BOX, "number", 3, ["start.frame = 99999", "its last is frame_"])
    decompose(head() + START + "frame = 1\ncheckpoint = 1\n" + BOX, "both", 2, ["give either checkpoint or frame"])
    decompose(head() + "[start]\n" + BOX, "runless", 2, ["start", "run"])
    decompose(head() + START + "checkpiont = 1\n" + BOX, "slip", 2, ["checkpiont", "did you mean"])
    shutil.copytree("settle.run", "bad.run")
    newest = sorted(name for name in os.listdir("bad.run") if name.startswith("checkpoint_"))[-1]
    with open(os.path.join("bad.run", newest), "r+b") as file:
        file.seek(-100, os.SEEK_END)
        file.write(b"\xff" * 8)
    decompose(head() + START.replace("settle", "bad") + BOX, "bad", 3, ["damaged", "give checkpoint = N for another one"])
    shutil.copytree("settle.run", "mixed.run")
    decompose(head(1.5) + MARGIN + BED + BOX, "another")
    shutil.copy("another.scene.h5", "mixed.run/scene.h5")
    decompose(head() + START.replace("settle", "mixed") + BOX, "mixed", 3, ["was not made from the scene.h5 beside it"])


def a_damaged_start_in_a_scene_is_refused():
    settle()
    decompose(head() + START + BOX, "on")
    for name, change, says in [
            ("kind", lambda f: f.move("start/pairs/springs", "start/pairs/bonds"), "knows no such state of pairs"),
            ("column", lambda f: f.__delitem__("start/pairs/springs/force"), "has no column force"),
            ("finite", lambda f: f["start/pairs/springs/force"].__setitem__((0, 1), float("nan")), "start/pairs/springs/force: row 0 is not a finite number"),
            ("pair", lambda f: f["start/pairs/springs/a"].__setitem__(0, 10**6), "which the scene does not have"),
            ("rows", lambda f: f["start"].attrs.__setitem__("bodies", 23), "rows expected"),
            ("number", lambda f: f["start/bodies/q_principal"].__setitem__((0, 0), 7.0), "unit quaternion")]:
        shutil.copy("on.scene.h5", f"{name}.scene.h5")
        with h5py.File(f"{name}.scene.h5", "r+") as file:
            change(file)
        result = run(2, f"{name}.scene.h5", "-o", f"{name}.run", expect=3)
        assert says in result.stderr, result.stderr


main([a_bed_at_rest_rests_on_from_its_checkpoint, without_springs_it_is_disturbed,
      what_a_case_adds_is_put_around_the_bodies_and_is_the_same_on_any_ranks, a_chain_of_starts_never_uses_an_id_again,
      renamed_materials_and_another_wall, a_wall_that_a_servo_moved_is_where_it_stood, bodies_stay_what_they_were_poured_or_placed, a_case_goes_on_where_its_run_ended, bad_input_is_refused_by_name, a_damaged_start_in_a_scene_is_refused])
