#!/usr/bin/env python3
"""Measures error against run time for what a user can choose. usage: measure.py STUDY BIN OUT [--repeats 5]

STUDY is one of: integrators, impact, collision, mesh, margin, drift, attraction. Writes OUT/STUDY.csv (one row per setting,
columns of validation plan 4.5) and OUT/STUDY.json (what the plots draw). The time of a setting is that of its steps, output
left out, the least of all repeats (the median is in the CSV); repeats of all settings of a study are interleaved, so that a
busy machine spoils all alike.
"""
import argparse
import json
import math
import os
import sys

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "validation"))

import closed_forms as cf  # noqa: E402
import meshes  # noqa: E402
from cases_impulse import lowest_vertex, world_inertia  # noqa: E402
from cases_rotation import INERTIA, angle_between, exact_box  # noqa: E402
from report import append_row, row_of  # noqa: E402
from scene import Case, ToolError, Tools, quaternion, rotated  # noqa: E402

INTEGRATORS = ["kdk-dlm", "midpoint", "spiral", "rig", "euler"]
LAWS = ["linear", "hunt-crossley", "hertz-mindlin"]


def step_seconds(run):
    return sum(seconds for phase, seconds in run.record["phases"].items() if phase != "output")


class Study:
    """Settings of one study: each a case to run, how to read its error, and where it belongs in the plots."""

    def __init__(self, name, tools, repeats):
        self.name, self.tools, self.repeats, self.settings, self.refused = name, tools, repeats, [], []

    def add(self, make, error, **labels):
        self.settings.append({"make": make, "error": error, "labels": labels, "seconds": []})

    def measure(self):
        for n in range(self.repeats):
            for s in self.settings:
                if "refused" in s:
                    continue
                try:
                    if n == 0:
                        s["case"] = s["make"]()
                        s["scene"] = s["case"].pack(self.tools)
                    run = s["case"].solve(self.tools, s["scene"])
                except ToolError as failure:
                    s["refused"] = failure.text.strip().splitlines()[-1]
                    print(f"{self.name} {s['labels']}: refused: {s['refused']}", flush=True)
                    continue
                s["seconds"].append(step_seconds(run))
                if n == 0:
                    s["run"], s["errors"] = run, s["error"](run)
        rows, path = [], os.path.join(self.tools.out, f"{self.name}.csv")
        if os.path.exists(path):
            os.remove(path)
        for s in self.settings:
            if "refused" in s:
                rows.append({**s["labels"], "refused": s["refused"]})
                continue
            errors = {key: value for key, value in s["errors"].items() if key in ("error_e", "error_t", "error_traj", "max_residual")}
            append_row(path, row_of(f"{self.name} " + " ".join(f"{v}" for v in s["labels"].values()), s["run"], s["seconds"], **errors))
            rows.append({**s["labels"], **s["errors"], "seconds": min(s["seconds"]), "median": float(numpy.median(s["seconds"])), "step": s["run"].step,
                         "steps": s["run"].steps, "contacts": float(numpy.mean(s["run"].log["contacts"])), "depth": s["run"].max_depth_ratio})
        with open(os.path.join(self.tools.out, f"{self.name}.json"), "w") as file:
            json.dump(rows, file, indent=1, default=float)


def integrators(study):
    """Free rotation of a box (R1, R2) to T = 10 and 5: orientation error."""
    for motion, w0, duration in (("R1", (1, 2, 3), 10.0), ("R2", (.1, 10, 0), 5.0)):
        exact = cf.free_orientation(INERTIA, w0, duration)
        for name in INTEGRATORS:
            for step in (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4):
                def make(name=name, step=step, w0=w0, duration=duration, motion=motion):
                    c = Case(f"integrators-{motion}-{name}-{step}", duration=duration, step=step, every=duration, margin=.001, integrator=name)
                    c.shape_file("box", exact_box(study.tools))
                    c.material("m", 1000.0)
                    c.pair_all(stiffness=1.0, restitution=1.0)
                    c.body("box", "m", (0, 0, 0), angular_velocity=w0)
                    return c
                study.add(make, lambda run, exact=exact: {"error_traj": angle_between(run.q[-1, 0], exact)}, case=motion, curve=name, dt=step)


def impact(study):
    """Restitution of a ball on a plane, worst of 41 phases, by law and steps a contact."""
    k, e_sum, R, e = 1e4, .02, .5, .5
    density = 1 / (4 / 3 * math.pi * R**3)
    contact = math.pi / math.sqrt(k)
    # Hertz: as hard as makes the impact last as long, t = 2.943 d / v with d = (15 m v^2 / (16 E* sqrt R))^(2/5); no margin, E = 2 E* (poisson 0)
    young = 2 * 15 / (16 * math.sqrt(R) * (contact / 2.94327518) ** 2.5)
    for law in LAWS:
        for name in INTEGRATORS:
            for steps in (8, 12, 20, 30, 50, 100, 200, 400):
                def make(law=law, name=name, steps=steps):
                    dt = contact / steps
                    hertz = law == "hertz-mindlin"
                    gap = 0.0 if hertz else e_sum
                    c = Case(f"impact-{law}-{name}-{steps}", duration=2.0 * contact, step=dt, margin=gap / 2, law=law, every=2.0 * contact, integrator=name)
                    c.sphere("ball", R)
                    c.material("m", density, **({"young": young} if hertz else {}))
                    c.pair_all(restitution=e, **({} if hertz else {"stiffness": k}), **({"restitution_speed": 1.0} if law == "hunt-crossley" else {}))
                    for j in range(41):
                        c.body("ball", "m", (2 * j, 0, R + gap + dt * (1 + (j + .5) / 41)), velocity=(0, 0, -1))
                    c.floor()
                    return c

                def error(run, law=law):
                    return {"error_e": numpy.abs(run.v[-1, :, 2] - e).max()}
                study.add(make, error, case=law, curve=name, steps_per_contact=steps)


def collision(study):
    """Two free concave rocks, elastic: energy error and position error against 3200 steps a contact."""
    random = numpy.random.default_rng(11)
    q = random.normal(size=(12, 2, 4))
    q /= numpy.linalg.norm(q, axis=2)[..., None]
    rocks = [meshes.rock(3, 2), meshes.rock(4, 2)]

    def make(name, steps, repeat_mesh=None):
        c = Case(f"collision-{name}-{steps}", duration=1.0, steps_per_contact=steps, margin=.01, every=1.0, integrator=name)
        for i, mesh in enumerate(rocks):
            c.mesh(f"rock{i}", mesh)
        c.material("m", 1.0)
        c.pair_all(stiffness=1e4, restitution=1.0)
        for i in range(len(q)):
            c.body("rock0", "m", (-.7, 5 * i, 0), orientation=q[i, 0], velocity=(.5, 0, 0))
            c.body("rock1", "m", (.7, 5 * i + .1, .05), orientation=q[i, 1], velocity=(-.5, 0, 0))
        return c
    reference = make("kdk-dlm", 3200).run(study.tools)
    # the end times differ by less than a step: positions are compared at the same time by free flight
    end = reference.times[-1]

    def error(run):
        x = run.x[-1] + (end - run.times[-1]) * run.v[-1]
        energy = run.energy()
        # per pair: the whole scene's energy hides errors of both signs
        return {"error_traj": numpy.abs(x - reference.x[-1]).max(), "error_e": abs(energy[-1] / energy[0] - 1)}
    for name in INTEGRATORS:
        for steps in (10, 20, 30, 50, 100, 200, 400):
            study.add(lambda name=name, steps=steps: make(name, steps), error, case="rocks", curve=name, steps_per_contact=steps)


SCAN = "/usr/share/glmark2/models/bunny.obj"  # Debian package glmark2-data


def scan(tools, triangles, width=1.0):
    """The scanned rabbit of Stanford, 69 666 triangles, simplified by scree-mesher: (vertices, triangles) about its centre, so wide."""
    path = os.path.join(tools.out, f"scan-{triangles}.off")
    tools.call("scree-mesher", "simplify", SCAN, "-o", path, "--triangles", str(triangles))
    with open(path) as file:
        words = [line.split() for line in file if line.strip() and not line.startswith("#")]
    count, faces = (int(word) for word in words[1][:2])
    vertices = numpy.array(words[2:2 + count], float)
    vertices *= width / numpy.ptp(vertices, axis=0).max()
    return meshes.centred((vertices, numpy.array([row[1:4] for row in words[2 + count:2 + count + faces]], int)))


def mesh(study):
    """Restitution and duration of impacts against the number of triangles: locked icospheres and a scan, a cube on its face (M9)."""
    e = .5
    # the elastic layer: as stiff as the spring when a face lies flat; its force on a ball grows with depth squared, so it has to be harder
    layer = {"cube": 1e4 * .02, "icosphere": 1e6 * .02, "scan": 1e6 * .02}
    scans = {triangles: scan(study.tools, triangles) for triangles in (300, 1000, 3000, 10000, 30000)}
    for gather, finenesses in (("potential", (30, 100, 400)), ("area", (400,)), ("pairs", (400,))):
        for steps in finenesses:
            # level 6 and the finest scan for the default alone: the others take minutes for them
            finest = gather == "potential"
            for kind, levels in (("icosphere", range(7 if finest else 6)), ("scan", tuple(scans)[:5 if finest else 3]), ("cube", (1, 2, 4, 8, 16))):
                for level in levels:
                    body = meshes.icosphere(level, .5) if kind == "icosphere" else scans[level] if kind == "scan" else meshes.box((1, 1, 1), level)
                    density = 1 / meshes.mass_properties(body)[0]

                    def make(body=body, density=density, kind=kind, level=level, gather=gather, steps=steps):
                        dt = math.pi / math.sqrt(1e4) / steps
                        c = Case(f"mesh-{gather}-{kind}-{level}-{steps}", duration=.08, step=dt, margin=.01, every=.08 if steps < 400 else 8 * dt, gather=gather)
                        q = (1, 0, 0, 0) if kind == "cube" else quaternion((1, 2, 3), .4)
                        c.mesh("body", body)
                        c.material("m", density)
                        c.pair_all(restitution=e, **({"layer_modulus": layer[kind]} if gather == "area" else {"stiffness": 1e4}))
                        low = -rotated(numpy.asarray(q), body[0])[:, 2].min()
                        c.body("body", "m", (0, 0, low + .02 + 1.5 * dt), orientation=q, velocity=(0, 0, -1), lock_rotation=True)
                        c.floor()
                        return c

                    def error(run, triangles=len(body[1])):
                        touching = run.log["time"][run.log["contacts"] > 0]
                        duration = touching[-1] - touching[0] if len(touching) else 0.0
                        return {"error_e": abs(run.v[-1, 0, 2] - e), "duration": duration, "triangles": triangles}
                    study.add(make, error, case=kind, curve=gather, level=level, steps_per_contact=steps)


def margin(study):
    """Impact of a box on its corner against the rigid impulse: thin margins are stiff, exact and slow. A corner that is rounded by its margin
    has a shorter arm; one that has the margin around it ("outside") touches early."""
    body = meshes.box((1, .8, .6))
    density, e = 1 / .48, .744079
    q = quaternion((.6, .5, .3), .9)
    low = lowest_vertex(body, q)
    v1, w1 = cf.impulse(1.0, world_inertia(body, density, q), low, numpy.array([0, 0, 1.]), numpy.array([0, 0, -1.]), numpy.zeros(3), e)
    for steps, surface in ((20, "drawn"), (30, "drawn"), (30, "outside"), (100, "drawn")):
        for share in (.05, .03, .02, .01, .005, .002, .001, .0005):
            eps = share * .6

            def make(eps=eps, steps=steps, surface=surface):
                # design rule: the impact uses up 0.4 of the margins; the corner moves m_eff, not the mass
                m_eff = 1 / cf.pair_mobility(numpy.array([0, 0, 1.]), [(1.0, world_inertia(body, density, q), low)])
                k = m_eff * (1 / (.4 * eps)) ** 2
                # a fall of the same height for all: what a user waits for
                c = Case(f"margin-{surface}-{eps:.6f}-{steps}", duration=.1, steps_per_contact=steps, margin=eps / 2, every=.002, contacts=True,
                         contact={"surface": surface})
                c.mesh("box", body)
                c.material("m", density)
                c.pair_all(stiffness=k, restitution=e)
                c.body("box", "m", (0, 0, -low[2] + eps + .02), orientation=q, velocity=(0, 0, -1))
                c.floor()
                return c

            def error(run):
                touched = False
                for n, contacts in enumerate(run.contacts):
                    touches = len(contacts["depth"]) > 0
                    if touched and not touches or (n == len(run.contacts) - 1):
                        break
                    touched = touched or touches or run.v[n, 0, 2] > -1 + 1e-6
                # angular momentum: it stays while the frame may come some time after the contact
                got = world_inertia(body, density, run.q[n, 0]) @ run.w[n, 0]
                exact = world_inertia(body, density, q) @ w1
                return {"error_traj": numpy.linalg.norm(got - exact) / numpy.linalg.norm(exact)}
            study.add(make, error, case="corner", curve=f"{steps} steps a contact" + " (outside)" * (surface == "outside"), margin=share)


def drift(study):
    """Energy error over time: free rotation over the middle axis, and a cube that bounces for ever."""
    for name in INTEGRATORS:
        def spin(name=name):
            c = Case(f"drift-spin-{name}", duration=500.0, step=5e-3, every=2.5, margin=.001, integrator=name)
            c.shape_file("box", exact_box(study.tools))
            c.material("m", 1000.0)
            c.pair_all(stiffness=1.0, restitution=1.0)
            c.body("box", "m", (0, 0, 0), angular_velocity=(.1, 10, 0))
            return c

        def bounce(name=name):
            k, height = 1e4, .0015
            omega = math.sqrt(k * math.sqrt(2.0))
            duration = 1000 * (2 * math.sqrt(2 * height / 9.81) + math.pi / omega)
            c = Case(f"drift-bounce-{name}", duration=duration, step=math.pi / omega / 100, gravity=(0, 0, -9.81), margin=.01, every=duration / 200, integrator=name)
            c.mesh("cube", meshes.box())
            c.material("m", 1.0)
            c.pair_all(stiffness=k, restitution=1.0)
            c.body("cube", "m", (0, 0, .52 + height), orientation=quaternion((0, 0, 1), .3), lock_rotation=True)
            c.floor()
            return c

        def error(run, scale=None):
            energy, time = run.energy(), run.log["time"]
            scale = scale or energy[0]
            error = (energy - energy[0]) / scale
            pick = slice(None, None, max(1, len(time) // 200))
            return {"time": list(time[pick]), "error": list(numpy.abs(error[pick])), "final": error[-1]}
        study.add(spin, error, case="free rotation about the middle axis", curve=name)
        study.add(bounce, lambda run: error(run, 9.81 * .0015), case="elastic bounces", curve=name)


def attraction(study):
    """A ball that leaves a plane which attracts it, worst of 41 phases: by the range at one work of separation, and the step."""
    k, R, mass, e, v, work = 1e4, 1e-3, 1e-3, .5, .5, 1e-6
    density = mass / (4 / 3 * math.pi * R**3)
    contact = math.pi * math.sqrt(mass / k)

    def pull_of(s):   # F s / 2 + F^2 / (2 k) = work
        return .5 * k * (math.sqrt(s * s + 8 * work / k) - s)
    sharp = cf.sticky_rebound(v, e, mass, k, pull_of(1e-7), 1e-7)
    for s in (2e-6, 1e-5, 5e-5, 2e-4):
        for steps in (12, 20, 30, 50, 100, 200, 500, 1000):
            def make(s=s, steps=steps):
                dt = contact / steps
                c = Case(f"attraction-{s:g}-{steps}", duration=2 * contact + 4 * s / v, step=dt, margin=0.0, every=1.0, contact={"impact_speed": v})
                c.sphere("ball", R)
                c.material("m", density)
                c.pair_all(stiffness=k, restitution=e, pull_off=pull_of(s), adhesion_range=s)
                for j in range(41):
                    c.body("ball", "m", (4 * R * j, 0, R + s + v * dt * (1 + (j + .5) / 41)), velocity=(0, 0, -v), lock_rotation=True)
                c.floor()
                return c

            def error(run, s=s):
                left = run.v[-1, :, 2]
                return {"error_e": numpy.abs(left - cf.sticky_rebound(v, e, mass, k, pull_of(s), s)).max() / v, "to_narrow": numpy.abs(left - sharp).max() / v}
            study.add(make, error, case="rebound", curve=f"range {1e6 * s:g} um", steps_per_contact=steps, steps_in_range=s / (v * contact / steps))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    studies = {f.__name__: f for f in (integrators, impact, collision, mesh, margin, drift, attraction)}
    parser.add_argument("study", choices=studies)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    tools = Tools(arguments.bin, arguments.out)
    try:
        study = Study(arguments.study, tools, arguments.repeats)
        studies[arguments.study](study)
        study.measure()
    finally:
        tools.clean()


if __name__ == "__main__":
    main()
