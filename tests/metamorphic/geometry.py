"""Distances, overlaps and volumes worked out anew and plainly, to hold the tools against: no grids, no hierarchies, all pairs of triangles."""
import numpy


def turned(q, points):
    """Points N x 3 by a unit quaternion w x y z."""
    u, w = numpy.asarray(q[1:]), q[0]
    t = 2 * numpy.cross(u, points)
    return points + w * t + numpy.cross(u, t)


def world_triangles(shape, position, quat, scale):
    points = turned(quat, shape["vertices"] * scale) + position
    return points[shape["triangles"]]


def segment_distances(p, q, r, s):
    """Smallest distances between the segments p q and r s, N x 3 each. Source: Ericson, Real-Time Collision Detection, 5.1.9."""
    d1, d2, w = q - p, s - r, p - r
    a, e, f = (d1 * d1).sum(-1), (d2 * d2).sum(-1), (d2 * w).sum(-1)
    b, c = (d1 * d2).sum(-1), (d1 * w).sum(-1)
    determinant = a * e - b * b
    with numpy.errstate(divide="ignore", invalid="ignore"):
        u = numpy.where(determinant > 1e-14 * a * e, numpy.clip((b * f - c * e) / determinant, 0, 1), 0.0)
        v = (b * u + f) / e
        u = numpy.where(v < 0, numpy.clip(-c / a, 0, 1), numpy.where(v > 1, numpy.clip((b - c) / a, 0, 1), u))
    v = numpy.clip(v, 0, 1)
    return numpy.linalg.norm(p + u[..., None] * d1 - r - v[..., None] * d2, axis=-1)


def point_triangle_distances(p, t):
    """Distances of points N x 3 from triangles N x 3 x 3."""
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    n = numpy.cross(b - a, c - a)
    n = n / numpy.linalg.norm(n, axis=1)[:, None]
    height = ((p - a) * n).sum(1)
    foot = p - height[:, None] * n
    inside = numpy.ones(len(p), bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= (numpy.cross(v - u, foot - u) * n).sum(1) >= 0
    edges = numpy.min([point_segment_distances(p, u, v) for u, v in ((a, b), (b, c), (c, a))], axis=0)
    return numpy.where(inside, numpy.abs(height), edges)


def point_segment_distances(p, u, v):
    d = v - u
    t = numpy.clip(((p - u) * d).sum(1) / (d * d).sum(1), 0, 1)
    return numpy.linalg.norm(u + t[:, None] * d - p, axis=1)


def triangle_sets_distance(a, b):
    """Smallest distance between two surfaces, triangles N x 3 x 3 and M x 3 x 3; 0 where they cross."""
    i, j = numpy.meshgrid(numpy.arange(len(a)), numpy.arange(len(b)), indexing="ij")
    s, t = a[i.ravel()], b[j.ravel()]
    best = numpy.inf
    for k in range(3):
        best = min(best, point_triangle_distances(s[:, k], t).min(), point_triangle_distances(t[:, k], s).min())
        for m in range(3):
            best = min(best, segment_distances(s[:, k], s[:, (k + 1) % 3], t[:, m], t[:, (m + 1) % 3]).min())
    return 0.0 if crosses(s, t) or crosses(t, s) else float(best)


def crosses(s, t):
    """Whether an edge of one of the triangles s passes through its partner in t."""
    n = numpy.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    for k in range(3):
        p, q = s[:, k], s[:, (k + 1) % 3]
        hp, hq = ((p - t[:, 0]) * n).sum(1), ((q - t[:, 0]) * n).sum(1)
        with numpy.errstate(divide="ignore", invalid="ignore"):
            x = p + (hp / (hp - hq))[:, None] * (q - p)
        hit = hp * hq < 0
        for m in range(3):
            hit &= (numpy.cross(t[:, (m + 1) % 3] - t[:, m], x - t[:, m]) * n).sum(1) > 0
        if hit.any():
            return True
    return False


def point_in_solid(p, triangles):
    """Whether points lie in a closed surface, by its solid angle. Source: van Oosterom and Strackee 1983."""
    p = numpy.atleast_2d(p)
    a, b, c = (triangles[None, :, k] - p[:, None] for k in range(3))
    la, lb, lc = (numpy.linalg.norm(v, axis=2) for v in (a, b, c))
    top = (a * numpy.cross(b, c)).sum(2)
    bottom = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return 2 * numpy.arctan2(top, bottom).sum(1) > 2 * numpy.pi


class Body:
    def __init__(self, scene, i):
        self.id = int(scene.body("id")[i])
        self.shape = scene.shapes[scene.body("shape")[i]]
        self.position, self.quat, self.scale = scene.body("position")[i], scene.body("orientation")[i], float(scene.body("scale")[i])
        self.reach = float(scene.radii()[i])
        self.is_ball = self.shape["kind"] == 2
        self.triangles = None if self.is_ball else world_triangles(self.shape, self.position, self.quat, self.scale)

    def shrink(self, share):
        """A mesh about its centre; a ball touches where it ends."""
        if not self.is_ball:
            self.triangles = self.position + share * (self.triangles - self.position)


def gap(a, b, shift):
    """Distance between two bodies, b moved by shift; below 0 or 0 where they overlap."""
    x = b.position + shift
    if a.is_ball and b.is_ball:
        return float(numpy.linalg.norm(a.position - x)) - a.reach - b.reach
    if a.is_ball or b.is_ball:
        ball, mesh = (a.position, b.triangles + shift) if a.is_ball else (x, a.triangles)
        radius = a.reach if a.is_ball else b.reach
        distance = float(point_triangle_distances(numpy.repeat(ball[None], len(mesh), axis=0), mesh).min())
        return -distance - radius if point_in_solid(ball, mesh)[0] else distance - radius
    other = b.triangles + shift
    distance = triangle_sets_distance(a.triangles, other)
    if distance > 0 and (point_in_solid(other[0, 0], a.triangles)[0] or point_in_solid(a.triangles[0, 0], other)[0]):
        return -distance
    return distance


def periodic_shifts(general):
    """How far the images of a body lie from it, itself first."""
    domain = general.get("domain", {})
    steps = []
    for k in range(3):
        length = domain["max"][k] - domain["min"][k] if domain.get("periodic", [False] * 3)[k] else 0.0
        steps.append([0.0, length, -length] if length > 0 else [0.0])
    return [numpy.array([x, y, z]) for x in steps[0] for y in steps[1] for z in steps[2]]


def body_samples(shape, scale, count=2000):
    """Points that fill a body evenly, in its axes, and the volume that each stands for."""
    if shape["kind"] == 2:
        k = numpy.arange(count) + 0.5
        radius = shape["radius"] * scale * numpy.cbrt(k / count)
        z = 1 - 2 * ((k * 0.7548776662466927) % 1)
        angle = 2 * numpy.pi * ((k * 0.5698402909980532) % 1)
        flat = numpy.sqrt(1 - z * z)
        points = radius[:, None] * numpy.column_stack([flat * numpy.cos(angle), flat * numpy.sin(angle), z])
    else:
        low, high = shape["vertices"].min(0), shape["vertices"].max(0)
        # until that many lie inside: a thin shape fills a small part of its box
        sides, parts, inside, begun = shape["vertices"][shape["triangles"]], [], 0, 0
        while inside < count and begun < 60 * count:
            k = numpy.arange(begun, begun + count) + 1.0
            cube = numpy.column_stack([(k * x) % 1 for x in (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)])
            points = low + cube * (high - low)
            parts.append(points[point_in_solid(points, sides)])
            inside, begun = inside + len(parts[-1]), begun + count
        points = numpy.concatenate(parts) * scale
    volume = shape["volume"] * scale**3
    return points, volume / max(1, len(points))


def area_of_hull(points):
    """Of the smallest convex polygon around points of a plane."""
    points = sorted(map(tuple, points))
    outline = []
    for way in (points, points[::-1]):
        side = []
        for x in way:
            while len(side) > 1 and (side[-1][0] - side[-2][0]) * (x[1] - side[-2][1]) - (side[-1][1] - side[-2][1]) * (x[0] - side[-2][0]) <= 0:
                side.pop()
            side.append(x)
        outline += side[:-1]
    return 0.5 * abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(outline, outline[1:] + outline[:1])))
