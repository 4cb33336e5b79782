#!/usr/bin/env python3
"""Do intervals of five seeds hold the mean of forty others? usage: error_study.py WORKFLOWS BIN SCRATCH [CASE ...]

45 seeds of small cases: the solid fraction of a bed, the angle of a heap, the discharge rate of a hopper. 200 draws of five seeds each (a fixed seed); the
interval of five, widened by sqrt(1 + 5/40) for the error of the other mean, must hold the mean of the other forty in 90 to 99 %: a perfect program passes in
99 % of pools of 45. Resumes: what is there is not run again.
"""
import json
import math
import os
import pathlib
import sys

import numpy as np

WORKFLOWS, BIN, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
os.environ["SCREE_BIN"] = str(BIN)
os.environ["PATH"] = os.pathsep.join([str(BIN), os.environ["PATH"]])
sys.dont_write_bytecode = True
sys.path[:0] = [str(WORKFLOWS), str(WORKFLOWS.parent / "post" / "python")]
from points_queue import PointsQueue  # noqa: E402
from scree.intervals import mean_interval  # noqa: E402

SEEDS, FEW, DRAWS = 45, 5, 200
HELD = (0.90, 0.99)
# (workflow, run, words of --config, quantity)
CASES = {"bed": ("boulders", None, ["size=small", "statistics=--frames last"], "solid_fraction"),
         "heap": ("repose", "repose-ball", ["size=small", "statistics=--frames last --repose cone"], "angle_of_repose"),
         "hopper": ("hopper", "hopper-ball-17", ["size=small"], "discharge_rate")}

failures = []
for name in sys.argv[4:] or CASES:
    case, run, words, quantity = CASES[name]
    folder = str(SCRATCH / name)
    points = {f"{name}-{seed}": {"case": run, "seed": str(seed)} for seed in range(1, SEEDS + 1)}
    code, text = PointsQueue(os.cpu_count(), words).call(case, folder, points, [f"{point}.statistics/statistics.json" for point in points])
    if code != 0:
        sys.exit(f"{name}: workflows/run ended with exit code {code}:\n{text[-2000:]}")
    values = []
    for point in points:
        with open(f"{folder}/{point}.statistics/statistics.json", encoding="utf-8") as file:
            values.append(json.load(file)["groups"]["all"][quantity]["mean"])
    values = np.array(values)
    random, inside = np.random.default_rng(1), 0
    for _ in range(DRAWS):
        order = random.permutation(SEEDS)
        interval = mean_interval(values[order[:FEW]])
        wider = math.sqrt(1 + FEW / (SEEDS - FEW))
        inside += interval.value - wider * (interval.value - interval.low) <= values[order[FEW:]].mean() <= interval.value + wider * (interval.high - interval.value)
    share = inside / DRAWS
    print(f"{name}: {quantity} {values.mean():.4g}, standard deviation of a seed {values.std(ddof=1):.2g}: the interval of {FEW} seeds holds the mean of {SEEDS - FEW} others in {100 * share:.1f} % of {DRAWS} draws", flush=True)
    if not HELD[0] <= share <= HELD[1]:
        failures.append(name)
if failures:
    sys.exit(f"outside of {HELD[0]} to {HELD[1]}: {', '.join(failures)}")
