#!/usr/bin/env python3
"""What the package reads of a run: frames, contacts, walls, tables, shapes, scene, meshes, regions, pictures."""
import copy
import json
import os
import shutil
import sys
import unittest
import zlib
from unittest import mock

import h5py
import numpy as np
import scree
from small_run import CASE, InFolder, make


class ReadTest(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_ = make(cls.folder, ranks=2)

    def test_a_run_says_what_it_is(self):
        run = self.run_
        self.assertEqual(run.name, "bed")
        self.assertEqual(os.fspath(run), run.folder)
        self.assertEqual(run.outcome["outcome"], "completed")
        self.assertEqual(run.provenance["ranks"], 2)
        self.assertEqual(run.case.text(), CASE)
        self.assertEqual(run.case["pairs.0.friction"], 0.4)
        self.assertIn("25 bodies, 5 frames; completed", repr(run))
        chalk = run.materials["chalk"]
        self.assertEqual((chalk.name, chalk.density, chalk.young, chalk.poisson), ("chalk", 1500, 0, 0))
        self.assertEqual(run.materials.by_index(0).name, "chalk")
        self.assertEqual(run.materials.indices("steel"), [1])
        self.assertEqual(list(run.walls), ["box", "plate"])
        self.assertEqual(run.walls["plate"].kind, "mesh")
        self.assertEqual((run.walls["box"].material, run.walls["box"].facts["upper"][2]), ("steel", 0.08))

    def test_temperatures_are_those_of_scenes_with_heat(self):
        self.assertFalse(self.run_.scene.has_heat)
        with self.assertRaisesRegex(scree.InputError, "no heat; add a table"):
            _ = self.run_.frames[0].bodies.temperature
        warm = CASE.replace('[contact]', '[heat]\n[contact]').replace('"60 ms"', '"2 ms"').replace("count = 24", 'count = 6\ntemperature = "20 degC"')
        warm = warm.replace("density = 1500", 'density = 1500\nheat_capacity = 900\nconductivity = "2 W/(m K)"\nreal_young = "30 GPa"')
        warm = warm.replace('density = "7.8 g/cm^3"', 'density = "7.8 g/cm^3"\nheat_capacity = 460\nconductivity = 42').replace("fixed = true", "fixed = true\ntemperature = 350")
        scene = scree.pack(scree.Case.from_text(warm), self.path("warm.scene.h5"), progress=False)
        run = scree.solve(scene, threads=1, progress=False)
        chalk = run.materials["chalk"]
        self.assertEqual((run.scene.has_heat, chalk.heat_capacity, chalk.conductivity, chalk.real_young), (True, 900, 2, 30e9))
        first = run.frames[0].bodies
        self.assertEqual(sorted(set(first.temperature)), [293.15, 350])

    def test_a_cell_that_deforms_is_that_of_the_frame(self):
        self.assertIsNone(self.run_.frames[-1].cell)
        text = """gravity = [0, 0, 0]
[time]
duration = "10 ms"
[domain]
min = [0, 0, 0]
max = [0.1, 0.1, 0.1]
periodic = ["x", "y", "z"]
[cell]
strain_rate = { x = 3, y = -2 }
[contact]
impact_speed = "1 m/s"
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = "50 kN/m"
restitution = 0.5
friction = 0.3
[[bodies]]
shape = "ball"
material = "glass"
position = [0.03, 0.05, 0.05]
velocity = [0.2, 0, 0]
[[bodies]]
shape = "ball"
material = "glass"
position = [0.07, 0.02, 0.05]
velocity = [-0.2, 0, 0]
[output]
every = "5 ms"
"""
        scene = scree.pack(scree.Case.from_text(text), self.path("cell.scene.h5"), progress=False)
        frame = scree.solve(scene, threads=1, progress=False).frames[-1]
        cell = frame.cell
        lengths = 0.1 * np.exp(np.array([-3, 2, 0]) * frame.time)
        self.assertLess(np.abs(cell.period / lengths - 1).max(), 1e-12)
        self.assertLess(np.abs(cell.upper - cell.lower - lengths).max(), 1e-13)
        np.testing.assert_array_equal(cell.lengths, cell.period)
        self.assertAlmostEqual(cell.volume, lengths.prod(), delta=1e-12 * lengths.prod())
        np.testing.assert_array_equal(cell.rate, [-3, 2, 0])
        # nothing touches: the stress is that of the motion along x, two bodies whose velocity falls as the cell grows
        along = frame.bodies.velocity[:, 0]
        self.assertAlmostEqual(cell.stress[0, 0], (frame.bodies.mass * along**2).sum() / cell.volume, delta=1e-9 * cell.stress[0, 0])
        self.assertAlmostEqual(cell.pressure, cell.stress[0, 0] / 3, delta=1e-12 * cell.pressure)
        self.assertAlmostEqual(abs(along[0]), 0.2 * np.exp(3 * frame.time), delta=1e-9)
        np.testing.assert_array_equal(frame.periodicity.period, cell.period)
        scree.write_h5md(scree.open(os.path.dirname(frame.path)), self.path("cell.h5md"))
        with h5py.File(self.path("cell.h5md")) as file:
            np.testing.assert_array_equal(file["particles/trajectory/box/offset/value"][-1], cell.lower)
        half = scree.Box(cell.lower, [*(cell.lower + cell.period / 2)[:1], *cell.upper[1:]])
        np.testing.assert_array_equal(frame.bodies.within(half).id, frame.bodies.in_region(half).id)
        beyond = scree.Box(cell.lower + [cell.period[0], 0, 0], cell.upper + [cell.period[0], 0, 0])   # the next cell: an image of each body
        self.assertEqual(len(frame.bodies.within(beyond)), len(frame.bodies))

    def test_frames_are_found_by_place_number_and_time(self):
        frames = self.run_.frames
        self.assertEqual(len(frames), 5)  # the last at the end of the step that reaches the duration
        self.assertEqual([frame.number for frame in frames], [0, 1, 2, 3, 4])
        self.assertEqual([frame.number for frame in frames[1:3]], [1, 2])
        self.assertEqual(frames[-1].number, 4)
        self.assertEqual(frames.by_number(2).number, 2)
        self.assertEqual(frames.at_time(0.021).number, 1)
        np.testing.assert_allclose(frames.times, [0, 0.02, 0.04, 0.06, 0.06], atol=1e-4)
        self.assertEqual(frames[1].time, frames.times[1])
        self.assertGreater(frames[1].step, 0)
        with self.assertRaises(scree.UnknownName):
            frames.by_number(77)
        with self.assertRaisesRegex(IndexError, "5 frames"):
            frames[5]
        self.assertEqual(repr(frames), f"<scree.Frames: 5 frames from 0 s to {frames.times[4]:.6g} s>")

    def test_what_has_left_a_wall_or_region_is_left_out(self):
        frame = self.run_.frames[-1]
        b = frame.bodies
        np.testing.assert_array_equal(b.within("box").id, b.in_region("box:-18 mm,-18 mm,0,18 mm,18 mm,80 mm").id)
        over = np.all(np.abs(b.position[:, :2]) <= 0.01, axis=1) & (b.position[:, 2] >= 0.067)  # the plate has moved down by 3 mm
        np.testing.assert_array_equal(b.within("plate").id, b.id[over])
        np.testing.assert_array_equal(b.within("box:0,0,0,1,1,1").id, b.in_region("box:0,0,0,1,1,1").id)
        with self.assertRaisesRegex(scree.UsageError, "box, plate"):
            b.within("boks")

    def test_a_worn_wall_has_the_vertices_of_the_frame(self):
        plate = self.run_.walls["plate"]
        worn = plate.mesh.vertices - [0, 0, 1e-4]  # of scale 1
        mesh = plate.worn_mesh(worn)
        np.testing.assert_allclose(mesh.vertices - plate.mesh.vertices, np.broadcast_to([0, 0, -1e-4], worn.shape), atol=1e-12)
        np.testing.assert_array_equal(plate.worn_mesh(np.zeros((0, 3))).vertices, plate.mesh.vertices)
        with self.assertRaisesRegex(scree.InputError, "worn"):
            plate.worn_mesh(worn[1:])

    def test_bodies_come_by_id_with_all_fields(self):
        for frame in self.run_.frames:
            b = frame.bodies
            self.assertEqual(len(b), 25)
            self.assertTrue(np.all(np.diff(b.id) > 0))
            self.assertEqual({name: getattr(b, name).shape for name in b.fields()},
                             {"id": (25,), "position": (25, 3), "quaternion": (25, 4), "velocity": (25, 3), "angular_velocity": (25, 3),
                              "shape": (25,), "material": (25,), "scale": (25,), "rank": (25,)})
            np.testing.assert_allclose(np.linalg.norm(b.quaternion, axis=1), 1, rtol=1e-12)
        self.assertEqual(set(self.run_.frames[0].bodies.rank), {0, 1})
        self.assertEqual(scree.Bodies.velocity.unit, "m/s")
        self.assertIn("[m/s]", scree.Bodies.velocity.__doc__)

    def test_arrays_are_shared_and_so_read_only(self):
        position = self.run_.frames[0].bodies.position
        with self.assertRaises(ValueError):
            position[0, 0] = 1
        position.copy()[0, 0] = 1

    def test_energy_and_mass_of_bodies_are_those_of_the_solver(self):
        frame = self.run_.frames[1]
        b = frame.bodies
        moving = b[b.is_particle]
        self.assertAlmostEqual(moving.kinetic_energy.sum() / frame.kinetic, 1, delta=1e-12)
        rock = self.run_.shapes["rock"]
        np.testing.assert_allclose(b.of_shape("rock").mass, 1500 * rock.volume * b.of_shape("rock").scale**3, rtol=1e-14)
        np.testing.assert_allclose(b.of_material("steel").volume, 4 / 3 * np.pi * 0.004**3, rtol=1e-12)
        np.testing.assert_allclose(b.of_shape("ball").diameter, 0.008, rtol=1e-12)
        self.assertEqual(len(b.particles()), 24)
        log, row, frame = self.run_.log, -1, self.run_.frames[-1]
        self.assertAlmostEqual((log["kinetic_translational"][row] + log["kinetic_rotational"][row]) / frame.kinetic, 1, delta=1e-12)
        self.assertAlmostEqual((log["elastic"][row] + log["elastic_tangential"][row]) / frame.elastic, 1, delta=1e-12)
        self.assertEqual((frame.potential, frame.dissipated), (log["potential"][row], log["dissipated"][row]))

    def test_names_and_rows_of_bodies(self):
        b = self.run_.bodies(-1)
        self.assertEqual(set(b.shape_name), {"rock", "ball"})
        self.assertEqual(list(b.material_name[b.row(0) : b.row(0) + 1]), ["steel"])
        self.assertEqual(b[b.row(5)].id.tolist(), [5])
        with self.assertRaisesRegex(scree.UnknownName, "body 1000"):
            b.row(1000)
        self.assertEqual(self.run_.bodies(self.run_.frames[0]).id.tolist(), self.run_.bodies(0).id.tolist())

    def test_contacts_of_a_frame(self):
        c = self.run_.frames[-1].contacts
        self.assertGreater(len(c), 1)
        self.assertTrue(np.all(c.body_a < c.body_b))
        np.testing.assert_allclose(np.linalg.norm(c.normal, axis=1), 1, rtol=1e-9)
        np.testing.assert_array_equal(c.force, c.normal_force[:, None] * c.normal + c.tangential_force)
        self.assertTrue(np.all(c.overlap < c.margin))
        keys = np.stack([c.body_a, c.body_b, c.feature], axis=1).tolist()
        self.assertEqual(keys, sorted(keys))
        b = self.run_.frames[-1].bodies
        low = b.in_region("box:-1,-1,-1,1,1,0.006")
        part = c.of(low)
        self.assertTrue(0 < len(part) < len(c))
        boundary = set(self.run_.scene.boundary_ids)
        for a, b in zip(part.body_a, part.body_b):
            self.assertTrue({a, b} <= set(low.id) | boundary and {a, b} & set(low.id))
        self.assertEqual(len(c.in_region("box:-1,-1,-1,1,1,1")), len(c))

    def test_walls_have_loads_and_names(self):
        frame = self.run_.frames[-1]
        w = frame.walls
        self.assertEqual(w.name, ["box", "plate"])
        log, row = self.run_.log, self.run_.log.rows - 1
        i = self.run_.walls["box"].id
        np.testing.assert_allclose(w.force[w.row("box")], [log[f"wall{i}_force_{k}"][row] for k in "xyz"], rtol=1e-12)
        np.testing.assert_allclose(w.torque[w.row(i)], [log[f"wall{i}_torque_{k}"][row] for k in "xyz"], rtol=1e-12, atol=1e-18)
        with self.assertRaisesRegex(scree.UnknownName, "box, plate"):
            w.row("lid")
        mesh = frame.wall_mesh("plate")
        np.testing.assert_allclose(mesh.vertices[:, 2], 0.07 - 0.05 * frame.time, rtol=1e-9)
        self.assertAlmostEqual(frame.wall_mesh("box").volume, -(0.036**2) * 0.08, delta=1e-12)

    def test_meshes_in_the_world(self):
        frame = self.run_.frames[-1]
        b = frame.bodies.of_shape("rock")
        mesh = frame.mesh(int(b.id[0]))
        self.assertAlmostEqual(mesh.volume / b.volume[0], 1, delta=1e-9)
        centre = np.einsum("t,tk->k", np.einsum("ij,ij->i", mesh.vertices[mesh.triangles[:, 0]], np.cross(
            mesh.vertices[mesh.triangles[:, 1]], mesh.vertices[mesh.triangles[:, 2]])), mesh.vertices[mesh.triangles].sum(axis=1)) / 24 / mesh.volume
        np.testing.assert_allclose(centre, b.position[0], atol=1e-12)
        together = frame.meshes(b)
        self.assertEqual(len(together.triangles), 60 * len(b))
        self.assertEqual(np.unique(together.body).tolist(), b.id.tolist())
        np.testing.assert_array_equal(together.vertices[together.triangles[together.body == b.id[1]]],
                                      frame.mesh(int(b.id[1])).vertices[frame.mesh(int(b.id[1])).triangles])
        ball = frame.mesh(0)
        self.assertEqual(len(ball.triangles), 320)
        np.testing.assert_allclose(np.linalg.norm(ball.vertices - frame.bodies.position[0], axis=1), 0.004, rtol=1e-12)
        self.assertLess(abs(ball.area / (4 * np.pi * 0.004**2) - 1), 0.02)
        self.assertEqual(len(frame.meshes(frame.bodies[:0]).triangles), 0)
        # bodies of another frame are those of the same ids, never others
        first = self.run_.frames[0]
        np.testing.assert_array_equal(frame.meshes(first.bodies[5:7]).vertices, frame.meshes(frame.bodies[5:7]).vertices)
        b = first.bodies
        b._store._arrays["VTKHDF/PointData/id"] = b.id + 1000  # as of bodies that have left since
        with self.assertRaisesRegex(scree.UnknownName, "body 1000"):
            frame.meshes(b)
        b._store._arrays["VTKHDF/PointData/id"] = b.id - 1000
        self.assertTrue(np.all(np.einsum("ij,ij->i", ball.normals, ball.vertices[ball.triangles[:, 0]] - frame.bodies.position[0]) > 0))

    def test_shapes_from_run_and_file(self):
        rock = self.run_.shapes["rock"]
        alone = scree.open_shapes(self.path("rock.shape.h5"))
        self.assertEqual(list(alone), ["rock"])
        self.assertEqual(alone.provenance["tool"], "scree-mesher")
        self.assertEqual(os.fspath(alone), self.path("rock.shape.h5"))
        np.testing.assert_array_equal(alone["rock"].vertices, rock.vertices)
        self.assertEqual(rock.triangles.shape, (60, 3))
        self.assertAlmostEqual(rock.mesh.volume / rock.volume, 1, delta=1e-9)
        self.assertAlmostEqual(rock.mesh.area / rock.area, 1, delta=1e-9)
        self.assertAlmostEqual(rock.equivalent_diameter, 0.008, delta=1e-6)
        self.assertLess(rock.bounding_radius, 0.01)
        self.assertEqual((rock.kind, rock.sphere_radius, self.run_.shapes["ball"].sphere_radius), ("solid", 0, 0.004))
        self.assertEqual(rock.inertia.shape, (3, 3))
        self.assertEqual(rock.origin_shift.shape, (3,))
        with self.assertRaisesRegex(scree.UnknownName, "ball, rock, plate"):
            self.run_.shapes["stone"]

    def test_scene_alone(self):
        scene = scree.open_scene(self.path("bed.scene.h5"))
        self.assertEqual(scene.pair("steel", "chalk")["friction"], 0.2)
        self.assertEqual([pair["between"] for pair in scene.pairs], [("chalk", "chalk"), ("chalk", "steel")])  # that can occur
        self.assertEqual(scene.settings["gravity"], [0, 0, -9.81])
        self.assertEqual(scene.start["position"].shape, (25, 3))
        self.assertEqual(scene.boundary_ids.tolist(), sorted([0, *(wall.id for wall in scene.walls.values())]))
        self.assertEqual(scene.case["title"], "a small bed")
        self.assertFalse(scene.periodicity.any)
        self.assertEqual(os.fspath(scene), self.path("bed.scene.h5"))
        self.assertIn("25 bodies", repr(scene))
        with self.assertRaises(scree.UnknownName):
            scene.pair("steel", "wood")

    def test_a_run_that_begins_with_another(self):
        case = scree.Case(self.path("bed.toml"))
        for key in ("bodies", "populations", "walls.1"):
            del case[key]
        case["start.run"] = "bed.run"
        case["time.duration"] = "1 ms"
        run = scree.solve(scree.pack(case, self.path("next.scene.h5"), progress=False), threads=1, progress=False)
        np.testing.assert_array_equal(run.frames[0].bodies.id, self.run_.bodies(-1).id)
        np.testing.assert_array_equal(run.frames[0].bodies.position, self.run_.bodies(-1).position)

    def test_log_and_ranks_are_columns_with_units(self):
        log = self.run_.log
        self.assertEqual((log.units["time"], log.units["kinetic_rotational"], log["step"].dtype.kind, log["state_hash"][0][:0]), ("s", "J", "i", ""))
        self.assertTrue(np.all(np.diff(log["time"]) > 0))
        late = log.where(log["time"] > 0.03)
        self.assertLess(late.rows, log.rows)
        self.assertEqual(set(self.run_.ranks["rank"]), {0, 1})
        with self.assertRaisesRegex(scree.UnknownName, "column 'tyme'"):
            log["tyme"]
        with self.assertRaisesRegex(scree.InputError, "steps.csv"):
            self.run_.steps
        with self.assertRaisesRegex(scree.InputError, "removed.csv"):
            self.run_.removed
        with self.assertRaisesRegex(scree.InputError, "inserted.csv"):
            self.run_.inserted

    def test_a_log_that_is_being_written_is_read_to_its_last_complete_row(self):
        table = scree.Table.read(os.path.join(self.run_.folder, "log.csv"))
        with open(os.path.join(self.run_.folder, "log.csv"), encoding="utf-8") as file:
            text = file.read()
        for cut in (3, len(text.splitlines()[-1]) // 2):
            with open(self.path("cut.csv"), "w", encoding="utf-8") as file:
                file.write(text[:-cut])
            self.assertEqual(scree.Table.read(self.path("cut.csv")).rows, table.rows - 1)

    def test_own_tables(self):
        table = scree.Table({"friction": [0.2, 0.4], "name": ["a, b", "c"]}, {"friction": "-"})
        again = scree.Table.read(table.write(self.path("own.csv")))
        self.assertEqual(again["friction"].tolist(), [0.2, 0.4])
        self.assertEqual(again["name"].tolist(), ["a, b", "c"])
        self.assertIn("2 rows", repr(again))
        self.assertIn("<td>0.2</td>", again._repr_html_())
        with self.assertRaisesRegex(scree.InputError, "different lengths"):
            scree.Table({"a": [1], "b": [1, 2]})

    def test_pictures_and_tables_for_notebooks(self):
        frame = self.run_.frames[-1]
        for page in (frame._repr_html_(), self.run_._repr_html_()):
            self.assertIn("<td>25</td>", page)
            self.assertIn("data:image/png;base64,iVBOR", page)
        for colour in ("shape", "material", "speed", frame.bodies.mass):
            ax = frame.plot(colour=colour, towards=(1, 1, -0.2))
            self.assertEqual(len(ax.collections), 1)
        with self.assertRaisesRegex(scree.UsageError, "shape, material, speed"):
            frame.plot(colour="rank")
        with mock.patch("scree.display._MOST_TRIANGLES", 0):  # outlines
            self.assertEqual(len(frame.plot(bodies=frame.bodies[:7]).collections[0].get_paths()), 7)
        self.assertIn("title", self.run_.case._repr_html_())

    def test_optional_packages_are_used_or_named(self):
        frame = self.run_.frames[-1]
        for call, package in ((frame.bodies.to_pandas, "pandas"), (frame.contacts.to_pandas, "pandas"), (frame.walls.to_pandas, "pandas"),
                              (self.run_.log.to_pandas, "pandas"), (frame.mesh(0).to_trimesh, "trimesh"), (frame.meshes().to_pyvista, "pyvista")):
            try:
                __import__(package)
            except ImportError:
                with self.assertRaisesRegex(scree.MissingPackage, f"pip install {package}"):
                    call()
            else:
                made = call()
                self.assertIn(package, type(made).__module__)
                if call == frame.bodies.to_pandas:
                    self.assertEqual((len(made), made.attrs["units"]["position_x"]), (25, "m"))
                    np.testing.assert_array_equal(made["quaternion_w"], frame.bodies.quaternion[:, 0])
                if package == "trimesh":
                    self.assertTrue(made.is_watertight)
                if package == "pyvista":
                    self.assertEqual(made.n_cells, len(frame.meshes().triangles))

    def test_what_other_packages_are_given(self):
        mesh = self.run_.frames[-1].meshes()
        trimesh, pyvista = mock.Mock(), mock.Mock()
        pyvista.PolyData.return_value.cell_data = {}
        with mock.patch.dict(sys.modules, trimesh=trimesh, pyvista=pyvista):
            mesh.to_trimesh()
            data = mesh.to_pyvista()
        (vertices, triangles), options = trimesh.Trimesh.call_args
        np.testing.assert_array_equal(vertices[triangles], mesh.vertices[mesh.triangles])
        np.testing.assert_array_equal(options["face_attributes"]["body"], mesh.body)
        (vertices, faces), _ = pyvista.PolyData.call_args
        np.testing.assert_array_equal(faces.reshape(-1, 4)[:, 1:], mesh.triangles)
        self.assertEqual(set(faces.reshape(-1, 4)[:, 0]), {3})
        np.testing.assert_array_equal(data.cell_data["body"], mesh.body)

    def test_what_is_wrong_is_said_with_the_file(self):
        with self.assertRaisesRegex(scree.InputError, "no such run folder"):
            scree.open(self.path("none.run"))
        with self.assertRaisesRegex(scree.InputError, "no such file"):
            scree.open_scene(self.path("none.scene.h5"))
        with self.assertRaisesRegex(scree.InputError, "'scree-shape' found, 'scree-scene' expected"):
            scree.open_scene(self.path("rock.shape.h5"))
        broken = self.path("broken.run")
        shutil.copytree(self.run_.folder, broken)
        os.truncate(os.path.join(broken, "frame_000002.hdf"), 1000)
        os.remove(os.path.join(broken, "run.json"))
        run = scree.open(broken)
        self.assertIsNone(run.outcome)
        self.assertIn("still being written", repr(run))
        self.assertEqual(run.provenance["tool"], "scree-solver")
        self.assertEqual(len(run.frames[1].bodies), 25)
        with self.assertRaisesRegex(scree.InputError, "frame_000002.hdf: the file is damaged"):
            run.frames[2].bodies.position
        self.refuses_hostile_frames(broken)
        os.remove(os.path.join(broken, "frames.hdf.series"))
        with self.assertRaisesRegex(scree.InputError, "no frames.hdf.series"):
            scree.open(broken)

    def refuses_hostile_frames(self, folder):
        """Of frame 1 in the folder of a run that has no run.json."""
        path = os.path.join(folder, "frame_000001.hdf")
        with open(path, "rb") as file:
            whole = file.read()

        def replaced(name, value):
            def change(file):
                del file[name]
                if value is not None:
                    file[name] = value
            return change

        def attribute(file):
            del file["frame"].attrs["kinetic"]
            file["frame"].attrs["kinetic"] = np.full(6000, 1.5)

        def unknown_wall(file):
            file["walls/id"][0] = -5
        data = "VTKHDF/PointData/"
        for change, use, says in (
                (replaced(data + "shape", np.full(25, -5)), lambda f: f.bodies.shape_name, "a shape that the scene does not have"),
                (replaced(data + "material", np.full(25, 99)), lambda f: f.bodies.mass, "a material that the scene does not have"),
                (replaced(data + "shape", np.full(25, 0.5)), lambda f: f.bodies.volume, "a column of integers expected"),
                (replaced(data + "velocity", np.zeros((25, 2))), lambda f: f.bodies.velocity, r"float64 of shape \(25, 2\) found, rows of 3 numbers expected"),
                (replaced(data + "id", np.zeros((25, 1), dtype=np.int64)), lambda f: f.bodies.scale, "a column of integers expected"),
                (unknown_wall, lambda f: f.wall_mesh("rock"), "its walls name wall -5, which the scene does not have"),
                (replaced("walls/position", np.zeros((0, 3))), lambda f: f.walls.position, "0 rows found, [1-9] expected"),
                (replaced(data + "scale", np.ones(3)), lambda f: f.bodies.id.size and f.bodies.scale, "3 rows found, 25 expected"),
                (replaced(data + "scale", np.full(25, b"x")), lambda f: f.bodies.scale, "a column of numbers expected"),
                (attribute, lambda f: f.kinetic, "the file is damaged")):
            with h5py.File(path, "r+") as file:
                change(file)
            with self.assertRaisesRegex(scree.InputError, f"frame_000001.hdf: .*{says}"):
                use(scree.open(folder).frames[1])
            with open(path, "wb") as file:
                file.write(whole)
        scene = os.path.join(folder, "scene.h5")
        with open(scene, "rb") as file:
            whole = file.read()
        for name, values, says in (("bodies/fixed", np.zeros(3, dtype=np.uint8), "3 rows found, 25 expected"), ("bodies/fixed", None, "no column bodies/fixed"),
                                   ("bodies/velocity", np.zeros(25), "rows of 3 numbers expected"),
                                   ("shapes/shape_0000/triangles", np.full((4, 3), 10**6), "a triangle of a vertex that it does not have")):
            with h5py.File(scene, "r+") as file:
                replaced(name, values)(file)
            with self.assertRaisesRegex(scree.InputError, f"scene.h5: .*{says}"):
                scree.open_scene(scene)
            with open(scene, "wb") as file:
                file.write(whole)
        with h5py.File(scene, "r") as file:
            settings = json.loads(file["settings"][()])
        for change, says in ((lambda f: f.update(settings=0.5), "settings: '0.5' found, a table expected"),
                             (lambda f: f["settings"].update(gravity=[1, 2]), r"gravity: '\[1, 2\]' found, 3 numbers expected"),
                             (lambda f: f["materials"][0].update(density="x"), "materials 0: density: 'x' found, a number expected"),
                             (lambda f: f["walls"][0].update(kind="hole"), "walls 0: kind: 'hole' found, one of plane"),
                             (lambda f: f["walls"].append(None), "walls [0-9]+: 'None' found, a table expected")):
            changed = copy.deepcopy(settings)
            change(changed)
            with h5py.File(scene, "r+") as file:
                replaced("settings", np.bytes_(json.dumps(changed).encode()))(file)
            with self.assertRaisesRegex(scree.InputError, f"scene.h5: .*{says}"):
                scree.open_scene(scene)
            with open(scene, "wb") as file:
                file.write(whole)
        record = os.path.join(folder, "run.json")
        for text, says in (('{"format": "scree-run", "outcome": 5}', "outcome: 5 found, a text"), ('{"format": "scree-run", "format_version": "x"}', "format_version"),
                           ("[" * 100000, "damaged"), ('{"format": "scree-run", "outcome": "completed", "message": "", "provenance": []}', "a table expected")):
            with open(record, "w", encoding="utf-8") as file:
                file.write(text)
            with self.assertRaisesRegex(scree.InputError, f"run.json: .*{says}"):
                scree.open(folder)
        os.remove(record)
        for text in ("step,x\n1," + "y" * 200000 + "\n", "step\n" + "9" * 400 + "\n"):
            with open(os.path.join(folder, "log.csv"), "w", encoding="utf-8") as file:
                file.write(text)
            try:
                scree.open(folder).log
            except scree.InputError:
                pass

    def test_things_of_one_name_are_all_there(self):
        plate = {"shape": {"plate": {"corner": [-0.01, -0.01, 0.075], "side_a": [0.02, 0, 0], "side_b": [0, 0.02, 0]}}, "material": "steel"}
        case = scree.Case.from_text(CASE, self.path("names.toml"))
        case["walls"] = [*case["walls"], {"name": "rock", **plate}, {"name": "rock", **plate}]
        case["time.duration"] = "1 ms"
        case["populations.0.count"] = 6
        run = scree.solve(scree.pack(case, self.path("names.scene.h5"), progress=False), threads=1, progress=False)
        self.assertEqual(run.frames[-1].walls.name, ["box", "plate", "rock", "rock"])
        self.assertEqual((list(run.walls), len(run.walls.in_order)), (["box", "plate", "rock"], 4))
        b = run.bodies()
        self.assertEqual(set(b.of_shape("rock").shape_name), {"rock"})
        np.testing.assert_allclose(b.of_shape("ball").volume, 4 / 3 * np.pi * 0.004**3, rtol=1e-12)
        self.assertEqual(len(run.scene.boundary_ids), 5)
        self.assertEqual(len(run.frames[-1].wall_mesh(run.walls.in_order[3].id).triangles), 2)

    def test_a_run_without_contacts_says_so(self):
        run = make(self.folder, name="silent", changes={"output.contacts": False, "time.duration": "1 ms", "output.every": "1 ms"})
        with self.assertRaisesRegex(scree.InputError, "kept no contacts"):
            run.frames[-1].contacts
        self.assertTrue(np.isnan(run.frames[-1].measures()["coordination_number"]))
        self.assertIn("not kept", run.frames[-1]._repr_html_())
        self.assertIn("--set output.contacts=false", run.case.text())


class ChunksTest(InFolder):
    def test_threads_read_what_hdf5_reads(self):
        import h5py
        from scree.chunks import read_array
        random = np.random.default_rng(1)
        path = self.path("chunks.h5")
        with h5py.File(path, "w") as file:
            for name, values in (("vectors", random.normal(size=(70001, 3))), ("ids", np.arange(200003)), ("indices", random.integers(0, 9, 300000, dtype=np.int32))):
                file.create_dataset(name, data=values, chunks=(16384, *values.shape[1:]), compression="gzip", shuffle=True)
            file.create_dataset("unshuffled", data=np.arange(200000), chunks=(16384,), compression="gzip")
            file.create_dataset("plain", data=np.arange(200000))
            file.create_dataset("big_endian", data=np.arange(200000, dtype=">i8"), chunks=(16384,), compression="gzip", shuffle=True)
            file.create_dataset("sparse", shape=(200000,), dtype="f8", chunks=(16384,), compression="gzip", shuffle=True)[20000:20010] = 1
        with mock.patch("scree.chunks._threads", lambda: 3), h5py.File(path) as file:
            for name, data in file.items():
                np.testing.assert_array_equal(read_array(path, data), data[()], err_msg=name)
            offset = file["vectors"].id.get_chunk_info(1).byte_offset
        with open(path, "r+b") as file:
            file.seek(offset)
            file.write(b"damaged")
        with mock.patch("scree.chunks._threads", lambda: 3), h5py.File(path) as file, self.assertRaises(zlib.error):
            read_array(path, file["vectors"])


class RegionTest(unittest.TestCase):
    def test_regions_have_the_rule_of_scree_post(self):
        points = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0.5, 0.5], [0, 0, 1], [0, 1, 0]], dtype=float)
        self.assertEqual(scree.Box([1, 1, 1], [0, 0, 0]).contains(points).tolist(), [True, False, True, False, False])
        self.assertEqual(scree.Cylinder([0, 0, 0], [0, 0, 1], 1).contains(points).tolist(), [True, False, True, False, False])
        self.assertEqual(scree.Sphere([0, 0, 0], 1).contains(points).tolist(), [True, False, True, False, False])
        self.assertEqual(scree.region("top=sphere:0,0,0,5 mm").radius, 0.005)
        cylinder = scree.region("cylinder:0,0,0,0,0,1 cm,2 mm")
        self.assertEqual((cylinder.start.tolist(), cylinder.end.tolist(), cylinder.radius), ([0, 0, 0], [0, 0, 0.01], 0.002))
        self.assertEqual(scree.region("box:1,1,1,0,0,0").lower.tolist(), [0, 0, 0])
        self.assertEqual(scree.Sphere([1, 2, 3], 1).centre.tolist(), [1, 2, 3])
        self.assertAlmostEqual(scree.Cylinder([0, 0, 0], [1, 1, 0], 2).volume, np.pi * 4 * np.sqrt(2))
        self.assertAlmostEqual(scree.Sphere([0, 0, 0], 3).volume, 36 * np.pi)
        self.assertEqual(scree.Box([0, 0, 0], [1, 2, 3]).volume, 6)
        self.assertEqual(scree.Box([0, 0, 0], [1, 2, 3]).upper.tolist(), [1, 2, 3])
        np.testing.assert_allclose(scree.Cylinder([0, 0, 0], [0, 0, 1], 2).bounds, [[-2, -2, 0], [2, 2, 1]])
        for text in ("cube:0,0,0,1,1,1", "box:0,0,0,1,1", "sphere:0,0,0,0", "cylinder:0,0,0,0,0,1,-1", "box:0,0,0,1,1,1 kg"):
            with self.assertRaises(scree.UsageError):
                scree.region(text)

    def test_images_in_a_periodic_domain(self):
        from scree.regions import Periodicity
        p = Periodicity([0, 0, 0], [1, 0, 0])
        points = np.array([[0.1, 0, 0], [0.5, 0, 0], [0.95, 0, 0]])
        self.assertEqual(p.contained(scree.Sphere([0, 0, 0], 0.2), points).tolist(), [True, False, True])
        np.testing.assert_allclose(p.wrap(np.array([[1.25, 3, 0], [-0.25, 0, 0]])), [[0.25, 3, 0], [0.75, 0, 0]])
        np.testing.assert_allclose(p.nearest(np.array([[0.75, 3, 0]])), [[-0.25, 3, 0]])

    def test_units(self):
        for text, value in (("2.5 mm", 0.0025), ("120 rpm", 4 * np.pi), ("7.8 g/cm^3", 7800), ("1 MN/m", 1e6), ("30 deg", np.pi / 6), ("3", 3),
                            ("1 1/s", 1), ("5 m/s²", 5), ("2 min", 120), ("1 mPa s", 1e-3), (4, 4)):
            self.assertAlmostEqual(scree.si(text) / value, 1, delta=1e-15, msg=text)
        for text in ("mm", "1 parsec", "1 m/", "1 m//s", "1 m %"):
            with self.assertRaises(scree.UsageError, msg=text):
                scree.si(text)
        with self.assertRaisesRegex(scree.UsageError, "not in units of m"):
            scree.si("1 kg", "m")

    def test_rotations(self):
        q = np.array([np.cos(0.3), 0, 0, np.sin(0.3)])
        np.testing.assert_allclose(scree.rotate(q, [1, 0, 0]), [np.cos(0.6), np.sin(0.6), 0], atol=1e-15)
        np.testing.assert_allclose(scree.rotation_matrix(q) @ [1, 2, 3], scree.rotate(q, [1, 2, 3]), atol=1e-15)
        mesh = scree.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        np.testing.assert_allclose(mesh.placed([0, 0, 5], q, 2).vertices[1], [2 * np.cos(0.6), 2 * np.sin(0.6), 5], atol=1e-15)
        self.assertEqual(len(scree.Mesh.joined([mesh, mesh]).triangles), 2)


if __name__ == "__main__":
    unittest.main()
