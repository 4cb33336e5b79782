"""Functions of a program that an engine calls between its steps."""
from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .engine_arguments import whole
from .engine_calls import EngineCalls
from .errors import UsageError

if TYPE_CHECKING:
    from .engine import Engine


class AfterSteps(EngineCalls):
    """What an engine calls between its steps."""

    def __init__(self) -> None:
        super().__init__()
        self._is_in_after_step = False
        self._after: dict[int, tuple[int, Callable[[Engine], Any]]] = {}  # every and function, by the number of the function
        self._last_after = 0

    def after_step(self, function: Callable[[Engine], Any], every: int = 1) -> int:
        """Calls function(engine) after each step whose number is a multiple of `every`. It may call everything but `step`.

        Returns a number for `remove_after_step`. An exception ends the call of `step`, after a complete step: the engine can go on.
        """
        def check() -> tuple[int, Callable[[Engine], Any]]:
            if not callable(function):
                raise UsageError(f"after_step: {function!r} found, a function expected")
            return whole("after_step: every", every, 1), function

        self._check_open("after_step")
        added = self._together(check)
        self._last_after += 1
        self._after[self._last_after] = added
        return self._last_after

    def remove_after_step(self, number: int) -> None:
        """Calls the function with this number of `after_step` no more; also from within a function that is called after a step."""
        def check() -> int:
            if whole("remove_after_step", number, 0) not in self._after:
                raise UsageError(f"remove_after_step: no function has the number {number}; it was removed before, or never added with after_step")
            return number

        del self._after[self._together(check, number if isinstance(number, int) else None)]

    def _check_not_nested(self, what: str) -> None:
        if self._is_in_after_step:
            raise UsageError(f"{what}: called by a function of after_step(), which is called between the steps of step() itself; return, and step afterwards")

    def _until_due(self, count: int) -> int:
        """How many of `count` steps are made before a function is due."""
        return min(count, *(every - self._steps() % every for every, _ in self._after.values())) if self._after else count

    def _steps(self) -> int:
        return int(self._fact("step_count"))

    def _call_after(self) -> None:
        due = [(number, function) for number, (every, function) in self._after.items() if self._steps() % every == 0]
        self._is_in_after_step = True
        try:
            # one that an earlier one has removed is not called any more
            self._together(lambda: [function(self) for number, function in due if number in self._after])  # type: ignore[arg-type]
        finally:
            self._is_in_after_step = False
