"""Walls, energies and saved states of an engine."""
from __future__ import annotations

import ctypes
import dataclasses
import sys
from typing import TYPE_CHECKING

import numpy as np

from .engine_arguments import address_of
from .engine_library import c_double, error_text, loaded_library
from .errors import UsageError

if TYPE_CHECKING:
    from .engine import Engine


class EngineWall:
    """A wall of an engine. Its loads are collective, its position and velocities are not."""

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
        self._engine._fact("wall_state", self._number, address_of(state))
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
    """Energies of the whole scene [J]."""

    translational: float  #: kinetic, of the centres of mass
    rotational: float  #: kinetic, about them
    potential: float  #: of weight and of constant forces of the case
    elastic: float  #: of all contacts, along their normals
    tangential_elastic: float  #: of all contacts, across their normals
    dissipated: float  #: since the start
    wall_work: float  #: of moving walls on the bodies, since the start
    outer_work: float  #: of set_wrench() and add_force(), since the start
    removed: float  #: of bodies that left
    arrived: float  #: of bodies that came in
    bond: float  #: of bonds
    fracture: float  #: of bonds that broke
    slept: float  #: of bodies as they fell asleep
    balance: float  #: sum of all with the signs of what they bring: constant but for the error of the run

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
