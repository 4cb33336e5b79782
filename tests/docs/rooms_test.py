#!/usr/bin/env python3
"""Holds solver/README.md to the files: rooms in the order of its table include nothing above them, and every file that it names is there.
Also, in all tools and core: no two rooms include each other, and units that do become fewer. No file of the solver has more than 400 lines. usage: rooms_test.py ROOT"""
import os
import re
import sys

ROOT = sys.argv[1]
kLongest = 400
# Units of one folder that reach each other by includes, and so are one unit in fact: no new ones, and those that are left become fewer.
KNOTS = [
    "solver/scene: lane_laws solver_scene",  # a scene makes its laws for lanes as it is made
]


def includes():
    """Of each unit, a header with its sources, those that it includes."""
    def unit(path):
        return re.sub(r"(-inl)?\.(hpp|cpp|inc)$", "", path)
    files = [os.path.relpath(os.path.join(folder, name), ROOT) for top in ("core", "mesher", "decomposer", "solver", "post")
             for folder, _, names in os.walk(os.path.join(ROOT, top)) for name in names if name.endswith((".hpp", ".cpp", ".inc"))]
    found = {unit(path): set() for path in files}
    for path in files:
        with open(os.path.join(ROOT, path), encoding="utf-8") as source:
            for other in re.findall(r'^#include "([\w/-]+\.(?:hpp|inc))"', source.read(), flags=re.M):
                if unit(other) in found and unit(other) != unit(path):
                    found[unit(path)].add(unit(other))
    return found


def knots(graph):
    """Sets of more than one node that reach each other (R. Tarjan, Depth-first search and linear graph algorithms, 1972)."""
    number, low, stack, result = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            knot = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(knot) > 1:
                result.append(sorted(knot))
    for node in sorted(graph):
        if node not in number:
            visit(node)
    return result


sys.setrecursionlimit(10000)
with open(os.path.join(ROOT, "solver/README.md"), encoding="utf-8") as file:
    page = file.read()
rooms = re.findall(r"^\| `(\w+)/` \|", page, flags=re.M)
assert len(rooms) >= 8, f"the table of rooms has {rooms}"
floor = {room: len(rooms) - k for k, room in enumerate(rooms)}  # the ground is 1
wrong = []
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
                    wrong.append(f"{where}:{number} includes {other.group(2)}/, a room above {room}/")
graph = includes()
rooms_of = {}
for unit, others in graph.items():
    room = "/".join(unit.split("/")[:2])
    rooms_of.setdefault(room, set()).update(other for other in ("/".join(o.split("/")[:2]) for o in others) if other != room)
wrong += [f"rooms that include each other in a circle: {' '.join(knot)}" for knot in knots(rooms_of)]
tied = [f"{os.path.dirname(knot[0])}: {' '.join(os.path.basename(unit) for unit in knot)}" for knot in knots(graph)]
wrong += [f"units that reach each other by includes: {knot}" for knot in sorted(set(tied) - set(KNOTS))]
wrong += [f"no longer a knot, take it off the list KNOTS: {knot}" for knot in sorted(set(KNOTS) - set(tied))]
section = page[page.index("## Rooms"):]
for name in re.findall(r"`([\w/]+\.(?:hpp|cpp|md))`", section):
    rows = [line for line in section.splitlines() if f"`{name}`" in line]
    own = [re.match(r"\| `(\w+)/`", row) for row in rows]
    places = [f"solver/{match.group(1)}/{name}" for match in own if match] + [f"solver/{name}", name]
    if not any(os.path.isfile(os.path.join(ROOT, place)) for place in places):
        wrong.append(f"solver/README.md names {name}, which is not there")
assert not wrong, "\n".join(wrong)
print(f"{len(rooms)} rooms; circles of includes that are left: {len(KNOTS)}")
