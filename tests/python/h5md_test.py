#!/usr/bin/env python3
"""Frames as H5MD: by the specification, by MDAnalysis, and against the package's own reading of the frames."""
import os
import subprocess
import sys
import unittest
import warnings

warnings.filterwarnings("ignore", category=DeprecationWarning)  # of MDAnalysis, when it is imported
import h5py
import numpy as np
import scree
from small_run import InFolder, make

# balls come in from above and leave at the sides: other bodies, and another number of them, in every frame
FLOW = {"domain.min": ["-18 mm", "-18 mm", "-1 mm"], "domain.max": ["18 mm", "18 mm", "50 mm"], "domain.outside": "remove", "domain.periodic": ["y"],
        "contact.relax": False, "walls.1.motion.translate.velocity": [0, 0, 0],
        "populations.0.velocity": ["1 m/s", 0, 0], "walls.0.shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "output.every": "5 ms",
        "inlets": [{"shape": "ball", "material": "chalk", "number_rate": "200 /s", "velocity": [0, 0, "-1 m/s"],
                    "region": {"box": [["-10 mm", "-10 mm", "34 mm"], ["10 mm", "10 mm", "44 mm"]]}}]}
ELEMENTS = {"position": "position", "velocity": "velocity", "angular_velocity": "angular_velocity", "orientation": "quaternion", "species": "shape",
            "material": "material", "scale": "scale"}


class H5mdTest(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.runs = {"bed": make(cls.folder, ranks=2), "flow": make(cls.folder, changes=FLOW, name="flow")}

    def test_the_runs_are_what_they_are_for(self):
        bed, flow = self.runs["bed"].frames, self.runs["flow"].frames
        self.assertEqual(len({len(frame.bodies) for frame in bed}), 1)
        counts = [len(frame.bodies) for frame in flow]
        self.assertGreater(len(set(counts)), 3)
        ids = [set(frame.bodies.id) for frame in flow]
        self.assertTrue(any(ids[0] - some for some in ids) and any(some - ids[0] for some in ids), counts)

    def test_every_number_of_every_frame_is_there(self):
        for name, run in self.runs.items():
            for copy in (False, True):
                scree.write_h5md(run, self.path("all.h5md"), copy=copy)
                with h5py.File(self.path("all.h5md")) as file:
                    group = file["particles/trajectory"]
                    self.assertEqual(group["position/value"].is_virtual, not copy)
                    for row, frame in enumerate(run.frames):
                        ids = group["id"][()] if isinstance(group["id"], h5py.Dataset) else group["id/value"][row]
                        there = ids != -1
                        np.testing.assert_array_equal(np.sort(ids[there]), frame.bodies.id, err_msg=name)
                        order = np.flatnonzero(there)[np.argsort(ids[there])]
                        for element, field in ELEMENTS.items():
                            found = group[element][()] if isinstance(group[element], h5py.Dataset) else group[f"{element}/value"][row]
                            np.testing.assert_array_equal(found[order], getattr(frame.bodies, field), err_msg=f"{name} {element}")
                        self.assertTrue(np.isnan(group["position/value"][row][~there]).all())
                        self.assertEqual((group["position/step"][row], group["position/time"][row]), (frame.step, frame.time))
                        self.assertEqual(file["observables/elastic_energy/value"][row], frame.elastic)

    def test_it_is_as_the_specification_says(self):
        for name, run in self.runs.items():
            for copy in (False, True):
                scree.write_h5md(run, self.path("form.h5md"), copy=copy)
                with h5py.File(self.path("form.h5md")) as file:
                    self.assertEqual(file["h5md"].attrs["version"].tolist(), [1, 1])
                    for text in (file["h5md/author"].attrs.get_id("name"), file["h5md/creator"].attrs.get_id("name"), file["h5md/creator"].attrs.get_id("version")):
                        self.assertFalse(text.get_type().is_variable_str())  # fixed length, scalar
                        self.assertEqual(text.shape, ())
                    group = file["particles/trajectory"]
                    box = group["box"].attrs
                    self.assertEqual((box["dimension"], box["boundary"].tolist()), (3, [b"none", b"periodic" if name == "flow" else b"none", b"none"]))
                    self.assertEqual("edges" in group["box"], name == "flow")
                    if name == "flow":
                        np.testing.assert_allclose(group["box/edges/value"][0], np.diag([0.036, 0.036, 0.051]))
                        self.assertEqual(file["parameters/domain/min"][2], -0.001)
                    position = group["position"]
                    self.assertTrue(np.all(np.diff(position["step"]) > 0))
                    elements = []
                    file.visititems(lambda path, item: elements.append(path) if isinstance(item, h5py.Group) and "value" in item else None)
                    self.assertGreater(len(elements), 7)
                    for group_name, item in file["particles/trajectory"].items():
                        if isinstance(item, h5py.Group) and group_name != "box":
                            elements.append(item.name)
                    for path in elements:
                        self.assertEqual(file[path]["step"], position["step"], path)  # hard links
                        self.assertEqual(file[path]["time"], position["time"], path)
                        self.assertEqual(len(file[path]["value"]), len(position["step"]), path)
                    self.assertEqual([position["value"].attrs["unit"], position["time"].attrs["unit"], group["velocity/value"].attrs["unit"]], ["m", "s", "m s-1"])
                    self.assertEqual(file["h5md/modules/units"].attrs["system"], "SI")
                    if isinstance(group["id"], h5py.Group):
                        self.assertEqual(group["id/value"].fillvalue, -1)
                    self.assertEqual([text.decode() for text in file["parameters/shapes/name"]], [shape.name for shape in run.shapes.in_order])
                    self.assertEqual(file["parameters/materials/density"][1], run.materials["steel"].density)

    def test_nothing_is_stored_twice(self):
        run = self.runs["flow"]
        scree.write_h5md(run, self.path("small.h5md"))
        with h5py.File(self.path("small.h5md")) as file:
            for element in (*ELEMENTS, "id"):
                data = file[f"particles/trajectory/{element}/value"]
                self.assertEqual(len(data.virtual_sources()), sum(len(frame.bodies) > 0 for frame in run.frames))
                self.assertEqual(data.id.get_storage_size(), 0)

    def test_it_moves_with_the_run(self):
        os.makedirs(self.path("one"))
        os.symlink(self.runs["bed"].folder, self.path("one/bed.run"))
        scree.write_h5md(self.path("one/bed.run"), self.path("one/bed.h5md"))
        os.rename(self.path("one"), self.path("two"))
        script = f"import h5py; print(h5py.File({self.path('two/bed.h5md')!r})['particles/trajectory/id/value'][2].tolist())"
        found = subprocess.run([sys.executable, "-c", script], cwd="/", capture_output=True, text=True, check=True).stdout
        self.assertEqual(sorted(eval(found)), self.runs["bed"].frames[2].bodies.id.tolist())

    def test_mdanalysis_reads_it(self):
        try:
            import MDAnalysis
        except ImportError:
            self.skipTest("no MDAnalysis (python3-mdanalysis): run ./setup")
        for name, run in self.runs.items():
            for copy in (False, True):
                scree.write_h5md(run, self.path("mda.h5md"), copy=copy, units=False)
                count = len(np.unique(np.concatenate([f.bodies.id for f in run.frames]))) if copy else max(len(f.bodies) for f in run.frames)
                universe = MDAnalysis.Universe.empty(count, trajectory=True)
                universe.load_new(self.path("mda.h5md"), convert_units=False)
                self.assertEqual((len(universe.trajectory), universe.trajectory.n_atoms), (len(run.frames), count))
                for frame, moment in zip(run.frames, universe.trajectory):
                    self.assertEqual((moment.time, moment.data["step"], moment.data["kinetic_energy"]), (frame.time, frame.step, frame.kinetic))
                    there = ~np.isnan(moment.positions[:, 0])
                    for found, expected in ((moment.positions, frame.bodies.position), (moment.velocities, frame.bodies.velocity)):
                        expected = expected.astype(np.float32)  # as MDAnalysis keeps them
                        if copy:  # by id
                            np.testing.assert_array_equal(found[there], expected)
                        else:
                            np.testing.assert_array_equal(np.unique(found[there], axis=0), np.unique(expected, axis=0))
                if name == "flow":
                    universe.trajectory[1]
                    np.testing.assert_allclose(universe.trajectory.ts.dimensions, [0.036, 0.036, 0.051, 90, 90, 90], rtol=1e-6)
                universe.trajectory.close()

    def test_it_says_whether_rows_are_bodies(self):
        run = self.runs["bed"]  # of 2 ranks: whether bodies change their rows, the run decides
        stay = all(np.array_equal(self.raw_ids(frame), self.raw_ids(run.frames[0])) for frame in run.frames)
        self.assertEqual(scree.write_h5md(run, self.path("rows.h5md")), stay)
        self.assertTrue(scree.write_h5md(run, self.path("rows.h5md"), copy=True))
        self.assertTrue(scree.write_h5md(run, self.path("rows.h5md"), frames=run.frames[-1:]))
        self.assertFalse(scree.write_h5md(self.runs["flow"], self.path("rows.h5md")))  # bodies come and go

    @staticmethod
    def raw_ids(frame):
        with h5py.File(frame.path) as file:
            return file["VTKHDF/PointData/id"][()]

    def command(self, *words, code=0):
        result = subprocess.run([sys.executable, "-m", "scree", *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def test_the_command(self):
        said = self.command("h5md", "flow.run", "-o", "by.h5md")
        self.assertIn(f"by.h5md: {len(self.runs['flow'].frames)} frames, ", said.stdout)
        self.assertIn("use --copy", said.stderr)
        self.assertEqual(self.command("h5md", "bed.run", "-o", "by.h5md", "--copy", "--no-units").stderr, "")
        with h5py.File(self.path("by.h5md")) as file:
            self.assertNotIn("unit", file["particles/trajectory/position/value"].attrs)
        for text, steps in (("last", [4]), ("-2", [3]), ("0,3", [0, 3]), ("1:3", [1, 2, 3]), ("::2", [0, 2, 4]), ("-2:", [3, 4])):
            self.command("h5md", "bed.run", "-o", "by.h5md", f"--frames={text}")
            with h5py.File(self.path("by.h5md")) as file:
                self.assertEqual(file["particles/trajectory/position/step"][()].tolist(), [self.runs["bed"].frames[k].step for k in steps], text)
        some = self.runs["bed"].frames
        self.assertEqual([frame.number for frame in some.at([0, -1])], [0, 4])

    def test_mistakes_are_named(self):
        for words, code, message in ((("bed.run", "-o", "x.h5md", "--frames=7"), 2, "'7' means none of the frames 0 to 4"),
                                     (("bed.run", "-o", "x.h5md", "--frames=3:1"), 2, "no frame; there are 0 to 4"),
                                     (("bed.run", "-o", "x.h5md", "--frames=a"), 2, "expected all, last, 7"),
                                     (("bad.run", "-o", "x.h5md"), 3, "bad.run: no such run folder"),
                                     (("bed.run", "-o", "no/x.h5md"), 4, "no/x.h5md: cannot be written")):
            self.assertIn(message, self.command("h5md", *words, code=code).stderr)
        self.assertFalse([name for name in os.listdir(self.folder) if name.endswith(".part")])
        with self.assertRaisesRegex(scree.UsageError, "no frames to write"):
            scree.write_h5md(self.runs["bed"], self.path("x.h5md"), frames=self.runs["bed"].frames[:0])

    def test_a_frame_that_is_cut_off_is_named(self):
        run = make(self.folder, name="cut")
        with open(run.frames[1].path, "r+b") as file:
            file.truncate(3000)
        for copy in (False, True):
            with self.assertRaisesRegex(scree.InputError, "frame_000001.hdf: the file is damaged"):
                scree.write_h5md(scree.open(run), self.path("cut.h5md"), copy=copy)
        self.assertFalse(os.path.exists(self.path("cut.h5md")))


if __name__ == "__main__":
    unittest.main()
