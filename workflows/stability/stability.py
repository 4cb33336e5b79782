#!/usr/bin/env python3
"""Runs the stiff and extreme cases X1 to X31 and tells which are held, refused with a named reason, or failed.

usage: stability.py BIN OUT [--only X1,X8] [--json FILE]

X30 and X31 take from ten minutes to hours and run only when they are named.

A case holds when its figure is within its criterion; it is refused when a tool ends with exit 2, 3 or 5 and says why;
everything else has failed: a NaN, a body that went through a wall unnoticed, a figure out of its criterion, a crash.
"""
import argparse
import json
import math
import os
import re
import sys
import time
import traceback

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "validation"))
sys.path.insert(0, HERE)

from scene import ToolError, Tools  # noqa: E402  (after the path is set)

HELD, REFUSED, FAILED = "held", "refused", "failed"
ON_DEMAND = ("X30", "X31")


class Table:
    """Rows (case, what, verdict, figure) of one session."""

    def __init__(self):
        self.rows, self.case = [], ""

    def add(self, what, verdict, figure):
        self.rows.append({"case": self.case, "what": what, "verdict": verdict, "figure": figure})
        print(f"  {verdict:8} {what}: {figure}", flush=True)

    def figure(self, what, value, limit, text=""):
        """Held when value <= limit; NaN is never held."""
        self.add(what, HELD if value <= limit else FAILED, f"{text + ' ' if text else ''}{value:.3g} (at most {limit:.3g})")

    def truth(self, what, holds, text):
        self.add(what, HELD if holds else FAILED, text)

    def refusal(self, what, error):
        """A named refusal, or a failure when the tool crashed or said nothing."""
        said = [line for line in error.text.splitlines() if "error:" in line]
        message = said[-1].split("error:", 1)[1].strip() if said else ""
        message = re.sub(r"/[^ :]*/", "", message)  # folders of this machine
        verdict = REFUSED if error.code in (2, 3, 5) and message else FAILED
        self.add(what, verdict, f"exit {error.code}: {message[:220] or 'no message: ' + error.text.strip()[-160:]}")

    def must_refuse(self, what, action, words=""):
        """A refusal that says these words is the right answer; another one, or going on, is a failure."""
        try:
            action()
        except ToolError as error:
            if words in error.text:
                self.refusal(what, error)
            else:
                self.add(what, FAILED, f"refused, but not for '{words}': {error.text.strip()[-200:]}")
        else:
            self.add(what, FAILED, "accepted in silence")


def finite(run):
    return bool(numpy.isfinite(run.x).all() and numpy.isfinite(run.v).all() and numpy.isfinite(run.w).all() and numpy.isfinite(run.q).all())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--only", default="")
    parser.add_argument("--json", default="")
    arguments = parser.parse_args()
    import extremes_motion
    import extremes_shapes
    cases = {f.id: f for f in extremes_motion.CASES + extremes_shapes.CASES}
    wanted = [name for name in arguments.only.split(",") if name] or sorted(set(cases) - set(ON_DEMAND), key=lambda name: int(name[1:]))
    tools, table = Tools(arguments.bin, arguments.out), Table()
    titles, times = {}, {}
    try:
        for name in wanted:
            case = cases[name]
            table.case, titles[name] = name, case.title
            print(f"{name} {case.title}", flush=True)
            started = time.time()
            try:
                case(tools, table)
            except ToolError as error:
                table.refusal("the case as a whole", error)
            except Exception:
                traceback.print_exc()
                table.add("the case as a whole", FAILED, traceback.format_exc().strip().splitlines()[-1])
            times[name] = time.time() - started
            print(f"  {times[name]:.1f} s", flush=True)
    finally:
        tools.clean()
    counts = {v: sum(row["verdict"] == v for row in table.rows) for v in (HELD, REFUSED, FAILED)}
    print(f"stability: {counts[HELD]} held, {counts[REFUSED]} refused with a named reason, {counts[FAILED]} failed")
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({"rows": table.rows, "titles": titles, "seconds": times}, file, indent=1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
