"""Small meshes for random cases. Sizes are chosen so that the ball that holds a shape has the radius asked for, about.

Vertices lie on a grid of 2^-16 of the size or finer: the middle of an edge, and of its halves, is exact in single precision, so no
importer rounds it and a split edge stays straight.
"""
import math
import os
import sys

import numpy

from model import Mesh

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "validation"))
import meshes as library  # noqa: E402  (the shapes of the validation cases)


def clean_mesh(mesh, surface=False):
    vertices, triangles = mesh
    vertices = numpy.asarray(vertices, float)
    unit = 2.0 ** (math.ceil(math.log2(numpy.abs(vertices).max())) - 17)
    return Mesh(numpy.round(vertices / unit) * unit + 0.0, triangles, surface)


def scaled_to(mesh, radius, surface=False):
    vertices, triangles = mesh
    vertices = vertices - library.mass_properties(mesh)[1]
    reach = numpy.linalg.norm(vertices, axis=1).max()
    return clean_mesh((vertices * (radius / reach), triangles), surface)


def cube(random, radius):
    return scaled_to(library.box(), radius)


def brick(random, radius):
    return scaled_to(library.box((1, random.uniform(0.4, 1), random.uniform(0.3, 1))), radius)


def tetrahedron(random, radius):
    return scaled_to(library.tetrahedron(1.0), radius)


def octahedron(random, radius):
    vertices = numpy.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    triangles = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    return scaled_to((vertices, numpy.array(triangles)), radius)


def prism(random, radius):
    return scaled_to(library.cylinder(1.0, random.uniform(0.5, 2.0), random.choice([3, 5, 6, 8])), radius)


def icosphere(random, radius):
    return scaled_to(library.icosphere(1), radius)


def ellipsoid(random, radius):
    return scaled_to(library.ellipsoid((1, random.uniform(0.5, 1), random.uniform(0.5, 1)), 1), radius)


def angle(random, radius):
    return scaled_to(library.prism(library.l_outline(1.0, random.uniform(0.3, 0.5)), random.uniform(0.3, 0.6)), radius)


def channel(random, radius):
    return scaled_to(library.prism(library.u_outline(1.0, 1.0, random.uniform(0.2, 0.3)), random.uniform(0.3, 0.6)), radius)


def ring(random, radius):
    return scaled_to(library.tube(random.uniform(0.4, 0.6), 1.0, random.uniform(0.4, 0.8), random.choice([6, 8])), radius)


def torus(random, radius):
    return scaled_to(library.torus(1.0, random.uniform(0.25, 0.45), 8, 5), radius)


def rock(random, radius):
    return scaled_to(library.rock(random.randrange(1000), 1), radius)


SOLIDS = {f.__name__: f for f in (cube, brick, tetrahedron, octahedron, prism, icosphere, ellipsoid, angle, channel, ring, torus, rock)}


# surfaces, for walls from files: about the origin, with room for what lies above z = 0 and within `half` of the z axis

def sheet(random, half):
    return clean_mesh(scaled(library.plate(1.0, random.choice([1, 2, 3])), 2 * half), True)


def terrain(random, half):
    """A height field: corners up to a tenth of the width below z = 0."""
    vertices, triangles = library.plate(1.0, 4)
    heights = numpy.array([random.uniform(-0.1, 0) for _ in vertices])
    return clean_mesh(scaled((vertices + numpy.column_stack([0 * heights, 0 * heights, heights]), triangles), 2 * half), True)


def tray(random, half):
    """An open box from z = 0 up, faces inward: floor and four sides."""
    h = random.uniform(0.5, 1.5) * half
    vertices = [(x * half, y * half, z) for z in (0, h) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    triangles = [(0, 1, 2), (0, 2, 3)]
    for i in range(4):
        j = (i + 1) % 4
        triangles += [(i, 4 + i, 4 + j), (i, 4 + j, j)]
    return clean_mesh((numpy.array(vertices), numpy.array(triangles)), True)


def slab(random, half):
    """A solid plate whose upper face is z = 0, closed: met from outside."""
    return clean_mesh(library.box((2 * half, 2 * half, half / 2), random.choice([1, 2]), (0, 0, -half / 4)), True)


def scaled(mesh, size):
    return mesh[0] * size, mesh[1]


SURFACES = {f.__name__: f for f in (sheet, terrain, tray, slab)}
