#!/usr/bin/env python3
"""The case boulders, small, as a user runs it: complete, and killed on the way. usage: boulders_test.py RUNNER BIN SCRATCH"""
import csv
import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
from killed import kill_after_checkpoint  # noqa: E402

RUNNER, BIN, SCRATCH = sys.argv[1:4]
ENV = dict(os.environ, SCREE_BIN=BIN)
NAME = "boulders-small"


def command(out):
    return [RUNNER, "boulders", "--config", "size=small", "--out", out]


def run(out):
    result = subprocess.run(command(out), env=ENV, capture_output=True, text=True, timeout=280)
    text = result.stdout + result.stderr
    assert result.returncode == 0, f"exit {result.returncode}\n{text}"
    return text


def outcome(out):
    with open(os.path.join(out, f"{NAME}.run", "run.json")) as f:
        return json.load(f)


def check_results(out):
    """Everything that the case promises is there and says the same."""
    record = outcome(out)
    assert record["outcome"] == "completed" and record["ranks"] == 2 and record["lost_bodies"] == 0, record["outcome"]
    assert 0 < record["max_depth_ratio"] < 1, record["max_depth_ratio"]
    with open(os.path.join(out, f"{NAME}.run", "frames.hdf.series")) as f:
        series = json.load(f)["files"]
    frames = {entry["name"] for entry in series}
    assert all(os.path.exists(os.path.join(out, f"{NAME}.run", name)) for name in frames)
    with open(os.path.join(out, f"{NAME}.bodies.csv")) as f:
        rows = list(csv.DictReader(f))
    assert list(rows[0])[:5] == ["time", "id", "x", "y", "z"], list(rows[0])
    assert len(rows) == 20 * len(series), (len(rows), len(series))  # twenty rocks; the wall does not count
    last = [row for row in rows if row["time"] == rows[-1]["time"]]
    # inside the box of case-small.toml; a margin of 3 mm keeps every centre off the walls
    assert all(abs(float(row["x"])) < 0.21 and abs(float(row["y"])) < 0.21 and 0 < float(row["z"]) < 0.5 for row in last)
    with open(os.path.join(out, f"{NAME}.png"), "rb") as f:
        assert f.read(8) == b"\x89PNG\r\n\x1a\n"
    with open(os.path.join(out, f"{NAME}.report.html")) as f:
        page = f.read()
    assert "</html>" in page and record["state_hash"] in page, "the report is cut short or of another run"
    for file in (f"{NAME}.contacts.csv", f"{NAME}.run/paraview/open_in_paraview.py"):
        assert os.path.getsize(os.path.join(out, file)) > 0, file


shutil.rmtree(SCRATCH, ignore_errors=True)
whole, killed = os.path.join(SCRATCH, "whole"), os.path.join(SCRATCH, "killed")

run(whole)
check_results(whole)
assert "Nothing to be done" in run(whole), "a second run did something"

# kill -9 of the workflow, of mpirun and of both ranks once there is a checkpoint
assert kill_after_checkpoint(command(killed), os.path.join(killed, f"{NAME}.run"), ENV, os.path.join(SCRATCH, "killed.log")), "the run had ended before the kill: nothing was tested"

text = run(killed)
assert "the last run was killed; resuming" in text, text
assert "--restart" in outcome(killed)["provenance"]["command"] and "scree-decomposer pack" not in text.split("Building DAG")[-1], text
check_results(killed)
first, second = outcome(whole), outcome(killed)
assert first["state_hash"] == second["state_hash"], (first["state_hash"], second["state_hash"])
assert first["steps"] == second["steps"], (first["steps"], second["steps"])
shutil.rmtree(SCRATCH)
print("all as expected")
