#!/usr/bin/env python3
"""Markdown table of the results of stability.py --json. usage: table.py RESULT.json... (to stdout)"""
import json
import os
import sys

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "table_header.md")) as file:
    print(file.read(), end="")
rows, titles = [], {}
for path in sys.argv[1:]:
    with open(path) as file:
        data = json.load(file)
    rows += data["rows"]
    titles.update(data["titles"])
order = sorted(titles, key=lambda name: int(name[1:]))


def cells(*values):
    return "| " + " | ".join(str(v).replace("|", "\\|").replace("\n", " ") for v in values) + " |"


counts = {verdict: sum(r["verdict"] == verdict for r in rows) for verdict in ("held", "refused", "failed")}
print(cells("case", "held", "refused with a named reason", "failed"))
print(cells(*["---"] * 4))
for name in order:
    own = [r["verdict"] for r in rows if r["case"] == name]
    failed = own.count("failed")
    print(cells(f"{name} {titles[name]}", own.count("held"), own.count("refused"), f"**{failed}**" if failed else 0))
print()
for name in order:
    print(f"### {name}: {titles[name]}\n")
    print(cells("what", "verdict", "figure or reason"))
    print(cells(*["---"] * 3))
    for r in rows:
        if r["case"] == name:
            print(cells(r["what"], f"**{r['verdict']}**" if r["verdict"] == "failed" else r["verdict"], r["figure"]))
    print()
print(f"{counts['held']} held, {counts['refused']} refused with a named reason, {counts['failed']} failed.")
