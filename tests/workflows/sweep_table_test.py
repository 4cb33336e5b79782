#!/usr/bin/env python3
"""The chart of a sweep places values by what they are, whatever their units; means over seeds have Student's interval. usage: sweep_table_test.py WORKFLOWS UNITS.cpp SCRATCH"""
import csv
import json
import math
import pathlib
import re
import subprocess
import sys

WORKFLOWS, UNITS, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:])
sys.dont_write_bytecode = True
sys.path.insert(0, str(WORKFLOWS))
from run_record import PREFIXED, PREFIXES, SYMBOLS, quantity_of  # noqa: E402

SCRATCH.mkdir(parents=True, exist_ok=True)


def made_of(points, numbers):
    """The chart, and the rows of sweep_means.csv. points: of each run its keys; numbers: of each run its quantities, (mean, ci95) each."""
    names = [f"r{number}" for number in range(len(points))]
    for name, quantities in zip(names, numbers):
        entries = {quantity: {"mean": mean, "ci95": ci95, "unit": "-"} for quantity, (mean, ci95) in quantities.items()}
        for folder, file, content in ((f"{name}.run", "run.json", {"outcome": "completed", "steps": 1, "wall_seconds": 1}),
                                      (f"{name}.statistics", "statistics.json", {"groups": {"all": entries}})):
            (SCRATCH / folder).mkdir(exist_ok=True)
            (SCRATCH / folder / file).write_text(json.dumps(content))
    points = {name: {"case": "r", **point} for name, point in zip(names, points)}
    subprocess.run(["/usr/bin/python3", WORKFLOWS / "sweep_table.py", json.dumps(points), "speed", "sweep.csv", "sweep_means.csv", "sweep.svg"], cwd=SCRATCH, check=True)
    with open(SCRATCH / "sweep_means.csv", newline="", encoding="utf-8") as file:
        return (SCRATCH / "sweep.svg").read_text(), list(csv.DictReader(file))


def line_of(values, means):
    """Ends of the drawn line through a sweep over `values`, and the label of the axis."""
    svg, _ = made_of([{"key": value} for value in values], [{"speed": (mean, None)} for mean in means])
    lines = [re.findall(r"[ML] ([-0-9.]+) ([-0-9.]+)", d) for d in re.findall(r'<path d="([^"]*)"[^>]*style="fill: none; stroke: #0072b2', svg)]
    line = max(lines, key=lambda path: float(path[-1][0]) - float(path[0][0]))   # the others are error bars
    return [(float(x), float(y)) for x, y in line], svg


# means are the values in SI: drawn rightly, they lie on a straight line that climbs
for values, means in ((["120 rpm", "5 rad/s", "1 rev/s", "300 deg/s"], [12.566370614, 5, 6.283185307, 5.235987756]),
                      (["5 mm", "1 cm", "0.1 in", "700 um", "0.02"], [5e-3, 1e-2, 2.54e-3, 7e-4, 2e-2]),
                      (["0.5 kN/m", "2 N/mm", "1e3 N/m"], [500, 2000, 1000]),
                      (["2 min", "90 s"], [120, 90]), (["8 mm", "12 mm"], [8, 12])):
    line, svg = line_of(values, means)
    assert len(line) == len(values), (values, line)
    (x0, y0), (x1, y1) = line[0], line[-1]
    for (x, y), after in zip(line, line[1:] + [None]):
        assert after is None or after[0] > x, (values, line)
        straight = y0 + (y1 - y0) * (x - x0) / (x1 - x0)
        assert abs(y - straight) < 0.01 * abs(y1 - y0), (values, line)   # of the chart's height; it is written to 1e-6 points
assert "<!-- key [mm] -->" in svg, "no unit at the axis"
assert len(line_of(["10 mm", "1 cm", "2 cm"], [1, 1, 2])[0]) == 2, "one place, drawn twice"
assert len(line_of(["rcb", "rib"], [1, 2])[0]) == 2

# means over seeds: of 1, 2, 4 the mean 7/3, and Student's t of two degrees of freedom, 4.302653, times sqrt(7/3 / 3)
TWO = {"mass": (5.0, None)}
svg, rows = made_of([{"key": value, "seed": seed} for value in ("8 mm", "12 mm") for seed in "123"],
                    [{"speed": (mean, 0.1), **TWO} for mean in (1, 2, 4)] + [{"speed": (3, 0.1), **TWO}, {"speed": (3, 0.1)}, {"speed": (3, 0.1), **TWO}])
assert [(row["case"], row["key"], row["n"]) for row in rows] == [("r", "8 mm", "3"), ("r", "12 mm", "3")] and "seed" not in rows[0], rows
assert math.isclose(float(rows[0]["speed_mean"]), 7 / 3) and math.isclose(float(rows[0]["speed_half"]), 4.302652729 * math.sqrt(7) / 3, rel_tol=1e-8), rows
assert float(rows[1]["speed_mean"]) == 3 and float(rows[1]["speed_half"]) == 0 and float(rows[0]["mass_mean"]) == 5, rows
assert rows[1]["mass_mean"] == rows[1]["mass_half"] == "", "a run of this point has no mass"
assert "<!-- bars: 95 % interval over 3 seeds -->" in svg, "what are the bars?"
# the chart has the same numbers: heights of the first bar over the distance of both means
bars = [re.findall(r"[ML] ([-0-9.]+) ([-0-9.]+)", d) for d in re.findall(r'<path d="([^"]*)"[^>]*style="fill: none; stroke: #0072b2', svg)]
heights = [abs(float(ends[0][1]) - float(ends[-1][1])) for ends in bars if len(ends) == 2 and ends[0][0] == ends[-1][0]]
climb = next(abs(float(ends[0][1]) - float(ends[-1][1])) for ends in bars if len(ends) == 2 and ends[0][0] != ends[-1][0])
assert abs(max(heights) / climb - 2 * float(rows[0]["speed_half"]) / (3 - 7 / 3)) < 1e-3, (heights, climb, rows)
# one seed has no half width over seeds; its bars are those within the run, and the chart says so
svg, rows = made_of([{"key": "8 mm"}, {"key": "12 mm"}], [{"speed": (1, 0.1)}, {"speed": (2, 0.2)}])
assert [(row["n"], row["speed_mean"], row["speed_half"]) for row in rows] == [("1", "1.0", ""), ("1", "2.0", "")], rows
assert "<!-- bars: 95 % interval within the run -->" in svg, "what are the bars?"
# seeds alone, and seeds as the first key
svg, rows = made_of([{"seed": seed} for seed in "12"], [{"speed": (1, 0.1)}, {"speed": (3, 0.1)}])
assert len(rows) == 1 and rows[0]["n"] == "2" and math.isclose(float(rows[0]["speed_half"]), 12.7062047, rel_tol=1e-7) and "band: over seeds" in svg, rows
svg, rows = made_of([{"seed": seed, "key": value} for seed in "12" for value in "57"], [{"speed": (mean, None)} for mean in (1, 2, 3, 4)])
assert [(row["key"], row["n"], row["speed_mean"]) for row in rows] == [("5", "2", "2.0"), ("7", "2", "3.0")] and "<!-- key -->" in svg, rows
svg, rows = made_of([{"key": "10 mm", "seed": "1"}, {"key": "1 cm", "seed": "1"}, {"key": "1 cm", "seed": "2"}], [{"speed": (mean, None)} for mean in (1, 1, 2)])
assert len(rows) == 1 and rows[0]["n"] == "2" and rows[0]["speed_mean"] == "1.5", ("one run, given twice, is one seed", rows)

# the tables of symbols here and in the tools are the same
source = UNITS.read_text()
tools = {name: prefixed == "true" for name, prefixed in re.findall(r'Symbol\{"([^"]+)",.*(true|false)\}', source)}
assert {name: name in PREFIXED for name in SYMBOLS} == tools, tools
assert {name: float(factor) for name, factor in re.findall(r'Prefix\{"([^"]+)", ([^}]+)\}', source)} == PREFIXES
assert quantity_of("2.7 g/cm^3")[0] == 2700 or abs(quantity_of("2.7 g/cm^3")[0] / 2700 - 1) < 1e-12
assert abs(quantity_of("0.9 kJ/(kg K)")[0] / 900 - 1) < 1e-12 and quantity_of("1 J/(kg K)")[1] == quantity_of("1 J/kg/K")[1]
for words in ("rib", "5 furlong", "1.2.3", "[1, 2]", ""):
    assert quantity_of(words) is None, words
# plot= is looked at before the first run: quantities of bodies and walls, functions of users
import sweep_quantity  # noqa: E402
from sweep_quantity import Wrong, check, entry_of  # noqa: E402
numbers = (WORKFLOWS.parent / "post/statistics/frame_numbers.cpp").read_text()
ours = re.search(r"group_quantities\(bool has_heat\) \{(.*?)\n\}\n", numbers, re.S)[1]
named = re.findall(r'\{"([a-z_]{3,})", "', ours) + [f"{name}_{ij}" for name in re.findall(r'tensor\("([a-z_]+)"', ours) for ij in sweep_quantity.TENSOR]
assert len(named) > 40 and set(named) <= set(sweep_quantity.OF_BODIES), set(named) ^ set(sweep_quantity.OF_BODIES)

case = SCRATCH / "case.toml"
case.write_text('[[walls]]\nname = "drum"\n[[walls]]\nwear = {}\n')
(SCRATCH / "mine.py").write_text('def ratio(run):\n    return 2.5, "N m"\n')
for word in ("mixing_index", "torque_y", "axis_torque@drum", "power@drum", "volume_worn@1", "mine.py:ratio"):
    check(word, [case], SCRATCH)
for word, says in (("torqe_y", "did you mean 'torque_y'?"), ("mixing", "there are: particle_count"), ("power@drumm", "did you mean 'drum'?"),
                   ("power@lid", "it has: 'drum'"), ("mixing_index@drum", "no quantity 'mixing_index'"), ("mine.py:ration", "no function 'ration'"),
                   ("yours.py:ratio", "there is no file")):
    try:
        check(word, [case], SCRATCH)
    except Wrong as reason:
        assert says in str(reason), (word, str(reason))
    else:
        raise AssertionError(f"{word} was accepted")

statistics = {"first_time": 1.0, "groups": {"all": {"mass": {"mean": 1.0, "ci95": None, "unit": "kg"}}},
              "walls": {"7 drum": {"power": {"mean": 3.0, "ci95": 0.1, "unit": "W"}}, "8": {"power": {"mean": 0.0, "ci95": None, "unit": "W"}}}}
(SCRATCH / "r0.statistics/wall_loads.csv").write_text("time,wall,sliding_power,damping_power,contact_rate,impact_power,volume_worn\n"
                                                      "# units: s,-,W,W,1/s,W,m^3\n1.75,7,1,0,0,0,1e-9\n2,7,3,0,0,0,2e-9\n")   # 0.75 and 0.25 s
at = str(SCRATCH / "r0")
for word, mean in (("mass", 1.0), ("power", 3.0), ("power@drum", 3.0), ("power@8", 0.0), ("sliding_power@drum", 1.5), ("volume_worn", 2e-9),
                   (f"{SCRATCH}/mine.py:ratio", 2.5)):
    assert entry_of(word, at, statistics)["mean"] == mean, word
statistics["walls"]["8"]["power"]["mean"] = 1.0
try:
    entry_of("power", at, statistics)
except Wrong as reason:
    assert "power@drum, power@8" in str(reason), reason
else:
    raise AssertionError("two walls have a power")
print("all as expected")
