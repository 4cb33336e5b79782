#!/usr/bin/env python3
"""Bodies that come in, leave, and fall out of their vessel: post and the package count those that are there, in all frames.

usage: come_and_go_test.py BIN FOLDER [--pictures]
"""
import csv
import os
import shutil
import sys
import unittest

import numpy as np
import scree

HEAD = """\
[time]
duration = "{duration}"
{time}
[shapes.ball]
sphere = {{ radius = "5 mm" }}
[shapes.cube]
file = "cube.shape.h5"
[materials.a]
density = 2500
[materials.b]
density = 2500
[contact]
impact_speed = "1 m/s"
"""
PAIR = """[[pairs]]
between = ["{}", "{}"]
stiffness = "20 kN/m"
restitution = 0.3
friction = 0.3
"""
INLET = """[[inlets]]
name = "{name}"
shape = "{shape}"
material = "{material}"
number_rate = "{rate} Hz"
region = {{ box = {box} }}
"""


def head(duration, time=""):
    return HEAD.format(duration=duration, time=time) + "".join(PAIR.format(*p) for p in ("aa", "ab", "bb"))


def made(name, case, **options):
    """Packs and solves a case; returns the run."""
    with open(f"{name}.toml", "w", encoding="utf-8") as file:
        file.write(case)
    scene = scree.pack(f"{name}.toml", f"{name}.scene.h5", progress=False)
    return scree.solve(scene, ranks=1, threads=1, progress=False, **options)


def statistics(run, folder, *words):
    """Runs the statistics; returns the rows of all by column, the summary of all, and what was said."""
    done = scree.call("post", "statistics", run.folder, "-o", folder, "--no-charts", "--jobs", "1", *words)
    with open(f"{folder}/series.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["group"] == "all"]
    with open(f"{folder}/summary.csv", encoding="utf-8") as file:
        summary = {(row["group"], row["quantity"]): float(row["mean"]) for row in csv.DictReader(file) if row["mean"]}
    return rows, summary, done.output


def lacey(position, ones):
    """Lacey's index by the definition of post/STATISTICS.md."""
    n, low, extent = len(position), position.min(axis=0), np.ptp(position, axis=0)
    side = np.cbrt(np.prod(extent) * 12 / n)
    _, cell = np.unique(((position - low) / side).astype(int), axis=0, return_inverse=True)
    count, sum_ = np.bincount(cell.ravel()), np.bincount(cell.ravel(), weights=ones)
    p = ones.mean()
    variance, apart = (count * (sum_ / count - p) ** 2).sum() / n, p * (1 - p)
    return (apart - variance) / (apart - apart * len(count) / n)


class BodiesThatComeIn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scree.generate("cube", "cube.shape.h5", size="8 mm", progress=False)
        # open above: its walls are a mesh
        box = '[[walls]]\nname = "box"\nmaterial = "a"\nshape = { box = { corners = [[-0.03, -0.03, 1], [0.03, 0.03, 1.2]], open = ["+z"] } }\n'
        inlets = (INLET.format(name="left", shape="ball", material="a", rate=400, box="[[-0.029, -0.029, 1.1], [0, 0.029, 1.15]]")
                  + INLET.format(name="right", shape="cube", material="b", rate=400, box="[[0, -0.029, 1.1], [0.029, 0.029, 1.15]]"))
        cls.run_ = made("inlets", head("0.24 s") + box + inlets + '[output]\nevery = "40 ms"\n')

    def test_the_mixing_index_counts_all_that_came_in(self):
        rows, _, _ = statistics(self.run_, "mixing", "--mixing", "material")
        bodies = self.run_.frames[-1].bodies
        self.assertGreater(len(bodies), 60)
        self.assertAlmostEqual(float(rows[-1]["mixing_index"]), lacey(bodies.position, (bodies.material == 0).astype(float)), 6)

    def test_a_first_frame_without_bodies_does_not_make_the_container(self):
        self.assertEqual(len(self.run_.frames[0].bodies), 0)
        rows, _, _ = statistics(self.run_, "all")
        given, _, _ = statistics(self.run_, "given", "--container", "box:-0.03,-0.03,1,0.03,0.03,1.2")
        for quantity in ("kinetic_pressure", "solid_fraction_of_container"):
            # bodies touch the walls to some millimetres of 60
            self.assertAlmostEqual(float(rows[-1][quantity]) / float(given[-1][quantity]), 1, delta=0.25, msg=quantity)
        with open("all/profile_z.csv", encoding="utf-8") as file:
            places = [float(row["z"]) for row in csv.DictReader(file) if not row["z"].startswith("#")]
        self.assertGreater(min(places), 0.99)  # the bed stands at 1 m

    def test_bodies_are_left_out_and_set_apart_by_names_of_what_came_in(self):
        def count(*words):
            return float(statistics(self.run_, "count", "--frames", "last", *words)[0][-1]["particle_count"])

        bodies = self.run_.frames[-1].bodies
        for words in (("--without", "cube"), ("--without", "b"), ("--apparatus", "cube")):
            self.assertEqual(count(*words), len(bodies.of_shape("ball")), words)
        self.assertEqual(count(), len(bodies))

    @unittest.skipUnless("--pictures" in sys.argv, "no VTK")
    def test_a_film_and_a_picture_show_the_box_though_the_first_frame_is_empty(self):
        scree.call("post", "picture", self.run_.folder, "-o", "at.png", "--at", "0", "0", "1.1", "--size", "320", "240")
        self.assertGreater(share_drawn("at.png"), 0.1)


class BodiesThatLeave(unittest.TestCase):
    def test_discharged_is_what_was_removed_and_rates_stand_for_their_time(self):
        domain = '[domain]\nmin = [-0.1, -0.1, -0.1]\nmax = [0.1, 0.1, 0.4]\noutside = "remove"\n'
        inlet = INLET.format(name="top", shape="ball", material="a", rate=200, box="[[-0.05, -0.05, 0.15], [0.05, 0.05, 0.2]]")
        run = made("through", head("0.6 s", "step = 3.3e-5") + domain + inlet + '[output]\nevery = "0.1 s"\n')
        rows, summary, _ = statistics(run, "through")
        self.assertLess(run.frames.times[-1] - run.frames.times[-2], 0.01)  # the last is one too many
        removed = run.removed
        for row in rows:
            gone = removed["mass"][removed["time"] <= float(row["time"])].sum()
            self.assertAlmostEqual(float(row["discharged_mass"]), gone, 9)
        total = removed["mass"].sum()
        self.assertAlmostEqual(summary["all", "discharge_rate"], total / run.frames.times[-1], delta=1e-6 * total)
        self.assertAlmostEqual(summary["all", "discharge_rate"], summary["sides of the domain", "mass_flow"], delta=1e-6 * total)

    def test_runs_that_lose_different_bodies_are_not_the_same(self):
        case = ("gravity = [0, 0, 0]\n" + head("0.1 s") + '[domain]\nmin = [-0.1, -0.1, -0.1]\nmax = [0.1, 0.1, 0.1]\noutside = "remove"\n'
                + '[[bodies]]\nshape = "ball"\nmaterial = "a"\nposition = [0.05, 0, 0]\nvelocity = [RIGHT, 0, 0]\n'
                + '[[bodies]]\nshape = "ball"\nmaterial = "a"\nposition = [-0.05, 0, 0]\nvelocity = [LEFT, 0, 0]\n[output]\nevery = "0.1 s"\n')
        a, b = (made(name, case.replace("RIGHT", right).replace("LEFT", left)) for name, right, left in (("a", "5", "0"), ("b", "0", "-5")))
        text = scree.call("post", "compare", a.folder, b.folder, "-o", "ab").output
        self.assertNotIn("bit by bit", text)
        self.assertIn("removed.csv", text)
        shutil.copytree(a.folder, "copy.run")
        self.assertIn("bit by bit", scree.call("post", "compare", a.folder, "copy.run", "-o", "aa").output)


class BodiesThatFallOut(unittest.TestCase):
    """A trough of plates; two bodies are thrown over its side and fall."""

    @classmethod
    def setUpClass(cls):
        scree.generate("cube", "cube.shape.h5", size="8 mm", progress=False)
        population = """[[populations]]
shape = "ball"
material = "{}"
count = 40
region = {{ box = [[{}, -0.028, 0.002], [{}, 0.028, 0.09]] }}
"""
        thrown = '[[bodies]]\nshape = "ball"\nmaterial = "a"\nposition = [{}, 0, 0.12]\nvelocity = [{}, 0, 1]\n'
        case = (head("0.8 s") + population.format("a", -0.028, 0) + population.format("b", 0, 0.028) + thrown.format(-0.02, -2) + thrown.format(0.02, 2)
                + '[[walls]]\nname = "trough"\nmaterial = "a"\n'
                'shape = { box = { corners = [[-0.03, -0.03, 0], [0.03, 0.03, 0.1]], open = ["+z"] } }\n'
                + '[output]\nevery = "0.2 s"\n')
        cls.run_ = made("trough", case)

    def test_what_has_left_counts_in_no_statistic_unless_it_is_asked_for(self):
        bodies = self.run_.frames[-1].bodies
        inside = bodies.within("trough")
        self.assertEqual((len(bodies), len(inside)), (82, 80))
        index = lacey(inside.position, (inside.material == 0).astype(float))
        for words in ((), ("--within", "trough"), ("--within", "box:-0.03,-0.03,0,0.03,0.03,1")):
            rows, _, _ = statistics(self.run_, "trough", "--mixing", "material", *words)
            self.assertEqual(float(rows[-1]["particle_count"]), 80, words)
            self.assertAlmostEqual(float(rows[-1]["mixing_index"]), index, 6, words)
        rows, _, _ = statistics(self.run_, "trough", "--mixing", "material", "--within", "all")
        self.assertEqual(float(rows[-1]["particle_count"]), 82)
        self.assertGreater(float(rows[-1]["mixing_index"]), index + 0.2)
        with self.assertRaisesRegex(scree.UsageError, "trough"):
            scree.call("post", "statistics", self.run_.folder, "-o", "no", "--within", "through")

    @unittest.skipUnless("--pictures" in sys.argv, "no VTK")
    def test_a_picture_frames_the_trough(self):
        for words, least, most in (((), 0.15, 1), (("--within", "all"), 0, 0.05)):
            scree.call("post", "picture", self.run_.folder, "-o", "trough.png", "--size", "320", "240", *words)
            self.assertGreater(share_drawn("trough.png"), least, words)
            self.assertLess(share_drawn("trough.png"), most, words)


class WornWall(unittest.TestCase):
    def test_the_package_gives_the_wall_as_it_is_worn(self):
        scree.generate("box", "slab.shape.h5", size="10 cm, 10 cm, 1 cm", edge_length="2 cm", progress=False)
        case = (head("0.1 s") + '[[populations]]\nshape = "ball"\nmaterial = "a"\ncount = 20\nvelocity = [0.5, 0, 0]\n'
                'region = { box = [[-0.09, -0.09, 0.01], [0.09, 0.09, 0.04]] }\n'
                '[[walls]]\nmaterial = "a"\nname = "slab"\nshape = { file = "slab.shape.h5" }\nscale = 2\nposition = [0, 0, -0.01]\n'
                'wear = { coefficient = 1e-2, every = "0.01 s" }\n[output]\nevery = "0.05 s"\n')
        scree.generate("cube", "cube.shape.h5", size="8 mm", progress=False)
        run = made("worn", case)
        heights = [frame.wall_mesh("slab").vertices[:, 2] for frame in (run.frames[0], run.frames[-1])]
        top = heights[0] > -1e-9
        self.assertLess(heights[1][top].min(), -1e-5)
        self.assertLessEqual(heights[1][top].max(), 1e-9)
        with scree_frame(run.frames[-1]) as file:
            worn = file["wear/vertex"][()]
        mesh = run.frames[-1].wall_mesh("slab")
        np.testing.assert_allclose(mesh.vertices, run.frames[-1].walls.position[0] + 2 * worn, atol=1e-12)  # it does not turn


def scree_frame(frame):
    import h5py

    return h5py.File(frame.path, "r")


def share_drawn(path):
    """Share of the pixels of a picture that are not white."""
    from matplotlib.image import imread

    return float((imread(path)[..., :3].min(axis=2) < 0.97).mean())


if __name__ == "__main__":
    os.environ["SCREE_BIN"] = os.path.abspath(sys.argv[1])
    shutil.rmtree(sys.argv[2], ignore_errors=True)
    os.makedirs(sys.argv[2])
    os.chdir(sys.argv[2])
    unittest.main(argv=sys.argv[:1])
