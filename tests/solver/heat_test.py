#!/usr/bin/env python3
"""Heat as a user meets it: ranks, restarts, sleep, bodies that come and go, walls, messages. usage: heat_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import glob
import json
import math
import os
import shutil
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, column, main, make_killed, outcome, pack, physics_of_log, run  # noqa: E402

# rocks and balls of two materials in a box that is hot below; what lies asks nothing of the walls at the sides
HEAP = """
seed = 3
[time]
duration = {duration}
{time}
[heat]
friction_heat = {friction}
{heat}
[contact]
margin = 2e-3
[materials.stone]
density = 2500
heat_capacity = 0.5
conductivity = 2
real_young = "50 GPa"
poisson = 0.2
[materials.steel]
density = 7800
heat_capacity = 0.3
conductivity = 40
[[pairs]]
between = ["stone", "stone"]
stiffness = 1e4
restitution = 0.3
friction = 0.5
rolling_friction = 0.05
contact_conductance = 2e4
[[pairs]]
between = ["stone", "steel"]
stiffness = 1e4
restitution = 0.3
friction = 0.5
[[pairs]]
between = ["steel", "steel"]
stiffness = 1e4
restitution = 0.3
friction = 0.5
[shapes.ball]
sphere = {{ radius = 0.01 }}
[shapes.rock]
file = "rock.shape.h5"
[output]
every = {every}
checkpoint = {checkpoint}
[[walls]]
name = "side"
shape = {{ box_inside = [[-0.04, -0.04, -1], [0.04, 0.04, 1]] }}
material = "steel"
heat_flux = "0.2 W"
[[walls]]
name = "floor"
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = "steel"
temperature = "60 degC"
[[walls]]
name = "lid"
shape = {{ plane = {{ point = [0, 0, 0.16], normal = [0, 0, -1] }} }}
material = "steel"
exchange = {{ coefficient = 1000, temperature = 280 }}
{more}
"""
POPULATION = """
[[populations]]
shapes = { ball = 1, rock = 2 }
material = "stone"
count = 30
region = { box = [[-0.038, -0.038, 0.002], [0.038, 0.038, 0.158]] }
velocity = [0.3, 0.2, -0.6]
temperature = "20 degC"
[[bodies]]
shape = "ball"
material = "steel"
position = [0, 0, 0.0101]
fixed = true
temperature = 300
heat_source = 0.1
"""


def heap(duration=0.048, time="", friction="true", heat="", every=None, checkpoint=0.016, more=POPULATION):
    if not os.path.exists("rock.shape.h5"):
        subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "20 mm, 15 mm, 12 mm", "-o", "rock.shape.h5"], check=True, env=ENV,
                       capture_output=True)
    return HEAP.format(duration=duration, time=time, friction=friction, heat=heat, every=every or duration / 6, checkpoint=checkpoint, more=more)


def frame(folder, number):
    with h5py.File(sorted(glob.glob(f"{folder}/frame_*.hdf"))[number]) as file:
        data = file["VTKHDF/PointData"]
        order = data["id"][()].argsort()
        return {name: data[name][()][order] for name in ("id", "temperature", "material", "scale", "shape")}


def balance_closes(folder):
    """What bodies hold is what came in less what went, to the rounding of what they hold."""
    balance, heat = column(folder, "heat_balance"), column(folder, "heat")
    assert len(balance) > 3 and abs(balance - balance[0]).max() <= 1e-12 * heat.max(), (balance, heat)


def the_same_bits_on_any_ranks_and_threads_and_after_a_restart():
    pack("heap", heap())
    kept = None
    for ranks, threads in ((1, 1), (1, 2), (2, 1), (3, 1)):
        folder = f"r{ranks}t{threads}.run"
        run(ranks, "heap.scene.h5", "-o", folder, threads=threads)
        found = physics_of_log(folder), [frame(folder, n)["temperature"].tolist() for n in (1, -1)]
        kept = kept or found
        assert found == kept, f"{folder}: another run than on one rank"
    balance_closes("r1t1.run")
    t = frame("r1t1.run", -1)["temperature"]
    assert numpy.ptp(t) > 0.1 and column("r1t1.run", "heat_made")[-1] > 0 and column("r1t1.run", "heat_made_in_walls")[-1] > 0, t
    made = column("r1t1.run", "heat_made") + column("r1t1.run", "heat_made_in_walls")
    dissipated = column("r1t1.run", "dissipated")
    assert abs(made - dissipated).max() <= 1e-12 * dissipated.max(), (made, dissipated)
    folder = "killed.run"
    shutil.copytree("r3t1.run", folder)
    make_killed(folder, keep=1)
    run(2, "heap.scene.h5", "-o", folder, "--restart", "latest")
    assert (physics_of_log(folder), [frame(folder, n)["temperature"].tolist() for n in (1, -1)]) == kept, "another run than without a kill"
    said = run(2, "verify", "r1t1.run").stdout
    assert "the same, bit for bit" in said, said


def verify_finds_another_temperature():
    pack("heap", heap(duration=0.02, checkpoint=0.01))
    run(1, "heap.scene.h5", "-o", "heap.run")
    path = sorted(glob.glob("heap.run/frame_*.hdf"))[-1]
    with h5py.File(path, "r+") as file:
        file["VTKHDF/PointData/temperature"][0] *= 1 + 1e-15
    result = subprocess.run([os.path.join(BIN, "scree-solver"), "verify", "heap.run", "--from", "start"], env=ENV, capture_output=True, text=True)
    assert result.returncode != 0 and "temperature" in result.stdout + result.stderr, result


def a_scene_without_heat_has_nothing_of_it():
    text = heap(duration=0.04, checkpoint=0.04)
    without = text[:text.index("[heat]")] + text[text.index("[contact]"):]
    for key in ("heat_capacity", "conductivity", "real_young", "contact_conductance", "heat_flux", "temperature", "exchange", "heat_source"):
        without = "\n".join(line for line in without.splitlines() if not line.startswith(key))
    pack("without", without)
    said = run(1, "without.scene.h5", "-o", "without.run").stdout
    assert "heat" not in open("without.run/log.csv").read().splitlines()[0], said
    with h5py.File(sorted(glob.glob("without.run/frame_*.hdf"))[-1]) as file:
        assert "temperature" not in file["VTKHDF/PointData"]
    with h5py.File(sorted(glob.glob("without.run/checkpoint_*.h5"))[-1]) as file:
        assert not [name for name in file["bodies"] if "temperature" in name] and "heat" not in file
    pack("with", text.replace("friction_heat = true", "friction_heat = false"))
    run(1, "with.scene.h5", "-o", "with.run")
    # heat changes nothing that moves
    for name in ("kinetic_translational", "potential", "dissipated", "critical_step"):
        assert (column("with.run", name) == column("without.run", name)).all(), name


def bodies_asleep_go_on_conducting():
    """Two balls on each other on a floor fall asleep, on any ranks; temperatures go on as those of the same balls awake."""
    more = """
[[bodies]]
shape = "ball"
material = "stone"
position = [0, 0, 0.0100]
[[bodies]]
shape = "ball"
material = "stone"
position = [0, 0, 0.0299]
lock_rotation = true
"""
    hashes = {}
    for sleeps in ("true", "false"):
        text = heap(duration=0.8, time=f"sleep = {sleeps}\nstep = 4e-4", friction="false", heat="temperature = 300", every=0.04, checkpoint=0.2, more=more)
        text = text.replace("heat_capacity = 0.5", "heat_capacity = 5").replace("margin = 2e-3", "margin = 0").replace("stiffness = 1e4", "stiffness = 2e3")
        pack(f"sleep_{sleeps}", text)
        for ranks in (1, 2):
            folder = f"{sleeps}{ranks}.run"
            run(ranks, f"sleep_{sleeps}.scene.h5", "-o", folder)
            hashes.setdefault(sleeps, set()).add(outcome(folder)["state_hash"])
        assert len(hashes[sleeps]) == 1, hashes
    asleep = column("true1.run", "asleep")
    assert asleep[-1] == 2 and (asleep == 2).sum() > 5, asleep
    first = math.ceil(column("true1.run", "time")[(asleep == 2).argmax()] / 0.04)   # frame by which both sleep
    t = [[frame(f"{sleeps}1.run", n)["temperature"] for n in (first, -1)] for sleeps in ("true", "false")]
    warmed = t[1][1] - t[1][0]
    assert abs(warmed).max() > 0.5, t
    # of a body asleep the contact stays exactly, of one awake it moves by less than the tolerance of falling asleep
    assert abs((t[0][1] - t[0][0]) / warmed - 1).max() < 2e-3, t
    balance_closes("true1.run")
    shutil.copytree("true2.run", "killed.run")
    make_killed("killed.run", keep=2)
    run(1, "sleep_true.scene.h5", "-o", "killed.run", "--restart", "latest")
    assert outcome("killed.run")["state_hash"] in hashes["true"]


def made_is_dissipated(folder):
    made = column(folder, "heat_made") + column(folder, "heat_made_in_walls")
    dissipated = column(folder, "dissipated")
    assert dissipated[-1] > 0 and abs(made - dissipated).max() <= 1e-12 * dissipated.max(), (made, dissipated)


def what_is_made_is_what_is_dissipated_as_steps_change_and_bodies_fall_asleep():
    fast = POPULATION.replace("velocity = [0.3, 0.2, -0.6]", "velocity = [0.9, 0.6, -1.8]")
    pack("halved", heap(duration=0.32, checkpoint=0.16, time='step = 8e-4\nstep_control = "quantised"', more=fast))
    for ranks in (1, 2):
        run(ranks, "halved.scene.h5", "-o", f"halved{ranks}.run")
        made_is_dissipated(f"halved{ranks}.run")
    with open("halved1.run/steps.csv", encoding="utf-8") as file:
        changes = [line for line in file if not line.startswith("#")]
    assert len(changes) > 3, f"the step must have changed: {changes}"
    assert outcome("halved1.run")["state_hash"] == outcome("halved2.run")["state_hash"]
    # three balls roll into each other on a floor and fall asleep
    balls = "".join(f"""
[[bodies]]
shape = "ball"
material = "stone"
position = [{x}, 0, 0.0101]
velocity = [{v}, 0, 0]
""" for x, v in ((-0.025, 0.05), (0, 0), (0.025, -0.04)))
    text = heap(duration=1.2, time="sleep = true", heat="temperature = 300", every=0.02, checkpoint=0.6, more=balls)
    text = text.replace("margin = 2e-3", "margin = 0").replace("stiffness = 1e4", "stiffness = 2e3").replace('friction = 0.5\n[[pairs]]', 'friction = 0.5\nrolling_friction = 0.05\n[[pairs]]')
    text = text.replace("heat_capacity = 0.5", "heat_capacity = 5")
    pack("tired", text)
    states = set()
    for ranks in (1, 3):
        run(ranks, "tired.scene.h5", "-o", f"tired{ranks}.run")
        made_is_dissipated(f"tired{ranks}.run")
        balance_closes(f"tired{ranks}.run")
        states.add(outcome(f"tired{ranks}.run")["state_hash"])
    assert column("tired1.run", "asleep")[-1] == 3 and len(states) == 1, (column("tired1.run", "asleep"), states)


def bodies_that_come_and_go_carry_their_heat():
    more = """
[[inlets]]
name = "feed"
shapes = { ball = 1, rock = 1 }
material = "stone"
number_rate = 200
temperature = "100 degC"
region = { box = [[-0.038, -0.038, 0.1], [0.038, 0.038, 0.158]] }
[[outlets]]
name = "drain"
region = { box = [[-0.04, -0.04, -0.1], [0.04, 0.0, 0.03]] }
to = "feed"
"""
    pack("flow", heap(duration=0.12, more=POPULATION + more))
    states = set()
    for ranks in (1, 3):
        run(ranks, "flow.scene.h5", "-o", f"flow{ranks}.run")
        states.add(outcome(f"flow{ranks}.run")["state_hash"])
        balance_closes(f"flow{ranks}.run")
    assert len(states) == 1, states
    assert column("flow1.run", "heat_arrived")[-1] > 0 and column("flow1.run", "heat_removed")[-1] > 0
    assert frame("flow1.run", -1)["temperature"].max() > 350, "what comes in is hot"
    pack("fed", heap(duration=0.06, more=POPULATION + more[:more.index("[[outlets]]")]))
    run(1, "fed.scene.h5", "-o", "fed.run")
    brought = column("fed.run", "inserted_mass")[-1] * 0.5 * 373.15
    assert brought > 0 and abs(column("fed.run", "heat_arrived")[-1] / brought - 1) < 1e-12, (brought, column("fed.run", "heat_arrived"))


def a_wall_keeps_what_it_cannot_give():
    """No body touches it before one falls on it: then that body gets all."""
    text = heap(duration=0.1, time="step = 1e-4", friction="false", heat="temperature = 300", every=0.01, checkpoint=0.05, more="""
[[bodies]]
shape = "ball"
material = "stone"
position = [0, 0, 0.03]
""")
    text = text.replace('temperature = "60 degC"', 'heat_flux = "0.3 W"').replace("margin = 2e-3", "margin = 0")
    pack("kept", text)
    run(1, "kept.scene.h5", "-o", "kept.run")
    time, kept, given = (column("kept.run", name) for name in ("time", "wall2_heat_kept", "wall2_heat"))
    assert abs(kept + given - 0.3 * time).max() <= 1e-12 * 0.3 * time[-1], (kept, given)
    assert kept.max() > 0.3 * 0.05 and given[-1] > 0.3 * 0.05, (kept, given)
    balance_closes("kept.run")
    heat = 2500 * 4 / 3 * math.pi * 0.01**3 * 0.5 * frame("kept.run", -1)["temperature"][0]
    assert abs(column("kept.run", "heat")[-1] / heat - 1) < 1e-13, "mass times heat capacity times temperature"
    shutil.copytree("kept.run", "killed.run")
    make_killed("killed.run", keep=1)
    assert kept[column("kept.run", "time") <= 0.051][-1] > 0, "the wall must keep some at the restart"
    run(1, "kept.scene.h5", "-o", "killed.run", "--restart", "latest")
    assert outcome("killed.run")["state_hash"] == outcome("kept.run")["state_hash"]


def tables_over_time_act_alike_on_any_ranks_and_after_a_restart():
    """Walls, outside, flux and sources by tables; among the bodies some that sleep, in a second case."""
    text = heap()
    for constant, table in (('heat_flux = "0.2 W"', 'heat_flux = { time = [0.01, 0.0201], power = ["0.2 W", "-0.3 W"] }'),
                            ('temperature = "60 degC"', 'temperature = { time = ["0 s", "11 ms", "60 ms"], temperature = ["60 degC", "90 degC", "20 degC"] }'),
                            ("coefficient = 1000, temperature = 280", "coefficient = 1000, temperature = { time = [0, 0.02], temperature = [280, 350] }"),
                            ("heat_source = 0.1", "heat_source = { time = [0.005, 0.03], power = [0.1, 0.5] }"),
                            ('temperature = "20 degC"', 'temperature = "20 degC"\nheat_source = { time = [0, 0.02, 0.021], power = [0.01, 0.01, 0] }')):
        assert text.count(constant) == 1, constant
        text = text.replace(constant, table)
    pack("tables", text)
    kept = None
    for ranks, threads in ((1, 2), (3, 1)):
        folder = f"tables{ranks}.run"
        run(ranks, "tables.scene.h5", "-o", folder, threads=threads)
        found = physics_of_log(folder), frame(folder, -1)["temperature"].tolist()
        kept = kept or found
        assert found == kept, f"{folder}: another run than on one rank"
        balance_closes(folder)
    shutil.copytree("tables3.run", "killed.run")
    make_killed("killed.run", keep=1)
    run(2, "tables.scene.h5", "-o", "killed.run", "--restart", "latest")
    assert (physics_of_log("killed.run"), frame("killed.run", -1)["temperature"].tolist()) == kept, "another run than without a kill"
    time, floor = column("tables1.run", "time"), column("tables1.run", "wall2_temperature")
    expected = numpy.interp(time, [0, 0.011, 0.06], [333.15, 363.15, 293.15])
    assert len(time) > 3 and abs(floor - expected).max() <= 1e-12 * 363.15, (floor, expected)
    # 30 bodies with 0.01 W for 20 ms and half of that for another; one with a table of its own
    knots = numpy.array([0, 0.005, 0.03, time[-1]])
    power = numpy.interp(knots, [0.005, 0.03], [0.1, 0.5])
    own = (numpy.diff(knots) * (power[1:] + power[:-1])).sum() / 2
    expected = 30 * (0.01 * 0.02 + 0.5 * 0.01 * 0.001) + own
    assert abs(column("tables1.run", "heat_from_sources")[-1] / expected - 1) < 1e-12, (column("tables1.run", "heat_from_sources")[-1], expected)
    said = run(1, "tables.scene.h5", "--plan").stdout
    for word in ("'floor' has 333.1 K at 0 s to 293.1 K at 60 ms (a table of 3 rows)", "30 bodies are each given 10 mW at 0 s", "1 body is given 100 mW at 5 ms",
                 "'side' gives 200 mW at 10 ms to -300 mW at 20.1 ms", "exchanges 1000 W/(m^2 K) with 280 K at 0 s"):
        assert word in said, f"no '{word}' in {said}"
    # a file that has such a table and was damaged
    for name, word in (("order", "the times must ascend"), ("index", "heat_table 7 found, but there are 2 tables")):
        shutil.copy("tables.scene.h5", f"{name}.scene.h5")
        with h5py.File(f"{name}.scene.h5", "r+") as file:
            if name == "index":
                file["bodies/heat_table"][0] = 7
            else:
                settings = json.loads(file["settings"][()])
                settings["settings"]["heat"]["source_tables"][0]["power"]["time"].reverse()
                del file["settings"]
                file["settings"] = numpy.bytes_(json.dumps(settings))
        said = run(1, f"{name}.scene.h5", "--plan", expect=3).stderr
        assert word in said, said


def a_step_beyond_that_of_conduction_ends_the_run():
    pack("fast", heap(duration=0.05).replace("heat_capacity = 0.5", "heat_capacity = 1e-8"))
    said = run(1, "fast.scene.h5", "-o", "fast.run", expect=5).stderr
    for word in ("conducts so well", "step of at most", "heat_capacity", "time.step"):
        assert word in said, said


def a_run_starts_with_the_temperatures_of_another():
    pack("first", heap(duration=0.02, checkpoint=0.01))
    run(1, "first.scene.h5", "-o", "first.run")
    pack("second", heap(duration=0.0, checkpoint=0.05, every=0.1, more='[start]\nrun = "first.run"\n'))
    with h5py.File("second.scene.h5") as file:
        begins = file["bodies/temperature"][()][file["bodies/id"][()].argsort()]
    assert (begins == frame("first.run", -1)["temperature"]).all()


def tables_statistics_colours_report_and_python_know_temperatures():
    pack("post", heap(duration=0.05, checkpoint=0.05))
    run(1, "post.scene.h5", "-o", "post.run")

    def post(*words, expect=0):
        result = subprocess.run([os.path.join(BIN, "scree-post"), *words], env=ENV, capture_output=True, text=True, timeout=200)
        assert result.returncode == expect, f"{words}: {result.stdout}{result.stderr}"
        return result.stdout + result.stderr

    post("bodies", "post.run", "-o", "post.csv")
    with open("post.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    last = frame("post.run", -1)
    time = max(float(row["time"]) for row in rows)
    told = {int(row["id"]): float(row["temperature"]) for row in rows if float(row["time"]) == time}
    assert told == dict(zip(last["id"].tolist(), last["temperature"].tolist()))
    post("statistics", "post.run", "-o", "post.statistics", "--no-charts")
    with open("post.statistics/series.csv", encoding="utf-8", newline="") as file:
        series = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["group"] == "all"]
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python"))
    import scree
    loaded = scree.open("post.run")
    assert (loaded.frames[-1].bodies.temperature == last["temperature"]).all()
    measured = loaded.frames[-1].measures()
    for name in ("temperature", "temperature_spread"):
        assert abs(measured[name] / float(series[-1][name]) - 1) < 1e-8, (name, measured[name], series[-1][name])   # nine digits in the table
    bodies = loaded.frames[-1].bodies.particles()
    assert abs(measured["temperature"] / (bodies.mass @ bodies.temperature / bodies.mass.sum()) - 1) < 1e-12 and measured["temperature_spread"] > 0
    assert "temperature" not in bodies.fields() and loaded.scene.has_heat and loaded.scene.materials["stone"].heat_capacity == 0.5
    post("report", "post.run", "-o", "post.html")
    with open("post.html", encoding="utf-8") as file:
        html = file.read()
    for words in ("Heat flow of walls", "From wall &#39;floor&#39;", "Largest Biot number"):
        assert words in html or words.replace("&#39;", "'") in html, words


BED = """
[time]
duration = {duration}
[heat]
frozen = true
{gas}
[start]
run = "settled.run"
"""


def frozen_bed(duration, gas="gas_conductivity = 0.05\ngas_range = 0.005", sources="", every=None):
    """The heap as it lies, with walls as before: materials, pairs and walls of the same text."""
    text = heap(duration=duration, friction="false", every=every, checkpoint=duration / 3, more="")
    return text[text.index("[contact]"):] + BED.format(duration=duration, gas=gas) + sources


def settled():
    if not os.path.exists("settled.run/run.json"):
        pack("settled", heap(duration=0.4, friction="false", checkpoint=0.4, every=0.2))
        run(1, "settled.scene.h5", "-o", "settled.run")


def a_frozen_bed_conducts_in_its_own_steps_with_the_same_bits():
    settled()
    pack("frozen", frozen_bed(30))
    kept = None
    for ranks, threads in ((1, 1), (1, 2), (2, 1), (3, 1)):
        folder = f"frozen{ranks}{threads}.run"
        run(ranks, "frozen.scene.h5", "-o", folder, threads=threads)
        found = physics_of_log(folder), [frame(folder, n)["temperature"].tolist() for n in (1, -1)]
        kept = kept or found
        assert found == kept, f"{folder}: another run than on one rank"
    shutil.copytree("frozen31.run", "frozen-killed.run")
    make_killed("frozen-killed.run", keep=1)
    run(2, "frozen.scene.h5", "-o", "frozen-killed.run", "--restart", "latest")
    assert (physics_of_log("frozen-killed.run"), [frame("frozen-killed.run", n)["temperature"].tolist() for n in (1, -1)]) == kept, "another run than without a kill"
    balance_closes("frozen11.run")
    record = outcome("frozen11.run")
    limit = column("frozen11.run", "heat_critical_step")
    step = record["time"] / record["steps"]
    assert 0.2 * limit.min() < step <= 0.25 * limit.min() * (1 + 1e-12) and limit.max() == limit.min(), (step, limit)
    first, last = frame("frozen11.run", 0), frame("frozen11.run", -1)
    assert (first["temperature"] == frame("settled.run", -1)["temperature"]).all() and numpy.ptp(last["temperature"]) > 1, last["temperature"]
    with h5py.File(sorted(glob.glob("frozen11.run/frame_*.hdf"))[0]) as begin, h5py.File(sorted(glob.glob("frozen11.run/frame_*.hdf"))[-1]) as end:
        assert (begin["VTKHDF/Points"][()] == end["VTKHDF/Points"][()]).all(), "bodies have moved"
        assert not end["VTKHDF/PointData/velocity"][()].any() and not end["VTKHDF/PointData/angular_velocity"][()].any()
    assert not column("frozen11.run", "kinetic_translational").any() and not column("frozen11.run", "kinetic_rotational").any()
    # a frame lies at each output time, whatever the step
    times = column("frozen11.run", "time")
    assert abs(times[-1] / 30 - 1) < 1e-12, times
    said = run(2, "verify", "frozen11.run").stdout
    assert "the same, bit for bit" in said, said


def a_frozen_bed_conducts_as_one_at_rest_that_moves_on():
    """The same heap, solved on with small steps and with its own: the same temperatures, to the last motion of the heap."""
    settled()
    duration = 0.05
    words = frozen_bed(duration, every=duration)
    pack("still", words)
    pack("moving", words.replace("frozen = true\n", ""))
    for name in ("still", "moving"):
        run(1, f"{name}.scene.h5", "-o", f"{name}.run")
    begin, still, moving = (frame(folder, n)["temperature"] for folder, n in (("still.run", 0), ("still.run", -1), ("moving.run", -1)))
    change = abs(still - begin).max()
    assert change > 1e-3 and abs(still - moving).max() < 0.05 * change, (change, abs(still - moving).max())
    assert outcome("still.run")["steps"] < 0.01 * outcome("moving.run")["steps"]


def gas_conducts_with_less_the_wider_the_gap():
    """Two balls that fly apart: what they exchange in a step falls, and ends at the range. On two ranks as on one."""
    text = heap(duration=0.02, time="step = 2e-5", friction="false", every=0.001, checkpoint=1, more="""
[[bodies]]
shape = "ball"
material = "stone"
position = [-0.0105, 0, 0.08]
velocity = [-0.2, 0, 0]
temperature = 350
[[bodies]]
shape = "ball"
material = "stone"
position = [0.0105, 0, 0.08]
velocity = [0.2, 0, 0]
temperature = 250
""").replace("[heat]\n", "[heat]\ngas_conductivity = 0.05\ngas_range = 0.005\n").replace("seed = 3\n", "seed = 3\ngravity = [0, 0, 0]\n")
    pack("apart", text)
    kept = None
    for ranks in (1, 2):
        run(ranks, "apart.scene.h5", "-o", f"apart{ranks}.run")
        series = [frame(f"apart{ranks}.run", n)["temperature"].tolist() for n in range(21)]
        kept = kept or series
        assert series == kept
    hot = numpy.array(kept)[:, 0]
    steps = -numpy.diff(hot)
    gaps = 0.001 + 0.4 * 0.001 * numpy.arange(21)
    inside = gaps[1:] < 0.005
    assert (steps[inside] > 0).all() and (numpy.diff(steps[inside]) < 0).all() and (steps[gaps[:-1] > 0.005 + 1e-9] == 0).all(), steps
    # of two balls of stone, alpha = 2 / 0.05; the gap in the middle of each interval
    alpha, radius, middle = 2 / 0.05, 0.01, 0.5 * (gaps[1:] + gaps[:-1])
    g0 = radius / (alpha**2 * math.exp(-3.9) - 1)
    conductance = math.pi * 0.05 * radius * numpy.log(1 + radius / (middle + g0))
    capacity = 2500 * 4 / 3 * math.pi * radius**3 * 0.5
    mean = 0.5 * (hot[1:] + hot[:-1]) - 300
    assert (abs(steps[inside] * capacity / (conductance[inside] * 2 * mean[inside] * 0.001) - 1) < 1e-3).all(), steps[inside] * capacity / (conductance[inside] * 2 * mean[inside] * 0.001)


def mistakes_are_told_with_their_line():
    base = heap()
    still = frozen_bed(30)
    settled()
    no_heat = base[:base.index("[heat]")] + base[base.index("[contact]"):]
    wrong = [
        ("no temperature", base.replace('temperature = "20 degC"', ""), 2, ["temperature", "is missing", "293 K", "[heat]"]),
        ("no capacity", base.replace("heat_capacity = 0.5", ""), 2, ["stone", "needs heat_capacity", "J/(kg K)"]),
        ("no conductivity", base.replace("conductivity = 2\n", ""), 2, ["stone", "needs conductivity", "W/(m K)"]),
        ("no heat", no_heat, 2, ["heat_capacity", "is for scenes with heat", "add a table [heat]"]),
        ("two of a wall", base.replace('temperature = "60 degC"', 'temperature = "60 degC"\nheat_flux = 1'), 2, ["heat_flux", "temperature", "give one"]),
        ("unit", base.replace('heat_flux = "0.2 W"', 'heat_flux = "0.2 J"'), 2, ["an energy", "a power", "5 W"]),
        ("below zero", base.replace("20 degC", "-300 degC"), 2, ["temperature", "> 0"]),
        ("unknown", base.replace("friction_heat", "frictionheat"), 2, ["frictionheat", "friction_heat"]),
        ("two of a table", base.replace('temperature = "60 degC"', 'temperature = { time = [0, 1], temperature = [300] }'), 2, ["temperature", "2 times and 1 temperatures"]),
        ("table back in time", base.replace("heat_source = 0.1", "heat_source = { time = [1, 0], power = [1, 2] }"), 2, ["heat_source", "must ascend"]),
        ("table of another unit", base.replace("heat_source = 0.1", 'heat_source = { time = [0, 1], power = ["1 W", "1 J"] }'), 2, ["power", "an energy", "a power"]),
        ("cold table", base.replace('temperature = "60 degC"', 'temperature = { time = [0, 1], temperature = [300, -3] }'), 2, ["temperature", "-3 K", "above 0"]),
        ("cold outside", base.replace("temperature = 280", "temperature = { time = [0, 1], temperature = [300, 0] }"), 2, ["exchange", "temperature", "0 K", "above 0"]),
        ("table without powers", base.replace('heat_flux = "0.2 W"', "heat_flux = { time = [0, 1] }"), 2, ["power", "missing"]),
        ("table without heat", no_heat.replace('temperature = "60 degC"', "").replace("heat_capacity", "#").replace("conductivity", "#").replace("real_young", "#").replace("contact_conductance", "#")
         .replace('temperature = "20 degC"', "").replace("exchange", "#").replace("temperature = 300", "").replace('heat_flux = "0.2 W"', "")
         .replace("heat_source = 0.1", "heat_source = { time = [0], power = [1] }"), 2, ["heat_source", "is for scenes with heat"]),
        ("exchange", base.replace("coefficient = 1000, ", ""), 2, ["exchange", "coefficient"]),
        ("gas alone", base.replace("[heat]", "[heat]\ngas_conductivity = 0.05"), 2, ["gas_conductivity", "gas_range", "belong together"]),
        ("range alone", base.replace("[heat]", "[heat]\ngas_range = 0.05"), 2, ["gas_conductivity", "gas_range", "belong together"]),
        ("thick gas", base.replace("[heat]", "[heat]\ngas_conductivity = 0.5\ngas_range = 0.01"), 2, ["gas_conductivity = 0.5", "stone", "a tenth"]),
        ("frozen motion", still.replace('temperature = "60 degC"', 'temperature = "60 degC"\nmotion = { translate = { velocity = [0, 0, 1] } }'), 2, ["frozen", "'floor'", "moves"]),
        ("frozen drive", still.replace('temperature = "60 degC"', 'temperature = "60 degC"\nmotion = { servo = { direction = [0, 0, -1], force = 1, max_speed = 1 } }'), 2, ["frozen", "'floor'", "answers to force"]),
        ("frozen rest", still.replace("duration = 30", "duration = 30\nstop_at_rest = true"), 2, ["frozen", "time.stop_at_rest"]),
        ("frozen friction", still.replace("frozen = true", "frozen = true\nfriction_heat = true"), 2, ["frozen", "heat.friction_heat"]),
        ("frozen fluid", still + "\n[fluid]\ndensity = 1\nviscosity = 1e-5\n", 2, ["frozen", "[fluid]"]),
    ]
    for name, text, code, words in wrong:
        assert text != base, name
        said = pack("wrong", text, expect=code)
        assert [word for word in said.split() if word.startswith("wrong.toml")], f"{name}: no place in {said}"
        for word in words:
            assert word in said, f"{name}: no '{word}' in {said}"
    pack("good", base)
    said = pack("wide", base.replace("[heat]", "[heat]\ngas_conductivity = 0.05\ngas_range = 0.3"))
    assert "heat.gas_range = 300 mm is wider than the largest body" in said, said
    said = pack("period", base.replace("[heat]", "[heat]\ngas_conductivity = 0.05\ngas_range = 0.1") + "[domain]\nmin = [-1, -0.1, -1]\nmax = [1, 0.1, 1]\nperiodic = [\"y\"]\n", expect=2)
    assert "periodic axis y" in said, said
    pack("long", still.replace("duration = 30", "duration = 300\nstep = 100"))
    said = run(1, "long.scene.h5", "-o", "long.run", expect=2).stderr
    for word in ("time.step = 100 s", "critical step", "conduction of body", "use at most"):
        assert word in said and said.count("critical step") == 1, said


def the_plan_tells_what_conducts():
    touching = """
[[bodies]]
shape = "ball"
material = "steel"
position = [0.02, 0.02, 0.00999]
temperature = 300
"""
    pack("plan", heap(more=POPULATION.replace("0.038, 0.002]", "0.038, 0.05]").replace("-0.038, 0.002]", "-0.038, 0.05]") + touching).replace("[contact]", "[contact]\nrelax = false"))
    said = run(1, "plan.scene.h5", "--plan").stdout
    settled()
    pack("frozen-plan", frozen_bed(30))
    frozen = run(1, "frozen-plan.scene.h5", "--plan").stdout
    for word in ("frozen", "heat through gas", "limited by conduction of body", "in gaps of up to 5 mm"):
        assert word in frozen, f"no '{word}' in {frozen}"
    for word in ("one temperature a body", "'floor' has 333.1 K", "'side' gives 200 mW", "'lid' exchanges", "with real_young", "critical step", "Biot"):
        assert word in said, f"no '{word}' in {said}"


main([the_same_bits_on_any_ranks_and_threads_and_after_a_restart, verify_finds_another_temperature, a_scene_without_heat_has_nothing_of_it,
      bodies_asleep_go_on_conducting, what_is_made_is_what_is_dissipated_as_steps_change_and_bodies_fall_asleep, bodies_that_come_and_go_carry_their_heat, a_wall_keeps_what_it_cannot_give,
      a_frozen_bed_conducts_in_its_own_steps_with_the_same_bits, a_frozen_bed_conducts_as_one_at_rest_that_moves_on, gas_conducts_with_less_the_wider_the_gap,
      tables_over_time_act_alike_on_any_ranks_and_after_a_restart, a_step_beyond_that_of_conduction_ends_the_run, a_run_starts_with_the_temperatures_of_another,
      tables_statistics_colours_report_and_python_know_temperatures, mistakes_are_told_with_their_line,
      the_plan_tells_what_conducts])
