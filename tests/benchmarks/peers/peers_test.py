"""Tests of the comparison that need no peer: peers_test.py NAME BIN WORK."""
import math
import os
import random
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True
import scene
import sphere_codes
import summary


def close(a, b, tolerance=1e-12):
    return abs(a - b) <= tolerance * max(1.0, abs(a), abs(b))


def the_summary_gives_ratios_and_the_worst_error_of_the_rounds():
    def row(program, number, cpu, depth):
        return {"family": "rock-80", "state": "rest", "program": program, "round": number, "bodies": 100, "steps": 10, "step": 1e-3,
                "cpu": cpu, "depth_share": depth, "intersecting_pairs": 0, "energy_change": -0.5, "kinetic_share": 0.1}
    rows = [row("Scree", 0, 1.0, 0.0), row("Other", 0, 4.0, 0.01), row("Scree", 1, 2.0, 0.0), row("Other", 1, 10.0, 0.03), row("Scree", 2, 1.0, 0.0),
            row("Other", 2, 5.0, 0.02)]
    own, other = summary.summarise(rows)
    assert own["median"] == 1000 and own["best"] == 1000 and other["median"] == 200 and other["best"] == 250
    assert other["ratio"] == 5 and other["least_ratio"] == 4  # 1000 / 250 in round 0
    assert other["depth_share"] == 0.03 and other["seconds_per_second"] == 500
    text = summary.table([own, other])
    assert "5.0 (4.0)" in text and "3.0e-02" in text and len(text.splitlines()) == 4, text


def a_missing_error_is_shown_as_missing():
    record, = summary.summarise([{"family": "spheres", "state": "rest", "program": "Other", "round": 0, "bodies": 10, "steps": 10, "step": 1e-3, "cpu": 1.0}])
    assert record["intersecting_pairs"] is None and " - |" in summary.table([record])


def the_lattice_keeps_bodies_apart_and_in_the_box():
    state, length = scene.lattice(50, 0.013)
    assert len(state) == 50 and {row[0] for row in state} == set(range(scene.SHAPE_COUNT))
    for i, a in enumerate(state):
        assert close(sum(x * x for x in a[4:8]), 1)
        assert all(0.013 < x < length - 0.013 for x in a[1:3]) and a[3] > 0.013
        for b in state[:i]:
            assert math.dist(a[1:4], b[1:4]) > 2 * 0.013 + 2 * scene.MARGIN
    assert scene.lattice(50, 0.013)[0] == state, "the same numbers every time"


def the_dashpot_gives_the_restitution_that_is_asked():
    mass, stiffness = 0.5, 100.0
    damping = sphere_codes.dashpot(stiffness, mass, 0.3)
    x, v, dt = 0.0, 1.0, 1e-5
    while x >= 0:  # until the spring is at its length again
        v -= (stiffness * x + damping * v) / mass * dt
        x += v * dt
    assert close(-v, 0.3, 1e-3), v


def a_body_of_lammps_is_read_back_as_it_was_written():
    numbers = random.Random(3)
    inertia = [[2e-7, 3e-7, 4e-7]] * scene.SHAPE_COUNT
    body = [2, 0.1, 0.2, 0.3] + scene.random_quaternion(numbers) + [1.0, 2.0, 3.0, 40.0, 50.0, 60.0]
    own_axes = scene.random_quaternion(numbers)  # whatever axes LAMMPS chooses
    turn = scene.rotation_matrix(body[4:8])
    local = [sum(turn[j][i] * body[11 + j] for j in range(3)) * inertia[2][i] for i in range(3)]
    momentum = [sum(turn[i][j] * local[j] for j in range(3)) * 1e4 / sphere_codes.MASS for i in range(3)]
    row = [1] + [100 * x for x in body[1:4]] + [100 * v for v in body[8:11]]
    read = sphere_codes.body_of_dump(row + own_axes + momentum, row + own_axes + momentum, body, inertia)
    assert all(close(a, b, 1e-9) for a, b in zip(read, body)), (read, body)
    half_turn = [0.0, 0.0, 0.0, 1.0]
    turned = sphere_codes.body_of_dump(row + sphere_codes.multiply(half_turn, own_axes) + momentum, row + own_axes + momentum, body, inertia)
    assert all(close(a, b, 1e-9) for a, b in zip(turned[4:8], sphere_codes.multiply(half_turn, body[4:8])))


def two_spheres_are_judged_by_their_overlap():
    r = scene.RADIUS
    row = lambda number, x, owner: [number, x, 0.5, 0.5, 0.0, 0.0, 2.0, owner, r]
    rows = [row(1, 0.5, 1), row(2, 0.5 + 1.9 * r, 2)]
    verdict = sphere_codes.judge_spheres(rows, 1.0, 3.0)
    assert close(verdict["depth_share"], 0.1, 1e-9) and close(verdict["kinetic_share"], 0.5 * 4 / (scene.GRAVITY * r), 1e-9)
    together = sphere_codes.judge_spheres([row(1, 0.5, 1), row(2, 0.5 + 1.9 * r, 1)], 1.0, 3.0, owner=-2)
    assert together["depth_share"] == 0.0, "spheres of one clump may overlap"


def one_command_runs_scree_through_the_scene_and_judges_it():
    out = WORK / "quick"
    done = subprocess.run([HERE / "run", "scenes", "--quick", "--family", "convex-20", "--program", "Scree", "--out", out, "--bin", BIN],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if line.startswith("| convex-20")]
    assert len(rows) == 2 and all("| Scree |" in row and "0.0e+00 | 0 |" in row for row in rows), done.stdout
    assert (out / "scenes.csv").read_text().count("\n") == 3
    rest = scene.read_state(out / "convex-20" / "bed-20" / "rest.state")
    assert len(rest) == 20 and max(abs(v) for row in rest for v in row[8:11]) < 0.5


def a_wrong_word_is_refused():
    done = subprocess.run([HERE / "run", "everything", "--bin", BIN], capture_output=True, text=True)
    assert done.returncode == 2 and "triangles" in done.stderr, done.stderr


if __name__ == "__main__":
    name, BIN, WORK = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"
    WORK.mkdir(parents=True, exist_ok=True)
    globals()[name]()
