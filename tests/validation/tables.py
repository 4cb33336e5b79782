#!/usr/bin/env python3
"""Markdown tables from the results of validate.py --json. usage: tables.py RESULT.json... (to stdout)"""
import json
import re
import sys

import known_misses
from report import number


HEADER = """# Validation

Every case of `tests/validation`, run through the tools as a user runs them, against closed forms and published values. The
demands are those of the validation plan of the project and are not loosened: a miss is shown as a miss, with its reason.
Made by `./workflows/run validation`; the file is its `validation.md`.

Letters: G mass properties, C normal contact (C4 to C11: tests 1 to 8 of Chung and Ooi, Granular Matter 13 (2011) 643),
I impulses of bodies off centre, F friction and rolling, R free rotation, S statics, N concave bodies, B packings and silos, D drag in a fluid.
Tier U runs with every commit, tier N in the workflow, tier W (B and N6, at a small size) on demand. A body with facets is
held against the formula with its own mass and inertia, and the facet error is told apart. Two demands stay missed for reasons
of physics: `docs/decisions/010`.
Mesh independence, ranks and what is left out have no case here: `docs/validation-demands.md` goes through their demands.
"""


def load(paths):
    cases, checks = [], []
    for path in paths:
        with open(path) as file:
            data = json.load(file)
        again = {c["case"] for c in data["cases"]}  # a later file replaces what an earlier one says of its cases
        cases = [c for c in cases if c["case"] not in again] + data["cases"]
        checks = [k for k in checks if k["case"] not in again] + data["checks"]
    order = {name: i for i, name in enumerate("GCIFRSNBD")}
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


def main():
    cases, checks = load(sys.argv[1:])
    own = {c["case"]: [k for k in checks if k["case"] == c["case"]] for c in cases}
    print(HEADER)
    print("## Summary\n")
    print("Times are seconds in the solver, on a machine that does other work too; steps and contacts (largest mean of a run) tell the size.\n")
    print("The last column tells how much of the tolerance the check closest to its limit uses.\n")
    print(row("case", "what", "tier", "checks", "missed", "steps", "contacts", "s", "of the tolerance"))
    print(row(*["---"] * 9))
    for c in cases:
        missed = f"**{c['misses']}**" if c["misses"] else "0"
        print(row(c["case"], c["title"], c["tier"], c["checks"], f"**did not run**: {c['failure']}" if c["failure"] else missed,
                  c["steps"], f"{c['contacts']:.3g}", f"{c['solver_seconds']:.2f}", f"{max((k['used'] for k in own[c['case']]), default=0):.0%}"))
    misses = [k for k in checks if not k["holds"]]
    print(f"\n{len(cases)} cases, {len(checks)} checks, {len(misses)} missed.\n")
    if misses:
        print("## Missed demands\n")
        print(row("case", "what", "measured", "demanded", "tolerance", "why"))
        print(row(*["---"] * 6))
        for k in misses:
            print(row(k["case"], k["what"], number(k["measured"]), expected(k), tolerance(k), known_misses.reason(k["case"], k["what"]) or "not explained yet"))
        print()
    print("## Published values\n")
    print("Of every case with a source, the comparison of two values that lies furthest off, measured in its tolerance.\n")
    print(row("case", "source", "quantity", "measured", "published or closed form", "tolerance", "error"))
    print(row(*["---"] * 7))
    for c in cases:
        compared = [k for k in own[c["case"]] if k["kind"] in ("relative", "absolute") and k["tolerance"] > 0]
        if c["source"] and compared:
            k = max(compared, key=lambda k: k["used"])
            print(row(c["case"], c["source"], k["what"], number(k["measured"]), expected(k), tolerance(k), error(k)))
    print()
    for c in cases:
        if not own[c["case"]]:
            continue
        print(f"## {c['case']}: {c['title']}\n")
        if c["source"]:
            print(f"Reference: {c['source']}.\n")
        print(row("quantity", "measured", "expected", "tolerance", "error", ""))
        print(row(*["---"] * 6))
        for k in own[c["case"]]:
            note = f" ({k['note']})" if k["note"] else ""
            print(row(k["what"] + note, number(k["measured"]), expected(k), tolerance(k), error(k), "" if k["holds"] else "**miss**"))
        print()


if __name__ == "__main__":
    main()
