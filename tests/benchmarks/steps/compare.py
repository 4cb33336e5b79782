"""Two commits on the same beds: instructions a body and step, and whether the bits are the same.

Instructions are those of Simulation::advance, counted by valgrind (callgrind): a busy machine does not change them. A solver of another
commit is built beside this one, from a worktree of its own in the output folder. Every count joins OUT/history.csv, a row a commit and bed:
a loss shows there whenever it came.
"""
import csv
import datetime
import json
import os
import re
import subprocess
from pathlib import Path

import scene

ROOT = Path(__file__).resolve().parents[3]
BALL_STEP = 2e-5   # of soft balls of 1 cm [s]
COLUMNS = ["commit", "date", "bed", "bodies", "steps", "instructions_per_body_step", "state_hash"]


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()


def built(out, commit):
    """The solver of a commit: made once."""
    tree, build = out / f"tree-{commit[:12]}", out / f"build-{commit[:12]}"
    solver = build / "bin" / "scree-solver"
    if not solver.exists():
        if not tree.exists():
            git("worktree", "add", "--detach", tree, commit)
        log = out / f"build-{commit[:12]}.log"
        with open(log, "w") as words:
            for command in (["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSCREE_TESTS=OFF"],
                            ["cmake", "--build", build, "--target", "scree-solver"]):
                if subprocess.run([str(word) for word in command], stdout=words, stderr=words).returncode != 0:
                    raise RuntimeError(f"{commit[:12]} does not build; see {log}")
    return solver


def bed_of_balls(out, side, steps, settle_seconds):
    """Soft balls of one size at rest in a box, with friction; the scene starts from the run that settled them."""
    folder, length = out / f"balls-{side}", side * 2.04 * scene.RADIUS
    folder.mkdir(parents=True, exist_ok=True)
    head = f"""title = "balls"
seed = 1
gravity = [0, 0, {-scene.GRAVITY}]
[materials.glass]
density = {scene.DENSITY}
young = 1e7
poisson = 0.3
[[pairs]]
between = ["glass", "glass"]
restitution = {scene.RESTITUTION}
friction = 0.3
[contact]
law = "hertz-mindlin"
[[walls]]
shape = {{ box_inside = [[0, 0, 0], [{length!r}, {length!r}, {3 * length!r}]] }}
material = "glass"
"""

    def pack(name, rest, seconds):
        path = folder / f"{name}.toml"
        path.write_text(head + f"[time]\nduration = {seconds!r}\nstep = {BALL_STEP!r}\n[output]\nevery = {seconds!r}\ncontacts = false\n" + rest)
        scene.run_tool(["scree-decomposer", "pack", path, "-o", path.with_suffix(".scene.h5")])
        return path.with_suffix(".scene.h5")

    run = folder / "settle.run"
    if not (run / "run.json").exists():
        bodies = f"[shapes.ball]\nsphere = {{ radius = {scene.RADIUS} }}\n"
        for i in range(side ** 3):
            cell = (i % side, i // side % side, i // side ** 2)
            speed = [0.1 * ((7 * i + 3 * k) % 11 - 5) / 5 for k in range(3)]   # so that they do not stay above each other
            place = [(c + 0.5) * 2.04 * scene.RADIUS for c in cell]
            bodies += f'[[bodies]]\nshape = "ball"\nmaterial = "glass"\nposition = {place!r}\nvelocity = {speed!r}\n'
        settle = pack("settle", bodies, settle_seconds)
        scene.run_tool(["rm", "-rf", run])
        scene.run_tool(["scree-solver", settle, "-o", run], env=scene.one_core())
    return pack("balls", f'[start]\nrun = "{run.name}"\n', steps * BALL_STEP), side ** 3


def count(solver, packed, folder, bodies, steps):
    """Instructions a body and step, and the hash of the last state."""
    run = folder / "counted.run"
    scene.run_tool(["rm", "-rf", run])
    words, _ = scene.run_tool(["valgrind", "--tool=callgrind", "--toggle-collect=scree::Simulation::advance()",
                               f"--callgrind-out-file={folder / 'counted.callgrind'}", solver, packed, "-o", run], merge=True, env=scene.one_core())
    record = json.loads((run / "run.json").read_text())
    return int(re.search(r"Collected\s*:\s*(\d+)", words).group(1)) / (bodies * steps), record["state_hash"]


def note(out, rows):
    path = out / "history.csv"
    known = list(csv.DictReader(open(path))) if path.exists() else []
    fresh = {(row["commit"], row["bed"]) for row in rows}
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows([row for row in known if (row["commit"], row["bed"]) not in fresh] + rows)


def compare(out, revision, beds, steps):
    """Prints a line for each of `beds` ({name: (packed scene, bodies)}); gives whether all bits are the same."""
    theirs = git("rev-parse", f"{revision}^{{commit}}")
    changed = git("status", "--porcelain", "--untracked-files=no") != ""
    mine = git("rev-parse", "HEAD") + ("-changed" if changed else "")
    here = next(Path(folder) for folder in os.environ["PATH"].split(":") if (Path(folder) / "scree-solver").exists()) / "scree-solver"
    solvers = {theirs: built(out, theirs), mine: here}
    rows, same = [], True
    print(f"instructions a body and step: {theirs[:12]}, this build, their ratio")
    for name, (packed, bodies) in beds.items():
        counts = {commit: count(solver, packed, out, bodies, steps) for commit, solver in solvers.items()}
        for commit, (instructions, state) in counts.items():
            rows.append(dict(zip(COLUMNS, (commit, datetime.date.today().isoformat(), name, bodies, steps, f"{instructions:.0f}", state))))
        (before, state_before), (now, state_now) = counts[theirs], counts[mine]
        same = same and state_before == state_now
        print(f"  {name:16} {before:8,.0f} {now:8,.0f} {before / now:6.2f}   {'same bits' if state_before == state_now else 'OTHER BITS'}", flush=True)
    note(out, rows)
    return same
