# The shared scene in Yade as convex polyhedra. Run by `run` as: yade -j1 -nx yade_scene.py, with SCENE=FILE.json in the environment.
# Physics: force = stiffness x overlap volume (Law2_PolyhedraGeom_PolyhedraPhys_Volumetric), Coulomb friction, no model of
# restitution, only Yade's numerical damping of all motion. Convex shapes only.
import json
import math
import os
import sys
import time

from yade import polyhedra_utils

options = json.load(open(os.environ["SCENE"]))
sys.path.insert(0, options["scripts"])
import scene

shapes = [scene.read_obj(scene.Path(options["shapes"]) / f"shape_{k}.obj")[0] for k in range(scene.SHAPE_COUNT)]
inertia = [[scene.DENSITY * m for m in row[1:4]] for row in scene.read_shapes(scene.Path(options["shapes"]))]
state = scene.read_state(scene.Path(options["start"]))
length = options["length"]

material = PolyhedraMat()
material.density, material.poisson, material.frictionAngle = scene.DENSITY, 0.3, math.atan(scene.FRICTION)
material.young = 2e9  # [N/m^3]: force over volume of overlap
O.materials.append(material)
bodies = []
for row in state:
    turn = scene.rotation_matrix(row[4:8])
    corners = [Vector3(*[sum(turn[i][j] * v[j] for j in range(3)) + row[1 + i] for i in range(3)]) for v in shapes[row[0]]]
    body = polyhedra_utils.polyhedra(material, v=corners)
    O.bodies.append(body)
    body.state.vel, body.state.angVel = Vector3(*row[8:11]), Vector3(*row[11:14])
    local = [sum(turn[j][i] * row[11 + j] for j in range(3)) for i in range(3)]
    momentum = [m * w for m, w in zip(inertia[row[0]], local)]
    body.state.angMom = Vector3(*[sum(turn[i][j] * momentum[j] for j in range(3)) for i in range(3)])
    bodies.append((body, body.state.ori))
for axis, position in ((2, 0.0), (0, 0.0), (0, length), (1, 0.0), (1, length)):
    O.bodies.append(utils.wall(position, axis=axis, sense=0, material=material))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()], verletDist=0.05 * scene.RADIUS),
    InteractionLoop([Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
                    [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()], [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
    NewtonIntegrator(damping=0.3, gravity=(0, 0, -scene.GRAVITY)),
]
O.dt = scene.STEP
O.run(2, True)  # builds what is built once
begin = time.process_time()
O.run(options["steps"], True)
cpu = time.process_time() - begin

end = []
for row, (body, first) in zip(state, bodies):
    s = body.state
    q = s.ori * first.inverse() * Quaternion(*row[4:8])  # Yade turns a body to its own principal axes when it is made
    end.append([row[0], *s.pos, q[3], q[0], q[1], q[2], *s.vel, *s.angVel])
scene.write_state(scene.Path(options["end"]), end)
json.dump({"cpu": cpu, "steps": options["steps"], "version": "2023.02a"}, open(options["result"], "w"))
O.exitNoBacktrace()
