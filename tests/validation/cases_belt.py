"""K: surfaces of walls that move along themselves: belts and turntables."""
import math

import numpy

import meshes
from registry import case_of
from scene import Case, rotated

CASES = []
case = case_of(CASES)

G = 9.81


def block_on(surface, mu, place, duration, every, k=1e6, margin=2e-4):
    """A cube of 1 kg that rests, as nearly as its corners know, on a plane whose surface moves."""
    half, mass = 0.05, 1.0
    c = Case("", duration=duration, every=every, gravity=(0, 0, -G), margin=margin)
    c.mesh("block", meshes.box((0.1, 0.1, 0.1)))
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=0.2, friction=mu)
    x, y = place
    c.body("block", "m", (x, y, half - mass * G / (k * 4**0.25)))
    c.floor(surface=surface)
    return c


@case("K1", "U", "a block that is put on a belt slips, then rides", "slips for v/(mu g) over v^2/(2 mu g); the belt's work is m v^2, half of it heat")
def k1(tools, report):
    mu, v, mass = 0.4, 0.5, 1.0
    c = block_on({"velocity": [v, 0, 0.3]}, mu, (0, 0), 0.3, 0.01)   # what points out of the plane does nothing
    c.name = "K1"
    run = report.run(c.run(tools))
    x, speed = run.x[:, 0, 0], run.v[:, 0, 0]
    slips = run.times < 0.9 * v / (mu * G)
    report.check("acceleration while it slips [m/s^2]", numpy.polyfit(run.times[slips], speed[slips], 1)[0], mu * G, 1e-3)
    riding = run.times > 1.2 * v / (mu * G)
    report.check("speed once it rides [m/s]", speed[riding].mean(), v, 1e-4)
    behind = v * run.times[-1] - x[-1]
    report.check("way that it slipped [m]", behind, v**2 / (2 * mu * G), 2e-3)
    report.check("time that it slipped [s]", 2 * behind / v, v / (mu * G), 2e-3)
    log = run.log
    report.check("work of the belt [J]", log["wall_work"][-1] - log["wall_work"][0], mass * v**2, 2e-3)
    report.check("heat [J]", log["dissipated"][-1] - log["dissipated"][0], mass * v**2 / 2, 2e-3)
    report.at_most("error of the energy balance, over the work", abs(log["energy_error"]).max() / (mass * v**2), 1e-3)
    wall = len(run.case.bodies)
    power = log[f"wall{wall}_power"]
    inner = (log["time"] > 0.02) & (log["time"] < 0.1)
    report.check("power of the belt while it slips [W]", power[inner].mean(), mu * mass * G * v, 2e-3)


@case("K2", "U", "a block on a turntable goes round with it", "circular motion at the table's rate, held by friction below mu g")
def k2(tools, report):
    mu, rate, r = 0.5, 3.0, 0.2   # 1.8 m/s^2 of 4.9
    c = block_on({"rate": rate, "axis": [0, 0, 1], "centre": [0.3, -0.1, 0]}, mu, (0.3 + r, -0.1), 3.0, 0.05)
    c.name = "K2"
    run = report.run(c.run(tools))
    late = run.times > 1.0
    arm = run.x[late, 0, :2] - numpy.array([0.3, -0.1])
    radius = numpy.linalg.norm(arm, axis=1)
    report.at_most("creep of the radius in 2 s, over it", abs(radius[-1] / radius[0] - 1), 2e-3)
    angle = numpy.unwrap(numpy.arctan2(arm[:, 1], arm[:, 0]))
    report.check("rate of its way round [1/s]", numpy.polyfit(run.times[late], angle, 1)[0], rate, 1e-3)
    report.check("spin [1/s]", run.w[late, 0, 2].mean(), rate, 1e-3)
    report.check("speed over radius [1/s]", (numpy.linalg.norm(run.v[late, 0, :2], axis=1) / radius).mean(), rate, 1e-3)


@case("K3", "U", "thrown off the end of a belt", "a parabola: v sqrt(2 h / g) from the end")
def k3(tools, report):
    v, h, R, margin = 2.0, 1.0, 2e-3, 2e-5
    c = Case("K3", duration=1.2, every=0.001, gravity=(0, 0, -G), margin=margin)
    c.sphere("grain", R)
    c.material("m", 1000.0)
    c.pair_all(stiffness=2e3, restitution=0.2, friction=0.5)
    mass = 1000 * 4 / 3 * math.pi * R**3
    # a ball that may not turn slides like a block, and has left the edge as its centre passes it, for v^2 > g R
    c.body("grain", "m", (-0.95, 0, h + R - mass * G / 2e3), lock_rotation=True)
    c.wall({"plate": {"corner": [-1, -0.1, h], "side_a": [1, 0, 0], "side_b": [0, 0.2, 0]}}, "m", surface={"velocity": [v, 0, 0]})
    run = report.run(c.run(tools))
    x, z = run.x[:, 0, 0], run.x[:, 0, 2]
    on = (x < -0.1) & (run.times > 0.6)
    report.check("speed on the belt [m/s]", run.v[on, 0, 0].mean(), v, 1e-4)
    start = z[on].mean()
    after = int(numpy.argmax(z < start - h))
    share = (start - h - z[after - 1]) / (z[after] - z[after - 1])
    report.check("where it has fallen 1 m [m from the end]", x[after - 1] + share * (x[after] - x[after - 1]), v * math.sqrt(2 * h / G), 2e-3)


@case("K4", "U", "load of a belt that is fed steadily", "rate / v")
def k4(tools, report):
    rate, v, length, warm = 2.0, 0.5, 0.5, 2.2
    c = Case("K4", duration=4.2, every=0.02, gravity=(0, 0, -G), margin=1.2e-3, seed=2)
    c.mesh("cube", meshes.box((0.03, 0.03, 0.03)))
    c.material("m", 2000.0)
    c.pair_all(stiffness=5e4, restitution=0.2, friction=0.6)
    c.inlet(shape="cube", material="m", rate=rate, region={"box": [[-0.1, -0.15, 0.06], [0.0, 0.15, 0.12]]}, velocity=(v, 0, -0.3))
    c.wall({"plate": {"corner": [-0.3, -0.3, 0], "side_a": [1.5, 0, 0], "side_b": [0, 0.6, 0]}}, "m", surface={"velocity": [v, 0, 0]})
    c.outlet(region={"box": [[0.75, -0.5, -0.5], [2, 0.5, 0.5]]})
    run = report.run(c.run(tools))
    mass = {r["id"]: float(r["mass"]) for r in run.inserted}
    came = {r["id"]: (float(r["time"]), float(r["x"])) for r in run.inserted}
    report.at_least("bodies that left by the belt's end", len(run.removed), 40)
    # of what left: how long each was between the feed and the end; the belt carries rate times that
    steady = [r for r in run.removed if float(r["time"]) > warm]
    speed = [(float(r["x"]) - came[r["id"]][1]) / (float(r["time"]) - came[r["id"]][0]) for r in steady]
    report.check("speed of what is carried [m/s]", sum(speed) / len(speed), v, 0.02)
    log = run.log
    late = log["time"] > warm
    there = (log["inserted_mass"] - log["removed_mass"])[late].mean()
    way = sum(float(r["x"]) - came[r["id"]][1] for r in steady) / len(steady)
    report.check("load of the belt [kg/m]", there / way, rate / v, 0.02)
    report.check("mass that came in [kg]", math.fsum(mass.values()), rate * 4.2, 0.5 * max(mass.values()) / (rate * 4.2))


@case("K5", "U", "a block on a turntable that travels, and one that orbits", "rests on it: slips by no more than its springs give way; the work that gives it its energy")
def k5(tools, report):
    rate, v, R, m_side = 4.0, 0.6, 0.15, 0.03
    turn = {"rotate": {"axis": [0, 0, 1], "centre": [0, 0, 0], "rate": rate}}
    along = {"translate": {"velocity": [v, 0, 0]}}
    for name, motion in (("travels", [turn, along]), ("orbits", [along | {"stop": 0.25}, turn])):
        c = Case(f"K5{name[0]}", duration=1.5, every=0.1, gravity=(0, 0, -G), margin=3e-4)
        c.mesh("block", meshes.box((m_side, m_side, 0.01)))
        c.material("m", 1000.0)
        stiffness, mu = 1e5, 0.8
        c.pair_all(stiffness=stiffness, restitution=0.1, friction=mu)
        mass = 1000.0 * m_side**2 * 0.01
        deep = mass * G / stiffness / 4**(1 / 8)
        c.body("block", "m", (R, 0, 0.005 - deep), velocity=(v, rate * R, 0), angular_velocity=(0, 0, rate))
        c.wall({"plate": {"corner": [-0.4, -0.4, 0], "side_a": [0.8, 0, 0], "side_b": [0, 0.8, 0]}}, "m", motion=motion)
        run = report.run(c.run(tools))
        place, turned = numpy.array(run.wall_position)[:, 0], numpy.array(run.wall_orientation)[:, 0]
        t = run.times
        angle = rate * t
        if name == "travels":
            exact = numpy.stack([v * t, 0 * t, 0 * t], axis=1)
        else:   # the plate goes first, and what it has gone turns about the centre that stays
            gone = v * numpy.minimum(t, 0.25)
            exact = numpy.stack([gone * numpy.cos(angle), gone * numpy.sin(angle), 0 * t], axis=1)
        report.at_most(f"{name}: place of the plate [m]", abs(place - exact).max(), 1e-12)
        apart = 2 * numpy.arctan2(turned[:, 3], turned[:, 0]) - angle
        report.at_most(f"{name}: its turn [rad]", abs((apart + math.pi) % (2 * math.pi) - math.pi).max(), 1e-9)
        if name == "orbits":   # it starts against what the plate does, and slides first: only the plate is told
            continue
        local = rotated(turned * [1, -1, -1, -1], run.x[:, 0] - place)
        # friction carries it around: the springs of four corners give way by m w^2 r over their stiffness, some microns
        give = mass * rate**2 * R / (2 / 7 * stiffness * 4**(1 / 8))
        report.at_most(f"{name}: way of the block on the plate, over what its springs give way", numpy.linalg.norm(local[1:, :2] - local[1, :2], axis=1).max() / give, 2.5)
        speed = numpy.linalg.norm(run.v[-1, 0] - [v, 0, 0])
        report.check(f"{name}: its speed about the hub [m/s]", speed, rate * R, 1e-3)
