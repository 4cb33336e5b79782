"""Q: bodies that come into a run and leave it."""
import math

from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)

G = 9.81
DENSITY = 2000.0


def ball_mass(diameter):
    return DENSITY * math.pi / 6 * diameter**3


@case("Q1", "U", "a feed by mass: what came in, what is there, what left", "integral of the rate; free fall")
def q1(tools, report):
    c = Case("Q1", duration=3.0, every=0.5, gravity=(0, 0, -G), margin=0, seed=3)
    c.sphere("ball", 0.01)
    c.material("m", DENSITY)
    c.pair_all(stiffness=1e3, restitution=0.5, friction=0.3)
    # falls 1 m: nothing meets, since 0.2 x 0.2 m take a body each 6 ms
    c.inlet(shape="ball", material="m", size={"distribution": "uniform", "min": 0.01, "max": 0.02},
            rate={"time": [0, 1, 2], "rate": [0.0, 0.6, 0.3]}, start=0.2, region={"box": [[-0.2, -0.2, 1.0], [0.2, 0.2, 1.1]]}, velocity=(0, 0, -1))
    c.outlet(name="end", region={"box": [[-1, -1, -1], [1, 1, 0]]})
    run = report.run(c.run(tools))
    owed = 0.3 + 0.45 + 0.3 * 0.8   # two trapezia and .8 s of the last rate
    came, left = [float(r["mass"]) for r in run.inserted], [float(r["mass"]) for r in run.removed]
    report.check("mass that came in [kg], to half of the largest body", math.fsum(came), owed, 0.5 * ball_mass(0.02) / owed)
    gone = {r["id"] for r in run.removed}
    there = math.fsum(float(r["mass"]) for r in run.inserted if r["id"] not in gone)
    report.at_most("came in - left - there [kg], over what came in", abs(math.fsum(came) - math.fsum(left) - there) / math.fsum(came), 1e-15)
    report.at_most("bodies in the last frame that are not those", len({str(i) for i in run.ids} ^ ({r["id"] for r in run.inserted} - gone)), 0)
    start = {r["id"]: r for r in run.inserted}
    look = 32 * run.step
    late = [float(r["residence_time"]) - (-1 + math.sqrt(1 + 2 * G * float(start[r["id"]]["z"]))) / G for r in run.removed]
    report.at_least("bodies that left", len(late), 50)
    report.at_most("latest that a fall was seen to end, over the interval of looks", max(late) / look, 1 + 1e-9)
    report.at_least("earliest, the same, and 1", 1 + min(late) / look, 1 - 1e-9)
    energy = run.record["energy"]
    report.at_most("error of the energy balance, over the largest kinetic energy", energy["error_max"] / energy["kinetic_peak"], 1e-10)


@case("Q2", "U", "a steady feed down a slope: mean number = rate times residence time", "Little, Oper. Res. 9 (1961) 383")
def q2(tools, report):
    rate, warm = 30.0, 2.0
    c = Case("Q2", duration=14.0, every=7.0, gravity=(0, 0, -G), margin=2e-3, seed=4)
    c.sphere("ball", 0.01)
    c.material("m", DENSITY)
    c.pair_all(stiffness=3e3, restitution=0.5, friction=0.3)
    c.inlet(shape="ball", material="m", number_rate=rate, region={"box": [[-0.1, -0.05, 0.26], [-0.04, 0.05, 0.32]]})
    c.wall({"plate": {"corner": [-0.15, -0.1, 0.25], "side_a": [0.4, 0, -0.2], "side_b": [0, 0.2, 0]}}, "m")
    c.outlet(region={"box": [[-1, -1, -2], [1, 1, -0.1]]})
    run = report.run(c.run(tools))
    steady = run.log["time"] >= warm
    number = (run.log["inserted_bodies"] - run.log["removed_bodies"])[steady].mean()
    residence = [float(r["residence_time"]) for r in run.removed if float(r["time"]) >= warm]
    report.check("mean number", number, rate * sum(residence) / len(residence), 0.01)
    report.check("number that came in", len(run.inserted), rate * 14.0, 0.5 / (rate * 14.0))
