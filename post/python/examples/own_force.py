#!/usr/bin/env python3
"""A force of your own, within every step: a magnet's pole below a box pulls weakly magnetic balls. Its work is the change of their magnetic energy.
usage: own_force.py FOLDER"""
import os
import sys

import numpy as np
import scree

MU0, CHI, FIELD, REACH = 4e-7 * np.pi, 0.3, 0.03, 0.02  # susceptibility of the balls; B = FIELD (REACH / d)^2 [T] at a distance d from the pole
POLE = np.array([0.0, 0.0, -0.01])

case = scree.Case.from_text("""
seed = 3
[time]
duration = "0.2 s"
[shapes.ball]
sphere = { radius = "4 mm" }
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = "5 kN/m"
restitution = 0.5
friction = 0.4
[[populations]]
shape = "ball"
material = "glass"
count = 60
region = { box = [["-25 mm", "-25 mm", "1 mm"], ["25 mm", "25 mm", "60 mm"]] }
[[walls]]
name = "box"
shape = { box_inside = [["-25 mm", "-25 mm", 0], ["25 mm", "25 mm", "200 mm"]] }
material = "glass"
""", os.path.join(sys.argv[1], "magnet.toml"))


def energy(bodies):
    """-V chi B^2 / (2 mu0) of each ball [J]."""
    d = np.linalg.norm(bodies.position - POLE, axis=1)
    return -bodies.volume * CHI / (2 * MU0) * (FIELD * (REACH / d) ** 2) ** 2


def magnet(bodies):
    """Its negative gradient [N]: towards the pole, as 1 / d^5."""
    r = bodies.position - POLE
    return (4 * energy(bodies) / (r**2).sum(axis=1))[:, None] * r


with scree.Engine(scree.pack(case, os.path.join(sys.argv[1], "magnet.scene.h5"), progress=False), threads=1) as engine:
    start = energy(engine.bodies).sum()
    engine.add_force(magnet)
    print("  time [s]  kinetic [J]  load on the box [N]  work of the magnet [J]  its energy given [J]  difference")
    while engine.time < engine.duration:
        engine.run_until(engine.time + 0.04)
        work, given = engine.energies().outer_work, start - energy(engine.bodies).sum()
        load = engine.walls["box"].load[2]
        print(f"{engine.time:10.4f} {engine.energies().kinetic:12.4e} {load:20.4f} {work:23.6e} {given:21.6e} {work / given - 1:11.1e}")
        assert abs(work / given - 1) < 1e-3, "of velocity Verlet: proportional to dt^2"
    print(engine.frame().measures()["coordination_number"], "contacts a ball")
