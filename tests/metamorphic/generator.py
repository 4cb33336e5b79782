"""Random valid cases over everything that the case language knows.

One function per feature of the language, called in the order of FEATURES; each draws whether and how its feature is in the case. A new
feature joins with one function here and, where it has numbers, lines in dimensions.py. What the functions share is in Draft.

Sizes are chosen so that a run of at most 60 bodies takes a second at most.
"""
import copy
import math
import random as random_numbers

import numpy

import solids
from geometry import turned
from model import Case
from transforms import Placement, placed, right_angle_turns

FEATURES = []
OF_BALLS_ALONE = []          # those of a scene of balls alone
kShareOfBallsAlone = 0.12    # of all cases: the features of the others leave one in a thousand


def feature(function):
    FEATURES.append(function)
    return function


def of_balls(function):
    """A feature that scenes of balls alone have too."""
    OF_BALLS_ALONE.append(function)
    return function


class Draft:
    """A case in the making.

    radius of the largest body, speed: units of length and velocity; margin, depth: of a contact that takes the fastest impact
    room: where bodies may be placed, two corners; clear of all walls by `gap`
    valleys: concave places of walls, a point and the normals of the faces that meet there; laid: how many bodies lie in
    some; laid_in: where, two corners
    alone: balls, walls of formulas that stand still or move, and gravity, and nothing else: steps go without a break (decisions/045)
    """

    def __init__(self, seed):
        self.random = random_numbers.Random(f"case {seed}")
        self.alone = random_numbers.Random(f"balls alone {seed}").random() < kShareOfBallsAlone
        self.case = Case({"title": f"seed {seed}", "seed": self.random.randrange(1000)}, note=f"seed {seed}")
        self.words = self.case.words
        self.extra_speed = 0.0    # of walls
        self.valleys, self.laid, self.laid_in = [], 0, None
        self.by_size = False      # margins, of bodies of different scales

    def chance(self, probability):
        return self.random.random() < probability

    def between(self, low, high):
        return self.random.uniform(low, high)

    def log_between(self, low, high):
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    def pick(self, weights):
        """One of the keys of {choice: weight}."""
        return self.random.choices(list(weights), list(weights.values()))[0]

    def direction(self):
        while True:
            v = numpy.array([self.random.gauss(0, 1) for _ in range(3)])
            if numpy.linalg.norm(v) > 0.1:
                return v / numpy.linalg.norm(v)

    def quaternion(self):
        while True:
            q = numpy.array([self.random.gauss(0, 1) for _ in range(4)])
            if numpy.linalg.norm(q) > 0.1:
                return (q / numpy.linalg.norm(q)).tolist()

    def wall(self, shape, **more):
        material = self.random.choice(self.wall_materials)
        self.case.walls.append({"shape": shape, "material": material, **more})
        return self.case.walls[-1]


def generate(seed):
    draft = Draft(seed)
    for function in OF_BALLS_ALONE if draft.alone else FEATURES:
        function(draft)
    return draft.case


# ---- what a scene is made of

@of_balls
@feature
def scale_of_things(d):
    """Lengths from millimetres to metres, densities of foam to steel, speeds around those of a fall by a radius."""
    d.radius = d.log_between(1e-3, 1.0)
    d.density = d.log_between(300, 8000)
    d.speed = math.sqrt(9.81 * d.radius) * d.log_between(0.3, 3)
    d.margin = d.radius * d.between(0.02, 0.1)


@of_balls
@feature
def gravity(d):
    kind = d.pick({"default": 4, "none": 3, "other": 3})
    if kind == "none":
        d.words["gravity"] = [0, 0, 0]
    elif kind == "other":
        size = d.speed**2 / d.radius * d.log_between(0.02, 1)
        lean = d.direction() * d.between(0, 0.4) + [0, 0, -1]
        d.words["gravity"] = (size * lean / numpy.linalg.norm(lean)).tolist()
    d.g = float(numpy.linalg.norm(d.case.gravity))


@of_balls
@feature
def materials(d):
    count = d.pick({1: 5, 2: 3, 3: 1})
    d.materials = ["m", "other", "third"][:count]
    d.words["materials"] = {name: {"density": d.density * d.between(0.7, 1)} for name in d.materials}
    d.wall_materials = d.materials if d.chance(0.7) else d.materials[-1:]


@of_balls
@feature
def shapes(d):
    """Balls, meshes of a dozen to a hundred triangles, or both."""
    kind = "balls" if d.alone else d.pick({"balls": 4, "meshes": 4, "both": 3})
    d.words["shapes"] = {}
    names = []
    if kind != "meshes":
        for i in range(d.pick({1: 3, 2: 1})):
            name = f"ball{i}"
            d.words["shapes"][name] = {"sphere": {"radius": d.radius * d.between(0.5, 1)}}
            names.append(name)
    if kind != "balls":
        for i in range(d.pick({1: 3, 2: 1})):
            name = d.random.choice(sorted(solids.SOLIDS)) + str(i)
            d.case.meshes[name] = solids.SOLIDS[name[:-1]](d.random, d.radius * d.between(0.6, 1))
            d.words["shapes"][name] = {"file": "@" + name}
            names.append(name)
    d.shapes, d.meshed = names, kind != "balls"


@feature
def thin_and_dented_shapes(d):
    """One of the meshes is thin, with margins about half its thickness, so that it is moved inwards only partly; or has dents that others lie in. From
    numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"thin shapes {d.words['title']}")
    meshed = [name for name in d.shapes if not name.startswith("ball")]
    kind = d.pick({"thin": 2, "dented": 1.5, "none": 6.5}) if meshed else "none"
    if kind != "none":
        old, makers = d.random.choice(meshed), solids.THIN if kind == "thin" else solids.DENTED
        maker = d.random.choice(sorted(makers))
        del d.case.meshes[old]
        name = maker + old[-1]
        mesh = d.case.meshes[name] = makers[maker](d.random, d.radius * d.between(0.6, 1))
        d.words["shapes"] = {name if key == old else key: {"file": "@" + name} if key == old else shape for key, shape in d.words["shapes"].items()}
        d.shapes[d.shapes.index(old)] = name
        if kind == "thin" and d.chance(0.85):
            d.margin = min(0.5 * solids.thickness_of(mesh) * d.between(0.4, 1.3), 0.1 * d.radius)
    d.random = others


@of_balls
@feature
def how_many(d):
    d.settles = d.g > 0 and d.chance(0.5 if d.alone else 0.1)   # meant to come to rest
    most = (12 if d.alone else 4) if d.settles else 12 if d.meshed else 30
    d.count = d.pick({1: 1, 2: 3, d.random.randint(3, 8): 4, d.random.randint(4, most): 12 if d.alone else 4})
    d.gap = 2.2 * d.margin
    d.cell = 2 * d.radius + d.gap + d.radius * d.log_between(0.005, 0.6)
    base = max(1, round((d.count / d.between(1, 3)) ** (1 / 2.5)))
    d.cells = [base, max(1, base - d.random.randint(0, 1)), 0]
    d.cells[2] = math.ceil(d.count / (d.cells[0] * d.cells[1]))
    d.size = numpy.array(d.cells) * d.cell


# ---- walls: each container sets d.room and d.closed

CONTAINERS = {}
PLAIN_CONTAINERS = {}   # of balls alone: planes, boxes and cylinders


def container(weight, plain=0):
    """plain: weight among those of balls alone"""
    def keep(function):
        CONTAINERS[function] = weight
        if plain:
            PLAIN_CONTAINERS[function] = plain
        return function
    return keep


def some_axes(d, axes, probability):
    """That become periodic."""
    return [axis for axis in axes if d.chance(probability)]


@of_balls
@feature
def walls(d):
    half = d.size / 2
    d.room = numpy.array([[-half[0], -half[1], d.gap], [half[0], half[1], d.gap + d.size[2]]])
    d.periodic, d.closed = [], False
    d.pick(PLAIN_CONTAINERS if d.alone else CONTAINERS)(d)
    for i, wall in enumerate(d.case.walls):
        if d.chance(0.3):
            wall["name"] = d.random.choice(["wall", "Wand", "left & right", "w"]) + str(i)


@container(3, plain=1)
def open_space(d):
    axes = some_axes(d, "xyz", 0.35)
    make_periodic(d, axes)


@container(4, plain=2)
def one_plane(d):
    axes = some_axes(d, "xy", 0.25)
    make_periodic(d, axes)
    lean = numpy.array([0 if "x" in axes else d.between(-0.3, 0.3), 0 if "y" in axes else d.between(-0.3, 0.3), 1.0])
    if d.chance(0.5):
        lean = numpy.array([0, 0, 1.0])
    lean /= numpy.linalg.norm(lean)
    # below the lowest corner of the room
    low = min(float(lean @ [x, y, d.room[0][2]]) for x in d.room[:, 0] for y in d.room[:, 1])
    d.wall({"plane": {"point": (lean * (low - d.gap)).tolist(), "normal": lean.tolist()}})


@container(2, plain=3)
def several_planes(d):
    d.wall({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}})
    for axis in range(2):
        for side in range(2):
            if d.chance(0.7):
                point, normal = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
                point[axis], normal[axis] = float(d.room[side][axis] + (2 * side - 1) * d.gap), 1.0 - 2 * side
                d.wall({"plane": {"point": point, "normal": normal}})


@container(4, plain=4)
def box_inside(d):
    axes = some_axes(d, "xyz", 0.2)
    make_periodic(d, axes)
    low, high = d.room[0] - d.gap, d.room[1] + d.gap
    for k, axis in enumerate("xyz"):
        if axis in axes:   # faces across a periodic axis are left out; they stand at the seam or beyond
            low[k], high[k] = d.words["domain"]["min"][k], d.words["domain"]["max"][k]
    d.wall({"box_inside": [low.tolist(), high.tolist()]})
    d.closed = True


@container(3, plain=4)
def cylinder_inside(d):
    k = d.random.randrange(3)
    across = [j for j in range(3) if j != k]
    middle = d.room.mean(axis=0)
    radius = float(numpy.linalg.norm((d.room[1] - d.room[0])[across]) / 2 + d.gap)
    start, end = middle.copy(), middle.copy()
    start[k], end[k] = d.room[0][k] - d.gap, d.room[1][k] + d.gap
    if some_axes(d, "xyz"[k], 0.3):
        make_periodic(d, ["xyz"[k]], {j: radius + d.radius for j in across})
        start[k], end[k] = d.words["domain"]["min"][k], d.words["domain"]["max"][k]
    d.wall({"cylinder_inside": {"start": start.tolist(), "end": end.tolist(), "radius": radius}})
    d.axis, d.closed = (k, middle), True


@container(2)
def sphere_inside(d):
    middle = d.room.mean(axis=0)
    d.wall({"sphere_inside": {"centre": middle.tolist(), "radius": float(numpy.linalg.norm(d.room[1] - middle) + d.gap)}})
    d.closed = True


@container(2)
def plate(d):
    a, b = numpy.array([1.0, d.between(-0.3, 0.3), 0]), numpy.array([d.between(-0.3, 0.3), 1.0, 0])
    reach = 2.5 * float(d.size[:2].max())
    d.wall({"plate": {"corner": (-(a + b) * reach / 2).tolist(), "side_a": (a * reach).tolist(), "side_b": (b * reach).tolist()}})


@container(2)
def disc(d):
    reach = float(numpy.linalg.norm(d.size[:2])) * d.between(0.8, 1.2)
    shape = {"centre": [0, 0, 0], "normal": [0, 0, 1], "radius": reach, "segments": d.random.choice([5, 8, 16])}
    if d.chance(0.3):
        shape["hole"] = reach * d.between(0.1, 0.4)
        d.wall({"plane": {"point": [0, 0, -3 * d.radius], "normal": [0, 0, 1]}})
    d.wall({"disc": shape})


@container(3)
def box(d):
    low, high = d.room[0] - d.gap, d.room[1] + d.gap
    shape = {"corners": [low.tolist(), high.tolist()]}
    if d.chance(0.6):
        shape["open"] = sorted({"+z", *(side for side in ("-x", "+y") if d.chance(0.15))})
    d.wall({"box": shape})
    d.closed = "open" not in shape


@container(2)
def tube(d):
    radius = float(numpy.linalg.norm(d.size[:2]) / 2 + d.gap) / math.cos(math.pi / 8)
    shape = {"start": [0, 0, 0], "end": [0, 0, float(d.room[1][2] + d.gap)], "radius": radius, "segments": d.random.choice([8, 12, 16])}
    openings = d.pick({(): 1, ("end",): 3, ("start", "end"): 1})
    if openings:
        shape["open"] = list(openings)
    if "start" in openings:
        d.wall({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}})
    d.wall({"cylinder": shape})
    d.axis, d.closed = (2, numpy.zeros(3)), not openings


@container(2)
def cone(d):
    bottom = float(numpy.linalg.norm(d.size[:2]) / 2 + 2 * d.gap) / math.cos(math.pi / 8)
    top = bottom * d.between(1.05, 1.6)
    shape = {"start": [0, 0, 0], "end": [0, 0, float(d.room[1][2] + d.gap)], "radius_start": bottom, "radius_end": top, "open": ["end"],
             "segments": d.random.choice([8, 12])}
    d.wall({"cone": shape})


@container(2)
def hopper(d):
    width = float(numpy.linalg.norm(d.size[:2]) + 2 * d.gap) / math.cos(math.pi / 8)
    outlet = min(0.7 * width, d.between(1.2, 2.5) * d.radius)
    shape = {"outlet": outlet, "bin": width, "bin_height": float(d.size[2] + 2 * d.gap), "segments": d.random.choice([8, 12])}
    if d.chance(0.3):
        shape |= {"outlet": [outlet, outlet], "bin": [width, width]}
        del shape["segments"]
    if d.chance(0.6):
        shape["half_angle"] = math.radians(d.between(30, 70))
        height = 0.5 * (width - outlet) / math.tan(shape["half_angle"])
    else:
        height = shape["funnel_height"] = 0.5 * (width - outlet) * d.between(0, 1.5)
    if d.chance(0.3):
        shape["stub"] = d.radius * d.between(0.2, 1)
    d.wall({"hopper": shape}, name="hopper")
    d.room = d.room + [0, 0, height]
    if d.chance(0.7):
        low = -shape.get("stub", 0) - 2.5 * d.margin
        d.wall({"plate": {"corner": [-width / 2, -width / 2, low], "side_a": [width, 0, 0], "side_b": [0, width, 0]}}, name="gate")


@container(2)
def drum(d):
    lifters = {"count": d.random.randint(2, 6), "height": d.radius * d.between(0.2, 0.6), "width": d.radius * d.between(0.2, 0.5)}
    if d.chance(0.4):
        lifters["top_width"] = lifters["width"] * d.between(0.5, 1)
    middle = d.room.mean(axis=0)
    radius = float(numpy.linalg.norm(d.size[[0, 2]]) / 2 + d.gap + lifters["height"]) / math.cos(math.pi / 12)
    start, end = middle.copy(), middle.copy()
    start[1], end[1] = d.room[0][1] - d.gap, d.room[1][1] + d.gap
    shape = {"start": start.tolist(), "end": end.tolist(), "radius": radius, "segments": d.random.choice([12, 24])}
    if d.chance(0.8):
        shape["lifters"] = lifters
    if d.chance(0.2):
        shape["open"] = d.random.sample(["start", "end"], d.random.randint(1, 2))
    d.wall({"drum": shape})
    d.axis, d.closed = (1, middle), "open" not in shape


@container(2)
def trough_with_machine(d):
    """A trough with a screw or paddles in it, below the bodies; either may be missing."""
    rim = d.radius * d.between(1.5, 3)
    radius = max(rim + 2.5 * d.margin, float(d.size[1]) / 2 + d.gap) / math.cos(math.pi / 8)
    low, high = float(d.room[0][0]) - 2 * d.gap, float(d.room[1][0]) + 2 * d.gap
    d.room = d.room + [0, 0, rim]
    machine = d.pick({"screw": 3, "paddles": 2, "none": 1})
    inset = 0.1 * (high - low)
    shaft = {"start": [low + inset, 0, 0], "end": [high - inset, 0, 0], "radius": rim, "shaft": rim * d.between(0.2, 0.6), "segments": d.random.choice([6, 8, 12])}
    trough = {"start": [low, 0, 0], "end": [high, 0, 0], "radius": radius, "height": float(d.room[1][2]) + d.gap, "segments": d.random.choice([8, 12, 16])}
    if d.chance(0.15):
        trough["open"] = d.random.sample(["start", "end"], d.random.randint(1, 2))
    d.wall({"trough": trough})
    length = high - low - 2 * inset
    if machine == "screw":
        starts = d.random.randint(1, 2)
        pitch = length / d.between(0.5, 2)
        d.wall({"screw": shaft | {"pitch": pitch * d.random.choice([1, -1]), "thickness": pitch / starts * d.between(0.1, 0.4)} | ({"starts": starts} if starts > 1 else {})})
    if machine == "paddles":
        d.wall({"paddles": shaft | {"count": d.random.randint(1, 4), "width": rim * d.between(0.2, 0.8), "thickness": rim * d.between(0.1, 0.3),
                                    "angle": d.between(-1, 1), "turn": d.between(0, math.pi)}})


@container(3)
def surface_from_file(d):
    name = d.random.choice(sorted(solids.SURFACES))
    half = float(d.size[:2].max()) * d.between(0.8, 1.2) + 2 * d.gap
    d.case.meshes[name] = solids.SURFACES[name](d.random, half)
    d.wall({"file": "@" + name})
    if d.chance(0.3):
        d.case.walls[-1]["scale"] = d.between(1.0, 1.3)
    if name != "tray" and d.chance(0.3):
        # far enough beyond the seam
        room = d.room
        make_periodic(d, [axis for axis in "xy" if d.chance(0.6)])
        if d.periodic and max(abs(v) for v in d.words["domain"]["min"][:2]) + 2 * d.radius > half:
            d.words.pop("domain")
            d.periodic, d.room = [], room


@container(2, plain=1)
def row_of_fixed_bodies(d):
    """A floor of bodies that never move, over a plane that catches what falls between them."""
    d.fixed_row = True
    d.wall({"plane": {"point": [0, 0, -4.5 * d.radius], "normal": [0, 0, 1]}})


@container(1)
def two_things(d):
    """A mesh inside a formula: contacts with both at once."""
    box_inside(d)
    low = float(d.room[0][2]) - 0.9 * d.gap
    if not d.periodic and d.chance(0.8):
        x, y = d.room[:, 0] * 0.9, d.room[:, 1] * 0.9
        d.wall({"plate": {"corner": [x[0], y[0], low + 0.1 * d.gap], "side_a": [x[1] - x[0], 0, 0], "side_b": [0, y[1] - y[0], 0]}})
        d.room[0][2] += 1.5 * d.gap
        d.room[1][2] += 1.5 * d.gap
        inside = d.case.walls[0]["shape"]["box_inside"]
        inside[1][2] += 2 * d.gap


# ---- walls with concave edges and corners, and room for bodies that lie in them

def raise_room(d, height, length=0.0):
    """What lies in valleys is below the room, and may lie further out along x."""
    d.laid_in = d.room + [[0, 0, -d.gap], [0, 0, 0]]
    d.laid_in[:, 0] = min(d.laid_in[0][0], -length), max(d.laid_in[1][0], length)
    d.room = d.room + [0, 0, height]


@container(3)
def box_with_bodies_at_its_edges(d):
    """A box of a mesh: bodies lie along its lower edges and in its corners."""
    least = 4.6 * d.radius if d.chance(0.5) else 7.5 * d.radius
    d.size[:2] = numpy.maximum(d.size[:2], least)
    half = d.size / 2
    d.room[:, 0], d.room[:, 1] = (-half[0], half[0]), (-half[1], half[1])
    raise_room(d, 2.3 * d.radius)
    low, high = numpy.array([*(d.room[0][:2] - d.gap), 0]), d.room[1] + d.gap
    shape = {"corners": [low.tolist(), high.tolist()]}
    if d.chance(0.8):
        shape["open"] = ["+z"]
    d.wall({"box": shape})
    d.closed = "open" not in shape
    inwards = ([1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0])
    for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
        corner = [(low, high)[x][0], (low, high)[y][1], 0]
        d.valleys.append((corner, [numpy.multiply(n, s) for n, s in zip(inwards, (1 - 2 * x, 1 - 2 * y, 1))]))
    if least > 7 * d.radius:
        for side in (-1, 1):
            d.valleys.append(([0, side * high[1], 0], [numpy.multiply(inwards[1], -side), inwards[2]]))
            d.valleys.append(([side * high[0], 0, 0], [numpy.multiply(inwards[0], -side), inwards[2]]))


@container(3)
def grooves(d):
    """V-shaped walls of a mesh, from narrow to nearly flat, with bodies in them; some are closed by triangles at their ends."""
    angle = d.pick({math.pi / 4: 1, d.between(0.2, 1.0): 2, d.between(1.0, 1.55): 2})
    width = d.radius * (1.3 / math.tan(angle) + d.between(1.2, 3))
    length = max(float(d.size[0]) / 2, 2.5 * d.radius) * d.between(1, 1.5) + d.radius / math.sin(angle)
    ends = d.chance(0.4)
    name = "grooves"
    d.case.meshes[name] = solids.grooves(angle, width, length, d.pick({1: 3, 3: 1}), d.pick({1: 3, 2: 1, 3: 1}), ends)
    raise_room(d, max(width * math.cos(angle), d.radius / math.sin(angle) + d.radius) + 0.1 * d.radius, length)
    d.wall({"file": "@" + name})
    normals = [numpy.array([0, math.cos(angle), math.sin(angle)]), numpy.array([0, -math.cos(angle), math.sin(angle)])]
    places = int(length / (1.1 * d.radius))
    d.valleys = [([x, 0, 0], normals) for x in (2.2 * d.radius * (i - 0.5 * (places - 1)) for i in range(places)) if abs(x) + 1.1 * d.radius < length]
    d.random.shuffle(d.valleys)
    if ends:
        d.valleys = [([side * length, 0, 0], [*normals, numpy.array([-side, 0, 0])]) for side in (-1, 1)] + [
            v for v in d.valleys if abs(v[0][0]) + 3.3 * d.radius < length]


@container(2)
def tube_around_a_row(d):
    """A tube that lies, of few to many faces, not much wider than what lies in it; the other bodies fall on it from outside."""
    sides = d.random.choice([5, 6, 8, 12, 24, 64])
    inside = d.radius * d.pick({d.between(1.05, 1.3): 1, d.between(1.3, 3): 1})
    outside = inside / math.cos(math.pi / sides)
    length = max(float(d.size[0]) / 2, 2.5 * d.radius) * d.between(1, 1.3)
    raise_room(d, 2 * outside + d.gap, length)
    shape = {"start": [-length, 0, outside], "end": [length, 0, outside], "radius": outside, "segments": sides}
    openings = d.pick({(): 1, ("end",): 1, ("start", "end"): 1})
    if openings:
        shape["open"] = list(openings)
    d.wall({"cylinder": shape})
    turn = math.pi / sides * d.between(-1, 1)
    down = numpy.array([0, math.sin(turn), -math.cos(turn)])
    places = max(1, int(length / (1.1 * d.radius)) - 1)
    d.valleys = [((inside * down + [2.2 * d.radius * (i - 0.5 * (places - 1)), 0, outside]), [-down]) for i in range(places)]


@container(2)
def floor_with_a_pit(d):
    """A pyramid pressed into a floor, shallow or deep."""
    corners = d.random.choice([3, 4, 6, 12])
    inner = d.between(0.15, 1.45)   # angle of its faces to the floor
    depth = d.radius * d.between(0.1, 1.2)
    inside = depth / math.tan(inner)
    half = 2 * (float(d.size[:2].max()) + inside + 2 * d.radius)
    d.case.meshes["pit"] = solids.pitted_floor(corners, inside / math.cos(math.pi / corners), depth, half)
    raise_room(d, 2.2 * d.radius)
    d.wall({"file": "@pit"})
    if inside > 0.6 * d.radius * math.sin(inner):   # what is larger lies on the rim
        turns = [2 * math.pi * (k + 1) / corners for k in range(corners)]
        d.valleys = [([0, 0, -depth], [numpy.array([-math.sin(inner) * math.cos(t), -math.sin(inner) * math.sin(t), math.cos(inner)]) for t in turns])]


def make_periodic(d, axes, reach=None):
    """A domain around the room, periodic along the axes."""
    if not axes:
        return
    low, high = d.room[0].copy(), d.room[1].copy()
    for k, axis in enumerate("xyz"):
        if axis in axes:
            lack = max(0.0, 4.2 * (d.radius + d.margin) - (high[k] - low[k])) / 2
            low[k], high[k] = low[k] - lack, high[k] + lack
        else:
            more = max(20 * d.radius, 2 * d.size[k], (reach or {}).get(k, 0))
            low[k], high[k] = low[k] - more, high[k] + more
    d.words["domain"] = {"min": low.tolist(), "max": high.tolist(), "periodic": list(axes)}
    d.periodic = list(axes)


@of_balls
@feature
def domain(d):
    if d.periodic:
        if d.chance(0.5):
            d.words["domain"]["outside"] = d.random.choice(["stop", "remove", "keep"])
        return
    if d.chance(0.25):
        outside = d.pick({"remove": 3, "keep": 1, "stop": 1})
        room = d.radius * (d.log_between(0.2, 5) if outside != "stop" else 50)
        low, high = all_places(d)
        d.words["domain"] = {"min": (low - room - d.gap).tolist(), "max": (high + room + d.gap).tolist(), "outside": outside}


def all_places(d):
    """The corners of all that bodies are placed in."""
    return d.room if d.laid_in is None else numpy.array([numpy.minimum(d.room[0], d.laid_in[0]), numpy.maximum(d.room[1], d.laid_in[1])])


# ---- bodies

@of_balls
@feature
def bodies(d):
    """In the cells of a grid, or drawn by the decomposer."""
    if getattr(d, "fixed_row", False):
        add_fixed_row(d)
    if d.chance(0.3) and not getattr(d, "fixed_row", False):
        populations(d)
        return
    cells = [(i, j, k) for k in range(d.cells[2]) for j in range(d.cells[1]) for i in range(d.cells[0])][:d.count]
    heading = d.chance(0.6)
    middle = d.room.mean(axis=0)
    for cell in cells:
        shape = d.random.choice(d.shapes)
        free = 0.5 * (d.cell - 2 * d.radius - d.gap)
        at = d.room[0] + (numpy.array(cell) + 0.5) * d.cell + [d.between(-free, free) for _ in range(3)]
        body = {"shape": shape, "material": d.random.choice(d.materials), "position": at.tolist()}
        if d.chance(0.8) and not shape.startswith("ball") or d.chance(0.2):
            body["orientation"] = d.quaternion()
        if d.chance(0.8):
            way = middle - at
            way = way / numpy.linalg.norm(way) if heading and numpy.linalg.norm(way) > 0.1 * d.radius else d.direction()
            body["velocity"] = (d.speed * (d.log_between(2, 20) if d.chance(0.02) else d.between(0.2, 1)) * way).tolist()
        if d.chance(0.5):
            body["angular_velocity"] = (0.5 * d.speed / d.radius * d.between(0, 1) * d.direction()).tolist()
        if d.chance(0.2):
            body["scale"] = d.log_between(0.03, 0.5) if d.chance(0.1) else d.between(0.5, 1)
        if d.chance(0.05):
            body["lock_rotation"] = True
        d.case.bodies.append(body)
    if len(d.case.bodies) > 2 and d.chance(0.1):
        body = d.random.choice(d.case.bodies)
        for key in ("velocity", "angular_velocity"):
            body.pop(key, None)
        body["fixed"] = True


def add_fixed_row(d):
    pitch = 2.2 * d.radius
    for i in range(-2, 3):
        d.case.bodies.append({"shape": d.random.choice(d.shapes), "material": d.random.choice(d.materials),
                              "position": [i * pitch, 0.0, -d.radius - 0.1 * d.gap], "fixed": True})


def populations(d):
    kinds = {"random": 6, "lattice": 3, "settle": 1.0 if d.g > 0 and d.closed and not d.periodic else 0, "compact": 0.7 if d.closed else 0}
    method = d.method = d.pick(kinds)
    d.count = min(d.count, 12) if method in ("settle", "compact") else max(1, d.count // 2)
    room = d.room.copy()
    split = d.count > 3 and method in ("random", "lattice") and d.chance(0.25)
    layers = [room] if not split else [numpy.array([room[0], [*room[1][:2], room[:, 2].mean() - 0.1 * d.gap]]),
                                       numpy.array([[*room[0][:2], room[:, 2].mean() + 0.1 * d.gap], room[1]])]
    d.words["populations"] = []
    for layer in layers:
        population = {"material": d.random.choice(d.materials)}
        fewest = max(1, d.count // len(layers) // 2)
        # at least one of each shape, also where one has a quarter
        names = d.random.sample(d.shapes, d.random.randint(1, len(d.shapes) if fewest > 4 * len(d.shapes) else 1))
        if len(names) == 1 and d.chance(0.7):
            population["shape"] = names[0]
        else:
            population["shapes"] = {name: d.random.randint(1, 3) for name in names}
            if d.chance(0.4):
                population["shares_by"] = d.random.choice(["mass", "mass", "number"])
        population |= region_of(d, layer, method)
        population |= sizes_of(d, names)
        share = 1 if "box" in population["region"] else 2
        population |= amount_of(d, layer, names, population, max(1, d.count // len(layers) // share))
        if method != "random" or d.chance(0.3):
            population["method"] = method
        if method == "lattice" and d.chance(0.6):
            population["jitter"] = d.between(0, 1)
        population |= orientation_of(d)
        if d.chance(0.5):
            population["velocity"] = (0.5 * d.speed * d.direction()).tolist()
        if d.chance(0.3):
            population["angular_velocity"] = (0.3 * d.speed / d.radius * d.direction()).tolist()
        d.words["populations"].append(population)


def region_of(d, room, method):
    middle, half = room.mean(axis=0), (room[1] - room[0]) / 2
    kind = d.pick({"box": 5, "cylinder": 2, "sphere": 2, "inside": 1, "inside_wall": 2})
    if kind == "inside_wall" and len(d.case.walls) == 1 and not d.periodic and d.closed and next(iter(d.case.walls[0]["shape"])) not in ("file", "plane"):
        d.case.walls[0]["name"] = "container"
        return {"region": {"inside_wall": "container"}}
    if kind == "cylinder":
        k = d.random.randrange(3)
        start, end = middle.copy(), middle.copy()
        start[k], end[k] = room[0][k], room[1][k]
        radius = float(min(half[j] for j in range(3) if j != k))
        return {"region": {"cylinder": {"start": start.tolist(), "end": end.tolist(), "radius": radius}}}
    if kind == "sphere":
        return {"region": {"sphere": {"centre": middle.tolist(), "radius": float(min(half))}}}
    if kind == "inside":
        name = f"region{len(d.case.meshes)}"
        lower, upper = room
        d.case.meshes[name] = solids.clean_mesh(solids.library.box(tuple(upper - lower), 1, tuple(middle)))
        return {"region": {"inside": "@" + name}}
    return {"region": {"box": room.tolist()}}


def equivalent_diameters(d, names):
    found = []
    for name in names:
        shape = d.words["shapes"][name]
        if "sphere" in shape:
            found.append(2 * shape["sphere"]["radius"])
        else:
            mesh = d.case.meshes[name]
            found.append((6 * solids.library.mass_properties((mesh.vertices, mesh.triangles))[0] / math.pi) ** (1 / 3))
    return found


def sizes_of(d, names):
    if d.chance(0.3):
        return {}
    top = min(equivalent_diameters(d, names))
    low = top * d.between(0.4, 0.9)
    middle, width = (top + low) / 2, (top - low) / 2
    kind = d.random.choice(["length", "fixed", "uniform", "normal", "lognormal", "weibull", "power", "sieve"])
    if kind == "length":
        return {"size": top}
    if kind == "fixed":
        return {"size": {"distribution": "fixed", "diameter": top}}
    if kind == "sieve":
        return {"size": {"distribution": "sieve", "diameter": [low, middle, top], "passing": [0, d.between(0.2, 0.8), 1]}}
    size = {"distribution": kind, "min": low, "max": top}
    size |= {"uniform": {}, "normal": {"mean": middle, "sigma": width * d.between(0.3, 1)},
             "lognormal": {"median": middle, "sigma": d.between(0.05, 0.5)}, "weibull": {"scale": middle, "shape": d.between(1, 6)},
             "power": {"exponent": d.between(0, 4)}}[kind]
    if d.chance(0.4):
        size["by"] = d.random.choice(["mass", "mass", "number"])
    return {"size": size}


def amount_of(d, room, names, population, count):
    """A number, or what so many bodies weigh or fill."""
    diameter = min(equivalent_diameters(d, names))
    volume = count * math.pi / 6 * diameter**3
    kind = d.pick({"count": 5, "mass": 2, "solid_fraction": 2, "fill": 4 if d.method == "settle" else 0})
    if kind == "mass":
        return {"mass": volume * d.words["materials"][population["material"]]["density"]}
    if kind == "solid_fraction" and "box" in population["region"]:
        return {"solid_fraction": min(0.2, volume / float(numpy.prod(room[1] - room[0])))}
    if kind == "fill":
        return {"fill": True}
    return {"count": count}


def orientation_of(d):
    kind = d.pick({"none": 4, "random": 1, "given": 1, "aligned": 2})
    if kind == "none":
        return {}
    if kind == "random":
        return {"orientation": "random"}
    if kind == "given":
        return {"orientation": d.quaternion()}
    aligned = {"align": d.direction().tolist()}
    if d.chance(0.6):
        aligned["axis"] = d.random.choice(["longest", "shortest", d.direction().tolist()])
    if d.chance(0.5):
        aligned["scatter"] = d.between(0, 0.5)
    return {"orientation": aligned}


# ---- what moves

@of_balls
@feature
def motions(d):
    """Some walls move, slowly enough for what they carry; times in shares of the duration, set by `duration`."""
    for wall in d.case.walls:
        if not d.chance(0.3):
            continue
        kind, shape = next(iter(wall["shape"].items()))
        speed = d.speed * d.between(0.05, 0.5)
        motion = d.pick({"rotate": 3, "translate": 2, "oscillate": 3, "table": 1})
        if d.periodic and motion == "rotate" or kind == "box_inside" and motion == "rotate" and d.chance(0.8):
            motion = "oscillate"
        way = d.direction()
        for k, axis in enumerate("xyz"):
            if axis in d.periodic:
                way[k] = 0
        if not numpy.linalg.norm(way) > 0.1:
            continue
        way = way / numpy.linalg.norm(way)
        if motion == "rotate":
            k, centre = getattr(d, "axis", (2, d.room.mean(axis=0)))
            axis = numpy.eye(3)[k] if d.chance(0.6) else d.direction()
            if d.chance(0.4):
                centre = centre + d.radius * d.direction() * d.log_between(0.1, 10)
            lever = float(numpy.linalg.norm(numpy.abs(d.room - centre).max(axis=0)) + d.radius)
            wall["motion"] = {"rotate": {"axis": axis.tolist(), "centre": numpy.asarray(centre).tolist(), "rate": speed / lever}}
        elif motion == "translate":
            wall["motion"] = {"translate": {"velocity": (speed * way).tolist()}}
        elif motion == "oscillate":
            amplitude = d.radius * d.log_between(0.01, 0.5)
            wall["motion"] = {"oscillate": {"direction": way.tolist(), "amplitude": amplitude, "frequency": speed / (2 * math.pi * amplitude)}}
            if d.chance(0.5):
                wall["motion"]["oscillate"]["phase"] = d.between(0, 6)
        else:
            rise = [d.between(-0.3, 0.3) if d.chance(0.3) else 0, *(d.between(-1, 1) for _ in range(d.random.randint(1, 3)))]
            wall["motion"] = {"table": {"time": [float(i) for i in range(len(rise))], "position": [(r * way).tolist() for r in rise]}, "speed": speed}
        if d.chance(0.3):
            wall["motion"]["start"] = d.between(-0.2 if d.chance(0.3) else 0, 0.5)
        if d.chance(0.3):
            wall["motion"]["stop"] = d.between(0.55, 1.2)
        d.extra_speed = max(d.extra_speed, speed)


@of_balls
@feature
def second_motions(d):
    """Some walls that move do so in two ways, which come in either order. From numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"second motions {d.words['title']}")
    for wall in d.case.walls:
        if "motion" not in wall or not d.chance(0.3):
            continue
        first, speed = wall["motion"], d.speed * d.between(0.02, 0.2)
        way = d.direction()
        for k, axis in enumerate("xyz"):
            if axis in d.periodic:
                way[k] = 0
        if not numpy.linalg.norm(way) > 0.1:
            continue
        if "oscillate" in first or d.chance(0.5) and "translate" not in first:
            second = {"translate": {"velocity": (speed * way).tolist()}, "stop": d.between(0.1, 0.6)}
        else:
            amplitude = d.radius * d.log_between(0.01, 0.5)
            second = {"oscillate": {"direction": way.tolist(), "amplitude": amplitude, "frequency": speed / (2 * math.pi * amplitude)}}
        wall["motion"] = [first, second] if d.chance(0.5) else [second, first]
        d.extra_speed += speed
    d.random = others


@feature
def drives(d):
    """Some walls that stand still otherwise answer to force. From numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"drives {d.words['title']}")
    density = max(material["density"] for material in d.words["materials"].values())
    mass = density * (2 * d.radius) ** 3
    force = mass * (d.g + d.speed**2 / d.radius) * d.log_between(0.3, 10)
    for wall in d.case.walls:
        if "motion" in wall or not d.chance(0.15):
            continue
        speed, kind = d.speed * d.between(0.05, 0.5), next(iter(wall["shape"]))
        way, centre = d.direction(), d.room.mean(axis=0) + d.radius * d.direction()
        for k, axis in enumerate("xyz"):
            if axis in d.periodic:
                way[k] = 0
        if not numpy.linalg.norm(way) > 0.1:
            continue
        lever = float(numpy.linalg.norm(numpy.abs(d.room - centre).max(axis=0)) + d.radius)
        turns = not d.periodic and kind not in ("plane", "box_inside") and d.chance(0.4)
        motion = d.pick({"servo": 3, "outer": 1, "free": 3, **({"motor": 2} if turns else {})})
        heavy = mass * d.log_between(1, 100)
        if motion == "servo" and turns:
            table = {"axis": way.tolist(), "centre": centre.tolist(), "torque": force * lever, "max_rate": speed / lever}
            if d.chance(0.5):
                table["swing"] = [-d.between(0, 0.3), d.between(0.01, 0.5)]
        elif motion == "outer":   # nobody drives it here: it stands still
            table = {"axis": way.tolist(), "centre": centre.tolist(), "max_rate": speed / lever} if turns else {"direction": way.tolist(), "max_speed": speed}
            if turns and d.chance(0.5):
                table["swing"] = [-d.between(0, 0.3), d.between(0.01, 0.5)]
        elif motion == "servo" and d.chance(0.5):
            area = d.radius**2 * d.log_between(1, 100)
            table = {"direction": way.tolist(), "stress": force / area, "area": area, "max_speed": speed}
        elif motion == "servo":
            table = {"direction": way.tolist(), "force": force, "max_speed": speed}
        elif motion == "motor":
            table = {"axis": d.direction().tolist(), "centre": centre.tolist(), "torque": force * lever, "inertia": 3 * heavy * lever**2,
                     "max_rate": speed / lever}
        elif turns:
            table = {"hinge": way.tolist(), "centre": centre.tolist(), "inertia": 3 * heavy * lever**2, "torque": force * lever}
            if d.chance(0.6):
                table |= {"mass": heavy, "mass_centre": (centre + 0.5 * lever * d.direction()).tolist()}
            if d.chance(0.5):
                table["swing"] = [-d.between(0.01, 0.3), d.between(0, 0.5)]
            if d.chance(0.5):
                table["turn_damping"] = table["inertia"] * d.speed / d.radius * d.log_between(0.01, 1)
        else:
            table = {"guide": way.tolist(), "mass": 3 * heavy, "force": d.random.choice([-1, 1]) * force}
            if d.chance(0.5):
                table["damping"] = table["mass"] * d.speed / d.radius * d.log_between(0.01, 1)
        if motion == "servo" and d.chance(0.3):
            table["share"] = d.between(0.1, 1)
        if not turns and motion != "motor" and d.chance(0.6):
            table["stroke"] = [-d.radius * d.between(0, 0.5), d.radius * d.between(0.05, 1)]
        wall["motion"] = {motion: table}
        if d.chance(0.3):
            wall["motion"]["start"] = d.between(-0.2 if d.chance(0.3) else 0, 0.5)
        if d.chance(0.3):
            wall["motion"]["stop"] = d.between(0.55, 1.2)
        d.extra_speed = max(d.extra_speed, speed)
    d.random = others


@feature
def surfaces(d):
    """Some walls are belts or turntables; times in shares of the duration. From numbers of its own, so that other words stay what their seed made them."""
    others, d.random = d.random, random_numbers.Random(f"surfaces {d.words['title']}")
    for wall in d.case.walls:
        if not d.chance(0.15):
            continue
        speed = d.speed * d.between(0.05, 0.8)
        if d.chance(0.65):
            surface = {"velocity": (speed * d.direction()).tolist()}
        else:
            axis, centre = d.direction(), d.room.mean(axis=0) + d.radius * d.direction()
            if len(d.periodic) > 1:
                continue
            if d.periodic:
                axis = numpy.eye(3)["xyz".index(next(iter(d.periodic)))]
            lever = float(numpy.linalg.norm(numpy.abs(d.room - centre).max(axis=0)) + d.radius)
            surface = {"rate": speed / lever, "axis": axis.tolist(), "centre": centre.tolist()}
        if d.chance(0.3):
            surface["start"] = d.between(-0.2 if d.chance(0.3) else 0, 0.5)
        if d.chance(0.3):
            surface["stop"] = d.between(0.55, 1.2)
        wall["surface"] = surface
        d.extra_speed = max(d.extra_speed, speed)
    d.random = others


# ---- how contacts are computed

@of_balls
@feature
def contact(d):
    law = d.pick({"linear": 5, "hunt-crossley": 2, "hertz-mindlin": 3})
    gather = "potential" if d.alone else d.pick({"potential": 8, "area": 1.2, "pairs": 0.8})
    if gather == "area" and law == "hertz-mindlin":
        law = "linear"
    d.law, d.gather = law, gather
    table = {}
    if law != "linear" or d.chance(0.2):
        table["law"] = law
    if gather != "potential" or d.chance(0.1):
        table["gather"] = gather
    if gather == "potential" and d.chance(0.2):
        table["weights"] = d.pick({"unit": 2, "density": 1})
    only_balls = not d.meshed and not any(is_mesh_wall(wall) for wall in d.case.walls)
    given = d.chance(0.6) or gather == "area"
    if only_balls and gather != "area" and d.chance(0.3):
        table["margin"] = 0.0
    elif given:
        table["margin"] = d.margin
    surface = d.pick({None: 5, "outside": 3, "drawn": 2})
    used = {body["shape"] for body in d.case.bodies}.union(*([p["shape"]] if "shape" in p else p["shapes"] for p in d.case.populations))
    if gather == "area" and all(name.startswith("ball") for name in used):
        surface = "outside"   # balls have a layer with this only
    if surface is not None:
        table["surface"] = surface
    if surface != "outside" and "margin" in table and d.meshed and gather != "area" and d.chance(0.3):
        table["margin_ratio"] = table.pop("margin") / d.radius
    if d.chance(0.2):
        table["impact_speed"] = fastest(d) * d.between(0.9, 1.5)
    d.barrier = 0.0
    if gather == "potential" and table.get("margin", 0) > 0 and (d.meshed or surface == "outside") and not d.alone and d.chance(0.1):
        d.barrier = table["barrier"] = d.log_between(0.05, 3)
    if table:
        d.words["contact"] = table


@feature
def margins_by_size(d):
    """Bodies of scales that differ widely, each with a margin of its size; thin ones with the margin that they were given. From numbers of its own,
    as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"margins by size {d.words['title']}")
    table = d.words.setdefault("contact", {})
    thin = [name for name in d.shapes if name[:-1] in solids.THIN]
    if d.meshed and d.gather != "area" and not d.barrier and d.chance(0.8 if thin else 0.15):
        if table.get("surface") == "outside":
            del table["surface"]
        for key in ("margin", "margin_ratio"):
            table.pop(key, None)
        if thin and d.chance(0.3):
            table["margin"] = d.margin
        else:
            radius = 0.5 * min(equivalent_diameters(d, thin)) if thin else d.radius
            table["margin_ratio"] = d.margin / radius
            d.by_size = True
            for body in d.case.bodies:
                if not body.get("fixed") and d.chance(0.6):
                    body["scale"] = d.log_between(0.2, 1)
    if not table:
        del d.words["contact"]
    d.random = others


@feature
def laid_in_valleys(d):
    """The first bodies lie in the concave edges and corners of the walls, a dented one with another in its dent. From numbers of its own, as surfaces."""
    own = random_numbers.Random(f"laid {d.words['title']}")
    kept, d.random = d.random, own
    gap = 2 * d.margin if d.words.get("contact", {}).get("surface") == "outside" else 0.0
    valleys = list(d.valleys)
    for body in d.case.bodies[:own.randint(1, 4)] if valleys else []:
        if not valleys or body.get("fixed"):
            break
        point, normals = valleys.pop(0 if d.chance(0.7) else own.randrange(len(valleys)))
        if not body["shape"].startswith("ball") and d.chance(0.6):
            body["orientation"] = [1.0, 0.0, 0.0, 0.0]   # faces flush with those of boxes
        lay(d, body, numpy.array(point, float), normals, gap)
        d.laid += 1
    dented = [body for body in d.case.bodies[d.laid:] if body["shape"][:-1] in solids.DENTED]
    movers = [body for body in d.case.bodies[d.laid:] if not body.get("fixed")]
    if dented and len(movers) > 1 and d.chance(0.8):
        host = dented[0]
        guest = own.choice([body for body in movers if body is not host])
        point, normals = solids.valley_of(host["shape"][:-1], d.case.meshes[host["shape"]])
        q, scale = host.get("orientation", [1, 0, 0, 0]), host.get("scale", 1.0)
        before = copy.deepcopy(guest)
        guest["scale"] = guest.get("scale", 1.0) * d.between(0.3, 1)
        lay(d, guest, numpy.array(host["position"]) + scale * turned(q, point[None])[0], list(turned(q, numpy.array(normals))), gap)
        for key in ("velocity", "angular_velocity"):   # together
            guest.pop(key, None)
            if key in host and key == "velocity":
                guest[key] = host[key]
        if (numpy.array(guest["position"]) < d.room[0]).any() or (numpy.array(guest["position"]) > d.room[1]).any():
            guest.clear()   # in a wall
            guest.update(before)
        else:
            host.pop("angular_velocity", None)
    d.random = kept


def lay(d, body, point, normals, gap):
    """Puts a body where it touches the faces through a point: all of up to three, or the first that it meets on its way down into a pit."""
    q, scale = body.get("orientation", [1, 0, 0, 0]), body.get("scale", 1.0)
    if body["shape"].startswith("ball"):
        reach = [d.words["shapes"][body["shape"]]["sphere"]["radius"] * scale] * len(normals)
    else:
        corners = turned(q, scale * d.case.meshes[body["shape"]].vertices)
        reach = [float((-corners @ n).max()) for n in normals]
    away = scale * d.margin * d.pick({0.0: 2, d.between(0, 0.5): 1, d.between(-0.3, 0): 0.5})
    if body["shape"].startswith("ball"):
        away = max(away, -0.015 * reach[0])   # more is refused
    n, reach = numpy.array(normals, float), numpy.array(reach) + gap + away
    if len(normals) <= 3:
        way = numpy.linalg.lstsq(n, reach, rcond=None)[0]
    else:
        up = n.sum(axis=0) / numpy.linalg.norm(n.sum(axis=0))
        way = max(reach / (n @ up)) * up
    body["position"] = (point + way).tolist()
    if d.chance(0.5):
        body.pop("velocity", None)
        body.pop("angular_velocity", None)
    elif "velocity" in body:
        body["velocity"] = (0.3 * numpy.array(body["velocity"])).tolist()


@of_balls
@feature
def pressed_starts(d):
    """Some bodies begin within the margins of each other, or overlap where the case parts them."""
    bodies = d.words.get("bodies", [])
    table = d.words.setdefault("contact", {})
    relax = d.pick({None: 12, True: 1.5, False: 1, "shallow": 1})
    if relax is not None:
        table["relax"] = relax
    movers = [body for body in bodies[d.laid:] if not body.get("fixed")]
    if len(movers) > 1 and d.chance(0.6 if relax is not None else 0.1):
        a, b = d.random.sample(movers, 2)
        gap = d.margin * d.between(0.1, 1.9) if relax is not True else d.radius * d.between(-0.3, 0.1)
        if relax is not True and table.get("surface") != "outside":
            gap -= 2 * d.margin   # pressed where touch begins at the surfaces
        if d.by_size:
            gap *= min(body.get("scale", 1) for body in (a, b))
        if relax is not True and table.get("surface") != "outside" and a["shape"].startswith("ball") and b["shape"].startswith("ball"):
            # balls have no margins then, and may be pressed by 2 % of a radius
            gap = 0.02 * min(d.words["shapes"][body["shape"]]["sphere"]["radius"] * body.get("scale", 1) for body in (a, b)) * d.between(-0.9, 1)
        # as near as balls about both would be
        reach = sum(d.radius * body.get("scale", 1) if not body["shape"].startswith("ball")
                    else d.words["shapes"][body["shape"]]["sphere"]["radius"] * body.get("scale", 1) for body in (a, b))
        b["position"] = (numpy.array(a["position"]) + (reach + gap) * d.direction()).tolist()
    if not table:
        del d.words["contact"]


def motions_of(wall):
    """Of a wall of a case: none, one or several."""
    motion = wall.get("motion", [])
    return motion if isinstance(motion, list) else [motion]


def is_mesh_wall(wall):
    return next(iter(wall["shape"])) not in ("plane", "box_inside", "cylinder_inside", "sphere_inside")


def fastest(d):
    """Of the impacts to expect."""
    height = float(d.room[1][2] - min(0.0, d.room[0][2])) + 2 * d.radius
    return 1.3 * d.speed + 0.8 * math.sqrt(2 * d.g * height) + d.extra_speed


@of_balls
@feature
def pairs(d):
    """Every pair of materials; stiff enough for the fastest impact of the heaviest body."""
    heaviest = d.density * 4 / 3 * math.pi * d.radius**3
    speed = 0.6 * fastest(d)   # few bodies meet the worst; what does ends with a message, which must be the same everywhere
    d.words["pairs"] = []
    names = sorted(d.words["materials"])
    share = d.between(0.3, 0.7)
    depth = 2 * d.margin * share if d.words.get("contact", {}).get("margin", 1) > 0 else 0.02 * d.radius
    if d.words.get("contact", {}).get("surface") != "outside":
        depth *= 0.5   # mesh walls and balls have no margin of their own
    friction = d.pick({"none": 2, "some": 5})
    for i, a in enumerate(names):
        for b in names[i:]:
            pair = {"between": [a, b] if d.chance(0.5) else [b, a]}
            stiffer = d.between(1, 2)
            if d.gather == "area":
                # of a ball: pi kappa R D^2 with kappa the modulus over both margins
                pair["layer_modulus"] = stiffer * 1.5 * heaviest * speed**2 / (math.pi * 0.5 * d.radius * depth**3) * 2 * d.margin
            elif d.law != "hertz-mindlin":
                pair["stiffness"] = stiffer * heaviest * (speed / depth) ** 2
            pair["restitution"] = d.between(0.05, 0.3) if d.settles else d.pick({1.0: 2, d.between(0.05, 1): 8, d.log_between(1e-5, 0.05): 0.7, 0.0: 0.3})
            if d.law == "hunt-crossley" and (pair["restitution"] < 1 or d.chance(0.3)):
                pair["restitution_speed"] = d.speed * d.between(0.5, 2)
            if friction == "some" and d.chance(0.9):
                friction_of(d, pair)
            d.words["pairs"].append(pair)
    if d.law == "hertz-mindlin":
        modulus = 0.75 * 1.25 * heaviest * speed**2 / (depth**2.5 * math.sqrt(0.4 * d.radius))
        for material in d.words["materials"].values():
            material["poisson"] = d.between(0, 0.45)
            material["young"] = 2 * modulus * d.between(1, 2)
    d.stiffness = heaviest * (speed / depth) ** 2
    d.heaviest = heaviest


def friction_of(d, pair):
    pair["friction"] = d.between(0.05, 1)
    if d.chance(0.2):
        pair["friction_sliding"] = pair["friction"] * d.between(0.5, 1)
    if d.chance(0.2):
        pair["tangential_ratio"] = d.between(0.1, 1)
    if d.chance(0.2):
        pair["tangential_damping"] = d.between(0, 2)
    if d.chance(0.3):
        pair["rolling_friction"] = d.log_between(0.01, 0.5)
        if d.chance(0.5):
            pair["rolling_model"] = d.random.choice(["elastic-plastic", "constant"])
    if d.chance(0.2):
        pair["torsional_friction"] = d.log_between(0.01, 0.5)
    if d.chance(0.1):
        pair["contact_radius"] = d.radius * d.between(0.2, 1)


@of_balls
def contacts_alike(d):
    """Of balls alone: pairs of materials that differ in what they keep, springs of friction and of rolling, are left to single steps; most scenes have none."""
    if d.chance(0.1):
        return
    rubs = [pair for pair in d.words["pairs"] if "friction" in pair]
    rolls = bool(rubs) and d.chance(0.4)
    for pair in d.words["pairs"]:
        if rubs and pair not in rubs:
            friction_of(d, pair)
        if not rubs:
            pair["restitution"] = min(pair["restitution"], d.between(0.5, 0.95))
            if d.law == "hunt-crossley":
                pair.setdefault("restitution_speed", d.speed)
        for key in ("rolling_friction", "rolling_model", "torsional_friction"):
            pair.pop(key, None)
        if rolls:
            pair["rolling_friction"] = d.log_between(0.01, 0.5)
            if d.chance(0.5):
                pair["torsional_friction"] = d.log_between(0.01, 0.5)


@feature
def contacts_in_valleys(d):
    """What lies in edges and dents: elastic without losses, or damped, with friction that is less while it slides. From numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"contacts in valleys {d.words['title']}")
    if d.valleys or any(name[:-1] in solids.DENTED for name in d.shapes):
        kind = d.pick({"elastic": 3, "sliding": 4, "drawn": 3})
        for pair in d.words["pairs"] if kind != "drawn" else []:
            if kind == "elastic":
                pair["restitution"] = 1.0
                for key in ("friction", "friction_sliding", "tangential_ratio", "tangential_damping", "rolling_friction", "rolling_model", "torsional_friction"):
                    pair.pop(key, None)
            else:
                pair["restitution"] = min(pair["restitution"], d.between(0.1, 0.8))
                if d.law == "hunt-crossley":
                    pair.setdefault("restitution_speed", d.speed)
                pair["friction"] = d.between(0.2, 1)
                pair["friction_sliding"] = pair["friction"] * d.between(0.2, 0.95)
    d.random = others


@feature
def cells_of_large_things(d):
    for wall in d.case.walls:
        if is_mesh_wall(wall) and d.chance(0.1):
            wall["cell_size"] = d.radius * d.between(0.5, 3)
    for shape in d.words["shapes"].values():
        if "file" in shape and d.chance(0.05):
            shape["cell_size"] = d.radius * d.between(0.3, 2)


@feature
def load_maps(d):
    """From numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"load maps {d.words['title']}")
    for wall in d.case.walls:
        if is_mesh_wall(wall) and d.chance(0.4):
            wall["load_map"] = True
        if is_mesh_wall(wall) and "file" not in wall["shape"] and d.chance(0.15):
            wall["triangle_size"] = d.radius * d.between(1, 4)
    d.random = others


@feature
def fluid(d):
    if not d.chance(0.12):
        return
    density = d.density * d.log_between(0.001, 0.8)
    fluid_of = {"density": density, "viscosity": density * d.speed * d.radius * d.log_between(0.01, 3)}
    if d.chance(0.3):
        fluid_of["velocity"] = (0.3 * d.speed * d.direction()).tolist()
    if d.chance(0.5):
        fluid_of["drag"] = d.random.choice(["stokes", "haider-levenspiel"])
    d.words["fluid"] = fluid_of


@of_balls
@feature
def methods(d):
    if d.chance(0.3):
        d.words["motion"] = {"integrator": d.pick({"kdk-dlm": 1, "midpoint": 1, "spiral": 1, "rig": 1, "euler": 0 if d.alone else 1})}


# ---- time and output

@of_balls
@feature
def duration(d):
    """As long as it takes to go some radii, at most some ten thousand steps as far as stiffness tells: on several ranks that share cores a step
    of two balls takes as long as one of a hundred."""
    per_contact = d.pick({30: 6, 20: 1, 12: 1, 8: 0.5, 50: 1, 100: 0.3})
    slower = (8 if d.meshed else 3) * math.sqrt(1 + 24 * d.barrier) * (3 if d.gather != "potential" else 1)
    step = math.pi * math.sqrt(d.heaviest / d.stiffness) / per_contact / slower
    step *= min([1.0, *(body.get("scale", 1.0) for body in d.words.get("bodies", []) if not body.get("fixed"))]) ** 1.5
    d.duration = min(d.radius / d.speed * d.log_between(3, 25), step * d.log_between(2000, 10000) * 20 / (d.count + 12))
    d.step_guess = step
    time = {"duration": d.duration}
    if per_contact != 30:
        time["steps_per_contact"] = per_contact
    if d.chance(0.1):
        time.pop("steps_per_contact", None)
        time["step"] = step * d.between(0.5, 1)
    if not d.alone and d.chance(0.15):
        time["step_control"] = d.pick({"quantised": 4, "fixed": 1})
    if d.settles:
        d.duration = time["duration"] = min(8 * d.duration, 30000 * step)
    if d.settles and d.chance(0.8) or d.g > 0 and d.chance(0.05):
        time["stop_at_rest"] = True
    if d.words.get("domain", {}).get("outside") == "remove" and d.chance(0.15):
        time["stop_when_empty"] = True
    d.words["time"] = time
    for wall in d.case.walls:
        motions = motions_of(wall)
        for motion in motions:
            if "table" not in motion:
                continue
            times = motion["table"]["time"]
            lap = d.duration / len(times) * d.between(0.5, 1.5)
            most = max(numpy.linalg.norm(numpy.diff(numpy.array(motion["table"]["position"]), axis=0), axis=1).max(), 0.1)
            way = motion.pop("speed") * lap / most
            motion["table"]["time"] = [lap * t for t in times]
            motion["table"]["position"] = [[way * x for x in p] for p in motion["table"]["position"]]
        for moves in (*motions, wall.get("surface", {})):
            for key in ("start", "stop"):
                if key in moves:
                    moves[key] *= d.duration


@feature
def wear(d):
    """From numbers of its own, as surfaces."""
    others, d.random = d.random, random_numbers.Random(f"wear {d.words['title']}")
    for wall in d.case.walls:
        if is_mesh_wall(wall) and d.chance(0.15):
            # a fall of a body rubs off a thousandth of its volume at most: by less than a tenth of the margin at a time, mostly
            density = max(material["density"] for material in d.words["materials"].values())
            wall["wear"] = {"coefficient": 1e-3 * d.log_between(0.01, 1) / (density * max(d.speed**2, d.g * d.radius)),
                            "every": d.duration * d.log_between(0.01, 0.5)}
    d.random = others


@of_balls
@feature
def output(d):
    table = {"every": d.duration / (40 if d.settles else d.random.randint(5, 12))}
    if d.chance(0.15):
        table["contacts"] = d.random.choice([True, False])
    if d.chance(0.2):
        table["checkpoint"] = d.duration / d.random.randint(2, 5)
    d.words["output"] = table


@feature
def impacts(d):
    """From numbers of its own: what other features draw stays."""
    if random_numbers.Random(f"impacts {d.words['title']}").random() < 0.3:
        d.words["output"]["impacts"] = True


@feature
def inlets_and_outlets(d):
    """Bodies that come in somewhere in the room, and places where they leave. Draws of its own: what other features draw stays."""
    own = random_numbers.Random(f"openings {d.case.note}")
    if own.random() >= 0.25 or d.words["time"].get("stop_at_rest") or d.words["time"].get("stop_when_empty"):
        return
    kept, d.random = d.random, own
    names = [f"feed{i}" for i in range(d.pick({0: 1, 1: 4, 2: 1}))]
    if names:
        d.words["inlets"] = [inlet_of(d, name) for name in names]
    outlets = []
    for i in range(d.pick({0: 1, 1: 3, 2: 1}) if names else 1):
        # below everything, or anywhere when bodies come in again
        again = bool(names) and d.chance(0.5)
        low, high = d.room[0].copy(), d.room[1].copy()
        if not again:
            low, high = low - 30 * d.radius, high + 30 * d.radius
            high[2] = all_places(d)[0][2] - 0.6 * d.gap
        outlet = {} if d.chance(0.3) else {"name": d.random.choice(["end", "left, right", "o"]) + str(i)}
        outlet |= region_of(d, numpy.array([low, high]), "random") if again else {"region": {"box": [low.tolist(), high.tolist()]}}
        outlets.append(outlet | ({"to": d.random.choice(names)} if again else {}))
    if outlets:
        d.words["outlets"] = outlets
    d.random = kept


def inlet_of(d, name):
    inlet = {"name": name, "material": d.random.choice(d.materials)}
    shapes = d.random.sample(d.shapes, d.random.randint(1, len(d.shapes)))
    if len(shapes) == 1 and d.chance(0.7):
        inlet["shape"] = shapes[0]
    else:
        inlet["shapes"] = {shape: d.random.randint(1, 3) for shape in shapes}
        if d.chance(0.4):
            inlet["shares_by"] = d.random.choice(["mass", "number"])
    inlet |= region_of(d, d.room, "random") | sizes_of(d, shapes) | orientation_of(d)
    if d.chance(0.7):
        inlet["velocity"] = (0.5 * d.speed * d.direction()).tolist()
    if d.chance(0.3):
        inlet["angular_velocity"] = (0.3 * d.speed / d.radius * d.direction()).tolist()
    number = d.between(1, 10) / d.duration
    mass = number * math.pi / 6 * (0.8 * min(equivalent_diameters(d, shapes))) ** 3 * d.words["materials"][inlet["material"]]["density"]
    key, rate = ("rate", mass) if d.chance(0.5) else ("number_rate", number)
    inlet[key] = rate
    if d.chance(0.3):
        inlet[key] = {"time": [d.duration * d.between(0, 0.2), d.duration * d.between(0.3, 0.6), d.duration], "rate": [0, rate, rate * d.between(0, 2)]}
    if d.chance(0.3):
        inlet["start"] = d.duration * d.between(-0.1, 0.4)
    if d.chance(0.3):
        inlet["stop"] = d.duration * d.between(0.5, 1.1)
    if d.chance(0.2):
        inlet["limit"] = mass * d.duration * d.between(0.3, 1)
    if d.chance(0.2):
        inlet["count"] = d.random.randint(1, 5)
    if d.chance(0.2):
        inlet["when_full"] = d.random.choice(["wait", "stop"])
    return inlet


@feature
def inlets_beside_bodies(d):
    """An inlet that reaches around a body that is there already. Draws of its own: what other features draw stays."""
    own = random_numbers.Random(f"inlets beside {d.case.note}")
    time = d.words["time"]
    if own.random() >= (0.6 if d.words.get("inlets") else 0.08) or not d.case.bodies or time.get("stop_at_rest") or time.get("stop_when_empty"):
        return
    kept, d.random = d.random, own
    inlets = d.words.setdefault("inlets", [])
    if not inlets or d.chance(0.3):
        inlets.append(inlet_of(d, f"beside{len(inlets)}"))
    beside = own.choice(d.case.bodies)
    half = d.radius * d.between(1.1, 2.5)
    middle = numpy.array(beside["position"]) + d.direction() * d.radius * d.between(0, 1.5)
    inlets[-1]["region"] = {"sphere": {"centre": middle.tolist(), "radius": half}} if d.chance(0.3) else \
        {"box": [(middle - half).tolist(), (middle + half).tolist()]}
    for outlet in d.words.get("outlets", []):
        outlet.setdefault("to", own.choice(inlets)["name"])   # else it might take bodies out as they come in, which is refused
    d.random = kept


@of_balls
def balls_leave(d):
    """Balls alone that pass a side of the room leave, in some scenes: these are reviewed every few steps."""
    time = d.words["time"]
    if d.chance(0.85) or time.get("stop_at_rest") or time.get("stop_when_empty"):
        return
    low, high = d.room[0] - 30 * d.radius, d.room[1] + 30 * d.radius
    k = d.random.randrange(3)
    low[k] = d.room[0][k] + d.between(0.5, 1) * (d.room[1][k] - d.room[0][k])
    d.words["outlets"] = [{"region": {"box": [low.tolist(), high.tolist()]}}]


@of_balls
@feature
def anywhere(d):
    """The whole scene turned and moved: nothing may depend on axes, but boxes stay along them."""
    if d.case.populations or d.words.get("inlets") or d.words.get("outlets"):
        return
    bound = "domain" in d.words or any("box_inside" in wall["shape"] for wall in d.case.walls)
    turn, shift = numpy.eye(3), numpy.zeros(3)
    if d.chance(0.4):
        q = d.quaternion()
        turn = d.random.choice(right_angle_turns()) if bound else rotation(q)
    if d.chance(0.3):
        shift = d.direction() * d.radius * (d.log_between(1, 1e3) if d.chance(0.8) else d.log_between(1e3, 1e6))
    if (turn == numpy.eye(3)).all() and not shift.any():
        return
    d.case = placed(d.case, Placement(turn, shift))
    d.words = d.case.words


def thickness(d):
    """Of the thinnest shape at scale 1: twice volume over area of a mesh, diameter of a ball."""
    thinnest = 2 * d.radius
    for name, shape in d.words["shapes"].items():
        if "sphere" in shape:
            thinnest = min(thinnest, 2 * shape["sphere"]["radius"])
        elif name in d.case.meshes:
            thinnest = min(thinnest, solids.thickness_of(d.case.meshes[name]))
    return thinnest


@feature
def attraction(d):
    """Some pairs attract each other: at most a third of what the fastest impact presses with, over a part of its overlap. After all else, so
    that the rest of a case does not depend on it."""
    if d.gather != "potential" or "cell_size" in d.case.text() or not d.words["pairs"] or not d.chance(0.25):
        return
    attract(d)


def attract(d):
    depth = math.sqrt(d.heaviest / d.stiffness) * 0.6 * fastest(d)
    widest = 0.5 * thickness(d) - 3 * d.margin   # bodies may be smaller, and a derived margin wider
    if widest < 0.2 * depth:
        return
    for pair in d.words["pairs"]:
        if not d.chance(0.7):
            continue
        # of the pair's own stiffness; a Hertz contact of the same impact presses no deeper than 3/2 of this at the same force
        force = d.log_between(0.003, 0.15) * pair.get("stiffness", 0.3 * d.stiffness) * depth
        if d.chance(0.5):
            pair["adhesion_model"] = d.random.choice(["jkr", "dmt"])
            factor = (1.5 if pair["adhesion_model"] == "jkr" else 2) * math.pi
            pair["adhesion"] = force / (factor * pair.get("contact_radius", d.radius))
        else:
            pair["pull_off"] = force
        reach = min(widest, depth * d.between(0.3, 1))
        if d.law != "hertz-mindlin" and ("pull_off" in pair or "contact_radius" in pair) and d.chance(0.4):
            pair["separation_energy"] = 0.5 * force * reach + force**2 / (2 * pair["stiffness"])
        else:
            pair["adhesion_range"] = reach


@feature
def cohesion(d):
    """What attracts has liquid bridges, necks of JKR or a traction by area in some cases. Draws of its own: what other features draw stays."""
    own = random_numbers.Random(f"cohesion {d.case.note}")
    if "cell_size" in d.case.text() or not d.words["pairs"]:
        return
    depth = math.sqrt(d.heaviest / d.stiffness) * 0.6 * fastest(d)
    widest = 0.5 * thickness(d) - 3 * d.margin
    if widest < 0.2 * depth:
        return
    sticks = [pair for pair in d.words["pairs"] if "pull_off" in pair or "adhesion" in pair]
    barrier = "barrier" in d.words.get("contact", {})
    kept, d.random = d.random, own
    reach = min(widest, depth * d.between(0.3, 1))
    only_balls = all("sphere" in shape for shape in d.words["shapes"].values())
    if d.gather == "area" and d.chance(0.25):
        for pair in d.words["pairs"]:
            if d.chance(0.7) and d.margin > 0:
                # a traction of at most a seventh of what the layer bears
                pair["adhesion"] = 0.5 * reach * pair["layer_modulus"] * d.log_between(0.001, 0.15)
                pair["adhesion_range"] = reach
    elif d.gather == "potential" and not barrier and d.law == "hertz-mindlin" and only_balls and (sticks or d.chance(0.3)) and d.chance(0.7):
        for pair in sticks or d.words["pairs"]:
            for key in ("pull_off", "adhesion_range", "separation_energy"):
                pair.pop(key, None)
            force = d.log_between(0.003, 0.15) * 0.3 * d.stiffness * depth
            pair.setdefault("adhesion", force / (1.5 * math.pi * pair.get("contact_radius", d.radius)))
            pair |= {"adhesion_model": "jkr", "adhesion_hysteresis": True}
    elif sticks and d.chance(0.4):
        for pair in sticks:
            force = d.log_between(0.003, 0.15) * pair.get("stiffness", 0.3 * d.stiffness) * depth
            for key in ("pull_off", "adhesion", "adhesion_model", "adhesion_range", "separation_energy"):
                pair.pop(key, None)
            pair["surface_tension"] = force / (4 * math.pi * pair.get("contact_radius", d.radius))
            pair["bridge_volume"] = (reach / 1.7) ** 3   # with its angle and R it reaches no further
            if d.chance(0.5):
                pair["contact_angle"] = d.between(0, 1)
            if d.chance(0.5):
                pair["bridge_rupture"] = d.random.choice(["willett", "lian"])
    d.random = kept


@feature
def attracted_bodies_leave(d):
    """What attracts is taken out beside what it sticks to, by an outlet about one of the bodies, or with half of the bodies. Draws of its own: what other
    features draw stays."""
    own = random_numbers.Random(f"attracted and gone {d.case.note}")
    time, pairs = d.words["time"], d.words["pairs"]
    leave = "outlets" in d.words or d.words.get("domain", {}).get("outside") == "remove"
    sticks = any(word in pair for pair in pairs for word in ("pull_off", "adhesion", "surface_tension"))
    if not (leave or sticks) or own.random() >= 0.5 or time.get("stop_at_rest") or time.get("stop_when_empty"):
        return
    kept, d.random = d.random, own
    if not sticks and d.gather == "potential" and pairs and "cell_size" not in d.case.text():
        attract(d)
    movers = [body for body in d.case.bodies if not body.get("fixed")]
    if movers and not leave and any(word in pair for pair in pairs for word in ("pull_off", "adhesion", "surface_tension")):
        at = numpy.array(own.choice(movers)["position"])
        if d.chance(0.5):
            region = {"sphere": {"centre": at.tolist(), "radius": d.radius * d.between(0.2, 1)}}
        else:
            low, high = at - 30 * d.radius, at + 30 * d.radius
            k = own.randrange(3)
            (low if d.chance(0.5) else high)[k] = at[k]   # those whose centre is on one side of it
            region = {"box": [low.tolist(), high.tolist()]}
        d.words["outlets"] = [{"region": region}]
    d.random = kept


@feature
def plastic_contacts(d):
    """What neither attracts nor has cells or a barrier yields in some cases. Draws of its own: what other features draw stays."""
    own = random_numbers.Random(f"plastic contacts {d.case.note}")
    table, pairs = d.words.get("contact", {}), d.words["pairs"]
    if own.random() >= 0.2 or d.gather != "potential" or "barrier" in table or table.get("on_overlap") == "continue" or "cell_size" in d.case.text():
        return
    if "step" in d.words["time"] or any(word in pair for pair in pairs for word in ("pull_off", "adhesion", "surface_tension")):
        return   # a step that is given was chosen for contacts that do not stiffen
    for pair in pairs:
        if own.random() < 0.8:
            pair["plasticity"] = own.uniform(0.05, 0.9)
            if own.random() < 0.6:
                pair["adhesive_ratio"] = own.uniform(0.01, 0.5)


def rotation(q):
    w, x, y, z = q
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def draw_strength(d, bond, stress, depth):
    """What bonds may have beside their stiffness; of strengths about a stress, and of its work over a depth."""
    if d.chance(0.5):
        bond["tangential_ratio"] = d.between(0.2, 1)
    if d.chance(0.7):
        bond["tension"] = stress * d.log_between(0.01, 1)
        if d.chance(0.7):
            bond["cohesion"] = stress * d.log_between(0.01, 1)
            if d.chance(0.7):
                bond["friction_angle"] = d.between(0, 1)
    if d.chance(0.3):
        bond["fracture_energy"] = stress * depth * d.log_between(1e-3, 1)
    if d.chance(0.3) and ("tension" in bond or "fracture_energy" in bond):
        bond["strength_scatter"] = {"weibull_modulus": d.between(1, 10)}
    if d.chance(0.5):
        bond["damping"] = d.between(0, 0.3)


@feature
def bonds(d):
    """One of the bodies in two halves, face to face, that hold together until they do not."""
    whole = [b for b in d.case.bodies[d.laid:] if not b.get("fixed") and not b.get("lock_rotation")]
    if not whole or not d.words.get("contact", {}).get("margin") or not d.chance(0.12):
        return
    body = d.random.choice(whole)
    length, half = (float(numpy.float32(share * d.radius)) for share in (0.5, 0.35))
    d.case.meshes["half"] = solids.clean_mesh(solids.library.box((length, 2 * half, 2 * half)))
    d.words["shapes"]["half"] = {"file": "@half"}
    body.pop("scale", None)
    body["shape"] = "half"
    along = turned(numpy.array(body.setdefault("orientation", d.quaternion())), numpy.array([[0.5 * length + d.margin, 0, 0]]))[0]
    other = copy.deepcopy(body)
    centre = numpy.array(body["position"])
    body["position"], other["position"] = (centre - along).tolist(), (centre + along).tolist()
    if "angular_velocity" in body:
        spin = numpy.cross(body["angular_velocity"], along)
        velocity = numpy.array(body.get("velocity", [0, 0, 0]))
        body["velocity"], other["velocity"] = (velocity - spin).tolist(), (velocity + spin).tolist()
    d.case.bodies.append(other)
    area, height = 4 * half**2, length + 2 * d.margin
    stress = d.stiffness * d.margin / area
    bond = {"between": [body["material"]] * 2, "distance": 3 * d.margin, "young": d.stiffness * d.between(0.5, 2) * height / area}
    draw_strength(d, bond, stress, d.margin)
    d.words["bonds"] = [bond]


@feature
def pieces(d):
    """One of the bodies starts as pieces of a cut mesh. From numbers of its own, as surfaces."""
    own = random_numbers.Random(f"pieces {d.case.note}")
    contact = d.words.get("contact", {})
    # pieces ask for surface = "outside", which is their default, and must be wider than their margins
    fits = contact.get("margin") and contact["margin"] < 0.05 * d.radius and contact.get("surface") != "drawn"
    whole = [b for b in d.case.bodies[d.laid:] if not b.get("fixed") and not b.get("lock_rotation") and b["shape"] != "half"]
    if not fits or not whole or own.random() >= 0.35:
        return
    kept, d.random = d.random, own
    body = own.choice(whole)
    d.case.meshes["cut"] = solids.SOLIDS[own.choice(["angle", "brick", "cube", "octahedron", "prism", "rock"])](own, 0.9 * d.radius)
    cut = {"cells": own.randint(2, 4)}
    if d.chance(0.7):
        cut["seed"] = own.randint(1, 1000)
    if d.chance(0.5):
        cut["evenly"] = d.chance(0.5)
    d.words["shapes"]["cut"] = {"file": "@cut", "pieces": cut}
    body["shape"] = "cut"
    body.pop("scale", None)
    # of a face as wide as the body's radius
    stress = d.stiffness * contact["margin"] / d.radius**2
    bond = {"within": body["material"], "young": d.stiffness * d.between(0.3, 1) / d.radius}
    draw_strength(d, bond, stress, contact["margin"])
    if d.chance(0.9):   # without, its pieces are loose from the start
        d.words["bonds"] = d.words.get("bonds", []) + [bond]
    d.random = kept


@of_balls
@feature
def stiffness_by_size(d):
    """From numbers of its own, as surfaces. About the same stiffness for two bodies of the scene's size."""
    others, d.random = d.random, random_numbers.Random(f"stiffness by size {d.words['title']}")
    for pair in d.words["pairs"]:
        attracts = any(word in pair for word in ("pull_off", "adhesion", "surface_tension"))
        if "stiffness" in pair and not attracts and not d.barrier and d.chance(0.2):
            pair["modulus"] = pair.pop("stiffness") / d.radius
    d.random = others


@feature
def on_overlap(d):
    """Whether runs go on beyond the room of a contact, where a wall moves. From numbers of its own, as surfaces."""
    own = random_numbers.Random(f"on overlap {d.case.note}")
    table = d.words.get("contact", {})
    if d.gather == "potential" and "barrier" not in table and any("motion" in wall for wall in d.case.walls) and own.random() < 0.4:
        d.words.setdefault("contact", {})["on_overlap"] = own.choices(["continue", "stop"], [3, 1])[0]


@feature
def sleep(d):
    """From numbers of its own, as surfaces. Mostly in cases that lose their motion, and last until bodies have slept for a while."""
    own = random_numbers.Random(f"sleep {d.case.note}")
    streams = any(d.words.get("fluid", {}).get("velocity", [0, 0, 0]))
    if own.random() >= (0.4 if d.valleys else 0.2) or d.words.get("bonds") or streams or d.words["output"].get("impacts"):
        return
    time = d.words["time"]
    time["sleep"] = own.random() < 0.95
    if not time["sleep"]:
        return
    if own.random() < 0.8:
        time["sleep_tolerance"] = 10 ** own.uniform(-4, -0.3)
    if d.g > 0 and own.random() < 0.8:
        for pair in d.words["pairs"]:
            pair["restitution"] = min(pair["restitution"], own.uniform(0.05, 0.4))
            if d.law == "hunt-crossley":
                pair.setdefault("restitution_speed", d.speed)
            pair["friction"] = max(pair.get("friction", 0), own.uniform(0.2, 0.8))
        fall = 2 * math.sqrt(d.radius / d.g)   # by a diameter: what is at rest sleeps after it
        time["duration"] = d.duration = max(d.duration, min(own.uniform(6, 12) * fall, 30000 * d.step_guess))
        d.words["output"]["every"] = max(d.words["output"]["every"], d.duration / 40)


@feature
def heat(d):
    """Temperatures, with walls of every kind. From numbers of its own, as surfaces. Conductivities are such that the step is stable: what
    all contacts of a body conduct is some 30 k R, if each is as wide as the body."""
    own = random_numbers.Random(f"heat {d.case.note}")
    if own.random() >= 0.2 or d.words.get("bonds"):
        return
    capacity = d.speed ** 2 * 10 ** own.uniform(-1, 2)
    conductivity = d.density * capacity * d.radius ** 2 / d.step_guess * 10 ** own.uniform(-6, -3)
    table = d.words["heat"] = {"friction_heat": own.random() < 0.5}
    by_body = own.random() < 0.5
    if not by_body:
        table["temperature"] = own.uniform(280, 320)
    for material in d.words["materials"].values():
        material["heat_capacity"] = capacity * own.uniform(0.5, 2)
        material["conductivity"] = conductivity * own.uniform(0.2, 1)
        if own.random() < 0.3:
            material["real_young"] = d.density * d.speed ** 2 * 10 ** own.uniform(4, 8)
    for pair in d.words["pairs"]:
        if own.random() < 0.3:
            pair["contact_conductance"] = conductivity / d.radius * 10 ** own.uniform(-1, 3)
    # one body warms by a degree in the run
    power = d.density * 4 * d.radius ** 3 * capacity / max(d.duration, d.step_guess)
    for tables in ("bodies", "populations", "inlets"):
        for entry in d.words.get(tables, []):
            if by_body or own.random() < 0.3:
                entry["temperature"] = own.uniform(250, 400)
            if tables != "inlets" and own.random() < 0.2:
                entry["heat_source"] = power * own.uniform(-0.1, 2)
    tables = random_numbers.Random(f"heat over time {d.case.note}")

    def over_time(column, value, draw):
        """A number, or a table whose rows may lie before, within and after the run."""
        if tables.random() >= 0.3:
            return value
        time = sorted(max(d.duration, d.step_guess) * tables.uniform(-0.3, 1.3) for _ in range(tables.randint(1, 4)))
        return {"time": time, column: [draw() for _ in time]}

    for entry in [e for table in ("bodies", "populations") for e in d.words.get(table, [])]:
        if "heat_source" in entry:
            entry["heat_source"] = over_time("power", entry["heat_source"], lambda: power * tables.uniform(-0.1, 2))
    for wall in d.case.walls:
        kind = own.choice(["none", "temperature", "heat_flux", "exchange"])
        if kind == "temperature":
            wall["temperature"] = over_time("temperature", own.uniform(250, 400), lambda: tables.uniform(250, 400))
        if kind == "heat_flux":
            wall["heat_flux"] = over_time("power", power * own.uniform(-0.1, 3), lambda: power * tables.uniform(-0.1, 3))
        if kind == "exchange":
            wall["exchange"] = {"coefficient": conductivity / d.radius * 10 ** own.uniform(-1, 3), "temperature": own.uniform(250, 400)}
            wall["exchange"]["temperature"] = over_time("temperature", wall["exchange"]["temperature"], lambda: tables.uniform(250, 400))
    gas_and_stillness(d, random_numbers.Random(f"gas {d.case.note}"), table)


def gas_and_stillness(d, own, table):
    """Gas in gaps; and, where nothing asks for motion, bodies that stay as they are. From numbers of its own."""
    if own.random() < 0.4:
        table["gas_conductivity"] = min(m["conductivity"] for m in d.words["materials"].values()) * 10 ** own.uniform(-3, -1.1)
        table["gas_range"] = d.radius * own.uniform(0.01, 1)
    time, output = d.words["time"], d.words["output"]
    asks = [wall for wall in d.case.walls if {"motion", "motions", "surface", "load_map", "wear"} & set(wall)]
    asks += [key for key in ("sleep", "stop_at_rest", "stop_when_empty") if time.get(key)] + [key for key in ("fluid", "inlets", "outlets") if d.words.get(key)]
    if own.random() < 0.7 and not asks and time.get("step_control", "fixed") == "fixed" and not output.get("impacts"):
        table["frozen"] = True
        table["friction_heat"] = False


def between_planes(d, rates, stresses):
    """The cell is periodic along x and y alone: smooth planes hold the bodies along z."""
    words, domain = d.words, d.words["domain"]
    domain["periodic"] = ["x", "y"]
    for part in ("z", "yz", "xz"):
        rates.pop(part, None)
        stresses.pop(part, None)
    bodies = sorted(words["materials"])
    smooth = {key: value for key, value in words["materials"][bodies[0]].items() if key in ("density", "young", "poisson")}
    words["materials"]["smooth plane"] = smooth
    for name in bodies:
        pair = next(copy.deepcopy(p) for p in words["pairs"] if p["between"] == [name, name])
        for key in [key for key in pair if "friction" in key or "rolling" in key or "torsional" in key]:
            pair.pop(key)
        words["pairs"].append({**pair, "between": [name, "smooth plane"], "friction": 0.0})
    words["walls"] = [{"name": name, "shape": {"plane": {"point": [0.0, 0.0, domain[side][2]], "normal": [0.0, 0.0, normal]}}, "material": "smooth plane"}
                      for name, side, normal in (("lower plane", "min", 1.0), ("upper plane", "max", -1.0))]


@feature
def cell(d):
    """The periodic cell deforms, in some scenes, which then have no walls. From numbers of its own, as surfaces. Each axis changes by a tenth at
    most, or is pressed by some thousandths of what its contacts can bear."""
    own = random_numbers.Random(f"cell {d.case.note}")
    words, time = d.words, d.words["time"]
    if own.random() < (0.7 if d.case.walls else 0.3) or any(words.get(key) for key in ("inlets", "outlets", "bonds", "fluid", "heat", "populations", "start")):
        return
    if any(body.get("fixed") or body.get("force") for body in words["bodies"]) or any("pieces" in shape for shape in words["shapes"].values()):
        return
    if time.get("step_control") == "quantised" or words.get("motion", {}).get("integrator") == "euler" or words["output"].get("impacts") or time.get("sleep"):
        return
    for key in ("stop_at_rest", "stop_when_empty"):
        time.pop(key, None)
    words["gravity"] = [0.0, 0.0, 0.0]
    surfaces = {wall["shape"]["file"][1:] for wall in d.case.walls if str(wall["shape"].get("file", "")).startswith("@")}
    for name in surfaces - {shape["file"][1:] for shape in words["shapes"].values() if "file" in shape}:
        d.case.meshes.pop(name, None)
    words.pop("walls", None)
    words.get("contact", {}).pop("on_overlap", None)
    places = numpy.array([body["position"] for body in words["bodies"]])
    room = d.radius * max([1.0, *(body.get("scale", 1.0) for body in words["bodies"])]) + d.margin
    low, high = places.min(axis=0) - 1.1 * room, places.max(axis=0) + 1.1 * room
    lack = numpy.maximum(0.0, 4.8 * room - (high - low)) / 2     # a tenth may go
    words["domain"] = {"min": (low - lack).tolist(), "max": (high + lack).tolist(), "periodic": ["x", "y", "z"]}
    table = words["cell"] = {}
    rates, stresses = {}, {}
    for axis in "xyz":
        kind = own.choice(["strain_rate", "strain_rate", "stress", "none"])
        if kind == "strain_rate":
            rates[axis] = own.uniform(-0.1, 0.1) / d.duration
        if kind == "stress":
            stresses[axis] = d.stiffness / d.radius * 10 ** own.uniform(-6, -3)
    shears = random_numbers.Random(f"shears {d.case.note}")     # of numbers of their own: other scenes stay as they are
    for part in ("yz", "xz", "xy"):
        kind = shears.choice(["strain_rate", "strain_rate", "stress", "stress", "none"])
        if kind == "strain_rate":
            rates[part] = shears.choice([0.2, 1.5]) * shears.uniform(-1, 1) / d.duration
        if kind == "stress":
            stresses[part] = shears.choice([-1, 1]) * d.stiffness / d.radius * 10 ** shears.uniform(-7, -4)
    if len(words["bodies"]) < 2:     # nothing withstands a stress
        stresses.clear()
    later = random_numbers.Random(f"rates over time {d.case.note}")
    for part, rate in rates.items():
        if later.random() < 0.5:     # to and fro
            rates[part] = {"time": [0.0, 0.4 * d.duration, later.uniform(0.5, 0.9) * d.duration], "rate": [rate, rate, -later.uniform(0, 1) * rate]}
    for part in [part for part in stresses if len(part) == 2]:
        if later.random() < 0.25:
            stresses[part] = 0.0
    layer = random_numbers.Random(f"layer {d.case.note}")
    if layer.random() < 0.25:
        between_planes(d, rates, stresses)
    if rates:
        table["strain_rate"] = rates
    if stresses:
        table["stress"] = stresses
    if own.random() < 0.4:
        table["stop_when"] = {"strain": own.uniform(0.01, 0.2)}
        if stresses and own.random() < 0.5 and any(stresses.values()):
            table["stop_when"]["stress_error"] = own.uniform(0.01, 0.5)
        if own.random() < 0.5:
            table["stop_when"]["kinetic_ratio"] = own.uniform(0.01, 10)
