"""E: cases that start from a run ([start]; docs/develop/decisions/017)."""
import math
import os
import shutil

import numpy

import meshes
from cases_friction import G, Incline, rest_height
from registry import case_of
from scene import Case, Run

CASES = []
case = case_of(CASES)

MU, K, MARGIN, MASS, HALF, ANGLE = .5, 1e4, .002, 1.0, .05, math.radians(20)
TANGENTIAL = 2 / 7   # tangential over normal stiffness of the linear law


def block_on_incline(name, duration, every, mu=MU, k=K, place=True, locked=False):
    c = Case(name, duration=duration, gravity=(0, 0, -G), margin=MARGIN, every=every, contacts=True)
    c.material("m", 1000.0)
    c.material("floor")
    c.pair_all(stiffness=k, restitution=.2, friction=mu)
    s = Incline(c, ANGLE, (0, 0, 0), 2.0)
    if place:
        c.mesh("block", meshes.box((.1, .1, .1)))
        c.body("block", "m", s.point(0, rest_height(HALF, MARGIN, MASS, k, math.cos(ANGLE))), orientation=s.q, lock_rotation=locked)
    return c, s


class Kept:
    """A run whose folder stays until the case ends."""

    def __init__(self, c, tools):
        self.folder = os.path.join(tools.scratch, f"{c.name}.run")
        shutil.rmtree(self.folder, ignore_errors=True)
        scene = c.pack(tools)
        tools.call("scree-solver", scene, "-o", self.folder)
        self.run = Run(self.folder, c)

    def start(self, c, **words):
        c.tables["start"] = {"run": self.folder, **words}
        return c


def forces(run, frame):
    """Normal and tangential force of a frame's contacts, in world axes, by feature."""
    contacts = run.contacts[frame]
    order = numpy.argsort(contacts["feature"])
    return contacts["normal_force"][order], contacts["tangential_force"][order]


@case("E1", "U", "a block held on a slope by friction stays, from the checkpoint of its run", "statics")
def s1(tools, report):
    c, s = block_on_incline("E1-before", duration=6.0, every=2.0)
    before = Kept(c, tools)
    c, s = block_on_incline("E1", duration=1.0, every=.1, place=False)
    run = report.run(before.start(c).run(tools))
    weight = MASS * G   # the mesh is read in single precision
    normal, tangential = forces(run, 0)
    report.check("normal forces at the start [N]", normal.sum(), weight * math.cos(ANGLE), 1e-7)
    report.check("friction at the start, m g sin(theta) [N]", numpy.linalg.norm(tangential.sum(axis=0)), weight * math.sin(ANGLE), 1e-7)
    old_normal, old_tangential = forces(before.run, -1)
    report.at_most("change of contact forces to the last frame of the run, over the weight",
                   max(abs(normal - old_normal).max(), abs(tangential - old_tangential).max()) / weight, 1e-12)
    report.at_most("creep in 1 s over the size", abs(run.x[-1, 0] - run.x[0, 0]).max() / HALF, 1e-12)
    energy = run.energy()
    scale = weight * HALF
    report.at_most("energy created, over m g a", max(0.0, (energy - energy[0]).max()) / scale, 1e-12)
    shutil.rmtree(before.folder)


@case("E2", "U", "from a frame, without springs, the block slips until new ones hold", "m v' = F - kt x with damping")
def s2(tools, report):
    # all of m g sin(theta) falls on springs at rest: displaced by F / kt at last
    c, s = block_on_incline("E2-before", duration=6.0, every=2.0, locked=True)
    before = Kept(c, tools)
    c, s = block_on_incline("E2", duration=4.0, every=.5, place=False)
    run = report.run(before.start(c, frame=3).run(tools))
    normal, tangential = forces(run, 0)
    report.at_most("friction at the start over the weight", numpy.linalg.norm(tangential.sum(axis=0)) / (MASS * G), 1e-9)
    slip = s.along(run.x[-1, 0] - run.x[0, 0])[0]
    # it cannot turn: n = 4 corners with the same overlap d share one potential of the overlap n^(1/8) d, so that F over it is k n^(1/8)
    stiffness = TANGENTIAL * K * 4**.125
    report.check("slip downhill, m g sin(theta) / kt [m]", slip, MASS * G * math.sin(ANGLE) / stiffness, 1e-3)
    shutil.rmtree(before.folder)


@case("E3", "U", "with less friction the block slides from the start", "Coulomb")
def s3(tools, report):
    c, s = block_on_incline("E3-before", duration=6.0, every=2.0)
    before = Kept(c, tools)
    mu = .2
    c, s = block_on_incline("E3", duration=.3, every=.01, mu=mu, place=False)
    run = report.run(before.start(c).run(tools))
    late = run.times >= .1
    v = s.along(run.v[:, 0])[:, 0]
    measured = numpy.polyfit(run.times[late], v[late], 1)[0]
    report.check("acceleration, g (sin - mu cos) [m/s^2]", measured, G * (math.sin(ANGLE) - mu * math.cos(ANGLE)), 1e-3)
    shutil.rmtree(before.folder)


@case("E4", "U", "stiffer and softer contacts give back no more than the springs held", "passivity, docs/reference/contact-law.md 3.4")
def s4(tools, report):
    c, s = block_on_incline("E4-before", duration=6.0, every=2.0)
    before = Kept(c, tools)
    held = before.run.log["elastic_tangential"][-1]
    for factor in (4.0, .5):
        c, s = block_on_incline(f"E4-{factor:g}", duration=2.0, every=.1, k=K * factor, place=False)
        run = report.run(before.start(c).run(tools))
        # a stiffer contact keeps the force: energy F^2 / 2 k; a softer one keeps the stretch: k s^2 / 2
        expected = held / factor if factor > 1 else held * factor
        report.check(f"{factor:g} times as stiff: energy of springs at the start [J]", run.log["elastic_tangential"][0], expected, 1e-9)
        normal, tangential = forces(run, -1)
        report.check(f"{factor:g} times as stiff: friction at the end [N]", numpy.linalg.norm(tangential.sum(axis=0)), MASS * G * math.sin(ANGLE), 1e-6)
    shutil.rmtree(before.folder)
