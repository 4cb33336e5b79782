#!/usr/bin/env python3
"""Measures the error of the numbers of a case, for workflows/run CASE --error. usage: error.py CASE --error [--goal QUANTITY=ERROR] [--budget TIME] ...

    --goal "angle_of_repose=0.5 deg"   total error wanted of a number; repeat it for others. "=1%" is of the value
    --budget "2 h"                     ends in this time with what it has
    --quantity NAME                    stands first in the table; repeat it. FILE.py:FUNCTION is a function of yours, which gets the path of NAME.run
    --seeds 5                          of every setting
    --plan                             what would be run, and how long that takes; packs the case and runs nothing
    --dry-run                          the steps of the case itself; changes nothing
    --cores N, --out FOLDER, --config WORDS...: as those of workflows/run. Other words go to Snakemake

Results: error.md, error.csv, error.json, error.png and .svg in the folder error of the results of the case. The runs are in the same folder. The same command goes
on where it was interrupted, and makes no run twice. Exit codes are those of the tools.
"""
import argparse
import math
import os
import re
import shlex
import subprocess
import sys
import time

BEGAN = time.monotonic()
os.environ["OMP_NUM_THREADS"] = "1"
sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path[:0] = [HERE, os.path.join(HERE, ".."), os.path.join(ROOT, "post", "python")]
import config_words  # noqa: E402
import scree  # noqa: E402
from answers import Wrong, check_name, fragments_of, goal_of, numbers_of, seconds_of  # noqa: E402
from campaign import START, Campaign, Stop  # noqa: E402
from plan import affordable, first_jobs, makespan  # noqa: E402
from points_queue import RUNNER, PointsQueue, cannot_begin, invalid, tool_errors  # noqa: E402
from run_record import record_of  # noqa: E402
from settings import CASE, remarks, settings_of  # noqa: E402
from shapes import note, variants_of  # noqa: E402
from sweep_quantity import statistics_of  # noqa: E402

FEWEST_SEEDS = 2
STATISTICS = ".statistics/statistics.json"


def say(text):
    print(f"error: {text}" if not text.startswith("workflows/run") else text, file=sys.stderr, flush=True)


class Words(argparse.ArgumentParser):
    def error(self, message):
        raise Wrong(f"--error: {message}")


def read_words(words):
    if {"-h", "--help"} & set(words):
        print(__doc__.partition("usage: ")[2].replace("error.py CASE", "workflows/run CASE", 1).strip())
        sys.exit(0)
    parser = Words(prog="workflows/run CASE --error", add_help=False, allow_abbrev=False)
    parser.add_argument("case")
    parser.add_argument("--error", action="store_true")
    parser.add_argument("--plan", action="store_true")
    parser.add_argument("--dry-run", "--dryrun", "-n", action="store_true")
    parser.add_argument("--goal", action="append", default=[])
    parser.add_argument("--quantity", action="append", default=[])
    parser.add_argument("--budget")
    parser.add_argument("--seeds", default="5")
    parser.add_argument("--out")
    parser.add_argument("--cores", "-c", default=str(os.cpu_count()))
    parser.add_argument("--config", nargs="+", default=[])
    known, further = parser.parse_known_args(words)
    for name, least in (("seeds", FEWEST_SEEDS), ("cores", 1)):
        value = getattr(known, name)
        if not value.isdigit() or int(value) < least:
            raise Wrong(f"--{name}: '{value}' found; expected a whole number of at least {least}")
        setattr(known, name, int(value))
    known.goals = [goal_of(text) for text in known.goal]
    known.seconds = seconds_of(known.budget, "--budget") if known.budget is not None else None
    for name in [*(goal.name for goal in known.goals), *known.quantity]:
        check_name(name, ".")
    for word in known.config:
        if word.partition("=")[0] in ("points", "sweep", "replicas", "plot"):
            raise Wrong(f"--config {word}: a sweep has no place here; give --seeds, or measure the error of one point with a case of its own")
    if known.case.endswith(".toml"):
        if not os.path.isfile(known.case):
            raise Wrong(f"no case file '{known.case}'")
        known.case = os.path.abspath(known.case)
        known.run, known.title, out = None, os.path.basename(known.case).removesuffix(".toml"), known.case.removesuffix(".toml") + ".out"
    else:
        known.case, _, run = known.case.partition("/")
        known.run, known.title = run or None, run or known.case
        if not re.fullmatch(r"[A-Za-z0-9_-]+", known.case) or not os.path.isfile(os.path.join(HERE, "..", known.case, "Snakefile")):
            raise Wrong(f"no case '{known.case}'; give a case of workflows, CASE/RUN for one of several runs, or the path of a case of yours, PATH/case.toml")
        out = os.path.join(HERE, "..", known.case, "out")
    try:
        config_words.check(config_words.snakefile_of(known.case), os.path.basename(known.case), known.config, is_points=True)
    except config_words.Wrong as reason:
        raise Wrong(str(reason)) from None
    known.folder = os.path.abspath(known.out or os.path.join(out, "error", known.run or ""))
    return known, further


class Runs:
    """The runs of a case by workflows/run: what a Campaign calls its source."""

    def __init__(self, words, further):
        self.words, self.queue = words, PointsQueue(words.cores, words.config, further)
        self.folder, self.named, self.asked, self.messages, self.made = words.folder, {}, {}, {}, set()
        self.first_seed, self.has_bonds = None, False
        self.functions = [name for name in dict.fromkeys([*(goal.name for goal in words.goals), *words.quantity]) if ".py:" in name]

    def name(self, job):
        """The run with the seed of the case is called by the case alone: it is made before its seed is known."""
        return CASE if job[0] == CASE and job[1] in (None, self.first_seed) else f"{job[0]}-{job[1]}"

    def path(self, job):
        return os.path.join(self.folder, self.name(job))

    def call(self, jobs, ending, seconds=None):
        for job in jobs:
            keys = self.named[job[0]].keys if job[0] in self.named else {}
            self.asked[self.name(job)] = {"case": self.words.run, **keys, **({} if self.name(job) == CASE else {"seed": str(job[1])})}
        answer = self.queue.call(self.words.case, self.folder, self.asked, [self.name(job) + ending for job in jobs], seconds)
        if self.queue.received:
            raise Stop(128 + self.queue.received, "interrupted; the same command goes on from here")
        return answer

    def first(self, seconds, is_plan):
        """The scene of the case as it is, and its run unless only a plan is asked for."""
        job = (CASE, None)
        code, text = self.call([job], ".scene.h5" if is_plan else STATISTICS, seconds)
        if code < 0:
            raise Stop(5, f"the budget of {seconds:.0f} s ended before the first run of the case; the same command with a larger --budget goes on from its checkpoint")
        if code != 0:
            message = invalid(self.folder, CASE)
            if message is not None:
                raise Stop(5, f"the case itself becomes invalid: {message}")
            errors = tool_errors(text)
            several = re.search(r"\(none given\); there are: (.*)", text)
            if several:
                raise Stop(2, f"{self.words.case} has several runs; say which: {', '.join(f'{self.words.case}/{run}' for run in several[1].split(', '))}")
            raise Stop(4 if code == 4 else 2, errors[0].partition("error: ")[2] if errors else cannot_begin(text) or f"workflows/run ended with exit code {code}; see {self.folder}.log")
        scene = scree.open_scene(self.path(job) + ".scene.h5")
        self.first_seed = int(scene.case.data.get("seed", 0))
        if not is_plan:
            self.made.add((CASE, self.first_seed))
        return scene

    def is_there(self, job):
        return os.path.exists(self.path(job) + STATISTICS)

    def make(self, jobs, seconds):
        jobs = [job for job in jobs if job not in self.made]   # Snakemake sees each once: it makes those again whose case has changed since
        if not jobs:
            return True
        code, text = self.call(jobs, STATISTICS, seconds)
        self.made |= {job for job in jobs if self.is_there(job)}
        if code < 0:
            return False
        if code == 4:
            raise Stop(4, f"{cannot_begin(text) or 'another run is at work'}; see {self.folder}.log")
        # a message that stands among those of other runs is not known to be of this one: one run of each setting that failed is called alone
        for name in dict.fromkeys(name for name, seed in jobs if not self.is_there((name, seed))):
            job = next(job for job in jobs if job[0] == name and not self.is_there(job))
            message = invalid(self.folder, self.name(job))
            if message is None:
                _, text = self.call([job], STATISTICS)
                errors = tool_errors(text)
                message = errors[0].partition("error: ")[2] if errors else f"failed; see {self.folder}.log"
            self.messages[name] = message
        return True

    def result(self, job):
        if not self.is_there(job) or not os.path.exists(self.path(job) + ".run/run.json"):
            return None
        record = record_of(self.path(job))
        numbers = numbers_of(self.path(job), self.functions, ".")
        if self.has_bonds:
            numbers |= fragments_of(self.path(job))
        return {"numbers": numbers, "cost": record["wall_seconds"] * record["ranks"] * record["threads"], "hash": record["state_hash"]}

    def failure(self, job):
        return invalid(self.folder, self.name(job)) or self.messages.get(job[0])


def settings_here(runs, scene, folder):
    """Settings of the case of a scene; those that scree-decomposer refuses have its message as the reason."""
    case, command = scene.case.data, scene.provenance["command"]
    base = os.path.dirname(os.path.join(folder, command[2]))
    variants = {name: variants_of(name, shape, base, os.path.join(folder, "shapes")) for name, shape in case.get("shapes", {}).items()}
    # balls have no margin, whatever the case says
    margin = scene.settings.get("margin", 0.0) if any(len(shape.triangles) for shape in scene.shapes.values()) else 0.0
    settings = []
    changes = [word for pair in zip(command, command[1:]) if pair[0] == "--set" for word in pair]
    for setting in settings_of(case, margin, variants):
        if setting.keys:
            words = [word for key, value in setting.keys.items() for word in ("--set", f"{key}={value}")]
            result = subprocess.run(["scree-decomposer", "check", command[2], *changes, *words], cwd=folder, capture_output=True, text=True, check=False)
            if result.returncode != 0:
                first = result.stderr.strip().splitlines()[0] if result.stderr.strip() else f"exit {result.returncode}"
                setting = type(setting)(setting.name, setting.part, setting.side, setting.what, why_not=first.partition("error: ")[2] or first)
        settings.append(setting)
    return settings, base


def time_of_case(runs):
    """(core time of a run [s], where it is from)."""
    path = runs.path((CASE, None))
    if os.path.exists(path + ".run/run.json"):
        record = record_of(path)
        return record["wall_seconds"] * record["ranks"] * record["threads"], "a run of the case that was made"
    result = subprocess.run(["scree-solver", path + ".scene.h5", "--plan"], capture_output=True, text=True, check=False)
    found = re.search(r"^  wall time +about ([^(]*?)( \(| at the pace)", result.stdout, re.M)
    parts = re.findall(r"([\d.e+-]+) (s|min|h|d)\b", found[1]) if found else []
    factor = {"s": 1, "min": 60, "h": 3600, "d": 86400}
    source = ("a sample of the bed that the solver settled" if "of these bodies was settled" in result.stdout else
              "the usual cost of a body in a bed" if "no sample of the bed was settled" in result.stdout else
              "the first steps of the solver: a bed that is still to form takes several times as long")
    return sum(float(number) * factor[unit] for number, unit in parts) if parts else math.nan, source


def plan_text(words, settings, seed, cost, source):
    from page import duration, keys_text, table   # takes a second: matplotlib
    expected = {setting.name: setting.cost * cost for setting in settings}
    seeds = [seed + number for number in range(words.seeds)]
    jobs = first_jobs(settings, seeds, words.seeds)
    left = []
    if words.seconds:
        jobs, left = affordable(jobs, lambda name: expected[name], words.cores, words.seconds, {}, words.seconds * words.cores)
    rows = []
    for setting in settings:
        count = sum(name == setting.name for name, _ in jobs)
        what = f"not possible: {setting.why_not}" if setting.why_not else keys_text(setting)
        rows.append((setting.what, what, count, "-" if setting.why_not else duration(expected[setting.name]), "-" if setting.why_not else duration(count * expected[setting.name])))
    lines = table(["setting", "keys", "seeds", "one run", "core time"], rows)
    lines += [f"{len(jobs)} runs, {duration(sum(expected[name] for name, _ in jobs))} of a core; about {duration(makespan([expected[name] for name, _ in jobs], words.cores) + 2 * START)} on {words.cores} cores.",
              f"The time of a run is that of {source}."]
    if left:
        lines.append(f"The budget of {duration(words.seconds)} does not allow {len(left)} further runs.")
    if words.goals:
        lines.append(f"Further seeds follow until the goal is reached: {', '.join(goal.text for goal in words.goals)}.")
    return "\n".join(lines)


def main():
    # 1. what is asked for
    words, further = read_words(sys.argv[1:])
    if words.dry_run:
        os.execv(RUNNER, [RUNNER, words.case, "--dry-run", "--out", words.folder, *further, *(["--config", *words.config] if words.config else [])])
    runs = Runs(words, further)
    os.environ["PATH"] = os.pathsep.join([os.environ.get("SCREE_BIN") or os.path.join(ROOT, "build", "release", "bin"), os.environ["PATH"]])
    is_built = "SCREE_BIN" in runs.queue.env

    # 2. the case as it is: its scene, its first run, its settings
    scene = runs.first(words.seconds, words.plan)
    runs.queue.env.setdefault("SCREE_BIN", os.path.join(ROOT, "build", "release", "bin"))   # built by now; not again by each call
    case, seed = scene.case.data, runs.first_seed
    settings, base = settings_here(runs, scene, words.folder)
    runs.named, runs.has_bonds = {setting.name: setting for setting in settings}, bool(case.get("bonds"))
    if words.plan:
        print(plan_text(words, settings, seed, *time_of_case(runs)))
        return
    used = time.monotonic() - BEGAN if is_built else 0.0   # building the tools is not part of the budget

    # 3. the other runs, with the table of what is known after each call of the queue
    statistics = statistics_of(runs.path((CASE, None)))
    said = remarks(case) + note(case, base)

    def write_page(campaign):
        from page import write   # takes a second: matplotlib
        campaign.title, campaign.case_title, campaign.remarks = words.title, str(case.get("title", "")), said
        campaign.times = f"Numbers are means over {statistics['first_time']:.4g} to {statistics['last_time']:.4g} s of simulated time."
        write(campaign, *campaign.answers(), words.folder)

    campaign = Campaign(settings, seed, words.seeds, runs, words.cores, words.goals, words.quantity, words.seconds, used, say=say, write=write_page)
    campaign.run()

    # 4. what came out
    for entry in campaign.answers()[1]:
        print(f"{entry.label} = {entry.text}")
    say(f"done: {os.path.join(words.folder, 'error.md')}")


if __name__ == "__main__":
    try:
        main()
    except Stop as error:
        say(f"workflows/run: error: {error}")
        sys.exit(error.code)
    except Wrong as error:
        say(f"workflows/run: error: {error}")
        sys.exit(2)
    except KeyboardInterrupt:
        say("workflows/run: interrupted; the same command goes on from here")
        sys.exit(130)
