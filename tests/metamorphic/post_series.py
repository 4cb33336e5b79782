"""Statistics of scree-post worked out anew from the frames and the tables of events: numbers of groups, what passed gates, mixing."""
import math
import os
import re

import numpy

from geometry import turned
from model import Case
from post_says import read_csv
from relations import NotApplicable, relation, require
from tools import read_json

kDigits = 1e-7         # tables have nine
kApparatusSize = 5     # STATISTICS.md: what is so many times as large as the median body is no particle


def statistics(trial, run, *words):
    """Folder of the tables, and what was said."""
    out = trial.tools.new_path(".statistics")
    code, said, err = trial.tools.call("scree-post", "statistics", run.folder, "-o", out, "--no-charts", *words)
    require(code == 0, f"post statistics ends with {code}: {err.strip()[-800:]}")
    return out, said + err


def number(text):
    return float(text) if text not in ("", None) else math.nan


# ---- which bodies count

class Counted:
    """The bodies of a run that are particles."""

    def __init__(self, run, all_of_them):
        self.run, self.scene = run, run.scene
        scene = self.scene
        reach = [shape["radius"] if shape["kind"] == 2 else float(numpy.linalg.norm(shape["vertices"], axis=1).max()) if len(shape["vertices"]) else 0.0
                 for shape in scene.shapes]
        self.reach = numpy.array(reach)
        self.volume = numpy.array([shape["volume"] for shape in scene.shapes])
        self.diameter = numpy.cbrt(6 * self.volume / math.pi)
        self.density = numpy.array([material["density"] for material in scene.materials])
        names = {shape["name"]: k for k, shape in enumerate(scene.shapes)}
        # id: shape, scale, origin (a population, -1 for [[bodies]], the name of an inlet), in the order in which they came
        self.all = {}
        fixed = set()
        for i in range(scene.count):
            key = int(scene.bodies["id"][i])
            self.all[key] = int(scene.bodies["shape"][i]), float(scene.bodies["scale"][i]), int(scene.bodies["population"][i]), int(scene.bodies["material"][i])
            if scene.bodies["fixed"][i]:
                fixed.add(key)
        of_inlet = {inlet["name"]: inlet["material"] for inlet in scene.settings.get("inlets", [])}
        for row in run.events("inserted.csv"):
            shape = names[row["shape"]]
            self.all.setdefault(int(row["id"]), (shape, float(row["diameter"]) / self.diameter[shape], row["inlet"], of_inlet[row["inlet"]]))
        self.walls = set(fixed)
        if not all_of_them:
            poured = [self.size(key) for key, (_, _, origin, _) in self.all.items() if isinstance(origin, int) and origin >= 0 and key not in fixed]
            came = [self.size(key) for key, (_, _, origin, _) in self.all.items() if isinstance(origin, str)]
            sizes = sorted(poured or came)
            if sizes:
                limit = kApparatusSize * sizes[len(sizes) // 2]
                self.walls |= {key for key, (_, _, origin, _) in self.all.items() if origin == -1 and self.size(key) >= limit}

    def size(self, key):
        shape, scale, _, _ = self.all[key]
        return scale * self.reach[shape]

    def masses(self, frame):
        return self.density[frame.bodies["material"]] * self.volume[frame.bodies["shape"]] * frame.bodies["scale"] ** 3

    def particles(self, frame):
        return numpy.array([int(i) not in self.walls for i in frame.ids], bool)


# ---- which have left

def box_of(scene, wall, place, q):
    """Around a wall or a region of an inlet at its place; None for a plane."""
    if wall["kind"] == "plane":
        return None
    if wall["kind"] == "mesh":
        points = turned(q, wall["scale"] * scene.shapes[wall["shape"]]["vertices"]) + place
    elif wall["kind"] == "box_inside":
        ends = numpy.array([wall["lower"], wall["upper"]])
        points = turned(q, numpy.array([[ends[i, 0], ends[j, 1], ends[m, 2]] for i in (0, 1) for j in (0, 1) for m in (0, 1)])) + place
    elif wall["kind"] == "cylinder_inside":
        ends = turned(q, numpy.array([wall["axis_start"], wall["axis_end"]], float)) + place
        axis = (ends[1] - ends[0]) / numpy.linalg.norm(ends[1] - ends[0])
        out = wall["radius"] * numpy.sqrt(numpy.maximum(0, 1 - axis**2))
        points = numpy.vstack([ends - out, ends + out])
    else:
        middle = turned(q, numpy.array([wall["point"]], float)) + place
        points = numpy.vstack([middle - wall["radius"], middle + wall["radius"]])
    return points.min(axis=0), points.max(axis=0)


def place_of(scene, frame, k):
    row = list(frame.walls["id"]).index(scene.walls[k]["id"])
    return frame.walls["position"][row], frame.walls["orientation"][row]


def equipment(counted, frame):
    scene = counted.scene
    boxes = [box_of(scene, wall, *place_of(scene, frame, k)) for k, wall in enumerate(scene.walls)]
    reach = counted.reach[frame.bodies["shape"]] * frame.bodies["scale"]
    boxes += [(frame.position[i] - reach[i], frame.position[i] + reach[i]) for i in numpy.flatnonzero(~counted.particles(frame))]
    boxes = [box for box in boxes if box is not None]
    return (numpy.min([low for low, _ in boxes], axis=0), numpy.max([high for _, high in boxes], axis=0)) if boxes else None


def opened(box, scene, sideways):
    """Open upwards, along periodic axes, and to all sides where only what is below has left."""
    gravity = numpy.array(scene.general["gravity"])
    up = int(numpy.argmax(numpy.abs(gravity)))
    low, high = box[0].copy(), box[1].copy()
    (low if gravity[up] > 0 else high)[up] = math.copysign(math.inf, -gravity[up])
    for k in range(3):
        if scene.general.get("domain", {}).get("periodic", [False] * 3)[k] or sideways and k != up:
            low[k], high[k] = -math.inf, math.inf
    return low, high


def reaches_into(box, x, reach):
    return ((x + numpy.reshape(reach, (-1, 1)) >= box[0]) & (x - numpy.reshape(reach, (-1, 1)) <= box[1])).all(axis=1)


def in_the_equipment(counted):
    """Gives a function of a frame: which bodies have not left (STATISTICS.md, bodies that have left)."""
    run, scene = counted.run, counted.scene
    everywhere = lambda frame: numpy.ones(len(frame.ids), bool)   # noqa: E731
    first = run.frames[0]
    if any(wall["kind"] == "plane" for wall in scene.walls) or not numpy.any(scene.general["gravity"]):
        return everywhere
    begin = equipment(counted, first)
    if begin is None:
        return everywhere
    regions = [inlet["region"] for inlet in scene.settings.get("inlets", [])]
    inlets = [box_of(scene, region, numpy.array(region.get("position", [0, 0, 0])), region.get("orientation", [1.0, 0, 0, 0])) for region in regions]
    particles = counted.particles(first)
    reach = counted.reach[first.bodies["shape"]] * first.bodies["scale"]
    for sideways in (False, True):
        box = opened(begin, scene, sideways)
        if reaches_into(box, first.position, reach)[particles].all() and all(reaches_into(box, numpy.array(corners), [0, 0]).all() for corners in inlets):
            break
    else:
        return everywhere

    def holds(frame):
        now = equipment(counted, frame)
        both = numpy.minimum(begin[0], now[0]), numpy.maximum(begin[1], now[1])
        inside = reaches_into(opened(both, scene, sideways), frame.position, counted.reach[frame.bodies["shape"]] * frame.bodies["scale"])
        return inside | ~counted.particles(frame)
    return holds


# ---- numbers of a group

def expected_of(counted, frame, stays, member):
    """Of the particles `member`; contacts of bodies that have left are none."""
    f, mass = frame, counted.masses(frame)
    particle = counted.particles(frame) & stays
    member = member & particle
    m, v = mass[member], f.velocity[member]
    found = {"particle_count": float(member.sum()), "mass": m.sum()}
    scale = {}
    if member.any():
        mean = (m[:, None] * v).sum(axis=0) / m.sum()
        centre = (m[:, None] * f.position[member]).sum(axis=0) / m.sum()
        speed = numpy.linalg.norm(v, axis=1)
        for k, axis in enumerate("xyz"):
            found[f"velocity_{axis}"], found[f"centre_of_mass_{axis}"] = mean[k], centre[k]
            scale[f"velocity_{axis}"], scale[f"centre_of_mass_{axis}"] = speed.max(), numpy.abs(f.position[member]).max()
        found["mean_speed"] = (m * speed).sum() / m.sum()
        found["mean_spin"] = numpy.linalg.norm(f.spin[member], axis=1).mean()
        found["granular_temperature"] = (m * ((v - mean) ** 2).sum(axis=1)).sum() / m.sum() / 3
        scale["granular_temperature"] = (speed**2).max()
    else:
        found |= {name: math.nan for name in ("velocity_x", "centre_of_mass_y", "mean_speed", "mean_spin", "granular_temperature")}
    return found, scale


def kinds_of_contacts(points, patch):
    """The contacts of a pair, by the definition of post/README.md: (strength, place, normal) of its points; patch [m]."""
    kinds = []
    while points:
        strongest = max(range(len(points)), key=lambda k: abs(points[k][0]))
        normal = points[strongest][2]
        mine = [p[1] for k, p in enumerate(points) if k == strongest or p[2] @ normal >= math.cos(math.radians(25.0))]
        points = [p for k, p in enumerate(points) if k != strongest and p[2] @ normal < math.cos(math.radians(25.0))]
        far = max(((numpy.linalg.norm(q - p), k, l) for k, p in enumerate(mine) for l, q in enumerate(mine) if l > k), default=(0.0, 0, 0))
        width = 0.0
        if far[0] > 0:
            line = (mine[far[2]] - mine[far[1]]) / far[0]
            width = max(numpy.linalg.norm(numpy.cross(p - mine[far[1]], line)) for p in mine)
        kinds.append("face" if width > patch else "edge" if far[0] > patch else "point")
    return kinds


def expected_constraints(counted, frame, stays, member):
    """Contacts by kind and constraints per particle; nothing of scenes with periodic sides, whose contact points lie in any image."""
    if any(counted.scene.general.get("domain", {}).get("periodic", [False] * 3)):
        return {}
    c, particle = frame.contacts, counted.particles(frame) & stays
    member = member & particle
    row = {int(i): k for k, i in enumerate(frame.ids)}
    size = counted.diameter[frame.bodies["shape"]] * frame.bodies["scale"]
    pairs = {}
    for i in range(len(c.get("depth", ()))):
        pair = int(c["body_a"][i]), int(c["body_b"][i])
        if c["normal_force"][i] != 0 and all(stays[row[k]] for k in pair if k in row):
            pairs.setdefault(pair, []).append((c["normal_force"][i], c["point"][i], c["normal"][i]))
    found = dict.fromkeys(("point_contacts", "edge_contacts", "face_contacts", "constraints", "constraints_frictionless"), 0.0)
    for pair, points in pairs.items():
        rows = [row[k] for k in pair if k in row]
        mine = [k for k in rows if member[k]]
        both = sum(bool(particle[k]) for k in rows) == 2
        for kind in kinds_of_contacts(points, 0.1 * min((size[k] for k in rows if size[k] > 0), default=math.inf)):
            found[f"{kind}_contacts"] += len(mine)
            found["constraints"] += len(mine) * {"point": 3, "edge": 5, "face": 6}[kind] * (0.5 if both else 1)
            found["constraints_frictionless"] += len(mine) * {"point": 1, "edge": 2, "face": 3}[kind]
    count = int(member.sum())
    return {name: value / count if count else math.nan for name, value in found.items()}


def expected_of_contacts(counted, frame, stays, member, whole):
    c = frame.contacts
    particle = counted.particles(frame) & stays
    member = member & particle
    row = {int(i): k for k, i in enumerate(frame.ids)}
    points, forces, shear, neighbours, ends, fabric = 0, [], [], [set() for _ in frame.ids], 0, []
    for i in range(len(c.get("depth", ()))):
        if c["normal_force"][i] == 0:
            continue
        a, b = row.get(int(c["body_a"][i])), row.get(int(c["body_b"][i]))
        if any(k is not None and not stays[k] for k in (a, b)):
            continue
        for k, other in ((a, int(c["body_b"][i])), (b, int(c["body_a"][i]))):
            if k is not None and member[k]:
                neighbours[k].add(other)
                ends += 1
        if not whole and not any(k is not None and member[k] for k in (a, b)):
            continue
        points += 1
        forces.append(c["normal_force"][i])
        shear.append(numpy.linalg.norm(c["tangential_force"][i]))
        if a is not None and b is not None and particle[a] and particle[b]:
            fabric.append(numpy.outer(c["normal"][i], c["normal"][i]))
    count = numpy.array([len(neighbours[k]) for k in numpy.flatnonzero(member)])
    forces, n, nan = numpy.array(forces), max(len(count), 1), math.nan
    held = count >= 2
    found = {"coordination_number": count.sum() / n if len(count) else nan, "rattler_fraction": (~held).sum() / n if len(count) else nan,
             "coordination_number_without_rattlers": count[held].mean() if held.any() else nan,
             "contact_points_per_particle": ends / n if len(count) else nan,
             "mean_normal_force": forces.mean() if points else nan, "max_normal_force": max(0.0, forces.max(initial=0)),
             "mean_tangential_force": numpy.mean(shear) if points else nan, "tensile_fraction": (forces < 0).mean() if points else nan,
             "mean_tensile_force": -forces[forces < 0].mean() if (forces < 0).any() else nan,
             "fabric_xx": numpy.mean([f[0, 0] for f in fabric]) if fabric else nan, "fabric_yz": numpy.mean([f[1, 2] for f in fabric]) if fabric else nan}
    found |= expected_constraints(counted, frame, stays, member)
    size = numpy.abs(forces).max(initial=0)
    return found, {"mean_normal_force": size, "fabric_xx": 1.0, "fabric_yz": 1.0}


def compare(row, found, scale, where):
    for name, value in found.items():
        said = number(row[name])
        if math.isnan(value) or math.isnan(said):
            require(math.isnan(value) and math.isnan(said), f"{where}: {name} is {row[name] or 'empty'}, the frame gives {value}")
            continue
        slack = kDigits * max(abs(value), scale.get(name, 0.0)) + 1e-300
        require(abs(said - value) <= slack, f"{where}: {name} is {row[name]}, the frame gives {value!r}")


def other_speed(rows):
    for row in rows:
        row["particle_count"] = repr(number(row["particle_count"]) + 1)


@relation("sums", other_speed)
def post_series(trial):
    """Number, mass, motion, neighbours and forces of all particles, by material and by shape, in every frame: also where bodies come in, leave or are spilled."""
    run = trial.completed()
    if not run.frames:
        raise NotApplicable("no frames")
    r, has_contacts = trial.random, run.scene.general.get("output_contacts", True)
    every_one, everywhere = r.random() < 0.4, r.random() < 0.3
    counted = Counted(run, every_one)
    holds = (lambda frame: numpy.ones(len(frame.ids), bool)) if everywhere else in_the_equipment(counted)
    words = ["--by-material", "--by-shape", *(["--count-all"] if every_one else []), *(["--within", "all"] if everywhere else [])]
    level = None
    if r.random() < 0.4:
        spots = numpy.concatenate([frame.position for frame in run.frames])
        axis = r.randrange(3)
        if len(spots):
            low, high = spots[:, axis].min(), spots[:, axis].max()
            level = axis, low + (high - low) * r.random()
            words += ["--discharge", f"{'xyz'[axis]}={level[1]!r}"]
    folder, said = statistics(trial, run, *words)
    rows = read_csv(os.path.join(folder, "series.csv"))
    trial.seen(rows)
    table = {(int(row["frame"]), row["group"]): row for row in rows}
    scene = run.scene
    groups = {"all": lambda f: numpy.ones(len(f.ids), bool)}
    groups |= {f"material {m['name']}": lambda f, k=k: f.bodies["material"] == k for k, m in enumerate(scene.materials)}
    groups |= {f"shape {s['name']}": lambda f, k=k: f.bodies["shape"] == k for k, s in enumerate(scene.shapes) if s["volume"] > 0 and s["kind"] != 1}
    missing = [name for name in groups if (run.frames[0].number, name) not in table and not name.startswith("shape")]
    require(not missing, f"series.csv has no group {missing}")
    start = sum(counted.density[material] * counted.volume[shape] * scale**3 for key, (shape, scale, origin, material) in counted.all.items()
                if not isinstance(origin, str) and key not in counted.walls)
    gone = {name: [(int(row["step"]), float(row["mass"])) for row in run.events(name) if int(row["id"]) not in counted.walls]
            for name in ("inserted.csv", "removed.csv")}
    removes = bool(scene.settings.get("outlets")) or scene.general.get("domain", {}).get("outside") == "remove"
    before, left = None, 0
    for frame in run.frames:
        stays = holds(frame)
        left = int((~stays).sum())
        for name, of in groups.items():
            row = table.get((frame.number, name))
            if row is None:
                continue   # a shape that is a wall
            where = f"frame {frame.number}, {name}"
            compare(row, *expected_of(counted, frame, stays, of(frame)), where)
            if has_contacts:
                compare(row, *expected_of_contacts(counted, frame, stays, of(frame), name == "all"), where)
        row, where = table[frame.number, "all"], f"frame {frame.number}, all"
        compare(row, {key: frame.attributes[name] for key, name in (("kinetic_energy", "kinetic"), ("potential_energy", "potential"),
                                                                    ("elastic_energy", "elastic"), ("dissipated_energy", "dissipated"))}, {}, where)
        step = frame.attributes["step"]
        came = sum(mass for at, mass in gone["inserted.csv"] if at <= step)
        masses = counted.masses(frame)[counted.particles(frame)]
        passed = math.nan
        if level is not None:
            passed = start + came - masses[frame.position[counted.particles(frame)][:, level[0]] > level[1]].sum()
        elif removes:
            passed = start + came - masses.sum()
        compare(row, {"discharged_mass": passed}, {"discharged_mass": start + came}, where)
        if before is not None:
            rate = (passed - before[1]) / (frame.time - before[0]) if frame.time > before[0] else math.nan
            compare(row, {"discharge_rate": rate}, {"discharge_rate": (start + came) / max(frame.time - before[0], 1e-300)}, where)
        before = frame.time, passed
    told = re.search(r"(\d+) bod(?:y has|ies have) left the equipment", said)
    if left:
        require(told and int(told.group(1)) == left, f"{left} bodies have left at the last frame, and post says: {told.group(0) if told else 'nothing'}")


# ---- gates

def another_gate(rows):
    for row in rows:
        row["mass"] = repr(number(row["mass"]) * 1.01 + 1e-9)


@relation("sums", another_gate)
def post_flow(trial):
    """What passed inlets, outlets and the sides of the domain, how long it stayed and how large it was: from inserted.csv and removed.csv."""
    run = trial.completed()
    inserted, removed = run.events("inserted.csv"), run.events("removed.csv")
    if not inserted and not removed or len(run.frames) < 2:
        raise NotApplicable("nothing passed")
    counted = Counted(run, True)
    folder, _ = statistics(trial, run)
    begin, end = run.frames[0].time, run.frames[-1].time
    path = os.path.join(folder, "flow.csv")
    gates = {}   # name: time, mass, diameter, residence
    for row in inserted:
        gates.setdefault("inlet " + row["inlet"], []).append((float(row["time"]), float(row["mass"]), float(row["diameter"]), 0.0))
    for row in removed:
        shape, scale, _, _ = counted.all[int(row["id"])]
        name = "outlet " + row["outlet"] if row["outlet"] else "sides of the domain"
        gates.setdefault(name, []).append((float(row["time"]), float(row["mass"]), scale * counted.diameter[shape], float(row["residence_time"])))
    gates = {name: numpy.array(events)[[begin < e[0] <= end or e[0] == begin == 0 for e in events]].reshape(-1, 4) for name, events in gates.items()}
    if not any(len(events) for events in gates.values()):
        require(not os.path.exists(path), "flow.csv, and nothing passed")
        return
    rows = read_csv(path)
    trial.seen(rows)
    named = {row["gate"] for row in rows}
    require(set(gates) <= named, f"flow.csv has the gates {named}, there were {set(gates)}")
    count = min(max(max(map(len, gates.values())) // 10, 5), 200)
    width = (end - begin) / count
    for name in sorted(named):
        events = gates.get(name, numpy.zeros((0, 4)))
        mine = [row for row in rows if row["gate"] == name]
        require(len(mine) == count, f"gate {name}: {len(mine)} intervals, {count} expected")
        for k, row in enumerate(mine):
            until = begin + (k + 1) * width
            edge = numpy.abs(events[:, 0] - until) < 1e-9 * end
            if k + 1 < count and edge.any():
                continue   # of either interval
            mass = events[events[:, 0] <= until][:, 1].sum() if k + 1 < count else events[:, 1].sum()
            require(abs(number(row["mass"]) - mass) <= kDigits * max(mass, 1e-300), f"gate {name}: {row['mass']} kg by {row['time']} s, the tables have {mass!r}")
            before = number(mine[k - 1]["mass"]) if k else 0.0
            rate = (number(row["mass"]) - before) / width
            require(abs(number(row["mass_flow"]) - rate) <= 1e-6 * max(number(row["mass"]) / width, 1e-300), f"gate {name}: {row['mass_flow']} kg/s until {row['time']} s, not {rate!r}")
    sizes = read_csv(os.path.join(folder, "sizes_passed.csv"))
    for row, following in zip(sizes, sizes[1:] + [None]):
        if following and following["gate"] == row["gate"] and float(following["diameter"]) <= float(row["diameter"]) * (1 + 1e-8):
            continue   # sizes that differ by rounding have rows of their own
        events = gates[row["gate"]]
        finer = events[events[:, 2] <= float(row["diameter"]) * (1 + 1e-8)][:, 1].sum() / events[:, 1].sum()
        require(abs(finer - float(row["share"])) <= kDigits, f"gate {row['gate']}: {row['share']} is finer than {row['diameter']} m, the tables have {finer!r}")
    told = read_json(os.path.join(folder, "statistics.json"))["flow"]["gates"]
    for name, events in gates.items():
        require(told[name]["bodies"] == len(events), f"gate {name}: {told[name]['bodies']} bodies passed, the tables have {len(events)}")
        if name.startswith("inlet") or not len(events):
            continue
        mean = (events[:, 1] * events[:, 3]).sum() / events[:, 1].sum()
        require(abs(told[name]["residence_time"]["mean"] - mean) <= 1e-6 * max(mean, 1e-300), f"gate {name}: bodies stayed {told[name]['residence_time']['mean']} s, the tables have {mean!r}")
        if (events[:, 3] > 0).any():
            times = [row for row in read_csv(os.path.join(folder, "residence_times.csv")) if row["gate"] == name]
            require(times and abs(float(times[-1]["share"]) - 1) <= kDigits, f"gate {name}: shares of residence times end at {times[-1]['share'] if times else 'none'}")


# ---- mixing

def mixing_scene(trial):
    """Two kinds of balls that fly about and touch now and then; more come in and some leave. Enough for the index, which needs sixty."""
    r, radius = trial.random, 0.01
    half = 0.2
    room = [[-half, -half, -half], [half, half, half]]
    words = {"gravity": [0, 0, 0] if r.random() < 0.7 else [0, 0, -0.05], "time": {"duration": 0.4},
             "shapes": {"ball0": {"sphere": {"radius": radius}}, "ball1": {"sphere": {"radius": 0.6 * radius}}},
             "materials": {"m": {"density": 2000.0}, "other": {"density": 1000.0}},
             "pairs": [{"between": [a, b], "stiffness": 1e3, "restitution": 0.5} for a, b in (("m", "m"), ("m", "other"), ("other", "other"))],
             "contact": {"margin": 0.0}, "output": {"every": 0.1}, "seed": r.randrange(1000)}

    def of_kind(k):
        entry = {"shape": f"ball{k}", "material": r.choice(["m", "other"]) if r.random() < 0.4 else ("m", "other")[k],
                 "velocity": [r.uniform(-0.3, 0.3) for _ in range(3)], "region": {"box": room}}
        if r.random() < 0.4:
            entry["size"] = {"distribution": "uniform", "min": radius, "max": 2 * radius}
        return entry
    kind = r.choice(["populations", "inlets", "both", "both"])
    if kind != "inlets":
        words["populations"] = [of_kind(k) | {"count": r.randint(25, 80)} for k in range(r.choice([1, 2, 2]))]
    if kind != "populations":
        words["inlets"] = [of_kind(k) | {"name": f"feed{k}", "number_rate": r.uniform(100, 250), "region": {"box": [room[0], [0, half, half]]}} for k in range(r.choice([1, 2, 2]))]
        if r.random() < 0.3:
            words["inlets"][0]["start"] = 0.15
    if r.random() < 0.5:
        words["outlets"] = [{"region": {"box": [[r.uniform(0.1, 1) * half, -half, -half], [half, half, half]]}}]
    return Case(words)


def lacey(positions, kind):
    """STATISTICS.md, mixing_index: cells of about 12 particles, cubes from the lowest corner on."""
    n = len(kind)
    p = kind.mean() if n else 0.0
    if n < 60 or not 0 < p < 1:
        return math.nan
    low, extent = positions.min(axis=0), positions.max(axis=0) - positions.min(axis=0)
    room = numpy.prod(numpy.maximum(extent, 1e-6 * extent.max()))
    cells = ((positions - low) / numpy.cbrt(12 * room / n)).astype(int)
    _, cell = numpy.unique(cells, axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = numpy.bincount(cell)
    share = numpy.bincount(cell, kind) / count
    variance, apart = (count * (share - p) ** 2).sum() / n, p * (1 - p)
    random = apart * len(count) / n
    return (apart - variance) / (apart - random) if apart > random else math.nan


def lacey_apart(positions, kind):
    """mixing_index_apart: the least over two layers along each axis, either kind below."""
    found, ones = [math.nan], int(kind.sum()) if len(kind) else 0
    for axis in range(3):
        order = numpy.argsort(positions[:, axis], kind="stable")
        for chosen in (order[:ones], order[len(order) - ones:]):
            layers = numpy.zeros(len(kind))
            layers[chosen] = 1
            found.append(lacey(positions, layers))
    return float(numpy.nanmin(found)) if not numpy.isnan(found).all() else math.nan


def mixed_more(rows):
    for row in rows:
        for name in ("mixing_index", "mixing_index_apart", "segregation_fine", "segregation_coarse"):
            row[name] = repr(number(row[name]) + 0.01) if row[name] else "0.5"


@relation("sums", mixed_more)
def post_mixing(trial):
    """Lacey's index of two kinds, and how far the sizes are apart, of balls of which some come in and leave."""
    r = trial.random
    run = trial.tools.solve(trial.tools.pack(mixing_scene(trial)))
    require(run.completed(), f"balls that fly about: {run.text[-300:]}")
    counted = Counted(run, True)
    by = r.choice(["auto", "material", "shape", "population", "size", "half-x", "half-y", "half-z"])
    folder, _ = statistics(trial, run, "--mixing", by, "--count-all")
    rows = read_csv(os.path.join(folder, "series.csv"))
    trial.seen(rows)
    keys = list(counted.all)
    if by == "auto":
        by = "material" if len({counted.all[key][3] for key in keys}) > 1 else "half-z"
    if by == "size":
        volumes = numpy.array([counted.volume[counted.all[key][0]] * counted.all[key][1] ** 3 for key in keys])
        median = numpy.sort(volumes)[len(volumes) // 2]
        limit = (1 - 1e-9) * median if volumes.max() <= (1 + 1e-9) * median else (1 + 1e-9) * median
        kinds = {key: int(v > limit) for key, v in zip(keys, volumes)}
    elif by.startswith("half"):
        axis = "xyz".index(by[-1])
        first = next(frame for frame in run.frames if len(frame.ids))
        places = first.position[:, axis]
        middle = numpy.sort(places)[len(places) // 2]
        kinds = {int(i): int(x >= middle) for i, x in zip(first.ids, places)}
    else:
        column = {"material": 3, "shape": 0, "population": 2}[by]
        kinds = {key: int(counted.all[key][column] == counted.all[keys[0]][column]) for key in keys}
    for frame, row in zip(run.frames, [row for row in rows if row["group"] == "all"]):
        where = f"frame {frame.number}, kinds by {by}"
        mine = numpy.array([int(i) in kinds for i in frame.ids], bool)
        kind = numpy.array([kinds[int(i)] for i in frame.ids[mine]], float)
        compare(row, {"mixing_index": lacey(frame.position[mine], kind), "mixing_index_apart": lacey_apart(frame.position[mine], kind)},
                {"mixing_index": 1.0, "mixing_index_apart": 1.0}, where)
        diameters = counted.diameter[frame.bodies["shape"]] * frame.bodies["scale"]
        if not len(diameters):
            continue
        ordered = numpy.sort(diameters)
        fine, coarse = ordered[(len(ordered) - 1) // 3], ordered[2 * len(ordered) // 3]
        if coarse <= fine * (1 + 1e-9):
            classes = numpy.where(diameters < fine * (1 - 1e-9), 0, numpy.where(diameters > coarse * (1 + 1e-9), 2, 1))
        else:
            classes = numpy.where(diameters <= fine * (1 + 1e-9), 0, numpy.where(diameters >= coarse * (1 - 1e-9), 2, 1))
        for k, name in enumerate(("fine", "middle", "coarse")):
            compare(row, {f"segregation_{name}": 1 - lacey(frame.position, (classes == k).astype(float))}, {f"segregation_{name}": 1.0}, where)
