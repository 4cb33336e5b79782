"""Numbers of one frame by the definitions of scree-post (post/STATISTICS.md, post/statistics/contact_measures.cpp)."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .regions import Region

if TYPE_CHECKING:
    from .frames import Frame

_TENSOR = (("xx", 0, 0), ("yy", 1, 1), ("zz", 2, 2), ("xy", 0, 1), ("xz", 0, 2), ("yz", 1, 2))


def _ratio(part: float, whole: float) -> float:
    return float(part) / float(whole) if whole > 0 else float("nan")


def _rows_of(ids: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Row of each wanted id among ascending ids; -1 for a wall."""
    if not len(ids):
        return np.full(len(wanted), -1)
    row = np.minimum(np.searchsorted(ids, wanted), len(ids) - 1)
    return np.where(ids[row] == wanted, row, -1)


def _motion(frame: Frame, member: np.ndarray) -> dict[str, float]:
    b = frame.bodies[member]
    count, mass = len(b), b.mass
    numbers = {"particle_count": float(count), "mass": float(mass.sum())}
    share = mass / mass.sum() if count else mass
    nan = np.full(3, np.nan)
    velocity = share @ b.velocity if count else nan
    centre = share @ b.position if count else nan
    numbers.update({f"velocity_{c}": float(velocity[k]) for k, c in enumerate("xyz")})
    numbers["mean_speed"] = float(share @ np.linalg.norm(b.velocity, axis=1)) if count else float("nan")
    numbers["mean_spin"] = float(np.linalg.norm(b.angular_velocity, axis=1).mean()) if count else float("nan")
    numbers["granular_temperature"] = float(share @ ((b.velocity - velocity) ** 2).sum(axis=1) / 3) if count else float("nan")
    numbers.update({f"centre_of_mass_{c}": float(centre[k]) for k, c in enumerate("xyz")})
    if frame.scene.has_heat:
        mean = float(share @ b.temperature) if count else float("nan")
        numbers["temperature"] = mean
        numbers["temperature_spread"] = float(np.sqrt(share @ (b.temperature - mean) ** 2)) if count else float("nan")
    return numbers


def _contacts(frame: Frame, particle: np.ndarray, member: np.ndarray, part: Region | None) -> dict[str, float]:
    names = ["coordination_number", "coordination_number_without_rattlers", "rattler_fraction", "contact_points_per_particle",
             "mean_normal_force", "max_normal_force", "mean_tangential_force", "tensile_fraction", "mean_tensile_force",
             *(f"fabric_{ij}" for ij, _, _ in _TENSOR)]
    if not frame.scene.settings.get("output_contacts", True):
        return dict.fromkeys(names, float("nan"))
    c = frame.contacts
    c = c[c.normal_force != 0]
    ids, count = frame.bodies.id, int(member.sum())
    row_a, row_b = _rows_of(ids, c.body_a), _rows_of(ids, c.body_b)
    first = np.ones(len(c), dtype=bool)  # of each pair: a neighbour counts once, however many points press
    first[1:] = (c.body_a[1:] != c.body_a[:-1]) | (c.body_b[1:] != c.body_b[:-1])
    neighbours, ends = np.zeros(len(ids), dtype=np.int64), 0
    for row in (row_a, row_b):
        mine = (row >= 0) & member[row]
        ends += int(mine.sum())
        np.add.at(neighbours, row[mine & first], 1)
    neighbours = neighbours[member]
    few = neighbours < 2
    held = np.ones(len(c), dtype=bool) if part is None else frame.periodicity.contained(part, c.point)
    among = held & (row_a >= 0) & (row_b >= 0) & particle[row_a] & particle[row_b]
    normal, normal_force = c.normal[among], c.normal_force[held]
    fabric = normal.T @ normal / len(normal) if len(normal) else np.full((3, 3), np.nan)
    tangential = np.linalg.norm(c.tangential_force[held], axis=1)
    values = [_ratio(neighbours.sum(), count), _ratio(neighbours.sum() - (neighbours == 1).sum(), count - few.sum()), _ratio(few.sum(), count),
              _ratio(ends, count), _ratio(normal_force.sum(), len(normal_force)), float(normal_force.max(initial=0)),
              _ratio(tangential.sum(), len(tangential)), _ratio((normal_force < 0).sum(), len(normal_force)),
              _ratio(-normal_force[normal_force < 0].sum(), (normal_force < 0).sum()), *(float(fabric[i, j]) for _, i, j in _TENSOR)]
    return dict(zip(names, values))


def frame_measures(frame: Frame, part: Region | None) -> dict[str, float]:
    """See Frame.measures."""
    bodies = frame.bodies
    particle = bodies.is_particle if len(bodies) else np.zeros(0, dtype=bool)
    member = particle if part is None else particle & frame.periodicity.contained(part, bodies.position)
    numbers = {**_contacts(frame, particle, member, part), **_motion(frame, member)}
    if part is None:
        numbers.update({"kinetic_energy": frame.kinetic, "potential_energy": frame.potential, "elastic_energy": frame.elastic,
                        "dissipated_energy": frame.dissipated})
    return numbers
