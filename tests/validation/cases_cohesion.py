"""A: attraction of contacts. Sticking and rebound, work to part, the force that parts bodies of any mesh."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)

RADIUS, MASS, STIFFNESS, PULL_OFF, RANGE = 1e-3, 1e-3, 1e4, 0.1, 1e-5
DENSITY = MASS / (4 / 3 * math.pi * RADIUS**3)


def sticky_bounces(tools, report, name, speeds, restitution, step, **words):
    """Balls of 1 g that attract the plane on which they fall, each with its speed, from just beyond the range. Gives the speeds at the end."""
    c = Case(name, duration=2 * math.pi * math.sqrt(MASS / STIFFNESS) + 12 * RANGE / min(speeds), step=step, every=1.0, margin=0.0)
    c.sphere("ball", RADIUS)
    c.material("m", DENSITY)
    c.pair("m", "m", stiffness=STIFFNESS, restitution=restitution, pull_off=PULL_OFF, adhesion_range=RANGE, **words)
    for i, v in enumerate(speeds):
        # the first step within the range has another phase for each
        c.body("ball", "m", (4 * RADIUS * i, 0, RADIUS + RANGE + v * step * (1 + (i + .5) / len(speeds))), velocity=(0, 0, -v), lock_rotation=True)
    c.floor("m")
    run = report.run(c.run(tools))
    return run


@case("A1", "U", "balls that attract a plane: sticking speed, speed of leaving", "linear contact with damping: the push alone is damped")
def a1(tools, report):
    # with e = .5, reduced mass 1 g, k = 1e4 N/m, F_c = .1 N, s = 10 um
    step = 1e-7
    expected = {.2: .06271, .5: .22180, 1.0: .47393}
    run = sticky_bounces(tools, report, "A1-damped", list(expected), .5, step)
    for v, left in zip(expected, run.v[-1][:, 2]):
        report.check(f"leaves at, arriving at {v:g} m/s", left, expected[v], 2e-4)
        report.check(f"the same at {v:g} m/s, from the equation of the contact", left, cf.sticky_rebound(v, .5, MASS, STIFFNESS, PULL_OFF, RANGE), 2e-4)
    limit = cf.sticking_speed(.5, MASS, STIFFNESS, PULL_OFF, RANGE)
    report.check("sticking speed, from the equation of the contact", limit, .13386, 1e-4)
    run = sticky_bounces(tools, report, "A1-sticks", [.99 * limit, 1.01 * limit], .5, step)
    at_rest = RADIUS - PULL_OFF / STIFFNESS
    report.check("1 % below it: stays within the range", run.x[-1][0, 2] - at_rest, 0, 2 * RANGE + PULL_OFF / STIFFNESS, "absolute")
    report.check("1 % above it: leaves at", run.v[-1][1, 2], cf.sticky_rebound(1.01 * limit, .5, MASS, STIFFNESS, PULL_OFF, RANGE), 2e-2)


@case("A2", "U", "without losses a sticky ball leaves as it came; error against step", "conservation of energy")
def a2(tools, report):
    contact = math.pi * math.sqrt(MASS / STIFFNESS)
    errors = []
    speeds = numpy.linspace(.9, 1.1, 21)   # the range is entered and left at as many phases of a step
    for steps in (250, 500, 1000, 2000):
        run = sticky_bounces(tools, report, f"A2-{steps}", list(speeds), 1.0, contact / steps)
        errors.append(numpy.sqrt((((run.v[-1][:, 2] - speeds) / speeds)**2).mean()))
        report.run(run, error_e=errors[-1])
    report.at_most("speed of leaving over speed of arrival - 1, 1000 steps a contact", errors[2], 1e-6)
    order = math.log2(errors[0] / errors[3]) / 3
    report.at_least("order of the error in the step", order, 1.7)


def pull_at_touch(run, body):
    """Normal force of a body's contacts in the frame of the start, as a pull [N]."""
    contacts = run.contacts[0]
    mine = (contacts["body_a"] == body) | (contacts["body_b"] == body)
    return -contacts["normal_force"][mine].sum()


def cubes_at_touch(c, side, margin, share=1.0):
    """Cubes on corner, edge and face, coarse and with their faces split, at this share of the height at which they touch a floor at z = 0.
    Gives of each what it is and n^(1/8) of its n equal features."""
    down = {"corner": (quaternion((1, -1, 0), math.acos(1 / math.sqrt(3))), 1), "edge": (quaternion((1, 0, 0), math.pi / 4), 2),
            "face": (quaternion((0, 0, 1), 0.0), 4)}
    c.mesh("coarse", meshes.box((side, side, side)))
    c.mesh("fine", meshes.box((side, side, side), 4))
    expected = []
    for x, (name, (q, features)) in enumerate(down.items()):
        for y, shape in enumerate(("coarse", "fine")):
            # edges and corners are rounded by the margin
            touch = margin - (1 - 2 * margin / side) * rotated(q, c.solids[shape][0])[:, 2].min()
            c.body(shape, "m", (3 * side * x, 3 * side * y, touch * share), orientation=q)
            expected.append((f"cube on its {name}, {shape}", features**.125))
    return expected


@case("A3", "U", "pull-off of a cube on face, edge and corner, and with its faces split", "n equal features: F_c n^(1/8)")
def a3(tools, report):
    """The attraction of one body is largest at touch, where the push begins: read there."""
    k, force, s, margin = 1e4, 3.0, 4e-3, 1e-2
    c = Case("A3", duration=1e-6, step=1e-6, margin=margin, every=1e-6, contacts=True)
    c.material("m", 1000.0)
    c.pair("m", "m", stiffness=k, restitution=1.0, pull_off=force, adhesion_range=s)
    expected = cubes_at_touch(c, 1, margin)
    c.floor("m")
    run = report.run(c.run(tools))
    for i, (what, value) in enumerate(expected):
        report.check(f"pull-off over F_c: {what}", pull_at_touch(run, i) / force, value, 1e-6)
        if i % 2:
            report.check(f"{what} against coarse", pull_at_touch(run, i), pull_at_touch(run, i - 1), 1e-9)


@case("A4", "U", "a body held on a vertical wall by its attraction alone: friction mu (N + F_c)", "Coulomb, with the push as the normal force")
def a4(tools, report):
    mu, g, duration = .4, 9.81, .05
    c = Case("A4", duration=duration, every=duration / 10, margin=0.0, gravity=(0, 0, -g), contact={"impact_speed": .01})
    c.sphere("ball", RADIUS)
    c.material("wall", DENSITY)
    shares = (.97, 1.03)   # of the weight that friction carries
    for i, share in enumerate(shares):
        c.material(f"m{i}", DENSITY)
        c.pair(f"m{i}", "wall", stiffness=STIFFNESS, restitution=.3, friction=mu, pull_off=MASS * g / (mu * share), adhesion_range=RANGE)
        c.body("ball", f"m{i}", (RADIUS * (1 + 1e-9), 4 * RADIUS * i, 0), lock_rotation=True)
    c.pair_all(stiffness=STIFFNESS, restitution=.3)
    c.floor("wall", normal=(1, 0, 0))
    run = report.run(c.run(tools))
    # the first half is for the contacts to come to rest in; share .97 then has friction for 1 / .97 of the weight, 1.03 lacks 1 - 1 / 1.03
    half, passed = len(run.times) // 2, run.times[-1] - run.times[len(run.times) // 2]
    report.at_most("friction above the weight: falls, over a free fall", (run.x[half, 0, 2] - run.x[-1, 0, 2]) / (.5 * g * passed**2), 1e-4)
    report.check("friction below the weight: acceleration", (run.v[half, 1, 2] - run.v[-1, 1, 2]) / passed, g * (1 - 1 / shares[1]), 1e-2)
    report.at_most("neither leaves the wall", numpy.abs(run.x[:, :, 0] - RADIUS).max(), 3 * MASS * g / mu / STIFFNESS)


@case("A5", "U", "pull-off forces of two balls from the work of adhesion", "JKR 3/2 pi w R*, DMT 2 pi w R*; Bond number")
def a5(tools, report):
    w, radius, density = .05, 1e-3, 2500.0
    c = Case("A5", duration=1e-7, step=1e-7, margin=0.0, every=1e-7, contacts=True)
    c.sphere("ball", radius)
    for model in ("jkr", "dmt"):
        c.material(model, density)
        c.pair(model, model, stiffness=1e3, restitution=1.0, adhesion=w, adhesion_model=model, adhesion_range=1e-5)
    c.pair_all(stiffness=1e3, restitution=1.0)
    for i, model in enumerate(("jkr", "jkr", "dmt", "dmt")):
        c.body("ball", model, (2 * radius * (1 + 1e-9) * (i % 2), 10 * radius * (i // 2), 0))
    run = report.run(c.run(tools))
    weight = 4 / 3 * math.pi * radius**3 * density * 9.81
    for body, model, expected in ((0, "JKR", 117.81e-6), (2, "DMT", 157.08e-6)):
        report.check(f"{model}, R* = 0.5 mm, w = 50 mJ/m^2", pull_at_touch(run, body), expected, 5e-5)
    report.check("Bond number of the first", pull_at_touch(run, 0) / weight, 1.147, 5e-4)


W_NECK, YOUNG, R_BALL, RHO = .05, 2e7, 1e-3, 2500.0   # E* = 10 MPa, R* = .5 mm


def sticky_pairs(name, speeds, duration, step, every, **words):
    """Pairs of balls that meet head on, each at its closing speed, from just beyond touch."""
    c = Case(name, duration=duration, step=step, every=every, margin=0.0, contacts=True, law="hertz-mindlin", contact={"impact_speed": max(speeds)})
    c.sphere("ball", R_BALL)
    c.material("m", RHO, young=YOUNG, poisson=0.0)
    c.pair("m", "m", **words)
    for i, v in enumerate(speeds):
        gap = v * step * (2 + (i + .5) / len(speeds))
        for side in (-1, 1):
            c.body("ball", "m", (side * (R_BALL + gap / 2), 6 * R_BALL * i, 0), velocity=(-side * v / 2, 0, 0))
    return c


def pair_forces(run, pair):
    """Overlap and normal force of a pair of sticky_pairs, one row for each frame in which they touch or stick."""
    rows = [(c["depth"][k], c["normal_force"][k]) for c in run.contacts for k in numpy.nonzero(c["body_a"] == 2 * pair)[0]]
    return numpy.array(rows)


def closing(run, frame, pair):
    return run.v[frame, 2 * pair, 0] - run.v[frame, 2 * pair + 1, 0]


@case("A6", "U", "balls that stick with the hysteresis of JKR: force on both branches, sticking speed, restitution", "Johnson, Kendall, Roberts 1971; Thornton and Ning 1998")
def a6(tools, report):
    modulus, radius = YOUNG / 2, R_BALL / 2
    mass = 4 / 3 * math.pi * R_BALL**3 * RHO / 2
    at_touch = cf.jkr(0.0, W_NECK, modulus, radius)
    unit = (W_NECK**5 * radius**4 / modulus**2)**(1 / 3)
    sticks = math.sqrt(2 * 7.0922 * unit / mass)
    report.check("sticking speed of the theory", sticks, 3.9646e-3, 1e-4)
    words = {"restitution": 1.0, "adhesion": W_NECK, "adhesion_model": "jkr", "adhesion_hysteresis": True}
    step = 2e-7
    over = (.98, 1.02, 1.2, 1.5, 2.0, 4.0)
    duration = 6e-3
    run = report.run(sticky_pairs("A6", [s * sticks for s in over], duration, step, 2e-5, **words).run(tools))
    report.at_most("2 % below the sticking speed: gap at the end, over that of tear-off",
                   (run.x[-1, 1, 0] - run.x[-1, 0, 0] - 2 * R_BALL) / at_touch["tear_off"], 1.0)
    for i, s in list(enumerate(over))[1:]:
        left = -closing(run, -1, i) / (s * sticks)
        report.check(f"restitution at {s:g} sticking speeds", left, math.sqrt(1 - 1 / s**2), 2e-2 if s < 1.1 else 2e-3)
    worst, most = 0.0, 0.0
    for i in range(len(over)):
        rows = pair_forces(run, i)
        for overlap, force in rows:
            worst = max(worst, abs(force - cf.jkr(overlap, W_NECK, modulus, radius)["force"]))
        most = max(most, -rows[:, 1].min())
    report.at_most("force in frames against that of the radius of the contact, over F_c", worst / at_touch["pull_off"], 1e-9)
    report.check("pull-off force", most, 117.81e-6, 2e-3)
    report.check("force at touch, from the same", at_touch["force"], -4 / 3 * math.pi * W_NECK * radius, 1e-12)
    log = run.log
    # five contacts have parted, and lost what is between touch and tear-off; the first has released it and is still in its well
    lost = log["dissipated"][-1]
    report.check("dissipated, six necks formed", lost, 6 * 7.0922 * unit, 1e-4)
    total = run.energy() + log["dissipated"]
    report.at_most("energy and dissipated: deviation over the energy at the start", abs(total - total[0]).max() / total[0], 5e-3)


@case("A7", "U", "a liquid bridge: force against gap, rupture, energy", "Willett et al. 2000, Lian et al. 1993")
def a7(tools, report):
    tension, angle = .072, math.radians(20)
    volume = 1e-3 * R_BALL**3
    table = {0.0: 425.107e-6, .001: 410.45e-6, .01: 268.71e-6, .05: 47.710e-6, .1: 14.499e-6}
    for rupture, gap, energy in (("lian", 117.45e-6, 9.7478e-9), ("willett", 118.63e-6, 9.7603e-9)):
        lian = rupture == "lian"
        for s, force in table.items():
            report.check(f"closed form at S/R = {s:g}", cf.bridge_force(s * R_BALL, tension, angle, volume, R_BALL), force, 5e-5)
        work = cf.bridge_work(tension, angle, volume, R_BALL, lian)
        report.check(f"rupture, {rupture}", cf.bridge_rupture(angle, volume, R_BALL, lian), gap, 1e-4)
        report.check(f"work to part, {rupture}", work, energy, 1e-4)
        mass = 4 / 3 * math.pi * R_BALL**3 * RHO / 2
        sticks = math.sqrt(2 * work / mass)
        over = (.9, 1.1, 1.5, 3.0)
        words = {"restitution": 1.0, "stiffness": 1e4, "surface_tension": tension, "contact_angle": "20 deg", "bridge_volume": volume,
                 "bridge_rupture": rupture}
        c = sticky_pairs(f"A7-{rupture}", [s * sticks for s in over], 12e-3, 1e-6, 2e-5, **words)
        c.tables["contact"]["law"] = "linear"
        run = report.run(c.run(tools))
        worst, farthest, nearest = 0.0, 0.0, 1.0
        for i, s in enumerate(over):
            rows = pair_forces(run, i)
            beyond = rows[rows[:, 0] < 0]
            worst = max(worst, numpy.abs(-beyond[:, 1] - cf.bridge_force(-beyond[:, 0], tension, angle, volume, R_BALL)).max())
            if s > 1:
                farthest = max(farthest, -rows[:, 0].min())
                gaps = run.x[:, 2 * i + 1, 0] - run.x[:, 2 * i, 0] - 2 * R_BALL
                nearest = min(nearest, gaps[gaps > farthest].min())
                left = -closing(run, -1, i) / (s * sticks)
                report.check(f"leaves at, arriving at {s:g} sticking speeds, {rupture}", left, math.sqrt(1 - 1 / s**2), 2e-3)
            else:
                report.at_most("below the sticking speed: largest gap, over that of rupture",
                               (run.x[:, 1, 0] - run.x[:, 0, 0]).max() / gap - 2 * R_BALL / gap, 1.0)
        report.at_most(f"force in frames against Willett's, over that at touch, {rupture}", worst / table[0.0], 1e-6)
        report.at_most(f"largest gap with a bridge in a frame, over rupture, {rupture}", farthest / gap, 1.0001)
        report.at_least(f"least gap without one after, over rupture, {rupture}", nearest / gap, .9999)
        report.check(f"dissipated as four bridges formed, {rupture}", run.log["dissipated"][-1], 4 * energy, 1e-4)


@case("A8", "U", "a bridge between a cube and a plane: on face, edge and corner, and with its faces split", "one per pair: n equal features share it, F n^(1/8)")
def a8(tools, report):
    tension, volume, margin = .072, 1e-12, 1e-4
    side, k = 2e-3, 1e3
    equivalent = (3 / (4 * math.pi))**(1 / 3) * side
    c = Case("A8", duration=1e-6, step=1e-6, margin=margin, every=1e-6, contacts=True)
    c.material("m", 1000.0)
    c.pair("m", "m", stiffness=k, restitution=1.0, surface_tension=tension, bridge_volume=volume)
    expected = cubes_at_touch(c, side, margin, 1 - 1e-9)
    c.floor("m")
    run = report.run(c.run(tools))
    force = 4 * math.pi * equivalent * tension
    for i, (what, value) in enumerate(expected):
        report.check(f"pull-off over 4 pi R* gamma: {what}", pull_at_touch(run, i) / force, value, 1e-4)
        if i % 2:
            report.check(f"{what} against coarse", pull_at_touch(run, i), pull_at_touch(run, i - 1), 1e-9)


@case("A9", "U", "a ball that sticks to a wall by JKR's neck: friction mu |F + 2 F_c|", "Thornton 1991")
def a9(tools, report):
    mu, g, duration, radius = .4, 9.81, .05, R_BALL
    ball = 4 / 3 * math.pi * radius**3
    c = Case("A9", duration=duration, every=duration / 10, margin=0.0, gravity=(0, 0, -g), law="hertz-mindlin", contact={"impact_speed": .01})
    c.sphere("ball", radius)
    c.material("wall", RHO, young=YOUNG, poisson=0.0)
    shares = (.97, 1.03)   # weight over what friction carries at rest, where F = 0
    for i, share in enumerate(shares):
        c.material(f"m{i}", RHO, young=YOUNG, poisson=0.0)
        work = share * ball * RHO * g / (mu * 2 * 1.5 * math.pi * radius)
        c.pair(f"m{i}", "wall", restitution=.3, friction=mu, adhesion=work, adhesion_model="jkr", adhesion_hysteresis=True)
        c.body("ball", f"m{i}", (radius * (1 + 1e-9), 4 * radius * i, 0), velocity=(-1e-3, 0, 0), lock_rotation=True)   # it must touch once
    c.pair_all(restitution=.3)
    c.floor("wall", normal=(1, 0, 0))
    run = report.run(c.run(tools))
    half, passed = len(run.times) // 2, run.times[-1] - run.times[len(run.times) // 2]
    report.check("friction below the weight: acceleration", (run.v[half, 0, 2] - run.v[-1, 0, 2]) / passed, g * (1 - shares[0]), 2e-2)
    report.at_most("friction above the weight: falls, over a free fall", (run.x[half, 1, 2] - run.x[-1, 1, 2]) / (.5 * g * passed**2), 1e-4)


@case("A10", "U", 'attraction with gather = "area": flat punch, ball, icospheres, at touch', "p A with p = 2 w / s; 2 pi w R* (Derjaguin), of every mesh")
def a10(tools, report):
    # a thin layer: over curved faces gaps count along the mean normal, which errs by its share of R
    w, s, ratio, side = .5, 2e-5, 5e-3, 2e-3
    c = Case("A10", duration=1e-7, step=1e-7, every=1e-7, contacts=True, gather="area", contact={"margin_ratio": ratio})
    c.material("m", 1000.0)
    c.pair("m", "m", layer_modulus=1e9, restitution=1.0, adhesion=w, adhesion_range=s)
    expected, radius = [], 1e-3
    q = quaternion((1, 2, 3), .7)
    c.mesh("coarse", meshes.box((side, side, side)))
    c.mesh("fine", meshes.box((side, side, side), 4))
    c.sphere("ball", radius)
    levels = range(1, 7)
    for level in levels:
        c.mesh(f"ico{level}", meshes.icosphere(level, radius))
    touch = 5e-5 * s   # a little above it: meshes are imported in single precision, and the layer is stiff
    for i, shape in enumerate(("coarse", "fine")):
        c.body(shape, "m", (4 * side * i, 0, touch + side / 2))
        # edges are rounded by the margin: the face is as much smaller
        flat = side - 2 * ratio * side * (.75 / math.pi)**(1 / 3)
        expected.append((f"face of a cube, {shape}, over p A", 2 * w / s * flat**2, 1e-4))
    c.body("ball", "m", (0, 4 * side, touch + radius))
    expected.append(("ball over 2 pi w R*", 2 * math.pi * w * radius, 2e-4))
    for i, level in enumerate(levels):
        shape = f"ico{level}"
        lowest = rotated(q, c.solids[shape][0])[:, 2].min()
        c.body(shape, "m", (4 * side * i, 8 * side, touch - lowest), orientation=q)
    c.floor("m")
    run = report.run(c.run(tools))
    for i, (what, value, tolerance) in enumerate(expected):
        report.check(what, pull_at_touch(run, i) / value, 1.0, tolerance)
    report.check("face of a cube, fine against coarse", pull_at_touch(run, 1), pull_at_touch(run, 0), 1e-9)
    over = [pull_at_touch(run, 3 + i) / (2 * math.pi * w * radius) for i in range(len(levels))]
    for level, value in zip(levels, over):
        # a facet's sag takes it off the plane by as much as the range where the mesh is coarse
        if level < 4:
            report.at_most(f"icosphere of level {level}, over 2 pi w R*", value, 1.0)
        else:
            report.check(f"icosphere of level {level}, over 2 pi w R*", value, 1.0, .03)
    report.at_most("level 6 against level 5", abs(over[-1] / over[-2] - 1), .01)


def concave_impacts(tools, report, name, steps, words):
    """Largest change of all energy of six elastic impacts of L-shaped bodies, over that of the motion at the start."""
    k, size, mass, speed = 1e4, 1e-2, 1e-3, .5
    shape = meshes.prism(meshes.l_outline(size, .4 * size), .5 * size)
    volume = meshes.mass_properties(shape)[0]
    contact = math.pi * math.sqrt(mass / 2 / k)
    c = Case(f"{name}-{steps}", duration=.03, step=contact / steps, margin=3e-4, every=contact / 4, contact={"impact_speed": speed})
    c.mesh("l", shape)
    c.material("m", mass / volume)
    c.pair("m", "m", stiffness=k, restitution=1.0, **words)
    for i in range(6):
        turns = [quaternion((1, .3 * i, -.2 * i), .7 * i + side) for side in (0, 1)]
        for side in (0, 1):
            sign = 1 - 2 * side
            c.body("l", "m", (4 * size * i, 0, (1 - 2 * side) * 1.3 * size), velocity=(0, 0, -sign * speed / 2), orientation=turns[side])
    run = report.run(c.run(tools))
    total = run.energy() + run.log["dissipated"]
    return abs(total - total[0]).max() / total[0], run


@case("A11", "U", "elastic impacts of concave bodies that stick: error of the energy against the step", "conservation of energy")
def a11(tools, report):
    pull = {"pull_off": .3, "adhesion_range": 2e-5}
    for name, words in (("without attraction", {}), ("with attraction", pull)):
        errors = [concave_impacts(tools, report, "A11" + ("b" if words else "a"), steps, words)[0] for steps in (25, 50, 100, 200)]
        report.at_most(f"{name}: change of energy at 200 steps a contact", errors[-1], 5e-4)
        report.at_least(f"{name}: order of the error in the step", math.log2(errors[0] / errors[-1]) / 3, 1.7)


@case("A12", "U", "a cube that lands on its face with a bridge, and a ball with a neck that rebounds with damping", "conservation of energy; pull at most F_c")
def a12(tools, report):
    """Features that share a potential are deeper together than one: what goes as the bridge forms is counted where the deepest touches."""
    side = 2e-3
    c = Case("A12a", duration=8e-3, every=1e-4, margin=1e-4, contact={"impact_speed": .2})
    c.mesh("cube", meshes.box((side, side, side)))
    c.material("m", 1000.0)
    c.pair("m", "m", stiffness=1e3, restitution=1.0, surface_tension=.072, bridge_volume=1e-12)
    c.body("cube", "m", (0, 0, 2e-4 + side / 2 + 1e-5), velocity=(0, 0, -.1))
    c.floor("m")
    run = report.run(c.run(tools))
    total = run.energy() + run.log["dissipated"]
    report.at_most("cube: energy and dissipated: deviation over the energy at the start", abs(total - total[0]).max() / total[0], 1e-2)
    work = .1
    c = Case("A12b", duration=6e-4, step=2e-7, every=2e-6, margin=0.0, contacts=True, law="hertz-mindlin", contact={"impact_speed": .5})
    c.sphere("ball", R_BALL)
    c.material("m", RHO, young=YOUNG, poisson=0.0)
    c.pair("m", "m", restitution=.4, friction=.8, adhesion=work, adhesion_model="jkr", adhesion_hysteresis=True)
    c.body("ball", "m", (0, 0, R_BALL * (1 + 1e-5)), velocity=(.3, 0, -.5))
    c.floor("m")
    run = report.run(c.run(tools))
    pull = max(-contacts["normal_force"].min() for contacts in run.contacts if len(contacts["normal_force"]))
    report.at_most("neck with e = 0.4: largest pull over F_c", pull / (1.5 * math.pi * work * R_BALL), 1 + 1e-9)
