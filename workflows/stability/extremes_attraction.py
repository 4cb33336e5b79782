"""X cases about attraction: stiff, narrow and fast (X32)."""
import math

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, ToolError
from verdicts import FAILED, finite

CASES = []
_mark = case_of(CASES)
G = cf.GRAVITY


def case(name, title):
    return _mark(name, "X", title)


def cluster(name, words, shape="ball", k=1e4, duration=.2, **more):
    """27 bodies of 1 g and 5 mm that fall onto each other from all sides, without gravity."""
    c = Case(name, duration=duration, every=duration / 50, contact={"impact_speed": .3}, **more)
    if shape == "ball":
        c.sphere("body", 5e-3)
        density = 1e-3 / (4 / 3 * math.pi * 5e-3**3)
    else:
        c.mesh("body", meshes.box((8e-3, 8e-3, 8e-3)))
        density = 1e-3 / 8e-3**3
    hertz = more.get("law") == "hertz-mindlin"
    c.material("m", density, **({"young": 1e7, "poisson": .3} if hertz else {}))
    c.pair("m", "m", restitution=.5, friction=.5, **({} if hertz else {"stiffness": k}), **words)
    for i in range(27):
        cell = numpy.array([i % 3, i // 3 % 3, i // 9]) - 1
        turn = numpy.array((1, .1 * cell[0], .2 * cell[1], .3 * cell[2]))
        c.body("body", "m", cell * 15e-3, velocity=-cell * .1, orientation=turn / numpy.linalg.norm(turn))
    return c


def held(tools, table, what, c):
    """Finite, with kinetic, stored and dissipated energy that keep their sum: to a tenth, since steps here are few for what they cross."""
    try:
        run = c.run(tools)
    except ToolError as error:
        table.add(what, FAILED, f"refused: {error.text.strip()[-200:]}")
        return
    table.truth(f"{what}: finite", finite(run), "finite")
    total = run.energy() + run.log["dissipated"]
    table.figure(f"{what}: change of all energy over that dissipated", abs(total - total[0]).max() / run.log["dissipated"].max(), 0.1)


@case("X32", "attraction: huge, stiff, of no range and of one that is larger than a body")
def x32(tools, table):
    weight = 1e-3 * G
    for bond in (1, 100, 1e4):
        held(tools, table, f"Bond number {bond:g}, balls", cluster("X32", {"pull_off": bond * weight, "adhesion_range": 5e-5}, k=1e4 * max(1, bond / 100), duration=.2 if bond < 1e4 else .08))
    held(tools, table, "Bond number 1000, cubes", cluster("X32", {"pull_off": 1000 * weight, "adhesion_range": 5e-5}, "cube", k=1e5, margin=2e-4))
    held(tools, table, "attraction 100 times as stiff as the contact", cluster("X32", {"pull_off": 1.0, "adhesion_range": 1e-6}, duration=.08))
    for what, value, says in (("range of 0", 0.0, "expected a value > 0"), ("range as wide as a body", 1.01e-2, "further than body")):
        table.must_refuse(what, lambda: cluster("X32", {"pull_off": weight, "adhesion_range": value}).run(tools), says)
    held(tools, table, "bridges that hold 1000 weights", cluster("X32", {"surface_tension": 1000 * weight / (4 * math.pi * 2.5e-3), "bridge_volume": 1e-12}, k=1e5))
    held(tools, table, "bridges of cubes", cluster("X32", {"surface_tension": .072, "bridge_volume": 1e-9}, "cube", margin=2e-4))
    for work in (.1, 10, 1000):
        held(tools, table, f"necks of {work:g} J/m^2",
             cluster("X32", {"adhesion": work, "adhesion_model": "jkr", "adhesion_hysteresis": True}, law="hertz-mindlin", margin=1e-3))
    area = {"layer_modulus": 1e6, "adhesion": 1.0, "adhesion_range": 5e-5}
    c = cluster("X32", area, "cube", margin=2e-4, gather="area")
    c.pairs[("m", "m")].pop("stiffness")
    held(tools, table, "cubes that stick by area", c)
