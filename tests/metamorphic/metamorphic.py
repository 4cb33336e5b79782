#!/usr/bin/env python3
"""Random valid cases, run through the four tools, and relations between the runs. Smallest failing cases are kept.

metamorphic.py BIN_FOLDER --seed 1 --count 100                  a hundred cases from seed 1 on, some relations each
metamorphic.py BIN_FOLDER --seed 17 --relation turned           one relation of one case
metamorphic.py BIN_FOLDER --case kept/17-turned/case.json --relation turned --draw 17     a case from a file
metamorphic.py BIN_FOLDER --known                               the cases of the folder cases/
Exit 0: all relations hold; 1: some do not; 2: wrong command.
"""
import argparse
import collections
import glob
import json
import multiprocessing
import os
import random
import sys
import time
import traceback

import bits  # noqa: F401  (these register their relations)
import mesh_formats  # noqa: F401
import near  # noqa: F401
import packings  # noqa: F401
import post_says  # noqa: F401
import post_series  # noqa: F401
import starts  # noqa: F401
import sums  # noqa: F401
from generator import generate
from model import case_from_json, read_case
from relations import RELATIONS, NotApplicable, Refused, Trial, Violation
from shrink import shrink
from tools import Tools

HERE = os.path.dirname(os.path.abspath(__file__))
TOOLS = None
# how many relations of each kind a random case is put to
DRAWN = {"bits": 3, "near": 2, "sums": 3}
# how often a relation is drawn against others of its kind, where not once
WEIGHTS = {"any_ranks_and_threads": 3, "killed_and_continued": 2, "outputs_at_other_times": 2, "restarted_when_finished": 0.7, "packed_twice": 0.5, "the_case_in_the_scene": 0.5,
           "plan_tells_what_runs": 0.5, "post_tables": 0.5, "report_trusts_its_files": 0.3, "any_mesh_format": 0.4}


def drawn_relations(seed):
    r = random.Random(f"relations {seed}")
    names = []
    for group, number in DRAWN.items():
        mine = sorted((r.random() ** (1 / WEIGHTS.get(name, 1)), name) for name, entry in RELATIONS.items() if entry.group == group)
        names += [name for _, name in mine[-number:]]
    return names


def examine(trial, name):
    """('held' | 'not applicable' | 'violated' | 'refused', why)"""
    try:
        trial.begin(name)
        RELATIONS[name].function(trial)
        return "held", ""
    except NotApplicable as reason:
        return "not applicable", str(reason)
    except Refused as reason:
        return "refused", str(reason)
    except Violation as reason:
        return "violated", str(reason)


def work(job):
    """One case; gives its lines and counts. Runs in a process of its own."""
    results = []
    begun = time.time()
    try:
        case = read_case(job["case"]) if job["case"] else generate(job["seed"])
        trial = Trial(TOOLS, case, job["draw"])
        for name in job["relations"]:
            outcome, why = examine(trial, name)
            # relations of a scene that another scene is made from: only the case itself must be accepted, by pack and by the solver
            accepted = trial.kept_run is not None or (trial.kept_scene is not None and not why.startswith("solver"))
            if outcome == "refused" and (job["known"] or accepted):
                outcome = "violated" if job["known"] or RELATIONS[name].group == "bits" else "not applicable"
            if outcome == "violated" and job["keep"]:
                why += keep(job, case, trial, name, why)
            results.append((name, outcome, why))
            if outcome == "refused":
                break
    except Exception:  # a fault of the tester itself
        results.append(("-", "broken", traceback.format_exc()))
    TOOLS.empty()
    return job, results, time.time() - begun


def keep(job, case, trial, name, why):
    """Shrinks a case and writes it with the command that shows it."""
    label = os.path.splitext(os.path.basename(os.path.dirname(job["case"]) if job["case"] else str(job["seed"])))[0]
    folder = os.path.join(job["keep"], f"{label}-{name}")

    def violates(candidate):
        try:
            return examine(Trial(TOOLS, candidate, job["draw"]), name)[0] == "violated"
        except Exception:
            return False   # a candidate that makes no sense to the tester
    smallest = shrink(case, violates, trial.kept_scene, job["shrink"]) if job["shrink"] > 0 else case
    final = examine(Trial(TOOLS, smallest, job["draw"]), name)[1] or why
    smallest.note = f"{case.note}: {name}: {final}"
    smallest.write(folder)
    command = f"python3 tests/metamorphic/metamorphic.py BIN_FOLDER --case {os.path.join(folder, 'case.json')} --relation {name} --draw {job['draw']}"
    with open(os.path.join(folder, "violation.txt"), "w") as file:
        file.write(f"{command}\n\nthe smallest case: {final}\n\nthe case of the seed: {why}\n")
    return f"\n  smallest case kept: {command}\n  {final}"


def known_cases():
    """Cases of past defects: {"relations": [...], "draws": [...], note, words, meshes}."""
    jobs = []
    for path in sorted(glob.glob(os.path.join(HERE, "cases", "*.json"))):
        with open(path) as file:
            data = json.load(file)
        case_from_json(data)
        for draw in data.get("draws", [0]):
            jobs.append({"case": path, "seed": draw, "draw": draw, "relations": data["relations"]})
    return jobs


def start_worker(arguments, many_ranks=None):
    global TOOLS
    TOOLS = Tools(arguments.bin, arguments.mpiexec, arguments.cache, many_ranks)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", help="folder of the tools")
    parser.add_argument("--mpiexec", default="mpirun")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--relation", action="append", choices=sorted(RELATIONS), help="only this one; may be repeated (default: some, drawn by the seed)")
    parser.add_argument("--all", action="store_true", help="all relations on every case")
    parser.add_argument("--case", help="case.json in place of random cases")
    parser.add_argument("--draw", type=int, help="seed of what the relations draw (default: the seed)")
    parser.add_argument("--known", action="store_true", help="the cases of past defects")
    parser.add_argument("--keep", help="folder for smallest failing cases")
    parser.add_argument("--shrink", type=float, default=120, help="seconds to shrink a failing case (default 120)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=0, help="begin no further case after so many seconds (0: no limit)")
    parser.add_argument("--cache", help="folder for imported meshes, to share it between runs")
    parser.add_argument("--verbose", action="store_true", help="a line for every case")
    arguments = parser.parse_args()
    if arguments.keep:
        os.makedirs(arguments.keep, exist_ok=True)

    jobs = known_cases() if arguments.known else []
    if arguments.case:
        jobs.append({"case": arguments.case, "seed": 0, "draw": arguments.draw or 0})
    if not jobs:
        jobs = [{"case": None, "seed": seed, "draw": seed if arguments.draw is None else arguments.draw}
                for seed in range(arguments.seed, arguments.seed + arguments.count)]
    for job in jobs:
        job["keep"], job["shrink"], job["known"] = arguments.keep, arguments.shrink, arguments.known
        if arguments.relation:
            job["relations"] = arguments.relation
        job.setdefault("relations", [name for name in sorted(RELATIONS) if RELATIONS[name].group in DRAWN] if arguments.all or arguments.case else drawn_relations(job["seed"]))

    begun, counts, violations, skipped = time.time(), collections.defaultdict(collections.Counter), 0, 0
    refused = 0

    def tell(job, results, seconds):
        nonlocal violations, refused
        label = job["case"] or f"seed {job['seed']}"
        if arguments.verbose:
            print(f"{label}: {seconds:.1f} s: " + ", ".join(f"{name} {outcome}" for name, outcome, _ in results), flush=True)
        for name, outcome, why in results:
            counts[name][outcome] += 1
            if outcome in ("violated", "broken"):
                violations += 1
                print(f"{label}: {name}: {outcome}: {why}", flush=True)
            if outcome == "refused":
                refused += 1
                if arguments.verbose or job["case"]:
                    print(f"{label}: refused: {why}", flush=True)

    pool = multiprocessing.Pool(arguments.jobs, start_worker, (arguments, multiprocessing.Lock())) if arguments.jobs > 1 and len(jobs) > 1 else None
    done = 0
    if pool is None:
        start_worker(arguments)
        for job in jobs:
            if arguments.seconds and time.time() - begun > arguments.seconds:
                break
            tell(*work(job))
            done += 1
        TOOLS.clean()
    else:
        waiting, running = list(reversed(jobs)), []
        while waiting or running:
            while waiting and len(running) < 2 * arguments.jobs and not (arguments.seconds and time.time() - begun > arguments.seconds):
                running.append(pool.apply_async(work, (waiting.pop(),)))
            if not running:
                break
            tell(*running.pop(0).get())
            done += 1
        scratch = pool.map(clean_worker, range(4 * arguments.jobs))
        del scratch
        pool.close()
        pool.join()
    skipped = len(jobs) - done
    for name in sorted(counts):
        print(f"{name:32} " + ", ".join(f"{number} {outcome}" for outcome, number in sorted(counts[name].items())))
    print(f"{done} cases in {time.time() - begun:.0f} s, {refused} refused, {violations} violations" + (f"; {skipped} not begun" if skipped else ""))
    return 1 if violations else 0


def clean_worker(_):
    TOOLS.clean()


if __name__ == "__main__":
    sys.exit(main())
