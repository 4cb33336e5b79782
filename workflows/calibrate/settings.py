"""What a calibration is asked for: the words of --config, read and checked. Errors are ValueErrors that say what was found, what was expected and
what to do. Nothing is run here."""
import difflib
import math
import os
import re
import sys
from dataclasses import dataclass

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from case_keys import Wrong, problem_of  # noqa: E402
from config_words import snakefile_of, words_of  # noqa: E402
from run_record import NUMBER, unit_of  # noqa: E402
from sweep_quantity import OF_BODIES, OF_WALLS  # noqa: E402

# of this folder: words of scree-post statistics
SCENES = {"heap": "--frames last --repose cone", "drum": "--from 0.4 --repose slope", "slide": "--frames last"}
OWN = "calibrate"
KINDS = ("mean", "last", "min", "max")
EXAMPLE = {"target": "heap:angle_of_repose=15+-1;drum:angle_of_repose=37+-1", "keys": "pairs.0.friction=0.05..0.8;pairs.0.rolling_friction=0..0.5"}
# the other words of --config, and what they are when not given; all else goes on to the workflow of the case
DEFAULTS = {"case": "heap", "set": "", "budget": 56, "start": None, "replicas": 3, "batch": 4, "stop": 0.3, "seed": 1, "experiments": None, "survey": 12}
# word of --config that is read here -> its default as a text
WORDS = {"target": "", "keys": "", **{name: str(value or "") for name, value in DEFAULTS.items()}}
NOT_WORDS = ("points", "plot", "sweep")   # of the workflows of the cases: those that calibrate.py sets, or that make no sense with it
OF_GATES = ["mass_flow", "residence_time"]
MOST_KEYS = 6
FEWEST = 6            # answers that a surrogate is made from
REPLICATED = 2        # points that are run with several seeds
SIGMAS = 1.959964     # of a Gaussian's 95 % interval


@dataclass(frozen=True)
class Scene:
    name: str                # heap, or CASE, or CASE/RUN: as it stands in target; of a case file its name without .toml
    case: str                # the word for workflows/run: a name, or the path of a case file
    run: str | None          # of its runs; None: its only one

    @property
    def folder(self):
        """Of its runs, in that of the results."""
        return os.path.join("runs", self.name if self.case.endswith(".toml") else self.case)


@dataclass(frozen=True)
class Key:
    name: str                # its first path
    paths: tuple             # of (scene or None for all, path in the case)
    low: float               # in the unit
    high: float
    unit: str
    log: bool

    def value(self, x):
        """At x, 0 to 1: a number in the unit of the key."""
        if self.log:
            return math.exp(math.log(self.low) + x * (math.log(self.high) - math.log(self.low)))
        return self.low + x * (self.high - self.low)

    def place(self, value):
        if self.log:
            return (math.log(value) - math.log(self.low)) / (math.log(self.high) - math.log(self.low))
        return (value - self.low) / (self.high - self.low)

    def text(self, x):
        """For --set."""
        return f"{self.value(x):.6g} {self.unit}".strip()


@dataclass(frozen=True)
class Target:
    scene: Scene
    quantity: str
    group: str
    kind: str
    text: str                # value, uncertainty and unit as they were given
    value: float
    uncertainty: float       # half of the 95 % interval
    unit: str                # "": that of the summary

    @property
    def name(self):
        return f"{self.scene.name}:{self.quantity}" + (f"@{self.group}" if self.group != "all" else "") + (f".{self.kind}" if self.kind != "mean" else "")

    @property
    def deviation(self):
        return self.uncertainty / SIGMAS


@dataclass(frozen=True)
class Settings:
    targets: tuple
    keys: tuple
    fixed: tuple             # (scene or None, KEY=VALUE)
    budget: int
    start: int               # points of the first design
    replicas: int
    batch: int
    stop: float
    seed: int
    survey: int              # runs of each experiment that has no target
    experiments: tuple       # scenes without a target, of which one may be proposed
    words: tuple             # for workflows/run --config

    @property
    def scenes(self):
        return list(dict.fromkeys(target.scene for target in self.targets))

    @property
    def first_runs(self):
        return (self.start + min(REPLICATED, self.start) * (self.replicas - 1)) * len(self.scenes)


def parts_of(text):
    return [part.strip() for part in text.split(";") if part.strip()]


def scene_of(name, folder, what):
    if name.endswith(".toml"):
        path = os.path.abspath(os.path.join(folder, name))
        if not os.path.isfile(path):
            raise ValueError(f"{what}: there is no case file {path}; give its path from the folder where workflows/run is called, or from /")
        return Scene(os.path.basename(path).removesuffix(".toml"), path, None)
    if name in SCENES:
        return Scene(name, OWN, name)
    case, slash, run = name.partition("/")
    if not re.fullmatch(r"[A-Za-z0-9_-]+", case) or (slash and not run):
        raise ValueError(f"{what}: '{name}' found as a scene; expected {', '.join(SCENES)}, a case such as column, CASE/RUN such as repose/repose-ball, or PATH/case.toml")
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    if case == OWN or not os.path.isfile(os.path.join(here, case, "Snakefile")):
        there = sorted(name for name in os.listdir(here) if os.path.isfile(os.path.join(here, name, "Snakefile")) and name != OWN)
        raise ValueError(f"{what}: there is no scene and no case '{case}'; scenes: {', '.join(SCENES)}; cases: {', '.join(there)}")
    return Scene(name, case, run or None)


def target_of(part, default, folder):
    match = re.fullmatch(rf"(?:(?P<scene>[^:=@]*):)?\s*(?P<quantity>\w+)(?:@(?P<group>[^=]*?))?(?:\.(?P<kind>\w+))?\s*=\s*(?P<value>{NUMBER})\s*(?P<unit>[^+±]*?)\s*"
                         rf"(?:\+-|±)\s*(?P<uncertainty>{NUMBER})\s*(?P<after>.*)", part)
    if not match:
        raise ValueError(f"target: '{part}' found; expected [SCENE:]QUANTITY[.last]=VALUE+-UNCERTAINTY[ UNIT], for instance heap:angle_of_repose=34+-1. "
                         "The uncertainty is half of the 95 % interval")
    kind = match["kind"] or "mean"
    if kind not in KINDS:
        raise ValueError(f"target: '{part}': there is no '.{kind}' of a quantity; use one of: {', '.join(KINDS)}")
    unit = match["unit"].strip() or match["after"].strip()
    if match["unit"].strip() and match["after"].strip() and match["unit"].strip() != match["after"].strip():
        raise ValueError(f"target: '{part}': two units; write value and uncertainty in one")
    if unit and unit_of(unit) is None:
        raise ValueError(f"target: '{part}': '{unit}' is no unit that Scree knows")
    uncertainty = float(match["uncertainty"])
    if not math.isfinite(float(match["value"])) or not math.isfinite(uncertainty):
        raise ValueError(f"target: '{part}': a number is too large")
    if not uncertainty > 0:
        raise ValueError(f"target: '{part}': the uncertainty is {uncertainty:g}; expected one above 0: half of the 95 % interval of the measurement")
    return Target(scene_of((match["scene"] or "").strip() or default, folder, "target"), match["quantity"], (match["group"] or "all").strip(), kind, part.split("=", 1)[1].strip(),
                  float(match["value"]), uncertainty, unit)


def path_of(text, scenes, what):
    """(scene or None, path) of [SCENE:]PATH."""
    prefix, colon, path = text.strip().rpartition(":")
    names = [scene.name for scene in scenes]
    if colon and prefix.strip() not in names:
        raise ValueError(f"{what}: '{text.strip()}': no target has the scene '{prefix.strip()}'; there are: {', '.join(names)}")
    path = path.strip()
    if not re.fullmatch(r"[^\s.=]+(\.[^\s.=]+)*", path):
        raise ValueError(f"{what}: '{text.strip()}' found; expected a key of the case such as pairs.0.friction (decomposer/CASE.md)")
    return (prefix.strip() if colon else None), path


def covers(one, other):
    """Whether the first of two (scene or None, path) changes all that the second does; '*' stands for any part."""
    (scene, path), (of, others) = one, other
    parts, their = ([part.lstrip("0") or "0" if part.isdigit() else part for part in text.split(".")] for text in (path, others))
    return (scene is None or of is None or scene == of) and len(parts) == len(their) and all(a in ("*", b) for a, b in zip(parts, their))


def key_of(part, scenes):
    names, equals, bounds = part.partition("=")
    low_text, dots, high_text = bounds.partition("..")
    words = high_text.split()
    log = bool(words) and words[-1] == "log"
    high_text = high_text.strip().removesuffix("log").strip() if log else high_text.strip()
    low, high = re.fullmatch(rf"\s*({NUMBER})\s*(.*?)\s*", low_text), re.fullmatch(rf"({NUMBER})\s*(.*)", high_text)
    if not equals or not dots or not low or not high:
        raise ValueError(f"keys: '{part}' found; expected KEY=LOWER..UPPER, for instance pairs.0.friction=0.1..0.8 or pairs.*.stiffness=1 kN/m..50 kN/m log")
    unit = high[2] or low[2]
    if unit and unit_of(unit) is None or low[2] and unit_of(low[2]) is None:
        raise ValueError(f"keys: '{part}': '{unit if unit_of(unit) is None else low[2]}' is no unit that Scree knows")
    bottom, top = float(low[1]), float(high[1])
    if not math.isfinite(bottom) or not math.isfinite(top):
        raise ValueError(f"keys: '{part}': a bound is too large")
    if low[2] and low[2] != unit:
        if unit_of(low[2])[1] != unit_of(unit)[1]:
            raise ValueError(f"keys: '{part}': the bounds have units of different kinds, {low[2]} and {unit}")
        bottom *= unit_of(low[2])[0] / unit_of(unit)[0]
    if not bottom < top:
        raise ValueError(f"keys: '{part}': the lower bound {low_text.strip()} is not below the upper bound {high_text}; write LOWER..UPPER")
    if log and not bottom > 0:
        raise ValueError(f"keys: '{part}': a logarithmic scale needs a lower bound above 0, found {low_text.strip()}")
    paths = tuple(path_of(text, scenes, "keys") for text in names.split(","))
    for _, path in paths:
        if path == "seed":
            raise ValueError("keys: 'seed' is what replicas differ in; it cannot be fitted")
    return Key(paths[0][1], paths, bottom, top, unit, log)


def experiments_of(text, scenes, folder):
    """The scenes that have no target, and may be proposed. Those of this folder have their grains in the same places of the case; of another case only its
    author knows what the keys are there."""
    if text is None:
        names = SCENES if all(scene.case == OWN for scene in scenes) else ()
    else:
        names = [] if text.strip() == "none" else parts_of(text)
    found = [scene_of(name, folder, "experiments") for name in names]
    for scene in found:
        if [other.name for other in found].count(scene.name) > 1:
            raise ValueError(f"experiments: {scene.name} is there twice")
        if text is not None and scene in scenes:
            raise ValueError(f"experiments: {scene.name} has a target; give scenes that have none, or experiments=none")
    return tuple(scene for scene in found if scene not in scenes)


def number_of(config, name, kind, low):
    value = config.get(name, DEFAULTS[name])
    if value is None:
        return None
    try:
        number = kind(str(value))
    except ValueError:
        number = None
    if number is None or not number >= low:
        raise ValueError(f"{name}={value} found; expected a {'whole ' if kind is int else ''}number, at least {low}")
    return number


def plain(value):
    """The text of a word of --config; Snakemake reads it as YAML, which makes a table of 'a: b'."""
    if isinstance(value, dict):
        return ";".join(f"{key}:{plain(entry)}" for key, entry in value.items())
    return str(value)


def read(config, folder="."):
    """Settings of the words of --config. folder: what paths of cases are relative to."""
    config = {name: plain(value) for name, value in config.items() if value is not None}
    if ("target" in config) != ("keys" in config):
        there, missing = ("target", "keys") if "target" in config else ("keys", "target")
        raise ValueError(f"{there} is given without {missing}; for instance {missing}=\"{EXAMPLE[missing]}\"")
    asked = {**EXAMPLE, **config}
    default = asked.get("case", DEFAULTS["case"])
    targets = tuple(target_of(part, default, folder) for part in parts_of(asked["target"]))
    if not targets:
        raise ValueError(f"target: there is none; for instance target=\"{EXAMPLE['target']}\"")
    names = [target.name for target in targets]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"target: {name} is there twice; give the mean of the measurements, with its uncertainty")
    scenes = list(dict.fromkeys(target.scene for target in targets))
    for scene in scenes:
        if [other.name for other in scenes].count(scene.name) > 1:
            raise ValueError(f"target: two scenes are called {scene.name}; give one of the case files another name")
    experiments = experiments_of(config.get("experiments"), scenes, folder)
    keys = tuple(key_of(part, scenes) for part in parts_of(asked["keys"]))
    if not 1 <= len(keys) <= MOST_KEYS:
        raise ValueError(f"keys: {len(keys)} found; expected 1 to {MOST_KEYS}")
    paths = [path for key in keys for path in key.paths]
    for number, path in enumerate(paths):
        for other in paths[:number]:
            if covers(path, other):   # the later one counts
                raise ValueError(f"keys: {path[1]} is there twice" if path == other else f"keys: {path[1]} replaces {other[1]}; give it first, or leave one out")
    fixed = []
    for part in parts_of(asked.get("set", "")):
        path, equals, value = part.partition("=")
        if not equals or not value.strip():
            raise ValueError(f"set: '{part}' found; expected KEY=VALUE, for instance populations.0.count=400")
        scene, path = path_of(path, [*scenes, *experiments], "set")
        if path == "seed":
            raise ValueError("set: 'seed' is what replicas differ in; give seed=NUMBER to begin with another one")
        for key in paths:
            if covers(key, (scene, path)):
                raise ValueError(f"set: the key {key[1]} replaces {path}; leave one out")
        fixed.append((scene, f"{path}={value.strip()}"))
    numbers = {name: number_of(config, name, kind, low) for name, kind, low in (
        ("budget", int, 1), ("start", int, 4), ("replicas", int, 1), ("batch", int, 1), ("stop", float, 0), ("seed", int, 0), ("survey", int, FEWEST))}
    numbers["start"] = numbers["start"] or 8 + 4 * len(keys)
    words = {"ranks": "1", **{name: value for name, value in config.items() if name not in WORDS}}
    settings = Settings(targets, keys, tuple(fixed), **numbers, experiments=experiments, words=tuple(f"{name}={value}" for name, value in words.items()))
    each = settings.first_runs // len(scenes)
    if each < FEWEST:
        raise ValueError(f"start={settings.start} with replicas={settings.replicas} makes {each} runs of a scene; a fit needs {FEWEST} at least: give start={FEWEST} or more")
    if settings.first_runs > settings.budget:
        raise ValueError(f"budget={settings.budget} is too small: the first design takes {settings.first_runs} runs ({settings.start} points, {REPLICATED} of them with "
                         f"{settings.replicas} seeds, in {len(scenes)} scene{'s' if len(scenes) > 1 else ''}). Give budget={settings.first_runs + 4 * settings.batch} or more, or fewer "
                         f"start= points or replicas=")
    return settings


def did_you_mean(name, known):
    near = difflib.get_close_matches(name, known, 1)
    return f", did you mean '{near[0]}'?" if near else f"; there are: {', '.join(known)}"


def check(config, folder="."):
    """As read, and refuses names that no case has: words of --config that neither this workflow nor that of a scene reads, keys, quantities."""
    settings = read(config, folder)
    cases = dict.fromkeys(scene.case for scene in (*settings.scenes, *settings.experiments))
    try:
        theirs = {name for case in cases for name in words_of(snakefile_of(case)).all}
    except Wrong as reason:
        raise ValueError(str(reason)) from None
    known = [*WORDS, *sorted(theirs - {*WORDS, *NOT_WORDS})]
    for name, value in config.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            raise ValueError(f"--config {name}={plain(value)}: {OWN} has no word '{name}'" + (f", did you mean '{near[0]}'? There are: " if near else "; there are: ") +
                             ", ".join(known))
    paths = [("keys", path) for key in settings.keys for _, path in key.paths] + [("set", text.partition("=")[0]) for _, text in settings.fixed]
    for word, path in paths:
        if (problem := problem_of(path)) is not None:
            raise ValueError(f"{word}: {path}: {problem} (decomposer/CASE.md)")
    for target in settings.targets:
        quantities = OF_BODIES if target.group == "all" else [*OF_BODIES, *OF_WALLS, *OF_GATES]
        if target.quantity not in quantities:
            raise ValueError(f"target: {target.name}: there is no quantity '{target.quantity}'{did_you_mean(target.quantity, quantities)}")
    return settings
