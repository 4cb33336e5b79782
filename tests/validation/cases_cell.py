"""Z: periodic cells under stress and strain. Closed forms of crystals, of a free body, the work of the cell, and its control."""
import math

import numpy

from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)

# cells of a crystal: places of its bodies over the edge of the cell, distance of neighbours over that edge, p d^2 / (k (2 R - d))
CRYSTALS = {
    "simple cubic": ([(0, 0, 0)], 1.0, 1.0),
    "body-centred": ([(0, 0, 0), (0.5, 0.5, 0.5)], math.sqrt(3) / 2, math.sqrt(3)),
    "face-centred": ([(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)], math.sqrt(0.5), 2 * math.sqrt(2)),
}


def crystal(name, cells, radius, distance, k, duration=1e-5, step=1e-5, **more):
    """Balls in their places, so far apart, in so many cells along each axis; the domain begins away from the origin."""
    places, ratio, _ = CRYSTALS[name]
    edge = distance / ratio
    corner = numpy.array([0.3, -0.2, 0.1]) * edge
    c = Case(f"{name.replace(' ', '-')}-{cells}", duration=duration, step=step, margin=0, every=duration,
             domain={"min": list(corner), "max": list(corner + cells * edge), "periodic": ["x", "y", "z"]}, **more)
    c.cell = {}
    c.sphere("ball", radius)
    c.material("m", 2500.0)
    c.pair_all(stiffness=k, restitution=1.0, friction=0.0)
    for at in numpy.ndindex(cells, cells, cells):
        for place in places:
            c.body("ball", "m", corner + edge * (numpy.array(at) + place + 0.1))
    return c


def pressure(log, row=0):
    return sum(log[f"stress_{a}{a}"][row] for a in "xyz") / 3


@case("Z1", "U", "crystals of balls at rest in a periodic cell", "p = c k (2 R - d) / d^2, K = c k (4 R - d) / (3 d^2), c = 1, sqrt(3), 2 sqrt(2) (z n d^3 / 6)")
def z1(tools, report):
    radius, k = 0.01, 1e4
    for name, (_, _, factor) in CRYSTALS.items():
        for cells in (3, 4):
            distance = 2 * radius * (1 - 5e-3)   # within what starts may overlap
            run = report.run(crystal(name, cells, radius, distance, k).run(tools))
            expected = factor * k * (2 * radius - distance) / distance**2
            # places are rounded to 1e-17 m, of overlaps of 1e-4 m: 1e-13
            for a in "xyz":
                report.check(f"{name}, {cells} cells: stress along {a} [Pa]", run.log[f"stress_{a}{a}"][0], expected, 1e-12)
            shear = max(abs(run.log[f"stress_{a}"][0]) for a in ("yz", "xz", "xy"))
            report.check(f"{name}, {cells} cells: shear stress, over the pressure", shear / expected, 0, 1e-12, "absolute")
        change = 1e-4
        values = [pressure(report.run(crystal(name, 3, radius, distance * (1 + s * change), k).run(tools)).log) for s in (1, -1)]
        bulk = -(values[0] - values[1]) / (6 * change)      # d ln V = 3 d ln d
        # the third derivative of p over d is some 20 p / d^3: 1e-8 of a difference over 1e-4
        report.check(f"{name}: bulk modulus from two cells [Pa]", bulk, factor * k * (4 * radius - distance) / (3 * distance**2), 1e-6)


@case("Z2", "U", "two balls that do not meet in a cell that shrinks", "u = u_0 h_0 / h; x / h from the integral of u / h; the error of the step is of second order")
def z2(tools, report):
    rates, duration, length, speed = numpy.array([2.0, -1.0, 0.5]), 0.2, 0.4, 0.05
    errors = []
    for steps in (1000, 2000):
        c = Case(f"Z2-{steps}", duration=duration, step=duration / steps, margin=0, every=duration,
                 domain={"min": [-length / 2] * 3, "max": [length / 2] * 3, "periodic": ["x", "y", "z"]})
        c.cell = {"strain_rate": dict(zip("xyz", rates))}
        c.sphere("ball", 0.005)
        c.material("m", 2500.0)
        c.pair_all(stiffness=50.0, restitution=1.0, friction=0.0)
        start = numpy.array([[0.05, 0.02, -0.03], [-0.06, -0.01, 0.04]])
        velocity = speed * numpy.array([1.0, 0.5, -0.7])
        for sign, x in zip((1, -1), start):
            c.body("ball", "m", x, velocity=sign * velocity)
        run = report.run(c.run(tools))
        stretch = numpy.exp(-rates * duration)               # h / h_0
        for k, a in enumerate("xyz"):
            # h is multiplied by g in each step, and keeps what rounding takes
            report.check(f"{steps} steps: length along {a}, over exp(-rate t)", run.log[f"cell_{a}"][-1] / length / stretch[k], 1, 1e-14)
            report.check(f"{steps} steps: strain along {a}", run.log[f"strain_{a}"][-1], rates[k] * duration, 1e-13)
        report.check(f"{steps} steps: velocity over u_0 h_0 / h", abs(run.v[-1][0] / (velocity / stretch) - 1).max(), 0, 1e-13, "absolute")
        way = velocity * numpy.expm1(2 * rates * duration) / (2 * rates)   # of x h_0 / h
        for sign, x, found in zip((1, -1), start, run.x[-1]):
            errors.append(abs(found - stretch * (x + sign * way)).max() / speed / duration)
        momentum = abs(run.v[-1].sum(axis=0)).max() / speed
        report.check(f"{steps} steps: momentum of both, over that of one", momentum, 0, 1e-14, "absolute")
        work = run.log["cell_work"][-1] / (run.log["kinetic_translational"][-1] - run.log["kinetic_translational"][0])
        report.check(f"{steps} steps: work of the cell over the gain of kinetic energy", work, 1, 4e-6 * (1000 / steps) ** 2)
    report.check("error of the way, 1000 steps over 2000", errors[0] / errors[2], 4, 2e-2, note="second order")
    report.at_most("error of the way, 2000 steps, of itself", errors[2], 1e-6)


def gas(name, step, duration, cell, count=60, restitution=1.0, friction=0.0, k=1e4, seed=5):
    """Balls that move in all directions; 0.3 of the cell is solid."""
    radius = 0.004
    width = (count * 4 / 3 * math.pi * radius**3 / 0.3) ** (1 / 3)
    c = Case(name, duration=duration, step=step, margin=0, every=duration / 20, seed=seed,
             domain={"min": [0, 0, 0], "max": [width] * 3, "periodic": ["x", "y", "z"]})
    c.cell = cell
    c.sphere("ball", radius)
    c.material("m", 2500.0)
    c.pair_all(stiffness=k, restitution=restitution, friction=friction)
    random = numpy.random.default_rng(seed)
    side = math.ceil(count ** (1 / 3))
    for n in range(count):
        at = numpy.array([n % side, n // side % side, n // side**2]) + 0.5 + 0.05 * random.uniform(-1, 1, 3)
        c.body("ball", "m", at * width / side, velocity=0.3 * random.normal(size=3), angular_velocity=20 * random.normal(size=3))
    return c, radius, width


def work_of_the_cell(tools, report, name, cell, least_ratio):
    """The energy balance of a gas in this cell at three steps; least_ratio is that of the errors of the largest and of the least."""
    for words, more in (("elastic", {}), ("with friction and damping", {"restitution": 0.6, "friction": 0.4})):
        errors = []
        for step in (2e-5, 1e-5, 5e-6) + (() if more else (5e-7,)):
            c, _, _ = gas(f"{name}-{words.split()[0]}-{step:g}", step, 0.05, cell, **more)
            run = report.run(c.run(tools))
            log = run.log
            errors.append(abs(log["energy_error"]).max() / abs(log["cell_work"][-1]))
        report.at_most(f"{words}: largest error of the balance over the work, step 5 us", errors[2], 2e-3)
        if not more:
            report.at_most(f"{words}: the same, step 0.5 us", errors[3], 1e-6)
        # chaos: another step gives other collisions, so that the ratio is that of two samples
        report.at_least(f"{words}: error of 20 us over that of 5 us", errors[0] / errors[2], least_ratio)
        start = log["kinetic_translational"][0] + log["kinetic_rotational"][0]
        report.at_least(f"{words}: work of the cell over the energy at the start", log["cell_work"][-1] / start, 0.1)


@case("Z3", "U", "a gas of balls is compressed: the work of the cell", "kinetic + elastic + dissipated - work stays the same; the error is of second order in the step")
def z3(tools, report):
    work_of_the_cell(tools, report, "Z3", {"strain_rate": {"x": 4.0, "y": 2.0, "z": 1.0}}, 6)


@case("Z4", "U", "balls under an isotropic pressure", "stresses reach their targets; the energy balance closes; the momentum stays 0")
def z4(tools, report):
    stress = {"x": 2e3, "y": 2e3, "z": 2e3}
    c, radius, _ = gas("Z4", None, 0.5, {"stress": stress, "stop_when": {"stress_error": 5e-3, "kinetic_ratio": 1e-3}}, count=200,
                       restitution=0.3, friction=0.3)
    c.tables["output"]["every"] = 2e-3
    run = report.run(c.run(tools))
    log = run.log
    report.at_most("time at which it is still, over the whole", run.times[-1] / 0.5, 0.9)
    for a in "xyz":
        report.check(f"stress along {a} [Pa]", log[f"stress_{a}{a}"][-1], stress[a], 5e-3)
    report.check("solid fraction", log["solid_fraction"][-1], 0.60, 0.05, note="friction 0.3, 200 balls: 0.58 to 0.62 (Agnolin and Roux 2007)")
    # rounding of 1e4 steps
    momentum = abs(run.v[-1].sum(axis=0)).max() / abs(run.v[0]).sum()
    report.check("momentum, over the sum of sizes at the start", momentum, 0, 1e-13, "absolute")
    balance = abs(log["energy_error"]).max() / abs(log["cell_work"][-1])
    report.at_most("error of the balance over the work", balance, 5e-3)
    rate = max(abs(numpy.diff(log[f"strain_{a}"]) / numpy.diff(log["time"])).max() for a in "xyz")
    inertial = rate * 2 * radius * math.sqrt(2500.0 / 2e3)
    report.at_most("largest inertial number on the way", inertial, 0.1)


@case("Z5", "U", "balls that are sheared for long at a constant lateral stress", "the lateral stress is the target, though the cell widens all the time; the balance closes")
def z5(tools, report):
    lateral = 2e3
    c, radius, _ = gas("Z5", None, 0.5, {"strain_rate": {"z": 2.0}, "stress": {"x": lateral, "y": lateral}}, count=200, restitution=0.3, friction=0.3)
    c.tables["output"]["every"] = 2e-3
    log = report.run(c.run(tools)).log
    late = log["strain_z"] > 0.5
    rate = -(log["strain_x"][late][-1] - log["strain_x"][late][0]) / (log["time"][late][-1] - log["time"][late][0])
    report.at_least("rate at which the cell widens along x [1/s]", rate, 0.5)
    mean = {a: numpy.trapz(log[f"stress_{a}{a}"][late], log["time"][late]) / (log["time"][late][-1] - log["time"][late][0]) for a in "xyz"}
    for a in "xy":
        # the stress of 200 balls scatters by a tenth as rows of them slip; over half a unit of strain
        report.check(f"mean stress along {a} [Pa]", mean[a], lateral, 0.03)
    report.at_least("mean stress along z over that across", mean["z"] / lateral, 1.5)
    report.at_most("error of the balance over the work", abs(log["energy_error"]).max() / abs(log["cell_work"][-1]), 5e-3)


@case("Z6", "U", "two free balls while their cell is sheared by 100 periods", "straight lines: x = x_0 + v t of any image, v = u_0 + L x_0; u = v - L x")
def z6(tools, report):
    rate, length, speed = 40.0, 0.4, numpy.array([0.05, 0.31, 0.0])
    step = 1.25e-5                                  # u_x reaches 31 m/s, and no body may move by more than a tenth of its radius
    duration = 100 / rate
    c = Case("Z6", duration=duration, step=step, margin=0, every=duration, domain={"min": [-length / 2] * 3, "max": [length / 2] * 3, "periodic": ["x", "y", "z"]})
    c.cell = {"strain_rate": {"xy": -rate}}         # the upper side moves along x
    c.sphere("ball", 0.005)
    c.material("m", 2500.0)
    c.pair_all(stiffness=50.0, restitution=1.0, friction=0.0)
    start = numpy.array([0.03, 0.05, 0.1])          # half a period apart along z, so that they never meet
    for sign in (1, -1):
        c.body("ball", "m", sign * start, velocity=sign * speed)
    run = report.run(c.run(tools))
    time = run.times[-1]
    report.check("shear h_xy over the length", run.log["cell_xy"][-1] / length, rate * time, 1e-13)
    report.check("shear strain", run.log["strain_xy"][-1], -rate * time, 1e-13)
    shear = rate * time * length
    velocity = speed + numpy.array([rate * start[1], 0, 0])
    # each step adds the same to u_x, and may round to the same side
    rounding = duration / step * 2.0**-53
    fastest = rate * speed[1] * duration            # change of u_x
    for sign, x, u in zip((1, -1), run.x[-1], run.v[-1]):
        way = sign * (start + velocity * time)
        off = x - way
        n = numpy.rint(off[1] / length)
        off -= n * numpy.array([shear, length, 0])
        off[0] -= length * numpy.rint(off[0] / length)
        report.check("distance from its straight line, over its way", abs(off).max() / numpy.linalg.norm(velocity * time), 0, rounding * 0.5 * fastest * time / numpy.linalg.norm(velocity * time), "absolute")
        report.at_least("periods crossed along y", abs(way[1]) / length, 1.5)
        report.check("u_x over v - L y", u[0] / (sign * velocity[0] - rate * way[1]), 1, rounding)
        report.check("u_y over its start", u[1] / (sign * speed[1]), 1, 1e-14)


@case("Z7", "U", "a gas of balls is sheared in three directions: the work of the cell", "kinetic + elastic + dissipated - work stays the same; the error is of second order in the step")
def z7(tools, report):
    work_of_the_cell(tools, report, "Z7", {"strain_rate": {"xy": 30.0, "xz": -12.0, "yz": 9.0, "z": 2.0}}, 5)


@case("Z8", "U", "face-centred crystal of balls, sheared a little", "C44 = k / (sqrt(2) d) at touch, for each of the three shears")
def z8(tools, report):
    radius, k, shear, duration = 0.01, 1e4, 1e-6, 1e-4
    overlap = 1e-5                                  # of d: above what the shear opens, d * shear / 2
    distance = 2 * radius * (1 - overlap)
    for part in ("yz", "xz", "xy"):
        c = crystal("face-centred", 3, radius, distance, k, duration=duration, step=1e-5)
        c.cell = {"strain_rate": {part: shear / duration}}
        run = report.run(c.run(tools))
        report.check(f"strain {part}", run.log[f"strain_{part}"][-1], shear, 1e-9)
        # stresses of the overlap turn with the cell: some parts of it
        report.check(f"C44 by {part} [Pa]", run.log[f"stress_{part}"][-1] / shear, k / (math.sqrt(2) * distance), 20 * overlap)
        others = max(abs(run.log[f"stress_{p}"][-1]) for p in ("yz", "xz", "xy") if p != part)
        report.check(f"other shear stresses, over that of {part}", others / run.log[f"stress_{part}"][-1], 0, 20 * overlap, "absolute")


@case("Z9", "U", "a column of balls in contact is sheared through half a period and a whole one", "contacts across the sides have the forces of those within, springs of friction included")
def z9(tools, report):
    radius, k = 0.01, 1e4
    distance = 2 * radius * (1 - 2e-3)
    cells = numpy.array([3, 60, 3])                 # a shear of 1 / 40 is half a period along x, and contacts open at 1 / 16
    corner = numpy.array([0.003, -0.002, 0.001])
    duration, rate = 2e-3, 27.5
    c = Case("Z9", duration=duration, step=2e-6, margin=0, every=duration / 60, contacts=True,
             domain={"min": list(corner), "max": list(corner + cells * distance), "periodic": ["x", "y", "z"]})
    c.cell = {"strain_rate": {"xy": rate}}
    c.sphere("ball", radius)
    c.material("m", 2500.0)
    c.pair_all(stiffness=k, restitution=1.0, friction=0.3)
    for at in numpy.ndindex(*cells):
        c.body("ball", "m", corner + distance * (numpy.array(at) + 0.1))
    run = report.run(c.run(tools))
    report.at_least("shear at the end, over the period along x", rate * duration * cells[1] / cells[0], 1.05)
    ratios, counts = [], []
    for contacts in run.contacts:
        along_y = abs(contacts["normal"][:, 1]) > 0.5
        force = numpy.linalg.norm(contacts["tangential_force"][along_y], axis=1)
        if len(force) and force.max() > 0:
            ratios.append(force.min() / force.max())
            counts.append(along_y.sum())
    # every ball is as every other: differences are rounding, of overlaps of 4e-5 m
    report.check("least over largest force of friction, over and within the sides", min(ratios, default=0), 1, 1e-6)
    report.check("contacts along y in each frame with friction", min(counts, default=0), numpy.prod(cells), 0)
    report.at_least("frames with friction", len(counts), 20)


@case("Z10", "U", "a layer of balls between two planes: the plane cell", "s_xx = s_yy = sqrt(3) k (2 R - d) / (d H), s_zz = 2 k e / (sqrt(3) d^2); C11 = 3 sqrt(3) k / (4 H), C66 = sqrt(3) k / (4 H) at touch")
def z10(tools, report):
    # rows along x of a triangular lattice, each half a distance beside the last; e is the overlap with each plane
    radius, k, rows = 0.01, 1e4, 6
    height = 2 * radius * (1 - 1e-3)

    def layer(overlap, duration, **cell):
        distance = 2 * radius * (1 - overlap)
        corner = numpy.array([0.003, -0.002, 0.001])
        size = numpy.array([rows * distance, rows * math.sqrt(3) / 2 * distance, height])
        c = Case("Z10-" + "-".join([f"{overlap:g}", *cell.get("strain_rate", {})]), duration=duration, step=1e-5, margin=0, every=duration,
                 domain={"min": list(corner), "max": list(corner + size), "periodic": ["x", "y"]})
        c.cell = dict(cell)
        c.sphere("ball", radius)
        c.material("m", 2500.0)
        c.material("plane", 2500.0)
        c.pair("m", "m", stiffness=k, restitution=1.0, friction=0.0)
        c.pair("m", "plane", stiffness=k, restitution=1.0, friction=0.0)
        for z, normal in ((corner[2], 1), (corner[2] + height, -1)):
            c.wall({"plane": {"point": [0, 0, z], "normal": [0, 0, normal]}}, "plane")
        for i, j in numpy.ndindex(rows, rows):
            c.body("ball", "m", corner + [(i + 0.5 * (j % 2) + 0.2) * distance, (j + 0.3) * math.sqrt(3) / 2 * distance, height / 2])
        return report.run(c.run(tools)), distance

    run, distance = layer(5e-3, 1e-5)
    expected = math.sqrt(3) * k * (2 * radius - distance) / (distance * height)
    for a in "xy":
        report.check(f"stress along {a} [Pa]", run.log[f"stress_{a}{a}"][0], expected, 1e-12)
    pressed = k * (radius - height / 2) * 2 / (math.sqrt(3) * distance**2)
    report.check("stress along z, by the planes [Pa]", run.log["stress_zz"][0], pressed, 1e-11)      # of overlaps of 1e-5 m
    shears = max(abs(run.log[f"stress_{a}"][0]) for a in ("yz", "xz", "xy"))
    report.check("shear stress, over the pressure", shears / expected, 0, 1e-12, "absolute")

    small, duration, overlap = 1e-6, 1e-4, 1e-5      # the overlap is above what the shear opens
    for part, row, modulus in (("x", "xx", 3 * math.sqrt(3) / 4), ("x", "yy", math.sqrt(3) / 4), ("y", "yy", 3 * math.sqrt(3) / 4), ("xy", "xy", math.sqrt(3) / 4)):
        run, distance = layer(overlap, duration, strain_rate={part: small / duration})
        change = run.log[f"stress_{row}"][-1] - run.log[f"stress_{row}"][0]
        # stresses of the overlap turn and grow with the cell: some parts of it
        report.check(f"stress {row} over strain {part} [Pa]", change / small, modulus * k / height, 20 * overlap)


@case("Z11", "U", "a crystal of balls is sheared to and fro by a table", "strain: the integral of the table; stress_xy = C44 times it, C44 = k / (sqrt(2) d) at touch")
def z11(tools, report):
    radius, k, small, duration, overlap = 0.01, 1e4, 1e-6, 1e-3, 1e-5
    distance = 2 * radius * (1 - overlap)
    rate = small / duration
    table = {"time": [0.0, 0.25 * duration, 0.75 * duration], "rate": [4 * rate, 4 * rate, -6 * rate]}
    c = crystal("face-centred", 3, radius, distance, k, duration=duration, step=1e-6)
    c.tables["output"]["every"] = duration / 8
    c.cell = {"strain_rate": {"xy": table}}
    run = report.run(c.run(tools))
    expected = []
    for t in run.log["time"]:
        t = min(t, duration)
        slope = -10 * rate / (0.5 * duration)
        middle = min(max(t - 0.25 * duration, 0), 0.5 * duration)
        expected.append(4 * rate * min(t, 0.25 * duration) + 4 * rate * middle + 0.5 * slope * middle**2 - 6 * rate * max(t - 0.75 * duration, 0))
    expected = numpy.array(expected)
    assert len(expected) >= 9 and expected.max() > 1.35 * small and expected.min() < -0.9 * small, expected
    report.check("strain xy, less the integral of the table, over its largest", numpy.abs(run.log["strain_xy"] - expected).max() / small, 0, 1e-9, "absolute")
    report.check("stress xy over the strain, less C44, over C44", numpy.abs(run.log["stress_xy"] * math.sqrt(2) * distance / k - expected).max() / small, 0, 40 * overlap, "absolute")


@case("Z12", "U", "a crystal of balls on its close-packed planes: a shear whose stress is held at 0", "strain yz = strain x / sqrt(8): stiffness of the cubic crystal at touch, turned so that [111] is along z")
def z12(tools, report):
    radius, k, small, overlap = 0.01, 1e4, 1e-6, 1e-4
    distance = 2 * radius * (1 - overlap)
    numbers = numpy.array([4, 2, 2])
    edges = distance * numpy.array([1, math.sqrt(3), math.sqrt(6)])    # layers A, B, C, each over the gaps of the last
    corner = numpy.array([0.003, -0.002, 0.001])
    duration = 2.4                                  # 1000 times that of a contact: what is damped has gone
    c = Case("Z12", duration=duration, step=2e-4, margin=0, every=duration, domain={"min": list(corner), "max": list(corner + numbers * edges), "periodic": ["x", "y", "z"]})
    c.cell = {"strain_rate": {"x": {"time": [0, 0.5 * duration, 0.5001 * duration], "rate": [2 * small / duration, 2 * small / duration, 0.0]}}, "stress": {"yz": 0.0}}
    c.sphere("ball", radius)
    c.material("m", 2500.0)
    c.pair_all(stiffness=k, restitution=1.0, friction=0.0)
    for at in numpy.ndindex(*numbers):
        for layer in range(3):
            for place in ((0, 0), (0.5, 0.5)):
                x, y = place[0] * edges[0], place[1] * edges[1] + layer * distance / math.sqrt(3)
                c.body("ball", "m", corner + numpy.array(at) * edges + [0.2 * distance + x, 0.1 * distance + y % edges[1], (layer + 0.3) * math.sqrt(2 / 3) * distance])
    run = report.run(c.run(tools))
    # cubic axes in the frame of the cell, and the stiffness in k / d: C12 and C44 are 1 / sqrt(2), and the part of the axes -1 / sqrt(2)
    axes = numpy.array([[1 / math.sqrt(2), 1 / math.sqrt(6), 1 / math.sqrt(3)], [-1 / math.sqrt(2), 1 / math.sqrt(6), 1 / math.sqrt(3)], [0, -2 / math.sqrt(6), 1 / math.sqrt(3)]])
    coupling = -(axes[:, 1] * axes[:, 2] * axes[:, 0] ** 2).sum()
    shear = 1 - (axes[:, 1] ** 2 * axes[:, 2] ** 2).sum()
    assert abs(-coupling / shear - 1 / math.sqrt(8)) < 1e-12
    report.check("strain x", run.log["strain_x"][-1], small * 1.0001, 1e-9)
    report.check("strain yz over strain x", run.log["strain_yz"][-1] / run.log["strain_x"][-1], 1 / math.sqrt(8), 20 * overlap)
    pressure = max(abs(run.log[f"stress_{a}{a}"][-1]) for a in "xyz")
    report.check("stress yz, over the largest normal stress", run.log["stress_yz"][-1] / pressure, 0, 1e-4, "absolute")
    report.check("the other shears", max(abs(run.log[f"strain_{p}"][-1]) for p in ("xz", "xy")), 0, 0, "absolute")


@case("Z13", "U", "stiffness of crystals of balls at touch", "C11, C12, C44 in k / d: simple cubic 1, 0, 0; body-centred 1 / sqrt(3) each; face-centred sqrt(2), 1 / sqrt(2), 1 / sqrt(2)")
def z13(tools, report):
    radius, k, small, overlap = 0.01, 1e4, 1e-6, 1e-5    # the overlap is above what the strain opens
    distance = 2 * radius * (1 - overlap)
    expected = {"simple cubic": (1, 0, 0), "body-centred": (1 / math.sqrt(3),) * 3, "face-centred": (math.sqrt(2), 1 / math.sqrt(2), 1 / math.sqrt(2))}
    for name, (c11, c12, c44) in expected.items():
        # stresses of the overlap turn and grow with the cell: some parts of it. Ten steps, since two of the crystals are unstable without friction
        tolerance = 20 * overlap
        for part, row, value in (("x", "xx", c11), ("x", "yy", c12), ("xy", "xy", c44)):
            c = crystal(name, 3, radius, distance, k, duration=1e-4, step=1e-5)
            c.cell = {"strain_rate": {part: small / 1e-4}}
            run = report.run(c.run(tools))
            stress = (run.log[f"stress_{row}"][-1] - run.log[f"stress_{row}"][0]) / small
            report.check(f"{name}: stress {row} over strain {part}, in k / d", stress * distance / k, value, tolerance, "absolute")
