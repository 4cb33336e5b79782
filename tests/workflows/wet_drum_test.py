#!/usr/bin/env python3
"""The predicted start of avalanches solves its equation, and is none where the equation has no solution. usage: wet_drum_test.py WORKFLOWS"""
import math
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(sys.argv[1]).resolve() / "wet-drum"))
from prediction import predicted_start  # noqa: E402

for degrees in (5, 20, 33.8, 36.5, 45, 60):
    dry = math.radians(degrees)
    largest = 1 / math.tan(dry)
    for share in (0, 1e-6, 0.2, 0.5, 0.9, 0.999):
        theta = predicted_start(dry, share * largest)
        assert dry <= theta < math.pi / 2 and abs(math.tan(theta) - math.tan(dry) * (1 + share * largest / math.cos(theta))) < 1e-9 * math.tan(theta) / math.cos(theta), (degrees, share, theta)
    assert all(predicted_start(dry, factor * largest) is None for factor in (1.0001, 2, 100)), degrees
    # just below the limit the bed stands almost upright; the left side stays below the right at every angle beyond the limit
    assert predicted_start(dry, 0.999999 * largest) > math.radians(89.9)
    assert all(math.tan(angle) < math.tan(dry) * (1 + 1.01 * largest / math.cos(angle)) for angle in (math.pi / 2 * k / 1000 for k in range(1000)))
assert predicted_start(math.radians(30), math.nan) is None
print("all as expected")
