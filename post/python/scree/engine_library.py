"""libscree_engine.so by ctypes: where it is, its functions (solver/engine/scree_engine.h), its errors and warnings."""
from __future__ import annotations

import contextlib
import ctypes
import os
import shutil
import sys
import sysconfig
import warnings
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from .errors import UsageError

_ABI = 1  # of the library: functions are added within one, and none is changed
NAME = "libscree_engine.so"
_PACKAGE = os.path.dirname(__file__)

c_pointer, c_text, c_int, c_int64, c_double = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_int64, ctypes.c_double
PollFunction = ctypes.CFUNCTYPE(c_int, c_pointer)
WarningFunction = ctypes.CFUNCTYPE(None, c_pointer, c_text)
ForceFunction = ctypes.CFUNCTYPE(c_int, c_pointer, c_pointer, c_int64, c_pointer, c_pointer)


class CEnergies(ctypes.Structure):
    _fields_ = [(name, c_double) for name in (
        "translational", "rotational", "potential", "elastic", "tangential_elastic", "dissipated", "wall_work", "outer_work", "removed", "arrived",
        "bond", "fracture", "slept", "balance")]


class CHeat(ctypes.Structure):
    _fields_ = [(name, c_double) for name in (
        "stored", "made", "made_in_walls", "from_sources", "from_program", "from_medium", "from_walls", "arrived", "removed", "balance", "critical_step", "biot")]


#: scree_new_body
NEW_BODY = np.dtype([("shape", np.uintp), ("material", np.uintp), ("position", float, 3), ("quaternion", float, 4), ("velocity", float, 3),
                      ("angular_velocity", float, 3), ("scale", float)])

#: result and arguments after the engine
_OF_ENGINE: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "close": (c_int, ()), "step": (c_int, (c_int64,)), "run_until": (c_int, (c_double,)), "on_poll": (c_int, (PollFunction, c_double, c_pointer)),
    "time": (c_double, ()), "dt": (c_double, ()), "step_count": (c_int64, ()), "duration": (c_double, ()), "is_over": (c_int, ()), "gravity": (c_double, (c_int,)),
    "shape_count": (c_int, ()), "shape_name": (c_text, (c_int,)), "material_count": (c_int, ()), "material_name": (c_text, (c_int,)),
    "body_count": (c_int64, ()), "reals": (c_pointer, (c_text,)), "integers": (c_pointer, (c_text,)),
    "set_wrench": (c_int, (c_int64, c_pointer, c_pointer, c_pointer)), "clear_wrench": (c_int, (c_int64, c_pointer)),
    "remove_force": (c_int, (c_int,)),
    "set_heat_source": (c_int, (c_int64, c_pointer, c_pointer)), "set_medium": (c_int, (c_int64, c_pointer, c_pointer, c_pointer)),
    "clear_heat": (c_int, (c_int64, c_pointer)), "take_medium_heat": (c_int, (c_int64, c_pointer, c_pointer)), "get_heat": (c_int, (c_pointer,)),
    "add_named_force": (c_int, (c_text, ForceFunction, c_int64, c_pointer, c_pointer)), "force_failed": (None, (c_text,)),
    "wall_count": (c_int, ()), "wall_name": (c_text, (c_int,)), "wall_loads": (c_int, (c_pointer,)), "wall_state": (c_int, (c_int, c_pointer)),
    "drive_wall": (c_int, (c_int, c_double)), "wall_way": (c_int, (c_int, c_pointer, c_pointer)),
    "get_energies": (c_int, (c_pointer,)), "state_hash": (c_int, (c_pointer,)), "critical_step": (c_int, (c_pointer,)), "contacts": (c_int, (c_pointer,)),
    "contact_reals": (c_pointer, (c_text,)), "contact_integers": (c_pointer, (c_text,)),
    "save": (c_int, (c_pointer,)), "restore": (c_int, (c_pointer,)), "write_checkpoint": (c_int, (c_text,)), "write_frame": (c_int, (c_text,)),
    "insert_with_temperature": (c_int, (c_int64, c_pointer, c_pointer, c_pointer)), "remove": (c_int, (c_int64, c_pointer)),
}


class ScreeWarning(UserWarning):
    """A warning of the engine, as scree-solver prints them."""


_warning_texts: list[str] = []  # that the library gave, until Python's `warnings` have them: within a call they could not be raised


@WarningFunction
def _keep_warning(_: Any, text: bytes) -> None:
    _warning_texts.append(text.decode("utf-8", "replace"))


def pass_on_warnings() -> None:
    """Gives the warnings of the library to Python's `warnings`, as of the line that called this package."""
    while _warning_texts:
        level, frame = 1, sys._getframe()
        while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == _PACKAGE:
            level, frame = level + 1, frame.f_back
        warnings.warn(_warning_texts.pop(0), ScreeWarning, stacklevel=level)


def library_path() -> str:
    given = os.environ.get("SCREE_ENGINE_LIBRARY")
    if given:
        if not os.path.isfile(given):
            raise UsageError(f"SCREE_ENGINE_LIBRARY={given}: no such file; give the path of {NAME}")
        return given
    tools, solver = os.environ.get("SCREE_BIN"), shutil.which("scree-solver")
    if tools:
        folders = [tools]
    else:
        # first what this package came with: another one may be of another version
        folders = [os.path.join(_PACKAGE, *[".."] * 4, "bin"), os.path.join(_PACKAGE, *[".."] * 3, "build", "release", "bin")]
        folders += [os.path.dirname(os.path.realpath(solver))] if solver else []
    places = [os.path.join("..", "lib"), ".", os.path.join("..", "lib", sysconfig.get_config_var("MULTIARCH") or "."), os.path.join("..", "lib", "scree", "lib")]
    for folder in folders:
        for place in places:
            path = os.path.normpath(os.path.join(folder, place, NAME))
            if os.path.isfile(path):
                return path
    where = f"in or near SCREE_BIN={tools}" if tools else "near the tools"
    raise UsageError(f"{NAME}: not found {where}; set SCREE_ENGINE_LIBRARY to its path, or install it with the tools")


@contextlib.contextmanager
def of_the_wheel() -> Iterator[None]:
    """While MPI is begun: the Open MPI of the wheel takes its plug-ins from there (packaging/tool does so for the tools), and knows nothing of an mpirun of the
    system, which need not be of the same Open MPI: each process is alone. Programs that are started afterwards have the environment as it was."""
    plugins = os.path.join(os.path.dirname(library_path()), "plugins")
    if not os.path.isdir(plugins) or "mpi4py.MPI" in sys.modules:  # of another installation; or MPI is begun, with the system's
        yield
        return
    before = {name: value for name, value in os.environ.items() if name.startswith(("OMPI_", "PMIX_", "PMI_")) or name == "HWLOC_PLUGINS_PATH"}
    for name in before:
        del os.environ[name]
    os.environ |= {"OMPI_MCA_mca_base_component_path": plugins, "HWLOC_PLUGINS_PATH": plugins}
    try:
        yield
    finally:
        for name in ("OMPI_MCA_mca_base_component_path", "HWLOC_PLUGINS_PATH"):
            del os.environ[name]
        os.environ |= before


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
def loaded_library() -> ctypes.CDLL:
    """The library, loaded once for the process. Raises UsageError when there is none, or one of another version."""
    path = library_path()
    try:
        library = _loaded(path)
        abi = library.scree_engine_abi()
    except (OSError, AttributeError) as error:
        raise UsageError(f"{path}: cannot be loaded: {error}") from error
    if abi != _ABI:
        raise UsageError(f"{path}: has version {abi} of the interface, this package needs {_ABI}; install both from the same Scree")
    for name, (result, arguments) in _OF_ENGINE.items():
        function = getattr(library, f"scree_{name}")
        function.restype, function.argtypes = result, (c_pointer, *arguments)
    library.scree_error.restype = c_text
    library.scree_open.restype, library.scree_open.argtypes = c_int, (c_text, c_pointer, c_text, c_text, c_int, c_pointer)
    library.scree_free_state.restype, library.scree_free_state.argtypes = None, (c_pointer,)
    library.scree_on_warning.restype, library.scree_on_warning.argtypes = None, (WarningFunction, c_pointer)
    library.scree_on_warning(_keep_warning, None)
    return library


def error_text() -> str:
    return loaded_library().scree_error().decode("utf-8", "replace")


def memory(address: int, rows: int, width: int, kind: type) -> np.ndarray:
    """Numbers of the library where they are, for use within this call. Arrays of the places used last are kept: one is made in the time of a step."""
    place = address, rows, width, kind
    array = _memory.get(place)
    if array is None:
        if len(_memory) >= 64:
            _memory.clear()
        array = np.frombuffer((ctypes.c_char * (8 * rows * width)).from_address(address), dtype=kind)
        array = _memory[place] = array if width == 1 else array.reshape(rows, width)
    return array


_memory: dict[tuple[int, int, int, type], np.ndarray] = {}


def copied(address: int, rows: int, width: int, kind: type) -> np.ndarray:
    """Numbers of the library as an array that lasts; read-only."""
    values = memory(address, rows, width, kind).copy() if rows else np.zeros(0 if width == 1 else (0, width), dtype=kind)
    values.flags.writeable = False
    return values
