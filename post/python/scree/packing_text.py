"""Packings as text: data files and dumps of LAMMPS and LIGGGHTS, lists of spheres of Yade.

Sources: the pages `read_data`, `dump` and `atom_style` of LAMMPS's and LIGGGHTS's manuals; `ymport.text`, `ymport.textExt` and
`SpherePack.save` of Yade. Every number is written with the fewest digits that give the same double again.
"""
from __future__ import annotations

import re
from collections.abc import Sequence
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    from .packings import Packing

_SPHERE = {"sphere": 7, "granular": 7, "atomic": 5}  # atom styles that are read, and their columns without image flags
_PLACES = ("x y z", "xu yu zu", "xs ys zs", "xsu ysu zsu")


class _Lines:
    """Lines of a file, one after the other, with errors that name them."""

    def __init__(self, path: str) -> None:
        self.path, self.number = path, 0
        try:
            with open(path, encoding="utf-8") as file:
                self._all = file.read().splitlines()
        except UnicodeDecodeError:
            raise InputError(f"{path}: no text file") from None
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from error

    def error(self, message: str, line: int | None = None) -> InputError:
        return InputError(f"{self.path}:{self.number if line is None else line}: {message}")

    def next(self) -> str | None:
        """The next line; None at the end, when `number` is that of the last line."""
        if self.number >= len(self._all):
            return None
        self.number += 1
        return self._all[self.number - 1]

    def back(self) -> None:
        self.number -= 1

    def rows(self, count: int, what: str, comments: bool = False) -> tuple[list[list[str]], list[int]]:
        """The words of the next lines that are not empty, and their line numbers. Stops at the end of the file."""
        found: list[list[str]] = []
        places: list[int] = []
        while len(found) < count:
            line = self.next()
            if line is None:
                raise self.error(f"the file ends after {len(found)} of {count} lines of {what}")
            words = (line.partition("#")[0] if comments else line).split()
            if words:
                found.append(words)
                places.append(self.number)
        return found, places

    def numbers(self, rows: Sequence[Sequence[str]], places: Sequence[int], columns: Sequence[int], what: str, whole: bool = False) -> np.ndarray:
        """Some columns of rows as numbers."""
        dtype: Any = np.int64 if whole else float
        for row, place in zip(rows, places):
            if len(row) <= max(columns):
                raise self.error(f"{len(row)} values found in {what}, {max(columns) + 1} expected", place)
        try:
            values = np.array([[row[c] for c in columns] for row in rows], dtype=dtype).reshape(len(rows), len(columns))
            if whole or np.isfinite(values).all():
                return values
        except (ValueError, OverflowError):
            pass
        for row, place in zip(rows, places):
            for c in columns:
                try:
                    if whole:
                        int(row[c])
                    elif not np.isfinite(float(row[c])):
                        raise ValueError
                except ValueError:
                    raise self.error(f"'{row[c]}' in column {c + 1} of {what}; {'a whole' if whole else 'a finite'} number expected", place) from None
        raise self.error(f"a number of {what} is too large")


def _unique(lines: _Lines, ids: np.ndarray, places: Sequence[int]) -> None:
    _, first, counts = np.unique(ids, return_index=True, return_counts=True)
    if len(first) < len(ids):
        twice = ids[first[counts > 1][0]]
        rows = np.flatnonzero(ids == twice)
        raise lines.error(f"id {twice} for the second time; line {places[rows[0]]} has it too", places[rows[1]])


# LAMMPS and LIGGGHTS: data files

def read_data(path: str, need_radius: bool, _: int | None = None) -> dict[str, Any]:
    """A data file of atom style sphere (LIGGGHTS: granular): id, type, diameter, density, x, y, z in section Atoms."""
    lines = _Lines(path)
    lines.next()  # the title
    count, bounds, parts = _data_header(lines)
    atoms_seen = False
    while (line := lines.next()) is not None:
        section, _, style = (part.strip() for part in line.partition("#"))
        if not section:
            continue
        if not section[0].isalpha():
            raise lines.error(f"'{line.strip()}': the name of a section expected, such as Atoms; the header announces {count} atoms")
        if section == "Atoms":
            parts.update(_data_atoms(lines, count, style, need_radius))
            atoms_seen = True
        elif section == "Velocities":
            if not atoms_seen:
                raise lines.error("section Velocities before section Atoms")
            parts.update(_data_velocities(lines, parts["id"], count))
        else:  # Masses, Pair Coeffs, Bonds ...: up to the next name
            while (other := lines.next()) is not None and not other.strip()[:1].isalpha():
                pass
            if other is not None:
                lines.back()
    if not atoms_seen:
        raise lines.error(f"no section Atoms, though the header announces {count} atoms")
    return {**parts, "lower": bounds[:, 0], "upper": bounds[:, 1]}


def _data_header(lines: _Lines) -> tuple[int, np.ndarray, dict[str, Any]]:
    count: int | None = None
    bounds: dict[str, list[float]] = {}
    while (line := lines.next()) is not None:
        words = line.partition("#")[0].split()
        if not words:
            continue
        if words[0][0].isalpha():
            lines.back()
            break
        if words[1:] == ["atoms"]:
            count = int(lines.numbers([words], [lines.number], [0], "the header", whole=True)[0, 0])
        elif len(words) == 4 and words[2:] in (["xlo", "xhi"], ["ylo", "yhi"], ["zlo", "zhi"]):
            bounds[words[2][0]] = lines.numbers([words], [lines.number], [0, 1], "the header")[0].tolist()
        elif words[-3:] == ["xy", "xz", "yz"] and any(float(w) for w in words[:3]):
            raise lines.error("a box with slanted sides (xy xz yz) cannot be read; only one with right angles")
    if count is None:
        raise lines.error("no line 'N atoms' in the header; is this a data file of LAMMPS?")
    missing = [axis for axis in "xyz" if axis not in bounds]
    if missing:
        raise lines.error(f"no line '{missing[0]}lo {missing[0]}hi' in the header")
    return count, np.array([bounds[axis] for axis in "xyz"]), {}


def _data_atoms(lines: _Lines, count: int, style: str, need_radius: bool) -> dict[str, Any]:
    if style and style not in _SPHERE:
        raise lines.error(f"section Atoms has the atom style '{style}'; sphere, granular or atomic expected")
    rows, places = lines.rows(count, "section Atoms", comments=True)
    width = len(rows[0]) if rows else 7
    if not style:
        style = "sphere" if width in (7, 10) else "atomic"
    wide = _SPHERE[style]
    for row, place in zip(rows, places):
        if len(row) not in (wide, wide + 3):
            raise lines.error(f"{len(row)} values found in section Atoms, {wide} expected ({'id type diameter density x y z' if wide == 7 else 'id type x y z'}), "
                              "or three more", place)
    if style == "atomic" and need_radius:
        raise lines.error("atoms of style atomic have no radius; give the radius of all", places[0] if places else None)
    ids = lines.numbers(rows, places, [0, 1], "section Atoms", whole=True)
    _unique(lines, ids[:, 0], places)
    values = lines.numbers(rows, places, range(2, wide), "section Atoms")
    parts: dict[str, Any] = {"id": ids[:, 0], "kind": ids[:, 1], "position": values[:, -3:]}
    if style != "atomic":
        wrong = np.flatnonzero(values[:, 0] <= 0)
        if len(wrong) and need_radius:
            raise lines.error(f"the diameter is {rows[wrong[0]][2]}; above 0 expected: points of no size cannot be read", places[wrong[0]])
        parts.update(radius=values[:, 0] / 2, density=values[:, 1])
    return parts


def _data_velocities(lines: _Lines, ids: np.ndarray, count: int) -> dict[str, Any]:
    rows, places = lines.rows(count, "section Velocities", comments=True)
    width = len(rows[0]) if rows else 7
    for row, place in zip(rows, places):
        if len(row) != width or width not in (4, 7):
            raise lines.error(f"{len(row)} values found in section Velocities, 4 or 7 expected (id vx vy vz wx wy wz), in all lines as many", place)
    own = lines.numbers(rows, places, [0], "section Velocities", whole=True)[:, 0]
    _unique(lines, own, places)
    unknown = np.flatnonzero(~np.isin(own, ids))
    if len(unknown):
        raise lines.error(f"id {own[unknown[0]]} is not in section Atoms", places[unknown[0]])
    order = np.argsort(own)[np.argsort(np.argsort(ids))]  # row of each atom
    values = lines.numbers(rows, places, range(1, width), "section Velocities")[order]
    return {"velocity": values[:, :3], "angular_velocity": values[:, 3:] if width == 7 else None}


def _text(values: Any) -> str:
    return " ".join(map(repr, values))


def write_data(file: IO[str], p: Packing) -> None:
    """A data file for `atom_style sphere` (LIGGGHTS: the same), in `units si`. Bodies without a density have 1000 kg/m^3."""
    lower, upper = p.box
    kinds = int(p.kind.max(initial=1))
    file.write(f"Spheres written by Scree: SI units, atom_style sphere\n\n{len(p)} atoms\n{kinds} atom types\n")
    for k, axis in enumerate("xyz"):
        file.write(f"{float(lower[k])!r} {float(upper[k])!r} {axis}lo {axis}hi\n")
    density = np.full(len(p), 1000.0) if p.density is None else p.density
    file.write("\nAtoms # sphere\n\n")
    columns = (p.id, p.kind, 2 * p.radius, density, *p.position.T)
    file.writelines(_text(row) + "\n" for row in zip(*(c.tolist() for c in columns)))
    if p.velocity is not None:
        spin = np.zeros((len(p), 3)) if p.angular_velocity is None else p.angular_velocity
        file.write("\nVelocities\n\n")
        file.writelines(_text(row) + "\n" for row in zip(*(c.tolist() for c in (p.id, *p.velocity.T, *spin.T))))


# LAMMPS and LIGGGHTS: dumps

def read_dump(path: str, need_radius: bool, step: int | None = None) -> dict[str, Any]:
    """A moment of a text dump (dump custom): columns by their names, in any order."""
    lines = _Lines(path)
    found: list[int] = []
    chosen = None
    while (moment := _dump_moment(lines)) is not None:
        found.append(moment["step"])
        if step is None or moment["step"] == step:
            chosen = moment
    if chosen is None:
        steps = ", ".join(map(str, found[:10])) + (f" and {len(found) - 10} more" if len(found) > 10 else "")
        raise InputError(f"{path}: {'no line ITEM: TIMESTEP' if step is None else f'no step {step}; there are: {steps or None}'}")
    return _dump_columns(lines, chosen, need_radius)


def _dump_moment(lines: _Lines) -> dict[str, Any] | None:
    """The next moment, its atoms as words; None at the end."""
    m: dict[str, Any] = {"time": 0.0, "periodic": (False,) * 3}
    while (line := lines.next()) is not None:
        if not line.strip():
            continue
        if not line.startswith("ITEM:"):
            raise lines.error(f"'{line[:40]}': a line that begins with ITEM: expected")
        item = line[5:].strip()
        if item in ("TIMESTEP", "NUMBER OF ATOMS", "TIME", "UNITS"):
            rows, places = lines.rows(1, item)
            if item == "TIME":
                m["time"] = float(lines.numbers(rows, places, [0], item)[0, 0])
            elif item != "UNITS":
                m["step" if item == "TIMESTEP" else "count"] = int(lines.numbers(rows, places, [0], item, whole=True)[0, 0])
        elif item.startswith("BOX BOUNDS"):
            words = item.split()[2:]
            if "xy" in words:
                raise lines.error("a box with slanted sides (xy xz yz) cannot be read; only one with right angles")
            rows, places = lines.rows(3, "BOX BOUNDS")
            m["bounds"] = lines.numbers(rows, places, [0, 1], "BOX BOUNDS")
            m["periodic"] = tuple(word == "pp" for word in words) if len(words) == 3 else (False,) * 3
        elif item.startswith("ATOMS"):
            missing = [name for key, name in (("step", "TIMESTEP"), ("count", "NUMBER OF ATOMS"), ("bounds", "BOX BOUNDS")) if key not in m]
            if missing:
                raise lines.error(f"ITEM: ATOMS without ITEM: {missing[0]} before it")
            m["names"], m["line"] = item.split()[1:], lines.number
            m["rows"], m["places"] = lines.rows(m["count"], f"the atoms of step {m['step']}")
            for row, place in zip(m["rows"], m["places"]):
                if len(row) != len(m["names"]):
                    raise lines.error(f"{len(row)} values found, {len(m['names'])} expected ({' '.join(m['names'])})", place)
            return m
        else:
            raise lines.error(f"'ITEM: {item}' is unknown; TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, ATOMS, TIME, UNITS expected")
    if "step" in m:
        raise lines.error(f"the file ends within step {m['step']}, before ITEM: ATOMS")
    return None


def _dump_columns(lines: _Lines, m: dict[str, Any], need_radius: bool) -> dict[str, Any]:
    names, rows, places = m["names"], m["rows"], m["places"]

    def values(wanted: str, whole: bool = False) -> np.ndarray | None:
        columns = wanted.split()
        if not all(c in names for c in columns):
            return None
        array = lines.numbers(rows, places, [names.index(c) for c in columns], "ITEM: ATOMS", whole)
        return array if len(columns) > 1 else array[:, 0]

    bounds = m["bounds"]
    found = [place for place in _PLACES if values(place) is not None]
    if not found:
        raise lines.error(f"no positions in the columns {' '.join(names)}; x y z, xu yu zu or xs ys zs expected", m["line"])
    position = values(found[0])
    if "xs" in found[0]:
        position = bounds[:, 0] + position * (bounds[:, 1] - bounds[:, 0])
    diameter = values("diameter")
    radius = values("radius") if diameter is None else diameter / 2
    if radius is None and need_radius:
        raise lines.error(f"no column radius or diameter among {' '.join(names)}; give the radius of all, or dump the radius", m["line"])
    ids = values("id", whole=True)
    if ids is not None:
        _unique(lines, ids, places)
    return {"id": ids, "kind": values("type", whole=True), "position": position, "radius": radius, "velocity": values("vx vy vz"),
            "angular_velocity": values("omegax omegay omegaz"), "quaternion": values("quatw quati quatj quatk"), "density": values("density"),
            "lower": bounds[:, 0], "upper": bounds[:, 1], "periodic": m["periodic"], "step": m["step"], "time": m["time"]}


def write_dump(file: IO[str], p: Packing) -> None:
    """A dump of one moment, with the columns that there are."""
    lower, upper = p.box
    sides = " ".join("pp" if periodic else "ff" for periodic in p.periodic)
    file.write(f"ITEM: TIMESTEP\n{p.step}\nITEM: NUMBER OF ATOMS\n{len(p)}\nITEM: BOX BOUNDS {sides}\n")
    file.writelines(f"{float(a)!r} {float(b)!r}\n" for a, b in zip(lower, upper))
    columns = {"id": p.id, "type": p.kind, **dict(zip("xyz", p.position.T)), "radius": p.radius}
    for names, values in (("vx vy vz", p.velocity), ("omegax omegay omegaz", p.angular_velocity), ("quatw quati quatj quatk", p.quaternion)):
        if values is not None:
            columns.update(zip(names.split(), values.T))
    if p.density is not None:
        columns["density"] = p.density
    file.write(f"ITEM: ATOMS {' '.join(columns)}\n")
    file.writelines(_text(row) + "\n" for row in zip(*(c.tolist() for c in columns.values())))


# Yade: lists of spheres

def read_yade(path: str, _: bool = True, __: int | None = None) -> dict[str, Any]:
    """A list of spheres: x y z r in each line, and what a line `#format x_y_z_r_matId` at the top names; more columns are left out."""
    lines = _Lines(path)
    names = ["x", "y", "z", "r"]
    rows: list[list[str]] = []
    places: list[int] = []
    periodic = None
    while (line := lines.next()) is not None:
        form = re.match(r"#\s*format\s+(\S+)", line)
        if form:
            names = form[1].split("_")
            if rows or not {"x", "y", "z", "r"} <= set(names):
                raise lines.error(f"'{line.strip()}': a format with x, y, z and r, before the first sphere, expected")
        cell = re.match(r"##PERIODIC::\s*(.*)", line)  # as SpherePack.save writes it
        if cell:
            periodic = lines.numbers([cell[1].split()], [lines.number], [0, 1, 2], "the period")[0] if len(cell[1].split()) == 3 else None
        words = line.partition("#")[0].split()
        if words:
            if len(words) < len(names):
                raise lines.error(f"{len(words)} values found, {len(names)} expected ({' '.join(names)})")
            rows.append(words)
            places.append(lines.number)
    values = lines.numbers(rows, places, [names.index(c) for c in "xyzr"], "the spheres")
    wrong = np.flatnonzero(values[:, 3] <= 0)
    if len(wrong):
        raise lines.error(f"the radius is {rows[wrong[0]][names.index('r')]}; above 0 expected", places[wrong[0]])
    parts: dict[str, Any] = {"position": values[:, :3], "radius": values[:, 3]}
    if "id" in names:
        parts["id"] = lines.numbers(rows, places, [names.index("id")], "the ids", whole=True)[:, 0]
        _unique(lines, parts["id"], places)
    if "matId" in names:
        parts["kind"] = lines.numbers(rows, places, [names.index("matId")], "the materials", whole=True)[:, 0] + 1  # Yade counts from 0
    if periodic is not None:
        parts.update(lower=np.zeros(3), upper=periodic, periodic=(True,) * 3)
    return parts


def write_yade(file: IO[str], p: Packing) -> None:
    """x y z r of each, and, with several kinds, the material for `ymport.textExt` (from 0); `ymport.text` reads the first four."""
    several = len(p) > 0 and bool((p.kind != 1).any())
    file.write("#format x_y_z_r" + ("_matId" if several else "") + "\n")
    columns = (*p.position.T, p.radius, *((p.kind - 1,) if several else ()))
    file.writelines(_text(row) + "\n" for row in zip(*(c.tolist() for c in columns)))
