#!/usr/bin/env python3
"""Runs the commands of documentation pages as they stand there. usage: commands_test.py GROUP ROOT BIN SCRATCH

A command is a ```sh block, or an indented line that begins with one of our tools or scripts, or with what starts them. A page is run from top to
bottom in a folder of its own; what its commands need and do not make (a mesh, a case, a finished run) is put there before by stand_ins.sh.
- not_run.txt lists the lines that are not run, and why.
- workflows/run becomes a dry run, which reads all of a case and decides all its steps; cases_test.sh, boulders_test.py and studies_test.sh run
  the small sizes whole.
Fails, too, when a page with commands belongs to no group.
"""
import os
import re
import shutil
import subprocess
import sys

GROUPS = {
    "guide": ["docs/user/install.md", "docs/user/start-here.md", "docs/user/cookbook.md"],
    "tools": ["README.md", "mesher/README.md", "decomposer/README.md", "solver/README.md", "post/README.md", "post/STATISTICS.md"],
    "python": ["post/python/README.md"],
    "workflows": ["docs/results/distance-study.md", "docs/results/cases.md", *(f"workflows/{name}/README.md" for name in (
        "ballast", "beam", "boulders", "brazilian", "calibrate", "coater", "column", "compression", "conveyor", "crater", "critical-state", "crush", "cuboids", "dice", "distance-study", "drum", "error", "flow-function", "fluidised", "granite", "granuheap", "heated-bed", "heated-drum", "hopper", "impact", "mill", "mixer", "peers", "press", "repose", "rockfall", "scaling", "screen", "shape-dial", "shear-box", "shear-flow", "silo", "stability", "staples", "sticky", "triaxial", "tube", "unbroken", "validation", "wet-drum", "work-precision"))],
    "tests": ["docs/develop/testing.md", "tests/sanitizers/README.md", "tests/validation/README.md", "tests/metamorphic/README.md", *(f"tests/benchmarks/{name}/README.md" for name in (
        "broad_phase", "candidates", "distance", "leave_out", "peers", "plan", "steps"))],
}
# a template of docs/results/distance-study.md, and a page whose commands need the changes that extending_test.py makes
NOT_HERE = {"workflows/distance-study/page.md", "docs/develop/extending.md"}
COMMAND = re.compile(r"(\./|\(?cd |[A-Z_]+=\S+ |scree-(mesher|decomposer|solver|post|bench-|peers-)|mpirun |cmake |ctest |paraview |pvbatch |xvfb-run |tests/|workflows/|packaging/)")

GROUP, ROOT, BIN, SCRATCH = sys.argv[1:5]
HERE = os.path.dirname(os.path.abspath(__file__))


def left_out():
    """(page, command) of not_run.txt."""
    with open(os.path.join(HERE, "not_run.txt"), encoding="utf-8") as file:
        return {tuple(part.strip() for part in line.split(" | ")[:2]) for line in file if not line.startswith("#")}


NOT_RUN = left_out()
met = set()


def is_run(page, line):
    entry = (page, line.split("#")[0].strip())
    if entry in NOT_RUN:
        met.add(entry)
    return entry not in NOT_RUN


def scripts_of(page):
    """The commands of a page, in order."""
    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        text = file.read()
    found = []
    for fenced, indented in re.findall(r"^```sh\n(.*?)^```|((?:^    [^\n]*\n)+)", text, flags=re.S | re.M):
        if fenced:
            found.append("".join(line for line in fenced.splitlines(keepends=True) if is_run(page, line)))
            continue
        lines = re.sub(r"\\\n\s*", "", re.sub(r"^    ", "", indented, flags=re.M)).splitlines()
        found += [line for line in lines if COMMAND.match(line) and is_run(page, line)]
    return [script for script in found if script.strip()], text


def pages_with_commands():
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders if not name.startswith(".") and name not in ("build", "out")]
        for name in files:
            page = os.path.relpath(os.path.join(folder, name), ROOT)
            if name.endswith(".md") and page not in NOT_HERE and scripts_of(page)[0]:
                yield page


def run(page):
    folder = os.path.join(SCRATCH, page.replace("/", "-").removesuffix(".md"))
    os.makedirs(os.path.join(folder, "build", "release"))
    os.symlink(BIN, os.path.join(folder, "build", "release", "bin"))
    for name in ("workflows", "tests", "post"):
        os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
    environment = dict(os.environ, PATH=BIN + os.pathsep + os.environ["PATH"], PYTHONDONTWRITEBYTECODE="1")
    environment.pop("SCREE_BIN", None)

    def execute(script, what):
        result = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder, env=environment, capture_output=True, text=True, timeout=900)
        assert result.returncode == 0, f"{page}: exit {result.returncode} of {what}\n{script}\n{result.stdout}\n{result.stderr}"

    execute(f"'{HERE}/stand_ins.sh' {page}", "stand_ins.sh")
    scripts, text = scripts_of(page)
    for script in scripts:
        dry = re.sub(r"^((?:\./)?workflows/run [^#\n]*?)(\s*(#.*)?)$", rf"\1 --dry-run{'' if '--out' in script else ' --out dry'}\2", script, flags=re.M)
        execute(dry, "the command")
    for target in re.findall(r"\]\(([^)#:]+)\)", text):
        assert os.path.exists(os.path.join(ROOT, os.path.dirname(page), target)), f"{page}: the link to {target} leads nowhere"
    print(f"{page}: {len(scripts)} commands ran", flush=True)


forgotten = set(pages_with_commands()) - set(sum(GROUPS.values(), []))
assert not forgotten, f"commands of these pages are run by no test: {', '.join(sorted(forgotten))}; add them to GROUPS in {__file__}"
assert met == NOT_RUN, f"not_run.txt names commands that no page has: {sorted(NOT_RUN - met)}"
shutil.rmtree(SCRATCH, ignore_errors=True)
for page in GROUPS[GROUP]:
    run(page)
shutil.rmtree(SCRATCH)
