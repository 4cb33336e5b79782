"""F: friction and rolling (validation plan 1.4)."""
import math

import numpy

import closed_forms as cf
import meshes
from cases_rotation import product
from registry import case_of
from scene import Case, inverse, quaternion, rotated

CASES = []
case = case_of(CASES)
G = cf.GRAVITY


def rest_height(half, margin, mass, k, load=1.0, corners=4):
    """Centre of a block at rest on its corners: U = k n^(1/4) d^2 / 2."""
    return half - load * mass * G / (k * corners**.25)


class Incline:
    """A flat mesh plate as a wall, turned down by alpha about y (downhill is +x of the plate), centred at `place`."""

    def __init__(self, c, alpha, place, size, material="floor"):
        self.q = quaternion((0, 1, 0), alpha)
        self.place = numpy.asarray(place, float)
        c.mesh_wall(meshes.plate(size), material, position=list(self.place), orientation=list(self.q))

    def point(self, x, z, y=0.0):
        return self.place + rotated(self.q, numpy.array([x, y, z]))

    def along(self, vectors):
        """Components (downhill, across, out) of world vectors."""
        return rotated(inverse(self.q), vectors)


@case("F1", "U", "block on an incline sticks below and slides above the friction angle")
def f1(tools, report):
    mu, k, margin, mass, half = .5, 1e4, .002, 1.0, .05
    c = Case("F1", duration=62.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.5)
    c.mesh("block", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)
    c.material("floor")
    c.pair_all(stiffness=k, restitution=.2, friction=mu)
    angles = [26.0, 26.5, 26.6, 27.0]
    inclines = []
    for i, degrees in enumerate(angles):
        alpha = math.radians(degrees)
        # slides up to a g sin dtheta t^2 / 2 = 200 m: plates that are long enough, side by side in height
        s = Incline(c, alpha, (0, 0, 600.0 * i), 500.0)
        c.body("block", "m", s.point(0, rest_height(half, margin, mass, k, math.cos(alpha))), orientation=s.q)
        inclines.append(s)
    run = report.run(c.run(tools, timeout=300))
    for i, (degrees, s) in enumerate(zip(angles, inclines)):
        x = s.along(run.x[:, i] - s.place)
        v = numpy.linalg.norm(run.v[:, i], axis=1)
        if degrees < math.degrees(math.atan(mu)):
            settled = run.times >= 15  # the sudden load makes it slide a little, and near the limit it stops slowly
            report.at_most(f"{degrees} degrees: speed after settling [m/s]", v[settled].max(), 1e-9)
            report.at_most(f"{degrees} degrees: creep in 60 s [m]", abs(x[-1, 0] - x[settled][0, 0]), 1e-9)
        else:
            a = G * (math.sin(math.radians(degrees)) - mu * math.cos(math.radians(degrees)))
            late = run.times >= 5
            measured = numpy.polyfit(run.times[late], s.along(run.v[:, i])[late, 0], 1)[0]
            report.check(f"{degrees} degrees: slides with g (sin - mu cos) [m/s^2]", measured, a, 1e-3)


@case("F2", "U", "block sliding down 30 degrees")
def f2(tools, report):
    mu, alpha, k, margin, mass, half = .2, math.radians(30), 1e6, .0002, 1.0, .05
    c = Case("F2", duration=1.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.1)
    c.mesh("block", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)
    c.material("floor")
    c.pair_all(stiffness=k, restitution=.3, friction=mu)
    s = Incline(c, alpha, (0, 0, 0), 8.0)
    c.body("block", "m", s.point(-1, rest_height(half, margin, mass, k, math.cos(alpha))), orientation=s.q)
    run = c.run(tools)
    x = s.along(run.x[:, 0] - s.place)[:, 0]
    v = s.along(run.v[:, 0])[:, 0]
    report.run(run, error_traj=abs(x[-1] - x[0] - 1.602929))
    a = (v[-1] - v[2]) / (run.times[-1] - run.times[2])
    report.check("acceleration [m/s^2]", a, 3.205858, 1e-3)
    report.check("x(1 s) [m]", x[-1] - x[0], 1.602929, 1e-3)


def thrown_blocks(tools, name, angles, locked, k=1e6, margin=.0002, duration=1.3, every=.01):
    """Blocks on a plane thrown with 2 m/s, mu = 0.2, each turned into its direction when not locked."""
    mass, half = 1.0, .05
    c = Case(name, duration=duration, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=every)
    c.mesh("block", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.3, friction=.2)
    for i, angle in enumerate(angles):
        c.body("block", "m", (8 * math.cos(angle), 8 * math.sin(angle), rest_height(half, margin, mass, k)), velocity=(2 * math.cos(angle), 2 * math.sin(angle), 0),
               orientation=quaternion((0, 0, 1), 0 if locked else angle), lock_rotation=locked)
    c.floor()
    return c.run(tools)


@case("F3", "U", "block thrown along a plane stops")
def f3(tools, report):
    # frames close enough to see how it springs back as it stops: half a period of its friction springs is 6 ms
    run = thrown_blocks(tools, "F3", [0.0], locked=False, every=2.5e-3)
    x = run.x[:, 0, 0] - run.x[0, 0, 0]
    v = run.v[:, 0, 0]
    expected = 2 * 2 / (2 * .2 * G)
    report.run(run, error_traj=abs(x[-1] - expected))
    report.check("stopping distance [m]", x[-1], expected, 1e-3)
    moving = (run.times > .1) & (run.times < .9)
    slope, start = numpy.polyfit(run.times[moving], v[moving], 1)
    report.check("time of the stop, from the line of the speed [s]", -start / slope, 2 / (.2 * G), 1e-3)
    report.at_most("velocity reversal over v0", max(0.0, -v.min()) / 2, 1e-6)
    report.at_most("speed at the end [m/s]", numpy.linalg.norm(run.v[-1, 0]), 1e-6)


@case("F8", "U", "rolling resistance of constant moment brakes a rolling ball", "LAMMPS granular test suite; VALIDATION F8")
def f8(tools, report):
    R, k, mu_r, w0 = .1, 1e6, .02, 10.0
    mass = 1000 * 4 / 3 * math.pi * R**3
    c = Case("F8", duration=1.0, steps_per_contact=30, gravity=(0, 0, -G), margin=2e-4, every=.02)
    c.sphere("ball", R)
    c.material("m", 1000.0)
    # friction is high, so it rolls without slip: (7/5) m R^2 w' = -mu_r R m g
    c.pair_all(stiffness=k, restitution=.5, friction=1.0, rolling_friction=mu_r, rolling_model="constant", contact_radius=R)
    c.body("ball", "m", (0, 0, R + 4e-4 - mass * G / k), velocity=(w0 * R, 0, 0), angular_velocity=(0, w0, 0))
    c.floor()
    run = report.run(c.run(tools))
    late = (run.times > .1) & (run.w[:, 0, 1] > 1)
    rate = -numpy.polyfit(run.times[late], run.w[late, 0, 1], 1)[0]
    report.check("rolls free: w' [rad/s^2], closed form (5/7) mu_r g/R", rate, 5 / 7 * mu_r * G / R, 5e-3)
    # without friction it spins in its place: (2/5) m R^2 w' = -mu_r R m g, the formula of the reference
    c = Case("F8-spin", duration=1.0, steps_per_contact=30, gravity=(0, 0, -G), margin=2e-4, every=.02)
    c.sphere("ball", R)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.5, friction=0.0, rolling_friction=mu_r, rolling_model="constant", contact_radius=R)
    c.body("ball", "m", (0, 0, R + 4e-4 - mass * G / k), angular_velocity=(0, w0, 0))
    c.floor()
    run = report.run(c.run(tools))
    late = (run.times > .1) & (run.w[:, 0, 1] > 1)
    rate = -numpy.polyfit(run.times[late], run.w[late, 0, 1], 1)[0]
    report.check("spins without friction: w' [rad/s^2], closed form (5/2) mu_r g/R", rate, 2.5 * mu_r * G / R, 5e-3)


@case("F9", "U", "rolling resistance holds a ball on a slope below tan a = mu_r", "Ai et al. 2011; VALIDATION F9")
def f9(tools, report):
    R, k, mu_r, margin = .1, 1e6, .1, 1e-4
    mass = 1000 * 4 / 3 * math.pi * R**3
    limit = math.degrees(math.atan(mu_r))
    c = Case("F9", duration=6.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.1)
    c.sphere("ball", R)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.2, friction=.8, rolling_friction=mu_r, rolling_model="elastic-plastic", contact_radius=R)
    offsets = (-.1, .1)
    inclines = []
    for i, offset in enumerate(offsets):
        s = Incline(c, math.radians(limit + offset), (0, 0, 30 * i), 40.0, "m")
        c.body("ball", "m", s.point(-6, R - mass * G / k), orientation=s.q)
        inclines.append(s)
    run = report.run(c.run(tools))
    way = [s.along(run.x[-1, i] - run.x[run.times > 4][0, i])[0] for i, s in enumerate(inclines)]
    report.at_most(f"{limit - .1:.3f} degrees: rolls in the last 2 s by [m]", abs(way[0]), 1e-6)
    report.at_least(f"{limit + .1:.3f} degrees: rolls in the last 2 s by [m]", way[1], 1e-3)


@case("F10", "U", "friction does not depend on direction: F3 every 15 degrees")
def f10(tools, report):
    angles = [math.radians(15 * i) for i in range(24)]
    for locked in (True, False):
        run = report.run(thrown_blocks(tools, f"F10-{'locked' if locked else 'free'}", angles, locked, every=1.3))
        way = run.x[-1] - run.x[0]
        length = numpy.hypot(way[:, 0], way[:, 1])
        across = numpy.abs(-way[:, 0] * numpy.sin(angles) + way[:, 1] * numpy.cos(angles)) / length
        label = "rotation locked, cube not turned" if locked else "free, cube turned into its direction"
        report.at_most(f"{label}: direction error [rad]", across.max(), 1e-6)
        report.at_most(f"{label}: spread of the distance", numpy.ptp(length) / length.mean(), 1e-6)


@case("F4", "U", "block on a slowly turning table tips at tan a = b/h")
def f4(tools, report):
    mu, k, margin = 1.0, 1e6, 1e-4
    rate = math.radians(.25)
    shapes = [((.1, .1, .2), 26.5650512), ((.1, .1, .3), 18.4349488)]
    start = 1.0  # degrees before the threshold
    for i, (size, threshold) in enumerate(shapes):
        c = Case(f"F4-{i}", duration=5.2, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.02)
        c.mesh("block", meshes.box(size))
        mass = 1000 * numpy.prod(size)
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.1, friction=mu)
        alpha = math.radians(threshold - start)
        q = quaternion((0, 1, 0), alpha)
        c.mesh_wall(meshes.plate(1.0), "m", position=[0, 0, 0], orientation=list(q), motion={"rotate": {"axis": [0, 1, 0], "centre": [0, 0, 0], "rate": rate}, "start": .5})
        # placed with the tilt that its corner loads ask for, so that it does not start to rock: lower pair N1, upper N2
        c.body("block", "m", rotated(q, numpy.array([0, 0, size[2] / 2 - mass * G / (k * 4**.25)])), orientation=q)
        run = report.run(c.run(tools))
        alpha_t = alpha + rate * numpy.maximum(0, run.times - .5)
        down = numpy.stack([numpy.cos(alpha_t), 0 * alpha_t, -numpy.sin(alpha_t)], axis=1)
        axis = rotated(run.q[:, 0], numpy.array([1.0, 0, 0]))
        lean = numpy.abs(numpy.arctan2(numpy.linalg.norm(numpy.cross(down, axis), axis=1), (down * axis).sum(axis=1)))
        tipped = numpy.nonzero(lean > math.radians(1))[0]
        measured = math.degrees(alpha_t[tipped[0]]) if len(tipped) else float("nan")
        report.check(f"b/h = {size[0] / size[2]:.3f}: angle at which it leans by 1 degree [degrees]", measured, threshold, .2, "absolute",
                     f"turned by {math.degrees(rate):g} degrees/s")


@case("F5", "U", "a sliding ball comes to roll")
def f5(tools, report):
    R, k, mu, v0 = .1, 1e6, .2, 2.0
    # friction acts in the middle of the gap, half of both margins outside the ball: a margin of 1e-3 R
    margin = 1e-4
    c = Case("F5", duration=1.4, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.01)
    c.sphere("ball", R)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.5, friction=mu)
    mass = 1000 * 4 / 3 * math.pi * R**3
    spins = [0.0, -10.0, -20.0, -60.0]
    for i, w in enumerate(spins):
        c.body("ball", "m", (0, i, R - mass * G / k), velocity=(v0, 0, 0), angular_velocity=(0, w, 0))
    c.floor()
    run = report.run(c.run(tools))
    for i, w in enumerate(spins):
        final = (5 * v0 + 2 * R * w) / 7
        report.check(f"backspin {w:g}: v_f [m/s]", run.v[-1, i, 0], final, 5e-3 * v0, "absolute")
    t = 2 * v0 / (7 * mu * G)
    sliding = (run.times > .02) & (run.times < .9 * t)
    slope, start = numpy.polyfit(run.times[sliding], run.v[sliding, 0, 0], 1)
    report.check("time until it rolls [s]", (5 * v0 / 7 - start) / slope, t, 5e-3)
    i0 = int(numpy.argmin(abs(run.times - .7)))
    way = run.x[i0, 0, 0] - 5 * v0 / 7 * (run.times[i0] - t)
    report.check("way until it rolls [m]", way, 12 * v0**2 / (49 * mu * G), 5e-3)
    # mesh: v_f = v0/(1 + I/mR^2) with its own inertia
    # soft enough (depth at rest 0.4 mm, several facets deep) to roll over its facets without losing speed to them
    margin, k = 1e-3, 1e5
    for level in (3, 4):
        mesh = meshes.icosphere(level, R)
        volume, _, inertia = meshes.mass_properties(mesh)
        c = Case(f"F5-L{level}", duration=.6, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.005)
        c.mesh("ball", mesh)
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.9, friction=mu)
        c.body("ball", "m", (0, 0, mesh[0][:, 2].max() - 1000 * volume * G / k), velocity=(v0, 0, 0))
        c.floor()
        run = report.run(c.run(tools))
        late = run.times > .4
        v = run.v[late, 0, 0]
        ratio = inertia[1, 1] / (volume * R**2)
        lever = run.x[late, 0, 2].mean()  # to the plane
        print(f"    level {level}: facet ripple of the speed {numpy.ptp(v):.3g} m/s")
        if level == 4:
            report.check("icosphere L4: mean v_f [m/s]", v.mean(), v0 / (1 + ratio * R**2 / lever**2), 5e-3, note="by the lever to the middle of the gap")
            report.check("icosphere L4: 1/(1 + I/mR^2)", 1 / (1 + ratio), .714580, 1e-5, "absolute")


@case("F6", "U", "rolling down an incline; slip limits of ball and cylinder")
def f6(tools, report):
    R, k, mu = .1, 1e6, .3
    margin = 1e-4
    c = Case("F6", duration=1.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.05)
    c.sphere("ball", R)
    ball_mass = 1000 * 4 / 3 * math.pi * R**3
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.3, friction=mu)
    angles = [math.radians(20), math.atan(3.5 * mu * .97), math.atan(3.5 * mu * 1.03)]
    inclines = []
    for i, alpha in enumerate(angles):
        s = Incline(c, alpha, (0, 0, 30 * i), 20.0, "m")
        c.body("ball", "m", s.point(-6, R - ball_mass * G * math.cos(alpha) / k), orientation=s.q)
        inclines.append(s)
    run = report.run(c.run(tools))
    lever = R
    for i, (alpha, s) in enumerate(zip(angles, inclines)):
        v, w = s.along(run.v[:, i]), s.along(run.w[:, i])
        late = run.times > .2
        a = numpy.polyfit(run.times[late], v[late, 0], 1)[0]
        slip = abs(v[-1, 0] - w[-1, 1] * lever) / v[-1, 0]
        if i == 0:
            report.check("ball, 20 degrees: a [m/s^2]", a, 2.396584, 5e-3)
        if i < 2:
            report.at_most(f"ball, tan a = {math.tan(alpha) / mu:.3g} mu: slip over speed", slip, 1e-3)
        else:
            expected = G * (math.sin(alpha) - mu * math.cos(alpha))
            report.check(f"ball, tan a = {math.tan(alpha) / mu:.3g} mu: slips with a [m/s^2]", a, expected, 5e-3)
            report.at_least("and its rim slides (slip over speed)", slip, 5e-3)
    # Cylinders: prisms. Friction is remembered per corner, so a rolling prism creeps by the stretch that every new corner
    # needs, mu D / rho, over the length for which a corner carries, sqrt(8 R D): small depths D creep little, if the facets
    # (height R (pi/n)^2 / 2 = 2e-6 m) are smaller still. A 128-gon on a contact of the same stiffness creeps by 1 to 2 %.
    for sides in (512,):
        c = Case(f"F6-{sides}", duration=.7, steps_per_contact=150, gravity=(0, 0, -G), margin=margin, every=.01)
        mesh = meshes.cylinder(R, .1, sides, turn=.5)
        volume, _, inertia = meshes.mass_properties(mesh)
        c.mesh("cylinder", mesh)
        c.material("m", 1000.0)
        c.pair_all(stiffness=k, restitution=.3, friction=mu)
        angles = [math.radians(20), math.atan(3 * mu * .9), math.atan(3 * mu * 1.1)]
        inclines = []
        lie = quaternion((1, 0, 0), math.pi / 2)
        for i, alpha in enumerate(angles):
            s = Incline(c, alpha, (0, 0, 30 * i), 20.0, "m")
            down = -rotated(lie, mesh[0])[:, 2].min()
            c.body("cylinder", "m", s.point(-6, down - 1000 * volume * G * math.cos(alpha) / (k * 4**.25)), orientation=product(s.q, lie))
            inclines.append(s)
        run = report.run(c.run(tools))
        for i, (alpha, s) in enumerate(zip(angles, inclines)):
            v, w = s.along(run.v[:, i]), s.along(run.w[:, i])
            late = run.times > .2
            a = numpy.polyfit(run.times[late], v[late, 0], 1)[0]
            lever = numpy.abs(rotated(inverse(s.q), run.x[late, i] - s.place)[:, 2]).mean()
            slip = numpy.abs(v[late, 0] - w[late, 1] * lever).mean() / v[late, 0].mean()
            ratio = inertia[2, 2] / (volume * lever**2)
            if i == 0:
                report.check(f"{sides}-gon, 20 degrees: a by its own inertia [m/s^2]", a, G * math.sin(alpha) / (1 + ratio), 5e-3, note=f"smooth cylinder 2.236812, ripple {numpy.ptp(v[late, 0] - numpy.polyval(numpy.polyfit(run.times[late], v[late, 0], 1), run.times[late])):.2g} m/s")
            if i < 2:
                report.at_most(f"{sides}-gon, tan a = {math.tan(alpha) / mu:.3g} mu: creep over speed", slip, 1e-2)
            else:
                report.check(f"{sides}-gon, tan a = {math.tan(alpha) / mu:.3g} mu: slips with a [m/s^2]", a, G * (math.sin(alpha) - mu * math.cos(alpha)), 5e-3)


@case("F7", "U", "a twelve-sided prism rolls down; a six-sided one tips at pi/6", "McGeer 1990, rimless wheel; impulse about the new edge")
def f7(tools, report):
    R, depth, k, margin, mu, density = .1, .1, 1e7, 2e-4, 1.0, 1000.0
    lie = quaternion((1, 0, 0), math.pi / 2)
    # At rest on a face: tips when tan a passes tan(pi/n), the angle from the middle of the face to its edge.
    mesh = meshes.cylinder(R, depth, 6)
    mass = density * meshes.mass_properties(mesh)[0]
    c = Case("F7-tips", duration=1.5, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=.05)
    c.mesh("prism", mesh)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=.1, friction=mu)
    inclines = [Incline(c, math.radians(30 + offset), (0, 0, 20 * i), 10.0, "m") for i, offset in enumerate((-.5, .5))]
    for s in inclines:
        c.body("prism", "m", s.point(-2, R * math.cos(math.pi / 6) - mass * G * .87 / (k * 4**.25)), orientation=product(s.q, lie))
    run = report.run(c.run(tools))
    turned = [math.degrees(2 * math.acos(min(1.0, abs(run.q[-1, i] @ run.q[0, i])))) for i in range(2)]
    report.at_most("six sides, 29.5 degrees: turns in 1.5 s by [degrees]", turned[0], .05)
    report.at_least("six sides, 30.5 degrees: turns in 1.5 s by [degrees]", turned[1], 20.0)
    # Rolling from edge to edge: every landing keeps eta of the spin (angular momentum about the new edge), every step of length
    # s = 2 R sin(pi/n) gives m g s sin a. Started at the steady speed, it must keep it.
    n, alpha = 12, math.radians(8)
    mesh = meshes.cylinder(R, depth, n, turn=.5)
    volume, _, inertia = meshes.mass_properties(mesh)
    gyration = inertia[2, 2] / volume
    eta = (gyration + R * R * math.cos(2 * math.pi / n)) / (gyration + R * R)
    before = math.sqrt(4 * G * R * math.sin(math.pi / n) * math.sin(alpha) / ((gyration + R * R) * (1 - eta * eta)))
    c = Case("F7-rolls", duration=1.6, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.001)
    c.mesh("prism", mesh)
    c.material("m", density)
    c.pair_all(stiffness=k, restitution=.02, friction=mu)
    starts = (1.0, 1.2)  # times the steady spin after a landing
    inclines = [Incline(c, alpha, (0, 0, 20 * i), 16.0, "m") for i in range(len(starts))]
    for s, share in zip(inclines, starts):
        # just landed: it turns about the edge in front, its face a milliradian up
        w = share * eta * before
        q = product(s.q, product(quaternion((0, 1, 0), 1e-3), lie))
        low = -rotated(inverse(s.q), rotated(q, mesh[0]))[:, 2].min()
        foot = numpy.array([R * math.sin(math.pi / n), 0, -low])
        v = numpy.cross([0, w, 0], -foot)
        c.body("prism", "m", s.point(-6, low - density * volume * G / (k * 2**.25)), orientation=q,
               velocity=rotated(s.q, v), angular_velocity=rotated(s.q, numpy.array([0, w, 0])))
    run = report.run(c.run(tools))
    print(f"    eta {eta:.4f}, steady spin before a landing {before:.4f} rad/s")
    for i, share in enumerate(starts):
        w = run.w[:, i, 1]
        # landings: the spin falls by more than half of (1 - eta) within 3 ms
        drop = numpy.nonzero(w[:-3] - w[3:] > .5 * (1 - eta) * before * .8)[0]
        landings = [int(drop[0])] + [int(b) for a, b in zip(drop[:-1], drop[1:]) if b - a > 20]
        peaks = [w[max(0, j - 6):j + 4].max() for j in landings]
        valleys = [w[j:j + 10].min() for j in landings]
        last = slice(-7, -1)
        report.at_least(f"start at {share} of the steady spin: landings", len(landings), 12)
        report.check(f"start at {share} of the steady spin: spin kept by a landing", numpy.mean(numpy.array(valleys[last]) / peaks[last]), eta, .02)
        if share == 1.0:
            report.check("steady spin before a landing [rad/s]", numpy.mean(peaks[last]), before, .02)
        else:
            # the surplus of w^2 falls by eta^2 at every step
            expected = before * math.sqrt(1 + (share**2 - 1) * eta ** (2 * (len(landings) - 4)))
            report.check("faster start: comes to the same spin [rad/s]", numpy.mean(peaks[last]), expected, .02)


@case("F11", "U", "spinning disc: torsion of a flat contact")
def f11(tools, report):
    R, mu, w0, height, k, margin, sides = .1, .3, 20.0, .02, 1e6, 2e-4, 32
    mesh = meshes.cylinder(R, height, sides)
    volume, _, inertia = meshes.mass_properties(mesh)
    mass = 1000 * volume
    area = .5 * sides * R**2 * math.sin(2 * math.pi / sides)
    # potential: all corners of a disc lie on its rim, so its weight does, M = mu m g R; an elastic layer presses evenly, two thirds of it
    for gather, pairs, corners, share in (("potential", {"stiffness": k}, sides, 1.0), ("area", {"layer_modulus": k * 2 * margin / area}, 1, 2 / 3)):
        c = Case(f"F11-{gather}", duration=.7, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.005, gather=gather)
        c.mesh("disc", mesh)
        c.material("m", 1000.0)
        c.pair_all(restitution=.3, friction=mu, **pairs)
        c.body("disc", "m", (0, 0, rest_height(height / 2, margin, mass, k, corners=corners)), angular_velocity=(0, 0, w0))
        c.floor()
        run = report.run(c.run(tools))
        w = run.w[:, 0, 2]
        moving = (run.times > .02) & (w > .3 * w0)
        slope, start = numpy.polyfit(run.times[moving], w[moving], 1)
        torque = -slope * 1000 * inertia[2, 2] / (mu * mass * G * R)
        report.check(f"{gather}: torque over mu m g R", torque, share, .02, note="load on the rim" if share == 1 else "uniform pressure")
        report.check(f"{gather}: stops after [s]", -start / slope, 1000 * inertia[2, 2] * w0 / (share * mu * mass * G * R), .02)
        report.at_most(f"{gather}: spin at the end [rad/s]", abs(w[-1]), 1e-6)


@case("F12", "U", "block stuck on a turntable")
def f12(tools, report):
    mu, k, margin, half, rate = .5, 1e5, 2e-3, .05, 3.0
    limit = mu * G / rate**2
    radii = [.3, .95 * limit, 1.05 * limit]
    c = Case("F12", duration=10.0, steps_per_contact=30, gravity=(0, 0, -G), margin=margin, every=.05, contacts=True)
    c.mesh("block", meshes.box((.1, .1, .1)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=.2, friction=mu)
    for i, r in enumerate(radii):
        a = 2.1 * i
        c.body("block", "m", (r * math.cos(a), r * math.sin(a), rest_height(half, margin, 1.0, k)), orientation=quaternion((0, 0, 1), a),
               velocity=(-rate * r * math.sin(a), rate * r * math.cos(a), 0), angular_velocity=(0, 0, rate))
    c.floor(motion={"rotate": {"axis": [0, 0, 1], "centre": [0, 0, 0], "rate": rate}})
    run = report.run(c.run(tools))
    r = numpy.hypot(run.x[..., 0], run.x[..., 1])
    settled = run.times > 1
    for i in (0, 1):
        force = []
        for n in numpy.nonzero(settled)[0]:
            contacts = run.contacts[n]
            mine = contacts["body_a"] == i
            total = contacts["tangential_force"][mine].sum(axis=0)
            outward = run.x[n, i] * [1, 1, 0] / r[n, i]
            force.append(-total @ outward)
        expected = rate**2 * r[settled, i].mean()
        report.check(f"r = {radii[i]:.3g} m: friction over m w^2 r, mean", numpy.mean(force) / expected, 1.0, 1e-3)
        report.at_most(f"r = {radii[i]:.3g} m: its ripple", numpy.ptp(force) / expected, 1e-3)
        report.at_most(f"r = {radii[i]:.3g} m: drift in {rate * 9 / 2 / math.pi:.1f} turns over r", abs(r[-1, i] - r[settled][0, i]) / radii[i], 1e-3)
    report.at_least("r = 1.05 of the limit: slides off (r at the end over r)", r[-1, 2] / radii[2], 1.5)


@case("F13", "U", "sliding friction below static friction: the same at every step and stiffness", "a = g_along - mu_sliding g_across")
def f13(tools, report):
    mu_static, mu_sliding, half, margin = .6, .3, .01, 1e-4
    stiffnesses = [3e3, 1e4, 3e4, 1e5]
    mass = 1000.0 * 8 * half**3
    for scene, gravity, speed, expected in (("slope of 0.5", (G / math.sqrt(1.25) / 2, 0, -G / math.sqrt(1.25)), .05, G / math.sqrt(1.25) * (.5 - mu_sliding)),
                                            ("level floor", (0, 0, -G), 1.0, -mu_sliding * G)):
        worst = {}
        for steps in (8, 12, 30, 120, 480):
            c = Case(f"F13-{scene.split()[0]}-{steps}", duration=.2, steps_per_contact=steps, gravity=gravity, margin=margin, every=.01,
                     contact={"impact_speed": .1})
            c.mesh("cube", meshes.box((2 * half,) * 3))
            c.mesh("bed", meshes.box((1.0, .1, .1)))
            c.sphere("ball", half)
            for n, k in enumerate(stiffnesses):
                c.material(f"m{n}", 1000.0)
                c.pair(f"m{n}", f"m{n}", stiffness=k, restitution=.3, friction=mu_static, friction_sliding=mu_sliding)
            c.pair_all(stiffness=1e4, restitution=.3, friction=0)
            kinds = []
            for n, k in enumerate(stiffnesses):
                c.body("bed", f"m{n}", (0, .2 * n, .5), fixed=True)
                ball = mass * math.pi / 6  # of a ball of that width
                for shape, x, m, corners in (("cube", -.4, mass, 4), ("ball", -.2, ball, 1)):
                    sinks = -gravity[2] * m / (k * corners**.25)
                    c.body(shape, f"m{n}", (x, .2 * n, .55 + half - sinks), velocity=(speed, 0, 0), lock_rotation=True)
                    kinds.append(shape)
            run = report.run(c.run(tools))
            late = (run.times > .095) & (run.times < .205)
            for kind, i in zip(kinds, numpy.nonzero(run.v[0, :, 0])[0]):
                a = (run.v[late, i, 0][-1] - run.v[late, i, 0][0]) / (run.times[late][-1] - run.times[late][0])
                if kind not in worst or abs(a - expected) > abs(worst[kind] - expected):
                    worst[kind] = a
        for kind, a in worst.items():
            report.check(f"{scene}, {kind} on a fixed body: acceleration that is farthest off [m/s^2]", a, expected, .01)
