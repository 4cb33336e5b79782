#!/usr/bin/env python3
"""The JSON Schema of the case language, from the program that reads it and the page that explains it.

usage: make_schema.py PRINT_READS CASE.md CASE.toml... [-o SCHEMA | --check SCHEMA]

Types, units, ranges and words come from what the reader asked of the cases, which hold every key once; meanings, defaults and
what is required come from the tables of CASE.md. Ends with 1 when a key is read by no case, when the page and the reader do
not name the same keys, or (--check) when the schema in the file is not the one that is made.
"""
import argparse
import json
import re
import subprocess
import sys

RANGES = {"any": {}, "positive": {"exclusiveMinimum": 0}, "not_negative": {"minimum": 0},
          "unit_interval": {"minimum": 0, "maximum": 1}, "fraction": {"exclusiveMinimum": 0, "exclusiveMaximum": 1}}
QUANTITY = r"^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*[^\s].*$"   # a number and a unit
VECTOR = {"type": "array", "minItems": 3, "maxItems": 3}


def page_rows(path):
    """(table, key) -> (default, meaning), of the sections of CASE.md that explain tables of the case; and, as (table, keys), the
    keys of which one and only one must be there: "`a` or `b`" and "required"; and the tables that may be left out: "(absent: ...)"."""
    rows, choices, left_out, tables, in_example = {}, [], set(), [], False
    for line in open(path, encoding="utf-8"):
        if line.startswith("```"):
            in_example = not in_example
        if in_example:
            continue
        if line.startswith("## "):
            tables = [""] if line.startswith("## Top level") else [
                re.sub(r"\.NAME$", ".*", name) for name in re.findall(r"`\[([a-z_.NAME]+)\]`", line)]
            tables += [name + "[]" for name in re.findall(r"`\[\[([a-z_]+)\]\]`", line)]
            if "(absent: " in line:
                left_out.update(tables)
            continue
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]
        if not tables or len(cells) != 4 or not cells[0].startswith("`"):
            continue
        names = re.findall(r"`([a-z_.]+)`", cells[0])
        either = " or " in cells[0] and cells[2] == "required"
        if either:
            choices.append((tables[0], names))
        for name in names:
            table, key = name.split(".") if "." in name else (tables[0], name)
            rows[table, key] = ("" if either else cells[2].replace("`", ""), cells[3].replace("`", ""))
    return rows, choices, left_out


def number(read):
    plain = {"type": "number", **RANGES[read["range"]]}
    if not read["dimension"]:
        return plain
    return {"anyOf": [plain, {"type": "string", "pattern": QUANTITY, "description": read["dimension"] + ", with its unit"}]}


def value_of(read, build_table):
    """The schema of what one call of the reader accepts."""
    kind, below = read["kind"], (read["table"] + "." if read["table"] else "") + read["key"]
    if kind == "number":
        return number(read)
    if kind == "integer":
        return {"type": "integer", **RANGES[read["range"]]}
    if kind == "boolean":
        return {"type": "boolean"}
    if kind == "text":
        return {"type": "string"}
    if kind == "word":
        return {"enum": read["words"]}
    if kind == "vector":
        return {**VECTOR, "items": number(read)}
    if kind == "corners":
        return {"type": "array", "minItems": 2, "maxItems": 2, "items": {**VECTOR, "items": number(read)}}
    if kind == "numbers":
        return {"type": "array", "items": number(read)}
    if kind == "vectors":
        return {"type": "array", "items": {**VECTOR, "items": number(read)}}
    if kind == "texts":
        return {"type": "array", "items": {"type": "string"}}
    if kind == "named_numbers":
        return {"type": "object", "minProperties": 1, "additionalProperties": number(read)}
    if kind == "named_tables":
        return {"type": "object", "additionalProperties": build_table(below + ".*")}
    if kind == "tables":
        return {"type": "array", "items": build_table(below + "[]")}
    return build_table(below)   # table


# a call that knows more about the value makes these say nothing new
IMPLIED = {"word": {"text"}, "named_numbers": {"table"}, "named_tables": {"table"}}


def make_schema(reads, rows, exclusive, left_out):
    asked = {}
    for read in reads:
        if read["kind"] != "allowed":
            calls = asked.setdefault((read["table"], read["key"]), [])
            if read not in calls:
                calls.append(read)
    maps = {(t + "." if t else "") + k for (t, k), calls in asked.items() for c in calls if c["kind"] == "named_numbers"}
    asked = {place: calls for place, calls in asked.items() if place[0] not in maps}
    allowed = sorted({(r["table"], r["key"]) for r in reads if r["kind"] == "allowed"})
    faults = [f"'{t}.{k}' may stand in a case, and none of the cases given here makes the reader read it" for t, k in allowed if (t, k) not in asked]
    explained = {table for table, _ in rows}
    faults += [f"'{t}.{k}' is read, and CASE.md has no row for it" for t, k in allowed
               if t in explained and (t, k) not in rows and not any(c["kind"] in ("table", "tables", "named_tables") for c in asked.get((t, k), []))]
    faults += [f"CASE.md explains '{t}.{k}', which nothing reads" for t, k in rows if (t, k) not in allowed]

    def build_table(path):
        properties, required = {}, []
        for table, key in allowed:
            if table != path:
                continue
            calls = asked.get((table, key), [])
            kinds = {c["kind"] for c in calls}
            hidden = set().union(*(IMPLIED.get(k, set()) for k in kinds))
            choices = []
            for call in calls:
                choice = value_of(call, build_table)
                if call["kind"] not in hidden and choice not in choices:
                    choices.append(choice)
            value = choices[0] if len(choices) == 1 else {"anyOf": choices}
            below = f"{table}.{key}" if table else key
            inside = below not in left_out and any("required" in choice and choice.get("type") == "object" for choice in choices)
            default, meaning = rows.get((table, key), ("", ""))
            if meaning:
                value = {"description": meaning + (f" (default: {default})" if default not in ("", "required") else ""), **value}
            if default == "required" or inside:
                required.append(key)   # a table with a key that must be there must be there itself
            properties[key] = value
        one_of = [{"oneOf": [{"required": [key]} for key in keys]} for table, keys in exclusive if table == path]
        return {"type": "object", "additionalProperties": False, "properties": properties, **({"required": required} if required else {}),
                **({"allOf": one_of} if one_of else {})}

    schema = {"$schema": "http://json-schema.org/draft-07/schema#", "title": "Scree: a case of the discrete element method", **build_table("")}
    return schema, faults


def main():
    parser = argparse.ArgumentParser(description="JSON Schema of the case language")
    parser.add_argument("print_reads")
    parser.add_argument("page")
    parser.add_argument("cases", nargs="+")
    parser.add_argument("-o", "--output")
    parser.add_argument("--check")
    arguments = parser.parse_args()
    reads = json.loads(subprocess.run([arguments.print_reads, *arguments.cases], check=True, capture_output=True, text=True).stdout)
    schema, faults = make_schema(reads, *page_rows(arguments.page))
    text = json.dumps(schema, indent=1, ensure_ascii=False) + "\n"
    if arguments.check and open(arguments.check, encoding="utf-8").read() != text:
        faults.append(f"{arguments.check} is not what the reader and CASE.md make now; make it anew with\n"
                      f"  {' '.join(sys.argv[:3])} {' '.join(arguments.cases)} -o {arguments.check}")
    for fault in faults:
        print(fault, file=sys.stderr)
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    sys.exit(1 if faults else 0)


main()
