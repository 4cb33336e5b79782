"""How the runs of a folder were made, from what their files record: shapes, cases and starts, down to the meshes.

Every run.json has the command, the case and the inputs of the solver, of the packer and of the mesher, with the sha256 of each input. So a capsule
needs no Snakefile to compute a run again: it gives words to the three tools, and no program of its own.
"""
import hashlib
import json
import math
import os
import re
import sys
import tomllib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from own_case import PATHS, texts  # noqa: E402

# options with a value that do not change what is computed: outputs, and how a scene is divided
LEFT_OUT = {"-o", "--output", "--picture", "--ranks", "--preview", "--sizes", "--cut", "--solver"}


class Refused(Exception):
    """These runs cannot be put into a capsule: which, and why."""


class Missing(Refused):
    """A file that a result was made from is not there with the bytes that it had."""


def sha256_of(path, known={}):   # noqa: B006  (one memory for all calls: a mesh is used by many runs)
    stamp = os.stat(path)
    key = (path, stamp.st_mtime_ns, stamp.st_size)
    if key not in known:
        with open(path, "rb") as file:
            known[key] = hashlib.file_digest(file, "sha256").hexdigest()
    return known[key]


def split_words(words):
    """Of a command: its words without outputs, as (word, value of the option or None)."""
    words = iter(words)
    for word in words:
        option, equals, value = word.partition("=")
        if option in LEFT_OUT:
            if not equals:
                next(words, None)
        elif option == "--set":
            yield "--set", value if equals else next(words, "")
        else:
            yield word, None


class Recipe:
    """shapes and runs, in an order in which they can be made, as capsule.json has them; files: name in the capsule -> path."""

    def __init__(self, out):
        self.out = os.path.abspath(out)
        self.shapes, self.runs, self.files = [], [], {}
        self.run_names, self.shape_names = {}, {}   # folder -> name; words -> name
        self.taken = set()
        self.dates = []

    def unique(self, wanted):
        """A name that no other file of the capsule has: rock.shape.h5, rock-2.shape.h5, ..."""
        folder, base = os.path.split(wanted)
        stem, dot, end = base.partition(".")
        name, number = wanted, 1
        while name in self.taken:
            number += 1
            name = os.path.join(folder, f"{stem}-{number}{dot}{end}")
        self.taken.add(name)
        return name

    def find(self, given, folders):
        """The path of a recorded input that still has the bytes that it had."""
        for folder in folders:
            path = os.path.normpath(os.path.join(folder, given["path"]))
            if os.path.isfile(path) and sha256_of(path) == given["sha256"]:
                return path
        raise Missing(f"{given['path']}: is not there, or no longer has the bytes that it had when it was used (sha256 {given['sha256']}); "
                      "bring it back, or run the case again")

    def keep(self, wanted, path):
        """The name of a file in the capsule, which has it once."""
        for name, other in self.files.items():
            if name.startswith(os.path.dirname(wanted) + "/") and os.path.basename(name) == os.path.basename(wanted) and sha256_of(other) == sha256_of(path):
                return name
        name = self.unique(wanted)
        self.files[name] = path
        return name

    def shape(self, given, folders):
        """The name of a shape file, and how it is made."""
        history = given["history"]
        beside = [os.path.dirname(os.path.normpath(os.path.join(folder, given["path"]))) for folder in folders]
        try:
            if not isinstance(history, dict) or os.path.basename(history["command"][0]) != "scree-mesher":
                raise Missing(given["path"])
            words = self.mesher_words(history, [*folders, *beside])
        except Missing as reason:
            try:
                words = {"file": self.keep(f"meshes/{os.path.basename(given['path'])}", self.find(given, folders))}
            except Missing:
                raise reason from None
        key = json.dumps(words)
        if key not in self.shape_names:
            self.shape_names[key] = self.unique(os.path.basename(given["path"]))
            self.shapes.append({"file": self.shape_names[key], "made_by": words})
        return self.shape_names[key]

    def mesher_words(self, history, folders):
        inputs = {given["path"]: given for given in history["inputs"]}
        words = []
        for word, _ in split_words(history["command"][1:]):
            if word not in inputs:
                if "/" in word:
                    raise Refused(f"scree-mesher {word}: a path among the words of a shape that is none of its inputs")
                words.append(word)
            elif inputs[word]["history"]:
                words.append({"shape": self.shape(inputs[word], folders)})
            else:
                path = self.find(inputs[word], folders)
                words.append({"file": self.keep(f"meshes/{os.path.basename(path)}", path)})
        return words

    def run(self, folder):
        """The name of a run; what it begins with comes before it."""
        folder = os.path.abspath(folder)
        if folder in self.run_names:
            return self.run_names[folder]
        try:
            with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
                record = json.load(file)
            history = record["provenance"]
            scene = history["inputs"][0]["history"]
            pack = scene["command"]
        except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
            raise Refused(f"{folder}: has no run.json of a scene that was packed ({error!r})") from None
        if record["outcome"] != "completed":
            raise Refused(f"{folder}: the run is {record['outcome']}; a capsule has complete runs only")
        if os.path.basename(history["command"][0]) != "scree-solver" or os.path.basename(pack[0]) != "scree-decomposer" or pack[1] != "pack":
            raise Refused(f"{folder}: was made by {history['command'][0]} from a scene of {' '.join(pack[:2])}; a capsule has runs of scree-solver from scenes of "
                          "scree-decomposer pack only, which can be computed without other programs")
        base = os.path.dirname(folder)
        inside = os.path.relpath(folder, self.out)
        name = self.unique((os.path.basename(folder) if inside.startswith("..") else inside.replace("/", "-")).removesuffix(".run"))
        self.run_names[folder] = name
        self.runs.append(self.entry(name, folder, base, record, scene))   # after the run that it begins with: entry() adds that one
        self.dates.append(history["utc"])
        return name

    def check_start(self, folder, record, start):
        """A checkpoint that the clock wrote, or the end of a run that was stopped and went on, is not written when the run is computed again."""
        match = re.fullmatch(r"checkpoint_(\d+)\.h5", record.get("start", {}).get("file", ""))
        if match is None:
            return
        with open(os.path.join(start, "run.json"), encoding="utf-8") as file:
            before = json.load(file)
        step, every, dt = int(match[1]), before["settings"]["settings"].get("checkpoint_every", 0), before["step_size"]
        by_clock = before["settings"]["settings"].get("checkpoint_by_clock", True) or not every > 0
        # the first step at or after each whole number of intervals
        if step == before["steps"] or not by_clock and abs(step - math.ceil(round(step * dt / every) * every / dt - 1e-6)) < 1:
            return
        raise Refused(f"{folder}: begins with the checkpoint of step {step} of {start}, which the clock or an interruption wrote: computed again, that run writes none there. "
                      f"Give its case a checkpoint interval in time of the simulation ([output] checkpoint = \"...\"), or begin with its end, step {before['steps']}")

    def entry(self, name, folder, base, record, scene):
        settings, case = [], None
        for word, value in split_words(scene["command"][2:]):
            if word == "--set":
                settings.append(value)
            else:
                case = word
        inputs = scene["inputs"]
        case_path = self.find(next(given for given in inputs if given["path"] == case), [base])
        places = {os.path.normpath(os.path.join(base, given["path"])): given for given in inputs if given["history"]}
        start = None
        for key, text in texts(tomllib.loads(scene["configuration"])):
            place = os.path.normpath(os.path.join(base, os.path.dirname(case), text))
            found = None
            if key == ("start", "run"):
                self.check_start(folder, record, place)
                found = start = self.run(place)
                found += ".run"
            elif key[-1] in PATHS and place in places:
                found = self.shape(places[place], [base])
            if found is not None and found != text:
                if any(sign in part for part in key for sign in ".="):
                    raise Refused(f"{case}: {'.'.join(key)}: a name with a point or an equals sign cannot be set from outside; rename it")
                settings = [setting for setting in settings if setting.split("=")[0].strip() != ".".join(key)] + [f"{'.'.join(key)}={found}"]
        entry = {"name": name, "title": record["settings"]["settings"]["title"], "case": self.keep(f"cases/{name}.toml", case_path), "settings": settings, "start": start,
                 "record": f"runs/{name}/run.json", "log": f"runs/{name}/log.csv",
                 **{key: record[key] for key in ("state_hash", "steps", "time", "bodies", "wall_seconds", "ranks", "threads")},
                 "git": record["provenance"]["git"], "git_dirty": record["provenance"]["git_dirty"]}
        for key in ("record", "log"):
            self.files[entry[key]] = os.path.join(folder, os.path.basename(entry[key]))
        return entry
