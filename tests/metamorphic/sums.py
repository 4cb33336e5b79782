"""What must add up within one run: momentum, energy, forces; and what an impact and a rest must be."""
import math

import numpy

from geometry import turned
from model import Case
from relations import NotApplicable, relation, require

kSumRounding = 1e-11     # of what is summed: a sum of some thousand steps and a hundred contacts

# what damping may give back, of what is in motion: the work of a step is taken with the mean velocity, its force with that of half a step before
kReturned = 1e-6


def swings_of_springs(run):
    """What friction springs make the dissipated energy swing by [J]: their way is that of the velocity of half a step before, their work that of the mean
    velocity. So a row within a contact is off by up to (w dt)^2 / 2 of what they store, which comes back as the contact ends. With w the highest frequency,
    that is 2 (dt / critical step)^2."""
    if "critical_step" not in run.log or len(run.log["step"]) < 2:
        return 0.0
    steps, critical = numpy.diff(run.column("step")), run.column("critical_step")
    size = (numpy.diff(run.column("time")) / numpy.maximum(steps, 1)).max()
    return 2 * (size / critical[critical > 0].min(initial=numpy.inf)) ** 2 * run.column("elastic_tangential").max()


def moving_masses(run):
    scene = run.scene
    return scene.masses() * scene.moving()


def rows_at_frames(run):
    """Pairs of a row of the log and a frame of the same step."""
    rows = {int(step): i for i, step in enumerate(run.log["step"])}
    return [(rows[f.attributes["step"]], f) for f in run.frames if f.attributes["step"] in rows]


def no_removal(run):
    if run.record["removed_bodies"] or run.record["lost_bodies"] or run.record.get("inserted_bodies"):
        raise NotApplicable("bodies came or went")


def spin_energy(shape, quat, spin):
    """Twice that of a body of scale and density 1."""
    own = turned(quat, numpy.eye(3)) @ spin   # in axes of the mesh
    return own @ numpy.asarray(shape["inertia"]).reshape(3, 3) @ own


def inertia_in_world(scene, i, quat):
    shape = scene.shapes[scene.body("shape")[i]]
    density = scene.materials[scene.body("material")[i]]["density"]
    inertia = numpy.asarray(shape["inertia"]).reshape(3, 3) * density * scene.body("scale")[i] ** 5
    columns = turned(quat, numpy.eye(3))   # rows: images of the axes
    return columns.T @ inertia @ columns


# how the self-test breaks them

def faster(run):
    run.frames[-1].velocity[:] += 1e-6 * (1 + numpy.abs(run.frames[-1].velocity).max())


def spinning(run):
    run.frames[-1].spin[:] += 1e-6 * (1 + numpy.abs(run.frames[-1].spin).max())


def more_dissipated(run):
    column = run.log["dissipated"]
    column[len(column) // 2] = repr(float(column[len(column) // 2]) + 10 * abs(run.record["energy"]["kinetic_peak"]) + 1)


def more_kinetic(run):
    run.log["kinetic_translational"] = [repr(1.001 * float(x) + 1e-30) for x in run.log["kinetic_translational"]]


def another_wall_force(run):
    for frame in run.frames:
        frame.walls["force"] = frame.walls["force"] * 1.001


# ---- one run

@relation("sums", faster)
def momentum(trial):
    """Changes by gravity and by what the walls take, and by nothing else."""
    run = trial.completed()
    no_removal(run)
    if "fluid" in run.scene.general or (~run.scene.moving()).any() or trial.case.value("motion", "integrator") == "euler":
        raise NotApplicable("a fluid or fixed bodies take momentum too; euler's kicks are not those of the log")
    if trial.case.value("time", "sleep"):
        raise NotApplicable("what sleeps does not answer to forces below its tolerance")
    trial.seen(run)
    mass, gravity = moving_masses(run), numpy.array(run.scene.general["gravity"])
    first = (mass[:, None] * run.frames[0].velocity).sum(axis=0)
    walls = [wall["id"] for wall in run.scene.walls]
    for row, frame in rows_at_frames(run):
        impulse = numpy.array([[float(run.log[f"wall{w}_impulse_{axis}"][row]) for axis in "xyz"] for w in walls]).reshape(-1, 3)
        now = (mass[:, None] * frame.velocity).sum(axis=0)
        pulled = mass.sum() * gravity * frame.time
        scale = sum((mass * numpy.linalg.norm(f.velocity, axis=1)).sum() for f in run.frames) + numpy.abs(impulse).sum() + numpy.abs(pulled).sum()
        error = numpy.abs(now - first - pulled + impulse.sum(axis=0)).max()
        require(error <= kSumRounding * scale, f"momentum at t = {frame.time:.6g} s is off by {error:.3g} N s, {error / scale if scale > 0 else 0:.3g} of what was exchanged: "
                f"{now.tolist()}, began with {first.tolist()}, gravity gave {pulled.tolist()}, walls took {impulse.sum(axis=0).tolist()}")


@relation("sums", spinning)
def angular_momentum(trial):
    """About the centre of mass of bodies that nothing else touches."""
    run = trial.completed()
    no_removal(run)
    scene = run.scene
    if scene.walls or "fluid" in scene.general or (~scene.moving()).any() or scene.body("lock_rotation").any() or any(
            scene.general.get("domain", {}).get("periodic", [False])):
        raise NotApplicable("something else takes angular momentum")
    trial.seen(run)
    mass = scene.masses()

    def momenta(frame):
        x = frame.position - (mass[:, None] * frame.position).sum(axis=0) / mass.sum()
        v = frame.velocity - (mass[:, None] * frame.velocity).sum(axis=0) / mass.sum()
        orbit = mass[:, None] * numpy.cross(x, v)
        spin = numpy.array([inertia_in_world(scene, i, frame.quat[i]) @ frame.spin[i] for i in range(len(mass))])
        return (orbit + spin).sum(axis=0), float(numpy.linalg.norm(orbit, axis=1).sum() + numpy.linalg.norm(spin, axis=1).sum() +
                                                 (mass * numpy.linalg.norm(x, axis=1) * numpy.linalg.norm(frame.velocity, axis=1)).sum())
    first, scale = momenta(run.frames[0])
    for frame in run.frames:
        now, size = momenta(frame)
        scale = max(scale, size)
        error = numpy.abs(now - first).max()
        require(error <= 10 * kSumRounding * scale, f"angular momentum at t = {frame.time:.6g} s is off by {error:.3g}, {error / scale:.3g} of what there is")


@relation("sums", more_kinetic)
def energies_of_frames(trial):
    """Kinetic and potential energy of the log are those of the bodies in the frames, whether bodies come and go or not."""
    run = trial.completed()
    trial.seen(run)
    scene = run.scene
    gravity = numpy.array(scene.general["gravity"])
    if "fluid" in scene.general or any(scene.general.get("domain", {}).get("periodic", [False])):
        gravity = gravity * 0   # lighter in the fluid; images of bodies in the frames
    if run.record["removed_bodies"] or run.record.get("inserted_bodies"):
        gravity = gravity * 0   # the height of the origin counts for other masses
    fixed = {int(i) for i in scene.body("id")[~scene.moving()]}
    height = None
    for row, frame in rows_at_frames(run):
        shapes = [scene.shapes[k] for k in frame.bodies["shape"]]
        density = numpy.array([scene.materials[k]["density"] for k in frame.bodies["material"]])
        scale = frame.bodies["scale"]
        moving = numpy.array([int(i) not in fixed for i in frame.ids], bool)
        mass = density * numpy.array([shape["volume"] for shape in shapes]) * scale**3 * moving
        translational = 0.5 * (mass * (frame.velocity**2).sum(axis=1)).sum()
        rotational = sum(0.5 * density[i] * scale[i] ** 5 * spin_energy(shapes[i], frame.quat[i], frame.spin[i]) for i in numpy.flatnonzero(moving))
        for name, value in (("kinetic_translational", translational), ("kinetic_rotational", rotational)):
            logged = float(run.log[name][row])
            require(abs(logged - value) <= 1e-9 * (abs(value) + 1e-6 * translational) + 1e-300, f"{name} at t = {frame.time:.6g} s: the log has {logged!r}, the frame {value!r}")
        if gravity.any():
            potential, logged = -(mass[:, None] * frame.position @ gravity).sum(), float(run.log["potential"][row])
            if height is None:
                height = potential - logged
            size = (mass * numpy.linalg.norm(frame.position, axis=1)).sum() * numpy.linalg.norm(gravity)
            require(abs(potential - logged - height) <= 1e-9 * size, f"potential at t = {frame.time:.6g} s: the log has {logged!r}, the frame {potential - height!r}")


@relation("sums", more_dissipated)
def energy_balance(trial):
    """The columns add up to energy_error, which stays small; what is dissipated never comes back."""
    run = trial.completed()
    trial.seen(run)
    names = ("kinetic_translational", "kinetic_rotational", "potential", "elastic", "elastic_tangential", "dissipated", "wall_work", "energy_error")
    kt, kr, potential, elastic, tangential, dissipated, work, error = (run.column(name) for name in names)
    if "cell_work" in run.log:
        work = work + run.column("cell_work")
    scale = max((kt + kr).max(), numpy.abs(dissipated).max(), numpy.abs(work).max(), numpy.abs(elastic + tangential).max())
    rounding = 1e-8 * scale + 1e-12 * numpy.abs(potential).max()
    took, brought = (run.column(name) if name in run.log else 0 * kt for name in ("removed", "inserted"))
    bond, fracture, slept = (run.column(name) if name in run.log else 0 * kt for name in ("bond", "fracture", "slept"))
    balance = kt + kr + potential + elastic + tangential + dissipated - work + took - brought + bond + fracture + slept
    off = numpy.abs(balance - balance[0] - error).max()
    rounding += 1e-12 * (numpy.abs(took).max() + numpy.abs(brought).max())
    require(off <= rounding, f"the energy columns leave {off:.3g} J that energy_error does not have ({scale:.3g} J in motion)")
    if not numpy.any(run.scene.general.get("fluid", {}).get("velocity", [0, 0, 0])):   # a stream drives bodies
        apart = (elastic == 0) & (tangential == 0)   # no contact: there nothing swings
        for values, swing, where in ((dissipated, swings_of_springs(run), "any two rows"), (dissipated[apart], 0.0, "rows without contact")):
            changes = numpy.append(numpy.diff(values), 0.0)
            fall = -changes.min()
            require(fall <= rounding + kReturned * scale + swing, f"dissipated energy falls by {fall:.3g} J between {where}, {fall / max(scale, 1e-300):.3g} of "
                    f"what is in motion, at row {numpy.argmin(changes)}")
    coarse = trial.case.value("time", "steps_per_contact", 30) < 20 or trial.case.value("time", "step")
    exact = trial.case.value("motion", "integrator", "kdk-dlm") == "kdk-dlm" and trial.case.value("contact", "gather", "potential") == "potential"
    if exact and not coarse and trial.case.value("time", "step_control", "fixed") == "fixed":
        apart = (elastic + tangential) == 0   # what is off within a contact may come back as it ends
        worst = numpy.abs(error[apart]).max(initial=0)
        require(worst <= 0.05 * scale + rounding, f"energy is off by {worst:.3g} J, {worst / max(scale, 1e-300):.3g} of what is in motion")


def energy_made(run):
    run.log["energy_error"][-1] = repr(10 * run.record["energy"]["kinetic_peak"] + 1.0)


@relation("sums", energy_made)
def finer_steps_keep_energy(trial):
    """Without losses, all forces come from one potential, at concave edges too: what is off goes with the square of the step, and the finer of two runs
    is less off. A force that jumps, or is no gradient, errs by as much with any step; so does a body that comes or leaves with another energy than is
    booked."""
    case = trial.case.copy()
    words = case.words
    if case.value("contact", "gather", "potential") != "potential":
        raise NotApplicable("other ways to gather contacts have no potential of all of them")
    for name in ("motion", "fluid", "bonds"):
        words.pop(name, None)
    for key in ("sleep", "sleep_tolerance", "step_control", "stop_at_rest", "stop_when_empty", "step"):
        words["time"].pop(key, None)
    words.get("cell", {}).pop("stop_when", None)
    for wall in case.walls:
        wall.pop("wear", None)
    for pair in words.get("pairs", []):
        pair["restitution"] = 1.0
        for key in ("friction", "friction_sliding", "rolling_friction", "torsional_friction", "plasticity", "adhesive_ratio"):
            pair.pop(key, None)
        if "adhesion_hysteresis" in pair or "surface_tension" in pair:   # more work to part than to join
            for key in ("adhesion", "adhesion_model", "adhesion_hysteresis", "surface_tension", "contact_angle", "bridge_volume", "bridge_rupture"):
                pair.pop(key, None)
    steps = max(20, case.value("time", "steps_per_contact", 30))
    words["time"]["duration"] *= min(1.0, 8000 / max(1, trial.run.steps))   # five times that is computed
    off = []
    for factor in (1, 4):
        words["time"]["steps_per_contact"] = factor * steps
        run = trial.tools.solve(trial.tools.pack(case))
        if not run.completed():
            raise NotApplicable("without losses the run becomes invalid")
        if factor > 1:
            trial.seen(run)
        off.append(numpy.abs(run.column("energy_error")).max())
    scale = max(run.column(name).max() for name in ("kinetic_translational", "elastic", "kinetic_rotational"))
    scale = max([scale, *(numpy.abs(run.column(name)).max() for name in ("wall_work", "cell_work", "removed", "inserted") if name in run.log)])
    if scale == 0:
        raise NotApplicable("nothing moves")
    rounding = 1e-8 * scale + 1e-12 * numpy.abs(run.column("potential")).max()
    require(off[1] <= 0.5 * off[0] + 5e-4 * scale + rounding,
            f"energy is off by {off[0] / scale:.3g} of what is in motion with {steps:g} steps a contact, by {off[1] / scale:.3g} with four times as many")


def pressed(run):
    run.log["elastic"][0] = "1.0"


def another_came(run):
    run.record["inserted_bodies"] = run.record.get("inserted_bodies", 0) + 1


@relation("sums", another_came)
def bodies_in_and_out(trial):
    """In - out = there: number and mass, in run.json, the tables, the log and the last frame; no id came twice unless it had left; rates are kept."""
    run, case = trial.completed(), trial.case
    removes = case.value("domain", "outside") == "remove"
    if not case.words.get("inlets") and not case.words.get("outlets") and not removes:
        raise NotApplicable("no inlets, no outlets and no sides at which bodies leave")
    trial.seen(run)
    inserted, removed = (run.events(name) for name in ("inserted.csv", "removed.csv"))
    record, scene = run.record, run.scene
    require(record.get("inserted_bodies", 0) == len(inserted), f"{record.get('inserted_bodies')} came in by run.json, {len(inserted)} by the table")
    require(record["removed_bodies"] == len(removed), f"{record['removed_bodies']} left by run.json, {len(removed)} by the table")
    require(record["bodies"] == scene.count + len(inserted) - len(removed) and record["lost_bodies"] == 0,
            f"{scene.count} + {len(inserted)} - {len(removed)} bodies are not {record['bodies']}")
    there = {int(i) for i in scene.body("id")}
    for step, comes, row in sorted([(int(r["step"]), 1, r) for r in inserted] + [(int(r["step"]), 0, r) for r in removed],
                                   key=lambda e: (e[0], e[1], int(e[2]["id"]))):
        i = int(row["id"])
        require((i in there) != bool(comes), f"body {i} {'comes in' if comes else 'leaves'} at step {step} and {'is' if i in there else 'is not'} there")
        there ^= {i}
    require(there == {int(i) for i in run.frames[-1].ids}, f"the last frame has other bodies than came in and stayed: {there ^ {int(i) for i in run.frames[-1].ids}}")
    for name, events in (("inserted", inserted), ("removed", removed)):
        if f"{name}_mass" not in run.log:
            require(not events, f"{len(events)} were {name}, of which the log says nothing")
            continue
        for row, step in enumerate(run.log["step"]):
            by_now = [float(r["mass"]) for r in events if int(r["step"]) <= int(step)]
            logged = float(run.log[f"{name}_bodies"][row]), float(run.log[f"{name}_mass"][row])
            require(logged[0] == len(by_now) and abs(logged[1] - sum(by_now)) <= 1e-9 * sum(by_now),
                    f"by step {step}, {logged[0]:g} bodies of {logged[1]!r} kg are {name} in the log, {len(by_now)} of {sum(by_now)!r} kg in the table")
    for k, inlet in enumerate(record.get("inlets", [])):
        new = [float(r["mass"]) for r in inserted if r["inlet"] == inlet["name"]]
        require(len(new) == inlet["bodies"] + inlet["came_in_again"], f"inlet {k}: {len(new)} in the table, {inlet}")
        if inlet["shortfall"] == 0 and "limit" not in case.words["inlets"][k] and "count" not in case.words["inlets"][k]:
            by_number = "number_rate" in case.words["inlets"][k]
            had, one = (inlet["bodies"], 1) if by_number else (inlet["mass"], max(new, default=inlet["owed"] * 2))
            late = 32 * record["step_size"] / max(run.frames[-1].time, 1e-300) * inlet["owed"] * 4   # what is owed since the last look
            require(abs(had - inlet["owed"]) <= 0.5 * one * (1 + 1e-9) + late, f"inlet {k} let in {had}, and owed {inlet['owed']}")


@relation("sums", pressed)
def starts_unpressed(trial):
    """Nothing is stored in contacts at the start, unless the case asks for it or bodies were settled."""
    if trial.case.value("contact", "relax") is False or any(p.get("method") in ("settle", "compact") for p in trial.case.populations):
        raise NotApplicable("pressed starts were asked for")
    trial.seen(trial.run)
    stored = float(trial.run.log["elastic"][0])
    attracts = any("pull_off" in p or "adhesion" in p or "surface_tension" in p for p in trial.case.words.get("pairs", []))   # what is near holds less than none
    require(stored <= 0 if attracts else stored == 0, f"{stored:.6g} J are stored in contacts at the start")


def another_load(run):
    for frame in run.frames:
        if frame.loads:
            frame.loads["impulse"] = frame.loads["impulse"] * (1 + 1e-9)


@relation("sums", another_load)
def load_maps_bear_what_walls_bear(trial):
    """The impulses of a map's triangles add up to that of its wall; works, contacts and their energies never fall."""
    run, compared = trial.run, 0
    mapped = [wall["id"] for wall in trial.scene.walls if wall.get("load_map")]
    if not mapped or not run.frames:
        raise NotApplicable("no load map")
    for before, frame in zip(run.frames[:-1], run.frames[1:]):
        for name in ("sliding_work", "contacts", "impact_energy"):
            fallen = (before.loads[name] - frame.loads[name]).max()
            require(fallen <= 0, f"{name} of a triangle falls by {fallen:.3g} until t = {frame.time:.6g} s")
    for row, frame in rows_at_frames(run):
        for wall in mapped:
            k = list(frame.walls["id"]).index(wall)
            turned_by = [f.walls["orientation"][k] for f in run.frames if f.time <= frame.time]
            if not all(numpy.array_equal(q, turned_by[0]) for q in turned_by):
                continue   # the map goes round with the wall
            of_wall = frame.loads["impulse"][frame.loads["wall"] == wall]
            total = turned(turned_by[0], of_wall.sum(axis=0))
            logged = numpy.array([float(run.log[f"wall{wall}_impulse_{axis}"][row]) for axis in "xyz"])
            size = numpy.abs(of_wall).sum() + numpy.abs(logged).max()
            compared += size > 0
            require(numpy.abs(total - logged).max() <= kSumRounding * size,
                    f"wall {wall} at t = {frame.time:.6g} s: its map adds up to {total.tolist()}, the log has {logged.tolist()}")
    if not compared:
        raise NotApplicable("no row of the log at a frame, or nothing bears")


def another_loss(run):
    for frame in run.frames:
        if frame.losses:
            frame.losses["friction"] = frame.losses["friction"] - 1e-6 * (abs(frame.attributes["dissipated"]) + run.record["energy"]["kinetic_peak"]) - 1e-300


@relation("sums", another_loss)
def losses_by_cause_make_all_losses(trial):
    """What contacts dissipate, by pair of materials and cause, adds up to all that is dissipated where nothing else takes energy; impacts never grow fewer."""
    run, case = trial.run, trial.case
    if not case.table("output").get("impacts") or not run.frames:
        raise NotApplicable("impacts are not recorded")
    trial.seen(run)
    names = ("material_a", "material_b", "energy_from", "normal_count", "shear_count")
    counts = [{row[:3]: row[3:] for row in zip(*(f.impacts[name].tolist() for name in names))} if f.impacts else {} for f in run.frames]
    for before, now, frame in zip(counts, counts[1:], run.frames[1:]):
        for key, (normal, shear) in before.items():
            require(key in now and now[key][0] >= normal and now[key][1] >= shear, f"impacts of {key} grow fewer until t = {frame.time:.6g} s")
    others = "fluid" in trial.scene.general or "bonds" in case.words or any("wear" in wall for wall in case.walls) or \
        any(key in pair for pair in case.words.get("pairs", []) for key in ("pull_off", "adhesion", "surface_tension", "neck_adhesion", "bridge"))
    if others:
        raise NotApplicable("a fluid, bonds, wear, necks or bridges take energy too")
    for frame in run.frames:
        parts = numpy.concatenate([frame.losses[cause] for cause in ("damping", "friction", "rolling")])
        all_lost = frame.attributes["dissipated"]
        # sums of forces on bodies against sums of forces of contacts: rounding of what goes to and fro between bodies
        scale = numpy.abs(parts).sum() + abs(all_lost) + run.record["energy"]["kinetic_peak"]
        require(abs(parts.sum() - all_lost) <= 1e-9 * scale, f"t = {frame.time:.6g} s: contacts have dissipated {parts.sum():.12g} J, all together {all_lost:.12g} J")


@relation("sums", another_wall_force)
def contacts_make_wall_forces(trial):
    """The contacts of a frame add up to the force on each wall, in frame and log: exactly where nothing is damped and rubs, since contacts are
    written with the velocities of the frame and walls have the forces of the step (RUN_FORMAT.md)."""
    if not trial.scene.walls:
        raise NotApplicable("no walls")
    case = trial.case.copy()
    for pair in case.words.get("pairs", []):
        pair["restitution"] = 1.0
        for key in ("friction", "friction_sliding", "rolling_friction", "torsional_friction"):
            pair.pop(key, None)
    case.table("output").pop("contacts", None)
    run = trial.solve_case(case)
    if not run.completed():
        raise NotApplicable("without losses the run becomes invalid")
    rows = {frame.number: row for row, frame in rows_at_frames(run)}
    touched = False
    for frame in run.frames:
        c = frame.contacts
        if not c:
            continue
        force = c["normal_force"][:, None] * c["normal"] + c["tangential_force"]   # on a
        for k, wall in enumerate(frame.walls["id"]):
            on = numpy.where((c["body_a"] == wall)[:, None], force, 0) - numpy.where((c["body_b"] == wall)[:, None], force, 0)
            size = numpy.linalg.norm(on, axis=1).sum()
            touched = touched or size > 0
            error = numpy.abs(on.sum(axis=0) - frame.walls["force"][k]).max()
            require(error <= 1e-9 * max(size, numpy.abs(frame.walls["force"][k]).max()),
                    f"wall {wall} at t = {frame.time:.6g} s: contacts add up to {on.sum(axis=0).tolist()}, the frame says {frame.walls['force'][k].tolist()}")
            if frame.number in rows:
                logged = numpy.array([float(run.log[f"wall{wall}_force_{axis}"][rows[frame.number]]) for axis in "xyz"])
                require(numpy.abs(logged - frame.walls["force"][k]).max() <= 1e-9 * numpy.abs(logged).max(),
                        f"wall {wall} at t = {frame.time:.6g} s: the log has {logged.tolist()}, the frame {frame.walls['force'][k].tolist()}")
    if not touched and trial.spoil is None:
        raise NotApplicable("no frame has a contact with a wall")


@relation("sums", another_wall_force)
def weights_at_rest(trial):
    """What rests weighs on the walls what it weighs."""
    run = trial.completed()
    no_removal(run)
    if not run.record.get("came_to_rest") or (~run.scene.moving()).any() or "fluid" in run.scene.general:
        raise NotApplicable("nothing came to rest on walls")
    trial.seen(run)
    weight = moving_masses(run).sum() * numpy.array(run.scene.general["gravity"])
    force = run.frames[-1].walls["force"].sum(axis=0)
    error = numpy.abs(force - weight).max() / numpy.linalg.norm(weight)
    # the limit of rest is 1e-6 of the energy of a fall: vibrations of a thousandth of that speed
    require(error <= (0.0 if trial.spoil else 0.05), f"bodies at rest weigh {weight.tolist()} N, the walls carry {force.tolist()} N")


# ---- an impact

def restitution_scene(trial):
    """One ball of the case thrown onto a plane, with the law of one of its pairs."""
    case = trial.case.copy()
    words = case.words
    r = trial.random
    pair = dict(r.choice(words["pairs"]))
    for key in ("friction", "friction_sliding", "rolling_friction", "torsional_friction", "pull_off", "adhesion", "adhesion_model", "adhesion_range",
                "separation_energy", "adhesion_hysteresis", "surface_tension", "contact_angle", "bridge_volume", "bridge_rupture", "plasticity", "adhesive_ratio"):
        pair.pop(key, None)
    if case.value("contact", "gather", "potential") == "pairs":
        raise NotApplicable("gather = pairs is for comparison")
    pair["between"] = ["m", "m"]
    pair["restitution"] = r.choice([0.0, 1e-5, 1e-4, 1e-3, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6, 0.9, 1.0])
    scene = trial.scene
    radius = scene.size()
    scale = float(scene.masses().max()) / (trial.case.words["materials"][pair_material(trial)]["density"] * 4 / 3 * math.pi * radius**3)
    material = dict(words["materials"][pair_material(trial)])
    material["density"] *= scale
    speed = pair.get("restitution_speed", 0.3 * max(scene.general.get("impact_speed", 0), 1e-3))
    margin = scene.general["margin"]
    per_contact = r.choice([8, 12, 20, 30, 100])
    start = radius * 1.05 + 2 * margin
    words = {"gravity": [0, 0, 0], "time": {"duration": 1.0, "steps_per_contact": per_contact},
             "shapes": {"ball": {"sphere": {"radius": radius}}}, "materials": {"m": material}, "pairs": [pair],
             "contact": dict(case.words.get("contact", {})) | {"margin": margin, "impact_speed": speed},
             "bodies": [{"shape": "ball", "material": "m", "position": [0, 0, start], "velocity": [0, 0, -speed]}],
             "walls": [{"shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "material": "m"}]}
    words["contact"].pop("relax", None)
    words["contact"].pop("margin_ratio", None)
    words["time"]["duration"] = 3 * (start - radius) / speed
    words["output"] = {"every": words["time"]["duration"] / 4}
    return Case(words), pair["restitution"], speed, per_contact


def pair_material(trial):
    return sorted(trial.case.words["materials"])[0]


@relation("sums", faster)
def no_rebound_above_arrival(trial):
    """A ball leaves a plane with the restitution that was asked for, whatever the law and the steps of a contact."""
    if trial.scene.count == 0 or not trial.case.words.get("pairs"):
        raise NotApplicable("nothing to throw")
    case, asked, speed, per_contact = restitution_scene(trial)
    for _ in range(4):
        run = trial.tools.solve(trial.tools.pack(case))
        if run.code == 5:
            raise NotApplicable("too soft: " + run.record["message"][:100])
        if float(run.log["elastic"][-1]) == 0 and run.frames[-1].velocity[0, 2] > -0.999 * speed:
            break
        case.words["time"]["duration"] *= 3
    trial.seen(run)
    got = run.frames[-1].velocity[0, 2] / speed
    most = run.column("kinetic_translational").max() / run.column("kinetic_translational")[0]
    # a coarse step's energy goes up and down within a contact, by the square of the step
    require(most <= 1 + 1 / per_contact**2, f"kinetic energy rises to {most:.6g} of that of arrival; restitution {asked} at {per_contact} steps a contact")
    fall = -numpy.diff(run.column("dissipated")).min() / run.column("kinetic_translational")[0]
    # Damping acts with the velocity of half a step before. At the turning point a step gives back at most m chi a dt (a dt)^2 / 16, with chi <= (1 - e^2) / V and
    # a <= peak V / (steps dt): an error of third order in the step, of all damping laws (laws/damping.hpp).
    peak = 3.7 if case.value("contact", "law", "linear") == "hertz-mindlin" else math.pi
    require(fall <= kReturned + (1 - asked**2) * (peak / per_contact)**3 / 8,
            f"dissipated energy falls by {fall:.3g} of that of arrival; restitution {asked} at {per_contact} steps a contact")
    error = abs(got - asked)
    require(error <= (1e-9 if trial.spoil else 0.02), f"restitution {asked} at {per_contact} steps a contact comes out as {got:.6g} ({case.value('contact', 'law', 'linear')})")


def further_on(run):
    run.frames[-1].position[:] += run.scene.size()


@relation("sums", further_on)
def rest_is_rest(trial):
    """Bodies that came to rest stay where they are when the run goes on."""
    run = trial.completed()
    no_removal(run)
    if not run.record.get("came_to_rest") or run.frames[-1].time > 0.99 * trial.case.words["time"]["duration"]:
        raise NotApplicable("nothing came to rest before the end")
    case = trial.case.copy()
    case.words["time"]["stop_at_rest"] = False
    whole = trial.solve_case(case)
    if not whole.completed() or len(whole.frames[-1].ids) != len(run.frames[-1].ids):
        require(False, f"at rest at t = {run.frames[-1].time:.6g} s, and yet: exit {whole.code}, {whole.text.strip().splitlines()[-1][:200]}")
    gone = numpy.linalg.norm(whole.frames[-1].position - run.frames[-1].position, axis=1) / run.scene.radii()
    worst = int(numpy.argmax(gone))
    require(gone[worst] <= 0.2, f"at rest at t = {run.frames[-1].time:.6g} s; body {run.frames[-1].ids[worst]} goes {gone[worst]:.3g} of its radius until {whole.frames[-1].time:.6g} s")


def another_heat(run):
    if "heat_balance" in run.log:
        row = run.log["heat_balance"]
        row[-1] = str(float(row[-1]) + 1e-3 * max(abs(float(v)) for v in run.log["heat"]))


@relation("sums", another_heat)
def heat_balance(trial):
    """Heat stored is what contacts, walls, sources and arriving bodies gave, less what leaving bodies took. Without sources and heat of contacts
    temperatures stay between those of bodies and walls."""
    run, words = trial.run, trial.case.words
    if "heat" not in words or len(run.log.get("heat_balance", [])) < 2:
        raise NotApplicable("no heat")
    trial.seen(run)
    balance, heat = run.column("heat_balance"), run.column("heat")
    # each sum rounds what bodies hold, and what passes through, which may be more where they come and go
    through = sum(numpy.abs(run.column(f"heat_{name}")).max() for name in ("arrived", "removed"))
    require(numpy.abs(balance - balance[0]).max() <= 1e-11 * (heat.max() + through), f"the balance of heat goes from {balance[0]:.17g} to {balance[-1]:.17g} J")
    entries = [entry for table in ("bodies", "populations", "inlets") for entry in words.get(table, [])] + trial.case.walls
    if words["heat"].get("friction_heat") or any("heat_source" in e or "heat_flux" in e for e in entries) or "start" in words:
        return
    given = [e["temperature"] for e in entries if "temperature" in e] + [w["exchange"]["temperature"] for w in trial.case.walls if "exchange" in w]
    known = [value for of in given for value in (of["temperature"] if isinstance(of, dict) else [of])]
    known += [words["heat"]["temperature"]] if "temperature" in words["heat"] else []
    for frame in run.frames:
        t = frame.bodies["temperature"]
        if len(t):
            require(min(known) * (1 - 1e-13) <= t.min() and t.max() <= max(known) * (1 + 1e-13),
                    f"t = {frame.time:.6g} s: temperatures from {t.min():.17g} to {t.max():.17g} K, all began between {min(known)} and {max(known)}")
