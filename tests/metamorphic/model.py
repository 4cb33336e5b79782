"""A case of the case language as data: the words of its TOML file and the meshes that it names.

words    the tables of the case as Python holds them; a file of the mesher is "@NAME", NAME being one of the meshes
meshes   NAME: Mesh; vertices are exact in single precision, so that no importer rounds them
"""
import copy
import json
import os

import numpy


class Mesh:
    """vertices V x 3 [m], triangles T x 3; surface: of a wall, may be open."""

    def __init__(self, vertices, triangles, surface=False):
        self.vertices = numpy.asarray(vertices, float).reshape(-1, 3)
        self.triangles = numpy.asarray(triangles, int).reshape(-1, 3)
        self.surface = surface

    def off(self):
        lines = [f"OFF\n{len(self.vertices)} {len(self.triangles)} 0\n"]
        lines += ["%.17g %.17g %.17g\n" % tuple(v) for v in self.vertices]
        lines += ["3 %d %d %d\n" % tuple(t) for t in self.triangles]
        return "".join(lines)


class Case:
    def __init__(self, words, meshes=None, note=""):
        self.words, self.meshes, self.note = words, meshes or {}, note

    def copy(self):
        return Case(copy.deepcopy(self.words), dict(self.meshes), self.note)

    # what most relations ask
    def table(self, name):
        return self.words.setdefault(name, {})

    @property
    def bodies(self):
        return self.words.setdefault("bodies", [])

    @property
    def walls(self):
        return self.words.setdefault("walls", [])

    @property
    def populations(self):
        return self.words.get("populations", [])

    @property
    def gravity(self):
        return numpy.array(self.words.get("gravity", [0, 0, -9.81]), float)

    def periodic(self):
        return self.words.get("domain", {}).get("periodic", [])

    def value(self, table, key, default=None):
        return self.words.get(table, {}).get(key, default)

    def text(self, file_of=lambda name: name + ".shape.h5"):
        """The case as TOML; file_of gives the path of a mesh's shape file."""
        return toml_text(with_files(self.words, file_of))

    def write(self, folder):
        """case.json, and for the eye and the hand the same as case.toml with its meshes and the commands that make them."""
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, "case.json"), "w") as file:
            json.dump(self.to_json(), file, indent=1)
            file.write("\n")
        with open(os.path.join(folder, "case.toml"), "w") as file:
            for name, mesh in self.meshes.items():
                file.write(f"# scree-mesher import {name}.off -o {name}.shape.h5{' --surface' if mesh.surface else ''}\n")
            file.write(self.text())
        for name, mesh in self.meshes.items():
            with open(os.path.join(folder, name + ".off"), "w") as file:
                file.write(mesh.off())

    def to_json(self):
        return {"note": self.note, "words": self.words,
                "meshes": {name: {"vertices": mesh.vertices.tolist(), "triangles": mesh.triangles.tolist(), "surface": mesh.surface}
                           for name, mesh in self.meshes.items()}}


def case_from_json(data):
    return Case(data["words"], {name: Mesh(m["vertices"], m["triangles"], m["surface"]) for name, m in data.get("meshes", {}).items()},
                data.get("note", ""))


def read_case(path):
    with open(path) as file:
        return case_from_json(json.load(file))


def with_files(value, file_of):
    if isinstance(value, str):
        return file_of(value[1:]) if value.startswith("@") else value
    if isinstance(value, dict):
        return {key: with_files(entry, file_of) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [with_files(entry, file_of) for entry in value]
    return value


def used_meshes(words):
    """Names of the meshes that the words name."""
    found = set()
    with_files(words, lambda name: found.add(name) or name)
    return found


def toml_value(value):
    """Numbers keep all their digits."""
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{toml_key(key)} = {toml_value(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, (list, tuple, numpy.ndarray)):
        return "[" + ", ".join(toml_value(entry) for entry in value) + "]"
    if isinstance(value, (int, numpy.integer)):
        return str(int(value))
    return repr(float(value))


def toml_key(key):
    return key if key.replace("_", "").replace("-", "").isalnum() and key.isascii() else json.dumps(key)


def toml_text(words):
    lines = [f"{key} = {toml_value(value)}" for key, value in words.items() if not isinstance(value, dict) and not is_tables(value)]
    for name, value in words.items():
        if name in ("shapes", "materials"):
            for inner, table in value.items():
                lines += ["", f"[{name}.{toml_key(inner)}]"] + [f"{key} = {toml_value(entry)}" for key, entry in table.items()]
        elif isinstance(value, dict):
            lines += ["", f"[{name}]"] + [f"{key} = {toml_value(entry)}" for key, entry in value.items()]
        elif is_tables(value):
            for table in value:
                lines += ["", f"[[{name}]]"] + [f"{key} = {toml_value(entry)}" for key, entry in table.items()]
    return "\n".join(lines) + "\n"


def is_tables(value):
    return isinstance(value, list) and bool(value) and all(isinstance(entry, dict) for entry in value) or value == []
