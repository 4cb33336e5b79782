"""Inputs for LIGGGHTS and LAMMPS, and what they say: plain spheres, clumps of 14 spheres, rounded polyhedra.

Spheres and clumps are other bodies than the rocks, so they settle by themselves in a box of the same floor; the polyhedra of
LAMMPS start from the same state as everybody. Lengths of LAMMPS's polyhedra are in centimetres, masses in those of one body:
its body styles are known to fail at lengths far from 1.
"""
import math

import scene

R = scene.RADIUS
MASS = scene.DENSITY * 4 / 3 * math.pi * R ** 3


def dashpot(stiffness, mass, restitution):
    """Damping of a linear spring with this restitution."""
    logarithm = math.log(restitution)
    ratio = -logarithm / math.sqrt(math.pi ** 2 + logarithm ** 2)
    return 2 * ratio * math.sqrt(stiffness * mass)


def planes(length):
    return (("zplane", 0.0), ("xplane", 0.0), ("xplane", length), ("yplane", 0.0), ("yplane", length))


def liggghts_head(length, height):
    return f"""units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block {-0.1 * R} {length + 0.1 * R} {-0.1 * R} {length + 0.1 * R} {-0.1 * R} {height} units box
create_box 1 box
neighbor {0.3 * R} bin
neigh_modify delay 0
"""


def liggghts_physics(length):
    walls = "".join(f"fix w{i} all wall/gran model hertz tangential history primitive type 1 {axis} {at}\n"
                    for i, (axis, at) in enumerate(planes(length)))
    return f"""fix m1 all property/global youngsModulus peratomtype {scene.YOUNG}
fix m2 all property/global poissonsRatio peratomtype {scene.POISSON}
fix m3 all property/global coefficientRestitution peratomtypepair 1 {scene.RESTITUTION}
fix m4 all property/global coefficientFriction peratomtypepair 1 {scene.FRICTION}
pair_style gran model hertz tangential history
pair_coeff * *
fix grav all gravity {scene.GRAVITY} vector 0.0 0.0 -1.0
{walls}"""


def lattice_of_spheres(state):
    lines = "".join(f"create_atoms 1 single {row[1]!r} {row[2]!r} {row[3]!r} units box\n" for row in state)
    return lines + f"set group all diameter {2 * R}\nset group all density {scene.DENSITY}\n"


def timed_run(settle, steps, dump):
    """Settles, then runs the steps that count, then writes where everything is."""
    return f"""timestep {scene.STEP}
thermo 100000
run {settle}
run {steps}
dump end all custom 1 end.dump {dump}
run 0
"""


def liggghts_spheres(state, length, height, settle, steps):
    return (liggghts_head(length, height) + lattice_of_spheres(state) + liggghts_physics(length) + "fix move all nve/sphere\n"
            + timed_run(settle, steps, "id x y z vx vy vz omegax omegay omegaz radius"))


def clump():
    """14 spheres in the shape of a rock with axes 1, 0.85, 0.7: [x, y, z, radius]."""
    spheres = [(0.0, 0.0, 0.0, 0.68 * R)]
    axes = (R, 0.85 * R, 0.7 * R)
    for i in range(13):  # a spiral of points over the ellipsoid
        z = 1 - 2 * (i + 0.5) / 13
        angle = i * math.pi * (3 - math.sqrt(5))
        ring = math.sqrt(1 - z * z)
        spheres.append((0.62 * axes[0] * ring * math.cos(angle), 0.62 * axes[1] * ring * math.sin(angle), 0.62 * axes[2] * z, 0.38 * R))
    return spheres


def liggghts_clumps(count, length, height, settle, steps):
    """Needs clump.txt beside it. Seeds must be primes above 10000."""
    return (liggghts_head(length, height).replace("newton off", "newton off\nhard_particles yes") + liggghts_physics(length)
            + f"""fix pt all particletemplate/multisphere 15485863 atom_type 1 density constant {scene.DENSITY} nspheres {len(clump())} ntry 200000 spheres file clump.txt scale 1.0 type 1
fix pd all particledistribution/discrete 32452843 1 pt 1.0
region fill block 0 {length} 0 {length} 0 {0.9 * height} units box
fix ins all insert/pack seed 32452867 distributiontemplate pd maxattempt 500 insert_every once overlapcheck yes orientation random all_in yes particles_in_region {count} region fill
fix move all multisphere
""" + timed_run(settle, steps, "id x y z vx vy vz id_multisphere radius"))


def lammps_spheres(state, length, height, settle, steps):
    # 4/3 of the effective modulus, as in LIGGGHTS and Scree; a restitution near 0.3 at an overlap of 1 % of the radius
    stiffness, damping = 2 * scene.YOUNG / (3 * (1 - scene.POISSON**2)), 1.2e6
    model = f"hertz/history {stiffness} NULL {damping} NULL {scene.FRICTION} 1"
    walls = "".join(f"fix w{i} all wall/gran {model} {axis} {at} NULL\n" if axis == "zplane" else "" for i, (axis, at) in enumerate(planes(length)))
    walls += f"fix wx all wall/gran {model} xplane 0.0 {length}\nfix wy all wall/gran {model} yplane 0.0 {length}\n"
    return f"""units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
region box block 0 {length} 0 {length} 0 {height} units box
create_box 1 box
""" + lattice_of_spheres(state) + f"""pair_style gran/{model}
pair_coeff * *
neighbor {0.3 * R} bin
neigh_modify every 1 delay 0 check yes
fix move all nve/sphere
fix grav all gravity {scene.GRAVITY} vector 0 0 -1
{walls}""" + timed_run(settle, steps, "id x y z vx vy vz omegax omegay omegaz radius")


def lammps_polyhedra(state, length, height, shapes, inertia, steps):
    """Data file and input of body/rounded/polyhedron from a state. shapes: [(vertices, triangles)], inertia: moments [kg m^2]."""
    cm = 100.0
    data = [f"rocks\n\n{len(state)} atoms\n{len(state)} bodies\n1 atom types\n0 {length * cm} xlo xhi\n0 {length * cm} ylo yhi\n"
            f"0 {height * cm} zlo zhi\n\nAtoms\n\n"]
    velocities = ["\nVelocities\n\n"]
    bodies = ["\nBodies\n\n"]
    for i, row in enumerate(state):
        vertices, triangles = shapes[row[0]]
        turn = scene.rotation_matrix(row[4:8])
        tensor = [[sum(turn[a][c] * inertia[row[0]][c] * turn[b][c] for c in range(3)) * cm * cm / MASS for b in range(3)] for a in range(3)]
        spin = row[11:14]
        momentum = [sum(tensor[a][b] * spin[b] for b in range(3)) for a in range(3)]
        data.append(f"{i + 1} 1 1 1.0 " + " ".join(repr(x * cm) for x in row[1:4]) + "\n")
        velocities.append(f"{i + 1} " + " ".join(repr(v * cm) for v in row[8:11]) + " " + " ".join(repr(x) for x in momentum) + "\n")
        edges = sorted({(min(a, b), max(a, b)) for t in triangles for a, b in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))})
        words = [f"{x:.9g}" for x in (tensor[0][0], tensor[1][1], tensor[2][2], tensor[0][1], tensor[0][2], tensor[1][2])]
        words += [f"{sum(turn[a][b] * v[b] for b in range(3)) * cm:.9g}" for v in vertices for a in range(3)]
        words += [str(x) for e in edges for x in e] + [str(x) for t in triangles for x in t + (-1,)] + [f"{2 * scene.MARGIN * cm:.9g}"]
        bodies.append(f"{i + 1} 3 {len(words)}\n{len(vertices)} {len(edges)} {len(triangles)}\n")
        line = ""  # LAMMPS reads 255 characters a line, 32 lines a body
        for word in words:
            if len(line) + len(word) > 240:
                bodies.append(line + "\n")
                line = ""
            line += word + " "
        bodies.append(line + "\n")
    stiffness = scene.STIFFNESS / MASS
    damping = dashpot(stiffness, 0.5, scene.RESTITUTION)
    wall = f"wall/body/polyhedron {stiffness:.6g} {damping:.6g} {damping / 2:.6g}"
    dump = "id x y z vx vy vz c_q[1] c_q[2] c_q[3] c_q[4] c_q[5] c_q[6] c_q[7]"
    text = f"""units lj
boundary fm fm fm
comm_modify vel yes
atom_style body rounded/polyhedron 1 {max(len(v) for v, _ in shapes) * 5}
atom_modify map array
read_data rocks.data
pair_style body/rounded/polyhedron {damping:.6g} {damping / 2:.6g} {scene.FRICTION} 1 0.05
pair_coeff * * {stiffness:.6g} 0
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {scene.STEP}
fix 1 all nve/body
fix 2 all gravity {scene.GRAVITY * cm} vector 0 0 -1
fix 3 all {wall} zplane 0.0 NULL
fix 4 all {wall} xplane 0.0 {length * cm}
fix 5 all {wall} yplane 0.0 {length * cm}
compute q all property/atom quatw quati quatj quatk angmomx angmomy angmomz
thermo 100000
dump start all custom 1 start.dump {dump}
run 0
undump start
run {steps}
dump end all custom 1 end.dump {dump}
run 0
"""
    return "".join(data + velocities + bodies), text


def read_dump(path):
    """Rows of the last snapshot of a dump file, ordered by id."""
    lines = open(path).read().splitlines()
    start = max(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    return sorted(([float(w) for w in line.split()] for line in lines[start + 1:]), key=lambda row: row[0])


def body_of_dump(row, first, body, inertia):
    """Row of a state from the dumps at the end and at the start (id x y z vx vy vz quaternion angular momentum, cm, masses of a body).

    LAMMPS turns a body to its own principal axes when it reads it, so only the turn since the start is taken from it."""
    cm = 100.0
    now, then = row[7:11], first[7:11]
    turned = multiply(now, [then[0], -then[1], -then[2], -then[3]])
    q = multiply(turned, body[4:8])
    turn = scene.rotation_matrix(q)
    momentum = [x * MASS / cm ** 2 for x in row[11:14]]
    local = [sum(turn[j][i] * momentum[j] for j in range(3)) / inertia[body[0]][i] for i in range(3)]
    spin = [sum(turn[i][j] * local[j] for j in range(3)) for i in range(3)]
    return [body[0]] + [x / cm for x in row[1:4]] + q + [v / cm for v in row[4:7]] + spin


def multiply(p, q):
    """Product of two quaternions w x y z."""
    return [p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]]


def judge_spheres(rows, length, moving_mass, owner=None):
    """Deepest overlap over R and kinetic energy per body over m g R. rows: id x y z vx vy vz ... radius; owner: column of the clump."""
    deepest = 0.0
    width = 2 * max(row[-1] for row in rows)
    cells = {}   # spheres that overlap lie in the same or in neighbouring cells
    for a in rows:
        deepest = max(deepest, a[-1] - a[1], a[1] + a[-1] - length, a[-1] - a[2], a[2] + a[-1] - length, a[-1] - a[3])
        cell = tuple(math.floor(a[k] / width) for k in (1, 2, 3))
        for x in (-1, 0, 1):
            for y in (-1, 0, 1):
                for z in (-1, 0, 1):
                    for b in cells.get((cell[0] + x, cell[1] + y, cell[2] + z), ()):
                        if owner is not None and a[owner] == b[owner]:
                            continue
                        gap2 = sum((a[k] - b[k]) ** 2 for k in (1, 2, 3))
                        if gap2 < (a[-1] + b[-1]) ** 2:
                            deepest = max(deepest, a[-1] + b[-1] - math.sqrt(gap2))
        cells.setdefault(cell, []).append(a)
    kinetic = sum(0.5 * moving_mass * sum(v * v for v in row[4:7]) for row in rows) / len(rows)
    return {"depth_share": deepest / R, "kinetic_share": kinetic / (moving_mass * scene.GRAVITY * R)}
