#!/usr/bin/python3
"""Runs validation cases through the tools, as a user would, and holds them against closed forms.

usage: validate.py BIN OUT [--tier U|N|W] [--only C1,F2] [--wp FILE] [--repeat N] [--size small|real] [--json FILE] [--list]

BIN holds the executables, OUT gets the case files and errors.csv. --wp appends the rows of error against time to FILE instead,
--repeat times every run so often (five for figures of speed). A case prints what was measured, what was
expected, the tolerance of docs/reference/validation-plan.md, wall time, steps and contacts. Exit: 0 all demands met but those of known_misses.py, 1 a new miss, 2 usage.
"""
import argparse
import importlib
import json
import os
import sys
import time
import traceback

import known_misses
from report import Report
from scene import ToolError, Tools

GROUPS = ["cases_geometry", "cases_normal", "cases_chung_ooi", "cases_impulse", "cases_friction", "cases_rotation", "cases_statics",
          "cases_nonconvex", "cases_bulk", "cases_drag", "cases_start", "cases_feed", "cases_belt", "cases_load", "cases_touch", "cases_wear", "cases_cohesion", "cases_bonds", "cases_sleep", "cases_valleys", "cases_overlap", "cases_heat", "cases_cell", "cases_masonry", "cases_plastic"]


def all_cases():
    cases = {}
    for group in GROUPS:
        module = importlib.import_module(group)
        for function in module.CASES:
            cases[function.id] = function
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--tier", default="", help="only cases of these tiers, for instance U or UN")
    parser.add_argument("--only", default="", help="only these cases, comma separated")
    parser.add_argument("--wp", default="", help="file for the rows of error against time, one per run; rows are appended")
    parser.add_argument("--repeat", type=int, default=1, help="how often each run is timed")
    parser.add_argument("--size", choices=["small", "real"], default="small", help="of the bulk cases")
    parser.add_argument("--json", default="", help="all checks, for tables")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()

    cases = all_cases()
    wanted = [name for name in arguments.only.split(",") if name]
    unknown = [name for name in wanted if name not in cases]
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(cases)}")
    chosen = [c for name, c in cases.items() if (not wanted or name in wanted) and (not arguments.tier or c.tier in arguments.tier)]
    if arguments.list:
        for c in chosen:
            print(f"{c.id:5} {c.tier}  {c.title}")
        return 0

    tools = Tools(arguments.bin, arguments.out, repeat=arguments.repeat, size=arguments.size)
    report = Report(arguments.wp or os.path.join(tools.out, "errors.csv"))
    summary, failed = [], []
    try:
        for c in chosen:
            print(f"{c.id} {c.title}", flush=True)
            report.begin(c.id)
            started = time.time()
            try:
                c(tools, report)
            except ToolError as error:
                print(f"  MISS a tool refused: {error}", flush=True)
                failed.append((c.id, str(error).strip().splitlines()[-1]))
            except Exception:  # a checker that breaks is a failure of the case, and the others still run
                traceback.print_exc()
                failed.append((c.id, traceback.format_exc().strip().splitlines()[-1]))
            report.end()
            elapsed = time.time() - started
            own = [k for k in report.checks if k.case == c.id]
            print(f"  {len(own)} checks, {len(report.misses(c.id))} misses; {report.runs} runs, {report.steps} steps, {report.contacts:.3g} contacts, "
                  f"{report.seconds:.2f} s in the solver, {elapsed:.2f} s in all", flush=True)
            summary.append({"case": c.id, "tier": c.tier, "title": c.title, "source": c.source, "checks": len(own), "misses": len(report.misses(c.id)),
                            "runs": report.runs, "steps": report.steps, "contacts": report.contacts, "solver_seconds": report.seconds,
                            "seconds": elapsed, "failure": dict(failed).get(c.id, "")})
    finally:
        tools.clean()
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({"cases": summary, "checks": [vars(k) for k in report.checks]}, file, indent=1, default=float)
    print(f"validation: {len(chosen)} cases, {len(report.checks)} checks, {len(report.misses())} misses, {len(failed)} broken")
    new = [k for k in report.misses() if not known_misses.reason(k.case, k.what)]
    for k in report.misses():
        print(f"  MISS {'' if k in new else '(known) '}{k.case} {k.what}: " + " | ".join(cell for cell in k.cells() if cell))
    run = {k.case for k in report.checks}
    stale = [key for key in known_misses.KNOWN if key[0] in run and all(k.holds for k in report.checks if k.case == key[0] and k.what.startswith(key[1]))]
    for case, what in stale:
        print(f"  HOLDS AGAIN {case} {what}: take it out of known_misses.py")
    for name, why in failed:
        print(f"  BROKEN {name}: {why}")
    return 1 if new or stale or failed else 0


if __name__ == "__main__":
    sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
    sys.exit(main())
