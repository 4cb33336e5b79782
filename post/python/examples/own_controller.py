#!/usr/bin/env python3
"""A controller of your own, or the world of a learner: a ball is held at a height by a force that is set every 10 ms. The interface is that of
Gymnasium, `reset` and `step`. Heights are compared with the closed form of a mass under a force that is held. usage: own_controller.py FOLDER"""
import os
import sys
import warnings

import numpy as np
import scree

warnings.simplefilter("error", scree.ScreeWarning)  # a doubtful scene ends the program
case = scree.Case()
case["time"] = {"duration": 10, "step": "0.1 ms"}
case["contact.margin"] = 0
case["shapes.ball.sphere.radius"] = "1 cm"
case["materials.wood.density"] = 700
case["pairs"] = [{"between": ["wood", "wood"], "stiffness": "1 kN/m", "restitution": 0.5, "friction": 0.3}]
case["walls"] = [{"shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "material": "wood"}]
case.add_bodies("ball", "wood", [0, 0, 0.05])
case.path = os.path.join(sys.argv[1], "hover.toml")


class Hover:
    """Observation: height over the target [m] and speed [m/s]. Action: force upwards [N]. An episode ends after 1 s, or on the floor."""

    window, target = 100, 0.15  # steps, m
    def __init__(self, scene):
        self.engine = scree.Engine(scene, threads=1)
        self.start, self.ball = self.engine.save(), self.engine.bodies.id
        self.mass = self.engine.bodies.mass[0]
        self.weight = -self.engine.gravity[2] * self.mass

    def observe(self):
        bodies = self.engine.bodies
        return np.array([bodies.position[0, 2] - self.target, bodies.velocity[0, 2]])

    def reset(self):
        self.engine.restore(self.start)
        return self.observe(), {}

    def step(self, action):
        self.engine.set_wrench(self.ball, [0, 0, action])
        self.engine.step(self.window)
        seen = self.observe()
        return seen, -abs(seen[0]), len(self.engine.contacts()) > 0, self.engine.time > 0.9999, {}


world = Hover(scree.pack(case, os.path.join(sys.argv[1], "hover.scene.h5"), progress=False))
tau = world.window * world.engine.dt
print("stiffness [1/s^2]  damping [1/s]  reward  height over target [m]  closed form [m]")
for stiffness, damping in ((50, 5), (50, 15), (400, 30)):  # a learner would try more
    (seen, _), done, total = world.reset(), False, 0.0
    expected, gains = seen.copy(), np.array([stiffness, damping])
    step = np.array([[1, tau], [0, 1]]) - np.outer([tau**2 / 2, tau], gains)  # of a held acceleration, -gains . (height, speed)
    while not done:
        seen, reward, on_floor, out_of_time, _ = world.step(world.weight - world.mass * gains @ seen)
        total, done, expected = total + reward, on_floor or out_of_time, step @ expected
    print(f"{stiffness:17g} {damping:14g} {total:7.3f} {seen[0]:23.9f} {expected[0]:16.9f}")
    assert abs(seen[0] - expected[0]) < 1e-9, "velocity Verlet is exact for a constant force"
world.engine.close()
