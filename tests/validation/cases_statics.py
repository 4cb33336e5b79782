"""S: bodies at rest, rocking, toppling (VALIDATION 1.6)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)
G = cf.GRAVITY


@case("S1", "U", "box dropped with a tilt comes to true rest")
def s1(tools, report):
    k, margin, mass, side = 1e4, .01, 1.0, .2
    d = mass * G / (k * 4**.25)
    q = quaternion((1, .3, 0), math.radians(2))
    for steps in (8, 15, 30, 60):
        c = Case(f"S1-{steps}", duration=12.0, steps_per_contact=steps, gravity=(0, 0, -G), margin=margin, every=.5)
        for n in (1, 5):
            c.mesh(f"cube{n}", meshes.box((side,) * 3, n))
        c.material("floor")
        names = []
        for i, zeta in enumerate((.05, .3)):
            c.material(f"m{i}", mass / side**3)
            c.pair(f"m{i}", "floor", stiffness=k, restitution=cf.restitution(zeta), friction=.5)
            for n in (1, 5):
                c.body(f"cube{n}", f"m{i}", (2 * i, 2 * n, side / 2 + 2 * margin + .05), orientation=q)
                names.append(f"zeta = {zeta}, {n} x {n}")
        c.pair_all(stiffness=k, restitution=1.0)
        c.floor("floor")
        run = report.run(c.run(tools))
        for b, name in enumerate(names):
            inertia = mass * side**2 / 6
            kinetic = .5 * mass * (run.v[-1, b] ** 2).sum() + .5 * inertia * (run.w[-1, b] ** 2).sum()
            report.at_most(f"{steps} steps a contact, {name}: kinetic energy at rest [J]", kinetic, 1e-20)
            report.check(f"{steps} steps a contact, {name}: height [m]", run.x[-1, b, 2], side / 2 + 2 * margin - d, 1e-3 * d, "absolute")


@case("S2", "N", "stacks of 5, 10, 20, 50 cubes stand for 60 s")
def s2(tools, report):
    k, margin, side, mass = 1e5, .005, .1, 1.0
    c = Case("S2", duration=60.0, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=6.0)
    c.mesh("cube", meshes.box((side,) * 3))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.3, friction=.5)
    heights, first = [], {}
    for s, count in enumerate((5, 10, 20, 50)):
        z = side / 2
        first[count] = len(c.bodies)
        for i in range(count):
            z += 2 * margin - (count - i) * mass * G / (k * (4 if i == 0 else 8) ** .25)
            c.body("cube", "m", (1.0 * s, 0, z))
            heights.append(z)
            z += side
    c.floor()
    run = report.run(c.run(tools))
    for count, b in first.items():
        speed = numpy.linalg.norm(run.v[-1, b:b + count], axis=1).max()
        lateral = numpy.hypot(run.x[-1, b:b + count, 0] - run.x[0, b:b + count, 0], run.x[-1, b:b + count, 1]).max()
        report.at_most(f"{count} cubes: largest speed after 60 s [m/s]", speed, 1e-8)
        report.at_most(f"{count} cubes: lateral drift over L", lateral / side, 1e-6)
        worst = 0.0
        z = side / 2
        for i in range(count):
            depth = 2 * margin - (run.x[-1, b + i, 2] - (run.x[-1, b + i - 1, 2] + side if i else side / 2))
            load = depth * k * (4 if i == 0 else 8) ** .25
            worst = max(worst, abs(load / ((count - i) * mass * G) - 1))
        report.at_most(f"{count} cubes: error of the loads, from the depths", worst, 1e-3)


@case("S4", "N", "rocking block", "Housner 1963")
def s4(tools, report):
    b, h, k, margin = .1, .3, 1e8, 2e-4
    alpha, R = math.atan2(b, h), math.hypot(b, h)
    p = math.sqrt(3 * G / (4 * R))
    fractions = [.1, .3, .5, .9]
    c = Case("S4", duration=.7, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.001)
    c.mesh("block", meshes.box((2 * b, .2, 2 * h)))
    mass = 1000 * 2 * b * .2 * 2 * h
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.02, friction=5.0)
    rest = 2 * margin - mass * G / (k * 2**.25)
    for i, f in enumerate(fractions):
        q = quaternion((0, 1, 0), f * alpha)
        low = -rotated(q, c.solids["block"][0])[:, 2].min()
        c.body("block", "m", (0, i, low + rest), orientation=q)
    c.floor()
    run = report.run(c.run(tools))
    for i, f in enumerate(fractions):
        axis = rotated(run.q[:, i], numpy.array([0, 0, 1.0]))
        theta = numpy.arctan2(axis[:, 0], axis[:, 2])
        rate = run.w[:, i, 1]
        down = int(numpy.nonzero(theta < 0)[0][0]) if (theta < 0).any() else len(theta) - 1
        quarter = run.times[down - 1] + (run.times[down] - run.times[down - 1]) * theta[down - 1] / (theta[down - 1] - theta[down])
        expected, speed = cf.housner_quarter(alpha, p, f)
        report.check(f"theta0 = {f} alpha: quarter period [s]", quarter, expected, .02)
        before = numpy.abs(rate[:down + 5]).max()
        if f == .5:
            report.check(f"theta0 = {f} alpha: speed at the impact [rad/s]", before, 1.336809, .02)
        if f >= .3:
            after = numpy.abs(rate[(run.times > quarter + .01) & (run.times < quarter + .02)]).mean()
            # carried on by 0.015 s of deceleration p^2 sin(alpha)
            after += p * p * math.sin(alpha) * .015
            report.check(f"theta0 = {f} alpha: w after over w before the impact", after / before, 1 - 1.5 * math.sin(alpha) ** 2, .02)


@case("S6", "N", "row of dominoes: steady wave, speed scales with sqrt(g l)")
def s6(tools, report):
    speeds = {}
    for name, scale, start in (("base", 1.0, 1.0), ("pushed harder", 1.0, 2.0), ("four times larger", 4.0, 1.0)):
        height, thickness, width, gap = .048 * scale, .0075 * scale, .024 * scale, .016 * scale
        # mass and weight grow with scale^3: the same share of the margin is used up when k grows with scale^2
        margin, k = 2e-4 * scale, 1e5 * scale**2
        count = 20
        c = Case(f"S6-{scale:g}-{start:g}", duration=.8 * math.sqrt(scale), steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.004 * math.sqrt(scale))
        c.mesh("domino", meshes.box((thickness, width, height)))
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.5, friction=.2)
        mass = 1000 * thickness * width * height
        w = 4 * start / math.sqrt(scale)  # of the first one, about its lower edge
        push = {"angular_velocity": (0, w, 0), "velocity": (w * height / 2, 0, w * thickness / 2)}
        for i in range(count):
            c.body("domino", "m", (i * (thickness + gap), 0, height / 2 + 2 * margin - mass * G / (k * 4**.25)),
                   **(push if i == 0 else {}))
        c.floor()
        run = report.run(c.run(tools))
        lean = numpy.arccos(numpy.clip(rotated(run.q, numpy.array([0, 0, 1.0]))[..., 2], -1, 1))
        started = []
        for i in range(count):
            moving = numpy.nonzero(lean[:, i] > .05)[0]
            started.append(run.times[moving[0]] if len(moving) else float("nan"))
        started = numpy.array(started)
        steps = numpy.diff(started)
        speeds[name] = (thickness + gap) / steps[8:18].mean() / math.sqrt(G * height)
        report.check(f"{name}: all fall", float(numpy.isfinite(started).sum()), count, 0, "absolute")
        report.at_most(f"{name}: scatter of the wave speed, dominoes 9 to 18", steps[8:18].std() / steps[8:18].mean(), .1)
    report.check("speed over sqrt(g l): start twice as fast", speeds["pushed harder"], speeds["base"], .03)
    report.check("speed over sqrt(g l): four times larger", speeds["four times larger"], speeds["base"], .01)
    print(f"    speed over sqrt(g l): {speeds['base']:.3f} at d/l = {16 / 48:.2f}")


@case("S9", "N", "pyramid of three cylinders stands above tan 15 degrees")
def s9(tools, report):
    R, k, margin, sides = .1, 1e6, 2e-4, 512
    limit = math.tan(math.radians(15))
    mesh = meshes.cylinder(R, .1, sides)
    mass = 1000 * meshes.mass_properties(mesh)[0]
    lie = quaternion((1, 0, 0), math.pi / 2)
    for name, mu, duration in (("slips", .9 * limit, .6), ("stands", 1.1 * limit, 3.0)):
        c = Case(f"S9-{name}", duration=duration, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.1)
        c.mesh("cylinder", mesh)
        c.material("floor")
        c.material("m", 1000.0)
        c.pair("m", "m", stiffness=k, restitution=.3, friction=mu)
        c.pair_all(stiffness=k, restitution=.3, friction=.5)
        apart = 2 * R + 2 * margin
        z = R + 2 * margin - 1.5 * mass * G / (k * 2**.25)
        for x, height in ((-apart / 2, z), (apart / 2, z), (0, z + apart * math.sqrt(.75) - .3 * margin)):
            c.body("cylinder", "m", (x, 0, height), orientation=lie)
        c.floor("floor")
        run = report.run(c.run(tools))
        sunk = run.x[0, 2, 2] - run.x[-1, 2, 2]
        if name == "slips":
            report.at_least("mu = 0.9 tan 15: the top has fallen in 0.6 s by [m]", sunk, .1 * R)
        else:
            report.at_most("mu = 1.1 tan 15: the top sinks by [m]", abs(sunk), 4 * margin)
            report.at_most("mu = 1.1 tan 15: speed after 3 s [m/s]", numpy.linalg.norm(run.v[-1], axis=1).max(), 1e-6)
