#!/usr/bin/env python3
"""Every public name of the package is documented, tested, typed, and used in an example."""
import glob
import inspect
import os
import re
import unittest

import scree

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.join(HERE, "..", "..", "post", "python")


def text_of(paths):
    """The sources without their documentation texts."""
    texts = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            texts.append(re.sub(r'""".*?"""', "", file.read(), flags=re.S))
    return "\n".join(texts)


def used(name, text):
    return re.search(rf"\b{re.escape(name)}\b", text) is not None


def members():
    """(class, name, member) of all public attributes that a public class defines or inherits from this package."""
    for class_name in scree.__all__:
        kind = getattr(scree, class_name)
        if not inspect.isclass(kind):
            continue
        for base in kind.__mro__:
            if not base.__module__.startswith("scree"):
                continue
            for name, member in vars(base).items():
                if not name.startswith("_") and not name.startswith("exit_code"):
                    yield kind, name, member


def attributes_set(kind):
    """Names that __init__ of a class sets with a type, `self.name: type = ...`, or the fields of a dataclass."""
    if hasattr(kind, "__dataclass_fields__"):
        return list(kind.__dataclass_fields__)
    if "__init__" not in vars(kind):
        return []
    return re.findall(r"^\s+self\.([a-z]\w*): ", inspect.getsource(kind.__init__), flags=re.M)


class NamesTest(unittest.TestCase):
    tests = text_of(glob.glob(os.path.join(HERE, "*_test.py")) + glob.glob(os.path.join(HERE, "..", "engine", "*.py")))
    examples = text_of(glob.glob(os.path.join(PACKAGE, "examples", "*.py")))

    def test_all_is_what_there_is(self):
        self.assertEqual(scree.__all__, sorted(scree.__all__, key=lambda name: (name[0].islower(), name)))
        public = {name for name, value in vars(scree).items() if not name.startswith("_") and not inspect.ismodule(value)}
        self.assertEqual(public, set(scree.__all__))

    def test_everything_is_documented(self):
        for name in scree.__all__:
            self.assertTrue((getattr(scree, name).__doc__ or "").strip(), name)
        for kind, name, member in members():
            if isinstance(member, (staticmethod, classmethod)):
                member = member.__func__
            if callable(member) or isinstance(member, property) or hasattr(member, "__get__"):
                self.assertTrue((member.__doc__ or "").strip(), f"{kind.__name__}.{name}")

    def test_attributes_are_documented(self):
        for class_name in scree.__all__:
            kind = getattr(scree, class_name)
            if not inspect.isclass(kind):
                continue
            source = inspect.getsource(kind)
            for name in attributes_set(kind):
                in_doc = re.search(rf"\b{name}\b", kind.__doc__ or "") or re.search(rf"\b{name}\b", kind.__init__.__doc__ or "")
                lines = [i for i, line in enumerate(source.splitlines()) if re.match(rf"\s+(self\.)?{name}: ", line)]
                beside = any("#:" in line for i in lines for line in source.splitlines()[max(0, i - 1) : i + 1])
                self.assertTrue(in_doc or beside, f"{class_name}.{name}")

    def test_everything_is_tested(self):
        for name in scree.__all__:
            self.assertTrue(used(f"scree.{name}", self.tests) or any(used(m, self.tests) for m in self.made_by(name)), name)
        for kind, name, _ in members():
            self.assertTrue(used(name, self.tests), f"{kind.__name__}.{name}")
        for class_name in scree.__all__:
            for name in attributes_set(getattr(scree, class_name)) if inspect.isclass(getattr(scree, class_name)) else []:
                self.assertTrue(used(name, self.tests), f"{class_name}.{name}")

    def test_everything_is_in_an_example(self):
        for name in scree.__all__:
            self.assertTrue(used(f"scree.{name}", self.examples) or any(used(m, self.examples) for m in self.made_by(name)), name)

    @staticmethod
    def made_by(name):
        """What gives an object of a class that users do not make themselves."""
        return {"Frame": ["frames"], "Frames": ["frames"], "Bodies": ["bodies"], "Contacts": ["contacts"], "Walls": [r"walls"], "Run": ["scree.open", "scree.solve"],
                "Scene": ["scree.pack", "scree.open_scene"], "Shape": ["shapes"], "Shapes": ["scree.open_shapes", "scree.generate"],
                "Statistics": ["scree.statistics"], "Material": ["materials"], "Mesh": ["mesh", "meshes"], "Wall": ["walls"], "Result": ["scree.call"],
                "Region": ["scree.Box", "scree.region"], "Measurement": ["scree.measure"]}.get(name, [])

    def test_calls_are_typed(self):
        for name in scree.__all__:
            value = getattr(scree, name)
            functions = [value] if inspect.isfunction(value) else [m for _, m in inspect.getmembers(value, inspect.isfunction) if m.__module__.startswith("scree")]
            for function in functions:
                if function.__name__.startswith("_") and function.__name__ != "__init__":
                    continue
                signature = inspect.signature(function)
                for parameter in list(signature.parameters.values()):
                    if parameter.name not in ("self", "cls"):
                        self.assertIsNot(parameter.annotation, inspect.Parameter.empty, f"{function.__qualname__}: {parameter.name}")
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, function.__qualname__)
        self.assertTrue(os.path.exists(os.path.join(PACKAGE, "scree", "py.typed")))

    def test_the_version_is_that_of_scree(self):
        with open(os.path.join(HERE, "..", "..", "CMakeLists.txt"), encoding="utf-8") as file:
            self.assertIn(f"project(scree VERSION {scree.__version__} ", file.read())

    def test_everything_shows_what_it_is(self):
        for name in scree.__all__:
            value = getattr(scree, name)
            if inspect.isclass(value) and not issubclass(value, Exception) and name != "Region":
                self.assertIsNot(value.__repr__, object.__repr__, name)


if __name__ == "__main__":
    unittest.main()
