"""Triangle meshes and rotations."""
from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .errors import missing_package


def rotate(quaternion: Any, vectors: Any) -> np.ndarray:
    """Vectors turned by unit quaternions w x y z. Shapes (n x 4 or 4) and (n x 3 or 3) are broadcast."""
    q, v = np.asarray(quaternion, dtype=float), np.asarray(vectors, dtype=float)
    w, u = q[..., :1], q[..., 1:]
    t = 2 * np.cross(u, v)
    return v + w * t + np.cross(u, t)


def rotation_matrix(quaternion: Any) -> np.ndarray:
    """Rotation matrices (n x 3 x 3 or 3 x 3) of unit quaternions w x y z: `matrix @ v` is `rotate(quaternion, v)`."""
    q = np.asarray(quaternion, dtype=float)
    return np.stack([rotate(q, axis) for axis in np.eye(3)], axis=-1)


class Mesh:
    """Triangles in space.

    vertices   V x 3 [m]
    triangles  T x 3 vertex indices from 0, counter-clockwise seen from outside
    body       T ids: of which body each triangle is; None for a mesh of one thing
    """

    def __init__(self, vertices: Any, triangles: Any, body: Any = None) -> None:
        """vertices: V x 3 [m]; triangles: T x 3 indices; body: T ids or None."""
        self.vertices: np.ndarray = np.asarray(vertices, dtype=float).reshape(-1, 3)
        self.triangles: np.ndarray = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
        self.body: np.ndarray | None = None if body is None else np.asarray(body, dtype=np.int64)

    def placed(self, position: ArrayLike, quaternion: ArrayLike = (1, 0, 0, 0), scale: float = 1.0) -> Mesh:
        """The mesh scaled, turned by a quaternion w x y z, then moved [m]."""
        return Mesh(np.asarray(position) + scale * rotate(quaternion, self.vertices), self.triangles, self.body)

    @staticmethod
    def joined(meshes: Iterable[Mesh], bodies: Iterable[int] | None = None) -> Mesh:
        """Several meshes as one; with `bodies`, the id of each, its triangles know which body they belong to."""
        parts = list(meshes)
        if not parts:
            return Mesh(np.zeros((0, 3)), np.zeros((0, 3)), [] if bodies is not None else None)
        begins = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
        body = None if bodies is None else np.repeat(np.array(list(bodies)), [len(part.triangles) for part in parts])
        return Mesh(np.concatenate([part.vertices for part in parts]),
                    np.concatenate([part.triangles + begin for part, begin in zip(parts, begins)]), body)

    @property
    def normals(self) -> np.ndarray:
        """Unit normal of each triangle, T x 3; zero for a triangle without area."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        n = np.cross(b - a, c - a)
        length = np.linalg.norm(n, axis=1, keepdims=True)
        return n / np.where(length > 0, length, 1)

    @property
    def area(self) -> float:
        """Area of all triangles [m^2]."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    @property
    def volume(self) -> float:
        """Volume inside a closed mesh [m^3]; negative when it is turned inside out."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    def to_trimesh(self) -> Any:
        """A trimesh.Trimesh. Raises MissingPackage without trimesh."""
        try:
            import trimesh
        except ImportError:
            raise missing_package("to_trimesh", "trimesh") from None
        attributes = {} if self.body is None else {"body": self.body}
        return trimesh.Trimesh(self.vertices, self.triangles, process=False, face_attributes=attributes)

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData, with the cell array `body` where triangles belong to bodies. Raises MissingPackage without pyvista."""
        try:
            import pyvista
        except ImportError:
            raise missing_package("to_pyvista", "pyvista") from None
        faces = np.hstack([np.full((len(self.triangles), 1), 3, dtype=np.int64), self.triangles])
        data = pyvista.PolyData(self.vertices, faces.ravel())
        if self.body is not None:
            data.cell_data["body"] = self.body
        return data

    def __repr__(self) -> str:
        of = "" if self.body is None else f" of {len(np.unique(self.body))} bodies"
        return f"<scree.Mesh {len(self.vertices)} vertices, {len(self.triangles)} triangles{of}>"


@lru_cache(maxsize=4)
def icosphere(divisions: int = 2) -> Mesh:
    """A ball of radius 1 as a mesh inscribed in it: 20 times 4 to the power of `divisions` triangles."""
    g = (1 + math.sqrt(5)) / 2
    points = [(s * a, t * b, 0.0) for a, b in ((1.0, g),) for s in (-1, 1) for t in (-1, 1)]
    vertices = np.array([p[k:] + p[:k] for k in range(3) for p in points]) / math.hypot(1, g)
    # faces: all triples of vertices at the distance of an edge, turned outward
    edge = 2 / math.hypot(1, g)
    near = np.abs(np.linalg.norm(vertices[:, None] - vertices[None], axis=2) - edge) < 1e-9
    faces = [(i, j, k) for i in range(12) for j in range(i + 1, 12) for k in range(j + 1, 12) if near[i, j] and near[j, k] and near[i, k]]
    triangles = np.array([f if np.dot(vertices[f[0]], np.cross(vertices[f[1]], vertices[f[2]])) > 0 else (f[0], f[2], f[1]) for f in faces])
    for _ in range(divisions):
        sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        unique, where = np.unique(sides, axis=0, return_inverse=True)
        middle = vertices[unique].sum(axis=1)
        ab, bc, ca = (where.reshape(3, -1) + len(vertices))
        vertices = np.concatenate([vertices, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
        a, b, c = triangles.T
        triangles = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return Mesh(vertices, triangles)


def box_mesh(lower: Any, upper: Any) -> Mesh:
    """A box between two corners, turned outward."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    return Mesh(lower + corners * (upper - lower), triangles)


def cylinder_mesh(start: Any, end: Any, radius: float, segments: int = 64) -> Mesh:
    """A closed cylinder, turned outward, inscribed in the round one."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    axis = (end - start) / np.linalg.norm(end - start)
    u = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    u /= np.linalg.norm(u)
    angle = 2 * math.pi * np.arange(segments) / segments
    ring = radius * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * np.cross(axis, u))
    i = np.arange(segments)
    j, n = (i + 1) % segments, segments
    low, high = np.full(n, 2 * n), np.full(n, 2 * n + 1)
    triangles = np.concatenate([np.stack(t, axis=1) for t in ((i, j, n + j), (i, n + j, n + i), (low, j, i), (high, n + i, n + j))])
    return Mesh(np.concatenate([start + ring, end + ring, [start, end]]), triangles)
