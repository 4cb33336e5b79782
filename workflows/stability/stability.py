#!/usr/bin/env python3
"""Runs the stiff and extreme cases X1 to X32 and tells which are held, refused with a named reason, or failed.

usage: stability.py BIN OUT [--only X1,X8] [--json FILE]

X30 and X31 take from ten minutes to an hour and run only when they are named.

A case holds when its figure is within its criterion; it is refused when a tool ends with exit 2, 3 or 5 and says why;
everything else has failed: a NaN, a body that went through a wall unnoticed, a figure out of its criterion, a crash.
"""
import argparse
import json
import os
import sys
import time
import traceback

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "validation"))
sys.path.insert(0, HERE)

import extremes_attraction  # noqa: E402  (after the path is set)
import extremes_motion  # noqa: E402
import extremes_shapes  # noqa: E402
from scene import ToolError, Tools  # noqa: E402
from verdicts import FAILED, HELD, REFUSED, Table  # noqa: E402

ON_DEMAND = ("X30", "X31")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--only", default="")
    parser.add_argument("--json", default="")
    arguments = parser.parse_args()
    cases = {f.id: f for f in extremes_motion.CASES + extremes_shapes.CASES + extremes_attraction.CASES}
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
