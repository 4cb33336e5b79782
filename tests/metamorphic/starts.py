"""A case that starts from the run of a case: what it begins with is what the run ended with, whoever computes it."""
import csv
import os

import numpy

from bits import another_last_digit, same
from near import speed_of
from relations import NotApplicable, Refused, relation, require

kRounding = 1e-13       # of places, velocities and turns: one conversion of units and frames
kSlidingShare = 0.9     # half of a step changes a speed by an eighth where a contact takes 12 steps, and damping is a third of a push: its square by a tenth
kForceRounding = 1e-7   # of the largest force and of what is in motion: rounding of a place over the overlap that it makes


def next_case(trial):
    """The case without its bodies, started from its own run; and whether from a frame."""
    if trial.case.words.get("bonds"):
        raise NotApplicable("bonds are not taken over from a run")
    run, case = trial.completed(), trial.case.copy()
    for key in ("bodies", "populations"):
        case.words.pop(key, None)
    start = case.words["start"] = {"run": run.folder}
    from_frame = trial.random.random() < 0.25
    if from_frame:
        start["frame"] = run.frames[-1].number
    elif trial.random.random() < 0.3:
        start["checkpoint"] = run.record["steps"]
    if trial.random.random() < 0.4:
        names = {name: f"of {name}" for name in case.words["materials"]}
        start["materials"] = names
        case.words["materials"] = {names[name]: entry for name, entry in case.words["materials"].items()}
        for pair in case.words.get("pairs", []):
            pair["between"] = [names[name] for name in pair["between"]]
        for user in [*case.walls, *case.words.get("inlets", [])]:
            user["material"] = names[user["material"]]
    return case, from_frame


def contact_forces(frame, walls, tangential):
    """Forces by pair and feature; walls by their place in the case."""
    number = {wall["id"]: -1 - i for i, wall in enumerate(walls)}
    c = frame.contacts
    if not c:
        return {}
    forces = {}
    for a, b, feature, normal, friction in zip(c["body_a"], c["body_b"], c["feature"], c["normal_force"], c["tangential_force"]):
        a, b = number.get(int(a), int(a)), number.get(int(b), int(b))
        if a < 0:   # of the two, the one with the smaller id comes first
            a, b, friction = b, a, -friction
        forces[a, b, int(feature)] = numpy.array([normal, *(friction if tangential else ())])
    return forces


def slides(frame, scene):
    """Whether the friction of a contact is all that sliding allows."""
    c = frame.contacts
    if not c:
        return False
    coefficients = {pair["friction_sliding"] if pair["friction_sliding"] >= 0 else pair["friction"] for pair in scene.settings["pairs"]}
    push, along = numpy.abs(c["normal_force"]), numpy.linalg.norm(c["tangential_force"], axis=1)
    return any(((push > 0) & (numpy.abs(along - mu * push) <= 1e-9 * push)).any() for mu in coefficients)


def step_at(run, end):
    """The step of its first or last moment, where quantised steps change it."""
    path = os.path.join(run.folder, "steps.csv")
    if not os.path.exists(path):
        return run.record["step_size"]
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if end == -1 or row["step"] == "0"]
    return float(rows[-1]["step_size"]) if rows else run.record["step_size"]


def end_of(run):
    """Its last frame, where that is the end of the run and has bodies."""
    end = run.frames[-1]
    if len(end.ids) == 0 or end.attributes["step"] != run.record["steps"]:
        raise NotApplicable("the run ends without bodies, or between frames")
    return end


def begins_as_it_ended(trial, run, case, from_frame):
    """Packs and runs a case that starts from a run, and compares its first frame with the last of that run. Gives the scene and the run."""
    end = run.frames[-1]
    try:
        scene = trial.tools.pack(case)
    except Refused as reason:
        if "outside the domain" in str(reason) and trial.case.value("domain", "outside") == "keep":
            raise NotApplicable("bodies outside the domain") from None
        raise
    first = trial.tools.solve(scene)
    require(first.frames, f"no first frame: {first.text[-300:]}")
    begin = first.frames[0]
    require(numpy.array_equal(begin.ids, end.ids), f"ids {begin.ids.tolist()} in place of {end.ids.tolist()}")
    for name in ("position", "velocity", "angular_velocity", "quat"):
        here, there = begin.bodies[name], end.bodies[name]
        lack = numpy.abs(here - there).max()
        # what is at rest in a cell that deforms has the rounding of the velocity of the cell, which stands for the speed of the run
        least = {"velocity": speed_of(run), "angular_velocity": speed_of(run) / run.scene.size()}.get(name, 1e-300)
        require(lack <= kRounding * max(numpy.abs(there).max(), least), f"{name} begins {lack} away")
    masses = scene.masses()
    speed = max(numpy.linalg.norm(end.velocity, axis=1).max(), numpy.linalg.norm(end.spin, axis=1).max() * scene.radii().max())
    moving = masses.sum() * (numpy.linalg.norm(scene.general["gravity"]) + speed**2 / scene.size())
    here = contact_forces(begin, scene.walls, not from_frame)
    there = contact_forces(end, run.scene.walls, not from_frame)
    scale = moving + max((float(numpy.abs(v).max()) for v in there.values()), default=0.0)
    zero = numpy.zeros(1 if from_frame else 4)
    cell = trial.case.words.get("cell", {})
    begins_anew = cell.get("stress") or any(isinstance(rate, dict) for rate in cell.get("strain_rate", {}).values())   # the rates of the cell
    if step_at(first, 0) != step_at(run, -1) or begins_anew:   # what damping takes in a step depends on the step and on the cell
        here = there = {}
    for key in here.keys() | there.keys():
        lack = numpy.abs(here.get(key, zero) - there.get(key, zero)).max()
        require(lack <= kForceRounding * scale, f"contact {key} begins with {here.get(key)} and ended with {there.get(key)}")
    energy = moving * scene.size() + sum(abs(float(run.log[name][-1])) for name in ("elastic", "elastic_tangential"))
    for name in ("kinetic_translational", "kinetic_rotational", "elastic") + (() if from_frame else ("elastic_tangential",)):
        begun, ended = float(first.log[name][0]), float(run.log[name][-1])
        lack = abs(begun - ended)
        if name == "elastic_tangential" and slides(end, run.scene):
            # the spring of a contact that slides has what friction allowed with the velocities half a step before the end; a start uses those of the end
            require(kSlidingShare * ended - kForceRounding * energy <= begun, f"{name} begins at {begun} J and ended at {ended} J, of contacts that slide")
            lack = max(0.0, begun - ended)
        require(lack <= kForceRounding * energy + kRounding * masses.sum() * speed_of(run)**2, f"{name} begins at {first.log[name][0]} J and ended at {run.log[name][-1]} J")
    return scene, first


@relation("bits", another_last_digit)
def started_from_its_run(trial):
    """[start]: bodies, contact forces and energies are those of the end of the run; the same bits on any ranks."""
    run = trial.completed()
    if any("motion" in wall or "wear" in wall or wall.get("surface", {}).keys() & {"start", "stop"} for wall in trial.case.walls):
        raise NotApplicable("walls would stand where they began")
    end_of(run)
    case, from_frame = next_case(trial)
    scene, first = begins_as_it_ended(trial, run, case, from_frame)
    how = trial.parallel()
    same(first, trial.solve(scene, **how), f"started from a run, {how}")


def motions_of(wall):
    """Words of all its motions."""
    motion = wall.get("motion", {})
    return {word for part in (motion if isinstance(motion, list) else [motion]) for word in part}


def walls_of(frame):
    return numpy.column_stack([frame.walls["position"], frame.walls["orientation"]])


@relation("bits", another_last_digit)
def goes_on_where_it_ended(trial):
    """[start] with continue: bodies, walls, contact forces and energies are those of the end of the run, whatever moves; the same bits on any ranks."""
    run, case = trial.completed(), trial.case.copy()
    if trial.case.words.get("bonds") or case.words.get("inlets"):
        raise NotApplicable("bonds are not taken over from a run, and inlets begin again")
    if any("wear" in wall or motions_of(wall) & {"free", "motor"} for wall in case.walls):
        raise NotApplicable("walls that would begin as drawn, or at rest")
    end = end_of(run)
    case.words["start"] = {"run": run.folder, "continue": True}
    scene, first = begins_as_it_ended(trial, run, case, False)
    # an analytic wall that answers to force is placed where it stood, and counts its displacement from there
    shown = [k for k, wall in enumerate(case.walls) if not motions_of(wall) & {"servo", "outer"}]
    if shown:
        here, there = (walls_of(frame)[shown] for frame in (first.frames[0], end))
        lack = numpy.abs(here - there).max()
        require(lack <= 1e3 * kRounding * max(numpy.abs(there).max(), 1), f"walls begin {lack} away from where they stood: {here.tolist()}, {there.tolist()}")
    how = trial.parallel()
    same(first, trial.solve(scene, **how), f"going on, {how}")
