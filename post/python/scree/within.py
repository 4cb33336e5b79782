"""Which bodies of a frame have not left: the rule of scree-post (post/run/within.hpp)."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .errors import UsageError
from .meshes import rotate
from .regions import Box, Cylinder, Region, Sphere, region

if TYPE_CHECKING:
    from .rows import Store
    from .scene import Scene, Wall

_PLANE = "plane"


def up_axis(scene: Scene) -> tuple[int, float]:
    """Axis along which gravity pulls most, and the direction of up along it; z and +1 without gravity."""
    gravity = np.asarray(scene.settings.get("gravity", (0, 0, 0)), dtype=float)
    if not gravity @ gravity > 0:
        return 2, 1.0
    axis = int(np.argmax(np.abs(gravity)))
    return axis, -1.0 if gravity[axis] > 0 else 1.0


def _inside(wall: Wall) -> Region:
    """What an analytic wall holds, in its own frame."""
    f = wall.facts
    if wall.kind == "box_inside":
        return Box(f["lower"], f["upper"])
    if wall.kind == "cylinder_inside":
        return Cylinder(f["axis_start"], f["axis_end"], f["radius"])
    return Sphere(f["point"], f["radius"])


def _extent(wall: Wall, position: np.ndarray, quaternion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = position + rotate(quaternion, wall.mesh.vertices)
    return points.min(axis=0), points.max(axis=0)


def _open_upwards(scene: Scene, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    axis, sign = up_axis(scene)
    (upper if sign > 0 else lower)[axis] = sign * np.inf
    for k in np.flatnonzero(scene.periodicity.period > 0):
        lower[k], upper[k] = -np.inf, np.inf
    return lower, upper


def _reach_into(box: tuple[np.ndarray, np.ndarray], points: np.ndarray, radii: np.ndarray | float = 0.0) -> np.ndarray:
    r = np.broadcast_to(radii, len(points))[:, None]
    return np.all((points + r >= box[0]) & (points - r <= box[1]), axis=1)


def bodies_within(store: Store, points: np.ndarray, place: str | Region) -> np.ndarray:
    """See Bodies.within: n booleans."""
    scene = store.scene
    names = {str(wall.id): wall for wall in reversed(scene.walls.in_order)} | {wall.name: wall for wall in reversed(scene.walls.in_order)}
    if isinstance(place, Region) or place not in names:
        if isinstance(place, str) and ":" not in place:
            raise UsageError(f"within '{place}': no wall of the scene has this name or id; it has {', '.join(scene.walls) or 'none'}; else give a region")
        return store.periodicity.contained(region(place), points)
    wall = names[place]
    row = int(np.flatnonzero(store.get("walls/id") == wall.id)[0])
    position, quaternion = store.get("walls/position")[row], store.get("walls/orientation")[row]
    if wall.kind == "mesh":
        return _reach_into(_open_upwards(scene, *_extent(wall, position, quaternion)), points)
    own = rotate(quaternion * [1, -1, -1, -1], points - position)
    if wall.kind == _PLANE:
        return (own - wall.facts["point"]) @ np.asarray(wall.facts["normal"], dtype=float) > 0
    return store.periodicity.contained(_inside(wall), own)
