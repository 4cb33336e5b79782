"""Scenes and shapes: what a run was made from (core/storage/SCENE_FORMAT.md, SHAPE_FORMAT.md)."""
from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

import h5py
import numpy as np

from .case import Case
from .errors import InputError, UsageError, unknown_name
from .hdf import expect_column, json_of, opened, text_of
from .meshes import Mesh, box_mesh, cylinder_mesh, icosphere
from .regions import Periodicity
from .settings import expect_provenance, expect_settings
from .tables import Table

_APPARATUS_SIZE = 5.0  # as post/run/apparatus.hpp
_START = ("id", "shape", "material", "scale", "position", "orientation", "velocity", "angular_velocity", "fixed", "population")
_KINDS = ("solid", "surface", "sphere")

Item = TypeVar("Item")


class Named(Mapping[str, Item], Generic[Item]):
    """Things by name. Of several with one name, such as two walls, the name means the first; `in_order` has all."""

    def __init__(self, kind: str, items: list[Item]) -> None:
        """kind: word for messages; items: with an attribute `name`."""
        self._kind = kind
        self.in_order: tuple[Item, ...] = tuple(items)  #: all, as frames and scenes count them
        self._names: list[str] = [item.name for item in items]  # type: ignore[attr-defined]

    def by_index(self, index: int) -> Item:
        """The thing that an index in a frame or scene means. Raises IndexError, for a negative one too."""
        if index < 0:
            raise IndexError(f"{self._kind} {index}: counted from 0")
        return self.in_order[index]

    def indices(self, name: str) -> list[int]:
        """The indices by which frames and scenes mean a name. Raises UnknownName."""
        found = [index for index, known in enumerate(self._names) if known == name]
        if not found:
            raise unknown_name(self._kind, name, self)
        return found

    def __getitem__(self, name: str) -> Item:
        return self.in_order[self.indices(name)[0]]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(self._names))

    def __len__(self) -> int:
        return len(set(self._names))

    def __repr__(self) -> str:
        return f"<scree.{type(self).__name__}: {', '.join(self) or 'none'}>"


class Shape:
    """A shape of scale 1.

    name           of the shape
    kind           "solid" (closed mesh with mass), "surface" (a wall, no mass) or "sphere" (exact, without triangles)
    vertices       V x 3 [m]; of a solid about its centre of mass
    triangles      T x 3 indices, counter-clockwise seen from outside; none for a sphere
    sphere_radius  [m]; 0 for a mesh
    volume         [m^3]; 0 for a surface
    area           [m^2]
    inertia        3 x 3 [m^5]: at density 1, about the centre of mass, in the axes of `vertices`; times the density for kg m^2
    origin_shift   3 [m]: coordinates of the mesh file are `vertices + origin_shift`
    """

    def __init__(self, group: h5py.Group) -> None:
        """group: of a shape in a file."""
        self.name: str = text_of(group.attrs["name"])
        self.kind: str = _KINDS[int(group.attrs["kind"])]
        self.sphere_radius: float = float(group.attrs["sphere_radius"])
        self.volume: float = float(group.attrs["volume"])
        self.area: float = float(group.attrs["area"])
        self.vertices: np.ndarray = group["vertices"][()].reshape(-1, 3)
        self.triangles: np.ndarray = group["triangles"][()].reshape(-1, 3)
        if self.triangles.size and (self.triangles.dtype.kind not in "iu" or not 0 <= self.triangles.min() <= self.triangles.max() < len(self.vertices)):
            raise InputError(f"{group.file.filename}: shape '{self.name}': a triangle of a vertex that it does not have; the file is damaged")
        self.inertia: np.ndarray = group["inertia"][()].reshape(3, 3)
        self.origin_shift: np.ndarray = group["origin_shift"][()].reshape(3)

    @property
    def equivalent_diameter(self) -> float:
        """Diameter of the ball of equal volume [m]; 0 for a surface."""
        return float(np.cbrt(6 * self.volume / np.pi))

    @cached_property
    def bounding_radius(self) -> float:
        """Distance of the farthest point from the origin [m]."""
        return float(np.sqrt((self.vertices**2).sum(axis=1).max(initial=0))) + self.sphere_radius

    @cached_property
    def mesh(self) -> Mesh:
        """The surface as a Mesh; of a sphere 320 triangles inscribed in it."""
        if self.kind == "sphere":
            ball = icosphere()
            return Mesh(self.sphere_radius * ball.vertices, ball.triangles)
        return Mesh(self.vertices, self.triangles)

    def __repr__(self) -> str:
        if self.kind == "sphere":
            return f"<scree.Shape '{self.name}': sphere, radius {self.sphere_radius:.4g} m>"
        size = f", equivalent diameter {self.equivalent_diameter:.4g} m" if self.volume else ""
        return f"<scree.Shape '{self.name}': {self.kind}, {len(self.triangles)} triangles{size}>"


@dataclass(frozen=True)
class Material:
    """A material."""

    name: str  #: by which cases mean it
    density: float  #: [kg/m^3]
    young: float  #: Young's modulus [Pa]; 0 when not given
    poisson: float  #: Poisson's ratio
    heat_capacity: float = 0.0  #: [J/(kg K)] of scenes with heat; 0 when not given
    conductivity: float = 0.0  #: for heat [W/(m K)], the same
    real_young: float = 0.0  #: Young's modulus of the real material [Pa], the same


class Wall:
    """A wall of a scene.

    id        by which contacts and frames mean it
    name      given in the case, or kind and number
    kind      "plane", "box_inside", "cylinder_inside", "sphere_inside" or "mesh"
    material  name of its material
    facts     what else the scene says about it, as in SCENE_FORMAT.md: `point`, `normal`, `lower`, `upper`, `radius`, `motion` ... SI
    """

    def __init__(self, facts: dict[str, Any], materials: Named[Material], shapes: Shapes) -> None:
        """facts: of the wall in the scene's settings."""
        self.id: int = int(facts["id"])
        self.name: str = facts["name"]
        self.kind: str = facts["kind"]
        self.material: str = materials.by_index(facts["material"]).name
        self.facts: dict[str, Any] = facts
        self._shape = shapes.by_index(facts["shape"]) if self.kind == "mesh" else None

    @cached_property
    def mesh(self) -> Mesh:
        """Its surface in its own frame; `frame.wall_mesh(name)` gives it in the world.

        Boxes, cylinders and spheres that are inside out are turned inward; curved ones are drawn with triangles.
        Raises UsageError for a plane, which has no end.
        """
        f = self.facts
        if self._shape is not None:
            return Mesh(f["scale"] * self._shape.vertices, self._shape.triangles)
        if self.kind == "box_inside":
            mesh = box_mesh(f["lower"], f["upper"])
        elif self.kind == "cylinder_inside":
            mesh = cylinder_mesh(f["axis_start"], f["axis_end"], f["radius"])
        elif self.kind == "sphere_inside":
            mesh = icosphere(3).placed(f["point"], scale=f["radius"])
        else:
            raise UsageError(f"wall '{self.name}': a plane has no end, and so no mesh; its point and normal are in `facts`")
        return Mesh(mesh.vertices, mesh.triangles[:, ::-1])

    def worn_mesh(self, vertices: np.ndarray) -> Mesh:
        """Its surface with other vertices: V x 3 as a frame has them, axes and scale of its shape; without any, `mesh`."""
        if self._shape is None or not len(vertices):
            return self.mesh
        if len(vertices) != len(self._shape.vertices):
            raise InputError(f"wall '{self.name}': {len(vertices)} worn vertices found, {len(self._shape.vertices)} expected; the frame is damaged")
        return Mesh(self.facts["scale"] * vertices, self._shape.triangles)

    def __repr__(self) -> str:
        return f"<scree.Wall {self.id} '{self.name}': {self.kind} of {self.material}>"


class Shapes(Named[Shape]):
    """Shapes by name, from a shape file or a scene."""

    def __init__(self, items: list[Shape], path: str = "", provenance: dict[str, Any] | None = None) -> None:
        """items: in the order of the file."""
        super().__init__("shape", items)
        self.path: str = path  #: file they were read from
        self.provenance: dict[str, Any] = provenance or {}  #: who made the file, from what: tool, command, inputs, git, time

    def __fspath__(self) -> str:
        return self.path


def _shapes_in(group: h5py.Group) -> list[Shape]:
    # by number: shape_10000 comes after shape_9999
    return [Shape(group[name]) for name in sorted(group, key=lambda n: int(n.rpartition("_")[2]))]


def open_shapes(path: str | os.PathLike[str]) -> Shapes:
    """The shapes of a NAME.shape.h5 by name. Raises InputError when it is missing, damaged or newer."""
    source = os.fspath(path)
    with opened(source, "scree-shape", 1) as file:
        return Shapes(_shapes_in(file["shapes"]), source, json_of(file["provenance"]))


class Scene:
    """A scene: shapes, materials, pairs, walls, settings, and the bodies at the start."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """path: NAME.scene.h5. Raises InputError when it is missing, damaged or newer."""
        self.path: str = os.fspath(path)  #: file it was read from
        with opened(self.path, "scree-scene", 4) as file:
            facts = json_of(file["settings"])
            expect_settings(facts)
            self.provenance: dict[str, Any] = json_of(file["provenance"])  #: who made it, from what: tool, command, case, inputs, git, time
            expect_provenance(self.provenance)
            self.shapes: Shapes = Shapes(_shapes_in(file["shapes"]), self.path, self.provenance)  #: by name
            #: columns of the bodies at the start, as in SCENE_FORMAT.md: id, shape, material, scale, position, orientation, velocity ...
            self.start: dict[str, np.ndarray] = {
                name: expect_column(self.path, f"bodies/{name}", data[()]) for name, data in file["bodies"].items()}
            self.settings: dict[str, Any] = facts["settings"]  #: as in SCENE_FORMAT.md, SI
            known = ("name", "density", "young", "poisson", "heat_capacity", "conductivity", "real_young")
            self.materials: Named[Material] = Named("material", [Material(*(m.get(k, 0.0) for k in known)) for m in facts["materials"]])  #: by name
            #: contact of each two materials that can meet: `between` (two names) and the values of SCENE_FORMAT.md, SI
            self.pairs: list[dict[str, Any]] = [
                {"between": tuple(self.materials.by_index(p[k]).name for k in "ab"), **{k: v for k, v in p.items() if k not in "ab"}} for p in facts["pairs"]]
            self.walls: Named[Wall] = Named("wall", [Wall(w, self.materials, self.shapes) for w in facts["walls"]])  #: by name
            missing = [name for name in _START if name not in self.start]
            if missing:
                raise InputError(f"{self.path}: no column bodies/{missing[0]}; the file is damaged")
            for column, values in self.start.items():
                if len(values) != len(self.start["id"]):
                    raise InputError(f"{self.path}: bodies/{column}: {len(values)} rows found, {len(self.start['id'])} expected; the file is damaged")
            for column, of in (("shape", self.shapes), ("material", self.materials)):
                if len(self.start["id"]) and not 0 <= self.start[column].min() <= self.start[column].max() < len(of.in_order):
                    raise InputError(f"{self.path}: a body has {column} {self.start[column].max()}, but there are {len(of.in_order)} {column}s")

    def pair(self, a: str, b: str) -> dict[str, Any]:
        """The contact of two materials in either order: stiffness [N/m], restitution, friction ... Raises UnknownName."""
        for pair in self.pairs:
            if pair["between"] in ((a, b), (b, a)):
                return pair
        raise unknown_name("pair", f"{a}, {b}", [", ".join(p["between"]) for p in self.pairs])

    @property
    def has_heat(self) -> bool:
        """Whether bodies have temperatures."""
        return "heat" in self.settings

    @property
    def case(self) -> Case:
        """The case that it was packed from, with what `--set` changed."""
        inputs = self.provenance.get("inputs") or [{}]
        return Case.from_text(self.provenance.get("configuration", ""), inputs[0].get("path", "case.toml"))

    @cached_property
    def periodicity(self) -> Periodicity:
        """Periodic axes of the domain."""
        domain = self.settings.get("domain", {})
        if not any(domain.get("periodic", [])):
            return Periodicity([0, 0, 0], [0, 0, 0])
        period = np.where(domain["periodic"], np.subtract(domain["max"], domain["min"]), 0)
        return Periodicity(domain["min"], period, domain.get("shear", (0, 0, 0)))

    @cached_property
    def boundary_ids(self) -> np.ndarray:
        """Ids that are no particles, as in scree-post: walls, fixed bodies, and apparatus.

        Apparatus is a body of [[bodies]] at least five times as large as the median body of the populations, such as a lid; where there
        are no populations, than the median body of those that came in (inserted.csv beside the scene).
        """
        b = self.start
        radius = np.array([shape.bounding_radius for shape in self.shapes.in_order] or [0.0])
        size = b["scale"] * radius[b["shape"]]
        boundary = b["fixed"] != 0
        poured = np.sort(size[(b["population"] >= 0) & ~boundary])
        if not len(poured):
            poured = np.sort(self._sizes_that_came_in())
        if len(poured):
            boundary = boundary | ((b["population"] < 0) & (size >= _APPARATUS_SIZE * poured[len(poured) // 2]))
        return np.sort(np.concatenate([[wall.id for wall in self.walls.in_order], b["id"][boundary]]).astype(np.int64))

    def _sizes_that_came_in(self) -> np.ndarray:
        """Bounding radii of the bodies that came in through inlets [m]."""
        path = os.path.join(os.path.dirname(self.path), "inserted.csv")
        if not os.path.exists(path):
            return np.zeros(0)
        table = Table.read(path)
        ratio = {shape.name: shape.bounding_radius / shape.equivalent_diameter for shape in self.shapes.in_order if shape.volume}
        return table["diameter"] * np.array([ratio.get(str(name), 0.0) for name in table["shape"]])

    def __fspath__(self) -> str:
        return self.path

    def __repr__(self) -> str:
        return f"<scree.Scene '{self.path}': {len(self.start['id'])} bodies, {len(self.shapes.in_order)} shapes, {len(self.walls.in_order)} walls>"


def open_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a NAME.scene.h5. Raises InputError when it is missing, damaged or newer."""
    return Scene(path)
