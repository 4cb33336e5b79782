"""N: non-convex bodies and interlock (validation plan 1.7)."""
import math

import numpy

import closed_forms as cf
import meshes
from cases_rotation import product
from registry import case_of
from scene import Case, ToolError, quaternion

CASES = []
case = case_of(CASES)
G = cf.GRAVITY


@case("N1", "U", "U-shaped particle hangs on a fixed bar")
def n1(tools, report):
    k, margin = 1e5, .001
    mesh = meshes.centred(meshes.prism(meshes.u_outline(.06, .08, .015), .03))
    mass = 1000 * meshes.mass_properties(mesh)[0]
    c = Case("N1", duration=10.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=1.0, contacts=True)
    c.mesh("hook", mesh)
    c.mesh("bar", meshes.box((.02, .3, .01)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.3, friction=.4)
    c.body("bar", "m", (0, 0, 0), fixed=True)
    # opening downwards (y of the outline to -z): its inner face rests on the bar's upper face
    q = quaternion((1, 0, 0), -math.pi / 2)
    inner = mesh[0][:, 1].min() + .015
    # turned by -90 degrees about x, y of the outline points to -z: the web lies on top, its inner face at z = -inner
    c.body("hook", "m", (0, 0, .005 + inner - .0002), orientation=q)
    run = report.run(c.run(tools))
    last = run.contacts[-1]
    hook = last["body_a"] == 1
    side = numpy.where(hook, 1, -1)
    total = ((last["normal_force"][:, None] * last["normal"] + last["tangential_force"]) * side[:, None]).sum(axis=0)
    report.check("sum of the contact forces over m g", total[2] / (mass * G), 1.0, 1e-6)
    report.at_most("speed after 10 s [m/s]", numpy.linalg.norm(run.v[-1, 1]), 1e-9)
    count = len(last["depth"])
    spread = numpy.ptp(last["depth"]) / last["depth"].mean()
    report.at_most("spread of the overlaps", spread, 1e-6)
    report.check(f"overlap is m g / (k n^(1/4)), n = {count} contacts [m]", last["depth"].mean(), mass * G / (k * count**.25), 1e-3)


@case("N3", "U", "ring falls along a bolt: clearance is clearance")
def n3(tools, report):
    margin, bolt = .0005, .02
    ring = meshes.tube(.025, .04, .02, 48)
    tight = meshes.tube(bolt + .0007, .04, .02, 48)
    c = Case("N3", duration=.4, step=1e-4, gravity=(0, 0, -G), margin=margin, every=.02)
    c.mesh("ring", ring)
    c.mesh("bolt", meshes.cylinder(bolt, 2.0, 48))
    c.material("m", 1000.0)
    c.pair_all(stiffness=1e4, restitution=.5, friction=0.0)
    c.body("bolt", "m", (0, 0, 0), fixed=True)
    c.body("ring", "m", (0, 0, .8))
    run = report.run(c.run(tools))
    report.at_most("contacts with a clearance above the margins", run.log["contacts"].max(), 0)
    fall = run.x[:, 1, 2] - run.x[0, 1, 2] + .5 * G * run.times**2
    report.at_most("free fall: |z + g t^2 / 2| [m]", numpy.abs(fall).max(), 1e-12)
    # a clearance of less than the margins, without weight: touch begins at the surfaces as drawn, so it goes along freely
    c = Case("N3-tight", duration=.2, steps_per_contact=30, margin=margin, every=.02)
    c.mesh("ring", tight)
    c.mesh("bolt", meshes.cylinder(bolt, 2.0, 48))
    c.material("m", 1000.0)
    c.pair_all(stiffness=1e4, restitution=.5, friction=0.0)
    c.body("bolt", "m", (0, 0, 0), fixed=True)
    c.body("ring", "m", (0, 0, .3), velocity=(0, 0, -1.0))
    run = report.run(c.run(tools))
    report.at_most("contacts with a clearance below the margins", run.log["contacts"].max(), 0)
    report.at_most("sideways motion over the clearance", numpy.hypot(run.x[-1, 1, 0], run.x[-1, 1, 1]) / .0007, 1e-3)
    report.at_most("change of the axial speed", abs(run.v[-1, 1, 2] + 1.0), 1e-6)


@case("N4", "N", "nested bowls do not pass through each other")
def n4(tools, report):
    def bowl(radius, thickness, sides):
        outer = [(0, -radius)] + [(radius * math.sin(a), -radius * math.cos(a)) for a in numpy.linspace(.2, math.pi / 2, 8)]
        r = radius - thickness
        inner = [(r * math.sin(a), -r * math.cos(a)) for a in numpy.linspace(math.pi / 2, .2, 8)] + [(0, -r)]
        return meshes.centred(meshes.lathe(outer + inner, sides))
    mesh = bowl(.1, .02, 24)
    k, margin, count = 1e6, .002, 5
    c = Case("N4", duration=6.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.5)
    c.mesh("bowl", mesh)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.4, friction=.3)
    for i in range(count):
        c.body("bowl", "m", (.003 * i, .002 * (-1) ** i, .08 * i), orientation=quaternion((1, .5, 0), .03 * i), fixed=i == 0)
    run = report.run(c.run(tools))
    report.at_least("steps", run.steps, 1e5)
    z = run.x[-1, :, 2]
    report.check("bowls in their order", float((numpy.diff(z) > 0).sum()), count - 1, 0, "absolute")
    # a bowl of outer radius .1 rests, a gap of both margins away, on the inner edge, radius .08, of the one below
    report.check("distance of the two lowest [m]", z[1] - z[0], math.sqrt((.1)**2 - .08**2), .0015, "absolute", "24 sides flatten the circles by 1 %")
    report.at_most("largest overlap over the margins", run.max_depth_ratio, 1.0)


@case("N5", "N", "two staples pulled apart: the force follows the pull, up to what the contact can carry")
def n5(tools, report):
    margin, k, density, pull = .001, 1e5, 1000.0, 100.0
    mesh = meshes.centred(meshes.prism(meshes.u_outline(.06, .08, .015), .015))
    mass = density * meshes.mass_properties(mesh)[0]
    inner = mesh[0][:, 1].min() + .015  # the inner face of the web, from the centre of mass
    upright = quaternion((1, 0, 0), math.pi / 2)  # arms up: y of the outline to z
    hooked = product(quaternion((0, 0, 1), math.pi / 2), quaternion((1, 0, 0), -math.pi / 2))  # arms down, a quarter turn away

    def pulled(name, gravity, k, duration):
        c = Case(name, duration=duration, steps_per_contact=30, gravity=gravity, margin=margin, every=duration / 10, contacts=True)
        c.mesh("staple", mesh)
        c.material("m", density)
        c.pair_all(stiffness=k, restitution=.2, friction=.4)
        c.body("staple", "m", (0, 0, 0), orientation=upright, fixed=True)
        depth = mass * numpy.linalg.norm(gravity) / (k * 4**.25)
        c.body("staple", "m", (0, 0, 2 * inner - min(depth, 1.9 * margin)), orientation=hooked)
        return c.run(tools)
    # the pull leans by less than the webs' half width over the lever of the weight, and less than the friction angle
    for name, lean in (("straight", (0, 0)), ("leaning", (.08, .05))):
        direction = numpy.array([*lean, -1.0]) / math.sqrt(1 + lean[0]**2 + lean[1]**2)
        run = report.run(pulled(f"N5-{name}", pull * direction, k, 2.0))
        last = run.contacts[-1]
        side = numpy.where(last["body_a"] == 1, 1, -1)
        force = ((last["normal_force"][:, None] * last["normal"] + last["tangential_force"]) * side[:, None]).sum(axis=0)
        report.at_most(f"{name}: error of the force over the pull", numpy.linalg.norm(force + mass * pull * direction) / (mass * pull), 1e-6)
        report.at_most(f"{name}: speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 1]), 1e-9)
        report.check(f"{name}: contacts, the edges of two webs crossing", len(last["depth"]), 4, 0, "absolute")
    # the limit: a depth of 0.97 of both margins, where the solver must stop by name before the staples pass through each other
    for share in (.9, 1.1):
        soft = mass * pull / (4**.25 * share * 2 * margin)
        try:
            run = pulled(f"N5-{share}", numpy.array([0, 0, -pull]), soft, 1.0)
            report.check(f"pull that needs {share} of the margins: overlap over the margins", run.max_depth_ratio, share, .01, "absolute")
        except ToolError as error:
            report.check(f"pull that needs {share} of the margins: refused by name (exit code)", error.code if "too soft" in error.text else -1, 5 if share > 1 else 0, 0, "absolute")


@case("N7", "U", "thin plate between boxes from both sides")
def n7(tools, report):
    k, margin = 1e6, .0005
    c = Case("N7", duration=2.0, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.5, contacts=True)
    c.mesh("box", meshes.box((.1, .1, .1)))
    c.mesh("plate", meshes.box((.3, .3, .002)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.2, friction=.5)
    plate = 1000 * .3 * .3 * .002
    c.body("box", "m", (0, 0, 0), fixed=True)
    gap = -.00005
    c.body("plate", "m", (0, 0, .05 + gap + .001))
    c.body("box", "m", (0, 0, .05 + 2 * gap + .002 + .05))
    run = report.run(c.run(tools))
    last = run.contacts[-1]

    def force_on(body, other):
        total = 0.0
        for side, a, b in ((1, body, other), (-1, other, body)):
            mine = (last["body_a"] == a) & (last["body_b"] == b)
            total += side * (last["normal_force"][mine] * last["normal"][mine][:, 2] + last["tangential_force"][mine][:, 2]).sum()
        return total
    report.check("force of the plate on the box above over its weight", force_on(2, 1) / (1.0 * G), 1.0, 1e-6)
    report.check("force of the box below over both weights", force_on(1, 0) / ((1 + plate) * G), 1.0, 1e-6)
    report.at_most("speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 1:], axis=1).max(), 1e-8)
    report.at_most("the plate moved sideways by [m]", numpy.hypot(*run.x[-1, 1, :2]), 1e-6)
