"""What the scripts of the workflows read of a run."""
import json
import math
import re
import tomllib

import h5py


def record_of(run):
    """run.json of NAME.run."""
    with open(f"{run}.run/run.json", encoding="utf-8") as file:
        return json.load(file)


def case_of(record):
    """The case that the run was made from, as it was after --set."""
    return tomllib.loads(record["provenance"]["inputs"][0]["history"]["configuration"])


def with_interval(values, digits):
    """Mean of runs with different seeds as a text, with its interval of 95 % where there is more than one."""
    from scree.intervals import mean_interval   # of the Python package, which the scripts that call this have in their path
    mean = mean_interval(values, is_signed=True)
    return f"{mean.value:.{digits}f}" + (f" +- {mean.half:.{digits}f}" if mean.count > 1 else "")


def heights_of_heaviest(frames):
    """Of frames of the Python package: the row of the heaviest body in the first, and its z [m] in all."""
    row = int(frames[0].bodies.mass.argmax())
    body = int(frames[0].bodies.id[row])
    return row, [float(frame.bodies.position[frame.bodies.id == body][0, 2]) for frame in frames]


def frame_at(run, time=None):
    """Positions N x 3 [m] in the last frame, or in the last one at or before a time."""
    with open(f"{run}.run/frames.hdf.series", encoding="utf-8") as file:
        entries = [entry for entry in json.load(file)["files"] if time is None or entry["time"] <= time * (1 + 1e-9)]
    with h5py.File(f"{run}.run/{entries[-1]['name']}", "r") as file:
        return file["VTKHDF/Points"][:]


# Symbols and prefixes of core/base/units.cpp: factor to SI, then powers of kilogram, metre, second, radian and kelvin.
SYMBOLS = {
    "m": (1, 0, 1, 0, 0, 0), "g": (1e-3, 1, 0, 0, 0, 0), "t": (1e3, 1, 0, 0, 0, 0), "s": (1, 0, 0, 1, 0, 0), "min": (60, 0, 0, 1, 0, 0), "h": (3600, 0, 0, 1, 0, 0),
    "in": (0.0254, 0, 1, 0, 0, 0), "N": (1, 1, 1, -2, 0, 0), "Pa": (1, 1, -1, -2, 0, 0), "bar": (1e5, 1, -1, -2, 0, 0), "J": (1, 1, 2, -2, 0, 0),
    "W": (1, 1, 2, -3, 0, 0), "Hz": (1, 0, 0, -1, 0, 0), "rad": (1, 0, 0, 0, 1, 0), "deg": (math.pi / 180, 0, 0, 0, 1, 0), "°": (math.pi / 180, 0, 0, 0, 1, 0),
    "rev": (2 * math.pi, 0, 0, 0, 1, 0), "rpm": (2 * math.pi / 60, 0, 0, -1, 1, 0), "K": (1, 0, 0, 0, 0, 1),
}
PREFIXED = {"m", "g", "s", "N", "Pa", "bar", "J", "W", "Hz", "rad", "K"}
PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12}
NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"

BRACKETS = r"/ *\(([^()/]*)\)"  # J/(kg K) is J/kg/K

UNIT_PART = r"(/)|([^\W\d_²³]+|°)(?:\^?(-?[1-9]|[²³]))?"


def unit_of(text):
    """Factor to SI and powers of a unit such as "kg/m^3", None when it is none."""
    factor, powers, divides = 1.0, [0, 0, 0, 0, 0], False
    text = re.sub(BRACKETS, lambda found: "".join("/" + part for part in found[1].split()) + " ", text)
    if re.sub(UNIT_PART, "", text).strip(" *") not in ("", "1"):
        return None
    for slash, name, power in re.findall(UNIT_PART, text):
        if slash:
            divides = True
            continue
        symbol = SYMBOLS.get(name)
        if symbol is None and name[:1] in PREFIXES and name[1:] in PREFIXED:
            symbol = (PREFIXES[name[0]] * SYMBOLS[name[1:]][0], *SYMBOLS[name[1:]][1:])
        if symbol is None:
            return None
        exponent = {"": 1, "²": 2, "³": 3}.get(power) or int(power)
        exponent = -exponent if divides else exponent
        factor *= symbol[0] ** exponent
        powers = [sum_ + exponent * one for sum_, one in zip(powers, symbol[1:])]
    return factor, tuple(powers)


def quantity_of(text):
    """Value in SI and powers of a text such as "5 mm", None for words. A number alone has no powers: it is SI."""
    match = re.fullmatch(rf"\s*({NUMBER})\s*(.*?)\s*", text)
    unit = unit_of(match[2]) if match else None
    return unit and (float(match[1]) * unit[0], unit[1])


def si(value):
    """A number, or a text with its unit, in SI."""
    if not isinstance(value, str):
        return float(value)
    known = quantity_of(value)
    if known is None:
        raise ValueError(f"'{value}' is no number with a unit")
    return known[0]
