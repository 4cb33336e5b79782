"""The settings at which the error of a case is measured: the case as it is, and with one part of the computation changed at a time.

A setting is a set of keys of the case. What a case does not allow is a setting as well, with the reason: a table that left it out would claim an
error that was never examined. Nothing is run here.
"""
import math
import os
import sys
from dataclasses import dataclass, field

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from run_record import si  # noqa: E402

PARTS = ("step", "stiffness", "margin", "shape")   # in the order of the tables
CASE = "case"
STEPS_PER_CONTACT = 30      # default of time.steps_per_contact (decomposer/CASE.md)
HERTZ_TIME = 0.4            # duration of a contact of Hertz falls with this power of the modulus; of a linear one with 1/2
TIMES = 4                   # triangles of a finer shape over those of the case
FEWEST_TRIANGLES = 4        # of a closed mesh
# expected core time over that of the case, until a run has shown it
COST = {"finer shape": 3.0, "coarser shape": 0.6}


@dataclass(frozen=True)
class Setting:
    name: str                # "case", "step-finer" ...: begins the names of its runs
    part: str                # of PARTS; "case"
    side: str                # "finer", "coarser"; "case"
    what: str                # for the table: "step / 2"
    keys: dict = field(default_factory=dict)   # key of the case -> value, as for --set
    cost: float = 1.0        # core time expected, over that of the case
    why_not: str = ""        # why the case does not allow it

    @property
    def is_finer(self):
        return self.side == "finer"


def number(value):
    """For --set: all digits."""
    return f"{value:.17g}"


def refused(part, side, what, why):
    return Setting(f"{part}-{side}", part, side, what, why_not=why)


def step_keys(case, factor):
    """Keys of a step that is so many times as long; None where heat sets it."""
    time = case.get("time", {})
    if "step" in time:
        return {"time.step": number(si(time["step"]) * factor)}
    if case.get("heat", {}).get("frozen"):
        return None
    return {"time.steps_per_contact": number(si(time.get("steps_per_contact", STEPS_PER_CONTACT)) / factor)}


def steps(case):
    found = []
    for side, factor, what in (("finer", 0.5, "step / 2"), ("coarser", 2.0, "step x 2")):
        keys = step_keys(case, factor)
        found.append(Setting(f"step-{side}", "step", side, what, keys, 1 / factor) if keys else
                     refused("step", side, what, "heat.frozen: conduction sets the step; give time.step"))
    return found


def stiffness_keys(case, factor):
    """Keys of contacts that are so many times as stiff. With a step that is given, the number of steps in a contact stays the same."""
    hertz = case.get("contact", {}).get("law") == "hertz-mindlin"
    keys = {}
    for place, pair in enumerate(case.get("pairs", [])):
        for name in ("stiffness", "modulus", "layer_modulus"):
            if name in pair:
                keys[f"pairs.{place}.{name}"] = number(si(pair[name]) * factor)
    if hertz:
        for name, material in case.get("materials", {}).items():
            if "young" in material:
                keys[f"materials.{name}.young"] = number(si(material["young"]) * factor)
    if keys and "step" in case.get("time", {}):
        keys.update(step_keys(case, factor ** -(HERTZ_TIME if hertz else 0.5)))
    return keys


def stiffnesses(case):
    found = []
    for side, factor, what in (("finer", 2.0, "stiffness x 2"), ("coarser", 0.5, "stiffness / 2")):
        keys = stiffness_keys(case, factor)
        if any("." in name or "=" in name for name in case.get("materials", {})) and any(key.startswith("materials.") for key in keys):
            found.append(refused("stiffness", side, what, "a material whose name has a point or an equals sign cannot be set from outside; rename it"))
        elif keys:
            found.append(Setting(f"stiffness-{side}", "stiffness", side, what, keys, math.sqrt(factor)))
        else:
            found.append(refused("stiffness", side, what, "no pair of the case has a stiffness"))
    return found


def margins(case, margin):
    """margin: the thickness that the scene has, in m; 0 where no body has one."""
    contact = case.get("contact", {})
    if not margin:
        return [refused("margin", "finer", "margin / 2", "no body has a margin: balls are exact")]
    if "margin_ratio" in contact and si(contact["margin_ratio"]) > 0:
        keys = {"contact.margin_ratio": number(si(contact["margin_ratio"]) / 2)}
    elif "margin" in contact and si(contact["margin"]) > 0:
        keys = {"contact.margin": number(si(contact["margin"]) / 2)}
    else:
        keys = {"contact.margin": number(margin / 2)}
    return [Setting("margin-finer", "margin", "finer", "margin / 2", keys)]


def shapes(variants):
    """variants: name of a shape -> {"finer": file, "coarser": file} or the reason that there is none, a text that is no path of a file."""
    found = []
    for side, what in (("finer", f"triangles x {TIMES}"), ("coarser", f"triangles / {TIMES}")):
        files = {name: made[side] for name, made in variants.items() if made[side].endswith(".shape.h5")}
        reasons = list(dict.fromkeys(made[side] for made in variants.values() if not made[side].endswith(".shape.h5")))
        if not files:
            found.append(refused("shape", side, what, "; ".join(reasons) or "the case names no shapes"))
            continue
        keys = {f"shapes.{name}.file": file for name, file in files.items()}
        partly = f" ({', '.join(files)}; {'; '.join(reasons)})" if reasons else ""
        found.append(Setting(f"shape-{side}", "shape", side, what + partly, keys, COST[f"{side} shape"]))
    return found


def settings_of(case, margin, variants):
    """All settings of a case, as it is after --set: the case itself, then the parts, finer before coarser."""
    return [Setting(CASE, CASE, CASE, "as the case is"), *steps(case), *stiffnesses(case), *margins(case, margin), *shapes(variants)]


def remarks(case):
    """What no setting of this case varies, for the page."""
    said = []
    if "start" in case:
        said.append("The bodies of `[start]` come from one run: the scatter of that run is not in the intervals.")
    if case.get("bonds"):
        said.append("Bonds keep their stiffness and strength: only contacts are varied.")
    if any("file" in wall.get("shape", {}) for wall in case.get("walls", []) if isinstance(wall.get("shape"), dict)):
        said.append("Walls from files keep their triangles.")
    return said
