"""P: contacts that yield. Restitution, force on every branch, energy, heat."""
import math

import numpy

import closed_forms as cf
import meshes
from cases_heat import box_of_rocks
from registry import case_of
from scene import Case, quaternion, rotated

CASES = []
case = case_of(CASES)

PHASES = 7
LOADS = ((.2, 0.0), (.5, 0.0), (.8, 0.0), (.95, 0.0), (.5, .1), (.8, .05), (.8, .2))   # plasticity, adhesive_ratio
R, YOUNG = .5, 2e6
DENSITY = 1 / (4 / 3 * math.pi * R**3)


def thrown(name, law, steps, loads, speed, damped=1.0, every=1.0, contacts=False, phases=PHASES, duration=4):
    """Balls of mass 1 that fall on a plane: one for each pair of plasticity and adhesion, and phase of the first contact within a step. The step is a share of
    the contact of the steepest of them."""
    hertz = law == "hertz-mindlin"
    loading = math.pi / math.sqrt(1e4) if not hertz else cf.hertz_impact(1.0, speed, YOUNG, R)[2]
    dt = loading / steps * math.sqrt(1 - max(share for share, _ in loads))
    c = Case(name, duration=duration * loading, step=dt, law=law, every=every, contacts=contacts, contact={"impact_speed": speed} if hertz else None)
    c.sphere("ball", R)
    c.material("floor", DENSITY, **({"young": 2 * YOUNG, "poisson": 0.0} if hertz else {}))
    for i, (share, adhesive) in enumerate(loads):
        c.material(f"m{i}", DENSITY, **({"young": 2 * YOUNG, "poisson": 0.0} if hertz else {}))
        c.pair(f"m{i}", "floor", restitution=damped, plasticity=share, **({"adhesive_ratio": adhesive} if adhesive else {}), **({} if hertz else {"stiffness": 1e4}))
    c.pair_all(restitution=1.0, **({} if hertz else {"stiffness": 1e4}))
    for i in range(len(loads)):
        for j in range(phases):
            c.body("ball", f"m{i}", (2 * j, 2 * i, R + speed * dt * (1 + (j + .5) / phases)), velocity=(0, 0, -speed), lock_rotation=True)
    c.floor("floor")
    return c


@case("P1", "U", "contacts that yield: restitution, and what yielding takes", "Walton and Braun 1986; Thakur et al. 2014, by its integrals")
def p1(tools, report):
    for law, n in (("linear", 1.0), ("hertz-mindlin", 1.5)):
        for steps, limit in ((30, 4e-4), (120, 4e-5)):
            run = report.run(thrown(f"P1-{law}-{steps}", law, steps, LOADS, 1.0).run(tools))
            v = run.v[-1, :, 2].reshape(len(LOADS), PHASES)
            worst, taken = 0.0, 0.0
            for row, (share, adhesive) in zip(v, LOADS):
                expected = cf.plastic_restitution(share, adhesive, n)
                worst = max(worst, numpy.abs(row**2 - expected**2).max())
                taken += PHASES * .5 * (1 - expected**2)
                if steps == 120:
                    report.check(f"{law}, plasticity {share:g}, adhesive ratio {adhesive:g}: restitution", row.mean(), expected, 1e-4, "absolute")
            report.at_most(f"{law}, {steps} steps in the steepest contact: energy after over before, worst deviation", worst, limit)
            report.check(f"{law}, {steps} steps: dissipated, over the energy of all", run.log["dissipated"][-1] / (.5 * v.size), taken / (.5 * v.size), limit, "absolute")
    report.check("closed form: no adhesion, linear", cf.plastic_restitution(.8, 0.0, 1.0), math.sqrt(.2), 1e-14)
    # a damped contact has one dashpot, 2 zeta sqrt(m k2), pressed and unloaded
    damped, share = .7, .5
    run = report.run(thrown("P1-damped", "linear", 120, ((share, 0.0),), 1.0, damped=damped).run(tools))
    report.check("plasticity .5 with restitution .7 of damping", run.v[-1, :, 2].mean(), cf.damped_plastic_restitution(share, damped), 1e-4, "absolute")


@case("P2", "U", "contacts that yield: the force in frames on every branch, stuck balls", "Thakur et al. 2014, equations with the largest overlap")
def p2(tools, report):
    for law, n in (("linear", 1.0), ("hertz-mindlin", 1.5)):
        loads = ((.8, .6), (.5, .2), (.6, 0.0))
        c = thrown(f"P2-{law}", law, 60, loads, 1.0, phases=1, duration=4)
        c.tables["output"]["every"] = c.tables["time"]["step"]
        c.tables["output"]["contacts"] = True
        run = report.run(c.run(tools))
        stiffness = 1e4 if n == 1 else 4 / 3 * YOUNG * math.sqrt(R)
        for body, (share, adhesive) in enumerate(loads):
            contact = cf.Eepa(stiffness, share, adhesive, n)
            worst, largest, branches = 0.0, 0.0, set()
            for frame in run.contacts:
                for row in numpy.nonzero(frame["body_a"] == body)[0]:
                    force = contact.force(frame["depth"][row])
                    branches.add(contact.branch)
                    worst, largest = max(worst, abs(force - frame["normal_force"][row])), max(largest, abs(force))
            report.at_most(f"{law}, plasticity {share:g}, adhesive ratio {adhesive:g}: force in frames against the published one, over the largest", worst / largest, 1e-9)
            report.check(f"{law}, plasticity {share:g}, adhesive ratio {adhesive:g}: branches that it went through", len(branches), 3 if adhesive else 2, 0, "absolute")
        total = run.energy() + run.log["dissipated"]
        report.at_most(f"{law}: energy and dissipated, deviation over the energy at the start", abs(total - total[0]).max() / total[0], 5e-4)


@case("P3", "U", "a cube that yields lands on a face, an edge, a corner: the same restitution", "Walton and Braun 1986; one dent for all features of a pair")
def p3(tools, report):
    k, side, margin, share = 1e4, .5, .01, .75
    turns = {"face": (1.0, 0, 0, 0), "edge": quaternion((1, 0, 0), math.pi / 4), "corner": quaternion((1, -1, 0), math.acos(1 / math.sqrt(3)))}
    mesh = meshes.box((side, side, side))
    mass = 1000 * side**3
    speed = .25 * margin * math.sqrt(k / mass)
    dt = math.pi * math.sqrt(mass / k) / 400
    c = Case("P3", duration=3 * math.pi * math.sqrt(mass / k), step=dt, margin=margin, every=1.0)
    c.mesh("cube", mesh)
    c.material("m", 1000.0)
    c.pair_all(stiffness=k, restitution=1.0, plasticity=share)
    for i, turn in enumerate(turns.values()):
        corners = numpy.array([rotated(turn, p) for p in mesh[0]])
        c.body("cube", "m", (2 * i, 0, -corners[:, 2].min() + .5 * speed * dt), orientation=turn, velocity=(0, 0, -speed), lock_rotation=True)
    c.floor()
    run = report.run(c.run(tools))
    for i, name in enumerate(turns):
        report.check(f"on its {name}: restitution", run.v[-1, i, 2] / speed, math.sqrt(1 - share), 5e-5)


@case("P4", "U", "what contacts that yield take: in the balance, in losses of pairs, as heat", "dissipated = sum of losses by cause = heat made; E (1 - e^2) along the normal alone")
def p4(tools, report):
    c = thrown("P4-thrown", "linear", 60, LOADS, 1.0)
    c.tables["output"]["impacts"] = True
    run = report.run(c.run(tools))
    losses, energy = run.losses[-1], .5 * PHASES
    for i, (share, adhesive) in enumerate(LOADS):
        of_pair = losses["material_b"] == i + 1   # materials are in the order of their names: the floor is material 0
        for cause, expected in (("damping", 1 - cf.plastic_restitution(share, adhesive, 1.0)**2), ("friction", 0.0), ("rolling", 0.0)):
            report.check(f"plasticity {share:g}, adhesive ratio {adhesive:g}: losses by {cause}, over the energy before", losses[cause][of_pair].sum() / energy, expected, 1e-4, "absolute")
    for adhesive in (0.0, .1):
        pair = {"restitution": .8, "plasticity": .5} | ({"adhesive_ratio": adhesive} if adhesive else {})
        c = box_of_rocks(f"P4-box-{adhesive:g}", 1e-5, .2, pair=pair, impacts=True)
        run = report.run(c.run(tools))
        log, losses = run.log, run.losses[-1]
        name = f"adiabatic box, adhesive ratio {adhesive:g}"
        made = log["heat_made"][-1] + log["heat_made_in_walls"][-1]
        report.check(f"{name}: heat made over dissipated", made / log["dissipated"][-1], 1, 1e-12)
        report.check(f"{name}: losses of all pairs over dissipated", sum(losses[cause].sum() for cause in ("damping", "friction", "rolling")) / log["dissipated"][-1], 1, 1e-9)
        report.at_least(f"{name}: losses by damping, of it", losses["damping"].sum() / log["dissipated"][-1], .2)
