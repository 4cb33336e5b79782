"""Frames of a run (core/storage/RUN_FORMAT.md)."""
from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from .display import frame_html, plot_bodies
from .errors import InputError, UsageError, unknown_name
from .hdf import json_of, opened
from .measures import frame_measures
from .meshes import Mesh
from .regions import Cell, Periodicity, Region, region
from .rows import Bodies, Contacts, Walls, Store
from .scene import Scene

_FACTS = ("step", "kinetic", "potential", "elastic", "dissipated")


class Frame:
    """One frame of a run. Nothing is read before it is used.

    Its numbers: `time` [s], `number` (as in the file's name), `step`, and the energies of the whole scene `kinetic`, `potential`,
    `elastic`, `dissipated` [J].
    """

    def __init__(self, path: str, scene: Scene, time: float) -> None:
        """Made by `run.frames`."""
        self.path: str = path  #: file of the frame
        self.scene: Scene = scene  #: of the run
        self.time: float = time  #: [s]
        self._store = Store(path, scene)
        self.bodies: Bodies = Bodies(self._store)  #: by ascending id
        self.walls: Walls = Walls(self._store)  #: positions and loads

    @property
    def contacts(self) -> Contacts:
        """Contact points. Raises InputError when the run kept none (`output.contacts = false` in the case)."""
        if not self.scene.settings.get("output_contacts", True):
            raise InputError(f"{self.path}: the run kept no contacts; set contacts = true in [output] of the case and run it again")
        return Contacts(self._store)

    @cached_property
    def _facts(self) -> dict[str, Any]:
        with opened(self.path, "scree-frame", 1) as file:
            known = file["frame"].attrs  # each by its name: HDF5 1.10 ends the process when it lists the attributes of some damaged files
            return {**{name: known[name].item() for name in _FACTS}, "provenance": json_of(file["provenance"])}

    @property
    def number(self) -> int:
        """Number of the frame, as in the name of its file."""
        return int(re.sub(r"\D", "", os.path.basename(self.path)))

    @property
    def step(self) -> int:
        """Step of the run."""
        return int(self._facts["step"])

    @property
    def kinetic(self) -> float:
        """Kinetic energy of the whole scene [J]."""
        return float(self._facts["kinetic"])

    @property
    def potential(self) -> float:
        """Potential energy of the whole scene [J]."""
        return float(self._facts["potential"])

    @property
    def elastic(self) -> float:
        """Elastic energy of all contacts [J]."""
        return float(self._facts["elastic"])

    @property
    def dissipated(self) -> float:
        """Energy dissipated since the start [J]."""
        return float(self._facts["dissipated"])

    @property
    def cell(self) -> Cell | None:
        """The periodic cell of a scene with [cell]: lengths, rates, stress. None in any other scene."""
        return self._store.cell

    @property
    def periodicity(self) -> Periodicity:
        """Periodic axes at this time: those of the cell, or of the domain."""
        return self._store.periodicity

    @property
    def provenance(self) -> dict[str, Any]:
        """Who made the frame, from what: tool, command, inputs, git, ranks, threads."""
        return dict(self._facts["provenance"])

    def mesh(self, body_id: int) -> Mesh:
        """The mesh of a body in the world; of an analytic sphere 320 triangles. Raises UnknownName."""
        return self._body_mesh(self.bodies.row(body_id))

    def _body_mesh(self, row: int) -> Mesh:
        b = self.bodies
        shape = self.scene.shapes.by_index(int(b.shape[row]))
        return shape.mesh.placed(b.position[row], b.quaternion[row], float(b.scale[row]))

    def meshes(self, bodies: Bodies | None = None) -> Mesh:
        """The meshes of all bodies, or of a part of them, as one mesh; `mesh.body` is the id of each triangle's body.

        Bodies of another frame are those of the same ids in this one. Raises UnknownName when it does not have one.
        """
        ids = (self.bodies if bodies is None else bodies).id
        rows = np.searchsorted(self.bodies.id, ids)
        here = np.isin(ids, self.bodies.id)
        if not here.all():
            self.bodies.row(int(ids[~here][0]))  # says that it is not in this frame
        return Mesh.joined((self._body_mesh(int(row)) for row in rows), ids.tolist())

    def wall_mesh(self, wall: str | int) -> Mesh:
        """The mesh of a wall, by its name or id, in the world at this time, worn as it is then. Raises UnknownName; UsageError for a plane."""
        row = self.walls.row(wall)
        by_id = {w.id: w for w in self.scene.walls.in_order}
        known = by_id[int(self.walls.id[row])]
        mesh = known.worn_mesh(self._worn_vertices(known.id))
        return mesh.placed(self.walls.position[row], self.walls.quaternion[row])

    def _worn_vertices(self, wall_id: int) -> np.ndarray:
        """V x 3, axes and scale of the wall's mesh file; none where the wall does not wear."""
        with opened(self.path, "scree-frame", 1) as file:
            if "wear" not in file:
                return np.zeros((0, 3))
            return file["wear/vertex"][()].reshape(-1, 3)[file["wear/wall"][()] == wall_id]

    def measures(self, part: Region | str | None = None) -> dict[str, float]:
        """Numbers of the frame under the names and by the definitions of `scree-post statistics` (post/STATISTICS.md), in SI units.

        part   only particles with their centre, and contacts with their point, in this region
        Of contacts: coordination_number, coordination_number_without_rattlers, rattler_fraction, contact_points_per_particle,
        mean_normal_force, max_normal_force, mean_tangential_force, tensile_fraction, mean_tensile_force, fabric_ij. Of motion:
        particle_count, mass, velocity_i, mean_speed, mean_spin, granular_temperature, centre_of_mass_i, and of a scene with heat
        temperature and temperature_spread. Of the whole scene,
        without a region: kinetic_energy, potential_energy, elastic_energy, dissipated_energy. What is not defined (no particle, no contact, no contacts kept) is NaN; the largest
        normal force of no contact is 0.
        """
        return frame_measures(self, None if part is None else region(part))

    def plot(self, ax: Any = None, colour: str | Any = "shape", towards: ArrayLike = (0, 1, 0), bodies: Bodies | None = None) -> Any:
        """Draws the bodies with matplotlib as they look from outside; returns the axes. Raises MissingPackage without matplotlib.

        ax       matplotlib axes; new ones when None
        colour   "shape", "material", "speed", "temperature" of a scene with heat, or a value for each body
        towards  direction of view, horizontal for a picture with gravity pointing down
        bodies   only these
        True triangles where they are few, else the outline of each body, which is convex.
        """
        return plot_bodies(self, self.bodies if bodies is None else bodies, ax, colour, towards)

    def __repr__(self) -> str:
        return f"<scree.Frame {self.number} at {self.time:.6g} s: {len(self.bodies)} bodies>"

    def _repr_html_(self) -> str:
        return frame_html(self)


class Frames(Sequence[Frame]):
    """The frames of a run by ascending time: `frames[-1]`, `frames[10:20:2]`, `for frame in frames`.

    A frame that is not used any more is forgotten, so that memory does not grow with the number of frames; the latest one is kept.
    """

    def __init__(self, scene: Scene, entries: list[tuple[str, float]]) -> None:
        """entries: path and time of each frame."""
        self._scene, self._entries = scene, entries
        self._latest: Frame | None = None

    @property
    def times(self) -> np.ndarray:
        """Times of the frames [s], without opening them."""
        return np.array([time for _, time in self._entries])

    def by_number(self, number: int) -> Frame:
        """The frame with a number in the name of its file. Raises UnknownName."""
        for index in range(len(self)):
            if os.path.basename(self._entries[index][0]) == f"frame_{number:06}.hdf":
                return self[index]
        raise unknown_name("frame", number, (os.path.basename(path) for path, _ in self._entries))

    def at_time(self, time: float) -> Frame:
        """The frame nearest to a time [s]."""
        if not self._entries:
            raise UsageError("there are no frames")
        return self[int(np.argmin(np.abs(self.times - time)))]

    def at(self, places: Sequence[int]) -> Frames:
        """A part of the frames, by their places: `frames.at([0, 5, -1])`."""
        return Frames(self._scene, [self._entries[place] for place in places])

    @overload
    def __getitem__(self, index: int) -> Frame: ...

    @overload
    def __getitem__(self, index: slice) -> Frames: ...

    def __getitem__(self, index: int | slice) -> Frame | Frames:
        if isinstance(index, slice):
            return Frames(self._scene, self._entries[index])
        try:
            path, time = self._entries[index]
        except IndexError:
            raise IndexError(f"frame {index}: there are {len(self)} frames, counted from 0") from None
        if self._latest is None or self._latest.path != path:
            self._latest = Frame(path, self._scene, time)
        return self._latest

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(len(self)))

    def __len__(self) -> int:
        return len(self._entries)

    def __repr__(self) -> str:
        if not self._entries:
            return "<scree.Frames: none>"
        return f"<scree.Frames: {len(self)} frames from {self._entries[0][1]:.6g} s to {self._entries[-1][1]:.6g} s>"


def frames_of(folder: str, scene: Scene) -> Frames:
    """The frames that `frames.hdf.series` of a run folder lists. Raises InputError."""
    series = os.path.join(folder, "frames.hdf.series")
    try:
        with open(series, encoding="utf-8") as file:
            entries = [(os.path.join(folder, e["name"]), float(e["time"])) for e in json.load(file)["files"]]
    except FileNotFoundError:
        raise InputError(f"{folder}: no frames.hdf.series in it; either no frame is written yet or scree-solver did not make this folder") from None
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError(f"{series}: not a list of frames: {error}") from error
    return Frames(scene, sorted(entries, key=lambda entry: entry[1]))
