#!/usr/bin/env python3
"""The angle of repose of each run at its end. usage: angles.py TABLE.csv NAME...; reads NAME.end/statistics.json"""
import json
import sys

TABLE, *NAMES = sys.argv[1:]
with open(TABLE, "w", encoding="utf-8") as table:
    table.write("run,angle_of_repose_deg\n")
    for name in NAMES:
        with open(f"{name}.end/statistics.json", encoding="utf-8") as file:
            angle = json.load(file)["groups"]["all"].get("angle_of_repose")
        table.write(f"{name},{angle['mean']:.2f}\n" if angle else f"{name},\n")  # empty: too few grains to see a slope
