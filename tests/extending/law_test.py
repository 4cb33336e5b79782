#!/usr/bin/env python3
"""A law that pulls, added as docs/develop/extending.md says (constant_pull.hpp). usage: law_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from mpi_environment import mpi_environment  # noqa: E402

BIN, MPIEXEC = os.path.abspath(sys.argv[1]), sys.argv[2]
ENV = mpi_environment(OMP_NUM_THREADS="1")
FORCE, REACH = 0.1, 1e-4  # of constant_pull.hpp
RADIUS, DENSITY, STIFFNESS = 0.01, 2500, 1e3
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
APART = 0.1  # distance of pairs that have nothing to do with each other [m]


def tool(name):
    """The tool that was built beside the others with the law, or the one of a tree that has the law."""
    with_law = os.path.join(BIN, f"{name}-with-a-law")
    return with_law if os.path.exists(with_law) else os.path.join(BIN, name)


def call(*words):
    done = subprocess.run([str(w) for w in words], env=ENV, capture_output=True, text=True)
    assert done.returncode == 0, f"{words} ends with {done.returncode}: {done.stderr[-2000:]}"


def pairs_of_balls(gaps, speeds):
    """Two balls for each gap, one above the other, approaching with that speed each."""
    bodies = []
    for n, (gap, speed) in enumerate(zip(gaps, speeds)):
        for side in (-1, 1):
            bodies.append((n * APART, 0, side * (RADIUS + 0.5 * gap), -side * speed))
    return bodies


def solve(name, bodies, duration, step=None, every=None, restitution=1, friction=0, ranks=1, more="", gravity=(0, 0, 0), body=""):
    text = f"""title = "a law that pulls"
gravity = {list(gravity)!r}
time = {{ duration = {duration!r}{f', step = {step!r}' if step else ''} }}
contact = {{ law = "constant-pull", relax = false, margin = 0 }}
shapes.ball.sphere.radius = {RADIUS}
materials.stone.density = {DENSITY}
[output]
every = {every or duration!r}
[[pairs]]
between = ["stone", "stone"]
stiffness = {STIFFNESS}
restitution = {restitution}
friction = {friction}
{more}"""
    for x, y, z, v in bodies:
        text += f'[[bodies]]\nshape = "ball"\nmaterial = "stone"\nposition = {[x, y, z]}\nvelocity = [0, 0, {v!r}]\n{body}'
    with open(name + ".toml", "w") as file:
        file.write(text)
    call(tool("scree-decomposer"), "pack", name + ".toml", "-o", name + ".scene.h5")
    start = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    call(*start, tool("scree-solver"), name + ".scene.h5", "-o", name + ".run")
    with open(name + ".run/run.json") as file:
        run = json.load(file)
    with open(name + ".run/log.csv") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return run, rows, [frame(f"{name}.run/{f}") for f in sorted(os.listdir(name + ".run")) if f.endswith(".hdf")]


def frame(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.__setitem__(name.split("/")[-2] + "/" + name.split("/")[-1], item[()])
                        if isinstance(item, h5py.Dataset) and "/" in name else None)
    return found


def it_attracts_within_its_reach_and_is_counted():
    run, rows, frames = solve("still", pairs_of_balls([0.5 * REACH, 1.5 * REACH], [0, 0]), duration=0.02, every=0.001)
    assert [int(r["contacts"]) for r in rows[:2]] == [1, 1], "the pair within reach is a contact, the other is none"
    contacts = frames[0]
    assert abs(contacts["contacts/normal_force"][0] + FORCE) < 1e-12, contacts["contacts/normal_force"]
    overlap = contacts[[k for k in contacts if k in ("contacts/depth", "contacts/overlap")][0]][0]
    assert abs(overlap + 0.5 * REACH) < 1e-9, overlap
    elastic = [float(r["elastic"]) for r in rows]
    assert abs(elastic[0] + 0.5 * FORCE * REACH) < 1e-9 * FORCE * REACH, "the energy of a pair half a reach apart"
    assert min(elastic) < elastic[0] - 0.25 * FORCE * REACH, "they come together"
    # from rest within the reach they cannot leave it
    assert all(int(r["contacts"]) == 1 for r in rows)
    # the well is passed once and again: its energy is kept
    scale = FORCE * REACH
    assert max(abs(float(r["energy_error"])) for r in rows) < 0.05 * scale, [r["energy_error"] for r in rows]


def energy_is_kept_to_first_order():
    """The force jumps where the law begins to act: the energy of a passage is wrong by up to half of F0 v dt, by the phase of the step."""
    count = 64
    numbers = random.Random(1)
    gaps = [REACH * numbers.uniform(1.2, 1.6) for _ in range(count)]
    speeds = [numbers.uniform(0.015, 0.03) for _ in range(count)]  # so that the phases of coming and going are of all kinds
    errors = []
    for level in range(3):
        step = 5e-5 / 2**level
        run, rows, frames = solve(f"passage{level}", pairs_of_balls(gaps, speeds), duration=0.04, step=step)
        velocity = [v for k, v in frames[-1].items() if k.lower().endswith("/velocity") and len(v) == 2 * count][0]
        ends = [sum(v @ v for v in velocity[2 * n:2 * n + 2]) / (2 * speeds[n]**2) for n in range(count)]
        assert rows[-1]["contacts"] == "0", "all of them have parted"
        errors.append(math.sqrt(sum((e - 1) ** 2 for e in ends) / count))
    ratios = [errors[k] / errors[k + 1] for k in range(2)]
    print("root mean square of the relative error of the energy:", errors, "ratios", ratios)
    # a mean over 64 phases is good to a tenth
    assert all(1.6 < r < 2.5 for r in ratios), (errors, ratios)


def the_step_is_derived_and_bounded():
    run, rows, _ = solve("derived", pairs_of_balls([0.2 * REACH], [0]), duration=0.01, every=0.0005)
    # half a period of the reduced mass over the default number of steps
    expected = math.pi / math.sqrt(STIFFNESS * 2 / MASS) / 30
    assert abs(run["step_size"] / expected - 1) < 1e-9, (run["step_size"], expected)
    # a constant pull has no stiffness: only the push bounds the step
    steps = [float(r["critical_step"]) for r in rows]
    assert steps[0] == math.inf and abs(min(steps) / (2 / math.sqrt(STIFFNESS * 2 / MASS)) - 1) < 1e-6, steps


def the_same_bits_on_two_ranks():
    bodies = pairs_of_balls([0.3 * REACH, 0.6 * REACH, 1.1 * REACH, 0.1 * REACH], [0.01] * 4)
    hashes = [solve(f"ranks{n}", bodies, duration=0.03, restitution=0.5, friction=0.4, ranks=n)[0]["state_hash"] for n in (1, 2)]
    assert hashes[0] == hashes[1], hashes
    touching = [((2 * RADIUS + 0.1 * REACH) * n, 0, 0, 0) for n in range(4)]  # a chain that is cut between two of its balls
    hashes = [solve(f"chain{n}", touching, duration=0.03, restitution=0.5, friction=0.4, ranks=n)[0]["state_hash"] for n in (1, 2)]
    assert hashes[0] == hashes[1], hashes


def friction_goes_with_the_push():
    """A ball that does not turn hangs under a ceiling by its attraction alone: k D = F0 - m g pushes, and holds or slides by mu times that."""
    ceiling = """[[walls]]
name = "ceiling"
material = "stone"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, -1] } }
"""
    weight, friction, duration = 0.3 * FORCE, 0.5, 0.5
    limit = friction * (FORCE - weight)
    for side in (0.7 * limit, 1.3 * limit):  # both are above friction times the net force
        gravity = (side / MASS, 0, -weight / MASS)
        _, rows, frames = solve(f"hanging{round(10 * side / limit)}", [(0, 0, -RADIUS - 0.1 * REACH, 0)], duration=duration, every=0.05, restitution=0.2,
                                friction=friction, gravity=gravity, more=ceiling, body="lock_rotation = true\n")
        assert int(rows[-1]["contacts"]) == 1, "it hangs"
        force = frames[-1]["contacts/normal_force"][0]
        assert abs(force / -weight - 1) < 1e-3, (force, weight)
        speed = [v for k, v in frames[-1].items() if k.lower().endswith("/velocity") and len(v) == 1][0][0][0]
        expected = max(0, side - limit) / MASS * duration
        assert abs(speed - expected) < 0.03 * limit / MASS * duration, (side / limit, speed, expected)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for test in sys.argv[3:]:
            globals()[test]()
