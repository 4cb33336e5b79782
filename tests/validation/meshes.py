"""Triangle meshes for the validation cases, and their mass properties by an independent sum.

A mesh is (V x 3 vertices [m], T x 3 indices, outward). Vertices are rounded to single precision and written with all
digits: whatever the import keeps, the closed forms use the very numbers that the tools see.
"""
import math

import numpy


def rounded(vertices):
    return numpy.asarray(vertices, numpy.float32).astype(float)


def write_off(path, vertices, triangles):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n")
        file.writelines("%.17g %.17g %.17g\n" % tuple(v) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(t) for t in triangles)


def mass_properties(mesh):
    """Volume, centre of mass, inertia about it per unit density (3 x 3): signed tetrahedra about the mean vertex."""
    vertices, triangles = mesh
    origin = vertices.mean(axis=0)
    a, b, c = (vertices[triangles[:, i]] - origin for i in range(3))
    six = numpy.einsum("ij,ij->i", a, numpy.cross(b, c))
    volume = six.sum() / 6
    centre = (six[:, None] * (a + b + c)).sum(axis=0) / 24 / volume
    # covariance of a tetrahedron at the origin: det/120 (sum_i p_i p_i^T + s s^T), s = a + b + c
    s = a + b + c
    second = sum(numpy.einsum("t,ti,tj->ij", six, p, p) for p in (a, b, c, s)) / 120
    second -= volume * numpy.outer(centre, centre)
    inertia = numpy.trace(second) * numpy.eye(3) - second
    return volume, centre + origin, inertia


def centred(mesh):
    """Moved so that the centre of mass is the origin, to single precision."""
    vertices, triangles = mesh
    return rounded(vertices - mass_properties(mesh)[1]), triangles


def transformed(mesh, matrix=numpy.eye(3), shift=(0, 0, 0)):
    return rounded(mesh[0] @ numpy.asarray(matrix, float).T + numpy.asarray(shift, float)), mesh[1]


def joined(*parts):
    vertices, triangles, count = [], [], 0
    for v, t in parts:
        vertices.append(v)
        triangles.append(t + count)
        count += len(v)
    return numpy.concatenate(vertices), numpy.concatenate(triangles)


def welded(vertices, triangles):
    unique, index = numpy.unique(numpy.round(vertices, 12), axis=0, return_inverse=True)
    triangles = index.reshape(-1)[numpy.asarray(triangles)]
    keep = (triangles[:, 0] != triangles[:, 1]) & (triangles[:, 1] != triangles[:, 2]) & (triangles[:, 0] != triangles[:, 2])
    return rounded(unique), triangles[keep]


def box(size=(1, 1, 1), n=1, shift=(0, 0, 0)):
    """Box with every face in n x n squares of two triangles."""
    vertices, triangles = [], []
    for axis in range(3):
        for side in (-1, 1):
            first = len(vertices)
            u, w = (axis + 1) % 3, (axis + 2) % 3
            for i in range(n + 1):
                for j in range(n + 1):
                    p = [0.0, 0.0, 0.0]
                    p[axis], p[u], p[w] = side / 2, i / n - 0.5, j / n - 0.5
                    vertices.append(p)
            for i in range(n):
                for j in range(n):
                    a, b, c, d = (first + (i + di) * (n + 1) + j + dj for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
                    triangles += [(a, b, c), (a, c, d)] if side > 0 else [(a, c, b), (a, d, c)]
    v, t = welded(numpy.array(vertices), numpy.array(triangles))
    return rounded(v * numpy.asarray(size, float) + numpy.asarray(shift, float)), t


def icosphere(level, radius=1.0):
    """Vertices on the sphere of the radius."""
    g = (1 + math.sqrt(5)) / 2
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    vertices = [numpy.array(v) / math.sqrt(1 + g * g) for v in vertices]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
                 (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        middle, finer = {}, []

        def half(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                m = vertices[i] + vertices[j]
                middle[key] = len(vertices)
                vertices.append(m / numpy.linalg.norm(m))
            return middle[key]

        for a, b, c in triangles:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        triangles = finer
    return rounded(numpy.array(vertices) * radius), numpy.array(triangles)


def ellipsoid(axes, level):
    v, t = icosphere(level)
    return rounded(v * numpy.asarray(axes, float)), t


def cylinder(radius, height, sides, turn=0.0):
    """Prism along z with its vertices on the cylinder; flat ends are fans about their centres."""
    angles = 2 * math.pi * (numpy.arange(sides) + turn) / sides
    ring = numpy.stack([radius * numpy.cos(angles), radius * numpy.sin(angles)], axis=1)
    low = numpy.column_stack([ring, numpy.full(sides, -height / 2)])
    high = numpy.column_stack([ring, numpy.full(sides, height / 2)])
    vertices = numpy.vstack([low, high, [[0, 0, -height / 2], [0, 0, height / 2]]])
    triangles = []
    for i in range(sides):
        j = (i + 1) % sides
        triangles += [(i, j, sides + j), (i, sides + j, sides + i), (j, i, 2 * sides), (sides + i, sides + j, 2 * sides + 1)]
    return rounded(vertices), numpy.array(triangles)


def prism(outline, height):
    """Right prism along z over a simple polygon (counter-clockwise): L, U, wedges."""
    outline = numpy.asarray(outline, float)
    n = len(outline)
    low = numpy.column_stack([outline, numpy.full(n, -height / 2)])
    high = numpy.column_stack([outline, numpy.full(n, height / 2)])
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i)]
    for a, b, c in ears(outline):
        triangles += [(n + a, n + b, n + c), (c, b, a)]
    return rounded(numpy.vstack([low, high])), numpy.array(triangles)


def ears(outline):
    """Triangles of a simple polygon by ear clipping; the outlines here have a dozen corners."""
    index, triangles = list(range(len(outline))), []

    def area(a, b, c):
        return (outline[b][0] - outline[a][0]) * (outline[c][1] - outline[a][1]) - (outline[b][1] - outline[a][1]) * (outline[c][0] - outline[a][0])

    while len(index) > 3:
        for k in range(len(index)):
            a, b, c = index[k - 1], index[k], index[(k + 1) % len(index)]
            if area(a, b, c) <= 0:
                continue
            if any(area(a, b, p) >= 0 and area(b, c, p) >= 0 and area(c, a, p) >= 0 for p in index if p not in (a, b, c)):
                continue
            triangles.append((a, b, c))
            index.pop(k)
            break
        else:
            raise ValueError("the outline is no simple polygon")
    return triangles + [tuple(index)]


def l_outline(arm, width):
    return [(0, 0), (arm, 0), (arm, width), (width, width), (width, arm), (0, arm)]


def u_outline(width, height, thickness):
    w, h, t = width, height, thickness
    return [(0, 0), (w, 0), (w, h), (w - t, h), (w - t, t), (t, t), (t, h), (0, h)]


def torus(R, r, n, m):
    """n x m quads around z, outward."""
    vertices, triangles = [], []
    for i in range(n):
        for j in range(m):
            a, b = 2 * math.pi * i / n, 2 * math.pi * j / m
            vertices.append(((R + r * math.cos(b)) * math.cos(a), (R + r * math.cos(b)) * math.sin(a), r * math.sin(b)))
            p, q, s, t = i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
            triangles += [(p, q, s), (p, s, t)]
    return rounded(numpy.array(vertices)), numpy.array(triangles)


def tube(inner, outer, height, sides):
    """Ring with a rectangular profile along z: washers, nuts, staple-free clearance holes."""
    vertices, triangles = [], []
    profile = [(inner, -height / 2), (outer, -height / 2), (outer, height / 2), (inner, height / 2)]
    for i in range(sides):
        a = 2 * math.pi * i / sides
        vertices += [(r * math.cos(a), r * math.sin(a), z) for r, z in profile]
        for j in range(4):
            p, q = 4 * i + j, 4 * ((i + 1) % sides) + j
            s, t = 4 * ((i + 1) % sides) + (j + 1) % 4, 4 * i + (j + 1) % 4
            triangles += [(p, q, s), (p, s, t)]
    return rounded(numpy.array(vertices)), numpy.array(triangles)


def lathe(profile, sides):
    """Body of revolution about z from a profile of (r, z) from the lower pole to the upper, outward to its right; the
    ends lie on the axis (r = 0)."""
    vertices, triangles = [(0, 0, profile[0][1])], []
    rings = profile[1:-1]
    for r, z in rings:
        vertices += [(r * math.cos(2 * math.pi * i / sides), r * math.sin(2 * math.pi * i / sides), z) for i in range(sides)]
    vertices.append((0, 0, profile[-1][1]))
    last = len(vertices) - 1
    for i in range(sides):
        j = (i + 1) % sides
        triangles.append((0, 1 + j, 1 + i))
        for k in range(len(rings) - 1):
            a, b = 1 + k * sides, 1 + (k + 1) * sides
            triangles += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
        triangles.append((last, 1 + (len(rings) - 1) * sides + i, 1 + (len(rings) - 1) * sides + j))
    return rounded(numpy.array(vertices)), numpy.array(triangles)


def tetrahedron(edge):
    v = numpy.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) * edge / (2 * math.sqrt(2))
    return rounded(v), numpy.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])


def plate(size, n=1):
    """Open square sheet at z = 0, facing up."""
    vertices = [((i / n - 0.5) * size, (j / n - 0.5) * size, 0.0) for i in range(n + 1) for j in range(n + 1)]
    triangles = []
    for i in range(n):
        for j in range(n):
            a, b, c, d = i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1
            triangles += [(a, b, c), (a, c, d)]
    return rounded(numpy.array(vertices)), numpy.array(triangles)


def rock(seed, level, radius=0.5, roughness=0.22):
    """Concave rock: an icosphere whose radius carries smooth noise of the given rms (bumps of random direction)."""
    random = numpy.random.default_rng(seed)
    v, t = icosphere(level)
    directions = random.normal(size=(24, 3))
    directions /= numpy.linalg.norm(directions, axis=1)[:, None]
    frequency, phase = random.uniform(1.5, 4.5, 24), random.uniform(0, 2 * math.pi, 24)
    noise = numpy.cos(frequency * (v @ directions.T) * 1.0 + phase).sum(axis=1)
    sample = icosphere(3)[0]
    scale = numpy.cos(frequency * (sample @ directions.T) + phase).sum(axis=1)
    noise = (noise - scale.mean()) / scale.std() * roughness
    return centred((v * (radius * numpy.maximum(0.35, 1 + noise))[:, None], t))
