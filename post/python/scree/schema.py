"""Checks of a case by the schema of the case language (decomposer/schema/case.schema.json).

Only what that schema uses of JSON Schema is understood; a test compares the verdicts with those of python3-jsonschema.
"""
from __future__ import annotations

import difflib
import json
import operator
import os
import re
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

from .errors import MachineError

Problem = tuple[tuple[Any, ...], str]  # place, message
_KINDS: dict[str, tuple[type, ...]] = {"object": (dict,), "array": (list,), "string": (str,), "boolean": (bool,), "integer": (int,), "number": (int, float)}
_WORDS = {"object": "a table", "array": "a list", "string": "a text", "boolean": "true or false", "integer": "a whole number", "number": "a number"}

_RANGES: tuple[tuple[str, Callable[[Any, Any], bool], str], ...] = (
    ("minimum", operator.ge, "at least"), ("maximum", operator.le, "at most"),
    ("exclusiveMinimum", operator.gt, "more than"), ("exclusiveMaximum", operator.lt, "less than"))


@lru_cache(maxsize=1)
def case_schema() -> dict[str, Any]:
    """The schema: installed beside this file, or of the checkout. Raises MachineError when it is at neither place."""
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.path.join(here, "case.schema.json"), os.path.join(here, "..", "..", "..", "decomposer", "schema", "case.schema.json")]
    for place in places:
        if os.path.exists(place):
            with open(place, encoding="utf-8") as file:
                return dict(json.load(file))
    raise MachineError(f"the schema of the case language is missing; it is looked for at {' and '.join(places)}")


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    return isinstance(value, _KINDS[kind]) or (kind == "integer" and isinstance(value, float) and value.is_integer())


def _expected(schema: dict[str, Any]) -> str:
    """What a schema asks for, in words."""
    if "anyOf" in schema:
        return " or ".join(dict.fromkeys(_expected(choice) for choice in schema["anyOf"]))
    if "enum" in schema:
        return ", ".join(f'"{word}"' for word in schema["enum"])
    if schema.get("type") == "string" and "pattern" in schema:
        return schema.get("description", "a quantity with its unit")
    if schema.get("type") == "array" and schema.get("minItems") == schema.get("maxItems") is not None:
        return f"a list of {schema['minItems']}"
    return _WORDS.get(schema.get("type", ""), "something else")


def _shown(value: Any) -> str:
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."


def _table_problems(value: dict[str, Any], schema: dict[str, Any], place: tuple[Any, ...]) -> Iterator[Problem]:
    properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    for key, below in value.items():
        if key in properties:
            yield from problems_of(below, properties[key], (*place, key))
        elif isinstance(others, dict):
            yield from problems_of(below, others, (*place, key))
        elif others is False:
            near = difflib.get_close_matches(key, properties, 1)
            yield (*place, key), "unknown key; " + (f"did you mean {near[0]}?" if near else "expected one of: " + ", ".join(properties))
    for key in schema.get("required", []):
        if key not in value:
            yield (*place, key), "missing; it is required"
    if len(value) < schema.get("minProperties", 0):
        yield place, "empty; at least one entry expected"


def _choice_problems(value: Any, choices: list[dict[str, Any]], place: tuple[Any, ...]) -> Iterator[Problem]:
    """Problems of the choice that comes nearest: the deepest among those of the right type."""
    verdicts = [(choice, list(problems_of(value, choice, place))) for choice in choices]
    if any(not problems for _, problems in verdicts):
        return
    near = [problems for choice, problems in verdicts if "type" in choice and _is(value, choice["type"]) and "pattern" not in choice]
    if near:
        yield from max(near, key=lambda problems: (max(len(where) for where, _ in problems), -len(problems)))
    else:
        yield place, f"{_shown(value)}: expected {_expected({'anyOf': choices})}"


def problems_of(value: Any, schema: dict[str, Any], place: tuple[Any, ...] = ()) -> Iterator[Problem]:
    """What is wrong with a value by a schema: place and message each; nothing for a right one."""
    if "anyOf" in schema:
        yield from _choice_problems(value, schema["anyOf"], place)
    for part in schema.get("allOf", []):
        yield from problems_of(value, part, place)
    if "oneOf" in schema and isinstance(value, dict):
        keys = [key for choice in schema["oneOf"] for key in choice["required"]]
        found = [key for key in keys if key in value]
        if len(found) != 1:
            yield place, f"one and only one of {', '.join(keys)} expected; found: {', '.join(found) or 'none'}"
    if "enum" in schema and value not in schema["enum"]:
        yield place, f"{_shown(value)}: expected {_expected(schema)}"
    if "type" in schema and not _is(value, schema["type"]):
        yield place, f"{_shown(value)}: expected {_expected(schema)}"
    elif isinstance(value, dict):
        yield from _table_problems(value, schema, place)
    elif isinstance(value, list):
        least, most = schema.get("minItems", 0), schema.get("maxItems", len(value))
        if not least <= len(value) <= most:
            yield place, f"{len(value)} values found, {least if least == most else f'{least} to {most}'} expected"
        for index, item in enumerate(value if "items" in schema else []):
            yield from problems_of(item, schema["items"], (*place, index))
    elif isinstance(value, str):
        if "pattern" in schema and not re.search(schema["pattern"], value):
            yield place, f"{_shown(value)}: expected {_expected(schema)}"
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        for key, holds, words in _RANGES:
            if key in schema and not holds(value, schema[key]):
                yield place, f"{_shown(value)}: {words} {schema[key]} expected"
