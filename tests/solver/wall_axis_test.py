#!/usr/bin/env python3
"""Torque and power of walls about their own axes, and walls by their names, also after [start]. usage: wall_axis_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import json
import math
import os
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python"))
import scree  # noqa: E402
from tool_runs import BIN, ENV, column, main, outcome, pack, run  # noqa: E402

G, RADIUS, DENSITY = 9.81, 0.01, 2500
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
FAR = 2e4   # [m] from the world's origin: more than a thousand extents, so that the solver computes about another origin

HEAD = """
gravity = [0, 0, -9.81]
[time]
duration = "%s"
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = "100 kN/m"
restitution = 0.3
friction = 0.5
[output]
every = "20 ms"
[shapes.ball]
sphere = { radius = "10 mm" }
"""


def plate(name, x, motion, z=0.0):
    return f"""
[[walls]]
name = "{name}"
material = "m"
shape = {{ box = {{ corners = [[{x - 0.1!r}, -0.1, {z - 0.02!r}], [{x + 0.1!r}, 0.1, {z!r}]] }} }}
{motion}
"""


def ball(x, z):
    return f'[[bodies]]\nshape = "ball"\nmaterial = "m"\nposition = [{x!r}, 0, {z!r}]\n'


def the_torque_of_a_ball_at_rest_is_its_weight_times_its_arm_and_power_is_torque_times_rate():
    # turns so slowly that the ball rests: 1e-6 rad/s lifts it by 3e-8 m/s
    rate, arm = 1e-6, 0.03
    turning = f"motion = {{ rotate = {{ axis = [0, 1, 0], centre = [{FAR!r}, 0.5, 2], rate = {rate!r} }} }}"
    surface = f"surface = {{ rate = {rate!r}, axis = [0, 2, 0], centre = [{FAR + 1!r}, 0, 3] }}"
    # an axis that is carried along: after 0.3 s at 0.1 m/s the plate and its axis are 3 cm further, the arm is so much shorter
    both = ("motion = [{ rotate = { axis = [0, 1, 0], centre = [%r, 0, 1], rate = 1e-6 } },\n"
            "  { translate = { velocity = [0.1, 0, 0] }, start = 0.1, stop = 0.2 }]" % (FAR + 2))
    pack("axis", HEAD % "0.3 s" + plate("turns", FAR, turning) + plate("surface", FAR + 1, surface) + plate("both", FAR + 2, both) + plate("still", FAR + 3, "")
         + "".join(ball(FAR + k + arm, 0.01) for k in range(4)))
    run(1, "axis.scene.h5", "-o", "axis.run")
    log = scree.Run("axis.run").log
    weight = MASS * G * arm   # (r x F)_y = -x Fz, of a force that points down
    for name in ("turns", "surface"):
        # at rest the last rows scatter by what is left of the first contact: 1e-6 of the weight
        assert abs(log[f"axis_torque@{name}"][-1] / weight - 1) < 1e-4, (name, log[f"axis_torque@{name}"][-1], weight)
        about_origin = log[f"torque_y@{name}"][-1]
        assert abs(about_origin) > 1e4 * weight, "about the world's origin the torque is another one"
    assert "axis_torque@still" not in list(log) and not any(name.startswith("wall7_axis") for name in log)
    # friction carries the ball with the plate or lets it slide: the arm is where the ball is
    frames = scree.Run("axis.run").frames
    moved = frames[-1].bodies.position[frames[-1].bodies.id == 2][0, 0] - (FAR + 2 + 0.1 * 0.1)
    assert abs(moved - arm) > 1e-3
    force, friction = log["force_z@both"][-1], log["force_x@both"][-1]
    expected = (0 - 1) * friction - moved * force   # (r x F)_y = rz Fx - rx Fz, from the axis, 1 m above the plate
    # the place in a frame has 1e-12 of 2e4 m, and the force that of half a step before: 1e-5 of them
    assert abs(log["axis_torque@both"][-1] - expected) < 1e-4 * weight + 1e-4 * abs(friction), (log["axis_torque@both"][-1], expected)
    assert "walls" in outcome("axis.run") and [w["name"] for w in outcome("axis.run")["walls"]] == ["turns", "surface", "both", "still"]


DRUM = """
[[walls]]
name = "drum"
material = "m"
shape = { drum = { start = [0.3, 0, 0.2], end = [0.3, 0.1, 0.2], radius = "5 cm", lifters = { count = 4, height = "8 mm", width = "6 mm" } } }
motion = { rotate = { axis = [0, 1, 0], centre = [0.3, 0, 0.2], rate = "60 rpm" } }
"""
FILLED = DRUM + """
[[populations]]
shapes = { ball = 1 }
material = "m"
count = 12
size = "12 mm"
region = { box = [[0.28, 0.02, 0.18], [0.33, 0.08, 0.22]] }
"""


def power_is_minus_torque_times_rate_and_walls_have_names_after_a_start():
    pack("drum", HEAD % "0.25 s" + FILLED)   # a quarter of a turn: four lifters stand as they did
    run(1, "drum.scene.h5", "-o", "drum.run")
    pack("more", HEAD % "0.2 s" + '[start]\nrun = "drum.run"\n' + '[[walls]]\nname = "floor"\nmaterial = "m"\nshape = { plane = { point = [0, 0, -1], normal = [0, 0, 1] } }\n'
         + DRUM.replace("60 rpm", "90 rpm"))
    run(1, "more.scene.h5", "-o", "more.run")
    rate = {"drum": 60 * 2 * math.pi / 60, "more": 90 * 2 * math.pi / 60}
    ids = {}
    for name in rate:
        log = scree.Run(f"{name}.run").log
        ids[name] = [w["wall"] for w in outcome(f"{name}.run")["walls"] if w["name"] == "drum"][0]
        torque, power = log["axis_torque@drum"], log["power@drum"]
        assert numpy.array_equal(torque, column(f"{name}.run", f"wall{ids[name]}_axis_torque"))
        assert torque.min() < -1e-4, "the drum lifts: what it carries turns it back"
        # two sums of the same forces, about the origin and about the axis: rounding of the larger one
        scale = rate[name] * (abs(log["torque_y@drum"]) + 0.5 * (abs(log["force_x@drum"]) + abs(log["force_z@drum"]))).max()
        assert abs(power + rate[name] * torque).max() < 1e-12 * scale, (name, power, torque)
    # the work is summed step by step. With a row for each step the power of all rows is the work to 1e-12; with a row of nine steps, as here,
    # to 3 %, and of 180 steps to 30 %: most of it is impacts
    pack("fine", (HEAD % "0.25 s").replace('every = "20 ms"', 'every = "1 ms"') + FILLED)
    run(1, "fine.scene.h5", "-o", "fine.run")
    log = scree.Run("fine.run").log
    work, by_rows = log["wall_work"][-1], (0.5 * (log["power@drum"][1:] + log["power@drum"][:-1]) * numpy.diff(log["time"])).sum()
    assert abs(by_rows / work - 1) < 0.1, (by_rows, work)
    assert ids["more"] != ids["drum"], "after a start a wall has another id"

    # statistics, report and sweep call it by its name
    subprocess.run([os.path.join(BIN, "scree-post"), "statistics", "more.run", "-o", "more.statistics"], check=True, env=ENV, capture_output=True)
    subprocess.run([os.path.join(BIN, "scree-post"), "report", "more.run", "-o", "more.html"], check=True, env=ENV, capture_output=True)
    walls = scree.Run("more.run").statistics["walls"]
    frames = scree.Run("more.run").frames
    mine = walls["name"] == "drum"
    assert mine.sum() == len(frames) and set(walls["name"]) == {"drum", "floor"}
    for torque, frame in zip(walls["axis_torque"][mine], frames):
        row = frame.walls.row("drum")
        about = frame.walls.torque[row] - numpy.cross([0.3, 0, 0.2], frame.walls.force[row])
        assert abs(torque - about[1]) < 1e-6 * abs(about[1]) + 1e-9, (torque, about)   # nine digits in the table
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "workflows"))
    from sweep_quantity import entry_of, statistics_of
    assert abs(entry_of("axis_torque@drum", "more", statistics_of("more"))["mean"] - walls["axis_torque"][mine][1:].mean()) < 0.5
    with open("more.html", encoding="utf-8") as file:
        page = file.read()
    assert "Torque on walls that turn" in page and "axis_torque" in page and "<td>drum</td>" in page
    assert f"wall {ids['more']}" not in page and f">{ids['more']} drum<" not in page, "a wall by its number only"
    with open("more.statistics/statistics.json", encoding="utf-8") as file:
        assert json.load(file)["walls"][f"{ids['more']} drum"]["axis_torque"]["unit"] == "N m"


main([the_torque_of_a_ball_at_rest_is_its_weight_times_its_arm_and_power_is_torque_times_rate,
      power_is_minus_torque_times_rate_and_walls_have_names_after_a_start])
