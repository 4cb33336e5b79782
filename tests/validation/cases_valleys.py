"""V: bodies in valleys: at concave edges of walls and bodies (docs/reference/contact-law.md section 3.7)."""
import math

import numpy

import meshes
from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)
G = 9.81


def valley(angle, half, width):
    """Two faces along x that meet in the line y = z = 0; their normals are `angle` degrees apart."""
    top = half * math.tan(math.radians(angle) / 2)
    vertices = [(s * width / 2, y, z) for s in (-1, 1) for y, z in ((-half, top), (0, 0), (half, top))]
    return meshes.rounded(numpy.array(vertices)), numpy.array([(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)])


def pit(count, slope, half):
    """Faces of a slope [degrees] that go down to the origin."""
    angles = 2 * math.pi * (numpy.arange(count) + .31) / count
    top = half * math.cos(math.pi / count) * math.tan(math.radians(slope))
    ring = numpy.column_stack([half * numpy.cos(angles), half * numpy.sin(angles), numpy.full(count, top)])
    return meshes.rounded(numpy.vstack([[[0, 0, 0]], ring])), numpy.array([(0, 1 + i, 1 + (i + 1) % count) for i in range(count)])


def octahedron(radius):
    v = radius * numpy.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    t = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return meshes.rounded(v), numpy.array(t)


def rest_of(run, body):
    """Largest speed over the last fifth of a run [m/s], and how fast the body has moved over it [m/s]."""
    last = run.times >= .8 * run.times[-1]
    speed = numpy.linalg.norm(run.v[last, body], axis=1).max()
    way = numpy.linalg.norm(run.x[last, body][-1] - run.x[last, body][0])
    return speed, way / (run.times[last][-1] - run.times[last][0])


def check_rest(report, run, body, what):
    speed, creep = rest_of(run, body)
    report.at_most(f"{what}: speed at rest [m/s]", speed, 1e-10)
    report.at_most(f"{what}: creep [m/s]", creep, 1e-10)


def face_loads(run, bodies):
    """Normal force by the axis that it is nearest to, of contacts of some bodies in the last frame: 3 numbers [N] a body."""
    contacts = run.contacts[-1]
    loads = numpy.zeros((bodies, 3))
    for i in range(len(contacts["normal_force"])):
        body = int(min(contacts["body_a"][i], contacts["body_b"][i]))
        force = abs(contacts["normal_force"][i]) * numpy.abs(contacts["normal"][i])
        loads[body, numpy.argmax(force)] += force.max()
    return loads


@case("V1", "U", "a cube at the edge and in the corner of a mesh box rests as between planes", "equilibrium")
def v1(tools, report):
    side, k, gravity = .02, 1e4, numpy.array([4, 1, -8.])  # y: 28 % of what friction can hold along the edge
    for steps in (12, 30, 120):
        for wall in ("mesh", "planes"):
            if wall == "planes" and steps != 30:
                continue
            c = Case(f"V1-{wall}-{steps}", duration=.6, steps_per_contact=steps, gravity=gravity, every=.01, contacts=True,
                     contact={"margin_ratio": .05})
            c.mesh("cube", meshes.box((side,) * 3))
            c.material("m", 2700.0)
            c.pair_all(stiffness=k, restitution=.3, friction=.3)
            c.body("cube", "m", (.0395, 0, .0102))
            c.body("cube", "m", (.0395, .0395, .0102))
            corners = [[-.05, -.05, 0], [.05, .05, .1]]
            c.wall({"box": {"corners": corners, "open": ["+z"]}} if wall == "mesh" else {"box_inside": corners}, "m")
            run = report.run(c.run(tools))
            for body, where in enumerate(("edge", "corner")):
                check_rest(report, run, body, f"{steps} steps a contact, {where} of {wall}")
    # Without friction the loads are those of equilibrium: the components of the weight. Weights of minima differ from 1 by 3 t^2 with
    # t = (difference of the overlaps) / (2 margins): at 10 kN/m the loads are off by 4e-6, at 100 kN/m by a hundredth of it.
    for wall in ("mesh", "planes"):
        for where, g, y in (("edge", gravity * (1, 0, 1), 0), ("corner", gravity, .0395)):
            c = Case(f"V1-loads-{wall}-{where}", duration=.6, gravity=g, every=.01, contacts=True, contact={"margin_ratio": .05})
            c.tables["time"]["duration"] = .3
            c.mesh("cube", meshes.box((side,) * 3))
            c.material("m", 2700.0)
            c.pair_all(stiffness=10 * k, restitution=.3, friction=0)
            c.body("cube", "m", (.0395, y, .0102))
            corners = [[-.05, -.05, 0], [.05, .05, .1]]
            c.wall({"box": {"corners": corners, "open": ["+z"]}} if wall == "mesh" else {"box_inside": corners}, "m")
            run = report.run(c.run(tools))
            loads = 2700 * side**3 * numpy.abs(g)
            error = numpy.abs(face_loads(run, 1)[0] - loads).max() / numpy.linalg.norm(loads)
            report.at_most(f"{where} of {wall}: error of the loads of the faces over the weight", error, 1e-6)
    c = Case("V1-sleep", duration=.6, gravity=gravity, every=.01, time={"sleep": True}, contact={"margin_ratio": .05})
    c.mesh("cube", meshes.box((side,) * 3))
    c.material("m", 2700.0)
    c.pair_all(stiffness=k, restitution=.3, friction=.3)
    c.body("cube", "m", (.0395, 0, .0102))
    c.wall({"box": {"corners": [[-.05, -.05, 0], [.05, .05, .1]], "open": ["+z"]}}, "m")
    run = report.run(c.run(tools))
    report.check("cubes asleep at the end", run.log["asleep"][-1], 1, 0, "absolute")


@case("V2", "U", "a tip in a groove rests, at 28 % of what friction holds along the groove", "equilibrium")
def v2(tools, report):
    radius, k = .01, 1e4
    slope = .28 * .5
    for steps in (12, 30, 120):
        c = Case(f"V2-{steps}", duration=.6, steps_per_contact=steps, gravity=G * numpy.array([slope, 0, -1]) / math.hypot(1, slope),
                 every=.01, contact={"margin_ratio": .05})
        c.mesh("tip", octahedron(radius))
        c.material("m", 2700.0)
        c.pair_all(stiffness=k, restitution=.3, friction=.5)
        angles = (30, 60, 89, 90, 120)
        for i, angle in enumerate(angles):
            c.mesh_wall(valley(angle, 3 * radius, 10 * radius), "m", position=(0, 8 * i * radius, 0))
            # the steepest one holds the tip by the vertices beside it
            height = radius * max(1, math.tan(math.radians(angle) / 2)) + 1e-4
            c.body("tip", "m", (1e-5, 8 * i * radius + 2e-5, height), lock_rotation=True)
        run = report.run(c.run(tools))
        for i, angle in enumerate(angles):
            check_rest(report, run, i, f"{steps} steps a contact, faces {angle} degrees apart")


@case("V3", "U", "an octahedron in a pit of three faces and a cube in a notch of a body rest", "equilibrium")
def v3(tools, report):
    radius, k, side = .01, 1e4, .02
    for steps in (12, 30, 120):
        c = Case(f"V3-{steps}", duration=.6, steps_per_contact=steps, gravity=(0, 0, -G), every=.01, contact={"margin_ratio": .05})
        c.mesh("tip", octahedron(radius))
        c.mesh("cube", meshes.box((side,) * 3))
        # a block with a notch of a right angle, its bottom line along z of the prism
        notch = meshes.prism([(-.04, -.03), (.04, -.03), (.04, .03), (0, -.01), (-.04, .03)], .06)
        c.mesh("notched", meshes.centred(notch))
        bottom = -.01 - meshes.mass_properties(notch)[1][1]
        c.material("m", 2700.0)
        c.pair_all(stiffness=k, restitution=.3, friction=.3)
        slopes = (12, 18, 40)
        for i, slope in enumerate(slopes):
            c.mesh_wall(pit(3, slope, 5 * radius), "m", position=(12 * i * radius, 0, 0))
            c.body("tip", "m", (12 * i * radius + 2e-5, 3e-5, radius + 5e-5), lock_rotation=True)
        s = math.sqrt(.5)
        c.body("notched", "m", (0, 1, 0), orientation=(s, s, 0, 0), fixed=True)
        c.body("cube", "m", (0, 1, bottom + side * s + 1e-4), orientation=(math.cos(math.pi / 8), 0, math.sin(math.pi / 8), 0))
        run = report.run(c.run(tools))
        for i, slope in enumerate(slopes):
            check_rest(report, run, i, f"{steps} steps a contact, pit of slope {slope} degrees")
        check_rest(report, run, len(slopes) + 1, f"{steps} steps a contact, cube in a notch")


@case("V4", "U", "a ball that rolls over a concave edge keeps its energy, the better the shorter the step", "energy")
def v4(tools, report):
    radius, k, speed = .02, 1e5, .1
    mass = 2700 * 4 / 3 * math.pi * radius**3
    at_rest, kinetic = .5 * (mass * G)**2 / k, .5 * mass * speed**2
    # shallow edges: over the elastic energy at rest, of which a potential that jumps made 12 to 19 %; steep ones throw the ball: over the
    # kinetic energy
    for name, angles, scale, limits in (("shallow", (.1, .2, .5, 1, 2), at_rest, (1e-3, 1e-4)), ("steep", (5, 10, 30), kinetic, (3e-3, 3e-4))):
        errors = []
        for steps, limit in zip((60, 240), limits):
            c = Case(f"V4-{name}-{steps}", duration=.12, steps_per_contact=steps, gravity=(0, 0, -G), every=.01, contact={"margin": 0})
            c.sphere("ball", radius)
            c.material("m", 2700.0)
            c.pair_all(stiffness=k, restitution=1.0, friction=0.0)
            for i, angle in enumerate(angles):
                half = math.radians(angle) / 2
                c.mesh_wall(valley(angle, .1, .2), "m", position=(.5 * i, 0, 0))
                depth = mass * G * math.cos(half) / k
                y = -.004 - radius * math.tan(half)  # on the left face, at rest on it, towards the edge
                off = radius - depth
                c.body("ball", "m", (.5 * i, y * math.cos(half) + off * math.sin(half), -y * math.sin(half) + off * math.cos(half)),
                       velocity=(0, speed * math.cos(half), -speed * math.sin(half)))
            run = report.run(c.run(tools))
            energy = run.energy()
            errors.append(numpy.abs(energy - energy[0]).max() / scale)
            report.at_most(f"{name} edges, {steps} steps a contact: change of the energy", errors[-1], limit)
        report.at_least(f"{name} edges: change at 60 over that at 240 steps a contact", errors[0] / errors[1], 4)


@case("V5", "U", "a ball lies in a tessellated tube as in the tube", "depth of one contact")
def v5(tools, report):
    tube, k = .05, 1e5
    for count in (16, 128, 512):
        for ratio in (.1, .5, .9):
            radius = ratio * tube
            mass = 2700 * 4 / 3 * math.pi * radius**3
            stiffness = mass * G / (.01 * radius)  # presses by a hundredth of the radius
            c = Case(f"V5-{count}-{ratio}", duration=.25, gravity=(0, 0, -G), every=.025, contact={"margin": 0})
            c.sphere("ball", radius)
            c.material("m", 2700.0)
            c.pair_all(stiffness=stiffness, restitution=.2, friction=0.0)
            # one facet or one edge at the bottom
            for i, turn in enumerate((.5, 0.)):
                angles = -math.pi / 2 + 2 * math.pi * (numpy.arange(count) + turn) / count
                outer = tube / math.cos(math.pi / count)
                ring = outer * numpy.column_stack([numpy.cos(angles), numpy.sin(angles)])
                v = [(s * tube, y, z) for s in (-1, 1) for y, z in ring]
                t = []
                for j in range(count):
                    n = (j + 1) % count
                    t += [(j, n, count + n), (j, count + n, count + j)]
                c.mesh_wall((meshes.rounded(numpy.array(v)), numpy.array(t)), "m", position=(4 * tube * i, 0, 0))
                c.body("ball", "m", (4 * tube * i, 0, -(tube - radius + .01 * radius)))
            run = report.run(c.run(tools))
            for i, place in enumerate(("facet", "edge")):
                depth = -run.x[-5:, i, 2].mean() - (tube - radius)
                ball = f"{count} segments, ball of {ratio} of the tube, above the {place}: depth over that in the tube"
                if count == 512:
                    report.check(ball, depth / (.01 * radius), 1, .02, "absolute")
                elif place == "facet" and ratio < .9:  # alone on its facet; beside that facets are coarser than R/200
                    report.check(ball, depth / (.01 * radius), 1, 1e-3, "absolute")


@case("V6", "U", "tips and balls that bounce in grooves keep their energy under other laws: Hertz, attraction, a barrier", "energy")
def v6(tools, report):
    radius, drop = .01, 4e-4
    mass = 2700 * 4 / 3 * radius**3   # of the octahedron
    for name, words, pair in (("Hertz", {"law": "hertz-mindlin"}, {}), ("attraction", {}, {"stiffness": 1e5, "pull_off": 3 * mass * G, "adhesion_range": 1e-4}),
                              ("barrier", {"contact": {"barrier": 1.0}}, {"stiffness": 1e4})):
        errors = []
        for steps in (120, 480):
            c = Case(f"V6-{name}-{steps}", duration=.06, steps_per_contact=steps, gravity=(0, 0, -G), every=.01,
                     **{"contact": {"margin_ratio": .05, **words.get("contact", {})}, **{k: v for k, v in words.items() if k != "contact"}})
            c.mesh("tip", octahedron(radius))
            c.material("m", 2700.0, young=1e7, poisson=.3)
            c.pair_all(restitution=1.0, friction=0.0, **pair)
            for i, angle in enumerate((30, 89, 120)):
                c.mesh_wall(valley(angle, 3 * radius, 10 * radius), "m", position=(0, 8 * i * radius, 0))
                height = radius * max(1, math.tan(math.radians(angle) / 2)) + drop
                c.body("tip", "m", (1e-5, 8 * i * radius + 2e-5, height), orientation=(math.cos(.05), math.sin(.05), 0, 0))
            run = report.run(c.run(tools))
            energy = run.energy()
            errors.append(numpy.abs(energy - energy[0]).max() / (3 * mass * G * drop))
        report.at_most(f"{name}: change of the energy over that of the falls, 480 steps a contact", errors[1], 1e-3)
        report.at_least(f"{name}: the same at 120 over that at 480 steps a contact", errors[0] / errors[1], 4)


@case("V7", "U", "rolling resistance and wear of both faces of an edge", "constant moments of both contacts; Archard on both faces")
def v7(tools, report):
    # the normals of a right-angled groove are at 45 degrees to the weight: two contacts of m g / sqrt(2); (2/5) m R^2 w' = -mu_r R sqrt(2) m g
    radius, k, mu_r, w0 = .1, 1e6, .02, 10.0
    mass = 1000 * 4 / 3 * math.pi * radius**3
    depth = mass * G / math.sqrt(2) / k
    c = Case("V7-spin", duration=1.0, steps_per_contact=30, gravity=(0, 0, -G), contact={"margin": 0}, every=.02)
    c.sphere("ball", radius)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.5, friction=0.0, rolling_friction=mu_r, rolling_model="constant", contact_radius=radius)
    c.mesh_wall(valley(90, 3 * radius, 10 * radius), "m")
    c.body("ball", "m", (0, 0, math.sqrt(2) * (radius - depth)), angular_velocity=(w0, 0, 0))
    run = report.run(c.run(tools))
    late = (run.times > .1) & (run.w[:, 0, 0] > 1)
    rate = -numpy.polyfit(run.times[late], run.w[late, 0, 0], 1)[0]
    report.check("a ball that spins in a groove: w' [rad/s^2]", rate, 2.5 * math.sqrt(2) * mu_r * G / radius, 5e-3)
    # a cube slides along the edge of a mesh box, pressed onto floor and wall
    side, mu, way, coefficient, gravity = .1, .2, .5, 5e-8, numpy.array([4., 0, -8.])
    mass, push = 1.0, 12.0
    c = Case("V7-wear", duration=1.1 * math.sqrt(2 * way / (mu * push)), steps_per_contact=30, every=.1, gravity=gravity, contact={"margin_ratio": .02})
    c.mesh("cube", meshes.box((side,) * 3))
    c.material("m", mass / side**3)
    c.pair_all(stiffness=1e6, restitution=.1, friction=mu)
    c.body("cube", "m", (.25 - side / 2 + 1e-6, -.3, side / 2 - 2e-6), velocity=(0, math.sqrt(2 * mu * push * way), 0))
    box = {"box": {"corners": [[-.25, -.5, 0], [.25, .5, .3]], "open": ["+z"]}}
    c.wall(box, "m", wear={"coefficient": coefficient, "every": 5.0})
    run = report.run(c.run(tools))
    report.check("slid along the edge [m]", run.x[-1, 0, 1] - run.x[0, 0, 1], way, 1e-2)
    work = run.loads[-1]["sliding_work"].sum()
    report.check("work of sliding on both faces [J]", work, mu * mass * push * way, 1e-2)
    impulse = numpy.abs(run.loads[-1]["impulse"].sum(axis=0))
    report.check("impulse on the wall over that on the floor", impulse[0] / impulse[2], 4 / 8, 1e-3)
