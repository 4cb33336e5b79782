"""A small run that has everything that a frame can have: bonds, walls with load maps and wear, impacts, a wall that answers to force, bodies
that come in and that leave."""
import os
import subprocess

MATERIALS = """\
[materials.m]
density = 2500
[materials.steel]
density = 7800
[[pairs]]
between = ["m", "m"]
stiffness = 2e4
restitution = 0.5
friction = 0.4
[[pairs]]
between = ["m", "steel"]
stiffness = 2e4
restitution = 0.5
friction = 0.4
"""
CASE = """
title = "everything"
seed = 2
gravity = [0, 0, -9.81]
[time]
duration = 0.12
[contact]
margin = "0.4 mm"
surface = "outside"
[domain]
min = [-0.09, -0.02, -0.09]
max = [0.09, 0.08, 0.09]
outside = "remove"
""" + MATERIALS + """\
[shapes.ball]
sphere = { radius = "7 mm" }
[shapes.rock]
file = "rock.shape.h5"
pieces = "pieces.shape.h5"
[[populations]]
shape = "rock"
material = "m"
count = 3
velocity = [0, 0, -1]
region = { cylinder = { start = [0, 0.01, -0.02], end = [0, 0.05, -0.02], radius = 0.04 } }
[[inlets]]
name = "chute"
shape = "ball"
material = "m"
number_rate = "200 Hz"
velocity = [0, 0, -1]
region = { box = [[-0.03, 0.01, 0.0], [0.03, 0.05, 0.03]] }
[[outlets]]
name = "hole"
region = { box = [[-0.01, 0.02, -0.08], [0.01, 0.04, -0.055]] }
[[walls]]
name = "drum"
shape = { drum = { start = [0, 0, 0], end = [0, 0.06, 0], radius = 0.075, segments = 16 } }
material = "steel"
motion = { rotate = { axis = [0, 1, 0], centre = [0, 0, 0], rate = "60 rpm" } }
wear = { coefficient = 2e-7, every = "0.012 s" }
[[walls]]
name = "lid"
shape = { plate = { corner = [-0.04, 0.005, -0.04], side_a = [0.03, 0, 0.01], side_b = [0, 0.05, 0] } }
material = "steel"
motion = { free = { guide = [0, 0, 1], mass = "0.2 kg", stroke = [-0.02, 0.03] } }
load_map = true
[output]
every = EVERY
checkpoint = 0.02
impacts = true
"""


BONDS = """[[bonds]]
within = "m"
young = "1 MPa"
tension = "5 MPa"
cohesion = "10 MPa"
"""


def make_rich_run(bin_folder, folder, bonds=True, every=0.02):
    """Writes rich.run, and all that it is made of, into a folder; returns its path. Without bonds: loose.run, with which a case can start."""
    name = "rich" if bonds else "loose"
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, f"{name}.toml"), "w", encoding="utf-8") as file:
        case = CASE.replace("EVERY", str(every))
        file.write(case.replace("[[inlets]]", BONDS + "[[inlets]]") if bonds else case)
    for words in (["scree-mesher", "generate", "box", "--size", "16 mm,14 mm,12 mm", "-o", "rock.shape.h5"],
                  ["scree-mesher", "fracture", "rock.shape.h5", "--cells", "4", "--inset", "0.4 mm", "-o", "pieces.shape.h5"],
                  ["scree-decomposer", "pack", f"{name}.toml", "-o", f"{name}.scene.h5"], ["scree-solver", f"{name}.scene.h5", "-o", f"{name}.run"]):
        done = subprocess.run([os.path.join(bin_folder, words[0]), *words[1:]], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, (words, done.stderr)
    return os.path.join(folder, f"{name}.run")
