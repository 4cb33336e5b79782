#!/usr/bin/env python3
"""How many ranks a run is worth. usage: ranks.py SCENE CORES

Prints the number. The result of a run does not depend on it (docs/develop/decisions/003), its time does: ranks exchange messages in every step. On a
machine of its own a rank pays off from 50 to 100 bodies with triangles on (docs/results/scaling.md); where other programs use the cores too, ranks
wait for each other's time slices, and 120 balls took 3 to 24 times as long on two ranks as on one.
"""
import json
import sys

import h5py

BODIES_A_RANK = 200       # with triangles: twice what pays off on a machine of its own
BALL = 0.1                # work of an analytic ball, in bodies with triangles
SPHERE = 2                # kind of a shape (core/storage/SHAPE_FORMAT.md)


def work_in(path):
    """Free bodies that the scene starts with, and what its inlets may hold at most by their number; in bodies with triangles."""
    with h5py.File(path) as scene:
        weight = [BALL if scene["shapes"][name].attrs["kind"] == SPHERE else 1.0 for name in sorted(scene["shapes"])]
        work = sum(weight[shape] for shape, fixed in zip(scene["bodies/shape"][:], scene["bodies/fixed"][:]) if not fixed)
        inlets = json.loads(scene["settings"][()]).get("inlets", [])
    # how many bodies of a rate are there at a time, nobody knows: a limit is taken in full
    return work + sum(inlet.get("count", 0) for inlet in inlets if isinstance(inlet.get("count", 0), int) and inlet.get("count", 0) < 1e9)


def ranks_for(path, cores):
    return max(1, min(cores, int(work_in(path) / BODIES_A_RANK)))


if __name__ == "__main__":
    print(ranks_for(sys.argv[1], int(sys.argv[2])))
