"""The settings of a scene (core/storage/SCENE_FORMAT.md): what this package reads of them is checked once, when the scene is opened."""
from __future__ import annotations

from typing import Any

_MATERIAL = ("density", "young", "poisson", "heat_capacity", "conductivity", "real_young")
#: by kind of wall: each value that the package reads, and how many numbers it has; 0: one that is no list
_WALLS: dict[str, dict[str, int]] = {
    "plane": {"point": 3, "normal": 3}, "box_inside": {"lower": 3, "upper": 3}, "cylinder_inside": {"axis_start": 3, "axis_end": 3, "radius": 0},
    "sphere_inside": {"point": 3, "radius": 0}, "mesh": {"scale": 0, "shape": 0}}


def _wrong(where: str, found: Any, expected: str) -> ValueError:
    return ValueError(f"settings: {where}: {str(found)[:60]!r} found, {expected} expected")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _expect(facts: dict[str, Any], where: str, name: str, kind: type, expected: str) -> Any:
    if not isinstance(facts.get(name), kind) or (kind is int and isinstance(facts[name], bool)):
        raise _wrong(f"{where}{name}", facts.get(name), expected)
    return facts[name]


def _expect_numbers(facts: dict[str, Any], where: str, name: str, count: int) -> None:
    value = facts.get(name)
    if count == 0 and not _is_number(value):
        raise _wrong(f"{where}{name}", value, "a number")
    if count and not (isinstance(value, list) and len(value) == count and all(map(_is_number, value))):
        raise _wrong(f"{where}{name}", value, f"{count} numbers")


def _tables(facts: dict[str, Any], name: str) -> list[tuple[str, dict[str, Any]]]:
    """Each entry of a list of tables, and how messages name it."""
    entries = _expect(facts, "", name, list, "a list")
    for number, entry in enumerate(entries):
        if not isinstance(entry, dict):
            raise _wrong(f"{name} {number}", entry, "a table")
    return [(f"{name} {number}: ", entry) for number, entry in enumerate(entries)]


def expect_settings(facts: Any) -> None:
    """Raises ValueError where a value that the package reads is missing or of another type."""
    if not isinstance(facts, dict):
        raise _wrong("all of it", facts, "a table")
    settings = _expect(facts, "", "settings", dict, "a table")
    _expect_numbers({"gravity": [0, 0, 0], **settings}, "", "gravity", 3)
    domain = settings.get("domain", {})
    if not isinstance(domain, dict):
        raise _wrong("domain", domain, "a table")
    if "periodic" in domain:
        if not (isinstance(domain["periodic"], list) and len(domain["periodic"]) == 3 and all(isinstance(p, bool) for p in domain["periodic"])):
            raise _wrong("domain: periodic", domain["periodic"], "three times true or false")
        _expect_numbers({"shear": [0, 0, 0], **domain}, "domain: ", "shear", 3)
    for name in ("min", "max") if any(domain.get("periodic", [])) else ():
        _expect_numbers(domain, "domain: ", name, 3)
    for where, material in _tables(facts, "materials"):
        _expect(material, where, "name", str, "a text")
        for name in _MATERIAL:
            _expect_numbers({name: 0.0, **material}, where, name, 0)
    for where, pair in _tables(facts, "pairs"):
        _expect(pair, where, "a", int, "a whole number")
        _expect(pair, where, "b", int, "a whole number")
    for where, wall in _tables(facts, "walls"):
        _expect(wall, where, "id", int, "a whole number")
        _expect(wall, where, "material", int, "a whole number")
        _expect(wall, where, "name", str, "a text")
        kind = _expect(wall, where, "kind", str, "a text")
        if kind not in _WALLS:
            raise _wrong(f"{where}kind", kind, f"one of {', '.join(_WALLS)}")
        for name, count in _WALLS[kind].items():
            _expect_numbers(wall, where, name, count)


def expect_provenance(provenance: Any) -> None:
    """Raises ValueError where the parts of a provenance that the package reads are of another type."""
    if not isinstance(provenance, dict):
        raise ValueError(f"provenance: {str(provenance)[:60]!r} found, a table expected")
    inputs = provenance.get("inputs", [])
    if not isinstance(provenance.get("configuration", ""), str) or not isinstance(inputs, list) or not all(
            isinstance(entry, dict) and isinstance(entry.get("path", ""), str) for entry in inputs):
        raise ValueError("provenance: the text 'configuration' and the list 'inputs' of tables expected")
