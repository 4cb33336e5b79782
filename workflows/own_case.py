"""What workflows/own_case.smk asks of a case file: the files that it names, and how those are made that are not there."""
import os
import re
import shlex
import tomllib

SHAPE = ".shape.h5"
# what scree-mesher import reads (mesher/io/mesh_file.cpp); a test holds the two equal
MESHES = (".stl", ".obj", ".ply", ".off", ".bmf", ".3ds", ".dae", ".fbx", ".blend", ".x3d", ".ac", ".lwo", ".step", ".stp", ".brep")
WORDS = "meshes.toml"
# keys of a case that name a shape file (CASE.md); a title, or a name, may end like one
PATHS = ("file", "pieces", "inside")


class Wrong(Exception):
    """The user can put it right: where, what was found, what was expected."""


def read_toml(path):
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:  # an editor may begin it with a byte order mark
            value = tomllib.loads(file.read())
        sum(1 for _ in texts(value))
        return value
    except OSError as error:
        raise Wrong(f"{path}: {error.strerror}; give the path of a case file") from None
    except RecursionError:
        raise Wrong(f"{path}: tables within tables that no case has; look at it with: scree-decomposer check {path}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Wrong(f"{path}: {error}; correct the TOML, or look at it with: scree-decomposer check {path}") from None


def texts(value, key=()):
    """Every text of a case with the key that leads to it."""
    if isinstance(value, str):
        yield key, value
    elif isinstance(value, dict):
        for name, part in value.items():
            yield from texts(part, (*key, name))
    elif isinstance(value, list):
        for number, part in enumerate(value):
            yield from texts(part, (*key, str(number)))


class OwnCase:
    """name: of the run. shapes: name -> words of scree-mesher. words: for scree-decomposer pack. inputs: files that the case is made of."""

    def __init__(self, path, results):
        self.path = os.path.abspath(path)
        self.folder, file = os.path.split(self.path)
        self.name = re.sub(r"[^A-Za-z0-9_.-]+", "-", file.removesuffix(".toml")).strip("-.") or "case"
        case = read_toml(self.path)
        said_in = os.path.join(self.folder, WORDS)
        said = read_toml(said_in) if os.path.exists(said_in) else {}
        for name, words in said.items():
            if not isinstance(words, str):
                raise Wrong(f"{said_in}: {name}: expected the words for scree-mesher, for instance {name} = \"import {name}.stl --unit mm\"")

        used = {}   # file -> the keys that name it
        for key, text in texts(case):
            if text.endswith(SHAPE) and key[-1] in PATHS:
                used.setdefault(text, []).append(key)
        self.shapes, self.inputs, words, made_from, asked = {}, [], [], {}, set()
        for file, keys in used.items():
            said_as = os.path.basename(file).removesuffix(SHAPE)
            name = said_as.replace("{", "(").replace("}", ")")  # braces are wildcards of Snakemake
            there = os.path.join(self.folder, file)
            if said_as not in said and os.path.exists(there):
                self.inputs.append(there)
                continue
            if made_from.setdefault(name, there) != there:
                raise Wrong(f"{self.path}: {file} and {made_from[name]} would both be made as {name}{SHAPE}; give them different names")
            self.shapes[name] = self.words_of(said[said_as], said_in, said_as) if said_as in said else self.import_of(there, keys)
            asked.add(said_as)
            made = os.path.join(results, name + SHAPE)
            for key in keys:
                if any(sign in part for part in key for sign in ".="):
                    raise Wrong(f"{self.path}: {'.'.join(key)}: a name with a point or an equals sign cannot be set from outside; rename it")
                words += ["--set", f"{'.'.join(key)}={made}"]
        for name in said:
            if name not in asked:
                raise Wrong(f"{said_in}: {name}: the case names no {name}{SHAPE}; it names: {', '.join(sorted(used)) or 'no shape files'}")
        start = case.get("start", {})
        if isinstance(start, dict) and isinstance(start.get("run"), str):
            self.inputs.append(os.path.join(self.folder, start["run"], "run.json"))
        self.words = shlex.join(words)

    def words_of(self, text, where, name):
        """Files of the folder of the case by their whole paths, since the steps run in the folder of the results."""
        try:
            words = shlex.split(text)
        except ValueError as error:
            raise Wrong(f"{where}: {name}: {error} in: {text}") from None
        if not words:
            raise Wrong(f"{where}: {name}: expected the words for scree-mesher, for instance \"import {name}.stl --unit mm\"")
        return shlex.join([words[0], *map(self.with_whole_path, words[1:])])

    def with_whole_path(self, word):
        option, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
        path = os.path.join(self.folder, value)
        return option + equals + path if not value.startswith("-") and os.path.isfile(path) else word

    def import_of(self, shape, keys):
        beside = os.path.dirname(shape)
        name = os.path.basename(shape).removesuffix(SHAPE)
        found = sorted(file for file in (os.listdir(beside) if os.path.isdir(beside) else [])
                       if os.path.splitext(file)[0] == name and os.path.splitext(file)[1].lower() in MESHES)
        named_at = f"{self.path}: {'.'.join(keys[0])}: {os.path.relpath(shape, self.folder)}"
        if not found:
            raise Wrong(f"{named_at} is not there, and no mesh to make it from: expected {name}.stl, {name}.obj or another mesh in {beside}, "
                        f"or a line in {os.path.join(self.folder, WORDS)}: {name} = \"import FILE --unit mm\"")
        if len(found) > 1:
            raise Wrong(f"{named_at} could be made from {' or '.join(found)}; keep one, or choose in {os.path.join(self.folder, WORDS)}: "
                        f"{name} = \"import {found[0]}\"")
        surface = ["--surface"] if all(key[0] == "walls" for key in keys) else []
        return shlex.join(["import", os.path.join(beside, found[0]), *surface])
