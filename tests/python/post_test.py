#!/usr/bin/env python3
"""The package and scree-post read the same: tables of bodies and contacts, choice by region, statistics, to 1e-12."""
import os
import unittest

import numpy as np
import scree
from small_run import InFolder, make

# name in the CSV of scree-post -> field and component
BODIES = {"x": ("position", 0), "y": ("position", 1), "z": ("position", 2), "vx": ("velocity", 0), "vy": ("velocity", 1), "vz": ("velocity", 2),
          "qw": ("quaternion", 0), "qx": ("quaternion", 1), "qy": ("quaternion", 2), "qz": ("quaternion", 3),
          "wx": ("angular_velocity", 0), "wy": ("angular_velocity", 1), "wz": ("angular_velocity", 2)}
CONTACTS = {"x": ("point", 0), "y": ("point", 1), "z": ("point", 2), "nx": ("normal", 0), "ny": ("normal", 1), "nz": ("normal", 2),
            "ftx": ("tangential_force", 0), "fty": ("tangential_force", 1), "ftz": ("tangential_force", 2)}
REGION = "cylinder:0,0,-1 mm,0,0,12 mm,16 mm"
# a bed that is periodic along x, with a region beyond the side
PERIODIC = {"domain.min": ["-18 mm", "-18 mm", 0], "domain.max": ["18 mm", "18 mm", "80 mm"], "domain.periodic": ["x"], "contact.relax": False,
            "walls.1.motion.translate.velocity": [0, 0, 0]}
PERIODIC_REGION = "box:12 mm,-20 mm,0,26 mm,20 mm,12 mm"


class PostTest(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runs = {"bed": (make(cls.folder, ranks=2), REGION),
                    "periodic": (make(cls.folder, changes=PERIODIC, name="periodic"), PERIODIC_REGION)}

    def compare(self, table, frames, rows_of, names, whole):
        begin = 0
        for frame in frames:
            rows = rows_of(frame)
            part = slice(begin, begin + len(rows))
            begin += len(rows)
            for name in whole:
                np.testing.assert_array_equal(table[name][part], getattr(rows, name))
            np.testing.assert_array_equal(table["time"][part], np.full(len(rows), frame.time))
            for name, (field, k) in names.items():
                values = getattr(rows, field)
                np.testing.assert_allclose(table[name][part], values if k is None else values[:, k], rtol=1e-12, atol=0, err_msg=name)
        self.assertEqual(begin, table.rows)

    def test_bodies_and_contacts_are_those_of_the_tables(self):
        for name, (run, _) in self.runs.items():
            scree.call("post", "bodies", run, output=self.path("bodies.csv"), progress=False)
            self.compare(scree.Table.read(self.path("bodies.csv")), run.frames, lambda frame: frame.bodies, BODIES, ["id"])
            scree.call("post", "contacts", run, output=self.path("contacts.csv"), progress=False)
            table = scree.Table.read(self.path("contacts.csv"))
            self.compare(table, run.frames, lambda frame: frame.contacts, {**CONTACTS, "fn": ("normal_force", None), "depth": ("overlap", None)},
                         ["body_a", "body_b", "feature"])
            self.assertGreater(table.rows, 10, name)

    def test_statistics_are_those_of_the_tool(self):
        for name, (run, region) in self.runs.items():
            for frame in (run.frames[0], run.frames[-1]):
                made = scree.statistics(run, self.path("one"), frames=frame.number, region=["part=" + region], no_charts=True, progress=False)
                for part, group in ((None, "all"), (region, "region part")):
                    numbers = frame.measures(part)
                    self.assertGreater(numbers["particle_count"], 0 if frame.number else -1)
                    for quantity, value in numbers.items():
                        try:
                            theirs = made.mean(quantity, group)
                        except scree.UnknownName:  # no value in any frame
                            theirs = float("nan")
                        scale = max(abs(theirs), 1e-3 * numbers["mean_speed"] ** 2 if quantity == "granular_temperature" else 0)
                        np.testing.assert_allclose(value, theirs, rtol=0, atol=1e-12 * scale, equal_nan=True, err_msg=f"{name} {group} {quantity}")
            self.assertGreater(frame.measures()["coordination_number"], 0.1)
            self.assertEqual(set(frame.measures(region)), set(numbers) - set())

    def test_bodies_in_a_region_are_those_that_scree_post_writes(self):
        run, region = self.runs["bed"]
        frame = run.frames[-1]
        scree.call("post", "vtk", run, output=self.path("vtk"), what="bodies", frames="last", region=region, progress=False)
        name = next(n for n in os.listdir(self.path("vtk")) if n.endswith(".vtp"))
        with open(self.path(os.path.join("vtk", name)), "rb") as file:
            count = int(file.read().partition(b'NumberOfPoints="')[2].partition(b'"')[0])
        chosen = frame.bodies.in_region(region)
        self.assertEqual(len(chosen), count)
        self.assertTrue(0 < count < len(frame.bodies))

    def test_statistics_over_all_frames(self):
        run, _ = self.runs["bed"]
        made = scree.statistics(run, no_charts=True, progress=False)
        self.assertEqual(os.fspath(made), made.folder)
        self.assertEqual(made.folder, self.path("bed.statistics"))
        self.assertEqual(run.statistics.numbers, made.numbers)
        series = made["series"]
        numbers = np.array([frame.measures()["coordination_number"] for frame in run.frames])
        # a frame counts by half of the time to its neighbours, the first and the last by as much on both sides
        gaps = np.diff(run.frames.times)
        weights = np.append(gaps[0], gaps) + np.append(gaps, gaps[-1])
        self.assertAlmostEqual(made.mean("coordination_number"), np.average(numbers, weights=weights), delta=1e-12)
        np.testing.assert_allclose(series["coordination_number"], numbers, atol=1e-8)
        self.assertGreaterEqual(made.ci95("coordination_number"), 0)
        self.assertEqual(series.units["kinetic_energy"], "J")
        self.assertIn("summary", list(made))
        self.assertIn("profile_z", repr(made))
        for call in (lambda: made["sumary"], lambda: made.mean("coordination"), lambda: made.mean("coordination_number", "none")):
            with self.assertRaises(scree.UnknownName):
                call()


if __name__ == "__main__":
    unittest.main()
