"""Arguments of an engine's functions as the library needs them. Each function raises UsageError, with the argument's name in the text."""
from __future__ import annotations

import ctypes
import operator
import os
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .engine_library import NAME, NEW_BODY, c_pointer, loaded_library
from .errors import UsageError, unknown_name


def whole(what: str, value: Any, least: int, most: int = 2**63 - 1) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise UsageError(f"{what}: {value!r} found, a whole number expected") from None
    if not least <= number <= most:
        raise UsageError(f"{what}: {number} found, a whole number of at least {least}{f' and at most {most}' if most < 2**63 - 1 else ''} expected")
    return number


def real(what: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {value!r} found, a number expected") from None


def path_bytes(what: str, value: Any) -> bytes:
    try:
        return os.fsencode(value)
    except TypeError:
        raise UsageError(f"{what}: {value!r} found, a path expected") from None


def id_list(what: str, ids: ArrayLike) -> np.ndarray:
    found = np.atleast_1d(np.asarray(ids))
    if found.ndim != 1 or (found.size and found.dtype.kind not in "iu"):
        cure = "; a mask is applied as bodies.id[mask]" if found.dtype.kind == "b" else ""
        raise UsageError(f"{what}: {found.dtype} of shape {found.shape} found, a list of whole numbers expected{cure}")
    return np.ascontiguousarray(found, dtype=np.int64)


def vectors(what: str, values: ArrayLike, rows: int, width: int = 3) -> np.ndarray:
    """rows x width numbers from as many, or from one row for all."""
    if type(values) is np.ndarray and values.dtype == float and values.shape == ((rows,) if width == 1 else (rows, width)) and values.flags.c_contiguous:
        return values  # mostly: force functions of few bodies are called every 30 us
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {type(values).__name__} found that is no array of numbers, {rows} x {width} expected") from None
    shapes = ((rows,), ()) if width == 1 else ((rows, width), (width,))
    if found.shape not in shapes:
        raise UsageError(f"{what}: shape {found.shape} found, {shapes[0]} expected, a row for each body, or {shapes[1]} for all")
    return np.ascontiguousarray(np.broadcast_to(found, shapes[0]))


def address_of(values: np.ndarray | None) -> int | None:
    return None if values is None else int(values.__array_interface__["data"][0])  # half the time of values.ctypes


def duplicate_of(comm: Any) -> Any:
    """A duplicate of a communicator of mpi4py. Raises UsageError."""
    MPI = sys.modules.get("mpi4py.MPI")
    if MPI is None or not isinstance(comm, MPI.Intracomm) or comm == MPI.COMM_NULL:
        raise UsageError(f"comm: {comm!r} found, a communicator of mpi4py expected, such as MPI.COMM_WORLD, or None for this process alone")
    try:
        own, theirs = (ctypes.cast(library.MPI_Comm_size, c_pointer).value for library in (loaded_library(), ctypes.CDLL(MPI.__file__)))
    except (AttributeError, OSError):
        own = theirs = None  # cannot be compared here
    if own != theirs:
        raise UsageError(f"comm: mpi4py uses another MPI library than {NAME}: {MPI.Get_library_version().split(',')[0]}; install the mpi4py of the system")
    return comm.Dup()


def floats(what: str, values: ArrayLike) -> np.ndarray:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise UsageError(f"{what}: {type(values).__name__} found that is no array of numbers") from None


def new_bodies(names: dict[str, np.ndarray], shape: str | Sequence[str], material: str | Sequence[str], position: ArrayLike,
               given: dict[str, Any]) -> tuple[np.ndarray, list[Any]]:
    """Bodies as the library takes them, and what must live until it has.   in   names   of shapes and materials"""
    places = np.atleast_2d(floats("insert: position", position))
    if places.ndim != 2 or places.shape[1] != 3:
        raise UsageError(f"insert: position: shape {np.shape(position)} found, (n, 3) or (3,) expected")
    bodies, kept = np.zeros(len(places), dtype=NEW_BODY), []
    bodies["position"] = places
    for kind, named in (("shape", shape), ("material", material)):
        words = [named] * len(places) if isinstance(named, str) else list(named)
        if len(words) != len(places):
            raise UsageError(f"insert: {kind}: {len(words)} names found, one or {len(places)} expected")
        known = names[kind].tolist()
        for word in dict.fromkeys(words):
            if word not in known:
                raise unknown_name(f"insert: {kind}", word, known)
        texts = {word: ctypes.create_string_buffer(word.encode()) for word in dict.fromkeys(words)}
        kept.append(texts)
        bodies[kind] = [ctypes.addressof(texts[word]) for word in words]
    for name, width, default in (("quaternion", 4, [1, 0, 0, 0]), ("velocity", 3, 0), ("angular_velocity", 3, 0), ("scale", 1, 1.0)):
        values = default if given[name] is None else given[name]
        bodies[name] = 0 if isinstance(values, int) and width == 3 else vectors(f"insert: {name}", values, len(places), width)
    norms = np.linalg.norm(bodies["quaternion"], axis=1)
    if np.any(np.abs(norms - 1) > 1e-6):
        raise UsageError(f"insert: quaternion: norm {norms[np.argmax(np.abs(norms - 1))]:g} found, 1 expected (w x y z); divide it by its norm")
    return bodies, kept
