#!/usr/bin/env python3
"""Inlets and outlets as a user meets them: bodies that come into a run and leave it. usage: inlets_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import glob
import math
import os
import shutil
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, main, make_killed, outcome, pack, physics_of_log, run  # noqa: E402

G = 9.81
EXCHANGE = 32  # steps between two looks at inlets and outlets
DENSITY = 2000.0

HEAD = """
seed = 5
[time]
duration = {duration}
{time}
[contact]
margin = {margin}
[materials.m]
density = 2000
[[pairs]]
between = ["m", "m"]
stiffness = {stiffness}
restitution = 0.5
friction = 0.3
[output]
every = {every}
contacts = false
checkpoint = {checkpoint}
[shapes.ball]
sphere = {{ radius = 0.01 }}
"""


def head(duration, time="", margin="0", stiffness="1000", every=None, checkpoint="0"):
    return HEAD.format(duration=duration, time=time, margin=margin, stiffness=stiffness, every=every or duration / 4, checkpoint=checkpoint)


def computed(name, text, ranks=1, **options):
    pack(name, text)
    return run(ranks, f"{name}.scene.h5", "-o", f"{name}.run", **options)


def table(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def last_frame(folder):
    with h5py.File(sorted(glob.glob(f"{folder}/frame_*.hdf"))[-1]) as file:
        data = file["VTKHDF/PointData"]
        return {"x": file["VTKHDF/Points"][()], "id": data["id"][()], "mass": data["mass"][()] if "mass" in data else None}


def ball_mass(radius):
    return DENSITY * 4 / 3 * math.pi * radius**3


# ---- outlets

def an_outlet_takes_out_what_falls_into_it():
    """Five balls and a region of each kind, every one with its top at 0: the fall is known, and so are the step and the velocity."""
    heights = [0.3, 0.51, 0.2, 0.77, 0.44]
    text = head(0.6, "step = 1e-4")
    for i, z in enumerate(heights):
        text += f"[[bodies]]\nshape = 'ball'\nmaterial = 'm'\nposition = [{i}, 0, {z}]\n"
    text += "[[bodies]]\nshape = 'ball'\nmaterial = 'm'\nposition = [0, 0, -0.2]\nfixed = true\n"
    text += "[[bodies]]\nshape = 'ball'\nmaterial = 'm'\nposition = [5, 0, 0.5]\n"  # falls past all of them
    text += """
[[walls]]
name = "bin"
shape = { box = { corners = [[3.8, -0.2, -0.8], [4.2, 0.2, 0]], open = ["+z"] } }
material = "m"
[[outlets]]
name = "box, the first"
region = { box = [[-0.1, -0.1, -0.5], [1.1, 0.1, 0]] }
[[outlets]]
name = "cylinder"
region = { cylinder = { start = [2, 0, -0.5], end = [2, 0, 0], radius = 0.05 } }
[[outlets]]
name = "sphere"
region = { sphere = { centre = [3, 0, -0.25], radius = 0.25 } }
[[outlets]]
name = "mesh"
region = { inside_wall = "bin" }
"""
    text = text.replace("margin = 0", "margin = 1e-4")
    computed("fall", text)
    rows, record = table("fall.run", "removed.csv"), outcome("fall.run")
    names = ["box, the first", "box, the first", "cylinder", "sphere", "mesh"]
    assert sorted(int(row["id"]) for row in rows) == [0, 1, 2, 3, 4], rows
    for row in rows:
        i = int(row["id"])
        late = math.sqrt(2 * heights[i] / G)
        step = math.ceil(late / 1e-4 / EXCHANGE) * EXCHANGE
        assert int(row["step"]) == step, (row, step)
        assert row["outlet"] == names[i], (row, names[i])
        assert float(row["residence_time"]) == float(row["time"]) == step * 1e-4, row
        assert abs(float(row["velocity_z"]) + G * float(row["time"])) < 1e-9, row
    assert record["removed_bodies"] == 5 and record["bodies"] == 2 and record["lost_bodies"] == 0, record
    assert [o["bodies"] for o in record["outlets"]] == [2, 1, 1, 1], record["outlets"]
    assert abs(sum(o["mass"] for o in record["outlets"]) - 5 * ball_mass(0.01)) < 1e-12
    # what left took its energy along: nothing is missing
    assert record["energy"]["error_max"] < 1e-11 * record["energy"]["kinetic_peak"], record["energy"]
    last = table("fall.run", "log.csv")[-1]
    by_hand = sum(0.5 * ball_mass(0.01) * sum(float(r["velocity_" + k]) ** 2 for k in "xyz") + ball_mass(0.01) * G * float(r["z"]) for r in rows)
    assert abs(float(last["removed"]) - by_hand) < 1e-9 * abs(by_hand) + 1e-12, (last["removed"], by_hand)


# ---- inlets

FEED = """
[shapes.small]
sphere = {{ radius = 0.006 }}
[[inlets]]
name = "feed"
shapes = {{ ball = 2, small = 1 }}
material = "m"
region = {{ box = [[-0.2, -0.2, 0.9], [0.2, 0.2, 1]] }}
velocity = [0, 0, -1]
{rate}
"""
END = """
[[outlets]]
name = "end"
region = { box = [[-0.5, -0.5, -0.4], [0.5, 0.5, 0]] }
"""


def what_comes_in_is_the_integral_of_the_rate_and_what_is_there_is_in_minus_out():
    """By mass along a table, with sizes: to half a body at every row of the log. Hardly anything touches: every fall is known."""
    size = 'size = { distribution = "uniform", min = 0.008, max = 0.02 }\n'
    rate = size + "rate = { time = [0.1, 0.5, 1.0], rate = [0.2, 1.0, 0.4] }\nstart = 0.2\nstop = 1.6\n"
    computed("mass", head(2.0) + FEED.format(rate=rate) + END)
    largest = ball_mass(0.01)

    def owed(t):
        t = min(t, 1.6) - 0.2
        if t <= 0:
            return 0.0
        times, rates = numpy.array([0, 0.1, 0.5, 1.0, 9]), numpy.array([0.2, 0.2, 1.0, 0.4, 0.4])
        grid = numpy.union1d(times[times < t], [0, t])
        return numpy.trapezoid(numpy.interp(grid, times, rates), grid) if hasattr(numpy, "trapezoid") else numpy.trapz(numpy.interp(grid, times, rates), grid)

    record, log = outcome("mass.run"), table("mass.run", "log.csv")
    inserted, removed = table("mass.run", "inserted.csv"), table("mass.run", "removed.csv")
    interval = EXCHANGE * record["step_size"]
    for row in log:
        behind = 1.0 * interval  # most that is owed since the last look
        assert abs(float(row["inserted_mass"]) - owed(float(row["time"]))) <= 0.5 * largest + behind, (row["time"], row["inserted_mass"])
    assert abs(record["inserted_mass"] - owed(2.0)) <= 0.5 * largest, (record["inserted_mass"], owed(2.0))
    feed = record["inlets"][0]
    assert abs(feed["owed"] - owed(2.0)) < 1e-12 and feed["shortfall"] == 0 and feed["times_blocked"] == 0, feed
    assert feed["bodies"] == len(inserted) > 100, feed
    # exactly, since both sides are exact sums: in - out = there
    assert len(inserted) - len(removed) == record["bodies"] and len(removed) > 50 and record["lost_bodies"] == 0
    came = {row["id"]: row for row in inserted}
    assert len(came) == len(inserted), "an id came twice"
    assert [int(row["id"]) for row in inserted] == sorted(int(row["id"]) for row in inserted)
    gone = {row["id"] for row in removed}
    there = {str(i) for i in last_frame("mass.run")["id"]}
    assert there == set(came) - gone
    total = math.fsum(float(came[i]["mass"]) for i in came)
    assert abs(total - math.fsum([math.fsum(float(row["mass"]) for row in removed), math.fsum(float(came[i]["mass"]) for i in there)])) < 1e-14 * total
    assert float(log[-1]["inserted_mass"]) == total and float(log[-1]["removed_mass"]) == math.fsum(float(row["mass"]) for row in removed)
    for row in removed:
        first = came[row["id"]]
        assert row["mass"] == first["mass"]
        assert float(row["residence_time"]) == float(row["time"]) - float(first["time"])
        fall = (-1 + math.sqrt(1 + 2 * G * float(first["z"]))) / G  # with 1 m/s from there to 0
        assert 0 <= float(row["residence_time"]) - fall <= interval * (1 + 1e-9), (row, fall)
    for row in inserted:
        radius = 0.5 * float(row["diameter"])
        assert 0.004 <= radius <= 0.01 and abs(float(row["mass"]) / ball_mass(radius) - 1) < 1e-12, row
        assert -0.2 + radius <= float(row["x"]) <= 0.2 - radius and 0.9 + radius <= float(row["z"]) <= 1 - radius, row
    # bodies bring their energy: nothing is made or lost
    assert record["energy"]["error_max"] < 1e-8 * record["energy"]["kinetic_peak"], record["energy"]  # some graze each other
    first = min(inserted, key=lambda row: int(row["step"]))
    assert float(first["time"]) > 0.2


def shapes_and_sizes_follow_what_was_asked():
    """The n-th body is a function of the seed, the inlet and n: shares to a body or two, sizes to their quantiles, at any number."""
    size = 'size = { distribution = "lognormal", median = 0.012, sigma = 0.3, min = 0.006, max = 0.03 }\n'
    computed("shares", head(1.0) + FEED.format(rate=size + 'number_rate = "300 /s"\n') + END)
    rows = table("shares.run", "inserted.csv")
    assert len(rows) == 300, len(rows)
    for n in (30, 90, 300):
        balls = sum(row["shape"] == "ball" for row in rows[:n])
        assert abs(balls - n * 2 / 3) <= 3, (n, balls)
    from math import erf, log, sqrt

    def below(d):
        def phi(x):
            return 0.5 * (1 + erf(log(x / 0.012) / 0.3 / sqrt(2)))
        return (phi(d) - phi(0.006)) / (phi(0.03) - phi(0.006))

    diameters = sorted(float(row["diameter"]) for row in rows)
    difference = max(abs((i + 0.5) / len(diameters) - below(d)) for i, d in enumerate(diameters))
    assert difference < 0.03, difference  # independent numbers would differ by .05 in the mean
    # by mass, as they are: (2 : 1 of the mass) of bodies of masses 1 : 0.216
    computed("by_mass", head(1.0) + FEED.format(rate='shares_by = "mass"\nnumber_rate = 300\n') + END)
    rows = table("by_mass.run", "inserted.csv")
    mass = {name: sum(float(row["mass"]) for row in rows if row["shape"] == name) for name in ("ball", "small")}
    assert abs(mass["ball"] / mass["small"] - 2) < 0.1, mass


def a_limit_ends_an_inlet_to_a_body():
    text = head(1.0) + FEED.format(rate='rate = 5\nlimit = 0.5\n').replace("ball = 2, small = 1", "ball = 1") + END
    computed("limit", text)
    record, mass = outcome("limit.run"), ball_mass(0.01)
    assert record["inlets"][0]["bodies"] == round(0.5 / mass) and record["inlets"][0]["shortfall"] == 0, record["inlets"]
    computed("count", text.replace("limit = 0.5", "count = 7"))
    assert outcome("count.run")["inlets"][0]["bodies"] == 7
    # 20 balls of 0.2 kg/s, for which there is no room: what is owed is the mass of 20
    text = head(0.2) + """
[[inlets]]
shape = "ball"
material = "m"
region = { box = [[-0.03, -0.03, 0.02], [0.03, 0.03, 0.08]] }
velocity = [0, 0, -0.01]
rate = 1000
count = 200
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "m"
"""
    for name, rate, limit in (("by_mass", "rate = 1000", "count = 200"), ("by_number", "number_rate = 1e5", f"limit = {200 * mass}")):
        computed(name, text.replace("rate = 1000", rate).replace("count = 200", limit))
        inlet = outcome(f"{name}.run")["inlets"][0]
        one = mass if name == "by_mass" else 1
        assert inlet["bodies"] < 200 and abs(inlet["owed"] - 200 * one) < 1e-9 * inlet["owed"], inlet
        assert abs(inlet["shortfall"] - (200 - inlet["bodies"]) * one) < 1e-9 * inlet["owed"], inlet


def a_blocked_inlet_waits_and_says_so_once_or_ends_the_run():
    """A closed tray that holds a few balls: the inlet fills it, and no more fits."""
    tray = """
[[walls]]
shape = { box_inside = [[-0.03, -0.03, 0], [0.03, 0.03, 0.3]] }
material = "m"
"""
    text = head(1.5, checkpoint="0.7") + """
[[inlets]]
shape = "ball"
material = "m"
number_rate = 100
region = { box = [[-0.03, -0.03, 0.02], [0.03, 0.03, 0.05]] }
""" + tray
    warnings = pack("full", text)
    assert "nothing takes bodies out" in warnings and "waits" in warnings, warnings
    said = run(1, "full.scene.h5", "-o", "full.run").stderr
    assert said.count("no room") == 1 and "run.json has the shortfall" in said, said
    record = outcome("full.run")
    at_end = f"inlet 'inlet 0': {record['inlets'][0]['shortfall']:.4g} of {record['inlets'][0]['owed']:.4g} bodies did not come in"
    assert said.count(at_end) == 1, (said, at_end)
    inlet = record["inlets"][0]
    assert 5 < inlet["bodies"] < 60 and inlet["times_blocked"] > 10, inlet
    assert abs(inlet["owed"] - 100 * record["time"]) < 1e-9 and inlet["shortfall"] == inlet["owed"] - inlet["bodies"] > 90, inlet
    assert record["max_depth_ratio"] < 1 and record["energy"]["error_relative"] < 0.05, record["energy"]
    assert record["lost_bodies"] == 0
    # the second part of a run knows that it was said
    shutil.copytree("full.run", "again.run")
    make_killed("again.run")
    said = run(2, "full.scene.h5", "-o", "again.run", "--restart", "latest").stderr
    assert "no room" not in said and said.count(at_end) == 1, said
    assert outcome("again.run")["inlets"] == record["inlets"] and outcome("again.run")["state_hash"] == record["state_hash"]
    pack("stop", text.replace("number_rate", 'when_full = "stop"\nnumber_rate'))
    for ranks in (1, 2):
        said = run(ranks, "stop.scene.h5", "-o", f"stop{ranks}.run", expect=5).stderr
        assert said.count("inlet 'inlet 0': no room for its next body ('ball', diameter 20 mm)") == 1 and "when_full" in said, said


def what_it_owes_comes_as_soon_as_there_is_room():
    """A gate that opens: the mass is the integral of the rate again."""
    text = head(2.0) + """
[[inlets]]
shape = "ball"
material = "m"
number_rate = 40
region = { box = [[-0.04, -0.04, 0.02], [0.04, 0.04, 0.06]] }
[[walls]]
shape = { cylinder_inside = { start = [0, 0, -1], end = [0, 0, 0.2], radius = 0.06 } }
material = "m"
[[walls]]
name = "gate"
shape = { disc = { centre = [0, 0, 0], normal = [0, 0, 1], radius = 0.1 } }
material = "m"
motion = { translate = { velocity = [0.5, 0, 0] }, start = 0.9 }
[[outlets]]
region = { box = [[-0.2, -0.2, -2], [0.2, 0.2, -0.3]] }
"""
    computed("gate", text.replace("margin = 0", 'surface = "outside"\nmargin = 3e-4').replace("1000", "20000"))
    inlet = outcome("gate.run")["inlets"][0]
    assert inlet["times_blocked"] > 3 and inlet["first_blocked"] < 0.9 and inlet["shortfall"] == 0 and inlet["bodies"] == 80, inlet


def bodies_come_in_clear_of_all_others_and_of_walls():
    """A crowded feed: bodies that came in within reach of another would bring energy that nobody counted."""
    text = head(0.3, margin="1.5e-3", stiffness="20000", every=0.05) + """
[shapes.rock]
file = "rock.shape.h5"
[[inlets]]
shapes = { ball = 1, rock = 1 }
material = "m"
size = { distribution = "uniform", min = 0.014, max = 0.02 }
number_rate = 600
region = { cylinder = { start = [0, 0, 0.005], end = [0, 0, 0.2], radius = 0.08 } }
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "m"
[[outlets]]
region = { box = [[0.1, -1, -1], [1, 1, 1]] }
"""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "20 mm, 15 mm, 12 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    computed("dense", text)
    record = outcome("dense.run")
    assert record["inlets"][0]["bodies"] > 60, record["inlets"]
    # no energy comes from overlaps: what came in brought kinetic and potential energy only
    assert record["energy"]["error_relative"] < 5e-3, record["energy"]
    assert record["max_depth_ratio"] < 0.8, record["max_depth_ratio"]


# ---- recycling

LOOP = """
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shape = "rock"
material = "m"
count = 6
region = { box = [[-0.1, -0.1, 0.46], [0, 0.1, 0.55]] }
[[inlets]]
name = "feed"
shapes = { ball = 1, rock = 1 }
material = "m"
size = { distribution = "uniform", min = 0.015, max = 0.025 }
number_rate = 60
stop = 0.3
region = { box = [[-0.1, -0.1, 0.57], [0, 0.1, 0.65]] }
velocity = [0.2, 0, 0]
angular_velocity = [3, 2, 1]
[[inlets]]
name = "second"
shape = "ball"
material = "m"
rate = { time = [0, 0.6], rate = [0, 0.3] }
region = { sphere = { centre = [0.05, 0, 0.4], radius = 0.05 } }
[[walls]]
name = "chute"
shape = { plate = { corner = [-0.12, -0.15, 0.45], side_a = [0.3, 0, -0.3], side_b = [0, 0.3, 0] } }
material = "m"
motion = [{ oscillate = { direction = [1, 0, 0], amplitude = 0.004, frequency = 12 } }, { rotate = { axis = [0, 1, 0], centre = [0, 0, 0.3], rate = 0.05 }, stop = 0.4 }]
wear = { coefficient = 1e-8, every = 0.04 }
surface = { velocity = [0.5, 0, -0.3], start = 0.15 }
[[walls]]
name = "flap"
shape = { plate = { corner = [0.11, -0.15, 0.32], side_a = [0, 0.3, 0], side_b = [0, 0, -0.06] } }
material = "m"
motion = { free = { hinge = [0, 1, 0], centre = [0.11, 0, 0.32], inertia = 6e-5, mass = 0.05, mass_centre = [0.11, 0, 0.29], torque = 0.001, swing = [-1.5, 1.5] } }
[[walls]]
name = "pusher"
shape = { plate = { corner = [-0.16, -0.15, 0.46], side_a = [0, 0.3, 0], side_b = [0, 0, 0.2] } }
material = "m"
motion = { servo = { direction = [1, 0, 0], force = 0.5, max_speed = 0.1, stroke = [0, 0.03] }, start = 0.1 }
[[outlets]]
name = "back"
to = "feed"
region = { box = [[-0.5, -0.5, -0.5], [0.9, 0, 0.1]] }
[[outlets]]
name = "out"
region = { box = [[-0.5, 0, -0.5], [0.9, 0.5, 0.1]] }
"""


def make_loop():
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "20 mm, 15 mm, 12 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    pack("loop", head(0.6, margin="2e-3", stiffness="5000", checkpoint="0.11") + LOOP)


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart_in_mid_feed():
    make_loop()
    kept = {}
    for ranks, threads in ((1, 1), (2, 2), (3, 1)):
        folder = f"r{ranks}t{threads}.run"
        run(ranks, "loop.scene.h5", "-o", folder, threads=threads)
        kept[folder] = (*(outcome(folder)[name] for name in ("state_hash", "step_limited_by", "inlets", "outlets")), physics_of_log(folder),
                        table(folder, "inserted.csv"), table(folder, "removed.csv"))
        assert kept[folder] == kept["r1t1.run"], f"{folder}: another run than on one rank"
    record = outcome("r1t1.run")
    feed, second = record["inlets"]
    assert feed["bodies"] == 18 and second["bodies"] > 3 and feed["came_in_again"] > 3, record["inlets"]
    assert record["lost_bodies"] == 0 and record["energy"]["error_relative"] < 0.02, record["energy"]
    log = [row for row in table("r1t1.run", "log.csv")]
    ways = [[float(row[name]) for row in log] for name in log[0] if name.endswith("_way")]
    assert len(ways) == 2 and all(max(way) - min(way) > 0.01 for way in ways), "flap and pusher move"
    for start, ranks in ((0, 4), (1, 1)):
        folder = f"restart{start}.run"
        shutil.copytree("r2t2.run", folder)
        make_killed(folder, keep=start + 1)
        run(ranks, "loop.scene.h5", "-o", folder, "--restart", "latest")
        found = (*(outcome(folder)[name] for name in ("state_hash", "step_limited_by", "inlets", "outlets")), physics_of_log(folder),
                 table(folder, "inserted.csv"), table(folder, "removed.csv"))
        assert found == kept["r1t1.run"], f"{folder}: another run than without a restart"
    said = run(1, "verify", "r3t1.run").stdout
    assert "the same, bit for bit" in said, said


WHEEL = """
[[walls]]
name = "wheel"
shape = { plate = { corner = [0.06, -0.06, 0.2], side_a = [0.1, 0, 0], side_b = [0, 0.12, 0] } }
material = "m"
triangle_size = 0.03
load_map = true
motion = { motor = { axis = [0, 1, 0], centre = [0.11, 0, 0.2], torque = 0.02, inertia = 2e-4, max_rate = "60 rpm" } }
[start]
run = "before.run"
"""


def make_everything():
    """A scene with all that equipment has: inlets by number and by mass, outlets with and without a way back, a belt, several motions, a servo, a part
    on a hinge, a motor, load maps, wear, impacts, and bodies from an earlier run."""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "20 mm, 15 mm, 12 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    settings = {"margin": "2e-3", "stiffness": "5000"}
    first, rest = LOOP.split("[[inlets]]", 1)
    chute = rest[rest.index("[[walls]]"):rest.index("motion =")]   # it stands still
    computed("before", head(0.03, checkpoint="0.01", **settings) + first + chute)
    rock = first[:first.index("[[populations]]")]
    text = head(0.55, checkpoint="0.11", **settings).replace("contacts = false", "contacts = true\nimpacts = true") + rock + "[[inlets]]" + rest + WHEEL
    pack("everything", text)


def all_of_it(folder):
    """What a run left, apart from times: last frame with all its groups, tables, log, hash."""
    with h5py.File(sorted(glob.glob(f"{folder}/frame_*.hdf"))[-1]) as file:
        groups = {f"{group}/{name}": file[group][name][()].tolist() for group in ("loads", "wear", "impacts", "losses", "walls") for name in file[group]}
    return (groups, physics_of_log(folder), table(folder, "inserted.csv"), table(folder, "removed.csv"),
            *(outcome(folder)[name] for name in ("state_hash", "step_limited_by", "inlets", "outlets", "wear")))


def every_feature_of_equipment_in_one_scene_is_the_same_run_on_any_ranks_and_threads_and_after_a_kill():
    make_everything()
    kept = None
    for ranks, threads in ((1, 1), (1, 2), (2, 1), (3, 1), (4, 1)):
        folder = f"r{ranks}t{threads}.run"
        run(ranks, "everything.scene.h5", "-o", folder, threads=threads, limit=800)   # four ranks on two cores wait for each other
        found = all_of_it(folder)
        kept = kept or found
        assert found == kept, f"{folder}: another run than on one rank"
    groups, record = kept[0], outcome("r1t1.run")
    log = table("r1t1.run", "log.csv")
    ways = {name: [float(row[name]) for row in log] for name in log[0] if name.endswith("_way")}
    assert len(ways) == 3 and all(max(way) - min(way) > 0.01 for way in ways.values()), "flap, pusher and wheel move"
    assert record["inlets"][0]["came_in_again"] > 3 and record["outlets"][1]["bodies"] > 0 and record["wear"][0]["volume"] > 0, record
    assert sum(groups["impacts/normal_count"]) > 50 and max(groups["loads/contacts"]) > 0 and record["lost_bodies"] == 0
    for moment, ranks in ((0, 2), (1, 1)):
        folder = f"killed{moment}.run"
        shutil.copytree("r3t1.run", folder)
        make_killed(folder, keep=moment + 1)
        run(ranks, "everything.scene.h5", "-o", folder, "--restart", "latest", limit=800)
        assert all_of_it(folder) == kept, f"{folder}: another run than without a kill"


def the_reason_of_the_step_stays_after_a_restart():
    """At the start the step follows from bodies to come; after a restart there are bodies as light."""
    computed("reason", head(0.6, checkpoint="0.2") + FEED.format(rate='number_rate = "50 /s"\n') + END)
    reason = outcome("reason.run")["step_limited_by"]
    assert "to come" in reason, reason
    make_killed("reason.run", keep=1)
    run(2, "reason.scene.h5", "-o", "reason.run", "--restart", "latest")
    assert outcome("reason.run")["step_limited_by"] == reason, outcome("reason.run")["step_limited_by"]


def what_leaves_comes_in_again_with_its_shape_size_and_id():
    make_loop()
    run(1, "loop.scene.h5", "-o", "loop.run")
    inserted, removed, record = table("loop.run", "inserted.csv"), table("loop.run", "removed.csv"), outcome("loop.run")
    back = [row for row in removed if row["outlet"] == "back"]
    assert len(back) > 3
    seen, again = {}, 0
    events = sorted([(int(r["step"]), 0, int(r["id"]), r) for r in removed] + [(int(r["step"]), 1, int(r["id"]), r) for r in inserted],
                    key=lambda e: e[:3])
    waiting = {}
    for step, comes, i, row in events:
        if not comes:
            if row["outlet"] == "back":
                waiting[i] = row
            else:
                assert i not in waiting
            seen.setdefault(i, row)
        elif i in waiting:
            assert row["inlet"] == "feed" and int(waiting[i]["step"]) < step and row["mass"] == waiting.pop(i)["mass"]
            again += 1
        else:
            assert i not in seen, f"id {i} was used before"
            seen[i] = row
    assert again == record["inlets"][0]["came_in_again"] > 3
    assert len(waiting) == record["inlets"][0]["in_transit"]


# ---- a long steady feed

def the_mean_number_is_the_rate_times_the_residence_time():
    """Little's law on a slope with friction: bodies slide, bump and pile. The mean number is exact from the tables of who came and went."""
    text = head(12.0, margin="2e-3", stiffness="3000", every=3) + """
[[inlets]]
shape = "ball"
material = "m"
number_rate = 30
region = { box = [[-0.1, -0.05, 0.26], [-0.04, 0.05, 0.32]] }
[[walls]]
shape = { plate = { corner = [-0.15, -0.1, 0.25], side_a = [0.4, 0, -0.2], side_b = [0, 0.2, 0] } }
material = "m"
[[outlets]]
region = { box = [[-1, -1, -2], [1, 1, -0.1]] }
"""
    computed("slope", text)
    inserted, removed = table("slope.run", "inserted.csv"), table("slope.run", "removed.csv")
    assert len(inserted) == 360, len(inserted)
    # from 2 s on it is steady; the mean over time, from when each came and went
    begin, end = 2.0, 12.0
    left = {row["id"]: float(row["time"]) for row in removed}
    there = [min(end, left.get(row["id"], end)) - max(begin, float(row["time"])) for row in inserted]
    present = sum(max(0.0, length) for length in there) / (end - begin)
    residence = numpy.mean([float(row["residence_time"]) for row in removed if float(row["time"]) >= 2])
    expected = 30 * residence
    assert abs(present / expected - 1) < 0.01, (present, expected)


# ---- what is refused

def mistakes_are_told_with_their_line():
    base = head(1.0) + FEED.format(rate="number_rate = 10") + END
    wrong = [
        ("inlets[0].rate", base.replace("number_rate = 10", 'rate = "3 m/s"'), 2, ["a velocity", "a mass per time", "2 kg/s"]),
        ("both", base.replace("number_rate = 10", "rate = 3\nnumber_rate = 10"), 2, ["rate", "number_rate"]),
        ("none", base.replace("number_rate = 10", ""), 2, ["rate", "number_rate"]),
        ("table", base.replace("number_rate = 10", "rate = { time = [0, 1], rate = [1] }"), 2, ["2 times and 1 rates"]),
        ("descends", base.replace("number_rate = 10", "rate = { time = [1, 0], rate = [1, 2] }"), 2, ["must ascend"]),
        ("nothing", base.replace("number_rate = 10", "rate = { time = [0], rate = [0] }"), 2, ["nothing would come in"]),
        ("stop", base.replace("number_rate = 10", "number_rate = 10\nstart = 2\nstop = 1"), 2, ["stop", "after start"]),
        ("when_full", base.replace("number_rate = 10", "number_rate = 10\nwhen_full = 'skip'"), 2, ["when_full", "wait", "stop"]),
        ("unknown", base.replace("number_rate = 10", "number_rate = 10\nspeed = 3"), 2, ["speed", "inlets"]),
        ("to", base + 'to = "fed"\n', 2, ["fed", "feed"]),
        ("same name", base + END, 2, ["end", "names must differ"]),
        ("plane", base.replace("box = [[-0.5, -0.5, -0.4], [0.5, 0.5, 0]]", "plane = 3"), 2, ["plane"]),
        ("rest", base.replace("duration = 1.0", "duration = 1.0\nstop_at_rest = true"), 2, ["stop_at_rest"]),
        ("empty", base.replace("duration = 1.0", "duration = 1.0\nstop_when_empty = true")
         + '[domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 2]\noutside = "remove"\n', 2, ["stop_when_empty"]),
        ("too small", base.replace("[0.2, 0.2, 1]", "[0.2, 0.2, 0.915]"), 3, ["holds no 'ball' of diameter 20 mm", "enlarge"]),
        ("in a wall", base + '[[walls]]\nname = "roof"\nshape = { plane = { point = [0, 0, 0.95], normal = [0, 0, -1] } }\nmaterial = "m"\n'
         .replace("0.95", "0.5"), 3, ["roof", "none of", "clear of the walls"]),
        ("outlet", base.replace("[0.5, 0.5, 0]", "[0.5, 0.5, 1]"), 2, ["outlet 'end'", "inlet 'feed'", 'to = "feed"']),
        ("no pair", base.replace("[materials.m]", "[materials.n]\ndensity = 1\n[materials.m]").replace('small = 1 }\nmaterial = "m"',
                                                                                                  'small = 1 }\nmaterial = "n"'), 2, ["n"]),
    ]
    for name, text, code, words in wrong:
        assert text != base, name
        said = pack("wrong", text, expect=code)
        line = [word for word in said.split() if word.startswith("wrong.toml")]
        assert line, f"{name}: no place in {said}"
        for word in words:
            assert word in said, f"{name}: no '{word}' in {said}"
    pack("good", base)


def the_plan_tells_what_is_to_come():
    pack("plan", head(2.0) + FEED.format(rate="number_rate = 10") + END)
    said = run(1, "plan.scene.h5", "--plan").stdout
    assert "'feed': about 20 bodies" in said and "every 32 steps" in said, said
    assert "outlet" in said and "for 20 bodies at the end" in said and "if none leaves" in said, said


main([an_outlet_takes_out_what_falls_into_it, what_comes_in_is_the_integral_of_the_rate_and_what_is_there_is_in_minus_out,
      shapes_and_sizes_follow_what_was_asked, a_limit_ends_an_inlet_to_a_body, a_blocked_inlet_waits_and_says_so_once_or_ends_the_run,
      what_it_owes_comes_as_soon_as_there_is_room, bodies_come_in_clear_of_all_others_and_of_walls,
      the_same_bits_on_any_ranks_and_threads_and_after_a_restart_in_mid_feed,
      every_feature_of_equipment_in_one_scene_is_the_same_run_on_any_ranks_and_threads_and_after_a_kill, what_leaves_comes_in_again_with_its_shape_size_and_id,
      the_reason_of_the_step_stays_after_a_restart,
      the_mean_number_is_the_rate_times_the_residence_time, mistakes_are_told_with_their_line, the_plan_tells_what_is_to_come])
