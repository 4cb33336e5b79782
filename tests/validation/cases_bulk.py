"""B: packings, silos, entangled columns against published experiments (validation plan 1.7 N6, 1.8), means with 95 % confidence over seeds.

Sizes: `small` takes minutes and shows the trend with the walls and the noise of a small sample; `real` is that of the experiments.
"""
import math

import numpy
from scipy import stats
from scipy.optimize import curve_fit

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)
G = cf.GRAVITY


def confident(values):
    """Mean and half width of its 95 % confidence interval (Student)."""
    values = numpy.asarray(values, float)
    return values.mean(), stats.t.ppf(.975, len(values) - 1) * values.std(ddof=1) / math.sqrt(len(values))


# --- pouring: bodies at random in a column that is periodic sideways fall on a floor
def contact_for(mass, fall, margin):
    """Stiffness for which a central impact after a fall of that height uses up all but a fifth of both margins; impacts in a crowd
    use half of it."""
    return .5 * mass * 2 * G * fall / (.8 * 2 * margin) ** 2


def poured(tools, report, name, mesh, mu, seed, count, side, restitution=.3):
    """Bodies of volume 1e-6 m^3 / their mesh's; gives the run. side: of the column, in diameters of equal volume."""
    d = (6 / math.pi * meshes.mass_properties(mesh)[0]) ** (1 / 3)
    margin, density = .02 * d, 2500.0
    height = 3.2 * count * d / side**2 * .5236 / .5 + 2 * d  # placed at a third of the space
    duration = 5 * math.sqrt(2 * height / G)
    c = Case(name, duration=duration, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=duration / 10, contacts=True, seed=seed,
             domain={"min": [0, 0, -d], "max": [side * d, side * d, height + 2 * d], "periodic": ["x", "y"]})
    c.mesh("grain", mesh)
    c.material("m", density)
    c.pair_all(stiffness=contact_for(density * d**3 * math.pi / 6, .5 * height, margin), restitution=restitution, friction=mu)
    c.population(shape="grain", material="m", count=count, region={"box": [[0, 0, .1 * d], [side * d, side * d, height]]})
    c.floor("m")
    return report.run(c.run(tools, timeout=3600)), margin


def solid_fraction(run, mesh, area):
    """Of the middle of a bed, from the slope of the count over height."""
    volume = meshes.mass_properties(mesh)[0]
    z = numpy.sort(run.x[-1, :, 2])
    middle = slice(int(.2 * len(z)), int(.8 * len(z)))
    rank = numpy.arange(len(z))[middle]
    return numpy.polyfit(z[middle], rank, 1)[0] * volume / area


def coordination(run):
    """Neighbours that press, per body of the middle of the bed that is held (more than one neighbour)."""
    last, z = run.contacts[-1], run.x[-1, :, 2]
    pressed = last["normal_force"] > 0
    pairs = {(a, b) for a, b in zip(last["body_a"][pressed], last["body_b"][pressed])}
    index, degree = {body: i for i, body in enumerate(run.ids)}, numpy.zeros(len(z))
    for a, b in pairs:
        for body in (a, b):
            if body in index:
                degree[index[body]] += 1
    low, high = numpy.quantile(z, [.2, .8])
    inside = (z > low) & (z < high) & (degree > 1)
    return degree[inside].mean()


@case("B1", "W", "spheres poured without and with friction: solid fraction, contacts", "Scott and Kilgour 1969; Onoda and Liniger 1990; isostatic: Z = 6")
def b1(tools, report):
    count, side, level, seeds = tools.sized((120, 4.5, 2, 5), (2000, 10, 3, 5))
    mesh = meshes.icosphere(level, .005)
    d = (6 / math.pi * meshes.mass_properties(mesh)[0]) ** (1 / 3)
    fractions, neighbours = {}, {}
    for mu in (0.0, .8):
        values = []
        for seed in range(seeds):
            run, margin = poured(tools, report, f"B1-{mu:g}-{seed}", mesh, mu, seed, count, side)
            values.append((solid_fraction(run, mesh, (side * d) ** 2), coordination(run)))
        fractions[mu], neighbours[mu] = (confident(column) for column in zip(*values))
        print(f"    mu = {mu:g}: solid fraction {fractions[mu][0]:.4f} +- {fractions[mu][1]:.4f}, neighbours {neighbours[mu][0]:.3f} +- {neighbours[mu][1]:.3f}")
    note = f"{seeds} seeds of {count}, 95 % confidence"
    report.check("frictionless: solid fraction", fractions[0.0][0], .64, .01 + fractions[0.0][1], "absolute", f"+- {fractions[0.0][1]:.3f}, {note}")
    report.check("frictionless: neighbours without rattlers", neighbours[0.0][0], 6.0, .3, "absolute", f"+- {neighbours[0.0][1]:.2f}")
    report.check("mu = 0.8: solid fraction, poured loosely", fractions[.8][0], .57, .02 + fractions[.8][1], "absolute", f"+- {fractions[.8][1]:.3f}; loosest 0.55")
    report.at_most("mu = 0.8: neighbours", neighbours[.8][0], 5.2)


def platonic(name):
    """Of unit circumradius: convex hull of its vertices, faces outward."""
    from scipy.spatial import ConvexHull
    g = (1 + math.sqrt(5)) / 2
    signs = (-1, 1)
    cube = [(x, y, z) for x in signs for y in signs for z in signs]
    even = [(0, a, b * g) for a in signs for b in signs]
    vertices = {"tetrahedron": [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], "cube": cube,
                "octahedron": [tuple(s * (i == axis) for i in range(3)) for axis in range(3) for s in signs],
                "icosahedron": [tuple(v[(i + shift) % 3] for i in range(3)) for v in even for shift in range(3)],
                "dodecahedron": cube + [tuple(v[(i + shift) % 3] for i in range(3)) for v in [(0, a / g, b * g) for a in signs for b in signs] for shift in range(3)]}[name]
    v = numpy.array(vertices, float)
    v /= numpy.linalg.norm(v, axis=1)[:, None]
    hull = ConvexHull(v)
    t = hull.simplices.copy()
    for i, (a, b, c) in enumerate(t):
        if numpy.cross(v[b] - v[a], v[c] - v[a]) @ (v[a] + v[b] + v[c]) < 0:
            t[i] = (a, c, b)
    return v, t


def dice(tools, report, name, mu, published, seeds, count, side):
    """Mean solid fraction of poured dice of every shape, with its confidence."""
    results = {}
    for shape in published:
        v, t = platonic(shape)
        volume = meshes.mass_properties((v, t))[0]
        mesh = meshes.rounded(v * (math.pi / 6 * .01**3 / volume) ** (1 / 3)), t
        d = (6 / math.pi * meshes.mass_properties(mesh)[0]) ** (1 / 3)
        values = []
        for seed in range(seeds):
            run, margin = poured(tools, report, f"{name}-{shape}-{seed}", mesh, mu, seed, count, side)
            values.append(solid_fraction(run, mesh, (side * d) ** 2))
        results[shape] = confident(values)
        print(f"    {shape}, mu = {mu:g}: solid fraction {results[shape][0]:.4f} +- {results[shape][1]:.4f}")
    return results


@case("B2", "W", "Platonic dice poured with friction: between the loosest and the densest measured", "Baker and Kudrolli 2010")
def b2(tools, report):
    count, side, seeds = tools.sized((120, 4.5, 5), (2000, 10, 5))
    published = {"tetrahedron": (.51, .64), "cube": (.54, .67), "octahedron": (.52, .64), "dodecahedron": (.51, .63), "icosahedron": (.50, .59)}
    for shape, (mean, half) in dice(tools, report, "B2", .5, published, seeds, count, side).items():
        low, high = published[shape]
        report.check(f"{shape}: solid fraction", mean, (low + high) / 2, (high - low) / 2 + .01 + half, "absolute", f"+- {half:.3f}; measured {low} to {high}")


@case("B3", "W", "Platonic bodies poured without friction: densest random packings", "Jiao and Torquato 2011; Jaoshvili et al. 2010")
def b3(tools, report):
    count, side, seeds = tools.sized((120, 4.5, 3), (2000, 10, 5))
    published = {"tetrahedron": .763, "octahedron": .697, "dodecahedron": .716, "icosahedron": .707}
    for shape, (mean, half) in dice(tools, report, "B3", 0.0, published, seeds, count, side).items():
        report.check(f"{shape}: solid fraction", mean, published[shape], .02 + half, "absolute", f"+- {half:.3f}")


@case("B4", "W", "silo: the load on the bottom saturates as Janssen says", "Janssen 1895; Vanel and Clement 1999")
def b4(tools, report):
    d, mu, density = .006, .5, 2500.0
    # what a bottom of thirty grains carries is its own from packing to packing: few grains across need several
    ratio, fills, seeds = tools.sized((6, (.5, 1.0, 2.0, 3.5), 5), (15, (.5, 1.0, 2.0, 3.0, 4.5), 1))
    D, margin = ratio * d, .02 * d
    area, mass = math.pi / 4 * D**2, density * math.pi / 6 * d**3
    loads, masses = [], []
    for fill in fills:
        count = int(.58 * fill * D * area / (math.pi / 6 * d**3))
        height = 2.0 * fill * D + 2 * d  # placed at 0.29 of the space
        settle = 6 * math.sqrt(2 * height / G)
        down = 2 * d  # the bottom is let down slowly, which turns all friction of the walls upwards
        carried = []
        for seed in range(1, seeds + 1):
            c = Case(f"B4-{fill:g}-{seed}", duration=2 * settle, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=settle / 5, seed=seed)
            c.sphere("grain", d / 2)
            c.material("m", density)
            c.material("wall")
            c.pair_all(stiffness=contact_for(mass, .6 * height, margin), restitution=.3, friction=mu)
            c.population(shape="grain", material="m", count=count, region={"box": [[-.33 * D, -.33 * D, .5 * d], [.33 * D, .33 * D, height * 1.9]]})
            bottom = c.floor("wall", motion={"translate": {"velocity": [0, 0, -.05 * down / settle]}, "start": settle})
            c.wall({"cylinder_inside": {"start": [0, 0, -10 * d], "end": [0, 0, 2.5 * height + 10 * d], "radius": D / 2}}, "wall")
            run = report.run(c.run(tools, timeout=3600))
            late = run.log["time"] > 1.6 * settle
            carried.append(-run.wall_column(bottom, "force")[late, 2].mean())
        masses.append(count * mass)
        loads.append(numpy.mean(carried))
        shares = numpy.array(carried) / (masses[-1] * G)
        print(f"    {count} spheres, {fill:g} D high: bottom carries {shares.mean():.3f} of the weight (" + ", ".join(f"{s:.3f}" for s in shares) + ")", flush=True)
    masses, loads = numpy.array(masses), numpy.array(loads) / G
    # a silo that carries by its walls alone beyond the saturation mass: one unknown
    (saturation,), _ = curve_fit(lambda m, s: s * (1 - numpy.exp(-m / s)), masses, loads, p0=[masses[-1] / 2])
    fitted = saturation * (1 - numpy.exp(-masses / saturation))
    r2 = 1 - ((loads - fitted) ** 2).sum() / ((loads - loads.mean()) ** 2).sum()
    report.at_least("R^2 of the exponential", r2, .98)
    report.at_most("tallest fill: share of the weight on the bottom", loads[-1] / masses[-1], .6)
    bulk = .58 * density
    K = D * bulk * area / (4 * mu * saturation)
    report.check("Janssen's K = D / (4 mu lambda)", K, .6, .4, "absolute", f"saturates at {saturation * G / area:.0f} Pa; 0.3 to 1 in experiments")


@case("N6", "W", "column of U-shaped particles on a shaken floor: arms of 0.4 of the width entangle most", "Gravish et al. 2012")
def n6(tools, report):
    width, thick, density, margin = .012, .0012, 2500.0, 1e-4
    count, seeds, shaken = tools.sized((60, 3, 1.0), (400, 5, 10.0))
    fallen = {}
    for ratio in (.1, .4, .8):  # arm beyond the web over width
        mesh = meshes.centred(meshes.prism(meshes.u_outline(width, thick + ratio * width, thick), thick))
        volume = meshes.mass_properties(mesh)[0]
        values = []
        for seed in range(seeds):
            half = .02 * (count / 60) ** (1 / 3)  # of the column
            height = count * volume / .02 / (4 * half**2) + width  # placed at 2 %, they fall and entangle
            settle = 2.5 * math.sqrt(2 * height / G)
            k = density * volume * 2 * G * .7 * height / (.4 * 2 * margin) ** 2
            c = Case(f"N6-{ratio}-{seed}", duration=settle + shaken, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.05, seed=seed)
            c.mesh("staple", mesh)
            c.material("m", density)
            c.pair_all(stiffness=k, restitution=.3, friction=.5)
            c.population(shape="staple", material="m", count=count, region={"box": [[-half, -half, .001], [half, half, height]]})
            # two times gravity at 30 Hz, from when the sides are drawn back
            c.floor(motion={"oscillate": {"direction": [0, 0, 1], "amplitude": 2 * G / (2 * math.pi * 30) ** 2, "frequency": 30.0, "phase": 0}, "start": settle})
            for axis in (0, 1):
                for side in (-1, 1):
                    out = [side * 2.0 * (i == axis) for i in range(3)]
                    c.wall({"plane": {"point": [side * half * (i == axis) for i in range(3)], "normal": [-float(side * (i == axis)) for i in range(3)]}}, "m",
                           motion={"translate": {"velocity": out}, "start": settle})
            run = report.run(c.run(tools, timeout=3600))
            level = run.x[..., 2].mean(axis=1)
            before = level[run.times >= settle][0]
            values.append(1 - level[-1] / before)
        fallen[ratio] = confident(values)
        print(f"    l/w = {ratio}: the centre has sunk by {fallen[ratio][0]:.3f} +- {fallen[ratio][1]:.3f} of its height")
    for ratio in (.1, .8):
        report.at_least(f"sinks less at l/w = 0.4 than at {ratio}: ratio of the sinking", fallen[ratio][0] / max(fallen[.4][0], 1e-12), 1.0,
                        f"+- {fallen[ratio][1] / fallen[ratio][0]:.0%}, {seeds} seeds of {count}")
