#!/usr/bin/env python3
"""What --plan says of a bed that is still to form, and of ranks that this machine lacks. usage: plan_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import math
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, main, outcome, pack, run  # noqa: E402

# 140 grains of a few sizes fall into a box without sides
BED = """
seed = 3
gravity = [0, 0, {gravity}]
[time]
duration = {duration}
[domain]
min = [0, 0, -0.1]
max = [0.05, 0.05, 0.6]
periodic = ["x", "y"]
[contact]
margin = {margin}
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = 4000
restitution = 0.4
friction = 0.4
[shapes.grain]
{shape}
[[walls]]
material = "m"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
{source}
[output]
every = {every}
"""
POPULATION = """
[[populations]]
shape = "grain"
material = "m"
count = 140
size = {{ distribution = "uniform", min = 0.008, max = 0.011 }}
region = {{ box = [[0, 0, 0.005], [0.05, 0.05, {top}]] }}
"""
INLET = """
[[inlets]]
name = "chute"
shape = "grain"
material = "m"
size = { distribution = "uniform", min = 0.008, max = 0.011 }
region = { box = [[0.005, 0.005, 0.3], [0.045, 0.045, 0.4]] }
rate = "0.1 kg/s"
"""


def bed(name, duration, shape="sphere = { radius = 0.005 }", margin=0, source=None, gravity=-9.81, stiffness=4000):
    pack(name, BED.format(duration=duration, shape=shape, margin=margin, source=source or POPULATION.format(top=0.3), every=duration / 4,
                          gravity=gravity).replace("stiffness = 4000", f"stiffness = {stiffness}"))


def plan_of(name, *words):
    return run(1, f"{name}.scene.h5", "--plan", *words).stdout


def contacts_of_sample(plan):
    found = re.search(r"a sample of (\d+) of these bodies .*; ([\d.]+) contacts a body", plan)
    assert found, plan
    return float(found[2])


def last_row(folder):
    with open(os.path.join(folder, "log.csv"), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))[-1]


def the_sample_of_a_bed_has_the_contacts_of_the_bed():
    """Balls and boxes: contacts of a body in the bed that the run makes, and in the sample that the plan settles before there is one."""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "0.01,0.009,0.008", "-o", "box.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    for name, shape, margin, long in (("balls", "sphere = { radius = 0.005 }", 0, 300), ("boxes", "file = 'box.shape.h5'", 0.0003, 300)):
        bed(f"{name}-long", long, shape, margin)
        plan = plan_of(f"{name}-long")
        assert re.search(r"wall time +about .+ \(.+ to .+\): [\d.e+]+ us a step as now, [\d.e+]+ us once 140 bodies lie in a bed", plan), plan
        assert "in a bed" in re.search(r"memory in all .*", plan)[0], plan
        bed(name, 0.6, shape, margin)
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
        contacts = int(last_row(f"{name}.run")["contacts"]) / outcome(f"{name}.run")["bodies"]
        assert 0.8 < contacts_of_sample(plan) / contacts < 1.25, (name, contacts_of_sample(plan), contacts)


def a_sample_is_made_of_what_inlets_will_bring():
    bed("fed", 300, source=INLET)
    plan = plan_of("fed")
    assert 1.5 < contacts_of_sample(plan) < 3.5, plan
    number = int(re.search(r"once (\d+) bodies lie in a bed", plan)[1])
    mean = 2500 * math.pi / 6 * (0.011**4 - 0.008**4) / (4 * 0.003)  # of balls of uniform diameter [kg]
    assert abs(number * mean / 30 - 1) < 0.01, plan  # 0.1 kg/s for 300 s


def no_sample_where_none_is_needed():
    """A short run, and one without gravity: the first steps tell the time."""
    bed("short", 0.4)
    bed("weightless", 2000, gravity=0)
    for name in ("short", "weightless"):
        assert "a sample of" not in plan_of(name), name


def a_sample_that_would_take_too_long_is_named():
    """Balls so stiff that they make millions of steps while they fall: the usual cost of a body in a bed, and why."""
    bed("stiff", 10, stiffness=4e11)
    plan = plan_of("stiff", "--ranks", "4")
    found = re.search(r"wall time +about .+ \(.+ to .+\): ([\d.e+-]+) us a step as now, ([\d.e+-]+) us once all lie in a bed, with about (\d+) contacts", plan)
    assert "while files are written in a bed" in re.search(r"memory in all .*", plan)[0], plan
    cost = re.search(r"from the usual cost of a body in a bed, ([\d.e+-]+) us a step: no sample of the bed was settled", plan)
    assert found and cost, plan
    assert 140 < int(found[3]) < 1400 and 0.05 < float(cost[1]) < 50, plan
    assert abs(float(found[2]) / (140 * float(cost[1])) - 1) < 0.01, plan
    assert re.search(r"4 ranks +about", plan), plan


def ranks_are_counted_as_the_solver_counts_them():
    """Bodies, ghosts and neighbours of a part on four ranks: what --plan --ranks 4 says, and what four ranks hold at the start."""
    bed("parts", 0.001)
    plan = plan_of("parts", "--ranks", "4")
    found = re.search(r"4 ranks +about .+ on 4 cores of this kind: ([\d.e+]+) us a step, efficiency ([\d.]+)", plan)
    counts = re.search(r"parts of (\d+) bodies \(at most (\d+)\), (\d+) ghosts and (\d+) neighbours at most", plan)
    assert found and counts, plan
    assert 0 < float(found[2]) <= 1, plan
    run(4, "parts.scene.h5", "-o", "parts.run")
    with open("parts.run/ranks.csv", encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["step"] == "0"]
    bodies, ghosts = [int(row["bodies"]) for row in rows], [int(row["ghosts"]) for row in rows]
    assert len(rows) == 4 and sum(bodies) == 140
    assert int(counts[1]) == 35 and abs(int(counts[2]) - max(bodies)) <= 3, (plan, bodies)
    assert 0.5 * max(ghosts) <= int(counts[3]) <= 1.5 * max(ghosts), (plan, ghosts)
    assert int(counts[4]) == max(int(row["neighbours"]) for row in rows), (plan, rows)
    many = plan_of("parts", "--ranks", "2,4,1000")
    assert "1000 ranks    more than the 140 bodies" in many, many
    each = [re.search(rf"\n  {ranks} ranks +about .*; about ([\d.]+) MB for each\n", many) for ranks in (2, 4)]
    assert all(each) and 20 < float(each[1][1]) <= float(each[0][1]), many


def memory_is_what_the_run_takes():
    """20 000 balls that do not touch, with frames: the most that the process held."""
    balls = POPULATION.format(top=3).replace("count = 140", 'count = 20000\nmethod = "lattice"').replace("min = 0.008, max = 0.011", "min = 0.0036, max = 0.004")
    pack("cloud", BED.format(duration=1e-3, shape="sphere = { radius = 0.005 }", margin=0, source=balls, every=5e-4, gravity=0).replace("0.6]", "4]"))
    found = re.search(r"memory in all +([\d.]+) MB now, about ([\d.]+) MB while files are written\n", plan_of("cloud"))
    assert found
    run(1, "cloud.scene.h5", "-o", "cloud.run")
    taken = outcome("cloud.run")["peak_rss_bytes"] / 1e6
    assert 0.8 < float(found[2]) / taken < 1.25, (found[0], taken)


def ranks_without_a_plan_are_refused():
    bed("parts", 0.001)
    for ranks, words, says in ((1, ["--ranks", "4"], "expected with --plan on one rank; to run on 4 ranks: mpirun -n 4"),
                               (2, ["--plan", "--ranks", "4"], "expected with --plan on one rank"),
                               (1, ["--plan", "--ranks", "0"], "--ranks"), (1, ["--plan", "--ranks", "many"], "--ranks")):
        told = run(ranks, "parts.scene.h5", *words, expect=2)
        assert says in told.stderr, told.stderr


main([the_sample_of_a_bed_has_the_contacts_of_the_bed, a_sample_is_made_of_what_inlets_will_bring, no_sample_where_none_is_needed, a_sample_that_would_take_too_long_is_named,
      ranks_are_counted_as_the_solver_counts_them, memory_is_what_the_run_takes, ranks_without_a_plan_are_refused])
