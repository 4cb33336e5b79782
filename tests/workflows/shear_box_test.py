#!/usr/bin/env python3
"""The strength of a shear box: the largest mean over 1 mm of curves that are known, and whether it is a lower bound. usage: shear_box_test.py WORKFLOWS"""
import importlib.util
import math
import pathlib
import sys

import numpy as np

sys.dont_write_bytecode = True
SPEC = importlib.util.spec_from_file_location("envelope", pathlib.Path(sys.argv[1]).resolve() / "shear-box/envelope.py")
envelope = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(envelope)

WAY = np.linspace(0, 6e-3, 6001)
NORMAL = np.full_like(WAY, 50e3)
RNG = np.random.default_rng(4)


def of(ratio):
    found = envelope.strength(WAY, NORMAL * ratio, NORMAL)
    return found, envelope.row("40 kPa", {"way": WAY, "rises": np.zeros(1)}, found).split(" | ")


# a curve that climbs to the end, without and with bursts: the largest mean is a lower bound, and every place that shows it says so
for ratio in (0.1 + 100 * WAY, 0.1 + 100 * WAY + RNG.normal(0, 0.05, len(WAY))):
    found, cells = of(ratio)
    assert found["is_largest_at_end"] and abs(found["way"] - 5.5e-3) < 0.3e-3, found
    assert abs(found["angle"] - math.degrees(math.atan(0.65))) < 0.5, found
    assert cells[3] == f">= {found['angle']:.1f} degrees, largest at the end", cells
# a curve with a peak at 3 mm and a lower end
found, cells = of(0.7 * np.exp(-((WAY - 3e-3) / 2e-3) ** 2) + 0.05)
assert not found["is_largest_at_end"] and abs(found["way"] - 3e-3) < 0.01e-3 and cells[3] == f"{found['angle']:.1f} degrees", (found, cells)
assert found["angle"] > found["angle_at_end"] and found["shear_stress"] / found["normal_stress"] < 0.75
# a peak 1.6 mm before the end is no lower bound, one 0.9 mm before the end is
assert not of(0.5 - 40 * abs(WAY - 4.4e-3))[0]["is_largest_at_end"] and of(0.5 - 40 * abs(WAY - 5.1e-3))[0]["is_largest_at_end"]
# a way that is too short for the means has no strength
short = WAY < 2e-3
assert envelope.strength(WAY[short], NORMAL[short], NORMAL[short]) is None
assert "sheared by 2.0 mm only" in envelope.row("40 kPa", {"way": WAY[short], "rises": np.zeros(1)}, None)
assert len(envelope.COLUMNS) == envelope.row("40 kPa", {"way": WAY[short], "rises": np.zeros(1)}, None).count("|") - 1

# the line through strengths tan(30 degrees) s + 2 kPa, and how many of them are lower bounds
slope = math.tan(math.radians(30))
line = envelope.line_through([{"normal_stress": s, "shear_stress": slope * s + 2e3, "is_largest_at_end": s > 50e3} for s in (25e3, 50e3, 100e3)])
assert abs(line["angle"] - 30) < 1e-9 and abs(line["cohesion"] - 2e3) < 1e-6 and line["cohesion_ci95"] < 1e-3 and line["lower_bounds"] == 1, line
assert envelope.line_through([found, found]) is None
print("all as expected")
