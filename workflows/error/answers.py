"""Numbers of runs, and what their settings make of them: a value, its interval, its errors by part, the seeds that a goal takes."""
import csv
import difflib
import math
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import sweep_quantity  # noqa: E402
from run_record import NUMBER, quantity_of, unit_of  # noqa: E402
from scree.intervals import (ROUNDING, Interval, deviation, effect, effect_of_step, mean_interval, seeds_needed, shown, student_quantile,  # noqa: E402
                             total_error)
from settings import CASE, PARTS  # noqa: E402

# where nothing is asked for, these stand first, as far as the case has them; all others follow below
FIRST = ("angle_of_repose", "discharge_rate", "discharged_mass", "mixing_index", "axis_torque", "power", "volume_worn", "fragments", "solid_fraction",
         "coordination_number", "pressure", "mean_speed", "temperature")
FIRST_FEW = 3
ENOUGH = 5               # runs of a setting from which its own scatter is drawn: that of three is wrong by a factor of two too often



class Wrong(Exception):
    """The user can put it right: where, what was found, what was expected."""


@dataclass(frozen=True)
class Goal:
    text: str            # as it was given
    name: str            # of the quantity
    half: float          # total error wanted, in the unit, or as a share of the value
    unit: str            # "%": of the value; "": that of the quantity


def goal_of(text):
    name, equals, rest = text.rpartition("=")
    match = re.fullmatch(rf"\s*(?:\+-|±)?\s*({NUMBER})\s*(.*?)\s*", rest)
    if not equals or not name.strip() or not match or not float(match[1]) > 0:
        raise Wrong(f"--goal: '{text}' found; expected QUANTITY=ERROR[ UNIT] with an error above 0, for instance \"angle_of_repose=0.5 deg\" or solid_fraction=1%")
    if match[2] not in ("", "%") and unit_of(match[2]) is None:
        raise Wrong(f"--goal: '{text}': '{match[2]}' is no unit that Scree knows")
    return Goal(text, name.strip(), float(match[1]), match[2])


def seconds_of(text, what):
    known = quantity_of(text)
    if known is None or known[1] != quantity_of("1 s")[1] or not known[0] > 0:
        raise Wrong(f"{what}: '{text}' found; expected a time above 0 with its unit, for instance \"10 min\" or \"2 h\"")
    return known[0]


def check_name(name, folder):
    """Refuses a file of the user that is not there, before anything runs."""
    try:
        sweep_quantity.function_of(name, folder)
    except sweep_quantity.Wrong as reason:
        raise Wrong(str(reason).replace("plot=", "quantity ", 1)) from None


def name_in(wanted, names, what):
    """The quantity that is meant: by its name, or by parts of it with points between that only one quantity has ("repose.angle")."""
    if wanted in names or ".py:" in wanted:
        return wanted
    asked = set(re.split(r"[._@ ]+", wanted))
    found = [name for name in names if asked <= set(re.split(r"[._@ ]+", name))]
    if len(found) == 1:
        return found[0]
    if found:
        raise Wrong(f"{what}: '{wanted}' could be {', '.join(found)}; give one of them")
    near = difflib.get_close_matches(wanted, names, 1, 0.6)
    raise Wrong(f"{what}: the runs have no '{wanted}'" + (f", did you mean '{near[0]}'?" if near else "") + f"; they have: {', '.join(names)}")


def numbers_of(run, functions, folder):
    """name -> (value, unit) of a run, without those that it does not have. run: path without .run."""
    try:
        entries = sweep_quantity.all_numbers(run, sweep_quantity.statistics_of(run))
        for word in functions:
            function = sweep_quantity.function_of(word, folder)
            said = function(f"{run}.run")
            value, unit = said if isinstance(said, tuple) else (said, "-")
            entries[word] = {"mean": float(value), "unit": unit}
    except sweep_quantity.Wrong as reason:
        raise Wrong(str(reason)) from None
    except (TypeError, ValueError) as error:
        raise Wrong(f"{word}: of {run}.run: {error}; expected a number, or (number, unit)") from None
    return {name: (float(entry["mean"]), entry["unit"]) for name, entry in entries.items()
            if entry.get("mean") is not None and math.isfinite(entry["mean"])}


def fragments_of(run):
    """Of the last frame (post/README.md): number of fragments, mass share of the largest, share of fines; empty where no bonds are."""
    table = f"{run}.fragments.csv"
    if not os.path.exists(table):
        result = subprocess.run(["scree-post", "fragments", f"{run}.run", "-o", table], capture_output=True, text=True, check=False)
        if result.returncode != 0:
            return {}
    with open(table, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    wanted = {"fragments": "fragments", "largest_share": "largest_fragment_share", "t10": "t10"}
    return {name: (float(rows[-1][column]), "-") for column, name in wanted.items() if rows and rows[-1].get(column)}


@dataclass
class Answer:
    """A number with its errors."""

    name: str
    unit: str
    seeds: Interval                              # of the case
    effects: dict                                # part -> Effect
    missing: dict                                # part -> why there is no effect
    settings: dict = field(default_factory=dict)  # setting -> (Interval of its runs, Interval of its value less that of the case)
    goal: float | None = None                    # total error wanted, in the unit

    @property
    def label(self):
        """For people: a function without the folder of its file."""
        return os.path.basename(self.name) if ".py:" in self.name else self.name

    @property
    def bias(self):
        return sum(entry.interval.value for entry in self.effects.values())

    @property
    def halves(self):
        """By part, of those that have one; NaN with one seed."""
        return {"seeds": self.seeds.half, **{part: entry.interval.half for part, entry in self.effects.items()}}

    @property
    def total(self):
        return total_error([self.bias], list(self.halves.values()))

    @property
    def counts(self):
        return {"seeds": self.seeds.count, **{part: entry.interval.count for part, entry in self.effects.items()}}

    @property
    def text(self):
        return shown(self.seeds.value, self.seeds.half, {part: entry.interval.value for part, entry in self.effects.items()}, self.unit)

    @property
    def is_enough(self):
        return self.goal is not None and self.total <= self.goal

    @property
    def seeds_for_goal(self):
        """Of every part alike; None where no number is enough."""
        deviations = [deviation(self.seeds), *(deviation(entry.interval) for entry in self.effects.values())]
        return None if any(map(math.isnan, deviations)) else seeds_needed(self.goal, [self.bias], deviations)

    @property
    def is_constant(self):
        """No seed and no setting changes it, but for rounding: the number of bodies, for instance."""
        sizes = [size for interval, size in [(self.seeds, 0.0), *((entry.interval, abs(entry.interval.value)) for entry in self.effects.values())]
                 for size in (size, interval.half) if math.isfinite(size)]
        return max(sizes) <= ROUNDING * abs(self.seeds.value)

    @property
    def largest(self):
        """(part, size) of the largest error: an effect that is seen by its value, one that is not by what it may be, the seeds by their half width."""
        sizes = {part: abs(entry.interval.value) if entry.interval.is_seen or not math.isfinite(entry.interval.half) else entry.interval.half for part, entry in self.effects.items()}
        if math.isfinite(self.seeds.half):
            sizes["seeds"] = self.seeds.half
        return max(sizes.items(), key=lambda entry: entry[1]) if sizes else (None, math.nan)

    def error_at(self, setting, count):
        """Total error of a number from so many seeds at a setting: what the setting adds there, and the interval of the seeds."""
        runs, shift = self.settings[setting]
        spread = deviation(runs) if runs.count >= ENOUGH else deviation(self.seeds)
        halves = [entry.interval.half for entry in self.effects.values()]
        if setting != CASE and shift.count > 1:
            halves.append(shift.half)
        return total_error([self.bias + shift.value], [*halves, student_quantile(count) * spread / math.sqrt(count) if spread != 0 else 0.0])


def answer_of(name, unit, values, settings, why_missing, is_seeded=True):
    """values: setting -> {seed: number}. why_missing: setting -> why it has no runs."""
    if not is_seeded:   # every further seed would give the same bits
        values = {setting: dict.fromkeys((0, 1), value) for setting, runs in values.items() for value in list(runs.values())[:1]}
    case = values.get(CASE, {})
    seeds = mean_interval(case.values())
    effects, missing, of_settings = {}, {}, {CASE: (seeds, Interval(0.0, 0.0, 0.0, max(2, seeds.count), "none"))}
    for part in PARTS:
        of_part = {setting.side: setting.name for setting in settings if setting.part == part}
        finer = values.get(of_part.get("finer"), {})
        found = effect(case, finer)
        if part == "step" and "coarser" in of_part:
            found = effect_of_step(case, finer, values.get(of_part["coarser"], {})) if found else None
        if found:
            effects[part] = found
        else:
            missing[part] = why_missing.get(of_part.get("finer"), "not run")
        for setting in of_part.values():
            theirs = values.get(setting, {})
            shift = effect(theirs, case)
            if shift:
                of_settings[setting] = (mean_interval(theirs.values()), shift.interval)
    return Answer(name, unit, seeds, effects, missing, of_settings)


def first_names(asked, answers):
    """Those that stand in the first table: what was asked for, else what a case is usually made for, else the first few."""
    if asked:
        return asked
    changing = [name for name, answer in answers.items() if not answer.is_constant] or list(answers)
    base = [name for first in FIRST for name in changing if name.partition("@")[0] == first]
    return base or changing[:FIRST_FEW]


def goal_in_unit(goal, unit, value):
    """Total error wanted, in the unit of the quantity."""
    if goal.unit == "%":
        return goal.half / 100 * abs(value)
    if not goal.unit:
        return goal.half
    mine, its = unit_of(goal.unit), unit_of("" if unit == "-" else unit)
    if its is None or mine[1] != its[1]:
        raise Wrong(f"--goal: '{goal.text}': the quantity is in {unit if unit != '-' else 'no unit'}, not in {goal.unit}")
    return goal.half * mine[0] / its[0]
