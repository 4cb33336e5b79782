"""Frames under names that other programs know: H5MD 1.1, with its module `units` 1.0.

Source: P. de Buyl, P. H. Colberg, F. Höfling, H5MD: a structured, efficient, and portable file format for molecular data, Computer Physics
Communications 185 (2014), and the specification 1.1.0.

    h5md                        version, author, creator
    particles/trajectory
      box                       dimension, boundary; edges of a periodic domain
      position velocity angular_velocity orientation id species material scale
        step time               one dataset each, of which all elements have hard links
        value                   frames x bodies (x components)
    observables                 kinetic_energy ..., each with step, time, value
    parameters                  shapes, materials: what species and material count

The values are virtual datasets: each row of `value` is the dataset of one frame file, in the order of that file, so that nothing is stored twice.
HDF5 does not let a row be ordered anew; a body is known by its `id`, as H5MD has it. A frame with fewer bodies than another ends in rows
with the fill value of `id`, -1.
"""
from __future__ import annotations

import getpass
import os
from typing import Any

import h5py
import numpy as np

from .errors import MachineError, UsageError
from .frames import Frames
from .hdf import opened
from .rows import Bodies
from .run import Run
from .scene import Scene

_NO_ID = -1
# H5MD's name of a field; quaternions are "orientation" by its proposal 104
_ELEMENTS = {"position": "position", "velocity": "velocity", "angular_velocity": "angular_velocity", "orientation": "quaternion", "id": "id",
             "species": "shape", "material": "material", "scale": "scale"}
_UNITS = {"m": "m", "m/s": "m s-1", "rad/s": "rad s-1", "J": "J", "s": "s", "kg": "kg", "kg/m^3": "kg m-3"}  # as the module writes them
_FIXED = ("species", "material", "scale")  # of a body for all time
_ENERGIES = ("kinetic", "potential", "elastic", "dissipated")


def _fill(dtype: np.dtype) -> Any:
    return np.nan if dtype.kind == "f" else _NO_ID


def _fixed_text(text: str) -> np.ndarray:
    """A text of fixed length, as H5MD wants its attributes."""
    return np.array(text.encode("utf-8") or b" ", dtype=f"S{len(text.encode('utf-8')) or 1}")


class _Writer:
    """One file that is being written."""

    def __init__(self, file: h5py.File, frames: Frames, scene: Scene, with_units: bool) -> None:
        self.file, self.frames, self.scene, self.with_units = file, frames, scene, with_units

    def unit(self, data: Any, unit: str) -> None:
        """`unit`: as in our formats, "m/s"."""
        if self.with_units and unit in _UNITS:
            data.attrs.create("unit", _UNITS[unit], dtype=h5py.string_dtype("ascii"))

    def head(self, version: str) -> None:
        head = self.file.create_group("h5md")
        head.attrs["version"] = np.array([1, 1], dtype=np.int32)
        try:
            user = getpass.getuser()
        except (KeyError, OSError):
            user = "unknown"
        head.create_group("author").attrs["name"] = _fixed_text(user)
        creator = head.create_group("creator")
        creator.attrs["name"], creator.attrs["version"] = _fixed_text("Scree"), _fixed_text(version)
        if self.with_units:
            units = head.create_group("modules/units")
            units.attrs["version"] = np.array([1, 0], dtype=np.int32)
            units.attrs.create("system", "SI", dtype=h5py.string_dtype("ascii"))

    def steps_and_energies(self, group: h5py.Group) -> None:
        """Steps and times, once in the file, and the energies of the whole scene."""
        position = group.create_group("position")
        rows = [(frame.step, frame.time, *(getattr(frame, name) for name in _ENERGIES)) for frame in self.frames]
        position["step"] = np.array([row[0] for row in rows], dtype=np.int64)
        position["time"] = np.array([row[1] for row in rows])
        self.unit(position["time"], "s")
        for k, name in enumerate(_ENERGIES, 2):
            energy = self.element(self.file.require_group("observables"), f"{name}_energy")
            energy["value"] = np.array([row[k] for row in rows])
            self.unit(energy["value"], "J")

    def element(self, group: h5py.Group, name: str) -> h5py.Group:
        """An element that depends on time: a group with hard links to the steps and times that all have."""
        made = group.require_group(name)
        position = self.file["particles/trajectory/position"]
        if made != position:
            made["step"], made["time"] = position["step"], position["time"]
        return made

    def box(self, group: h5py.Group) -> None:
        box, domain = group.create_group("box"), self.scene.settings.get("domain", {})
        periodic = domain.get("periodic", [False] * 3)
        box.attrs["dimension"] = np.int32(3)
        box.attrs["boundary"] = np.array([b"periodic" if p else b"none" for p in periodic], dtype="S8")
        if any(periodic):  # along the other axes they are placeholders; edge vectors as rows, which more readers know than a vector of lengths
            edges = [f.cell.edges if f.cell else np.diag(np.subtract(domain["max"], domain["min"]).astype(float)) for f in self.frames]
            edges = self.element(box, "edges").create_dataset("value", data=np.array(edges))
            lower = self.file.create_dataset("parameters/domain/min", data=np.asarray(domain["min"], dtype=float))
            for data in (edges, lower):
                self.unit(data, "m")
            if any(f.cell for f in self.frames):  # where its lower corner is as it deforms; parameters/domain/min is that of the start
                places = [f.cell.lower if f.cell else domain["min"] for f in self.frames]
                self.unit(self.element(box, "offset").create_dataset("value", data=np.array(places, dtype=float)), "m")

    def names(self) -> None:
        """What the numbers of `species` and `material` count."""
        for kind, items, column, unit in (("shapes", self.scene.shapes.in_order, "equivalent_diameter", "m"),
                                          ("materials", self.scene.materials.in_order, "density", "kg/m^3")):
            group = self.file.create_group(f"parameters/{kind}")
            group.create_dataset("name", data=[item.name for item in items], dtype=h5py.string_dtype("utf-8"))
            group[column] = np.array([getattr(item, column) for item in items], dtype=float)
            self.unit(group[column], unit)


def _write_virtual(writer: _Writer, group: h5py.Group, folder: str) -> bool:
    """Each value as a window on the frame files, in their order of rows. Returns whether each row is the same body in all frames."""
    fields = Bodies.fields()
    files, first, stay = [], None, True
    for frame in writer.frames:
        with opened(frame.path, "scree-frame", 1) as file:
            files.append((os.path.relpath(frame.path, folder), {name: file[fields[source].dataset].shape for name, source in _ELEMENTS.items()}))
            types = {name: file[fields[source].dataset].dtype for name, source in _ELEMENTS.items()}
            ids = file[Bodies.id.dataset][()]
        stay = stay and (first is None or np.array_equal(ids, first))
        first = ids
    for name, source in _ELEMENTS.items():
        most = max(shapes[name][0] for _, shapes in files)
        layout = h5py.VirtualLayout((len(files), most, *files[0][1][name][1:]), types[name])
        for row, (path, shapes) in enumerate(files):
            if shapes[name][0]:
                layout[row, : shapes[name][0]] = h5py.VirtualSource(path, fields[source].dataset, shapes[name], types[name])
        writer.unit(writer.element(group, name).create_virtual_dataset("value", layout, fillvalue=_fill(types[name])), fields[source].unit)
    return stay


def _write_copy(writer: _Writer, group: h5py.Group) -> None:
    """All values in this file, a row for each body that any frame has, by ascending id."""
    fields = Bodies.fields()
    known = [frame.bodies.id for frame in writer.frames]
    ids = np.unique(np.concatenate(known))
    always = all(len(some) == len(ids) for some in known)
    fixed: dict[str, np.ndarray] = {"id": ids} if always else {}
    for row, frame in enumerate(writer.frames):
        places = np.searchsorted(ids, frame.bodies.id)
        for name, source in _ELEMENTS.items():
            values = getattr(frame.bodies, source)
            if name in _FIXED:
                fixed.setdefault(name, np.zeros(len(ids), values.dtype))[places] = values
            elif name not in fixed:
                whole = np.full((len(ids), *values.shape[1:]), _fill(values.dtype), values.dtype)
                whole[places] = values
                if row == 0:
                    packed = {"chunks": (1, *whole.shape), "shuffle": True, "compression": 1} if len(ids) else {}
                    data = writer.element(group, name).create_dataset("value", (len(writer.frames), *whole.shape), values.dtype,
                                                                      fillvalue=_fill(values.dtype), **packed)
                    writer.unit(data, fields[source].unit)
                group[f"{name}/value"][row] = whole
    for name, values in fixed.items():
        group[name] = values


def write_h5md(run: str | os.PathLike[str], output: str | os.PathLike[str], frames: Frames | None = None, copy: bool = False, units: bool = True) -> bool:
    """Writes frames as H5MD 1.1; returns whether each row is the same body in all of them.

    run     a run folder, or a Run
    output  NAME.h5md. Its values are windows on the frame files (HDF5 virtual datasets), which must stay where they are relative to it:
            of a file that is gone, HDF5 reads fill values (ids -1, numbers NaN), without an error
    frames  a part of them, `run.frames[10:20]`; None: all
    copy    True: all values are in the file, rows by ascending id; for programs that take the n-th row for the same body at all times,
            and to send it elsewhere
    units   False: leave out the units, for programs that do not know metres
    Raises InputError when a frame is missing or damaged; UsageError without a frame; MachineError when the file cannot be written.
    """
    from . import __version__

    run = run if isinstance(run, Run) else Run(run)
    chosen = run.frames if frames is None else frames
    if not len(chosen):
        raise UsageError(f"{run.folder}: there are no frames to write")
    target = os.path.abspath(output)
    partial = f"{target}.{os.getpid()}.part"
    stay = True
    try:
        with h5py.File(partial, "w", libver=("earliest", "v110")) as file:
            writer = _Writer(file, chosen, run.scene, units)
            writer.head(__version__)
            group = file.create_group("particles/trajectory")
            writer.steps_and_energies(group)
            if copy:
                _write_copy(writer, group)
            else:
                stay = _write_virtual(writer, group, os.path.dirname(target))
            writer.box(group)
            writer.names()
        os.replace(partial, target)
    except OSError as error:
        raise MachineError(f"{os.fspath(output)}: cannot be written: {error}") from error
    finally:
        if os.path.exists(partial):
            os.remove(partial)
    return stay
