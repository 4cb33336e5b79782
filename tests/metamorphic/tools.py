"""The four tools as a user runs them, and what a run left behind, read into memory."""
import contextlib
import csv
import hashlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import h5py
import numpy

LIMIT = 300        # s, after which a command counts as hanging: far above the second that a case takes, on a machine that does other work too
ENVIRONMENT = dict(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1",
                   OMPI_MCA_hwloc_base_binding_policy="none", OMPI_MCA_mpi_yield_when_idle="1", OMP_WAIT_POLICY="passive", OMPI_MCA_btl_base_warn_component_unused="0")


class Refused(Exception):
    """The tools named what is wrong with a case: exit 2 or 3 of mesher or decomposer."""


class Violation(Exception):
    """A relation does not hold."""


class NotApplicable(Exception):
    """A relation says nothing about this case."""


class Tools:
    """Where the executables are, and a folder of this process for what they write. Imported meshes are shared by all cases."""

    def __init__(self, bin_folder, mpiexec="mpirun", cache=None, many_ranks=None):
        # ranks that wait take turns with whatever else runs: two runs on several ranks at once cost more than one after the other
        self.many_ranks = many_ranks or contextlib.nullcontext()
        self.bin, self.mpiexec = os.path.abspath(bin_folder), mpiexec
        memory = "/dev/shm"
        roomy = os.path.isdir(memory) and os.access(memory, os.W_OK) and shutil.disk_usage(memory).free > 2**30
        self.scratch = tempfile.mkdtemp(prefix="scree-metamorphic-", dir=memory if roomy else None)
        self.cache = cache or os.path.join(self.scratch, "meshes")
        os.makedirs(self.cache, exist_ok=True)
        self.count = 0
        # temporary files of Open MPI go where they are removed: processes that are killed leave theirs
        self.environment = dict(ENVIRONMENT, TMPDIR=self.scratch, OMPI_MCA_btl_vader_backing_directory=self.scratch, OMPI_MCA_orte_tmpdir_base=self.scratch)
        self.mesher = str(os.stat(os.path.join(self.bin, "scree-mesher")).st_mtime_ns) if os.path.exists(os.path.join(self.bin, "scree-mesher")) else ""

    def clean(self):
        shutil.rmtree(self.scratch, ignore_errors=True)

    def new_path(self, ending):
        self.count += 1
        return os.path.join(self.scratch, f"{self.count:05}{ending}")

    def empty(self):
        """Removes what the cases before this one left."""
        for name in os.listdir(self.scratch):
            path = os.path.join(self.scratch, name)
            if path != self.cache:
                shutil.rmtree(path, ignore_errors=True) if os.path.isdir(path) else os.remove(path)

    def call(self, tool, *arguments, ranks=1, threads=1, environment=None, cwd=None):
        """Gives (exit code, stdout, stderr). A crash or a hang of any tool is a violation, whatever was asked."""
        words = ([self.mpiexec, "-n", str(ranks)] if ranks > 1 else []) + [os.path.join(self.bin, tool), *map(str, arguments)]
        with self.many_ranks if ranks > 1 else contextlib.nullcontext():
            return self.outcome_of(words, f"{tool} {' '.join(map(str, arguments))} on {ranks} ranks, {threads} threads", threads, environment, cwd)

    def outcome_of(self, words, what, threads, environment, cwd):
        child = subprocess.Popen(words, env=dict(os.environ, **self.environment, OMP_NUM_THREADS=str(threads), **(environment or {})),
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", cwd=cwd, start_new_session=True)
        try:
            out, err = child.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            end_all(child)
            child.communicate()
            raise Violation(f"hangs: {what}: no end after {LIMIT} s") from None
        if child.returncode < 0 or child.returncode in (1, 134, 136, 139) or "internal error" in err:
            raise Violation(f"crashes: {what}: exit {child.returncode}\n{err[-2000:]}")
        return child.returncode, out, err

    def mesh_file(self, mesh, surface=None):
        surface = mesh.surface if surface is None else surface
        text = mesh.off()
        path = os.path.join(self.cache, hashlib.sha256((text + str(surface) + self.mesher).encode()).hexdigest()[:20] + ".shape.h5")
        if not os.path.exists(path):
            source = path.replace(".shape.h5", ".off")   # stays: reports look for it
            own = self.new_path(".off")
            with open(own, "w") as file:
                file.write(text)
            shutil.move(own, source)
            own = self.new_path(".shape.h5")
            code, out, err = self.call("scree-mesher", "import", source, "-o", own, *(["--surface"] if surface else []))
            if code != 0:
                raise Refused(f"import: {err.strip()}")
            shutil.move(own, path)
        return path

    def write_case(self, case):
        folder = self.new_path(".case")
        os.makedirs(folder)
        path = os.path.join(folder, "case.toml")   # a case without a title has that of its file
        with open(path, "w") as file:
            file.write(case.text(lambda name: self.mesh_file(case.meshes[name])))
        return path

    def pack(self, case, *arguments, path=None):
        """Gives a Scene. Throws Refused when the tools name a reason."""
        path = path or self.write_case(case)
        scene = self.new_path(".scene.h5")
        code, out, err = self.call("scree-decomposer", "pack", path, "-o", scene, "--solver", os.path.join(self.bin, "scree-solver"), *arguments)
        if code in (2, 3):
            raise Refused(f"pack: {err.strip()}")
        if code != 0:
            raise Violation(f"pack ends with {code}: {err.strip()[-1000:]}")
        return Scene(scene, out + err, path)

    def solve(self, scene, ranks=1, threads=1, arguments=(), folder=None, environment=None):
        """Gives a Run, completed or invalid (exit 5)."""
        folder = folder or self.new_path(".run")
        code, out, err = self.call("scree-solver", scene.path, "-o", folder, *arguments, ranks=ranks, threads=threads, environment=environment)
        if code == 2 and "time.step = " in err:
            raise Refused(f"solver: {err.strip()}")   # a step that is given; only the solver knows which are too long
        if code in (2, 3):
            raise Violation(f"solver refuses what pack took, exit {code}: {err.strip()[-1000:]}")
        if code not in (0, 5):
            raise Violation(f"solver on {ranks} ranks, {threads} threads ends with {code}: {err.strip()[-1000:]}")
        return Run(folder, code, out + err, scene)

    def start(self, scene, folder, ranks, threads, arguments=()):
        """The solver in the background, to be killed."""
        words = ([self.mpiexec, "-n", str(ranks)] if ranks > 1 else []) + [os.path.join(self.bin, "scree-solver"), scene.path, "-o", folder, *arguments]
        return subprocess.Popen(words, env=dict(os.environ, **self.environment, OMP_NUM_THREADS=str(threads)),
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)


def descendants(pid):
    """Ids of the processes that a process started, and of theirs."""
    parents = {}
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat") as file:
                parents[int(entry)] = int(file.read().rsplit(")", 1)[1].split()[1])
        except (OSError, ValueError, IndexError):
            continue  # not a process, or gone meanwhile
    found, front = [], [pid]
    while front:
        front = [child for child, parent in parents.items() if parent in front]
        found += front
    return found


def end_all(child):
    """SIGKILL to a process that was started here and to all that it started."""
    for pid in [*descendants(child.pid), child.pid]:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass


class Scene:
    """A packed scene. Arrays of bodies are in the order of the file; walls are dicts as in the settings."""

    def __init__(self, path, text, case_path):
        self.path, self.text, self.case_path = path, text, case_path
        with h5py.File(path, "r") as file:
            self.settings = json.loads(as_text(file["settings"][()]))
            self.bodies = {name: file["bodies"][name][()] for name in file["bodies"]}
            self.shapes = []
            for name in sorted(file["shapes"], key=lambda n: int(n.rsplit("_", 1)[1])):
                group = file["shapes"][name]
                self.shapes.append({"name": as_text(group.attrs["name"]), "kind": int(group.attrs["kind"]), "volume": float(group.attrs["volume"]),
                                    "radius": float(group.attrs["sphere_radius"]), "vertices": group["vertices"][()],
                                    "triangles": group["triangles"][()], "inertia": group["inertia"][()]})
        self.general, self.walls, self.materials = self.settings["settings"], self.settings["walls"], self.settings["materials"]
        self.count = len(self.bodies["id"])
        self.order = numpy.argsort(self.bodies["id"])

    def body(self, name):
        return self.bodies[name][self.order]

    def of_shape(self, name):
        return numpy.array([self.shapes[s][name] for s in self.body("shape")]) if self.count else numpy.zeros(0)

    def masses(self):
        density = numpy.array([self.materials[m]["density"] for m in self.body("material")])
        return density * self.of_shape("volume") * self.body("scale") ** 3

    def radii(self):
        """Of the spheres about the centres of mass that hold the bodies."""
        reach = [shape["radius"] if shape["kind"] == 2 else float(numpy.linalg.norm(shape["vertices"], axis=1).max()) for shape in self.shapes]
        return numpy.array([reach[s] for s in self.body("shape")]) * self.body("scale")

    def moving(self):
        return self.body("fixed") == 0

    def size(self):
        """A length that stands for the bodies [m]."""
        return float(self.radii().mean()) if self.count else 1.0


class Frame:
    """Bodies sorted by id, contacts by pair and feature."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            data = file["VTKHDF/PointData"]
            order = numpy.argsort(data["id"][()])
            self.bodies = {name: data[name][()][order] for name in data if name != "rank"}
            self.bodies["position"] = file["VTKHDF/Points"][()][order]
            self.contacts = {name: file["contacts"][name][()] for name in file["contacts"]} if "contacts" in file else {}
            if self.contacts:
                order = numpy.lexsort([self.contacts[name] for name in ("feature", "body_b", "body_a")])
                self.contacts = {name: values[order] for name, values in self.contacts.items()}
            self.walls = {name: file["walls"][name][()] for name in file["walls"]} if "walls" in file else {}
            self.impacts, self.losses = ({name: file[group][name][()] for name in file[group]} if group in file else {} for group in ("impacts", "losses"))
            self.loads = {name: file["loads"][name][()] for name in file["loads"]} if "loads" in file else {}
            self.attributes = {name: value.item() if hasattr(value, "item") else value for name, value in file["frame"].attrs.items()}
        self.time, self.number = float(self.attributes["time"]), int(self.attributes["number"])
        self.position, self.velocity, self.ids = self.bodies["position"], self.bodies["velocity"], self.bodies["id"]
        self.spin, self.quat = self.bodies["angular_velocity"], self.bodies["quat"]


class Run:
    """What stands in the folder of a run; text: what the solver said."""

    def __init__(self, folder, code, text, scene):
        self.folder, self.code, self.text, self.scene = folder, code, text, scene
        self.record = read_json(os.path.join(folder, "run.json"))
        self.log = read_table(os.path.join(folder, "log.csv"))
        self.names = sorted(name for name in os.listdir(folder) if name.startswith("frame_") and name.endswith(".hdf"))
        self.frames = [Frame(os.path.join(folder, name)) for name in self.names]
        series = read_json(os.path.join(folder, "frames.hdf.series")) or {"files": []}
        self.series = [(entry["name"], entry["time"]) for entry in series["files"]]
        self.tables = {name: read_lines(os.path.join(folder, name)) for name in ("steps.csv", "removed.csv", "inserted.csv")}

    def events(self, name):
        """The rows of removed.csv or inserted.csv, by the names of their columns; none without the table."""
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            return []
        with open(path, encoding="utf-8", newline="") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def column(self, name):
        return numpy.array([float(value) for value in self.log[name]])

    @property
    def hash(self):
        return self.record["state_hash"] if self.record else None

    @property
    def steps(self):
        return self.record["steps"] if self.record else 0

    def completed(self):
        return self.code == 0


def as_text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def read_json(path):
    if not os.path.exists(path):
        return None
    with open(path) as file:
        return json.load(file)


def read_lines(path):
    if not os.path.exists(path):
        return None
    with open(path) as file:
        return file.read().splitlines()


def read_table(path):
    """Columns as texts; nothing of a log that is not there."""
    if not os.path.exists(path):
        return {}
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])} if rows else {}


def kill_later(child, delay):
    """Ends a run after so many seconds, if it still runs; gives the thread."""
    thread = threading.Thread(target=lambda: (time.sleep(delay), child.poll() is None and end_all(child)))
    thread.start()
    return thread
