"""Cases that must give the same run in other words: moved, turned by right angles, mirrored, in other units, in another order, with split faces.

All of them want a case whose bodies are placed one by one: frozen() turns what the decomposer placed into such.
"""
import math

import numpy

from dimensions import in_other_units
from model import Case, Mesh
from tools import NotApplicable

TURNED_BY_PLACE = ("file", "hopper", "drum", "plate", "disc", "box", "cone", "cylinder", "trough", "screw", "paddles")   # walls that are meshes


def is_cut(case):
    """Whether bodies start as pieces."""
    return any("pieces" in shape for shape in case.words.get("shapes", {}).values())


def frozen(case, scene):
    """Every body of the scene in [[bodies]], in the order of their ids, with the margin and speed that the decomposer chose. Bodies that are cut stay
    as the case has them."""
    result = case.copy()
    if is_cut(case):
        if case.populations:
            raise NotApplicable("populations beside a body that is cut")
        return with_margins(result, scene)
    result.words.pop("populations", None)
    rows = {name: scene.body(name) for name in scene.bodies}
    result.words["bodies"] = []
    for i in range(scene.count):
        body = {"shape": scene.shapes[rows["shape"][i]]["name"], "material": scene.materials[rows["material"][i]]["name"],
                "position": rows["position"][i].tolist(), "orientation": rows["orientation"][i].tolist()}
        if rows["scale"][i] != 1:
            body["scale"] = float(rows["scale"][i])
        if rows["fixed"][i]:
            body["fixed"] = True
        else:
            body |= {"velocity": rows["velocity"][i].tolist(), "angular_velocity": rows["angular_velocity"][i].tolist()}
        if rows["lock_rotation"][i]:
            body["lock_rotation"] = True
        result.words["bodies"].append(body)
    return with_margins(result, scene)


def with_margins(result, scene):
    contact = result.table("contact")
    contact.pop("margin", None)
    contact.pop("margin_ratio", None)
    # what the scene has to the last bit
    key = "margin_ratio" if scene.general.get("margin_ratio", 0) > 0 else "margin"
    contact[key], contact["relax"] = scene.general[key], False
    if scene.general.get("impact_speed", 0) > 0:
        contact["impact_speed"] = scene.general["impact_speed"]
    return result


def product(p, q):
    a, u = p[0], numpy.array(p[1:])
    b, v = q[0], numpy.array(q[1:])
    return [float(a * b - u @ v), *(a * v + b * u + numpy.cross(u, v)).tolist()]


def quaternion_of(matrix):
    """Unit quaternion w x y z of a proper rotation matrix."""
    m = numpy.asarray(matrix, float)
    squares = [1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]]
    k = int(numpy.argmax(squares))
    s = 2 * math.sqrt(squares[k])
    if k == 0:
        return [s / 4, (m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s]
    if k == 1:
        return [(m[2, 1] - m[1, 2]) / s, s / 4, (m[0, 1] + m[1, 0]) / s, (m[0, 2] + m[2, 0]) / s]
    if k == 2:
        return [(m[0, 2] - m[2, 0]) / s, (m[0, 1] + m[1, 0]) / s, s / 4, (m[1, 2] + m[2, 1]) / s]
    return [(m[1, 0] - m[0, 1]) / s, (m[0, 2] + m[2, 0]) / s, (m[1, 2] + m[2, 1]) / s, s / 4]


def right_angle_turns():
    """The 24 turns that bring the axes onto each other, the one that leaves all in place last."""
    found = []
    for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
        for signs in range(8):
            m = numpy.zeros((3, 3))
            for row, axis in enumerate(order):
                m[row, axis] = -1 if signs >> row & 1 else 1
            if round(numpy.linalg.det(m)) == 1:
                found.append(m)
    return sorted(found, key=lambda m: bool((m == numpy.eye(3)).all()))


class Placement:
    """x -> turn (mirror x) + shift: mirror is the identity or diag(-1, 1, 1), turn proper."""

    def __init__(self, turn=numpy.eye(3), shift=(0, 0, 0), mirrored=False):
        self.turn, self.shift, self.mirrored = numpy.asarray(turn, float), numpy.asarray(shift, float), mirrored
        self.flip = numpy.diag([-1.0 if mirrored else 1.0, 1, 1])
        self.matrix = self.turn @ self.flip
        self.sign = -1.0 if mirrored else 1.0
        self.quat = quaternion_of(self.turn)

    def point(self, p):
        return (clean(self.matrix @ numpy.asarray(p, float)) + self.shift).tolist()

    def vector(self, v):
        return clean(self.matrix @ numpy.asarray(v, float)).tolist()

    def spin(self, w):
        """Of an axial vector."""
        return clean(self.sign * (self.matrix @ numpy.asarray(w, float))).tolist()

    def orientation(self, q):
        """Of a body whose mesh is mirrored too."""
        w, x, y, z = q
        if self.mirrored:
            y, z = -y, -z
        return [w, x, y, z] if (self.turn == numpy.eye(3)).all() else product(self.quat, [w, x, y, z])

    def box(self, corners):
        a, b = numpy.array(self.point(corners[0])), numpy.array(self.point(corners[1]))
        return [numpy.minimum(a, b).tolist(), numpy.maximum(a, b).tolist()]

    def axis(self, name):
        return "xyz"[int(numpy.argmax(numpy.abs(self.matrix[:, "xyz".index(name)])))]


def clean(v):
    return v + 0.0  # no negative zeros


def placed(case, how):
    """The whole case elsewhere."""
    if case.populations:
        raise NotApplicable("populations are placed anew elsewhere")
    if case.words.get("inlets") or case.words.get("outlets"):
        raise NotApplicable("bodies come in and leave at places of their own")
    result = case.copy()
    words = result.words
    words["gravity"] = how.vector(case.gravity)
    if "domain" in words and "min" in words["domain"]:
        words["domain"]["min"], words["domain"]["max"] = how.box([words["domain"]["min"], words["domain"]["max"]])
        if "periodic" in words["domain"]:
            words["domain"]["periodic"] = [how.axis(name) for name in words["domain"]["periodic"]]
            if "cell" in words and sorted(words["domain"]["periodic"]) not in (["x", "y"], ["x", "y", "z"]):
                raise NotApplicable("planes of a cell are across z")
    for key in ("strain_rate", "stress"):
        if key in words.get("cell", {}):
            words["cell"][key] = placed_cell(words["cell"][key], how)
    if "velocity" in words.get("fluid", {}):
        words["fluid"]["velocity"] = how.vector(words["fluid"]["velocity"])
    for body in words.get("bodies", []):
        body["position"] = how.point(body["position"])
        body["orientation"] = how.orientation(body.get("orientation", [1, 0, 0, 0]))
        for key, map_of in (("velocity", how.vector), ("angular_velocity", how.spin)):
            if key in body:
                body[key] = map_of(body[key])
    if how.mirrored:
        result.meshes = {name: mirrored_mesh(mesh) for name, mesh in case.meshes.items()}
    for wall in words.get("walls", []):
        place_wall(wall, how)
    return result


def placed_cell(part, how):
    """Of each component; a shear changes its sign with one of its axes. Only upper triangular cells can be written."""
    found = {}
    for name, value in part.items():
        if len(name) == 1:
            found[how.axis(name)] = value
            continue
        to = how.axis(name[0]) + how.axis(name[1])
        if to not in ("yz", "xz", "xy"):
            raise NotApplicable("a shear of the cell would be below the diagonal")
        turned = [how.matrix["xyz".index(new), "xyz".index(old)] for new, old in zip(to, name)]
        sign = float(turned[0] * turned[1])
        found[to] = {**value, "rate": [sign * rate for rate in value["rate"]]} if isinstance(value, dict) else sign * value
    return found


def mirrored_mesh(mesh):
    return Mesh(mesh.vertices * [-1, 1, 1] + 0.0, mesh.triangles[:, [0, 2, 1]], mesh.surface)


def turn_motion(motion, how):
    if "rotate" in motion:
        motion["rotate"]["axis"] = how.spin(motion["rotate"]["axis"])
        motion["rotate"]["centre"] = how.point(motion["rotate"].get("centre", [0, 0, 0]))
    if "translate" in motion:
        motion["translate"]["velocity"] = how.vector(motion["translate"]["velocity"])
    if "oscillate" in motion:
        motion["oscillate"]["direction"] = how.vector(motion["oscillate"]["direction"])
    if "table" in motion:
        motion["table"]["position"] = [how.vector(p) for p in motion["table"]["position"]]
    for word, ways, spins, points in (("servo", ["direction"], ["axis"], ["centre"]), ("outer", ["direction"], ["axis"], ["centre"]),
                                      ("free", ["guide"], ["hinge"], ["centre", "mass_centre"]), ("motor", [], ["axis"], ["centre"])):
        if word not in motion:
            continue
        for key in ways:
            if key in motion[word]:
                motion[word][key] = how.vector(motion[word][key])
        for key in spins:
            if key in motion[word]:
                motion[word][key] = how.spin(motion[word][key])
                for point in points:
                    motion[word][point] = how.point(motion[word].get(point, [0, 0, 0]))


def place_wall(wall, how):
    kind, shape = next(iter(wall["shape"].items()))
    if kind == "plane":
        shape["point"], shape["normal"] = how.point(shape["point"]), how.vector(shape["normal"])
    elif kind == "box_inside":
        wall["shape"][kind] = how.box(shape)
    elif kind == "cylinder_inside":
        shape["start"], shape["end"] = how.point(shape["start"]), how.point(shape["end"])
    elif kind == "sphere_inside":
        shape["centre"] = how.point(shape["centre"])
    else:
        if how.mirrored and kind != "file":
            mirror_form(wall, kind, shape)
        wall["position"] = how.point(wall.get("position", [0, 0, 0]))
        wall["orientation"] = how.orientation(wall.get("orientation", [1, 0, 0, 0]))
    motions = wall.get("motion", [])
    for motion in motions if isinstance(motions, list) else [motions]:
        turn_motion(motion, how)
    surface = wall.get("surface", {})
    if "velocity" in surface:
        surface["velocity"] = how.vector(surface["velocity"])
    if "rate" in surface:
        surface["axis"], surface["centre"] = how.spin(surface["axis"]), how.point(surface.get("centre", [0, 0, 0]))


def mirror_form(wall, kind, shape):
    """A form in its own axes, mirrored in x. Round forms are polygons, whose corners stand where the tool puts them: those that are not their own
    mirror image in x say nothing."""
    flip = numpy.array([-1.0, 1, 1])
    if kind == "plate":
        for key in ("corner", "side_a", "side_b"):
            shape[key] = (numpy.array(shape[key]) * flip + 0.0).tolist()
        shape["side_a"], shape["side_b"] = shape["side_b"], shape["side_a"]   # the same side faces up
    elif kind == "box":
        corners = numpy.array(shape["corners"]) * flip + 0.0
        shape["corners"] = [corners.min(axis=0).tolist(), corners.max(axis=0).tolist()]
        shape["open"] = [{"-x": "+x", "+x": "-x"}.get(side, side) for side in shape.get("open", [])]
        if not shape["open"]:
            del shape["open"]
    elif kind == "trough" and shape["start"][1:] == [0, 0] == shape["end"][1:]:
        shape["start"][0], shape["end"][0] = -shape["end"][0], -shape["start"][0]
        if "open" in shape:
            shape["open"] = [{"start": "end", "end": "start"}[side] for side in shape["open"]]
    elif kind == "hopper" and (isinstance(shape["outlet"], list) or shape.get("segments", 64) % 4 == 0):
        pass
    else:
        raise NotApplicable(f"a {kind} need not be its own mirror image")


def in_units(case, length, mass, time):
    result = Case(in_other_units(case.words, length, mass, time), {name: Mesh(mesh.vertices * length, mesh.triangles, mesh.surface)
                                                                     for name, mesh in case.meshes.items()}, case.note)
    if "gravity" not in case.words:
        result.words["gravity"] = (case.gravity * length / time**2).tolist()
    return result


def reordered(case, order):
    if case.populations:
        raise NotApplicable("populations have an order of their own")
    result = case.copy()
    result.words["bodies"] = [case.bodies[i] for i in order]
    return result


def split_mesh(mesh, random, share=0.4):
    """Edges cut in the middle, with the triangles on both sides: the same surface. Middles must be exact (solids.clean_mesh sees to it)."""
    vertices, triangles = mesh.vertices.tolist(), [tuple(t) for t in mesh.triangles]
    edges = sorted({tuple(sorted((t[k], t[(k + 1) % 3]))) for t in triangles for k in range(3)})
    random.shuffle(edges)
    for a, b in edges[:max(1, int(share * len(edges)))]:
        middle = len(vertices)
        vertices.append([(p + q) / 2 for p, q in zip(vertices[a], vertices[b])])
        for i in range(len(triangles)):
            t = triangles[i]
            for k in range(3):
                if {t[k], t[(k + 1) % 3]} == {a, b}:
                    triangles[i] = (t[k], middle, t[(k + 2) % 3])
                    triangles.append((middle, t[(k + 1) % 3], t[(k + 2) % 3]))
                    break
    return Mesh(vertices, triangles, mesh.surface)


def with_split_faces(case, random):
    result = case.copy()
    result.meshes = {name: split_mesh(mesh, random) for name, mesh in sorted(case.meshes.items())}
    return result


def disturbed(case, random, amount, size):
    """A twin: every body that moves a rounding away, by up to `amount` [m] along each axis. With one spring per pair of triangles bodies of
    that `size` [m] also turn by as much: an edge parallel to a face then touches at the end that rounding chooses (CASE.md, `gather`)."""
    result = case.copy()
    turns = case.value("contact", "gather") == "pairs"
    for body in result.bodies:
        if not body.get("fixed"):
            body["position"] = [x + amount * random.uniform(-1, 1) for x in body["position"]]
            if turns:
                body["orientation"] = [q + amount / size * random.uniform(-1, 1) for q in body.get("orientation", [1, 0, 0, 0])]
    return result
