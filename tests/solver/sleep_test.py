#!/usr/bin/env python3
"""Bodies that sleep (time.sleep) as a user meets them. usage: sleep_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import glob
import math
import os
import shutil
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, column, frames_of, main, make_killed, outcome, pack, physics_of_log, run, same_frames  # noqa: E402

ROCKS = """
[contact]
margin = "0.4 mm"
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 2e4
restitution = {restitution}
friction = {friction}
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shape = "rock"
material = "stone"
count = {count}
"""

# Rocks and balls that are poured, rest and sleep; a ball that comes late wakes some of them; then a plate pushes into the heap and stops,
# and an outlet takes out what it pushed away.
HEAP = """
seed = 5
gravity = [0, 0, -9.81]
[time]
duration = 0.6
step = 3e-5
sleep = true
[shapes.ball]
sphere = { radius = "6 mm" }
""" + ROCKS.format(restitution=0.3, friction=0.6, count=14) + """\
region = { box = [[-0.035, -0.02, 0.005], [0.03, 0.02, 0.045]] }
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "stone"
[[walls]]
name = "plate"
shape = { plate = { corner = [-0.075, -0.05, -0.01], side_a = [0, 0.1, 0], side_b = [0, 0, 0.08] } }
material = "stone"
motion = { translate = { velocity = [0.7, 0, 0] }, start = 0.47, stop = 0.57 }
[[inlets]]
name = "late"
shape = "ball"
material = "stone"
region = { box = [[-0.01, -0.01, 0.03], [0.01, 0.01, 0.06]] }
number_rate = 100
start = 0.3
count = 1
[[outlets]]
name = "edge"
region = { box = [[0.031, -1, -0.5], [1, 1, 0.5]] }
[output]
every = 0.05
checkpoint = 0.13
"""

# A heap that is poured into a tray, which holds it.
BED = """
seed = 7
gravity = [0, 0, -9.81]
[time]
duration = 0.9
step = 4e-5
sleep = true
""" + ROCKS.format(restitution=0.4, friction=0.5, count=30) + """\
region = { box = [[-0.03, -0.03, 0.005], [0.03, 0.03, 0.09]] }
[[walls]]
name = "tray"
shape = { box_inside = [[-0.035, -0.035, 0], [0.035, 0.035, 0.5]] }
material = "stone"
[output]
every = 0.05
checkpoint = 0.2
"""

# Five equal balls on a floor without friction: the first comes from the side, the others touch and sleep. Only the floor damps.
CRADLE = """
gravity = [0, 0, -9.81]
[time]
duration = 0.17
step = 4e-6
sleep = {sleep}
[contact]
law = "{law}"
margin = 0
impact_speed = 1
[materials.steel]
density = 7800
{material}
[[pairs]]
between = ["steel", "steel"]
restitution = 1
friction = 0
{pair}
[materials.ice]
density = 1000
{material}
[[pairs]]
between = ["steel", "ice"]
restitution = 0.1
friction = 0
{pair}
[shapes.ball]
sphere = {{ radius = 0.01 }}
{bodies}
[[walls]]
name = "floor"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "ice"
[output]
every = 0.01
"""


def rock():
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "12 mm, 10 mm, 9 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)


def changed(text, changes):
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def paths(folder):
    return sorted(glob.glob(f"{folder}/frame_*.hdf"))


def named(path, name):
    """A quantity of a frame, by id."""
    import h5py
    with h5py.File(path) as file:
        data = file["VTKHDF/PointData"]
        values = file["VTKHDF/Points"][()] if name == "position" else data[name][()]
        return values[data["id"][()].argsort()]


def final(folder, name):
    return named(paths(folder)[-1], name)


def positions(folder):
    """Of the first body in all frames."""
    return numpy.array([named(path, "position")[0] for path in paths(folder)])


def a_cradle_that_sleeps_is_struck_as_one_that_is_awake():
    """The last of five leaves with 0.942 of the speed of the first with springs, 0.989 with Hertz's law, and what sleep changes is below 1e-3."""
    for law, material, pair, last in (("linear", "", "stiffness = 1e6", 0.942), ("hertz-mindlin", "young = 2e9\npoisson = 0.3", "", 0.989)):
        speeds = {}
        for sleep in ("false", "true"):
            bodies = "".join(f'[[bodies]]\nshape = "ball"\nmaterial = "steel"\nposition = [{x}, 0, 0.01]\nvelocity = [{v}, 0, 0]\nlock_rotation = true\n'
                             for x, v in ((-0.062, 0.5), (0, 0), (0.02, 0), (0.04, 0), (0.06, 0)))
            name = f"{law}-{sleep}"
            pack(name, CRADLE.format(sleep=sleep, law=law, material=material, pair=pair, bodies=bodies))
            run(1, name + ".scene.h5", "-o", name + ".run")
            speeds[sleep] = final(name + ".run", "velocity")[:, 0] / 0.5
        asleep = column(f"{law}-true.run", "asleep")
        assert asleep.max() == 4 and asleep[-1] == 0, asleep
        assert abs(speeds["true"] - speeds["false"]).max() < 1e-3, speeds
        assert abs(speeds["true"][-1] - last) < 1e-3, (law, speeds)


# A block, which a ball that does not turn stands for, on a plane that is tilted about the point below it.
SLOPE = """
gravity = [0, 0, -9.81]
[time]
duration = {duration}
step = 8e-6
sleep = true
[contact]
margin = 0
impact_speed = 0.1
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = 1e5
restitution = 0.1
friction = 0.5
[shapes.ball]
sphere = {{ radius = 0.002 }}
[[bodies]]
shape = "ball"
material = "m"
position = [0, 0, 0.002]
lock_rotation = true
[[walls]]
name = "slope"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "m"
motion = [{motions}]
[output]
every = 0.01
"""


def a_slope_that_is_tilted_in_stages_is_left_at_the_angle_of_friction():
    """atan(0.5) = 26.565 degrees: the block sleeps through all rests below it, and slides with g (sin - mu cos) above it; both within 0.05 degrees."""
    limit, rate, rest = math.degrees(math.atan(0.5)), 20.0, 0.3
    angles, time, motions = [8.0, 16.0, 24.0, limit - 0.05, limit + 0.05], 0.1, []
    rests = []
    for before, angle in zip([0.0, *angles], angles):
        stop = time + (angle - before) / rate
        motions.append(f'{{ rotate = {{ axis = [0, 1, 0], centre = [0, 0, 0], rate = "{rate} deg/s" }}, start = {time!r}, stop = {stop!r} }}')
        rests.append((stop, stop + rest))
        time = stop + rest
    pack("slope", SLOPE.format(duration=time + 0.4, motions=", ".join(motions)))
    run(1, "slope.scene.h5", "-o", "slope.run")
    times, asleep, x = column("slope.run", "time"), column("slope.run", "asleep"), positions("slope.run")[:, 0]
    moving = column("slope.run", "kinetic_translational")
    for begin, end in rests[:-1]:
        k = numpy.searchsorted(times, end) - 1
        assert times[k] > begin and asleep[k] == 1 and moving[k] == 0, (begin, end, times[k])
        assert (asleep[(times > end + 2e-3) & (times < end + 5e-3)] == 0).all(), "a slope that moves wakes what lies on it"
    assert asleep[-1] == 0
    # it slides, slowly: the margin of 0.05 degrees is an acceleration of 9.81 * 0.05 * pi / 180 * sqrt(1.25)
    assert numpy.linalg.norm(final("slope.run", "velocity")[0]) > 0.3 * 9.81 * math.radians(0.05) * math.sqrt(1.25), final("slope.run", "velocity")
    first, last = positions("slope.run")[len(x) - 41], positions("slope.run")[-1]
    assert numpy.linalg.norm(last - first) > 1e-4, (first, last)


# A heavy block and a light one that touches it, both asleep. A third comes and pushes the light one, which an outlet takes out before it has
# left the heavy one: that one bears the push in its sleep, and wakes since it has lost a neighbour.
OUTLET = """
gravity = [0, 0, -9.81]
[time]
duration = 0.7
step = 1e-5
sleep = true
sleep_tolerance = 0.5
[contact]
margin = 0
impact_speed = 1
[materials.light]
density = 1000
[materials.heavy]
density = 50000
[[pairs]]
between = ["light", "light"]
stiffness = 2e3
restitution = 0.1
friction = 0.2
[[pairs]]
between = ["light", "heavy"]
stiffness = 2e3
restitution = 0.1
friction = 0.2
[shapes.ball]
sphere = { radius = 0.01 }
[[bodies]]
shape = "ball"
material = "heavy"
position = [0.02, 0, 0.01]
lock_rotation = true
[[bodies]]
shape = "ball"
material = "light"
position = [0, 0, 0.01]
lock_rotation = true
force = [0.012, 0, 0]
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "light"
[[inlets]]
shape = "ball"
material = "light"
region = { box = [[-0.0455, -0.0105, 0.0002], [-0.0245, 0.0105, 0.0206]] }
velocity = [0.3, 0, 0]
number_rate = 1000
start = 0.4
count = 1
[[outlets]]
region = { box = [[0.0001, -0.01, 0], [0.005, 0.01, 0.1]] }
[output]
every = 0.01
"""


def a_neighbour_that_is_taken_out_wakes_who_touched_it():
    pack("outlet", OUTLET)
    run(1, "outlet.scene.h5", "-o", "outlet.run")
    times, asleep, gone = column("outlet.run", "time"), column("outlet.run", "asleep"), column("outlet.run", "removed_bodies")
    assert (asleep[(times > 0.3) & (times < 0.4)] == 2).all(), asleep
    taken = times[numpy.flatnonzero(gone == 1)[0]]
    struck = times[numpy.flatnonzero((asleep < 2) & (times > 0.4))[0]]
    assert 0.4 < struck <= taken < 0.6, (struck, taken)
    assert (asleep[(times >= struck) & (times < taken)] == 1).all() and struck < taken, "the push alone leaves the heavy one asleep"
    assert (asleep[(times >= taken) & (times < taken + 0.05)] == 0).all(), asleep
    assert asleep[-1] >= 1, "it falls asleep again"
    run(2, "outlet.scene.h5", "-o", "two.run")
    assert physics_of_log("two.run") == physics_of_log("outlet.run")


# A slab on balls whose floor goes down: each of them carries less than the tolerance.
SLAB = """
gravity = [0, 0, -9.81]
[time]
duration = 0.65
sleep = true
sleep_tolerance = 0.01
[contact]
impact_speed = 1
margin_ratio = 0.02
[materials.m]
density = 2700
[[pairs]]
between = ["m", "m"]
stiffness = 1e5
restitution = 0.1
friction = 0.5
rolling_friction = 0.1
torsional_friction = 0.1
[shapes.slab]
file = "slab.shape.h5"
[shapes.ball]
sphere = { radius = 0.008 }
[[bodies]]
shape = "slab"
material = "m"
position = [0, 0, 0.0361]
[[populations]]
shape = "ball"
material = "m"
method = "lattice"
jitter = 0
count = 121
region = { box = [[-0.115, -0.115, 0.00001], [0.115, 0.115, 0.01603]] }
[[walls]]
shape = { plate = { corner = [-0.3, -0.3, 0], side_a = [0.6, 0, 0], side_b = [0, 0.6, 0] } }
material = "m"
motion = { translate = { velocity = [0, 0, -1] }, start = 0.5 }
[output]
every = 0.02
"""


def a_slab_whose_support_leaves_grain_by_grain_falls():
    """From 0.5 s on it falls freely: within the time that the balls take to let go, as if it had never slept."""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "0.24, 0.24, 0.04", "-o", "slab.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    pack("slab", SLAB)
    run(1, "slab.scene.h5", "-o", "slab.run")
    times, asleep, z = column("slab.run", "time"), column("slab.run", "asleep"), positions("slab.run")[:, 2]
    assert asleep[times < 0.49][-1] == 122, asleep[times < 0.49]
    way = z[0] - z[-1]
    assert abs(way / (0.5 * 9.81 * 0.15**2) - 1) < 0.05, way
    run(2, "slab.scene.h5", "-o", "two.run")
    assert physics_of_log("two.run") == physics_of_log("slab.run")


# An octahedron on its tip, 1e-5 rad from upright.
TIP = """
gravity = [0, 0, -9.81]
[time]
duration = 1
sleep = {sleep}
[contact]
margin_ratio = 0.05
relax = false
[materials.m]
density = 2700
[[pairs]]
between = ["m", "m"]
stiffness = 1e4
restitution = 0.1
friction = 0.5
[shapes.tip]
file = "tip.shape.h5"
[[bodies]]
shape = "tip"
material = "m"
position = [0, 0, 0.0097]
orientation = [{w!r}, {x!r}, 0, 0]
[[walls]]
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "m"
[output]
every = 0.025
"""


def a_body_that_falls_from_its_tip_does_not_sleep_on_it():
    with open("tip.off", "w") as file:
        file.write("OFF\n6 8 0\n0.01 0 0\n-0.01 0 0\n0 0.01 0\n0 -0.01 0\n0 0 0.01\n0 0 -0.01\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n")
    subprocess.run([os.path.join(BIN, "scree-mesher"), "import", "tip.off", "-o", "tip.shape.h5", "--unit", "m"], check=True, env=ENV, capture_output=True)
    ends = {}
    for sleep in ("false", "true"):
        pack(sleep, TIP.format(sleep=sleep, w=math.cos(0.5e-5), x=math.sin(0.5e-5)))
        run(1, sleep + ".scene.h5", "-o", sleep + ".run")
        ends[sleep] = final(sleep + ".run", "position")[0]
    assert ends["false"][2] < 0.0075, "it has not fallen"
    assert abs(ends["true"][2] - ends["false"][2]) < 1e-5, ends


def what_sleeps_for_ten_seconds_has_moved_by_exactly_nothing():
    rock()
    pack("bed", changed(BED, {"duration = 0.9": "duration = 10.6", "every = 0.05": "every = 0.2", "count = 30": "count = 5", "checkpoint = 0.2": ""}))
    run(1, "bed.scene.h5", "-o", "bed.run")
    asleep = column("bed.run", "asleep")
    times = column("bed.run", "time")
    assert (asleep[times > 0.55] == 5).all(), asleep
    for name in ("position", "quat"):
        frames = [named(path, name) for path in paths("bed.run")[3:]]
        assert len(frames) >= 50 and all(numpy.array_equal(frames[0], f) for f in frames), name
    assert column("bed.run", "kinetic_translational")[-1] == 0 and 0 < column("bed.run", "slept")[-1] < 1e-10


def energies_of_a_run_that_sleeps_are_closed():
    """What is in motion as bodies fall asleep is in `slept`: the balance is that of a run that stays awake, and so are the places, nearly."""
    rock()
    ends = {}
    for name, sleep in (("awake", "sleep = false"), ("asleep", "sleep = true")):
        pack(name, changed(BED, {"sleep = true": sleep}))
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
        ends[name] = final(f"{name}.run", "position"), column(f"{name}.run", "energy_error")[-1], column(f"{name}.run", "elastic")[-1]
    assert column("asleep.run", "asleep")[-1] == 30
    assert abs(ends["awake"][1] - ends["asleep"][1]) < 1e-3 * abs(ends["awake"][1]), ends
    assert abs(ends["awake"][2] - ends["asleep"][2]) < 1e-3 * ends["awake"][2]
    assert abs(ends["awake"][0] - ends["asleep"][0]).max() < 1e-6
    assert "asleep" not in physics_of_log("awake.run")[0]
    for name, is_said in (("asleep", True), ("awake", False)):
        subprocess.run([os.path.join(BIN, "scree-post"), "report", f"{name}.run", "-o", f"{name}.html"], check=True, env=ENV, capture_output=True, timeout=200)
        with open(f"{name}.html", encoding="utf-8") as file:
            assert ("30 bodies sleep at the end" in file.read()) == is_said, name


def a_tolerance_of_nothing_changes_nothing():
    """At the smallest tolerance nobody sleeps, and the run has the bits of one that knows no sleep."""
    rock()
    kept = {}
    for name, sleep in (("awake", ""), ("asleep", "sleep = true\nsleep_tolerance = 1e-300")):
        pack(name, changed(BED, {"sleep = true": sleep, "duration = 0.9": "duration = 0.3"}))
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
        kept[name] = [named(path, "position") for path in paths(f"{name}.run")]
    assert column("asleep.run", "asleep").max() == 0
    assert len(kept["awake"]) == len(kept["asleep"]) and all(numpy.array_equal(a, b) for a, b in zip(kept["awake"], kept["asleep"]))


def mistakes_and_plan_are_told():
    rock()
    pack("bed", BED)
    said = run(1, "bed.scene.h5", "--plan").stdout
    assert "in   sleep" in said and "every 64 steps" in said, said
    pack("awake", changed(BED, {"sleep = true": ""}))
    assert "out  sleep" in run(1, "awake.scene.h5", "--plan").stdout
    weightless = changed(BED, {"[0, 0, -9.81]": "[0, 0, 0]"})
    assert "time.sleep: without gravity nothing sleeps" in pack("weightless", weightless)
    assert "without gravity" in run(1, "weightless.scene.h5", "--plan").stdout
    fluid = "[fluid]\ndensity = 1000\nviscosity = 1e-3\nvelocity = [0.1, 0, 0]\n"
    bond = '[[bonds]]\nbetween = ["stone", "stone"]\nyoung = 1e6\n'
    for name, text, words in (("impacts", changed(BED, {"checkpoint = 0.2": "impacts = true"}), ["output.impacts", "time.sleep"]),
                              ("stream", BED + fluid, ["velocity", "time.sleep", "fluid at rest"]), ("bonds", BED + bond, ["bonds", "time.sleep"]),
                              ("alone", changed(BED, {"sleep = true": "sleep_tolerance = 0.01"}), ["sleep_tolerance", "sleep = true"]),
                              ("large", changed(BED, {"sleep = true": "sleep = true\nsleep_tolerance = 2"}), ["sleep_tolerance", "between 0 and 1"])):
        said = pack(name, text, expect=2)
        assert all(word in said for word in words), said
    servo = changed(BED, {"[output]": '[[walls]]\nname = "press"\nshape = { plate = { corner = [-0.03, -0.03, 0.2], side_a = [0, 0.06, 0], side_b = [0.06, 0, 0] } }\n'
                          'material = "stone"\nmotion = { servo = { direction = [0, 0, -1], force = 1, max_speed = 0.1 } }\n[output]'})
    assert "no body sleeps that touches wall 'press'" in pack("servo", servo)


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
        same_frames(frames_of("r1.run", ()), frames_of(folder, ()), "x", f"{ranks} ranks")
    # they slept, the ball that came late woke some but not all, and what was pushed over the edge left
    asleep, bodies = column("r1.run", "asleep"), 15
    assert asleep.max() >= 10, asleep
    assert asleep[-1] < asleep.max() < bodies and (numpy.diff(asleep) < 0).any(), asleep
    assert column("r1.run", "removed_bodies")[-1] > 0
    for keep in (2, 3):
        shutil.copytree("r1.run", f"again{keep}.run")
        make_killed(f"again{keep}.run", keep=1)
        run(keep, "heap.scene.h5", "-o", f"again{keep}.run", "--restart", "latest")
        assert outcome(f"again{keep}.run")["state_hash"] == kept[0] and physics_of_log(f"again{keep}.run") == kept[1], keep
    said = run(2, "verify", "r1.run", "--from", "start").stdout
    assert "the same, bit for bit" in said, said


main([the_same_bits_on_any_ranks_and_threads_and_after_a_restart, a_cradle_that_sleeps_is_struck_as_one_that_is_awake,
      a_slope_that_is_tilted_in_stages_is_left_at_the_angle_of_friction, a_neighbour_that_is_taken_out_wakes_who_touched_it,
      a_slab_whose_support_leaves_grain_by_grain_falls, a_body_that_falls_from_its_tip_does_not_sleep_on_it,
      what_sleeps_for_ten_seconds_has_moved_by_exactly_nothing,
      energies_of_a_run_that_sleeps_are_closed, a_tolerance_of_nothing_changes_nothing, mistakes_and_plan_are_told])
