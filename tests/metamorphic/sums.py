"""What must add up: momentum, energy, forces, packings, and what post makes of a run."""
import copy
import csv
import math
import os

import h5py
import numpy

from geometry import Body, body_samples, gap, periodic_shifts, point_triangle_distances, triangle_sets_distance, turned, world_triangles
from model import Case
from relations import NotApplicable, Refused, relation, require
from tools import read_json
from transforms import product

kSumRounding = 1e-11     # of what is summed: a sum of some thousand steps and a hundred contacts


def moving_masses(run):
    scene = run.scene
    return scene.masses() * scene.moving()


def rows_at_frames(run):
    """Pairs of a row of the log and a frame of the same step."""
    rows = {int(step): i for i, step in enumerate(run.log["step"])}
    return [(rows[f.attributes["step"]], f) for f in run.frames if f.attributes["step"] in rows]


def no_removal(run):
    if run.record["removed_bodies"] or run.record["lost_bodies"]:
        raise NotApplicable("bodies were taken out")


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
        require(error <= kSumRounding * scale, f"momentum at t = {frame.time:.6g} s is off by {error:.3g} N s, {error / scale:.3g} of what was exchanged: "
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
    """Kinetic and potential energy of the log are those of the bodies in the frames."""
    run = trial.completed()
    no_removal(run)
    trial.seen(run)
    scene, mass = run.scene, moving_masses(run)
    gravity = numpy.array(scene.general["gravity"])
    if "fluid" in scene.general or any(scene.general.get("domain", {}).get("periodic", [False])):
        gravity = gravity * 0   # lighter in the fluid; images of bodies in the frames
    moving = scene.moving()
    height = None
    for row, frame in rows_at_frames(run):
        translational = 0.5 * (mass * (frame.velocity**2).sum(axis=1)).sum()
        rotational = sum(0.5 * frame.spin[i] @ inertia_in_world(scene, i, frame.quat[i]) @ frame.spin[i] for i in numpy.flatnonzero(moving))
        for name, value in (("kinetic_translational", translational), ("kinetic_rotational", rotational)):
            logged = float(run.log[name][row])
            require(abs(logged - value) <= 1e-9 * (abs(value) + 1e-6 * translational) + 1e-300, f"{name} at t = {frame.time:.6g} s: the log has {logged!r}, the frame {value!r}")
        if gravity.any():
            potential, logged = -(mass[:, None] * frame.position @ gravity).sum(), float(run.log["potential"][row])
            if height is None:
                height = potential - logged
            scale = (mass * numpy.linalg.norm(frame.position, axis=1)).sum() * numpy.linalg.norm(gravity)
            require(abs(potential - logged - height) <= 1e-9 * scale, f"potential at t = {frame.time:.6g} s: the log has {logged!r}, the frame {potential - height!r}")


@relation("sums", more_dissipated)
def energy_balance(trial):
    """The columns add up to energy_error, which stays small; what is dissipated never comes back."""
    run = trial.completed()
    trial.seen(run)
    names = ("kinetic_translational", "kinetic_rotational", "potential", "elastic", "elastic_tangential", "dissipated", "wall_work", "energy_error")
    kt, kr, potential, elastic, tangential, dissipated, work, error = (run.column(name) for name in names)
    scale = max((kt + kr).max(), numpy.abs(dissipated).max(), numpy.abs(work).max(), (elastic + tangential).max())
    rounding = 1e-8 * scale + 1e-12 * numpy.abs(potential).max()
    if not run.record["removed_bodies"]:
        balance = kt + kr + potential + elastic + tangential + dissipated - work
        off = numpy.abs(balance - balance[0] - error).max()
        require(off <= rounding, f"the energy columns leave {off:.3g} J that energy_error does not have ({scale:.3g} J in motion)")
    if not numpy.any(run.scene.general.get("fluid", {}).get("velocity", [0, 0, 0])):   # a stream drives bodies
        fall = -numpy.diff(dissipated).min(initial=0)
        require(fall <= rounding, f"dissipated energy falls by {fall:.3g} J, {fall / scale:.3g} of what is in motion, at row {numpy.argmin(numpy.diff(dissipated))}")
    coarse = trial.case.value("time", "steps_per_contact", 30) < 20 or trial.case.value("time", "step")
    exact = trial.case.value("motion", "integrator", "kdk-dlm") == "kdk-dlm" and trial.case.value("contact", "gather", "potential") == "potential"
    if exact and not coarse and trial.case.value("time", "step_control", "fixed") == "fixed":
        worst = numpy.abs(error).max()
        require(worst <= 0.05 * scale + rounding, f"energy is off by {worst:.3g} J, {worst / scale:.3g} of what is in motion")


def pressed(run):
    run.log["elastic"][0] = "1.0"


@relation("sums", pressed)
def starts_unpressed(trial):
    """Nothing is stored in contacts at the start, unless the case asks for it or bodies were settled."""
    if trial.case.value("contact", "relax") is False or any(p.get("method") in ("settle", "compact") for p in trial.case.populations):
        raise NotApplicable("pressed starts were asked for")
    trial.seen(trial.run)
    stored = float(trial.run.log["elastic"][0])
    require(stored == 0, f"{stored:.6g} J are stored in contacts at the start")


def never_refused(notes):
    notes.clear()


@relation("known", never_refused)
def is_refused(trial):
    """The tools name what is wrong with the case before anything runs."""
    notes = []
    try:
        trial.tools.pack(trial.case)
    except Refused as reason:
        notes.append(str(reason))
    trial.seen(notes)
    require(notes, "pack takes it")


@relation("sums", another_wall_force)
def contacts_make_wall_forces(trial):
    """The contacts of a frame add up to the force and torque on each wall, in frame and log."""
    run = trial.completed()
    if not run.scene.walls or not run.scene.general.get("output_contacts", True):
        raise NotApplicable("no walls, or no contacts in the frames")
    trial.seen(run)
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
    for key in ("friction", "friction_sliding", "rolling_friction", "torsional_friction"):
        pair.pop(key, None)
    if case.value("contact", "gather", "potential") == "pairs":
        raise NotApplicable("gather = pairs is for comparison")
    pair["between"] = ["m", "m"]
    pair["restitution"] = r.choice([1e-5, 1e-4, 1e-3, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6, 0.9, 1.0])
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
    require(numpy.diff(run.column("dissipated")).min() >= -1e-9 * run.column("kinetic_translational")[0],
            f"dissipated energy falls; restitution {asked} at {per_contact} steps a contact")
    error = abs(got - asked)
    require(error <= (1e-9 if trial.spoil else 0.02), f"restitution {asked} at {per_contact} steps a contact comes out as {got:.6g} ({case.value('contact', 'law', 'linear')})")


# ---- packings

def one_body_moved(scene):
    if scene.count > 1:
        order = scene.order
        scene.bodies["position"][order[-1]] = scene.bodies["position"][order[0]]
    else:
        scene.bodies["position"][:] = 1e6


@relation("sums", one_body_moved)
def packings_do_not_overlap(trial):
    """All bodies are as far apart as the margins ask, from each other and from mesh walls."""
    scene = trial.tools.pack(trial.case) if trial.spoil else trial.scene
    trial.seen(scene)
    if scene.count == 0:
        raise NotApplicable("no bodies")
    bodies = [Body(scene, i) for i in range(scene.count)]
    margin = scene.general["margin"]
    population = scene.body("population")
    methods = [p.get("method", "random") for p in trial.case.populations]
    pressed = [k >= 0 and methods[k] in ("settle", "compact") for k in population]
    shifts, fixed = periodic_shifts(scene.general), ~scene.moving()
    drawn, relax = [k >= 0 for k in population], trial.case.value("contact", "relax", "shallow")
    for i, a in enumerate(bodies):
        for j in range(i, len(bodies)):
            b = bodies[j]
            if fixed[i] and fixed[j]:
                continue
            for shift in shifts:
                if (i == j and not shift.any()) or numpy.linalg.norm(a.position - b.position - shift) > a.reach + b.reach + 2 * margin:
                    continue
                # what starts keeps two margins, unless the case says otherwise; what was settled must not overlap; balls without margins press
                kept_apart = (drawn[i] or drawn[j] or relax is not False) and not pressed[i] and not pressed[j]
                asked = 2 * margin * (1 - 1e-6) if kept_apart else 0.0
                if (pressed[i] or pressed[j]) and margin == 0:
                    asked = -0.2 * min(a.reach, b.reach)
                found = gap(a, b, shift)
                require(found >= asked - 1e-9 * a.reach, f"bodies {a.id} and {b.id} are {found:.6g} m apart, asked are {asked:.6g} m (margin {margin:.6g} m)")
    for wall in scene.walls:
        for i, body in enumerate(bodies):
            if fixed[i]:
                continue
            depth = wall_gap(scene, wall, body)
            if depth is not None:
                asked = -0.2 * body.reach if pressed[i] and margin == 0 else -1e-9 * body.reach
                require(depth >= asked, f"body {body.id} is {depth:.6g} m inside wall {wall['id']} ({wall['kind']})")


def wall_at_start(wall):
    """A wall where its motion has it at 0 s: x -> displacement + turn about the centre."""
    motion = wall.get("motion") or {}
    kind = motion.get("kind", "none") if isinstance(motion, dict) else "none"
    if kind == "none":
        return wall
    elapsed = min(max(0.0, motion["start"]), max(motion["start"], motion["stop"])) - motion["start"]
    axis, quat, centre, way = numpy.array(motion["axis"]), [1.0, 0, 0, 0], numpy.zeros(3), numpy.zeros(3)
    if kind == "rotate":
        centre, half = numpy.array(motion["centre"]), 0.5 * motion["rate"] * elapsed
        quat = [math.cos(half), *(math.sin(half) * axis)]
    elif kind == "translate":
        way = motion["rate"] * elapsed * axis
    elif kind == "oscillate":
        way = motion["amplitude"] * (math.sin(2 * math.pi * motion["frequency"] * elapsed + motion["phase"]) - math.sin(motion["phase"])) * axis
    else:
        way = numpy.array([numpy.interp(elapsed, motion["table_time"], [p[k] for p in motion["table_position"]]) for k in range(3)])

    def place(p):
        return turned(quat, numpy.atleast_2d(numpy.array(p) - centre))[0] + centre + way
    placed = dict(wall)
    for key in ("point", "axis_start", "axis_end", "lower", "upper", "position"):
        if key in wall:
            placed[key] = place(wall[key])
    if "normal" in wall:
        placed["normal"] = turned(quat, numpy.array([wall["normal"]]))[0]
    if "orientation" in wall:
        placed["orientation"] = product(quat, wall["orientation"])
    return placed


def wall_gap(scene, wall, body):
    """Distance of a body from a wall as it stands at the start; below 0 behind it."""
    wall = wall_at_start(wall)
    points = [body.position] if body.is_ball else body.triangles.reshape(-1, 3)
    radius = body.reach if body.is_ball else 0.0
    points = numpy.asarray(points)
    periodic = scene.general.get("domain", {}).get("periodic", [False] * 3)
    if wall["kind"] == "plane":
        return float(((points - wall["point"]) @ numpy.array(wall["normal"])).min()) - radius
    if wall["kind"] == "sphere_inside":
        return wall["radius"] - float(numpy.linalg.norm(points - wall["point"], axis=1).max()) - radius
    if wall["kind"] == "box_inside":
        axes = [k for k in range(3) if not periodic[k]]
        return float(min([(points - wall["lower"])[:, axes].min(initial=numpy.inf), (wall["upper"] - points)[:, axes].min(initial=numpy.inf)])) - radius
    if wall["kind"] == "cylinder_inside":
        start, end = numpy.array(wall["axis_start"]), numpy.array(wall["axis_end"])
        axis = (end - start) / numpy.linalg.norm(end - start)
        along = (points - start) @ axis
        across = numpy.linalg.norm(points - start - along[:, None] * axis, axis=1)
        lids = numpy.inf if periodic[int(numpy.argmax(numpy.abs(axis)))] and numpy.abs(axis).max() > 1 - 1e-12 else min(along.min(), numpy.linalg.norm(end - start) - along.max())
        return float(min(wall["radius"] - across.max(), lids)) - radius
    surface = world_triangles(scene.shapes[wall["shape"]], numpy.array(wall["position"]), wall["orientation"], wall["scale"])
    if numpy.linalg.norm(surface.reshape(-1, 3) - body.position, axis=1).min() > 1e3 * body.reach:
        return None
    if body.is_ball:
        return float(point_triangle_distances(numpy.repeat(body.position[None], len(surface), axis=0), surface).min()) - radius
    near = surface[(numpy.linalg.norm(surface - body.position, axis=2).min(axis=1) < 3 * body.reach + numpy.linalg.norm(surface[:, 0] - surface[:, 1], axis=1)
                    + numpy.linalg.norm(surface[:, 0] - surface[:, 2], axis=1))]
    distance = triangle_sets_distance(body.triangles, near) if len(near) else numpy.inf
    return distance if distance > 0 else -1e-3 * body.reach


def one_body_less(scene):
    for name in scene.bodies:
        scene.bodies[name] = scene.bodies[name][:-1]
    scene.count -= 1
    scene.order = numpy.argsort(scene.bodies["id"])


@relation("sums", one_body_less)
def packings_as_asked(trial):
    """Numbers, masses, sizes, shares, regions, materials and velocities of what was placed."""
    scene = trial.tools.pack(trial.case) if trial.spoil else trial.scene
    trial.seen(scene)
    words = trial.case.words
    asked, of_population = words.get("bodies", []), scene.body("population")
    require((of_population < 0).sum() == len(asked), f"{(of_population < 0).sum()} bodies of [[bodies]] in the scene, {len(asked)} in the case")
    relax = words.get("contact", {}).get("relax", "shallow")
    for i, body in enumerate(asked):
        if relax is not True:
            # parted by at most two margins; balls without margins by what separates touch from overlap
            most = 2 * scene.general["margin"] * 1.0001 + 1e-6 * scene.radii()[i] if relax == "shallow" else 0.0
            way = float(numpy.linalg.norm(scene.body("position")[i] - body["position"]))
            require(way <= most, f"bodies[{i}] is at {scene.body('position')[i].tolist()}, {way:.6g} m from {body['position']} that was asked")
        require(numpy.array_equal(scene.body("velocity")[i], numpy.array(body.get("velocity", [0, 0, 0]), float)), f"bodies[{i}] has another velocity")
    masses, diameters = scene.masses(), (6 * scene.of_shape("volume") / math.pi) ** (1 / 3) * scene.body("scale")
    for k, population in enumerate(trial.case.populations):
        mine = numpy.flatnonzero(of_population == k)
        method = population.get("method", "random")
        total, largest = masses[mine].sum(), masses[mine].max(initial=0)
        if "count" in population:
            lost = method == "settle"   # what does not lie wholly in the region is taken out
            require(len(mine) == population["count"] or lost and len(mine) <= population["count"], f"populations[{k}]: {len(mine)} bodies, {population['count']} asked")
        if "mass" in population and method != "settle":
            next_one = largest if "size" not in population else masses[mine].max(initial=0) * 2
            require(abs(total - population["mass"]) <= 0.5 * max(next_one, largest) * (1 + 1e-9) or len(mine) == 0, f"populations[{k}]: {total:.6g} kg, {population['mass']:.6g} kg asked")
            require(len(mine) > 0, f"populations[{k}]: {population['mass']:.6g} kg asked, none placed and no word")
        if "solid_fraction" in population and method != "settle":
            region = population["region"]["box"]
            room = float(numpy.prod(numpy.abs(numpy.array(region[1]) - region[0])))
            volume = (scene.of_shape("volume") * scene.body("scale") ** 3)[mine]
            require(abs(volume.sum() - population["solid_fraction"] * room) <= 0.5 * 2 * volume.max(initial=room), f"populations[{k}]: solid {volume.sum():.6g} m^3 of {population['solid_fraction'] * room:.6g} asked")
        size = population.get("size")
        if isinstance(size, (int, float)):
            require(numpy.abs(diameters[mine] - size).max(initial=0) <= 1e-9 * size, f"populations[{k}]: diameters {diameters[mine].tolist()}, {size} asked")
        elif size:
            low = size.get("min", size.get("diameter") if not isinstance(size.get("diameter"), list) else size["diameter"][0])
            high = size.get("max", size.get("diameter") if not isinstance(size.get("diameter"), list) else size["diameter"][-1])
            require(diameters[mine].min(initial=high) >= low * (1 - 1e-9) and diameters[mine].max(initial=low) <= high * (1 + 1e-9),
                    f"populations[{k}]: diameters from {diameters[mine].min()} to {diameters[mine].max()}, asked from {low} to {high}")
        if isinstance(population.get("orientation"), list) and method in ("random", "lattice"):
            q = numpy.array(population["orientation"]) / numpy.linalg.norm(population["orientation"])
            require((numpy.abs(scene.body("orientation")[mine] @ q) > 1 - 1e-9).all(), f"populations[{k}] is not turned as asked")
        require(numpy.abs(scene.body("velocity")[mine] - population.get("velocity", [0, 0, 0])).max(initial=0) == 0, f"populations[{k}] has another velocity")
        in_region(trial, scene, k, population, mine)


def in_region(trial, scene, k, population, mine):
    kind, region = next(iter(population["region"].items()))
    general = dict(scene.general)
    wall = {"box": lambda: {"kind": "box_inside", "lower": numpy.minimum(*map(numpy.array, region)), "upper": numpy.maximum(*map(numpy.array, region))},
            "cylinder": lambda: {"kind": "cylinder_inside", "axis_start": region["start"], "axis_end": region["end"], "radius": region["radius"]},
            "sphere": lambda: {"kind": "sphere_inside", "point": region["centre"], "radius": region["radius"]}}.get(kind)
    if wall is None:
        return
    if population.get("method") in ("compact", "settle") and any(general.get("domain", {}).get("periodic", [False])):
        return   # periodic axes have no sides
    wall = wall()
    domain, general["domain"] = general.get("domain"), {}
    plain = type("Plain", (), {"general": general, "shapes": scene.shapes})
    for i in mine:
        body = Body(scene, i)
        inside = max(wall_gap(plain, wall, moved(body, shift)) for shift in periodic_shifts({"domain": domain or {}}))
        slack = 0.1 * body.reach if population.get("method") == "compact" else 1e-6 * body.reach
        require(inside >= -slack, f"populations[{k}]: body {body.id} is {-inside:.6g} m outside its region")


def moved(body, shift):
    other = copy.copy(body)
    other.position = body.position + shift
    if not body.is_ball:
        other.triangles = body.triangles + shift
    return other


# ---- what post says

def post(trial, *arguments):
    code, out, err = trial.tools.call("scree-post", *arguments)
    require(code == 0, f"post {arguments[0]} ends with {code}: {err.strip()[-800:]}")
    return out


def read_csv(path):
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def spoil_rows(rows):
    for row in rows:
        for key in row:
            if key not in ("time", "id"):
                row[key] = repr(float(row[key]) * 1.25 + 1e-9)


def fuller(rows):
    for row in rows:
        if row["solid_fraction"]:
            row["solid_fraction"] = repr(3 * float(row["solid_fraction"]))
        row["particle_count"] = repr(float(row["particle_count"] or 0) + 1)


@relation("sums", spoil_rows)
def post_tables(trial):
    """`bodies` and `contacts` write what stands in the frames, all digits."""
    run = trial.completed()
    path = trial.tools.new_path(".csv")
    post(trial, "bodies", run.folder, "-o", path)
    rows = read_csv(path)
    trial.seen(rows)
    columns = {"x": ("position", 0), "y": ("position", 1), "z": ("position", 2), "vx": ("velocity", 0), "vy": ("velocity", 1), "vz": ("velocity", 2),
               "qw": ("quat", 0), "wx": ("angular_velocity", 0), "wz": ("angular_velocity", 2)}
    expected = [(f.time, int(i), f, k) for f in run.frames for k, i in enumerate(f.ids)]
    require(len(rows) == len(expected), f"bodies: {len(rows)} rows, the frames have {len(expected)} bodies")
    found = {(float(row["time"]), int(row["id"])): row for row in rows}
    for time, number, frame, k in expected:
        row = found.get((time, number))
        require(row is not None, f"bodies: no row for body {number} at t = {time}")
        for name, (array, axis) in columns.items():
            require(float(row[name]) == frame.bodies[array][k, axis], f"bodies: {name} of body {number} at t = {time} is {row[name]}, the frame has {frame.bodies[array][k, axis]!r}")
    if not run.scene.general.get("output_contacts", True):
        return
    post(trial, "contacts", run.folder, "-o", path)
    rows = read_csv(path)
    require(len(rows) == sum(len(f.contacts["depth"]) for f in run.frames), f"contacts: {len(rows)} rows, the frames have other contacts")
    total = sum(float(row["fn"]) for row in rows)
    own = sum(float(f.contacts["normal_force"].sum()) for f in run.frames)
    size = sum(float(numpy.abs(f.contacts["normal_force"]).sum()) for f in run.frames)
    require(abs(total - own) <= 1e-9 * size, f"contacts: normal forces add up to {total}, the frames have {own}")


def inside_cylinder(points, start, end, radius):
    axis = (end - start) / numpy.linalg.norm(end - start)
    along = (points - start) @ axis
    across = numpy.linalg.norm(points - start - along[:, None] * axis, axis=1)
    return (along >= 0) & (along <= numpy.linalg.norm(end - start)) & (across <= radius)


@relation("sums", fuller)
def post_regions(trial):
    """Solid fraction, number and mass in boxes, cylinders and spheres: held against dense samples of each body, images included."""
    run = trial.completed()
    frame = run.frames[trial.random.randrange(len(run.frames))]
    scene = run.scene
    here = {int(i): k for k, i in enumerate(scene.body("id"))}
    rows = numpy.array([here[int(i)] for i in frame.ids], int)
    moving = scene.moving()[rows]
    if not moving.any():
        raise NotApplicable("no particles")
    points, weights, owner = [], [], []
    shifts = periodic_shifts(scene.general)
    for k, i in enumerate(rows):
        if not moving[k]:
            continue
        samples, volume = body_samples(scene.shapes[scene.body("shape")[i]], scene.body("scale")[i], 1500)
        for shift in shifts:
            points.append(turned(frame.quat[k], samples) + frame.position[k] + shift)
            weights.append(numpy.full(len(samples), volume))
            owner.append(numpy.full(len(samples), k))
    points, weights, owner = numpy.concatenate(points), numpy.concatenate(weights), numpy.concatenate(owner)
    volumes = (scene.of_shape("volume") * scene.body("scale") ** 3)[rows]
    low, high = frame.position[moving].min(axis=0) - scene.size(), frame.position[moving].max(axis=0) + scene.size()
    domain = scene.general.get("domain", {})
    for k in range(3):   # regions that lie in the domain
        if domain.get("periodic", [False] * 3)[k]:
            low[k], high[k] = domain["min"][k], domain["max"][k]
    r = trial.random

    def place(share):
        return low + (high - low) * [r.uniform(*share) for _ in range(3)]
    a, b = place((0, 0.5)), place((0.5, 1))
    for k in range(3):   # at a seam bodies reach in from the other side
        if domain.get("periodic", [False] * 3)[k] and r.random() < 0.5:
            a[k], b[k] = low[k], low[k] + r.uniform(0.8, 2) * scene.size()
    c, d = place((0.1, 0.9)), place((0.1, 0.9))
    k = r.randrange(3)
    start, end = place((0.2, 0.5)), None
    end = start.copy()
    end[k] = high[k] - 0.2 * (high - low)[k]
    room = float(min(high - low))
    regions = {"b": ("box", [*a, *b], lambda p: ((p >= a) & (p <= b)).all(axis=1), float(numpy.prod(b - a))),
               "s": ("sphere", [*c, 0.35 * room], lambda p: numpy.linalg.norm(p - c, axis=1) <= 0.35 * room, 4 / 3 * math.pi * (0.35 * room) ** 3),
               "l": ("cylinder", [*start, *end, 0.3 * room], lambda p: inside_cylinder(p, start, end, 0.3 * room),
                     math.pi * (0.3 * room) ** 2 * float(numpy.linalg.norm(end - start)))}
    if numpy.linalg.norm(d - c) > 0.1 * room:
        regions["o"] = ("cylinder", [*c, *d, 0.3 * room], lambda p: inside_cylinder(p, c, d, 0.3 * room), math.pi * (0.3 * room) ** 2 * float(numpy.linalg.norm(d - c)))
    out = trial.tools.new_path(".statistics")
    words = [word for name, (kind, numbers, _, _) in regions.items() for word in ("--region", f"{name}={kind}:" + ",".join(repr(float(x)) for x in numbers))]
    if not run.scene.general.get("output_contacts", True):
        raise NotApplicable("no contacts in the frames")
    post(trial, "statistics", run.folder, "-o", out, "--frames", str(frame.number), "--no-charts", *words)
    table = read_csv(os.path.join(out, "series.csv"))
    trial.seen(table)
    found = {row["group"].split()[-1]: row for row in table}
    for name, (kind, numbers, holds, volume) in regions.items():
        if any(domain.get("periodic", [False])) and not holds_within_one_period(kind, numbers, domain):
            continue
        inside = holds(points)
        solid = weights[inside].sum()
        said = float(found[name]["solid_fraction"]) * volume
        cut = [k for k in set(owner.tolist()) if inside[owner == k].any() and not inside[owner == k].all()]
        # post has 32 points or more for a body: the part of a cut body is right to a tenth or so, with either sign
        slack = 0.05 * math.sqrt((volumes[cut] ** 2).sum()) + 0.01 * solid
        require(abs(said - solid) <= slack, f"frame {frame.number}, region {kind}:{numbers}: post finds {said:.6g} m^3 of solid, there are {solid:.6g} m^3 ({len(cut)} bodies cut)")
        centres = numpy.zeros(len(rows), bool)
        doubtful = False
        for shift in shifts:
            centres |= holds(frame.position + shift)
        doubtful = any((holds(frame.position + shift * 1.0 + 1e-9 * room * way) != holds(frame.position + shift)).any() for shift in shifts for way in numpy.vstack([numpy.eye(3), -numpy.eye(3)]))
        number = int(float(found[name]["particle_count"] or 0))
        require(doubtful or number == (centres & moving).sum(), f"frame {frame.number}, region {kind}:{numbers}: post counts {number} particles, {(centres & moving).sum()} have their centre there")


def holds_within_one_period(kind, numbers, domain):
    """Whether a region lies between the sides of the domain along its periodic axes."""
    low, high = numpy.array(domain["min"]), numpy.array(domain["max"])
    if kind == "box":
        a, b = numpy.array(numbers[:3]), numpy.array(numbers[3:6])
    elif kind == "sphere":
        a, b = numpy.array(numbers[:3]) - numbers[3], numpy.array(numbers[:3]) + numbers[3]
    else:
        ends = numpy.array([numbers[:3], numbers[3:6]])
        a, b = ends.min(axis=0) - numbers[6], ends.max(axis=0) + numbers[6]
    periodic = numpy.array(domain["periodic"])
    return bool(((a >= low) & (b <= high))[periodic].all())


@relation("sums", fuller)
def post_layers(trial):
    """The layers of a profile along gravity hold all the solid, in a box, a cylinder that stands and one that lies; no fraction is above 1."""
    run = trial.completed()
    gravity = numpy.array(run.scene.general["gravity"])
    if not gravity.any() or not run.scene.general.get("output_contacts", True) or any(run.scene.general.get("domain", {}).get("periodic", [False])):
        raise NotApplicable("no axis of gravity, or no contacts")
    frame, scene, r = run.frames[-1], run.scene, trial.random
    if len(frame.ids) == 0 or not scene.moving().any():
        raise NotApplicable("no particles")
    vertical = int(numpy.argmax(numpy.abs(gravity)))
    here = {int(i): k for k, i in enumerate(scene.body("id"))}
    rows = numpy.array([here[int(i)] for i in frame.ids], int)
    moving = scene.moving()[rows]
    reach = scene.radii()[rows]
    low, high = (frame.position - reach[:, None])[moving].min(axis=0), (frame.position + reach[:, None])[moving].max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    kind, k = r.choice(["box", "upright", "lying"]), vertical
    if kind == "lying":
        k = r.choice([axis for axis in range(3) if axis != vertical])
    across = [axis for axis in range(3) if axis != k]
    radius = 1.05 * float(numpy.linalg.norm(half[across]))
    start, end = middle.copy(), middle.copy()
    start[k], end[k] = low[k] - 0.05 * half[k], high[k] + 0.05 * half[k]
    words = "box:" + ",".join(repr(float(x)) for x in [*(low - 0.05 * half), *(high + 0.05 * half)]) if kind == "box" else \
        "cylinder:" + ",".join(repr(float(x)) for x in [*start, *end, radius])
    out = trial.tools.new_path(".statistics")
    axis = "xyz"[vertical]
    post(trial, "statistics", run.folder, "-o", out, "--frames", str(frame.number), "--no-charts", "--container", words, "--profile", f"{axis}:6")
    table = read_csv(os.path.join(out, f"profile_{axis}.csv"))
    trial.seen(table)
    at = numpy.array([float(row[axis]) for row in table])
    fraction = numpy.array([float(row["solid_fraction"] or 0) for row in table])
    width = at[1] - at[0]
    solid = (scene.of_shape("volume") * scene.body("scale") ** 3)[rows][moving].sum()
    if kind == "box":
        rooms = numpy.full(len(at), width * float(numpy.prod([(2.1 * half)[j] for j in range(3) if j != vertical])))
    elif kind == "upright":
        rooms = numpy.full(len(at), width * math.pi * radius**2)
    else:
        fine = (numpy.arange(400) + 0.5) / 400 - 0.5
        rooms = numpy.array([width * (end[k] - start[k]) * numpy.mean(2 * numpy.sqrt(numpy.maximum(0, radius**2 - (z + fine * width - middle[vertical]) ** 2))) for z in at])
    total = float((fraction * rooms).sum())
    inside = at[0] - width / 2 <= low[vertical] + 1e-6 * width and at[-1] + width / 2 >= high[vertical] - 1e-6 * width
    require(fraction.max() <= 1.05, f"a layer of a {kind} container is filled to {fraction.max():.4g}")
    if inside:
        require(abs(total - solid) <= 0.03 * solid, f"the layers of a {kind} container hold {total:.6g} m^3 of solid, there are {solid:.6g} m^3")


def bad_files(data):
    for verdict in data["verdicts"]:
        if verdict["question"] == "Files behind the run":
            verdict["judgement"] = "bad"


@relation("sums", bad_files)
def report_trusts_its_files(trial):
    """The report of a run that was just made, with a key of its case set on the command line or not, finds all files as they were."""
    run = trial.completed()
    if trial.random.random() < 0.7:
        run = trial.tools.solve(trial.tools.pack(trial.case, "--set", "output.contacts=true", "--set", "title=set"))
    path = trial.tools.new_path(".json")
    post(trial, "report", run.folder, "-o", trial.tools.new_path(".html"), "--json", path)
    data = read_json(path)
    trial.seen(data)
    verdicts = {verdict["question"]: verdict for verdict in data["verdicts"]}
    require(verdicts["Outcome"]["judgement"] == "good", f"report: outcome {verdicts['Outcome']}")
    require(verdicts["Files behind the run"]["judgement"] == "good", f"report: files {verdicts['Files behind the run']}")
    lost = run.record["removed_bodies"] + run.record["lost_bodies"] + run.record["bodies_outside_domain"]
    require(lost == 0 or verdicts["Lost bodies"]["judgement"] != "good", f"report: {lost} bodies left, and {verdicts['Lost bodies']}")


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


# ---- what the mesher reads

def one_vertex_moved(shape):
    shape["vertices"][0] *= 1.001


@relation("sums", one_vertex_moved)
def any_mesh_format(trial):
    """A mesh is the same shape from any file format that holds it, comments and units included."""
    if not trial.case.meshes:
        raise NotApplicable("no meshes")
    name = trial.random.choice(sorted(trial.case.meshes))
    mesh = trial.case.meshes[name]
    kind = trial.random.choice(sorted(FORMATS))
    path = trial.tools.new_path(FORMATS[kind][0])
    with open(path, "wb") as file:
        file.write(FORMATS[kind][1](mesh))
    out = trial.tools.new_path(".shape.h5")
    code, _, err = trial.tools.call("scree-mesher", "import", path, "-o", out, *(["--surface"] if mesh.surface else []))
    require(code == 0, f"import of {name} as {kind} ends with {code}: {err.strip()[-500:]}")
    first, second = read_shape(trial.tools.mesh_file(mesh)), read_shape(out)
    trial.seen(second)
    size = numpy.abs(first["vertices"]).max()
    require(len(first["vertices"]) == len(second["vertices"]) and len(first["triangles"]) == len(second["triangles"]),
            f"{name} as {kind}: {len(second['vertices'])} vertices, {len(second['triangles'])} triangles; as OFF {len(first['vertices'])}, {len(first['triangles'])}")
    require(abs(first["volume"] - second["volume"]) <= 1e-12 * size**3, f"{name} as {kind}: volume {second['volume']}, as OFF {first['volume']}")
    far = max(numpy.linalg.norm(second["vertices"] - v, axis=1).min() for v in first["vertices"])
    require(far <= 1e-12 * size, f"{name} as {kind}: a vertex is {far:.3g} m from where it is as OFF")


def off_with_comments(mesh):
    lines = mesh.off().splitlines()
    count = len(mesh.vertices)
    return ("\n".join(["OFF", "# a comment", lines[1], "", *lines[2:2 + count], "# the facets", *lines[2 + count:], "# the end", ""])).encode()


def stl_text(mesh):
    lines = ["solid s"]
    for t in mesh.triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %.17g %.17g %.17g" % tuple(mesh.vertices[v]) for v in t), "endloop", "endfacet"]
    return ("\n".join([*lines, "endsolid s", ""])).encode()


def stl_binary(mesh):
    rows = numpy.zeros(len(mesh.triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = mesh.vertices[mesh.triangles]
    return b"binary".ljust(80) + numpy.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes()


def obj(mesh):
    return ("# a comment\n" + "".join("v %.17g %.17g %.17g\n" % tuple(v) for v in mesh.vertices) + "s off\n" +
            "".join("f %d %d %d\n" % tuple(t + 1) for t in mesh.triangles)).encode()


def ply_head(mesh, kind):
    return (f"ply\nformat {kind} 1.0\ncomment a comment\nelement vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(mesh.triangles)}\nproperty list uchar int vertex_indices\nend_header\n").encode()


def ply_text(mesh):
    return ply_head(mesh, "ascii") + ("".join("%.17g %.17g %.17g\n" % tuple(v) for v in mesh.vertices) + "".join("3 %d %d %d\n" % tuple(t) for t in mesh.triangles)).encode()


def ply_binary(mesh):
    faces = numpy.zeros(len(mesh.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.triangles
    return ply_head(mesh, "binary_little_endian") + mesh.vertices.astype("<f8").tobytes() + faces.tobytes()


FORMATS = {"OFF with comments": (".off", off_with_comments), "STL as text": (".stl", stl_text), "binary STL": (".stl", stl_binary), "OBJ": (".obj", obj),
           "PLY as text": (".ply", ply_text), "binary PLY": (".ply", ply_binary)}


def read_shape(path):
    with h5py.File(path, "r") as file:
        group = file["shapes/shape_0000"]
        return {"vertices": group["vertices"][()], "triangles": group["triangles"][()], "volume": float(group.attrs["volume"])}
