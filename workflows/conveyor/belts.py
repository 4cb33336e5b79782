#!/usr/bin/env python3
"""What the belts carry, throw and draw, against their closed forms. usage: belts.py TABLE.md CHART.svg CHART.png NAME

load      of a belt: rate / speed, the mean over the frames after the stream has passed the section
thrown    height of the stream beyond the end of belt 1: a parabola, - g (x / v)^2 / 2
power     of a belt: rate times its speed times the speed that it gives: force is the rate of momentum, and it acts at the belt's speed
residence from the feeder to the end of belt 2
"""
import os
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TABLE, SVG, PNG, NAME = sys.argv[1:]
G = 9.81
record = record_of(NAME)
case = case_of(record)
run = scree.open(f"{NAME}.run")
walls = {wall["name"]: wall for wall in case["walls"]}
feed = case["inlets"][0]
rate, fed_at = si(feed["rate"]), si(feed["velocity"][0])
speed = {1: si(walls["belt 1"]["surface"]["velocity"][0]), 2: si(walls["belt 2"]["surface"]["velocity"][1])}
shape = {belt: walls[f"belt {belt}"]["shape"]["plate"] for belt in (1, 2)}
end = {1: si(shape[1]["corner"][0]) + si(shape[1]["side_a"][0]), 2: si(shape[2]["corner"][1]) + si(shape[2]["side_b"][1])}
level = {belt: si(shape[belt]["corner"][2]) for belt in (1, 2)}
section = {belt: (end[belt] - 0.7, end[belt] - 0.1) for belt in (1, 2)}

inserted = run.inserted
mass_of = dict(zip(inserted["id"].astype(int), inserted["mass"]))
came_at = dict(zip(inserted["id"].astype(int), inserted["time"]))
times, loads, stream, passed, before = [], {1: [], 2: []}, [], {}, {}
for frame in run.frames:
    place, ids = frame.bodies.position, frame.bodies.id
    mass = np.array([mass_of[int(i)] for i in ids])
    times.append(frame.time)
    for belt, axis in ((1, 0), (2, 1)):
        low, high = section[belt]
        on = (place[:, axis] > low) & (place[:, axis] < high) & (np.abs(place[:, 2] - level[belt] - 0.05) < 0.08)
        loads[belt].append(mass[on].sum() / (high - low) if len(ids) else 0.0)
    # what the plate has thrown back no longer goes forward
    flying = (np.abs(place[:, 0] - end[1]) < 0.32) & (place[:, 2] > level[1] - 0.45) & (frame.bodies.velocity[:, 0] > 0.6 * speed[1]) if len(ids) else []
    stream += [row[[0, 2]] for row in place[flying]] if len(ids) else []
    for i, y in zip(ids.astype(int), place[:, 1] if len(ids) else []):
        if y >= end[2] and i not in passed and i in before:
            t, y0 = before[i]
            passed[i] = t + (end[2] - y0) / (y - y0) * (frame.time - t) - came_at[i]
        before[i] = (frame.time, y)
times, loads, stream = np.array(times), {belt: np.array(load) for belt, load in loads.items()}, np.array(stream).reshape(-1, 2)
fed_until = inserted["time"].max()   # the feed may end before the run
log = run.log
ids = {wall.name: wall.id for wall in run.scene.walls.in_order}

lines = ["| what | measured | closed form | difference |", "| --- | --- | --- | --- |"]


def told(what, measured, expected, unit):
    lines.append(f"| {what} | {measured:.3g} {unit} | {expected:.3g} {unit} | {100 * (measured / expected - 1):+.1f} % |")


def steady_from(belt):
    """Since when the whole section has its load: the stream has come to its end, and a quarter of a second more."""
    reached = np.flatnonzero(loads[belt] > 0.5 * rate / speed[belt])
    return times[reached[0]] + 0.6 / speed[belt] + 0.25 if len(reached) else np.inf


total_in, total_out = inserted["mass"].sum(), float(record["removed_mass"])
there = sum(mass_of[int(i)] for i in run.frames[-1].bodies.id)
lines.append(f"| mass that came in, left, is there | {total_in:.4g}, {total_out:.4g}, {there:.4g} kg | in - out = there | {total_in - total_out - there:.1e} kg |")
for belt, gives in ((1, speed[1] - fed_at), (2, speed[2])):
    since = steady_from(belt)
    late = (times > since) & (times <= fed_until)
    if late.sum() < 4:
        lines.append(f"| belt {belt} | not long enough loaded | | |")
        continue
    told(f"load of belt {belt}", loads[belt][late].mean(), rate / speed[belt], "kg/m")
    rows = (log["time"] > since) & (log["time"] <= fed_until)
    told(f"power of belt {belt}", log[f"wall{ids[f'belt {belt}']}_power"][rows].mean(), rate * gives * speed[belt], "W")
thrown = stream[stream[:, 0] > end[1] + 0.02] if len(stream) else stream
if len(thrown) > 20:
    rides = np.median(stream[stream[:, 0] < end[1] - 0.02][:, 1])
    off = thrown[:, 1] - rides + 0.5 * G * ((thrown[:, 0] - end[1]) / speed[1])**2
    lines.append(f"| stream beyond belt 1 | {1e3 * off.mean():+.0f} mm from the parabola, deviation {1e3 * off.std():.0f} mm | 0 | |")
if passed:
    stay = np.array(list(passed.values()))
    lines.append(f"| from the feeder to the end of belt 2 | {stay.mean():.2f} s, deviation {stay.std():.2f} s, of {len(stay)} rocks | | |")

figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
for belt, colour in ((1, "#2a6f97"), (2, "#bc6c25")):
    left.plot(times, loads[belt], color=colour, label=f"belt {belt}")
    left.axhline(rate / speed[belt], color=colour, linewidth=0.8, linestyle="--")
left.set_xlabel("time [s]")
left.set_ylabel("load [kg/m]")
left.legend(frameon=False, title="dashed: rate / speed")
if len(stream):
    right.plot(stream[:, 0] - end[1], stream[:, 1], ".", color="#888888", markersize=2, label="rocks", rasterized=True)
    x = np.linspace(0, 0.32, 60)
    if len(thrown) > 20:
        right.plot(x, rides - 0.5 * G * (x / speed[1])**2, color="#000000", linewidth=1, label="parabola")
    right.legend(frameon=False)
right.set_xlabel("beyond the end of belt 1 [m]")
right.set_ylabel("height [m]")
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write(f"# Two belts\n\n{len(mass_of)} rocks came in at {rate:g} kg/s.\n\n" + "\n".join(lines) + "\n")
