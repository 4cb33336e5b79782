"""Runs: NAME.run as a whole (core/storage/RUN_FORMAT.md)."""
from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

from .case import Case
from .errors import InputError, unknown_name
from .frames import Frame, Frames, frames_of
from .rows import Bodies
from .scene import Material, Named, Scene, Shapes, Wall
from .tables import Table

_NEWEST = 1


class Statistics(Mapping[str, Table]):
    """The folder that `scree-post statistics` wrote: its tables by name without ".csv", `summary`, `series`, `walls`, `profile_z` ..."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """folder: NAME.statistics. Raises InputError when it has no statistics.json or a newer one."""
        self.folder: str = os.fspath(folder)  #: it was read from
        path = os.path.join(self.folder, "statistics.json")
        if not os.path.exists(path):
            raise InputError(f"{path}: no such file; make it with scree-post statistics NAME.run -o {self.folder}")
        self.numbers: dict[str, Any] = _json_file(path, "scree-statistics")  #: all of statistics.json
        self._names = sorted(name.removesuffix(".csv") for name in os.listdir(self.folder) if name.endswith(".csv"))
        self._tables: dict[str, Table] = {}

    def mean(self, quantity: str, group: str = "all") -> float:
        """Mean of a quantity over the frames, SI. Raises UnknownName."""
        return float(self._entry(quantity, group)["mean"])

    def ci95(self, quantity: str, group: str = "all") -> float:
        """Half width of the 95 % confidence interval of the mean; NaN with fewer than two blocks. Raises UnknownName."""
        value = self._entry(quantity, group).get("ci95")
        return float("nan") if value is None else float(value)

    def _entry(self, quantity: str, group: str) -> dict[str, Any]:
        groups = self.numbers["groups"]
        if group not in groups:
            raise unknown_name(f"{self.folder}: group", group, groups)
        if quantity not in groups[group]:
            raise unknown_name(f"{self.folder}: quantity", quantity, groups[group])
        return groups[group][quantity]

    def __getitem__(self, name: str) -> Table:
        if name not in self._names:
            raise unknown_name(f"{self.folder}: table", name, self._names)
        if name not in self._tables:
            self._tables[name] = Table.read(os.path.join(self.folder, name + ".csv"))
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __fspath__(self) -> str:
        return self.folder

    def __repr__(self) -> str:
        return f"<scree.Statistics '{self.folder}': {', '.join(self._names)}>"


def _json_file(path: str, file_format: str) -> dict[str, Any]:
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            value = json.load(file)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: the file is damaged: {error}") from error
    if not isinstance(value, dict) or value.get("format") != file_format:
        raise InputError(f"{path}: not a {file_format}")
    if not isinstance(value.get("format_version", _NEWEST), int):
        raise InputError(f"{path}: format_version {value['format_version']!r} found, a whole number expected; the file is damaged")
    if value.get("format_version", _NEWEST) > _NEWEST:
        raise InputError(f"{path}: version {value['format_version']} of {file_format}; this package reads up to version {_NEWEST}; use a newer Scree")
    return value


class Run:
    """A run of scree-solver. What is read: the scene at once, log and tables when first used, frames field by field.

    A run that is still being written, or was killed, is read up to its last complete frame; `outcome` is then None. Open it again to see more.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """folder: NAME.run. Raises InputError when it is no run folder, or its scene or run.json is damaged or newer."""
        self.folder: str = os.fspath(folder).rstrip("/") or "/"  #: as given
        if not os.path.isdir(self.folder):
            raise InputError(f"{self.folder}: no such run folder; give the NAME.run that scree-solver wrote")
        self.name: str = os.path.basename(os.path.abspath(self.folder)).removesuffix(".run")  #: NAME of NAME.run
        path = os.path.join(self.folder, "run.json")
        #: contents of run.json: "outcome", "steps", "step_size" [s], "energy", "wall_seconds" ... SI; None while the run is being written
        self.outcome: dict[str, Any] | None = _json_file(path, "scree-run") if os.path.exists(path) else None
        for key, kind in (("outcome", str), ("message", str), ("provenance", dict)) if self.outcome is not None else ():
            if not isinstance(self.outcome.get(key), kind):
                raise InputError(f"{path}: {key}: {self.outcome.get(key)!r} found, {'a text' if kind is str else 'a table'} expected; the file is damaged")
        self.scene: Scene = Scene(os.path.join(self.folder, "scene.h5"))  #: what was run
        self.frames: Frames = frames_of(self.folder, self.scene)  #: by ascending time

    def bodies(self, frame: int | Frame = -1) -> Bodies:
        """The bodies of a frame, by its place in `frames` (-1 is the last): `run.bodies(-1).in_region(...)`."""
        return (frame if isinstance(frame, Frame) else self.frames[frame]).bodies

    def _table(self, name: str) -> Table:
        return Table.read(os.path.join(self.folder, name))

    @cached_property
    def log(self) -> Table:
        """log.csv: time, energies, contacts, loads on walls, one row per interval. Columns and units: RUN_FORMAT.md.

        What is of a wall has the name of the wall, too: `log["axis_torque@drum"]` is `log["wall7_axis_torque"]` where the drum has id 7.
        """
        log = self._table("log.csv")
        walls = self.scene.walls.in_order
        names = [wall.name for wall in walls]
        also = {f"{column.removeprefix(f'wall{wall.id}_')}@{wall.name}": column for wall in walls if wall.name and names.count(wall.name) == 1
                for column in log if column.startswith(f"wall{wall.id}_")}
        return Table({name: log[name] for name in log}, log.units, os.path.join(self.folder, "log.csv"), also)

    @cached_property
    def ranks(self) -> Table:
        """ranks.csv: times, waits and memory of each MPI rank."""
        return self._table("ranks.csv")

    @cached_property
    def steps(self) -> Table:
        """steps.csv: changes of the step, of a run with `step_control = "quantised"`. Raises InputError for others."""
        return self._table("steps.csv")

    @cached_property
    def removed(self) -> Table:
        """removed.csv: bodies that were taken out, of a run with outlets or `outside = "remove"`, or stepped by an engine. Raises InputError for others."""
        return self._table("removed.csv")

    @cached_property
    def inserted(self) -> Table:
        """inserted.csv: bodies that came in, of a run with inlets, or stepped by an engine. Raises InputError for others."""
        return self._table("inserted.csv")

    @cached_property
    def statistics(self) -> Statistics:
        """NAME.statistics beside the run, as `scree.statistics(run)` and the workflows write it. Raises InputError when there is none."""
        return Statistics(self.folder.removesuffix(".run") + ".statistics")

    @property
    def shapes(self) -> Shapes:
        """Shapes by name: `run.shapes["rock"].vertices`."""
        return self.scene.shapes

    @property
    def materials(self) -> Named[Material]:
        """Materials by name: `run.materials["stone"].density`."""
        return self.scene.materials

    @property
    def walls(self) -> Named[Wall]:
        """Walls of the scene by name; where they are and their loads are in the frames."""
        return self.scene.walls

    @property
    def case(self) -> Case:
        """The case that the scene was packed from, with what `--set` changed."""
        return self.scene.case

    @property
    def provenance(self) -> dict[str, Any]:
        """Who made the run, from what: tool, command, inputs and their history, git, ranks, threads, seed."""
        if self.outcome is not None:
            return dict(self.outcome["provenance"])
        return self.frames[-1].provenance if len(self.frames) else self.scene.provenance

    def __fspath__(self) -> str:
        return self.folder

    def _how(self) -> str:
        if self.outcome is None:
            return "still being written, or killed"
        return self.outcome["outcome"] + (f": {self.outcome['message']}" if self.outcome.get("message") else "")

    def __repr__(self) -> str:
        rows = self.inserted.rows if os.path.exists(os.path.join(self.folder, "inserted.csv")) else 0
        came_in = f" at the start, {rows} came in" if rows or "inlets" in self.scene.settings else ""
        return f"<scree.Run '{self.folder}': {len(self.scene.start['id'])} bodies{came_in}, {len(self.frames)} frames; {self._how()}>"

    def _repr_html_(self) -> str:
        title = f"<p><b>{html.escape(self.folder)}</b>: {html.escape(self._how())}</p>"
        return title + (self.frames[-1]._repr_html_() if len(self.frames) else "")


def open_run(folder: str | os.PathLike[str]) -> Run:
    """Opens NAME.run. Raises InputError when it is no run folder, or damaged, or of a newer version."""
    return Run(folder)
