"""T: where touch begins, at the surfaces as drawn (docs/decisions/022)."""
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
