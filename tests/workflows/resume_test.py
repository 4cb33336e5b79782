#!/usr/bin/env python3
"""Small cases, killed half way and resumed, against the same runs undisturbed. usage: resume_test.py RUNNER BIN WHOLE SCRATCH NAME/RUN...

WHOLE has the finished results of each case NAME in a folder of its name. The steps before the solver are taken from there, so that only the
run that is killed, and its continuation, cost time.
"""
import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from killed import kill_after_checkpoint  # noqa: E402

RUNNER, BIN, WHOLE, SCRATCH, *CASES = sys.argv[1:]
ENV = dict(os.environ, SCREE_BIN=BIN)


def record_of(folder, run):
    with open(os.path.join(folder, f"{run}.run", "run.json"), encoding="utf-8") as file:
        return json.load(file)


def is_resumed(record):
    """By the command of scree-solver, or, where a program steps the run, by the checkpoint among its inputs."""
    made = record["provenance"]
    return "--restart" in made["command"] or any("/checkpoint_" in given["path"] for given in made["inputs"])


shutil.rmtree(SCRATCH, ignore_errors=True)
for case in CASES:
    name, run = case.split("/")
    whole, killed = os.path.join(WHOLE, name), os.path.join(SCRATCH, name)
    command = [RUNNER, name, f"{run}.run/run.json", "--out", killed, "--config", "size=small", "ranks=1"]
    for attempt in range(4):  # on a busy machine the run may have ended before the signal comes; then another one is killed
        shutil.rmtree(killed, ignore_errors=True)
        shutil.copytree(whole, killed, ignore=shutil.ignore_patterns("*.run", "*.statistics", "*.html", "*.png"))
        if kill_after_checkpoint(command, os.path.join(killed, f"{run}.run"), ENV, os.path.join(SCRATCH, f"{name}.log")):
            break
    else:
        raise AssertionError(f"{case}: ended before each of {attempt + 1} kills: nothing was tested")
    result = subprocess.run(command, env=ENV, capture_output=True, text=True, timeout=280)
    text = result.stdout + result.stderr
    assert result.returncode == 0, f"{case}: exit {result.returncode}\n{text}"
    assert "the last run was killed; resuming" in text, text
    assert "scree-decomposer pack" not in text.split("Building DAG")[-1], text  # what was done stays done
    first, second = record_of(whole, run), record_of(killed, run)
    assert is_resumed(second) and not is_resumed(first), f"{case}: begun anew, not resumed"
    for key in ("outcome", "state_hash", "steps"):
        assert first[key] == second[key], f"{case}: {key}: {first[key]} undisturbed, {second[key]} resumed"
    print(f"{case}: the same after a kill, {second['steps']} steps", flush=True)
shutil.rmtree(SCRATCH)
