#!/usr/bin/env python3
"""From a mesh file to a report: twelve bodies of it fall on a floor. The material suits bodies of about a centimetre.
usage: whole_way.py MESH UNIT FOLDER      for instance: whole_way.py rock.stl mm heap"""
import os
import sys

import scree


def show(now: scree.Progress) -> None:
    print(f"{now.name}: {now.share:.0%} {now.text}")


mesh, unit, folder = sys.argv[1:4]
os.makedirs(folder, exist_ok=True)
rock = scree.import_mesh(mesh, os.path.join(folder, "rock.shape.h5"), unit=unit, name="rock", progress=False)["rock"]
size = 2.2 * rock.bounding_radius

case = scree.Case.from_text(f"""
[time]
duration = "10 ms"
[shapes.rock]
file = "rock.shape.h5"
[materials.stone]
density = 2600
[[pairs]]
between = ["stone", "stone"]
stiffness = "20 kN/m"
restitution = 0.3
friction = 0.5
[[populations]]
shape = "rock"
material = "stone"
count = 12
region = {{ box = [[{-1.5 * size}, {-1.5 * size}, {0.1 * size}], [{1.5 * size}, {1.5 * size}, {3 * size}]] }}
velocity = [0, 0, "-0.3 m/s"]
[[walls]]
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "stone"
""", os.path.join(folder, "heap.toml"))
scene = scree.pack(case, os.path.join(folder, "heap.scene.h5"), progress=show)
run = scree.solve(scene, threads=1, progress=show)
print(run)
print("wrote", scree.report(run, progress=show))
