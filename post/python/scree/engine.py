"""A run that a Python program steps: reads its bodies, and acts on them (docs/user/engine.md).

Units: SI, world axes. With several MPI ranks all calls are collective, but for `bodies`, their fields, and the numbers `time` to `gravity`.
"""
from __future__ import annotations

import ctypes
import math
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .attributes import ReadAttributes
from .engine_after import AfterSteps
from .engine_arguments import address_of, duplicate_of, id_list, new_bodies, path_bytes, real, vectors, whole
from .engine_calls import force_callback, name_of, polls
from .engine_heat import Heat, HeatOfEngine
from .engine_library import CEnergies, PollFunction, ScreeWarning, c_double, c_int, c_int64, c_pointer, copied, error_text, loaded_library, of_the_wheel, pass_on_warnings
from .engine_rows import INTEGERS, WIDTHS, EngineBodies, EngineContacts, Moment
from .engine_values import Energies, EngineWall, State
from .errors import InternalError, UsageError, error_of
from .frames import Frame
from .scene import Named, Scene

__all__ = ["Energies", "Engine", "EngineBodies", "EngineContacts", "EngineWall", "Heat", "ScreeWarning", "State"]

_POLL_INTERVAL = 0.1  # [s], after which a Ctrl-C stops the steps: not felt, and far longer than a step of few bodies


class Engine(AfterSteps, HeatOfEngine, ReadAttributes):
    """A run in this process, stepped from Python.

        with scree.Engine("bed.scene.h5") as engine:
            while engine.time < 0.2:
                engine.step(100)
                print(engine.time, engine.bodies.position[:, 2].max())

    Errors are raised on all ranks. After RunInvalid, InternalError, or an exception in a force function the bodies are in the midst of a step: bodies, walls
    and energies cannot be read then. What is left: `restore` a saved state, `remove_force`, `close`, and to find the cause `frame` and `write_frame`.
    Without `with`, call `close`. An engine of one rank is closed, too, when nothing refers to it any more; one of several ranks is not, since all must
    close it together, and for the same reason an exception of your own that leaves the `with` does not close it.
    One thread at a time calls an engine. Ctrl-C stops `step` within 0.1 s after a complete step, on all ranks; the engine can go on.
    """

    def __init__(self, scene: str | os.PathLike[str], comm: Any = None, run: str | os.PathLike[str] | None = None,
                 restart: str | os.PathLike[str] | None = None, threads: int | None = None) -> None:
        """scene    NAME.scene.h5, or a Scene
        comm     a communicator of mpi4py, whose ranks share the scene; None: this process alone
        run      NAME.run to make, with the folders above it and all files that scree-solver writes; None: no files. An engine that is closed before
                 the duration of the case has the outcome "interrupted" there
        restart  path of a checkpoint; "latest": the newest of the run folder; "auto": the same, or from the scene where there is none; None: from the scene
        threads  of each rank; None: OMP_NUM_THREADS where it is set, else as many as the bodies keep busy
        Raises UsageError, InputError, MachineError.
        """
        super().__init__()
        self._loads: tuple[int, np.ndarray] | None = None
        library, own = loaded_library(), None if comm is None else duplicate_of(comm)
        self._ranks: int = 1 if own is None else own.Get_size()
        self._comm = own if self._ranks > 1 else None

        def arguments() -> tuple[Any, ...]:
            paths = (None if path is None else path_bytes(what, path) for what, path in (("run", run), ("restart", restart)))
            return (path_bytes("scene", scene), *paths, 0 if threads is None else whole("threads", threads, 1, 1024))

        scene_path, *given = self._together(arguments)
        self._scene_path = os.fsdecode(scene_path)
        self._has_folder = run is not None
        address = None if own is None else sys.modules["mpi4py.MPI"]._addressof(own)  # type: ignore[attr-defined]
        handle = c_pointer()
        with of_the_wheel():
            code = library.scree_open(scene_path, address, *given, ctypes.byref(handle))
        text = error_text()
        if own is not None and (code or self._comm is None):
            own.Free()
        if code:
            self._comm = None
            raise self._marked(error_of(code, text, (), ""))
        self._handle = handle.value
        self._polls = polls(self._kept)
        next(self._polls)
        self._poll_callback = PollFunction(self._polls.send)
        self._call("on_poll", self._poll_callback, _POLL_INTERVAL, None)
        pass_on_warnings()

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
            loaded_library().scree_close(self._handle)

    # -- steps

    def step(self, n: int = 1) -> None:
        """Makes n steps. With a run folder, they end with the run, and a step after its end is a UsageError. Raises KeyboardInterrupt after a Ctrl-C."""
        self._advance(whole("step", n, 0))

    def run_until(self, time: float) -> None:
        """Steps until the first moment at or after a time [s]."""
        until = real("run_until", time)
        if not self._after:
            self._check_not_nested("run_until")
            self._moves += 1
            self._call("run_until", until)
            return
        steps = (until - self.time) / self.dt
        if not abs(steps) < 2**53:   # as the library
            raise UsageError(f"run_until: {until:g} s is no time that can be reached in steps of {self.dt:.3g} s")
        self._advance(max(0, math.ceil(steps - 1e-9)))

    def _advance(self, count: int) -> None:
        self._check_not_nested("step")
        while True:
            part = self._until_due(count)
            self._moves += 1
            self._call("step", part)
            count -= part
            if part and self._after:
                self._call_after()
            if count == 0 or (self._has_folder and self.is_over):
                return

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
        """Whether the duration of the case has passed; with a run folder, whether the run has ended, by its duration or at rest."""
        return bool(self._fact("is_over"))

    @property
    def gravity(self) -> np.ndarray:
        """Gravity; 3 [m/s^2]."""
        return np.array([self._fact("gravity", k) for k in range(3)])

    # -- reading

    @property
    def bodies(self) -> EngineBodies:
        """The bodies that this rank owns, at this moment; see EngineBodies. Not collective."""
        return EngineBodies(Moment(self))

    @cached_property
    def walls(self) -> Named[EngineWall]:
        """The walls by name: `walls["lid"].load`. Raises UnknownName for others."""
        return Named("wall", [EngineWall(self, k, name) for k, name in enumerate(self._names_of("wall"))])

    def _wall_loads(self) -> np.ndarray:
        if self._loads is None or self._loads[0] != self._moves:
            loads = np.zeros((len(self.walls.in_order), 6))
            self._call("wall_loads", address_of(loads))
            loads.flags.writeable = False
            self._loads = self._moves, loads
        return self._loads[1]

    def _drive(self, wall: int, name: str, rate: float) -> None:
        value = self._together(lambda: real(f"drive: rate of {name}", rate), float(rate) if isinstance(rate, (int, float, np.number)) else None)
        self._call("drive_wall", wall, value)

    @cached_property
    def _scene(self) -> Scene:
        return Scene(self._scene_path)

    def frame(self, folder: str | os.PathLike[str] | None = None) -> Frame:
        """The whole scene at this moment as a Frame of the reader: all bodies by id, contacts, walls; `measures()`, `plot()`. Collective.

        folder   where its file is written, a folder that all ranks see; None: that of temporary files. The file is removed with the frame and all that
                 was taken from it: bodies, walls, contacts
        """
        self._check_open("frame")
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
        frame._store.folder = own  # lives as long as bodies, walls and contacts that were taken from the frame
        return frame

    def energies(self) -> Energies:
        """Energies of the whole scene. Collective."""
        found = CEnergies()
        self._call("get_energies", ctypes.byref(found))
        return Energies(*(getattr(found, name) for name, _ in CEnergies._fields_))

    def contacts(self) -> EngineContacts:
        """The contact points that this rank counts. Collective."""
        count = c_int64()
        self._call("contacts", ctypes.byref(count))
        arrays = {}
        for name in EngineContacts.fields():
            address = self._fact("contact_integers" if name in INTEGERS else "contact_reals", name.encode())
            if address is None:
                raise InternalError(f"contacts: the library has no field {name}")
            arrays[name] = copied(address, count.value, WIDTHS.get(name, 1), np.int64 if name in INTEGERS else float)
        return EngineContacts(arrays)  # type: ignore[arg-type]

    def state_hash(self) -> str:
        """Hash of the whole state, as in log.csv: equal when every bit is. Collective."""
        text = ctypes.create_string_buffer(33)
        self._call("state_hash", text)
        return text.value.decode()

    def critical_step(self) -> float:
        """Largest stable step of the contacts that there are [s]. Collective."""
        step = c_double()
        self._call("critical_step", ctypes.byref(step))
        return step.value

    # -- forces from outside

    def set_wrench(self, ids: ArrayLike, force: ArrayLike, torque: ArrayLike | None = None) -> None:
        """Holds forces, and torques about the centres of mass, on bodies until they are set again, each instead of what its body had.

        ids      of any bodies, also of other ranks; each rank may give its own part
        force    n x 3, or 3 for all [N]; torque the same [N m], None: none
        They act at once: `bodies.force` has them, and so has the next step from its first half kick on. For partners that change slowly, a fluid or a
        controller. A force that follows from positions or velocities belongs in `add_force`: a spring that is held for a step gains energy.
        A body of `insert` takes a wrench after the step in which it joins.
        """
        def check() -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
            found = id_list("set_wrench: ids", ids)
            torques = None if torque is None else vectors("set_wrench: torque", torque, len(found))
            return found, vectors("set_wrench: force", force, len(found)), torques

        found, forces, torques = self._together(check)
        self._moves += 1  # forces on bodies change at once
        self._call("set_wrench", len(found), address_of(found), address_of(forces), address_of(torques))

    def clear_wrench(self, ids: ArrayLike | None = None) -> None:
        """Holds nothing any more: on these bodies, or on all."""
        found = self._together(lambda: None if ids is None else id_list("clear_wrench: ids", ids), "ids of all" if ids is None else "a list of ids")
        self._moves += 1  # forces on bodies change at once
        self._call("clear_wrench", -1 if found is None else len(found), None if found is None else address_of(found))

    def add_force(self, function: Callable[[EngineBodies], Any], every: int = 1) -> int:
        """Calls a function within each step. Returns a number for `remove_force`.

        function  of the bodies of this rank, at their new positions, with the velocities of half a step before. It returns their forces, n x 3 or 3
                  for all [N], or a tuple (forces, torques) [N m], or None. The bodies end with the call, arrays that were read from them do not. It may
                  read `time`, `steps` and the like of the engine, and call nothing else of it. An exception is raised by `step`, and ends the run
        every     in steps whose number is a multiple of it; between them the last forces are held

        add_force itself makes the first call, for the first half kick: n steps take n + 1 calls. After a restart it does not: up to the next step the
        functions take the forces that those of the checkpoint had, in the order in which they are added. Add the same functions in the same order, before
        the first step, and the run goes on with the same bits.
        A drag C is of first order in the step, since its velocities are half a step old: a period is too short by C dt / (4 m) of itself. It is stable
        for dt < 2 m / C, a spring of angular frequency w for dt < 2 / w; no check of the case knows of either.
        """
        def check() -> int:
            if not callable(function):
                raise UsageError(f"add_force: {function!r} found, a function expected")
            return whole("add_force: every", every, 1)

        self._check_open("add_force")
        steps = self._together(check)
        name = name_of(function)
        number, callback = c_int(), force_callback(function, name, self._kept, self._names)
        self._moves += 1  # forces on bodies change at once
        self._call("add_named_force", name.encode("utf-8", "replace"), callback, steps, None, ctypes.byref(number))
        self._functions[number.value] = callback
        return number.value

    def remove_force(self, number: int) -> None:
        """Calls the function with this number no more."""
        self._moves += 1  # forces on bodies change at once
        self._call("remove_force", whole("remove_force", number, -(2**31), 2**31 - 1))
        del self._functions[number]

    # -- states

    def save(self) -> State:
        """The present state in memory, held forces included. Force functions are not part of it. Collective."""
        handle = c_pointer()
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
        self._call("write_checkpoint", self._together(lambda: path_bytes("write_checkpoint", folder)))

    def write_frame(self, path: str | os.PathLike[str]) -> None:
        """Writes a frame, as those of a run, to a path. Collective."""
        self._call("write_frame", self._together(lambda: path_bytes("write_frame", path)))

    # -- bodies that come and go

    def insert(self, shape: str | Sequence[str], material: str | Sequence[str], position: ArrayLike, quaternion: ArrayLike | None = None,
               velocity: ArrayLike | None = None, angular_velocity: ArrayLike | None = None, scale: ArrayLike = 1.0,
               temperature: ArrayLike | None = None) -> np.ndarray:
        """Bodies join in the next step. Returns their ids. Each rank gives its own bodies.

        Raises UsageError, and no body joins, for a place outside the domain, within a body or behind a wall, and for a size that the scene was not made for.
        Warns of an overlap of more than 2 % of a radius, and again when one is at least twice as large as what was reported before.

        shape      name, or one for each; material the same
        position   n x 3, or 3 of one body [m]; where they are at the end of that step
        quaternion, velocity [m/s], angular_velocity [rad/s], scale of the shape: for each, or one for all; None: not turned, at rest
        temperature  [K], the same, in scenes with heat; None: heat.temperature of the case
        """
        def check() -> tuple[np.ndarray, np.ndarray | None, list[Any]]:
            given = {"quaternion": quaternion, "velocity": velocity, "angular_velocity": angular_velocity, "scale": scale}
            bodies, texts = new_bodies(self._names, shape, material, position, given)
            return bodies, None if temperature is None else vectors("insert: temperature", temperature, len(bodies), 1), texts

        self._check_open("insert")
        bodies, temperatures, _texts = self._together(check)
        ids = np.zeros(len(bodies), dtype=np.int64)
        self._call("insert_with_temperature", len(bodies), address_of(bodies), address_of(temperatures), address_of(ids))
        return ids

    def remove(self, ids: ArrayLike) -> None:
        """Takes bodies out in the next step, booked as those that leave the domain. Each rank may give its own part of the ids."""
        found = self._together(lambda: id_list("remove: ids", ids))
        self._call("remove", len(found), address_of(found))

    def __repr__(self) -> str:
        if self._handle is None:
            return f"<scree.Engine '{self._scene_path}': closed>"
        where = f" on this rank of {self._ranks}" if self._ranks > 1 else ""
        return f"<scree.Engine '{self._scene_path}': step {self.steps} at {self.time:.6g} s, {self._fact('body_count')} bodies{where}>"
