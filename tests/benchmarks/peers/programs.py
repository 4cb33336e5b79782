"""The programs of the comparison, each started from the same state and timed over whole steps.

Every function returns a record: steps, cpu (seconds of the steps alone), and the judge's verdict on the state that it ended in.
"""
import json
import os
import re
import shutil
from pathlib import Path

import scene
import sphere_codes

HERE = Path(__file__).resolve().parent


def missing(program):
    """Why a program cannot run here, or nothing."""
    needed = {"Scree": "scree-solver", "Bullet GImpact": "scree-peers-bullet", "Bullet hull": "scree-peers-bullet", "Yade polyhedra": "yade",
              "LAMMPS polyhedra": "lmp", "LAMMPS spheres": "lmp", "LIGGGHTS spheres": "liggghts", "LIGGGHTS clumps of 14": "liggghts"}
    tool = needed[program]
    return "" if shutil.which(tool) else f"{tool} is not here; ./setup --peers installs what it needs"


def judged(record, shapes, end, length, before):
    """Adds what the judge finds, and how much mechanical energy came in since the start."""
    verdict = scene.judge(shapes, end, length)
    verdict["energy_change"] = verdict["energy_share"] - before["energy_share"]
    return {**record, **verdict}


def scree(shapes, start, length, work, before, steps):
    """Steps are timed as the difference of two runs, so that start and files do not count."""
    state = scene.read_state(start)
    _, idle = scene.run_scree(work, "start", shapes, state, length, 0.0, every=1.0)
    run, cpu = scene.run_scree(work, "steps", shapes, state, length, steps * scene.STEP)
    end = work / "scree.state"
    scene.write_state(end, scene.read_frame(run, 1))
    log = scene.read_log(run)
    record = judged({"steps": steps, "step": scene.STEP, "cpu": cpu - idle}, shapes, end, length, before)
    record["depth_over_margins"] = max(log["max_depth_ratio"])
    return record


def bullet(mode):
    def work_of(shapes, start, length, work, before, steps):
        end = work / f"bullet-{mode}.state"
        step = 1e-3
        words, _ = scene.run_tool(["scree-peers-bullet", shapes, start, end, "--mode", mode, "--length", repr(length), "--margin", repr(scene.MARGIN),
                                   "--step", step, "--steps", steps, "--density", scene.DENSITY, "--gravity", scene.GRAVITY,
                                   "--friction", scene.FRICTION, "--restitution", scene.RESTITUTION])
        return judged({"steps": steps, "step": step, "cpu": json.loads(words)["cpu"]}, shapes, end, length, before)
    return work_of


def yade(shapes, start, length, work, before, steps):
    files = {name: str(work / f"yade.{name}") for name in ("state", "result")}
    options = {"scripts": str(HERE), "shapes": str(shapes), "start": str(start), "end": files["state"], "length": length, "steps": steps,
               "result": files["result"]}
    (work / "yade.json").write_text(json.dumps(options))
    scene.run_tool(["yade", "-j1", "-nx", HERE / "yade_scene.py"], env=dict(scene.one_core(), SCENE=str(work / "yade.json")))
    cpu = json.loads(Path(files["result"]).read_text())["cpu"]
    return judged({"steps": steps, "step": scene.STEP, "cpu": cpu}, shapes, Path(files["state"]), length, before)


def run_in(folder: Path, program, text, files=()):
    """Runs LIGGGHTS or LAMMPS on an input; returns CPU seconds, start and all."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in (("in", text), *files):
        (folder / name).write_text(content)
    _, cpu = scene.run_tool([program, "-in", "in"], cwd=folder, env=scene.one_core())
    return cpu


def lammps_polyhedra(shapes, start, length, work, before, steps):
    state = scene.read_state(start)
    meshes = [scene.read_obj(shapes / f"shape_{k}.obj") for k in range(scene.SHAPE_COUNT)]
    inertia = [[scene.DENSITY * m for m in row[1:4]] for row in scene.read_shapes(shapes)]
    height = max(row[3] for row in state) + 4 * scene.RADIUS
    folder = work / "lammps"
    idle, cpu = (run_in(folder, "lmp", text, [("rocks.data", data)])
                 for data, text in (sphere_codes.lammps_polyhedra(state, length, height, meshes, inertia, n) for n in (0, steps)))
    rows, first = sphere_codes.read_dump(folder / "end.dump"), sphere_codes.read_dump(folder / "start.dump")
    end = [sphere_codes.body_of_dump(row, origin, body, inertia) for row, origin, body in zip(rows, first, state)]
    scene.write_state(work / "lammps.state", end)
    return judged({"steps": steps, "step": scene.STEP, "cpu": cpu - idle}, shapes, work / "lammps.state", length, before)


def spheres(program, writer):
    def work_of(count, work, settle, steps):
        state, length = scene.spheres(count)
        height = 1.3 * max(row[3] for row in state) + 3 * scene.RADIUS
        folder = work / re.sub(r"\W+", "-", writer.__name__)
        files = [("clump.txt", "".join(" ".join(map(repr, s)) + "\n" for s in sphere_codes.clump()))]
        bodies = count if writer is sphere_codes.liggghts_clumps else state
        idle, cpu = (run_in(folder, program, writer(bodies, length, height, settle, n), files) for n in (0, steps))
        owner = -2 if writer is sphere_codes.liggghts_clumps else None
        verdict = sphere_codes.judge_spheres(sphere_codes.read_dump(folder / "end.dump"), length, sphere_codes.MASS, owner)
        return {"steps": steps, "step": scene.STEP, "cpu": cpu - idle, "bodies": count, **verdict}
    return work_of


def scree_spheres(count, work, settle, steps):
    """The same, by Scree: the time is that of the steps after those that settle the bed, as of the others."""
    folder = work / "scree"
    folder.mkdir(parents=True, exist_ok=True)
    state, length = scene.spheres(count)
    times = []
    for name, until in (("settle", settle), ("steps", settle + steps)):
        scene.write_sphere_case(folder / f"{name}.toml", state, length, until)
        run, cpu = scene.solve(folder, name)
        times.append(cpu)
    rows = [[i] + row[1:4] + row[8:11] + [scene.RADIUS] for i, row in enumerate(scene.read_frame(run, 1))]
    return {"steps": steps, "step": scene.STEP, "cpu": times[1] - times[0], "bodies": count, **sphere_codes.judge_spheres(rows, length, sphere_codes.MASS)}


# Steps that are timed: 0.05 s of the scene in Scree and in Bullet with its long steps; less in Yade and LAMMPS, which would need
# minutes and hours for it. The time is the difference of two runs, so that start and files do not count, or taken in the program.
ROCK_PROGRAMS = {
    "Scree": (scree, 2500),
    "Bullet GImpact": (bullet("gimpact"), 50),
    "Bullet hull": (bullet("hull"), 50),
    "Yade polyhedra": (yade, 100),
    "LAMMPS polyhedra": (lammps_polyhedra, 20),
}
SPHERE_PROGRAMS = {
    "Scree": (scree_spheres, 30000),
    "LIGGGHTS spheres": (spheres("liggghts", sphere_codes.liggghts_spheres), 30000),
    "LAMMPS spheres": (spheres("lmp", sphere_codes.lammps_spheres), 30000),
    "LIGGGHTS clumps of 14": (spheres("liggghts", sphere_codes.liggghts_clumps), 5000),
}
ROCKS = [scene.Family("rock", n) for n in (20, 80, 320, 1280)]
CONVEX = [scene.Family("convex", n) for n in (20, 80)]


def programs_of(family):
    """Who can simulate a family: convex-only programs get convex shapes only."""
    if family.kind == "rock":
        return ["Scree", "Bullet GImpact"]
    names = ["Scree", "Bullet GImpact", "Bullet hull", "Yade polyhedra"]
    return names + ["LAMMPS polyhedra"] if family.triangles == 20 else names  # 1 hour a round for 80


def versions():
    """Debian's versions of the peers that are installed."""
    packages = ["libfcl-dev", "libcgal-dev", "libbullet-dev", "yade", "liggghts", "lammps"]
    words = os.popen("dpkg-query -W -f='${Package} ${Version}\\n' " + " ".join(packages) + " 2>/dev/null").read()
    return [line.split() for line in words.splitlines() if len(line.split()) == 2]
