#!/usr/bin/env python3
"""Plots of your own: energies over time, and the last frame coloured by the force that each body carries.
usage: own_plot.py NAME.run PICTURE.png"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import scree

try:
    run = scree.open(sys.argv[1])
except scree.InputError as error:
    sys.exit(f"own_plot.py: {error}")
frame, log = run.frames[-1], run.log
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
for name in ("kinetic_translational", "kinetic_rotational", "dissipated"):
    left.plot(log["time"], log[name], label=name.replace("_", " "))
left.set(xlabel=f"time [{log.units['time']}]", ylabel=f"energy [{log.units['dissipated']}]")
left.legend()

carried = np.zeros(len(frame.bodies))
contacts = frame.contacts
for ids in (contacts.body_a, contacts.body_b):
    of_body = np.isin(ids, frame.bodies.id)  # walls are not bodies
    np.add.at(carried, np.searchsorted(frame.bodies.id, ids[of_body]), contacts.normal_force[of_body])
frame.plot(right, colour=carried)
right.set_title("sum of normal forces [N]")
figure.savefig(sys.argv[2])
print("wrote", sys.argv[2])

# bodies as triangles: of one body, of all, of a wall; other packages draw or measure them
mesh = frame.mesh(int(frame.bodies.id[-1]))
print(f"{mesh}: area {mesh.area:.3g} m^2; all: {frame.meshes()}")
try:
    print(mesh.to_trimesh().bounds)
except scree.MissingPackage as error:
    print(error)
# the axis of each body that was z in its mesh file: two ways
up = scree.rotate(frame.bodies.quaternion, [0, 0, 1])
assert np.allclose(up, scree.rotation_matrix(frame.bodies.quaternion)[:, :, 2])
print(f"mean tilt {np.degrees(np.arccos(np.abs(up[:, 2]))).mean():.1f} deg")
