#!/usr/bin/env python3
"""A first user's mixer, end to end: trough and shaft as STL files, tablets and cubes, some of them beside the trough, by workflows/run to the
report; mixing index, torque, picture and film against what numpy computes from the frames. usage: mixer_test.py RUNNER BIN SCRATCH

Exit 77: ffmpeg is missing.
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent.parent / "post/python"), str(HERE.parent / "support")]
import scree  # noqa: E402
from mpi_environment import mpi_environment  # noqa: E402

RUNNER, BIN, SCRATCH = sys.argv[1:4]
ENVIRONMENT = {k: v for k, v in mpi_environment(SCREE_BIN=BIN).items() if k not in ("DISPLAY", "XAUTHORITY")}
SIZE = (480, 360)
RADIUS, HALF, TOP = 0.030, 0.060, 0.060   # of the trough: a half cylinder along x, and walls up to TOP [m]
RATE, START = 2 * math.pi * 2, 0.1        # 120 rpm
SPILLED, EACH = 8, 100

CASE = """
title = "paddle mixer, tablets and cubes"
seed = 3
[time]
duration = "1 s"
steps_per_contact = 15
[shapes.tablet]
file = "tablet.shape.h5"
[shapes.cube]
file = "cube.shape.h5"
[materials.pharma]
density = "1300 kg/m^3"
[materials.steel]
density = "7850 kg/m^3"
[[pairs]]
between = ["pharma", "pharma"]
stiffness = "5 kN/m"
restitution = 0.5
friction = 0.4
[[pairs]]
between = ["pharma", "steel"]
stiffness = "5 kN/m"
restitution = 0.5
friction = 0.3
[[populations]]
shape = "tablet"
material = "pharma"
count = 100
region = { box = [["-58 mm", "-27 mm", 0], [0, "27 mm", "100 mm"]] }
[[populations]]
shape = "cube"
material = "pharma"
count = 100
region = { box = [[0, "-27 mm", 0], ["58 mm", "27 mm", "100 mm"]] }
[[populations]]
shape = "cube"
material = "pharma"
count = 8
region = { box = [["-50 mm", "50 mm", 0], ["50 mm", "70 mm", "60 mm"]] }
[[walls]]
name = "trough"
shape = { file = "trough.shape.h5" }
material = "steel"
[[walls]]
name = "shaft"
shape = { file = "shaft.shape.h5" }
material = "steel"
motion = { rotate = { axis = [1, 0, 0], rate = "120 rpm" }, start = "0.1 s" }
[output]
every = "20 ms"
[contact]
impact_speed = "1.6 m/s"
"""
MESHES = """
trough = 'import trough.stl --surface --unit mm'
shaft = 'import shaft.stl --surface --unit mm'
tablet = 'import tablet.stl --unit mm'
cube = 'generate cube --size "6 mm"'
"""


# ---- meshes, in mm

def write_stl(name, triangles):
    with open(os.path.join(SCRATCH, name), "w", encoding="ascii") as file:
        file.write("solid made\n")
        for t in numpy.asarray(triangles, float):
            file.write("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {p[0]:.9g} {p[1]:.9g} {p[2]:.9g}\n" for p in t) + "endloop\nendfacet\n")
        file.write("endsolid made\n")


def quads(rings, closed):
    """Triangles between rings of points, one after the other."""
    triangles = []
    for a, b in zip(rings, rings[1:]):
        for i in range(len(a) if closed else len(a) - 1):
            j = (i + 1) % len(a)
            triangles += [(a[i], a[j], b[j]), (a[i], b[j], b[i])]
    return triangles


def fan(ring, tip):
    return [(ring[i], ring[(i + 1) % len(ring)], tip) for i in range(len(ring))]


def trough():
    r, x, top = 1e3 * RADIUS, 1e3 * HALF, 1e3 * TOP
    section = [(-r, top)] + [(-r * math.cos(t), -r * math.sin(t)) for t in numpy.linspace(0, math.pi, 33)] + [(r, top)]
    ends = [[(end, y, z) for y, z in section] for end in (-x, x)]
    return quads(ends, closed=False) + [t for ring in ends for t in fan(ring, (ring[0][0], 0, 0))]


def shaft():
    ring = [(6 * math.cos(t), 6 * math.sin(t)) for t in numpy.linspace(0, 2 * math.pi, 13)[:-1]]
    ends = [[(x, y, z) for y, z in ring] for x in (-58, 58)]
    triangles = quads(ends, closed=True) + fan(ends[0], (-58, 0, 0)) + fan(ends[1], (58, 0, 0))
    for k in range(6):   # paddles, 9 mm off the trough: no body is caught
        turn, skew = math.radians(120 * k), math.radians(45 if k % 2 else -45)
        box = numpy.array([(x, y, z) for z in (3, 21) for x, y in ((-10, -1.5), (10, -1.5), (10, 1.5), (-10, 1.5))], float)
        x, y = box[:, 0] * math.cos(skew) - box[:, 1] * math.sin(skew), box[:, 0] * math.sin(skew) + box[:, 1] * math.cos(skew)
        box = numpy.stack([x - 45 + 18 * k, y * math.cos(turn) - box[:, 2] * math.sin(turn), y * math.sin(turn) + box[:, 2] * math.cos(turn)], axis=1)
        triangles += quads([list(map(tuple, box[:4])), list(map(tuple, box[4:]))], closed=True)
        triangles += fan(list(map(tuple, box[:4])), tuple(box[:4].mean(axis=0))) + fan(list(map(tuple, box[4:])), tuple(box[4:].mean(axis=0)))
    return triangles


def tablet():
    """Biconvex: 8 mm across, a band of 2.5 mm, caps of 0.9 mm."""
    ring = [(4 * math.cos(t), 4 * math.sin(t)) for t in numpy.linspace(0, 2 * math.pi, 13)[:-1]]
    low, high = ([(x, y, z) for x, y in ring] for z in (-1.25, 1.25))
    return quads([low, high], closed=True) + fan(low[::-1], (0, 0, -2.15)) + fan(high, (0, 0, 2.15))


# ---- what numpy makes of the frames

def within(bodies):
    """Bodies that have not left: some begin beside the trough, so that only what is wholly below it has."""
    reach = numpy.where(bodies.shape_name == "cube", 0.003 * math.sqrt(3), 0.0042)   # of a tablet a little less than its corner, 4.19 mm
    return bodies.position[:, 2] + reach > -RADIUS


def lacey(position, is_one):
    """Lacey (1954) over cubes that hold 12 bodies of an even share of the box around all, weighted by the bodies in each."""
    low, extent = position.min(axis=0), numpy.ptp(position, axis=0)
    side = (extent.prod() * 12 / len(position)) ** (1 / 3)
    _, cell, count = numpy.unique(numpy.floor((position - low) / side).astype(int), axis=0, return_inverse=True, return_counts=True)
    share, p = numpy.bincount(cell.ravel(), is_one) / count, is_one.mean()
    variance = (count * (share - p) ** 2).sum() / len(position)
    apart, random = p * (1 - p), p * (1 - p) * len(count) / len(position)
    return (apart - variance) / (apart - random)


def torque_on(wall, frame):
    """About x through the origin, from the contacts of a wall."""
    contacts = frame.contacts
    mine = (contacts.body_a == wall) | (contacts.body_b == wall)
    force = contacts.normal_force[:, None] * contacts.normal + contacts.tangential_force   # on a
    sign = numpy.where(contacts.body_a == wall, 1, -1)[:, None]
    return float(numpy.cross(contacts.point, sign * force)[mine, 0].sum())


# ---- pictures

def call(*words):
    result = subprocess.run([os.path.join(BIN, "scree-post"), *words], capture_output=True, text=True, env=ENVIRONMENT, cwd=os.path.join(SCRATCH, "mixer.out"))
    assert result.returncode == 0, (words, result)
    return result.stdout + result.stderr


def decoded(name):
    raw = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", name, "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         capture_output=True, check=True, cwd=os.path.join(SCRATCH, "mixer.out")).stdout
    return numpy.frombuffer(raw, numpy.uint8).reshape(-1, SIZE[1], SIZE[0], 3).astype(float)


def loss(a, b):
    """Signal to noise of two pictures [dB]."""
    return 10 * math.log10(255**2 / max(1e-9, numpy.mean((a - b) ** 2)))


def drawn(picture):
    """Share of the picture's height and width over which something is drawn."""
    rows, columns = numpy.nonzero(picture.min(axis=2) < 240)
    return numpy.ptp(rows) / SIZE[1], numpy.ptp(columns) / SIZE[0]


def main():
    if shutil.which("ffmpeg") is None:
        sys.exit(77)
    shutil.rmtree(SCRATCH, ignore_errors=True)
    os.makedirs(SCRATCH)
    for name, triangles in (("trough", trough()), ("shaft", shaft()), ("tablet", tablet())):
        write_stl(name + ".stl", triangles)
    for name, text in (("mixer.toml", CASE), ("meshes.toml", MESHES)):
        with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
            file.write(text)
    result = subprocess.run([RUNNER, "mixer.toml", "--config", "statistics=--mixing shape"], capture_output=True, text=True, env=ENVIRONMENT, cwd=SCRATCH)
    assert result.returncode == 0, result.stdout + result.stderr
    out = os.path.join(SCRATCH, "mixer.out")
    run = scree.open(os.path.join(out, "mixer.run"))
    assert run.outcome["outcome"] == "completed" and run.outcome["bodies"] == 2 * EACH + SPILLED, run.outcome

    # what was spilled, and who is counted
    last = run.frames[-1].bodies
    spilled = ~within(last)
    assert spilled.sum() == SPILLED and last.position[spilled, 2].max() < -1, "they have fallen for half a second: 1.2 m and more"
    with open(os.path.join(out, "mixer.statistics/statistics.json"), encoding="utf-8") as file:
        statistics = json.load(file)
    assert statistics["left"].startswith(f"{SPILLED} bodies have left the equipment"), statistics["left"]
    farthest = float(statistics["left"].split("farthest by ")[1].split()[0])
    assert abs(farthest - (-RADIUS - last.position[spilled, 2].min())) < 0.02, statistics["left"]

    # mixing index and number of bodies, frame by frame; nine digits in the table
    series = run.statistics["series"]
    rows = series.where(series["group"] == "all")
    assert len(rows["time"]) == len(run.frames)
    index = []
    for k, frame in enumerate(run.frames):
        inside = within(frame.bodies)
        index.append(lacey(frame.bodies.position[inside], (frame.bodies.shape_name[inside] == "tablet").astype(float)))
        assert rows["particle_count"][k] == inside.sum(), (k, rows["particle_count"][k], inside.sum())
        assert abs(rows["mixing_index"][k] - index[k]) < 1e-6, (k, rows["mixing_index"][k], index[k])
        counted = frame.bodies[inside & frame.bodies.is_particle]
        kinetic, weight = counted.kinetic_energy.sum(), 9.81 * (counted.mass * counted.position[:, 2]).sum()
        assert abs(rows["kinetic_energy"][k] - kinetic) < 1e-6 * kinetic + 1e-15, (k, rows["kinetic_energy"][k], kinetic)
        assert abs(rows["potential_energy"][k] - weight) < 1e-6 * abs(weight) + 1e-12, (k, rows["potential_energy"][k], weight)
    # from where all lie, apart, in a bed: half a turn later
    first = int(numpy.argmax([frame.time > START + 0.04 for frame in run.frames]))
    assert index[first] < 0.15 and index[-1] > index[first] + 0.05, f"the shaft mixes: {index[first]:.3f} to {index[-1]:.3f}"
    print(f"mixing index {index[first]:.3f} to {index[-1]:.3f}")

    # torque of the shaft: statistics and log against the contacts of the frames, and power against both
    shaft_id = [wall["wall"] for wall in run.outcome["walls"] if wall["name"] == "shaft"][0]
    walls = run.statistics["walls"]
    torque = walls["axis_torque"][walls["name"] == "shaft"]
    by_contacts = numpy.array([torque_on(shaft_id, frame) for frame in run.frames])
    moves = numpy.array([frame.time for frame in run.frames]) > START + 0.05
    assert torque[moves].mean() < 0, "the shaft lifts: what it pushes pushes back"
    # damping and friction of a frame's contacts are those of half a step later: with impacts a few per cent of a single force
    scale = abs(by_contacts[moves]).max()
    assert abs(torque - by_contacts).max() < 0.05 * scale and abs(torque - by_contacts)[moves].mean() < 0.01 * scale, (torque, by_contacts)
    # power and torque of a frame are those of one moment, and the log has rows at others
    of_frames = walls["power"][walls["name"] == "shaft"]
    turned = numpy.array([frame.time for frame in run.frames]) > START + 1e-3
    assert turned.sum() > 5 and abs(of_frames + RATE * torque)[turned].max() < 1e-6 * abs(of_frames).max(), (of_frames, torque)
    log = run.log
    same = [(k, int(abs(log["time"] - frame.time).argmin())) for k, frame in enumerate(run.frames)]
    same = [(k, row) for k, row in same if abs(log["time"][row] - run.frames[k].time) < 1e-9]   # steps of their own, but at the end
    assert same[-1][0] == len(run.frames) - 1 and torque[-1] != 0, (same, torque[-1])
    for k, row in same:
        assert abs(log["axis_torque@shaft"][row] - torque[k]) < 1e-6 * scale, (k, log["axis_torque@shaft"][row], torque[k])
    turning = (log["time"] > START + 1e-3)
    power = log["power@shaft"][turning]
    assert abs(power + RATE * log["axis_torque@shaft"][turning]).max() < 1e-9 * abs(power).max()
    assert abs(log["power@shaft"][log["time"] < START]).max() == 0 and "axis_torque@trough" not in log
    mean = statistics["walls"][f"{shaft_id} shaft"]["axis_torque"]["mean"]
    weights = numpy.gradient(numpy.array([frame.time for frame in run.frames]))
    weights[[0, -1]] /= 1   # ends of the trapezoid: gradient gives them the whole step
    weights[[0, -1]] *= 0.5
    assert abs(mean - (weights * torque).sum() / weights.sum()) < 0.05 * abs(torque).max(), (mean, torque.mean())
    with open(os.path.join(out, "mixer.report.html"), encoding="utf-8") as file:
        page = file.read()
    assert "Torque on walls that turn" in page and f"{SPILLED} bodies have left the equipment" in page

    # a picture shows the mixer and what is in it, whether others have fallen 1.5 m below it or not
    size = ["--size", str(SIZE[0]), str(SIZE[1]), "--no-legend"]
    said = call("picture", "mixer.run", "-o", "last.png", *size)
    assert f"{SPILLED} bodies have left the equipment" in said, said
    call("picture", "mixer.run", "-o", "mixer.png", "--within", "trough", *size)
    call("picture", "mixer.run", "-o", "all.png", "--within", "all", *size)
    seen, alone, everything = (decoded(name)[0] for name in ("last.png", "mixer.png", "all.png"))
    assert min(drawn(seen)) > 0.4, f"the mixer fills the picture: {drawn(seen)}"
    assert loss(seen, alone) > 30, loss(seen, alone)
    assert loss(seen, everything) < 25, "the camera of all bodies is another one"
    # a film: each frame once, with one camera, and the mixer fills it to the end
    chosen = [0, len(run.frames) // 2, len(run.frames) - 3, len(run.frames) - 2]
    call("film", "mixer.run", "-o", "mixer.mp4", "--frames", ",".join(map(str, chosen)), "--no-time", *size)
    film = decoded("mixer.mp4")
    assert len(film) == len(chosen), len(film)
    assert min(min(drawn(picture)) for picture in film) > 0.4, [drawn(picture) for picture in film]
    # 20 ms apart two pictures are nearly the same, and the more apart the less: one camera, and what moves is the shaft and the bodies
    assert loss(film[-2], film[-1]) > max(20, loss(film[0], film[-1]) + 3), (loss(film[-2], film[-1]), loss(film[0], film[-1]))
    shutil.rmtree(SCRATCH)
    print("all as expected")


if __name__ == "__main__":
    main()
