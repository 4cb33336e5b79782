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


def thin_angle(random, radius):
    return scaled_to(library.prism(library.l_outline(1.0, random.uniform(0.06, 0.18)), random.uniform(0.2, 0.6)), radius)


def thin_channel(random, radius):
    return scaled_to(library.prism(library.u_outline(1.0, random.uniform(0.5, 1.2), random.uniform(0.06, 0.18)), random.uniform(0.2, 0.6)), radius)


def thin_ring(random, radius):
    return scaled_to(library.tube(random.uniform(0.82, 0.94), 1.0, random.uniform(0.1, 0.4), random.choice([6, 8, 12])), radius)


def hook(random, radius):
    """A U whose legs differ."""
    t, long, short = random.uniform(0.06, 0.18), random.uniform(0.9, 1.3), random.uniform(0.3, 0.6)
    outline = [(0, 0), (0.7, 0), (0.7, short), (0.7 - t, short), (0.7 - t, t), (t, t), (t, long), (0, long)]
    return scaled_to(library.prism(outline, random.uniform(0.15, 0.5)), radius)


def dented(random, radius):
    """A cube with a pyramid pressed into its upper face, and into some of the others. Vertex 8 is the bottom of the upper one."""
    corners = [(x, y, z) for z in (-0.5, 0.5) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    faces = [(4, 5, 6, 7), (3, 2, 1, 0), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    depth, vertices, triangles = random.uniform(0.05, 0.35), list(corners), []
    for k, face in enumerate(faces):
        if k > 0 and random.random() < 0.6:
            triangles += [(face[0], face[1], face[2]), (face[0], face[2], face[3])]
            continue
        middle = numpy.mean([corners[i] for i in face], axis=0)
        triangles += [(face[i - 1], face[i], len(vertices)) for i in range(4)]
        vertices.append(tuple(middle * (1 - 2 * depth)))
    return scaled_to((numpy.array(vertices), numpy.array(triangles)), radius)


def notched(random, radius):
    """A block with a V along z: vertex 4 of each end is its bottom."""
    half, depth = random.uniform(0.3, 0.9), random.uniform(0.1, 1.5)
    outline = [(-1, -1), (1, -1), (1, 1), (half, 1), (0, 1 - depth), (-half, 1), (-1, 1)]
    return scaled_to(library.prism(outline, random.uniform(0.6, 2)), radius)


SOLIDS = {f.__name__: f for f in (cube, brick, tetrahedron, octahedron, prism, icosphere, ellipsoid, angle, channel, ring, torus, rock)}
THIN = {f.__name__: f for f in (thin_angle, thin_channel, thin_ring, hook)}
DENTED = {f.__name__: f for f in (dented, notched)}


def thickness_of(mesh):
    """Twice volume over area: of a plate its thickness."""
    p, q, r = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    area = numpy.linalg.norm(numpy.cross(q - p, r - p), axis=1).sum() / 2
    return 2 * abs(numpy.einsum("ij,ij->i", p, numpy.cross(q, r)).sum() / 6) / area


def valley_of(name, mesh):
    """Of a dented body: a point of its valley, and the normals of the faces that meet there."""
    bottom = {"dented": 8, "notched": 4}[name]
    faces = [t for t in mesh.triangles if bottom in t]
    normals = [numpy.cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]) for t in faces]
    normals = [n / numpy.linalg.norm(n) for n in normals]
    # the ends of a notch are no part of it
    return mesh.vertices[bottom], distinct([n for n in normals if name == "dented" or abs(n[2]) < 0.5])


def distinct(normals):
    kept = []
    for n in normals:
        if all(n @ m < 1 - 1e-6 for m in kept):
            kept.append(n)
    return kept


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


def grooves(angle, width, length, count, pieces, ends):
    """V-shaped grooves side by side along x, lowest at z = 0: half the angle between their faces [rad], width of a face, half their length; pieces along
    x; whether the ends are closed."""
    y, z = width * math.sin(angle), width * math.cos(angle)
    profile = [((i - count) * y, z if i % 2 == 0 else 0.0) for i in range(2 * count + 1)]   # a middle one lies on the x axis where there is an odd number
    across = len(profile)
    vertices = [(length * (2 * k / pieces - 1), *p) for k in range(pieces + 1) for p in profile]
    triangles = []
    for k in range(pieces):
        for i in range(across - 1):
            a, b = k * across + i, (k + 1) * across + i
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    for k in (0, pieces) if ends else ():
        triangles += [(k * across + i, k * across + i + 1, k * across + i + 2) for i in range(0, across - 1, 2)]
    return clean_mesh((numpy.array(vertices), numpy.array(triangles)), True)


def pitted_floor(corners, radius, depth, half):
    """A floor at z = 0 with a pyramid pressed into it, of so many corners at this radius."""
    turns = [2 * math.pi * (k + 0.5) / corners for k in range(corners)]
    vertices = [(0, 0, -depth)] + [(r * math.cos(t), r * math.sin(t), 0) for r in (radius, half) for t in turns]
    triangles = []
    for k in range(corners):
        i, j = 1 + k, 1 + (k + 1) % corners
        triangles += [(0, i, j), (i, i + corners, j + corners), (i, j + corners, j)]
    return clean_mesh((numpy.array(vertices), numpy.array(triangles)), True)


def scaled(mesh, size):
    return mesh[0] * size, mesh[1]


SURFACES = {f.__name__: f for f in (sheet, terrain, tray, slab)}
