"""Parts of space: boxes, cylinders, spheres, with the rule of scree-post (post/run/region.hpp).

A box is half open (lower sides belong to it, upper sides do not), a cylinder is half open along its axis, and the curved surface
of a cylinder or sphere does not belong to it: regions side by side count nothing twice.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .errors import UsageError
from .units import si


class Region:
    """A part of space. Use Box, Cylinder, Sphere, or `scree.region("box:0,0,0,1,1,1")`."""

    def contains(self, points: Any) -> np.ndarray:
        """Which of the points (n x 3) [m] lie inside: n booleans."""
        raise NotImplementedError

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        raise NotImplementedError

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the box around the region [m]."""
        raise NotImplementedError

    def _checked(self) -> None:
        if not self.volume > 0:
            raise UsageError(f"{self!r}: it has no volume")


class Box(Region):
    """A box with sides along the axes, between two opposite corners [m] in any order."""

    def __init__(self, corner: ArrayLike, opposite: ArrayLike) -> None:
        """corner, opposite: three coordinates each [m]. Raises UsageError when the box has no volume."""
        a, b = np.asarray(corner, dtype=float), np.asarray(opposite, dtype=float)
        self.lower: np.ndarray = np.minimum(a, b)  #: corner with the smallest coordinates [m]
        self.upper: np.ndarray = np.maximum(a, b)  #: corner with the largest coordinates [m]
        self._checked()

    def contains(self, points: Any) -> np.ndarray:
        """Which of the points (n x 3) [m] lie inside; lower sides belong to the box, upper sides do not."""
        p = np.asarray(points)
        return np.all((p >= self.lower) & (p < self.upper), axis=-1)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return float(np.prod(self.upper - self.lower))

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner [m]."""
        return self.lower, self.upper

    def __repr__(self) -> str:
        return f"scree.Box({self.lower.tolist()}, {self.upper.tolist()})"


class Cylinder(Region):
    """A cylinder in any direction, given by the ends of its axis and its radius [m]."""

    def __init__(self, start: ArrayLike, end: ArrayLike, radius: float) -> None:
        """start, end: of the axis [m]; radius [m]. Raises UsageError when the cylinder has no volume."""
        self.start: np.ndarray = np.asarray(start, dtype=float)
        self.end: np.ndarray = np.asarray(end, dtype=float)
        self.radius: float = float(radius)
        if not self.radius > 0:
            raise UsageError(f"{self!r}: a radius above 0 expected")
        self._checked()

    def contains(self, points: Any) -> np.ndarray:
        """Which of the points (n x 3) [m] lie inside; the lid at the start belongs to the cylinder."""
        axis, d = self.end - self.start, np.asarray(points) - self.start
        along = d @ axis / (axis @ axis)
        across = d - along[..., None] * axis
        return (along >= 0) & (along < 1) & (np.einsum("...i,...i", across, across) < self.radius**2)

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return float(math.pi * self.radius**2 * np.linalg.norm(self.end - self.start))

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the box around it [m]."""
        axis = (self.end - self.start) / np.linalg.norm(self.end - self.start)
        reach = self.radius * np.sqrt(np.maximum(0, 1 - axis**2))
        return np.minimum(self.start, self.end) - reach, np.maximum(self.start, self.end) + reach

    def __repr__(self) -> str:
        return f"scree.Cylinder({self.start.tolist()}, {self.end.tolist()}, {self.radius})"


class Sphere(Region):
    """A ball, given by its centre and radius [m]."""

    def __init__(self, centre: ArrayLike, radius: float) -> None:
        """centre: three coordinates [m]; radius [m]. Raises UsageError when the ball has no volume."""
        self.centre: np.ndarray = np.asarray(centre, dtype=float)
        self.radius: float = float(radius)
        self._checked()

    def contains(self, points: Any) -> np.ndarray:
        """Which of the points (n x 3) [m] lie inside; the surface does not belong to it."""
        d = np.asarray(points) - self.centre
        return np.einsum("...i,...i", d, d) < self.radius**2

    @property
    def volume(self) -> float:
        """Volume [m^3]."""
        return 4 / 3 * math.pi * self.radius**3

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper corner of the box around it [m]."""
        return self.centre - self.radius, self.centre + self.radius

    def __repr__(self) -> str:
        return f"scree.Sphere({self.centre.tolist()}, {self.radius})"


def region(text: str | Region) -> Region:
    """A region from the text that scree-post takes.

    "box:x0,y0,z0,x1,y1,z1", "cylinder:x0,y0,z0,x1,y1,z1,r" or "sphere:x,y,z,r", in metres or with units ("5 cm"). A name in front
    ("top=box:...") is ignored. A Region is returned as it is. Raises UsageError for anything else.
    """
    if isinstance(text, Region):
        return text
    kind, _, rest = text.rsplit("=", 1)[-1].partition(":")
    sizes = {"box": 6, "cylinder": 7, "sphere": 4}
    if kind not in sizes:
        raise UsageError(f"region '{text}': expected box:x0,y0,z0,x1,y1,z1, cylinder:x0,y0,z0,x1,y1,z1,r or sphere:x,y,z,r")
    numbers = [si(part, "m") for part in rest.split(",")]
    if len(numbers) != sizes[kind]:
        raise UsageError(f"region '{text}': {len(numbers)} numbers found, {sizes[kind]} expected")
    if kind == "box":
        return Box(numbers[:3], numbers[3:])
    if kind == "cylinder":
        return Cylinder(numbers[:3], numbers[3:6], numbers[6])
    return Sphere(numbers[:3], numbers[3])


class Periodicity:
    """Periodic axes of a domain.

    lower   its lower corner [m]
    period  length along each periodic axis [m], 0 for the others
    shear   h_yz, h_xz, h_xy of a cell that is sheared, since it was a box [m]; 0 in any other domain, and those with an axis that is not periodic
    """

    def __init__(self, lower: ArrayLike, period: ArrayLike, shear: ArrayLike = (0, 0, 0)) -> None:
        """Each with three values."""
        self.lower: np.ndarray = np.asarray(lower, dtype=float)
        self.period: np.ndarray = np.asarray(period, dtype=float)
        self.shear: np.ndarray = np.asarray(shear, dtype=float)
        self._lengths: np.ndarray = self.period

    @property
    def any(self) -> bool:
        """Whether an axis is periodic."""
        return bool(np.any(self.period > 0))

    @property
    def is_sheared(self) -> bool:
        """Whether images across y and z are shifted along another axis too."""
        return bool(np.any(self.shear != 0))

    @property
    def edges(self) -> np.ndarray:
        """The edges a, b, c of a cell with these images, as rows [m]: of all that there are the one with the least shears."""
        (yz, xz, xy), (x, y, z) = self.shear, self._lengths
        if self.is_sheared:
            turns = np.rint(yz / y)
            yz, xz = yz - turns * y, xz - turns * xy
            xz, xy = xz - np.rint(xz / x) * x, xy - np.rint(xy / x) * x
        return np.array([[x, 0, 0], [xy, y, 0], [xz, yz, z]])

    def _shift(self, images: np.ndarray) -> np.ndarray:
        """From a point to its images (n x 3, whole numbers) [m]; the order of operations is that of the solver."""
        (yz, xz, xy), (x, y, z) = self.shear, self.period
        n = images
        return np.stack([n[:, 2] * xz + n[:, 1] * xy + n[:, 0] * x, n[:, 2] * yz + n[:, 1] * y, n[:, 2] * z], axis=1)

    def _whole_shift(self, d: np.ndarray, whole: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """The shift of the images that `whole` takes from what d has of each period, in the order z, y, x."""
        (yz, xz, xy), n = self.shear, np.zeros_like(d)
        n[:, 2] = whole(d[:, 2] / self.period[2]) if self.period[2] > 0 else 0
        n[:, 1] = whole((d[:, 1] - n[:, 2] * yz) / self.period[1])
        n[:, 0] = whole((d[:, 0] - (n[:, 2] * xz + n[:, 1] * xy)) / self.period[0])
        return self._shift(n)

    def wrap(self, points: np.ndarray) -> np.ndarray:
        """The points (n x 3) [m] moved by whole periods into the domain."""
        if self.is_sheared:
            return points - self._whole_shift(points - self.lower, np.floor)
        wrapped = np.array(points)
        for k in np.flatnonzero(self.period > 0):
            wrapped[:, k] += -np.floor((wrapped[:, k] - self.lower[k]) / self.period[k]) * self.period[k]
        return wrapped

    def nearest(self, differences: np.ndarray) -> np.ndarray:
        """The shortest image of each difference (n x 3) of two positions in the domain [m].

        In a sheared cell that holds for images shorter than half of the smallest distance of two opposite sides; of longer ones another may be shorter.
        """
        d = np.array(differences)
        if self.is_sheared:
            return d - self._whole_shift(d, np.rint)
        for k in np.flatnonzero(self.period > 0):
            d[:, k] -= np.where(d[:, k] > 0.5 * self.period[k], self.period[k], 0) - np.where(d[:, k] < -0.5 * self.period[k], self.period[k], 0)
        return d

    def contained(self, part: Region, points: np.ndarray) -> np.ndarray:
        """Which of the points (n x 3) [m] in the domain lie in a region, themselves or with one of their images."""
        if not self.any:
            return part.contains(points)
        lower, upper = part.bounds
        if self.is_sheared:
            return self._contained_in_sheared(part, points)
        shifts = [np.zeros(1)] * 3
        for k in np.flatnonzero(self.period > 0):
            first = math.floor((lower[k] - self.lower[k]) / self.period[k]) - 1
            last = math.floor((upper[k] - self.lower[k]) / self.period[k]) + 1
            shifts[k] = np.arange(first, last + 1) * self.period[k]
        inside = np.zeros(len(points), dtype=bool)
        for x in shifts[0]:
            for y in shifts[1]:
                for z in shifts[2]:
                    inside |= part.contains(points + np.array([x, y, z]))
        return inside

    def _contained_in_sheared(self, part: Region, points: np.ndarray) -> np.ndarray:
        """Which images along one axis meet a region depends on those along the later ones."""
        lower, upper = part.bounds
        inside = np.zeros(len(points), dtype=bool)

        def images(k: int, n: list[float]) -> np.ndarray:
            if not self.period[k] > 0:
                return np.zeros(1)
            start = self.lower[k] + self._shift(np.array([n], dtype=float))[0, k]
            return np.arange(math.floor((lower[k] - start) / self.period[k]) - 1, math.floor((upper[k] - start) / self.period[k]) + 2)
        for z in images(2, [0, 0, 0]):
            for y in images(1, [0, 0, z]):
                for x in images(0, [0, y, z]):
                    inside |= part.contains(points + self._shift(np.array([[x, y, z]], dtype=float)))
        return inside


class Cell(Periodicity):
    """The periodic cell of a frame of a scene with [cell]. Stresses are positive in compression.

    lower, upper   opposite corners of the box that its bodies lie in [m]
    lengths        of that box [m]
    period         the same, but 0 along z where it lies between planes
    shear          h_yz, h_xz, h_xy since it was a box [m]
    edges          of the cell that ParaView and other readers draw, as rows [m]
    rate           (dh/dt) / h of each length [1/s]
    shear_rate     L_yz, L_xz, L_xy [1/s]
    stress         symmetric, 3 x 3 [Pa]
    """

    def __init__(self, lower: ArrayLike, upper: ArrayLike, rate: ArrayLike, normal_stress: ArrayLike, shear_stress: ArrayLike,
                 shear: ArrayLike = (0, 0, 0), shear_rate: ArrayLike = (0, 0, 0), periodic: ArrayLike = (True, True, True)) -> None:
        """Each with three values; stresses as xx, yy, zz and yz, xz, xy."""
        super().__init__(lower, np.where(periodic, np.subtract(upper, lower), 0.0), shear)
        self._lengths = np.subtract(upper, lower)
        self.rate: np.ndarray = np.asarray(rate, dtype=float)
        self.shear_rate: np.ndarray = np.asarray(shear_rate, dtype=float)
        yz, xz, xy = np.asarray(shear_stress, dtype=float)
        xx, yy, zz = np.asarray(normal_stress, dtype=float)
        self.stress: np.ndarray = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    @property
    def upper(self) -> np.ndarray:
        """Its upper corner [m]."""
        return self.lower + self._lengths

    @property
    def lengths(self) -> np.ndarray:
        """Of the box [m]."""
        return self._lengths

    @property
    def volume(self) -> float:
        """[m^3]"""
        return float(np.prod(self._lengths))

    @property
    def pressure(self) -> float:
        """A third of the trace of the stress [Pa]."""
        return float(np.trace(self.stress)) / 3
