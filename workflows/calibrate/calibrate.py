#!/usr/bin/env python3
"""Fits keys of cases to measured answers. usage: calibrate.py SETTINGS --cores N --folder PATH, in the folder of the results

SETTINGS are the words of --config as JSON; case files are named from PATH.

What is done is the list in main(). Every run that was asked for is in runs.json before it begins; a run that is done is never done again: after a
kill, runs.json says what is asked for and Snakemake what of it is missing. Exit codes as those of the tools.
"""
import argparse
import csv
import difflib
import json
import os
import subprocess
import sys

os.environ["OMP_NUM_THREADS"] = "1"   # small matrices: more threads are slower, and sum in another order
sys.dont_write_bytecode = True

try:
    from experiments import proposals, spread
    from posterior import ROUGH, next_runs, posterior, sobol, unsure_share
    from surrogate import Surrogate
except ImportError as missing:
    sys.exit(f"calibrate: error: {missing}; install the packages python3-scipy and python3-sklearn, or run ./setup")
from settings import FEWEST, REPLICATED, plain, read  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from points_queue import PointsQueue, cannot_begin, invalid, tool_errors  # noqa: E402
from run_record import unit_of  # noqa: E402


class Stop(Exception):
    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def say(text):
    print(f"calibrate: {text}", file=sys.stderr, flush=True)


class Runs:
    """The runs that were asked for, in runs.json: name -> scene, place (0 to 1 for each key), seed, and failed, with its message."""

    def __init__(self, settings, path="runs.json"):
        self.path, self.settings = path, settings
        of = {"keys": [[list(map(list, key.paths)), key.low, key.high, key.unit, key.log] for key in settings.keys],
              "set": [list(entry) for entry in settings.fixed], "words": list(settings.words), "seed": settings.seed}
        self.content = {"format": "scree-calibration", "format_version": 1, "of": of, "runs": {}}
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.content = json.load(file)
            for name, now in of.items():
                before = self.content["of"].get(name)
                if before != now:
                    raise Stop(2, f"{os.path.abspath(path)}: the runs in this folder are those of a calibration with other {name}: {json.dumps(before)}; now {json.dumps(now)}. "
                                  "Give another --out folder, or remove this one. (target, budget, stop and batch may change.)")

    def of(self, scenes):
        """The runs of scenes."""
        names = {scene.name for scene in scenes}
        return {name: run for name, run in self.content["runs"].items() if run["scene"] in names}

    @property
    def all(self):
        """Of the scenes that have a target."""
        return self.of(self.settings.scenes)

    def add(self, scene, place):
        number = len(self.content["runs"])
        name = f"{scene.name.replace('/', '-')}-{number:03d}"
        self.content["runs"][name] = {"scene": scene.name, "place": [round(float(x), 9) for x in place], "seed": 1000 * self.settings.seed + number + 1}

    def drop(self, scene):
        for name in self.of([scene]):
            del self.content["runs"][name]

    def fail(self, name, message):
        self.content["runs"][name]["failed"] = message
        self.write()

    def write(self):
        with open(self.path + ".part", "w", encoding="utf-8") as file:
            json.dump(self.content, file, indent=1)
        os.replace(self.path + ".part", self.path)

    def keys_of(self, run):
        """Key of the case -> value, as for --set."""
        point = dict(text.partition("=")[::2] for scene, text in self.settings.fixed if scene in (None, run["scene"]))
        for key, x in zip(self.settings.keys, run["place"]):
            point.update({path: key.text(x) for scene, path in key.paths if scene in (None, run["scene"])})
        return {**point, "seed": str(run["seed"])}

    def shown(self, run):
        return ", ".join(f"{key.name} = {key.text(x)}" for key, x in zip(self.settings.keys, run["place"]))


def statistics_of(scene, name):
    return os.path.join(scene.folder, f"{name}.statistics")


class Workflow:
    """Calls workflows/run for the runs of a case."""

    def __init__(self, runs, cores):
        self.runs = runs
        self.scenes = [*runs.settings.scenes, *runs.settings.experiments]
        self.called = set()   # cases of which Snakemake has seen all runs: it makes those anew whose case has changed since
        self.queue = PointsQueue(cores, runs.settings.words)

    def call(self, scene, files):
        """Makes the files; returns the exit code and what was printed."""
        its = {other.name: other.run for other in self.scenes if other.case == scene.case}
        points = {name: {"case": its[run["scene"]], **self.runs.keys_of(run)} for name, run in self.runs.of(self.scenes).items() if run["scene"] in its and "failed" not in run}
        return self.queue.call(scene.case, scene.folder, points, files)

    def check(self, scene):
        """Are the keys those of the case, and are both bounds of each what it may be? scree-decomposer knows."""
        first = next(iter(self.runs.of([scene])))
        code, text = self.call(scene, [f"{first}.toml"])
        case = os.path.join(scene.folder, f"{first}.toml")
        if code != 0 or not os.path.exists(case):
            raise Stop(4 if code == 4 else 2, f"workflows/run {scene.case} cannot begin: " + (cannot_begin(text) or f"exit {code}; see {scene.folder}.log"))
        settings = self.runs.settings
        tries = [("set", text, text) for of, text in settings.fixed if of in (None, scene.name)]
        for key in settings.keys:
            tries += [("keys", f"{path}={key.text(x)}", f"{key.name}, {where}") for x, where in ((0.0, "lower bound"), (1.0, "upper bound"), (0.37, "between the bounds"))
                      for of, path in key.paths if of in (None, scene.name)]
        for word, change, what in tries:
            result = subprocess.run(["scree-decomposer", "check", case, "--set", change], capture_output=True, text=True, check=False)
            if result.returncode != 0:
                message = result.stderr.strip().splitlines()[0].removeprefix("scree-decomposer: error: ") if result.stderr.strip() else f"exit {result.returncode}"
                raise Stop(2, f"{word}: {what}: {change} is refused in {scene.name}: {message}")

    def first(self, scene):
        """Makes a run of the scene, and gives its name."""
        for name, run in self.runs.of([scene]).items():
            if "failed" not in run:
                self.make([name])
                if "failed" not in run:
                    return name
        raise Stop(5, f"all runs of {scene.name} became invalid. Narrow the bounds of the keys")

    def make(self, names):
        """Makes the runs of these names that are not done. A run that became invalid is marked as failed; anything else that goes wrong stops."""
        for case in dict.fromkeys(scene.case for scene in self.scenes):
            scenes = {scene.name: scene for scene in self.scenes if scene.case == case}
            mine = {name: scenes[run["scene"]] for name, run in self.runs.of(self.scenes).items() if name in names and run["scene"] in scenes and "failed" not in run}
            wanted = {name: os.path.join(statistics_of(scene, name), "statistics.json") for name, scene in mine.items()}
            if not wanted or case in self.called and all(map(os.path.exists, wanted.values())):
                continue
            self.called.add(case)
            code, text = self.call(next(iter(mine.values())), [os.path.relpath(path, mine[name].folder) for name, path in wanted.items()])
            for name in wanted:
                if os.path.exists(wanted[name]):
                    continue
                run = self.runs.content["runs"][name]
                message = invalid(mine[name].folder, name)
                if message is not None:
                    say(f"{name} became invalid ({self.runs.shown(run)}): {message}")
                    self.runs.fail(name, message)
                    continue
                errors = tool_errors(text)
                if errors:
                    raise Stop(2, f"{name} ({self.runs.shown(run)}) cannot be made: {errors[0]}. Narrow the bounds of the keys, or change the case")
                last = [line for line in text.splitlines() if line.startswith("workflows/run: ")]
                raise Stop(4 if code == 4 else 128 - code if code < 0 else code or 1, f"{name} was not made: {last[-1] if last else f'exit {code}'}; see {mine[name].folder}.log")


class Summaries:
    """Numbers of the summaries of runs, read once."""

    def __init__(self):
        self.read = {}

    def of(self, scene, name):
        """(group, quantity) -> row of summary.csv."""
        if name not in self.read:
            with open(os.path.join(statistics_of(scene, name), "summary.csv"), encoding="utf-8", newline="") as file:
                self.read[name] = {(row["group"], row["quantity"]): row for row in csv.DictReader(file)}
        return self.read[name]

    def value(self, target, name):
        """The answer of a run in the unit of the summary, None where it has none."""
        row = self.of(target.scene, name).get((target.group, target.quantity))
        if row is None:
            return None
        if target.kind != "last":
            return float(row[target.kind]) if row[target.kind] else None
        with open(os.path.join(statistics_of(target.scene, name), "series.csv"), encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row.get("group") == target.group and row.get(target.quantity)]
        return float(rows[-1][target.quantity]) if rows else None

    def check(self, target, name):
        """Refuses a target that is in no summary; otherwise its unit and the factor from the unit of the target."""
        rows = self.of(target.scene, name)
        groups = list(dict.fromkeys(group for group, _ in rows))
        if target.group not in groups:
            raise Stop(2, f"target: {target.name}: there is no group '{target.group}' in the summary of {target.scene.name}; there are: {', '.join(groups)}")
        there = [quantity for group, quantity in rows if group == target.group]
        if target.quantity not in there:
            close = difflib.get_close_matches(target.quantity, there, 1)
            raise Stop(2, f"target: {target.name}: there is no '{target.quantity}' in the summary of {target.scene.name}{f', did you mean {close[0]}?' if close else ''}; "
                          f"there are: {', '.join(there)}")
        unit = rows[(target.group, target.quantity)]["unit"]
        if not target.unit:
            return unit, 1.0
        mine, its = unit_of(target.unit), unit_of("" if unit == "-" else unit)
        if its is None or mine[1] != its[1]:
            raise Stop(2, f"target: {target.name}={target.text}: {target.quantity} is in {unit}, not in {target.unit}")
        return unit, mine[0] / its[0]


def answers_of(runs, summaries, target):
    """(names, places, answers) of the runs that have one."""
    found = [(name, run["place"], summaries.value(target, name)) for name, run in runs.all.items()
             if run["scene"] == target.scene.name and "failed" not in run and os.path.exists(os.path.join(statistics_of(target.scene, name), "statistics.json"))]
    found = [entry for entry in found if entry[2] is not None]
    return [entry[0] for entry in found], [entry[1] for entry in found], [entry[2] for entry in found]


def first_design(settings):
    """Points of a Sobol sequence; the first ones, which lie far from each other, once more for each further seed."""
    points = list(sobol(settings.start, len(settings.keys), settings.seed))
    return points + [point for point in points[:REPLICATED] for _ in range(settings.replicas - 1)]


def calibrate(settings, runs, make, answers, measured, report=say):
    """The loop: fit, judge, ask for more runs, until the surrogate is known well enough or the budget is spent.

    in   make      names of runs -> makes them
    in   answers   target -> (names, places, answers)
    in   measured  (value, deviation) of each target, in the unit of its answers
    out  surrogates of the targets, posterior, why it stopped
    """
    while True:
        make(list(runs.all))
        failed = sum("failed" in run for run in runs.all.values())
        if failed > max(2, len(runs.all) // 3):
            raise Stop(5, f"{failed} of {len(runs.all)} runs became invalid; the last: {[run['failed'] for run in runs.all.values() if 'failed' in run][-1]}. Narrow the bounds of the keys")
        data = [answers(target) for target in settings.targets]
        for target, (names, _, _) in zip(settings.targets, data):
            if len(names) < FEWEST:
                raise Stop(3, f"target: only {len(names)} of the runs have {target.name}: too few for a fit, which needs {FEWEST}. Is it a number that this case has?")
        surrogates = [Surrogate(places, values) for _, places, values in data]
        found = posterior(surrogates, measured, len(settings.keys), settings.seed, ROUGH)
        share = unsure_share(surrogates, measured, found.even(400))
        spent = len(runs.all)
        intervals = ", ".join(f"{key.name} {key.value(low):.3g} .. {key.value(high):.3g}"
                              for k, key in enumerate(settings.keys) for low, high in [found.interval(k)])
        report(f"{spent} of {settings.budget} runs: {intervals}; the surrogate is known to {max(share):.2g} of the measurement (stop: {settings.stop:g})")
        if max(share) <= settings.stop or spent >= settings.budget:
            found = posterior(surrogates, measured, len(settings.keys), settings.seed)
            return surrogates, found, share, "precise" if max(share) <= settings.stop else "budget"
        scenes = {scene.name: scene for scene in settings.scenes}
        by_scene = {name: [k for k, target in enumerate(settings.targets) if target.scene.name == name] for name in scenes}
        for name, place in next_runs({name: [surrogates[k] for k in entry] for name, entry in by_scene.items()},
                                     {name: [measured[k] for k in entry] for name, entry in by_scene.items()},
                                     found, min(settings.batch, settings.budget - spent), 1000 * settings.seed + spent):
            runs.add(scenes[name], place)
        runs.write()


def survey(settings, runs, workflow, found):
    """Runs each experiment that has no target at points of the posterior, so that proposals can be made.

    Returns (name of the scene, why) of those that were not run: a scene that refuses a key is no reason to lose a calibration.
    """
    refused = []
    for scene in settings.experiments:
        there = runs.of([scene])
        try:
            if not there:
                for place in spread(found.even(400), settings.survey):
                    runs.add(scene, place)
                say(f"{scene.name} is run at {settings.survey} points of the posterior, to see whether its answers would fix the keys")
                workflow.check(scene)
                runs.write()
            workflow.make(list(runs.of([scene])))
            left = sum("failed" not in run for run in runs.of([scene]).values())
            if left < FEWEST:
                refused.append((scene.name, f"{len(runs.of([scene])) - left} of its {len(runs.of([scene]))} runs became invalid"))
        except Stop as reason:
            if reason.code not in (2, 3, 5):
                raise
            if not there:
                runs.drop(scene)
            refused.append((scene.name, str(reason)))
    return refused


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("settings")
    parser.add_argument("--cores", type=int, default=1)
    parser.add_argument("--folder", default=".")
    words = parser.parse_args()

    # 1. what is asked for, and the runs that were asked for before
    config = json.loads(words.settings)
    settings = read(config, words.folder)
    if not {"target", "keys"} & set(map(plain, config)):
        say("no target and no keys are given: this is the example of the README")
    runs = Runs(settings)
    added = [scene for scene in settings.scenes if not any(run["scene"] == scene.name for run in runs.all.values())]
    there = len(runs.all)
    for scene in added:
        for place in first_design(settings):
            runs.add(scene, place)
    if added and len(runs.all) > settings.budget:
        raise Stop(2, f"budget={settings.budget} is too small: {there} runs are there, and the first design of {', '.join(scene.name for scene in added)} takes {len(runs.all) - there} more; "
                      f"give budget={len(runs.all) + 4 * settings.batch} or more")

    # 2. are the keys keys and the targets in the summaries? one run of each scene shows
    workflow, summaries = Workflow(runs, words.cores), Summaries()
    for scene in added:   # those that are there were checked before
        workflow.check(scene)
    runs.write()
    first = {scene.name: workflow.first(scene) for scene in settings.scenes}
    units = [summaries.check(target, first[target.scene.name]) for target in settings.targets]
    measured = [(target.value * factor, target.deviation * factor) for target, (_, factor) in zip(settings.targets, units)]

    # 3. run, fit, choose
    surrogates, found, share, why = calibrate(settings, runs, workflow.make, lambda target: answers_of(runs, summaries, target), measured)

    # 4. what came out, and, where keys are open, which experiment would fix them
    from page import is_open, judge, write   # takes a second: matplotlib
    numbers = judge(settings, measured, surrogates, found, share, why)
    numbers["not_tried"], numbers["proposals"] = [], []
    if is_open(numbers):
        numbers["not_tried"] = survey(settings, runs, workflow, found)
        numbers["proposals"] = proposals(settings, runs, summaries, found, statistics_of)
    write(settings, runs, summaries, [unit for unit, _ in units], measured, surrogates, found, numbers)
    say("done: calibration.md")


if __name__ == "__main__":
    try:
        main()
    except Stop as error:
        say(f"error: {error}")
        sys.exit(error.code)
    except ValueError as error:
        say(f"error: {error}")
        sys.exit(2)
