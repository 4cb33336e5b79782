#!/usr/bin/env python3
"""Draws the plots P1, P2, P4, P5, P8 of validation plan 4.5. usage: plots.py FOLDER (reads *.json and fronts/, writes P*.svg and P*.png)

The front of a plot: settings for which no other is both faster and more accurate, as scree-post error-vs-time finds them; marked by a
grey line and rings.
"""
import csv
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

FOLDER = sys.argv[1]
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#000000", "#999999"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X", "*"]
plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": .3, "svg.hashsalt": "scree", "legend.fontsize": 8, "legend.framealpha": .8, "axes.titlesize": 9.5})


def load(name):
    with open(os.path.join(FOLDER, name + ".json")) as file:
        return [row for row in json.load(file) if "refused" not in row]


def save(figure, name):
    figure.tight_layout()
    figure.savefig(os.path.join(FOLDER, name + ".svg"), metadata={"Date": None})
    figure.savefig(os.path.join(FOLDER, name + ".png"), dpi=110)
    plt.close(figure)


def curves(rows):
    """Names of the curves in the order they come."""
    return list(dict.fromkeys(row["curve"] for row in rows))


def table_of(name):
    with open(os.path.join(FOLDER, "fronts", name)) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def mark_front(axes, case, error, without="none", label="front"):
    """Line and rings around the front of a case; leaves out settings whose name begins with `without`, which the plot does not draw."""
    best = sorted((float(row["time"]), float(row["error"])) for row in table_of("fronts.csv")
                  if row["case"] == case and row["error_column"] == error and row["on_front"] == "yes" and not row["choice"].startswith(without))
    if best:
        axes.plot(*zip(*best), color="0.35", linewidth=4, alpha=.25, zorder=0, label=label)
        axes.plot(*zip(*best), linestyle="", marker="o", markersize=9, markerfacecolor="none", markeredgecolor="0.35")


def draw(axes, rows, x, y, label=True, floor=1e-17):
    names = curves(rows)
    for n, name in enumerate(names):
        own = sorted((row for row in rows if row["curve"] == name), key=lambda row: row[x])
        axes.loglog([row[x] for row in own], [max(row[y], floor) for row in own], color=COLOURS[n % len(COLOURS)], marker=MARKERS[n % len(MARKERS)], markersize=4, linewidth=1.2,
                    label=name if label else None)


def slope(own, x, y):
    """Order in x of a curve's finer half, where it is above rounding."""
    own = sorted((row for row in own if row[y] > 1e-12), key=lambda row: row[x])[:4]
    if len(own) < 3:
        return None
    return numpy.polyfit(numpy.log([row[x] for row in own]), numpy.log([row[y] for row in own]), 1)[0]


def p1_p2():
    panels = [("integrators", "R1", "error_traj", "free rotation (R1): orientation error [rad]"),
              ("integrators", "R2", "error_traj", "about the middle axis (R2): orientation error [rad]"),
              ("impact", "linear", "error_e", "impact, linear law: |e - 0.5|, worst phase"),
              ("impact", "hunt-crossley", "error_e", "impact, Hunt-Crossley: |e - 0.5|, worst phase"),
              ("impact", "hertz-mindlin", "error_e", "impact, Hertz: |e - 0.5|, worst phase"),
              ("collision", "rocks", "error_traj", "12 pairs of concave rocks: position error [m]")]
    panels = [(rows, title, key, f"{study} {case}") for study, case, key, title in panels if (rows := [row for row in load(study) if row["case"] == case])]
    for name, x, xlabel in (("P1", "seconds", "time of the steps [s]"), ("P2", "step", "step [s]")):
        columns = (len(panels) + 1) // 2
        figure, axes = plt.subplots(2, columns, figsize=(4.3 * columns, 7.4))
        for ax in axes.flat[len(panels):]:
            ax.set_axis_off()
        for ax, (rows, title, key, case) in zip(axes.flat, panels):
            if name == "P2":
                rows = [dict(row) for row in rows]
                for curve in curves(rows):
                    order = slope([row for row in rows if row["curve"] == curve], "step", key)
                    for row in rows:
                        if row["curve"] == curve and order is not None:
                            row["curve"] = f"{curve}: order {order:.2f}"
            draw(ax, rows, x, key)
            if name == "P1":
                mark_front(ax, case, key)
            ax.set_title(title)
            ax.set_xlabel(xlabel)
            ax.legend()
        save(figure, name)


def p4():
    rows = load("mesh")
    finest = max(row["steps_per_contact"] for row in rows)
    figure, axes = plt.subplots(2, 3, figsize=(14, 7.4))
    for ax, kind in zip(axes[0], ("icosphere", "scan", "cube")):
        own = [dict(row, curve=f"{row['curve']}, {row['steps_per_contact']} steps") for row in rows if row["case"] == kind]
        draw(ax, own, "triangles", "error_e")
        ax.set_title(f"{kind}, rotation locked: |e - 0.5|, by steps a contact")
        ax.set_xlabel("triangles")
        ax.set_ylim(1e-7, 3e2)  # room for the legend above the curves; one scale for all three
        ax.legend(loc="upper left", ncol=2)
    own = [dict(row, curve=row["curve"]) for row in rows if row["steps_per_contact"] == finest]
    for n, (kind, style) in enumerate((("icosphere", "-"), ("scan", ":"), ("cube", "--"))):
        for name in curves(own):
            points = sorted((row["triangles"], row["duration"]) for row in own if row["case"] == kind and row["curve"] == name)
            if not points:
                continue
            i = curves(own).index(name)
            axes[1, 0].semilogx(*zip(*points), style, color=COLOURS[i], marker=MARKERS[n], markersize=4, label=f"{kind}, {name}")
    axes[1, 0].set_ylim(0, 1.3 * max(row["duration"] for row in own))
    axes[1, 0].set_title(f"duration of the contact [s], {finest} steps a contact")
    axes[1, 0].set_xlabel("triangles")
    own = [dict(row, curve=f"{row['case']}, " + (f"{row['steps_per_contact']} steps" if row["curve"] == "potential" else row["curve"])) for row in rows
           if row["curve"] != "pairs"]
    draw(axes[1, 1], own, "seconds", "error_e")
    for kind, label in (("icosphere", "fronts"), ("scan", None), ("cube", None)):
        mark_front(axes[1, 1], f"mesh {kind}", "error_e", without="pairs", label=label)
    axes[1, 1].set_title("|e - 0.5| against time, all refinements")
    axes[1, 1].set_xlabel("time of the steps [s]")
    # many curves in both: their legends have the last field
    axes[1, 2].axis("off")
    for ax, title, place in ((axes[1, 0], "duration (left)", "upper left"), (axes[1, 1], "|e - 0.5| against time (middle)", "upper right")):
        axes[1, 2].add_artist(axes[1, 2].legend(*ax.get_legend_handles_labels(), title=title, fontsize=7, title_fontsize=8, loc=place))
    save(figure, "P4")


def p5():
    rows = load("margin")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4))
    for ax, x, y, title, xlabel in ((axes[0], "margin", "error_traj", "angular momentum after a corner impact:\nerror against the rigid body", "margin sum over smallest size"),
                                    (axes[1], "margin", "step", "step [s]", "margin sum over smallest size"),
                                    (axes[2], "seconds", "error_traj", "error against time", "time of the steps [s]")):
        draw(ax, rows, x, y)
        if x == "seconds":
            mark_front(ax, "margin corner", y)
        ax.set_title(title)
        ax.set_xlabel(xlabel)
        ax.legend()
    save(figure, "P5")


def p8():
    rows = load("drift")
    cases = list(dict.fromkeys(row["case"] for row in rows))
    figure, axes = plt.subplots(1, len(cases), figsize=(5 * len(cases), 4))
    for ax, case in zip(numpy.atleast_1d(axes), cases):
        for n, row in enumerate(row for row in rows if row["case"] == case):
            # thinner curves on top, since some integrators coincide
            ax.loglog(numpy.array(row["time"])[1:], numpy.maximum(row["error"], 1e-17)[1:], color=COLOURS[n], linewidth=3 - .5 * n, label=row["curve"])
        ax.set_title(f"{case}: |dE|/E")
        ax.set_xlabel("time [s]")
        ax.legend()
    save(figure, "P8")


def p9():
    rows = load("attraction")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4))
    for ax, x, y, title, xlabel in ((axes[0], "steps_per_contact", "error_e", "speed of leaving: error against that of the range", "steps a contact"),
                                    (axes[1], "steps_in_range", "error_e", "the same", "steps through the range"),
                                    (axes[2], "seconds", "to_narrow", "error against a range of 0.1 um\nof the same work of separation", "time of the steps [s]")):
        draw(ax, rows, x, y)
        ax.set_title(title)
        ax.set_xlabel(xlabel)
        ax.legend(loc="center right" if x == "seconds" else "upper right")
    save(figure, "P9")


def table():
    """The folded table of the page, as Markdown: per case the cheapest setting that reaches an error."""
    rows = table_of("best.csv")
    errors = {case: {row["error_column"] for row in rows if row["case"] == case} for case in {row["case"] for row in rows}}
    lines = ["<details><summary>Cheapest setting for a given error</summary>", "", "| study | error at most | cheapest setting | its error | s |", "|---|---|---|---|---|"]
    for row in rows:
        name = row["case"].replace(" ", ", ", 1) + (f", {row['error_column']}" if len(errors[row["case"]]) > 1 else "")
        lines.append(f"| {name} | {row['at_most']} | {row['choice']} | {float(row['error']):.2g} | {float(row['time']):.2g} |")
    with open(os.path.join(FOLDER, "fronts.md"), "w") as file:
        file.write("\n".join(lines) + "\n\n</details>\n")


for part in (p1_p2, p4, p5, p8, p9, table):
    part()
