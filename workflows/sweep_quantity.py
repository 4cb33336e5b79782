"""What a sweep can draw and tabulate (plot=): looked at before the first run by pipeline.smk, read after the last by sweep_table.py.

    mixing_index            a quantity of all bodies (post/STATISTICS.md), the mean over time
    axis_torque             of the only wall that has it: torque about the wall's own axis, [N m]
    torque_y@drum           of the wall of that name (or number): forces, torques, power; of walls with load maps what wall_loads.csv has
    FILE.py:FUNCTION        what a function of yours says of a run: it is given the path of NAME.run, and returns a number, or (number, unit)
"""
import csv
import difflib
import importlib.util
import json
import math
import os
import re
import sys
import tomllib

TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
# those of post/statistics/frame_numbers.cpp: a test holds the two equal
OF_BODIES = [
    "particle_count", "mass", "coordination_number", "coordination_number_without_rattlers", "rattler_fraction", "contact_points_per_particle",
    "point_contacts", "edge_contacts", "face_contacts", "constraints", "constraints_frictionless", "mean_normal_force", "max_normal_force", "mean_tangential_force", "tensile_fraction", "mean_tensile_force",
    *(f"fabric_{ij}" for ij in TENSOR), "fabric_anisotropy", *(f"force_fabric_{ij}" for ij in TENSOR), "force_fabric_anisotropy",
    *(f"stress_{ij}" for ij in TENSOR), "pressure", "deviatoric_stress", "cohesive_pressure", "kinetic_pressure", "solid_fraction",
    "solid_fraction_of_container", "velocity_x", "velocity_y", "velocity_z", "mean_speed", "mean_spin", "granular_temperature", "centre_of_mass_x",
    "centre_of_mass_y", "centre_of_mass_z", "temperature", "temperature_spread", "force_chain_share", "force_chain_count", "force_chain_length", "mixing_index", "mixing_index_apart", "segregation_fine",
    "segregation_middle", "segregation_coarse", "angle_of_repose", "discharged_mass", "discharge_rate", "kinetic_energy", "potential_energy",
    "elastic_energy", "dissipated_energy", "energy_error"]
OF_WALLS = ["force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z", "axis_torque", "power", "way", "rate"]
OF_LOADS = {"sliding_power": "W", "damping_power": "W", "contact_rate": "1/s", "impact_power": "W", "volume_worn": "m^3"}


class Wrong(Exception):
    """The user can put it right: where, what was found, what was expected."""


def function_of(word, folder="."):
    """FILE.py:FUNCTION, loaded; None for the name of a quantity."""
    match = re.fullmatch(r"(.+\.py):([A-Za-z_]\w*)", word)
    if match is None:
        return None
    path = os.path.join(folder, match[1])
    if not os.path.isfile(path):
        raise Wrong(f"plot={word}: there is no file {path}; give FILE.py:FUNCTION")
    spec = importlib.util.spec_from_file_location("of_user", path)
    module = importlib.util.module_from_spec(spec)
    if (beside := os.path.dirname(os.path.abspath(path))) not in sys.path:
        sys.path.append(beside)   # modules beside it, as if it were started as a program
    os.environ["SCREE_LOADS_FUNCTION_OF"] = path   # a program that measures as it is loaded would load itself again without end (scree.measure)
    try:
        spec.loader.exec_module(module)
    except Exception as error:   # whatever stands in it
        raise Wrong(f"plot={word}: {path}: {type(error).__name__}: {error}") from None
    finally:
        del os.environ["SCREE_LOADS_FUNCTION_OF"]
    function = getattr(module, match[2], None)
    if not callable(function):
        raise Wrong(f"plot={word}: {path} has no function '{match[2]}'")
    return function


def table_of(case):
    """What stands in a case file; None where it cannot be read: the decomposer says why."""
    try:
        with open(case, "rb") as file:
            return tomllib.load(file)
    except (OSError, ValueError):
        return None


def has_wall(table, kinds):
    """Whether a wall of a case has one of these keys, by itself or in its motion."""
    for wall in table.get("walls", []):
        motions = wall.get("motion", []) if isinstance(wall, dict) else []
        parts = [wall, *(motions if isinstance(motions, list) else [motions])]
        if any(isinstance(part, dict) and kind in part for part in parts for kind in kinds):
            return True
    return False


# quantities that only some cases have: the part of a case that makes them, keys of it, and what is missing without them
NEEDS = {
    **dict.fromkeys(("temperature", "temperature_spread"), ("heat", (), "it has no [heat]")),
    **dict.fromkeys(("way", "rate"), ("walls", ("servo", "free", "motor", "outer"), "no wall of it answers to force (servo, free, motor, outer)")),
    **dict.fromkeys(("sliding_power", "damping_power", "contact_rate", "impact_power"), ("walls", ("load_map", "wear"), "no wall of it has a load_map")),
    "volume_worn": ("walls", ("wear",), "no wall of it wears"),
}


def misses(name, case, changed):
    """What a case has to have for a quantity, and has not; empty where it may have it. changed: keys that a sweep or --set gives it."""
    if name not in NEEDS:
        return ""
    part, kinds, missing = NEEDS[name]
    table = table_of(case)
    if table is None or any(key.partition(".")[0] == part for key in changed):
        return ""
    return "" if (has_wall(table, kinds) if kinds else part in table) else missing


def walls_of(case):
    """Names of the walls of a case file; None where it cannot be read: the decomposer says why."""
    try:
        return [wall.get("name", "") for wall in table_of(case).get("walls", [])]
    except AttributeError:   # no table, or no tables in it
        return None


def check(word, cases, folder=".", changed=()):
    """Refuses a quantity that no run of these case files can have, before anything runs. changed: keys that a sweep or --set gives them."""
    if function_of(word, folder) is not None:
        return
    name, at, wall = word.partition("@")
    names = [*OF_WALLS, *OF_LOADS] if at else [*OF_BODIES, *OF_WALLS, *OF_LOADS]
    if name not in names:
        near = difflib.get_close_matches(name, names, 1, 0.7)
        raise Wrong(f"plot={word}: there is no quantity '{name}'" + (f", did you mean '{near[0]}'?" if near else f"; there are: {', '.join(names)}"))
    for case in cases:
        if missing := misses(name, case, changed):
            raise Wrong(f"plot={word}: the runs of {case} have no {name}: {missing}")
    for case in cases if at else []:
        walls = walls_of(case)
        if walls is None or wall in walls or wall.isdigit():
            continue
        near = difflib.get_close_matches(wall, walls, 1)
        raise Wrong(f"plot={word}: {case} has no wall '{wall}'" + (f", did you mean '{near[0]}'?" if near else
                    f"; it has: {', '.join(repr(name) for name in walls if name) or 'none with a name'}"))


def of_walls(run, statistics):
    """Of every wall of a run by what it is called: quantity -> entry."""
    walls = {key: {name: entry for name, entry in entries.items() if name not in OF_LOADS} for key, entries in statistics.get("walls", {}).items()}
    try:
        with open(f"{run}.statistics/wall_loads.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    except OSError:
        return walls
    for key in walls:
        mine = [row for row in rows if row["wall"] in (key, key.partition(" ")[0])]
        for name, unit in OF_LOADS.items():
            ends = [float(row["time"]) for row in mine]   # a row is of what passed since the frame before
            lengths = [end - begin for begin, end in zip([statistics["first_time"], *ends], ends)]
            found = [(lasts, float(row[name])) for lasts, row in zip(lengths, mine) if row.get(name) not in (None, "", "nan")]
            whole = sum(lasts for lasts, _ in found)
            if whole > 0:   # what is worn off grows; the others are rates between two frames, of which the last may be short
                mean = found[-1][1] if name == "volume_worn" else sum(lasts * value for lasts, value in found) / whole
                walls[key][name] = {"mean": mean, "ci95": None, "unit": unit}
    return walls


def entry_of(word, run, statistics, functions={}):
    """{"mean", "ci95", "unit"} of a quantity of a run; empty where the run has none. Raises Wrong where several walls have it."""
    if word not in functions:
        functions[word] = function_of(word)
    if functions[word] is not None:
        said = functions[word](f"{run}.run")
        value, unit = said if isinstance(said, tuple) else (said, "-")
        return {"mean": float(value), "ci95": None, "unit": unit}
    name, at, wanted = word.partition("@")
    if not at and name in statistics["groups"]["all"]:
        return statistics["groups"]["all"][name]
    if not at and name not in OF_WALLS and name not in OF_LOADS:
        return {}
    has = {}
    for key, entries in of_walls(run, statistics).items():
        number, _, called = key.partition(" ")
        mean = entries.get(name, {}).get("mean")
        if (at and wanted in (called, number)) or (not at and mean is not None and math.isfinite(mean) and mean != 0):
            has[called or number] = entries.get(name, {})
    if len(has) > 1:
        raise Wrong(f"plot={word}: {len(has)} walls of {run} have it; say which: {', '.join(f'{name}@{wall}' for wall in has)}")
    return next(iter(has.values()), {})


def all_numbers(run, statistics):
    """All numbers of a run by name: of all bodies, and "force_x@lid" of walls, or by the number of a wall where it has no name."""
    numbers = dict(statistics["groups"]["all"])
    for wall, entries in of_walls(run, statistics).items():
        numbers |= {f"{quantity}@{wall.partition(' ')[2] or wall}": entry for quantity, entry in entries.items() if entry.get("mean") is not None}
    return numbers


def statistics_of(run):
    with open(f"{run}.statistics/statistics.json", encoding="utf-8") as file:
        return json.load(file)
