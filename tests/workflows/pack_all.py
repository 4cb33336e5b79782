#!/usr/bin/env python3
"""The decomposer packs every case of the workflows at its full size. usage: pack_all.py RUNNER BIN SCRATCH [WORKFLOW ...]

A dry run checks no size, no margin and no gap: what the decomposer refuses, only the decomposer says. The commands are those that the dry run of
each workflow prints, of each case file one for each set of keys that it changes. Nothing is simulated: cases that begin with the results of another
run are left out, bodies that the solver would pour are drawn, and cuts are into few pieces, since many take minutes and pack no otherwise.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

RUNNER, BIN, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
ASKED = sys.argv[4:]   # none: all of them
ENVIRONMENT = os.environ | {"SCREE_BIN": str(BIN), "PATH": f"{BIN}:{os.environ['PATH']}"}
CASES = {"/".join(path.parts[-2:]): path.read_text() for path in RUNNER.parent.glob("*/*.toml")}
FROM_RUNS = {case for case, text in CASES.items() if re.search(r"^\[start\]", text, re.MULTILINE)}
MADE_AFTER_RUNS = ("cuboids", "heated-bed")   # workflows with a case file that a script makes from results
WITHOUT_CASES = ("distance-study", "peers", "scaling", "stability", "validation", "work-precision")   # scaling: a bed that it tiles
DENSE = ("heated-bed",)   # of whose poured bodies random draws find no place for the last
PIECES = 8


def commands_of(name, folder):
    """Command lines of all steps before the solver, in an order in which they can run."""
    folder.mkdir(parents=True)
    words = [RUNNER, name, "--dry-run", "--out", folder]
    if name == "calibrate":
        (folder / "points.json").write_text('{"a": {"case": "heap"}, "b": {"case": "drum"}, "c": {"case": "slide"}}')
        words += ["--config", f"points={folder / 'points.json'}"]
    text = subprocess.run(words, env=ENVIRONMENT, text=True, capture_output=True, check=True).stdout
    lines = [part.strip() for line in text.splitlines() for part in line.split(" && ")]
    steps = [line for line in lines if re.match(r"(scree-mesher|cp|scree-decomposer pack) ", line) or re.match(r"/usr/bin/python3 \S*(slope|deck|frames|throws|staple)\.py", line)]
    return sorted(dict.fromkeys(steps), key=lambda line: line.startswith("scree-decomposer"))


def changed_keys(words):
    return tuple(sorted(words[k + 1].split("=")[0] for k, word in enumerate(words) if word == "--set"))


failures, packed = [], {}
shutil.rmtree(SCRATCH, ignore_errors=True)
for name in sorted(path.parent.name for path in RUNNER.parent.glob("*/Snakefile")):
    if name in WITHOUT_CASES or ASKED and name not in ASKED:
        continue
    folder, source = SCRATCH / name, {}
    for command in commands_of(name, folder):
        words = shlex.split(command)
        if words[0] == "cp":
            source[words[2]] = "/".join(pathlib.Path(words[1]).parts[-2:])
        if words[1].endswith("throws.py"):   # CASE PUBLISHED EACH SEED NEW_CASE [FIT]
            if len(words) > 7:
                continue   # with values that runs have fitted
            source[words[6]] = "/".join(pathlib.Path(words[2]).parts[-2:])
        if words[:2] == ["scree-mesher", "fracture"]:
            count = words.index("--cells") + 1
            words[count] = str(min(int(words[count]), PIECES))
        if words[:2] == ["scree-decomposer", "pack"]:
            case = source.get(words[2])
            if name in MADE_AFTER_RUNS and not (folder / words[2]).exists():
                continue
            if case in FROM_RUNS or changed_keys(words) in packed.setdefault(case, []):
                continue
            packed[case].append(changed_keys(words))
            if any("method=settle" in word for word in words) or 'method = "settle"' in (folder / words[2]).read_text():
                words += ["--set", f"populations.0.method={'lattice' if name in DENSE else 'random'}"]
        done = subprocess.run(words, cwd=folder, env=ENVIRONMENT, text=True, capture_output=True)
        if done.returncode != 0:
            failures.append(f"{name}: exit {done.returncode} of {shlex.join(words)}\n  {done.stderr.strip()}")

small = {"boulders/case-small.toml"}   # of size=small
excused = {case for case in CASES if case.split("/")[0] in WITHOUT_CASES} | FROM_RUNS | small
failures += [f"{case} is packed by no workflow at its full size" for case in sorted(set(CASES) - set(packed) - excused) if not ASKED or case.split("/")[0] in ASKED]
print("\n".join(failures) or f"all packed: {len(packed)} cases")
sys.exit(bool(failures))
