#!/usr/bin/env python3
"""Predicts the efficiency of a scene on many ranks from counted cuts and measured rates.
usage: model.py SCALING.csv OUTPUT_FOLDER CUTS.csv...   (in the folder of the runs)

    step = bodies_mean * imbalance * c + ghosts_max * g + neighbours * latency + bytes / bandwidth + log2(P) * latency

c is the measured time of a body on one core; g that of a ghost: the pairs that two ranks compute, packing,
unpacking. Latency and bandwidth are those of a common cluster network, not of this machine, and are said in the table."""
import csv
import math
import os
import sys

LATENCY = 2e-6       # s, a message between nodes, both ends included
BANDWIDTH = 1e9      # B/s of one rank: a 12.5 GB/s adapter shared by a dozen ranks
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7"]


def rows_of(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def ghost_share(run):
    """Time of a ghost over that of a body, both from one run on two ranks: a busy machine slows both."""
    with open(os.path.join(run, "ranks.csv")) as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    first, last = rows[:2], rows[-2:]
    change = lambda names: sum(float(b["t_" + n]) - float(a["t_" + n]) for a, b in zip(first, last) for n in names)
    total = lambda name: sum(float(r[name]) for r in last)
    body = change(["contact", "search", "sort", "gather", "integrate"]) / total("bodies")
    return change(["twice", "halo", "migrate"]) / max(1.0, total("ghosts")) / body


def measured_rates(rows):
    """Seconds of a body on one core, and of a ghost."""
    best = {}
    for r in rows:
        name = r["run"].rsplit(".", 2)[0]
        if name not in best or float(r["step_seconds"]) < float(best[name]["step_seconds"]):
            best[name] = r
    strong = max((n for n in best if n.endswith("-2x1")), key=lambda n: int(best[n]["bodies"]))
    base, pair = best[strong.replace("-2x1", "-1x1")], best[strong]
    body = float(base["step_seconds"]) / int(base["bodies"])
    return body, body * ghost_share(pair["run"]), base, pair


def svg(lines, path):
    width, height, left, top, right, bottom = 640, 340, 60, 64, 20, 48
    low = min(x for _, points in lines for x, _ in points)
    high = max(x for _, points in lines for x, _ in points)
    px = lambda x: left + (width - left - right) * math.log(x / low) / max(1e-9, math.log(high / low))
    py = lambda y: top + (height - top - bottom) * (1 - y)
    out = [f'<svg viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg" font-family="system-ui,Liberation Sans,Arial,sans-serif">'
           '<rect width="100%" height="100%" fill="#fff"/>'
           '<text x="8" y="20" font-size="15" font-weight="600" fill="#1c2430">Predicted efficiency of a step (coordinate bisection)</text>']
    for y in (0, 0.2, 0.4, 0.6, 0.8, 1):
        out.append(f'<line x1="{left}" x2="{width - right}" y1="{py(y):.1f}" y2="{py(y):.1f}" stroke="#e4e9ee"/>'
                   f'<text x="{left - 7}" y="{py(y) + 4:.1f}" font-size="11.5" fill="#56616f" text-anchor="end">{y:g}</text>')
    x = low
    while x <= high:
        out.append(f'<text x="{px(x):.1f}" y="{height - bottom + 18}" font-size="11.5" fill="#56616f" text-anchor="middle">{x}</text>')
        x *= 2
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 8}" font-size="12.5" fill="#37424e" text-anchor="middle">ranks</text>')
    place = left
    for k, (name, points) in enumerate(lines):
        colour = COLOURS[k % len(COLOURS)]
        path_text = " ".join(f'{"L" if i else "M"}{px(a):.1f} {py(b):.1f}' for i, (a, b) in enumerate(points))
        out.append(f'<path d="{path_text}" fill="none" stroke="{colour}" stroke-width="2"/>'
                   f'<line x1="{place}" x2="{place + 26}" y1="44" y2="44" stroke="{colour}" stroke-width="2.4"/>'
                   f'<text x="{place + 32}" y="48" font-size="12.5" fill="#37424e">{name}</text>')
        place += 60 + 7 * len(name)
    out.append("</svg>\n")
    with open(path, "w") as f:
        f.write("\n".join(out))


def main():
    body, ghost, base, pair = measured_rates(rows_of(sys.argv[1]))
    folder = sys.argv[2]
    os.makedirs(folder, exist_ok=True)
    table = ["scene,bodies,cut,parts,bodies_per_part,imbalance,ghosts_max,neighbours_max,bytes_max,step_seconds,compute,ghosts,messages,efficiency"]
    lines = []
    for path in sys.argv[3:]:
        name = os.path.splitext(os.path.basename(path))[0]
        drawn = []
        for r in rows_of(path):
            parts = int(r["parts"])
            mean = float(r["bodies_mean"])
            compute = body * mean * float(r["imbalance"])
            doubled = ghost * float(r["ghosts_max"])
            messages = (float(r["neighbours_max"]) + math.log2(parts)) * LATENCY + float(r["bytes_max"]) / BANDWIDTH
            step = compute + doubled + messages
            efficiency = body * mean / step
            table.append(f'{name},{mean * parts:.0f},{r["cut"]},{parts},{mean:.0f},{r["imbalance"]},{r["ghosts_max"]},{r["neighbours_max"]},'
                         f'{r["bytes_max"]},{step:.4g},{compute / step:.3f},{doubled / step:.3f},{messages / step:.3f},{efficiency:.3f}')
            if r["cut"] == "rcb":
                if not drawn:
                    bodies = mean * parts   # of the fewest parts: the mean is rounded
                drawn.append((parts, efficiency))
        lines.append((f"{bodies:.0f} bodies, {name}", drawn))
    with open(os.path.join(folder, "prediction.csv"), "w") as f:
        f.write("\n".join(table) + "\n")
    svg(lines, os.path.join(folder, "efficiency.svg"))
    print(f"a body {1e9 * body:.0f} ns, a ghost {1e9 * ghost:.0f} ns (from {base['run']} and {pair['run']})")
    print("\n".join(table))


main()
