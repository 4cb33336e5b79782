"""What scree-post says of a run, held against the frames: tables, regions, layers, verdicts."""
import csv
import math
import os

import numpy

from geometry import body_samples, periodic_shifts, turned
from relations import NotApplicable, relation, require
from tools import read_json


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


def fixed_ids(scene):
    return {int(i) for i in scene.body("id")[~scene.moving()]}


@relation("sums", fuller)
def post_regions(trial):
    """Solid fraction, number and mass in boxes, cylinders and spheres: held against dense samples of each body, images included."""
    run = trial.completed()
    frame = run.frames[trial.random.randrange(len(run.frames))]
    scene = run.scene
    moving = numpy.array([int(i) not in fixed_ids(scene) for i in frame.ids], bool)
    if not moving.any():
        raise NotApplicable("no particles")
    points, weights, owner = [], [], []
    shifts = periodic_shifts(scene.general)
    volumes = numpy.array([scene.shapes[s]["volume"] for s in frame.bodies["shape"]]) * frame.bodies["scale"] ** 3
    for k in numpy.flatnonzero(moving):
        samples, volume = body_samples(scene.shapes[frame.bodies["shape"][k]], frame.bodies["scale"][k], 1500)
        for shift in shifts:
            points.append(turned(frame.quat[k], samples) + frame.position[k] + shift)
            weights.append(numpy.full(len(samples), volume))
            owner.append(numpy.full(len(samples), k))
    points, weights, owner = numpy.concatenate(points), numpy.concatenate(weights), numpy.concatenate(owner)
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
    post(trial, "statistics", run.folder, "-o", out, "--frames", str(frame.number), "--no-charts", "--count-all", "--within", "all", *words)
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
        # post has up to 2000 points for a body in so small a scene
        slack = 0.05 * math.sqrt((volumes[cut] ** 2).sum()) + 0.01 * solid + 0.01 * volumes.max()
        require(abs(said - solid) <= slack, f"frame {frame.number}, region {kind}:{numbers}: post finds {said:.6g} m^3 of solid, there are {solid:.6g} m^3 ({len(cut)} bodies cut)")
        centres = numpy.zeros(len(frame.ids), bool)
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
    moving = numpy.array([int(i) not in fixed_ids(scene) for i in frame.ids], bool)
    if not moving.any():
        raise NotApplicable("no particles")
    vertical = int(numpy.argmax(numpy.abs(gravity)))
    reach = numpy.array([shape["radius"] if shape["kind"] == 2 else float(numpy.linalg.norm(shape["vertices"], axis=1).max())
                         for shape in (scene.shapes[s] for s in frame.bodies["shape"])]) * frame.bodies["scale"]
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
    post(trial, "statistics", run.folder, "-o", out, "--frames", str(frame.number), "--no-charts", "--container", words, "--profile", f"{axis}:6",
         "--count-all", "--within", "all")
    table = read_csv(os.path.join(out, f"profile_{axis}.csv"))
    trial.seen(table)
    at = numpy.array([float(row[axis]) for row in table])
    fraction = numpy.array([float(row["solid_fraction"] or 0) for row in table])
    width = at[1] - at[0]
    solid = (numpy.array([scene.shapes[s]["volume"] for s in frame.bodies["shape"]]) * frame.bodies["scale"] ** 3)[moving].sum()
    if kind == "box":
        rooms = numpy.full(len(at), width * float(numpy.prod([(2.1 * half)[j] for j in range(3) if j != vertical])))
    elif kind == "upright":
        rooms = numpy.full(len(at), width * math.pi * radius**2)
    else:
        fine = (numpy.arange(400) + 0.5) / 400 - 0.5
        rooms = numpy.array([width * (end[k] - start[k]) * numpy.mean(2 * numpy.sqrt(numpy.maximum(0, radius**2 - (z + fine * width - middle[vertical]) ** 2))) for z in at])
    total = float((fraction * rooms).sum())
    require(fraction.max() <= 1.05, f"a layer of a {kind} container is filled to {fraction.max():.4g}")
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
    lost, removed = run.record["lost_bodies"] + run.record["bodies_outside_domain"], run.record["removed_bodies"]
    require(lost == 0 or verdicts["Lost bodies"]["judgement"] != "good", f"report: {lost} bodies left, and {verdicts['Lost bodies']}")
    all_bodies = len(run.frames[0].bodies["position"]) + run.record.get("inserted_bodies", 0)
    taken = f"{removed} of {all_bodies} removed"  # as the case requires: good, but reported
    require(removed == 0 or taken in verdicts["Lost bodies"]["answer"], f"report: {removed} bodies were taken out, and {verdicts['Lost bodies']}")
