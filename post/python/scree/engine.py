"""A run that a Python program steps: reads its bodies, and acts on them (solver/engine/scree_engine.h, by ctypes on libscree_engine.so).

Units: SI, world axes. With several MPI ranks all calls are collective, but for `bodies`, their fields, and the numbers `time` to `gravity`.
"""
from __future__ import annotations

import _signal  # its functions without the enums of `signal`, which take longer than a step of few bodies
import ctypes
import dataclasses
import math
import operator
import os
import shutil
import signal
import sys
import sysconfig
import tempfile
import threading
import warnings
from collections.abc import Callable, Generator, Sequence
from functools import cached_property, lru_cache
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from .errors import InternalError, UnknownName, UsageError, error_of, unknown_name
from .frames import Frame
from .rows import Field, Rows
from .scene import Named, Scene

_ABI = 1  # of the library: functions are added within one, and none is changed
_POLL_INTERVAL = 0.1  # [s], after which a Ctrl-C stops the steps: not felt, and far longer than a step of few bodies
_NAME = "libscree_engine.so"

Result = TypeVar("Result")

# ---- The library

_pointer, _text, _int, _int64, _double = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_int64, ctypes.c_double
_Poll = ctypes.CFUNCTYPE(_int, _pointer)
_OnWarning = ctypes.CFUNCTYPE(None, _pointer, _text)
_Force = ctypes.CFUNCTYPE(_int, _pointer, _pointer, _int64, _pointer, _pointer)


class _CEnergies(ctypes.Structure):
    _fields_ = [(name, _double) for name in (
        "translational", "rotational", "potential", "elastic", "tangential_elastic", "dissipated", "wall_work", "outer_work", "removed", "arrived",
        "bond", "fracture", "slept", "balance")]


#: scree_new_body
_NEW_BODY = np.dtype([("shape", np.uintp), ("material", np.uintp), ("position", float, 3), ("quaternion", float, 4), ("velocity", float, 3),
                      ("angular_velocity", float, 3), ("scale", float)])

#: result and arguments after the engine
_OF_ENGINE: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "close": (_int, ()), "step": (_int, (_int64,)), "run_until": (_int, (_double,)), "on_poll": (_int, (_Poll, _double, _pointer)),
    "time": (_double, ()), "dt": (_double, ()), "step_count": (_int64, ()), "duration": (_double, ()), "is_over": (_int, ()), "gravity": (_double, (_int,)),
    "shape_count": (_int, ()), "shape_name": (_text, (_int,)), "material_count": (_int, ()), "material_name": (_text, (_int,)),
    "body_count": (_int64, ()), "reals": (_pointer, (_text,)), "integers": (_pointer, (_text,)),
    "set_wrench": (_int, (_int64, _pointer, _pointer, _pointer)), "clear_wrench": (_int, (_int64, _pointer)),
    "add_force": (_int, (_Force, _int64, _pointer, _pointer)), "remove_force": (_int, (_int,)),
    "wall_count": (_int, ()), "wall_name": (_text, (_int,)), "wall_loads": (_int, (_pointer,)), "wall_state": (_int, (_int, _pointer)),
    "drive_wall": (_int, (_int, _double)), "wall_way": (_int, (_int, _pointer, _pointer)),
    "get_energies": (_int, (_pointer,)), "state_hash": (_int, (_pointer,)), "critical_step": (_int, (_pointer,)), "contacts": (_int, (_pointer,)),
    "contact_reals": (_pointer, (_text,)), "contact_integers": (_pointer, (_text,)),
    "save": (_int, (_pointer,)), "restore": (_int, (_pointer,)), "write_checkpoint": (_int, (_text,)), "write_frame": (_int, (_text,)),
    "insert": (_int, (_int64, _pointer, _pointer)), "remove": (_int, (_int64, _pointer)),
}


class ScreeWarning(UserWarning):
    """A warning of the engine, as scree-solver prints them."""


_warning_texts: list[str] = []  # that the library gave, until Python's `warnings` have them: within a call they could not be raised


@_OnWarning
def _keep_warning(_: Any, text: bytes) -> None:
    _warning_texts.append(text.decode("utf-8", "replace"))


def _pass_on_warnings() -> None:
    while _warning_texts:
        level, frame = 1, sys._getframe()
        while frame.f_back is not None and frame.f_code.co_filename == __file__:  # to the line that called this module
            level, frame = level + 1, frame.f_back
        warnings.warn(_warning_texts.pop(0), ScreeWarning, stacklevel=level)


def _library_path() -> str:
    given = os.environ.get("SCREE_ENGINE_LIBRARY")
    if given:
        if not os.path.isfile(given):
            raise UsageError(f"SCREE_ENGINE_LIBRARY={given}: no such file; give the path of {_NAME}")
        return given
    here = os.path.dirname(os.path.abspath(__file__))
    tools, solver = os.environ.get("SCREE_BIN"), shutil.which("scree-solver")
    if tools:
        folders = [tools]
    else:
        beside = [os.path.join(here, *[".."] * 4, "bin"), os.path.join(here, *[".."] * 3, "build", "release", "bin")]
        folders = [*([os.path.dirname(os.path.realpath(solver))] if solver else []), *beside]
    places = [os.path.join("..", "lib"), ".", os.path.join("..", "lib", sysconfig.get_config_var("MULTIARCH") or "."), os.path.join("..", "lib", "scree", "lib")]
    for folder in folders:
        for place in places:
            path = os.path.normpath(os.path.join(folder, place, _NAME))
            if os.path.isfile(path):
                return path
    where = f"in or near SCREE_BIN={tools}" if tools else "near the tools"
    raise UsageError(f"{_NAME}: not found {where}; set SCREE_ENGINE_LIBRARY to its path, or install it with the tools")


def _loaded(path: str) -> ctypes.CDLL:
    """OpenMP threads that wait give their core away soon, as those of scree-solver (solver/main.cpp): else a step takes up to a thousand times longer
    where others want the cores. The runtime reads the variable as it is loaded; where it is loaded before, it waits as it does."""
    is_given = "OMP_WAIT_POLICY" in os.environ or "GOMP_SPINCOUNT" in os.environ
    if not is_given:
        os.environ["GOMP_SPINCOUNT"] = "2000"
    try:
        return ctypes.CDLL(path)
    finally:
        if not is_given:
            del os.environ["GOMP_SPINCOUNT"]


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL:
    """The library, loaded once for the process. Raises UsageError when there is none, or one of another version."""
    path = _library_path()
    try:
        library = _loaded(path)
        abi = library.scree_engine_abi()
    except (OSError, AttributeError) as error:
        raise UsageError(f"{path}: cannot be loaded: {error}") from error
    if abi != _ABI:
        raise UsageError(f"{path}: has version {abi} of the interface, this package needs {_ABI}; install both from the same Scree")
    for name, (result, arguments) in _OF_ENGINE.items():
        function = getattr(library, f"scree_{name}")
        function.restype, function.argtypes = result, (_pointer, *arguments)
    library.scree_error.restype = _text
    library.scree_open.restype, library.scree_open.argtypes = _int, (_text, _pointer, _text, _text, _int, _pointer)
    library.scree_free_state.restype, library.scree_free_state.argtypes = None, (_pointer,)
    library.scree_on_warning.restype, library.scree_on_warning.argtypes = None, (_OnWarning, _pointer)
    library.scree_on_warning(_keep_warning, None)
    return library


def _error_text() -> str:
    return _library().scree_error().decode("utf-8", "replace")


def _copied(address: int, rows: int, width: int, kind: type) -> np.ndarray:
    """Numbers of the library as an array that lasts; read-only."""
    values = np.frombuffer(ctypes.string_at(address, 8 * rows * width), dtype=kind) if rows else np.zeros(0, dtype=kind)
    return values if width == 1 else values.reshape(rows, width)


# ---- Arguments: each function raises UsageError, with the argument's name in the text

def _whole(what: str, value: Any, least: int, most: int = 2**63 - 1) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise UsageError(f"{what}: {value!r} found, a whole number expected") from None
    if not least <= number <= most:
        raise UsageError(f"{what}: {number} found, a whole number of at least {least}{f' and at most {most}' if most < 2**63 - 1 else ''} expected")
    return number


def _real(what: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {value!r} found, a number expected") from None


def _path(what: str, value: Any) -> bytes:
    try:
        return os.fsencode(value)
    except TypeError:
        raise UsageError(f"{what}: {value!r} found, a path expected") from None


def _id_list(what: str, ids: ArrayLike) -> np.ndarray:
    found = np.atleast_1d(np.asarray(ids))
    if found.ndim != 1 or (found.size and found.dtype.kind not in "iu"):
        cure = "; a mask is applied as bodies.id[mask]" if found.dtype.kind == "b" else ""
        raise UsageError(f"{what}: {found.dtype} of shape {found.shape} found, a list of whole numbers expected{cure}")
    return np.ascontiguousarray(found, dtype=np.int64)


def _vectors(what: str, values: ArrayLike, rows: int, width: int = 3) -> np.ndarray:
    """rows x width numbers from as many, or from one row for all."""
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {type(values).__name__} found that is no array of numbers, {rows} x {width} expected") from None
    shapes = ((rows,), ()) if width == 1 else ((rows, width), (width,))
    if found.shape not in shapes:
        raise UsageError(f"{what}: shape {found.shape} found, {shapes[0]} expected, a row for each body, or {shapes[1]} for all")
    return np.ascontiguousarray(np.broadcast_to(found, shapes[0]))


def _address(values: np.ndarray | None) -> int | None:
    return None if values is None else values.ctypes.data


def _communicator(comm: Any) -> Any:
    """A duplicate of a communicator of mpi4py. Raises UsageError."""
    MPI = sys.modules.get("mpi4py.MPI")
    if MPI is None or not isinstance(comm, MPI.Intracomm) or comm == MPI.COMM_NULL:
        raise UsageError(f"comm: {comm!r} found, a communicator of mpi4py expected, such as MPI.COMM_WORLD, or None for this process alone")
    try:
        own, theirs = (ctypes.cast(library.MPI_Comm_size, _pointer).value for library in (_library(), ctypes.CDLL(MPI.__file__)))
    except (AttributeError, OSError):
        own = theirs = None  # cannot be compared here
    if own != theirs:
        raise UsageError(f"comm: mpi4py uses another MPI library than {_NAME}: {MPI.Get_library_version().split(',')[0]}; install the mpi4py of the system")
    return comm.Dup()


# ---- Rows of bodies and contacts

_WIDTHS = {name: 3 for name in ("position", "velocity", "angular_velocity", "force", "torque", "point", "normal", "tangential_force")} | {"quaternion": 4}
_INTEGERS = {"id", "shape", "material", "fixed", "asleep", "body_a", "body_b", "feature"}


class _Store(Protocol):
    count: int
    names: dict[str, np.ndarray]

    def get(self, name: str) -> np.ndarray: ...


class _Moment:
    """Fields of the bodies of this rank at one moment, read when first used; none is read of a later moment."""

    def __init__(self, engine: Engine) -> None:
        self._engine, self._moves, self._arrays = engine, engine._moves, {}  # type: ignore[var-annotated]
        self.count = int(engine._fact("body_count"))
        self.names = engine._names

    def get(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            engine = self._engine
            engine._enter(f"bodies.{name}")
            try:
                if self._moves != engine._moves:
                    raise UsageError(f"bodies.{name}: the engine has moved on since these bodies were taken, and this field had not been read; "
                                     f"take engine.bodies again, or read it in time with engine.bodies.read({name!r})")
                self._arrays[name] = _field(engine._handle, name, self.count)
            finally:
                engine._busy.release()
        return self._arrays[name]


class _WithinStep:
    """Fields of the bodies of this rank while a function of forces is called."""

    def __init__(self, handle: int, count: int, names: dict[str, np.ndarray]) -> None:
        self._handle, self.count, self.names = handle, count, names
        self._arrays: dict[str, np.ndarray] = {}
        self.is_over = False

    def get(self, name: str) -> np.ndarray:
        if self.is_over:
            raise UsageError(f"bodies.{name}: the bodies of a force function end with its call; keep copies of fields, or use engine.bodies after the step")
        if name not in self._arrays:
            self._arrays[name] = _field(self._handle, name, self.count)
        return self._arrays[name]


def _field(handle: int | None, name: str, count: int) -> np.ndarray:
    if name in _INTEGERS:
        address, kind = _library().scree_integers(handle, name.encode()), np.int64
    else:
        address, kind = _library().scree_reals(handle, name.encode()), float
    if address is None:
        raise UsageError(f"bodies.{name}: {_error_text()}")
    return _copied(address, count, _WIDTHS.get(name, 1), kind)


class EngineBodies(Rows):
    """Bodies that this rank owns, in any order: a body is known by its `id`. A mask, a slice or row numbers in brackets give a part.

    A field is read when it is first used. `engine.bodies` are those of one moment: what was read stays readable, and a field that is first read after the
    engine has moved on is a UsageError. The arrays are read-only copies.
    """

    id = Field("id", "-", "id of each body: unique, never reused; n")
    position = Field("position", "m", "centre of mass, world; n x 3")
    quaternion = Field("quaternion", "-", "unit quaternion w x y z: turns the axes of the shape's mesh to the world; n x 4")
    velocity = Field("velocity", "m/s", "of the centre of mass, world; n x 3")
    angular_velocity = Field("angular_velocity", "rad/s", "about world axes; n x 3")
    force = Field("force", "N", "sum of all forces in the last step, those from outside included; n x 3")
    torque = Field("torque", "N m", "the same, about the centre of mass; n x 3")
    mass = Field("mass", "kg", "of each body; n")
    volume = Field("volume", "m^3", "of each body; n")
    diameter = Field("diameter", "m", "of the sphere of equal volume; n")
    radius = Field("radius", "m", "distance of the farthest point from the centre of mass; n")
    shape = Field("shape", "-", "index of the shape; names with shape_name; n")
    material = Field("material", "-", "index of the material; names with material_name; n")
    scale = Field("scale", "-", "factor on the size of the shape; n")
    fixed = Field("fixed", "-", "1: never moves; n")
    asleep = Field("asleep", "-", "1: at rest, and not computed until it is disturbed; n")

    _store: Any

    def __init__(self, store: _Store, chosen: np.ndarray | None = None) -> None:
        """Made by an engine."""
        super().__init__(store, chosen)  # type: ignore[arg-type]

    @property
    def temperature(self) -> np.ndarray:
        """Temperature of each body; n [K]. Raises UsageError in a scene without heat."""
        return self._field("temperature")

    def _of_some_scenes(self) -> dict[str, str]:
        try:
            self._field("temperature")
        except UsageError:
            return {}
        return {"temperature": "K"}

    @property
    def shape_name(self) -> np.ndarray:
        """Name of the shape of each body; n texts."""
        return self._store.names["shape"][self.shape]

    @property
    def material_name(self) -> np.ndarray:
        """Name of the material of each body; n texts."""
        return self._store.names["material"][self.material]

    def read(self, *fields: str) -> EngineBodies:
        """Reads these fields at once, or without names all, so that they can be used after the engine has moved on. Returns the same bodies."""
        for name in fields or self.fields():
            if name not in self.fields() and name != "temperature":
                raise unknown_name("field of bodies", name, [*self.fields(), "temperature"])
            self._store.get(name)
        return self

    def row(self, body_id: int) -> int:
        """Row of a body by its id. Raises UnknownName when this rank does not own it."""
        found = np.flatnonzero(self.id == body_id)
        if not len(found):
            raise UnknownName(f"body {body_id}: not among these {len(self)} bodies; another rank owns it, it has left, or it is a wall")
        return int(found[0])

    def __len__(self) -> int:
        return self._store.count if self._chosen is None else len(self._chosen)


class EngineContacts(Rows):
    """Contact points that this rank counts, of the whole scene each once. The arrays are read-only copies."""

    body_a = Field("body_a", "-", "id of the first body, the smaller id; c")
    body_b = Field("body_b", "-", "id of the second body or wall; c")
    feature = Field("feature", "-", "key of the contact point within its pair; c")
    point = Field("point", "m", "contact point, world; c x 3")
    normal = Field("normal", "-", "unit vector from b to a; c x 3")
    overlap = Field("overlap", "m", "sum of margins minus gap; c")
    margin = Field("margin", "m", "sum of the two margins; c")
    normal_force = Field("normal_force", "N", "on a, along the normal; c")
    tangential_force = Field("tangential_force", "N", "on a; c x 3")

    @property
    def force(self) -> np.ndarray:
        """Force on a: normal and tangential; c x 3 [N]."""
        return self.normal_force[:, None] * self.normal + self.tangential_force


class EngineWall:
    """A wall of an engine. Its loads are collective, its position and velocities are not."""

    def __init__(self, engine: Engine, number: int, name: str) -> None:
        """Made by an engine."""
        self._engine, self._number = engine, number
        self.name: str = name  #: given in the case, or kind and number

    @property
    def load(self) -> np.ndarray:
        """Force of all bodies on the wall; 3 [N]. Collective."""
        return self._engine._wall_loads()[self._number, :3]

    @property
    def torque(self) -> np.ndarray:
        """Torque of all bodies on the wall about the world's origin; 3 [N m]. Collective."""
        return self._engine._wall_loads()[self._number, 3:]

    def _state(self) -> np.ndarray:
        state = np.zeros(13)
        self._engine._fact("wall_state", self._number, _address(state))
        return state

    @property
    def position(self) -> np.ndarray:
        """World = position + rotate(quaternion, point in the frame of the wall); 3 [m]."""
        return self._state()[:3]

    @property
    def quaternion(self) -> np.ndarray:
        """Unit quaternion w x y z; 4."""
        return self._state()[3:7]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of `position`; 3 [m/s]."""
        return self._state()[7:10]

    @property
    def angular_velocity(self) -> np.ndarray:
        """About world axes; 3 [rad/s]."""
        return self._state()[10:]

    def drive(self, rate: float) -> None:
        """Moves a wall with the motion `outer` of the case at a rate [m/s] or [rad/s], until it is given again; the same on every rank. Collective.

        Raises UsageError for another wall, or a rate above its max_speed or max_rate.
        """
        self._engine._drive(self._number, self.name, rate)

    def _way_and_rate(self) -> tuple[float, float]:
        way, rate = _double(), _double()
        if self._engine._fact("wall_way", self._number, ctypes.byref(way), ctypes.byref(rate)):
            raise UsageError(_error_text())
        return way.value, rate.value

    @property
    def way(self) -> float:
        """Displacement of a wall with the motion outer, servo, free or motor from where it was placed: along its direction [m] or about its axis [rad]."""
        return self._way_and_rate()[0]

    @property
    def rate(self) -> float:
        """Rate of `way` [m/s] or [rad/s]."""
        return self._way_and_rate()[1]

    def __repr__(self) -> str:
        return f"<scree.EngineWall '{self.name}'>"


@dataclasses.dataclass(frozen=True)
class Energies:
    """Energies of the whole scene [J]."""

    translational: float  #: kinetic, of the centres of mass
    rotational: float  #: kinetic, about them
    potential: float  #: of weight and of constant forces of the case
    elastic: float  #: of all contacts, along their normals
    tangential_elastic: float  #: of all contacts, across their normals
    dissipated: float  #: since the start
    wall_work: float  #: of moving walls on the bodies, since the start
    outer_work: float  #: of set_wrench() and add_force(), since the start
    removed: float  #: of bodies that left
    arrived: float  #: of bodies that came in
    bond: float  #: of bonds
    fracture: float  #: of bonds that broke
    slept: float  #: of bodies as they fell asleep
    balance: float  #: sum of all with the signs of what they bring: constant but for the error of the run

    @property
    def kinetic(self) -> float:
        """Translational and rotational [J]."""
        return self.translational + self.rotational


class State:
    """A state of a run in memory, from `Engine.save()`."""

    def __init__(self, handle: int, time: float, steps: int, ranks: int) -> None:
        """Made by an engine."""
        self._handle, self._ranks = handle, ranks
        self.time: float = time  #: [s]
        self.steps: int = steps  #: since the start of the run

    def __del__(self) -> None:
        if not sys.is_finalizing():
            _library().scree_free_state(self._handle)

    def __repr__(self) -> str:
        return f"<scree.State: step {self.steps} at {self.time:.6g} s>"


# ---- The engine

class _Kept:
    """Exceptions of callbacks, which the library cannot pass on, until its call has returned."""

    failure: BaseException | None = None  # of a function of forces
    interrupt: BaseException | None = None  # of a signal
    is_asked = False  # whether a Ctrl-C came while functions of forces were called


def _poll(kept: _Kept) -> Generator[int, Any, None]:
    """Lets the signals of Python act, and gives 2 after an exception of one of them. The library calls `send` of this generator.

    A function would be wrong here: Python runs handlers of signals as the first thing in it, before its `try`.
    """
    answer = 0
    while True:
        try:
            yield answer
            answer = 0
            _pass_on_warnings()
            if kept.is_asked:
                kept.is_asked = False
                raise KeyboardInterrupt
        except GeneratorExit:
            return
        except BaseException as error:
            kept.interrupt = error
            answer = int(signal.SIGINT)


def _force_callback(function: Callable[[EngineBodies], Any], kept: _Kept, names: dict[str, np.ndarray]) -> Any:
    name = getattr(function, "__name__", type(function).__name__)

    def fill(address: int, what: str, values: Any, count: int) -> None:
        if values is not None and count:
            given = _vectors(f"force function {name}: {what}", values, count)
            ctypes.memmove(address, _address(given), given.nbytes)  # all 0 before

    def call(_: Any, handle: int, count: int, force: int, torque: int) -> int:
        store = _WithinStep(handle, count, names)
        try:
            result = function(EngineBodies(store))
            forces, torques = result if isinstance(result, tuple) and len(result) == 2 else (result, None)
            fill(force, "force", forces, count)
            fill(torque, "torque", torques, count)
            return 0
        except BaseException as error:
            kept.failure = error
            return 1
        finally:
            store.is_over = True

    return _Force(call)


class Engine:
    """A run in this process, stepped from Python.

        with scree.Engine("bed.scene.h5") as engine:
            while engine.time < 0.2:
                engine.step(100)
                print(engine.time, engine.bodies.position[:, 2].max())

    Errors are raised on all ranks. After RunInvalid, InternalError, or an exception in a force function, only reading, `remove_force`, `restore` and `close`
    are left.
    Without `with`, call `close`. An engine of one rank is closed, too, when nothing refers to it any more; one of several ranks is not, since all must
    close it together, and for the same reason an exception of your own that leaves the `with` does not close it.
    One thread at a time calls an engine. Ctrl-C stops `step` within 0.1 s after a complete step, on all ranks; the engine can go on.
    """

    _handle: int | None = None
    _comm: Any = None  # of several ranks

    def __init__(self, scene: str | os.PathLike[str], comm: Any = None, run: str | os.PathLike[str] | None = None,
                 restart: str | os.PathLike[str] | None = None, threads: int | None = None) -> None:
        """scene    NAME.scene.h5, or a Scene
        comm     a communicator of mpi4py, whose ranks share the scene; None: this process alone
        run      NAME.run to make, with all files that scree-solver writes; None: no files
        restart  path of a checkpoint, or "latest" or "auto" of the run folder; None: from the scene
        threads  of each rank; None: OMP_NUM_THREADS where it is set, else as many as the bodies keep busy
        Raises UsageError, InputError, MachineError.
        """
        self._busy, self._caller = threading.Lock(), 0
        self._kept, self._moves, self._is_in_after_step = _Kept(), 0, False
        self._functions: dict[int, Any] = {}  # callbacks, which the library has the addresses of
        self._after: list[tuple[int, Callable[[Engine], Any]]] = []
        self._loads: tuple[int, np.ndarray] | None = None
        library, own = _library(), None if comm is None else _communicator(comm)
        self._ranks: int = 1 if own is None else own.Get_size()
        self._comm = own if self._ranks > 1 else None

        def arguments() -> tuple[Any, ...]:
            paths = (None if path is None else _path(what, path) for what, path in (("run", run), ("restart", restart)))
            return (_path("scene", scene), *paths, 0 if threads is None else _whole("threads", threads, 1, 1024))

        scene_path, *given = self._together(arguments)
        self._scene_path = os.fsdecode(scene_path)
        communicator = None if own is None else sys.modules["mpi4py.MPI"]._addressof(own)  # type: ignore[attr-defined]
        handle = _pointer()
        code = library.scree_open(scene_path, communicator, *given, ctypes.byref(handle))
        text = _error_text()
        if own is not None and (code or self._comm is None):
            own.Free()
        if code:
            self._comm = None
            raise self._marked(error_of(code, text, (), ""))
        self._handle = handle.value
        self._polls = _poll(self._kept)
        next(self._polls)
        self._poll_callback = _Poll(self._polls.send)
        self._call("on_poll", self._poll_callback, _POLL_INTERVAL, None)
        _pass_on_warnings()

    # -- calls of the library

    def _enter(self, what: str) -> None:
        """One call at a time of an open engine; `_busy` is released at its end."""
        if not self._busy.acquire(blocking=False):
            if self._caller == threading.get_ident():
                raise UsageError(f"{what}: the engine is within a step; a force function uses the bodies that it gets, and the numbers time to gravity")
            raise UsageError(f"{what}: another thread is within a call of this engine; use one thread, or a lock of your own")
        self._caller = threading.get_ident()
        if self._handle is None:
            self._busy.release()
            raise UsageError(f"{what}: the engine is closed; open another one")

    def _fact(self, name: str, *arguments: Any) -> Any:
        """A number of the library; also within a function of forces."""
        if self._handle is None:
            raise UsageError(f"{name}: the engine is closed; open another one")
        if self._busy.locked() and self._caller != threading.get_ident():
            raise UsageError(f"{name}: another thread is within a call of this engine; use one thread, or a lock of your own")
        return getattr(_library(), f"scree_{name}")(self._handle, *arguments)

    def _call(self, name: str, *arguments: Any) -> None:
        """Calls the library, and raises its errors, or the exceptions of callbacks that are behind them."""
        function = getattr(_library(), f"scree_{name}")
        self._enter(name)
        try:
            code = function(self._handle, *arguments) if not self._functions else self._call_shielded(function, *arguments)
            text = _error_text() if code else ""
        finally:
            self._busy.release()
        _pass_on_warnings()
        if not code:
            return
        kept = self._kept
        if code >= 128:
            error, kept.interrupt = kept.interrupt, None
            raise self._marked(error or KeyboardInterrupt())
        error, kept.failure = kept.failure, None
        raise self._marked(error or error_of(code, text, (), ""))

    def _call_shielded(self, function: Any, *arguments: Any) -> int:
        """A Ctrl-C does not cut a force function short, which would end the run: it waits for the poll. A second one does."""
        if threading.current_thread() is not threading.main_thread() or _signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            return function(self._handle, *arguments)

        def note(number: int, frame: Any) -> None:
            if self._kept.is_asked:
                signal.default_int_handler(number, frame)
            self._kept.is_asked = True

        _signal.signal(signal.SIGINT, note)
        try:
            return function(self._handle, *arguments)
        finally:
            _signal.signal(signal.SIGINT, signal.default_int_handler)

    def _marked(self, error: BaseException) -> BaseException:
        error._scree_on_all_ranks = True  # type: ignore[attr-defined]
        return error

    def _together(self, prepare: Callable[[], Result], alike: Any = None) -> Result:
        """What `prepare` gives. Where it raises on one rank, or `alike` differs, all ranks raise: none waits for another in a call of the library."""
        error: Exception | None = None
        try:
            result = prepare()
        except Exception as raised:
            if self._comm is None:
                raise
            error = raised
        if self._comm is None:
            return result
        reports = self._comm.allgather((None if error is None else f"{type(error).__name__}: {error}", alike))
        if error is not None:
            raise self._marked(error)
        for rank, (text, other) in enumerate(reports):
            if text is not None:
                raise self._marked(UsageError(f"rank {rank}: {text}"))
            if other != reports[0][1]:
                raise self._marked(UsageError(f"{other} given on rank {rank}, {reports[0][1]} on rank 0; all ranks give the same"))
        return result

    def _names_of(self, kind: str) -> list[str]:
        return [self._fact(f"{kind}_name", k).decode("utf-8", "replace") for k in range(self._fact(f"{kind}_count"))]

    @cached_property
    def _names(self) -> dict[str, np.ndarray]:
        """Names of shapes and materials, in the order of the scene."""
        return {kind: np.array(self._names_of(kind), dtype=object) for kind in ("shape", "material")}

    # -- begin and end

    def close(self) -> None:
        """Ends the run, and writes the last files of one with a folder. Calls after it are UsageErrors, a second close is none."""
        if self._handle is None:
            return
        try:
            self._call("close")
        except UsageError:
            if self._busy.locked():
                raise  # within a step, or in another thread: still open
            self._handle = None
            raise
        except BaseException:
            self._handle = None
            raise
        self._handle = None
        self._functions.clear()
        if self._comm is not None:
            self._comm.Free()
        pending, self._kept.interrupt = self._kept.interrupt, None
        if pending is not None or self._kept.is_asked:
            raise pending or KeyboardInterrupt()  # it came in the last step

    def __enter__(self) -> Engine:
        return self

    def __exit__(self, kind: Any, error: BaseException | None, traceback: Any) -> None:
        if error is None or self._comm is None or getattr(error, "_scree_on_all_ranks", False):
            self.close()

    def __del__(self) -> None:
        if self._handle is not None and self._comm is None and not sys.is_finalizing():
            _library().scree_close(self._handle)

    # -- steps

    def step(self, n: int = 1) -> None:
        """Makes n steps. With a run folder, a step after the end of the run is a UsageError. Raises KeyboardInterrupt after a Ctrl-C."""
        self._advance(_whole("step", n, 0))

    def run_until(self, time: float) -> None:
        """Steps until the first moment at or after a time [s]."""
        until = _real("run_until", time)
        if not self._after:
            self._check_not_nested("run_until")
            self._moves += 1
            self._call("run_until", until)
            return
        steps = math.ceil((until - self.time) / self.dt - 1e-9) if math.isfinite(until) else 2**63  # as the library
        self._advance(_whole("run_until: steps", max(0, steps), 0))

    def _check_not_nested(self, what: str) -> None:
        if self._is_in_after_step:
            raise UsageError(f"{what}: called by a function of after_step(), which is called between the steps of step() itself; return, and step afterwards")

    def _advance(self, count: int) -> None:
        self._check_not_nested("step")
        while True:
            part = min(count, *(every - self.steps % every for every, _ in self._after)) if self._after else count
            self._moves += 1
            self._call("step", part)
            count -= part
            if part and self._after:
                self._call_after()
            if count == 0:
                return

    def _call_after(self) -> None:
        due = [function for every, function in self._after if self.steps % every == 0]
        self._is_in_after_step = True
        try:
            self._together(lambda: [function(self) for function in due])
        finally:
            self._is_in_after_step = False

    def after_step(self, function: Callable[[Engine], Any], every: int = 1) -> None:
        """Calls function(engine) after each step whose number is a multiple of `every`. It may call everything but `step`."""
        def check() -> tuple[int, Callable[[Engine], Any]]:
            if not callable(function):
                raise UsageError(f"after_step: {function!r} found, a function expected")
            return _whole("after_step: every", every, 1), function

        self._after.append(self._together(check))

    @property
    def time(self) -> float:
        """Time of the run [s]."""
        return float(self._fact("time"))

    @property
    def dt(self) -> float:
        """Length of a step [s]; n steps take n times this."""
        return float(self._fact("dt"))

    @property
    def steps(self) -> int:
        """Steps since the start of the run."""
        return int(self._fact("step_count"))

    @property
    def duration(self) -> float:
        """Duration of the case [s]."""
        return float(self._fact("duration"))

    @property
    def is_over(self) -> bool:
        """Whether a run with a folder has reached its end: the duration of the case, or rest."""
        return bool(self._fact("is_over"))

    @property
    def gravity(self) -> np.ndarray:
        """Gravity; 3 [m/s^2]."""
        return np.array([self._fact("gravity", k) for k in range(3)])

    # -- reading

    @property
    def bodies(self) -> EngineBodies:
        """The bodies that this rank owns, at this moment; see EngineBodies. Not collective."""
        return EngineBodies(_Moment(self))

    @cached_property
    def walls(self) -> Named[EngineWall]:
        """The walls by name: `walls["lid"].load`. Raises UnknownName for others."""
        return Named("wall", [EngineWall(self, k, name) for k, name in enumerate(self._names_of("wall"))])

    def _wall_loads(self) -> np.ndarray:
        if self._loads is None or self._loads[0] != self._moves:
            loads = np.zeros((len(self.walls.in_order), 6))
            self._call("wall_loads", _address(loads))
            loads.flags.writeable = False
            self._loads = self._moves, loads
        return self._loads[1]

    def _drive(self, wall: int, name: str, rate: float) -> None:
        value = self._together(lambda: _real(f"drive: rate of {name}", rate), float(rate) if isinstance(rate, (int, float, np.number)) else None)
        self._call("drive_wall", wall, value)

    @cached_property
    def _scene(self) -> Scene:
        return Scene(self._scene_path)

    def frame(self, folder: str | os.PathLike[str] | None = None) -> Frame:
        """The whole scene at this moment as a Frame of the reader: all bodies by id, contacts, walls; `measures()`, `plot()`. Collective.

        folder   where its file is written, a folder that all ranks see; None: that of temporary files. The file is removed with the frame
        """
        own = tempfile.TemporaryDirectory(prefix="scree-frame-")
        shared = self._together(lambda: tempfile.mkdtemp(prefix="scree-frame-", dir=folder))
        if self._comm is not None:
            mine = shared
            shared = self._comm.bcast(mine)
            if mine != shared:
                os.rmdir(mine)
        name = f"frame_{self.steps:06}.hdf"
        try:
            self._call("write_frame", os.fsencode(os.path.join(shared, name)))
            path = self._together(lambda: shutil.copy(os.path.join(shared, name), own.name))
        finally:
            if self._comm is None or self._comm.Get_rank() == 0:
                shutil.rmtree(shared, ignore_errors=True)
        frame = Frame(path, self._scene, self.time)
        frame._folder = own  # type: ignore[attr-defined]  # lives as long
        return frame

    def energies(self) -> Energies:
        """Energies of the whole scene. Collective."""
        found = _CEnergies()
        self._call("get_energies", ctypes.byref(found))
        return Energies(*(getattr(found, name) for name, _ in _CEnergies._fields_))

    def contacts(self) -> EngineContacts:
        """The contact points that this rank counts. Collective."""
        count = _int64()
        self._call("contacts", ctypes.byref(count))
        arrays = {}
        for name in EngineContacts.fields():
            address = self._fact("contact_integers" if name in _INTEGERS else "contact_reals", name.encode())
            if address is None:
                raise InternalError(f"contacts: the library has no field {name}")
            arrays[name] = _copied(address, count.value, _WIDTHS.get(name, 1), np.int64 if name in _INTEGERS else float)
        return EngineContacts(arrays)  # type: ignore[arg-type]

    def state_hash(self) -> str:
        """Hash of the whole state, as in log.csv: equal when every bit is. Collective."""
        text = ctypes.create_string_buffer(33)
        self._call("state_hash", text)
        return text.value.decode()

    def critical_step(self) -> float:
        """Largest stable step of the contacts that there are [s]. Collective."""
        step = _double()
        self._call("critical_step", ctypes.byref(step))
        return step.value

    # -- forces from outside

    def set_wrench(self, ids: ArrayLike, force: ArrayLike, torque: ArrayLike | None = None) -> None:
        """Holds forces, and torques about the centres of mass, on bodies until they are set again, each instead of what its body had.

        ids      of any bodies, also of other ranks; each rank may give its own part
        force    n x 3, or 3 for all [N]; torque the same [N m], None: none
        They act from the next step on: for partners that change slowly, a fluid or a controller. A force that follows from positions or velocities
        belongs in `add_force`: a spring that is held for a step gains energy.
        """
        def check() -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
            found = _id_list("set_wrench: ids", ids)
            torques = None if torque is None else _vectors("set_wrench: torque", torque, len(found))
            return found, _vectors("set_wrench: force", force, len(found)), torques

        found, forces, torques = self._together(check)
        self._moves += 1  # forces on bodies change at once
        self._call("set_wrench", len(found), _address(found), _address(forces), _address(torques))

    def clear_wrench(self, ids: ArrayLike | None = None) -> None:
        """Holds nothing any more: on these bodies, or on all."""
        found = self._together(lambda: None if ids is None else _id_list("clear_wrench: ids", ids), "ids of all" if ids is None else "a list of ids")
        self._moves += 1  # forces on bodies change at once
        self._call("clear_wrench", -1 if found is None else len(found), None if found is None else _address(found))

    def add_force(self, function: Callable[[EngineBodies], Any], every: int = 1) -> int:
        """Calls a function within each step, and once at once. Returns a number for `remove_force`.

        function  of the bodies of this rank, at their new positions, with the velocities of half a step before. It returns their forces, n x 3 or 3
                  for all [N], or a tuple (forces, torques) [N m], or None. The bodies end with the call, arrays that were read from them do not. It may
                  read `time`, `steps` and the like of the engine, and call nothing else of it. An exception is raised by `step`, and ends the run
        every     in steps whose number is a multiple of it; between them the last forces are held
        """
        def check() -> int:
            if not callable(function):
                raise UsageError(f"add_force: {function!r} found, a function expected")
            return _whole("add_force: every", every, 1)

        steps = self._together(check)
        number, callback = _int(), _force_callback(function, self._kept, self._names)
        self._moves += 1  # forces on bodies change at once
        self._call("add_force", callback, steps, None, ctypes.byref(number))
        self._functions[number.value] = callback
        return number.value

    def remove_force(self, number: int) -> None:
        """Calls the function with this number no more."""
        self._moves += 1  # forces on bodies change at once
        self._call("remove_force", _whole("remove_force", number, -(2**31), 2**31 - 1))
        del self._functions[number]

    # -- states

    def save(self) -> State:
        """The present state in memory, held forces included. Force functions are not part of it. Collective."""
        handle = _pointer()
        self._call("save", ctypes.byref(handle))
        assert handle.value is not None
        return State(handle.value, self.time, self.steps, self._ranks)

    def restore(self, state: State) -> None:
        """Goes back to a saved state, as often as wanted, with the same bits after it. Not in a run with a folder. Collective."""
        def check() -> int:
            if not isinstance(state, State):
                raise UsageError(f"restore: {state!r} found, a state from save() expected")
            if state._ranks != self._ranks:
                raise UsageError(f"restore: the state is of {state._ranks} ranks, the engine has {self._ranks}; use a checkpoint, which any number of ranks reads")
            return state._handle

        handle = self._together(check)
        self._moves += 1
        self._call("restore", handle)

    def write_checkpoint(self, folder: str | os.PathLike[str]) -> None:
        """Writes a checkpoint into a folder that exists, named by its step; no more than the last two in a folder are kept. Collective."""
        self._call("write_checkpoint", self._together(lambda: _path("write_checkpoint", folder)))

    def write_frame(self, path: str | os.PathLike[str]) -> None:
        """Writes a frame, as those of a run, to a path. Collective."""
        self._call("write_frame", self._together(lambda: _path("write_frame", path)))

    # -- bodies that come and go

    def insert(self, shape: str | Sequence[str], material: str | Sequence[str], position: ArrayLike, quaternion: ArrayLike | None = None,
               velocity: ArrayLike | None = None, angular_velocity: ArrayLike | None = None, scale: ArrayLike = 1.0) -> np.ndarray:
        """Bodies join in the next step. Returns their ids. Each rank gives its own bodies; that their places are free is not checked.

        shape      name, or one for each; material the same
        position   n x 3, or 3 of one body [m]; where they are at the end of that step
        quaternion, velocity [m/s], angular_velocity [rad/s], scale of the shape: for each, or one for all; None: not turned, at rest
        """
        def check() -> tuple[np.ndarray, list[Any]]:
            places = np.atleast_2d(_floats("insert: position", position))
            if places.ndim != 2 or places.shape[1] != 3:
                raise UsageError(f"insert: position: shape {np.shape(position)} found, (n, 3) or (3,) expected")
            bodies, kept = np.zeros(len(places), dtype=_NEW_BODY), []
            bodies["position"] = places
            for kind, given in (("shape", shape), ("material", material)):
                words = [given] * len(places) if isinstance(given, str) else list(given)
                if len(words) != len(places):
                    raise UsageError(f"insert: {kind}: {len(words)} names found, one or {len(places)} expected")
                known = self._names[kind].tolist()
                for word in dict.fromkeys(words):
                    if word not in known:
                        raise unknown_name(f"insert: {kind}", word, known)
                texts = {word: ctypes.create_string_buffer(word.encode()) for word in dict.fromkeys(words)}
                kept.append(texts)
                bodies[kind] = [ctypes.addressof(texts[word]) for word in words]
            for name, width, values in (("quaternion", 4, [1, 0, 0, 0] if quaternion is None else quaternion), ("velocity", 3, 0 if velocity is None else velocity),
                                        ("angular_velocity", 3, 0 if angular_velocity is None else angular_velocity), ("scale", 1, scale)):
                bodies[name] = 0 if isinstance(values, int) and width == 3 else _vectors(f"insert: {name}", values, len(places), width)
            norms = np.linalg.norm(bodies["quaternion"], axis=1)
            if np.any(np.abs(norms - 1) > 1e-6):
                raise UsageError(f"insert: quaternion: norm {norms[np.argmax(np.abs(norms - 1))]:g} found, 1 expected (w x y z); divide it by its norm")
            return bodies, kept

        bodies, _texts = self._together(check)
        ids = np.zeros(len(bodies), dtype=np.int64)
        self._call("insert", len(bodies), _address(bodies), _address(ids))
        return ids

    def remove(self, ids: ArrayLike) -> None:
        """Takes bodies out in the next step, booked as those that leave the domain. Each rank may give its own part of the ids."""
        found = self._together(lambda: _id_list("remove: ids", ids))
        self._call("remove", len(found), _address(found))

    def __repr__(self) -> str:
        if self._handle is None:
            return f"<scree.Engine '{self._scene_path}': closed>"
        where = f" on this rank of {self._ranks}" if self._ranks > 1 else ""
        return f"<scree.Engine '{self._scene_path}': step {self.steps} at {self.time:.6g} s, {self._fact('body_count')} bodies{where}>"


def _floats(what: str, values: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {type(values).__name__} found that is no array of numbers") from None
