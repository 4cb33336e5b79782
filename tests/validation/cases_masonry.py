"""M: arches that stand or fall by their thickness, their friction and the tilt of the ground, and rows of dominoes (judges 2 and 3 of the published benchmarks)."""
import functools
import math

import numpy

import closed_forms as cf
import meshes
from cases_rotation import product
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)
G = cf.GRAVITY


class Arch:
    """Half a circle of mean radius 1 of `count` voussoirs with plane faces: corners at 1 +- thickness / 2 on radial joints, the first and last joint on the
    ground. Corners are rounded with the radius `margin`: the ball in a corner of the angle w touches the joint margin / tan(w / 2) short of its end."""

    def __init__(self, count, thickness, margin=0.0):
        self.count, self.thickness, self.margin = count, thickness, margin
        self.half = math.pi / (2 * count)
        inner, outer = 1 - thickness / 2, 1 + thickness / 2
        s, c = math.sin(self.half), math.cos(self.half)
        # of a voussoir whose middle is the y axis
        self.outline = [(-inner * s, inner * c), (inner * s, inner * c), (outer * s, outer * c), (-outer * s, outer * c)]
        # a trapezoid of parallel sides a and b, h apart: its centroid from a is h (a + 2 b) / (3 (a + b))
        a, b, h = 2 * inner * s, 2 * outer * s, thickness * c
        self.radius = inner * c + h * (a + 2 * b) / (3 * (a + b))
        self.area = h * (a + b) / 2
        self.middles = [(2 * i + 1) * self.half for i in range(count)]

    def model(self):
        """Blocks and contacts, as closed_forms.can_stand() has them."""
        blocks = [(self.radius * math.cos(a), self.radius * math.sin(a), self.area) for a in self.middles]
        low = 1 - self.thickness / 2 + self.margin / math.tan(math.pi / 4 + self.half / 2)   # inner corners are wider than a right angle by half the angle of a voussoir
        high = 1 + self.thickness / 2 - self.margin / math.tan(math.pi / 4 - self.half / 2)
        contacts = []
        for joint in range(self.count + 1):
            a = 2 * self.half * joint
            along = (-math.sin(a), math.cos(a))
            for r in (low, high):
                point = (r * math.cos(a), r * math.sin(a))
                contacts.append((joint - 1 if joint else None, joint, point, along) if joint < self.count else (None, joint - 1, point, (-along[0], -along[1])))
        return blocks, contacts

    def can_stand(self, friction, down=(0, -1)):
        return cf.can_stand(*self.model(), friction, down)


@functools.cache
def least_thickness(count, margin):
    """Over the mean radius, with friction that no joint uses up."""
    return cf.threshold(lambda t: Arch(count, t, margin).can_stand(4.0), 2.5 * margin + 1e-3, .5)


@functools.cache
def least_friction(count, thickness, margin):
    return cf.threshold(Arch(count, thickness, margin).can_stand, 0.0, 4.0)


@functools.cache
def greatest_tilt(count, thickness, margin, friction):
    """Of the ground [rad]."""
    return cf.threshold(lambda tilt: not Arch(count, thickness, margin).can_stand(friction, (math.sin(tilt), -math.cos(tilt))), 0.0, math.radians(45))


# Least thickness over the mean radius of half a circle of voussoirs with plane faces, by the number of voussoirs, computed before for this plan by another
# program; for many of them Milankovitch (1907) has .1075. Least friction and greatest tilt at a thickness of .15: the same source.
LEAST_THICKNESS = {7: .0957, 8: .1000, 11: .1046, 13: .1025, 16: .1071, 21: .1067, 32: .1072, 101: .1075}
LEAST_FRICTION = {13: .3483, 21: .3505}
GREATEST_TILT = {13: 8.34, 21: 8.44}   # degrees, friction .7
MARGIN = 1e-3                          # over the mean radius


def run_arch(tools, report, name, arch, friction, stiffness, tilt=0.0):
    """The arch on a ground that is tilted from the start. Gives how far the stone that moves most has moved after 1.5 s, over the mean radius, and the greatest
    speed then [m/s]. A stone falls by the radius in 0.45 s."""
    c = Case("M-" + name.replace(",", "").replace(" ", "-"), duration=1.5, steps_per_contact=12, gravity=(G * math.sin(tilt), 0, -G * math.cos(tilt)), margin=arch.margin, every=.15)
    c.mesh("stone", meshes.centred(meshes.prism(arch.outline, .2)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=stiffness, restitution=.1, friction=friction)
    lie = quaternion((1, 0, 0), math.pi / 2)   # the outline (x, y) comes to stand upright
    for a in arch.middles:
        c.body("stone", "m", (arch.radius * math.cos(a), 0, arch.radius * math.sin(a)), orientation=product(quaternion((0, 1, 0), math.pi / 2 - a), lie))
    c.floor()
    run = report.run(c.run(tools))
    return float(numpy.linalg.norm(run.x[-1] - run.x[0], axis=1).max()), float(numpy.linalg.norm(run.v[-1], axis=1).max())


def falls(tools, report, name, *words, **more):
    moved, _ = run_arch(tools, report, name, *words, **more)
    report.at_least(f"{name}: a stone has moved by, over the radius", moved, .1)


def stays(tools, report, name, *words, **more):
    """Joints give by a few micrometres; the springs that this leaves ring with less than a millimetre a second."""
    moved, speed = run_arch(tools, report, name, *words, **more)
    report.at_most(f"{name}: a stone has moved by, over the radius", moved, 2e-4)
    report.at_most(f"{name}: speed in the end [m/s]", speed, 1e-3)


@case("M1", "U", "arches of voussoirs: least thickness", "Heyman, Int. J. Solids Struct. 2 (1966) 249; Milankovitch 1907; linear programming")
def m1(tools, report):
    """Joints give under thrust, which brings the fall nearer, the more joints the more: an arch of seven falls at 1.005 times its least thickness with contacts of
    0.2 GN/m and stands there with 1 GN/m; one of 32 falls there with 1 GN/m and stands with 4."""
    for count, published in LEAST_THICKNESS.items():
        report.check(f"{count} voussoirs: least thickness, by linear programming", least_thickness(count, 0.0), published, 6e-5, "absolute")
    for count in tools.sized((7,), (7, 8, 11, 13, 16, 21, 32)):
        rounded = least_thickness(count, MARGIN)
        report.check(f"{count} voussoirs, rounded with {MARGIN:g} of the radius: what that adds to the least thickness, over twice the rounding",
                     (rounded - least_thickness(count, 0.0)) / (2 * MARGIN), 1.0, .025)
        stiffness = 1e9 if count < 32 else 4e9
        falls(tools, report, f"{count} voussoirs, 0.995 of the least thickness", Arch(count, .995 * rounded, MARGIN), 1.0, stiffness)
        stays(tools, report, f"{count} voussoirs, 1.005 of the least thickness", Arch(count, 1.005 * rounded, MARGIN), 1.0, stiffness)


@case("M2", "N", "arches of voussoirs: least friction, greatest tilt of the ground", "linear programming")
def m2(tools, report):
    thickness = .15
    for count in tools.sized((13,), (13, 21)):
        report.check(f"{count} voussoirs: least friction, by linear programming", least_friction(count, thickness, 0.0), LEAST_FRICTION[count], 6e-5, "absolute")
        report.check(f"{count} voussoirs: greatest tilt [degrees], by linear programming", math.degrees(greatest_tilt(count, thickness, 0.0, .7)), GREATEST_TILT[count], 6e-3, "absolute")
        arch = Arch(count, thickness, MARGIN)
        mu, tilt = least_friction(count, thickness, MARGIN), greatest_tilt(count, thickness, MARGIN, .7)
        falls(tools, report, f"{count} voussoirs, 0.98 of the least friction", arch, .98 * mu, 2e8)
        stays(tools, report, f"{count} voussoirs, 1.02 of the least friction", arch, 1.02 * mu, 2e8)
        stays(tools, report, f"{count} voussoirs, 0.98 of the greatest tilt", arch, .7, 1e9, .98 * tilt)
        falls(tools, report, f"{count} voussoirs, 1.01 of the greatest tilt", arch, .7, 1e9, 1.01 * tilt)


def wave_speed(tools, report, gap):
    """Of a row of dominoes: speed of the wave over the last ten that it reaches, the speed by the closed form, and how many it reaches."""
    height, thickness, width, margin, stiffness, count = .048, .0075, .024, 5e-5, 1e5, 60
    expected = cf.domino_speed(height, thickness, gap)
    c = Case(f"M3-{1e3 * gap:g}-mm", duration=(count - 4) * (gap + thickness) / expected, steps_per_contact=20, gravity=(0, 0, -G), margin=margin, every=2e-3)
    c.mesh("domino", meshes.box((thickness, width, height)))
    c.material("stone", 1000.0)
    c.material("ground")
    c.pair("stone", "stone", stiffness=stiffness, restitution=0.0, friction=0.0)
    c.pair("stone", "ground", stiffness=stiffness, restitution=0.0, friction=5.0)
    c.pair_all(stiffness=stiffness, restitution=0.0, friction=0.0)
    mass = 1000 * thickness * width * height
    spin = expected / (gap + thickness) * 2 * math.asin(gap / height)   # of the first one, about its lower edge
    for i in range(count):
        push = {"angular_velocity": (0, spin, 0), "velocity": (spin * height / 2, 0, spin * thickness / 2)} if i == 0 else {}
        c.body("domino", "stone", (i * (thickness + gap), 0, height / 2 - mass * G / (stiffness * 4**.25)), **push)
    c.floor("ground")
    run = report.run(c.run(tools))
    lean = numpy.arcsin(numpy.clip(rotated(run.q, numpy.array([0, 0, 1.0]))[..., 0], -1, 1))
    mark = .5 * math.asin(gap / height)
    started = []
    for i in range(count):
        later = numpy.nonzero(lean[:, i] > mark)[0]
        if not len(later):
            break
        k = later[0]   # a straight line between the frames
        started.append(run.times[k - 1] + (run.times[k] - run.times[k - 1]) * (mark - lean[k - 1, i]) / (lean[k, i] - lean[k - 1, i]) if k else run.times[0])
    last = len(started) - 1
    return 10 * (gap + thickness) / (started[last] - started[last - 10]), expected, last


# gap [m], speed [m/s] computed before for this plan by another program
DOMINOES = {.0085: 1.381, .012: 1.299, .016: 1.241, .020: 1.198, .024: 1.163}


@case("M3", "N", "dominoes without friction between them: speed of the wave", "one degree of freedom: a row that leans, joins without rebound, turns about front lower edges")
def m3(tools, report):
    """Free slabs on a rough ground. In wide gaps the edge would have to hold them down: they may leave the ground, and the speed is reported only."""
    for gap, published in DOMINOES.items():
        speed, expected, reached = wave_speed(tools, report, gap)
        report.check(f"gap {1e3 * gap:g} mm: closed form [m/s]", expected, published, 6e-4, "absolute")
        report.at_least(f"gap {1e3 * gap:g} mm: slabs that the wave reaches", reached, 45)
        if gap < .014:
            report.check(f"gap {1e3 * gap:g} mm: speed over the last ten [m/s]", speed, expected, 2e-3)
        else:
            print(f"    gap {1e3 * gap:g} mm: speed over the last ten {speed:.4f} m/s, {speed / expected - 1:+.2%}")
