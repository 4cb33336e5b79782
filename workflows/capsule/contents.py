"""What the two JSON files of a capsule say, checked before any of it is used: ro-crate-metadata.json and capsule.json."""
import json
import re
import tomllib
from urllib.parse import unquote

from archive import Bad, wrong_name
from crate import METADATA, PROFILE
from recipe import PATHS, texts

CAPSULE = "capsule.json"
FORMAT, FORMAT_VERSION = "scree-capsule", 1
SHA256, STATE_HASH = r"[0-9a-f]{64}", r"[0-9a-f]{32}"
# commands of scree-mesher that make a shape file, and its options that write another file
MAKERS = {"import", "generate", "repair", "simplify", "refine", "hull", "remesh", "fracture"}
WRITERS = ("-o", "--output", "--picture")


def read_json(archive, name):
    if name not in archive.files:
        raise Bad(f"{archive.path}: has no {name}: it is no capsule of Scree, or was cut")
    try:
        value = json.loads(archive.read(name).decode())
    except (ValueError, RecursionError) as error:
        raise Bad(f"{archive.path}: {name} is no JSON: {error}") from None
    if not isinstance(value, dict):
        raise Bad(f"{archive.path}: {name}: expected an object")
    return value


def is_plain(text):
    """A text without NUL and without halves of characters, which no command line and no file name can have."""
    return isinstance(text, str) and not re.search("[\0\ud800-\udfff]", text)


class Reader:
    """Values of a JSON file, by what they must be; a wrong one is named by its place."""

    def __init__(self, where):
        self.where = where

    def wrong(self, place, found, expected):
        return Bad(f"{self.where}: {place}: {str(found)[:200]!r} found, expected {expected}")

    def get(self, value, place, key, kind, expected):
        if not isinstance(value, dict) or not isinstance(value.get(key), kind) or isinstance(value.get(key), bool) and kind is not bool:
            raise self.wrong(f"{place}.{key}", value.get(key, "nothing") if isinstance(value, dict) else value, expected)
        return value[key]

    def text(self, value, place, key, pattern=r"[\s\S]*", expected="a text"):
        text = self.get(value, place, key, str, expected)
        if not is_plain(text) or not re.fullmatch(pattern, text):
            raise self.wrong(f"{place}.{key}", text, expected)
        return text

    def list(self, value, place, key):
        return self.get(value, place, key, list, "a list")

    def count(self, value, place, key):
        number = self.get(value, place, key, int, "a whole number, >= 0")
        if number < 0:
            raise self.wrong(f"{place}.{key}", number, "a whole number, >= 0")
        return number

    def name(self, value, place, key, end=""):
        """A name in a folder of verify: it cannot lead out of this folder."""
        text = self.text(value, place, key)
        if wrong_name(text) or not text.endswith(end):
            raise self.wrong(f"{place}.{key}", text, f"the name of a file{' that ends with ' + end if end else ''}, without '..'")
        return text


def check_crate(archive):
    """RO-Crate 1.1: descriptor, root and one entity for each file, with the size and the sha256 that it has."""
    where = f"{archive.path}: {METADATA}"
    read = Reader(where)
    entities = {}
    for number, entity in enumerate(read.list(read_json(archive, METADATA), "", "@graph")):
        entities[read.text(entity, f"@graph[{number}]", "@id")] = entity
    descriptor = entities.get(METADATA, {})
    if descriptor.get("conformsTo") != {"@id": PROFILE} or descriptor.get("about") != {"@id": "./"} or entities.get("./", {}).get("@type") != "Dataset":
        raise Bad(f"{where}: has no metadata descriptor of {PROFILE} or no root dataset './'")
    root = entities["./"]
    for key in ("name", "description", "datePublished"):
        read.text(root, "./", key, r"[\s\S]+", "a text")
    read.get(root, "./", "license", dict, "the identifier of a licence")
    parts = {unquote(read.text(part, "./.hasPart", "@id")) for part in read.list(root, "./", "hasPart")}
    entities = {unquote(key): entity for key, entity in entities.items()}
    for name, (_, size, sha256) in archive.files.items():
        if name == METADATA:
            continue
        if name not in entities or name not in parts:
            raise Bad(f"{archive.path}: {name} is not among the files of {METADATA}; it was added after the capsule was made")
        if read.text(entities[name], name, "sha256", SHA256, "64 hexadecimal digits") != sha256:
            raise Bad(f"{archive.path}: {name} has other bytes than recorded: sha256 {sha256}, expected {entities[name]['sha256']}")
        if read.text(entities[name], name, "contentSize") != str(size):
            raise Bad(f"{where}: {name}: contentSize {entities[name]['contentSize']} found, expected {size}")
    for part in parts - {*archive.files}:
        raise Bad(f"{archive.path}: {part} is missing; {METADATA} has it")


def check_words(read, words, place, files, shapes):
    """Words of scree-mesher that make one shape from files of the capsule and earlier shapes, and write nothing else."""
    if not isinstance(words, list) or not words or not isinstance(words[0], str) or words[0] not in MAKERS:
        raise read.wrong(place, words, f"words that begin with one of: {', '.join(sorted(MAKERS))}")
    for number, word in enumerate(words):
        if isinstance(word, dict):
            name = word.get("file", word.get("shape"))
            if len(word) != 1 or not isinstance(name, str) or name not in (files if "file" in word else shapes):
                raise read.wrong(f"{place}[{number}]", word, "a file of the capsule or an earlier shape")
        elif not is_plain(word) or "/" in word or word == ".." or word.startswith(WRITERS):
            raise read.wrong(f"{place}[{number}]", word, "a word without a path that is no output")


def put(node, parts, value):
    """As --set of scree-decomposer: a key by its parts, a place of a list, '*' for all. A KeyError or IndexError where there is no such place."""
    part, rest = parts[0], parts[1:]
    if not isinstance(node, (dict, list)):
        raise KeyError(part)
    places = (list(node) if isinstance(node, dict) else range(len(node))) if part == "*" else [part if isinstance(node, dict) else int(part)]
    for place in places:
        if not rest:
            node[place] = value
        else:
            put(node.setdefault(place, {}) if isinstance(node, dict) else node[place], rest, value)


def as_computed(archive, run):
    """The case of a run with its settings."""
    case = tomllib.loads(archive.read(run["case"]).decode("utf-8-sig"))
    for setting in run["settings"]:
        key, _, text = setting.partition("=")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except ValueError:
            value = text.strip()   # a text without quotes
        try:
            put(case, [part.strip() for part in key.split(".")], value)
        except (KeyError, IndexError):
            raise ValueError(f"it has no place for the setting {setting[:200]!r}") from None
    return case


def check_case(archive, read, run, place, shapes):
    """The files that a case names, as its settings have changed them: shapes of the capsule, and the run that it begins with."""
    try:
        named = dict(texts(as_computed(archive, run)))
    except (ValueError, RecursionError) as error:
        raise read.wrong(f"{place}.case", run["case"], f"a file of the case language that its settings fit ({error})") from None
    start = f"{run.get('start')}.run"
    for key, text in named.items():
        if key == ("start", "run") and text != start:
            raise read.wrong(f"{place}: start.run of {run['case']}", text, f"'{start}'" if run.get("start") is not None else "no start, as in capsule.json")
        if key[-1] in PATHS and text not in shapes:
            raise read.wrong(f"{place}: {'.'.join(key)} of {run['case']}", text, "a shape of the capsule")


def check_capsule(archive):
    """The content of capsule.json. Its names stay inside the folder of verify, and its words start nothing but the three tools."""
    capsule = read_json(archive, CAPSULE)
    read = Reader(f"{archive.path}: {CAPSULE}")
    if capsule.get("format") != FORMAT:
        raise read.wrong("format", capsule.get("format"), FORMAT)
    if capsule.get("format_version") != FORMAT_VERSION:
        raise Bad(f"{archive.path}: {CAPSULE}: format_version {capsule.get('format_version')} found, this Scree reads {FORMAT_VERSION}; use the version of Scree that made the capsule, or a newer one")
    read.text(capsule, "", "title")
    tools = read.get(read.get(capsule, "", "versions", dict, "an object"), "versions", "tools", dict, "an object")
    for tool in ("scree-mesher", "scree-decomposer", "scree-solver"):
        if not all(isinstance(line, str) for line in read.list(tools, "versions.tools", tool)):
            raise read.wrong(f"versions.tools.{tool}", tools[tool], "a list of texts")

    left_out = {}
    for number, item in enumerate(read.list(capsule, "", "left_out")):
        place = f"left_out[{number}]"
        name = read.name(item, place, "name")
        read.count(item, place, "bytes")
        read.text(item, place, "sha256", SHA256, "64 hexadecimal digits")
        read.text(item, place, "how")
        if "path" in item:
            read.text(item, place, "path", r"/[^\0]+", "an absolute path")
        left_out[name] = item
    files = {*archive.files, *(name for name in left_out if name.startswith("meshes/"))}

    shapes = set()
    for number, shape in enumerate(read.list(capsule, "", "shapes")):
        place = f"shapes[{number}]"
        name = read.name(shape, place, "file", ".shape.h5")
        if "/" in name or name in shapes:
            raise read.wrong(f"{place}.file", name, "the name of a file, different from the other shapes")
        made_by = shape.get("made_by")
        if not isinstance(made_by, dict):
            check_words(read, made_by, f"{place}.made_by", files, shapes)
        elif read.text(made_by, f"{place}.made_by", "file") not in files:
            raise read.wrong(f"{place}.made_by", made_by, "a file of the capsule")
        shapes.add(name)

    runs = set()
    if not read.list(capsule, "", "runs"):
        raise read.wrong("runs", "an empty list", "at least one run")
    for number, run in enumerate(capsule["runs"]):
        place = f"runs[{number}]"
        name = read.name(run, place, "name")
        if "/" in name or name in runs or len(name.encode()) > 200:   # files get longer names
            raise read.wrong(f"{place}.name", name, "a name without '/' of at most 200 bytes, different from the other runs")
        if read.text(run, place, "case") not in archive.files:
            raise read.wrong(f"{place}.case", run["case"], "a file of the capsule")
        for setting in read.list(run, place, "settings"):
            if not is_plain(setting) or not re.match(r"[^-=][^=]*=", setting):
                raise read.wrong(f"{place}.settings", setting, "KEY=VALUE")
        if run.get("start") is not None and read.text(run, place, "start") not in runs:
            raise read.wrong(f"{place}.start", run["start"], "an earlier run")
        read.text(run, place, "state_hash", STATE_HASH, "32 hexadecimal digits")
        read.text(run, place, "git")
        read.count(run, place, "steps")
        if read.text(run, place, "log") not in archive.files:
            raise read.wrong(f"{place}.log", run["log"], "a file of the capsule")
        check_case(archive, read, run, place, shapes)
        runs.add(name)
    return capsule, left_out
