#!/usr/bin/env python3
"""What a press does to a bed, beside statics. usage: press.py TABLE.md NAME ...

lid       mean force of the lid on the bed over the last tenth of the run, and what its servo was asked for
floor     the same of the floor; smooth sides carry nothing upright, so that it is lid and weight of the grains
sides     share of lid and weight that hangs on the sides, and how much of their friction that takes
Janssen   K of H. A. Janssen's slices (Z. VDI 39, 1895) from what arrives at the floor with the friction that the sides have mobilised; K measured
          is the mean pressure on the sides over that on lid and floor
"""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

TABLE, *NAMES = sys.argv[1:]
G = 9.81


def arrives(K, mobilised, side, height, top, weight_density):
    """Vertical stress at the floor of slices with friction on four sides, below a stress on top."""
    k = 4 * mobilised * K / side
    end = weight_density / k
    return end + (top - end) * np.exp(-k * height)


def read(name):
    case, run = case_of(record_of(name)), scree.open(f"{name}.run")
    walls = {wall["name"]: wall for wall in case["walls"]}
    ids = {wall.name: wall.id for wall in run.scene.walls.in_order}
    log = run.log
    late = log["time"] > 0.9 * log["time"][-1]

    def force(wall, k):
        return log[f"wall{ids[wall]}_force_{k}"][late].mean()
    servo = walls["lid"]["motion"]["servo"]
    side = si(walls["+x"]["shape"]["plane"]["point"][0]) - si(walls["-x"]["shape"]["plane"]["point"][0])
    area, asked = side * side, si(servo["stress"]) * si(servo["area"])
    lid, floor = force("lid", "z"), -force("floor", "z")
    hung = -sum(force(wall, "z") for wall in ("-x", "+x", "-y", "+y"))
    pressed = 0.5 * (force("+x", "x") - force("-x", "x") + force("+y", "y") - force("-y", "y"))
    weight = G * run.frames[-1].bodies.mass.sum()
    bed = si(walls["lid"]["position"][2]) - 0.005 + log[f"wall{ids['lid']}_way"][late].mean() * servo["direction"][2]
    K = (pressed / (side * bed)) / (0.5 * (lid + floor) / area)
    mobilised = hung / (4 * pressed) if pressed > 0 else 0.0
    result = {"asked": asked, "lid": lid, "floor": floor, "weight": weight, "hung": hung, "mobilised": mobilised, "K": K, "janssen": float("nan")}
    if mobilised > 0.02:
        low, high = 1e-3, 3.0
        for _ in range(80):
            middle = 0.5 * (low + high)
            more = arrives(middle, mobilised, side, bed, lid / area, weight / (area * bed)) > floor / area
            low, high = (middle, high) if more else (low, middle)
        result["janssen"] = middle
    return result


lines = ["| sides | force on the lid / set force | force on the floor / lid force and weight | share carried by the sides | mobilised share of their friction | K from Janssen | K measured |",
         "| --- | --- | --- | --- | --- | --- | --- |"]
for name in NAMES:
    r = read(name)
    total = r["lid"] + r["weight"]
    smooth = not r["janssen"] == r["janssen"]
    lines.append(f"| {name} | {r['lid'] / r['asked']:.4f} | {r['floor'] / total:.4f} | {100 * r['hung'] / total:.1f} % | "
                 + ("| | " if smooth else f"{r['mobilised']:.2f} | {r['janssen']:.2f} | ") + f"{r['K']:.2f} |")
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Press\n\n" + "\n".join(lines) + "\n")
