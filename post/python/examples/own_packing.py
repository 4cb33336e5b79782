#!/usr/bin/env python3
"""A packing of your own in a case: cubes laid as a wall of bricks, hit by a ball; then run and looked at.
usage: own_packing.py FOLDER"""
import os
import sys

import numpy as np
import scree

folder = sys.argv[1]
side, gap = scree.si("1 cm"), scree.si("1.2 mm")  # two margins of 0.5 mm and a little
scree.generate("cube", os.path.join(folder, "brick.shape.h5"), size="1 cm", name="brick", progress=False)

case = scree.Case()
case["title"] = "a wall of bricks"
case["time.duration"] = "20 ms"
case["shapes"] = {"brick": {"file": "brick.shape.h5"}, "ball": {"sphere": {"radius": "8 mm"}}}
case["materials.clay.density"] = 1900
case["pairs"] = [{"between": ["clay", "clay"], "stiffness": "20 kN/m", "restitution": 0.2, "friction": 0.6}]
case["contact.margin"] = "0.5 mm"
case["walls"] = [{"name": "floor", "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "material": "clay"}]
case["output.every"] = "5 ms"

# every second row is moved by half a brick
places = [((column + 0.5 * (row % 2) - 2) * (side + gap), 0.0, (row + 0.5) * (side + gap)) for row in range(4) for column in range(4)]
case.add_bodies("brick", "clay", np.array(places))
case.add_bodies("ball", "clay", [0, -0.03, 0.022], velocity=[0, 1.5, 0])
case.path = os.path.join(folder, "bricks.toml")
try:
    case.check()
except scree.UsageError as error:  # each problem with its key
    sys.exit(str(error))
path = case.save()
print(scree.call("decomposer", "check", path, progress=False).output, end="")

scene = scree.pack(path, os.path.join(folder, "bricks.scene.h5"), progress=False)
run = scree.solve(scene, threads=1, progress=lambda now: print(f"{now.name} {now.share:.0%}"))
moved = np.linalg.norm(run.frames[-1].bodies.position - run.frames[0].bodies.position, axis=1)
print(f"{run}\nthe bricks moved by {1e3 * moved[:-1].mean():.2f} mm on average, {1e3 * moved[:-1].max():.2f} mm at most")
print(f"brick: {scree.open_shapes(os.path.join(folder, 'brick.shape.h5'))['brick']}; margin {scree.open_scene(scene.path).settings['margin']} m; {run.materials}")
