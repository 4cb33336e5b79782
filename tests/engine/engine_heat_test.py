#!/usr/bin/env python3
"""Heat that a program gives to bodies: sources, media, new bodies with a temperature. usage: engine_heat_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import glob
import math
import os
import subprocess

from engine_cases import BIN, ENV, FLOOR, balls, main, one_ball, pack, program, refused, solver_hash  # isort: skip

import numpy as np  # noqa: E402
import scree  # noqa: E402

MASS = 1000 * 4 / 3 * math.pi * 0.01**3  # of one_ball()
CAPACITY = 0.05 * MASS  # of warm_ball() [J/K]


def with_heat(text, heat="temperature = 300", capacity=0.05):
    """A case with heat, of bodies of glass."""
    return text.replace("density = ", f"heat_capacity = {capacity}\nconductivity = 2\ndensity = ", 1) + f"\n[heat]\n{heat}\n"


def warm_ball(name="warm", heat="temperature = 300", **arguments):
    pack(name, with_heat(one_ball(**{"step": "2e-4", **arguments}), heat))
    return f"{name}.scene.h5"


def a_source_heats_by_its_power_over_the_heat_capacity():
    """T = T0 + P t / (m c), to rounding; it is held until it is given again."""
    with scree.Engine(warm_ball()) as engine:
        ids, power = engine.bodies.id, 3e-3
        engine.set_heat_source(ids, power)
        assert engine.bodies.temperature[0] == 300, "it acts over the next step"
        engine.step(400)
        rise = engine.bodies.temperature[0] - 300
        assert abs(rise * CAPACITY / (power * engine.time) - 1) < 1e-12, (rise, power * engine.time / CAPACITY)
        heat = engine.heat()
        assert abs(heat.from_program / (power * engine.time) - 1) < 1e-14 and heat.from_medium == heat.from_sources == 0, heat
        engine.set_heat_source(None, [-power])   # without ids: the bodies of this rank
        engine.step(400)
        assert abs(engine.bodies.temperature[0] - 300) < 1e-11 and abs(engine.heat().from_program) < 1e-16
        engine.clear_heat()
        engine.step(10)
        assert abs(engine.heat().from_program) < 1e-16 and engine.take_medium_heat(ids)[0] == 0


def a_medium_heats_by_its_exponential_to_second_order():
    """Each step multiplies T_m - T by 1 - x + x^2 / 2, x = G dt / (m c): to rounding. Against the exponential the error falls as the square of the step.
    The medium has given what is stored, and what it gave is taken once."""
    medium, errors = 400.0, []
    for step in ("4e-4", "2e-4"):
        with scree.Engine(warm_ball(step=step)) as engine:
            conductance = 0.1 * CAPACITY / 4e-4
            x, steps = conductance * engine.dt / CAPACITY, round(0.008 / engine.dt)
            ids, before = engine.bodies.id, engine.heat()
            engine.set_medium(ids, conductance, medium)
            engine.step(steps)
            temperature, heat = engine.bodies.temperature[0], engine.heat()
            exact = medium - 100 * math.exp(-x * steps)
            closed = medium - 100 * (1 - x + x * x / 2) ** steps
            assert abs(temperature - closed) < 1e-10, (temperature, closed)
            errors.append(temperature - exact)
            assert abs(heat.critical_step * conductance / CAPACITY - 1) < 1e-12, heat
            taken = engine.take_medium_heat(ids)[0]
            for given in (taken, heat.from_medium):
                assert abs(given / (CAPACITY * (temperature - 300)) - 1) < 1e-12, (given, CAPACITY * (temperature - 300))
            assert abs(taken / heat.from_medium - 1) < 1e-15, "the sum keeps what rounding takes from it"
            assert abs(heat.balance - before.balance) < 1e-12 * heat.stored and engine.take_medium_heat(ids)[0] == 0
            engine.set_medium(ids, 0, medium)   # a medium that is there, and exchanges nothing
            engine.step(10)
            assert engine.take_medium_heat(ids)[0] == 0 and engine.bodies.temperature[0] == temperature
    assert abs(errors[0] / errors[1] - 4) < 0.3, errors


def hot_pile(name="hot", **arguments):
    pack(name, with_heat(balls(**arguments), "temperature = 300\nfriction_heat = true", capacity=0.5))
    return f"{name}.scene.h5"


def the_same_bits_on_any_ranks_and_after_restart_and_restore():
    scene = hot_pile()
    os.mkdir("kept")
    expected = program("heated", 1, scene=scene, steps=400)
    assert expected[1]["from_program"] > 0 and expected[1]["from_medium"] > 0 and expected[1]["made"] > 0, expected
    assert len(expected[2]) == 50 and abs(sum(expected[2].values()) / expected[1]["from_medium"] - 1) < 1e-13, expected
    for ranks, threads in ((1, 2), (2, 1), (3, 1)):
        assert program("heated", ranks, threads, scene=scene, steps=400) == expected, (ranks, threads)
    for ranks in (1, 2):
        assert program("heated", ranks, scene=scene, steps=400, repeats=2) == expected, f"restored on {ranks} ranks"
    assert program("heated", 2, scene=scene, steps=400, folder="kept") == expected
    path, = glob.glob("kept/*.h5")
    for ranks in (1, 2, 3):
        assert program("heated", ranks, scene=scene, steps=400, path=path) == expected, f"from a checkpoint on {ranks} ranks"


def bodies_that_come_and_go_have_their_temperature_and_their_heat():
    """What passed from the media is the sum over bodies, those included that have left; on any ranks."""
    scene = hot_pile()
    states = []
    for ranks in (1, 2, 3):
        hash_, begin, arrived, end, taken, hot, mild, text = program("heat_comes_and_goes", ranks, scene=scene)
        states.append((hash_, end["stored"], end["from_medium"]))
        assert abs(hot - 500) < 1 and abs(mild - 300) < 1, (hot, mild)
        c = 2500 * 4 / 3 * math.pi * 0.004**3 * 0.5
        assert abs(arrived["arrived"] / (9 * c * 800) - 1) < 1e-12, (arrived, 9 * c * 800)
        assert end["removed"] > 0 and abs(end["balance"] - begin["balance"]) < 1e-12 * end["stored"], (begin, end)
        assert end["from_medium"] > 0 and abs(taken / end["from_medium"] - 1) < 1e-12, (taken, end)
        assert "can be taken once" in text, text
    assert states[0] == states[1] == states[2], states


def a_body_asleep_is_heated_and_sleeps_on():
    scene = warm_ball(position="[0, 0, 0.0099]", gravity="[0, 0, -9.81]", more=FLOOR, time="sleep = true", step="1e-4")
    with scree.Engine(scene) as engine:
        engine.run_until(0.8)
        assert engine.bodies.asleep.tolist() == [1]
        before, place = engine.bodies.temperature[0], engine.bodies.position.tolist()
        conductance, steps = 0.02 * CAPACITY / engine.dt, 50
        engine.set_medium(engine.bodies.id, conductance, 350)
        engine.step(steps)
        closed = 350 - (350 - before) * (1 - 0.02 + 0.0002) ** steps
        assert abs(engine.bodies.temperature[0] - closed) < 1e-10, (engine.bodies.temperature, closed)
        engine.clear_heat()
        engine.set_heat_source(engine.bodies.id, 1e-3)
        engine.step(steps)
        assert abs(engine.bodies.temperature[0] - closed - 1e-3 * steps * engine.dt / CAPACITY) < 1e-10
        assert engine.bodies.asleep.tolist() == [1] and engine.bodies.position.tolist() == place


def a_step_too_long_for_the_medium_ends_the_run_and_says_so():
    with scree.Engine(warm_ball()) as engine:
        limit = CAPACITY / engine.dt
        state = engine.save()
        engine.set_medium(engine.bodies.id, 0.99 * limit, 400)
        engine.step(20)
        engine.set_medium(engine.bodies.id, 1.01 * limit, 400)
        said = refused(scree.RunInvalid, "exchanges heat so well that its temperature is stable with a step of at most", lambda: engine.step(5))
        assert "of the medium that the program gives it" in said and "or the medium a smaller conductance" in said, said
        engine.restore(state)
        assert engine.bodies.temperature[0] == 300
        engine.set_heat_source(engine.bodies.id, -1e3)
        refused(scree.RunInvalid, "below absolute zero; take less from it (heat_source, heat_flux, the sources of a program)", lambda: engine.step(100))


def a_frozen_bed_exchanges_heat_with_its_medium():
    """Nothing moves, and steps are those of heat: the same closed form. What moves bodies is refused."""
    scene = warm_ball("frozen", heat="temperature = 300\nfrozen = true", step="0.5")
    with scree.Engine(scene) as engine:
        conductance, steps = 0.1 * CAPACITY / engine.dt, 30
        engine.set_medium(engine.bodies.id, conductance, 400)
        engine.step(steps)
        closed = 400 - 100 * (1 - 0.1 + 0.005) ** steps
        assert abs(engine.bodies.temperature[0] - closed) < 1e-10, (engine.bodies.temperature, closed)
        for call, action in (("insert", lambda: engine.insert("ball", "glass", [0, 0, 1], temperature=300)), ("set_wrench", lambda: engine.set_wrench([0], [0, 0, 1]))):
            refused(scree.UsageError, f"{call}: heat.frozen keeps bodies as they are; leave it out of the case", action)


def mistakes_are_told_with_a_cure_and_change_nothing():
    pack("cold", one_ball())
    with scree.Engine("cold.scene.h5") as engine:
        for call, action in (("set_heat_source", lambda: engine.set_heat_source([0], 1)), ("set_medium", lambda: engine.set_medium([0], 1, 300)), ("clear_heat", engine.clear_heat),
                             ("take_medium_heat", engine.take_medium_heat), ("heat", engine.heat)):
            refused(scree.UsageError, f"{call}: the scene has no heat, and its bodies no temperature; add a table [heat] to the case", action)
        refused(scree.UsageError, "body 0 of this call has a temperature, and the scene has no heat; leave it out", lambda: engine.insert("ball", "glass", [0, 0, 1], temperature=300))
        refused(scree.UsageError, "temperature", lambda: engine.bodies.temperature)
    scene = hot_pile()
    with scree.Engine(scene) as engine, scree.Engine(scene) as twin:
        one, two = engine.bodies.id[:2].tolist()
        for each in (engine, twin):
            each.set_medium([one], 1e-3, 400)
        for text, action in (
                ("no body of the run has the id 9999; it is a wall, has left, or was never there: take ids from bodies", lambda: engine.set_heat_source([one, 9999], 1)),
                ("no body of the run has the id 9999", lambda: engine.set_medium([one, 9999], 1e-3, 300)),
                ("no body of the run has the id 9999", lambda: engine.clear_heat([9999])),
                ("no body of the run has the id 9999", lambda: engine.take_medium_heat([one, 9999])),
                (f"body {one} is named twice in one call; name it once", lambda: engine.set_heat_source([one, two, one], 1)),
                (f"body {one} is named twice in one call; name it once", lambda: engine.take_medium_heat([one, one])),
                (f"body {two} gets a source of nan W, which is not a finite number", lambda: engine.set_heat_source([one, two], [1, math.nan])),
                (f"body {two} gets a medium with a conductance of -0.001 W/K; expected a finite number >= 0, h A", lambda: engine.set_medium([one, two], [1, -1e-3], 300)),
                (f"body {two} gets a medium with a conductance of nan W/K", lambda: engine.set_medium([two], math.nan, 300)),
                (f"body {two} gets a medium with a temperature of 0 K; expected a finite number > 0, in kelvin", lambda: engine.set_medium([two], 1, 0)),
                (f"body {two} gets a medium with a temperature of -20 K", lambda: engine.set_medium([two], 1, -20)),
                ("set_heat_source: power: shape (3,) found, (2,) expected, a row for each body, or () for all", lambda: engine.set_heat_source([one, two], [1, 2, 3])),
                ("set_medium: temperature: shape (1, 2) found", lambda: engine.set_medium([one, two], 1, [[300, 300]])),
                ("set_medium: conductance: shape (3,) found, (80,) expected", lambda: engine.set_medium(None, [1, 2, 3], 300)),
                ("set_heat_source: ids: float64 of shape (1,) found, a list of whole numbers expected", lambda: engine.set_heat_source([1.5], 1)),
                ("set_medium: conductance: str found that is no array of numbers", lambda: engine.set_medium([one], "much", 300)),
                ("body 1 of this call has a temperature of -5 K; expected a finite number > 0, in kelvin", lambda: engine.insert("ball", "glass", [[0, 0, 0.1], [0, 0, 0.12]], temperature=[300, -5])),
                ("body 0 of this call has a temperature of nan K", lambda: engine.insert("ball", "glass", [0, 0, 0.1], temperature=math.nan)),
                ("insert: temperature: shape (2,) found, (1,) expected", lambda: engine.insert("ball", "glass", [[0, 0, 0.1]], temperature=[300, 300]))):
            refused(scree.UsageError, text, action)
        late, = engine.insert("ball", "glass", [0, 0, 0.15], temperature=310)
        for call, action in (("set_medium", lambda: engine.set_medium([late], 1, 300)), ("set_heat_source", lambda: engine.set_heat_source([late], 1)),
                             ("take_medium_heat", lambda: engine.take_medium_heat([late])), ("clear_heat", lambda: engine.clear_heat([late]))):
            refused(scree.UsageError, f"{call}: body {late} was inserted and joins in the next step; make a step first", action)
        twin.insert("ball", "glass", [0, 0, 0.15], temperature=310)
        engine.step(50)
        twin.step(50)
        assert engine.state_hash() == twin.state_hash() and engine.heat() == twin.heat(), "what was refused has changed nothing"
        before = engine.heat()
        engine.close()
        refused(scree.UsageError, "the engine is closed", lambda: engine.set_heat_source([one], 1))
        assert before.critical_step > 0
    each = "".join(f'\n[[bodies]]\nshape = "ball"\nmaterial = "{material}"\nposition = [0, 0, {z}]\ntemperature = 300\n' for material, z in (("glass", 0.1), ("glass", 0.2)))
    wall = FLOOR.replace('"glass"', '"rubber"')
    pack("each", with_heat(one_ball(position="[0.1, 0, 0.05]", body="temperature = 300", more=each + wall + '[materials.rubber]\ndensity = 1\n[[pairs]]\nbetween = ["glass", "rubber"]\nstiffness = 1e3\nrestitution = 0.5\n'), ""))
    with scree.Engine("each.scene.h5") as engine:
        refused(scree.UsageError, "body 0 of this call has no temperature, and [heat] of the case has none for all bodies; give one", lambda: engine.insert("ball", "glass", [0, 0, 1]))
        refused(scree.UsageError, "is of 'rubber', which has no heat_capacity and conductivity; give both to the material in the case",
                lambda: engine.insert("ball", "rubber", [0, 0, 1], temperature=300))


def a_run_folder_has_the_heat_of_the_program_in_log_balance_and_report():
    scene = hot_pile(every=0.01)
    hash_, steps = solver_hash(scene, "plain.run")
    assert "heat_from_program" not in scree.open("plain.run").log and "heat_from_medium" not in scree.open("plain.run").log, "a scene without a program has no such columns"
    with scree.Engine(scene) as engine:
        engine.step(steps)
        assert engine.state_hash() == hash_, "an engine that gives no heat has the bits of scree-solver"
    with scree.Engine(scene, run="program.run") as engine:
        ids = engine.bodies.id
        engine.set_heat_source(ids[:30], 0.1)
        engine.set_medium(ids[10:], 2e-3, 350)
        engine.run_until(0.03)
        end = engine.heat()
    with scree.Engine(scene, run="program.run", restart="latest") as engine:
        assert abs(engine.heat().from_program / end.from_program - 1) < 1e-14, "a restart goes on with what was held"
        while not engine.is_over:
            engine.step()
        end = engine.heat()
    log = scree.open("program.run").log
    for column, value in (("heat_from_program", end.from_program), ("heat_from_medium", end.from_medium), ("heat", end.stored)):
        assert log[column][-1] == value > 0, (column, log[column], value)
    assert (np.diff(log["heat_from_program"]) > 0).all() and abs(log["heat_balance"] - log["heat_balance"][0]).max() < 1e-12 * log["heat"].max()
    subprocess.run([os.path.join(BIN, "scree-post"), "report", "program.run", "-o", "report.html"], env=ENV, check=True, capture_output=True)
    with open("report.html", encoding="utf-8") as file:
        text = file.read()
    assert "From sources of the program" in text and "From media of the program" in text


if __name__ == "__main__":
    main([
        a_source_heats_by_its_power_over_the_heat_capacity, a_medium_heats_by_its_exponential_to_second_order,
        the_same_bits_on_any_ranks_and_after_restart_and_restore, bodies_that_come_and_go_have_their_temperature_and_their_heat,
        a_body_asleep_is_heated_and_sleeps_on, a_step_too_long_for_the_medium_ends_the_run_and_says_so,
        a_frozen_bed_exchanges_heat_with_its_medium, mistakes_are_told_with_a_cure_and_change_nothing,
        a_run_folder_has_the_heat_of_the_program_in_log_balance_and_report,
    ])
