#!/usr/bin/env python3
"""Holds solver/README.md to the files: rooms in the order of its table include nothing above them, and every file that it names is there.
Also: no file of the solver has more than 400 lines. usage: rooms_test.py ROOT"""
import os
import re
import sys

ROOT = sys.argv[1]
kLongest = 400
# Includes that point up, to be removed: what a scene may have (bonds, inlets, wall loads, impacts) is known to the loop over pairs and to the step size.
POINT_UP = {
    ("pairs/forces.hpp", "step/impacts.hpp"), ("pairs/forces.hpp", "step/load_map.hpp"),
    ("pairs/pair_evaluation.hpp", "step/impacts.hpp"), ("pairs/pair_evaluation.hpp", "step/wall_loads.hpp"),
    ("step_size/stability.hpp", "step/run_state.hpp"), ("step_size/step_levels.hpp", "step/run_state.hpp"),
    ("step_size/step_size.cpp", "step/bonds.hpp"), ("step_size/step_size.cpp", "step/inlets.hpp"),
    ("step_size/stability.cpp", "step/bonds.hpp"), ("step_size/stability.cpp", "step/wall_drives.hpp"),
}

with open(os.path.join(ROOT, "solver/README.md"), encoding="utf-8") as file:
    page = file.read()
rooms = re.findall(r"^\| `(\w+)/` \|", page, flags=re.M)
assert len(rooms) >= 8, f"the table of rooms has {rooms}"
floor = {room: len(rooms) - k for k, room in enumerate(rooms)}  # the ground is 1
wrong, pointing_up = [], set()
found = {name for name in os.listdir(os.path.join(ROOT, "solver")) if os.path.isdir(os.path.join(ROOT, "solver", name))}
wrong += [f"solver/{name} is not in the table of rooms" for name in sorted(found - set(rooms))]
wrong += [f"the table has solver/{name}, which is not there" for name in sorted(set(rooms) - found)]
for room in found & set(rooms):
    for folder, _, names in os.walk(os.path.join(ROOT, "solver", room)):
        for name in names:
            path = os.path.join(folder, name)
            with open(path, encoding="utf-8") as file:
                lines = file.readlines()
            where = os.path.relpath(path, ROOT)
            if len(lines) > kLongest:
                wrong.append(f"{where} has {len(lines)} lines, more than {kLongest}")
            for number, line in enumerate(lines, 1):
                other = re.match(r'#include "solver/((\w+)/[^"]+)"', line)
                if other and floor.get(other.group(2), 0) > floor[room]:
                    if (arrow := (where.removeprefix("solver/"), other.group(1))) in POINT_UP:
                        pointing_up.add(arrow)
                        continue
                    wrong.append(f"{where}:{number} includes {other.group(2)}/, a room above {room}/")
wrong += [f"{source} no longer includes {target}: take it off the list POINT_UP" for source, target in sorted(POINT_UP - pointing_up)]
section = page[page.index("## Rooms"):]
for name in re.findall(r"`([\w/]+\.(?:hpp|cpp|md))`", section):
    rows = [line for line in section.splitlines() if f"`{name}`" in line]
    own = [re.match(r"\| `(\w+)/`", row) for row in rows]
    places = [f"solver/{match.group(1)}/{name}" for match in own if match] + [f"solver/{name}", name]
    if not any(os.path.isfile(os.path.join(ROOT, place)) for place in places):
        wrong.append(f"solver/README.md names {name}, which is not there")
assert not wrong, "\n".join(wrong)
print(f"{len(rooms)} rooms; {len(POINT_UP)} includes point up")
