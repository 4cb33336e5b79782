"""S: bodies at rest, rocking, toppling (validation plan 1.6)."""
import math

import numpy

import closed_forms as cf
import meshes
from cases_masonry import Arch
from cases_rotation import product
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
                c.body(f"cube{n}", f"m{i}", (2 * i, 2 * n, side / 2 + .05), orientation=q)
                names.append(f"zeta = {zeta}, {n} x {n}")
        c.pair_all(stiffness=k, restitution=1.0)
        c.floor("floor")
        run = report.run(c.run(tools))
        for b, name in enumerate(names):
            inertia = mass * side**2 / 6
            kinetic = .5 * mass * (run.v[-1, b] ** 2).sum() + .5 * inertia * (run.w[-1, b] ** 2).sum()
            report.at_most(f"{steps} steps a contact, {name}: kinetic energy at rest [J]", kinetic, 1e-20)
            report.check(f"{steps} steps a contact, {name}: height [m]", run.x[-1, b, 2], side / 2 - d, 1e-3 * d, "absolute")


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
            z -= (count - i) * mass * G / (k * (4 if i == 0 else 8) ** .25)
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
            depth = -(run.x[-1, b + i, 2] - (run.x[-1, b + i - 1, 2] + side if i else side / 2))
            load = depth * k * (4 if i == 0 else 8) ** .25
            worst = max(worst, abs(load / ((count - i) * mass * G) - 1))
        report.at_most(f"{count} cubes: error of the loads, from the overlaps", worst, 1e-3)
    # twenty that fall onto each other by a tenth of a millimetre each: to true rest, with less energy at every look
    c = Case("S2-dropped", duration=20.0, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.5)
    c.mesh("cube", meshes.box((side,) * 3))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.3, friction=.5)
    for i in range(20):
        c.body("cube", "m", (0, 0, side / 2 + 1e-4 + i * (side + 1e-4)))
    c.floor()
    run = report.run(c.run(tools))
    energy, kinetic = run.energy(), run.log["kinetic_translational"] + run.log["kinetic_rotational"]
    report.at_most("20 cubes dropped: largest rise of the mechanical energy over what was lost", numpy.diff(energy).max() / (energy[0] - energy[-1]), 1e-12)
    report.at_most("20 cubes dropped: kinetic energy at the end over that of a contact", kinetic[-1] / ((mass * G) ** 2 / (2 * k)), 1e-12)


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
    rest = -mass * G / (k * 2**.25)
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


LIE = quaternion((1, 0, 0), math.pi / 2)  # an outline (x, y) of a prism comes to stand upright: y to z


def upright(angle):
    """Turned from the vertical towards +x by the angle."""
    return quaternion((0, 1, 0), angle)


@case("S5", "N", "block set in rotation about its lower edge: comes back or topples", "energy: w^2 = 3 g (1 - cos a) / (2 R)")
def s5(tools, report):
    b, h, k, margin = .1, .3, 1e8, 2e-4
    alpha, R = math.atan2(b, h), math.hypot(b, h)
    critical = math.sqrt(1.5 * G * (1 - math.cos(alpha)) / R)
    c = Case("S5", duration=2.5, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.02)
    c.mesh("block", meshes.box((2 * b, .2, 2 * h)))
    mass = 1000 * 2 * b * .2 * 2 * h
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.02, friction=5.0)
    shares = (.98, 1.02)
    for i, share in enumerate(shares):
        w = share * critical  # about the edge at +x: the centre goes up and over
        c.body("block", "m", (0, i, h - mass * G / (k * 4**.25)), velocity=(w * h, 0, w * b), angular_velocity=(0, w, 0))
    c.floor()
    run = report.run(c.run(tools))
    lean = numpy.arccos(numpy.clip(rotated(run.q, numpy.array([0, 0, 1.0]))[..., 2], -1, 1))
    report.at_most("0.98 of the critical spin: largest lean over alpha", lean[:, 0].max() / alpha, 1.0)
    report.check("0.98: largest lean over alpha, from the energy", lean[:, 0].max() / alpha,
                 (alpha - math.acos(math.cos(alpha) + shares[0]**2 * (1 - math.cos(alpha)))) / alpha, .02, "absolute")
    report.at_least("1.02 of the critical spin: lean at the end [degrees]", math.degrees(lean[-1, 1]), 80)


@case("S7", "N", "stack that hangs over the edge by the harmonic series", "Hall 2005: block i over the one below by L / (2 i)")
def s7(tools, report):
    length, height, count, k, margin = .2, .05, 4, 1e8, 1e-4
    mass = 1000 * length * .1 * height
    for name, share in (("stands", .98), ("falls", 1.02)):
        c = Case(f"S7-{name}", duration=2.0, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.1)
        c.mesh("block", meshes.box((length, .1, height)))
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.2, friction=.6)
        # the table is the lowest block, fixed; from the bottom up block `level` carries level - 1 others and hangs over by L/(2 level)
        c.body("block", "m", (0, 0, -height / 2), fixed=True)
        x, z = 0.0, 0.0
        for level in range(count, 0, -1):
            x += share * length / (2 * level)
            z -= level * mass * G / (k * 8**.25)
            c.body("block", "m", (x, 0, z + height / 2))
            z += height
        run = report.run(c.run(tools))
        sunk = (run.x[0] - run.x[-1])[1:, 2].max()
        if share < 1:
            report.at_most(f"{share} of the limit: any block sinks by, over its height", sunk / height, .01)
            report.at_most(f"{share} of the limit: speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 1:], axis=1).max(), 1e-6)
        else:
            report.at_least(f"{share} of the limit: a block sinks by, over its height", sunk / height, 1.0)
    report.check("overhang of the top block over L at the limit", sum(1 / (2 * i) for i in range(1, count + 1)), 25 / 24, 1e-12)


@case("S8", "N", "ladder between floor and wall slides below tan a = (1 - mu^2) / (2 mu)", "statics, both contacts at their limit")
def s8(tools, report):
    length, thickness, k, margin, mu = 1.0, .01, 1e7, 1e-4, .4
    limit = cf.ladder_angle(length - 2 * margin, thickness - 2 * margin, margin, mu)  # corners are rounded by the margin
    report.check("limit without thickness, closed form [degrees]", math.degrees(cf.ladder_angle(length, 0.0, 0.0, mu)),
                 math.degrees(math.atan((1 - mu * mu) / (2 * mu))), 1e-9)
    c = Case("S8", duration=1.0, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.1)
    c.mesh("ladder", meshes.box((thickness, .1, length)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.1, friction=mu)
    offsets = (-.5, .5)
    for i, offset in enumerate(offsets):
        q = upright(math.pi / 2 - limit - math.radians(offset))
        corners = rotated(q, meshes.box((thickness - 2 * margin, .1, length - 2 * margin))[0])
        c.body("ladder", "m", (-corners[:, 0].max() - 0.99 * margin, i, -corners[:, 2].min() + 0.99 * margin), orientation=q)
    c.floor()
    c.wall({"plane": {"point": [0, 0, 0], "normal": [-1, 0, 0]}}, "m")
    run = report.run(c.run(tools))
    sunk = run.x[0, :, 2] - run.x[-1, :, 2]
    degrees = [math.degrees(limit) + offset for offset in offsets]
    report.at_least(f"{degrees[0]:.2f} degrees: sinks by, over its length", sunk[0] / length, .02)
    report.at_most(f"{degrees[1]:.2f} degrees: sinks by, over its length", sunk[1] / length, 1e-3)
    report.at_most(f"{degrees[1]:.2f} degrees: speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 1]), 1e-6)


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
            c.body("domino", "m", (i * (thickness + gap), 0, height / 2 - mass * G / (k * 4**.25)),
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


@case("S9", "N", "pyramid of three cylinders, arch of five stones, house of cards: stand by friction", "statics; Heyman 1966, static theorem")
def s9(tools, report):
    pyramid(tools, report)
    arch(tools, report)
    card_house(tools, report)


def pyramid(tools, report):
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
        apart = 2 * R
        z = R - 1.5 * mass * G / (k * 2**.25)
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


def arch(tools, report):
    """Half a circle of five stones on a plane. Loads at the corners of the joints, the least friction by linear programming."""
    mean, depth, k, margin = .5, .2, 1e8, 2e-4
    of_one = Arch(5, .4)   # the arch over its mean radius
    inner, radius = mean * (1 - of_one.thickness / 2), mean * of_one.radius
    stone = meshes.prism([(mean * x, mean * y) for x, y in of_one.outline], depth)
    blocks, contacts = of_one.model()
    least = cf.least_friction(blocks, contacts)
    report.check("arch, least friction by linear programming against that of its mirror image", cf.least_friction(
        [(-x, z, w) for x, z, w in blocks], [(a, b, (-p[0], p[1]), (-n[0], n[1])) for a, b, p, n in contacts]), least, 1e-6)
    for share in (.9, 1.15):
        gap = -0.1 * margin  # thrusts are some hundred newton: depths of some micrometres, 1 % of the margins
        c = Case(f"S9-arch-{share}", duration=1.5, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.1)
        c.mesh("stone", meshes.centred(stone))
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.1, friction=share * least)
        for a in of_one.middles:
            # pushed outward and up, so that the gap is the same in every joint
            r = radius + gap / (2 * math.sin(of_one.half))
            c.body("stone", "m", (r * math.cos(a), 0, r * math.sin(a) + gap / 2), orientation=product(upright(math.pi / 2 - a), LIE))
        c.floor()
        run = report.run(c.run(tools))
        sunk = (run.x[0] - run.x[-1])[:, 2].max()
        if share < 1:
            report.at_least(f"arch, mu = {share} of the least, {least:.4f}: a stone has fallen in 1.5 s by, over the rise", sunk / inner, .1)
        else:
            report.at_most(f"arch, mu = {share} of the least: a stone sinks by, over the rise", sunk / inner, .005)
            report.at_most(f"arch, mu = {share} of the least: speed after 1.5 s [m/s]", numpy.linalg.norm(run.v[-1], axis=1).max(), 1e-6)


def card_house(tools, report):
    """One card leans against the face of another: two bodies, three lines of contact, so every load is known."""
    length, thick, k, margin = .1, .002, 1e6, 1e-5
    a, b = math.radians(20), math.radians(15)
    first, second = numpy.array([math.sin(a), math.cos(a)]), numpy.array([-math.sin(b), math.cos(b)])  # upwards along the cards
    side, face = numpy.array([math.cos(a), -math.sin(a)]), numpy.array([math.cos(b), math.sin(b)])  # to their right
    # corners are rounded: balls of the margin about those of a card that is two margins smaller
    long, flat = length - 2 * margin, thick - 2 * margin
    foot = -long / 2 * first + flat / 2 * side
    one = numpy.array([0, margin]) - foot
    top = one + long / 2 * first + flat / 2 * side  # this corner lies against the left face of the second card
    height = margin + long / 2 * math.cos(b) + flat / 2 * math.sin(b)
    wall = top + margin * face
    along = (wall[1] - height + thick / 2 * math.sin(b)) / math.cos(b)
    two = wall + thick / 2 * face - along * second
    contacts = [(None, 0, one + foot - [0, margin], (0, 1)), (None, 1, two - long / 2 * second - flat / 2 * face - [0, margin], (0, 1)),
                (0, 1, top + margin * face, face)]
    weights = [.06, .1]  # as the depths along y, which differ so that the cards' edges are not flush
    least = cf.least_friction([(*one, weights[0]), (*two, weights[1])], contacts)
    for share in (.95, 1.05):
        c = Case(f"S9-cards-{share}", duration=.5, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.05)
        c.mesh("one", meshes.box((thick, weights[0], length)))
        c.mesh("two", meshes.box((thick, weights[1], length)))
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.1, friction=share * least)
        c.body("one", "m", (one[0], 0, one[1]), orientation=upright(a))
        c.body("two", "m", (two[0], 0, two[1]), orientation=upright(-b))
        c.floor()
        run = report.run(c.run(tools))
        sunk = (run.x[0] - run.x[-1])[:, 2].max()
        if share < 1:
            report.at_least(f"cards, mu = {share} of the least, {least:.4f}: a card has sunk in 0.5 s by, over its length", sunk / length, .05)
        else:
            report.at_most(f"cards, mu = {share} of the least: a card sinks by, over its length", sunk / length, .01)
            report.at_most(f"cards, mu = {share} of the least: speed after 0.5 s [m/s]", numpy.linalg.norm(run.v[-1], axis=1).max(), 1e-6)
