"""A small run for the tests of the package: rocks and balls of two materials, a fixed ball, a box, and a plate that moves."""
import os
import tempfile
import unittest

import scree

CASE = """\
# rocks and balls fall into a box
title = "a small bed"   # for plots
seed = 3

[time]
duration = "60 ms"
steps_per_contact = 12

[shapes.rock]
file = "rock.shape.h5"
[shapes.ball]
sphere = { radius = "4 mm" }

# one soft, one hard
[materials.chalk]
density = 1500
[materials.steel]
density = "7.8 g/cm^3"

[[pairs]]
between = ["chalk", "chalk"]
stiffness = "2 kN/m"
restitution = 0.3
friction = 0.4          # as measured
[[pairs]]
between = ["chalk", "steel"]
stiffness = "2 kN/m"
restitution = 0.5
friction = 0.2
[[pairs]]
between = ["steel", "steel"]
stiffness = "2 kN/m"
restitution = 0.7
friction = 0.1

[contact]
margin = "0.4 mm"

[[bodies]]
shape = "ball"
material = "steel"
position = [0, 0, "4.8 mm"]
fixed = true

[[populations]]
shapes = { rock = 0.7, ball = 0.3 }
material = "chalk"
count = 24
region = { box = [["-17 mm", "-17 mm", "10 mm"], ["17 mm", "17 mm", "46 mm"]] }
velocity = [0, 0, "-0.5 m/s"]

[[walls]]
name = "box"
shape = { box_inside = [["-18 mm", "-18 mm", 0], ["18 mm", "18 mm", "80 mm"]] }
material = "steel"
[[walls]]
name = "plate"
shape = { plate = { corner = ["-10 mm", "-10 mm", "70 mm"], side_a = ["20 mm", 0, 0], side_b = [0, "20 mm", 0] } }
material = "steel"
motion = { translate = { velocity = [0, 0, "-50 mm/s"] } }

[output]
every = "20 ms"
"""


def make(folder, ranks=1, changes=None, name="bed"):
    """Packs and solves the case in a folder; returns the run."""
    rock = os.path.join(folder, "rock.shape.h5")
    if not os.path.exists(rock):
        scree.generate("rock", rock, diameter="8 mm", triangles=60, seed=1, progress=False)
    case = os.path.join(folder, "bed.toml")
    with open(case, "w", encoding="utf-8") as file:
        file.write(CASE)
    scene = scree.pack(case, os.path.join(folder, f"{name}.scene.h5"), set=changes, progress=False)
    return scree.solve(scene, ranks=ranks, threads=1, progress=False)


def write_box(path, side):
    """An STL of a cube."""
    corners = [(x, y, z) for x in (0, side) for y in (0, side) for z in (0, side)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("solid box\n")
        for triangle in (t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))):
            vertices = "".join("vertex {} {} {}\n".format(*corners[k]) for k in triangle)
            file.write(f"facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
        file.write("endsolid box\n")


class InFolder(unittest.TestCase):
    """Tests in one empty folder per class."""

    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory(prefix="scree-python-")
        cls.folder = cls._folder.name

    @classmethod
    def tearDownClass(cls):
        cls._folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder, name)
