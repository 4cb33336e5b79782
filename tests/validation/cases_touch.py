"""T: where touch begins, at the surfaces as drawn (docs/develop/decisions/022)."""
import math

import numpy

import meshes
from registry import case_of
from scene import Case, quaternion

CASES = []
case = case_of(CASES)

G = 9.81


@case("T1", "U", "balls fall through tubes with a clearance of half a per cent", "free fall")
def t1(tools, report):
    radius, clearance, sides, length = .01, 5e-5, 96, .3
    # sides of a polygon whose inscribed circle has the clearance
    inner = (radius + clearance) / math.cos(math.pi / sides)
    c = Case("T1", duration=.2, step=1e-4, gravity=(0, 0, -G), every=.01, contact={"margin_ratio": .075})
    c.material("m", 2500.0)
    c.pair_all(stiffness=1e5, restitution=.5, friction=.5)
    c.sphere("ball", radius)
    c.mesh("icosphere", meshes.icosphere(4, radius))
    for i, shape in enumerate(("ball", "icosphere")):
        c.mesh_wall(meshes.tube(inner, 1.5 * inner, length, sides), "m", position=(5 * radius * i, 0, 0))
        c.body(shape, "m", (5 * radius * i, 0, .1), orientation=quaternion((1, 2, 3), .4))
    run = report.run(c.run(tools))
    report.at_most("contacts", run.log["contacts"].max(), 0)
    for i, name in enumerate(("analytic ball", "icosphere of level 4, margin 7.5 % of its radius")):
        report.at_most(f"{name}: off a free fall, over its way", abs(run.x[-1, i, 2] - .1 + .5 * G * .04) / (.5 * G * .04), 1e-12)


@case("T2", "U", "a block let go .01 mm above a floor lies down", "energy of its fall")
def t2(tools, report):
    side, gap, k = .0625, 1e-5, 1e5   # sides that single precision holds
    c = Case("T2", duration=.25, gravity=(0, 0, -G), every=5e-4, contacts=True)
    c.mesh("block", meshes.box((side, side, side)))
    c.material("m", 2500.0)
    c.pair_all(stiffness=k, restitution=.5, friction=.5)
    c.body("block", "m", (0, 0, side / 2 + gap))
    c.floor()
    run = report.run(c.run(tools))
    depth = 2500 * side**3 * G / (k * 4**.25)
    report.at_most("highest place above where it was let go [m]", run.x[:, 0, 2].max() - (side / 2 + gap), 0)
    report.check("height at rest [m]", run.x[-1, 0, 2], side / 2 - depth, 1e-6 * depth, "absolute")
    report.at_most("speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 0]), 1e-9)


@case("T3", "U", "cubes of two sizes lie on each other: heights, margins and places of contacts", "m g / (k n^(1/4))")
def t3(tools, report):
    side, ratio, k, density, scale = .03125, .06, 1e6, 2500.0, 3.0
    c = Case("T3", duration=.4, gravity=(0, 0, -G), every=.1, contacts=True, contact={"margin_ratio": ratio})
    c.mesh("cube", meshes.box((side, side, side)))
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=.2, friction=.5)
    light, heavy = density * side**3, density * (scale * side)**3
    lower, upper = (light + heavy) * G / (k * 4**.25), light * G / (k * 4**.25)
    c.body("cube", "m", (0, 0, scale * side / 2 - lower), scale=scale)
    c.body("cube", "m", (0, 0, (scale + .5) * side - lower - upper), orientation=quaternion((0, 0, 1), .3))
    c.floor()
    run = report.run(c.run(tools))
    report.check("the large one sinks by [m]", scale * side / 2 - run.x[-1, 0, 2], lower, 1e-6)
    report.check("the small one on it by [m]", run.x[-1, 0, 2] + (scale + 1) * side / 2 - run.x[-1, 1, 2], upper, 1e-6)
    contacts = run.contacts[-1]
    radius = side * (3 / (4 * math.pi))**(1 / 3)
    both = (contacts["body_a"] < 2) & (contacts["body_b"] < 2)
    report.check("margins of the two, of cubes [m]", contacts["margin"][both].max(), ratio * radius * (1 + scale), 1e-12)
    report.check("room at the floor, two margins [m]", contacts["margin"][~both].max(), 2 * ratio * radius * scale, 1e-12)
    # where the drawn faces overlap
    report.check("height of contacts with the floor [m]", contacts["point"][~both][:, 2].mean(), -lower / 2, 1e-3 * lower, "absolute")
    report.check("height of contacts of the two [m]", contacts["point"][both][:, 2].mean(), run.x[-1, 0, 2] + scale * side / 2 - upper / 2, 1e-3 * upper, "absolute")


@case("T4", "U", "a small body is pinched under one ten times as large", "it holds")
def t4(tools, report):
    small, scale, density = .01, 10.0, 2500.0
    c = Case("T4", duration=.4, steps_per_contact=20, gravity=(0, 0, -G), every=.1)
    c.mesh("rock", meshes.rock(3, 2))
    size = numpy.ptp(meshes.rock(3, 2)[0], axis=0).max()
    c.material("m", density)
    c.pair_all(stiffness=2e6, restitution=.3, friction=.5)
    c.body("rock", "m", (0, 0, .55 * small), scale=small / size)
    c.body("rock", "m", (0, 0, (1.2 + .5 * scale) * small), scale=scale * small / size, lock_rotation=True)
    c.floor()
    run = report.run(c.run(tools))
    report.at_most("overlap over the margins, margins derived", run.max_depth_ratio, .97)
    report.at_least("the small one is loaded: largest overlap over the margins", run.max_depth_ratio, .01)


@case("T5", "U", "stiffness by size: k = modulus 2 R_a R_b / (R_a + R_b) of balls, walls and cubes", "v / w sin(w t), m g / (k n^(1/4))")
def t5(tools, report):
    small, modulus, density, speed = .01, 2e6, 2500.0, .1
    pairs = ((1.0, 1.0), (1.0, 4.0), (4.0, 4.0), (1.0, None), (4.0, None))   # radii over the small one's; None: a wall

    def spring(a, b):
        return modulus * small * (2 * a if b is None else 2 * a * b / (a + b))

    def mass(a):
        return density * 4 / 3 * math.pi * (a * small)**3

    def rate(a, b):
        return math.sqrt(spring(a, b) * (1 / mass(a) + (0 if b is None else 1 / mass(b))))
    longest = math.pi / rate(4.0, 4.0)
    c = Case("T5", duration=1.25 * longest, steps_per_contact=2000, gravity=(0, 0, 0), every=longest / 40)
    c.sphere("ball", small)
    c.material("m", density)
    c.pair_all(modulus=modulus, restitution=1.0)
    c.floor()
    for i, (a, b) in enumerate(pairs):
        x, height = .3 * i, a * small if b is None else .2
        c.body("ball", "m", (x, 0, height), scale=a, velocity=(0, 0, -speed if b is None else speed))
        if b is not None:
            c.body("ball", "m", (x, 0, height + (a + b) * small), scale=b)
    run = report.run(c.run(tools))
    first = 0
    for a, b in pairs:
        w = rate(a, b)
        times = run.times[(run.times > 0) & (run.times < .98 * math.pi / w)]
        pressed = [a * small - run.x[k, first, 2] if b is None else (a + b) * small - (run.x[k, first + 1, 2] - run.x[k, first, 2])
                   for k in range(len(run.times)) if 0 < run.times[k] < .98 * math.pi / w]
        name = f"R {a:g} on " + ("a wall" if b is None else f"{b:g}")
        report.at_most(f"{name}: overlap off v / w sin(w t), over v / w", abs(numpy.array(pressed) - speed / w * numpy.sin(w * times)).max() * w / speed, 3e-6)
        first += 1 if b is None else 2
    report.check("step: that of a small ball's contact [s]", run.step, math.pi * math.sqrt(mass(1) / (2 * modulus * small)) / 2000, 1e-3)

    side, scales = .03125, (1.0, 3.0)
    c = Case("T5-cubes", duration=.4, gravity=(0, 0, -G), every=.1, contact={"margin_ratio": .06})
    c.mesh("cube", meshes.box((side, side, side)))
    c.material("m", density)
    c.pair_all(modulus=5 * modulus, restitution=.2, friction=.5)
    c.floor()
    depths = [density * (s * side)**3 * G / (5 * modulus * 2 * s * side * (3 / (4 * math.pi))**(1 / 3) * 4**.25) for s in scales]
    for i, (s, depth) in enumerate(zip(scales, depths)):
        c.body("cube", "m", (.2 * i, 0, s * side / 2 - depth), scale=s)
    run = report.run(c.run(tools))
    for i, (s, depth) in enumerate(zip(scales, depths)):
        report.check(f"a cube of scale {s:g} sinks by [m]", s * side / 2 - run.x[-1, i, 2], depth, 1e-6)
