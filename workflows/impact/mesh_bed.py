#!/usr/bin/env python3
"""A bed of meshes that begins as a bed of balls. usage: mesh_bed.py BALLS SHAPE.shape.h5 OUT.toml

Writes the case BALLS.toml with a mesh in the place of each ball of the run BALLS.run, turned as the ball was, as large as fits into it. The meshes
fall by some per cent of the height of the bed until they rest: a fraction of the time that it takes to pour them.
"""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from scree.scene import open_shapes  # noqa: E402

BALLS, SHAPE, OUT = sys.argv[1:]

bodies = scree.open(f"{BALLS}.run").frames[-1].bodies
case = scree.Case(f"{BALLS}.toml")
case["shapes.grain"] = {"file": SHAPE}
case["time.duration"] = "0.1 s"
case["output.every"] = "20 ms"
case["output.checkpoint"] = "20 ms"
material = case.data.pop("populations")[0]["material"]
reach = np.linalg.norm(open_shapes(SHAPE).by_index(0).vertices, axis=1).max()
case.add_bodies("grain", material, bodies.position, quaternion=bodies.quaternion, scale=0.5 * bodies.diameter / reach)
case.save(OUT)
