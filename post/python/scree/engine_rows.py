"""Bodies and contacts of an engine: rows whose fields are read from the library when they are first used."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from .engine_library import copied, error_text, loaded_library
from .errors import UnknownName, UsageError, unknown_name
from .rows import Field, Rows

if TYPE_CHECKING:
    from .engine_calls import EngineCalls

WIDTHS = {name: 3 for name in ("position", "velocity", "angular_velocity", "force", "torque", "point", "normal", "tangential_force")} | {"quaternion": 4}
INTEGERS = {"id", "shape", "material", "fixed", "asleep", "body_a", "body_b", "feature"}


class Store(Protocol):
    count: int
    names: dict[str, np.ndarray]

    def get(self, name: str) -> np.ndarray: ...


class Moment:
    """Fields of the bodies of this rank at one moment, read when first used; none is read of a later moment."""

    def __init__(self, engine: EngineCalls) -> None:
        self._engine, self._moves, self._arrays = engine, engine._moves, {}  # type: ignore[var-annotated]
        self.count = int(engine._fact("body_count"))
        self.names = engine._names

    def get(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            engine = self._engine
            engine._enter(f"bodies.{name}")
            try:
                if self._moves != engine._moves:
                    raise UsageError(f"bodies.{name}: the engine has moved on since these bodies were taken, and this field had not been read; "
                                     f"take engine.bodies again, or read it in time with engine.bodies.read({name!r})")
                self._arrays[name] = field_of(engine._handle, name, self.count)
            finally:
                engine._busy.release()
        return self._arrays[name]


class WithinStep:
    """Fields of the bodies of this rank while a function of forces is called."""

    def __init__(self, handle: int, count: int, names: dict[str, np.ndarray]) -> None:
        self._handle, self.count, self.names = handle, count, names
        self._arrays: dict[str, np.ndarray] = {}
        self.is_over = False

    def get(self, name: str) -> np.ndarray:
        if self.is_over:
            raise UsageError(f"bodies.{name}: the bodies of a force function end with its call; keep copies of fields, or use engine.bodies after the step")
        if name not in self._arrays:
            self._arrays[name] = field_of(self._handle, name, self.count)
        return self._arrays[name]


def field_of(handle: int | None, name: str, count: int) -> np.ndarray:
    library = loaded_library()
    if name in INTEGERS:
        address, kind = library.scree_integers(handle, name.encode()), np.int64
    else:
        address, kind = library.scree_reals(handle, name.encode()), float
    if address is None:
        raise UsageError(f"bodies.{name}: {error_text().removeprefix('bodies: ')}")
    return copied(address, count, WIDTHS.get(name, 1), kind)


class EngineBodies(Rows):
    """Bodies that this rank owns, in any order: a body is known by its `id`. A mask, a slice or row numbers in brackets give a part.

    A field is read when it is first used. `engine.bodies` are those of one moment: what was read stays readable, and a field that is first read after the
    engine has moved on is a UsageError. The arrays are read-only copies.
    """

    id = Field("id", "-", "id of each body: unique, never reused; n")
    position = Field("position", "m", "centre of mass, world; n x 3")
    quaternion = Field("quaternion", "-", "unit quaternion w x y z: turns the axes of the shape's mesh to the world; n x 4")
    velocity = Field("velocity", "m/s", "of the centre of mass, world; n x 3")
    angular_velocity = Field("angular_velocity", "rad/s", "about world axes; n x 3")
    force = Field("force", "N", "sum of all forces in the last step, those from outside included; n x 3")
    torque = Field("torque", "N m", "the same, about the centre of mass; n x 3")
    mass = Field("mass", "kg", "of each body; n")
    volume = Field("volume", "m^3", "of each body; n")
    diameter = Field("diameter", "m", "of the sphere of equal volume; n")
    radius = Field("radius", "m", "distance of the farthest point from the centre of mass; n")
    shape = Field("shape", "-", "index of the shape; names with shape_name; n")
    material = Field("material", "-", "index of the material; names with material_name; n")
    scale = Field("scale", "-", "factor on the size of the shape; n")
    fixed = Field("fixed", "-", "1: never moves; n")
    asleep = Field("asleep", "-", "1: at rest, and not computed until it is disturbed; n")

    _store: Any

    def __init__(self, store: Store, chosen: np.ndarray | None = None) -> None:
        """Made by an engine, for each call of a force function."""
        of_mine = self.__dict__
        of_mine["_store"], of_mine["_chosen"] = store, chosen

    @property
    def temperature(self) -> np.ndarray:
        """Temperature of each body; n [K]. Raises UsageError in a scene without heat."""
        return self._field("temperature")

    def _of_some_scenes(self) -> dict[str, str]:
        try:
            self._field("temperature")
        except UsageError:
            return {}
        return {"temperature": "K"}

    @property
    def shape_name(self) -> np.ndarray:
        """Name of the shape of each body; n texts."""
        return self._store.names["shape"][self.shape]

    @property
    def material_name(self) -> np.ndarray:
        """Name of the material of each body; n texts."""
        return self._store.names["material"][self.material]

    def read(self, *fields: str) -> EngineBodies:
        """Reads these fields at once, or without names all, so that they can be used after the engine has moved on. Returns the same bodies."""
        for name in fields or self.fields():
            if name not in self.fields() and name != "temperature":
                raise unknown_name("field of bodies", name, [*self.fields(), "temperature"])
            self._store.get(name)
        return self

    def row(self, body_id: int) -> int:
        """Row of a body by its id. Raises UnknownName when this rank does not own it."""
        found = np.flatnonzero(self.id == body_id)
        if not len(found):
            raise UnknownName(f"body {body_id}: not among these {len(self)} bodies; another rank owns it, it has left, or it is a wall")
        return int(found[0])

    def __len__(self) -> int:
        return self._store.count if self._chosen is None else len(self._chosen)


class EngineContacts(Rows):
    """Contact points that this rank counts, of the whole scene each once. The arrays are read-only copies."""

    body_a = Field("body_a", "-", "id of the first body, the smaller id; c")
    body_b = Field("body_b", "-", "id of the second body or wall; c")
    feature = Field("feature", "-", "key of the contact point within its pair; c")
    point = Field("point", "m", "contact point, world; c x 3")
    normal = Field("normal", "-", "unit vector from b to a; c x 3")
    overlap = Field("overlap", "m", "sum of margins minus gap; c")
    margin = Field("margin", "m", "sum of the two margins; c")
    normal_force = Field("normal_force", "N", "on a, along the normal; c")
    tangential_force = Field("tangential_force", "N", "on a; c x 3")

    @property
    def force(self) -> np.ndarray:
        """Force on a: normal and tangential; c x 3 [N]."""
        return self.normal_force[:, None] * self.normal + self.tangential_force
