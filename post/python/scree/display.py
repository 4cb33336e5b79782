"""Pictures and tables of a frame for notebooks."""
from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .errors import UsageError, missing_package
from .meshes import rotation_matrix

if TYPE_CHECKING:
    from .frames import Frame
    from .rows import Bodies

_MOST_TRIANGLES = 60_000  # drawn one by one, about a second; above, each body is its outline
_MOST_OUTLINES = 20_000  # above, each body is a disc of equal volume
_DIRECTIONS = 32  # of an outline
_TONES = ((0.55, 0.52, 0.48), (0.76, 0.66, 0.50), (0.45, 0.55, 0.62), (0.70, 0.48, 0.40), (0.60, 0.66, 0.52), (0.40, 0.38, 0.42),
          (0.82, 0.78, 0.70), (0.50, 0.42, 0.55))  # stone, as the pictures of scree-post


def _axes_of_view(frame: Frame, towards: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Right, up and depth of the picture: gravity points down where it can."""
    depth = np.asarray(towards, dtype=float)
    if not np.linalg.norm(depth) > 0:
        raise UsageError("plot: the direction of view has no length")
    depth = depth / np.linalg.norm(depth)
    gravity = np.asarray(frame.scene.settings.get("gravity", (0, 0, 0)), dtype=float)
    for up in (-gravity, np.array([0.0, 0, 1]), np.array([0.0, 1, 0])):
        up = up - (up @ depth) * depth
        if np.linalg.norm(up) > 1e-6 * max(1.0, float(np.linalg.norm(gravity))):
            break
    up = up / np.linalg.norm(up)
    return np.cross(depth, up), up, depth


def _colours(frame: Frame, bodies: Bodies, colour: str | Any) -> tuple[np.ndarray, tuple[str, float, float] | None]:
    """Red green blue of each body, and for a scale its label and ends."""
    if isinstance(colour, str) and colour in ("shape", "material"):
        index = bodies.shape if colour == "shape" else bodies.material
        return np.array(_TONES)[index % len(_TONES)], None
    if isinstance(colour, str) and colour not in ("speed", "temperature"):
        raise UsageError(f'plot: colour "{colour}" is none; there are shape, material, speed, temperature, or give a value for each body')
    label = {"speed": "speed [m/s]", "temperature": "temperature [K]"}[colour] if isinstance(colour, str) else ""
    if isinstance(colour, str):
        values = np.linalg.norm(bodies.velocity, axis=1) if colour == "speed" else np.asarray(bodies.temperature, dtype=float)
    else:
        values = np.asarray(colour, dtype=float)
    if len(values) != len(bodies):
        raise UsageError(f"plot: {len(values)} values of colour for {len(bodies)} bodies")
    from matplotlib import colormaps

    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    shares = (values - low) / (high - low) if high > low else np.zeros(len(values))
    return colormaps["viridis"](shares)[:, :3], (label, low, high)


def _triangle_patches(frame: Frame, bodies: Bodies, colours: np.ndarray, view: np.ndarray) -> tuple[list[np.ndarray] | np.ndarray, np.ndarray]:
    """All triangles that face the viewer, farthest first, shaded by their slope."""
    mesh = frame.meshes(bodies)
    normals = mesh.normals
    front = normals @ view[2] < 0
    corners = mesh.vertices[mesh.triangles[front]]
    assert mesh.body is not None
    row = np.searchsorted(bodies.id, mesh.body[front])
    light = np.array([-0.4, 0.7, -0.6]) / np.linalg.norm([-0.4, 0.7, -0.6])
    shade = 0.45 + 0.55 * np.clip(normals[front] @ view.T @ light, 0, 1)
    order = np.argsort(-(corners @ view[2]).mean(axis=1), kind="stable")
    return (corners @ view[:2].T)[order], (colours[row] * shade[:, None])[order]


def _outline_patches(frame: Frame, bodies: Bodies, colours: np.ndarray, view: np.ndarray) -> tuple[list[np.ndarray] | np.ndarray, np.ndarray]:
    """The convex outline of each body, farthest first: its farthest vertices in 32 directions of the picture."""
    angle = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    patches = 0.5 * bodies.diameter[:, None, None] * circle
    for index, shape in enumerate(frame.scene.shapes.in_order):
        rows = np.flatnonzero(bodies.shape == index)
        if shape.kind == "sphere" or len(bodies) > _MOST_OUTLINES:
            continue
        for part in np.array_split(rows, 1 + len(rows) * _DIRECTIONS * len(shape.vertices) // 10_000_000):  # 80 MB at a time
            turned = rotation_matrix(bodies.quaternion[part])
            seen = np.einsum("ak,nkj->naj", view[:2], turned)  # right and up of the picture in the axes of each body
            farthest = np.argmax(np.einsum("da,naj->ndj", circle, seen) @ shape.vertices.T, axis=2)
            corners = shape.vertices[farthest]
            patches[part] = bodies.scale[part][:, None, None] * np.einsum("naj,ndj->nda", seen, corners)
    order = np.argsort(-(bodies.position @ view[2]), kind="stable")
    return (patches + (bodies.position @ view[:2].T)[:, None])[order], colours[order]


def plot_bodies(frame: Frame, bodies: Bodies, ax: Any, colour: str | Any, towards: ArrayLike) -> Any:
    """See Frame.plot."""
    try:
        from matplotlib.cm import ScalarMappable
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import Normalize
        from matplotlib.figure import Figure
    except ImportError:
        raise missing_package("plot", "matplotlib") from None
    if ax is None:
        ax = Figure(figsize=(5, 4), layout="tight").add_subplot()
    view = np.array(_axes_of_view(frame, towards))
    colours, scale = _colours(frame, bodies, colour)
    triangles = np.array([len(shape.mesh.triangles) for shape in frame.scene.shapes.in_order])
    few = len(bodies) > 0 and int(triangles[bodies.shape].sum()) <= _MOST_TRIANGLES
    patches, faces = (_triangle_patches if few else _outline_patches)(frame, bodies, colours, view)
    edges = {"linewidths": 0.3, "edgecolors": "face"} if few else {"linewidths": 0.4, "edgecolors": (0.2, 0.2, 0.2)}
    ax.add_collection(PolyCollection(patches, facecolors=faces, closed=True, **edges))
    ax.autoscale_view()
    ax.set_aspect("equal")
    for axis, set_label in ((view[0], ax.set_xlabel), (view[1], ax.set_ylabel)):
        name = [("-" if value < 0 else "") + "xyz"[k] for k, value in enumerate(axis) if abs(value) > 0.999]
        set_label(f"{name[0]} [m]" if name else "[m]")
    ax.set_title(f"{frame.time:.6g} s")
    if scale is not None:
        ax.figure.colorbar(ScalarMappable(Normalize(scale[1], scale[2]), "viridis"), ax=ax, label=scale[0])
    return ax


def frame_html(frame: Frame) -> str:
    """A small table of a frame and, with matplotlib, a picture of it."""
    bodies = frame.bodies
    speed = np.linalg.norm(bodies.velocity, axis=1)
    rows = [("frame", f"{frame.number}"), ("time", f"{frame.time:.6g} s"), ("bodies", f"{len(bodies)}"), ("walls", f"{len(frame.walls)}"),
            ("contact points", f"{len(frame.contacts)}" if frame.scene.settings.get("output_contacts", True) else "not kept"),
            ("fastest body", f"{speed.max():.4g} m/s" if len(speed) else "-"), ("kinetic energy", f"{frame.kinetic:.4g} J")]
    table = "".join(f"<tr><th>{name}</th><td>{html.escape(value)}</td></tr>" for name, value in rows)
    try:
        ax = frame.plot()
    except ImportError:
        return f"<table>{table}</table>"
    file = io.BytesIO()
    ax.figure.savefig(file, format="png", dpi=100)
    picture = base64.b64encode(file.getvalue()).decode()
    return f'<div style="display:flex"><table>{table}</table><img alt="bodies" src="data:image/png;base64,{picture}"></div>'
