"""X cases about meshes, placement, scales and precision (docs/reference/validation-plan.md, section 2)."""
import math
import os

import numpy

import closed_forms as cf
import meshes
from registry import case_of
from scene import Case, ToolError, import_mesh, quaternion, rotated
from extremes_motion import simple
from verdicts import finite

CASES = []
_mark = case_of(CASES)
G = cf.GRAVITY


def case(name, title):
    return _mark(name, "X", title)


@case("X10", "deep overlap at the start")
def x10(tools, table):
    def scene(name, *bodies, meshes_=None):
        c = simple(name, .01, 1e4, e=.5, margin=.002, every=.01)
        c.mesh("cube", meshes.box((.1, .1, .1)))
        for name_, mesh in (meshes_ or {}).items():
            c.mesh(name_, mesh)
        for body in bodies:
            c.body(*body)
        return c
    table.must_refuse("two boxes that overlap by half", lambda: scene("X10a", ("cube", "m", (0, 0, 0)), ("cube", "m", (.05, 0, 0))).run(tools))
    table.must_refuse("two bodies at the same place", lambda: scene("X10b", ("cube", "m", (0, 0, 0)), ("cube", "m", (0, 0, 0))).run(tools))
    table.must_refuse("a small box inside a solid one", lambda: scene("X10c", ("big", "m", (0, 0, 0)), ("cube", "m", (0, 0, 0)), meshes_={"big": meshes.box((1, 1, 1))}).run(tools))
    # separated on request, before the first step: the bodies start at rest, two margins apart
    c = scene("X10e", ("cube", "m", (0, 0, 0)), ("cube", "m", (.05, .01, 0)))
    c.tables["contact"]["relax"] = True
    try:
        run = c.run(tools)
        table.truth("two boxes that overlap by half, with relax", finite(run) and run.max_depth_ratio <= 1e-6 and numpy.abs(run.v[-1]).max() < 1e-9,
                    f"separated to {numpy.linalg.norm(run.x[0, 1] - run.x[0, 0]):.4g} m between centres; speed {numpy.abs(run.v[-1]).max():.2g} m/s")
    except ToolError as error:
        table.refusal("two boxes that overlap by half, with relax", error)
    # legal: inside a hollow shell
    outer, inner = meshes.box((1, 1, 1)), meshes.box((.8, .8, .8))
    shell = meshes.joined(outer, (inner[0], inner[1][:, ::-1]))
    try:
        run = scene("X10d", ("shell", "m", (0, 0, 0)), ("cube", "m", (0, 0, 0)), meshes_={"shell": shell}).run(tools)
        table.truth("a box in the hollow of a shell", finite(run) and run.log["contacts"].max() == 0, "accepted, no contact")
    except ToolError as error:
        table.add("a box in the hollow of a shell", "failed", f"refused though legal: {error.text.strip()[-200:]}")


def drop(tools, name, mesh, e=.5, k=1e4, speed=1.0, steps=100, q=(1, 0, 0, 0), lock=False, **more):
    """A body of mass about 1 falls on a plane; gives the run."""
    c = simple(name, .08, k, e=e, density=1.0 / meshes.mass_properties(mesh)[0], steps_per_contact=steps, margin=.01, every=.02, **more)
    c.mesh("shape", mesh)
    low = -rotated(numpy.asarray(q), mesh[0])[:, 2].min()
    c.body("shape", "m", (0, 0, low + .0205), orientation=q, velocity=(0, 0, -speed), lock_rotation=lock)
    c.floor()
    return c.run(tools)


@case("X11", "slivers, needles, caps")
def x11(tools, table):
    reference = drop(tools, "X11", meshes.box()).v[-1, 0, 2]
    for aspect in (1e3, 1e5, 1e6):
        # the bottom and top faces are cut by a point close to one of their edges: needles and caps of that aspect
        vertices, triangles = meshes.box()
        vertices, triangles = list(map(tuple, vertices)), [tuple(t) for t in triangles]
        for z in (-.5, .5):
            face = [t for t in triangles if all(vertices[i][2] == z for i in t)]
            t = face[0]
            a, b, c = (numpy.array(vertices[i]) for i in t)
            p = (a + b) / 2 + (c - (a + b) / 2) / aspect
            i = len(vertices)
            vertices.append(tuple(meshes.rounded(p)))
            triangles.remove(t)
            triangles += [(t[0], t[1], i), (t[1], t[2], i), (t[2], t[0], i)]
        try:
            mesh = (numpy.array(vertices), numpy.array(triangles))
            run = drop(tools, "X11", mesh)
            table.figure(f"cube with triangles of aspect {aspect:g}: restitution differs by", abs(run.v[-1, 0, 2] - reference), 1e-5)
        except ToolError as error:
            table.refusal(f"cube with triangles of aspect {aspect:g}", error)


@case("X12", "zero-area and duplicate facets")
def x12(tools, table):
    vertices, triangles = meshes.box()
    clean = drop(tools, "X12", (vertices, triangles), q=quaternion((1, 2, 3), .4))
    doubled = numpy.vstack([vertices, vertices])
    dirty = numpy.vstack([triangles, triangles[:2], [[0, 0, 1], [2, 2, 2]], triangles[3:4] + len(vertices)])
    mesh = (doubled, dirty)
    c = simple("X12d", .08, 1e4, e=.5, density=1.0, steps_per_contact=100, margin=.01, every=.02)
    c.mesh("shape", mesh)
    q = quaternion((1, 2, 3), .4)
    c.body("shape", "m", (0, 0, -rotated(q, vertices)[:, 2].min() + .0205), orientation=q, velocity=(0, 0, -1))
    c.floor()
    run = c.run(tools)
    table.figure("2 doubled, 2 flat and 1 repeated facet: trajectory differs by", max(numpy.abs(run.x - clean.x).max(), numpy.abs(run.w - clean.w).max()), 1e-12)
    _, text = import_mesh(tools, mesh)
    said = [line.rsplit(": ", 1)[-1] for line in text.splitlines() if "dropped" in line]
    table.truth("reported with their count", bool(said), "; ".join(said)[:160])


@case("X13", "thin plate, open sheet")
def x13(tools, table):
    plate = meshes.box((1, 1, 1e-4))
    c = simple("X13", .2, 1e5, e=.3, mu=.3, gravity=(0, 0, -G), margin=4e-5, steps_per_contact=30, every=.02)
    c.mesh("plate", plate)
    c.body("plate", "m", (0, 0, 5e-5 + 1e-4))
    c.floor()
    try:
        run = c.run(tools)
        table.truth("1 x 1 x 1e-4 m, closed, falls on a plane", finite(run) and run.x[-1, 0, 2] > 4e-5 and run.log["contacts"][-1] <= 4, f"rests at z = {run.x[-1, 0, 2]:.3g} m with {run.log['contacts'][-1]:.0f} contacts")
    except ToolError as error:
        table.refusal("1 x 1 x 1e-4 m, closed, falls on a plane", error)
    table.must_refuse("open sheet as a body", lambda: import_mesh(tools, meshes.plate(1.0)), "the mesh is open")


@case("X14", "meshes that do not close")
def x14(tools, table):
    vertices, triangles = meshes.box()
    a, b, c = triangles[0]
    t_vertices = numpy.vstack([vertices, (vertices[a] + vertices[b]) / 2])
    t_triangles = numpy.vstack([triangles[1:], [[a, len(vertices), c], [len(vertices), b, c]]])
    gap = numpy.vstack([vertices, [vertices[a] + [1e-7, 0, 0]]])
    moved = triangles.copy()
    moved[0] = [len(vertices), b, c]
    cases = {"missing facet": ((vertices, triangles[1:]), "3 boundary edges in 1 loop"), "gap of 1e-7": ((gap, moved), "4 boundary edges in 1 loop"),
             "T-junction": ((t_vertices, t_triangles), "1 T-junction")}
    for name, (mesh, words) in cases.items():
        table.must_refuse(f"{name}, as a body", lambda mesh=mesh: import_mesh(tools, mesh), words)
        out, text = import_mesh(tools, mesh, "--surface", "--unit", "m")
        table.truth(f"{name}, as a wall", os.path.exists(out), "accepted, reported as: " + "; ".join(line.rsplit(": ", 1)[-1] for line in text.splitlines() if "note" in line)[:140])


@case("X15", "inverted and mixed triangles")
def x15(tools, table):
    vertices, triangles = meshes.icosphere(2, .5)
    one_percent = triangles.copy()
    for i in (5, 100, 211):
        one_percent[i] = one_percent[i][::-1]
    for name, mesh in (("all inverted", (vertices, triangles[:, ::-1])), ("1 % inverted", (vertices, one_percent))):
        table.must_refuse(f"{name}, without --flip", lambda mesh=mesh: import_mesh(tools, mesh))
    results = {}
    for name, mesh in (("right", (vertices, triangles)), ("all inverted", (vertices, triangles[:, ::-1])), ("1 % inverted", (vertices, one_percent))):
        path, _ = import_mesh(tools, mesh, "--flip", name="x15")
        c = simple("X15", .3, 1e4, e=.5, mu=.3, density=2.0, gravity=(0, 0, -G), margin=.01, every=.1)
        c.shape_file("shape", path)
        c.body("shape", "m", (0, 0, .54), orientation=quaternion((1, 2, 3), .4), velocity=(.3, 0, -1))
        c.floor()
        run = c.run(tools)
        results[name] = run.record["state_hash"], run.x
    for name in ("all inverted", "1 % inverted"):
        # a triangle that is turned begins at another vertex: the centre of mass, a sum over triangles, is then another to rounding
        same, apart = results[name][0] == results["right"][0], numpy.abs(results[name][1] - results["right"][1]).max()
        table.truth(f"{name}, with --flip: same trajectory", same or apart <= 4 * numpy.finfo(float).eps, "the same bits" if same else f"to rounding: {apart:.2g} m of 1 m")


@case("X16", "self-intersecting mesh")
def x16(tools, table):
    table.must_refuse("two cubes that overlap, as one body", lambda: import_mesh(tools, meshes.joined(meshes.box(), meshes.box(shift=(.5, .3, .2)))),
                      "1 pair of components passes through each other")
    out, _ = import_mesh(tools, meshes.joined(meshes.box(), meshes.box(shift=(.5, .3, .2))), "--surface")
    table.truth("the same as a wall", os.path.exists(out), "accepted")


@case("X17", "far from the origin")
def x17(tools, table):
    q = quaternion((.6, .5, .3), .9)
    states = {}
    for shift in (0.0, 1e3, 1e6, 1e9):
        # shifts that are sums of powers of two, so that the start itself is the same body at another place
        s = 0.0 if shift == 0 else 2.0 ** round(math.log2(shift))
        c = simple("X17", .05, 1e4, e=.5, mu=.3, density=1.0, step=1e-4, gravity=(0, 0, -G), margin=.015625, every=.01)
        c.mesh("box", meshes.box((1, .5, .75)))
        c.mesh("base", meshes.box((4, 4, 1)))
        c.body("base", "m", (s, s, -.5 + s), fixed=True)
        c.body("box", "m", (s, s, .75 + s), orientation=q, velocity=(.5, 0, -2))
        try:
            run = c.run(tools)
            states[shift] = run.x[:, 1] - s, run.v[:, 1], run.w[:, 1]
        except ToolError as error:
            table.refusal(f"moved by {shift:g} L", error)
    for shift, limit in ((1e3, 1e-9), (1e6, 1e-9), (1e9, 1e-6)):
        if shift in states and 0.0 in states:
            worst = max(numpy.abs(a - b).max() for a, b in zip(states[shift], states[0.0]))
            table.figure(f"impact moved by {shift:g} L: trajectory differs by", worst, limit)
    ends = {}
    for shift in (0.0, 2.0**20):
        c = simple("X17-plane", .05, 1e4, e=.5, density=1.0, step=1e-4, margin=.015625, every=.01)
        c.mesh("box", meshes.box((1, .5, .75)))
        c.floor(point=(0, 0, shift))
        c.body("box", "m", (shift, 0, .75 + shift), orientation=q, velocity=(.5, 0, -2))
        run = c.run(tools)
        ends[shift] = run.x[-1, 0] - [shift, 0, shift], run.v[-1, 0], run.w[-1, 0]
    table.figure("the same on a plane wall, 1e6 L away: differs by", max(numpy.abs(a - b).max() for a, b in zip(*ends.values())), 1e-9)


@case("X18", "other units: the same scene 1e-6 and 1e6 times as large")
def x18(tools, table):
    q = quaternion((.6, .5, .3), .9)
    ends = {}
    for power in (0, -20, 20):
        s = 2.0**power
        # lengths times s, density the same: masses s^3; with times kept, stiffness s^3 and gravity s
        c = simple("X18", .2, 1e4 * s**3, e=.5, mu=.3, density=1.0, step=1e-4, gravity=(0, 0, -G * s), margin=.01 * s, every=.05)
        c.mesh("rock", meshes.rock(3, 2))
        c.mesh("base", meshes.box((4, 4, 1)))
        c.body("base", "m", (0, 0, -.5 * s), fixed=True, scale=s)
        c.body("rock", "m", (0, 0, .75 * s), orientation=q, velocity=(.5 * s, 0, -1 * s), scale=s)
        try:
            run = c.run(tools)
            ends[power] = run.x[:, 1] / s, run.v[:, 1] / s, run.w[:, 1]
        except ToolError as error:
            table.refusal(f"times 2^{power}", error)
    for power in (-20, 20):
        if power in ends:
            table.figure(f"times 2^{power}: dimensionless results differ by", max(numpy.abs(a - b).max() for a, b in zip(ends[power], ends[0])), 1e-10)


@case("X19", "NaN, infinities, huge and empty input")
def x19(tools, table):
    off = lambda v, t: f"OFF\n{len(v)} {len(t)} 0\n" + "".join(f"{a} {b} {c}\n" for a, b, c in v) + "".join(f"3 {a} {b} {c}\n" for a, b, c in t)  # noqa: E731
    cube = meshes.box()
    vertices = [tuple(repr(float(x)) for x in v) for v in cube[0]]
    for name, value in (("NaN", "nan"), ("infinite", "inf"), ("1e308", "1e308")):
        bad = [(value, *vertices[0][1:]), *vertices[1:]]
        table.must_refuse(f"a vertex that is {name}", lambda bad=bad: import_mesh(tools, None, text=off(bad, cube[1])))
    table.must_refuse("a mesh without triangles", lambda: import_mesh(tools, None, text=off(vertices, [])))
    table.must_refuse("one triangle as a body", lambda: import_mesh(tools, None, text=off(vertices, cube[1][:1])))
    table.must_refuse("two triangles as a body", lambda: import_mesh(tools, None, text=off(vertices, cube[1][:2])))
    table.must_refuse("an empty file", lambda: import_mesh(tools, None, text=""))

    def scene(replace, by):
        c = simple("X19", .01, 1e4, e=.5, margin=.002, every=.01)
        c.mesh("cube", meshes.box((.1, .1, .1)))
        c.body("cube", "m", (0, 0, 1), velocity=(0, 0, -1))
        c.floor()
        path = c.write(tools)
        with open(path) as file:
            text = file.read()
        assert replace in text, replace
        with open(path, "w") as file:
            file.write(text.replace(replace, by))
        out = os.path.join(tools.scratch, "x19.scene.h5")
        tools.call("scree-decomposer", "pack", path, "-o", out)
        tools.call("scree-solver", out, "-o", os.path.join(tools.scratch, f"x19-{len(table.rows)}.run"))
    for name, replace, by in (("velocity inf", "velocity = [0, 0, -1]", "velocity = [0, 0, -inf]"), ("velocity nan", "velocity = [0, 0, -1]", "velocity = [nan, 0, 0]"),
                              ("velocity 1e308", "velocity = [0, 0, -1]", "velocity = [0, 0, -1e308]"),
                              ("density 0", "density = 1000.0", "density = 0.0"), ("density negative", "density = 1000.0", "density = -5.0"),
                              ("position 1e308", "position = [0, 0, 1]", "position = [0, 0, 1e308]"), ("stiffness nan", "stiffness = 10000.0", "stiffness = nan"),
                              ("stiffness inf", "stiffness = 10000.0", "stiffness = inf"), ("duration nan", "duration = 0.01", "duration = nan"),
                              ("quaternion 0", "position = [0, 0, 1]", "orientation = [0, 0, 0, 0]\nposition = [0, 0, 1]"),
                              ("density 1e-320 (denormal)", "density = 1000.0", "density = 1e-320")):
        table.must_refuse(name, lambda replace=replace, by=by: scene(replace, by))
    # a gap of the smallest positive number
    c = simple("X19-gap", .01, 1e4, e=.5, margin=.002, step=1e-5, every=.01)
    c.sphere("ball", .125)
    c.body("ball", "m", (0, 0, .125 + 5e-324))
    c.floor()
    try:
        run = c.run(tools)
        table.truth("gap of 5e-324 m", finite(run), "finite")
    except ToolError as error:
        table.refusal("gap of 5e-324 m", error)


@case("X24", "faces that touch exactly at the start")
def x24(tools, table):
    for relax in (False, True):
        for gap in (0.0, 1e-15, 1e-12, 1e-9):
            c = simple("X24", .001, 1e4, e=.5, margin=.002, step=1e-5, every=1e-4, contacts=True)
            if relax:
                c.tables["contact"]["relax"] = True
            c.mesh("cube", meshes.box((.125, .125, .125)))
            c.body("cube", "m", (0, 0, .0625 + .0625))
            c.body("cube", "m", (0, 0, .1875 + .0625 + gap))
            name = f"gap {gap:g} m between identical boxes{', with relax' if relax else ''}"
            try:
                run = c.run(tools)
                table.truth(name, finite(run), f"finite, overlap at most {run.max_depth_ratio:.3g} of the margins" + (", separated along the common normal" if relax else ""))
            except ToolError as error:
                table.refusal(name, error)


@case("X25", "aligned boxes slide on each other")
def x25(tools, table):
    mu, k, margin = .2, 1e6, .0005
    for width, name in ((.2, "on a wider box"), (.1, "flush with its edges")):
        c = simple("X25", .6, k, e=.3, mu=mu, gravity=(0, 0, -G), margin=margin, steps_per_contact=30, every=.004, contacts=True)
        c.mesh("base", meshes.box((2, width, .1)))
        c.mesh("block", meshes.box((.1, .1, .1)))
        c.body("base", "m", (0, 0, 0), fixed=True)
        # beside a wider box of larger margin, whose rounded edge lies further in, its four corners alone carry
        c.body("block", "m", (-.5, 0, .1 - G / (k * 4**.25)), velocity=(1.5, 0, 0), orientation=(1, 0, 0, 1e-16))
        run = c.run(tools)
        force, upward = [], 1.0
        for contacts in run.contacts[10:]:  # lies still
            force.append(contacts["tangential_force"].sum(axis=0))
            # a feature at the rim of its edge has next to no force, and what it has is from its weight that fades: along the edge, not out of it
            carries = contacts["normal_force"] > 1e-6 * G
            upward = min(upward, numpy.abs(contacts["normal"][carries, 2]).min())
        force = numpy.linalg.norm(force, axis=1)
        table.truth(f"{name}: finite", finite(run), "finite")
        # beside the edge of the base the gap of a corner leans outward: there the normal may turn, but not flip
        table.figure(f"{name}: normals lean by [rad]", math.acos(min(1.0, upward)), 1e-6 if width > .1 else .3)
        table.figure(f"{name}: friction over mu m g - 1, worst", numpy.abs(force / (mu * G) - 1).max(), 2e-2)
        table.figure(f"{name}: speed lost against mu g t", abs((1.5 - run.v[-1, 1, 0]) / (mu * G * run.times[-1]) - 1), 1e-3)


@case("X26", "gap that flickers around the margins")
def x26(tools, table):
    R, margin, k = .5, .01, 1e6
    c = simple("X26", .2, k, e=.5, mu=.5, step=1e-4, margin=margin, every=.001, contacts=True, density=1000.0)
    c.sphere("ball", R)
    c.body("ball", "m", (0, 0, R), velocity=(.1, 0, 0))
    c.floor(motion={"oscillate": {"direction": [0, 0, 1], "amplitude": 1e-12, "frequency": 333.0, "phase": 0}})
    run = c.run(tools)
    table.truth("finite", finite(run), "finite")
    change = numpy.linalg.norm(numpy.diff(run.v[:, 0], axis=0), axis=1).max() * 1000 * 4 / 3 * math.pi * R**3 / .001
    table.figure("largest mean force of 10 steps over k times the margins", change / (k * 2 * margin), 1e-9)
