#!/usr/bin/env python3
"""Every validation case is in the workflow and in its tables; those of tier U are tests. usage: groups_test.py"""
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def words(text):
    return set(re.findall(r"\b[A-Z]\d+\b", text))


def main():
    cases = {}
    for name in os.listdir(HERE):
        if name.startswith("cases_"):
            with open(os.path.join(HERE, name)) as file:
                cases |= dict(re.findall(r'@case\("([A-Z]\d+)", "([UNW])"', file.read()))
    with open(os.path.join(HERE, "..", "..", "workflows", "validation", "Snakefile")) as file:
        workflow = words(file.read().split("rule all")[0])
    with open(os.path.join(HERE, "CMakeLists.txt")) as file:
        tests = words(" ".join(re.findall(r"foreach\((?:group|case) ([^)]*)\)", file.read())))
    import tables
    told = {case for case in cases if case[0] in tables.GROUPS}
    quick = {case for case, tier in cases.items() if tier == "U"}
    lists = (("workflows/validation/Snakefile", set(cases), workflow), ("tables.py", set(cases), told),
             ("CMakeLists.txt", quick, tests))
    faults = [f"{place}: {sorted(there - has)} are not in it" for place, there, has in lists if there - has]
    print("\n".join(faults) or f"{len(cases)} cases")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
