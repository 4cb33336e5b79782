"""The scene of the comparison on the side of Python: shapes, the case for Scree, beds at rest and in motion.

A bed is settled once by scree-solver; every program then starts from the same positions, orientations and velocities.
A state is a list of rows [shape, x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz], SI, as in peer_scene.hpp.
"""
import json
import math
import os
import random
import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path

RADIUS = 0.01        # of the ball of equal volume [m]
DENSITY = 2600.0     # [kg/m^3]
GRAVITY = 9.81       # [m/s^2]
FRICTION = 0.5
RESTITUTION = 0.3
SHAPE_COUNT = 4
# 4 % of the diameter is the gap between touching bodies. The stiffness stops the last body of 11 g, which falls at
# 2 m/s, within 0.7 of both margins (k >= m / 2 (v / (0.7 * 4e-4))^2), and gives 21 of the steps below to a contact.
MARGIN = 0.02 * RADIUS
STIFFNESS = 3e5      # [N/m]
STEP = 2e-5          # of every penalty code [s]
YOUNG, POISSON = 1e7, 0.3  # of spheres [Pa]


@dataclass(frozen=True)
class Family:
    """A kind of shape with a number of triangles."""
    kind: str
    triangles: int

    @property
    def name(self):
        return f"{self.kind}-{self.triangles}"


def run_tool(command, merge=False, **options):
    """Runs a program and returns what it printed (merge: with its errors) and the CPU seconds it took; raises with its words when it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT if merge else subprocess.PIPE, text=True, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        words = (done.stdout[-500:] + (done.stderr or "")[-1500:]).strip()
        raise RuntimeError(f"{' '.join(map(str, command))}\nended with {done.returncode}: {words}")
    return done.stdout, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def one_core():
    """The environment of a program that must use one core and may be started as root."""
    return dict(os.environ, OMP_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                PRTE_ALLOW_RUN_AS_ROOT="1", PRTE_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_btl_vader_single_copy_mechanism="none",
                OMPI_MCA_hwloc_base_binding_policy="none", PRTE_MCA_hwloc_default_binding_policy="none")


def make_shapes(folder: Path, family: Family):
    """shapes.txt and shape_K.obj for everybody, shape_K.shape.h5 for Scree."""
    run_tool(["scree-peers-scene", "shapes", "--kind", family.kind, "--triangles", family.triangles,
              "--count", SHAPE_COUNT, "--radius", RADIUS, folder])
    for k in range(SHAPE_COUNT):
        run_tool(["scree-mesher", "import", folder / f"shape_{k}.obj", "-o", folder / f"shape_{k}.shape.h5", "--name", f"shape_{k}"])


def read_shapes(folder: Path):
    """Rows of shapes.txt: [volume, moments (3), bounding radius]."""
    return [[float(word) for word in line.split()] for line in open(folder / "shapes.txt")]


def read_obj(path: Path):
    vertices, triangles = [], []
    for line in open(path):
        words = line.split()
        if words[0] == "v":
            vertices.append(tuple(float(w) for w in words[1:]))
        else:
            triangles.append(tuple(int(w) - 1 for w in words[1:]))
    return vertices, triangles


def random_quaternion(numbers):
    q = [numbers.gauss(0, 1) for _ in range(4)]
    size = math.sqrt(sum(x * x for x in q))
    return [x / size for x in q]


def rotation_matrix(q):
    w, x, y, z = q
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))


def lattice(count, bounding_radius, seed=7, side=4, margin=MARGIN):
    """A state of bodies at rest in a lattice of `side` cells, turned at random, and the length of the box that it fills.

    200 bodies settle to a bed about as high as 4 are wide, so that most have neighbours on all sides."""
    spacing = 2.05 * bounding_radius + 2 * margin
    numbers = random.Random(seed)
    state = []
    for i in range(count):
        cell = (i % side, i // side % side, i // side ** 2)
        state.append([i % SHAPE_COUNT] + [(c + 0.5) * spacing for c in cell] + random_quaternion(numbers) + [0.0] * 6)
    return state, side * spacing


def spheres(count):
    """The same of spheres, as wide as the bed will be high, each moved aside at random, since a lattice of spheres would stand as it is."""
    state, length = lattice(count, RADIUS, side=max(4, round((count / 1.6) ** (1 / 3))))
    numbers = random.Random(11)
    return [row[:1] + [x + numbers.uniform(-0.03, 0.03) * RADIUS for x in row[1:3]] + row[3:] for row in state], length


def write_sphere_case(path: Path, state, length, steps):
    """A case of spheres for scree-decomposer: Hertz and Mindlin, as the other programs have them."""
    text = [f"gravity = [0, 0, {-GRAVITY}]\n[time]\nduration = {steps * STEP!r}\nstep = {STEP!r}\n[shapes.ball]\nsphere = {{ radius = {RADIUS!r} }}",
            f"[materials.rock]\ndensity = {DENSITY}\nyoung = {YOUNG!r}\npoisson = {POISSON!r}",
            f'[[pairs]]\nbetween = ["rock", "rock"]\nrestitution = {RESTITUTION}\nfriction = {FRICTION}', '[contact]\nlaw = "hertz-mindlin"']
    text += [f'[[bodies]]\nshape = "ball"\nmaterial = "rock"\nposition = {[float(x) for x in row[1:4]]}' for row in state]
    text.append(f"[[walls]]\nshape = {{ box_inside = [[0, 0, 0], [{length!r}, {length!r}, {20 * length!r}]] }}\n" 'material = "rock"')
    text.append(f"[output]\nevery = {steps * STEP!r}\ncontacts = false\n")
    path.write_text("\n".join(text))


def write_state(path: Path, state):
    with open(path, "w") as file:
        for row in state:
            file.write(" ".join([str(int(row[0]))] + [repr(float(x)) for x in row[1:]]) + "\n")


def read_state(path: Path):
    rows = [[float(word) for word in line.split()] for line in open(path)]
    return [[int(row[0])] + row[1:] for row in rows]


def write_case(path: Path, shapes: Path, state, length, duration, every, friction=FRICTION):
    """A case for scree-decomposer with every body placed, in an open box."""
    vector = lambda values: "[" + ", ".join(repr(float(v)) for v in values) + "]"
    text = [f'title = "comparison with other programs"\nseed = 1\ngravity = [0, 0, {-GRAVITY}]\n',
            f"[time]\nduration = {duration!r}\nstep = {STEP!r}\n"]
    for k in range(SHAPE_COUNT):
        text.append(f'[shapes.shape_{k}]\nfile = "{os.path.relpath(shapes / f"shape_{k}.shape.h5", path.parent)}"\n')
    text.append(f"[materials.rock]\ndensity = {DENSITY}\n")
    text.append(f'[[pairs]]\nbetween = ["rock", "rock"]\nstiffness = {STIFFNESS}\nrestitution = {RESTITUTION}\nfriction = {friction}\n')
    # as it was when the peers were measured: nothing drawn overlaps, which is what "cut pairs" counts
    # and a bed under load starts under load: by itself, the decomposer parts what is pressed
    text.append(f'[contact]\nsurface = "outside"\nmargin = {MARGIN!r}\nrelax = false\n')
    for row in state:
        text.append(f'[[bodies]]\nshape = "shape_{int(row[0])}"\nmaterial = "rock"\nposition = {vector(row[1:4])}\n'
                    f"orientation = {vector(row[4:8])}\nvelocity = {vector(row[8:11])}\nangular_velocity = {vector(row[11:14])}\n")
    # a lid far above: the box is closed, nothing reaches it
    text.append(f"[[walls]]\nshape = {{ box_inside = [[0, 0, 0], [{length!r}, {length!r}, {20 * length!r}]] }}\n" 'material = "rock"\n')
    text.append(f"[output]\nevery = {every!r}\ncontacts = false\n")
    path.write_text("\n".join(text))


def run_scree(folder: Path, name, shapes: Path, state, length, duration, every=None, friction=FRICTION):
    """Packs and runs; returns the folder of the run and the CPU seconds of the solver, start and files included."""
    folder.mkdir(parents=True, exist_ok=True)
    write_case(folder / f"{name}.toml", shapes, state, length, duration, every or duration, friction)
    return solve(folder, name)


def solve(folder: Path, name):
    """Packs and runs a case that is there; the folder of the run, and the CPU seconds of the solver."""
    run_tool(["scree-decomposer", "pack", folder / f"{name}.toml", "-o", folder / f"{name}.scene.h5"])
    run = folder / f"{name}.run"
    run_tool(["rm", "-rf", run])
    _, cpu = run_tool(["scree-solver", folder / f"{name}.scene.h5", "-o", run], env=one_core())
    return run, cpu


def read_frame(run: Path, number):
    """The state in a frame of a run, ordered by body."""
    import h5py
    with h5py.File(run / f"frame_{number:06d}.hdf") as file:
        data = file["VTKHDF/PointData"]
        order = sorted(range(len(data["id"])), key=lambda i: data["id"][i])
        columns = [data["shape"][:], file["VTKHDF/Points"][:], data["quat"][:], data["velocity"][:], data["angular_velocity"][:]]
    rows = [[int(columns[0][i])] + [float(x) for c in columns[1:] for x in c[i]] for i in order]
    return rows


def read_log(run: Path):
    """Columns of log.csv by name, texts left out."""
    lines = [line.rstrip("\n").split(",") for line in open(run / "log.csv") if not line.startswith("#")]
    columns = {}
    for index, name in enumerate(lines[0]):
        if name != "state_hash":
            columns[name] = [float(line[index]) for line in lines[1:]]
    return columns


def phases(log):
    """Columns of the seconds of a step's phases: all but those of output, and of what is counted in others."""
    return {name[2:]: column for name, column in log.items() if name.startswith("t_") and name not in ("t_output", "t_wait_longest")}


def judge(shapes: Path, state_file: Path, length):
    """What the independent judge says about a state, and its mechanical energy per body over m g R."""
    words, _ = run_tool(["scree-peers-scene", "judge", shapes, state_file, "--length", repr(length), "--density", DENSITY,
                         "--gravity", GRAVITY, "--reach", repr(2 * MARGIN)])
    verdict = json.loads(words)
    weight = DENSITY * sum(row[0] for row in read_shapes(shapes)) / SHAPE_COUNT * GRAVITY * RADIUS * verdict["bodies"]
    verdict["kinetic_share"] = verdict["kinetic"] / weight
    verdict["energy_share"] = (verdict["kinetic"] + verdict["potential"]) / weight
    verdict["depth_share"] = verdict["deepest"] / RADIUS
    return verdict


def settle(work: Path, family: Family, count):
    """Makes, once, the beds of a family: moving.state (bodies still falling and colliding), rest.state, length.txt.

    Without friction while it settles, so that the bed is as dense as one that was shaken for long."""
    shapes = work / family.name / "shapes"
    bed = work / family.name / f"bed-{count}"
    if not (bed / "rest.state").exists():
        bed.mkdir(parents=True, exist_ok=True)
        make_shapes(shapes, family)
        state, length = lattice(count, max(row[4] for row in read_shapes(shapes)))
        run, _ = run_scree(bed, "settle", shapes, state, length, 0.8, every=0.1, friction=0.0)
        write_state(bed / "moving.state", read_frame(run, 2))
        (bed / "length.txt").write_text(repr(length))
        write_state(bed / "rest.state", read_frame(run, 8))
    return shapes, bed, float((bed / "length.txt").read_text())
