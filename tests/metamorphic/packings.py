"""Packings held against plain geometry: nothing overlaps, and all is as the case asks."""
import copy
import math

import numpy

from geometry import Body, gap, periodic_shifts, point_triangle_distances, triangle_sets_distance, turned, world_triangles
from relations import NotApplicable, Refused, relation, require
from transforms import product


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
    outside = scene.general.get("surface", "outside") == "outside"
    margin = scene.general["margin"] if outside else 0.0
    if not outside:
        # edges and corners are rounded by margins that differ from shape to shape: half of each body must be clear of the others
        for body in bodies:
            body.shrink(0.5)
    population = scene.body("population")
    methods = [p.get("method", "random") for p in trial.case.populations]
    pressed = [k >= 0 and methods[k] in ("settle", "compact") for k in population]
    shifts, fixed = periodic_shifts(scene.general), ~scene.moving()
    piece = [scene.shapes[s]["name"].startswith("cut_") for s in scene.body("shape")]
    drawn, relax = [k >= 0 for k in population], trial.case.value("contact", "relax", "shallow")
    for i, a in enumerate(bodies):
        for j in range(i, len(bodies)):
            b = bodies[j]
            if fixed[i] and fixed[j]:
                continue
            if piece[i] and piece[j]:
                continue   # cells that share an edge alone are nearer where it is sharp; bonds take the contacts of the others
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
    if kind == "several":
        for part in motion["parts"]:
            wall = wall_at_start(wall | {"motion": part})
        return wall
    if kind in ("none", "servo", "outer", "free", "motor"):   # those that answer to force start where they are placed
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
    whole = [body for body in asked if "pieces" not in words["shapes"][body["shape"]]]
    pieces = numpy.array([scene.shapes[s]["name"].startswith("cut_") for s in scene.body("shape")], bool)
    there = int(((of_population < 0) & ~pieces).sum())
    require(there == len(whole), f"{there} bodies of [[bodies]] in the scene, {len(whole)} in the case")
    require(pieces.any() == (len(whole) < len(asked)), f"{pieces.sum()} pieces in the scene")
    if pieces.any():
        # all pieces of the one body that is cut: its mass, about where it is placed
        (body,) = [body for body in asked if "pieces" in words["shapes"][body["shape"]]]
        mesh = trial.case.meshes[words["shapes"][body["shape"]]["file"][1:]]
        p, q, r = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        mass = words["materials"][body["material"]]["density"] * float(numpy.einsum("ij,ij->i", p, numpy.cross(q, r)).sum()) / 6
        found = scene.masses()[pieces]
        require(abs(found.sum() / mass - 1) <= 1e-9, f"pieces of {found.sum()!r} kg of a body of {mass!r} kg")
        asked = whole
    relax = words.get("contact", {}).get("relax", "shallow")
    for i, body in enumerate(asked):
        if relax is not True:
            # parted by at most two margins; balls that touch where they are drawn by 2 % of their radius
            margin = scene.general.get("margin_ratio", 0) * scene.radii()[i] if scene.general.get("surface") == "drawn" else scene.general["margin"]
            is_ball = scene.shapes[scene.body("shape")[i]]["kind"] == 2
            pressed_in = 0.02 * scene.radii()[i] if is_ball and scene.general.get("surface") == "drawn" else 2 * margin
            most = pressed_in * 1.0001 + 1e-6 * scene.radii()[i] if relax == "shallow" else 0.0
            way = float(numpy.linalg.norm(scene.body("position")[i] - body["position"]))
            require(way <= most, f"bodies[{i}] is at {scene.body('position')[i].tolist()}, {way:.6g} m from {body['position']} that was asked")
        require(numpy.array_equal(scene.body("velocity")[i], numpy.array(body.get("velocity", [0, 0, 0]), float)), f"bodies[{i}] has another velocity")
    masses, diameters = scene.masses(), (6 * scene.of_shape("volume") / math.pi) ** (1 / 3) * scene.body("scale")
    for k, population in enumerate(trial.case.populations):
        mine = numpy.flatnonzero(of_population == k)
        method = population.get("method", "random")
        total, largest = masses[mine].sum(), masses[mine].max(initial=0)
        if "count" in population:
            require(len(mine) == population["count"], f"populations[{k}]: {len(mine)} bodies, {population['count']} asked")
        if "mass" in population:
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
        if not body.is_ball and scene.general.get("surface") != "outside":
            # what touches lies in the region; a corner of the drawn surface sticks out of its rounding, that of a tetrahedron by two margins
            slack += 3 * (scene.general.get("margin_ratio", 0) * body.reach if scene.general.get("surface") == "drawn" else scene.general["margin"])
        require(inside >= -slack, f"populations[{k}]: body {body.id} is {-inside:.6g} m outside its region")


def moved(body, shift):
    other = copy.copy(body)
    other.position = body.position + shift
    if not body.is_ball:
        other.triangles = body.triangles + shift
    return other
