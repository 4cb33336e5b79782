#!/usr/bin/env python3
"""Lifetimes of columns of staples on a vibrating floor. usage: staples.py RESULT.json TABLE.md CHART.svg CHART.png BEFORE.png AFTER.png SHOWN NAME...

NAME is arm-RATIO-gamma-GAMMA-SEED; the pictures are of SHOWN. The height of a column is that of its centre of mass over the floor, from the potential energy in log.csv, as a mean over one period of the floor. A
column has collapsed when its height has fallen by 1 - 1/e of what it can fall: from the height at the start down to the lowest height of all runs of this arm length at their ends. The time at
which this happens is the lifetime tau. A run that ends before has a lifetime above its duration: it is censored.

ln(f tau) = intercept + Delta / Gamma is fitted by maximum likelihood to all runs of an arm length, with one normal scatter. A censored run counts with the probability that its lifetime is
above its duration. Without censored runs this is the line of least squares. Intervals (95 %) are Student's, from the curvature of the likelihood. r^2 is that of the line of least squares
through the means over the seeds. It is of the accelerations at which all runs have collapsed.
"""
import json
import math
import os
import re
import sys

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from scipy.optimize import minimize  # noqa: E402
from scipy.stats import norm, t as student  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
sys.dont_write_bytecode = True
import scree  # noqa: E402
from run_record import case_of, record_of, si  # noqa: E402

RESULT, TABLE, SVG, PNG, BEFORE, AFTER, SHOWN, *NAMES = sys.argv[1:]
POINTS = 40           # of a period, for its mean
LEAST_R2 = 0.95       # of the published law
LEAST_GAMMAS = 5
COLLAPSED = 0.5       # of the height at the start: an arm length of which no run falls below has no lowest height
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#7b2d8b", "#bc6c25", "#606c38", "#9a031e"]


def read(name):
    found = re.fullmatch(r"arm-([0-9.]+)-gamma-([0-9.]+)-([0-9]+)", name)
    if not found:
        sys.exit(f"staples.py: '{name}' is no arm-RATIO-gamma-GAMMA-SEED")
    record, run = record_of(name), scree.open(f"{name}.run")
    case = case_of(record)
    gravity = -si(case.get("gravity", [0, 0, -9.81])[2])
    floor = case["walls"][0]["motion"]["oscillate"]
    amplitude, frequency, phase = (si(floor[key]) for key in ("amplitude", "frequency", "phase"))
    first, last = run.frames[0].bodies, run.frames[-1].bodies
    mass = first.mass.sum()
    time, potential = run.log["time"], run.log["potential"]
    turn = 2 * math.pi * frequency
    # from the first row of the log on, and to half a period before its last
    at = np.arange(time[0], time[-1], 1 / (POINTS * frequency))
    height = np.interp(at, time, potential) / (mass * gravity) - amplitude * (np.sin(turn * at + phase) - math.sin(phase))
    means = np.convolve(height, np.full(POINTS, 1 / POINTS), "valid")
    if not len(means):
        sys.exit(f"staples.py: {name} is shorter than a period of the floor")
    centres = at[:len(means)] + 0.5 * (POINTS - 1) * (at[1] - at[0])
    depth = np.asarray(run.log["max_depth_ratio"])
    return {"name": name, "arm": float(found[1]), "gamma": amplitude * turn ** 2 / gravity, "seed": int(found[3]), "frequency": frequency,
            "bodies": len(first), "lost": len(first) - len(last), "duration": float(centres[-1]), "start": float(height[0]), "end": float(means[-1]),
            "time": np.concatenate([[0], centres]), "height": np.concatenate([[height[0]], means]),
            "deepest": float(depth.max()), "usual": float(np.median(depth)), "energy_error": float(np.abs(run.log["energy_error"]).max() / run.log["dissipated"][-1]),
            "steps": int(record["steps"]), "step": float(record["time"]) / int(record["steps"]), "seconds": float(record["wall_seconds"])}


def lifetime(run, floor):
    """The time at which a column has fallen by 1 - 1/e down to a lowest height, and whether it has."""
    if floor is None:
        return run["duration"], False
    threshold = run["start"] - (1 - math.exp(-1)) * (run["start"] - floor)
    below = np.flatnonzero(run["height"] <= threshold)
    if not len(below):
        return run["duration"], False
    k = int(below[0])
    (t0, t1), (h0, h1) = run["time"][k - 1:k + 1], run["height"][k - 1:k + 1]
    return float(t0 + (h0 - threshold) / (h0 - h1) * (t1 - t0)), True


def fit(gammas, values, has_collapsed, with_intercept=True):
    """Intercept and Delta with their intervals, covariance and scatter; None for fewer runs than numbers to find."""
    design = np.stack([np.ones_like(gammas), 1 / gammas], axis=1) if with_intercept else (1 / gammas)[:, None]
    free = len(values) - design.shape[1]
    if free < 1 or len(set(gammas)) < 2 or has_collapsed.sum() <= design.shape[1]:
        return None

    def cost(x):
        scatter = math.exp(x[-1])
        z = (values - design @ x[:-1]) / scatter
        return -(norm.logpdf(z[has_collapsed]) - x[-1]).sum() - norm.logsf(z[~has_collapsed]).sum()

    line = np.linalg.lstsq(design[has_collapsed], values[has_collapsed], rcond=None)[0]
    left = (values - design @ line)[has_collapsed]
    start = np.append(line, math.log(max(1e-3, left.std())))
    best = minimize(cost, start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-11, "maxiter": 40000, "maxfev": 40000}).x
    # curvature by central differences
    steps = 1e-3 * np.maximum(0.1, np.abs(best))
    n = len(best)
    curvature = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            a, b = np.eye(n)[i] * steps[i], np.eye(n)[j] * steps[j]
            curvature[i, j] = (cost(best + a + b) - cost(best + a - b) - cost(best - a + b) + cost(best - a - b)) / (4 * steps[i] * steps[j])
    covariance = np.linalg.inv(curvature)[:-1, :-1] * len(values) / free   # as least squares: scatter from the degrees of freedom
    half = student.ppf(0.975, free) * np.sqrt(np.diag(covariance))
    return {"values": best[:-1].tolist(), "half": half.tolist(), "scatter": math.exp(best[-1]) * math.sqrt(len(values) / free), "free": free}


def determination(gammas, values, has_collapsed):
    """r^2 of a line through the means at each acceleration at which all runs have collapsed, and their number."""
    kept = [gamma for gamma in sorted(set(gammas)) if has_collapsed[gammas == gamma].all()]
    if len(kept) < 3:
        return None, len(kept)
    means = [values[gammas == gamma].mean() for gamma in kept]
    return float(np.corrcoef(1 / np.array(kept), means)[0, 1] ** 2), len(kept)


def judged_arms(runs):
    arms = {}
    for ratio in sorted({run["arm"] for run in runs}):
        own = [run for run in runs if run["arm"] == ratio]
        lowest = min(run["end"] for run in own)
        # nothing has collapsed: there is no lowest height
        floor = lowest if lowest < COLLAPSED * own[0]["start"] else None
        for run in own:
            run["lifetime"], run["collapsed"] = lifetime(run, floor)
            below = np.flatnonzero(run["height"] <= 0.5 * run["start"])
            run["half_time"] = float(run["time"][below[0]]) if len(below) else None
        gammas = np.round([run["gamma"] for run in own], 9)
        values = np.log([run["frequency"] * run["lifetime"] for run in own])
        has = np.array([run["collapsed"] for run in own])
        halves = np.log([run["frequency"] * (run["half_time"] or run["duration"]) for run in own])
        has_half = np.array([run["half_time"] is not None for run in own])
        r2, count = determination(gammas, values, has)
        arms[ratio] = {"runs": own, "gammas": gammas, "values": values, "collapsed": has, "lowest": lowest, "line": fit(gammas, values, has), "through_zero": fit(gammas, values, has, False),
                       "half_line": fit(gammas, halves, has_half), "r2": r2, "r2_gammas": count, "start": float(np.mean([run["start"] for run in own])), "bodies": own[0]["bodies"]}
    return arms


def pair(line, k):
    return f"{line['values'][k]:.2f} +- {line['half'][k]:.2f}" if line else "no fit"


def verdicts(arms):
    """(claim, measured, verdict) of each claim of the paper."""
    rows = []
    for ratio, arm in arms.items():
        if arm["r2"] is None:
            measured, verdict = f"all runs have collapsed at {arm['r2_gammas']} accelerations", "not judged"
        else:
            measured = f"r^2 = {arm['r2']:.3f} over {arm['r2_gammas']} accelerations"
            missed = [f"r^2 by {LEAST_R2 - arm['r2']:.3f}"] * (arm["r2"] <= LEAST_R2) + [f"{arm['r2_gammas']} of {LEAST_GAMMAS} accelerations"] * (arm["r2_gammas"] < LEAST_GAMMAS)
            verdict = "misses: " + ", ".join(missed) if missed else "holds"
        rows.append((f"l/w = {ratio:g}: ln(f tau) is linear in 1/Gamma, r^2 above {LEAST_R2} over at least {LEAST_GAMMAS} accelerations", measured, verdict))
    for ratio, arm in arms.items():
        line = arm["line"]
        if not line:
            rows.append((f"l/w = {ratio:g}: intercept 0 within its interval", "no fit", "not judged"))
            continue
        beyond = abs(line["values"][0]) - line["half"][0]
        rows.append((f"l/w = {ratio:g}: intercept 0 within its interval", pair(line, 0), "holds" if beyond <= 0 else f"misses by {beyond:.2g} beyond the interval"))
    ratios = [ratio for ratio in arms if arms[ratio]["line"]]
    for key, k, label in (("line", 1, "Delta is largest at a middle arm length"), ("through_zero", 0, "the same, of lines through the origin")):
        if len(ratios) < 3:
            rows.append((label, f"{len(ratios)} arm lengths", "not judged"))
            continue
        delta = {ratio: (arms[ratio][key]["values"][k], arms[ratio][key]["half"][k]) for ratio in ratios}
        top = max(delta, key=lambda ratio: delta[ratio][0])
        measured = ", ".join(f"{value:.2f} +- {half:.2f} at {ratio:g}" for ratio, (value, half) in delta.items())
        if top in (ratios[0], ratios[-1]):
            rows.append((label, measured, f"misses: largest at l/w = {top:g}"))
            continue
        is_clear = all(delta[top][0] - delta[end][0] > math.hypot(delta[top][1], delta[end][1]) for end in (ratios[0], ratios[-1]))
        rows.append((label, measured, f"holds, at l/w = {top:g}" if is_clear else f"largest at l/w = {top:g}, but the differences to both ends are within the intervals"))
    return rows


runs = [read(name) for name in NAMES]
arms = judged_arms(runs)
claims = verdicts(arms)

lines = ["# Staples", "", "| arm length l/w | staples | height at the start [mm] | lowest height [mm] | runs | not collapsed in their time | Delta | intercept | r^2 of the means | Delta of a line through the origin | Delta from half the height | intercept from half the height |",
         "|---|---|---|---|---|---|---|---|---|---|---|---|"]
for ratio, arm in arms.items():
    r2 = f"{arm['r2']:.3f} ({arm['r2_gammas']})" if arm["r2"] is not None else "-"
    lines.append(f"| {ratio:g} | {arm['bodies']} | {1e3 * arm['start']:.1f} | {1e3 * arm['lowest']:.1f} | {len(arm['runs'])} | {(~arm['collapsed']).sum()} | {pair(arm['line'], 1)} | {pair(arm['line'], 0)} | {r2} | "
                 f"{pair(arm['through_zero'], 0)} | {pair(arm['half_line'], 1)} | {pair(arm['half_line'], 0)} |")
lines += ["", "| published claim | measured | verdict |", "|---|---|---|", *(f"| {' | '.join(row)} |" for row in claims), "",
          "| run | Gamma | lifetime [periods] | height at the end over that at the start | bodies lost | usual and largest overlap over the sum of margins | largest energy error over dissipated | steps | run time [s] |", "|---|---|---|---|---|---|---|---|---|"]
for run in runs:
    lived = ("" if run["collapsed"] else "above ") + f"{run['frequency'] * run['lifetime']:.1f}"
    lines.append(f"| {run['name']} | {run['gamma']:.2f} | {lived} | {run['end'] / run['start']:.2f} | {run['lost']} | {run['usual']:.3f}, {run['deepest']:.3f} | {run['energy_error']:.1e} | {run['steps']} | "
                 f"{run['seconds']:.0f} |")
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("\n".join(lines) + "\n")

with open(RESULT, "w", encoding="utf-8") as file:
    json.dump({"arms": {f"{ratio:g}": {key: arm[key] for key in ("bodies", "start", "lowest", "line", "through_zero", "half_line", "r2", "r2_gammas")} for ratio, arm in arms.items()},
               "claims": [dict(zip(("claim", "measured", "verdict"), row)) for row in claims],
               "runs": [{key: value for key, value in run.items() if key not in ("time", "height")} for run in runs]}, file, indent=1)
    file.write("\n")

figure, ((shots, left), (middle, right)) = plt.subplots(2, 2, figsize=(10.4, 7.8), layout="constrained")
pair_of_shots = [plt.imread(path)[..., :3] for path in (BEFORE, AFTER)]
# one frame of both, without the empty margins; each with its own rows
columns = np.flatnonzero(np.logical_or(*[(shot < 0.97).any(axis=(0, 2)) for shot in pair_of_shots]))
parts = []
for shot in pair_of_shots:
    rows = np.flatnonzero((shot < 0.97).any(axis=(1, 2)))
    parts += [shot[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1], np.ones((25, columns[-1] + 1 - columns[0], 3))]
shots.imshow(np.concatenate(parts[:-1]))
shots.axis("off")
shown = next((run for run in runs if run["name"] == SHOWN), runs[0])
shots.set_title(f"l/w = {shown['arm']:g}, $\\Gamma$ = {shown['gamma']:.3g}: at the start and at the end; colour: height at the start", fontsize="medium")
own = [run for run in arms[shown["arm"]]["runs"] if run["seed"] == shown["seed"]]
for run, shade in zip(own, plt.cm.viridis(np.linspace(0, 0.9, len(own)))):
    left.plot(run["frequency"] * run["time"], 1e3 * run["height"], color=shade, linewidth=1.2, label=rf"$\Gamma$ = {run['gamma']:.3g}")
    if run["collapsed"]:
        left.plot(run["frequency"] * run["lifetime"], 1e3 * np.interp(run["lifetime"], run["time"], run["height"]), "o", color=shade, markersize=5)
left.set(xlabel="periods of the floor", ylabel="height of the centre of mass [mm]", title=f"l/w = {shown['arm']:g}; dots: lifetime", ylim=(0, None), xlim=(0, None))
left.legend(frameon=False, loc="upper right", ncols=2)
for (ratio, arm), colour in zip(arms.items(), COLOURS):
    x = 1 / arm["gammas"]
    for has, face in ((arm["collapsed"], colour), (~arm["collapsed"], "none")):
        if has.any():
            middle.plot(x[has], arm["values"][has], "o" if face == colour else "^", color=colour, markersize=4.5, markerfacecolor=face)
    ends = np.array([0, 1.05 * x.max()])
    if arm["line"]:
        middle.plot(ends, arm["line"]["values"][0] + arm["line"]["values"][1] * ends, color=colour, linewidth=1)
    middle.plot([], [], "o-", color=colour, markersize=4.5, linewidth=1, label=f"l/w = {ratio:g}")
middle.axhline(0, color="#888888", linewidth=0.6)
censored = any((~arm["collapsed"]).any() for arm in arms.values())
middle.set(xlabel=r"1 / $\Gamma$", ylabel=r"ln(f $\tau$)", title="all runs" + ("; triangles: not yet collapsed at the end" if censored else ""), xlim=(0, None))
middle.legend(frameon=False, loc="upper left")
fitted = False
for key, k, marker, colour, label in (("line", 1, "o", "#000000", "slope of the line"), ("through_zero", 0, "s", "#888888", "slope of a line through the origin")):
    found = [(ratio, arm[key]["values"][k], arm[key]["half"][k]) for ratio, arm in arms.items() if arm[key]]
    if found:
        x, value, half = np.array(found).T
        right.errorbar(x, value, half, fmt=marker + "-", color=colour, capsize=3, linewidth=1, label=label)
        fitted = True
right.set(xlabel="arm length l / width w", ylabel=r"$\Delta$", title=r"$\tau$ = exp($\Delta$ / $\Gamma$) / f, intervals of 95 %", xlim=(0, None))
if fitted:
    right.legend(frameon=False)
figure.savefig(SVG, metadata={"Date": None})
figure.savefig(PNG, dpi=150)
