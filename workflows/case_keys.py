"""Keys of a case as --set, sweep= and calibrate take them, for instance pairs.*.friction: checked by the schema of the case language before anything
runs. Whether the case has a list that is so long, the decomposer checks when it packs.
"""
import difflib
import functools
import json
import os
import re

SCHEMA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "decomposer", "schema", "case.schema.json")
QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'|\[[^\[\]]*\]|\{[^{}]*\}|\([^()]*\)")
FURTHER_KEY = re.compile(r"(?:,|\s)\s*([A-Za-z_][\w-]*(?:\.[\w*-]+)*)\s*=")
MOST_PLACES = 3   # of a name that is a key at several places


class Wrong(Exception):
    """The user can correct it: the place, the text found, the text expected."""


@functools.lru_cache(maxsize=1)
def schema():
    """None in a copy of this folder alone: the decomposer then refuses a wrong key."""
    if not os.path.exists(SCHEMA):
        return None
    with open(SCHEMA, encoding="utf-8") as file:
        return json.load(file)


def choices(node):
    """A node of the schema and all that it may be instead."""
    yield node
    for kind in ("anyOf", "oneOf", "allOf"):
        for part in node.get(kind, []):
            yield from choices(part)


def places_of(name, node, path=()):
    """Keys that end with this name, with * for lists and NAME for tables of the user."""
    for choice in choices(node):
        for key, below in choice.get("properties", {}).items():
            if key == name:
                yield ".".join((*path, key))
            yield from places_of(name, below, (*path, key))
        if isinstance(choice.get("additionalProperties"), dict):
            yield from places_of(name, choice["additionalProperties"], (*path, "NAME"))
        if isinstance(choice.get("items"), dict):
            yield from places_of(name, choice["items"], (*path, "*"))


def problem_of(key):
    """Why the case language has no such key; None where it has."""
    if schema() is None:
        return None
    names, nodes = key.split("."), list(choices(schema()))
    for depth, name in enumerate(names):
        above, known, is_list, below = ".".join(names[:depth]), [], False, []
        for node in nodes:
            if node == {}:
                return None   # anything
            if node.get("type") == "array":
                is_list = True
                if name == "*" or name.isdigit():
                    below.append(node.get("items", {}))
            elif node.get("type") == "object":
                known += node.get("properties", {})
                others = node.get("additionalProperties", {})
                if name in node.get("properties", {}):
                    below.append(node["properties"][name])
                elif isinstance(others, dict):
                    below.append(others)
        if not below:
            where = f"in {above}" if above else "in a case"
            near = difflib.get_close_matches(name, known, 1)
            elsewhere = list(dict.fromkeys(places_of(name, schema())))[:MOST_PLACES] if depth == 0 else []
            if is_list and not known:
                return f"{above} is a list: after it comes a number from 0, or * for all of it, not '{name}'"
            if elsewhere:
                return f"there is no key '{name}' {where}, did you mean {' or '.join(repr(place) for place in elsewhere)}?"
            if near:
                return f"there is no key '{name}' {where}, did you mean '{near[0]}'?"
            if known:
                return f"there is no key '{name}' {where}; there are: {', '.join(dict.fromkeys(known))}"
            return f"{above} is a value; there is no '{name}' in it"
        nodes = [choice for node in below for choice in choices(node)]
    return None


def check(key, what):
    if (problem := problem_of(key)) is not None:
        raise Wrong(f"{what}: {key}: {problem} (decomposer/CASE.md)")


def hidden(text):
    """The text with a sign of no meaning for each in quotes and brackets, so that only what separates keys and values remains."""
    while (less := QUOTED.sub(lambda found: "\0" * len(found[0]), text)) != text:
        text = less
    return text


def split(text, sign):
    """The parts of a text between the signs that do not stand in quotes or brackets."""
    places = [-1, *(place for place, letter in enumerate(hidden(text)) if letter == sign), len(text)]
    return [text[begin + 1:end] for begin, end in zip(places, places[1:])]


def axes_of(sweep):
    """[(key, value), ...] for each key of a sweep such as "pairs.*.friction=0.2|0.4;time.duration=1 s|2 s"."""
    axes = []
    for part in (part.strip() for part in split(sweep, ";")):
        if not part:
            continue
        key, equals, values = part.partition("=")
        key = key.strip()
        if not equals or not key or not all(value.strip() for value in split(values, "|")):
            raise Wrong(f"sweep: '{part}' found, expected KEY=VALUE|VALUE|..., for instance pairs.*.friction=0.2|0.4")
        if further := FURTHER_KEY.search(hidden(values)):
            corrected, end = "", len(values)
            for found in reversed(list(FURTHER_KEY.finditer(hidden(values)))):
                corrected, end = ";" + values[found.start(1):end] + corrected, found.start()
            corrected = f"{key}={values[:end]}{corrected}"
            raise Wrong(f"sweep: '{further[1]}=' stands in a value of {key}; keys are separated by a semicolon: \"sweep={sweep.replace(part, corrected)}\"")
        if "," in hidden(values):
            corrected = "|".join(value.strip() for words in split(values, "|") for value in split(words, ","))
            raise Wrong(f"sweep: a comma stands in a value of {key}={values}; values of a sweep are separated by |: \"sweep={sweep.replace(part, f'{key}={corrected}')}\"; "
                        "a value with a comma in it stands in quotes or brackets")
        check(key, "sweep")
        if any(key == axis[0][0] for axis in axes):
            raise Wrong(f"sweep: {key} stands there twice; give all its values in one place: {key}=VALUE|VALUE|...")
        axes.append([(key, value.strip()) for value in split(values, "|")])
    return axes
