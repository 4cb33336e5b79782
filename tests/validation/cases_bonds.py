"""J: bonds. Beams and chains of cubes, one bond that breaks, what a bond keeps, a rock that shatters."""
import math
import os

import numpy

import meshes
from registry import case_of
from scene import Case, inverse, rotated

CASES = []
case = case_of(CASES)

YOUNG, H, DENSITY = 1e9, .01, 2500.0
MARGIN = 1e-4


def cubes(tools, name, duration, ratio, bond=None, density=DENSITY, **words):
    """A chain of cubes along x with centres H apart, bonded face to face. Their faces end a margin short, so that they are in touch; their mass is that
    of the whole cube."""
    c = Case(name, duration=duration, margin=MARGIN, **words)
    c.tables["contact"]["surface"] = "outside"   # pieces end a margin short
    cube = os.path.join(tools.scratch, "cube.shape.h5")
    tools.call("scree-mesher", "generate", "box", "--size", f"{H - 2 * MARGIN!r},{H!r},{H!r}", "-o", cube)
    c.shape_file("cube", cube)
    c.material("m", density * H / (H - 2 * MARGIN))
    c.pair("m", "m", stiffness=1e4, restitution=1.0)
    c.bond(between=["m", "m"], distance=3 * MARGIN, young=YOUNG, tangential_ratio=ratio, **(bond or {}))
    return c


@case("J1", "U", "cantilever of 11 cubes under a load at its end", "beam theory with shear, of cells: P/(EI) (l^3/3 - l h^2/12) + P l/(k_t h A)")
def j1(tools, report):
    count, load, area, inertia = 11, .01, H**2, H**4 / 12
    length = (count - 1) * H
    for ratio, value in ((1.0, 4.000e-6), (.25, 4.030e-6)):
        # a thick fluid takes the swing: the lowest frequency is 640 rad/s
        duration = .06
        c = cubes(tools, "J1", duration, ratio, every=duration)
        c.fluid = {"density": 1e-6, "viscosity": 27.0, "drag": "stokes"}
        for i in range(count):
            c.body("cube", "m", (i * H, 0, 0), **({"fixed": True} if i == 0 else {}), **({"force": (0, 0, -load)} if i == count - 1 else {}))
        run = report.run(c.run(tools))
        expected = load / (YOUNG * inertia) * (length**3 / 3 - length * H**2 / 12) + load * length / (ratio * YOUNG / H * H * area)
        report.check(f"deflection at the end, ratio {ratio:g}", -run.x[-1][-1, 2], expected, 1e-6)
        report.check(f"the same from the page of the specification, ratio {ratio:g}", -run.x[-1][-1, 2], value, 2e-4)


@case("J2", "U", "free chain of ten cubes: frequency of its first mode", "(2/h) sqrt(E/rho) sin(pi / 2N)")
def j2(tools, report):
    count, amplitude = 10, 1e-4
    expected = 2 / H * math.sqrt(YOUNG / DENSITY) * math.sin(math.pi / (2 * count)) / (2 * math.pi)
    periods = 20
    c = cubes(tools, "J2", periods / expected, 1.0, step=2e-7, every=1 / expected / 16)
    for i in range(count):
        c.body("cube", "m", (i * H, 0, 0), velocity=(amplitude * math.cos((i + .5) * math.pi / count), 0, 0))
    run = report.run(c.run(tools))
    # phase of displacement and velocity of the first cube, unwrapped
    x, v, omega = run.x[:, 0, 0] - run.x[0, 0, 0], run.v[:, 0, 0], 2 * math.pi * expected
    phase = numpy.unwrap(numpy.arctan2(omega * x, v))
    frequency = numpy.polyfit(run.times, phase, 1)[0] / (2 * math.pi)
    report.check("first frequency [Hz]", frequency, expected, 1e-5)
    report.check("the same from the page of the specification", expected, 3149.289, 1e-6)


@case("J5", "U", "one bond in tension breaks at its strength, and its energy goes to the fracture", "500 N, 50 um, 12.5 mJ")
def j5(tools, report):
    for share in (.999, 1.001):
        duration = .02
        c = cubes(tools, f"J5-{share:g}", duration, 1.0, {"tension": 5e6}, every=duration)
        c.fluid = {"density": 1e-6, "viscosity": 5000.0, "drag": "stokes"}   # the load comes slowly
        c.body("cube", "m", (0, 0, 0), fixed=True)
        c.body("cube", "m", (H, 0, 0), force=(share * 500, 0, 0))
        run = report.run(c.run(tools))
        report.check(f"bonds that hold {share:g} of 500 N", run.log["bonds"][-1], 1 if share < 1 else 0, 0, "absolute")
        if share < 1:
            report.check("stretch [m]", run.x[-1][1, 0] - H, share * 5e-5, 1e-6)
            report.check("energy of the bond [J]", run.log["bond"][-1], share**2 * .0125, 2e-6)
        else:
            report.check("energy that goes to the fracture [J]", run.log["fracture"][-1], .0125, 1e-3)


@case("J7", "U", "a bonded pair in free spin: no drift of energy or angular momentum; the same in a turned world", "conservation")
def j7(tools, report):
    def spin(name, turn, steps):
        c = cubes(tools, name, steps * 1e-6, .25, step=1e-6, every=steps * 1e-6 / 50)
        centre = rotated(turn, [(0, 0, 0), (H, 0, 0)])
        w = rotated(turn, (30.0, 200.0, 50.0))
        # turning as one about their middle, with a stretch and a twist of their own
        for i, x in enumerate(centre):
            own = rotated(turn, ((-1)**i * .05, .02, 0))
            c.body("cube", "m", x, orientation=turn, velocity=numpy.cross(w, x - centre.mean(axis=0)) + own,
                   angular_velocity=w + rotated(turn, ((-1)**i * 20.0, 0, 5.0)))
        return report.run(c.run(tools))
    steps = 1_000_000 if tools.size == "real" else 200_000
    straight = numpy.array([1.0, 0, 0, 0])
    run = spin("J7", straight, steps)
    log = run.log
    energy = log["kinetic_translational"] + log["kinetic_rotational"] + log["bond"]
    slope = numpy.polyfit(log["time"] / log["time"][-1], energy, 1)[0]
    report.at_most("energy of the bond as a share of what moves: the test is none without", -log["bond"].max() / energy[0], 0)
    report.at_most("drift of the energy over the run, relative", abs(slope) / energy[0], 1e-4)
    side = numpy.array([H - 2 * MARGIN, H, H])
    mass = DENSITY * H**3
    inertia = mass / 12 * numpy.array([side[1]**2 + side[2]**2, side[0]**2 + side[2]**2, side[0]**2 + side[1]**2])

    def angular_momentum(f):
        total = numpy.zeros(3)
        for b in range(2):
            body = rotated(inverse(run.q[f][b]), run.w[f][b])
            total += mass * numpy.cross(run.x[f][b], run.v[f][b]) + rotated(run.q[f][b], inertia * body)
        return total
    first = angular_momentum(0)
    report.at_most("change of the angular momentum, relative", max(numpy.linalg.norm(angular_momentum(f) - first) for f in range(len(run.times)))
                   / numpy.linalg.norm(first), 1e-11)
    turn = numpy.array([.5, .5, -.5, .5])
    short = spin("J7-short", straight, 2000)
    turned = spin("J7-turned", turn, 2000)
    report.at_most("places in a turned world, turned back, over the size", numpy.abs(rotated(inverse(turn), turned.x[-1]) - short.x[-1]).max() / H, 1e-10)


@case("J9", "U", "two cubes as bonded polyhedra of exaDEM: where they part", "U >= 2 G A on four springs of 1e3 N/m: 2.19 mm; U >= G A: 1.55 mm")
def j9(tools, report):
    side, g, k, h = .98, 5e-3, 4e3, 1.0
    area = side**2
    for energy, stretch in ((2 * g, 2.19e-3), (g, 1.55e-3)):
        margin = .01
        c = Case("J9", duration=.5, margin=margin, step=2e-5, every=.5)
        c.tables["contact"]["surface"] = "outside"   # pieces end a margin short
        c.mesh("cube", meshes.box((side, side, side)))
        mass = 1.0
        c.material("m", mass / side**3)
        c.pair("m", "m", stiffness=1e3, restitution=1.0)
        # k_n A = k, with k_n = young / h
        c.bond(between=["m", "m"], distance=3 * margin, young=k / area * h, tangential_ratio=1.0, fracture_energy=energy)
        speed = math.sqrt(3 * energy * area / mass)   # half as much again as it takes to part them
        c.body("cube", "m", (0, 0, 0), fixed=True)
        c.body("cube", "m", (h, 0, 0), velocity=(speed, 0, 0))
        run = report.run(c.run(tools))
        held = run.log["fracture"][-1]
        report.check(f"stretch at which G = {energy:g} J/m^2 parts them [m]", math.sqrt(2 * held / k), stretch, 3e-3)
        report.check("energy that it took [J]", held, energy * area, 2e-3)
        report.check("speed that is left [m/s]", run.v[-1][1, 0], math.sqrt(speed**2 - 2 * held / mass), 1e-4)


def cut_rock(tools, name, cells, inset):
    """A rock of 2 cm and its pieces; gives their files."""
    rock, pieces = (os.path.join(tools.scratch, f"{name}{kind}.shape.h5") for kind in ("", "-pieces"))
    tools.call("scree-mesher", "generate", "rock", "--diameter", "2cm", "--triangles", "200", "--seed", "4", "-o", rock)
    tools.call("scree-mesher", "fracture", rock, "--cells", str(cells), "--seed", "2", "--evenly", "--inset", f"{inset!r} m", "-o", pieces)
    return rock, pieces


@case("J8", "U", "a cut body dropped unbroken, against the uncut one: speeds after the impact", "the same body without cuts; restitution as requested")
def j8(tools, report):
    margin, speed = 2e-4, .8

    def left(name, turn, restitution, height, shape, pieces=None):
        """Root of the share of the kinetic energy that an impact on a plane leaves, and the share that bonds hold after it."""
        duration = (height - .0075) / speed
        c = Case(name, duration=duration, margin=margin, every=duration)
        c.tables["contact"]["surface"] = "outside"   # pieces end a margin short
        c.gravity = (0, 0, 0)
        c.shape_file("body", shape, **({"pieces": pieces} if pieces else {}))
        c.material("stone", 2600.0)
        c.pair("stone", "stone", stiffness=4e5, restitution=restitution)
        if pieces:
            c.bond(within="stone", young=2e9)   # a contact lasts 22 times as long as a wave takes through the body
        c.body("body", "stone", (0, 0, height), orientation=turn, velocity=(0, 0, -speed))
        c.floor("stone")
        log = report.run(c.run(tools)).log
        kinetic = log["kinetic_translational"] + log["kinetic_rotational"]
        return math.sqrt(kinetic[-1] / kinetic[0]), log["bond"][-1] / kinetic[0] if pieces else 0.0

    rock, pieces = cut_rock(tools, "J8", 20, margin)
    turns = numpy.random.default_rng(1).normal(size=(4, 4))
    turns /= numpy.linalg.norm(turns, axis=1)[:, None]
    ratios = []
    for k, turn in enumerate(turns):
        for e in (1.0, .5) if k < 2 else (.5,):
            whole, cut = left("J8-whole", turn, e, .0125, rock)[0], left("J8-cut", turn, e, .0125, rock, pieces)[0]
            if e == 1:
                report.check(f"rock {k} of 20 cells, restitution 1: root of its energy, cut over whole", cut / whole, 1, .02)
            else:
                ratios.append(cut / whole)
    report.check("rocks, restitution 0.5: root of their energy, cut over whole, mean", float(numpy.mean(ratios)), 1, .03)
    report.check("the worst of them: where two or three pieces touch at once", max(ratios, key=lambda r: abs(r - 1)), 1, .05)
    box, pieces = (os.path.join(tools.scratch, f"J8-box{kind}.shape.h5") for kind in ("", "-pieces"))
    tools.call("scree-mesher", "generate", "box", "--size", "2cm,2cm,2cm", "-o", box)
    tools.call("scree-mesher", "fracture", box, "--cells", "20", "--seed", "2", "--evenly", "--inset", f"{margin!r} m", "-o", pieces)
    straight = numpy.array([1.0, 0, 0, 0])
    report.check("box on its face, whole, restitution 0.5", left("J8-box", straight, .5, .0105, box)[0], .5, .002)
    # each of n contacts for itself would have sqrt(n) times the damping ratio, and leave .36
    report.check("the same of 20 cells: several press at once, and are damped together", left("J8-box-cut", straight, .5, .0105, box, pieces)[0], .5, .03)


def thrown(tools, name, bond, speed, restitution=.5, duration=.004, contact=None):
    margin = 2e-4
    rock, pieces = cut_rock(tools, name, 20, margin)
    c = Case(name, duration=duration, margin=margin, every=duration / 40, contact=contact)
    c.tables["contact"]["surface"] = "outside"   # pieces end a margin short
    c.shape_file("rock", rock, pieces=pieces)
    c.material("stone", 2600.0)
    c.pair("stone", "stone", stiffness=2e6, restitution=restitution, friction=.5)
    c.bond(within="stone", young=4e9, **bond)   # faces hold more than contacts: a bond that breaks under pressure gives energy else
    c.body("rock", "stone", (0, 0, .012 + 3 * margin), velocity=(0, 0, -speed))
    c.floor("stone")
    return c.run(tools)


@case("J11", "U", "a rock that shatters on a floor: kinetic + elastic + bonds + fracture + dissipated", "conservation of energy")
def j11(tools, report):
    run = report.run(thrown(tools, "J11", {"tension": 1e6, "cohesion": 2e6, "friction_angle": math.radians(35)}, 4.0))
    log = run.log
    kinetic = (log["kinetic_translational"] + log["kinetic_rotational"])[0]
    broken = log["bonds"][0] - log["bonds"][-1]
    report.at_least("bonds that break", broken, 10)
    report.at_least("share of the energy that goes to the fracture", log["fracture"][-1] / kinetic, 1e-3)
    report.at_most("error of the balance over the kinetic energy", numpy.abs(log["energy_error"]).max() / kinetic, 1e-2)
    whole = report.run(thrown(tools, "J11-whole", {}, 4.0))
    report.check("bonds that break of a rock without strength given", whole.log["bonds"][0] - whole.log["bonds"][-1], 0, 0, "absolute")
