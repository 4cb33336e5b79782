"""Reading our HDF5 files: formats and versions checked, errors that name the file."""
from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import h5py

from .errors import InputError, ScreeError


#: what reading raises where a value is missing, of another type or of another size than it must be
DAMAGE = (OSError, KeyError, ValueError, TypeError, IndexError, AttributeError, OverflowError, RecursionError, MemoryError, RuntimeError, zlib.error)


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
