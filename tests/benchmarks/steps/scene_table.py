#!/usr/bin/python3
"""The speed of finished runs with their errors, one row each, as a table for docs/results/performance.md.

  tests/benchmarks/steps/scene_table.py OUT/*.run ...

Speed: steps of bodies, counted at each output from ranks.csv since bodies come and leave, over the wall seconds of the phases without output and
the number of cores: of a machine that had nothing else to do on these cores. Errors: the largest departure of the energy balance over what was
exchanged; the deepest overlap over the room of its pair (contacts end a run at 0.97).
"""
import csv
import json
import sys
from pathlib import Path


def body_steps(run):
    """Steps times bodies, those of an interval between outputs as the mean of its ends."""
    bodies = {}
    with open(run / "ranks.csv") as file:
        for line in csv.DictReader(line for line in file if not line.startswith("#")):
            step = int(line["step"])
            bodies[step] = bodies.get(step, 0) + int(line["bodies"])
    steps = sorted(bodies)
    return sum((b - a) * (bodies[a] + bodies[b]) / 2 for a, b in zip(steps, steps[1:]))


def row(run):
    record = json.loads((run / "run.json").read_text())
    phases = record["phases"]
    seconds = sum(value for name, value in phases.items() if name != "output")
    cores = record["ranks"] * record["threads"]
    done = body_steps(run)
    bodies = round(done / record["steps"])
    rate = done / (seconds * cores)
    digits = 10 ** max(0, len(str(int(rate))) - 3)
    return [run.name.removesuffix(".run"), f"{bodies}", record["settings"]["settings"]["law"], f"{record['steps']}", f"{record['step_size']:.3g} s",
            f"{int(round(rate / digits) * digits):,}".replace(",", " "), f"{seconds * cores:.0f} s", f"{record['energy']['error_relative']:.1e}",
            f"{record['max_depth_ratio']:.2f}"]


def main():
    runs = [Path(word) for word in sys.argv[1:]]
    missing = [run for run in runs if not (run / "run.json").exists()]
    for run in missing:
        print(f"scene_table: {run} has no run.json: not a run that has ended; give folders of runs that have", file=sys.stderr)
    if missing:
        return 2
    if not runs:
        print(__doc__, file=sys.stderr)
        return 2
    head = ["scene", "bodies, mean", "law", "steps", "step", "particle-steps/s and core", "core time", "energy error", "deepest"]
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for run in runs:
        print("| " + " | ".join(row(run)) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
