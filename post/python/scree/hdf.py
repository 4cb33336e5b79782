"""Reading our HDF5 files: formats and versions checked, errors that name the file."""
from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import h5py
import numpy as np

from .errors import InputError, ScreeError


#: what reading raises where a value is missing, of another type or of another size than it must be
DAMAGE = (OSError, KeyError, ValueError, TypeError, IndexError, AttributeError, OverflowError, RecursionError, MemoryError, RuntimeError, zlib.error)

# columns of frames and scenes by their names: which hold integers, and which more than one number in a row
_INTEGERS = {"id", "shape", "material", "rank", "body_a", "body_b", "feature", "fixed", "lock_rotation", "population", "owner"}
_COMPONENTS = {"quat": 4, "orientation": 4, **dict.fromkeys(
    ("Points", "position", "velocity", "angular_velocity", "point", "normal", "tangential_force", "force", "torque"), 3)}


def text_of(value: Any) -> str:
    """Text of an attribute or scalar dataset, whatever way HDF5 stores it."""
    if isinstance(value, h5py.Dataset):
        value = value[()]
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def json_of(value: Any) -> Any:
    """Contents of a JSON text."""
    return json.loads(text_of(value))


@contextmanager
def opened(path: str, file_format: str, newest: int) -> Iterator[h5py.File]:
    """A file of ours, open for reading.

    Raises InputError when it is missing, truncated, of another format or of a newer version, or when what is read in the block is damaged.
    """
    if not os.path.exists(path):
        raise InputError(f"{path}: no such file")
    try:
        with h5py.File(path, "r") as file:
            found = text_of(file.attrs.get("format", ""))
            if found != file_format:
                raise InputError(f"{path}: format '{found}' found, '{file_format}' expected")
            version = int(file.attrs["format_version"])
            if version > newest:
                raise InputError(f"{path}: version {version} of {file_format}; this package reads up to version {newest}; use a newer Scree")
            yield file
    except ScreeError:
        raise
    except DAMAGE as error:
        raise InputError(f"{path}: the file is damaged: {error}") from error


def expect_column(path: str, name: str, values: np.ndarray) -> np.ndarray:
    """The values of a column of a frame or scene. Raises InputError for what is no column of numbers, or of other numbers than the format has."""
    column = name.rpartition("/")[2]
    width = _COMPONENTS.get(column)
    if values.dtype.kind not in ("iu" if column in _INTEGERS else "iuf") or not values.ndim or values.shape[1:] != (() if width is None else (width,)):
        expected = f"rows of {width} numbers" if width else "a column of integers" if column in _INTEGERS else "a column of numbers"
        raise InputError(f"{path}: {name}: {values.dtype} of shape {values.shape} found, {expected} expected; the file is damaged")
    return values
