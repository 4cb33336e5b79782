#!/usr/bin/env python3
"""Files that are damaged on purpose: every reader says what is wrong with them, and nothing crashes. usage: hostile_files_test.py BIN SCRATCH"""
import json
import os
import shutil
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from rich_run import make_rich_run  # noqa: E402

BIN, SCRATCH = os.path.abspath(sys.argv[1]), sys.argv[2]
BAD_DATA = 3
shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)
os.chdir(SCRATCH)
RUN = make_rich_run(BIN, ".")
WITH_BONDS = "frame_000001.hdf"
LAST = sorted(name for name in os.listdir(RUN) if name.startswith("frame_"))[-1]


def tool(name, *words, code=0, says=""):
    done = subprocess.run([os.path.join(BIN, name), *words], capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == code and says in done.stderr, f"{name} {words}: exit {done.returncode}, expected {code} with '{says}':\n{done.stderr}"
    return done.stdout + done.stderr


def changed_file(source, name, change):
    shutil.copy(source, name)
    with h5py.File(name, "r+") as file:
        change(file)
    return name


def changed_run(change, frame=LAST):
    shutil.rmtree("changed.run", ignore_errors=True)
    shutil.copytree(RUN, "changed.run")
    with h5py.File(os.path.join("changed.run", frame), "r+") as file:
        change(file)
    return "changed.run"


def attribute(place, name, value):
    def change(file):
        attributes = file[place].attrs
        if name in attributes:
            del attributes[name]
        attributes.create(name, value)
    return change


def dataset(name, value):
    def change(file):
        del file[name]
        file.create_dataset(name, data=value)
    return change


def row(name, index, value):
    def change(file):
        file[name][index] = value
    return change


# an attribute has one value of its class, a text is one text
MANY, WORDS = 6000, numpy.full(6000, b"ABCDEFGHIJ", dtype="S10")
for name, change, says in (("text", dataset("provenance", numpy.full(200000, b"ABCDEFGHIJ", dtype="S10")), "200000 values, one expected"),
                           ("number", attribute("/", "format_version", numpy.full(MANY, 0x4141414141414141, "<i8")), "6000 values, one expected"),
                           ("word", attribute("/", "format", WORDS), "6000 values, one expected"),
                           ("none", attribute("/", "format_version", h5py.Empty("<i8")), "0 values, one expected"),
                           ("class", attribute("/", "format_version", 1.5), "floating-point numbers, whole numbers expected"),
                           ("real", attribute("shapes/shape_0000", "volume", b"large"), "texts, numbers expected"),
                           ("vertex", row("shapes/shape_0000/vertices", 0, 1e-3), "its attribute 'area' is "),
                           ("far", row("shapes/shape_0000/vertices", 0, 1e308), "its attribute 'area' is 0.001168 m^2"),
                           ("area", attribute("shapes/shape_0000", "area", 1.0), "its attribute 'area' is 1 m^2, but its surface has "),
                           ("volume", attribute("shapes/shape_0000", "volume", numpy.inf), "volume inf"),
                           ("radius", attribute("shapes/shape_0000", "sphere_radius", -1.0), "'sphere_radius' is -1 m, 0 of a shape that is no sphere expected"),
                           ("cells", attribute("shapes/shape_0000", "cell_size", numpy.inf), "'cell_size' is inf m, a value >= 0 expected"),
                           ("tiny", attribute("shapes/shape_0000", "volume", 1e-9), "'volume' is 1e-09 m^3, but its surface holds 2.688e-06 m^3"),
                           ("turn", row("shapes/shape_0000/body_from_principal", 0, 2.0), "body_from_principal: a quaternion of norm 4, 1 expected"),
                           ("moments", row("shapes/shape_0000/principal_moments", 0, -1.0), "principal_moments: -1, -1, -1 m^5 found, values > 0 expected"),
                           ("inertia", row("shapes/shape_0000/inertia", 1, numpy.nan), "inertia: a value that is not a finite number"),
                           ("shift", row("shapes/shape_0000/origin_shift", 0, numpy.nan), "origin_shift: not finite numbers"),
                           ("group", dataset("shapes", [1.0]), "cannot be opened")):
    tool("scree-mesher", "info", changed_file("rock.shape.h5", f"{name}.shape.h5", change), code=BAD_DATA, says=says)
for name, change, says in (("settings", dataset("settings", WORDS), "6000 values, one expected"),
                           ("number", attribute("partition", "predicted_imbalance", numpy.full(MANY, 1.5)), "6000 values, one expected"),
                           ("negative", attribute("shapes/shape_0000", "sphere_radius", -0.007), "'sphere_radius' is -0.007 m, a value > 0 expected"),
                           ("origin", row("bodies/population", 0, 2**31 - 1), "population 2147483647 found, -1 or the number of a table"),
                           ("place", row("shapes/shape_0000/vertices", 0, 1.0), "one vertex at the origin expected"),
                           ("column", dataset("bodies/shape", numpy.full(1, 0.5)), "floating-point numbers, whole numbers expected")):
    scene = changed_file("rich.scene.h5", f"{name}.scene.h5", change)
    tool("scree-decomposer", "partition", scene, "--ranks", "2", "-o", "x.scene.h5", code=BAD_DATA, says=says)
    tool("scree-solver", scene, "--plan", code=BAD_DATA, says=says)
changed_run(attribute("frame", "kinetic", numpy.full(MANY, 1.5)))
tool("scree-post", "statistics", "changed.run", "-o", "st", "--no-charts", "--frames", "last", code=BAD_DATA, says="6000 values, one expected")

# what a frame names is there, and it is somewhere
BODIES = "VTKHDF/PointData/"
for change, says in ((row(BODIES + "material", 1, 100000000), "has material 100000000, but the scene has 2"), (row(BODIES + "material", 1, -5), "has material -5"),
                     (row(BODIES + "shape", 1, 1 << 30), "has shape 1073741824"), (row(BODIES + "id", 1, 1 << 60), "which the run does not have"),
                     (row(BODIES + "id", 1, -7), "which the scene does not have"), (row(BODIES + "scale", 1, 0), "scale 0"),
                     (row(BODIES + "rank", 1, 2**31 - 1), "rank 2147483647, the number of an MPI rank expected"), (row(BODIES + "rank", 0, -1), "rank -1"),
                     (row(BODIES + "quat", 1, [0, 0, 0, 0]), "an orientation of norm 0"), (row("VTKHDF/Points", 1, numpy.nan), "not a finite number"),
                     (row("walls/id", 1, 12345), "wall 12345"), (row("walls/orientation", 1, numpy.nan), "an orientation of norm nan"),
                     (row("loads/triangle", 1, 1 << 20), "triangle 1048576"), (row("loads/wall", 1, 12345), "wall 12345"),
                     (dataset("wear/wall", numpy.zeros(0, "<i8")), "rows found"), (row("losses/material_b", 1, 77), "material 77"),
                     (row("impacts/normal_count", 0, -2**63), "row 0 of its impacts has normal_count -9223372036854775808"),
                     (row("impacts/shear_count", slice(0, 2), 2**62), "row 1 of its impacts has shear_count 4611686018427387904")):
    tool("scree-post", "bodies", changed_run(change), "-o", "x.csv", code=BAD_DATA, says=says)
run = changed_run(dataset("bonds/bond", numpy.zeros(0, "<i8")), WITH_BONDS)
tool("scree-post", "vtk", run, "-o", "v", "--what", "bonds", "--frames", "1", code=BAD_DATA, says="rows found")
run = changed_run(row("bonds/bond", 1, 2**31 - 1), WITH_BONDS)
tool("scree-post", "vtk", run, "-o", "v", "--what", "bonds", "--frames", "1", code=BAD_DATA, says="bond 2147483647")
tool("scree-post", "fragments", run, "-o", "f.csv", code=BAD_DATA, says="bond 2147483647")

# one bit of each column says that its fill value is shared by a table that the file has not: HDF5 1.10 then reads address 0
run = changed_run(lambda file: None)
with open(os.path.join(run, LAST), "rb+") as file:
    data = file.read()
    fill = bytes.fromhex("05 00 08 00 01 00 00 00 02 01 01 01")
    assert fill in data
    file.seek(0)
    file.write(data.replace(fill, fill.replace(b"\x01", b"\x03", 1)))
for words in (("fragments", run, "-o", "f.csv"), ("vtk", run, "-o", "v", "--frames", "last")):
    assert LAST in tool("scree-post", *words, code=BAD_DATA, says="damaged")

# run.json of other types
for key, value, says in (("outcome", 5, "outcome is number, a text expected"), ("inlets", [], "inlets holds 0 records"), ("inlets", {}, "a list expected"),
                         ("step_size", "x", "step_size is string, a number expected"), ("state_hash", 5, "a text expected"), ("phases", [1], "an object expected"),
                         ("drives", [3], "an object expected"), ("outlets", [{"bodies": "many", "mass": 0}], "a number expected")):
    shutil.rmtree("changed.run", ignore_errors=True)
    shutil.copytree(RUN, "changed.run")
    with open("changed.run/run.json", encoding="utf-8") as file:
        record = json.load(file)
    record[key] = value
    with open("changed.run/run.json", "w", encoding="utf-8") as file:
        json.dump(record, file)
    tool("scree-post", "bodies", "changed.run", "-o", "x.csv", code=BAD_DATA, says=says)
# null is what JSON writes of a number that is not finite
record.update(outlets=[{"bodies": 0, "mass": None, "name": "hole"}], mean_imbalance=None, step_size=None)
with open("changed.run/run.json", "w", encoding="utf-8") as file:
    json.dump(record, file)
tool("scree-post", "statistics", "changed.run", "-o", "st", "--no-charts", "--frames", "last")

# a name that no file can have
shutil.rmtree("changed.run", ignore_errors=True)
shutil.copytree(RUN, "changed.run")
with open("changed.run/frames.hdf.series", encoding="utf-8") as file:
    series = json.load(file)
series["files"][1]["name"] = "x" * 70000
with open("changed.run/frames.hdf.series", "w", encoding="utf-8") as file:
    json.dump(series, file)
tool("scree-post", "bodies", "changed.run", "-o", "x.csv", code=BAD_DATA, says="File name too long")
tool("scree-decomposer", "pack", "rich.toml", "-o", "x" * 300 + ".scene.h5", code=4, says="File name too long")
shutil.copy(os.path.join(RUN, "frames.hdf.series"), "changed.run/frames.hdf.series")

# a run that was killed, or still goes on, with inlets and outlets
os.remove("changed.run/run.json")
for words in (["report", "changed.run", "-o", "x.html"], ["statistics", "changed.run", "-o", "st", "--no-charts"]):
    tool("scree-post", *words, says="no run.json")
with open("x.html", encoding="utf-8") as file:
    assert "that came in so far" in file.read()

# what would be wrong without a word
tool("scree-mesher", "generate", "rock", "--diameter", "1", "--triangles", "-4", "-o", "x.shape.h5", code=2, says="at least 1")
for radius in ("1e-200", "1e200"):
    tool("scree-mesher", "generate", "sphere", "--radius", radius, "--analytic", "-o", "x.shape.h5", code=2, says="cannot be computed with")
tool("scree-mesher", "generate", "sphere", "--radius", "1", "--analytic", "-o", "x.shape.h5", "--name", "a\nb", code=2, says="a line break")
tool("scree-post", "statistics", RUN, "-o", "st", "--no-charts", "--profile", "z:5", "--profile", "z:7", code=2, says="'z' is given twice")
tool("scree-post", "statistics", RUN, "-o", "st", "--no-charts", "--region", "a=box:-1,-1,-1,1,1,0", "--region", "a=box:-1,-1,-1,1,1,1", code=2,
     says="'a' is given twice")
for words in (["picture", RUN, "-o", "x.png", "--zoom", "nan"], ["picture", RUN, "-o", "x.png", "--zoom", "0"], ["film", RUN, "-o", "x.gif", "--turn", "nan"],
              ["film", RUN, "-o", "x.gif", "--rate", "nan"]):
    assert len(tool("scree-post", *words, code=2, says="expected")) < 300, words
# without --what: everything that the run has
tool("scree-post", "vtk", RUN, "-o", "everything", "--frames", "1")
assert {"bodies.pvd", "bonds.pvd", "contacts.pvd", "walls.pvd"} <= set(os.listdir("everything")), os.listdir("everything")
# a surface whose triangles disagree: --flip makes them agree, and turns all where they do
with open("sheet.off", "w", encoding="utf-8") as file:
    file.write("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 3 2\n")
for turn in range(2):
    tool("scree-mesher", "import", "sheet.off", "--surface", "--flip", "--unit", "m", "-o", "sheet.shape.h5")
    with h5py.File("sheet.shape.h5") as file:
        points, triangles = file["shapes/shape_0000/vertices"][()], file["shapes/shape_0000/triangles"][()]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    up = numpy.cross(b - a, c - a)[:, 2]
    assert up[0] * up[1] > 0 and (turn == 0 or up[0] * first < 0), (turn, up)
    first = up[0]
    with open("sheet.off", "w", encoding="utf-8") as file:
        file.write("OFF\n4 2 0\n" + "".join("{} {} {}\n".format(*p) for p in points) + "".join("3 {} {} {}\n".format(*t) for t in triangles))

# keys of many parts
with open("keys.toml", "w", encoding="utf-8") as file:
    file.write(".".join(["a"] * 50000) + " = 1\n")
tool("scree-decomposer", "check", "keys.toml", code=2, says="more than 16 parts")

shutil.rmtree(os.getcwd())
print("all as expected")
