#!/usr/bin/env python3
"""The examples of the package run, and do what they say."""
import glob
import os
import re
import subprocess
import sys
import unittest

import scree
from measure_test import BALL
from small_run import CASE, InFolder, make, write_box

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python", "examples")


class ExamplesTest(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_ = make(cls.folder)

    def example(self, name, *words):
        result = subprocess.run([sys.executable, os.path.join(EXAMPLES, name), *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def test_own_statistic(self):
        output = self.example("own_statistic.py", "bed.run")
        self.assertEqual(scree.Table.read(self.path("bed.layers.csv")).rows, 5)
        self.assertIn(f"coordination number {scree.open(self.path('bed.run')).statistics.mean('coordination_number'):.3f} +- ", output)
        self.assertIn("load on plate: [", output)

    def test_own_plot(self):
        self.example("own_plot.py", "bed.run", "bed.png")
        with open(self.path("bed.png"), "rb") as file:
            self.assertEqual(file.read(4), b"\x89PNG")

    def test_own_packing(self):
        output = self.example("own_packing.py", self.folder)
        run = scree.open(self.path("bricks.run"))
        self.assertEqual(len(run.bodies()), 17)
        self.assertIn("17 bodies, 5 frames; completed", output)
        self.assertGreater(run.bodies().velocity[:-1, 1].max(), 0.05)  # hit

    def test_the_whole_way(self):
        write_box(self.path("rock.stl"), 8)
        output = self.example("whole_way.py", "rock.stl", "mm", self.path("way"))
        self.assertTrue(os.path.exists(self.path("way/heap.report.html")))
        self.assertIn("12 bodies, ", output)

    def test_sweep(self):
        with open(self.path("sweep.toml"), "w", encoding="utf-8") as file:
            file.write(CASE.replace('"60 ms"', '"30 ms"'))
        words = ("sweep.toml", "out", "pairs.*.friction=0.1,0.5")
        self.example("sweep.py", *words)
        table = scree.Table.read(self.path("out/sweep.csv"))
        self.assertEqual(table["pairs.*.friction"].tolist(), [0.1, 0.5])
        self.assertNotEqual(*table["kinetic_energy"])
        before = os.path.getmtime(self.path("out/pairs.all.friction=0.1.run/run.json"))
        self.example("sweep.py", *words)  # nothing is repeated
        self.assertEqual(os.path.getmtime(self.path("out/pairs.all.friction=0.1.run/run.json")), before)
        self.assertEqual(scree.Case(self.path("out/pairs.all.friction=0.5.toml"))["shapes.rock.file"], "../rock.shape.h5")

    def test_exchange(self):
        output = self.example("exchange.py", "bed.run", self.path("other"))
        self.assertIn("24 spheres went out and came back: places differ by 0 m", output)
        again = scree.open(self.path("other/again.run"))
        self.assertEqual(len(again.bodies()), 24)
        for name in ("bed.h5md", "bed.data", "bed.dump", "bed.txt", "bed.vtp"):
            self.assertGreater(os.path.getsize(self.path(os.path.join("other", name))), 1000)

    def test_engines(self):
        os.makedirs(self.path("engines"), exist_ok=True)
        self.assertIn("contacts a ball", self.example("own_force.py", self.path("engines")))  # each compares itself with a closed form
        self.assertEqual(len(self.example("own_controller.py", self.path("engines")).splitlines()), 4)
        self.assertEqual(len(self.example("two_engines.py", self.path("engines")).splitlines()), 10)

    def test_measure(self):
        with open(self.path("ball.toml"), "w", encoding="utf-8") as file:
            file.write(BALL)
        output = self.example("measure.py", "ball.toml", "centre_of_mass_z", "1 %", "5 min")
        self.assertRegex(output, r"centre_of_mass_z = 0\.00[0-9]+ .*\(stiffness\) m")
        self.assertIn("margin (no body has a margin", output)

    def test_the_page(self):
        with open(os.path.join(EXAMPLES, "..", "README.md"), encoding="utf-8") as file:
            blocks = re.findall(r"^```python\n(.*?)^```", file.read(), flags=re.S | re.M)
        self.assertGreater(len(blocks), 3)
        result = subprocess.run([sys.executable, "-c", "\n".join(blocks)], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("rock", result.stdout)

    def test_all_examples_are_here(self):
        with open(os.path.abspath(__file__), encoding="utf-8") as file:
            text = file.read()
        for path in glob.glob(os.path.join(EXAMPLES, "*.py")):
            self.assertIn(f'self.example("{os.path.basename(path)}"', text)


if __name__ == "__main__":
    unittest.main()
