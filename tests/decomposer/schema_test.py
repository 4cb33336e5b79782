#!/usr/bin/env python3
"""The schema of the case language and the tables of CASE.md: made from the keys of today, and what a validator that is not ours says with it.
usage: schema_test.py SOURCE PRINT_KEYS SCREE_DECOMPOSER"""
import copy
import glob
import json
import os
import subprocess
import sys
import tempfile
import tomllib

import jsonschema

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from mpi_environment import mpi_environment  # noqa: E402

SOURCE, PRINT_KEYS, DECOMPOSER = sys.argv[1:4]
FOLDER = os.path.join(SOURCE, "decomposer", "schema")
ENV = mpi_environment()

cases = sorted(glob.glob(os.path.join(FOLDER, "cases", "*.toml")))
schema_file = os.path.join(FOLDER, "case.schema.json")
subprocess.run([sys.executable, os.path.join(FOLDER, "make_schema.py"), PRINT_KEYS, "--schema", schema_file, "--page",
                os.path.join(SOURCE, "decomposer", "CASE.md"), "--check"], check=True)
with open(schema_file, encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)

# every case that we ship is right by the schema
shipped = cases + sorted(glob.glob(os.path.join(SOURCE, "workflows", "*", "case*.toml")))
assert len(shipped) >= 6, shipped
for path in shipped:
    with open(path, "rb") as file:
        errors = [f"{path}: {list(e.absolute_path)}: {e.message}" for e in validator.iter_errors(tomllib.load(file))]
    assert not errors, errors

# what the schema calls wrong, the decomposer refuses too; the last two only the decomposer can know
with open(os.path.join(FOLDER, "cases", "bodies.toml"), "rb") as file:
    right = tomllib.load(file)


def change(setting):
    case = copy.deepcopy(right)
    exec(setting, {"case": case})  # noqa: S102  a line of this file
    return case


def toml_of(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_of(v)}" for key, v in value.items()) + " }"
    return json.dumps(value) if not isinstance(value, list) else "[" + ", ".join(map(toml_of, value)) + "]"


def decomposer_refuses(case):
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write("\n".join(f"{key} = {toml_of(value)}" for key, value in case.items()))
        file.flush()
        result = subprocess.run([DECOMPOSER, "check", file.name], env=ENV, capture_output=True, text=True)
    assert result.returncode in (0, 2), result.stderr
    return result.returncode == 2


assert not decomposer_refuses(right) and validator.is_valid(right)
# a number in quotes is one in SI units, where a text can carry a unit
for setting in ("case['bodies'][0]['position'] = ['0', '0.1', ' 1e-3 ']", "case['time']['duration'] = '2'"):
    assert validator.is_valid(change(setting)) and not decomposer_refuses(change(setting)), setting
for setting, schema_knows in [("case['time']['duraton'] = 1", True), ("case['pairs'][0]['friction'] = -0.5", True),
                              ("case['time']['step'] = '1 parsec of'; case['time']['step'] = True", True),
                              ("del case['time']['duration']", True), ("del case['time']", True), ("case['contact']['law'] = 'magic'", True),
                              ("case['gravity'] = [0, 0]", True), ("case['pairs'][0]['restitution'] = 1.5", True),
                              ("case['bodies'][0]['fixed'] = 1", True), ("case['bodies'][0]['shape'] = 'stone'", False),
                              ("case['time']['steps_per_contact'] = 30", False)]:
    case = change(setting)
    assert validator.is_valid(case) != schema_knows, setting
    assert decomposer_refuses(case), setting
print("all as expected")
