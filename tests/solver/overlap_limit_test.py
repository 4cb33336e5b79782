#!/usr/bin/env python3
"""contact.on_overlap as a user meets it: a body between a wall that moves and another. usage: overlap_limit_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import json
import os
import shutil
import subprocess
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, column, main, make_killed, outcome, pack, physics_of_log, run  # noqa: E402

WAY = 0.008   # of the press [m]: the cubes are pressed up to twelve times as deep as they have room for, the balls have room
STIFFNESS = 5000.0

CASE = """
seed = 7
[time]
duration = 0.2
[contact]
margin = "0.3 mm"
{contact}
[materials.m]
density = 2000
[[pairs]]
between = ["m", "m"]
stiffness = {stiffness}
restitution = 0.5
friction = 0.3
[shapes.cube]
file = "cube.shape.h5"
[shapes.ball]
sphere = {{ radius = "5 mm" }}
[[walls]]
name = "floor"
shape = {floor}
material = "m"
[[walls]]
name = "press"
shape = {press}
material = "m"
{motion}
[output]
every = "10 ms"
checkpoint = "25 ms"
"""
MOTION = 'motion = {{ oscillate = {{ direction = [0, 0, 1], amplitude = {amplitude}, frequency = "5 Hz", phase = "90 deg" }} }}'
PLANES = {"floor": "{ plane = { point = [0, 0, 0], normal = [0, 0, 1] } }",
          "press": '{ plane = { point = [0, 0, "10.5 mm"], normal = [0, 0, -1] } }'}
PLATES = {"floor": '{ plate = { corner = ["-5 cm", "-5 cm", 0], side_a = ["10 cm", 0, 0], side_b = [0, "10 cm", 0] } }',
          "press": '{ plate = { corner = ["-5 cm", "-5 cm", "10.5 mm"], side_a = ["10 cm", 0, 0], side_b = [0, "10 cm", 0] } }'}


def case(contact='on_overlap = "continue"', walls=PLATES, way=WAY, motion=MOTION):
    """Cubes and balls side by side, each with half a millimetre to spare."""
    if not os.path.exists("cube.shape.h5"):
        subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "10mm,10mm,10mm", "-o", "cube.shape.h5"], env=ENV, check=True,
                       capture_output=True)
    text = CASE.format(contact=contact, stiffness=STIFFNESS, motion=motion.format(amplitude=way / 2), **walls)
    for i in range(6):
        text += f'[[bodies]]\nshape = "{"cube" if i % 2 else "ball"}"\nmaterial = "m"\nposition = ["{-25 + 10.0 * i} mm", 0, "5.1 mm"]\n'
    return text


def computed(name, text, ranks=1, **options):
    pack(name, text)
    return run(ranks, f"{name}.scene.h5", "-o", f"{name}.run", **options)


def report(folder):
    subprocess.run([os.path.join(BIN, "scree-post"), "report", folder, "-o", "report.html", "--json", "report.json"], env=ENV, check=True,
                   capture_output=True)
    with open("report.json", encoding="utf-8") as file:
        return json.load(file)


# ---- tests

def a_run_ends_with_the_names_of_both_walls_and_the_gap_unless_it_is_to_continue():
    said = computed("stopped", case(contact=""), expect=5).stderr
    assert "squeezed between wall 'press', which moves, and wall 'floor': they are " in said, said
    assert 'contact.on_overlap = "continue"' in said, said
    assert "deep_contacts" not in outcome("stopped.run")
    assert computed("named", case(contact='on_overlap = "stop"'), expect=5).stderr.count("squeezed between")
    said = computed("went_on", case()).stderr
    done = outcome("went_on.run")
    assert done["outcome"] == "completed" and done["exit_code"] == 0
    assert said.count("so far ") == 1 and "went deeper than the law has room for" in said, said


def what_is_counted_is_what_was_pressed():
    """Six bodies, each between two walls: half of the way less the half millimetre for each wall."""
    for name, walls in (("planes", PLANES), ("plates", PLATES)):
        computed(name, case(walls=walls))
        deep = outcome(f"{name}.run")["deep_contacts"]
        overlap = (WAY - 0.0005) / 2
        assert deep["contacts"] == 6, (name, deep)
        assert abs(deep["deepest"]["overlap"] - overlap) < 0.02 * overlap, (name, deep)
        room = (deep["deepest"]["overlap"] - deep["deepest"]["excess"]) / 0.97   # two margins of the cube at a plane, one at triangles
        assert 5 < overlap / room < 15, (name, room)
        assert deep["deepest"]["wall"] in ("press", "floor"), deep
        assert abs(deep["deepest"]["time"] - 0.1) < 0.01 and 0.01 < deep["first"] < 0.05 and 0.15 < deep["last"] < 0.19, deep
        steps, now = column(f"{name}.run", "deep_contact_steps"), column(f"{name}.run", "deep_contacts")
        assert now.max() == 6 and now[-1] == 0 and (numpy.diff(steps) >= 0).all() and steps[-1] == deep["contact_steps"], (now, steps)
        # force on the press, whose id follows those of six bodies and the floor, at its lowest: three balls and three cubes, whose four corners share a potential
        pressed = column(f"{name}.run", "wall7_force_z")
        expected = 3 * STIFFNESS * (1 + 2**0.5) * overlap
        assert abs(pressed.max() - expected) < 0.02 * expected, (name, pressed.max(), expected)
        error, elastic = column(f"{name}.run", "energy_error"), column(f"{name}.run", "elastic")
        assert abs(error).max() < 1e-3 * elastic.max() and elastic[-1] < 1e-3 * elastic.max(), (name, abs(error).max(), elastic.max(), elastic[-1])


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart():
    computed("base", case())
    log = physics_of_log("base.run")
    for ranks, threads in ((3, 1), (1, 2)):
        run(ranks, "base.scene.h5", "-o", f"base_{ranks}_{threads}.run", threads=threads)
        assert physics_of_log(f"base_{ranks}_{threads}.run") == log, (ranks, threads)
    kept = outcome("base.run")["deep_contacts"]
    for ranks in (1, 2):
        shutil.copytree("base.run", f"killed_{ranks}.run")
        make_killed(f"killed_{ranks}.run")
        run(ranks, "base.scene.h5", "-o", f"killed_{ranks}.run", "--restart", "latest")
        assert physics_of_log(f"killed_{ranks}.run") == log, ranks
        assert outcome(f"killed_{ranks}.run")["deep_contacts"] == kept, ranks


def nothing_differs_before_the_first():
    """A press that leaves the bodies some room: the same state after every row, with and without the word."""
    for name, contact in (("stop", ""), ("continue", 'on_overlap = "continue"')):
        computed(name, case(contact=contact, way=0.0007))
    assert column("continue.run", "max_depth_ratio").max() > 0.2
    hashes = []
    for name in ("stop", "continue"):
        with open(f"{name}.run/log.csv", encoding="utf-8") as file:
            rows = [line.strip().split(",") for line in file if not line.startswith("#")]
        hashes.append([row[rows[0].index("state_hash")] for row in rows])
    assert hashes[0] == hashes[1]
    assert outcome("continue.run")["deep_contacts"] == {"contacts": 0, "contact_steps": 0}


def the_report_doubts_it_and_says_where():
    computed("deep", case())
    verdicts = {v["question"]: v for v in report("deep.run")["verdicts"]}
    overlap = verdicts["Contact overlap"]
    assert overlap["judgement"] == "doubtful", overlap
    assert "deeper than the law has room for" in overlap["answer"] and "'press'" in overlap["evidence"] or "'floor'" in overlap["evidence"], overlap
    os.remove("deep.run/run.json")  # as of a run that was killed
    overlap = {v["question"]: v for v in report("deep.run")["verdicts"]}["Contact overlap"]
    assert overlap["judgement"] == "doubtful" and "contact-steps so far" in overlap["evidence"], overlap
    computed("shallow", case(way=0.0007))
    assert {v["question"]: v for v in report("shallow.run")["verdicts"]}["Contact overlap"]["judgement"] == "good"


def the_plan_tells_which():
    for contact, expected in (("", 'on_overlap = "stop": they end the run'), ('on_overlap = "continue"', "on along the tangent of the law")):
        pack("plan", case(contact=contact))
        said = run(1, "plan.scene.h5", "--plan").stdout
        assert expected in said, said


def mistakes_are_told_with_their_line():
    still = ""
    for contact, motion, expected in (
            ('on_overlap = "go"', MOTION, 'plan.toml:7: contact.on_overlap = "go"'),
            ('on_overlp = "continue"', MOTION, "did you mean 'on_overlap'"),
            ('on_overlap = "continue"', still, "no wall of this case moves"),
            ('on_overlap = "continue"\ngather = "pairs"', MOTION, 'goes with gather = "potential" only'),
            ('on_overlap = "continue"\nbarrier = 1\nsurface = "outside"', MOTION, "does not go with a barrier")):
        said = pack("plan", case(contact=contact, motion=motion), expect=2)
        assert expected in said, said


main([a_run_ends_with_the_names_of_both_walls_and_the_gap_unless_it_is_to_continue, what_is_counted_is_what_was_pressed,
      the_same_bits_on_any_ranks_and_threads_and_after_a_restart, nothing_differs_before_the_first, the_report_doubts_it_and_says_where,
      the_plan_tells_which, mistakes_are_told_with_their_line])
