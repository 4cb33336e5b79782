"""A number of a case with its errors, by workflows/run CASE --error."""
from __future__ import annotations

import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from .case import Case
from .errors import InputError, MachineError, UsageError, error_of
from .tools import Path

_HERE = os.path.dirname(os.path.abspath(__file__))


@dataclass(frozen=True)
class Measurement:
    """A number with its errors. `print` shows it as "32.4 +- 0.8 (seeds) -0.3 (step) +0.1 (shape) deg"."""

    name: str  #: of the quantity
    unit: str  #: "-" for a number without one
    value: float  #: mean of the runs at the settings of the case
    half_width: float  #: of the 95 % interval from seeds; NaN with one seed
    seeds: int  #: runs at the settings of the case
    effects: dict[str, float]  #: what "step", "stiffness", "margin" and "shape" add to the value
    half_widths: dict[str, float]  #: of these effects; NaN with one seed
    missing: dict[str, str]  #: parts without an effect, and why
    total_error: float  #: |sum of the effects| + root of the sum of squares of all half widths
    goal: float | None  #: total error wanted, in the unit
    reached: bool | None  #: whether the goal is; None without one
    seeds_for_goal: int | None  #: of every setting, to expect; None where no number is enough, or without a goal
    text: str  #: value and errors
    folder: str  #: of error.md, of the chart and of the runs

    def __str__(self) -> str:
        return self.text


def _word_of(quantity: str | Callable[[str], Any]) -> str:
    if isinstance(quantity, str):
        return quantity
    name, file = getattr(quantity, "__qualname__", ""), None
    try:
        file = inspect.getsourcefile(quantity)
    except TypeError:
        pass
    if not file or not os.path.exists(file) or not re.fullmatch(r"[A-Za-z_]\w*", name):
        raise UsageError(f"measure: {quantity!r}: expected the name of a quantity, or a function that a file defines at its top: other programs call it by FILE.py:FUNCTION")
    return f"{os.path.abspath(file)}:{name}"


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def _from(record: dict[str, Any], folder: str) -> Measurement:
    effects = record["effects"]
    return Measurement(record["name"], record["unit"], _number(record["value"]), _number(record["half_width"]), record["seeds"],
                       {part: _number(entry["value"]) for part, entry in effects.items()}, {part: _number(entry["half_width"]) for part, entry in effects.items()},
                       dict(record["missing"]), _number(record["total_error"]), record["goal"], record["reached"], record["seeds_for_goal"], record["text"], folder)


def measure(case: Path | Case, quantity: str | Callable[[str], Any], goal: str | float | None = None, budget: str | float | None = None, *, seeds: int = 5,
            output: Path | None = None, cores: int | None = None, config: Sequence[str] = (), progress: bool = True) -> Measurement:
    """Measures a number of a case, with its errors from seeds, step, stiffness, margin and triangles.

    case      name of a ready case ("boulders", "repose/repose-ball"), path of a case file, or a Case, which is saved in `output` first
    quantity  a name of the statistics ("solid_fraction", "torque_y@drum"); or a function at the top of a file, which gets the path of NAME.run and returns
              a number, or (number, unit). The file is loaded by other programs: calls of measure in it stand below  if __name__ == "__main__":
    goal      total error wanted: a number in the unit of the quantity, "0.5 deg" or "1 %"; further seeds are run until it is reached
    budget    time in which it ends with what it has: seconds, or "10 min"
    seeds     of every setting, at least 2
    output    folder of results and runs; None: that of workflows/run. The same call goes on from what is there
    config    words for the workflow: ["size=small", "statistics=--from 2"]
    Needs a checkout of Scree, whose workflows/run it calls. Raises UsageError for a wrong word, RunInvalid when the case itself cannot be run.
    """
    loading = os.environ.get("SCREE_LOADS_FUNCTION_OF")
    if loading:
        raise UsageError(f'measure: {loading} is loaded for its function, and measures when it is loaded; put the call of measure below: if __name__ == "__main__":')
    runner = os.path.join(_HERE, "..", "..", "..", "workflows", "run")
    if not os.path.exists(runner):
        raise MachineError("measure: workflows/run is not here; take this package from a checkout of Scree: PYTHONPATH=CHECKOUT/post/python")
    word = _word_of(quantity)
    if isinstance(case, Case):
        if output is None:
            raise UsageError("measure: a Case needs output=FOLDER, in which it is saved; or give the path of its file")
        os.makedirs(output, exist_ok=True)
        case = case.copy().save(os.path.join(output, "case.toml"))
    folder = os.path.abspath(output) if output is not None else None
    words = [os.path.normpath(runner), os.fspath(case), "--error", "--quantity", word, "--seeds", str(seeds)]
    words += ["--goal", f"{word}={goal}"] if goal is not None else []
    words += ["--budget", budget if isinstance(budget, str) else f"{budget} s"] if budget is not None else []
    words += ["--out", folder] if folder else []
    words += ["--cores", str(cores)] if cores is not None else []
    words += ["--config", *config] if config else []
    said = []
    with subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace") as process:
        assert process.stderr is not None
        for line in process.stderr:
            said.append(line)
            if progress and line.startswith("error: ") and "done: " not in line:
                sys.stderr.write("measure: " + line.removeprefix("error: "))
    errors = [line.partition("workflows/run: error: ")[2].strip() for line in said if line.startswith("workflows/run: error: ")]
    if process.returncode != 0:
        raise error_of(process.returncode if process.returncode > 0 else 128 - process.returncode, errors[-1] if errors else "".join(said[-20:]).strip(), words, "".join(said))
    done = [line.partition("done: ")[2].strip() for line in said if line.startswith("error: done: ")]
    folder = os.path.dirname(done[-1])
    with open(os.path.join(folder, "error.json"), encoding="utf-8") as file:
        content = json.load(file)
    found = [record for record in content["numbers"] if record["name"] == content["first"][0]]
    if not found:
        raise InputError(f"{folder}/error.json: no number of {word}; the file is damaged")
    return _from(found[0], folder)
