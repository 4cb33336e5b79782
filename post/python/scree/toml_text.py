"""TOML text that is changed and written again.

What is not changed keeps its text, comments included: a file is read as statements (a key with its value, and the comment lines above it),
and a statement is written as it stood while its value is the same. A changed value keeps the comments above it and behind it, but not
those between the lines of a list. Removed keys and tables take their comments with them. Tables of one name are written together.
"""
from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass, field
from typing import Any

Path = tuple[Any, ...]  # names of tables and keys, numbers in lists


@dataclass
class _Statement:
    before: str  # comments and blank lines above
    path: Path  # of its key, within its table
    source: str
    value: Any


@dataclass
class _Block:
    before: str
    header: str
    statements: list[_Statement] = field(default_factory=list)


def plain(value: Any) -> Any:
    """A value as TOML has it: numpy scalars and arrays, tuples and paths become numbers, lists and texts."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "__fspath__"):
        return value.__fspath__()
    if isinstance(value, dict):
        return {str(key): plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    return value


def _same(a: Any, b: Any) -> bool:
    if type(a) is not type(b):
        return False
    if isinstance(a, dict):
        return list(a) == list(b) and all(_same(a[k], b[k]) for k in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(_same, a, b))
    return bool(a == b)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)


def value_text(value: Any) -> str:
    """A value on one line; tables become inline tables."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {value_text(v)}" for k, v in value.items()) + " }" if value else "{}"
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (int, float)) or hasattr(value, "isoformat"):
        return value.isoformat() if hasattr(value, "isoformat") else repr(value)
    raise TypeError(f"{value!r}: a {type(value).__name__} is no value of TOML")


def _nested_path(table: dict[str, Any], stop: Any) -> Path:
    """Names down to the value `stop` in a table with one key at each level."""
    path: list[str] = []
    node: Any = table
    while isinstance(node, dict) and node is not stop and node:
        name, node = next(iter(node.items()))
        path.append(name)
        if isinstance(node, list):
            break
    return tuple(path)


def _statement_path(source: str) -> Path:
    """Names of the key of a statement: of `a.b = 1` (a, b)."""
    for match in re.finditer("=", source):
        try:
            table = tomllib.loads(source[: match.start()] + "= 0")
        except tomllib.TOMLDecodeError:
            continue  # an = within a quoted key
        return _nested_path(table, None)
    raise ValueError(source)


def _at(table: Any, path: Path) -> Any:
    for name in path:
        table = table[name]
    return table


class Document:
    """A TOML file: `data`, its values, may be changed at will, and `text()` writes them with the comments of the file."""

    def __init__(self, text: str) -> None:
        """Raises tomllib.TOMLDecodeError."""
        text = text.removeprefix("\ufeff")  # the byte order mark of an editor
        self.data: dict[str, Any] = tomllib.loads(text)
        self._blocks: dict[int, _Block] = {id(self.data): _Block("", "")}
        self._tables: list[Any] = [self.data]  # kept alive: their ids name them
        self._lines: dict[Path, int] = {}
        self._tail = ""
        self._scan(text.replace("\r\n", "\n"))

    def _scan(self, text: str) -> None:
        # lines of TOML end with a line feed alone, not with the separators that str.splitlines() knows
        lines, at, before = re.findall(r"[^\n]*\n|[^\n]+", text), 0, ""
        counts: dict[Path, int] = {}
        table = self.data
        path: Path = ()
        while at < len(lines):
            begin, line = at + 1, lines[at]
            at += 1
            if not line.strip() or line.lstrip().startswith("#"):
                before += line
            elif line.lstrip().startswith("["):
                names = _nested_path(tomllib.loads(line), None)
                table, path = self._resolve(names, counts, line.lstrip().startswith("[["))
                self._tables.append(table)
                self._blocks[id(table)] = _Block(before, line if line.endswith("\n") else line + "\n")
                self._lines[path] = begin
                before = ""
            else:
                source = line
                while True:
                    try:
                        value = tomllib.loads(source)
                        break
                    except tomllib.TOMLDecodeError:
                        source += lines[at]
                        at += 1
                names = _statement_path(source)
                self._blocks[id(table)].statements.append(_Statement(before, names, source, _at(value, names)))
                self._lines[path + names] = begin
                before = ""
        self._tail = before

    def _resolve(self, names: Path, counts: dict[Path, int], begins: bool) -> tuple[dict[str, Any], Path]:
        """The table that a header means, and its path. A [[header]] begins the next entry of the list of that path: each wall has its own
        [[walls.motion]]."""
        node: Any = self.data
        path: list[Any] = []
        for depth, name in enumerate(names, 1):
            node = node[name]
            path.append(name)
            if isinstance(node, list):
                if begins and depth == len(names):
                    counts[tuple(path)] = counts.get(tuple(path), 0) + 1
                index = counts[tuple(path)] - 1
                node = node[index]
                path.append(index)
        return node, tuple(path)

    def line_of(self, path: Path) -> int:
        """Line of a value, or of what holds it, in the file as it was read; 0 when the file does not have it."""
        while path:
            if path in self._lines:
                return self._lines[path]
            path = path[:-1]
        return 0

    def text(self) -> str:
        """The data as TOML."""
        return write(self.data, self) + self._tail

    def block_of(self, table: Any) -> _Block | None:
        """How a table stood in the file; None for a new one."""
        return self._blocks.get(id(table))


def _is_block(value: Any, depth: int, parent: dict[str, Any], document: Document) -> bool:
    """Whether a value is written as a table with a header of its own."""
    if isinstance(value, list):
        return bool(value) and all(isinstance(v, dict) for v in value) and (depth == 0 or any(document.block_of(v) is not None for v in value))
    if not isinstance(value, dict):
        return False
    if document.block_of(value) is not None or any(isinstance(v, dict) and document.block_of(v) is not None for v in value.values()):
        return True
    return depth == 0 or (depth == 1 and all(isinstance(v, dict) for v in parent.values()))


def _leaves(table: dict[str, Any], prefix: Path, dotted: set[Path]) -> list[tuple[Path, Any]]:
    """Keys of a table; those below a dotted key of the file one by one."""
    found: list[tuple[Path, Any]] = []
    for name, value in table.items():
        path = (*prefix, name)
        found += _leaves(value, path, dotted) if path in dotted and isinstance(value, dict) else [(path, value)]
    return found


def _comment_behind(statement: _Statement) -> tuple[str, int]:
    """The comment behind a value, and its column."""
    for match in re.finditer("#", statement.source):
        try:
            if _same(_at(tomllib.loads(statement.source[: match.start()]), statement.path), statement.value):
                return statement.source[match.start() :].rstrip("\n"), match.start() - statement.source.rfind("\n", 0, match.start()) - 1
        except (tomllib.TOMLDecodeError, KeyError):
            continue
    return "", 0


def _table_text(table: dict[str, Any], names: list[str], is_element: bool, document: Document) -> str:
    block = document.block_of(table)
    statements = block.statements if block else []
    dotted = {statement.path[:k] for statement in statements for k in range(1, len(statement.path))}
    below = [name for name, value in table.items() if (name,) not in dotted and _is_block(value, len(names), table, document)]
    below = [name for name in below if not any(statement.path == (name,) for statement in statements)]  # an inline table stays one
    leaves = dict(_leaves({k: v for k, v in table.items() if k not in below}, (), dotted))
    text = ""
    if block is not None:
        text = block.before + block.header
    elif names and (is_element or leaves or not below):
        header = ".".join(map(_key, names))
        text = f"\n[[{header}]]\n" if is_element else f"\n[{header}]\n"
    for statement in statements:
        if statement.path in leaves:
            value = plain(leaves.pop(statement.path))
            text += statement.before
            if _same(value, statement.value):
                text += statement.source if statement.source.endswith("\n") else statement.source + "\n"
            else:
                comment, column = _comment_behind(statement)
                line = f"{'.'.join(map(_key, statement.path))} = {value_text(value)}"
                text += (line.ljust(column - 1) + " " + comment if comment else line) + "\n"
    for path, value in leaves.items():
        text += f"{'.'.join(map(_key, path))} = {value_text(plain(value))}\n"
    for name in below:
        value = table[name]
        parts = value if isinstance(value, list) else [value]
        text += "".join(_table_text(part, [*names, name], isinstance(value, list), document) for part in parts)
    return text


def write(data: dict[str, Any], document: Document) -> str:
    """Values as TOML, with the text of the document where they are unchanged."""
    return _table_text(data, [], False, document)
