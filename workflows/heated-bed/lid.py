#!/usr/bin/env python3
"""The case with the lid where it has come to rest in the bed, and without air for a run of contacts alone. usage: lid.py BED RUN CASE.toml OUTPUT.toml"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

bed, name, case, output = sys.argv[1:]
run = scree.open(f"{bed}.run")
walls = run.frames[-1].walls
drawn = next(wall for wall in case_of(record_of(bed))["walls"] if wall["name"] == "lid")
place = float(si(drawn["shape"]["plane"]["point"][2]) + walls.position[walls.row("lid")][2])
with open(case, encoding="utf-8") as file:
    text = file.read()
assert text.count('"LID"') == 1, case
if name.endswith("contacts"):
    text = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("gas_"))
with open(output, "w", encoding="utf-8") as file:
    file.write(text.replace('"LID"', repr(place)))
