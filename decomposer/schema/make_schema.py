#!/usr/bin/env python3
"""The JSON Schema of the case language and the tables of CASE.md, from the keys as the decomposer reads them.

usage: make_schema.py PRINT_KEYS --schema SCHEMA --page CASE.md [--check]

PRINT_KEYS prints one record for each key (name, type, unit, range, words, default, meaning). In CASE.md, what lies between a line
`<!-- keys TABLE -->` and the next `<!-- end -->` is replaced by the table of those keys. Ends with 1 when a table of the case has no
place on the page, or (--check) when a file is not what would be written.
"""
import argparse
import json
import re
import subprocess
import sys

RANGES = {"any": {}, "positive": {"exclusiveMinimum": 0}, "not_negative": {"minimum": 0},
          "unit_interval": {"minimum": 0, "maximum": 1}, "fraction": {"exclusiveMinimum": 0, "exclusiveMaximum": 1}}
RANGE_TEXTS = {"any": "", "positive": "> 0", "not_negative": ">= 0", "unit_interval": "0 to 1", "fraction": "between 0 and 1"}
QUANTITY = r"^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?(\s*[^\s].*)?\s*$"   # a number and a unit, or in SI units
SECTIONS = {"table": "", "table_list": "",   # a list of what the key's own table says
             "tables": "[]", "named_tables": ".*"}


def array(items, count=None):
    return {"type": "array", **({"minItems": count, "maxItems": count} if count else {}), "items": items}


def is_default(text):
    """Whether the text tells what holds when the key is absent, rather than when it may be."""
    return text != "" and not text.startswith(("required", "or ", "see ", "one of "))


def below(record):
    """The table that a key opens."""
    return (record["table"] + "." if record["table"] else "") + record["key"] + SECTIONS[record["type"]]


# --- schema

def number(record):
    plain = {"type": "number", **RANGES[record["range"]]}
    if not record["dimension"]:
        return plain
    return {"anyOf": [plain, {"type": "string", "pattern": QUANTITY, "description": record["dimension"] + ", with its unit"}]}


def value_of(record, build_table):
    kind = record["type"]
    if kind == "number":
        return number(record)
    if kind == "integer":
        return {"type": "integer", **RANGES[record["range"]]}
    if kind == "boolean":
        return {"type": "boolean"}
    if kind in ("text", "path", "name"):
        return {"type": "string"}
    if kind == "word":
        return {"enum": record["words"]}
    if kind in ("vector", "direction"):
        return array(number(record), 3)
    if kind == "quaternion":
        return array({"type": "number"}, 4)
    if kind == "corners":
        return array(array(number(record), 3), 2)
    if kind == "numbers":
        return array(number(record))
    if kind == "vectors":
        return array(array(number(record), 3))
    if kind == "texts":
        return array({"enum": record["words"]} if record["words"] else {"type": "string"})
    if kind == "named_numbers":
        return {"type": "object", "minProperties": 1, "additionalProperties": number(record)}
    if kind == "named_texts":
        return {"type": "object", "minProperties": 1, "additionalProperties": {"type": "string"}}
    table = build_table(below(record))
    if kind == "named_tables":
        return {"type": "object", "additionalProperties": table}
    return array(table) if kind in ("tables", "table_list") else table


def make_schema(records):
    def build_table(path):
        properties, required, one_of = {}, [], []
        for record in (r for r in records if r["table"] == path):
            key = record["key"]
            if record["type"] == "one_of":
                one_of.append({"oneOf": [{"required": [word]} for word in record["words"]]})
            elif key not in properties:
                same = [r for r in records if (r["table"], r["key"]) == (path, key)]
                choices = []
                for choice in (value_of(r, build_table) for r in same):
                    if choice not in choices:
                        choices.append(choice)
                value = choices[0] if len(choices) == 1 else {"anyOf": choices}
                default, meaning = record["default"].replace("`", ""), record["meaning"].replace("`", "")
                if meaning:
                    value = {"description": meaning + (f" (default: {default})" if is_default(default) else ""), **value}
                if default == "required":
                    required.append(key)
                properties[key] = value
        return {"type": "object", "additionalProperties": False, "properties": dict(sorted(properties.items())),
                **({"required": sorted(required)} if required else {}), **({"allOf": one_of} if one_of else {})}

    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": "Scree: a case of the discrete element method", **build_table("")}


# --- page

def unit_of(record):
    found = re.search(r"\[(.*)\]", record["dimension"])
    return found.group(1) if found else ""


def joined(*parts):
    return ", ".join(part for part in parts if part)


def type_text(record, records):
    kind, unit, range_text = record["type"], unit_of(record), RANGE_TEXTS[record["range"]]
    if kind == "table_list":
        return "list of them"
    if kind in SECTIONS:
        return table_text(below(record), records)
    if kind == "word":
        return ", ".join(f"`{word}`" for word in record["words"])
    if kind == "texts":
        return "list of " + (", ".join(f"`{word}`" for word in record["words"]) or "texts")
    return {"number": joined(unit, range_text) or "number", "integer": joined("whole number", range_text), "boolean": "true, false",
            "vector": joined("vector", unit), "direction": "direction", "quaternion": "`[w, x, y, z]`",
            "corners": joined("`[corner, corner]`", unit), "numbers": joined("list", unit), "vectors": joined("list of vectors", unit),
            "named_numbers": "`{ NAME = number, ... }`", "named_texts": "`{ NAME = \"TEXT\", ... }`"}.get(kind, kind)


def rows_of(table, records):
    """(key, records of it), in their order."""
    rows = {}
    for record in records:
        if record["table"] == table and record["type"] != "one_of":
            rows.setdefault(record["key"], []).append(record)
    return rows


def table_text(table, records):
    """`{ axis, centre = [0, 0, 0], this or that }`"""
    keys, choices = [], [r["words"] for r in records if r["table"] == table and r["type"] == "one_of"]
    for key, same in rows_of(table, records).items():
        default = same[0]["default"].replace("`", "")
        choice = next((words for words in choices if key in words), [key])
        if key == choice[0]:
            keys.append(" or ".join(choice) + (" = " + default if is_default(default) else ""))
    return "`{ " + ", ".join(keys) + " }`"


def inner_text(table, records):
    """What the keys of a table in a table mean, behind its own meaning."""
    texts = []
    for key, same in rows_of(table, records).items():
        record, shown = same[0], ""
        if record["type"] in SECTIONS:
            shown = " " + table_text(below(record), records)
        elif unit_of(record) not in ("", "m"):
            shown = f" [{unit_of(record)}]"
        elif record["type"] == "texts" and record["words"]:
            shown = " (" + ", ".join(f"`{word}`" for word in record["words"]) + ")"
        if shown or record["meaning"]:
            texts.append(f"`{key}`{shown}" + (": " + record["meaning"] if record["meaning"] else ""))
    return "; ".join(texts)


def page_table(table, records, on_page):
    lines = ["| key | type, unit | default | meaning |", "|---|---|---|---|"]
    for key, same in rows_of(table, records).items():
        types, meanings = [], [same[0]["meaning"]]
        for record in same:
            is_section = record["type"] in SECTIONS
            text = "see below" if is_section and below(record) in on_page else type_text(record, records)
            if text not in types:
                types.append(text)
            if is_section and below(record) not in on_page:
                meanings.append(inner_text(below(record), records))
        meaning = ". ".join(m for m in meanings if m)
        cells = [f"`{key}`", " or ".join(types), same[0]["default"], meaning]
        lines.append("|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|")
    return lines


def make_page(text, records):
    """Returns the page with its tables made anew, and what is wrong with it."""
    lines, result, faults, table = text.split("\n"), [], [], None
    on_page = re.findall(r"^<!-- keys (.*?) -->$", text, re.MULTILINE)
    on_page = ["" if name == "(top level)" else name for name in on_page]
    for line in lines:
        begins = re.match(r"<!-- keys (.*?) -->$", line)
        if begins:
            table = "" if begins.group(1) == "(top level)" else begins.group(1)
            rows = rows_of(table, records)
            if not rows:
                faults.append(f"CASE.md has a place for the keys of '{table}', which is no table of the case")
            result += [line] + page_table(table, [r for r in records if table or r["type"] not in SECTIONS], on_page)
        elif line == "<!-- end -->":
            table = None
        if table is None and not begins:
            result.append(line)
    for record in records:
        if record["type"] in SECTIONS and record["table"] == "" and below(record) not in on_page:
            faults.append(f"CASE.md has no place for the keys of '{below(record)}'; add the lines <!-- keys {below(record)} --> and <!-- end -->")
    return "\n".join(result), faults


def main():
    parser = argparse.ArgumentParser(description="JSON Schema and page of the case language")
    parser.add_argument("print_keys")
    parser.add_argument("--schema", required=True)
    parser.add_argument("--page", required=True)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    records = json.loads(subprocess.run([arguments.print_keys], check=True, capture_output=True, text=True).stdout)
    with open(arguments.page, encoding="utf-8") as file:
        old_page = file.read()
    page, faults = make_page(old_page, records)
    for path, text in ((arguments.schema, json.dumps(make_schema(records), indent=1, ensure_ascii=False) + "\n"), (arguments.page, page)):
        if not arguments.check:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        elif open(path, encoding="utf-8").read() != text:
            faults.append(f"{path} is not what the keys make now; make it anew with: ninja case-schema")
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)


main()
