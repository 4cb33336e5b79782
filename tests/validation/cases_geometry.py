"""G: mass properties and what the mesher says of broken meshes (validation plan 1.1)."""
import json
import math
import os

import h5py
import numpy

import meshes
from registry import case_of
from scene import ToolError, import_mesh

CASES = []
case = case_of(CASES)


def imported(tools, name, mesh, *arguments, text=None):
    """Imports a mesh (see import_mesh) and gives volume, centre, inertia, principal moments (density 1)."""
    return properties(import_mesh(tools, mesh, *arguments, text=text, name=name)[0])


def properties(path):
    with h5py.File(path, "r") as file:
        shape = file["shapes/shape_0000"]
        return {"volume": float(shape.attrs["volume"]), "centre": shape["origin_shift"][:].ravel(), "inertia": shape["inertia"][:],
                "moments": numpy.sort(shape["principal_moments"][:].ravel()), "frame": shape["body_from_principal"][:].ravel(),
                "verdict": json.loads(shape["verdict"][()])}


@case("G1", "U", "mass properties of a box, coarse and fine, turned and far away")
def g1(tools, report):
    # Coordinates are whole numbers times a scale that the mesher applies, so that the file's single precision is exact.
    expected = numpy.array([1 / 30, .34 / 3, .4 / 3]) / 1000  # for density 1: the box of mass 8 has density 1000
    for n in (1, 16):
        box = meshes.box((40 * 16, 20 * 16, 10 * 16), n)
        p = imported(tools, f"g1-{n}", box, "--scale", repr(.01 / 16))
        report.check(f"{12 * n * n} triangles: mass / 8", 1000 * p["volume"] / 8, 1, 1e-13)
        report.at_most(f"{12 * n * n} triangles: relative error of the moments", numpy.abs(p["moments"] / expected - 1).max(), 1e-13)
        report.at_most(f"{12 * n * n} triangles: centre of mass [m]", numpy.abs(p["centre"]).max(), 1e-13)
        # turned by a rational rotation (2/3, -1/3, 2/3), moved by (1e3, -2e3, 5e2) m
        turn = numpy.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
        scale = .01 / 48
        vertices = meshes.box((40 * 48, 20 * 48, 10 * 48), n)[0] @ turn.T + numpy.round(numpy.array([1e3, -2e3, 5e2]) / scale)
        assert (vertices == meshes.rounded(vertices)).all() and (vertices == numpy.round(vertices)).all()
        p = imported(tools, f"g1-far-{n}", (vertices, box[1]), "--scale", repr(scale))
        report.check(f"{12 * n * n} triangles, 2.3 km away and turned: mass / 8", 1000 * p["volume"] / 8, 1, 1e-10)
        report.at_most(f"{12 * n * n} triangles, far: relative error of the moments", numpy.abs(p["moments"] / expected - 1).max(), 1e-10)
        R = turn
        inertia = R @ numpy.diag([1 / 30, .34 / 3, .4 / 3]) @ R.T / 1000
        report.at_most(f"{12 * n * n} triangles, far: inertia tensor", numpy.abs(p["inertia"] - inertia).max() / inertia.max(), 1e-10)


@case("G2", "U", "regular tetrahedron")
def g2(tools, report):
    v = numpy.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float)
    p = imported(tools, "g2", (v, numpy.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])))
    a = 2 * math.sqrt(2)
    report.check("volume", p["volume"], a**3 / (6 * math.sqrt(2)), 1e-13)
    report.at_most("moments against m a^2/20, relative", numpy.abs(p["moments"] / (p["volume"] * a * a / 20) - 1).max(), 1e-13)


@case("G3", "U", "icospheres with vertices at radius 1: volume and inertia by level")
def g3(tools, report):
    volumes = [.60546138, .87345320, .96616075, .99139384, .99783917, .99945921]
    inertias = [.72360680, .91447931, .97736101, .99425747, .99855913, .99963945]
    errors = []
    for level in range(6):
        p = imported(tools, f"g3-{level}", meshes.icosphere(level))
        ratio = p["volume"] / (4 / 3 * math.pi)
        errors.append(1 - ratio)
        report.check(f"L{level}: V over that of the sphere", ratio, volumes[level], 1e-7)
        report.check(f"L{level}: I over 0.4 m R^2", p["moments"].mean() / (.4 * p["volume"]), inertias[level], 1e-7)
    report.check("order in the edge length, L4 to L5", math.log2(errors[4] / errors[5]), 2.0, .05, "absolute")


@case("G4", "U", "torus of 64 x 32 quads")
def g4(tools, report):
    R, r = 1.0, .25
    p = imported(tools, "g4", meshes.torus(R, r, 64, 32))
    m = p["volume"]
    report.check("V over 2 pi^2 R r^2", m / (2 * math.pi**2 * R * r * r), .99199154, 1e-7)
    report.check("Izz over m (R^2 + 3/4 r^2)", p["inertia"][2, 2] / (m * (R * R + .75 * r * r)), .99810858, 1e-7)
    report.check("Ixx over m (R^2/2 + 5/8 r^2)", p["inertia"][0, 0] / (m * (R * R / 2 + .625 * r * r)), .99797776, 1e-7)


def crossing_pairs(mesh):
    """Pairs of triangles without a common vertex that meet, by exact integers: an edge of one has a point of the other."""
    vertices = [[round(1000 * x) for x in v] for v in mesh[0].tolist()]

    def volume(a, b, c, d):
        (u, v, w) = ([x[i] - a[i] for i in range(3)] for x in (b, c, d))
        return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])

    def pierces(p, q, triangle):
        sides = volume(p, *triangle), volume(q, *triangle)
        if sides[0] * sides[1] > 0 or sides == (0, 0):   # on one side; no two triangles of the case lie in one plane
            return False
        around = [volume(p, q, triangle[k], triangle[(k + 1) % 3]) for k in range(3)]
        return min(around) >= 0 or max(around) <= 0

    corners = [(set(t), [vertices[i] for i in t]) for t in mesh[1].tolist()]
    return sum(not a & b and any(pierces(x[k], x[(k + 1) % 3], y) for x, y in ((s, t), (t, s)) for k in range(3))
               for i, (a, s) in enumerate(corners) for b, t in corners[:i])


@case("G5", "U", "broken meshes are named and counted, never accepted silently")
def g5(tools, report):
    vertices, triangles = meshes.box()
    flip = triangles[:, ::-1]
    one_flipped = triangles.copy()
    one_flipped[3] = one_flipped[3][::-1]
    # a T-junction: the middle of one edge is a vertex of one neighbour only
    a, b, c = triangles[0]
    middle = len(vertices)
    t_junction = numpy.vstack([triangles[1:], [[a, middle, c], [middle, b, c]]])
    t_vertices = numpy.vstack([vertices, (vertices[a] + vertices[b]) / 2])
    far = numpy.vstack([vertices, [[3.0, 3, 3]]])
    fin = numpy.vstack([triangles, [[a, b, len(vertices)]]])
    crossing = meshes.joined(meshes.box(), meshes.box(shift=(.5, .3, .2)))
    duplicate = numpy.vstack([triangles, triangles[:1]])
    sliver = numpy.vstack([triangles, [[a, a, b]]])
    broken = {
        "inverted winding": ((vertices, flip), {"inverted_components": 1}, "the mesh is inverted", True),
        "one flipped facet": ((vertices, one_flipped), {"inconsistent_edges": 3}, "the orientation is not consistent", True),
        "hole": ((vertices, triangles[1:]), {"boundary_edges": 3, "boundary_loops": 1}, "the mesh is open", True),
        "duplicated facet": ((vertices, duplicate), {"duplicates_dropped": 1}, "1 duplicate triangle dropped", False),
        "zero-area facet": ((vertices, sliver), {"degenerate_dropped": 1}, "1 zero-area triangle dropped", False),
        "T-junction": ((t_vertices, t_junction), {"t_junctions": 1, "boundary_edges": 3}, "1 T-junction", True),
        "non-manifold edge": ((far, fin), {"non_manifold_edges": 1, "boundary_edges": 2}, "1 non-manifold edge", True),
        "self-intersection": (crossing, {"crossing_components": 1, "self_intersections": crossing_pairs(crossing)}, "passes through each other", True),
    }
    for name, (mesh, counts, words, refused) in broken.items():
        path = os.path.join(tools.scratch, "g5.off")
        meshes.write_off(path, *mesh)
        out = os.path.join(tools.scratch, "g5.shape.h5")
        if os.path.exists(out):
            os.remove(out)
        try:
            text = tools.call("scree-mesher", "import", path, "-o", out)
            code = 0
            with h5py.File(out, "r") as file:
                verdict = json.loads(file["shapes/shape_0000/verdict"][()])
        except ToolError as error:
            code, text = error.code, error.text
            try:
                verdict = json.loads(tools.call("scree-mesher", "check", path, "--json"))
            except ToolError as check:
                verdict = json.loads(check.text[check.text.index("{"):check.text.rindex("}") + 1])
        report.check(f"{name}: {'refused' if refused else 'mended'} (exit code)", code, 3 if refused else 0, 0, "absolute")
        for key, count in counts.items():
            report.check(f"{name}: {key}", count_of(verdict, key), count, 0, "absolute")
        # refused: what to do is said too
        told = words in text and (not refused or "what to do: " in text)
        report.check(f"{name}: reported as '{words}'{' with advice' if refused else ''}", float(told), 1, 0, "absolute")


def count_of(verdict, key):
    """The count of a verdict, wherever it stands: of the mesh as it is, as stored in the file, or as repaired."""
    if isinstance(verdict, dict):
        best = verdict.get(key, 0)
        best = best if isinstance(best, (int, float)) else 0
        return max([best] + [count_of(v, key) for k, v in verdict.items() if isinstance(v, (dict, list))])
    if isinstance(verdict, list):
        return max([0] + [count_of(v, key) for v in verdict])
    return 0


@case("G6", "U", "principal axes of a box turned at random, and free rotation in them")
def g6(tools, report):
    import closed_forms as cf
    from cases_rotation import INERTIA, angle_between, product
    from scene import Case, quaternion, rotated
    q = quaternion((.3, -.5, .8), 1.1)
    R = numpy.stack([rotated(q, e) for e in numpy.eye(3)], axis=1)
    vertices, triangles = meshes.box((.4, .2, .1))
    mesh = (meshes.rounded(vertices @ R.T), triangles)
    p = imported(tools, "g6", mesh)
    own = meshes.mass_properties(mesh)
    report.at_most("moments against an independent sum over the same triangles, relative", numpy.abs(p["moments"] / numpy.linalg.eigvalsh(own[2]) - 1).max(), 1e-12)
    frame = p["frame"]
    P = numpy.stack([rotated(frame, e) for e in numpy.eye(3)], axis=1)
    moments = numpy.diag(P.T @ p["inertia"] @ P)
    report.check("frame is right-handed (determinant)", numpy.linalg.det(P), 1, 1e-12)
    report.at_most("it makes the inertia diagonal", numpy.abs(P.T @ p["inertia"] @ P - numpy.diag(moments)).max() / moments.max(), 1e-12)
    report.check("moments are ascending", float((numpy.diff(moments) >= 0).all()), 1, 0, "absolute")
    # the same motion as R1: the turned mesh, started turned back, at the body velocity (1, 2, 3) of the box
    c = Case("G6", duration=1.0, step=2.5e-4, margin=.001, every=1.0)
    c.mesh("box", mesh)
    c.material("m", 1000.0)
    c.pair_all(stiffness=1.0, restitution=1.0)
    c.body("box", "m", (0, 0, 0), angular_velocity=rotated(q, numpy.array([1.0, 2, 3])))
    run = report.run(c.run(tools))
    # orientation of the box proper: run's turn times q; it must be q times the free rotation
    report.at_most("R1 in these axes: orientation error at t = 1 [rad]", angle_between(product(run.q[-1, 0], q), product(q, cf.free_orientation(INERTIA, (1, 2, 3), 1.0))), 2e-6)
