#!/usr/bin/env python3
"""What passes a screen, and when. usage: screen.py TABLE.md CHART.svg CHART.png NAME

passing    share of the rocks of a size that have come in and passed the deck; counted by number, those still on the deck left out of the recovery
rate       of the fine rocks that are on the deck, how many pass per second (maximum likelihood: those that pass over the time that all of them spend
           on it), from the time by which a tenth of them passes: the others have come down to the deck by then
Gaudin     what a ball meets that falls straight on an opening: ((a - d) / (a + w))^2 each time it is thrown (A. M. Gaudin, Principles of Mineral
           Dressing, 1939); times the frequency it is a rate for one try a throw
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
OPENING, LIGAMENT = 0.012, 0.004   # of the deck, as the Snakefile has it made
record = record_of(NAME)
case = case_of(record)
run = scree.open(f"{NAME}.run")
frequency = si(case["walls"][0]["motion"]["oscillate"]["frequency"])

inserted, removed = run.inserted, run.removed
size_of = {int(i): d for i, d in zip(inserted["id"], inserted["diameter"])}
mass_of = {int(i): m for i, m in zip(inserted["id"], inserted["mass"])}
came = {int(i): t for i, t in zip(inserted["id"], inserted["time"])}
sizes = {"fine": min(size_of.values()), "coarse": max(size_of.values())}
kind = {i: "fine" if d < 0.5 * (sizes["fine"] + sizes["coarse"]) else "coarse" for i, d in size_of.items()}
left = {int(i): (t, outlet) for i, t, outlet in zip(removed["id"], removed["time"], removed["outlet"])} if len(removed["id"]) else {}
end = run.frames[-1].time
there = {int(i) for i in run.frames[-1].bodies.id}

lines = ["| size | fed | passed the deck | left over the end | still on the deck | passed / all that left |", "| --- | --- | --- | --- | --- | --- |"]
for name in sizes:
    ids = [i for i in kind if kind[i] == name]
    under = [i for i in ids if i in left and left[i][1] == "under"]
    over = [i for i in ids if i in left and left[i][1] == "over"]
    share = f"{100 * len(under) / (len(under) + len(over)):.1f} %" if under or over else ""
    lines.append(f"| {name}, {1e3 * sizes[name]:.3g} mm | {len(ids)} | {len(under)} | {len(over)} | {len([i for i in ids if i in there])} | {share} |")
balance = sum(mass_of.values()) - sum(mass_of[i] for i in left) - sum(mass_of[i] for i in there)
lines += ["", f"Mass in, less what left and what is there: {balance:.1e} kg of {sum(mass_of.values()):.3g} kg."]

fine = [i for i in kind if kind[i] == "fine"]
passed = np.sort([left[i][0] - came[i] for i in fine if i in left and left[i][1] == "under"])
if len(passed) > 10:
    fall = np.quantile(passed, 0.1)   # by then all are on the deck
    stay = np.array([(left[i][0] if i in left else end) - came[i] - fall for i in fine])
    stay = stay[stay > 0]
    through = np.count_nonzero(passed > fall)
    rate = through / stay.sum()
    gaudin = ((OPENING - sizes["fine"]) / (OPENING + LIGAMENT)) ** 2
    lines += ["", f"Fine rocks pass at {rate:.2f} +- {1.96 * rate / through ** 0.5:.2f} per second and rock on the deck. One try a throw with Gaudin's chance of {gaudin:.4f} "
              f"would be {gaudin * frequency:.2f}: they have {rate / (gaudin * frequency):.1f} tries a throw."]

figure, (first, second) = plt.subplots(1, 2, figsize=(9.5, 3.6))
time = np.linspace(0, end, 300)
for name, colour in (("fine", "#2a6f97"), ("coarse", "#bc6c25")):
    ids = [i for i in kind if kind[i] == name]
    for words, style in ((("came in", None), ":"), (("passed", "under"), "-"), (("left at the end", "over"), "--")):
        moments = np.sort([came[i] for i in ids] if words[1] is None else [left[i][0] for i in ids if i in left and left[i][1] == words[1]])
        if len(moments):
            first.plot(time, np.searchsorted(moments, time), style, color=colour, label=f"{name}, {words[0]}")
first.set_xlabel("time [s]")
first.set_ylabel("rocks")
first.legend(frameon=False, fontsize=7)
if len(passed) > 10:
    # share not yet passed, of those that are still on the deck at that time (Kaplan and Meier)
    exits = sorted([(left[i][0] - came[i], left[i][1] == "under") if i in left else (end - came[i], False) for i in fine])
    alive, still, curve = len(exits), 1.0, [(0.0, 1.0)]
    for moment, through in exits:
        if through:
            still *= 1 - 1 / alive
            curve.append((moment, still))
        alive -= 1
    second.step(*zip(*curve), where="post", color="#2a6f97", label="fine rocks")
    at, left_then = np.linspace(fall, curve[-1][0], 100), [share for moment, share in curve if moment <= fall][-1]
    second.plot(at, left_then * np.exp(-rate * (at - fall)), color="#000000", linewidth=0.8, label=f"{left_then:.2f} exp(- {rate:.2f} (t - {fall:.2f}))")
    second.set_yscale("log")
    second.legend(frameon=False, fontsize=8)
second.set_xlabel("time since it came in [s]")
second.set_ylabel("share that has not passed")
figure.tight_layout()
figure.savefig(SVG, dpi=150)
figure.savefig(PNG, dpi=150)
with open(TABLE, "w", encoding="utf-8") as page:
    page.write("# Screen\n\n" + "\n".join(lines) + "\n")
