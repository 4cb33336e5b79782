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


@case("A3", "U", "pull-off of a cube on face, edge and corner, and with its faces split", "n equal features: F_c n^(1/8)")
def a3(tools, report):
    """The attraction of one body is largest at touch, where the push begins: read there."""
    k, force, s, margin = 1e4, 3.0, 4e-3, 1e-2
    down = {"corner": (quaternion((1, -1, 0), math.acos(1 / math.sqrt(3))), 1), "edge": (quaternion((1, 0, 0), math.pi / 4), 2),
            "face": (quaternion((0, 0, 1), 0.0), 4)}
    c = Case("A3", duration=1e-6, step=1e-6, margin=margin, every=1e-6, contacts=True)
    c.material("m", 1000.0)
    c.pair("m", "m", stiffness=k, restitution=1.0, pull_off=force, adhesion_range=s)
    c.mesh("coarse", meshes.box((1, 1, 1)))
    c.mesh("fine", meshes.box((1, 1, 1), 4))
    expected = []
    for x, (name, (q, features)) in enumerate(down.items()):
        for y, shape in enumerate(("coarse", "fine")):
            touch = 2 * margin - rotated(q, c.solids[shape][0])[:, 2].min()
            c.body(shape, "m", (3 * x, 3 * y, touch), orientation=q)
            expected.append((f"cube on its {name}, {shape}", features**.125))
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
