#!/usr/bin/env python3
"""The chart of a sweep places values by what they are, whatever their units. usage: sweep_table_test.py WORKFLOWS UNITS.cpp SCRATCH"""
import json
import pathlib
import re
import subprocess
import sys

WORKFLOWS, UNITS, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:])
sys.dont_write_bytecode = True
sys.path.insert(0, str(WORKFLOWS))
from run_record import PREFIXED, PREFIXES, SYMBOLS, quantity_of  # noqa: E402

SCRATCH.mkdir(parents=True, exist_ok=True)


def line_of(values, means):
    """Ends of the drawn line through a sweep over `values`, and the label of the axis."""
    points = {}
    for number, (value, mean) in enumerate(zip(values, means)):
        name = f"r{number}"
        points[name] = {"case": "r", "key": value}
        for folder, file, content in ((f"{name}.run", "run.json", {"outcome": "completed", "steps": 1, "wall_seconds": 1}),
                                      (f"{name}.statistics", "statistics.json", {"groups": {"all": {"speed": {"mean": mean, "ci95": None, "unit": "-"}}}})):
            (SCRATCH / folder).mkdir(exist_ok=True)
            (SCRATCH / folder / file).write_text(json.dumps(content))
    subprocess.run(["/usr/bin/python3", WORKFLOWS / "sweep_table.py", json.dumps(points), "speed", "sweep.csv", "sweep.svg"], cwd=SCRATCH, check=True)
    svg = (SCRATCH / "sweep.svg").read_text()
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
