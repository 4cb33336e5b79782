"""Case files (decomposer/CASE.md): read, change, check, write."""
from __future__ import annotations

import copy
import os
import re
import tomllib
from collections.abc import Iterator, Sequence
from typing import Any

from .errors import InputError, UsageError, unknown_name
from .schema import case_schema, problems_of
from .toml_text import Document, plain


# A key or header of more parts than the tool takes (decomposer/case/parse_toml.hpp): tomllib needs minutes for some ten thousand.
_MANY_PARTS = re.compile(r"""^[ \t]*\[{0,2}(?:[ \t]*(?:"[^"\n]*"|'[^'\n]*'|[\w-]+)[ \t]*\.){16}""", re.M)


class Case:
    """A case. Keys are those of `scree-decomposer pack --set`: names with dots between, lists by number, `*` for all of a list or table.

        case = scree.Case("drum.toml")
        case["time.duration"] = "2 s"
        case["pairs.*.friction"] = 0.4
        case.save("rougher.toml")

    `data` has all of it as dicts and lists, to be changed at will. Comments of the file are kept, except those between the lines of a
    list that is changed, and those of keys that are removed.
    """

    def __init__(self, path: str | os.PathLike[str] | None = None) -> None:
        """path: case.toml; None for an empty case. Raises InputError when it cannot be read; UsageError when it is no TOML."""
        self.path: str | None = None if path is None else os.fspath(path)  #: file it was read from or saved to
        text = ""
        if self.path is not None:
            try:
                with open(self.path, encoding="utf-8") as file:
                    text = file.read()
            except (OSError, UnicodeDecodeError) as error:
                raise InputError(f"{self.path}: cannot be read: {error}") from error
        self._load(text)

    @classmethod
    def from_text(cls, text: str, path: str | None = None) -> Case:
        """A case from TOML text. path: its name in messages, and what its paths are relative to. Raises UsageError when it is no TOML."""
        case = cls()
        case.path = path
        case._load(text)
        return case

    def _load(self, text: str) -> None:
        text = text.removeprefix("\ufeff")
        try:
            if _MANY_PARTS.search(text):
                raise RecursionError
            self._document = Document(text)
        except tomllib.TOMLDecodeError as error:
            raise UsageError(f"{self.path or 'case'}: no TOML: {error}") from error
        except RecursionError:
            raise UsageError(f"{self.path or 'case'}: tables within tables that no case has; expected keys as in CASE.md") from None
        self._read: str | None = text

    @property
    def data(self) -> dict[str, Any]:
        """All of the case: tables as dicts, `[[...]]` as lists of dicts. May be changed."""
        return self._document.data

    def copy(self) -> Case:
        """A second case that can be changed without changing this one."""
        return Case.from_text(self.text(), self.path)

    def _found(self, key: str, parts: list[str], create: bool) -> Iterator[tuple[Any, Any]]:
        """(holder, name or number) of each value that a key means."""
        nodes: list[Any] = [self.data]
        for depth, part in enumerate(parts):
            last, below = depth + 1 == len(parts), []
            for node in nodes:
                names: list[Any] = [part]
                if isinstance(node, list):
                    if part != "*" and not (part.isdigit() and int(part) < len(node)):
                        raise unknown_name(f"{key}: entry", part, [*range(len(node)), "*"])
                    names = list(range(len(node))) if part == "*" else [int(part)]
                elif not isinstance(node, dict):
                    raise UsageError(f"{key}: {'.'.join(parts[:depth])} is neither a table nor a list")
                elif part == "*":
                    names = list(node)
                elif part not in node and not create:
                    raise unknown_name(f"{key}: key", part, node)
                for name in names:
                    if last:
                        yield node, name
                    else:
                        below.append(node.setdefault(name, {}) if isinstance(node, dict) and create else node[name])
            nodes = below

    def __getitem__(self, key: str) -> Any:
        """The value of a key; with `*` in it, the list of all that it means. Raises UnknownName."""
        values = [holder[name] for holder, name in self._found(key, key.split("."), create=False)]
        return values if "*" in key.split(".") else values[0]

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets a key, or all that a key with `*` means; missing tables are made. numpy numbers and arrays are allowed."""
        for holder, name in list(self._found(key, key.split("."), create=True)):
            holder[name] = copy.deepcopy(plain(value))

    def __delitem__(self, key: str) -> None:
        """Removes a key, or all that a key with `*` means. Raises UnknownName."""
        for holder, name in reversed(list(self._found(key, key.split("."), create=False))):
            del holder[name]

    def __contains__(self, key: str) -> bool:
        try:
            return bool(list(self._found(key, key.split("."), create=False)))
        except UsageError:
            return False

    def add_bodies(self, shape: str, material: str | Sequence[str], position: Any, quaternion: Any = None, velocity: Any = None, angular_velocity: Any = None,
                   scale: Any = None, fixed: bool = False) -> None:
        """Adds a body of `[[bodies]]` for each row of `position`: a packing of your own.

        shape, material    names in the case; of materials one for all, or n
        position           n x 3 [m], centres of mass
        quaternion         n x 4, unit, w x y z; None: not turned
        velocity           n x 3 [m/s]; angular_velocity n x 3 [rad/s], world axes; None: 0
        scale              n factors on the size of the shape, or one for all; None: 1
        """
        positions = plain(position)
        if positions and not isinstance(positions[0], list):
            positions = [positions]
        count = len(positions)
        columns = {"material": [material] * count if isinstance(material, str) else list(material), "position": positions}
        if len(columns["material"]) != count:
            raise UsageError(f"add_bodies: {len(columns['material'])} materials for {count} positions")
        for name, values in (("orientation", quaternion), ("velocity", velocity), ("angular_velocity", angular_velocity), ("scale", scale)):
            if values is not None:
                rows = plain(values)
                columns[name] = rows if isinstance(rows, list) and (name == "scale" or not rows or isinstance(rows[0], list)) else [rows] * count
                if len(columns[name]) != count:
                    raise UsageError(f"add_bodies: {len(columns[name])} values of {name} for {count} positions")
        for row in range(count):
            body: dict[str, Any] = {"shape": shape, **{name: values[row] for name, values in columns.items()}}
            self.data.setdefault("bodies", []).append({**body, "fixed": True} if fixed else body)

    def problems(self) -> list[str]:
        """What is wrong with the case by the schema of the case language, with file, line and key each; empty when nothing is.

        Whether names exist and numbers fit together only the tool can say: `scree.call("decomposer", "check", case.path)`.
        """
        unchanged = self.text() == self._read
        found = []
        for place, message in problems_of(plain(self.data), case_schema()):
            line = self._document.line_of(place) if unchanged else 0
            found.append(f"{self.path or 'case'}{f':{line}' if line else ''}: {'.'.join(map(str, place)) or 'case'}: {message}")
        return found

    def check(self) -> None:
        """Raises UsageError with all `problems()` when there are any."""
        problems = self.problems()
        if problems:
            raise UsageError("\n".join(problems))

    def text(self) -> str:
        """The case as TOML. Raises UsageError for a value that TOML does not have, such as None."""
        try:
            return self._document.text()
        except TypeError as error:
            raise UsageError(f"{self.path or 'case'}: {error}") from error

    def save(self, path: str | os.PathLike[str] | None = None, check: bool = True) -> str:
        """Writes the case, whole or not at all, and returns the path.

        path   where to; None: where it was read from. Relative paths of meshes and shapes are changed so that they mean the same files
        check  whether to check it by the schema first. Raises UsageError with all problems; nothing is written then
        """
        if path is None and self.path is None:
            raise UsageError("save: give a path; this case was not read from a file")
        target = os.fspath(path) if path is not None else str(self.path)
        if check:
            self.check()
        text = self._moved_to(os.path.dirname(os.path.abspath(target)))
        partial = f"{target}.{os.getpid()}.part"
        try:
            with open(partial, "w", encoding="utf-8") as file:
                file.write(text)
            os.replace(partial, target)
        finally:
            if os.path.exists(partial):
                os.remove(partial)
        self.path, self._read = target, None  # the lines are other ones now
        return target

    def _moved_to(self, folder: str) -> str:
        """Text for another folder: paths relative to the case lead to the same files."""
        if self.path is not None:
            home = os.path.dirname(os.path.abspath(self.path))
            if home != folder:
                for table, key in _paths_of(self.data):
                    if not os.path.isabs(table[key]):
                        table[key] = os.path.relpath(os.path.join(home, table[key]), folder)
        return self.text()

    def __repr__(self) -> str:
        return f"<scree.Case '{self.path or 'not saved'}': {', '.join(self.data) or 'empty'}>"

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self.text())}</pre>"


def _paths_of(data: dict[str, Any]) -> Iterator[tuple[dict[str, Any], str]]:
    """(table, key) of each path of a case: `run` of [start], `file` and `pieces` of shapes, `file` of walls, `inside` of regions."""
    start = data.get("start")
    if isinstance(start, dict) and isinstance(start.get("run"), str):
        yield start, "run"
    yield from _paths_in(data)


def _paths_in(node: Any) -> Iterator[tuple[dict[str, Any], str]]:
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("file", "pieces", "inside") and isinstance(value, str):
                yield node, key
            else:
                yield from _paths_in(value)
    elif isinstance(node, list):
        for value in node:
            yield from _paths_in(value)
