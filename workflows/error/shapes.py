"""Shapes of a case with four times and a quarter of the triangles, made by scree-mesher from the shape file and what it says of its origin.

A finer shape comes, where it can, from where the shape came from: a simplified mesh is simplified less, a generated one is generated finer. A mesh that
was imported has no more detail: each of its triangles is split in four. That shows what contacts owe to the triangles, not what the mesh owes to
the body; the reason stands in the table.
"""
import hashlib
import json
import math
import os
import subprocess
import sys

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from settings import FEWEST_TRIANGLES, TIMES  # noqa: E402

SIDES = ("finer", "coarser")
# generated with a number of triangles; an edge length makes all others finer
BY_COUNT = ("rock",)
FLAT = ("box", "tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron", "stone")   # exact with any number of triangles


class CannotMake(Exception):
    """scree-mesher refused."""


def origin_of(path):
    """(words of the command that made a shape file without program and output, triangles, mean length of an edge); None for an exact ball."""
    with h5py.File(path) as file:
        names = sorted(file["shapes"])
        if len(names) != 1:
            raise CannotMake(f"its file holds {len(names)} shapes")
        shape = file["shapes"][names[0]]
        if "triangles" not in shape or len(shape["triangles"]) == 0:
            return None
        corners = shape["vertices"][:][shape["triangles"][:]]
        edge = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
        command = json.loads(file["provenance"][()])["command"][1:]
        return without(command, "-o", "--output"), len(shape["triangles"]), edge


def without(words, *options):
    """Words without options that have one value."""
    left, skip = [], False
    for word in words:
        if skip:
            skip = False
        elif word in options:
            skip = True
        elif not any(word.startswith(f"{option}=") for option in options):
            left.append(word)
    return left


def finer_words(words, path, count, edge):
    """Words for scree-mesher, and whether the finer shape is another surface than that of the case."""
    split = ["refine", path, "--times", "1"]
    if words[:1] == ["simplify"] and not words[1].endswith(".shape.h5"):
        return [*without(words, "--triangles"), "--triangles", str(TIMES * count)], True
    if words[:1] == ["generate"] and words[1] in BY_COUNT:
        return [*without(words, "--triangles", "--edge-length"), "--triangles", str(TIMES * count)], True
    if words[:1] == ["generate"] and words[1] not in FLAT:
        return [*without(words, "--triangles", "--edge-length"), "--edge-length", f"{edge / math.sqrt(TIMES):.9g} m"], True
    return split, False


def mesher(words, folder):
    result = subprocess.run(["scree-mesher", *words], cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        said = [line for line in result.stderr.splitlines() if "error:" in line]
        raise CannotMake(said[-1].split("error: ", 1)[-1] if said else f"scree-mesher ended with exit code {result.returncode}")


def make(words, output, source):
    """Makes a file unless it is there."""
    if not os.path.exists(output):
        part = output.removesuffix(".shape.h5") + ".part.shape.h5"
        mesher([*words, "-o", part], os.path.dirname(source))
        os.replace(part, output)
    return output


def variants_of(name, shape, base, folder):
    """{"finer": file or reason, "coarser": file or reason} of a shape of the case.

    shape    its table in the case
    base     folder that paths of the case are relative to
    folder   where the files are made
    """
    if "file" not in shape:
        return dict.fromkeys(SIDES, f"{name} is an exact ball: it has no triangles")
    if "pieces" in shape:
        return dict.fromkeys(SIDES, f"{name} is cut into pieces, which another mesh would change")
    source = os.path.abspath(os.path.join(base, shape["file"]))
    try:
        origin = origin_of(source)
    except (CannotMake, OSError, KeyError, ValueError) as error:
        return dict.fromkeys(SIDES, f"{name}: {error}")
    if origin is None:
        return dict.fromkeys(SIDES, f"{name} is an exact ball: it has no triangles")
    words, count, edge = origin
    with open(source, "rb") as file:
        digest = hashlib.sha256(file.read()).hexdigest()[:8]
    made = {}
    os.makedirs(folder, exist_ok=True)
    for side in SIDES:
        # another shape of the case makes another name, which makes the runs again
        output = os.path.join(os.path.abspath(folder), f"{name}-{side}-{digest}.shape.h5")
        try:
            if side == "coarser" and count // TIMES < FEWEST_TRIANGLES:
                raise CannotMake(f"{count} triangles are too few for a quarter")
            if side == "coarser":
                made[side] = make(["simplify", source, "--triangles", str(count // TIMES)], output, source)
                continue
            wanted, is_other = finer_words(words, source, count, edge)
            try:
                made[side] = make(wanted, output, source)
            except CannotMake:   # the mesh that it came from is not there any more, or has no more triangles
                if not is_other:
                    raise
                made[side] = make(["refine", source, "--times", "1"], output, source)
        except CannotMake as error:
            made[side] = f"{name}: {error}"
    return made


def note(case, base):
    """A sentence for the page on shapes whose finer mesh is the same surface."""
    same = []
    for name, shape in case.get("shapes", {}).items():
        try:
            origin = origin_of(os.path.join(base, shape["file"])) if "file" in shape and "pieces" not in shape else None
        except (CannotMake, OSError, KeyError, ValueError):
            continue
        if origin and not finer_words(origin[0], "", origin[1], origin[2])[1]:
            same.append(name)
    return [f"The finer mesh of {', '.join(same)} is the same surface with every triangle split in four: the difference between mesh and real body is not in the total."] if same else []
