"""Calls of the library by an engine: one at a time, with its errors raised on all ranks, and with signals and callbacks of Python between."""
from __future__ import annotations

import _signal  # its functions without the enums of `signal`, which take longer than a step of few bodies
import os
import signal
import threading
from collections.abc import Callable, Generator
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from .engine_arguments import vectors
from .engine_library import ForceFunction, error_text, loaded_library, memory, pass_on_warnings
from .engine_rows import EngineBodies, WithinStep
from .errors import UsageError, error_of

Result = TypeVar("Result")


class Kept:
    """Exceptions of callbacks, which the library cannot pass on, until its call has returned."""

    failure: BaseException | None = None  # of a function of forces
    interrupt: BaseException | None = None  # of a signal
    is_asked = False  # whether a Ctrl-C came while functions of forces were called


def polls(kept: Kept) -> Generator[int, Any, None]:
    """Lets the signals of Python act, and gives 2 after an exception of one of them. The library calls `send` of this generator.

    A function would be wrong here: Python runs handlers of signals as the first thing in it, before its `try`.
    """
    answer = 0
    while True:
        try:
            yield answer
            answer = 0
            pass_on_warnings()
            if kept.is_asked:
                kept.is_asked = False
                raise KeyboardInterrupt
        except GeneratorExit:
            return
        except BaseException as error:
            kept.interrupt = error
            answer = int(signal.SIGINT)


def name_of(function: Any) -> str:
    """Of a function of a program, in messages and run.json."""
    name, code = getattr(function, "__name__", type(function).__name__), getattr(function, "__code__", None)
    if name == "<lambda>" and code is not None:
        return f"lambda of {os.path.basename(code.co_filename)}:{code.co_firstlineno}"
    return str(name)


def force_callback(function: Callable[[EngineBodies], Any], name: str, kept: Kept, names: dict[str, np.ndarray]) -> Any:
    """The function as the library calls it."""
    said = {what: f"force function {name}: {what}" for what in ("force", "torque")}

    def fill(address: int, what: str, values: Any, count: int) -> None:
        if values is not None and count:
            memory(address, count, 3, float)[...] = vectors(said[what], values, count)  # all 0 before

    def call(_: Any, handle: int, count: int, force: int, torque: int) -> int:
        store = WithinStep(handle, count, names)
        try:
            result = function(EngineBodies(store))
            forces, torques = result if isinstance(result, tuple) and len(result) == 2 else (result, None)
            fill(force, "force", forces, count)
            fill(torque, "torque", torques, count)
            return 0
        except BaseException as error:
            kept.failure = error
            why = f"{type(error).__name__}: {error}".removesuffix(": ")
            loaded_library().scree_force_failed(handle, why.encode("utf-8", "replace"))
            return 1
        finally:
            store.is_over = True

    return ForceFunction(call)


#: what a user called, where the library has another name for it
_SAID = {"body_count": "bodies", "step_count": "steps", "wall_count": "walls", "wall_name": "walls", "wall_state": "walls", "wall_loads": "walls: load",
         "wall_way": "walls: way", "drive_wall": "drive", "get_energies": "energies", "get_heat": "heat", "insert_with_temperature": "insert", "add_named_force": "add_force", "shape_count": "shape_name",
         "material_count": "material_name"}


class EngineCalls:
    """What an engine has of the library: its handle, and who is within a call."""

    _handle: int | None = None
    _comm: Any = None  # of several ranks

    def __init__(self) -> None:
        self._busy, self._caller = threading.Lock(), 0
        self._kept, self._moves = Kept(), 0
        self._functions: dict[int, Any] = {}  # callbacks, which the library has the addresses of

    def _enter(self, what: str) -> None:
        """One call at a time of an open engine; `_busy` is released at its end."""
        what = _SAID.get(what, what)
        if not self._busy.acquire(blocking=False):
            if self._caller == threading.get_ident():
                raise UsageError(f"{what}: the engine is within a step; a force function uses the bodies that it gets, and the numbers time to gravity")
            raise UsageError(f"{what}: another thread is within a call of this engine; use one thread, or a lock of your own")
        self._caller = threading.get_ident()
        try:
            self._check_open(what)
        except UsageError:
            self._busy.release()
            raise

    def _check_open(self, what: str) -> None:
        if self._handle is None:
            raise UsageError(f"{what}: the engine is closed; open another one")

    def _fact(self, name: str, *arguments: Any) -> Any:
        """A number of the library; also within a function of forces."""
        self._check_open(_SAID.get(name, name))
        if self._busy.locked() and self._caller != threading.get_ident():
            raise UsageError(f"{_SAID.get(name, name)}: another thread is within a call of this engine; use one thread, or a lock of your own")
        return getattr(loaded_library(), f"scree_{name}")(self._handle, *arguments)

    def _call(self, name: str, *arguments: Any) -> None:
        """Calls the library, and raises its errors, or the exceptions of callbacks that are behind them."""
        function = getattr(loaded_library(), f"scree_{name}")
        self._enter(name)
        try:
            code = function(self._handle, *arguments) if not self._functions else self._call_shielded(function, *arguments)
            text = error_text() if code else ""
        finally:
            self._busy.release()
        pass_on_warnings()
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
