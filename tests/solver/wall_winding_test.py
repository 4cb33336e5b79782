#!/usr/bin/env python3
"""Bodies meet walls on both sides, whatever the winding of their triangles. usage: wall_winding_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import math
import os
import random
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, main, outcome, run  # noqa: E402

HEAD = """
gravity = [0, 0, -9.81]
[time]
duration = 0.06
[shapes.ball]
sphere = { radius = "8 mm" }
[shapes.cube]
file = "cube.shape.h5"
[shapes.rock]
file = "rock.shape.h5"
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = "100 kN/m"
restitution = 0.5
friction = 0.3
[contact]
margin_ratio = 0.1
impact_speed = "1 m/s"
[output]
every = "10 ms"
"""


def roof():
    x, y, z = 0.06, 0.06, -0.03
    return [(-x, -y, z), (0, -y, 0), (x, -y, z), (-x, y, z), (0, y, 0), (x, y, z)], [(0, 1, 3), (1, 4, 3), (1, 2, 4), (2, 5, 4)]


def grid(rows, columns, at, closed=False):
    """Triangles over points at(row, column); closed: the last column joins the first one."""
    width = columns if closed else columns + 1
    triangles = []
    for i in range(rows):
        for j in range(columns):
            a, b, c, d = (r * width + s % width for r, s in ((i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)))
            triangles += [(a, b, d), (a, d, c)]
    return [at(i, j) for i in range(rows + 1) for j in range(width)], triangles


def height_field():
    draw = random.Random(4)
    return grid(8, 8, lambda i, j: (0.12 * i / 8 - 0.06, 0.12 * j / 8 - 0.06, draw.uniform(-0.004, 0)))


def around(radius, j, count, z):
    return radius * math.cos(2 * math.pi * j / count), radius * math.sin(2 * math.pi * j / count), z


def funnel():
    rings = [(0.008, -0.05), (0.012, -0.04), (0.06, 0.0)]
    return grid(2, 24, lambda i, j: around(rings[i][0], j, 24, rings[i][1]), closed=True)


def shaft():
    """Along y, met from outside."""
    rings = [(0.0, -0.06), (0.02, -0.06), (0.02, 0.06), (0.0, 0.06)]
    points, triangles = grid(3, 24, lambda i, j: around(rings[i][0], j, 24, rings[i][1]), closed=True)
    return [(x, z, y - 0.02) for x, y, z in points], [t for t in triangles if len({points[k] for k in t}) == 3]


def v_blender():
    """Two open tubes of eight sides that lean towards each other."""
    points, triangles = [], []
    for side in (-1, 1):
        lean = side * math.radians(40)
        tube, own = grid(1, 8, lambda i, j: around(0.03, j, 8, 0.08 * i), closed=True)
        first = len(points)
        for x, y, z in tube:
            points.append((side * 0.025 + x * math.cos(lean) + z * math.sin(lean), y, z * math.cos(lean) - x * math.sin(lean) - 0.06))
        triangles += [tuple(first + k for k in t) for t in own]
    return points, triangles


WALLS = {"roof": roof, "field": height_field, "funnel": funnel, "shaft": shaft, "blender": v_blender}


def tool(name, *arguments):
    result = subprocess.run([os.path.join(BIN, f"scree-{name}"), *arguments], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    return result.stderr


def folder_of(winding):
    draw, text = random.Random(7), HEAD
    for n, (name, make) in enumerate(WALLS.items()):
        points, triangles = make()
        with open(f"{name}.obj", "w") as file:
            file.writelines("v %.9g %.9g %.9g\n" % p for p in points)
            for a, b, c in triangles:
                turned = winding == "down" or (winding == "mixed" and draw.random() < 0.4)
                file.write("f %d %d %d\n" % ((a + 1, c + 1, b + 1) if turned else (a + 1, b + 1, c + 1)))
        tool("mesher", "import", f"{name}.obj", "--unit", "m", "--surface", "-o", f"{name}.shape.h5")
        text += f'[[walls]]\nname = "{name}"\nshape = {{ file = "{name}.shape.h5" }}\nmaterial = "m"\nposition = [{0.3 * n}, 0, 0]\n'
        for k, shape in enumerate(("ball", "cube", "rock")):
            y = 0.035 * (k - 1)
            x = {"blender": 0.0, "funnel": 0.01 * (k - 1)}.get(name, 0.001 * (k + 1))
            z = {"funnel": 0.012, "blender": 0.03 if k != 1 else 0.01}.get(name, 0.015)
            text += (f'[[bodies]]\nshape = "{shape}"\nmaterial = "m"\nposition = [{0.3 * n + x}, {y}, {z}]\n'
                     f'orientation = {[math.cos(0.2 + 0.3 * k), math.sin(0.2 + 0.3 * k), 0, 0]}\nvelocity = [0, 0, -0.6]\n')
    with open(f"{winding}.toml", "w") as file:
        file.write(text)
    tool("decomposer", "pack", f"{winding}.toml", "-o", f"{winding}.scene.h5")
    run(1, f"{winding}.scene.h5", "-o", f"{winding}.run")
    return f"{winding}.run"


def places(folder):
    with h5py.File(os.path.join(folder, sorted(n for n in os.listdir(folder) if n.startswith("frame_"))[-1])) as frame:
        data = frame["VTKHDF/PointData"]
        order = data["id"][:].argsort()
        return frame["VTKHDF/Points"][:][order], data["velocity"][:][order]


def the_same_run_with_normals_up_down_and_mixed():
    tool("mesher", "generate", "box", "--size", "14 mm, 12 mm, 10 mm", "-o", "cube.shape.h5")
    tool("mesher", "generate", "rock", "--diameter", "15 mm", "--triangles", "80", "--seed", "3", "-o", "rock.shape.h5")
    up, v = places(folder_of("up"))
    fall = -0.6 - 9.81 * 0.06   # of what meets nothing [m/s]
    assert (v[:, 2] > fall + 0.1).sum() >= 12, v   # nearly all have met their wall
    for winding in ("down", "mixed"):
        folder = folder_of(winding)
        x, _ = places(folder)
        # one bounce or two, of which each makes a rounding some tens of times larger
        assert numpy.abs(x - up).max() < 1e-10, (winding, numpy.abs(x - up).max(axis=1))
        assert outcome(folder)["energy"]["error_relative"] < 0.01, outcome(folder)["energy"]


main([the_same_run_with_normals_up_down_and_mixed])
