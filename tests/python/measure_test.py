#!/usr/bin/env python3
"""A number of a case with its errors: a closed form by real runs, and calls that cannot work."""
import math
import os
import subprocess
import sys
import unittest

import scree
from small_run import InFolder

BALL = """\
gravity = [0, 0, -9.81]
[time]
duration = "0.3 s"
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.steel]
density = 7800
[[pairs]]
between = ["steel", "steel"]
stiffness = "2 kN/m"
restitution = 0.1
[[bodies]]
shape = "ball"
material = "steel"
position = [0, 0, "5.0 mm"]
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "steel"
[output]
every = "0.1 s"
"""


def depth(run):
    """Overlap of the ball and the plane at the end."""
    return 5e-3 - float(scree.open(run).frames[-1].bodies.position[0, 2]), "m"


class MeasureTest(InFolder):
    def test_measure_refuses_what_it_cannot_do(self):
        def inner(run):
            return 1.0

        for quantity in (inner, lambda run: 1.0, len):
            with self.assertRaisesRegex(scree.UsageError, "function that a file defines at its top"):
                scree.measure("boulders", quantity)
        with self.assertRaisesRegex(scree.UsageError, "needs output=FOLDER"):
            scree.measure(scree.Case(), "mass")
        with self.assertRaisesRegex(scree.UsageError, "no case 'nope'"):
            scree.measure("nope", "mass")
        with self.assertRaisesRegex(scree.UsageError, "--budget: 'soon' found; expected a time"):
            scree.measure("boulders", "mass", budget="soon")

    def test_a_program_that_measures_as_it_is_loaded_is_refused(self):
        """Its function is loaded by the workflow: without a guard that would measure again, and so on without end."""
        scree.Case.from_text(BALL).save(self.path("ball.toml"))
        with open(self.path("own.py"), "w", encoding="utf-8") as file:
            file.write("import scree\n\ndef depth(run):\n    return 1.0, 'm'\n\nscree.measure('ball.toml', depth, seeds=2, output='out', progress=False)\n")
        result = subprocess.run([sys.executable, "own.py"], cwd=self.path("."), capture_output=True, text=True, timeout=100)
        self.assertEqual(result.returncode, 1)
        self.assertIn('UsageError: measure: ', result.stderr)
        self.assertIn('put the call of measure below: if __name__ == "__main__":', result.stderr.splitlines()[-1])
        self.assertLess(result.stderr.count("UsageError"), 4)

    def test_measure_gives_a_ball_on_a_spring_its_step(self):
        """A ball that is pressed by gravity on a spring k rests at m g / k below touch, whatever the step; a spring of 2 k holds it half as deep."""
        case = scree.Case.from_text(BALL)
        measured = scree.measure(case, depth, goal="1e-9 m", output=self.path("ball"), seeds=2, progress=False)
        weight = 7800 * 4 / 3 * math.pi * 5e-3**3 * 9.81
        self.assertIsInstance(measured, scree.Measurement)
        self.assertAlmostEqual(measured.value / (weight / 2000), 1, places=4)
        self.assertAlmostEqual(measured.effects["stiffness"] / (weight / 4000), 1, places=3)
        self.assertLess(abs(measured.effects["step"]), 1e-3 * measured.value)
        self.assertEqual((measured.seeds, measured.half_width, measured.half_widths["stiffness"], measured.unit, measured.goal), (1, 0, 0, "m", 1e-9))
        self.assertEqual(sorted(measured.missing), ["margin", "shape"])
        self.assertAlmostEqual(measured.total_error, abs(sum(measured.effects.values())))
        self.assertEqual((measured.reached, measured.seeds_for_goal), (False, None))
        self.assertIn("(stiffness)", str(measured))
        self.assertEqual(measured.text, str(measured))
        self.assertTrue(measured.name.endswith("measure_test.py:depth"))
        self.assertTrue(os.path.exists(os.path.join(measured.folder, "error.png")))


if __name__ == "__main__":
    unittest.main()
