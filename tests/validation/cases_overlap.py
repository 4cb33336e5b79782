"""O: contacts deeper than the law has room for, with contact.on_overlap = "continue" (docs/reference/contact-law.md 3.8)."""
import math

import meshes
from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)

G, SIDE, MARGIN, DENSITY = 9.81, 0.1, 0.002, 1000.0
ROOM = 2 * MARGIN          # of a body at a wall: two margins outside of the body as drawn
LIMIT = 0.97 * ROOM        # where a run without the word ends, and the tangent begins
STIFFNESS, YOUNG = 1e5, 1e7


class Linear:
    """k d, of n corners that share a potential k n^(1/4) d: its tangent is itself."""

    def __init__(self, corners=1):
        self.k = STIFFNESS * corners**.25

    def force(self, d):
        return self.k * d

    def energy(self, d):
        return .5 * self.k * d * d

    def overlap(self, force):
        return force / self.k


class Hertz:
    """4/3 E* sqrt(R) d^(3/2) up to the limit, and on along the tangent; E* = E / 2, Poisson's ratio 0."""

    def __init__(self, radius):
        self.a = 4 / 3 * (YOUNG / 2) * math.sqrt(radius)

    def force(self, d):
        at, y = min(d, LIMIT), max(d - LIMIT, 0)
        return self.a * at**1.5 + 1.5 * self.a * math.sqrt(LIMIT) * y

    def energy(self, d):
        at, y = min(d, LIMIT), max(d - LIMIT, 0)
        return .4 * self.a * at**2.5 + self.a * LIMIT**1.5 * y + .75 * self.a * math.sqrt(LIMIT) * y * y

    def overlap(self, force):
        at_limit = self.a * LIMIT**1.5
        return (force / self.a) ** (2 / 3) if force < at_limit else LIMIT + (force - at_limit) / (1.5 * self.a * math.sqrt(LIMIT))


def plane(z):
    return {"plane": {"point": [0, 0, z], "normal": [0, 0, -1]}}


def plate(z):
    return {"plate": {"corner": [-.5, -.5, z], "side_a": [1, 0, 0], "side_b": [0, 1, 0]}}


BODIES = (("ball, linear", "ball", plane, Linear()), ("ball, Hertz", "ball", plane, Hertz(SIDE / 2)), ("ball at a plate, Hertz", "ball", plate, Hertz(SIDE / 2)),
          ("cube at planes", "cube", plane, Linear(4)), ("cube at a plate", "cube", plate, Linear(4)))


def pressed(name, shape, wall, law, duration, restitution, mass, above=0.0, damping=0.0, **body):
    """A body that touches the floor, and a part that comes down on it by its weight, from so far above."""
    c = Case(name, duration=duration, gravity=(0, 0, -G), every=duration / 20, margin=MARGIN, law="hertz-mindlin" if isinstance(law, Hertz) else "linear",
             contact={"on_overlap": "continue", "surface": "outside"})
    c.sphere("ball", SIDE / 2)
    c.mesh("cube", meshes.box((SIDE, SIDE, SIDE)))
    c.material("m", DENSITY, **({"young": YOUNG, "poisson": 0} if isinstance(law, Hertz) else {}))
    c.pair_all(restitution=restitution, friction=.3, **({} if isinstance(law, Hertz) else {"stiffness": STIFFNESS}))
    c.body(shape, "m", (0, 0, SIDE / 2 + ROOM), **body)
    c.floor()
    c.wall(wall(SIDE + 2 * ROOM + above), "m", motion={"free": {"guide": [0, 0, 1], "mass": mass, "damping": damping}})
    return c


def volume_of(shape):
    return SIDE**3 if shape == "cube" else math.pi / 6 * SIDE**3


@case("O1", "U", "bodies lie several maximum overlaps deep under a weight", "F(d) = M g above, (M + m) g below; energies of the law")
def o1(tools, report):
    weight = STIFFNESS * 3.75 * ROOM
    for i, (name, shape, wall, law) in enumerate(BODIES):
        body = DENSITY * volume_of(shape) * G
        mass = weight / G
        run = report.run(pressed(f"O1{'abcde'[i]}", shape, wall, law, 3.0, .2, mass, damping=2 * math.sqrt(STIFFNESS * mass)).run(tools))
        below, above = law.overlap(weight + body), law.overlap(weight)
        report.at_least(f"{name}: overlap over the maximum", above / ROOM, 2)
        # the part creeps to its place: critically damped or more, within exp(-8)
        report.check(f"{name}: overlap at the floor [m]", ROOM + SIDE / 2 - run.x[-1, 0, 2], below, 1e-3)
        way = run.log["wall2_way"][-1]
        report.check(f"{name}: way of the part [m]", -way, below + above, 1e-3)
        report.check(f"{name}: force on the floor [N]", -run.log["wall1_force_z"][-1], weight + body, 1e-3)
        report.check(f"{name}: energy stored [J]", run.log["elastic"][-1], law.energy(below) + law.energy(above), 2e-3)
        report.at_most(f"{name}: energy without a cause, over what is stored", abs(run.log["energy_error"]).max() / run.log["elastic"][-1], 1e-3)
        deep = run.record["deep_contacts"]
        report.check(f"{name}: contacts counted", deep["contacts"], 2, 0, "absolute")


@case("O2", "U", "a weight falls on a body that is held, several maximum overlaps deep, and comes back", "M g (h + d) = U(d)")
def o2(tools, report):
    mass, h = 40.0, ROOM
    for i, (name, shape, wall, law) in enumerate(BODIES):
        run = report.run(pressed(f"O2{'abcde'[i]}", shape, wall, law, .5, 1.0, mass, above=h, fixed=True).run(tools))
        low, high = 0.0, 1.0
        while high - low > 1e-15:
            low, high = (low, (low + high) / 2) if law.energy((low + high) / 2) > mass * G * (h + (low + high) / 2) else ((low + high) / 2, high)
        deep = run.record["deep_contacts"]
        report.at_least(f"{name}: overlap over the maximum", low / ROOM, 2)
        report.check(f"{name}: deepest overlap [m]", deep["deepest"]["overlap"], low, 1e-3)
        report.check(f"{name}: deepest beyond the limit [m]", deep["deepest"]["excess"], low - LIMIT, 2e-3)
        # what the part has of its fall is in its motion or stored, at every row; 30 steps in half a period leave (omega h)^2 / 4 = 2.7e-3 of it
        way, rate = run.log["wall2_way"], run.log["wall2_rate"]
        kept = .5 * mass * rate**2 + mass * G * way + run.log["elastic"]
        report.at_most(f"{name}: energy of part and contact off that of the start, over that of the fall", abs(kept).max() / (mass * G * (h + low)), 3e-3)
