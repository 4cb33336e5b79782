#!/usr/bin/env python3
"""The tester tested. usage: selftest.py BIN_FOLDER MPIEXEC SCHEMA [TEST...]

Each relation holds on a small scene and is violated once what it reads is spoilt; every key and word of the case language is drawn by the
generator and has a dimension; shrinking leaves what a violation needs.
"""
import json
import os
import random
import stat
import sys
import time

import bits  # noqa: F401  (these register their relations)
import mesh_formats  # noqa: F401
import near  # noqa: F401
import packings  # noqa: F401
import post_says  # noqa: F401
import post_series  # noqa: F401
import starts  # noqa: F401
import sums  # noqa: F401
from dimensions import DIMENSIONS, PLAIN, in_other_units
from generator import generate
from metamorphic import examine
from model import Case
from relations import RELATIONS, Trial
from shrink import shrink
from solids import SURFACES, cube
import tools as module
from tools import Tools, Violation

BIN, MPIEXEC, SCHEMA = sys.argv[1:4]
CASES_DRAWN = 1000   # enough for the rarest word to come up


def pair(**more):
    return {"between": ["m", "m"], "stiffness": 1e4, "restitution": 0.5, **more}


def scene(bodies, walls=(), **more):
    words = {"gravity": [0, 0, -9.81], "time": {"duration": 0.08}, "shapes": {"ball": {"sphere": {"radius": 0.01}}, "cube": {"file": "@cube"}},
             "materials": {"m": {"density": 2000.0}}, "pairs": [pair(friction=0.3)], "contact": {"margin": 0.0005, "impact_speed": 0.5},
             "bodies": list(bodies), "walls": list(walls), "output": {"every": 0.01}}
    words.update(more)
    return Case(words, {"cube": cube(random.Random(1), 0.012)})


def body(x, y, z, shape="ball", **more):
    return {"shape": shape, "material": "m", "position": [x, y, z], **more}


def scenes():
    floor = {"shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "material": "m"}
    falling = [body(0, 0, 0.0115, velocity=[0.1, 0, 0]), body(0.03, 0, 0.0118, velocity=[-0.1, 0, 0]), body(0, 0.03, 0.016, "cube", angular_velocity=[3, 2, 1])]
    towards = [body(0, 0, 0, velocity=[0.3, 0, 0], angular_velocity=[1, 2, 3]), body(0.025, 0.004, 0, "cube", velocity=[-0.3, 0, 0])]
    still = [body(0.2, 0, 0.012, fixed=True), body(0.2, 0.03, 0.012, velocity=[0, -0.2, 0])]
    population = {"shape": "ball", "material": "m", "count": 6, "region": {"box": [[-0.04, -0.04, 0.001], [0.04, 0.04, 0.08]]}}
    sheet = {"shape": {"file": "@sheet"}, "material": "m", "motion": {"rotate": {"axis": [0, 0, 1], "rate": 2.0}}}
    less_than_one = population | {"mass": 1e-4}
    del less_than_one["count"]
    on_a_sheet = scene(falling, [sheet])
    sheet["load_map"] = True
    on_a_mapped_sheet = scene(falling, [{"shape": {"file": "@sheet"}, "material": "m", "load_map": True}])
    on_a_mapped_sheet.meshes["sheet"] = SURFACES["sheet"](random.Random(1), 0.1)
    on_a_sheet.meshes["sheet"] = SURFACES["sheet"](random.Random(1), 0.1)
    feed = {"shape": "ball", "material": "m", "number_rate": 100.0, "region": {"box": [[-0.05, -0.05, 0.03], [0.05, 0.05, 0.06]]}, "velocity": [0, 0, -1]}
    end = {"region": {"box": [[-0.1, -0.1, -0.2], [0.1, 0.1, 0.0]]}}
    warm = scene([{**b, "temperature": 300.0 + 10 * k} for k, b in enumerate(falling)], [{**floor, "temperature": 350.0}], heat={},
                 materials={"m": {"density": 2000.0, "heat_capacity": 10.0, "conductivity": 1.0}})
    return [scene(falling, [floor], output={"every": 0.01, "impacts": True}), scene(towards, gravity=[0, 0, 0]), scene(still, [floor]), scene([], [floor], populations=[population]),
            scene([body(0, 0, 0.0111)], [floor], pairs=[pair(restitution=0.1)], time={"duration": 3.0, "stop_at_rest": True}, output={"every": 0.02}),
            on_a_sheet, on_a_mapped_sheet, scene([], [floor], populations=[less_than_one]), scene([], [], inlets=[feed], outlets=[end]), warm]


def every_relation_can_fail(tools):
    failures = []
    trials = [Trial(tools, case, 3) for case in scenes()]
    for name, entry in sorted(RELATIONS.items()):
        begun = time.time()
        for trial in trials if entry.group != "known" else reversed(trials):
            trial.spoil = None
            outcome, why = examine(trial, name)
            if outcome == "violated":
                failures.append(f"{name} is violated where it holds: {why}")
                break
            if outcome != "held":
                continue
            trial.spoil = entry.spoil
            spoilt = Trial(tools, trial.case, trial.seed)   # runs that were spoilt must not stay
            spoilt.spoil = entry.spoil
            outcome, why = examine(spoilt, name)
            if outcome != "violated":
                failures.append(f"{name} does not see what was spoilt: {outcome} {why}")
            break
        else:
            failures.append(f"{name} holds on none of the scenes: {outcome} {why}")
        print(f"{name}: {time.time() - begun:.1f} s", flush=True)
    assert not failures, "\n".join(failures)


def a_crash_and_a_hang_are_violations(tools):
    folder = tools.new_path(".bin")
    os.makedirs(folder)
    for name, script in (("scree-crash", "kill -SEGV $$"), ("scree-hang", "sleep 100")):
        path = os.path.join(folder, name)
        with open(path, "w") as file:
            file.write(f"#!/bin/sh\n{script}\n")
        os.chmod(path, os.stat(path).st_mode | stat.S_IEXEC)
    limit, module.LIMIT = module.LIMIT, 1
    broken = Tools(folder, MPIEXEC)
    try:
        for name in ("scree-crash", "scree-hang"):
            try:
                broken.call(name)
                raise AssertionError(f"{name} went unseen")
            except Violation:
                pass
    finally:
        module.LIMIT = limit
        broken.clean()


def schema_leaves(node, path=""):
    """(key, how its value looks) of every key that is no table."""
    kinds = node.get("anyOf", [node])
    for kind in kinds:
        if kind.get("type") == "object" or "properties" in kind:
            for name, entry in kind.get("properties", {}).items():
                yield from schema_leaves(entry, f"{path}.{name}" if path else name)
            if isinstance(kind.get("additionalProperties"), dict):
                yield from schema_leaves(kind["additionalProperties"], path + ".*")
        elif kind.get("type") == "array" and kind["items"].get("type") == "object":
            # a table, or a list of such tables: what is in the list has the keys of the one
            yield from schema_leaves(kind["items"], path if any(k.get("type") == "object" for k in kinds) else path + ".*")
        elif kind.get("type") == "array":
            inner = kind["items"].get("items", kind["items"])
            yield path, inner.get("anyOf", [inner])[0]
        else:
            yield path, kind


def leaves_of(words, path=""):
    if isinstance(words, dict):
        for name, entry in words.items():
            named = path in ("shapes", "materials", "populations.*.shapes", "inlets.*.shapes")
            yield from leaves_of(entry, f"{path}.*" if named else f"{path}.{name}" if path else name)
    elif isinstance(words, list) and path in ("bodies", "walls", "populations", "pairs", "inlets", "outlets", "bonds"):
        for entry in words:
            yield from leaves_of(entry, path + ".*")
    elif isinstance(words, list) and words and all(isinstance(entry, dict) for entry in words):
        for entry in words:
            yield from leaves_of(entry, path)
    else:
        yield path, words


def flat(value):
    return [y for x in value for y in flat(x)] if isinstance(value, list) else [value]


def every_word_of_the_language_is_drawn(_):
    with open(SCHEMA) as file:
        schema = json.load(file)
    keys, words, numbers = set(), set(), set()
    for key, kind in schema_leaves(schema):
        if key == "$schema":
            continue
        keys.add(key)
        words |= {(key, word) for word in kind.get("enum", [])}
        if kind.get("type") in ("number", "integer"):
            numbers.add(key)
    unknown = sorted(numbers - set(DIMENSIONS) - PLAIN)
    assert not unknown, f"numbers of the case language without a line in dimensions.py: {unknown}"
    gone = sorted((set(DIMENSIONS) | PLAIN) - keys)
    assert not gone, f"lines of dimensions.py that the case language has no key for: {gone}"
    drawn = set()
    for seed in range(CASES_DRAWN):
        for key, value in leaves_of(generate(seed).words):
            drawn.add(key)
            drawn |= {(key, entry) for entry in flat(value) if isinstance(entry, (str, bool))}
    strange = sorted(key for key in drawn if isinstance(key, str) and key not in keys and not any(k.startswith(key + ".") for k in keys))
    assert not strange, f"keys that cases have and the case language has not: {strange}"
    left = sorted(map(str, (keys | words) - drawn - NOT_DRAWN))
    assert not left, f"keys and words that no case of {CASES_DRAWN} has; generator.py draws them, or NOT_DRAWN says why not: {left}"


NOT_DRAWN = {
    # a case that starts from a run needs one: the relations of starts.py draw these
    "start.run", "start.checkpoint", "start.frame", "start.materials.*", "start.continue",
    # which bodies are left depends on where the run ended: tests/decomposer/start_test.py
    "start.leave_out.box", "start.leave_out.cylinder.start", "start.leave_out.cylinder.end", "start.leave_out.cylinder.radius",
    "start.leave_out.sphere.centre", "start.leave_out.sphere.radius", "start.leave_out.inside", "start.leave_out.inside_wall",
    "shapes.*.name",   # of several shapes in a file: the tester imports one mesh into each file
    # a file of pieces holds those that the case has cut here. A force would be one more term of every balance
    "shapes.*.pieces", "bodies.*.force",
    # openings that are others turned or mirrored, or through which bodies would only fall
    ("walls.*.shape.box.open", "+x"), ("walls.*.shape.box.open", "-y"), ("walls.*.shape.box.open", "-z"),
    ("walls.*.shape.cone.open", "start"),
}


def other_units_and_back_change_nothing(_):
    for seed in range(50):
        words = generate(seed).words
        there = in_other_units(words, 2.0**5, 2.0**-3, 2.0**7)
        assert in_other_units(there, 2.0**-5, 2.0**3, 2.0**-7) == words, seed
        assert there["time"]["duration"] == words["time"]["duration"] * 2.0**7


def cases_stay_themselves(_):
    for seed in range(20):
        first, second = generate(seed), generate(seed)
        assert first.text() == second.text() and json.dumps(first.to_json()) == json.dumps(second.to_json()), seed


def shrinking_leaves_what_is_needed(_):
    case = next(c for c in map(generate, range(1000)) if len(c.bodies) > 6 and len(c.walls) > 1 and "fluid" in c.words)
    smallest = shrink(case, lambda c: len(c.bodies) >= 2 and "fluid" in c.words, seconds=20)
    assert len(smallest.bodies) == 2 and not smallest.walls and set(smallest.words) <= {"bodies", "walls", "fluid", "time", "materials", "shapes", "pairs"}, smallest.words


def main():
    tests = [every_word_of_the_language_is_drawn, other_units_and_back_change_nothing, cases_stay_themselves, shrinking_leaves_what_is_needed,
             a_crash_and_a_hang_are_violations, every_relation_can_fail]
    chosen = sys.argv[4:] or [t.__name__ for t in tests]
    tools = Tools(BIN, MPIEXEC)
    try:
        for test in tests:
            if test.__name__ in chosen:
                begun = time.time()
                test(tools)
                print(f"passed {test.__name__} in {time.time() - begun:.1f} s", flush=True)
    finally:
        tools.clean()


if __name__ == "__main__":
    main()
