"""Scree from Python: read runs, write cases, call the tools, step runs.

    import scree
    run = scree.open("boulders.run")
    print(run.frames[-1].bodies.position.mean(axis=0))

All quantities are in SI units. post/python/README.md explains the package, and its folder `examples` has scripts.
"""
from .case import Case
from .engine import Engine, ScreeWarning
from .errors import (InputError, InternalError, Interrupted, MachineError, MissingPackage, RunInvalid, ScreeError, UnknownName, UsageError)
from .frames import Frame, Frames
from .h5md import write_h5md
from .measurement import Measurement, measure
from .meshes import Mesh, rotate, rotation_matrix
from .packings import Packing
from .regions import Box, Cylinder, Region, Sphere, region
from .rows import Bodies, Contacts, Walls
from .run import Run, Statistics
from .run import open_run as open  # noqa: A001  as scree.open
from .scene import Material, Scene, Shape, Shapes, Wall, open_scene, open_shapes
from .tables import Table
from .tools import Progress, Result, call, generate, import_mesh, pack, report, solve, statistics
from .units import si

__version__ = "0.1.0"

__all__ = [
    "Bodies", "Box", "Case", "Contacts", "Cylinder", "Engine", "Frame", "Frames", "InputError", "InternalError", "Interrupted",
    "MachineError", "Material", "Measurement", "Mesh", "MissingPackage", "Packing", "Progress", "Region", "Result", "Run", "RunInvalid", "Scene",
    "ScreeError", "ScreeWarning", "Shape", "Shapes", "Sphere", "Statistics", "Table", "UnknownName", "UsageError", "Wall", "Walls",
    "call", "generate", "import_mesh", "measure", "open", "open_scene", "open_shapes", "pack", "region", "report", "rotate", "rotation_matrix",
    "si", "solve", "statistics", "write_h5md",
]
