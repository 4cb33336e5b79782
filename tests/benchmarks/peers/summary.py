"""Tables from the rows of a comparison: particle-steps a second with the error of each program beside it."""
import statistics

COLUMNS = ["family", "state", "program", "round", "bodies", "steps", "step", "cpu", "load", "depth_share", "intersecting_pairs",
           "touching_pairs", "energy_change", "kinetic_share", "depth_over_margins"]


def particle_steps(row):
    """Particles times steps over CPU seconds [1/s]."""
    return float(row["bodies"]) * float(row["steps"]) / float(row["cpu"])


def summarise(rows):
    """One record a scene and program, in the order of the rows: speeds over the rounds, worst errors, and the ratio to Scree.

    The ratio is that of the medians; `least_ratio` is the smallest of the rounds, each against Scree in the same round."""
    groups = {}
    for row in rows:
        groups.setdefault((row["family"], row["state"], row["program"]), []).append(row)
    records = []
    for (family, state, program), group in groups.items():
        speeds = [particle_steps(row) for row in group]
        record = {"family": family, "state": state, "program": program, "rounds": len(group), "best": max(speeds),
                  "median": statistics.median(speeds), "seconds_per_second": statistics.median(float(r["cpu"]) / float(r["steps"]) / float(r["step"]) for r in group)}
        for name in ("depth_share", "intersecting_pairs", "energy_change", "kinetic_share"):
            values = [float(row[name]) for row in group if row.get(name) not in (None, "")]
            record[name] = max(values) if values else None
        own = {row["round"]: particle_steps(row) for row in rows if (row["family"], row["state"], row["program"]) == (family, state, "Scree")}
        if own:
            record["ratio"] = statistics.median(own.values()) / record["median"]
            in_turn = [own[row["round"]] / particle_steps(row) for row in group if row["round"] in own]
            record["least_ratio"] = min(in_turn) if in_turn else None
        records.append(record)
    return records


def text_of(value, form):
    return "-" if value is None else format(value, form)


def table(records):
    """The records as a Markdown table."""
    lines = ["| shapes | bed | program | particle-steps/s, median (best) | Scree is faster by (least round) | CPU s a simulated s | deepest / R | cut pairs | energy in | kinetic |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for r in records:
        ratio = "-" if r["program"] == "Scree" or "ratio" not in r else f"{r['ratio']:.1f} ({text_of(r['least_ratio'], '.1f')})"
        lines.append(f"| {r['family']} | {r['state']} | {r['program']} | {r['median']:,.0f} ({r['best']:,.0f}) | {ratio} | {r['seconds_per_second']:.3g} | "
                     f"{text_of(r['depth_share'], '.1e')} | {text_of(r['intersecting_pairs'], '.0f')} | {text_of(r['energy_change'], '+.1e')} | "
                     f"{text_of(r['kinetic_share'], '.1e')} |")
    return "\n".join(lines)
