#!/usr/bin/env python3
"""A statistic of your own: how much faster bodies are at the top of a bed than at its bottom.
usage: own_statistic.py NAME.run"""
import sys

import numpy as np
import scree

run = scree.open(sys.argv[1])
rows = []
for frame in run.frames:
    bodies = frame.bodies.particles()
    height, speed = bodies.position[:, 2], np.linalg.norm(bodies.velocity, axis=1)
    low, high = speed[height < np.median(height)], speed[height >= np.median(height)]
    rows.append((frame.time, low.mean(), high.mean(), len(frame.contacts)))
table = scree.Table(dict(zip(("time", "speed_below", "speed_above", "contacts"), zip(*rows))), {"time": "s", "speed_below": "m/s", "speed_above": "m/s"})
print("wrote", table.write(run.name + ".layers.csv"))

# a region with the rule of scree-post, and the numbers that both have
low = scree.region("box:-1,-1,0,1,1,1 cm")
frame = run.frames[-1]
print(f"{len(run.bodies(-1).in_region(low))} bodies below 1 cm, coordination number {frame.measures(low)['coordination_number']:.2f}")
print(f"{len(run.bodies(-1).in_region(scree.Sphere([0, 0, 0.01], 0.01)))} in a ball, {len(run.bodies().in_region(scree.Cylinder([0, 0, 0], [0, 0, 1], 0.01)))}"
      f" in a cylinder, {len(run.bodies().in_region(scree.Box([-1, -1, -1], [0, 1, 1])))} at x < 0")
for name in run.walls:
    print(f"load on {name}: {frame.walls.force[frame.walls.row(name)]} N")

# the mean over time with its confidence interval
steady = scree.statistics(run, run.name + ".statistics", no_charts=True, progress=False)
print(f"coordination number {steady.mean('coordination_number'):.3f} +- {steady.ci95('coordination_number'):.3f}")
