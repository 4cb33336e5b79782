#!/usr/bin/env python3
"""The page of docs/results/stability.md from the results of stability.py --json. usage: table.py RESULT.json... (to stdout)

Counts, failures and notes.md (of the cases that were run) come first; the lines of each case are folded.
"""
import html
import json
import os
import re
import sys

FOLDER = os.path.dirname(os.path.abspath(__file__))
WORDS = {"held": "held", "refused": "refused with a named reason", "failed": "failed"}


def cells(*values):
    return "| " + " | ".join(str(v).replace("|", "\\|").replace("\n", " ") for v in values) + " |"


def text_of(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return file.read()


def count_text(rows, leave_out_zero=False):
    counts = {verdict: sum(r["verdict"] == verdict for r in rows) for verdict in WORDS}
    return ", ".join(f"{n} {WORDS[verdict]}" for verdict, n in counts.items() if n or not leave_out_zero)


rows, titles = [], {}
for path in sys.argv[1:]:
    with open(path, encoding="utf-8") as file:
        data = json.load(file)
    rows += data["rows"]
    titles.update(data["titles"])
order = sorted(titles, key=lambda name: int(name[1:]))
of_case = {name: [r for r in rows if r["case"] == name] for name in order}

print(text_of("table_header.md"), end="")
print("## Findings\n")
print(f"**{len(order)} cases, {len(rows)} lines: {count_text(rows)}.**")
refused = [f"{name} ({n})" for name in order if (n := sum(r["verdict"] == "refused" for r in of_case[name]))]
if refused:
    print(f"Cases with refusals: {', '.join(refused)}.")
print()
failed = [r for r in rows if r["verdict"] == "failed"]
for r in failed:
    print(f"- **failed**: {r['case']}, {r['what']}: {r['figure']}")
if failed:
    print()
notes = [note for note in re.findall(r"^- .*\n(?:  .*\n)*", text_of("notes.md"), flags=re.M) if re.match(r"- (X\d+)", note).group(1) in titles]
if notes:
    print("### Notes, and differences from the plan\n")
    print("".join(notes))
print("## Cases\n")
for name in order:
    print(f"<details><summary>{html.escape(f'{name}: {titles[name]}: {count_text(of_case[name], True)}', quote=False)}</summary>\n")
    print(cells("what", "verdict", "figure or reason"))
    print(cells(*["---"] * 3))
    for r in of_case[name]:
        print(cells(r["what"], f"**{r['verdict']}**" if r["verdict"] == "failed" else r["verdict"], r["figure"]))
    print("\n</details>\n")
