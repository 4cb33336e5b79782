#!/usr/bin/env python3
"""What each tablet gets of the spray, frame by frame. usage: coating.py TABLE.md CHART.svg CHART.png RADIUS HEIGHT CUP NAME

The spray is a flat fan, as those of pans are: parallel rays across the slope of the bed, in a strip below the axis of the pan over its whole length. The first tablet on a ray gets what the ray carries in
a frame: mass is counted in seconds of one ray's flow. A tablet is taken for the ellipsoid of its axes. The interval is that of 400 draws of
tablets (bootstrap).
"""
import json
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

TABLE, SVG, PNG, RADIUS, HEIGHT, CUP, NAME = sys.argv[1:]
AXES = np.array([si(RADIUS), si(RADIUS), si(HEIGHT) / 2 + si(CUP)])   # half axes of a tablet
SLOPE = np.radians(35)    # of the spray against the vertical: across the surface of the bed
STRIP = 0.03              # width of the spray along the slope [m]
APART = 0.0014            # of rays [m]: some thirty on a tablet
SETTLED = 1.0             # [s]: the bed flows steadily
record = record_of(NAME)
case = case_of(record)
run = scree.open(f"{NAME}.run")
motion = case["walls"][0]["motion"]["rotate"]
turn = 2 * np.pi / si(motion["rate"])
length = si(case["domain"]["max"][1]) - si(case["domain"]["min"][1])
down = -np.array([np.sin(SLOPE), 0, np.cos(SLOPE)])   # the pan turns about +y and lifts its bed on the side of -x
along = np.array([np.cos(SLOPE), 0, -np.sin(SLOPE)])
rays = np.array([u * along + np.array([0, v, 0]) for u in np.arange(-0.5 * STRIP, 0.5 * STRIP + 1e-9, APART) for v in np.arange(0, length - 1e-9, APART)])


def first_on_each_ray(place, orientation):
    """Row of the first tablet on each ray; -1: none."""
    turned = np.transpose(scree.rotation_matrix(orientation), (0, 2, 1)) / AXES[:, None]   # into the ball that the ellipsoid is scaled to
    away = rays[None] - place[:, None]
    away[..., 1] -= length * np.round(away[..., 1] / length)
    p, d = np.einsum("nij,nrj->nri", turned, away), np.einsum("nij,j->ni", turned, down)
    b, c = np.einsum("nri,ni->nr", p, d), np.einsum("nri,nri->nr", p, p) - 1
    a = np.einsum("ni,ni->n", d, d)[:, None]
    root = b * b - a * c
    reach = np.where(root > 0, (-b - np.sqrt(np.maximum(root, 0))) / a, np.inf)   # where a ray goes in; rays begin at the axis of the pan
    reach[reach < -np.max(AXES)] = np.inf
    first = reach.argmin(axis=0)
    return np.where(np.isfinite(reach.min(axis=0)), first, -1)


ids = np.sort(run.frames[-1].bodies.id)
coat, coats, times, visits, seen_last = np.zeros(len(ids)), [], [], np.zeros(len(ids)), np.zeros(len(ids), dtype=bool)
before = SETTLED
for frame in run.frames:
    if frame.time < SETTLED:
        continue
    order = np.argsort(frame.bodies.id)
    hit = first_on_each_ray(frame.bodies.position[order], frame.bodies.quaternion[order])
    shares = np.bincount(hit[hit >= 0], minlength=len(ids)) / len(rays)
    coat = coat + shares * (frame.time - before)
    visits += (shares > 0) & ~seen_last
    seen_last = shares > 0
    before = frame.time
    times.append(frame.time - SETTLED)
    coats.append(coat)
times, coats = np.array(times), np.array(coats)
if not coats[-1].any():
    sys.exit(f"coating: no tablet of {NAME} came below the spray")


def variation(some):
    return some.std(axis=1) / some.mean(axis=1)


# CV = C t^-n: of the second half of the turns, where every tablet has come below the spray several times
late = times >= 0.2 * times[-1]


def exponent(columns):
    return -np.polyfit(np.log(times[late]), np.log(variation(coats[late][:, columns])), 1)[0]


random = np.random.default_rng(1)
drawn = [exponent(random.integers(0, len(ids), len(ids))) for _ in range(400)]
n, half = exponent(np.arange(len(ids))), 0.5 * float(np.diff(np.quantile(drawn, [0.025, 0.975]))[0])
cv = variation(coats[-1:])[0]
lines = ["| after | mean, in seconds of one spray | CV of tablets | tablets without any |", "|---|---|---|---|"]
for turns in np.arange(1, int(times[-1] / turn + 1e-6) + 1) if times[-1] >= turn else [times[-1] / turn]:
    k = min(int(np.searchsorted(times, turns * turn)), len(times) - 1)
    lines.append(f"| {turns:.3g} turns, {times[k]:.3g} s | {coats[k].mean():.3g} | {variation(coats[k:k + 1])[0]:.2f} | {int((coats[k] == 0).sum())} of {len(ids)} |")
lines += ["", f"CV falls as t^-n with n = {n:.2f} +- {half:.2f}; 0.5 where visits are independent of each other (Mann 1983). "
              f"A tablet comes below the spray {visits.mean() / times[-1]:.2f} times a second, {coats[-1].sum() / max(visits.sum(), 1):.3g} s of spray a visit. "
              f"{100 * coats[-1].sum() / times[-1]:.1f} % of the spray met tablets."]
with open(TABLE, "w", encoding="utf-8") as file:
    file.write("\n".join(lines) + "\n")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
shown = times >= 0.1
left.loglog(times[shown], variation(coats[shown]), color="C0", label="tablets")
left.loglog(times[late], cv * (times[late] / times[-1]) ** -0.5, color="0.4", linestyle="--", label="$t^{-1/2}$")
left.set(xlabel="time below the spray [s]", ylabel="CV of the coating", title="Coating becomes even")
left.legend(frameon=False)
right.hist(1e3 * coats[-1], bins=20, color="C0")
right.axvline(1e3 * coats[-1].mean(), color="0.2", linestyle=":")
right.set(xlabel="coating of a tablet [ms of spray]", ylabel="tablets", title=f"After {times[-1]:.3g} s: CV {cv:.2f}")
for path in (SVG, PNG):
    figure.savefig(path, dpi=120, metadata={"Date": None} if path.endswith(".svg") else None)
print(json.dumps({"exponent": n, "half_width": half, "cv": float(cv)}))
