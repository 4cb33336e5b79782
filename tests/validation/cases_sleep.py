"""Y: bodies that sleep."""
import math

import numpy

from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)
G = 9.81


@case("Y1", "U", "a slope that is tilted in stages, with sleep in the rests between", "slides where tan(angle) passes the coefficient of friction")
def y1(tools, report):
    mu, radius, rate, rest = 0.5, 0.002, 20.0, 0.3
    limit = math.degrees(math.atan(mu))
    angles = [10.0, 20.0, limit - 0.05, limit + 0.05]
    time, before, motions, rests = 0.1, 0.0, [], []
    for angle in angles:
        stop = time + (angle - before) / rate
        motions.append({"rotate": {"axis": [0, 1, 0], "centre": [0, 0, 0], "rate": math.radians(rate)}, "start": time, "stop": stop})
        rests.append((stop, stop + rest))
        time, before = stop + rest, angle
    slides = 0.4
    c = Case("Y1", duration=time + slides, gravity=(0, 0, -G), margin=0, every=0.005, time={"sleep": True}, contact={"impact_speed": 0.1})
    c.sphere("block", radius)
    c.material("m", 2500.0)
    c.pair_all(stiffness=1e5, restitution=0.3, friction=mu)
    c.body("block", "m", (0, 0, radius), lock_rotation=True)
    c.floor(motion=motions)
    run = report.run(c.run(tools))
    log = run.log
    for (begin, end), angle in list(zip(rests, angles))[:-1]:
        late = (log["time"] > begin + 0.7 * rest) & (log["time"] < end)
        report.check(f"bodies asleep at {angle:.3f} degrees", log["asleep"][late].min(), 1, 0, "absolute")
        turning = (log["time"] > end + 1e-4) & (log["time"] < end + 1e-3)
        if turning.any():
            report.check(f"bodies asleep as it turns on from {angle:.3f} degrees", log["asleep"][turning].max(), 0, 0, "absolute")
    late = run.times > rests[-1][0] + 0.1
    alpha = math.radians(angles[-1])
    downhill = numpy.array([math.cos(alpha), 0, -math.sin(alpha)])
    a = G * (math.sin(alpha) - mu * math.cos(alpha))
    report.check(f"acceleration at {angles[-1]:.3f} degrees [m/s^2]", numpy.polyfit(run.times[late], run.v[late, 0] @ downhill, 1)[0], a, 2e-2)
    report.check("bodies asleep while it slides", log["asleep"][log["time"] > rests[-1][0] + 0.1].max(), 0, 0, "absolute")


def chain(balls, power, step=1e-4):
    """Speeds of a row of balls of mass 1 that touch, after the first came with speed 1, with forces overlap^power: Runge-Kutta of fourth order."""
    x, v = numpy.zeros(balls), numpy.zeros(balls)
    v[0] = 1

    def acceleration(x):
        push = numpy.clip(x[:-1] - x[1:], 0, None)**power
        return numpy.append(0, push) - numpy.append(push, 0)

    while True:
        k1 = acceleration(x)
        k2 = acceleration(x + step / 2 * v)
        k3 = acceleration(x + step / 2 * v + step**2 / 4 * k1)
        k4 = acceleration(x + step * v + step**2 / 2 * k2)
        x, v = x + step * v + step**2 / 6 * (k1 + k2 + k3), v + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if (x[:-1] < x[1:]).all():
            return v


@case("Y2", "U", "a ball strikes four that touch and sleep", "the equations of the row of five, integrated by themselves; awake or asleep, the same to 1e-3")
def y2(tools, report):
    radius, speed = 0.01, 0.5
    for law, power, values, young in (("linear", 1.0, {"stiffness": 1e6}, {}), ("hertz-mindlin", 1.5, {}, {"young": 2e9, "poisson": 0.3})):
        speeds = {}
        for sleeps in (False, True):
            c = Case(f"Y2_{law}_{'asleep' if sleeps else 'awake'}", duration=0.17, step=4e-6, gravity=(0, 0, -G), margin=0, law=law, every=0.01,
                     time={"sleep": sleeps}, contact={"impact_speed": 1})
            c.sphere("ball", radius)
            c.material("steel", 7800.0, **young)
            c.material("ice", 1000.0, **young)
            c.pair("steel", "steel", restitution=1, friction=0, **values)
            c.pair("steel", "ice", restitution=0.1, friction=0, **values)
            for x, v in ((-0.062, speed), (0, 0), (0.02, 0), (0.04, 0), (0.06, 0)):
                c.body("ball", "steel", (x, 0, radius), velocity=[v, 0, 0], lock_rotation=True)
            c.floor("ice")
            run = report.run(c.run(tools))
            speeds[sleeps] = run.v[-1, :, 0] / speed
            if sleeps:
                report.check(f"{law}: bodies asleep before", run.log["asleep"].max(), 4, 0, "absolute")
                report.check(f"{law}: bodies asleep after", run.log["asleep"][-1], 0, 0, "absolute")
        expected = chain(5, power)
        report.at_most(f"{law}: speeds, awake and asleep apart, over that of the first", abs(speeds[True] - speeds[False]).max(), 1e-3)
        for k in (0, 4):
            report.check(f"{law}: speed of ball {k + 1}, over that of the first", speeds[True][k], expected[k], 1e-3, "absolute")
