"""X cases about steps, masses, speeds and loads (docs/reference/validation-plan.md, section 2)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, ToolError, quaternion, rotated
from verdicts import finite

CASES = []
_mark = case_of(CASES)
G = cf.GRAVITY


def case(name, title):
    return _mark(name, "X", title)


def simple(name, duration, k=1e4, e=1.0, mu=0.0, density=1000.0, **more):
    """A case with one material, one pair."""
    c = Case(name, duration=duration, **more)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=e, friction=mu)
    return c


@case("X1", "step sweep across the critical step")
def x1(tools, table):
    # An undamped ball that oscillates inside its contact: the true limit of kick-drift-kick is 2/omega.
    k, R = 1e4, .5
    mass = 1.0
    density = mass / (4 / 3 * math.pi * R**3)
    critical = 2 / math.sqrt(k / mass)
    for ratio in (.05, .1, .2, .5, .9, .99, 1.01, 1.5):
        c = simple(f"X1-{ratio}", 400 * critical, k, density=density, step=ratio * critical, gravity=(0, 0, -G), margin=.01, every=400 * critical)
        c.sphere("ball", R)
        c.body("ball", "m", (0, 0, R - .5 * mass * G / k), lock_rotation=True)
        c.floor()
        try:
            run = c.run(tools)
            energy = run.energy()
            scale = .5 * (mass * G) ** 2 / k
            growth = numpy.abs(energy - energy[0]).max() / scale
            if ratio < 1:
                table.figure(f"dt = {ratio} critical", growth, 20 if ratio > .5 else .5, "energy bounded to")
            else:
                table.truth(f"dt = {ratio} critical", False, f"unstable and not noticed, energy grew by {growth:.3g}")
        except ToolError as error:
            table.refusal(f"dt = {ratio} critical", error)
    # what the solver derives: dt = contact time / steps; the single contact's own critical step is (2/pi) contact time
    c = simple("X1-derived", .01, k, density=density, gravity=(0, 0, -G), margin=.01, steps_per_contact=1.0 * math.pi / 2)
    c.sphere("ball", R)
    c.body("ball", "m", (0, 0, R), lock_rotation=True)
    c.floor()
    try:
        run = c.run(tools)
        ratio = run.step / critical
        table.add("critical step that the solver derives over the true one, one contact of a ball", "held" if .99 <= ratio <= 1 else "failed",
                  f"{ratio:.3f} (required 0.99 to 1): pi/2 steps a contact; it assumes four features on a face")
    except ToolError as error:
        table.refusal("critical step derived, one contact of a ball", error)


@case("X2", "many contacts at once share one step")
def x2(tools, table):
    # elastic drops at 12 steps of the derived contact: a step that is too long for any of them gains energy
    tilt = quaternion((1, 1, 0), math.atan(math.sqrt(2)))  # corner down
    shapes = {"corner of a cube (1)": (meshes.box((.2, .2, .2)), tilt), "face of a cube (4)": (meshes.box((.2, .2, .2)), (1, 0, 0, 0)),
              "disc of 25 corners": (meshes.cylinder(.1, .05, 25), (1, 0, 0, 0)), "disc of 289 corners": (meshes.cylinder(.1, .05, 289), (1, 0, 0, 0)),
              "face of a cube, 16 x 16": (meshes.box((.2, .2, .2), 16), (1, 0, 0, 0)),
              "tip of a rod": (meshes.box((.02, .02, .5)), quaternion((0, 1, 0), .6)), "corner of a plate": (meshes.box((.4, .4, .02)), quaternion((1, 1, 0), .5)),
              "icosphere, 1280 triangles": (meshes.icosphere(3, .1), (1, 0, 0, 0))}
    for name, (mesh, q) in shapes.items():
        mass = 1000 * meshes.mass_properties(mesh)[0]
        speed, margin = .5, .002
        k = mass * (speed / margin) ** 2
        c = simple("X2", 30 * margin / speed, k, steps_per_contact=12, margin=margin, every=.5 * margin / speed)
        c.mesh("shape", mesh)
        low = -rotated(numpy.asarray(q), mesh[0])[:, 2].min()
        c.body("shape", "m", (0, 0, low + 0.05 * margin), orientation=q, velocity=(0, 0, -speed))
        c.floor()
        try:
            run = c.run(tools)
            energy = run.energy()
            table.figure(name, numpy.abs(energy / energy[0] - 1).max(), .02, f"{run.log['contacts'].max():.0f} contacts, energy kept to")
        except ToolError as error:
            table.refusal(name, error)


@case("X3", "mass ratio 1e6")
def x3(tools, table):
    side, margin, k = .125, .005, 3e9  # a side that single precision holds exactly: depths go down to 2e-9 m
    for name, lower, upper in (("1e6 kg on 1 kg", 1.0, 1e6), ("1 kg on 1e6 kg", 1e6, 1.0)):
        c = Case("X3", duration=.3, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.05)
        c.mesh("cube", meshes.box((side,) * 3))
        c.material("low", lower / side**3)
        c.material("high", upper / side**3)
        c.pair_all(stiffness=k, restitution=.3, friction=.5)
        d1, d2 = (lower + upper) * G / (k * 4**.25), upper * G / (k * 8**.25)
        c.body("cube", "low", (0, 0, side / 2 - d1))
        c.body("cube", "high", (0, 0, 1.5 * side - d1 - d2))
        c.floor("low")
        try:
            run = c.run(tools, timeout=300)
            z = run.x[-1, :, 2]
            error = max(abs(side / 2 - z[0] - d1) / d1, abs(z[0] + side - z[1] - d2) / d2)
            table.figure(f"{name}: static overlaps", error, 1e-3, "relative error")
            table.figure(f"{name}: jitter at the end [m/s]", numpy.linalg.norm(run.v[-1], axis=1).max(), 1e-6)
            warned = "ratio" in run.text or "steps" in run.text and "mass" in run.text
            period = 2 * math.pi * math.sqrt(1e6 / (k * 1.4))
            table.truth(f"{name}: warns that the light body sets the step", warned, "warned" if warned else
                        f"no warning, though the heavy body's contact lasts {.5 * period / run.step:.0f} steps")
        except ToolError as error:
            table.refusal(name, error)


@case("X4", "size ratio 1e3 and 1e4")
def x4(tools, table):
    times = {}
    for ratio, count in ((1e-3, 10), (1e-3, 32), (1e-4, 10)):
        L = ratio
        mass = 1000 * L**3
        speed, margin = 10 * L, .02 * L
        k = mass * (speed / margin) ** 2
        c = simple("X4", .3, k, e=.5, mu=.3, gravity=(0, 0, -100 * L), margin=margin, steps_per_contact=20, every=.3)
        c.mesh("plate", meshes.box((1, 1, .05)))
        c.mesh("cube", meshes.box())
        c.body("plate", "m", (0, 0, -.025), fixed=True)
        for i in range(count):
            for j in range(count):
                q = quaternion((1 + i % 3, 1 + j % 5, .3), .1 * ((7 * i + 3 * j) % 11))
                c.body("cube", "m", (3 * L * (i - count / 2), 3 * L * (j - count / 2), 1.3 * L), orientation=q, scale=L, velocity=(0, 0, -speed))
        try:
            run = c.run(tools, timeout=600)
            z = run.x[-1, 1:, 2]
            lost = int((z < .4 * L).sum())
            times[ratio, count] = run.wall_seconds / run.steps / count**2
            table.truth(f"{count**2} cubes of {ratio:g} m on a plate of 1 m", lost == 0 and finite(run), f"{lost} went through; {run.wall_seconds / run.steps / count**2 * 1e6:.2g} us a cube and step")
        except ToolError as error:
            table.refusal(f"{count**2} cubes of {ratio:g} m on a plate of 1 m", error)
    if len(times) == 3:
        table.figure("time per cube, 1024 cubes over 100", times[1e-3, 32] / times[1e-3, 10], 2.0)
        table.figure("time per cube, ratio 1e4 over 1e3", times[1e-4, 10] / times[1e-3, 10], 3.0)


@case("X5", "restitution near 0: damping up to five times critical")
def x5(tools, table):
    zetas = [1.0, 2.0, 3.0, 5.0]
    R, k = .5, 1e4
    density = 1 / (4 / 3 * math.pi * R**3)
    c = Case("X5", duration=.1, step=math.pi / math.sqrt(k) / 100, margin=.01, every=.001, contacts=True)
    c.sphere("ball", R)
    c.material("floor", density)
    for i, z in enumerate(zetas):
        c.material(f"m{i}", density)
        c.pair(f"m{i}", "floor", stiffness=k, restitution=cf.restitution(z))
        c.body("ball", f"m{i}", (2 * i, 0, R + .0201), velocity=(0, 0, -1))
    c.pair_all(stiffness=k, restitution=1.0)
    c.floor("floor")
    run = c.run(tools)
    for i, z in enumerate(zetas):
        table.figure(f"zeta = {z:g}: rebound over the impact speed", run.v[-1, i, 2], .14)
    least = min((contacts["normal_force"].min() for contacts in run.contacts if len(contacts["normal_force"])), default=0)
    table.truth("no force pulls", least >= 0, f"least normal force {least:.3g} N")


@case("X6", "restitution 1 over many bounces")
def x6(tools, table):
    k, height = 1e4, .0015
    omega = math.sqrt(k * math.sqrt(2.0))
    bounces = 10000
    duration = bounces * (2 * math.sqrt(2 * height / G) + math.pi / omega)
    c = simple("X6", duration, k, density=1.0, step=math.pi / omega / 100, gravity=(0, 0, -G), margin=.01, every=duration / 200)
    c.mesh("cube", meshes.box())
    c.body("cube", "m", (0, 0, .52 + height), lock_rotation=True)
    c.floor()
    run = c.run(tools)
    relative = (run.energy() - run.energy()[0]) / (G * height)
    slope = numpy.polyfit(run.log["time"], relative, 1)[0] * duration
    table.figure(f"{bounces} bounces of a cube: |slope| T of the energy", abs(slope), 1e-3)
    table.figure("rms of the energy", numpy.std(relative), 1e-3)


@case("X7", "friction 0 and 10")
def x7(tools, table):
    from cases_friction import Incline
    R, k, margin, alpha = .1, 1e6, 1e-5, math.radians(20)
    mass = 1000 * 4 / 3 * math.pi * R**3
    for mu in (0.0, 10.0):
        c = simple("X7", .5, k * 100, e=.5, mu=mu, gravity=(0, 0, -G), margin=margin, steps_per_contact=30, every=.05)
        c.sphere("ball", R)
        s = Incline(c, alpha, (0, 0, 0), 20.0, "m")
        c.body("ball", "m", s.point(-6, R - mass * G * math.cos(alpha) / (100 * k)), orientation=s.q)
        run = c.run(tools)
        v, w = s.along(run.v[:, 0]), s.along(run.w[:, 0])
        if mu == 0:
            table.figure("mu = 0: acceleration against g sin a, relative", abs(v[-1, 0] / (G * math.sin(alpha) * run.times[-1]) - 1), 1e-9)
            table.figure("mu = 0: spin [rad/s]", numpy.abs(w).max(), 1e-12)
        else:
            # friction acts in the middle of the gap; its spring stays stretched by a constant, so the speeds agree
            lever = .5 * (s.along(run.x[-1, 0] - s.place)[2] + R)
            table.figure("mu = 10: slip of a rolling ball over its speed", abs(v[-1, 0] - w[-1, 1] * lever) / v[-1, 0], 1e-6)
            ratio = 1 / 1.4
            late = run.times > .1
            a = numpy.polyfit(run.times[late], v[late, 0], 1)[0]
            table.figure("mu = 10: acceleration against no slip, relative", abs(a / (ratio * G * math.sin(alpha)) - 1), 1e-4)
    # wedge: a cube falls into a steep V and jams
    c = simple("X7-wedge", 2.0, 1e6, e=.3, mu=10.0, gravity=(0, 0, -G), margin=.001, every=.02)
    c.mesh("cube", meshes.box((.1, .1, .1)))
    for side in (-1, 1):
        c.wall({"plane": {"point": [side * .045, 0, 0], "normal": [-side * math.cos(.2), 0, math.sin(.2)]}}, "m")
    c.body("cube", "m", (0, 0, .2), orientation=quaternion((0, 0, 1), .0), velocity=(0, 0, -2))
    try:
        run = c.run(tools)
        energy = run.energy()
        table.figure("wedge, mu = 10: largest rise of the energy over its start", numpy.diff(energy).max() / abs(energy[0] - energy[-1] + 1e-300), 1e-3)
        table.figure("wedge: speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 0]), 1e-6)
    except ToolError as error:
        table.refusal("wedge, mu = 10", error)


@case("X8", "high speed against a thin wall")
def x8(tools, table):
    L, thick, margin = .1, .001, 2e-4
    dt = 2e-5
    mass = 1000 * L**3
    k = mass * 1.0 / (30 * dt / math.pi) ** 2 / 1.5
    for ratio in (.05, .2, 1.0, 5.0, 20.0, 250.0, 600.0):
        speed = ratio * 2 * margin / dt
        # the start is chosen so that a step would end on the far side without any overlap at the fastest
        c = simple("X8", (.3 + .2) / speed, k, e=.5, step=dt, margin=margin, every=(.3 + .2) / speed)
        c.mesh("cube", meshes.box((L, L, L)))
        c.mesh("wall", meshes.box((1, 1, thick)))
        c.body("wall", "m", (0, 0, 0), fixed=True)
        c.body("cube", "m", (0, 0, .3), velocity=(0, 0, -speed), lock_rotation=True)
        name = f"v dt / margin sum = {ratio:g} (v = {speed:.3g} m/s)"
        try:
            run = c.run(tools)
            if run.x[-1, 1, 2] < 0:
                table.add(name, "failed", f"went through unnoticed, z = {run.x[-1, 1, 2]:.3g} m")
            else:
                table.truth(name, finite(run) and run.v[-1, 1, 2] >= -1e-9 * speed, f"bounced, rebound {run.v[-1, 1, 2] / speed:.3f}")
        except ToolError as error:
            table.refusal(name, error)


    # the same by spin: the tip of a rod sweeps into a thin plate that stands in its way
    length = .1
    for ratio in (.05, 1.0, 20.0, 600.0):
        spin = ratio * 2 * margin / dt / (length / 2)
        c = simple("X8-spin", 2.0 / spin, k * length * .004**2 / L**3 / 10, e=.5, step=dt, margin=margin, every=2.0 / spin)
        c.mesh("rod", meshes.box((length, .004, .004)))
        c.mesh("wall", meshes.box((.02, thick, .1)))
        c.body("wall", "m", (.045, 0, 0), fixed=True)
        c.body("rod", "m", (0, 0, 0), orientation=quaternion((0, 0, 1), -.5), angular_velocity=(0, 0, spin))
        name = f"tip of a rod, R w dt / margin sum = {ratio:g} (w = {spin:.3g} rad/s)"
        try:
            run = c.run(tools)
            hit = abs(run.w[-1, 1, 2] / spin - 1) > .1
            table.truth(name, finite(run) and hit, f"struck, spin after over before {run.w[-1, 1, 2] / spin:.3f}" if hit else "went through unnoticed")
        except ToolError as error:
            table.refusal(name, error)


@case("X9", "ring shot along a bolt at 1000 m/s")
def x9(tools, table):
    c = simple("X9", 1e-3, 1e4, step=1e-6, margin=.0005, every=1e-3)
    c.mesh("ring", meshes.tube(.025, .04, .02, 48))
    c.mesh("bolt", meshes.cylinder(.02, 2.0, 48))
    c.body("bolt", "m", (0, 0, 0), fixed=True)
    c.body("ring", "m", (0, 0, .9), velocity=(0, 0, -1000))
    run = c.run(tools)
    table.figure("contacts", run.log["contacts"].max(), 0)
    table.figure("change of velocity [m/s]", numpy.abs(run.v[-1, 1] - [0, 0, -1000]).max(), 0)


@case("X20", "tall stack, and the stack that its stiffness cannot carry")
def x20(tools, table):
    side, margin, mass = .1, .005, 1.0

    def stack(name, count, k, duration):
        c = simple(name, duration, k, e=.3, mu=.5, gravity=(0, 0, -G), margin=margin, steps_per_contact=20, every=duration / 10)
        c.mesh("cube", meshes.box((side,) * 3))
        z = side / 2
        for i in range(count):
            z -= min((count - i) * mass * G / (k * (4 if i == 0 else 8) ** .25), 1.9 * margin)
            c.body("cube", "m", (0, 0, z))
            z += side
        c.floor()
        return c.run(tools, timeout=600)
    run = stack("X20", 50, 2e5, 40.0)
    table.figure("50 cubes, 40 s: largest speed [m/s]", numpy.linalg.norm(run.v[-1], axis=1).max(), 1e-8)
    table.figure("50 cubes: sideways drift over L", numpy.hypot(run.x[-1, :, 0], run.x[-1, :, 1]).max() / side, 1e-6)
    # 20 cubes whose lowest contact would need 0.9 and 1.1 of the margin sum
    for share in (.9, 1.1):
        k = 20 * mass * G / (4**.25 * share * 2 * margin)
        try:
            run = stack("X20-limit", 20, k, 2.0)
            table.truth(f"20 cubes that need {share} of the margins", share < 1 and finite(run), f"stands at {run.max_depth_ratio:.3f} of the margins")
        except ToolError as error:
            table.refusal(f"20 cubes that need {share} of the margins", error)


@case("X21", "dense packing, soft and 1e4 times stiffer")
def x21(tools, table):
    # at rest after 4 s when soft; stiff contacts settle a hundred times faster once the bodies have stopped to tumble
    for factor, duration in ((1, 5.0), (1e4, 3.0)):
        k = 1e4 * factor
        c = simple("X21", duration, k, e=.3, mu=.5, gravity=(0, 0, -G), margin=.003, steps_per_contact=20, every=duration / 30, seed=3)
        c.mesh("octahedron", octahedron(.05))
        n = 4
        for i in range(n):
            for j in range(n):
                for l in range(6):
                    q = quaternion((1 + i, .5 + j, .3 + l), .4 * (i + 2 * j + 3 * l))
                    c.body("octahedron", "m", (.112 * (i - 1.5), .112 * (j - 1.5), .06 + .112 * l), orientation=q)
        c.wall({"box_inside": [[-.225, -.225, 0], [.225, .225, 2]]}, "m")
        try:
            run = c.run(tools, timeout=3600)
            energy = run.energy()
            scale = energy[0] - energy[-1]
            contact = (1000 * 1 / 6 * .1**3 * .5 * G) ** 2 / (2 * k)
            kinetic = run.log["kinetic_translational"][-1] + run.log["kinetic_rotational"][-1]
            table.figure(f"{n * n * 6} octahedra, k = {k:g} N/m: largest rise of the mechanical energy over what was lost", numpy.diff(energy).max() / scale, 1e-4)
            table.add(f"k = {k:g} N/m: kinetic energy at the end over that of a contact", "held" if kinetic / contact < 1e-12 else "failed",
                      f"{kinetic / contact:.2g} (at most 1e-12) after {duration:g} s")
        except ToolError as error:
            table.refusal(f"{n * n * 6} octahedra, k = {k:g} N/m", error)


def concave_heap(tools, table, columns, layers, k, duration):
    """L-shaped bodies of three cubes of 30 mm, dropped from several layers in a box, until nothing moves."""
    side, name = .03, f"{columns**2 * layers} L-shaped bodies, k = {k:g} N/m"
    c = simple(table.case, duration, k, e=.3, mu=.5, gravity=(0, 0, -G), margin=.003, steps_per_contact=20, every=duration / 30, seed=3)
    rim = numpy.array([(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)], dtype=float)
    lids = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [t for i in range(6) for t in ((i, (i + 1) % 6, 6 + (i + 1) % 6), (i, 6 + (i + 1) % 6, 6 + i))]
    faces = sides + [(a, d, b) for a, b, d in lids] + [(6 + a, 6 + b, 6 + d) for a, b, d in lids]
    c.mesh("l", (meshes.rounded(numpy.vstack([rim, rim + (0, 0, 1)]) * side), numpy.array(faces)))
    random = numpy.random.default_rng(1)
    for layer in range(layers):
        for i in range(columns):
            for j in range(columns):
                q = random.normal(size=4)
                c.body("l", "m", (.11 * (i - (columns - 1) / 2), .11 * (j - (columns - 1) / 2), .07 + .11 * layer), orientation=tuple(q / numpy.linalg.norm(q)))
    half = .055 * columns + .01
    c.wall({"box_inside": [[-half, -half, 0], [half, half, 20]]}, "m")
    try:
        run = c.run(tools, timeout=12 * 3600)
        energy = run.energy()
        contact = (1000 * 3 * side**3 * G) ** 2 / (2 * k)
        kinetic = run.log["kinetic_translational"] + run.log["kinetic_rotational"]
        table.figure(f"{name}: largest rise of the mechanical energy over what was lost", numpy.diff(energy).max() / (energy[0] - energy[-1]), 1e-12)
        table.figure(f"{name}: kinetic energy after {duration:g} s over that of a contact", kinetic[-1] / contact, 1e-12)
        moving = run.log["time"][kinetic > 1e-12 * contact]
        print(f"    below 1e-12 of a contact's from {moving[-1]:.2f} s on; {run.steps} steps in {run.wall_seconds:.0f} s", flush=True)
    except ToolError as error:
        table.refusal(name, error)


@case("X29", "heap of 512 concave bodies comes to true rest")
def x29(tools, table):
    concave_heap(tools, table, 8, 8, 1e4, 9.0)  # at rest after 7.1 s


@case("X30", "heap of 64 concave bodies of 1e4 times the stiffness comes to true rest")
def x30(tools, table):
    concave_heap(tools, table, 4, 4, 1e8, 3.0)


@case("X31", "heap of 512 concave bodies of 1e4 times the stiffness comes to true rest")
def x31(tools, table):
    concave_heap(tools, table, 8, 8, 1e8, 4.0)


def octahedron(radius):
    v = numpy.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]) * radius
    t = numpy.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
    return meshes.rounded(v), t


@case("X22", "very fast spin")
def x22(tools, table):
    from cases_rotation import INERTIA, conserved, free_box
    for angle in (.01, .1, .5, 1.0):
        step = 1e-4
        w = numpy.array([.3, 1.0, .2])
        w *= angle / step / numpy.linalg.norm(w)
        try:
            run = free_box(tools, "X22", w, 2000 * step, step, 100 * step)
            energy, momentum = conserved(run)
            table.figure(f"free box, w dt = {angle}: |dL|/L", numpy.linalg.norm(momentum - momentum[0], axis=1).max() / numpy.linalg.norm(momentum[0]), 1e-13)
            table.figure(f"free box, w dt = {angle}: energy offset", numpy.abs(energy / energy[0] - 1).max(), .5 * angle**2)
        except ToolError as error:
            table.refusal(f"free box, w dt = {angle}", error)
    # rod of 0.1 m at 1e5 rad/s (tips at 5 km/s), 1 mm above a plane, tilts down slowly onto it
    c = simple("X22-rod", 2e-3, 1e5, e=.5, gravity=(0, 0, 0), margin=.001, every=2e-4)
    c.mesh("rod", meshes.box((.1, .004, .004)))
    c.body("rod", "m", (0, 0, .004), angular_velocity=(0, 0, 1e5), velocity=(0, 0, -2))
    c.floor()
    try:
        run = c.run(tools)
        table.truth("rod at 1e5 rad/s grazes a plane", finite(run) and run.x[-1, 0, 2] > 0, f"left with v_z = {run.v[-1, 0, 2]:.3g} m/s, w dt = {1e5 * run.step:.3g}")
        table.figure("rod: w dt that the derived step allows", 1e5 * run.step, .1)
    except ToolError as error:
        table.refusal("rod at 1e5 rad/s grazes a plane", error)


@case("X27", "gravity of 1000 g and of 0, a step that is too large")
def x27(tools, table):
    for name, g, k, step in (("1000 g on a contact made for 1 g", 9810, 1e4, None), ("0 g", 0, 1e4, None), ("step ten times too large", 9.81, 1e4, .05)):
        c = simple("X27", .5, k, e=.5, mu=.3, gravity=(0, 0, -g), margin=.005, step=step, every=.1)
        c.mesh("cube", meshes.box((.1, .1, .1)))
        c.body("cube", "m", (0, 0, .0605), velocity=(0, 0, 0))
        c.floor()
        try:
            run = c.run(tools)
            table.truth(name, finite(run) and g == 0, f"ran; speed at the end {numpy.linalg.norm(run.v[-1, 0]):.3g} m/s, overlap at most {run.max_depth_ratio:.3g} of the margins")
        except ToolError as error:
            table.refusal(name, error)


@case("X28", "no body, one body, a million bodies without contact")
def x28(tools, table):
    c = simple("X28-0", .1, step=.01)
    c.sphere("ball", .1)
    c.floor()
    try:
        run = c.run(tools)
        table.truth("0 bodies", run.record["outcome"] == "completed", "completed")
    except ToolError as error:
        table.refusal("0 bodies", error)
    c = simple("X28-1", .1, step=.01)
    c.sphere("ball", .1)
    c.body("ball", "m", (0, 0, 0), velocity=(1, 0, 0))
    c.tables["contact"]["margin"] = .001
    run = c.run(tools)
    table.figure("1 body: |x - v t| [m]", abs(run.x[-1, 0, 0] - .1), 1e-15)
    cost = {}
    for count in (10**5, 10**6):
        side = (count / 10**5) ** (1 / 3) * 10.0
        c = simple("X28-n", 2e-3, step=1e-4, gravity=(0, 0, -G), margin=.001, every=2e-3, seed=2)
        c.sphere("ball", .05)
        c.population(shape="ball", material="m", count=count, region={"box": [[0, 0, 0], [side] * 3]})
        try:
            run = c.run(tools, timeout=600)
            inner = sum(v for key, v in run.record["phases"].items() if key != "output")
            cost[count] = inner / run.steps / count
            table.truth(f"{count} balls, {run.steps} steps", finite(run) and run.log["contacts"].max() == 0, f"{cost[count] * 1e9:.0f} ns a body and step, {run.record['peak_rss_bytes'] / count:.0f} bytes a body at the peak")
        except ToolError as error:
            table.refusal(f"{count} balls", error)
    if len(cost) == 2:
        table.figure("time per body, a million over a hundred thousand", cost[10**6] / cost[10**5], 2.0)
