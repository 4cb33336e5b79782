"""C: single normal contacts. Restitution, duration, depth, conservation (validation plan 1.2)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)

ZETAS = [.01, .05, .1, .2, .3, .5, .7, 1.0, 2.0]
PHASES = 41  # of the first contact inside a step; an odd prime samples no pattern of the step


def bounces(tools, report, name, steps, zetas, phases=PHASES, law=None, every=None, contacts=False, speed=1.0):
    """Analytic spheres of mass 1, k = 1e4 fall on a plane with 1 m/s: one sphere per damping and phase."""
    k = 1e4
    radius = 0.5
    density = 1 / (4 / 3 * math.pi * radius**3)
    contact = math.pi / math.sqrt(k)
    dt = contact / steps
    restitutions = [1.0 if z == 0 else cf.restitution(z) for z in zetas]
    c = Case(name, duration=1.25 * contact + 4 * dt, step=dt, law=law, every=every or 1.0, contacts=contacts)
    c.sphere("ball", radius)
    c.material("floor", density)
    for i, e in enumerate(restitutions):
        c.material(f"m{i}", density)
        c.pair(f"m{i}", "floor", stiffness=k, restitution=e)
    c.pair_all(stiffness=k, restitution=1.0)
    for i in range(len(zetas)):
        for j in range(phases):
            # first contact falls (j + 1/2)/phases of a step after the end of the first step
            c.body("ball", f"m{i}", (2 * j, 2 * i, radius + speed * dt * (1 + (j + .5) / phases)), velocity=(0, 0, -speed), lock_rotation=True)
    c.floor("floor")
    run = c.run(tools)
    v = run.v[-1][:, 2].reshape(len(zetas), phases) / speed
    return run, v, dt


@case("C1", "U", "linear spring-dashpot: restitution, duration, overlap", "Schwager and Poeschel 2007")
def c1(tools, report):
    # what validation plan 1.2 demands at e = 0.5, worst phase
    for steps, limit, elastic in ((20, 2.3e-2, 2.6e-4), (50, 8.5e-3, 1.7e-5), (100, 4.3e-3, 2e-6)):
        run, v, dt = bounces(tools, report, f"C1-{steps}", steps, [cf.damping_ratio(.5), 0.0])
        worst = numpy.abs(v[0] - .5).max()
        report.run(run, error_e=worst)
        report.at_most(f"|e - 0.5|, worst of {PHASES} phases, {steps} steps a contact", worst, limit)
        report.at_most(f"|e - 1|, worst of {PHASES} phases, {steps} steps a contact", numpy.abs(v[1] - 1).max(), elastic)
    # the whole table, near the limit of small steps; e comes in through the user's restitution, so it must come out again
    run, v, dt = bounces(tools, report, "C1-table", 1000, ZETAS, phases=5)
    report.run(run, error_e=max(abs(v[i] - cf.restitution(z)).max() for i, z in enumerate(ZETAS)))
    for i, z in enumerate(ZETAS):
        report.check(f"e at zeta = {z:g}", v[i].mean(), cf.restitution(z), 1e-3, "absolute")
    # duration and depth of one bounce, read from forces and positions at every step
    k, radius = 1e4, 0.5
    contact = math.pi / math.sqrt(k)
    dt = contact / 2000
    c = Case("C1-duration", duration=1.2 * contact, step=dt, every=8 * dt, contacts=True)
    c.sphere("ball", radius)
    density = 1 / (4 / 3 * math.pi * radius**3)
    c.material("floor", density)
    for i, z in enumerate(ZETAS):
        c.material(f"m{i}", density)
        c.pair(f"m{i}", "floor", stiffness=k, restitution=cf.restitution(z))
        c.body("ball", f"m{i}", (2 * i, 0, radius + 0.5 * dt), velocity=(0, 0, -1), lock_rotation=True)
    c.pair_all(stiffness=k, restitution=1.0)
    c.floor("floor")
    run = report.run(c.run(tools))
    wall = len(ZETAS)
    for i, z in enumerate(ZETAS):
        depth = radius - run.x[:, i, 2]
        force = numpy.zeros(len(run.times))
        for n, contacts in enumerate(run.contacts):
            mine = (contacts["body_a"] == i) & (contacts["body_b"] == wall)
            force[n] = contacts["normal_force"][mine].sum()
        touching = run.times[force > 0]
        # the impact begins half a step after time 0, ends between the last frame with force and the next one
        duration = (touching[-1] - 0.5 * dt + 4 * dt) * math.sqrt(k)
        report.check(f"omega t at zeta = {z:g}", duration, cf.contact_duration(z), 8 * math.pi / 2000, "absolute", "read from every eighth of 2000 steps")
        report.check(f"d_max omega / v at zeta = {z:g}", depth.max() * math.sqrt(k), cf.deepest(z), 5e-3, "relative")


@case("C2", "U", "Hunt-Crossley: restitution by speed, phase, steps", "Hunt and Crossley 1975; VALIDATION C2")
def c2(tools, report):
    k, R = 1e4, .5
    density = 1 / (4 / 3 * math.pi * R**3)
    contact = math.pi / math.sqrt(k)
    alpha = cf.hunt_crossley_alpha(.5)
    # alpha = chi v: at half and twice the speed of the asked restitution the law itself says another one
    factors = (1.0, .5, 2.0)
    expected = [.5, cf.hunt_crossley_restitution(alpha / 2), cf.hunt_crossley_restitution(2 * alpha)]
    for steps, limit in ((20, 1.2e-3), (50, 2.2e-4), (100, 5e-5)):
        dt = contact / steps
        c = Case(f"C2-{steps}", duration=1.8 * contact, step=dt, law="hunt-crossley", every=1.0)
        c.sphere("ball", R)
        c.material("m", density)
        c.pair_all(stiffness=k, restitution=.5, restitution_speed=1.0)
        for i, f in enumerate(factors):
            for j in range(PHASES):
                c.body("ball", "m", (2 * j, 2 * i, R + f * dt * (1 + (j + .5) / PHASES)), velocity=(0, 0, -f), lock_rotation=True)
        c.floor()
        run = c.run(tools)
        e = run.v[-1, :, 2].reshape(len(factors), PHASES) / numpy.array(factors)[:, None]
        report.run(run, error_e=numpy.abs(e[0] - .5).max())
        report.at_most(f"|e - 0.5|, worst of {PHASES} phases, {steps} steps a contact", numpy.abs(e[0] - .5).max(), limit)
        if steps == 100:
            for i in (1, 2):
                report.check(f"e at {factors[i]:g} of the requested speed", e[i].mean(), expected[i], 1e-3, "absolute")


@case("C3", "U", "Hertz: a sphere and a fine mesh of it", "Hertz; VALIDATION C3")
def c3(tools, report):
    # aluminium as in test 2 of Chung and Ooi (depth 5e-5 m, as deep as a facet of level 4 is high), and a rubber ball, so deep
    # (3 mm) that a dozen corners of the mesh carry
    poisson, R = .3, .1
    for name, young, density, speed in (("analytic sphere", 70e9, 2699.0, .2), ("icosphere L4", 70e9, 2699.0, .2), ("analytic sphere, rubber", 1e7, 1000.0, .5),
                                        ("icosphere L4, rubber", 1e7, 1000.0, .5)):
        E = 1 / (2 * (1 - poisson**2) / young)
        sphere_mass = density * 4 / 3 * math.pi * R**3
        mesh = meshes.icosphere(4, R)
        mass = sphere_mass if name[0] == "a" else density * meshes.mass_properties(mesh)[0]
        depth, force, duration = cf.hertz_impact(mass, speed, E, R)
        margin = 0 if name[0] == "a" else depth
        dt = duration / 600
        c = Case(f"C3-{name.split()[0]}-{young:g}", duration=1.3 * duration, step=dt, margin=margin, law="hertz-mindlin", every=4 * dt, contacts=True)
        if name[0] == "a":
            c.sphere("ball", R)
        else:
            c.mesh("ball", mesh)
        c.material("m", density, young=young, poisson=poisson)
        c.pair_all(restitution=1.0, contact_radius=R)
        c.body("ball", "m", (0, 0, (R if name[0] == "a" else mesh[0][:, 2].max()) + 1e-9 * R), velocity=(0, 0, -speed), lock_rotation=True)
        c.floor()
        run = c.run(tools)
        total = numpy.array([contacts["normal_force"].sum() for contacts in run.contacts])
        touching = run.times[total > 0]
        deepest = run.x[0, 0, 2] - run.x[:, 0, 2].min()
        tolerance = 5e-3 if name[0] == "a" else .02
        report.run(run, error_e=abs(run.v[-1, 0, 2] / speed - 1), error_t=abs((touching[-1] - touching[0]) / duration - 1))
        report.check(f"{name}: largest overlap [m]", deepest, depth, tolerance)
        report.check(f"{name}: largest force [N]", total.max(), force, tolerance)
        report.check(f"{name}: duration [s]", touching[-1] - touching[0] + 4 * dt, duration, 2 * tolerance)


@case("C13", "N", "elastic bouncing for a long time: no drift of energy")
def c13(tools, report):
    g = 9.81
    # Locked: a unit cube on its face, 1e4 bounces of 1.5 mm. Free: eight that tumble for 60 s, over 2000 impacts of corners, edges, faces;
    # they fall by up to 0.3 m, so their contact is a hundred times stiffer. Every impact errs by some 1e-5 of m g h with a sign that chance
    # gives, so that the energy of a single cube wanders: in 200 s one has drifted by 6e-5, with other roundings by 1.3e-3. What must
    # not be is a drift that all have in common.
    random = numpy.random.default_rng(2)
    turns = random.normal(size=(8, 4))
    turns /= numpy.linalg.norm(turns, axis=1)[:, None]
    for name, k, height, orientations in (("locked", 1e4, .0015, numpy.array([[1.0, 0, 0, 0]])), ("free", 1e6, .0015, turns)):
        free = name == "free"
        omega = math.sqrt(k * math.sqrt(2.0) * (4 if free else 1))
        dt = math.pi / omega / 100
        duration = 60.0 if free else 10000 * (2 * math.sqrt(2 * height / g) + math.pi / omega)
        c = Case(f"C13-{name}", duration=duration, step=dt, gravity=(0, 0, -g), margin=0.01, every=duration / 200)
        c.mesh("cube", meshes.box())
        c.material("m", 1.0)
        c.pair_all(stiffness=k, restitution=1.0)
        for i, q in enumerate(orientations):
            c.body("cube", "m", (10 * i, 0, lowest(q) + 0.02 + height), orientation=q, lock_rotation=not free)
        c.floor("m")
        run = report.run(c.run(tools))
        fall = g * (run.x[0, :, 2] - .52)  # what each can fall, on its face at last
        relative = (run.energy() - run.energy()[0]) / fall.sum()
        slope, _ = numpy.polyfit(run.log["time"], relative, 1)
        report.at_most(f"{name}: |slope| T of the energy over m g h", abs(slope) * duration, 1e-3)
        report.at_most(f"{name}: rms of the energy over m g h", numpy.std(relative), 1e-3)
        if free:
            energy = .5 * (run.v**2).sum(axis=2) + .5 / 6 * (run.w**2).sum(axis=2) + g * run.x[..., 2]  # mass 1, inertia 1/6
            own = (energy - energy[0]) / fall
            own[numpy.abs(own) > .02] = numpy.nan  # in contact: part of it is in the spring
            slopes = [numpy.polyfit(run.times[held], column[held], 1)[0] * duration for column in own.T for held in [numpy.isfinite(column)]]
            print(f"    slopes T: {', '.join(f'{s:.1e}' for s in slopes)}")
            report.at_most("free: mean of the eight slopes over its standard error", abs(numpy.mean(slopes)) / (numpy.std(slopes, ddof=1) / math.sqrt(8)), 3.0)


def lowest(q):
    return -rotated(numpy.asarray(q), meshes.box()[0])[:, 2].min()


@case("C14", "U", "Newton's cradle of five cubes, binary impacts")
def c14(tools, report):
    k, margin = 1e6, 0.005
    dt = math.pi / math.sqrt(2 ** .75 * k * 2) / 100
    c = Case("C14", duration=0.12, step=dt, margin=margin, every=0.005)
    c.mesh("cube", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)  # mass 1
    c.pair_all(stiffness=k, restitution=1.0)
    gap = 0.004
    for i in range(5):
        c.body("cube", "m", (i * (0.1 + gap), 0, 0), velocity=(1 if i == 0 else 0, 0, 0))
    run = report.run(c.run(tools))
    v = run.v[-1][:, 0]
    report.check("last cube leaves with v0", v[4], 1.0, 1e-3, "absolute")
    report.at_most("largest speed of the others", numpy.abs(v[:4]).max(), 1e-3)


@case("C15", "U", "momentum and angular momentum of a non-convex pair with friction")
def c15(tools, report):
    k, margin = 1e5, 0.01
    c = Case("C15", duration=0.4, steps_per_contact=60, margin=margin, every=0.4)
    rocks = [meshes.rock(3, 2), meshes.rock(4, 1)]
    for i, mesh in enumerate(rocks):
        c.mesh(f"rock{i}", mesh)
    c.material("m", 1.0)
    c.pair_all(stiffness=k * 0.1, restitution=0.6, friction=0.4)
    pairs = 6
    random = numpy.random.default_rng(5)
    for i in range(pairs):
        q = random.normal(size=(2, 4))
        q /= numpy.linalg.norm(q, axis=1)[:, None]
        offset = random.uniform(-.15, .15, 2)
        c.body("rock0", "m", (-.75, 5 * i, 0), orientation=q[0], velocity=(1, 0, 0), angular_velocity=random.normal(size=3))
        c.body("rock1", "m", (.75, 5 * i + offset[0], offset[1]), orientation=q[1], velocity=(-1, 0, 0), angular_velocity=random.normal(size=3))
    run = report.run(c.run(tools))
    properties = [meshes.mass_properties(r) for r in rocks]
    worst_p = worst_l = 0.0
    touched = 0
    for i in range(pairs):
        p, l, scale_p, scale_l = [], [], 0.0, 0.0
        for f in (0, -1):
            total_p, total_l = numpy.zeros(3), numpy.zeros(3)
            for j in range(2):
                b = 2 * i + j
                m, inertia = properties[j][0], properties[j][2]
                R = matrix(run.q[f, b])
                spin = R @ inertia @ R.T @ run.w[f, b]
                x = run.x[f, b] - numpy.array([0, 5 * i, 0])  # a fixed point beside the pair
                total_p += m * run.v[f, b]
                total_l += numpy.cross(x, m * run.v[f, b]) + spin
                scale_p = max(scale_p, m * numpy.linalg.norm(run.v[f, b]))
                scale_l = max(scale_l, numpy.linalg.norm(spin) + numpy.linalg.norm(numpy.cross(x, m * run.v[f, b])))
            p.append(total_p)
            l.append(total_l)
        touched += bool(numpy.linalg.norm(run.v[-1, 2 * i] - run.v[0, 2 * i]) > 0.1)
        worst_p = max(worst_p, numpy.abs(p[1] - p[0]).max() / scale_p)
        worst_l = max(worst_l, numpy.abs(l[1] - l[0]).max() / scale_l)
    limit = 1e-13 * math.sqrt(run.steps)
    report.at_least("pairs that collided", touched, 5)
    report.at_most("change of momentum over m|v|", worst_p, limit)
    report.at_most("change of angular momentum about a fixed point", worst_l, limit)


def matrix(q):
    return numpy.stack([rotated(numpy.asarray(q), e) for e in numpy.eye(3)], axis=1)
