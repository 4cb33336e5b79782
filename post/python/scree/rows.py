"""Rows of a frame: bodies, contacts and walls, each field read when it is first used (core/storage/RUN_FORMAT.md)."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numpy as np

from .attributes import ReadAttributes
from .chunks import read_array
from .errors import InputError, UnknownName, missing_package, unknown_name
from .hdf import expect_column, opened
from .meshes import rotate
from .regions import Cell, Periodicity, Region, region
from .scene import Scene
from .within import bodies_within

if TYPE_CHECKING:
    import h5py

_SUFFIXES = {3: "xyz", 4: "wxyz"}
_FIRST_COLUMN = {"VTKHDF": "VTKHDF/PointData/id", "VTKHDF/PointData": "VTKHDF/PointData/id", "contacts": "contacts/body_a", "walls": "walls/id"}
Self = TypeVar("Self", bound="Rows")


class Field:
    """A column of a frame: a descriptor that reads its array when it is used. `Bodies.velocity.unit` is "m/s"."""

    def __init__(self, dataset: str, unit: str, meaning: str) -> None:
        """dataset: its path in the frame file."""
        self.dataset: str = dataset
        self.unit: str = unit
        self.__doc__ = meaning + (f" [{unit}]" if unit != "-" else "")

    def __set_name__(self, owner: type, name: str) -> None:
        self.name: str = name

    @overload
    def __get__(self, rows: None, owner: type) -> Field: ...

    @overload
    def __get__(self, rows: Rows, owner: type) -> np.ndarray: ...

    def __get__(self, rows: Rows | None, owner: type) -> Any:
        return self if rows is None else rows._field(self.dataset)


class Store:
    """The arrays of one frame that were read so far, ordered; read-only, since all who use the frame share them."""

    def __init__(self, path: str, scene: Scene) -> None:
        self.path, self.scene = path, scene
        self.folder: Any = None  # what removes the file when nothing uses it any more, of a frame that is no file of a run
        self._arrays: dict[str, np.ndarray] = {}
        self._orders: dict[str, np.ndarray | None] = {}

    @cached_property
    def cell(self) -> Cell | None:
        """The periodic cell of the frame where it deforms."""
        with opened(self.path, "scree-frame", 1) as file:
            if "cell" not in file:
                return None
            names = ("lower", "upper", "rate", "normal_stress", "shear_stress", "shear", "shear_rate")
            cell = file["cell"]   # the shears were added later
            values = [np.zeros((1, 3)) if name in ("shear", "shear_rate") and name not in cell else read_array(self.path, cell[name]) for name in names]
        if any(v.shape != (1, 3) or not np.all(np.isfinite(v)) for v in values):
            raise InputError(f"{self.path}: cell: one row of three numbers expected in each column; the file is damaged")
        return Cell(*(v[0] for v in values), periodic=self.scene.settings.get("domain", {}).get("periodic", (True,) * 3))

    @cached_property
    def moment(self) -> tuple[int, float]:
        """Step and time [s] of the frame."""
        with opened(self.path, "scree-frame", 1) as file:
            return int(file["frame"].attrs["step"]), float(file["frame"].attrs["time"])

    @property
    def periodicity(self) -> Periodicity:
        """Periodic axes at the time of the frame."""
        return self.cell or self.scene.periodicity

    def get(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            with opened(self.path, "scree-frame", 1) as file:
                order = self._order(file, name)
                self._keep(name, self._checked(name, self._read(file, name)), order)
        return self._arrays[name]

    def _checked(self, name: str, values: np.ndarray) -> np.ndarray:
        """Refuses numbers that are none, rows that are too few, and ids and indices of what the scene does not have."""
        expect_column(self.path, name, values)
        group, _, column = name.rpartition("/")
        first = _FIRST_COLUMN.get(group)
        if first is not None and name != first and len(values) != len(self.get(first)):
            raise InputError(f"{self.path}: {name}: {len(values)} rows found, {len(self.get(first))} expected; the file is damaged")
        known = {"shape": self.scene.shapes, "material": self.scene.materials}.get(column) if group == "VTKHDF/PointData" else None
        if known is not None and len(values):
            if not 0 <= values.min() <= values.max() < len(known.in_order):
                raise InputError(f"{self.path}: a body has a {column} that the scene does not have; frame and scene.h5 do not belong together, or the frame is damaged")
        if name == "walls/id":
            missing = set(values.tolist()) - {wall.id for wall in self.scene.walls.in_order}
            if missing:
                raise InputError(f"{self.path}: its walls name wall {min(missing)}, which the scene does not have; "
                                 "frame and scene.h5 do not belong together, or the frame is damaged")
        return values

    def _read(self, file: h5py.File, name: str) -> np.ndarray:
        return read_array(self.path, file[name])

    def _keep(self, name: str, values: np.ndarray, order: np.ndarray | None) -> None:
        if order is not None:
            values = values[order]
        if name == "contacts/point" and self.periodicity.any:
            values = self.periodicity.wrap(values)  # a contact across a periodic side is written where one of the two sees it
        values.flags.writeable = False
        self._arrays[name] = values

    def _order(self, file: h5py.File, name: str) -> np.ndarray | None:
        """Rows in ascending order of id or of (a, b, feature); None when the file has them so."""
        group = name.partition("/")[0]
        if group not in self._orders:
            if group == "VTKHDF":
                names = ["VTKHDF/PointData/id"]
            elif group == "contacts":
                names = [f"contacts/{key}" for key in ("feature", "body_b", "body_a")]
            else:
                names = []
            keys = [expect_column(self.path, key, self._read(file, key)) for key in names]
            order = np.lexsort(keys) if keys else None
            if order is not None and np.array_equal(order, np.arange(len(order))):
                order = None
            self._orders[group] = order
            for key, values in zip(names, keys):
                self._keep(key, values, order)
        return self._orders[group]


class Rows(ReadAttributes):
    """Rows of a frame: arrays by field. A mask, a slice or row numbers in brackets give a part of the same kind.

    The arrays are read-only, since all that use a frame share them; `.copy()` gives one of your own.
    """

    def __init__(self, store: Store, chosen: np.ndarray | None = None) -> None:
        """Made by a frame."""
        self._store = store
        self._chosen = chosen

    def _field(self, dataset: str) -> np.ndarray:
        values = self._store.get(dataset)
        return values if self._chosen is None else values[self._chosen]

    @classmethod
    def fields(cls) -> dict[str, Field]:
        """The fields by name; each has `unit` and, as its `__doc__`, its meaning."""
        return {name: field for base in reversed(cls.__mro__) for name, field in vars(base).items() if isinstance(field, Field)}

    def _of_some_scenes(self) -> dict[str, str]:
        """Properties that this scene has besides the fields, with their units."""
        return {}

    def _length_field(self) -> str:
        return next(iter(self.fields()))

    def __len__(self) -> int:
        return len(getattr(self, self._length_field()))

    def __getitem__(self: Self, chosen: Any) -> Self:
        rows = np.arange(len(self)) if self._chosen is None else self._chosen
        return type(self)(self._store, np.atleast_1d(rows[chosen]))

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a column for each field and component (`position_x`, `quaternion_w`); units in `attrs["units"]`.

        Raises MissingPackage without pandas.
        """
        try:
            import pandas
        except ImportError:
            raise missing_package("to_pandas", "pandas") from None
        columns: dict[str, np.ndarray] = {}
        units: dict[str, str] = {}
        fields = {**{name: field.unit for name, field in self.fields().items()}, **self._of_some_scenes()}
        for name, unit in fields.items():
            values = getattr(self, name)
            parts = [(name, values)] if values.ndim == 1 else [(f"{name}_{c}", values[:, k]) for k, c in enumerate(_SUFFIXES[values.shape[1]])]
            for column, part in parts:
                columns[column], units[column] = np.array(part), unit
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = units
        return frame

    def __repr__(self) -> str:
        return f"<scree.{type(self).__name__}: {len(self)} rows; {', '.join(self.fields())}>"


class Bodies(Rows):
    """Bodies of a frame, by ascending id."""

    id = Field("VTKHDF/PointData/id", "-", "id of each body: unique, walls included, never reused; n")
    position = Field("VTKHDF/Points", "m", "centre of mass, world; n x 3")
    quaternion = Field("VTKHDF/PointData/quat", "-", "unit quaternion w x y z: turns the axes of the shape's mesh to the world; n x 4")
    velocity = Field("VTKHDF/PointData/velocity", "m/s", "of the centre of mass, world; n x 3")
    angular_velocity = Field("VTKHDF/PointData/angular_velocity", "rad/s", "about world axes; n x 3")
    shape = Field("VTKHDF/PointData/shape", "-", "index of the shape; names with shape_name; n")
    material = Field("VTKHDF/PointData/material", "-", "index of the material; names with material_name; n")
    scale = Field("VTKHDF/PointData/scale", "-", "factor on the size of the shape; n")
    rank = Field("VTKHDF/PointData/rank", "-", "MPI rank that owned the body; n")

    @property
    def temperature(self) -> np.ndarray:
        """Temperature of each body; n [K]. Raises InputError in a scene without heat."""
        if not self._store.scene.has_heat:
            raise InputError(f"{self._store.path}: the scene has no heat; add a table [heat] to the case and run it again")
        return self._field("VTKHDF/PointData/temperature")

    def _of_some_scenes(self) -> dict[str, str]:
        return {"temperature": "K"} if self._store.scene.has_heat else {}

    def _of_shape(self, values: Sequence[float]) -> np.ndarray:
        return np.asarray(values, dtype=float)[self.shape]

    @property
    def shape_name(self) -> np.ndarray:
        """Name of the shape of each body; n texts."""
        return np.array([s.name for s in self._store.scene.shapes.in_order], dtype=object)[self.shape]

    @property
    def material_name(self) -> np.ndarray:
        """Name of the material of each body; n texts."""
        return np.array([m.name for m in self._store.scene.materials.in_order], dtype=object)[self.material]

    @property
    def volume(self) -> np.ndarray:
        """Volume of each body; n [m^3]."""
        return self._of_shape([s.volume for s in self._store.scene.shapes.in_order]) * self.scale * self.scale * self.scale

    @property
    def mass(self) -> np.ndarray:
        """Mass of each body; n [kg]."""
        return self.volume * np.array([m.density for m in self._store.scene.materials.in_order])[self.material]

    @property
    def diameter(self) -> np.ndarray:
        """Diameter of the sphere of equal volume of each body; n [m]."""
        return self._of_shape([s.equivalent_diameter for s in self._store.scene.shapes.in_order]) * self.scale

    @property
    def kinetic_energy(self) -> np.ndarray:
        """Kinetic energy of each body, translation and rotation; n [J]."""
        inertia = np.array([s.inertia for s in self._store.scene.shapes.in_order])[self.shape]
        density = np.array([m.density for m in self._store.scene.materials.in_order])[self.material]
        spin = rotate(self.quaternion * [1, -1, -1, -1], self.angular_velocity)
        rotation = density * self.scale**5 * np.einsum("ni,nij,nj->n", spin, inertia, spin)
        return 0.5 * (self.mass * np.einsum("ni,ni->n", self.velocity, self.velocity) + rotation)

    @property
    def is_particle(self) -> np.ndarray:
        """Whether each body is a particle: free to move, and no apparatus such as a lid (`Scene.boundary_ids`); n booleans."""
        return ~np.isin(self.id, self._store.scene.boundary_ids)

    def row(self, body_id: int) -> int:
        """Row of a body by its id. Raises UnknownName when it is not in the frame (a wall, or it was removed)."""
        found = np.flatnonzero(self.id == body_id)
        if not len(found):
            raise UnknownName(f"body {body_id}: not among these {len(self)} bodies; it may be a wall, it has left, or it has not come in yet")
        return int(found[0])

    def in_region(self, part: Region | str) -> Bodies:
        """The bodies whose centre lies in a region (`scree.Box` ..., or a text as for scree-post: "sphere:0,0,1 cm,5 mm").

        The rule is that of scree-post. In a periodic domain a region can extend beyond a side: it then contains images of bodies.
        """
        return self[self._store.periodicity.contained(region(part), self.position)]

    def within(self, place: Region | str) -> Bodies:
        """The bodies that have not left a wall, by its name, or a region, as `--within` of scree-post: what is in front of a plane; with its
        centre inside a box, cylinder or sphere; in the box around a mesh, or above that. Raises UsageError for what is neither.
        """
        return self[bodies_within(self._store, self.position, place)]

    def of_shape(self, name: str) -> Bodies:
        """The bodies of a shape by its name. Raises UnknownName."""
        return self[np.isin(self.shape, self._store.scene.shapes.indices(name))]

    def of_material(self, name: str) -> Bodies:
        """The bodies of a material by its name. Raises UnknownName."""
        return self[np.isin(self.material, self._store.scene.materials.indices(name))]

    def particles(self) -> Bodies:
        """The bodies that are particles (`is_particle`)."""
        return self[self.is_particle]


class Contacts(Rows):
    """Contact points of a frame, by (body_a, body_b, feature). Two meshes can touch at several points."""

    body_a = Field("contacts/body_a", "-", "the smaller id of the two; bodies and walls have different ids, and a wall may be either; c")
    body_b = Field("contacts/body_b", "-", "the larger id of the two; c")
    feature = Field("contacts/feature", "-", "key of the contact point within its pair; c")
    point = Field("contacts/point", "m", "contact point, world, in a periodic domain moved into it; c x 3")
    normal = Field("contacts/normal", "-", "unit vector from b to a; c x 3")
    overlap = Field("contacts/depth", "m", "overlap: sum of margins minus gap; c")
    margin = Field("contacts/margin", "m", "sum of the two margins; c")
    normal_force = Field("contacts/normal_force", "N", "on a, along the normal; c")
    tangential_force = Field("contacts/tangential_force", "N", "on a; c x 3")

    @property
    def force(self) -> np.ndarray:
        """Force on a: normal and tangential; c x 3 [N]."""
        return self.normal_force[:, None] * self.normal + self.tangential_force

    def in_region(self, part: Region | str) -> Contacts:
        """The contacts whose contact point lies in a region, with the rule of `Bodies.in_region`."""
        return self[self._store.periodicity.contained(region(part), self.point)]

    def of(self, bodies: Bodies) -> Contacts:
        """The contacts between two of the bodies, or between one of them and a wall or fixed body."""
        a, b = np.isin(self.body_a, bodies.id), np.isin(self.body_b, bodies.id)
        boundary = self._store.scene.boundary_ids
        return self[(a & b) | (a & np.isin(self.body_b, boundary)) | (b & np.isin(self.body_a, boundary))]


class Walls(Rows):
    """Walls in a frame: where they are, and their loads."""

    id = Field("walls/id", "-", "as in the scene; w")
    position = Field("walls/position", "m", "world = position + rotate(quaternion, point in the frame of the wall); w x 3")
    quaternion = Field("walls/orientation", "-", "unit quaternion w x y z; w x 4")
    force = Field("walls/force", "N", "on the wall; w x 3")
    torque = Field("walls/torque", "N m", "on the wall, about the world's origin; w x 3")

    @property
    def name(self) -> list[str]:
        """Names of the walls, as in the case, or kind and number."""
        names = {wall.id: wall.name for wall in self._store.scene.walls.in_order}
        return [names.get(int(i), str(i)) for i in self.id]

    def row(self, wall: str | int) -> int:
        """Row of a wall by its name or id: `walls.force[walls.row("lid")]`. Raises UnknownName."""
        known: list[Any] = self.name if isinstance(wall, str) else self.id.tolist()
        if wall not in known:
            raise unknown_name("wall", wall, known)
        return known.index(wall)
