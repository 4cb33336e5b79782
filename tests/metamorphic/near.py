"""Relations that hold within a tolerance: the same scene in other words.

Heaps are chaotic: what differs by a rounding at the start may differ by a diameter later. So each comparison is held against twins, runs
whose bodies start a few roundings away: up to each frame, kSpread times the largest distance of a twin and what rounding alone can do are
allowed; where twins have parted by kChaos of a body, nothing is compared any more. A violation is confirmed against more twins.
"""
import math
import random

import numpy

from geometry import turned as turned_by
from model import Mesh
from relations import NotApplicable, Refused, Violation, relation, require
from transforms import Placement, disturbed, frozen, in_units, is_cut, placed, reordered, right_angle_turns, with_split_faces

EPSILON = 2.0**-52
kSpread = 1000.0     # a relation rounds in every step, a twin at the start only
kChaos = 1e-4        # of a body: from here on a twin tells nothing
kTwins, kMoreTwins = 2, 8
kRounding = 1e-14    # a step, of the largest place over the size of a body


def base(trial):
    """The case with its bodies placed one by one."""
    if trial.case.words.get("inlets") or trial.case.words.get("outlets"):
        raise NotApplicable("bodies come in and leave at places of their own")
    if trial.case.value("time", "sleep"):
        raise NotApplicable("a rounding decides at which look a body is found at rest")
    if not hasattr(trial, "frozen"):
        trial.frozen = frozen(trial.case, trial.scene)
        try:
            trial.frozen_scene = trial.tools.pack(trial.frozen)
        except Refused as reason:
            trial.frozen = None
            trial.reason = str(reason)
    if trial.frozen is None:
        raise NotApplicable(f"bodies placed one by one are refused: {trial.reason[:200]}")
    if trial.scene.count == 0:
        raise NotApplicable("no bodies")
    if not hasattr(trial, "frozen_run"):
        trial.frozen_run = trial.tools.solve(trial.frozen_scene)
    if not trial.frozen_run.completed():
        raise NotApplicable("the run becomes invalid: " + (trial.frozen_run.record or {}).get("message", "")[:200])
    return trial.frozen


def reach_of(run):
    """The largest coordinate in a run."""
    return max(float(numpy.abs(frame.position).max(initial=0)) for frame in run.frames)


def twin(trial, number, amount):
    """A run of the base whose bodies start up to `amount` [m] away; the same for all relations of a trial."""
    kept = trial.__dict__.setdefault("twins", {})
    key = (number, round(math.log2(amount)))
    if key not in kept:
        kept[key] = trial.tools.solve(trial.tools.pack(disturbed(trial.frozen, random.Random(f"twin {trial.seed} {number}"), amount, trial.frozen_scene.size())))
    return kept[key]


def speed_of(run):
    """A speed that stands for the run [m/s]."""
    fastest = max(float(numpy.linalg.norm(frame.velocity, axis=1).max(initial=0)) for frame in run.frames)
    fall = float(numpy.linalg.norm(run.scene.general["gravity"])) * run.frames[-1].time
    return max(fastest, 0.01 * fall, 1e-3 * run.scene.size() / max(run.frames[-1].time, 1e-300))


def spin_of(run, size, speed):
    """An angular velocity that stands for the run [rad/s]: where bodies turn on the spot, its rounding has nothing to do with their speed."""
    return max(speed / size, max(float(numpy.linalg.norm(frame.spin, axis=1).max(initial=0)) for frame in run.frames))


def distances(run, other, back, size, speed):
    """Of each frame, how far `other` is from `run` once brought back: in sizes, speeds and turns; infinite where bodies are missing."""
    found = []
    spin = spin_of(run, size, speed)
    for f, g in zip(run.frames, other.frames):
        g = back(g)
        if len(f.ids) != len(g["id"]) or (f.ids != g["id"]).any():
            found.append(math.inf)
            continue
        if len(f.ids) == 0:
            found.append(0.0)
            continue
        d = [numpy.abs(f.position - g["position"]).max() / size, numpy.abs(f.velocity - g["velocity"]).max() / speed,
             numpy.abs(f.spin - g["angular_velocity"]).max() / spin]
        if "quat" in g:
            d.append(numpy.minimum(numpy.abs(f.quat - g["quat"]).max(axis=1), numpy.abs(f.quat + g["quat"]).max(axis=1)).max())   # q and -q are one turn
        found.append(float(max(d)))
    return found


def as_it_is(frame):
    return {"id": frame.ids, "position": frame.position, "velocity": frame.velocity, "angular_velocity": frame.spin, "quat": frame.quat}


def near(trial, other, back, amount, what):
    """Throws Violation when `other` is further from the base than its twins allow."""
    run = trial.frozen_run
    size, speed = trial.frozen_scene.size(), speed_of(run)
    own = reach_of(run)
    amount = max(amount, 2 * EPSILON * own, 4 * EPSILON * size)

    def verdict(twins):
        for t in twins:
            if t.code != run.code or len(t.frames) != len(run.frames):
                return None    # on the edge of ending otherwise
        spread = numpy.zeros(len(run.frames))
        for t in twins:
            spread = numpy.maximum(spread, distances(run, t, as_it_is, size, speed))
        spread = numpy.maximum.accumulate(spread)
        if other.code != run.code:
            return f"{what}: exit {other.code}, not {run.code}: {other.text.strip().splitlines()[-1][:300]}" if spread[-1] < kChaos else None
        step, same_steps = run.record["step_size"], other.record["steps"] == run.record["steps"]
        if len(other.frames) != len(run.frames) or not same_steps:
            # a duration or an interval that is a whole number of steps may round either way
            return None if abs(other.record["steps"] - run.record["steps"]) <= 1 or spread[-1] > kChaos else \
                f"{what}: {other.record['steps']} steps, not {run.record['steps']}"
        measured = distances(run, other, back, size, speed)
        for k, (d, s, f, g) in enumerate(zip(measured, spread, run.frames, other.frames)):
            if s > kChaos:
                return None
            late = abs(back(g).get("time", g.time) - f.time) / step
            rounding = 100 * amount / size + kRounding * (own / size + 1) * (f.attributes["step"] + 10) + 10 * late
            if d > kSpread * s + rounding:
                return f"{what}: {d:.3g} apart at frame {k} (t = {f.time:.6g} s, step {f.attributes['step']}); twins {s:.3g}, rounding {rounding:.3g}"
        return None

    text = verdict([twin(trial, i, amount) for i in range(kTwins)])
    if text:
        text = verdict([twin(trial, i, amount * (1 if i < kMoreTwins // 2 else 16)) for i in range(kMoreTwins)])
    if text:
        raise Violation(text)


def same_step(trial, other, unit=1.0):
    """The derived step has no reason to change by more than rounding. Step levels and iterations end within 1e-9."""
    a, b = trial.frozen_run.record["step_size"], (other.record or {}).get("step_size", math.nan) / unit
    require(abs(a - b) <= 1e-9 * a, f"the step becomes {b!r}, it was {a!r} ({trial.frozen_run.record['step_limited_by']}; {(other.record or {}).get('step_limited_by')})")


def a_little_aside(run):
    run.frames[-1].position[0, 0] += 1e-2 * run.scene.size()


def moved_back(how):
    def back(frame):
        inverse = how.matrix.T
        found = {"id": frame.ids, "position": (frame.position - how.shift) @ inverse.T, "velocity": frame.velocity @ inverse.T,
                 "angular_velocity": how.sign * (frame.spin @ inverse.T)}
        return found
    return back


@relation("near", a_little_aside)
def moved_far_away(trial):
    case = base(trial)
    size = trial.frozen_scene.size()
    way = numpy.array([trial.random.gauss(0, 1) for _ in range(3)])
    shift = way / numpy.linalg.norm(way) * size * 10 ** trial.random.uniform(1, 6)
    how = Placement(shift=shift)
    other = trial.solve_case(placed(case, how))
    if other.completed() and trial.case.value("time", "step_control") != "quantised":
        # the approach that may limit the step is known to a rounding of places over the margins
        a, b = trial.frozen_run.record["step_size"], other.record["step_size"]
        slack = 1e-9 + 1e3 * EPSILON * numpy.abs(shift).max() / (trial.frozen_scene.general["margin"] + 1e-3 * size)
        require(abs(a - b) <= slack * a, f"moved by {shift.tolist()}, the step becomes {b!r}, it was {a!r}")
    near(trial, other, moved_back(how), 2 * EPSILON * (numpy.abs(shift).max() + reach_of(trial.frozen_run)), f"moved by {shift.tolist()}")


@relation("near", a_little_aside)
def turned(trial):
    how = Placement(turn=right_angle_turns()[trial.random.randrange(23)])
    other = trial.solve_case(placed(base(trial), how))
    same_step(trial, other)
    near(trial, other, moved_back(how), 0, f"turned by {how.turn.astype(int).tolist()}")


@relation("near", a_little_aside)
def mirrored(trial):
    if is_cut(trial.case):
        raise NotApplicable("a mirrored mesh is cut elsewhere")
    if any("wear" in wall and "file" not in wall["shape"] for wall in trial.case.walls):
        raise NotApplicable("a wall wears triangle by triangle, and the diagonals of a form's faces are not mirrored")
    how = Placement(turn=right_angle_turns()[trial.random.randrange(24)], mirrored=True)
    other = trial.solve_case(placed(base(trial), how))
    same_step(trial, other)
    near(trial, other, moved_back(how), 0, f"mirrored by {how.matrix.astype(int).tolist()}")


@relation("near", a_little_aside)
def in_other_units(trial):
    """Powers of two: nothing rounds otherwise, except in roots."""
    length, mass, time = (2.0 ** trial.random.randint(-12, 12) for _ in range(3))
    other = trial.solve_case(in_units(base(trial), length, mass, time))
    same_step(trial, other, time)

    def back(frame):
        return {"id": frame.ids, "position": frame.position / length, "velocity": frame.velocity / (length / time),
                "angular_velocity": frame.spin * time, "quat": frame.quat, "time": frame.time / time}
    near(trial, other, back, 0, f"units of {length:g} m, {mass:g} kg, {time:g} s")


@relation("near", a_little_aside)
def in_another_order(trial):
    case = base(trial)
    order = list(range(len(case.bodies)))
    if len(order) < 2:
        raise NotApplicable("one body has one order")
    trial.random.shuffle(order)
    other = trial.solve_case(reordered(case, order))
    same_step(trial, other)

    def back(frame):
        # pieces have ids above all others
        old = numpy.array(order + list(range(len(order), max(frame.ids.max(initial=0) + 1, len(order)))))[frame.ids]
        sort = numpy.argsort(old)
        return {"id": old[sort], "position": frame.position[sort], "velocity": frame.velocity[sort], "angular_velocity": frame.spin[sort], "quat": frame.quat[sort]}
    near(trial, other, back, 0, f"bodies in the order {order}")


@relation("near", a_little_aside)
def split_faces(trial):
    """More triangles, the same surface."""
    if is_cut(trial.case):
        raise NotApplicable("cells of split faces have other triangles and are moved in otherwise")
    case = base(trial)
    if not case.meshes or case.value("contact", "gather", "potential") != "potential":
        raise NotApplicable("triangles are no more than a surface with gather = potential only")
    if any("wear" in wall for wall in case.walls):
        raise NotApplicable("a wall wears triangle by triangle")
    other = trial.solve_case(with_split_faces(case, trial.random))
    same_step(trial, other)
    near(trial, other, as_it_is, 0, "with split faces")


@relation("near", a_little_aside)
def other_origin_of_meshes(trial):
    """A wall's mesh told about another origin, placed where it was: motions turn about their own centre, not about the mesh's."""
    case = base(trial)
    walls = [wall for wall in case.walls if "file" in wall["shape"]]
    if not walls:
        raise NotApplicable("no walls from files")
    if any("cell_size" in wall for wall in walls):
        raise NotApplicable("the cells of a wall lie about the origin of its mesh")
    other = case.copy()
    size = trial.frozen_scene.size()
    for wall in other.walls:
        if "file" not in wall["shape"]:
            continue
        name = wall["shape"]["file"][1:]
        mesh = case.meshes[name]
        # whole grid steps of the mesh, so that its vertices stay exact
        unit = 2.0 ** round(math.log2(size))
        shift = unit * numpy.array([trial.random.randint(-20, 20) for _ in range(3)])
        other.meshes[name + "_elsewhere"] = Mesh(mesh.vertices + shift, mesh.triangles, mesh.surface)
        wall["shape"] = {"file": f"@{name}_elsewhere"}
        away = turned_by(wall.get("orientation", [1, 0, 0, 0]), wall.get("scale", 1.0) * shift[None])[0]
        wall["position"] = (numpy.array(wall.get("position", [0, 0, 0]), float) - away).tolist()
    run = trial.solve_case(other)
    reach = 40 * size * max(wall.get("scale", 1.0) for wall in walls)
    near(trial, run, as_it_is, 2 * EPSILON * reach, "with meshes about another origin")


@relation("near", a_little_aside)
def winding_of_a_wall(trial):
    """Triangles of walls turned over, all or some: bodies touch both sides of a wall."""
    case = base(trial)
    names = {wall["shape"]["file"][1:] for wall in case.walls if "file" in wall["shape"] and "wear" not in wall}
    names = sorted(name for name in names if case.meshes[name].surface)
    if not names:
        raise NotApplicable("no walls from files that are surfaces; a wall that wears recedes to one side")
    other = case.copy()
    share = trial.random.choice([1.0, 0.5, 0.2])
    for name in names:
        mesh = case.meshes[name]
        turned_over = numpy.array([trial.random.random() < share for _ in mesh.triangles])
        triangles = numpy.where(turned_over[:, None], mesh.triangles[:, [0, 2, 1]], mesh.triangles)
        other.meshes[name + "_turned"] = Mesh(mesh.vertices, triangles, True)
    for wall in other.walls:
        if wall["shape"].get("file", "@")[1:] in names and "wear" not in wall:
            wall["shape"] = {"file": wall["shape"]["file"] + "_turned"}
    run = trial.solve_case(other)
    same_step(trial, run)
    near(trial, run, as_it_is, 0, f"with {share:g} of the triangles of {', '.join(names)} turned over")


@relation("near", a_little_aside)
def placed_one_by_one(trial):
    """What the decomposer placed, placed by hand: the same places, another order of ids."""
    base(trial)
    if not trial.case.populations:
        raise NotApplicable("no populations")
    run, other = trial.completed(), trial.frozen_run
    size, speed = trial.scene.size(), speed_of(run)
    ids = {old: new for new, old in enumerate(sorted(trial.scene.bodies["id"]))}
    trial.seen(other)
    require(abs(run.record["step_size"] - other.record["step_size"]) <= 1e-9 * run.record["step_size"], "placed one by one, the step differs")

    def back(frame):
        old = sorted(ids)
        return as_it_is(frame) | {"id": numpy.array([old[i] for i in frame.ids])}
    # at the start nothing has happened yet
    d = distances(run, other, back, size, speed)
    require(d[0] <= 1e-12, f"placed one by one, bodies start {d[0]:.3g} apart")
    if trial.spoil is not None:
        require(d[-1] <= 1e-6, "spoilt")
