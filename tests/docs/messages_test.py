#!/usr/bin/env python3
"""Every message that docs/user/troubleshooting.md quotes is in the sources, in these words. usage: messages_test.py ROOT

A message is the first cell of a row, in backquotes; `...` and the end of a backquote stand for what the tool fills in."""
import os
import re
import sys

ROOT = sys.argv[1]
PAGE = "docs/user/troubleshooting.md"
TABLES = ("message", "warning")  # heads of the tables that quote


def texts():
    """The text literals of all tools, those that follow each other joined, numbers and names left out."""
    for top in ("core", "mesher", "decomposer", "solver", "post"):
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            for name in names:
                if name.endswith((".cpp", ".hpp")):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        source = re.sub(r"//[^\n\"]*\n", "\n", file.read())
                    source = re.sub(r"'\\?\"'", "''", source)
                    source = re.sub(r'(?<!\\)"\s*\n\s*"', "", source)
                    yield from (text.replace('\\"', '"') for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', source))


KNOWN = "\n".join(re.sub(r"\{\{", "{", text) for text in texts())
with open(os.path.join(ROOT, PAGE), encoding="utf-8") as page:
    lines = page.read().splitlines()
quoted, missing, inside = 0, [], False
for number, line in enumerate(lines, 1):
    cell = line.split(" | ")[0].removeprefix("| ")
    if not line.startswith("|"):
        inside = False
    elif cell in TABLES:
        inside = True
    elif inside:
        for words in re.findall(r"`([^`]+)`", cell):
            quoted += 1
            if words != "..." and words not in KNOWN:
                missing.append(f"{PAGE}:{number}: no tool says '{words}'")
assert quoted > 40, f"only {quoted} messages found"
assert not missing, "\n".join(missing)
print(f"{quoted} quoted messages are in the sources")
