#!/usr/bin/env python3
"""workflows/run CASE --error with Scree itself: balls bounce at a step that is too long. usage: error_run_test.py RUNNER BIN SCRATCH

Two numbers are known: the restitution is that of the case, 0.7, and the energy balance has no error. With eight steps to a contact the page names the step as
the largest error of the energy, with the right sign; with contacts as soft as these, the stiffness as that of the speed. The restitution of a linear
contact depends on neither: 0.7 lies within the total error. A second call makes no run; a setting that the case does not allow has its reason.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

RUNNER, BIN, SCRATCH = sys.argv[1:4]
RESTITUTION = 0.7
CASE = f"""\
title = "balls bounce once on a plate"
gravity = [0, 0, -9.81]
[time]
duration = "0.15 s"
steps_per_contact = 8
[shapes.ball]
sphere = {{ radius = "5 mm" }}
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = "20 kN/m"
restitution = {RESTITUTION}
[[populations]]
shape = "ball"
material = "glass"
count = 12
method = "lattice"
region = {{ box = [["-10 cm", "-10 cm", "40 mm"], ["10 cm", "10 cm", "60 mm"]] }}
[[walls]]
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "glass"
[output]
every = "50 ms"
"""
FUNCTION = '''\
"""Root of the energy of the balls above touch at the end over that at the start."""
import numpy as np
import scree


def restitution(run):
    frames = scree.open(run).frames
    before, after = frames[0].bodies, frames[-1].bodies
    energy = 9.81 * (after.position[:, 2] - 5e-3) + 0.5 * (after.velocity**2).sum(axis=1)
    return float(np.sqrt(energy / (9.81 * (before.position[:, 2] - 5e-3))).mean()), "-"
'''
shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)
folder = pathlib.Path(SCRATCH)
(folder / "balls.toml").write_text(CASE, encoding="utf-8")
(folder / "bounce.py").write_text(FUNCTION, encoding="utf-8")


def run(*words):
    result = subprocess.run([RUNNER, "balls.toml", "--error", "--quantity", "bounce.py:restitution", *words], cwd=SCRATCH, capture_output=True, text=True,
                            env={**os.environ, "SCREE_BIN": BIN}, check=False)
    assert result.returncode == 0, result.stderr
    return result


# which runs would be made, before any is
plan = run("--plan").stdout
assert "time.steps_per_contact = 16" in plan and "not possible: no body has a margin" in plan and not (folder / "balls.out/error/case.run").exists(), plan

result = run()
with open(folder / "balls.out/error/error.json", encoding="utf-8") as file:
    content = json.load(file)
numbers = {number["name"]: number for number in content["numbers"]}
number, energy, speed = (numbers[name] for name in ("bounce.py:restitution", "energy_error", "mean_speed"))
print("\n".join(f"{entry['name']} = {entry['text']}" for entry in (number, energy, speed)))
assert content["first"] == ["bounce.py:restitution"] and number["text"] in result.stdout
assert abs(number["value"] - RESTITUTION) <= number["total_error"] < 0.01, (number["value"], number["total_error"])
assert (energy["largest"], speed["largest"]) == ("step", "stiffness"), (energy, speed)
step = energy["effects"]["step"]
assert energy["value"] * step["value"] > 0 and (step["low"] > 0 or step["high"] < 0), "the step is seen, with the sign of the error"
assert abs(energy["value"] - step["value"]) < 0.5 * abs(energy["value"]), "without the effect of the step, the energy balance is nearer to zero"
assert set(number["missing"]) == {"margin", "shape"}, number["missing"]
page = (folder / "balls.out/error/error.md").read_text(encoding="utf-8")
assert number["text"] in page and "not possible: ball is an exact ball" in page and "## All other numbers" in page

# again: nothing is run, and the numbers are the same
records = {path: path.stat().st_mtime_ns for path in folder.glob("balls.out/error/*.run/run.json")}
assert len(records) == 23, sorted(records)   # five seeds of the case and of three settings, three of the softer one
run()
assert {path: path.stat().st_mtime_ns for path in folder.glob("balls.out/error/*.run/run.json")} == records, "a run was made twice"
with open(folder / "balls.out/error/error.json", encoding="utf-8") as file:
    assert json.load(file)["numbers"] == content["numbers"]
print("all as expected")
