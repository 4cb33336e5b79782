"""P: contacts that yield. Restitution, force on every branch, energy, heat."""
import math

import numpy

import closed_forms as cf
import meshes
from cases_heat import box_of_rocks
from cases_start import Kept
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


@case("P5", "U", "finely meshed balls whose contacts yield and pull, on a plane and on each other: restitution, balance", "Thakur et al. 2014, by its integrals; features that share stiffness share the pull")
def p5(tools, report):
    share, adhesive, k, margin, radius = .8, .3, 1e4, .02, .5
    for level in (2, 4):
        mesh = meshes.icosphere(level, radius)
        mass = 1000 * meshes.mass_properties(mesh)[0]
        contact = math.pi * math.sqrt(mass / k)
        speed = .4 * margin * math.sqrt(k / mass)
        low = mesh[0][:, 2].min()
        for other in ("a plane", "a ball"):
            apart = 2 if other == "a ball" else 1      # reduced mass, and speed of each
            c = Case(f"P5-{level}-{other.replace(' ', '-')}", duration=4 * contact, step=contact * math.sqrt(1 - share) / 400, margin=margin, every=4 * contact)
            c.mesh("ball", mesh)
            c.material("m", 1000.0)
            c.pair_all(stiffness=k, restitution=1.0, plasticity=share, adhesive_ratio=adhesive)
            c.body("ball", "m", (0, 0, -low + 1e-9), velocity=(0, 0, -speed / apart), lock_rotation=True)
            if other == "a ball":
                c.body("ball", "m", (0, 0, low), velocity=(0, 0, speed / apart), lock_rotation=True)
            else:
                c.floor()
            run = report.run(c.run(tools))
            name = f"level {level} on {other}"
            report.check(f"{name}: restitution", run.v[-1, 0, 2] * apart / speed, cf.plastic_restitution(share, adhesive, 1.0), 2e-3, "absolute")
            total = run.energy() + run.log["dissipated"]
            report.at_most(f"{name}: energy and dissipated, deviation over the energy at the start", abs(total - total[0]).max() / total[0], 1e-4)


@case("P6", "U", "contacts that yield: the derived step, a stiffness that goes with size, elastic contacts after a start, a bed that is poured", "k2 / k1 = 1 / (1 - plasticity)")
def p6(tools, report):
    share = .99
    for name, law, stiff in (("a stiffness", None, {"stiffness": 1e4}), ("a modulus", None, {"modulus": 1e5}), ("hertz-mindlin", "hertz-mindlin", {})):
        steps = []
        for plastic in ({}, {"plasticity": share}):
            c = Case(f"P6-{name.replace(' ', '-')}", duration=1e-3, steps_per_contact=20, law=law, every=1.0, contact={"impact_speed": 1.0} if law else None)
            c.sphere("ball", R)
            c.material("m", DENSITY, **({"young": YOUNG, "poisson": 0.0} if law else {}))
            c.pair_all(restitution=1.0, **stiff, **plastic)
            c.body("ball", "m", (0, 0, 2 * R))
            c.floor()
            steps.append(report.run(c.run(tools)).step)
        report.check(f"{name}: step with a plasticity of {share:g} over that without", steps[1] / steps[0], math.sqrt(1 - share), 2e-3)

    # pressed by its weight as one that yields, then of a material that does not: of two pairs, so that some contacts yield
    def heavy(name, plasticity, place):
        c = Case(name, duration=1.0 if place else .02, gravity=(0, 0, -9.81), every=1.0 if place else .01, contacts=True)
        c.sphere("ball", R)
        c.material("m", DENSITY)
        c.material("other", DENSITY)
        c.pair("m", "m", stiffness=1e4, restitution=.2, plasticity=plasticity)
        c.pair("m", "other", stiffness=1e4, restitution=.2, plasticity=.5)
        c.pair_all(stiffness=1e4, restitution=.2)
        if place:
            c.body("ball", "m", (0, 0, R - 1e-4))
            c.body("ball", "other", (3, 0, R - 1e-4))
        c.floor()
        return c

    before = Kept(heavy("P6-before", .8, True), tools)
    after = before.start(heavy("P6-after", 0.0, False))
    run = report.run(after.run(tools))
    report.check("elastic after a start: contacts that keep what they remember", "2 contacts keep their springs" in after.pack_text, 1, 0, "absolute")
    contacts = run.contacts[0]
    assert contacts["body_a"][0] == 0
    report.check("elastic after a start from contacts that had yielded: force over overlap [N/m]", contacts["normal_force"][0] / contacts["depth"][0], 1e4, 1e-9)

    # hunt-crossley without damping: what yields is all that stops a bed
    c = Case("P6-poured", duration=.01, gravity=(0, 0, -9.81), law="hunt-crossley", every=.01)
    c.sphere("ball", .001)
    c.material("m", 1500.0)
    c.pair_all(stiffness=1000.0, restitution=1.0, plasticity=.9)
    c.population(shape="ball", material="m", count=20, method="settle", region={"box": [[-.004, -.004, 0], [.004, .004, .01]]})
    c.wall({"box_inside": [[-.004, -.004, 0], [.004, .004, .03]]}, "m")
    report.run(c.run(tools))
    report.check("a poured bed: packed without a note that it is not at rest", "not at rest" in c.pack_text, 0, 0, "absolute")


@case("P7", "U", "a bond under pressure breaks: the contact in its place begins pressed for the first time", "continuity: a contact of the energy that the bond held")
def p7(tools, report):
    side, margin = .01, 1e-4
    forces = {}
    for name, plastic in (("elastic", {}), ("yields", {"plasticity": .8}), ("yields and pulls", {"plasticity": .8, "adhesive_ratio": .5})):
        c = Case(f"P7-{name.replace(' ', '-')}", duration=4e-5, step=1e-7, margin=margin, every=4e-7, contacts=True, contact={"surface": "outside"})
        c.mesh("cube", meshes.box((side - 2 * margin, side, side)))
        c.material("m", 2500.0)
        c.pair_all(stiffness=1e8, restitution=1.0, **plastic)
        c.bond(between=["m", "m"], distance=3 * margin, young=3e8, tangential_ratio=1.0, tension=1e9, cohesion=5e4, friction_angle=0)
        c.body("cube", "m", (0, 0, 0), fixed=True)
        c.body("cube", "m", (side, 0, 0), lock_rotation=True, velocity=(-.3, .25, 0))
        run = report.run(c.run(tools))
        first = next(contacts for contacts in run.contacts if len(contacts["depth"]))
        forces[name] = first["normal_force"].sum()
        report.at_most(f"{name}: bonds that hold in the end", run.log["bonds"][-1], 0)
    report.at_least("elastic: force of the contact in place of the bond [N]", forces["elastic"], 10)
    for name in ("yields", "yields and pulls"):   # the same energy, F^2 / 2 k2
        report.check(f"{name}: force in the first frame after the break, over that of an elastic contact", forces[name] / forces["elastic"], math.sqrt(5), .02)
