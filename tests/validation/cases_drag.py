"""D: drag and buoyancy of bodies in a fluid, each alone."""
import math
import os

from registry import case_of
from scene import Case

CASES = []
case = case_of(CASES)

WATER = {"density": 998.0, "viscosity": 1.0e-3}
G = 9.81


def fall(name, fluid, density, duration, step, every, **more):
    c = Case(name, duration=duration, step=step, every=every, gravity=(0, 0, -G), margin=1e-5)
    c.tables["fluid"] = {**fluid, **more}
    c.material("m", density)
    c.pair_all(stiffness=1e3, restitution=1.0)
    return c


@case("D1", "U", "a ball in oil falls, and stops spinning", "Stokes; Kirchhoff; Archimedes")
def d1(tools, report):
    d, density, oil = 2e-3, 2500.0, {"density": 900.0, "viscosity": 0.5}
    rate, terminal = 18 * oil["viscosity"] / (density * d * d), (density - oil["density"]) * G * d * d / (18 * oil["viscosity"])
    for step in (1e-5, 1e-3):  # the longer one is nearly the relaxation time
        c = fall(f"D1-{step:g}", oil, density, 3e-2, step, 1e-3, drag="stokes")
        c.body(c.sphere("ball", d / 2), "m", (0, 0, 0), angular_velocity=(0, 30, 0))
        run = report.run(c.run(tools))
        t = run.times[1]
        report.check(f"step {step:g}: speed after 1 ms [m/s]", -run.v[1, 0, 2], terminal * (1 - math.exp(-rate * t)), 1e-9)
        report.check(f"step {step:g}: terminal speed [m/s]", -run.v[-1, 0, 2], terminal, 1e-6)
        report.check(f"step {step:g}: spin after 1 ms [rad/s]", run.w[1, 0, 1], 30 * math.exp(-10 / 3 * rate * t), 1e-9)
    c = fall("D1-floats", {**oil, "density": density}, density, 1e-2, 1e-3, 1e-2)
    c.body(c.sphere("ball", d / 2), "m", (0, 0, 0))
    run = report.run(c.run(tools))
    report.at_most("distance moved by a ball of the density of the fluid [m]", abs(run.x[-1, 0]).max(), 0)


@case("D2", "U", "tetrahedra, cubes and octahedra fall in water", "Pettyjohn and Christiansen, Chem. Eng. Prog. 44 (1948) 157")
def d2(tools, report):
    volume, density = 1e-6, 2500.0
    d = (6 / math.pi * volume) ** (1 / 3)
    for shape, edge, faces in (("tetrahedron", (6 * math.sqrt(2) * volume) ** (1 / 3), math.sqrt(3)), ("cube", volume ** (1 / 3), 6.0),
                               ("octahedron", (3 / math.sqrt(2) * volume) ** (1 / 3), 2 * math.sqrt(3))):
        path = os.path.join(tools.scratch, f"{shape}.shape.h5")
        tools.call("scree-mesher", "generate", shape, "--size", repr(edge), "-o", path)
        c = fall(f"D2-{shape}", WATER, density, 5.0, 1e-3, 5.0)
        c.body(c.shape_file(shape, path), "m", (0, 0, 0))
        run = report.run(c.run(tools))
        sphericity = math.pi * d * d / (faces * edge * edge)
        # their law of Newton's regime, which these fall in: Re = 4200 to 6000
        expected = math.sqrt(4 / 3 * (density / WATER["density"] - 1) * G * d / (5.31 - 4.88 * sphericity))
        report.check(f"{shape}: terminal speed [m/s]", -run.v[-1, 0, 2], expected, 0.05, note="two published fits")
        report.at_most(f"{shape}: error of the energy balance, over what the fluid took", abs(run.log["energy_error"][-1]) / run.log["dissipated"][-1], 1e-3)
