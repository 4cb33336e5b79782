"""Heat that a program gives to the bodies of an engine: sources, and exchange with a fluid of its own."""
from __future__ import annotations

import ctypes
import dataclasses
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .engine_arguments import address_of, id_list, vectors
from .engine_calls import EngineCalls
from .engine_library import CHeat


@dataclasses.dataclass(frozen=True)
class Heat:
    """Heat of the whole scene, in J but for the last two.

    stored         mass times heat capacity times temperature, of all bodies that are in the run
    made           by contacts in bodies (`friction_heat` of the case), since the start, as all that follows
    made_in_walls  by contacts in walls; it leaves the scene
    from_sources   by sources of the case (`heat_source`)
    from_program   by sources of `set_heat_source`
    from_medium    by the media of `set_medium`
    from_walls     by walls
    arrived        with bodies that came in after the start
    removed        with bodies that left the run
    balance        stored + removed - made - from_sources - from_program - from_medium - from_walls - arrived: it stays the same but for rounding
    critical_step  which the step must not exceed, of contacts and media in the last step [s]
    biot           largest Biot number, of the same [-]
    """

    stored: float
    made: float
    made_in_walls: float
    from_sources: float
    from_program: float
    from_medium: float
    from_walls: float
    arrived: float
    removed: float
    balance: float
    critical_step: float
    biot: float


class HeatOfEngine(EngineCalls):
    """What an engine does with heat. In a scene without a table [heat] each call is a UsageError."""

    def set_heat_source(self, ids: ArrayLike | None, power: ArrayLike) -> None:
        """Holds sources of heat in bodies until they are set again, each instead of what its body had. Collective.

        ids     of any bodies, also of other ranks; each rank may give its own part. None: the bodies of this rank, in the order of `bodies`
        power   of each, or one for all [W]; below 0 it cools, 0 ends the source
        They act over the whole of each step from the next one on, and add to `heat_source` of the case. Bodies that sleep go on sleeping, and are heated too.
        """
        def check() -> tuple[np.ndarray | None, np.ndarray]:
            found, count = self._named("set_heat_source", ids)
            return found, vectors("set_heat_source: power", power, count, 1)

        self._check_open("set_heat_source")
        found, powers = self._together(check)
        self._call("set_heat_source", len(powers), address_of(found), address_of(powers))

    def set_medium(self, ids: ArrayLike | None, conductance: ArrayLike, temperature: ArrayLike) -> None:
        """Holds what surrounds bodies, a fluid of yours, until it is set again. Collective.

        ids          as in `set_heat_source`
        conductance  h A of each, or one for all [W/K]; 0: nothing passes
        temperature  of the fluid around each, or one for all [K]

        A body of temperature T gets the power conductance (temperature - T) in each stage of a step: the exchange is of second order. The step
        of the run must not exceed the mass times heat capacity over the conductances of a body, those of its contacts and this one: else `step` raises RunInvalid.
        `take_medium_heat` gives back what the fluid has lost.
        """
        def check() -> tuple[np.ndarray | None, np.ndarray, np.ndarray]:
            found, count = self._named("set_medium", ids)
            return found, vectors("set_medium: conductance", conductance, count, 1), vectors("set_medium: temperature", temperature, count, 1)

        self._check_open("set_medium")
        found, conductances, temperatures = self._together(check)
        self._call("set_medium", len(conductances), address_of(found), address_of(conductances), address_of(temperatures))

    def take_medium_heat(self, ids: ArrayLike | None = None) -> np.ndarray:
        """Heat that has passed from its medium to each body since it was last taken; n [J]: to rounding what the body was heated by. Collective.

        ids   as in `set_heat_source`. A body that had a medium and has left the run may be named once after that
        """
        def check() -> tuple[np.ndarray | None, int]:
            return self._named("take_medium_heat", ids)

        self._check_open("take_medium_heat")
        found, count = self._together(check)
        heat = np.zeros(count)
        self._call("take_medium_heat", count, address_of(found), address_of(heat))
        return heat

    def clear_heat(self, ids: ArrayLike | None = None) -> None:
        """Ends the sources and media of these bodies, or of all. Collective."""
        found = self._together(lambda: None if ids is None else id_list("clear_heat: ids", ids), "ids of all" if ids is None else "a list of ids")
        self._call("clear_heat", -1 if found is None else len(found), None if found is None else address_of(found))

    def heat(self) -> Heat:
        """Heat of the whole scene. Collective."""
        found = CHeat()
        self._call("get_heat", ctypes.byref(found))
        return Heat(*(getattr(found, name) for name, _ in CHeat._fields_))

    def _named(self, what: str, ids: Any) -> tuple[np.ndarray | None, int]:
        """Ids as the library takes them, and their number; None: all of this rank."""
        if ids is None:
            return None, int(self._fact("body_count"))
        found = id_list(f"{what}: ids", ids)
        return found, len(found)
