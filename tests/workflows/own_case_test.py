#!/usr/bin/env python3
"""A user's own case through `workflows/run PATH/case.toml`: what is made of the meshes beside it, what is refused, and the whole chain.

own_case_test.py RUNNER BIN SCRATCH
"""
import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

import h5py

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
from mpi_environment import mpi_environment  # noqa: E402

RUNNER, BIN, SCRATCH = sys.argv[1:4]
ENVIRONMENT = dict(os.environ, SCREE_BIN=BIN)
# names that a shell or Snakemake would take for something else
FOLDER = os.path.join(SCRATCH, "a user's {x} \"folder\" $(touch PWNED)")
CUBE = "$(touch PWNED) 'cube' {y}"
CASE = """
title = "made of rock.shape.h5"
[time]
duration = "20 ms"
[shapes.stone]
file = "stone.shape.h5"
[shapes.cube]
file = "forms/%s.shape.h5"
[materials.rock]
density = 2600
[[pairs]]
between = ["rock", "rock"]
stiffness = "100 kN/m"
friction = 0.5
restitution = 0.3
[[populations]]
shapes = { stone = 0.5, cube = 0.5 }
material = "rock"
count = 6
size = "3 cm"
region = { box = [["-9 cm", "-9 cm", "1 cm"], ["9 cm", "9 cm", "12 cm"]] }
[[walls]]
name = "floor"
shape = { file = "floor.shape.h5" }
material = "rock"
""" % CUBE
TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
FLOOR = "OFF\n4 2 0\n-200 -200 0\n200 -200 0\n200 200 0\n-200 200 0\n3 0 1 2\n3 0 2 3\n"


def write(name, text):
    path = os.path.join(FOLDER, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as file:
        file.write(text)


def run(*words, case="case.toml", expect=0, cwd=FOLDER):
    result = subprocess.run([RUNNER, case, *words], capture_output=True, text=True, env=ENVIRONMENT, cwd=cwd)
    text = result.stdout + result.stderr
    assert (result.returncode == 0) == (expect == 0) and (expect != 2 or result.returncode == 2), (words, result.returncode, text)
    return text


def refused(said, *words, **how):
    text = run(*words, expect=1, **how)
    assert said in text, (said, text)


def made(text):
    return [line for line in text.splitlines() if line.startswith("scree-mesher")]


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    write("case.toml", CASE)

    # meshes are those that the mesher imports
    root = os.path.dirname(os.path.dirname(RUNNER))
    sys.path.insert(0, os.path.join(root, "workflows"))
    from own_case import MESHES
    with open(os.path.join(root, "mesher/io/mesh_file.cpp")) as file:
        lists = re.findall(r"k(?:Parsers|AssimpExtensions|GmshExtensions)\{(.*?)\};", file.read(), re.S)
    imported = sorted(re.findall(r'"(\.\w+)"', " ".join(lists)))
    assert len(lists) == 3 and sorted(MESHES) == imported, (sorted(MESHES), imported)

    # what is missing is told with what would help
    refused("no case file 'nope.toml'", case="nope.toml")
    refused("shapes.stone.file: stone.shape.h5 is not there, and no mesh to make it from", "--dry-run")
    write("stone.off", TETRAHEDRON)
    write("stone.ply", TETRAHEDRON)
    refused("could be made from stone.off or stone.ply", "--dry-run")
    os.remove(os.path.join(FOLDER, "stone.ply"))
    write("floor.off", FLOOR)
    refused(f"shapes.cube.file: forms/{CUBE}.shape.h5 is not there", "--dry-run")
    write("meshes.toml", f"floor = 'import floor.off --surface --unit mm'\n\"{CUBE}\" = 3\n")
    refused(f"meshes.toml: {CUBE}: expected the words for scree-mesher", "--dry-run")
    write("meshes.toml", f"floor = 'import floor.off --surface --unit mm'\nrock = 'import stone.off'\n"
                         f"\"{CUBE}\" = 'generate box --size \"1 cm, 1 cm, 1 cm\"'\n")
    refused("the case names no rock.shape.h5", "--dry-run")
    write("meshes.toml", f"floor = 'import floor.off --surface --unit mm'\n\"{CUBE}\" = 'generate box --size \"1 cm, 1 cm, 1 cm\"'\n")
    write("case.toml", CASE + "[[")
    refused("case.toml: ", "--dry-run")
    write("case.toml", "\ufeff" + CASE)   # with a byte order mark, as some editors leave it

    # a dry run names the steps and leaves nothing
    before = sorted(os.listdir(FOLDER))
    steps = made(run("--dry-run"))
    assert sorted(os.listdir(FOLDER)) == before, os.listdir(FOLDER)
    assert any("floor.off'" in step and "--surface --unit mm" in step for step in steps) and any("stone.off'" in step for step in steps), steps
    assert any("generate box --size '1 cm, 1 cm, 1 cm'" in step for step in steps), steps

    # several meshes in one shape file keep their names; files behind an option are found, too
    write("one.off", TETRAHEDRON)
    write("points.csv", "x,y,z\n-0.001,0,0\n0.001,0,0\n")
    write("two.toml", CASE.replace('file = "stone.shape.h5"', 'file = "both.shape.h5"\nname = "one"'))
    write("meshes.toml", f"floor = 'import floor.off --surface --unit mm'\n\"{CUBE}\" = 'fracture box.shape.h5 --points=points.csv'\n"
                         f"both = 'import one.off stone.off'\n")
    steps = made(run("--dry-run", case="two.toml"))
    assert any("one.off" in step and "stone.off" in step and "--name" not in step for step in steps), steps
    assert any(f"--points={FOLDER}/points.csv" in shlex.split(step) for step in steps), steps
    for name in ("two.toml", "one.off", "points.csv"):
        os.remove(os.path.join(FOLDER, name))
    write("meshes.toml", f"floor = 'import floor.off --surface --unit mm'\n\"{CUBE}\" = 'generate box --size \"1 cm, 1 cm, 1 cm\"'\n")

    # from meshes to the report, from another folder, by a relative path; a second time there is nothing to do. Six bodies run on one rank,
    # however many cores there are
    write("case.toml", CASE)
    relative = os.path.join(os.path.basename(FOLDER), "case.toml")
    run("--config", "statistics=--from 0.01", "--cores", "2", case=relative, cwd=SCRATCH)
    results = os.path.join(FOLDER, "case.out")
    for name in ("case.report.html", "case.png", "case.run/paraview/case.pvd", "case.run/paraview/open_in_paraview.py", "case.bodies.csv"):
        assert os.path.getsize(os.path.join(results, name)) > 0, name
    with open(os.path.join(results, "case.run/run.json")) as file:
        record = json.load(file)
    assert record["outcome"] == "completed" and record["bodies"] == 6 and record["ranks"] == 1 and record["threads"] == 1, record
    with open(os.path.join(results, "case.bodies.csv"), newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len({row["id"] for row in rows}) == 6, rows[:3]
    assert sorted(os.listdir(FOLDER)) == sorted(before + ["case.out"])
    for folder in (SCRATCH, FOLDER, results):
        assert "PWNED" not in os.listdir(folder), f"a name was run by a shell in {folder}"
    words = ["--config", "statistics=--from 0.01"]
    assert "Nothing to be done" in run(*words)
    assert "Nothing to be done" in run(*words, "--cores", "1"), "another number of cores makes nothing anew"

    # a large case takes the cores that it is worth
    import ranks
    scene = os.path.join(results, "case.scene.h5")
    assert ranks.work_in(scene) == 6
    ranks.BODIES_A_RANK = 2
    assert [ranks.ranks_for(scene, cores) for cores in (1, 2, 8)] == [1, 2, 3]

    # the scene is divided for the ranks that run it: by the packer where they are given, else by the solver, which has nothing to undo then
    given = os.path.join(SCRATCH, "given")
    said = run("case.run/run.json", "--out", given, "--config", "ranks=2")
    with h5py.File(os.path.join(given, "case.scene.h5")) as divided, h5py.File(scene) as undivided:
        assert divided["partition"].attrs["ranks"] == 2 and undivided["partition"].attrs["ranks"] == 0
    chosen = subprocess.run(["mpirun", "-n", "2", os.path.join(BIN, "scree-solver"), scene, "-o", os.path.join(SCRATCH, "chosen.run")],
                            capture_output=True, text=True, env=mpi_environment(OMP_NUM_THREADS="1"))
    assert chosen.returncode == 0 and "cut again" not in said + chosen.stderr, (said, chosen.stderr)
    hashes = set()
    for folder in (os.path.join(results, "case.run"), os.path.join(given, "case.run"), os.path.join(SCRATCH, "chosen.run")):
        with open(os.path.join(folder, "run.json")) as file:
            record = json.load(file)
        hashes.add(record["state_hash"])
    assert record["ranks"] == 2 and len(hashes) == 1, (record["ranks"], hashes)

    # a mesh that changes is imported again, and a file that is there is used as it is
    write("stone.off", TETRAHEDRON.replace("0 0 1\n", "0 0 2\n", 1))
    steps = run(*words, "--dry-run")
    assert len(made(steps)) == 1 and "scree-decomposer pack" in steps and "scree-post report" in steps, steps
    shutil.copy(os.path.join(results, "stone.shape.h5"), os.path.join(FOLDER, "stone.shape.h5"))
    steps = run("--dry-run", "--out", os.path.join(SCRATCH, "other"))
    assert not any("stone" in step for step in made(steps)) and "shapes.stone.file" not in steps, steps

    # sweeps as of any case
    steps = run("--dry-run", "--cores", "4", "--config", "sweep=pairs.*.friction=0.2|0.6", "replicas=2")
    assert "threads: " not in steps, steps   # one core each, four side by side
    assert steps.count("scree-decomposer pack") == 4 and "friction=0.6" in steps, steps
    table = re.search(r"/usr/bin/python3 (\S+sweep_table\.py) ", steps)
    assert table and os.path.isfile(table[1]), f"the table of the sweep is made by a script that is not there: {table and table[1]}"
    shutil.rmtree(SCRATCH)


if __name__ == "__main__":
    main()
    print("all as expected")
