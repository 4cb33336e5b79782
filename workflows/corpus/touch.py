#!/usr/bin/env python3
"""How far the surface at which bodies touch is off the one that was drawn, of meshes at several margins.

    workflows/corpus/touch.py OUT [--tools FOLDER] [--shapes FOLDER ...] [--table docs/results/touch-surface.md]

Shapes are generated ones, the rocks of the ready cases, and the *.shape.h5 of the folders (corpus.py leaves those of its meshes in OUT). For each,
`scree-decomposer pack` tells the mean over the surface and the largest deviation, over the margin.
"""
import argparse
import glob
import os
import re
import shlex
import subprocess

RATIOS = (0.02, 0.05, 0.075, 0.1)   # margin over the radius of the ball of the same volume
FELS = "/usr/share/assimp/models/3DS/fels.3ds"
ASTEROIDS = "/usr/share/openuniverse/3dmodels"
SHAPES = {
    "box 1 : 1 : 1": 'generate box --size "1 cm, 1 cm, 1 cm"',
    "box 3 : 2 : 1": 'generate box --size "3 cm, 2 cm, 1 cm"',
    "box in triangles of 2 mm": 'generate box --size "1 cm, 1 cm, 1 cm" --edge-length "2 mm"',
    "cylinder, height 2 radii": 'generate cylinder --radius "1 cm" --height "2 cm"',
    "sphere, 50 triangles": 'generate sphere --radius "1 cm" --edge-length "8 mm"',
    "sphere, 540 triangles": 'generate sphere --radius "1 cm"',
    "torus": 'generate torus --radius "1 cm" --tube-radius "4 mm"',
    "tetrahedron": 'generate tetrahedron --size "1 cm"',
    "rock of press, 80 triangles": 'generate rock --diameter "7 mm" --triangles 80 --elongation 0.8 --flatness 0.8 --seed 4',
    "rock of conveyor, 80 triangles": 'generate rock --diameter "30 mm" --triangles 80 --elongation 0.8 --flatness 0.8 --seed 3',
    "rock of drum, 768 triangles": f"import {FELS} --unit cm",
    "boulder amalthea, 1000 triangles": f"import {ASTEROIDS}/amalthea.bmf",
    "boulder castalia, 1000 triangles": f"import {ASTEROIDS}/castalia.bmf",
    "boulder ky, 1000 triangles": f"import {ASTEROIDS}/ky.bmf",
    "boulder toutatis, 1000 triangles": f"import {ASTEROIDS}/toutatis.bmf",
    "rock of hopper, 96 triangles": f"simplify {FELS} --triangles 96",
}
CASE = """
[time]
duration = "1 ms"
[shapes.s]
file = "{file}"
[materials.m]
density = 2500
[[pairs]]
between = ["m", "m"]
stiffness = 1e5
restitution = 0.5
friction = 0
[contact]
margin_ratio = {ratio}
[[bodies]]
shape = "s"
material = "m"
position = [0, 0, 0]
"""

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("out")
parser.add_argument("--tools", default="")
parser.add_argument("--shapes", nargs="*", default=[])
parser.add_argument("--table")
words = parser.parse_args()
os.makedirs(words.out, exist_ok=True)


def tool(name):
    return os.path.join(words.tools, name) if words.tools else name


def deviations(shape):
    """Of each margin: mean and largest over the margin; None where the case is refused."""
    found = []
    for ratio in RATIOS:
        path = os.path.join(words.out, "case.toml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CASE.format(file=os.path.abspath(shape), ratio=ratio))
        pack = subprocess.run([tool("scree-decomposer"), "pack", path, "-o", os.path.join(words.out, "case.scene.h5")], capture_output=True, text=True, check=False)
        line = re.search(r"off the drawn surface by ([0-9.e-]+) of its margin on average, ([0-9.e-]+) at most", pack.stdout)
        found.append((float(line[1]), float(line[2])) if line else None)
    return found


rows = []
for number, (name, command) in enumerate(SHAPES.items()):
    path = os.path.join(words.out, f"made-{number}.shape.h5")
    subprocess.run([tool("scree-mesher"), *shlex.split(command), "-o", path], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows.append((name, deviations(path)))
for folder in words.shapes:
    for path in sorted(glob.glob(os.path.join(folder, "**", "*.shape.h5"), recursive=True)):
        name = os.path.basename(path).removesuffix(".shape.h5")
        rows.append((os.path.basename(os.path.dirname(path)) if name == "result" else name, deviations(path)))

text = ["# Contact surface and drawn surface", "",
        "For contacts a mesh is moved inwards by its margin and surrounded by a layer of that thickness: edges and vertices are rounded, and thin parts are moved",
        "only partly ([decision 022](../develop/decisions/022-touch-where-surfaces-are-drawn.md)). Distance of the contact surface from the drawn surface, mean over the surface and (largest), over the margin,",
        "for margins of 2 to 10 % of the radius of the ball of the same volume. A corner of a cube is cut by .73 of the margin. Made by `workflows/corpus/touch.py`.", "",
        "| shape | " + " | ".join(f"{100 * ratio:g} %" for ratio in RATIOS) + " |", "|---|" + "---|" * len(RATIOS)]
for name, found in rows:
    text.append(f"| {name} | " + " | ".join("refused" if d is None else f"{d[0]:.3f} ({d[1]:.2f})" for d in found) + " |")
below = [sum(d is not None and d[0] < 0.1 for d in column) for column in zip(*(found for _, found in rows))]
text += ["", "Mean below a tenth of the margin: " + ", ".join(f"{n} of {len(rows)} at {100 * ratio:g} %" for n, ratio in zip(below, RATIOS)) + "."]
print("\n".join(text))
if words.table:
    with open(words.table, "w", encoding="utf-8") as file:
        file.write("\n".join(text) + "\n")
