"""Draws error against time of the distance methods and writes the page around it.

usage: draw.py STUDY.csv PAGE.md PICTURE.png

The table comes from scree-bench-distance (one row a regime, method and precision). A method is on the front when no
other is both as fast and as exact: at p99 on near pairs, and over all regimes by its mean time and its worst error.
Errors up to 5 roundoffs count as equal; methods without a useful answer are left out (see the page).
"""
import csv
import math
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.ticker

# what gives closest points, in the order of the legend; brute-force-distance leaves them out and is drawn apart
METHODS = ["brute-force", "hybrid", "penalty", "pen4", "pen4-hybrid", "pen7", "pen7-hybrid"]
FILTER = "brute-force-distance"
COLOURS = {"brute-force": "#00441b", FILTER: "#74c476", "hybrid": "#08519c", "penalty": "#6baed6",
           "pen4": "#7f2704", "pen4-hybrid": "#d94801", "pen7": "#4d004b", "pen7-hybrid": "#ae017e"}
MARKERS = {"brute-force": "o", FILTER: "o", "hybrid": "s", "penalty": "D", "pen4": "^", "pen4-hybrid": "v",
           "pen7": "<", "pen7-hybrid": ">"}
ROUNDOFF = {"double": 2.0**-53, "single": 2.0**-24}
USEFUL = 1e-2  # an error above this is no answer, and its method not on the front
WORTHLESS = 10.0  # errors above this, and answers that are no number, are drawn here: ten longest edges


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    table = {}
    for row in rows:
        value = {k: float(row[k]) for k in ("ns_per_pair", "error_median", "error_p99", "error_max", "wrong_flags", "uncertified",
                                            "fell_back", "not_a_number", "fma_peak_gflops", "share_of_fma_peak")}
        table[row["precision"], row["method"], row["case"]] = value
    cases = list(dict.fromkeys(row["case"] for row in rows))
    return table, cases, rows[0]


def summary(table, cases, precision, method):
    """Mean time over the regimes, worst error and where, and the ranges of the shares."""
    rows = {case: table[precision, method, case] for case in cases}
    worst = max(cases, key=lambda case: rows[case]["error_max"])
    return {
        "near_ns": rows["near-1e-3"]["ns_per_pair"],
        "near_error": rows["near-1e-3"]["error_p99"],
        "mean_ns": sum(r["ns_per_pair"] for r in rows.values()) / len(rows),
        "worst_error": rows[worst]["error_max"],
        "worst_case": worst,
        "wrong_flags": max(r["wrong_flags"] for r in rows.values()),
        "uncertified": max(r["uncertified"] for r in rows.values()),
        "fell_back": (rows["near-1e-3"]["fell_back"], max(r["fell_back"] for r in rows.values())),
        "not_a_number": int(sum(r["not_a_number"] for r in rows.values())),
    }


def front(points):
    """Names of the points (name -> time, error) that no other one beats in both."""
    return [n for n, (t, e) in points.items()
            if not any(t2 <= t and e2 <= e and (t2 < t or e2 < e) for m, (t2, e2) in points.items() if m != n)]


def error_text(error):
    if not math.isfinite(error) or error > 1e100:
        return "no number"
    return "0" if error == 0 else f"{error:.1e}"


def draw(table, cases, head, path):
    figure, axes = plt.subplots(2, 2, figsize=(11, 8.6))
    on_front = {}
    for row, precision in enumerate(("double", "single")):
        roundoff = ROUNDOFF[precision]
        for column, (time, error, title) in enumerate((("near_ns", "near_error", "pairs at 1e-3 of their size, error at p99"),
                                                       ("mean_ns", "worst_error", "all twelve regimes: mean time, worst error"))):
            axis = axes[row][column]
            points = {}
            for method in METHODS + [FILTER]:
                s = summary(table, cases, precision, method)
                points[method] = (s[time], min(max(s[error], roundoff / 4), WORTHLESS))
            # an error within the declared 5 roundoffs is rounding, not method: such points count as equally exact
            exact = {m: (t, 5 * roundoff if e <= 5 * roundoff else e) for m, (t, e) in points.items()}
            members = front({m: exact[m] for m in METHODS if exact[m][1] < USEFUL})
            on_front[precision, time] = members
            for method, (t, e) in points.items():
                hollow = method not in members
                axis.plot(t, e, MARKERS[method], color=COLOURS[method], markersize=11 if not hollow else 8,
                          markerfacecolor="white" if hollow else COLOURS[method], markeredgewidth=1.8, zorder=4,
                          label=method + (" (no points)" if method == FILTER else ""))
            line = sorted((points[m] for m in members))
            steps_x, steps_y = [], []
            for k, (t, e) in enumerate(line):
                steps_x += [t, line[k + 1][0] if k + 1 < len(line) else 1e5]
                steps_y += [e, e]
            low, high = min(t for t, _ in points.values()), max(t for t, _ in points.values())
            axis.plot([line[0][0]] + steps_x, [WORTHLESS * 30] + steps_y, color="#555555", linewidth=1.2, linestyle="--", zorder=2)
            axis.axhspan(roundoff / 20, 5 * roundoff, color="#e5f5e0", zorder=0)
            axis.text(low / 1.35, roundoff / 15, "up to 5 roundoffs", ha="left", va="bottom", fontsize=8, color="#238b45")
            axis.axhline(WORTHLESS, color="#cccccc", linewidth=1, zorder=1)
            axis.text(high * 1.5, WORTHLESS * 1.4, "worse, or no number", ha="right", va="bottom", fontsize=8, color="#888888")
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.set_xlim(low / 1.4, high * 1.6)
            axis.set_ylim(roundoff / 20, WORTHLESS * 20)
            axis.set_xlabel("time [ns per pair]")
            axis.set_ylabel("error / max(longest edge, distance)")
            axis.set_title(f"{precision}: {title}", fontsize=10)
            axis.grid(True, which="major", color="#eeeeee", zorder=0)
            axis.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
            axis.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
            ticks = [t for d in range(0, 5) for t in (10**d, 2 * 10**d, 5 * 10**d) if low / 1.4 <= t <= high * 1.6]
            axis.xaxis.set_major_locator(matplotlib.ticker.FixedLocator(ticks))
    handles, labels = axes[0][0].get_legend_handles_labels()
    for handle in handles:
        handle.set_markersize(8)
    figure.legend(handles, labels, loc="lower center", ncol=4, frameon=False, fontsize=9)
    figure.suptitle(f"Triangle distance, one core, {head['simd']}: error against time (filled, dashed line: on the front)", fontsize=12)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(path, dpi=110)
    return on_front


def table_of(table, cases, precision, members):
    lines = ["| method | ns near | M/s near | p99 near | mean ns, all | worst error, where | wrong flags | uncertified | fell back near, most | front |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for method in [METHODS[0], FILTER] + METHODS[1:]:
        s = summary(table, cases, precision, method)
        numbers = f", {s['not_a_number']} NaN" if s["not_a_number"] else ""
        if method == FILTER:
            marks = "(no points)"
        else:
            marks = ", ".join(n for n, key in (("near", "near_ns"), ("all", "mean_ns")) if method in members[precision, key]) or "no"
        lines.append(f"| `{method}` | {s['near_ns']:.1f} | {1e3 / s['near_ns']:.1f} | {error_text(s['near_error'])} | {s['mean_ns']:.0f} | "
                     f"{error_text(s['worst_error'])}, {s['worst_case']}{numbers} | {100 * s['wrong_flags']:.1f} % | "
                     f"{100 * s['uncertified']:.0f} % | {100 * s['fell_back'][0]:.1f} %, {100 * s['fell_back'][1]:.0f} % | {marks} |")
    return "\n".join(lines)


def regime_table(table, cases):
    shown = ["brute-force", "hybrid", "penalty", "pen4-hybrid", "pen7-hybrid"]
    lines = ["| regime | " + " | ".join(f"`{m}`" for m in shown) + " |", "|---" * (len(shown) + 1) + "|"]
    for case in cases:
        cells = []
        for method in shown:
            r = table["double", method, case]
            cells.append(f"{r['ns_per_pair']:.0f} ns, {error_text(r['error_max'])}, {100 * r['fell_back']:.0f} %")
        lines.append(f"| {case} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main(csv_path, page_path, picture_path):
    table, cases, head = read(csv_path)
    members = draw(table, cases, head, picture_path)
    own, mix = summary(table, cases, "double", "brute-force"), summary(table, cases, "double", "hybrid")
    pen7, pen4 = summary(table, cases, "double", "pen7-hybrid"), summary(table, cases, "double", "pen4-hybrid")
    peak = {p: table[p, "brute-force", "near-1e-3"] for p in ("double", "single")}
    names = lambda key: " and ".join(f"`{m}`" for m in members[key])
    page = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "page.md")).read()
    values = {
        "picture": os.path.basename(picture_path),
        "target": head["simd"], "compiler": head["compiler"],
        "front_near_double": names(("double", "near_ns")), "front_all_double": names(("double", "mean_ns")),
        "front_near_single": names(("single", "near_ns")), "front_all_single": names(("single", "mean_ns")),
        "hybrid_ratio": f"{mix['near_ns'] / own['near_ns']:.2f}",
        "hybrid_fallback": f"{100 * mix['fell_back'][0]:.1f}",
        "hybrid_fallback_single": f"{100 * summary(table, cases, 'single', 'hybrid')['fell_back'][0]:.1f}",
        "pen4_fallback": f"{100 * pen4['fell_back'][0]:.1f}", "pen4_error": error_text(pen4["near_error"]),
        "pen7_fallback": f"{100 * pen7['fell_back'][0]:.0f}", "pen7_ratio": f"{pen7['near_ns'] / own['near_ns']:.1f}",
        "pen7_error": error_text(pen7["worst_error"]), "pen7_case": pen7["worst_case"],
        "peak_double": f"{peak['double']['fma_peak_gflops']:.1f}", "peak_single": f"{peak['single']['fma_peak_gflops']:.1f}",
        "share_double": f"{100 * peak['double']['share_of_fma_peak']:.0f}", "share_single": f"{100 * peak['single']['share_of_fma_peak']:.0f}",
        "rate_double": f"{1e3 / own['near_ns']:.1f}",
        "rate_indexed": f"{1e3 / table['single', 'brute-force-indexed', 'near-1e-3']['ns_per_pair']:.1f}",
        "rate_single": f"{1e3 / summary(table, cases, 'single', 'brute-force')['near_ns']:.1f}",
        "table_double": table_of(table, cases, "double", members), "table_single": table_of(table, cases, "single", members),
        "table_regimes": regime_table(table, cases),
    }
    for key, value in values.items():
        page = page.replace("{" + key + "}", value)
    with open(page_path, "w") as file:
        file.write(page)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
