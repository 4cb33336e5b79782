#!/usr/bin/env python3
"""Two engines in one program: balls fall out of one scene into another, below it. Mass and momentum of both together are what they must be.
usage: two_engines.py FOLDER"""
import os
import sys

import numpy as np
import scree

HEAD = """
gravity = [0, 0, -9.81]
time = { duration = "0.4 s", step = "50 us" }
contact = { margin = 0 }
shapes.ball = { sphere = { radius = "5 mm" } }
materials.glass = { density = 2500 }
pairs = [{ between = ["glass", "glass"], stiffness = "2 kN/m", restitution = 0.5, friction = 0.4 }]
[[populations]]
shape = "ball"
material = "glass"
"""
ABOVE = HEAD + """count = 40
size = { distribution = "uniform", min = "7 mm", max = "10 mm" }
region = { box = [[-0.03, -0.03, 0.01], [0.03, 0.03, 0.1]] }
"""
BELOW = HEAD + """count = 1
region = { box = [[-0.03, -0.03, -0.2], [0.03, 0.03, -0.18]] }
[[walls]]
name = "tray"
shape = { box_inside = [[-0.05, -0.05, -0.2], [0.05, 0.05, 0.5]] }
material = "glass"
"""


def opened(name, text):
    path = os.path.join(sys.argv[1], name)
    return scree.Engine(scree.pack(scree.Case.from_text(text, path + ".toml"), path + ".scene.h5", progress=False), threads=1)


def mass_and_momentum(*engines):
    return sum(np.column_stack([e.bodies.mass, e.bodies.mass[:, None] * e.bodies.velocity]).sum(axis=0) for e in engines)


with opened("above", ABOVE) as above, opened("below", BELOW) as below:
    dt, g, start = above.dt, above.gravity, mass_and_momentum(above, below)
    loads = [below.walls["tray"].load]
    below.after_step(lambda engine: loads.append(engine.walls["tray"].load))
    print("time [s]  above  below  mass [kg]     momentum [kg m/s]  start, weight, tray [kg m/s]")
    for step in range(8001):
        if step % 1000 == 0:
            now, impulse = mass_and_momentum(above, below), dt * (np.sum(loads[:-1], axis=0) + np.sum(loads[1:], axis=0)) / 2
            expected = start + np.append(0, start[0] * g * above.time - impulse)
            print(f"{above.time:8.3f} {len(above.bodies):6d} {len(below.bodies):6d} {now[0]:10.6f} {now[3]:21.12f} {expected[3]:29.12f}")
            assert np.abs(now - expected).max() < 1e-9 * start[0]
        fallen = above.bodies[above.bodies.position[:, 2] < 0]
        if len(fallen):  # both take place in the next step, at whose end a body is where it would have been
            below.insert("ball", "glass", fallen.position + dt * fallen.velocity + dt**2 / 2 * g, velocity=fallen.velocity + dt * g,
                         angular_velocity=fallen.angular_velocity, scale=fallen.scale)
            above.remove(fallen.id)
        above.step()
        below.step()
