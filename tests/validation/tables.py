#!/usr/bin/env python3
"""The page of docs/results/validation.md from the results of validate.py --json. usage: tables.py RESULT.json... [--note TEXT] (to stdout)

What was found comes first: counts and the missed requirements with their reasons. All tables are folded below. TEXT says how the
results were obtained.
"""
import argparse
import html
import json
import re

import known_misses
from report import number


HEADER = """# Validation

Every case of `tests/validation`, run through the tools as a user runs them, and compared with closed forms and published values. The
requirements are those of the validation plan (`docs/reference/validation-plan.md`). They are not loosened: a miss is shown as a miss, with
its reason. Made by `./workflows/run validation`; the file is its `validation.md`.
"""

GROUPS = {
    "G": "mass properties", "C": "normal contact; C4 to C11 are tests 1 to 8 of Chung and Ooi, Granular Matter 13 (2011) 643",
    "I": "impulses of bodies off centre", "F": "friction and rolling", "R": "free rotation", "S": "statics", "M": "arches and dominoes", "N": "concave bodies",
    "B": "packings and silos", "D": "drag in a fluid", "E": "starts from a run", "Q": "inlets and outlets", "K": "belts and turntables", "L": "walls that answer to load", "T": "where touch begins", "W": "load maps and wear",
    "A": "attraction", "J": "bonds", "Y": "bodies that sleep", "V": "bodies in valleys", "O": "beyond the maximum overlap", "H": "heat", "Z": "periodic cells",
    "P": "contacts that yield"}

READING = """Tier U runs in the tests (cases above ten seconds with the slow ones), tier N in the workflow, tier W (B and N6, at a small size) on demand. A body with facets is compared with
the formula with its own mass and inertia; the error of the facets is listed separately. Mesh independence, ranks and features that are left
out have no case here: see `docs/results/validation-demands.md`. Two requirements cannot be met for physical reasons: `docs/develop/decisions/010`.
"""


def load(paths):
    cases, checks = [], []
    for path in paths:
        with open(path) as file:
            data = json.load(file)
        again = {c["case"] for c in data["cases"]}  # a later file replaces the cases of an earlier one
        cases = [c for c in cases if c["case"] not in again] + data["cases"]
        checks = [k for k in checks if k["case"] not in again] + data["checks"]
    order = {name: i for i, name in enumerate(GROUPS)}
    cases.sort(key=lambda c: (order.get(c["case"][0], 9), int(re.sub(r"\D", "", c["case"]) or 0)))
    return cases, checks


def row(*cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def expected(c):
    if c["kind"] == "at most":
        return f"<= {c['tolerance']:.3g}"
    if c["kind"] == "at least":
        return f">= {c['tolerance']:.3g}"
    return number(c["expected"])


def tolerance(c):
    return {"relative": f"{100 * c['tolerance']:.3g} %", "absolute": f"{c['tolerance']:.3g}"}.get(c["kind"], "")


def error(c):
    return {"relative": f"{100 * c['error']:.2g} %", "absolute": f"{c['error']:.2g}"}.get(c["kind"], "")


def limit(c):
    """What is required, in words."""
    return f"required {expected(c)}" + (f" within {tolerance(c)}" if tolerance(c) else "")


def fold(summary, lines):
    """A section that a reader opens."""
    print(f"<details><summary>{html.escape(summary, quote=False)}</summary>\n")
    print("\n".join(lines))
    print("\n</details>\n")


def table(header, rows):
    return [row(*header), row(*["---"] * len(header)), *rows]


def findings(cases, checks, note):
    misses = [k for k in checks if not k["holds"]]
    broken = [c for c in cases if c["failure"]]
    print("## Findings\n")
    print(f"**{len(cases)} cases, {len(checks)} checks, {len(misses)} missed" + (f", {len(broken)} cases did not run" if broken else "") + ".**")
    remarks = [text for text in (note, "The missed requirements have the reasons below; everything else holds." if misses else "") if text]
    print(" ".join(remarks) + ("\n" if remarks else ""))
    print("\n".join(table(("group", "cases", "checks", "missed"), [
        row(f"{letter}: {what}", len(own), sum(c["checks"] for c in own), f"**{missed}**" if (missed := sum(c["misses"] for c in own)) else 0)
        for letter, what in GROUPS.items() if (own := [c for c in cases if c["case"][0] == letter])])))
    print()
    for c in broken:
        print(f"- {c['case']} **did not run**: {c['failure']}")
    why = {}
    for k in misses:
        why.setdefault((k["case"], known_misses.reason(k["case"], k["what"]) or "not explained yet"), []).append(k)
    for (case, reason), own in why.items():
        print(f"- **{case}**: {reason}")
        for k in own:
            print(f"  - {k['what']}: measured {number(k['measured'])}, {limit(k)}")
    if broken or misses:
        print()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+")
    parser.add_argument("--note", default="")
    arguments = parser.parse_args()
    cases, checks = load(arguments.results)
    own = {c["case"]: [k for k in checks if k["case"] == c["case"]] for c in cases}
    print(HEADER)
    findings(cases, checks, arguments.note)
    print("## Tables\n")
    print(READING)
    rows = []
    for c in cases:
        missed = f"**{c['misses']}**" if c["misses"] else "0"
        rows.append(row(c["case"], c["title"], c["tier"], c["checks"], f"**did not run**: {c['failure']}" if c["failure"] else missed,
                        c["steps"], f"{c['contacts']:.3g}", f"{c['solver_seconds']:.2f}", f"{max((k['used'] for k in own[c['case']]), default=0):.0%}"))
    fold("All cases: checks, size and time", [
        "Times are upper bounds of the seconds in the solver; steps and contacts (largest mean of a run) give the size. The last",
        "column is the share of its tolerance that the check closest to its limit uses.\n",
        *table(("case", "what", "tier", "checks", "missed", "steps", "contacts", "s", "of the tolerance"), rows)])
    rows = []
    for c in cases:
        compared = [k for k in own[c["case"]] if k["kind"] in ("relative", "absolute") and k["tolerance"] > 0]
        if c["source"] and compared:
            k = max(compared, key=lambda k: k["used"])
            rows.append(row(c["case"], c["source"], k["what"], number(k["measured"]), expected(k), tolerance(k), error(k)))
    if rows:
        fold("Published values: the largest deviation of each case with a source", [
            "Of every case with a source, the comparison of two values that uses the largest share of its tolerance.\n",
            *table(("case", "source", "quantity", "measured", "published or closed form", "tolerance", "error"), rows)])
    print("## Checks of each case\n")
    for c in cases:
        if not own[c["case"]]:
            continue
        rows = [row(k["what"] + (f" ({k['note']})" if k["note"] else ""), number(k["measured"]), expected(k), tolerance(k), error(k),
                    "" if k["holds"] else "**miss**") for k in own[c["case"]]]
        fold(f"{c['case']}: {c['title']} ({c['checks']} checks, {c['misses']} missed)", [
            *([f"Reference: {c['source']}.\n"] if c["source"] else []), *table(("quantity", "measured", "expected", "tolerance", "error", ""), rows)])


if __name__ == "__main__":
    main()
