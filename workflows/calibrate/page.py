"""The pages of a calibration: calibration.md, calibration.json, runs.csv, and the charts surface and posterior."""
import csv
import json
import os

import matplotlib
matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from experiments import FINEST, FIXED  # noqa: E402
from posterior import narrowing, ridge  # noqa: E402
from settings import SIGMAS  # noqa: E402
from run_record import record_of  # noqa: E402  the folder above, which settings adds to the path

BLUE, ORANGE, GREEN, BLACK = "#0072B2", "#D55E00", "#009E73", "#000000"   # Okabe and Ito (2008)
NOT_APART = 0.6     # deviation of a key where another is known, over that where it is not, below which the two are not distinguished
OPEN = 0.6          # width of an interval over that of the bounds, above which the answers do not fix a key
OFF = 2.5           # standard deviations between measured and computed answer, above which no keys within the bounds give it
SPREAD = 1.5        # root mean square of the runs left out, above which the surrogate is too sure of itself
AT_BOUND = 0.01     # of the bounds
MOST_PROPOSALS = 8   # rows


def number(value, digits=3):
    return f"{value:.{digits}g}"


def judge(settings, measured, surrogates, found, share, why):
    """All numbers of the page."""
    even = found.even(2000)
    best = found.best()
    keys, answers, pairs = [], [], []
    for k, key in enumerate(settings.keys):
        low, high = found.interval(k)
        keys.append({"key": key.name, "unit": key.unit, "value": key.value(best[k]), "low": key.value(low), "high": key.value(high),
                     "mean": float(np.mean([key.value(x) for x in even[:, k]])), "lower_bound": key.low, "upper_bound": key.high,
                     "share_of_bounds": high - low, "at_lower_bound": low < AT_BOUND, "at_upper_bound": high > 1 - AT_BOUND})
    for target, (value, deviation), surrogate, ratio in zip(settings.targets, measured, surrogates, share):
        mean, unsure = (float(x[0]) for x in surrogate.predict(best[None]))
        left_out = surrogate.left_out()
        answers.append({"target": target.name, "measured": value, "measured_ci95": SIGMAS * deviation, "computed": mean, "computed_ci95": SIGMAS * unsure,
                        "off": (mean - value) / float(np.hypot(deviation, unsure)), "noise": surrogate.noise, "surrogate_share": ratio, "runs": len(surrogate.answers),
                        "left_out_rms": float(np.sqrt(np.mean(left_out**2))), "left_out_most": float(np.abs(left_out).max())})
    for a in range(len(keys)):
        for b in range(a + 1, len(keys)):
            pairs.append({"keys": [keys[a]["key"], keys[b]["key"]], "correlation": float(np.corrcoef(even[:, a], even[:, b])[0, 1]),
                          "narrowing": [narrowing(even, a, b), narrowing(even, b, a)]})
            fixed = [keys[k]["share_of_bounds"] <= OPEN for k in (a, b)]
            pairs[-1]["told_apart"] = "no" if min(pairs[-1]["narrowing"]) < NOT_APART else "yes" if any(fixed) else "neither is fixed"
    along = ridge(even)
    computed = [surrogate.predict(along)[0] for surrogate in surrogates]
    stations = [{"keys": [key.value(x) for key, x in zip(settings.keys, place)], "answers": [float(entry[i]) for entry in computed]} for i, place in enumerate(along)]
    return {"keys": keys, "answers": answers, "pairs": pairs, "ridge": stations, "stopped": why, "best": [float(x) for x in best]}


def verdicts(settings, numbers, units, failed):
    """(outcome, sentence), the worst first."""
    found = []
    for answer, unit in zip(numbers["answers"], units):
        if abs(answer["off"]) > OFF:
            found.append(("bad", f"No keys within the bounds give the measured {answer['target']}: measured {number(answer['measured'], 4)} {unit}, nearest {number(answer['computed'], 4)}, "
                                 f"{abs(answer['off']):.1f} standard deviations off. The intervals below mean nothing until this is cleared: wider bounds, other keys, or a case that is nearer to "
                                 "the experiment."))
        if answer["left_out_rms"] > SPREAD:
            found.append(("doubtful", f"The surrogate of {answer['target']} is too sure of itself: runs lie {answer['left_out_rms']:.1f} (root mean square; 1 is right) of its standard "
                                      "deviations off where they are left out. Intervals are too narrow; more runs (budget=) or narrower bounds help."))
        if answer["noise"] > answer["measured_ci95"]:
            found.append(("doubtful", f"Single runs scatter by {number(answer['noise'], 2)} {unit} (standard deviation over seeds) in {answer['target']}, more than the measured "
                                      f"+- {number(answer['measured_ci95'], 2)}. That holds only if the measurement is the mean of several experiments, or of one that is larger than the case. "
                                      f"The scatter goes about with one over the root of the number of grains: {number((answer['noise'] / answer['measured_ci95']) ** 2, 2)} times as many "
                                      "grains in the case scatter by as much as was measured."))
    for key in numbers["keys"]:
        if key["share_of_bounds"] > OPEN:
            found.append(("doubtful", f"The answers do not fix {key['key']}: its interval takes {100 * key['share_of_bounds']:.0f} % of the bounds."))
        elif key["at_lower_bound"] or key["at_upper_bound"]:
            which = " and the ".join(name for name, there in (("lower bound", key["at_lower_bound"]), ("upper bound", key["at_upper_bound"])) if there)
            found.append(("doubtful", f"The interval of {key['key']} ends at the {which}, not where the answers end it."))
    for pair in numbers["pairs"]:
        if pair["told_apart"] != "yes":
            a, b = pair["keys"]
            found.append(("doubtful", f"{a} and {b} cannot be distinguished by these answers: {'neither is fixed; ' if pair['told_apart'] != 'no' else ''}if one were known, the interval "
                                      f"of the other would be {1 / min(pair['narrowing']):.1f} times narrower. See the ridge below; a target that depends on them in another way cuts it."))
    if numbers["stopped"] == "budget":
        most = max(answer["surrogate_share"] for answer in numbers["answers"])
        found.append(("doubtful", f"The budget ended before the surrogate was known to {settings.stop:g} of the measurements: it is known to {most:.2g}, and intervals are up to "
                                  f"{100 * (np.hypot(1, most) - 1):.0f} % wider than they need to be."))
    if failed:
        found.append(("doubtful", f"{failed} runs became invalid and are left out: see runs.csv for where."))
    return sorted(found, key=lambda entry: entry[0] != "bad") or [("good", "The answers are met, and they fix the keys.")]


def keys_fit(numbers):
    """Do some keys within the bounds give all answers? Otherwise posterior and intervals mean nothing, and charts leave them out."""
    return all(abs(answer["off"]) <= OFF for answer in numbers["answers"])


def is_open(numbers):
    """Is there a key that the answers do not fix, or a pair that they do not distinguish? Not where no keys give the answers: then intervals mean nothing."""
    if not keys_fit(numbers):
        return False
    return any(key["share_of_bounds"] > FIXED for key in numbers["keys"]) or any(pair["told_apart"] == "no" for pair in numbers["pairs"])


def percent(share):
    return f"{100 * share:.{0 if share >= 0.095 else 1}f} %"


def best_proposals(numbers):
    """For each key that is open: (key, the first proposal that fixes it, or else that of its narrowest interval)."""
    found = []
    for k, key in enumerate(numbers["keys"]):
        if key["share_of_bounds"] > FIXED and numbers["proposals"]:
            fixing = [entry for entry in numbers["proposals"] if entry["fixes"][k]]
            found.append((k, key, fixing[0] if fixing else min(numbers["proposals"], key=lambda entry: entry["widths"][k])))
    return found


def times(count):
    return {1: "once", 2: "twice"}.get(count, f"{count} times, on the mean")


def next_measurement(numbers):
    """The section that says which measurement would fix what is open."""
    text = "\n## What to measure next\n\n"
    for k, key, entry in best_proposals(numbers):
        width, now = entry["widths"][k], key["share_of_bounds"]
        further = max(0, entry["runs"] - entry["runs_there"])
        runs = f"the {entry['runs_there']} runs of it suffice" if not further else f"that is with its {entry['runs_there']} runs; about {further} more make the most of it"
        if entry["fixes"][k]:
            text += (f"- **{entry['number']}**, measured {times(entry['repeats'])}, is expected to narrow the interval of {key['key']} from {percent(now)} to {percent(width)} of its bounds"
                     f"{', if grains can be tracked' if entry['tracked'] else ''}; {runs}. Give it as a further target: `{entry['number']}=VALUE+-UNCERTAINTY`.\n")
        else:
            text += (f"- No number of these runs is expected to narrow the interval of {key['key']} to a third of its bounds (now {percent(now)}). The nearest is {entry['number']}, measured "
                     f"{times(entry['repeats'])}: {percent(width)}.\n")
    if not numbers["proposals"] and not numbers["not_tried"]:
        text += "No other number of these runs can be measured, and no experiment without a target was tried (`experiments=`).\n"
    for scene, why in numbers["not_tried"]:
        text += f"- {scene} was not tried: {why}\n"
    shown = numbers["proposals"][:MOST_PROPOSALS]
    if shown:
        text += "\n" + table(["number", "change over the posterior (standard deviation)", "scatter of one run", "measured", "runs: there, needed",
                              *(f"interval / bounds of {key['key']}, now {percent(key['share_of_bounds'])}" for key in numbers["keys"])],
                             [[entry["number"] + (" (tracked)" if entry["tracked"] else ""), f"{number(entry['change'], 2)} {entry['unit']}", f"{number(entry['scatter'], 2)} {entry['unit']}",
                               f"{entry['repeats']} x, to +- {number(SIGMAS * entry['deviation'], 2)} {entry['unit']}", f"{entry['runs_there']}, {entry['runs']}",
                               *(f"**{percent(width)}**" if fixes else percent(width) for width, fixes in zip(entry["widths"], entry["fixes"]))] for entry in shown])
        text += (f"\nThe {len(shown)} of {len(numbers['proposals'])} numbers that narrow the intervals most, each alone beside the targets that are there; bold where a key is fixed to a third of its "
                 "bounds; \"tracked\": needs tracked grains, or tomography. Intervals are means over what the measurement might be. The experiment is thought to scatter as one run does, repeated as often as it helps, but its mean to be "
                 f"no more certain than {100 * FINEST:.0f} % (standard deviation).\n")
    return text


def table(header, rows):
    return "\n".join(["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def write(settings, runs, summaries, units, measured, surrogates, found, numbers):
    """numbers: those of judge, with proposals and not_tried."""
    failed = sum("failed" in run for run in runs.all.values())
    said = verdicts(settings, numbers, units, failed)
    rows, seconds = [], 0.0
    scenes = {scene.name: scene for scene in [*settings.scenes, *settings.experiments]}
    everything = runs.of(scenes.values())
    for name, run in everything.items():
        scene = scenes[run["scene"]]
        record = {"outcome": "invalid"} if "failed" in run else record_of(os.path.join(scene.folder, name))
        seconds += record.get("wall_seconds", 0)
        values = [summaries.value(target, name) if target.scene.name == run["scene"] and "failed" not in run else None for target in settings.targets]
        rows.append([name, run["scene"], run["seed"], *(f"{key.value(x):.6g}" for key, x in zip(settings.keys, run["place"])), record["outcome"],
                     record.get("wall_seconds"), *values])
    with open("runs.csv", "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["run", "scene", "seed", *(key.name + (f" [{key.unit}]" if key.unit else "") for key in settings.keys), "outcome", "wall_seconds",
                      *(f"{target.name} [{unit}]" for target, unit in zip(settings.targets, units))])
        out.writerows(rows)
    with open("calibration.json", "w", encoding="utf-8") as file:
        json.dump({"format": "scree-calibration-result", "format_version": 1, **numbers, "verdicts": [{"outcome": outcome, "text": text} for outcome, text in said],
                   "units": units, "runs": len(runs.all), "survey_runs": len(rows) - len(runs.all), "failed": failed, "budget": settings.budget, "wall_seconds": seconds}, file, indent=1)

    short = [key.name for key in settings.keys]
    with open("calibration.md", "w", encoding="utf-8") as file:
        file.write("# Calibration\n\n" + "".join(f"- **{outcome}**: {text}\n" for outcome, text in said) + "\n## Keys\n\n")
        file.write(table(["key", "value", "95 % interval", "bounds", "interval / bounds"],
                         [[key["key"], f"**{number(key['value'])}** {key['unit']}", f"{number(key['low'])} to {number(key['high'])}",
                           f"{number(key['lower_bound'])} to {number(key['upper_bound'])}", f"{100 * key['share_of_bounds']:.0f} %"] for key in numbers["keys"]]))
        file.write("\nThe value is the middle of the keys that meet the answers equally well. The interval is the shortest that holds 95 % of the posterior: uniform between the "
                   "bounds before, then the measured answers with their uncertainty and that of the surrogate, which has that of the seeds in it.\n\n## Answers\n\n")
        file.write(table(["target", "measured", "computed at the value", "off, in standard deviations", "scatter of one run", "runs", "left out: root mean square, most"],
                         [[answer["target"], f"{number(answer['measured'], 4)} +- {number(answer['measured_ci95'], 2)} {unit}",
                           f"{number(answer['computed'], 4)} +- {number(answer['computed_ci95'], 2)}", f"{answer['off']:+.1f}", f"{number(answer['noise'], 2)} {unit}",
                           str(answer["runs"]), f"{answer['left_out_rms']:.1f}, {answer['left_out_most']:.1f}"] for answer, unit in zip(numbers["answers"], units)]))
        file.write("\n\"Left out\": how far a run lies off what all others say of it, in standard deviations; about 1 (and rarely above 3) where the surrogate is right about itself.\n"
                   "\n![What the answers are over the keys](surface.png)\n\n## What cannot be distinguished\n\n")
        if numbers["pairs"]:
            file.write(table(["keys", "distinguished", "correlation", "deviation of the first if the second were known, of what it is", "of the second if the first were known"],
                             [[" and ".join(pair["keys"]), "yes" if pair["told_apart"] == "yes" else f"**{pair['told_apart']}**", f"{pair['correlation']:+.2f}", f"{100 * pair['narrowing'][0]:.0f} %",
                               f"{100 * pair['narrowing'][1]:.0f} %"] for pair in numbers["pairs"]]))
            file.write("\nAlong the widest direction of the posterior, from one end to the other: different keys, much the same answers.\n\n")
            file.write(table([*short, *(f"{target.name} [{unit}]" for target, unit in zip(settings.targets, units))],
                             [[*(number(x) for x in station["keys"]), *(number(x, 4) for x in station["answers"])] for station in numbers["ridge"]]))
        else:
            file.write("There is one key only.\n")
        if is_open(numbers):
            file.write(next_measurement(numbers))
        ended = {"precise": f"the surrogate was known to {settings.stop:g} of the measurements", "budget": "the budget was spent"}[numbers["stopped"]]
        surveyed = len(rows) - len(runs.all)
        further = f", and {surveyed} of experiments without a target" if surveyed else ""
        file.write(f"\n![The posterior](posterior.png)\n\n## Budget\n\n{len(runs.all)} of {settings.budget} runs, {failed} of them invalid{further}; {seconds:.0f} s of solver time. It ended since {ended}. "
                   "All runs: `runs.csv`. A larger `budget=` or changed targets continue with these runs.\n")
    draw_surface(settings, measured, surrogates, found, units, numbers)
    draw_posterior(settings, found, numbers)


def label(key):
    return key.name + (f" [{key.unit}]" if key.unit else "")


def save(figure, name):
    figure.savefig(f"{name}.svg", metadata={"Date": None})
    figure.savefig(f"{name}.png", dpi=130)
    plt.close(figure)


NO_FIT = "no key within the bounds gives the measured answers"


def draw_surface(settings, measured, surrogates, found, units, numbers):
    """The answers over the keys: a curve for one key, maps for each pair of more, through the value of the others."""
    best, fit = np.array(numbers["best"]), keys_fit(numbers)
    dimension = len(settings.keys)
    pairs = [(a, b) for a in range(dimension) for b in range(a + 1, dimension)][:6] or [(0, None)]
    figure, plots = plt.subplots(len(surrogates), len(pairs), figsize=(5.2 * len(pairs) + 0.6, 4.1 * len(surrogates)), squeeze=False, layout="constrained")
    for row, (target, (value, deviation), surrogate, unit) in enumerate(zip(settings.targets, measured, surrogates, units)):
        half = SIGMAS * deviation
        for plot, (a, b) in zip(plots[row], pairs):
            if b is None:
                x = np.linspace(0, 1, 121)
                mean, unsure = surrogate.predict(x[:, None])
                places = [settings.keys[a].value(v) for v in x]
                plot.axhspan(value - half, value + half, color=ORANGE, alpha=0.25, lw=0, label="measured, 95 %")
                plot.fill_between(places, mean - SIGMAS * unsure, mean + SIGMAS * unsure, color=BLUE, alpha=0.25, lw=0, label="mean over seeds, 95 %")
                plot.plot(places, mean, color=BLUE)
                plot.plot([settings.keys[a].value(v) for v in surrogate.points[:, 0]], surrogate.answers, "o", color=BLACK, markersize=3, label="runs")
                key = numbers["keys"][0]
                if fit:
                    plot.axvspan(key["low"], key["high"], color=GREEN, alpha=0.15, lw=0, label="95 % interval of the key")
                plot.set_ylabel(f"{target.name} [{unit}]")
                plot.legend(fontsize="small")
            else:
                grid = np.linspace(0, 1, 61)
                u, v = np.meshgrid(grid, grid)
                points = np.tile(best, (u.size, 1))
                points[:, a], points[:, b] = u.ravel(), v.ravel()
                mean = surrogate.predict(points)[0].reshape(u.shape)
                x, y = ([settings.keys[k].value(t) for t in grid] for k in (a, b))
                filled = plot.contourf(x, y, mean, levels=14, cmap="viridis")
                figure.colorbar(filled, ax=plot, label=f"{target.name} [{unit}]")
                levels = [level for level in (value - half, value, value + half) if mean.min() < level < mean.max()]
                if levels:
                    plot.contour(x, y, mean, levels=levels, colors="white", linewidths=[2.0 if level == value else 1.0 for level in levels],
                                 linestyles=["-" if level == value else "--" for level in levels])
                even = found.even(500)
                if fit:
                    plot.plot([settings.keys[a].value(t) for t in even[:, a]], [settings.keys[b].value(t) for t in even[:, b]], ".", color=ORANGE, markersize=2, alpha=0.5)
                plot.plot([settings.keys[a].value(t) for t in surrogate.points[:, a]], [settings.keys[b].value(t) for t in surrogate.points[:, b]], "o", color=BLACK,
                          markerfacecolor="white", markersize=4)
                plot.plot(numbers["keys"][a]["value"], numbers["keys"][b]["value"], "*", color=ORANGE, markeredgecolor=BLACK, markersize=13)
                plot.set_ylabel(label(settings.keys[b]))
                if settings.keys[b].log:
                    plot.set_yscale("log")
            plot.set_xlabel(label(settings.keys[a]))
            if settings.keys[a].log:
                plot.set_xscale("log")
    if dimension > 1:
        star = "dots: posterior; star: value" if fit else "star: nearest"
        figure.suptitle(f"white: measured answer and its 95 % interval; rings: runs; {star}" + ("; other keys at the value" if dimension > 2 else "") +
                        ("" if fit else f"\n{NO_FIT}"), fontsize="small")
    elif not fit:
        figure.suptitle(NO_FIT, fontsize="small")
    save(figure, "surface")


def draw_posterior(settings, found, numbers):
    """Each key alone, and each pair with its ridge."""
    dimension = len(settings.keys)
    even = found.even(2000)
    values = np.array([[key.value(x) for x in even[:, k]] for k, key in enumerate(settings.keys)])
    figure, plots = plt.subplots(dimension, dimension, figsize=(3.3 * dimension + 1, 3.1 * dimension + 0.4), squeeze=False, layout="constrained")
    for row in range(dimension):
        for column in range(dimension):
            plot = plots[row][column]
            if column > row:
                plot.set_axis_off()
                continue
            key = settings.keys[column]
            plot.set_xlim(key.low, key.high)
            if key.log:
                plot.set_xscale("log")
            if row == column:
                edges = [key.value(x) for x in np.linspace(0, 1, 41)]
                plot.hist(values[row], bins=edges, color=BLUE, alpha=0.6)
                entry = numbers["keys"][row]
                plot.axvspan(entry["low"], entry["high"], color=BLUE, alpha=0.12, lw=0)
                plot.axvline(entry["value"], color=ORANGE)
                plot.set_yticks([])
                plot.set_title(f"{number(entry['value'])} ({number(entry['low'])} to {number(entry['high'])}) {key.unit}", fontsize="small")
            else:
                other = settings.keys[row]
                plot.set_ylim(other.low, other.high)
                if other.log:
                    plot.set_yscale("log")
                plot.plot(values[column], values[row], ".", color=BLUE, markersize=2, alpha=0.4)
                line = np.array([station["keys"] for station in numbers["ridge"]])
                plot.plot(line[:, column], line[:, row], "-o", color=ORANGE, markersize=4, label="along the ridge")
                pair = next(pair for pair in numbers["pairs"] if pair["keys"] == [key.name, other.name])
                plot.set_title(f"{dict(yes='distinguished', no='NOT distinguished').get(pair['told_apart'], pair['told_apart'])}: one known,\nthe other has {100 * min(pair['narrowing']):.0f} % of its deviation", fontsize="small")
                plot.legend(fontsize="small", loc="best")
            if row == dimension - 1:
                plot.set_xlabel(label(key))
            if column == 0 and row > 0:
                plot.set_ylabel(label(settings.keys[row]))
    save(figure, "posterior")
