#!/usr/bin/env python3
"""scree-post bed on a real run: a column of balls, cubes and Raschig rings in a tube.

usage: bed_test.py BIN SCRATCH

The files are read by other means than those that wrote them: the surface by scree-mesher check, the image by VTK where Python has it, the numbers
by numpy. Volumes of caps and shares of cells against closed forms are in bed_export_test.cpp.
"""
import csv
import json
import os
import re
import shutil
import subprocess
import sys

import numpy

CASE = """
title = "packed column"
gravity = [0, 0, "-9.81 m/s^2"]
seed = 3
[time]
duration = "0.15 s"
[output]
every = "0.15 s"
[contact]
margin_ratio = 0.04
[materials]
rock = { density = "2500 kg/m^3" }
wall = { density = "2500 kg/m^3" }
[[pairs]]
between = ["rock", "rock"]
stiffness = "60 kN/m"
restitution = 0.1
friction = 0.4
[[pairs]]
between = ["rock", "wall"]
stiffness = "60 kN/m"
restitution = 0.1
friction = 0.4
[shapes]
ball = { file = "ball.shape.h5" }
cube = { file = "cube.shape.h5" }
ring = { file = "ring.shape.h5" }
[[populations]]
shapes = { ball = 0.34, cube = 0.33, ring = 0.33 }
material = "rock"
count = 21
size = "10 mm"
region = { cylinder = { start = [0, 0, "0.5 mm"], end = [0, 0, "70 mm"], radius = "16.5 mm" } }
[[walls]]
name = "tube"
shape = { cylinder_inside = { start = [0, 0, 0], end = [0, 0, "100 mm"], radius = "17 mm" } }
material = "wall"
"""
GOOD, BAD_WORD = 0, 2


def tool(*words, code=GOOD, says=""):
    done = subprocess.run([os.path.join(BIN, words[0]), *words[1:]], capture_output=True, text=True)
    text = done.stdout + done.stderr
    assert done.returncode == code, f"{' '.join(words)}: exit code {done.returncode}, {code} expected\n{text}"
    assert says in text, f"{' '.join(words)}: '{says}' expected in\n{text}"
    return text


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert all(len(row) == len(rows[0]) for row in rows), path
    return [dict(zip(rows[0], row)) for row in rows[2:]]  # the second line has the units


def image(path):
    """Arrays of a .vti by name, and the spacing."""
    try:
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    except ImportError:
        with open(path, "rb") as file:
            head, data = file.read().split(b"<AppendedData encoding=\"raw\">\n_", 1)
        offsets = re.findall(rb'Name="(\w+)" format="appended" offset="(\d+)"', head)
        spacing = [float(x) for x in re.search(rb'Spacing="([^"]*)"', head).group(1).split()]
        arrays = {}
        for name, offset in offsets:
            size = int(numpy.frombuffer(data, "<u8", 1, int(offset))[0])
            arrays[name.decode()] = numpy.frombuffer(data, "<f4", size // 4, int(offset) + 8)
        return arrays, spacing
    reader = vtk.vtkXMLImageDataReader()
    reader.SetFileName(path)
    reader.Update()
    cells = reader.GetOutput().GetCellData()
    return {cells.GetArrayName(k): vtk_to_numpy(cells.GetArray(k)) for k in range(cells.GetNumberOfArrays())}, reader.GetOutput().GetSpacing()


def checked(path):
    """What scree-mesher says of a surface."""
    text = subprocess.run([os.path.join(BIN, "scree-mesher"), "check", path, "--unit", "m"], capture_output=True, text=True).stdout
    return {name: re.search(rf"^  {name}\s+(\S+)", text, re.MULTILINE).group(1)
            for name in ("watertight", "orientation", "self-intersections", "components", "volume", "zero-area triangles")}


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    os.makedirs(SCRATCH)
    os.chdir(SCRATCH)
    tool("scree-mesher", "generate", "sphere", "--analytic", "--radius", "5 mm", "-o", "ball.shape.h5")
    tool("scree-mesher", "generate", "cube", "--size", "8 mm", "-o", "cube.shape.h5")
    tool("scree-mesher", "generate", "hollow_cylinder", "--radius", "5 mm", "--inner-radius", "3 mm", "--height", "10 mm", "-o", "ring.shape.h5")
    with open("column.toml", "w", encoding="utf-8") as file:
        file.write(CASE)
    tool("scree-decomposer", "pack", "column.toml", "-o", "column.scene.h5")
    tool("scree-solver", "column.scene.h5", "-o", "column.run")

    for gap in (0.01, 0.03):
        tool("scree-post", "bed", "column.run", "-o", "bed", "--gap", str(gap))
        with open("bed/bed.json", encoding="utf-8") as file:
            bed = json.load(file)
        assert bed["particles"] == 21 and bed["open_edges"] == 0 and bed["pairs_left"] == 0 and bed["pairs_parted"] >= 20, bed
        assert 0.9 * 0.5 * gap <= bed["smallest_gap"] / bed["mean_diameter"] <= 1.001 * gap, bed
        surface = checked("bed/bed.stl")
        assert surface["watertight"] == "yes" and surface["orientation"] == "outward" and surface["components"] == "21", surface
        assert int(surface["self-intersections"]) == bed["self_crossings"] and surface["zero-area triangles"] == "0", (surface, bed)
        assert abs(float(surface["volume"]) / bed["volume_in_file"] - 1) < 1e-6, (surface, bed)
        ball = numpy.pi / 6 * 0.01**3  # all shapes have its volume
        assert abs(bed["solid_volume"] / (21 * ball) - 1) < 1e-12, bed
        lost = 1 - bed["volume_in_file"] / bed["solid_volume"]
        assert 0 < lost < 2 * gap, lost
        bodies = table("bed/bodies.csv")
        assert abs(sum(float(b["volume_in_file"]) for b in bodies) / bed["volume_in_file"] - 1) < 1e-12
        assert all(float(b["volume_in_file"]) <= (1 + 1e-6) * float(b["volume"]) for b in bodies)

    # the image holds all bodies, whole
    arrays, spacing = image("bed/void_fraction.vti")
    assert set(arrays) == {"solid_fraction", "void_fraction", "in_container"} and all(len(a) == numpy.prod(bed["cells"]) for a in arrays.values())
    solid = arrays["solid_fraction"].astype(float)
    assert abs(solid.sum() * numpy.prod(spacing) / bed["solid_volume"] - 1) < 1e-6, solid.sum()
    assert abs(bed["solid_volume_in_grid"] / bed["solid_volume"] - 1) < 1e-12
    # bodies overlap a little: what they fill twice leaves no void below 0
    assert numpy.allclose(arrays["void_fraction"], numpy.maximum(0, 1 - solid), atol=1e-6) and solid.min() >= 0
    round_share = arrays["in_container"].mean()
    assert abs(round_share - numpy.pi / 4) < 0.03, round_share

    # no ball's surface touches the wall but in a point: all void there; the rings of a tube sum to its solid
    rings = table("bed/radial_void_fraction.csv")
    assert float(rings[0]["void_fraction"]) > 0.75 and float(rings[0]["distance_from_wall_over_diameter"]) < 0.05, rings[0]
    assert all(abs(float(r["distance_from_wall"]) + float(r["distance_from_axis"]) - 0.017) < 1e-12 for r in rings)

    # contacts: those of the frame, and bodies that count them
    contacts = table("bed/contacts.csv")
    kinds = {kind: sum(c["kind"] == kind for c in contacts) for kind in ("point", "edge", "face")}
    assert len(contacts) == sum(kinds.values()) >= 30 and kinds["point"] > 0, kinds
    tool("scree-post", "contacts", "column.run", "-o", "all.csv")
    with open("all.csv", encoding="utf-8", newline="") as file:
        frame = list(csv.DictReader(file))
    last = frame[-1]["time"]
    carrying = [c for c in frame if c["time"] == last and float(c["fn"]) != 0]
    assert sum(int(c["points"]) for c in contacts) == len(carrying)
    assert abs(sum(float(c["normal_force"]) for c in contacts) - sum(float(c["fn"]) for c in carrying)) < 1e-9 * sum(abs(float(c["fn"])) for c in carrying)
    constraints = {"point": 3, "edge": 5, "face": 6}
    total = sum(constraints[c["kind"]] for c in contacts)  # one with a wall counts in whole, one of two particles by half for each
    assert abs(sum(float(b["constraints"]) for b in bodies) - total) < 1e-9
    assert abs(bed["constraints"] - total / 21) < 1e-9
    tool("scree-post", "statistics", "column.run", "-o", "statistics", "--frames", "last", "--no-charts")
    with open("statistics/summary.csv", encoding="utf-8", newline="") as file:
        means = {row["quantity"]: row["mean"] for row in csv.DictReader(line for line in file) if row["group"] == "all"}
    for name, value in (("constraints", bed["constraints"]), ("face_contacts", kinds_of(bodies, "face")), ("point_contacts", kinds_of(bodies, "point"))):
        assert abs(float(means[name]) - value) < 1e-8 * value, (name, means[name], value)  # the table has nine digits

    # bodies as they are
    tool("scree-post", "bed", "column.run", "-o", "whole", "--parting", "none", "--cell", "2 mm", "--ball-triangles", "320", "--rings", "7")
    with open("whole/bed.json", encoding="utf-8") as file:
        whole = json.load(file)
    assert abs(whole["volume_in_file"] / bed["solid_volume"] - 1) < 1e-12 and "pairs_parted" not in whole, whole
    assert len(table("whole/radial_void_fraction.csv")) == 7 and abs(whole["cell"][0] / 2e-3 - 1) < 0.2

    tool("scree-post", "bed", "column.run", "-o", "x", "--frame", "99", code=BAD_WORD, says="99")
    tool("scree-post", "bed", "column.run", "-o", "x", "--cell", "1 um", code=BAD_WORD, says="choose at least")
    tool("scree-post", "bed", "column.run", "-o", "x", "--gap", "5", code=BAD_WORD, says="--gap")
    tool("scree-post", "bed", "column.run", "-o", "x", "--ball-triangles", "500", code=BAD_WORD, says="320")
    tool("scree-post", "bed", "column.run", "-o", "x", "--container", "sphere:0,0,0,1", code=BAD_WORD, says="a sphere has no rings")
    tool("scree-post", "bed", "column.run", "-o", "x", "--within", "box:1,1,1,2,2,2", code=BAD_WORD, says="no particle in frame")
    tool("scree-post", "bed", "column.run", "-o", "x", "--container", "box:-0.02,-0.02,0,0.02,0.02,0.1", says="no radial void fraction")
    print("a packed bed as files: passed")


def kinds_of(bodies, kind):
    return sum(int(b[f"{kind}_contacts"]) for b in bodies) / len(bodies)


if __name__ == "__main__":
    BIN, SCRATCH = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    main()
