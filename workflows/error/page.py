"""The results for people and programs: error.md, error.csv, error.json, and the chart of error against run time."""
import csv
import json
import math
import os

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FuncFormatter  # noqa: E402

from plan import MOST  # noqa: E402
from settings import CASE, PARTS  # noqa: E402

COLOURS = ["#000000", "#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#009E73", "#CC79A7", "#999999"]   # Okabe and Ito (2008): told apart by all
MARKERS = "osD^vP*X"
MOST_CHARTS = 3
REMEDY = {"seeds": "more seeds", "step": "a smaller step", "stiffness": "stiffer contacts", "margin": "a smaller margin", "shape": "shapes with more triangles"}


def duration(seconds):
    if not math.isfinite(seconds):
        return "unknown"
    if seconds < 90:
        return f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def seeds_text(count):
    return f"{count} seed{'s' if count > 1 else ''}"


def figure_of(x, sign=""):
    """Two digits, without an exponent where that is readable."""
    if not math.isfinite(x):
        return "unknown"
    if x == 0 or 1e-3 <= abs(x) < 100:
        return f"{x:{sign}.2g}"
    return f"{round(x, 1 - math.floor(math.log10(abs(x)))):{sign}.0f}" if 100 <= abs(x) < 1e6 else f"{x:{sign}.1e}"


def with_unit(x, unit):
    return figure_of(x) + ("" if unit in ("", "-") or not math.isfinite(x) else f" {unit}")


def cell(text):
    return str(text).replace("|", "\\|").replace("\n", " ")


def table(header, rows):
    return ["| " + " | ".join(header) + " |", "|" + "---|" * len(header), *("| " + " | ".join(map(cell, row)) + " |" for row in rows), ""]


def verdict(answer, report):
    """Whether the goal is reached, and what would reach it."""
    if math.isnan(answer.total):
        return "unknown: a setting has one seed only"
    if answer.is_enough:
        return f"reached with {seeds_text(answer.seeds.count if report.is_seeded else 1)}"
    needed = answer.seeds_for_goal
    if needed is not None:
        further = max(0, needed - min(answer.counts.values()))
        return f"not reached; about {needed} seeds of every setting would reach it, {further} more than now"
    part = max(answer.effects, key=lambda name: abs(answer.effects[name].interval.value), default=None)
    if part is None:
        return "not reached at the settings of this case"
    return (f"not reached{', and no number of seeds reaches it' if report.is_seeded else ''}: the effects of the settings add up to {figure_of(answer.bias, '+')}; "
            f"the largest is that of the {part}: use {REMEDY[part]}")


def effect_text(answer, part):
    entry = answer.effects.get(part)
    if entry is None:
        return "-"
    text = figure_of(entry.interval.value, "+") + (f" +- {figure_of(entry.interval.half)}" if math.isfinite(entry.interval.half) else "")
    if entry.order is not None:
        return f"{text} (order {entry.order:.2g})"
    return text if entry.interval.is_seen or entry.interval.half == 0 or math.isnan(entry.interval.half) else f"{text} (not seen)"


def largest_text(answer):
    part, _ = answer.largest
    if part in (None, "seeds"):
        return part or "-"
    entry = answer.effects[part]
    return f"{part}, {figure_of(entry.interval.value, '+')}" + (f" +- {figure_of(entry.interval.half)}" if entry.interval.half > 0 else "")


def numbers_table(answers):
    return table(["number", "value and errors", "total error", "largest error"], [(entry.label, entry.text, with_unit(entry.total, entry.unit), largest_text(entry)) for entry in answers])


def keys_text(setting):
    """The keys that a setting changes; of shapes the files."""
    files = [name.split(".")[1] for name, value in setting.keys.items() if value.endswith(".shape.h5")]
    if files:
        return f"file of the shape{'s' if len(files) > 1 else ''} {', '.join(files)}"
    return ", ".join(f"{key} = {value}" for key, value in setting.keys.items()) or "-"


def cheapest(answer, report):
    """(setting, seeds, core time) that reaches the goal for the least core time; None where none does."""
    best = None
    for setting in answer.settings:
        cost = report.costs.mean(setting)
        for count in (range(2, MOST + 1) if report.is_seeded else [1]) if cost else ():
            if answer.error_at(setting, count) <= answer.goal:
                if best is None or count * cost < best[2]:
                    best = setting, count, count * cost
                break
    return best


def chart(answers, report, files):
    figure, plots = plt.subplots(1, len(answers), figsize=(5.6 * len(answers) + 0.6, 4.4), layout="constrained", squeeze=False)
    order = [setting.name for setting in report.settings]
    for answer, plot in zip(answers, plots[0]):
        for setting, (runs, _) in sorted(answer.settings.items(), key=lambda entry: order.index(entry[0])):
            cost = report.costs.mean(setting)
            if not cost or (setting != CASE and runs.count < 2):
                continue
            counts = np.arange(2, MOST + 1) if report.is_seeded else np.array([1])
            errors = np.array([answer.error_at(setting, count) for count in counts])
            number = order.index(setting) % len(COLOURS)
            label = report.named[setting].what.partition(" (")[0] if setting != CASE else "the case"
            plot.plot(counts * cost, errors, color=COLOURS[number], lw=2 if setting == CASE else 1, alpha=1 if setting == CASE else 0.7)
            now = max(2, runs.count) if report.is_seeded else 1
            plot.plot(now * cost, answer.error_at(setting, now), MARKERS[number], color=COLOURS[number], label=f"{label}, {now} run{'s' if now > 1 else ''}")
        if answer.goal is not None:
            plot.axhline(answer.goal, color="black", ls="--", lw=1)
            plot.annotate(f"goal {with_unit(answer.goal, answer.unit)}", (0.98, answer.goal), xycoords=("axes fraction", "data"), ha="right", va="bottom", fontsize="small")
            best = cheapest(answer, report)
            if best:
                plot.plot(best[2], answer.error_at(best[0], best[1]), "o", ms=14, mfc="none", mec="black", label=f"cheapest: {report.named[best[0]].what.partition(' (')[0]}, {seeds_text(best[1])}")
        plot.set_xscale("log")
        if all(np.min(line.get_ydata()) > 0 for line in plot.lines):
            plot.set_yscale("log")
        for axis in (plot.xaxis, plot.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            axis.set_minor_formatter(FuncFormatter(lambda x, _: f"{x:g}" if f"{x:.0e}"[0] in "25" else ""))
        plot.set_xlabel("core time of all seeds [s]")
        plot.set_ylabel(f"total error of {answer.label.replace('_', ' ')}" + (f" [{answer.unit}]" if answer.unit not in ("", "-") else ""))
        plot.grid(alpha=0.3, which="both")
        plot.legend(fontsize="x-small")
    for file in files:
        figure.savefig(file, dpi=150, metadata={"Date": None} if file.endswith("svg") else None)
    plt.close(figure)


def settings_rows(report, first):
    rows = []
    for setting in report.settings:
        done = len(report.there(setting.name))
        mean = report.costs.mean(setting.name)
        if setting.why_not:
            rows.append((setting.what, "not possible: " + setting.why_not, 0, "-", "-", "-"))
            continue
        failed = report.failed.get(setting.name)
        note = f"failed: {failed}" if failed else keys_text(setting)
        if setting.name != CASE and not failed and not done:
            note += " (not run: " + ("the budget did not allow it" if report.seconds else "it was interrupted") + ")"
        effect = effect_text(first, setting.part) if first and setting.is_finer else "-"
        rows.append((setting.what, note, done, duration(mean) if mean else "-", duration(sum(report.costs.measured.get(setting.name, []))), effect))
    return rows


def markdown(report, answers, first):
    main = first[0] if first else None
    lines = [f"# {report.title}: numbers with their errors", ""]
    if report.case_title:
        lines += [f"Case: {report.case_title}. {report.times}", ""]
    lines += ["## Results", ""]
    lines += numbers_table(first)
    lines += ["The value is the mean of the runs at the settings of the case. `+- (seeds)` is the half width of its 95 % interval: each seed packs the bodies in another way. `(step)`, `(stiffness)`, `(margin)` and "
              "`(shape)` are what the settings of the computation add to the value: the value at the setting of the case less the value at the finer setting, from runs with the same seeds. Effects that are zero in the digits "
              "shown are left out. Each effect has an interval, too (table of settings). The total error is the size of the sum of the effects, plus the root of the sum of squares of all half widths.", ""]
    if any(math.isnan(entry.total) for entry in first):
        lines += ["The total error is unknown where a setting has one seed only: one difference has no interval.", ""]
    goals = [entry for entry in first if entry.goal is not None]
    if goals:
        rows = []
        for entry in goals:
            best = cheapest(entry, report)
            rows.append((entry.label, with_unit(entry.goal, entry.unit), with_unit(entry.total, entry.unit), verdict(entry, report),
                         f"{report.named[best[0]].what}, {seeds_text(best[1])}, {duration(best[2])} of a core" if best else "none of those tried"))
        lines += ["## Goals", "", *table(["number", "goal", "total error", "verdict", "cheapest setting that reaches it"], rows)]
    if not report.is_seeded:
        lines += ["All seeds give the same bits: this case has no random numbers. One run of each setting is enough, and the intervals have no width.", ""]
    if main and len(main.settings) > 1:
        lines += ["![Total error against core time](error.png)", ""]
        lines += ["Each line is a setting: its error falls with the number of seeds, from 2 to 40, down to what the setting itself adds. Markers: the seeds that were run.", ""] if report.is_seeded else []
    lines += ["## Settings", "", *table(["setting", "keys", "seeds", "one run", "core time", f"effect on {main.label}" if main else "effect"], settings_rows(report, main))]
    for part, entry in main.effects.items() if main else ():
        if entry.note:
            lines += [f"The effect of the {part} is {entry.note}. It is the difference to the finer setting, the least that it can be.", ""]
    if main and main.missing:
        lines += ["Not in the total: " + "; ".join(f"{part} ({why})" for part, why in main.missing.items()) + ".", ""]
    lines += report.remarks + ([""] if report.remarks else [])
    lines += [f"Core time of all runs: {duration(sum(map(sum, report.costs.measured.values())))}." + (f" Budget: {duration(report.seconds)}, used {duration(report.used)}." if report.seconds else ""), ""]
    if report.left:
        counts = {}
        for name, _ in report.left:
            counts[name] = counts.get(name, 0) + 1
        lines += ["The budget did not allow: " + "; ".join(f"{count} run{'s' if count > 1 else ''} of {report.named[name].what} ({duration(report.costs.of(name))} each)" for name, count in counts.items())
                  + ". The same command with a larger budget goes on from here.", ""]
    rest = [entry for entry in answers if entry not in first]
    same = [entry for entry in rest if entry.is_constant]
    if len(rest) > len(same):
        lines += ["## All other numbers", "", *numbers_table([entry for entry in rest if not entry.is_constant])]
    if same and report.is_seeded:
        lines += ["The same in all runs: " + ", ".join(f"{entry.label} = {with_unit(entry.seeds.value, entry.unit)}" for entry in same) + ".", ""]
    lines += ["Methods, and what the intervals do not include: `workflows/README.md`, section on errors."]
    return "\n".join(lines) + "\n"


def record_of(answer, report):
    best = cheapest(answer, report) if answer.goal is not None else None
    return {"name": answer.name, "unit": answer.unit, "value": answer.seeds.value, "low": answer.seeds.low, "high": answer.seeds.high, "half_width": answer.seeds.half, "seeds": answer.seeds.count if report.is_seeded else 1,
            "method": answer.seeds.method, "total_error": answer.total, "text": answer.text, "largest": answer.largest[0], "goal": answer.goal, "reached": answer.is_enough if answer.goal is not None else None,
            "seeds_for_goal": answer.seeds_for_goal if answer.goal is not None else None, "cheapest": {"setting": best[0], "seeds": best[1], "core_seconds": best[2]} if best else None,
            "effects": {part: {"value": entry.interval.value, "low": entry.interval.low, "high": entry.interval.high, "half_width": entry.interval.half, "seeds": entry.interval.count,
                               "order": entry.order, "note": entry.note} for part, entry in answer.effects.items()}, "missing": answer.missing}


def plain_numbers(value):
    """JSON has no NaN."""
    if isinstance(value, dict):
        return {key: plain_numbers(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [plain_numbers(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write(report, answers, first, folder="."):
    here = lambda name: os.path.join(folder, name)  # noqa: E731
    drawn = [entry for entry in first if math.isfinite(entry.total) and not entry.is_constant][:MOST_CHARTS]
    if drawn:
        chart(drawn, report, [here("error.svg"), here("error.png")])
    with open(here("error.md"), "w", encoding="utf-8") as file:
        file.write(markdown(report, answers, first))
    records = [record_of(entry, report) for entry in answers]
    content = {"format": "scree-error", "format_version": 1, "case": report.title, "seeded": report.is_seeded, "first": [entry.name for entry in first],
               "settings": [{"name": setting.name, "part": setting.part, "side": setting.side, "what": setting.what, "keys": setting.keys, "why_not": setting.why_not or report.failed.get(setting.name, ""),
                             "seeds": sorted(report.there(setting.name)), "core_seconds": sum(report.costs.measured.get(setting.name, []))} for setting in report.settings],
               "budget": report.seconds, "used": report.used, "not_afforded": [list(job) for job in report.left], "numbers": records}
    with open(here("error.json.part"), "w", encoding="utf-8") as file:
        json.dump(plain_numbers(content), file, indent=1)
    os.replace(here("error.json.part"), here("error.json"))
    with open(here("error.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        of_parts = [f"{part}_{kind}" for part in PARTS for kind in ("effect", "half_width", "seeds")]
        writer.writerow(["number", "unit", "value", "low", "high", "half_width", "seeds", "method", "total_error", *of_parts])
        for record in records:
            parts = [record["effects"].get(part, {}).get(kind) for part in PARTS for kind in ("value", "half_width", "seeds")]
            writer.writerow([record[key] for key in ("name", "unit", "value", "low", "high", "half_width", "seeds", "method", "total_error")] + parts)
