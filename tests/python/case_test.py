#!/usr/bin/env python3
"""Cases: read, changed, checked by the schema, written with their comments."""
import glob
import os
import tomllib
import unittest

import numpy as np
import scree
from scree.schema import case_schema, problems_of
from small_run import CASE, InFolder

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SHIPPED = sorted(glob.glob(os.path.join(ROOT, "decomposer", "schema", "cases", "*.toml")) + glob.glob(os.path.join(ROOT, "workflows", "*", "case*.toml")))


class CaseTest(InFolder):
    def test_shipped_cases_are_right_and_come_out_as_they_went_in(self):
        self.assertGreater(len(SHIPPED), 10)
        for path in SHIPPED:
            case = scree.Case(path)
            with open(path, encoding="utf-8") as file:
                self.assertEqual(case.text(), file.read(), path)
            self.assertEqual(case.problems(), [], path)

    def test_every_value_of_shipped_cases_can_be_written_anew(self):
        for path in SHIPPED:
            fresh = scree.Case()
            for name, value in scree.Case(path).data.items():
                fresh[name] = value
            self.assertEqual(tomllib.loads(fresh.text()), scree.Case(path).data)

    def test_keys_are_those_of_set(self):
        case = scree.Case.from_text(CASE)
        self.assertEqual(case["time.duration"], "60 ms")
        self.assertEqual(case["pairs.*.friction"], [0.4, 0.2, 0.1])
        self.assertEqual(case["materials.*.density"], [1500, "7.8 g/cm^3"])
        self.assertEqual(case["walls.1.name"], "plate")
        self.assertIn("contact.margin", case)
        self.assertNotIn("contact.law", case)
        case["contact.law"] = "hertz-mindlin"
        case["fluid.density"] = np.float64(1000)
        case["bodies.0.position"] = np.array([0, 0, 1])
        self.assertEqual((case["contact.law"], case["fluid"], case["bodies.0.position"]), ("hertz-mindlin", {"density": 1000.0}, [0, 0, 1]))
        del case["pairs.*.friction"]
        self.assertNotIn("pairs.0.friction", case)
        for key in ("time.nothing", "pairs.7.friction", "nothing"):
            with self.assertRaises(scree.UnknownName, msg=key):
                case[key]
        with self.assertRaisesRegex(scree.UsageError, "neither a table nor a list"):
            case["title.x"] = 1

    def test_comments_and_order_stay(self):
        case = scree.Case.from_text(CASE)
        case["time.duration"] = "1 s"
        case["pairs.0.friction"] = 0.55
        case["pairs.1.rolling_friction"] = 0.01
        del case["walls.1"]
        del case["output"]
        text = CASE.replace('"60 ms"', '"1 s"').replace("friction = 0.4          # as", "friction = 0.55         # as")
        text = text.replace("friction = 0.2\n", "friction = 0.2\nrolling_friction = 0.01\n")
        text = text[: text.index("[[walls]]\nname = \"plate\"")]
        self.assertEqual(case.text(), text)

    def test_new_tables_follow(self):
        case = scree.Case()
        case["title"] = 'a "title"\nof two lines'
        case["time.duration"] = 1e-05
        case["materials"] = {"stone": {"density": 2500}, "two words": {"density": 1}}
        case["pairs"] = [{"between": ["stone", "stone"], "stiffness": 1000.0, "restitution": 0.5}]
        case["walls"] = [{"shape": {"plane": {"point": (0, 0, 0), "normal": [0, 0, 1]}}, "material": "stone"}]
        self.assertEqual(case.text(), 'title = "a \\"title\\"\\nof two lines"\n\n[time]\nduration = 1e-05\n\n[materials.stone]\ndensity = 2500\n\n'
                         '[materials."two words"]\ndensity = 1\n\n[[pairs]]\nbetween = ["stone", "stone"]\nstiffness = 1000.0\nrestitution = 0.5\n\n'
                         '[[walls]]\nshape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }\nmaterial = "stone"\n')
        self.assertEqual(tomllib.loads(case.text()), case.data)
        case.check()
        self.assertIn("title, time, materials", repr(case))
        case["title"] = None
        with self.assertRaisesRegex(scree.UsageError, "no value of TOML"):
            case.text()

    def test_odd_texts_stay(self):
        text = ('# head\n\na.b = 1 # one\n"k = y" = "x # no comment" # yes\nl = [ 1, # first\n  2, ] # end\n\n[t] # table\nm = """\n# text\n"""\n'
                "\n  # on the list\n  [[p]]\n  x = 1\n  [[p.q]]\n  y = 'its'\n  [[p]]\n# tail")
        case = scree.Case.from_text(text)
        self.assertEqual(case.text(), text)
        case["a.b"] = 2
        case["l"] = [1, 2, 3]
        case["k = y"] = "z"
        changed = scree.Case.from_text(case.text())
        self.assertEqual(changed.data, case.data)
        self.assertIn('a.b = 2 # one\n"k = y" = "z"              # yes\nl = [1, 2, 3] # end\n', case.text())
        with self.assertRaisesRegex(scree.UsageError, "line 1"):
            scree.Case.from_text("x = = 1", "my.toml")

    def test_every_entry_of_a_list_has_its_own_lists(self):
        text = "".join(f"[[walls]]\nname = 'w{k}'\n" + "".join(f"[[walls.motion]]\n# {k} {m}\nx = {10 * k + m}\n" for m in range(k)) for k in (2, 0, 1))
        case = scree.Case.from_text(text + "[walls.motion.deep]\ny = 1\n")
        self.assertEqual([[m["x"] for m in wall.get("motion", [])] for wall in case["walls"]], [[20, 21], [], [10]])
        case["walls.2.motion.0.x"] = 7
        self.assertEqual(case.text(), text.replace("x = 10", "x = 7") + "[walls.motion.deep]\ny = 1\n")
        self.assertEqual(case._document.line_of(("walls", 2, "motion", 0, "x")), 15)

    def test_texts_as_editors_leave_them(self):
        path = self.path("marked.toml")
        with open(path, "w", encoding="utf-8-sig") as file:  # with a byte order mark
            file.write(CASE.replace("friction = 0.2", "frction = 0.2"))
        self.assertIn(f"{path}:29: pairs.1.frction", scree.Case(path).problems()[0])
        for text in ("# a\u2028 b\n[time]\nduration = 1\n", "[time] # x\u0085y\u000b\u000cz\nduration = 1\n".replace("\u000b\u000c", "")):
            case = scree.Case.from_text(text)
            case["time.duration"] = 2
            self.assertEqual(case.text(), text.replace("= 1", "= 2"))
        for text in ("[time]", "[[bodies]]", "[a]\n[a.b]"):
            case = scree.Case.from_text(text)
            self.assertEqual(tomllib.loads(case.text()), case.data)
            (case.data["time"] if "time" in text else case.data["bodies"][0] if "bodies" in text else case.data["a"]["b"])["x"] = 1
            self.assertEqual(tomllib.loads(case.text()), case.data)
        for text in (".".join(["a"] * 50000) + " = 1\n", "x = 1\n  [" + ".".join(['"a"'] * 50000) + "]\n", "a = " + "{ a = " * 5000 + "1" + " }" * 5000):
            with self.assertRaisesRegex(scree.UsageError, "tables within tables"):
                scree.Case.from_text(text)

    def test_a_number_in_quotes_is_one_in_si_units(self):
        case = scree.Case.from_text(CASE)
        case["populations.0.region"] = {"box": [["-4 cm", "-4 cm", "0"], ["0.04", "4 cm", " 9e-2 "]]}
        case.check()
        case["populations.0.region.box.0.2"] = "0 0"
        self.assertEqual(case.problems(), [])  # the tool knows units
        case["populations.0.region.box.0.2"] = "nothing"
        self.assertIn("populations.0.region", case.problems()[0])

    def test_problems_have_file_line_and_key(self):
        path = self.path("wrong.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CASE.replace("friction = 0.2", "frction = 0.2").replace('"60 ms"', '"soon"').replace("count = 24", "count = 2.5"))
        case = scree.Case(path)
        self.assertEqual(case.problems(), [f'{path}:6: time.duration: "soon": expected a number or a time [s], with its unit',
                                           f"{path}:29: pairs.1.frction: unknown key; did you mean friction?",
                                           f"{path}:48: populations.0.count: 2.5: expected a whole number"])
        with self.assertRaisesRegex(scree.UsageError, "did you mean friction"):
            case.check()
        with self.assertRaisesRegex(scree.UsageError, "did you mean friction"):
            case.save(self.path("not.toml"))
        self.assertFalse(os.path.exists(self.path("not.toml")))
        case["seed"] = 4  # lines are not known any more
        self.assertIn(f"{path}: pairs.1.frction: ", case.problems()[1])

    def test_verdicts_are_those_of_another_validator(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("python3-jsonschema is not installed")
        validator = jsonschema.Draft7Validator(case_schema())
        right = scree.Case.from_text(CASE)
        values = [None, True, -1, 0, 0.5, 2, "2 mm", "word", [], [1, 2, 3], ["1 mm", 2, 3], {}, {"box": [[0, 0, 0], [1, 1, 1]]}, "linear", "stokes"]
        keys = ["title", "seed", "gravity", "time", "time.duration", "time.step", "domain.periodic", "fluid", "fluid.drag", "shapes.rock", "shapes.rock.file",
                "materials", "materials.chalk.poisson", "pairs", "pairs.0.between", "pairs.0.restitution", "contact.law", "contact.relax", "contact.margin",
                "bodies.0.position", "bodies.0.fixed", "populations.0.count", "populations.0.size", "populations.0.region", "walls.0.shape", "walls.1.motion",
                "output.every", "nothing", "populations.0.fill", "walls.0.nothing"]
        wrong = 0
        for key in keys:
            for value in values:
                case = right.copy()
                case[key] = value
                ours, theirs = bool(list(problems_of(case.data, case_schema()))), not validator.is_valid(case.data)
                self.assertEqual(ours, theirs, f"{key} = {value}")
                wrong += ours
        self.assertGreater(wrong, 200)

    def test_saved_in_another_folder_paths_mean_the_same_files(self):
        os.makedirs(self.path("a/b"), exist_ok=True)
        with open(self.path("a/case.toml"), "w", encoding="utf-8") as file:
            file.write(CASE)
        case = scree.Case(self.path("a/case.toml"))
        case["walls.1.shape"] = {"file": "/abs/wall.shape.h5"}
        case["shapes.rock.pieces"] = "pieces.shape.h5"
        case["start"] = {"run": "../bed.run"}
        self.assertEqual(case.save(self.path("a/b/case.toml")), self.path("a/b/case.toml"))
        self.assertEqual(case.path, self.path("a/b/case.toml"))
        again = scree.Case(self.path("a/b/case.toml"))
        self.assertEqual((again["shapes.rock.file"], again["walls.1.shape.file"]), ("../rock.shape.h5", "/abs/wall.shape.h5"))
        self.assertEqual((again["shapes.rock.pieces"], again["start.run"]), ("../pieces.shape.h5", "../../bed.run"))
        again["seed"] = 9
        again.save()
        self.assertEqual(scree.Case(self.path("a/b/case.toml"))["seed"], 9)
        self.assertEqual(os.listdir(self.path("a/b")), ["case.toml"])
        with self.assertRaisesRegex(scree.UsageError, "give a path"):
            scree.Case().save()
        with self.assertRaisesRegex(scree.InputError, "cannot be read"):
            scree.Case(self.path("none.toml"))

    def test_bodies_from_arrays(self):
        case = scree.Case.from_text(CASE)
        case.add_bodies("rock", "chalk", np.arange(6).reshape(2, 3) / 100, quaternion=np.array([[1, 0, 0, 0], [0, 1, 0, 0]]), velocity=[0, 0, -1], scale=[1, 2])
        case.add_bodies("ball", "steel", [0, 0, 0.03], fixed=True)
        case.add_bodies("ball", "steel", np.zeros((0, 3)), quaternion=np.zeros((0, 4)), velocity=np.zeros((0, 3)), scale=np.zeros(0))  # a packing without any
        self.assertEqual(len(case["bodies"]), 4)
        self.assertEqual(case["bodies.2"], {"shape": "rock", "material": "chalk", "position": [0.03, 0.04, 0.05], "orientation": [0, 1, 0, 0],
                                            "velocity": [0, 0, -1], "scale": 2})
        self.assertTrue(case["bodies.3.fixed"])
        case.check()
        with self.assertRaisesRegex(scree.UsageError, "1 values of scale for 2"):
            case.add_bodies("rock", "chalk", [[0, 0, 0], [1, 1, 1]], scale=[1])
        self.assertEqual(scree.Case.from_text(case.text()).data, case.data)


if __name__ == "__main__":
    unittest.main()
