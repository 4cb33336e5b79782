"""Walls, energies and saved states of an engine."""
from __future__ import annotations

import ctypes
import dataclasses
import sys
from typing import TYPE_CHECKING

import numpy as np

from .attributes import ReadAttributes
from .engine_arguments import address_of
from .engine_library import c_double, error_text, loaded_library
from .errors import UsageError

if TYPE_CHECKING:
    from .engine import Engine


class EngineWall(ReadAttributes):
    """A wall of an engine. Its loads are collective, its position and velocities are not."""

    _may_be_set = frozenset({"name"})

    def __init__(self, engine: Engine, number: int, name: str) -> None:
        """Made by an engine."""
        self._engine, self._number = engine, number
        self.name: str = name  #: given in the case, or kind and number

    @property
    def load(self) -> np.ndarray:
        """Force of all bodies on the wall; 3 [N]. Collective."""
        return self._engine._wall_loads()[self._number, :3]

    @property
    def torque(self) -> np.ndarray:
        """Torque of all bodies on the wall about the world's origin; 3 [N m]. Collective."""
        return self._engine._wall_loads()[self._number, 3:]

    def _state(self) -> np.ndarray:
        state = np.zeros(13)
        if self._engine._fact("wall_state", self._number, address_of(state)):
            raise UsageError(error_text())
        return state

    @property
    def position(self) -> np.ndarray:
        """World = position + rotate(quaternion, point in the frame of the wall); 3 [m]."""
        return self._state()[:3]

    @property
    def quaternion(self) -> np.ndarray:
        """Unit quaternion w x y z; 4."""
        return self._state()[3:7]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of `position`; 3 [m/s]."""
        return self._state()[7:10]

    @property
    def angular_velocity(self) -> np.ndarray:
        """About world axes; 3 [rad/s]."""
        return self._state()[10:]

    def drive(self, rate: float) -> None:
        """Moves a wall with the motion `outer` of the case at a rate [m/s] or [rad/s], until it is given again; the same on every rank. Collective.

        Raises UsageError for another wall, or a rate above its max_speed or max_rate.
        """
        self._engine._drive(self._number, self.name, rate)

    def _way_and_rate(self) -> tuple[float, float]:
        way, rate = c_double(), c_double()
        if self._engine._fact("wall_way", self._number, ctypes.byref(way), ctypes.byref(rate)):
            raise UsageError(error_text())
        return way.value, rate.value

    @property
    def way(self) -> float:
        """Displacement of a wall with the motion outer, servo, free or motor from where it was placed: along its direction [m] or about its axis [rad]."""
        return self._way_and_rate()[0]

    @property
    def rate(self) -> float:
        """Rate of `way` [m/s] or [rad/s]."""
        return self._way_and_rate()[1]

    def __repr__(self) -> str:
        return f"<scree.EngineWall '{self.name}'>"


@dataclasses.dataclass(frozen=True)
class Energies:
    """Energies of the whole scene, all in J.

    translational       kinetic, of the centres of mass
    rotational          kinetic, about the centres of mass
    potential           of weight, buoyancy and constant forces of the case; of bodies that are in the run. It is 0 at the origin of the world, in a
                        scene that is a thousand of its sizes away from it at a point near its middle
    elastic             of all contacts, along their normals
    tangential_elastic  of all contacts, in the springs of friction across their normals
    dissipated          taken by damping and friction of contacts and by a fluid, since the start
    wall_work           done by moving walls on the bodies, since the start
    outer_work          done by forces of `set_wrench` and `add_force`, or by a periodic cell that deforms, since the start
    removed             kinetic and potential, of bodies that left the run, as they left it
    arrived             kinetic and potential, of bodies that came in after the start, as they came in
    bond                of the bonds that hold
    fracture            of bonds as they broke, less that of the contacts in their place
    slept               kinetic, of bodies as they fell asleep
    balance             the sum translational + rotational + potential + elastic + tangential_elastic + dissipated + bond + fracture + slept + removed
                        - arrived - wall_work - outer_work. It is not an error: it is what stays the same. The error of the run since a moment is
                        `engine.energies().balance - balance_then`; `energy_error` of log.csv is that since the start
    """

    translational: float
    rotational: float
    potential: float
    elastic: float
    tangential_elastic: float
    dissipated: float
    wall_work: float
    outer_work: float
    removed: float
    arrived: float
    bond: float
    fracture: float
    slept: float
    balance: float

    @property
    def kinetic(self) -> float:
        """Translational and rotational [J]."""
        return self.translational + self.rotational


class State:
    """A state of a run in memory, from `Engine.save()`."""

    def __init__(self, handle: int, time: float, steps: int, ranks: int) -> None:
        """Made by an engine."""
        self._handle, self._ranks = handle, ranks
        self.time: float = time  #: [s]
        self.steps: int = steps  #: since the start of the run

    def __del__(self) -> None:
        if not sys.is_finalizing():
            loaded_library().scree_free_state(self._handle)

    def __repr__(self) -> str:
        return f"<scree.State: step {self.steps} at {self.time:.6g} s>"
