"""Packings of spheres, from and to other programs: LAMMPS and LIGGGHTS (data files, dumps), Yade (lists of spheres), VTK (.vtp).

Readers and writers of the formats: packing_text.py, packing_vtp.py.
"""
from __future__ import annotations

import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from .case import Case
from .errors import InputError, MachineError, UsageError, unknown_name
from .packing_text import read_data, read_dump, read_yade, write_data, write_dump, write_yade
from .packing_vtp import read_vtp, write_vtp
from .rows import Bodies
from .scene import open_shapes
from .units import si

_WRITERS = {"lammps-data": write_data, "lammps-dump": write_dump, "yade": write_yade, "vtp": write_vtp}
_READERS = {"lammps-data": read_data, "lammps-dump": read_dump, "yade": read_yade, "vtp": read_vtp}
_ENDINGS = {".data": "lammps-data", ".lmp": "lammps-data", ".dump": "lammps-dump", ".lammpstrj": "lammps-dump", ".liggghts": "lammps-dump",
            ".txt": "yade", ".spheres": "yade", ".vtp": "vtp"}
_COLUMNS = {"id": 0, "kind": 0, "position": 3, "radius": 0, "velocity": 3, "angular_velocity": 3, "quaternion": 4, "density": 0}


class Packing:
    """Spheres of one moment, as arrays, for or from another program. All in SI units; what a format does not have is None.

        scree.Packing.of(run.bodies(-1)).write("bed.data")
        scree.Packing.read("bed.data").add_to(case, "ball", "glass")

    position          n x 3 [m]
    radius            n [m]
    id                n whole numbers
    kind              n whole numbers from 1: the type of LAMMPS; of bodies of a run the material, in the order of the case
    velocity          n x 3 [m/s]
    angular_velocity  n x 3 [rad/s]
    quaternion        n x 4, w x y z
    density           n [kg/m^3]
    lower, upper      corners of the domain, 3 [m] each
    periodic          whether each of the three axes is
    step, time        of the moment [-, s]
    """

    def __init__(self, position: Any, radius: Any, *, id: Any = None, kind: Any = None, velocity: Any = None, angular_velocity: Any = None,  # noqa: A002
                 quaternion: Any = None, density: Any = None, lower: Any = None, upper: Any = None, periodic: Any = (False, False, False),
                 step: int = 0, time: float = 0.0) -> None:
        """Arrays of one length; radius and density can be one for all. id: None: from 1 on; kind: None: 1. Raises UsageError."""
        self.position: np.ndarray = np.asarray(position, dtype=float).reshape(-1, 3)
        count = len(self.position)
        self.radius: np.ndarray = _column("radius", radius, count)
        self.id: np.ndarray = np.arange(1, count + 1) if id is None else _column("id", id, count, np.int64)
        self.kind: np.ndarray = np.ones(count, np.int64) if kind is None else _column("kind", kind, count, np.int64)
        self.velocity: np.ndarray | None = _column("velocity", velocity, count)
        self.angular_velocity: np.ndarray | None = _column("angular_velocity", angular_velocity, count)
        self.quaternion: np.ndarray | None = _column("quaternion", quaternion, count)
        self.density: np.ndarray | None = _column("density", density, count)
        self.lower: np.ndarray | None = None if lower is None else np.asarray(lower, dtype=float)
        self.upper: np.ndarray | None = None if upper is None else np.asarray(upper, dtype=float)
        self.periodic: tuple[bool, ...] = tuple(bool(p) for p in periodic)
        self.step: int = step
        self.time: float = time
        for name in ("position", "radius"):
            wrong = np.flatnonzero(~np.isfinite(getattr(self, name)).reshape(count, -1).all(axis=1)) if count else []
            if len(wrong):
                raise UsageError(f"packing: {name} of row {wrong[0]} is {getattr(self, name)[wrong[0]].tolist()}; finite numbers expected")
        wrong = np.flatnonzero(self.radius <= 0)
        if len(wrong):
            raise UsageError(f"packing: the radius of row {wrong[0]} is {self.radius[wrong[0]]:.6g} m; a radius above 0 expected")

    @classmethod
    def of(cls, bodies: Bodies) -> Packing:
        """The bodies of a frame, or a part of them, as spheres: `Packing.of(run.bodies(-1).particles())`.

        A body with a mesh is the sphere of equal volume at its centre of mass. kind is its material, counted from 1 in the order of the case.
        """
        scene = bodies._store.scene
        exact = np.array([s.sphere_radius or 0.5 * s.equivalent_diameter for s in scene.shapes.in_order])  # of a sphere to the last digit
        domain, cell = scene.settings.get("domain", {}), bodies._store.cell
        if cell and cell.is_sheared:
            raise UsageError("packing: the periodic cell of the frame is sheared, which formats of packings do not hold; take a frame without shear")
        bounded = domain.get("bounded", "min" in domain)
        lower, upper = (cell.lower, cell.upper) if cell else (domain["min"], domain["max"]) if bounded else (None, None)
        step, time = bodies._store.moment
        return cls(bodies.position, exact[bodies.shape] * bodies.scale, id=bodies.id, step=step, time=time, kind=bodies.material + 1, velocity=bodies.velocity,
                   angular_velocity=bodies.angular_velocity, quaternion=bodies.quaternion,
                   density=np.array([m.density for m in scene.materials.in_order])[bodies.material],
                   lower=lower, upper=upper, periodic=domain.get("periodic", (False,) * 3))

    @classmethod
    def read(cls, path: str | os.PathLike[str], format: str | None = None, unit: str = "m", radius: str | float | None = None,  # noqa: A002
             step: int | None = None) -> Packing:
        """Reads a packing.

        format  "lammps-data" (atom style sphere, or atomic with `radius`), "lammps-dump", "yade" or "vtp"; None: by the contents
        unit    of the lengths in the file: "mm", "cm"; velocities are per second in it
        radius  of all, for a file that has none
        step    which moment of a dump; None: the last
        Raises InputError with file and line.
        """
        source = os.fspath(path)
        kind = format or _kind_of(source)
        if kind not in _READERS:
            raise unknown_name("format", kind, _READERS)
        given = None if radius is None else np.array(si(radius, "m"))
        parts = _READERS[kind](source, given is None, step)
        factor = si(f"1 {unit}", "m")
        if given is not None:
            parts["radius"] = np.full(len(parts["position"]), given)
        if factor != 1:
            for name in {"position", "velocity", "lower", "upper"} | ({"radius"} if given is None else set()):
                if parts.get(name) is not None:
                    parts[name] = np.asarray(parts[name], dtype=float) * factor
        try:
            return cls(**parts)
        except UsageError as error:
            raise InputError(f"{source}: {error}") from None

    def write(self, path: str | os.PathLike[str], format: str | None = None) -> str:  # noqa: A002
        """Writes the packing, whole or not at all, and returns the path. All numbers have the digits that give the same double again.

        format  as of `read`; None: by the ending: .data .lmp (LAMMPS data), .dump .lammpstrj .liggghts (LAMMPS dump), .txt .spheres (Yade), .vtp
        """
        target = os.fspath(path)
        kind = format or _ENDINGS.get(os.path.splitext(target)[1].lower())
        if kind is None:
            raise UsageError(f"{target}: no format has this ending; give one of {', '.join(_WRITERS)}, or an ending of {', '.join(_ENDINGS)}")
        if kind not in _WRITERS:
            raise unknown_name("format", kind, _WRITERS)
        partial = f"{target}.{os.getpid()}.part"
        try:
            with open(partial, "w", encoding="utf-8", newline="\n") as file:
                _WRITERS[kind](file, self)
            os.replace(partial, target)
        except OSError as error:
            raise MachineError(f"{target}: cannot be written: {error.strerror}") from error
        finally:
            if os.path.exists(partial):
                os.remove(partial)
        return target

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of the domain; of a packing without one those of a box around all spheres [m]."""
        if self.lower is not None and self.upper is not None:
            return self.lower, self.upper
        if not len(self):
            return np.zeros(3), np.ones(3)
        return (self.position - self.radius[:, None]).min(axis=0), (self.position + self.radius[:, None]).max(axis=0)

    def add_to(self, case: Case, shape: str, material: str | Mapping[int, str], fixed: bool = False) -> None:
        """Adds the spheres to a case as bodies of `[[bodies]]`, in the order of their ids, with their velocities.

        shape     a shape of the case, scaled to the radius of each: a sphere, or a mesh, whose sphere of equal volume then has that radius
        material  for all, or of each kind, {1: "glass", 2: "steel"}
        Spheres of a bed at rest overlap a little: set `contact.relax` to true in the case, and pack parts them.
        Raises UnknownName for a shape or kind that has no entry.
        """
        one = _radius_of(case, shape)
        order = np.argsort(self.id, kind="stable")
        kinds = {k: material if isinstance(material, str) else material.get(k) for k in np.unique(self.kind).tolist()}
        missing = [k for k, name in kinds.items() if name is None]
        if missing:
            raise unknown_name("material of kind", missing[0], dict(material))  # type: ignore[arg-type]
        scale = self.radius / one
        case.add_bodies(shape, [kinds[k] for k in self.kind[order].tolist()], self.position[order],
                        quaternion=None if self.quaternion is None else self.quaternion[order],
                        velocity=None if self.velocity is None else self.velocity[order],
                        angular_velocity=None if self.angular_velocity is None else self.angular_velocity[order],
                        scale=None if np.all(scale == 1) else scale[order], fixed=fixed)

    def __len__(self) -> int:
        return len(self.position)

    def __repr__(self) -> str:
        if not len(self):
            return "<scree.Packing: no spheres>"
        if not len(self):
            return "<scree.Packing: no spheres>"
        return f"<scree.Packing: {len(self)} spheres, radius {self.radius.min():.4g} m to {self.radius.max():.4g} m, {len(np.unique(self.kind))} kinds>"


def _column(name: str, values: Any, count: int, dtype: Any = float) -> Any:
    if values is None:
        return None
    shape = (count, _COLUMNS[name]) if _COLUMNS[name] else (count,)
    array = np.asarray(values, dtype=dtype)
    if array.ndim == 0 and len(shape) == 1:
        array = np.full(shape, array)
    if array.shape != shape:
        raise UsageError(f"packing: {name} has the shape {array.shape}, {shape} expected")
    return array


def _kind_of(path: str) -> str:
    """The format of a file, by its contents."""
    try:
        with open(path, "rb") as file:
            start = file.read(4096)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    if start.lstrip().startswith(b"<"):
        return "vtp"
    if start.lstrip().startswith(b"ITEM:"):
        return "lammps-dump"
    lines = [line.split(b"#")[0].split() for line in start.splitlines()[1:]]
    return "lammps-data" if any(len(words) == 2 and words[1] == b"atoms" for words in lines) else "yade"


def _radius_of(case: Case, shape: str) -> float:
    """Radius of a shape of a case at scale 1, of a mesh that of the sphere of equal volume [m]."""
    shapes = case.data.get("shapes", {})
    if shape not in shapes:
        raise unknown_name("shape", shape, shapes)
    entry = shapes[shape]
    if "sphere" in entry:
        return si(entry["sphere"]["radius"], "m")
    if "file" not in entry:
        raise UsageError(f"shapes.{shape}: neither a sphere nor a file")
    found = open_shapes(os.path.join(os.path.dirname(case.path or ""), entry["file"]))
    solid = found[entry["name"]] if "name" in entry else found.in_order[0]
    if not solid.volume > 0 or not math.isfinite(solid.volume):
        raise InputError(f"{found.path}: shape '{solid.name}' is a surface without a volume; a solid is needed")
    return 0.5 * solid.equivalent_diameter
