"""W: what walls bear: load maps and wear."""
import math

import numpy

import meshes
from registry import case_of
from scene import Case, rotated

CASES = []
case = case_of(CASES)

G = 9.81


def areas_and_middles(mesh):
    corners = mesh[0][mesh[1]]
    return 0.5 * numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1), corners.mean(axis=1)


def between(run, first, last, name):
    """What happened to each triangle from one frame to another."""
    return run.loads[last][name] - run.loads[first][name]


@case("W1", "U", "rocks shaken in a meshed bowl", "sum of a load map = impulse on its wall")
def w1(tools, report):
    bowl = meshes.transformed(meshes.box((0.12, 0.12, 0.08), n=4), numpy.eye(3), (0, 0, 0.04))
    vertices, triangles = bowl
    top = vertices[triangles][:, :, 2].min(axis=1) > 0.0799
    bowl = vertices, triangles[~top][:, ::-1]   # open above, facing inwards
    shake = {"oscillate": {"direction": [1, 0, 2], "amplitude": 2e-3, "frequency": 20}}
    turn = {"rotate": {"axis": [0, 1, 0], "centre": [0, 0, 0.04], "rate": 3.0}}
    for name, motion in (("shaken", shake), ("turned", turn)):
        c = Case(f"W1{name[0]}", duration=0.3, step=2e-5, every=0.02, gravity=(0, 0, -G), margin=3e-4, seed=5)
        c.mesh("rock", meshes.transformed(meshes.rock(3, 1), numpy.eye(3) * 0.02))
        c.sphere("ball", 0.008)
        c.material("m", 2000.0)
        c.pair_all(stiffness=2e5, restitution=0.4, friction=0.5, rolling_friction=0.02)
        for shape in ("rock", "ball"):
            c.population(shape=shape, material="m", count=12, region={"box": [[-0.05, -0.05, 0.005], [0.05, 0.05, 0.075]]})
        c.mesh_wall(bowl, "m", load_map=True, motion=motion)
        if name == "turned":   # nothing may fall out
            c.wall({"box_inside": [[-0.3, -0.3, -0.3], [0.3, 0.3, 0.4]]}, "m")
        run = report.run(c.run(tools))
        impulse = run.wall_column(0, "impulse")
        # the step divides the interval of frames by ten times a whole number: a row of the log is at each frame
        rows = abs(run.log["time"][None, :] - run.times[:, None]).argmin(axis=1)
        scale = abs(impulse).max()
        if name == "shaken":
            total = numpy.array([f["impulse"].sum(axis=0) for f in run.loads])
            report.at_most("shaken: sum of the map against the impulse in the log, over the largest", abs(total - impulse[rows]).max() / scale, 1e-12)
        else:
            # the map goes round with the wall: turned back at the middle of each interval, to the second order in the angle of one
            steps = []
            for k in range(1, len(run.loads)):
                middle = run.wall_orientation[k - 1][0] + run.wall_orientation[k][0]
                steps.append(rotated(middle / numpy.linalg.norm(middle), between(run, k - 1, k, "impulse").sum(axis=0)) -
                             (impulse[rows[k]] - impulse[rows[k - 1]]))
            report.at_most("turned: the same in the world, over the largest", abs(numpy.array(steps)).max() / scale, 2e-3)
        last = run.loads[-1]
        report.at_least(f"{name}: contacts that began", last["contacts"].sum(), 20)
        report.at_least(f"{name}: least sliding work of a triangle in an interval [J]",
                        min(between(run, k - 1, k, "sliding_work").min() for k in range(1, len(run.loads))) + 1e-15, 1e-15)
        lost = last["sliding_work"].sum() + last["damping_work"].sum()
        report.at_most(f"{name}: what the walls' contacts took, over all that was dissipated", lost / run.log["dissipated"][-1], 1 + 1e-3)


@case("W2", "U", "a block at rest on a fine plate", "centre of pressure under the centre of mass; m g")
def w2(tools, report):
    n, cell = 12, 0.01
    plate = meshes.plate(n * cell, n)
    area, middle = areas_and_middles(plate)
    low = middle[:, :2] - numpy.floor(middle[:, :2] / cell) * cell
    upper = low[:, 1] > low[:, 0]   # of the two triangles of a cell
    chosen = middle[upper]
    # a wedge whose four lower corners lie over the middles of triangles, and whose centre of mass is not in the middle
    x0, y0 = chosen[:, 0].min() + 2 * cell, chosen[:, 1].min() + 3 * cell
    x1, y1 = x0 + 6 * cell, y0 + 4 * cell
    wedge = meshes.prism([(0, 0), (x1 - x0, 0), (x1 - x0, 0.01), (0, 0.05)], y1 - y0)   # extruded along z: turned below
    turn = numpy.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)
    wedge = meshes.transformed(wedge, turn)
    volume, centre, _ = meshes.mass_properties(wedge)
    lowest = wedge[0][wedge[0][:, 2] < 1e-9]
    density, stiffness, margin = 2000.0, 4e5, 4e-4
    mass = density * volume
    # its corners stand on the middles of triangles where they are not rounded
    c = Case("W2", duration=0.6, every=0.2, gravity=(0, 0, -G), margin=margin, contact={"surface": "outside"})
    c.mesh("wedge", wedge)
    c.material("m", density)
    c.pair_all(stiffness=stiffness, restitution=0.2, friction=0.5)
    shift = numpy.array([x0, y0]) - lowest[:, :2].min(axis=0)
    c.body("wedge", "m", (centre[0] + shift[0], centre[1] + shift[1], centre[2] + 2 * margin - 1e-6))
    c.mesh_wall(plate, "m", load_map=True)
    run = report.run(c.run(tools))
    push = -between(run, -2, -1, "impulse")
    held = run.times[-1] - run.times[-2]
    report.check("mean force [N]", push[:, 2].sum() / held, mass * G, 1e-6)
    report.check("triangles that bear it", (push[:, 2] > 1e-9 * mass).sum(), 4, 0)
    pressure = (push[:, 2][:, None] * middle[:, :2]).sum(axis=0) / push[:, 2].sum()
    size = math.hypot(x1 - x0, y1 - y0)
    # the corners stand on the plate's triangles but not quite on their middles: it settles by a micrometre, and its mesh is rounded
    report.at_most("centre of pressure from under the centre of mass, over the size of the block",
                   numpy.linalg.norm(pressure - run.x[-1, 0, :2]) / size, 1e-6)
    report.check("contacts that began, in all", run.loads[-1]["contacts"].sum(), 0, 1e-12, "absolute")
    report.at_most("sliding work while it rests, over m g times a margin", between(run, -2, -1, "sliding_work").sum() / (mass * G * margin), 1e-9)


@case("W3", "U", "one impact on an edge between triangles", "m v^2 / 2 in, (1 - e^2) of it lost, dissipated by damping alone")
def w3(tools, report):
    plate = meshes.plate(0.4, 4)
    R, v, e = 0.05, 1.0, 0.5
    density = 1.0 / (4 / 3 * math.pi * R**3)
    cube = meshes.box((0.1, 0.1, 0.1))
    for name in ("ball", "cube"):
        c = Case(f"W3{name[0]}", duration=0.05, every=0.01, steps_per_contact=300, margin=2e-3)
        if name == "ball":
            c.sphere("ball", R)
            rho, height = density, R
        else:
            c.mesh("cube", cube)
            rho, height = 1.0 / meshes.mass_properties(cube)[0], 0.05
        c.material("m", rho)
        c.pair_all(stiffness=1e6, restitution=e, friction=0.4)
        c.body(name, "m", (0, 0, height + 5e-3), velocity=(0, 0, -v))
        c.mesh_wall(plate, "m", load_map=True)
        run = report.run(c.run(tools))
        last = run.loads[-1]
        report.check(f"{name}: contacts", last["contacts"].sum(), 1, 1e-12)
        report.check(f"{name}: energy of the impact [J]", last["impact_energy"].sum(), 0.5, 1e-9)
        report.check(f"{name}: lost [J]", last["damping_work"].sum(), 0.375, 2e-3)
        report.check(f"{name}: lost, of what the log says was dissipated", last["damping_work"].sum() / run.log["dissipated"][-1], 1, 1e-9)
        report.check(f"{name}: impulse [N s]", -last["impulse"][:, 2].sum(), 1 + e, 1e-3)
        if name == "ball":   # it falls on the vertex that six triangles share
            hit = last["contacts"] > 0
            report.check("triangles that share it", hit.sum(), 6, 0)
            report.at_most("and equally", numpy.ptp(last["impulse"][hit][:, 2]) / 1.5, 1e-15)


@case("W4", "U", "a block that slides to rest on a plate", "m v^2 / 2 = mu m g s, all of it under the way of the block")
def w4(tools, report):
    mu, v, margin = 0.3, 1.0, 4e-4
    plate = meshes.transformed(meshes.plate(1.2, 24), numpy.eye(3), (0.3, 0, 0))
    c = Case("W4", duration=0.6, every=0.02, gravity=(0, 0, -G), margin=margin)
    c.mesh("block", meshes.box((0.1, 0.1, 0.02)))
    mass, stiffness = 1.0, 2e6
    c.material("m", mass / meshes.mass_properties(meshes.box((0.1, 0.1, 0.02)))[0])
    c.pair_all(stiffness=stiffness, restitution=0.1, friction=mu)
    c.body("block", "m", (0, 0, 0.01 - mass * G / stiffness / 4**(1 / 8)), velocity=(v, 0, 0))
    c.mesh_wall(plate, "m", load_map=True)
    run = report.run(c.run(tools))
    slid = run.x[-1, 0, 0] - run.x[0, 0, 0]
    work = run.loads[-1]["sliding_work"]
    report.check("way [m]", slid, v**2 / (2 * mu * G), 5e-3)
    report.check("sliding work [J]", work.sum(), 0.5 * mass * v**2, 5e-3)
    report.check("sliding work [J] of the way that it went", work.sum(), mu * mass * G * slid, 2e-3)
    middle = areas_and_middles(plate)[1]
    under = (middle[:, 0] > -0.1) & (middle[:, 0] < slid + 0.1) & (abs(middle[:, 1]) < 0.1)
    report.at_most("elsewhere [J]", work[~under].sum(), 0)


@case("W5", "U", "a block wears what it slides over", "Archard: coefficient times mu m g s; the volume of the mesh")
def w5(tools, report):
    mu, mass, way, coefficient, margin, stiffness = 0.3, 1.0, 1.0, 5e-7, 8e-4, 2e6
    exact = coefficient * mu * mass * G * way
    block = meshes.box((0.1, 0.1, 0.02))
    top = numpy.array([1.6, 0.4, 0.0])
    slab = meshes.box((1.6, 0.4, 0.1), n=16, shift=(0.5, 0, -0.05))
    sheet = meshes.plate(1.6, 32)
    sheet = meshes.rounded(sheet[0] * numpy.array([1, 0.25, 1]) + numpy.array([0.5, 0, 0])), sheet[1]
    turned = sheet[0], sheet[1][:, ::-1]   # its normals point down, and what lies on it lies on its back
    # Worn all at once at the end, it slides over a plane. Worn every 0.15 s, it slides over facets, and about 4 in 1000 of the energy goes
    # into what is no sliding: impacts, and springs of features that come and go.
    for name, wall, every, tolerance in (("closed", slab, 0.9, 1e-3), ("turned sheet", turned, 0.9, 1e-3), ("sheet", sheet, 0.15, 1e-2)):
        c = Case(f"W5{name[0]}", duration=0.9, step=4e-5, every=0.15, gravity=(0, 0, -G), margin=margin)
        c.mesh("block", block)
        c.material("m", mass / meshes.mass_properties(block)[0])
        c.pair_all(stiffness=stiffness, restitution=0.1, friction=mu)
        c.body("block", "m", (0, 0, 0.01 - mass * G / stiffness / 4**(1 / 8)), velocity=(math.sqrt(2 * mu * G * way), 0, 0))
        c.mesh_wall(wall, "m", wear={"coefficient": coefficient, "every": every})
        run = report.run(c.run(tools))
        worn = run.wear[-1]["vertex"]
        lost = run.record["wear"][0]
        work = run.loads[-1]["sliding_work"].sum()
        report.check(f"{name}: volume worn off [m^3]", lost["volume"], exact, tolerance)
        report.check(f"{name}: the same from the work that the map has", lost["volume"], coefficient * work, 1e-9)
        if name == "closed":
            now = meshes.mass_properties((worn, wall[1]))[0]
            report.check(f"{name}: volume of the mesh less by [m^3]", meshes.mass_properties(wall)[0] - now, exact, tolerance)
            report.check(f"{name}: that, of what was worn off", meshes.mass_properties(wall)[0] - now, lost["volume"], 1e-6)
        else:
            # above the plane that it was: swept volume of the heights, a third of each vertex for each of its triangles
            area, _ = areas_and_middles((worn * [1, 1, 0], wall[1]))
            report.check(f"{name}: volume under the sheet less by [m^3]", -(area * worn[wall[1]][:, :, 2].mean(axis=1)).sum(), lost["volume"], 1e-4)
        upper = abs(worn[:, 2]) < 0.005
        deepest = -worn[upper][:, 2].min()
        report.check(f"{name}: deepest place [m]", deepest, lost["depth"], 1e-2)
        report.at_most(f"{name}: vertices that rose [m]", worn[upper][:, 2].max(), 1e-12)
        report.check(f"{name}: the block slid [m]", run.x[-1, 0, 0] - run.x[0, 0, 0], way, 1e-2)
        report.at_most(f"{name}: energy balance", run.record["energy"]["error_relative"], 2e-3)


@case("W6", "U", "one interval of wear or another", "sum of the intervals; the same work, to the second order in the depth of one")
def w6(tools, report):
    volumes = {}
    plate = meshes.plate(0.4, 16)
    for every in (0.01, 0.02, 0.04):
        c = Case("W6", duration=0.4, step=2e-5, every=0.04, gravity=(1.5, 0, -G), margin=4e-4)
        c.sphere("ball", 0.02)
        c.material("m", 3000.0)
        c.pair_all(stiffness=2e5, restitution=0.3, friction=0.1, rolling_friction=0.1)
        for k in range(5):
            c.body("ball", "m", (-0.1, -0.1 + 0.05 * k, 0.02), velocity=(0.2 + 0.1 * k, 0, 0))
        c.mesh_wall(plate, "m", wear={"coefficient": 1e-6, "every": every})
        run = report.run(c.run(tools))
        volumes[every] = run.record["wear"][0]["volume"]
        report.check(f"every {every} s: volume worn off, of the work", volumes[every], 1e-6 * run.loads[-1]["sliding_work"].sum(), 1e-9)
        report.at_most(f"every {every} s: energy balance", run.record["energy"]["error_relative"], 5e-3)
    report.check("volume at .02 s against .01 s", volumes[0.02], volumes[0.01], 2e-2)
    report.check("volume at .04 s against .01 s", volumes[0.04], volumes[0.01], 4e-2)


@case("W7", "U", "one impact recorded: a ball on a wall, two balls, a ball that slides as it lands", "m v^2 / 2, of it 1 - e^2 lost; mu (1 + e) m v s of friction")
def w7(tools, report):
    radius = 0.05
    density = 1.0 / (4 / 3 * math.pi * radius**3)   # 1 kg
    for name, e, mu, others, energy, lost in (("wall", 0.5, 0.0, False, 0.5, 0.375), ("two balls", 0.5, 0.0, True, 1.0, 0.75),
                                              ("wall, e = .9", 0.9, 0.0, False, 0.5, 0.095)):
        c = Case(f"W7{name[0]}{e}", duration=0.03, every=0.01, gravity=(0, 0, 0), margin=0, steps_per_contact=200, impacts=True)
        c.sphere("ball", radius)
        c.material("m", density)
        c.material("w", 1000.0)
        c.pair("m", "m", stiffness=1e6, restitution=e, friction=mu)
        c.pair("m", "w", stiffness=1e6, restitution=e, friction=mu)
        c.body("ball", "m", (0, 0, radius + 0.005), velocity=(0, 0, -1))
        if others:
            c.body("ball", "m", (0, 0, -radius - 0.005), velocity=(0, 0, 1))
        else:
            c.wall({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "w")
        run = report.run(c.run(tools))
        impacts, losses = run.impacts[-1], run.losses[-1]
        row = 0 if others else 1   # m with m, m with w
        report.check(f"{name}: impacts", impacts["normal_count"].sum(), 1, 0)
        report.check(f"{name}: energy in [J]", impacts["normal_energy"].sum(), energy, 1e-9)
        report.at_most(f"{name}: energy in, of the ends of its bin", max(impacts["energy_from"][0] / energy, energy / impacts["energy_to"][0]), 1)
        report.check(f"{name}: lost by damping [J]", losses["damping"][row], lost, 2e-3)
        report.check(f"{name}: that, of what the log has", losses["damping"].sum(), run.log["dissipated"][-1], 1e-12)
        report.at_most(f"{name}: by friction and rolling [J]", abs(losses["friction"]).sum() + abs(losses["rolling"]).sum(), 0)
    # a ball without spin comes at an angle and slides until it leaves: it loses its normal energy as above, and by friction what is missing
    # from the energy of its motion along the wall and of its spin
    e, mu, vx = 0.5, 0.1, 3.0
    c = Case("W7s", duration=0.03, every=0.01, gravity=(0, 0, 0), margin=0, steps_per_contact=200, impacts=True)
    c.sphere("ball", radius)
    c.material("m", density)
    c.pair_all(stiffness=1e6, restitution=e, friction=mu)
    c.body("ball", "m", (0, 0, radius + 0.005), velocity=(vx, 0, -1))
    c.wall({"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, "m")
    run = report.run(c.run(tools))
    impacts, losses = run.impacts[-1], run.losses[-1]
    push = mu * (1 + e)   # change of momentum along the wall over m v
    slid = 0.5 * vx**2 - 0.5 * (vx - push)**2 - 0.5 * 2.5 * push**2   # spin: torque impulse push R on 0.4 m R^2
    # to the first overlap, by which the lever is shorter than the radius: a step at 1 m/s
    report.check("sliding: energy along the surface [J]", impacts["shear_energy"].sum(), 0.5 * vx**2 * 2 / 7, run.step / radius)
    report.check("sliding: energy along the normal [J]", impacts["normal_energy"].sum(), 0.5, 1e-9)
    report.check("sliding: lost by friction [J]", losses["friction"][0], slid, 5e-3)
    report.check("sliding: all that is lost, of what the log has", losses["friction"].sum() + losses["damping"].sum(), run.log["dissipated"][-1], 1e-12)
