"""I: impacts of bodies off centre against rigid-body impulses (validation plan 1.3)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)
UP = numpy.array([0.0, 0, 1])


def matrix(q):
    return numpy.stack([rotated(numpy.asarray(q), e) for e in numpy.eye(3)], axis=1)


def world_inertia(mesh, density, q):
    R = matrix(q)
    return density * R @ meshes.mass_properties(mesh)[2] @ R.T


def lowest_vertex(mesh, q):
    v = rotated(numpy.asarray(q), mesh[0])
    return v[v[:, 2].argmin()]


def after_first_contact(run, body):
    """Velocities of a body in the first frame after its first contact has ended."""
    touched = False
    for n, contacts in enumerate(run.contacts):
        touches = bool(((contacts["body_a"] == body) | (contacts["body_b"] == body)).any())
        if touched and not touches:
            return run.v[n, body], run.w[n, body]
        touched = touched or touches
    raise AssertionError(f"body {body} {'never left' if touched else 'never touched'}")


@case("I1", "U", "cylinder on its end rim, 0 to 90 degrees", "Kodam et al. 2010; Park 2003")
def i1(tools, report):
    diameter, length, density, speed, e = 8e-3, 5e-3, 1200.0, 1.0, 0.85
    mass = density * math.pi * diameter**2 / 4 * length
    duration = 1e-3 * length / speed  # t_c |v| / L <= 1e-3
    k = mass * (math.pi / duration) ** 2
    margin = 1.2 * speed * duration / math.pi
    angles = list(range(0, 95, 5)) + [math.degrees(math.atan(length / diameter))]
    c = Case("I1", duration=1.6 * duration, steps_per_contact=400, margin=margin, every=duration / 20, contacts=True)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=e)
    expected, row = [], []
    for i, sides in enumerate((32, 128)):
        mesh = meshes.cylinder(diameter / 2, length, sides)
        c.mesh(f"cylinder{sides}", mesh)
        for j, theta in enumerate(angles):
            # the axis leans from z towards x by 90 - theta; a vertex of the rim lies in that plane
            q = quaternion((0, 1, 0), math.radians(90 - theta))
            low = lowest_vertex(mesh, q)
            c.body(f"cylinder{sides}", "m", (0.02 * j, 0.02 * i, -low[2] + 0.001 * margin), orientation=q, velocity=(0, 0, -speed))
            if theta in (0, 90):
                low = numpy.array([0, 0, low[2]])  # lands flat: the load passes through the centre
            inertia = world_inertia(mesh, density, q)
            m = density * meshes.mass_properties(mesh)[0]
            expected.append(cf.impulse(m, inertia, low, UP, numpy.array([0, 0, -speed]), numpy.zeros(3), e))
            row.append((sides, theta))
    c.floor("m")
    run = c.run(tools)
    worst, facet = {32: [0, 0, 0], 128: [0, 0, 0]}, {32: 0.0, 128: 0.0}
    table = []
    for b, (sides, theta) in enumerate(row):
        v, w = after_first_contact(run, b)
        smooth_v, smooth_w = cf.kodam(math.radians(theta)) if theta not in (0, 90) else (e, 0.0)
        worst[sides][0] = max(worst[sides][0], abs(v[2] - expected[b][0][2]) / speed)
        worst[sides][1] = max(worst[sides][1], numpy.abs(w - expected[b][1]).max() / 372.86)
        facet[sides] = max(facet[sides], abs(expected[b][0][2] - smooth_v), abs(abs(expected[b][1][1]) - abs(smooth_w)) / 372.86)
        table.append((sides, theta, v[2], w[1], smooth_v, smooth_w))
        if sides == 32 and theta in (20, 60):
            I = world_inertia(c.solids["cylinder32"], density, c.bodies[b]["orientation"])
            m = density * meshes.mass_properties(c.solids["cylinder32"])[0]
            ratio = (m * v @ v + w @ I @ w) / (m * speed**2)
            exact = expected[b]
            report.check(f"KE'/KE at {theta} degrees, 32-gon", ratio, (m * exact[0] @ exact[0] + exact[1] @ I @ exact[1]) / (m * speed**2), 2e-3)
            report.check(f"KE'/KE at {theta} degrees against the smooth cylinder", ratio, {20: .760413, 60: .846333}[theta], 2e-3)
    report.run(run, error_traj=max(max(w[:2]) for w in worst.values()))
    for sides in (32, 128):
        report.at_most(f"{sides}-gon, by its own inertia: v_z' over V, worst of {len(angles)} angles", worst[sides][0], 2e-3)
        report.at_most(f"{sides}-gon, by its own inertia: w' over its largest, worst of {len(angles)} angles", worst[sides][1], 2e-3)
    report.at_most("facet error of the 128-gon against the smooth cylinder", facet[128], 1e-2, f"32-gon: {facet[32]:.2g}")
    for sides, theta, v, w, smooth_v, smooth_w in table:
        if sides == 128 and theta in (5, 10, 20, 30, 40, 45, 60, 70, 80, 85):
            report.check(f"theta = {theta}: v_z' [m/s], 128-gon against the published smooth cylinder", v, smooth_v, 5e-3, "absolute")
            report.check(f"theta = {theta}: w' [rad/s], 128-gon against the published smooth cylinder", w, smooth_w, 5e-3 * 372.86, "absolute")


@case("I2", "U", "slender rod on its end, 5 to 85 degrees: frictionless and in gross slip", "rigid-body impulse; rod m_eff = m/(1 + 3 cos^2 a)")
def i2(tools, report):
    length, width, density, speed = .2, .001, 1000.0, 1.0
    mesh = meshes.box((length, width, width))
    mass = density * meshes.mass_properties(mesh)[0]
    angles = list(range(5, 90, 10))
    # The damping is made for the mobility along the normal; friction changes it, and with it the ratio of normal speeds, so slip
    # is held against the formula without damping.
    for mu, slip, e in ((0.0, 0.0, .7), (.1, 50.0, 1.0)):
        duration = 2e-4 * length / max(speed, .1 * slip)
        k = mass * (math.pi / duration) ** 2
        margin = 1.2 * speed * duration / math.pi
        c = Case(f"I2-{'slip' if mu else 'free'}", duration=1.8 * duration, steps_per_contact=300, margin=margin, every=duration / 25, contacts=True)
        c.mesh("rod", mesh)
        c.material("m", density)
        c.pair_all(stiffness=k, restitution=e, friction=mu)
        exact = []
        for i, degrees in enumerate(angles):
            q = quaternion((0, 1, 0), math.radians(degrees))
            low = lowest_vertex(mesh, q) * [1, 0, 1]  # both corners of the end carry the same
            c.body("rod", "m", (0, 1.0 * i, -low[2] + 0.001 * margin), orientation=q, velocity=(slip, 0, -speed))
            exact.append(cf.impulse(mass, world_inertia(mesh, density, q), low, UP, numpy.array([slip, 0, -speed]), numpy.zeros(3), e, mu,
                                    numpy.array([1.0, 0, 0]) if mu else None))
        c.floor("m")
        run = c.run(tools)
        results = [after_first_contact(run, i) for i in range(len(angles))]
        worst = max(max(numpy.abs(v - v1)[[0, 2]].max() / speed, numpy.linalg.norm(w - w1) * length / 2 / speed) for (v, w), (v1, w1) in zip(results, exact))
        report.run(run, error_traj=worst)
        report.at_most(f"{'gross slip' if mu else 'no friction'}: v' and w' L/2 over V, worst of {len(angles)} angles", worst, 2e-3)
        if not mu:
            for degrees, (v, w) in zip(angles, results):
                thin = 1 / (1 + 3 * math.cos(math.radians(degrees)) ** 2)
                report.check(f"{degrees} degrees: v_z' [m/s] against the rod without thickness", v[2], -speed + (1 + e) * speed * thin, 1e-2, "absolute", "width L/200")


@case("I3", "U", "box on its corner: error falls with the stiffness", "rigid-body impulse")
def i3(tools, report):
    q = quaternion((.6, .5, .3), .9)
    stiffness = [1e4, 1e5, 1e6, 1e7]
    size, density = (1, .8, .6), 1 / .48
    mesh = meshes.box(size)
    margin = 0.01
    low = lowest_vertex(meshes.box([side - 2 * margin for side in size]), q) - [0, 0, margin]  # the corner is a ball of the margin
    sharp, spun = cf.impulse(1.0, world_inertia(mesh, density, q), lowest_vertex(mesh, q), UP, numpy.array([0, 0, -1.]), numpy.zeros(3), .744079)
    c = Case("I3", duration=0.04, steps_per_contact=200, margin=margin, every=4e-4, contacts=True)
    c.mesh("box", mesh)
    c.material("floor", density)
    for i, k in enumerate(stiffness):
        c.material(f"m{i}", density)
        c.pair(f"m{i}", "floor", stiffness=k, restitution=.744079)
        c.body("box", f"m{i}", (3 * i, 0, -low[2] + 0.02 * margin), orientation=q, velocity=(0, 0, -1))
    c.pair_all(stiffness=1e4, restitution=1)
    c.floor("floor")
    run = c.run(tools)
    v1, w1 = cf.impulse(1.0, world_inertia(mesh, density, q), low, UP, numpy.array([0, 0, -1.]), numpy.zeros(3), .744079)
    report.check("closed form: v_z' as printed", sharp[2], .00847, 1e-5, "absolute")
    report.check("closed form: w_y' as printed", spun[1], -2.5250, 1e-4, "absolute")
    errors = []
    for i in range(len(stiffness)):
        v, w = after_first_contact(run, i)
        errors.append(numpy.linalg.norm(w - w1) / numpy.linalg.norm(w1))
        print(f"    k = {stiffness[i]:g}: relative error of w' {errors[-1]:.2e}, v_z' {v[2]:.5f}")
    report.run(run, error_traj=errors[-1])
    # the prototype of VALIDATION reached 6.8e-2, 5.9e-3, 1.9e-3, 6e-4
    for k, error, prototype in zip(stiffness, errors, (6.8e-2, 5.9e-3, 1.9e-3, 6e-4)):
        report.at_most(f"k = {k:g}: relative error of w'", error, 2 * prototype)
    report.at_most("k = 1e7: error", errors[-1], 2e-3)
    report.check("order of the error in 1/sqrt(k), 1e5 to 1e7", math.log(errors[1] / errors[3]) / math.log(10), 1.0, 0.35, "absolute")


def drop_on_plane(tools, name, meshes_and_bodies, density, e, speed=1.0, mu=0.0, tangential=0.0, time_ratio=1e-3):
    """Drops bodies [(mesh, q, w)] with 1 m/s and a tangential speed; gives the run and the exact results."""
    size = min(numpy.ptp(mesh[0], axis=0).min() for mesh, _ in meshes_and_bodies)
    mass = max(density * meshes.mass_properties(mesh)[0] for mesh, _ in meshes_and_bodies)
    duration = time_ratio * size / math.hypot(speed, tangential)
    k = mass * (math.pi / duration) ** 2
    margin = 1.2 * speed * duration / math.pi
    c = Case(name, duration=2.2 * duration, steps_per_contact=300, margin=margin, every=duration / 25, contacts=True)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=e, friction=mu)
    known, exact = {}, []
    for i, (mesh, q) in enumerate(meshes_and_bodies):
        key = id(mesh)
        if key not in known:
            known[key] = c.mesh(f"shape{len(known)}", mesh)
        low = lowest_vertex(mesh, q)
        c.body(known[key], "m", (4 * i * numpy.ptp(mesh[0]), 0, -low[2] + 0.001 * margin), orientation=q, velocity=(tangential, 0, -speed))
        m = density * meshes.mass_properties(mesh)[0]
        exact.append(cf.impulse(m, world_inertia(mesh, density, q), low, UP, numpy.array([tangential, 0, -speed]), numpy.zeros(3), e,
                                mu, numpy.array([1.0, 0, 0]) if mu > 0 else None))
    c.floor("m")
    return c.run(tools), exact


def compare(report, run, exact, label, limit, speed, lengths):
    worst = 0.0
    for b, (v1, w1) in enumerate(exact):
        v, w = after_first_contact(run, b)
        worst = max(worst, numpy.abs(v - v1).max() / speed, numpy.linalg.norm(w - w1) * lengths[b] / speed)
    report.run(run, error_traj=worst)
    report.at_most(f"{label}: v' and R w' over V, worst of {len(exact)}", worst, limit)


@case("I4", "U", "ellipsoid on a plane: frictionless and in gross slip", "rigid-body impulse")
def i4(tools, report):
    axes, density, e = (.2, .15, .1), 1000.0, 0.6
    random = numpy.random.default_rng(4)
    orientations = random.normal(size=(5, 4))
    orientations /= numpy.linalg.norm(orientations, axis=1)[:, None]
    for level in (3, 5):
        mesh = meshes.ellipsoid(axes, level)
        bodies = [(mesh, q) for q in orientations]
        # so fast a slip that its direction stays (the spin of the impact turns it by 1/50)
        for mu, slip in ((0.0, 0.0), (0.1, 50.0)):
            run, exact = drop_on_plane(tools, f"I4-{level}-{'slip' if mu else 'free'}", bodies, density, e, mu=mu, tangential=slip,
                                       time_ratio=1e-4)  # so stiff that one corner alone touches
            compare(report, run, exact, f"level {level}, {'gross slip' if mu else 'no friction'}, the mesh's own corner", 5e-3, math.hypot(1, slip), [0.15] * 5)
            if not mu:
                # against the smooth body: support point and moments of the ellipsoid
                worst = 0.0
                for q, (v1, w1) in zip(orientations, exact):
                    R = matrix(q)
                    n = R.T @ UP
                    low = R @ (-(numpy.array(axes) ** 2 * n) / math.sqrt(((numpy.array(axes) * n) ** 2).sum()))
                    m = density * 4 / 3 * math.pi * numpy.prod(axes)
                    I = m / 5 * numpy.diag([axes[1]**2 + axes[2]**2, axes[0]**2 + axes[2]**2, axes[0]**2 + axes[1]**2])
                    v2, w2 = cf.impulse(m, R @ I @ R.T, low, UP, numpy.array([0, 0, -1.]), numpy.zeros(3), e)
                    worst = max(worst, numpy.abs(v1 - v2).max(), numpy.linalg.norm(w1 - w2) * .15)
                print(f"    facet error of level {level}: {worst:.3g}")


@case("I5", "U", "L, U and torus fall on a plane: centre of mass outside the material", "rigid-body impulse")
def i5(tools, report):
    shapes = [meshes.centred(meshes.prism(meshes.l_outline(.3, .1), .1)), meshes.centred(meshes.prism(meshes.u_outline(.3, .3, .08), .1)),
              meshes.centred(meshes.torus(.15, .04, 24, 12))]
    random = numpy.random.default_rng(8)
    bodies = []
    for mesh in shapes:
        for _ in range(3):
            q = random.normal(size=4)
            bodies.append((mesh, q / numpy.linalg.norm(q)))
    run, exact = drop_on_plane(tools, "I5", bodies, 1000.0, 0.5)
    compare(report, run, exact, "three orientations each", 2e-3, 1.0, [0.15] * 9)


@case("I6", "U", "two free boxes meet edge on crossing edge", "rigid-body impulse")
def i6(tools, report):
    size, density, e, speed = (1.0, .4, .4), 1000.0, 0.7, 1.0
    mesh = meshes.box(size)
    half = .2 * math.sqrt(2)
    mass = density * .16
    duration = 1e-3 * .4 / speed
    k = mass / 2 * (math.pi / duration) ** 2
    margin = 1.2 * speed * duration / math.pi
    # A's long axis along x, B's along y (turned by 90 degrees), both on an edge; the crossing is off centre on both
    qa = quaternion((1, 0, 0), math.pi / 4)
    turn = quaternion((0, 0, 1), math.pi / 2)
    from cases_rotation import product
    c = Case("I6", duration=2.5 * duration, steps_per_contact=300, margin=margin, every=duration / 25, contacts=True)
    c.mesh("box", mesh)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=e)
    offsets = [(0.0, 0.0), (.2, -.1), (.3, .25), (-.1, .3)]
    for i, (a, b) in enumerate(offsets):
        y0 = 3.0 * i
        # the edges cross at (0, y0): A's centre lies a beside it along x, B's centre b beside it along y
        c.body("box", "m", (a, y0, half + margin * 0.0005), orientation=qa, velocity=(0, 0, -speed / 2))
        c.body("box", "m", (0, y0 + b, -half - margin * 0.0005), orientation=product(turn, qa), velocity=(0, 0, speed / 2))
    run = c.run(tools)
    worst = 0.0
    edge_edge = 0
    for i, (a, b) in enumerate(offsets):
        Ia, Ib = world_inertia(mesh, density, qa), world_inertia(mesh, density, product(turn, qa))
        ra, rb = numpy.array([-a, 0, -half]), numpy.array([0, -b, half])
        mobility = cf.pair_mobility(UP, [(mass, Ia, ra), (mass, Ib, rb)])
        J = (1 + e) * speed / mobility
        va, wa = after_first_contact(run, 2 * i)
        vb, wb = after_first_contact(run, 2 * i + 1)
        ea = (numpy.array([0, 0, -speed / 2 + J / mass]), numpy.linalg.solve(Ia, numpy.cross(ra, J * UP)))
        eb = (numpy.array([0, 0, speed / 2 - J / mass]), numpy.linalg.solve(Ib, numpy.cross(rb, -J * UP)))
        for got, want in ((va, ea[0]), (vb, eb[0]), (.5 * wa, .5 * ea[1]), (.5 * wb, .5 * eb[1])):
            worst = max(worst, numpy.abs(got - want).max() / speed)
        edge_edge += 1
    report.run(run, error_traj=worst)
    report.at_most(f"v' and w' L/2 over V, worst of {len(offsets)} crossings", worst, 2e-3)
    report.check("pairs that met", edge_edge, len(offsets), 0, "absolute")
