#!/usr/bin/env python3
"""A bed goes to other programs, and comes back as a case of its own: H5MD, LAMMPS and LIGGGHTS, Yade, VTK.
usage: exchange.py NAME.run FOLDER"""
import os
import sys

import numpy as np
import scree

run, folder = scree.open(sys.argv[1]), sys.argv[2]
os.makedirs(folder, exist_ok=True)

# all frames, without a second copy of the numbers; and the last one as spheres
same_rows = scree.write_h5md(run, os.path.join(folder, "bed.h5md"))
print(f"bed.h5md: each row is {'the' if same_rows else 'not the'} same body in all frames")
bed = scree.Packing.of(run.bodies(-1).particles())
for name in ("bed.data", "bed.dump", "bed.txt", "bed.vtp"):
    bed.write(os.path.join(folder, name))

# what another program left becomes the bodies of a case
back = scree.Packing.read(os.path.join(folder, "bed.dump"))
print(f"{len(back)} spheres went out and came back: places differ by {np.abs(back.position - bed.position).max():g} m; {back}")
case = scree.Case()
case["time.duration"] = "5 ms"
case["shapes.ball.sphere.radius"] = "1 mm"  # scaled to the radius of each
case["materials.glass.density"] = 2500
case["pairs"] = [{"between": ["glass", "glass"], "stiffness": "20 kN/m", "restitution": 0.5, "friction": 0.3}]
lower, upper = back.box
case["walls"] = [{"name": "floor", "shape": {"plane": {"point": [0, 0, float(lower[2])], "normal": [0, 0, 1]}}, "material": "glass"}]
case["contact.relax"] = True  # spheres at rest in another program overlap a little
back.add_to(case, "ball", dict.fromkeys(np.unique(back.kind).tolist(), "glass"))
case.save(os.path.join(folder, "again.toml"))
scene = scree.pack(case.path, os.path.join(folder, "again.scene.h5"), progress=False)
print(scree.solve(scene, threads=1, progress=False))
