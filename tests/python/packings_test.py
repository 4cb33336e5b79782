#!/usr/bin/env python3
"""Packings from and to LAMMPS, LIGGGHTS, Yade and VTK: round trips to the last digit, those programs as judges, messages with line numbers."""
import os
import shutil
import subprocess
import sys
import unittest

import numpy as np
import scree
from small_run import InFolder, make

FORMATS = {"bed.data": "lammps-data", "bed.dump": "lammps-dump", "bed.txt": "yade", "bed.vtp": "vtp"}
KEPT = {"bed.data": "id kind position radius velocity angular_velocity density lower upper", "bed.txt": "kind position radius",
        "bed.dump": "id kind position radius velocity angular_velocity quaternion density lower upper periodic step",
        "bed.vtp": "id kind position radius velocity angular_velocity quaternion density"}
BALLS = """\
[time]
duration = "1 ms"
[shapes.ball]
sphere = { radius = "2 mm" }   # scaled to each radius
[shapes.rock]
file = "rock.shape.h5"
[materials.glass]
density = 2500
[materials.steel]
density = 7800
[[pairs]]
between = ["glass", "glass"]
stiffness = "20 kN/m"
restitution = 0.5
friction = 0.3
[[pairs]]
between = ["glass", "steel"]
stiffness = "20 kN/m"
restitution = 0.5
friction = 0.3
[[pairs]]
between = ["steel", "steel"]
stiffness = "20 kN/m"
restitution = 0.5
friction = 0.3
[contact]
relax = true
"""
DATA = """\
two balls

2 atoms
2 atom types
0 1 xlo xhi
0 1 ylo yhi
0 1 zlo zhi

Masses

1 1
2 1

Atoms  # sphere

1 1 0.01 2500 0.1 0.2 0.3
2 2 0.02 7800 0.4 0.5 0.6 0 0 0   # with image flags

Velocities

2 4 5 6 0 0 0
1 1 2 3 7 8 9
"""
DUMP = """\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
1
ITEM: BOX BOUNDS pp ff ff
0 1
0 1
0 1
ITEM: ATOMS type id diameter xs ys zs
1 7 0.1 0.5 0.5 0.5
ITEM: UNITS
si
ITEM: TIME
0.25
ITEM: TIMESTEP
100
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp ff ff
-1 3
0 2
0 2
ITEM: ATOMS type id diameter xs ys zs
1 7 0.1 0.25 0.5 0.75
2 9 0.2 1.0 0.5 0.75
"""


class PackingsTest(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_ = make(cls.folder)
        cls.packing = scree.Packing.of(cls.run_.bodies(-1))

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def equal(self, found, expected, names):
        for name in names.split():
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)

    def odd(self):
        """A packing of numbers with all their digits."""
        rng = np.random.default_rng(5)
        quaternion = rng.normal(size=(300, 4))
        return scree.Packing(rng.normal(size=(300, 3)) * 10.0 ** rng.integers(-9, 9, (300, 1)), 10.0 ** rng.uniform(-7, 2, 300), id=rng.permutation(10**12 + np.arange(300)),
                             kind=rng.integers(1, 5, 300), velocity=rng.normal(size=(300, 3)) * 1e-300, angular_velocity=rng.normal(size=(300, 3)) / 3,
                             quaternion=quaternion / np.linalg.norm(quaternion, axis=1)[:, None], density=rng.uniform(1, 1e4, 300),
                             lower=[-1 / 3, -2, -3], upper=[1 / 7, 2e9, 3], periodic=(True, False, True), step=12345678901, time=0.5)

    def test_bodies_of_a_frame_as_spheres(self):
        p, b = self.packing, self.run_.bodies(-1)
        np.testing.assert_array_equal(p.position, b.position)
        np.testing.assert_allclose(4 / 3 * np.pi * p.radius**3, b.volume, rtol=1e-12)
        self.assertEqual(set(p.radius[b.shape_name == "ball"]), {0.004})
        np.testing.assert_allclose(p.density * 4 / 3 * np.pi * p.radius**3, b.mass, rtol=1e-12)
        self.assertEqual(set(p.kind), {1, 2})
        self.assertEqual(repr(p), "<scree.Packing: 25 spheres, radius 0.004 m to 0.004 m, 2 kinds>")
        lower, upper = p.box
        self.assertTrue(np.all(p.position - p.radius[:, None] >= lower) and np.all(p.position + p.radius[:, None] <= upper))
        frame = self.run_.frames[-1]
        self.assertEqual((p.lower, p.upper, p.periodic, p.step, p.time), (None, None, (False,) * 3, frame.step, frame.time))
        self.assertEqual(repr(scree.Packing([], [])), "<scree.Packing: no spheres>")

    def test_every_format_gives_the_same_numbers_again(self):
        for packing in (self.packing, self.odd(), scree.Packing([[1, 2, 3]], 0.5), scree.Packing(np.zeros((0, 3)), [])):
            for name, form in FORMATS.items():
                packing.write(self.path(name))
                for again in (scree.Packing.read(self.path(name)), scree.Packing.read(self.path(name), format=form)):
                    for field in KEPT[name].split():
                        expected = getattr(packing, field)
                        if field in ("lower", "upper"):
                            expected = packing.box[field == "upper"]
                        if field in ("velocity", "angular_velocity", "quaternion", "density") and expected is None:
                            continue
                        np.testing.assert_array_equal(getattr(again, field), expected, err_msg=f"{name} {field}")

    # the programs themselves

    def test_lammps_reads_and_writes_the_same(self):
        lammps = shutil.which("lmp")
        if not lammps:
            self.skipTest("no LAMMPS (package lammps): ./setup --peers")
        p = self.odd()
        p = scree.Packing(np.random.default_rng(1).uniform(-1, 1, (300, 3)), p.radius, id=np.arange(300, 0, -1), kind=p.kind, velocity=p.velocity * 1e300,
                          angular_velocity=p.angular_velocity, density=p.density, lower=[-2, -2, -2], upper=[2, 2, 2])
        moved = scree.Packing(p.position[:, [1, 2, 0]], p.radius, id=p.id, kind=p.kind, velocity=p.velocity / 3, lower=p.lower, upper=p.upper, step=77)
        p.write(self.path("to.data"))
        moved.write(self.path("to.dump"))
        columns = "id type x y z radius vx vy vz omegax omegay omegaz"
        self.write("in.lammps", f"""units si
atom_style sphere
boundary f f f
read_data to.data
write_dump all custom from.dump {columns} modify sort id format float %.17g
write_data from.data
read_dump to.dump 77 x y z vx vy vz box no replace yes
write_dump all custom moved.dump {columns} modify sort id format float %.17g
""")
        result = subprocess.run([lammps, "-in", "in.lammps", "-log", "none"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        order = np.argsort(p.id)
        for name in ("from.dump", "from.data"):
            found = scree.Packing.read(self.path(name))
            rows = np.argsort(found.id)
            for field in ("id", "kind", "position", "radius", "velocity", "angular_velocity"):
                np.testing.assert_allclose(getattr(found, field)[rows], getattr(p, field)[order], rtol=1e-15, err_msg=f"{name} {field}")
        np.testing.assert_allclose(found.density[rows], p.density[order], rtol=1e-14)  # LAMMPS keeps the mass
        found = scree.Packing.read(self.path("moved.dump"))
        np.testing.assert_allclose(found.position, moved.position[order], rtol=1e-15)
        np.testing.assert_allclose(found.velocity, moved.velocity[order], rtol=1e-15)

    def test_vtk_reads_and_writes_the_same(self):
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkPolyData
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

        p = self.odd()
        p.write(self.path("to.vtp"))
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(self.path("to.vtp"))
        reader.Update()
        data = reader.GetOutput()
        self.assertEqual((data.GetNumberOfPoints(), data.GetNumberOfVerts(), data.GetPointData().GetScalars().GetName()), (300, 300, "radius"))
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), p.position)
        for name in ("radius", "id", "kind", "velocity", "angular_velocity", "quaternion", "density"):
            np.testing.assert_array_equal(vtk_to_numpy(data.GetPointData().GetArray(name)), getattr(p, name), err_msg=name)
        self.assertEqual([data.GetCell(k).GetPointId(0) for k in (0, 299)], [0, 299])

        # all encodings, large enough for several blocks
        many = scree.Packing(np.random.default_rng(2).normal(size=(9000, 3)), 0.5, kind=np.arange(9000) % 3 + 1, velocity=np.random.default_rng(3).normal(size=(9000, 3)))
        cloud, points = vtkPolyData(), vtkPoints()
        points.SetData(numpy_to_vtk(many.position, deep=True))
        cloud.SetPoints(points)
        for name in ("radius", "kind", "velocity"):
            array = numpy_to_vtk(getattr(many, name), deep=True)
            array.SetName(name)
            cloud.GetPointData().AddArray(array)
        for mode in ("Ascii", "Binary", "Appended"):
            for packed in (True, False):
                for base64 in (True, False):
                    for order in ("Little", "Big"):
                        for head in (32, 64):
                            writer = vtkXMLPolyDataWriter()
                            writer.SetFileName(self.path("from.vtp"))
                            writer.SetInputData(cloud)
                            getattr(writer, f"SetDataModeTo{mode}")()
                            (writer.SetCompressorTypeToZLib if packed else writer.SetCompressorTypeToNone)()
                            writer.SetEncodeAppendedData(base64)
                            getattr(writer, f"SetByteOrderTo{order}Endian")()
                            writer.SetHeaderType(head)
                            self.assertEqual(writer.Write(), 1)
                            found = scree.Packing.read(self.path("from.vtp"))
                            for name in ("position", "radius", "kind", "velocity"):
                                expected = getattr(many, name)
                                compare = np.testing.assert_allclose if mode == "Ascii" and expected.dtype.kind == "f" else np.testing.assert_array_equal
                                compare(getattr(found, name), expected, err_msg=f"{mode} {packed} {base64} {order} {head} {name}")

    def test_yade_reads_and_writes_the_same(self):
        yade = shutil.which("yade")
        if not yade:
            self.skipTest("no Yade (package yade): ./setup --peers")
        p = scree.Packing(self.packing.position, self.packing.radius)
        p.write(self.path("to.txt"))
        self.write("both.py", "from yade import ymport, export\nO.bodies.append(ymport.text('to.txt'))\nexport.text('from.txt')\n")
        result = subprocess.run([yade, "-n", "-x", "both.py"], cwd=self.folder, capture_output=True, text=True, env=dict(os.environ, PYTHONPATH=""))
        self.assertTrue(os.path.exists(self.path("from.txt")), result.stdout + result.stderr)
        found = scree.Packing.read(self.path("from.txt"))
        np.testing.assert_allclose(found.position, p.position, rtol=1e-5)  # six digits are what it writes
        np.testing.assert_allclose(found.radius, p.radius, rtol=1e-5)

    def test_what_scree_post_writes_for_paraview_is_read(self):
        scree.call("post", "vtk", self.run_, output=self.path("vtk"), what="bodies", frames="last", progress=False)
        path = self.path("vtk/bodies_000004.vtp")
        found, b = scree.Packing.read(path, radius="4 mm"), self.run_.bodies(-1)
        rows = np.argsort(found.id)
        np.testing.assert_array_equal(found.id[rows], b.id)
        np.testing.assert_array_equal(found.kind[rows], b.material + 1)
        np.testing.assert_allclose(found.position[rows], b.position, rtol=1e-6)  # those files have single precision
        np.testing.assert_allclose(found.quaternion[rows], b.quaternion, atol=1e-6)
        with self.assertRaisesRegex(scree.InputError, "bodies_000004.vtp: no array radius, radii or diameter .*scale.*give the radius of all"):
            scree.Packing.read(path)

    # files as their writers make them

    def test_a_data_file(self):
        p = scree.Packing.read(self.write("two", DATA))
        self.assertEqual((p.id.tolist(), p.kind.tolist(), p.radius.tolist(), p.density.tolist()), ([1, 2], [1, 2], [0.005, 0.01], [2500, 7800]))
        self.assertEqual((p.position.tolist(), p.velocity.tolist(), p.angular_velocity.tolist()),
                         ([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]], [[1, 2, 3], [4, 5, 6]], [[7, 8, 9], [0, 0, 0]]))
        in_mm = scree.Packing.read(self.path("two"), unit="mm")
        np.testing.assert_allclose(np.c_[in_mm.position, in_mm.radius, in_mm.velocity], 1e-3 * np.c_[p.position, p.radius, p.velocity], rtol=1e-15)
        np.testing.assert_array_equal(in_mm.angular_velocity, p.angular_velocity)
        points = scree.Packing.read(self.write("points", DATA.replace("# sphere", "# atomic").replace("0.01 2500 ", "").replace("0.02 7800 ", "")), radius="3 mm")
        self.assertEqual((points.radius.tolist(), points.position.tolist()), ([0.003, 0.003], p.position.tolist()))

    def test_a_dump_of_several_moments(self):
        p = scree.Packing.read(self.write("moments", DUMP))
        self.assertEqual((p.step, p.time, p.id.tolist(), p.kind.tolist(), p.radius.tolist(), p.periodic), (100, 0.25, [7, 9], [1, 2], [0.05, 0.1], (True, False, False)))
        self.assertEqual(p.position.tolist(), [[0, 1, 1.5], [3, 1, 1.5]])
        self.assertEqual(p.lower.tolist(), [-1, 0, 0])
        self.assertEqual(len(scree.Packing.read(self.path("moments"), step=0)), 1)
        plain = DUMP.replace("xs ys zs", "xu yu zu").replace("diameter", "radius").replace("type id", "mol c_1")
        p = scree.Packing.read(self.write("plain", plain))
        self.assertEqual((p.position[0].tolist(), p.radius[0], p.id.tolist(), p.kind.tolist()), ([0.25, 0.5, 0.75], 0.1, [1, 2], [1, 1]))

    def test_lists_of_yade(self):
        p = scree.Packing.read(self.write("list", "# x y z r\n0 0 0 1\n\n2 0 0 .5  # small\n"))
        self.assertEqual((p.position.tolist(), p.radius.tolist(), p.kind.tolist()), ([[0, 0, 0], [2, 0, 0]], [1, 0.5], [1, 1]))
        p = scree.Packing.read(self.write("list", "#format id_x_y_z_r_matId\n4 0 0 0 1 0\n5 2 0 0 .5 3\n"))
        self.assertEqual((p.id.tolist(), p.kind.tolist()), ([4, 5], [1, 4]))
        p = scree.Packing.read(self.write("list", "##PERIODIC:: 1 2 3\n0 0 0 1 -1\n"))  # SpherePack.save, with a clump
        self.assertEqual((p.upper.tolist(), p.periodic, len(p)), ([1, 2, 3], (True,) * 3, 1))

    # into cases

    def test_into_a_case_and_out_of_its_run(self):
        rng = np.random.default_rng(7)
        places = 0.02 * np.stack(np.meshgrid(*[np.arange(3)] * 3), -1).reshape(-1, 3)
        p = scree.Packing(places, rng.uniform(0.002, 0.009, 27), id=rng.permutation(27), kind=rng.integers(1, 3, 27), velocity=0.01 * rng.normal(size=(27, 3)),
                          angular_velocity=rng.normal(size=(27, 3)), quaternion=[[0.5, 0.5, -0.5, 0.5]] * 27)
        for name, fields in KEPT.items():
            self.write("balls.toml", BALLS)
            p.write(self.path(name))
            case = scree.Case(self.path("balls.toml"))
            scree.Packing.read(self.path(name)).add_to(case, "ball", {1: "glass", 2: "steel"})
            start = scree.pack(case, self.path("balls.scene.h5"), progress=False).start
            order = np.argsort(p.id) if "id" in fields else np.arange(27)
            np.testing.assert_array_equal(start["position"], p.position[order], err_msg=name)
            np.testing.assert_allclose(0.002 * start["scale"], p.radius[order], rtol=3e-16)
            np.testing.assert_array_equal(start["material"], p.kind[order] - 1)
            if "velocity" in fields:
                np.testing.assert_array_equal(start["velocity"], p.velocity[order])
                np.testing.assert_array_equal(start["angular_velocity"], p.angular_velocity[order])
            if "quaternion" in fields:
                np.testing.assert_allclose(start["orientation"], p.quaternion[order], atol=1e-15)
        run = scree.solve(self.path("balls.scene.h5"), threads=1, progress=False)
        again = scree.Packing.of(run.bodies(0))
        last = scree.Packing.of(run.bodies(-1))
        self.assertEqual((last.step, last.time), (run.frames[-1].step, run.frames[-1].time))
        np.testing.assert_array_equal(again.position, p.position[np.argsort(p.id)])
        np.testing.assert_allclose(again.radius, p.radius[np.argsort(p.id)], rtol=3e-16)

    def test_meshes_get_the_size_of_the_sphere(self):
        self.write("balls.toml", BALLS)
        case = scree.Case(self.path("balls.toml"))
        scree.Packing([[0, 0, 0], [0.1, 0, 0]], [0.006, 0.012]).add_to(case, "rock", "glass", fixed=True)
        rock = scree.open_shapes(self.path("rock.shape.h5"))["rock"]
        np.testing.assert_allclose(np.array(case["bodies.*.scale"]) * rock.equivalent_diameter, [0.012, 0.024], rtol=1e-14)
        self.assertEqual(case["bodies.*.fixed"], [True, True])
        with self.assertRaisesRegex(scree.UnknownName, "shape 'pebble'.*ball, rock"):
            scree.Packing([[0, 0, 0]], 1).add_to(case, "pebble", "glass")
        with self.assertRaisesRegex(scree.UnknownName, "material of kind '3'.*1, 2"):
            scree.Packing([[0, 0, 0]], 1, kind=3).add_to(case, "ball", {1: "glass", 2: "steel"})

    def command(self, *words, code=0):
        result = subprocess.run([sys.executable, "-m", "scree", *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def test_the_commands(self):
        self.write("balls.toml", BALLS)
        said = self.command("export", "bed.run", "-o", "out.dump")
        self.assertRegex(said.stdout, r"out.dump: 24 spheres at 0\.06")
        self.assertIn("bodies have a mesh; they are written as spheres of equal volume", said.stderr)
        found = scree.Packing.read(self.path("out.dump"))
        self.equal(found, scree.Packing.of(self.run_.bodies(-1).particles()), "id position radius velocity kind")
        self.assertEqual(found.step, self.run_.frames[-1].step)
        self.command("export", "bed.run", "-o", "out.anything", "--format", "yade", "--frame", "0", "--shape", "ball", "--all", "--region", "box:-1,-1,-1,1,1,1")
        self.equal(scree.Packing.read(self.path("out.anything")), scree.Packing.of(self.run_.bodies(0).of_shape("ball")), "position radius")
        said = self.command("import", "out.dump", "--case", "balls.toml", "--shape", "ball", "--material", "glass", "-o", "new.toml")
        self.assertIn("new.toml: 24 bodies, radius 0.004 m to 0.004 m", said.stdout)
        self.assertEqual(set(scree.Case(self.path("new.toml"))["bodies.*.material"]), {"glass"})
        self.command("import", self.write("two", DATA), "--case", "balls.toml", "--shape", "ball", "--material", "1=glass", "--material", "2=steel", "--unit", "cm",
                     "--fixed", "-o", "new.toml")
        new = scree.Case(self.path("new.toml"))
        self.assertEqual((new["bodies.*.material"], new["bodies.*.fixed"]), (["glass", "steel"], [True, True]))
        np.testing.assert_allclose(new["bodies.*.scale"], [0.025, 0.05])
        self.assertIn("python3 -m scree import", self.command("--help").stdout)

    def test_mistakes_of_commands_are_named(self):
        self.write("balls.toml", BALLS)
        self.write("two", DATA)
        bring = ("import", "two", "--case", "balls.toml", "--shape", "ball", "-o", "x.toml")
        for words, code, message in (((*bring, "--material", "1=glass"), 2, "material of kind '2' does not exist; there are: 1"),
                                     ((*bring, "--material", "glass", "--material", "steel"), 2, "KIND=NAME expected"),
                                     ((*bring, "--material", "glass", "--unit", "kg"), 2, "not in units of m"),
                                     ((*bring[:1], "none", *bring[2:], "--material", "glass"), 3, "none: cannot be read: No such file"),
                                     (("export", "bed.run", "-o", "bed.xyz"), 2, "no format has this ending"),
                                     (("export", "bed.run", "-o", "bed.vtp", "--frame", "9"), 2, "frame '9' does not exist"),
                                     (("export", "bed.run", "-o", "bed.vtp", "--frame", "-9"), 2, "frame -9: there are 5"),
                                     (("export", "bed.run", "-o", "no/bed.vtp"), 4, "no/bed.vtp: cannot be written: No such file"),
                                     (("export",), 2, "required")):
            self.assertIn(message, self.command(*words, code=code).stderr)
        self.assertFalse(os.path.exists(self.path("x.toml")))

    def test_bad_files_are_named_with_their_line(self):
        def line_of(text, part):
            return text[: text.index(part)].count("\n") + 1

        atom, second = "1 1 0.01 2500 0.1 0.2 0.3", "2 2 0.02"
        for change, at, message in ((("2 atoms\n", ""), None, "no line 'N atoms'|1 values"), (("2 atoms", "two atoms"), None, "no line 'N atoms'"),
                                    (("0 1 ylo yhi", "0 x ylo yhi"), "0 x ylo", "'x' in column 2 of the header; a finite number"),
                                    (("0 1 zlo zhi\n", ""), None, "no line 'zlo zhi' in the header"),
                                    (("0 1 zlo zhi", "0 1 zlo zhi\n.1 0 0 xy xz yz"), ".1 0 0", "slanted sides"),
                                    ((atom, "1 1 0.01 2500 0.1 0.2"), "1 1 0.01", "6 values found in section Atoms, 7 expected"),
                                    ((atom, "1 1 0.01 2500 0.1 0.2 nan"), "1 1 0.01", "'nan' in column 7 of section Atoms; a finite number"),
                                    ((atom, "1.5 1 0.01 2500 0.1 0.2 0.3"), "1.5 1", "'1.5' in column 1 of section Atoms; a whole number"),
                                    ((atom, "2 1 0.01 2500 0.1 0.2 0.3"), second, "id 2 for the second time; line 16 has it too"),
                                    ((atom, "1 1 0 2500 0.1 0.2 0.3"), "1 1 0 ", "the diameter is 0; above 0 expected"),
                                    (("2 atoms", "3 atoms"), "Velocities", "1 values found in section Atoms"),
                                    (("2 atoms", "1 atoms"), second, "the name of a section expected, such as Atoms; the header announces 1 atoms"),
                                    (("# sphere", "# ellipsoid"), "Atoms", "atom style 'ellipsoid'; sphere, granular or atomic"),
                                    (("# sphere", "# atomic"), "1 1 0.01", "7 values found|no radius"),
                                    (("2 4 5 6 0 0 0", "3 4 5 6 0 0 0"), "3 4 5", "id 3 is not in section Atoms"),
                                    (("2 4 5 6 0 0 0", "2 4 5 6"), "1 1 2 3", "7 values found in section Velocities, 4 or 7"),
                                    (("1 1 2 3 7 8 9\n", ""), "2 4 5 6", "the file ends after 1 of 2 lines of section Velocities"),
                                    (("Atoms", "Atomz"), None, "no section Atoms|section Velocities before")):
            self.named(DATA.replace(*change, 1), at, message, line_of, "lammps-data")
        last = "2 9 0.2 1.0 0.5 0.75\n"
        for change, at, message in (((last, ""), "1 7 0.1 0.25", "the file ends after 1 of 2 lines of the atoms of step 100"),
                                    ((last, "2 9 0.2 1.0\n"), "2 9 0.2", "4 values found, 6 expected .type id diameter xs ys zs."),
                                    ((last, "2 7 0.2 1.0 0.5 0.75\n"), "2 7 0.2", "id 7 for the second time; line 24 has it too"),
                                    ((last, "2 9 0.2 1.0 0.5 z\n"), "2 9 0.2 1.0 0.5 z", "'z' in column 6 of ITEM: ATOMS"),
                                    ((last, last + "3 10 0.1 0 0 0\n"), "3 10", "a line that begins with ITEM: expected"),
                                    (("ITEM: TIME\n", "ITEM: TYME\n"), "ITEM: TYME", "'ITEM: TYME' is unknown"),
                                    (("-1 3\n", "-1\n"), "-1\n", "1 values found in BOX BOUNDS, 2 expected"),
                                    (("ITEM: BOX BOUNDS pp ff ff\n-1", "ITEM: BOX BOUNDS xy xz yz pp ff ff\n-1"), "ITEM: BOX BOUNDS xy", "slanted")):
            self.named(DUMP.replace(*change, 1), at, message, line_of, "lammps-dump")
        for change, message in ((("xs ys zs", "px py pz"), "no positions in the columns type id diameter px py pz"),
                                (("diameter", "weight"), "no column radius or diameter among type id weight")):
            self.named(DUMP.replace(*change), None, message, line_of, "lammps-dump")
        with self.assertRaisesRegex(scree.InputError, "no step 50; there are: 0, 100"):
            scree.Packing.read(self.write("bad", DUMP), step=50)
        for text, at, message in (("0 0 0 1\n5 0 1\n", "5 0 1\n", "3 values found, 4 expected .x y z r."), ("0 0 0 1\n0 0 0 -2\n", "0 0 0 -2", "the radius is -2"),
                                  ("0 0 a 1\n", "0 0 a", "'a' in column 3"), ("#format x_y_z\n0 0 0\n", "#format", "a format with x, y, z and r"),
                                  ("#format id_x_y_z_r\n1 0 0 0 1\n1 0 0 0 1\n", None, "id 1 for the second time; line 2")):
            self.named(text, at, message, line_of, "yade")
        self.packing.write(self.path("good.vtp"))
        with open(self.path("good.vtp"), encoding="utf-8") as file:
            good = file.read()
        for text, message in ((good[:-40], "bad:\\d+: no XML, or cut off"), (good.replace('"PolyData"', '"ImageData"'), "type PolyData expected, ImageData found"),
                              (good.replace('Name="radius"', 'Name="size"'), "no array radius, radii or diameter"),
                              (good.replace("AAAA", "", 1), "array radius: 25 x 1 numbers expected"), (good.replace("<Points>", "<Dots>").replace("</Points>", "</Dots>"), "without points"),
                              (good.replace('NumberOfPoints="25"', 'NumberOfPoints="26"'), "26 x 1 numbers expected")):
            with self.assertRaisesRegex(scree.InputError, message):
                scree.Packing.read(self.write("bad", text))
        with open(self.path("bad"), "wb") as file:
            file.write(bytes(range(256)))
        with self.assertRaisesRegex(scree.InputError, "bad: no text file"):
            scree.Packing.read(self.path("bad"))

    def named(self, text, at, message, line_of, form):
        with self.assertRaisesRegex(scree.InputError, message) as caught:
            scree.Packing.read(self.write("bad", text), format=form)
        self.assertRegex(str(caught.exception), rf"bad:{line_of(text, at) if at else r'[0-9]+'}: ")

    def test_own_arrays_are_checked(self):
        for words, options, message in ((([[0, 0, 0]], [1, 2]), {}, r"radius has the shape \(2,\), \(1,\) expected"), (([[0, 0, 0]], 0), {}, "radius of row 0 is 0 m"),
                                        (([[0, 0, np.nan]], 1), {}, "position of row 0"), (([[0, 0, 0]], 1), {"velocity": [1, 2]}, "velocity has the shape")):
            with self.assertRaisesRegex(scree.UsageError, message):
                scree.Packing(*words, **options)
        with self.assertRaisesRegex(scree.UnknownName, "format 'pdb'.*lammps-data, lammps-dump, yade, vtp"):
            scree.Packing([[0, 0, 0]], 1).write(self.path("x"), format="pdb")
        with self.assertRaisesRegex(scree.UsageError, "2 materials for 1 positions"):
            scree.Case().add_bodies("ball", ["glass", "steel"], [[0, 0, 0]])


if __name__ == "__main__":
    unittest.main()
