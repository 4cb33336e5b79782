"""Tables: log.csv, ranks.csv, the tables of scree-post, and own ones."""
from __future__ import annotations

import csv
import html
import io
import os
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from .errors import InputError, missing_package, unknown_name

_WHOLE = {"step", "id", "rank", "bodies", "body_a", "body_b", "feature", "frames", "blocks"}  # columns of whole numbers
_TEXT = {"state_hash", "name", "group", "quantity", "unit", "meaning", "reason", "kind", "shape", "inlet", "outlet", "gate"}  # never numbers, whatever they look like


def _column(name: str, cells: Sequence[str]) -> np.ndarray:
    if name not in _TEXT:
        try:
            if name in _WHOLE:
                return np.array([int(cell) for cell in cells], dtype=np.int64)
            return np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
        except (ValueError, OverflowError):
            pass
    return np.array(cells, dtype=object)


class Table(Mapping[str, np.ndarray]):
    """Columns of equal length by name, with units. A mapping: `table["time"]`, `list(table)`, `"time" in table`, `table.items()`.

    A table of own numbers: `Table({"friction": [0.2, 0.4], "angle": [21.0, 27.5]}, {"angle": "deg"})`.
    """

    def __init__(self, columns: Mapping[str, Any], units: Mapping[str, str] | None = None, source: str = "",
                 also: Mapping[str, str] | None = None) -> None:
        """columns: name -> values, all of one length; units: name -> SI unit, "-" for a number without; source: where it was read;
        also: further names of columns, name -> column."""
        self._columns = {name: np.asarray(values) for name, values in columns.items()}
        self._units = {name: (units or {}).get(name, "-") for name in self._columns}
        self._source = source
        self._also = dict(also or {})
        lengths = {name: len(values) for name, values in self._columns.items()}
        if len(set(lengths.values())) > 1:
            raise InputError(f"{source or 'table'}: columns of different lengths: {lengths}")

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Table:
        """Reads a CSV table with a header and, if there is one, a second line `# units: ...`.

        A last line that is not ended or not complete is left out: the solver may be writing it.
        Raises InputError when the file is missing or is no such table.
        """
        source = os.fspath(path)
        try:
            with open(source, encoding="utf-8", errors="replace", newline="") as file:
                text = file.read()
        except OSError as error:
            raise InputError(f"{source}: {error.strerror}") from error
        text = text[: text.rfind("\n") + 1]
        lines = csv.reader(io.StringIO(text))
        try:
            names = next(lines, None)
        except csv.Error as error:
            raise InputError(f"{source}: its header: {error}; the file is damaged") from error
        if not names:
            raise InputError(f"{source}: empty; a table with a header expected")
        units: dict[str, str] = {}
        rows: list[list[str]] = []
        try:
            for row in lines:
                if row and row[0].startswith("#"):
                    if row[0].startswith("# units:"):
                        units = dict(zip(names, [row[0].removeprefix("# units:").strip(), *row[1:]]))
                elif row:
                    rows.append(row)
        except csv.Error as error:
            raise InputError(f"{source}: line {lines.line_num}: {error}; the file is damaged") from error
        if rows and len(rows[-1]) != len(names):
            rows.pop()
        for number, row in enumerate(rows, 1):
            if len(row) != len(names):
                raise InputError(f"{source}: row {number}: {len(row)} values found, {len(names)} expected")
        cells = zip(*rows) if rows else ([] for _ in names)
        return cls({name: _column(name, list(column)) for name, column in zip(names, cells)}, units, source)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column by name; "-" for a number without a unit."""
        return dict(self._units)

    @property
    def rows(self) -> int:
        """Number of rows. (`len(table)` is the number of columns, as of any mapping.)"""
        return len(next(iter(self._columns.values()))) if self._columns else 0

    def __getitem__(self, name: str) -> np.ndarray:
        try:
            return self._columns[self._also.get(name, name)]
        except KeyError:
            raise unknown_name(f"{self._source or 'table'}: column", name, [*self._columns, *self._also]) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def where(self, mask: Any) -> Table:
        """The rows for which a mask is true, or of a slice or of row numbers: `log.where(log["time"] > 1)`."""
        return Table({name: values[mask] for name, values in self._columns.items()}, self._units, self._source, self._also)

    def write(self, path: str | os.PathLike[str]) -> str:
        """Writes the table as CSV with a line of units, all digits; returns the path."""
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self._columns)
            file.write("# units: " + ",".join(self._units.values()) + "\n")
            writer.writerows(zip(*(values.tolist() for values in self._columns.values())))
        return os.fspath(path)

    def to_pandas(self) -> Any:
        """A pandas.DataFrame; its units are in `frame.attrs["units"]`. Raises MissingPackage without pandas."""
        try:
            import pandas
        except ImportError:
            raise missing_package("to_pandas", "pandas") from None
        frame = pandas.DataFrame({name: np.array(values) for name, values in self._columns.items()})
        frame.attrs["units"] = self.units
        return frame

    def __repr__(self) -> str:
        shown = ", ".join(list(self._columns)[:6]) + (", ..." if len(self._columns) > 6 else "")
        return f"<scree.Table {self.rows} rows x {len(self._columns)} columns: {shown}>"

    def _repr_html_(self) -> str:
        if self.rows <= 12:
            chosen = list(range(self.rows))
        else:
            chosen = [*range(8), -1, *range(self.rows - 3, self.rows)]
        head = "".join(f"<th>{html.escape(n)}<br><small>{html.escape(u)}</small></th>" for n, u in self._units.items())
        body = ""
        for row in chosen:
            cells = ("..." if row < 0 else values[row] for values in self._columns.values())
            body += "<tr>" + "".join(f"<td>{html.escape(f'{c:.6g}' if isinstance(c, float) else str(c))}</td>" for c in cells) + "</tr>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table><p>{self.rows} rows</p>"
