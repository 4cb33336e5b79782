"""A mesh is the same shape from any file format that holds it."""
import h5py
import numpy

from relations import NotApplicable, relation, require


def one_vertex_moved(shape):
    shape["vertices"][0] *= 1.001


@relation("sums", one_vertex_moved)
def any_mesh_format(trial):
    """A mesh is the same shape from any file format that holds it, comments and units included."""
    if not trial.case.meshes:
        raise NotApplicable("no meshes")
    name = trial.random.choice(sorted(trial.case.meshes))
    mesh = trial.case.meshes[name]
    kind = trial.random.choice(sorted(FORMATS))
    path = trial.tools.new_path(FORMATS[kind][0])
    with open(path, "wb") as file:
        file.write(FORMATS[kind][1](mesh))
    out = trial.tools.new_path(".shape.h5")
    code, _, err = trial.tools.call("scree-mesher", "import", path, "-o", out, *(["--surface"] if mesh.surface else []))
    require(code == 0, f"import of {name} as {kind} ends with {code}: {err.strip()[-500:]}")
    first, second = read_shape(trial.tools.mesh_file(mesh)), read_shape(out)
    trial.seen(second)
    size = numpy.abs(first["vertices"]).max()
    require(len(first["vertices"]) == len(second["vertices"]) and len(first["triangles"]) == len(second["triangles"]),
            f"{name} as {kind}: {len(second['vertices'])} vertices, {len(second['triangles'])} triangles; as OFF {len(first['vertices'])}, {len(first['triangles'])}")
    require(abs(first["volume"] - second["volume"]) <= 1e-12 * size**3, f"{name} as {kind}: volume {second['volume']}, as OFF {first['volume']}")
    far = max(numpy.linalg.norm(second["vertices"] - v, axis=1).min() for v in first["vertices"])
    require(far <= 1e-12 * size, f"{name} as {kind}: a vertex is {far:.3g} m from where it is as OFF")


def off_with_comments(mesh):
    lines = mesh.off().splitlines()
    count = len(mesh.vertices)
    return ("\n".join(["OFF", "# a comment", lines[1], "", *lines[2:2 + count], "# the facets", *lines[2 + count:], "# the end", ""])).encode()


def stl_text(mesh):
    lines = ["solid s"]
    for t in mesh.triangles:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex %.17g %.17g %.17g" % tuple(mesh.vertices[v]) for v in t), "endloop", "endfacet"]
    return ("\n".join([*lines, "endsolid s", ""])).encode()


def stl_binary(mesh):
    rows = numpy.zeros(len(mesh.triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows["corners"] = mesh.vertices[mesh.triangles]
    return b"binary".ljust(80) + numpy.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes()


def obj(mesh):
    return ("# a comment\n" + "".join("v %.17g %.17g %.17g\n" % tuple(v) for v in mesh.vertices) + "s off\n" +
            "".join("f %d %d %d\n" % tuple(t + 1) for t in mesh.triangles)).encode()


def ply_head(mesh, kind):
    return (f"ply\nformat {kind} 1.0\ncomment a comment\nelement vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(mesh.triangles)}\nproperty list uchar int vertex_indices\nend_header\n").encode()


def ply_text(mesh):
    return ply_head(mesh, "ascii") + ("".join("%.17g %.17g %.17g\n" % tuple(v) for v in mesh.vertices) + "".join("3 %d %d %d\n" % tuple(t) for t in mesh.triangles)).encode()


def ply_binary(mesh):
    faces = numpy.zeros(len(mesh.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.triangles
    return ply_head(mesh, "binary_little_endian") + mesh.vertices.astype("<f8").tobytes() + faces.tobytes()


FORMATS = {"OFF with comments": (".off", off_with_comments), "STL as text": (".stl", stl_text), "binary STL": (".stl", stl_binary), "OBJ": (".obj", obj),
           "PLY as text": (".ply", ply_text), "binary PLY": (".ply", ply_binary)}


def read_shape(path):
    with h5py.File(path, "r") as file:
        group = file["shapes/shape_0000"]
        return {"vertices": group["vertices"][()], "triangles": group["triangles"][()], "volume": float(group.attrs["volume"])}
