#!/usr/bin/env python3
"""A number of a case with its errors: from seeds, step, stiffness, margin and triangles. usage: measure.py CASE QUANTITY [GOAL [BUDGET]]

For instance: measure.py bed.toml solid_fraction "1 %" "10 min"
"""
import sys

import scree

measured = scree.measure(*sys.argv[1:])
print(f"{measured.name} = {measured}")
print(f"total error {measured.total_error:.3g}; not in it: {', '.join(f'{part} ({why})' for part, why in measured.missing.items()) or 'nothing'}")
if measured.reached is False:
    print(f"goal of {measured.goal:.3g} not reached; seeds to expect: {measured.seeds_for_goal or 'no number is enough'}")
print(f"the page with the table and the chart: {measured.folder}/error.md")
