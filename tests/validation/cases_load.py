"""L: walls that answer to the load on them: free parts, motors, servos."""
import math

import numpy

import meshes
from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)

G = 9.81


def agm(a, b):
    """Arithmetic-geometric mean: digits double with each round."""
    for _ in range(8):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return a


def wall_column(run, index, name):
    return run.log[f"wall{len(run.case.bodies) + index}_{name}"]


@case("L1", "U", "a piston on one contact spring", "period 2 pi sqrt(M/k), depth at rest M g / k; the integrator's own period")
def l1(tools, report):
    M, k, R, h = 3.0, 2e5, 0.05, 2e-4
    rest = M * G / k
    c = Case("L1", duration=0.2, step=h, every=2e-3, gravity=(0, 0, -G))
    c.sphere("ball", R)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=1)
    c.body("ball", "m", (0, 0, 0), fixed=True)
    c.floor(point=(0, 0, R - 0.5 * rest), normal=(0, 0, -1), motion={"free": {"guide": [0, 0, 1], "mass": M}})
    run = report.run(c.run(tools))
    time, way, rate = run.log["time"], wall_column(run, 0, "way"), wall_column(run, 0, "rate")
    depth = 0.5 * rest - way
    report.check("mean depth over whole periods [m]", (depth.min() + depth.max()) / 2, rest, 1e-3)
    omega = math.acos(1 - h * h * k / (2 * M)) / h   # of the leapfrog
    exact = rest * (1 - 0.5 * numpy.cos(omega * time))
    report.at_most("distance from the discrete solution, over the depth at rest", abs(depth - exact).max() / rest, 1e-9)
    up = numpy.nonzero((rate[:-1] > 0) & (rate[1:] <= 0))[0]
    cross = time[up] + (time[up + 1] - time[up]) * rate[up] / (rate[up] - rate[up + 1])
    period = (cross[-1] - cross[0]) / (len(cross) - 1)
    report.check("period [s]", period, 2 * math.pi * math.sqrt(M / k), 2e-3)


@case("L2", "U", "a motor on a shaft", "rate = torque t / inertia; its work is in the shaft and in what the shaft does")
def l2(tools, report):
    torque, inertia, start = 0.4, 0.02, 0.05
    paddle = {"plate": {"corner": [0.02, -0.05, 0.01], "side_a": [0.2, 0, 0], "side_b": [0, 0, 0.1]}}
    for name, there in (("alone", False), ("against bodies", True)):
        c = Case(f"L2{'b' if there else 'a'}", duration=0.35, every=1e-3, gravity=(0, 0, -G), margin=4e-4)
        c.mesh("cube", meshes.box((0.04, 0.04, 0.04)))
        c.material("m", 800.0)
        c.pair_all(stiffness=5e4, restitution=0.4, friction=0.3)
        for x in (0.08, 0.15):
            c.body("cube", "m", (x, 0.02 if there else 0.4, 0.0208))
        c.floor()
        c.wall(paddle, "m", motion={"motor": {"axis": [0, 0, 1], "centre": [0, -0.05, 0], "torque": torque, "inertia": inertia}, "start": start})
        run = report.run(c.run(tools))
        time, way, rate = run.log["time"], wall_column(run, 1, "way"), wall_column(run, 1, "rate")
        on = time >= start
        if there:
            report.at_most(f"{name}: rate at the end, over that of a free shaft", rate[-1] / (torque / inertia * (time[-1] - start)), 0.95)
        else:
            # the shaft starts with the first whole step after `start`
            step = run.record["step_size"] if "step_size" in run.record else time[1] - time[0]
            report.at_most(f"{name}: rate against torque t / inertia [rad/s]", abs(rate[on] - torque / inertia * (time[on] - start)).max(),
                           torque / inertia * step)
        work = torque * way[-1]
        kept = 0.5 * inertia * rate[-1] ** 2
        done = run.log["wall_work"][-1] - run.log["wall_work"][0]
        report.check(f"{name}: energy of the shaft and work on bodies [J], of the motor's work", kept + done, work, 1e-9)


@case("L3", "U", "a flap that swings", "pendulum of finite amplitude: complete elliptic integral")
def l3(tools, report):
    inertia, mass, arm, angle = 0.03, 2.0, 0.12, 1.0
    c = Case("L3", duration=3.0, step=5e-4, every=2e-3, gravity=(0, 0, -G), margin=1e-3)
    c.sphere("ball", 0.01)
    c.material("m", 1000.0)
    c.pair_all(stiffness=1e4, restitution=0.5)
    c.body("ball", "m", (2, 0, 0), fixed=True)
    centre = [arm * math.sin(angle), 0, 0.5 - arm * math.cos(angle)]
    c.wall({"plate": {"corner": [0, -0.1, 0.5], "side_a": [2 * centre[0], 0, 2 * (centre[2] - 0.5)], "side_b": [0, 0.2, 0]}}, "m",
           motion={"free": {"hinge": [0, 3, 0], "centre": [0, 0, 0.5], "inertia": inertia, "mass": mass, "mass_centre": centre}})
    run = report.run(c.run(tools))
    time, way, rate = run.log["time"], wall_column(run, 0, "way"), wall_column(run, 0, "rate")
    period = 2 * math.pi * math.sqrt(inertia / (mass * G * arm)) / agm(1, math.cos(angle / 2))
    turn = numpy.nonzero((rate[:-1] > 0) & (rate[1:] <= 0))[0]
    cross = time[turn] + (time[turn + 1] - time[turn]) * rate[turn] / (rate[turn] - rate[turn + 1])
    report.check("period [s]", (cross[-1] - cross[0]) / (len(cross) - 1), period, 1e-5)
    report.check("swing [rad]", way.max() - way.min(), 2 * angle, 1e-4)
    energy = 0.5 * inertia * rate**2 + mass * G * arm * (1 - numpy.cos(angle - way))
    report.at_most("drift of its energy over what it has", abs(energy / energy[0] - 1).max(), 1e-4)


@case("L4", "U", "a press that holds its stress on a bed", "force asked; the same with a blow of at most a twentieth")
def l4(tools, report):
    stress, side = 20e3, 0.08
    c = Case("L4", duration=1.4, every=2e-3, gravity=(0, 0, -G), margin=4e-4, seed=3, steps_per_contact=12)
    c.mesh("rock", meshes.transformed(meshes.rock(5, 1), numpy.eye(3) * 0.016))
    c.material("m", 2500.0)
    c.pair_all(stiffness=2e5, restitution=0.3, friction=0.3)
    half = side / 2
    c.population(shape="rock", material="m", count=60, region={"box": [[-half, -half, 0.001], [half, half, 0.1]]})
    for normal in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        c.floor(point=[-half * x for x in normal], normal=normal)
    c.floor()
    area = side * side
    c.wall({"plate": {"corner": [-half, -half, 0.11], "side_a": [side, 0, 0], "side_b": [0, side, 0]}}, "m",
           motion={"servo": {"direction": [0, 0, -2], "stress": stress, "area": area, "max_speed": 0.1}, "start": 0.3})
    run = report.run(c.run(tools))
    time, rate, force = run.log["time"], wall_column(run, 5, "rate"), wall_column(run, 5, "force_z")
    target = stress * area
    late = time > 0.9 * time[-1]
    report.check("force once still [N]", force[late].mean(), target, 1e-3)
    report.at_most("largest deviation of it, over the force asked", abs(force[late] / target - 1).max(), 1e-3)
    report.at_most("largest force on the way, over the force asked", force.max() / target, 1.05)
    report.at_most("speed, over what it may have", abs(rate).max() / 0.1, 1 + 1e-9)
    report.check("it comes down at [m/s]", numpy.median(rate[(time > 0.32) & (time < 0.5)]), 0.1, 1e-9)


@case("L5", "U", "a prism with an inclined cut between smooth platens", "s1/s3 = tan(theta) / tan(theta - phi), as it slides")
def l5(tools, report):
    mu, theta, w, depth, more, s3 = 0.5, math.radians(60), 0.05, 0.05, 0.02, 50e3
    h = w * math.tan(theta)
    lower = meshes.prism([(0, -more), (w, -more), (w, h), (0, 0)], depth)
    upper = meshes.prism([(0, 0), (w, h), (w, h + more), (0, h + more)], depth)
    margin, k = 2e-4, 1e7
    c = Case("L5", duration=0.5, every=2e-3, margin=margin)
    c.mesh("lower", lower)
    c.mesh("upper", upper)
    c.material("rock", 2500.0)
    c.material("platen", 2500.0)
    c.pair("rock", "rock", stiffness=k, restitution=0.1, friction=mu)
    c.pair_all(stiffness=k, restitution=0.1, friction=0)
    gap = 0
    across = gap / math.cos(theta)   # the upper half is lifted until the cut is two margins wide
    for name, mesh, lift in (("lower", lower, 0), ("upper", upper, across)):
        centre = meshes.mass_properties(mesh)[1]
        c.body(name, "rock", (centre[0], centre[1] + lift, centre[2]))
    top = h + more + across + gap
    c.floor("platen", point=(0, -more - gap, 0), normal=(0, 1, 0))
    c.floor("platen", point=(0, top + 1e-5, 0), normal=(0, -1, 0), motion={"translate": {"velocity": [0, -4e-3, 0]}})
    c.floor("platen", point=(w + gap, 0, 0), normal=(-1, 0, 0))
    c.floor("platen", point=(-gap - 1e-5, 0, 0), normal=(1, 0, 0),
            motion={"servo": {"direction": [1, 0, 0], "stress": s3, "area": h * depth, "max_speed": 0.02}})
    run = report.run(c.run(tools))
    time = run.log["time"]
    slides = time > 0.6 * time[-1]
    side = -wall_column(run, 3, "force_x")
    axial = wall_column(run, 1, "force_y")
    report.check("stress of the servo [Pa]", side[slides].mean() / (h * depth), s3, 1e-3)
    ratio = (axial[slides] / (w * depth)) / (side[slides] / (h * depth))
    report.check("s1 / s3", ratio.mean(), math.tan(theta) / math.tan(theta - math.atan(mu)), 5e-3)
    report.at_most("its scatter while it slides", ratio.std() / ratio.mean(), 5e-3)
    report.at_least("way that the side has gone [m]", -wall_column(run, 3, "way")[-1], 2e-4)
