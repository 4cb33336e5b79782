"""Attributes of objects that a program reads and calls, and does not set: a misspelt name is an error with the nearest one."""
from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any


def nearest(name: str, known: list[str]) -> str:
    """The known name that was probably meant; "" where none is near."""
    begin = [k for k in known if len(name) > 1 and k.startswith(name)]
    return (difflib.get_close_matches(name, known, 1, 0.6) or begin or [""])[0]


class ReadAttributes:
    """Base of such objects. Without it an assignment to a misspelt attribute, or to a column of numbers, would pass and change nothing."""

    _may_be_set: frozenset[str] = frozenset()  # public attributes that `__init__` sets

    if not TYPE_CHECKING:  # a checker of types knows the names

        def __getattr__(self, name: str) -> Any:
            """Called for names that are not found."""
            kind = type(self)
            if name.startswith("_"):
                raise AttributeError(f"'{kind.__name__}' object has no attribute '{name}'")
            if hasattr(kind, name):  # a property that failed with an AttributeError of its own
                return object.__getattribute__(self, name)
            raise AttributeError(f"{kind.__name__} has no '{name}'{self._hint(name)}")

        def __setattr__(self, name: str, value: Any) -> None:
            kind = type(self)
            if name.startswith("_") or (name in self._may_be_set and name not in self.__dict__):
                return super().__setattr__(name, value)
            if hasattr(kind, name) or name in self.__dict__:
                raise AttributeError(f"{kind.__name__}.{name} cannot be set: it is only read or called")
            raise AttributeError(f"{kind.__name__} has no '{name}' that could be set{self._hint(name)}; keep values of your own in variables of your own")

    def _hint(self, name: str) -> str:
        near = nearest(name, [known for known in dir(type(self)) if not known.startswith("_")])
        return f"; did you mean '{near}'?" if near else ""
