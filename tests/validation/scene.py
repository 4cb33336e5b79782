"""Scenes for the tools, written the way a user writes them, and what a run left behind.

A Case holds the words of one case file. run() writes NAME.toml and its meshes into a folder, calls scree-mesher,
scree-decomposer and scree-solver, and gives a Run, which reads frames, log and record. Everything is SI.
"""
import csv
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import meshes  # noqa: E402
from mpi_environment import mpi_environment  # noqa: E402


class ToolError(Exception):
    """A tool ended with another exit code than expected; .code and .text say which and why."""

    def __init__(self, command, code, text):
        super().__init__(f"{' '.join(command)}: exit {code}\n{text}")
        self.code, self.text = code, text


class Tools:
    """Where the executables are, where files go. Run folders are short-lived: they live in memory where there is room,
    since the solver renames and flushes every frame, which costs 20 ms a frame on a disk that is busy."""

    def __init__(self, bin_folder, out, ranks=1, threads=1, repeat=1, size="small"):
        self.bin, self.out, self.ranks, self.threads, self.repeat, self.size = bin_folder, os.path.abspath(out), ranks, threads, repeat, size
        os.makedirs(self.out, exist_ok=True)
        memory = "/dev/shm"
        in_memory = os.path.isdir(memory) and os.access(memory, os.W_OK) and shutil.disk_usage(memory).free > 2**30
        self.scratch = tempfile.mkdtemp(prefix="scree-validation-", dir=memory if in_memory else self.out)
        self.environment = mpi_environment(OMP_NUM_THREADS=str(threads))

    def call(self, tool, *arguments, timeout=900, cwd=None):
        """Runs a tool; gives its stdout and stderr together. Throws ToolError for any exit code but 0."""
        path = os.path.join(self.bin, tool)
        command = [path, *arguments]
        if tool == "scree-solver" and self.ranks > 1:
            command = ["mpirun", "-n", str(self.ranks), *command]
        try:
            result = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=timeout, cwd=cwd, errors="replace")
        except subprocess.TimeoutExpired:
            raise ToolError([tool, *arguments], 124, f"still running after {timeout} s") from None
        text = result.stdout + result.stderr
        if result.returncode != 0:
            raise ToolError([tool, *arguments], result.returncode, text)
        return text

    def shape_file(self, named_meshes, surface=False, flip=False):
        """Imports meshes {name: (vertices, triangles)} in one call and gives the path; equal meshes are imported once."""
        digest = hashlib.sha256(repr((sorted(named_meshes), surface, flip)).encode())
        for name in sorted(named_meshes):
            vertices, triangles = named_meshes[name]
            digest.update(numpy.ascontiguousarray(vertices, dtype=float).tobytes() + numpy.ascontiguousarray(triangles, dtype=int).tobytes())
        path = os.path.join(self.scratch, digest.hexdigest()[:16] + ".shape.h5")
        if os.path.exists(path):
            return path
        files = []
        for name in sorted(named_meshes):
            file = os.path.join(self.scratch, f"{digest.hexdigest()[:16]}_{name}.off")
            meshes.write_off(file, *named_meshes[name])
            files.append(file)
        names = [word for name in sorted(named_meshes) for word in ("--name", name)]
        self.call("scree-mesher", "import", *files, *names, "-o", path, *(["--surface"] if surface else []), *(["--flip"] if flip else []))
        return path

    def sized(self, small, real):
        """What a bulk case takes at the size asked for."""
        return real if self.size == "real" else small

    def clean(self):
        shutil.rmtree(self.scratch, ignore_errors=True)


def toml(value):
    """A value as TOML: numbers keep all their digits."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, (list, tuple, numpy.ndarray)):
        return "[" + ", ".join(toml(entry) for entry in value) + "]"
    if isinstance(value, (int, numpy.integer)):
        return str(int(value))
    return repr(float(value))


class Case:
    """The words of one case file. Keyword arguments of the constructor go to [time], [contact], [motion], [output]."""

    def __init__(self, name, duration, step=None, steps_per_contact=None, gravity=(0, 0, 0), margin=None, law=None, gather=None,
                 integrator=None, every=None, contacts=False, seed=0, domain=None, time=None, contact=None, impacts=None):
        self.name = name
        self.top = {"title": name, "seed": seed, "gravity": list(gravity)}
        self.tables = {"time": {"duration": duration}, "contact": {}, "motion": {}, "output": {"contacts": contacts}}
        for table, key, value in [("time", "step", step), ("time", "steps_per_contact", steps_per_contact), ("contact", "margin", margin),
                                  ("contact", "law", law), ("contact", "gather", gather), ("motion", "integrator", integrator),
                                  ("output", "every", every), ("output", "impacts", impacts)]:
            if value is not None:
                self.tables[table][key] = value
        self.tables["contact"]["relax"] = False  # many cases start pressed as in equilibrium
        self.tables["time"].update(time or {})
        self.tables["contact"].update(contact or {})
        if domain is not None:
            self.tables["domain"] = domain
        self.shapes, self.solids, self.surfaces, self.files = {}, {}, {}, {}
        self.materials, self.pairs, self.bodies, self.walls, self.populations, self.inlets, self.outlets = {}, {}, [], [], [], [], []
        self.bonds, self.fluid, self.heat, self.cell = [], None, None, None  # heat, cell: the words of [heat] and [cell]

    # shapes: each gives its name, so that a call can stand where a body is made
    def sphere(self, name, radius):
        self.shapes[name] = {"sphere": {"radius": radius}}
        return name

    def mesh(self, name, mesh):
        self.solids[name] = mesh
        return name

    def shape_file(self, name, path, inner=None, **more):
        self.shapes[name] = {"file": path, **({"name": inner} if inner else {}), **more}
        return name

    def bond(self, **words):
        self.bonds.append(words)

    def material(self, name, density=1000.0, **more):
        self.materials[name] = {"density": density, **more}
        return name

    def pair(self, a, b, **values):
        self.pairs[tuple(sorted((a, b)))] = values

    def pair_all(self, **values):
        """Every pair of materials that has no values of its own."""
        names = sorted(self.materials)
        for i, a in enumerate(names):
            for b in names[i:]:
                self.pairs.setdefault((a, b), values)

    def body(self, shape, material, position, **more):
        self.bodies.append({"shape": shape, "material": material, "position": list(position),
                            **{k: list(v) if isinstance(v, (tuple, numpy.ndarray)) else v for k, v in more.items()}})
        return len(self.bodies) - 1

    def population(self, **words):
        """Bodies that the decomposer places; `count` and `region` as in the case language."""
        self.populations.append(words)

    def inlet(self, **words):
        self.inlets.append(words)

    def outlet(self, **words):
        self.outlets.append(words)

    def wall(self, shape, material, **more):
        self.walls.append({"shape": shape, "material": material, **more})
        return len(self.walls) - 1

    def floor(self, material="m", point=(0, 0, 0), normal=(0, 0, 1), **more):
        return self.wall({"plane": {"point": list(point), "normal": list(normal)}}, material, **more)

    def mesh_wall(self, mesh, material, **more):
        name = f"wall{len(self.surfaces)}"
        self.surfaces[name] = mesh
        return self.wall({"file": name}, material, **more)

    def text(self, shape_of=lambda name: name, surface_of=lambda name: name):
        lines = [f"{key} = {toml(value)}" for key, value in self.top.items()]
        for name, table in self.tables.items():
            if table:
                lines += [f"[{name}]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for name in self.solids:
            lines += [f"[shapes.{name}]", f"file = {toml(shape_of(name))}", f"name = {toml(name)}"]
        for name, table in self.shapes.items():
            lines += [f"[shapes.{name}]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for name, table in self.materials.items():
            lines += [f"[materials.{name}]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for (a, b), table in self.pairs.items():
            lines += ["[[pairs]]", f"between = {toml([a, b])}"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for table in self.bodies:
            lines += ["[[bodies]]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for table in self.populations:
            lines += ["[[populations]]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        for table in self.walls:
            table = dict(table)
            if table["shape"].get("file") in self.surfaces:
                table["shape"] = {"file": surface_of(table["shape"]["file"])}
            lines += ["[[walls]]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        if self.fluid:
            lines += ["[fluid]"] + [f"{key} = {toml(value)}" for key, value in self.fluid.items()]
        if self.heat is not None:
            lines += ["[heat]"] + [f"{key} = {toml(value)}" for key, value in self.heat.items()]
        if self.cell is not None:
            lines += ["[cell]"] + [f"{key} = {toml(value)}" for key, value in self.cell.items()]
        for name, tables in (("inlets", self.inlets), ("outlets", self.outlets), ("bonds", self.bonds)):
            for table in tables:
                lines += [f"[[{name}]]"] + [f"{key} = {toml(value)}" for key, value in table.items()]
        return "\n".join(lines) + "\n"

    def write(self, tools):
        """Imports the meshes and writes the case file; gives its path."""
        solids = tools.shape_file(self.solids) if self.solids else None
        surfaces = {name: tools.shape_file({name: mesh}, surface=True) for name, mesh in self.surfaces.items()}
        path = os.path.join(tools.out, f"{self.name}.toml")
        with open(path, "w") as file:
            file.write(self.text(lambda name: solids, lambda name: surfaces[name]))
        return path

    def pack(self, tools):
        """Gives the path of the scene."""
        path = self.write(tools)
        scene = os.path.join(tools.scratch, f"{self.name}.scene.h5")
        self.pack_text = tools.call("scree-decomposer", "pack", path, "-o", scene)
        return scene

    def solve(self, tools, scene, *arguments, timeout=900):
        """Runs a packed scene, as often as the tools are to time it. Throws ToolError when the solver refuses or the run becomes invalid."""
        folder = os.path.join(tools.scratch, f"{self.name}.run")
        walls = []
        for _ in range(tools.repeat):
            started = time.time()
            shutil.rmtree(folder, ignore_errors=True)
            text = tools.call("scree-solver", scene, "-o", folder, *arguments, timeout=timeout)
            run = Run(folder, self, text, time.time() - started)
            walls.append(run.wall_seconds)
        run.walls = walls
        shutil.rmtree(folder, ignore_errors=True)
        return run

    def run(self, tools, *arguments, timeout=900):
        """Packs and solves. Throws ToolError when a tool refuses or the run becomes invalid."""
        scene = self.pack(tools)
        run = self.solve(tools, scene, *arguments, timeout=timeout)
        os.remove(scene)
        return run


class Run:
    """What a run wrote. Bodies are in the order of the case; ids N tells how contacts name them.

    times F; x, v, w F x N x 3 [m, m/s, rad/s, world]; q F x N x 4 (w x y z); contacts: one dict of arrays per frame;
    wall_position F x W x 3; loads: of each frame a dict of arrays, one row for each triangle of walls with load maps; wear: the same for each vertex of walls that wear; impacts, losses: the same for what is recorded of them; log: dict of columns (numbers); record: run.json.
    """

    def __init__(self, folder, case=None, text="", seconds=0.0):
        self.case, self.text, self.seconds = case, text, seconds
        with open(os.path.join(folder, "run.json")) as file:
            self.record = json.load(file)
        self.log = read_log(os.path.join(folder, "log.csv"))
        with open(os.path.join(folder, "frames.hdf.series")) as file:
            entries = json.load(file)["files"]
        self.times, self.contacts, columns, temperatures = [], [], {"x": [], "v": [], "w": [], "q": []}, []
        self.wall_position, self.wall_orientation, self.loads, self.wear = [], [], [], []
        self.impacts, self.losses = [], []
        for entry in entries:
            with h5py.File(os.path.join(folder, entry["name"]), "r") as file:
                data = file["VTKHDF/PointData"]
                order = numpy.argsort(data["id"][:])
                self.ids = data["id"][:][order]
                self.times.append(float(file["frame"].attrs["time"]) if "frame" in file and "time" in file["frame"].attrs else entry["time"])
                columns["x"].append(file["VTKHDF/Points"][:][order])
                columns["v"].append(data["velocity"][:][order])
                columns["w"].append(data["angular_velocity"][:][order])
                columns["q"].append(data["quat"][:][order])
                if "temperature" in data:
                    temperatures.append(data["temperature"][:][order])
                if "contacts" in file:
                    self.contacts.append({name: file["contacts"][name][:] for name in file["contacts"]})
                if "loads" in file:
                    self.loads.append({name: file["loads"][name][:] for name in file["loads"]})
                for group, rows in (("impacts", self.impacts), ("losses", self.losses)):
                    if group in file:
                        rows.append({name: file[group][name][:] for name in file[group]})
                if "wear" in file:
                    self.wear.append({name: file["wear"][name][:] for name in file["wear"]})
                if "walls" in file:
                    self.wall_position.append(file["walls/position"][:])
                    self.wall_orientation.append(file["walls/orientation"][:])
        self.times = numpy.array(self.times)
        if len({len(x) for x in columns["x"]}) == 1:  # else bodies come and go: only the tables tell them
            self.temperature = numpy.array(temperatures)  # F x N [K], empty without heat
            self.x, self.v, self.w, self.q = (numpy.array(columns[name]) for name in ("x", "v", "w", "q"))
        self.inserted, self.removed = (read_events(os.path.join(folder, name)) for name in ("inserted.csv", "removed.csv"))
        self.steps, self.step = self.record["steps"], self.record["step_size"]
        self.wall_seconds = self.record["wall_seconds"]
        self.max_depth_ratio = self.record["max_depth_ratio"]

    def wall_column(self, wall, quantity):
        """F x 3 of 'force', 'torque' or 'impulse' on a wall, from the log (one row per log interval)."""
        bodies = len(self.case.bodies)  # numbered first; then walls, then what the decomposer placed
        return numpy.stack([self.log[f"wall{bodies + wall}_{quantity}_{axis}"] for axis in "xyz"], axis=1)

    def energy(self):
        """Kinetic + elastic + potential at the rows of the log."""
        log = self.log
        return log["kinetic_translational"] + log["kinetic_rotational"] + log["potential"] + log["elastic"] + log["elastic_tangential"]


def import_mesh(tools, mesh, *arguments, text=None, name="x"):
    """Writes an OFF file with all digits, or the text given, and imports it. Gives the shape file and what the tool said."""
    path = os.path.join(tools.scratch, name + ".off")
    if text is None:
        meshes.write_off(path, *mesh)
    else:
        with open(path, "w") as file:
            file.write(text)
    out = os.path.join(tools.scratch, name + ".shape.h5")
    if os.path.exists(out):
        os.remove(out)
    return out, tools.call("scree-mesher", "import", path, "-o", out, *arguments)


def read_log(path):
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    columns = {}
    for i, name in enumerate(rows[0]):
        if name != "state_hash":
            columns[name] = numpy.array([float(row[i]) for row in rows[1:]])
    return columns


def read_events(path):
    """Rows of inserted.csv or removed.csv; none without the table."""
    if not os.path.exists(path):
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def rotated(q, v):
    """Vectors turned by unit quaternions (w x y z); broadcasts."""
    q, v = numpy.asarray(q, float), numpy.asarray(v, float)
    u = q[..., 1:]
    t = 2 * numpy.cross(u, v)
    return v + q[..., :1] * t + numpy.cross(u, t)


def inverse(q):
    return numpy.asarray(q, float) * numpy.array([1, -1, -1, -1])


def quaternion(axis, angle):
    axis = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    return numpy.concatenate([[math.cos(angle / 2)], math.sin(angle / 2) * axis])
