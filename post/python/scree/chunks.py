"""Reading a compressed dataset with all cores.

HDF5 inflates the chunks of a dataset one after another, at some 300 MB/s, slower than a disk reads them. zlib and numpy work without Python's
lock, so that threads share the chunks of our frames (shuffled, deflated; core/storage/RUN_FORMAT.md). All else goes the usual way.
"""
from __future__ import annotations

import os
import zlib
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np

_SMALLEST = 1 << 20  # [B]: below this threads cost more than they save
_MOST_THREADS = 8
_FILTERS = [h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE]


def _threads() -> int:
    return min(_MOST_THREADS, len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


def _is_ours(data: h5py.Dataset) -> bool:
    """Whether chunks are ranges of rows, shuffled and deflated, in the byte order of this machine."""
    if not data.chunks or data.chunks[1:] != data.shape[1:] or not data.dtype.isnative or data.dtype.kind not in "iuf":
        return False
    created = data.id.get_create_plist()
    return [created.get_filter(k)[0] for k in range(created.get_nfilters())] == _FILTERS and hasattr(data.id, "get_chunk_info")


def read_array(path: str, data: h5py.Dataset) -> np.ndarray:
    """All of a dataset of the file at `path`. Threads: of its own, all ended when it returns. Raises OSError or zlib.error when it is damaged."""
    workers = _threads()
    if data.nbytes < _SMALLEST or workers < 2 or not _is_ours(data):
        return data[()]
    values = np.zeros(data.shape, data.dtype)  # a chunk that was never written reads as 0
    shape, dtype, size = data.chunks, data.dtype, data.dtype.itemsize
    chunks = [data.id.get_chunk_info(k) for k in range(data.id.get_num_chunks())]
    if any(chunk.filter_mask for chunk in chunks):
        return data[()]
    with open(path, "rb") as file:
        descriptor = file.fileno()

        def read(chunk: h5py.h5d.StoreInfo) -> None:
            plain = np.frombuffer(zlib.decompress(os.pread(descriptor, chunk.size, chunk.byte_offset)), np.uint8)
            rows = plain.reshape(size, -1).T.copy().view(dtype).reshape(shape)
            begin = chunk.chunk_offset[0]
            values[begin : begin + shape[0]] = rows[: len(values) - begin]

        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(read, chunks))
    return values
