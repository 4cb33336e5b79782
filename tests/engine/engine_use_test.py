#!/usr/bin/env python3
"""The engine as a Python user meets it: reading, mistakes, errors on ranks, Ctrl-C, files, warnings. usage: engine_use_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import ctypes
import gc
import glob
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
import warnings

from engine_cases import ENV, FLOOR, GLASS, MPIEXEC, PARTNER, balls, main, needs_mpi4py, one_ball, outcome, pack, pile, program, refused, solver_hash  # isort: skip

import h5py  # noqa: E402
import numpy as np  # noqa: E402
import scree  # noqa: E402
from tool_runs import MEASURED  # noqa: E402

MASS = 1000 * 4 / 3 * math.pi * 0.01**3  # of one_ball()
WEIGHT = 9.81 * MASS


def bodies_are_those_of_one_moment():
    pack("balls", balls())
    with scree.Engine("balls.scene.h5") as engine:
        assert repr(engine) == "<scree.Engine 'balls.scene.h5': step 0 at 0 s, 80 bodies>"
        start = scree.open_scene("balls.scene.h5").start
        bodies = engine.bodies
        order = np.argsort(bodies.id)
        assert len(bodies) == 80 and (bodies.id[order] == start["id"]).all()
        assert np.abs(bodies.position[order] - start["position"]).max() < 1e-17 and (bodies.velocity == [0.4, 0.3, -0.5]).all()
        assert set(bodies.shape_name) == {"ball"} and set(bodies.material_name) == {"glass"} and not bodies.shape.any() and not bodies.material.any()
        volume = 4 / 3 * math.pi * 0.004**3
        for name, value in (("mass", 2500 * volume), ("volume", volume), ("diameter", 0.008), ("radius", 0.004), ("scale", 1)):
            assert np.abs(getattr(bodies, name) / value - 1).max() < 1e-12, name
        assert np.abs(np.linalg.norm(bodies.quaternion, axis=1) - 1).max() < 1e-15
        assert not bodies.fixed.any() and not bodies.asleep.any() and not bodies.angular_velocity.any()
        assert np.abs(bodies.force - [[0, 0, -9.81 * 2500 * volume]]).max() < 1e-15 and not bodies.torque.any()
        before = bodies.position.copy()
        engine.step(10)
        assert (bodies.position == before).all() and (engine.bodies.position != before).any(), "what was read stays"
        late = engine.bodies
        low = late[late.position[:, 2] < 0.03]
        assert 0 < len(low) < 80 and (low.id == late.id[late.position[:, 2] < 0.03]).all() and low.row(int(low.id[3])) == 3
        kept = engine.bodies.read("mass", "force")
        engine.step(1)
        assert kept.mass.shape == (80,) and kept.force.shape == (80, 3)
        for action in (lambda: late.velocity, lambda: low.mass, lambda: kept.torque):
            refused(scree.UsageError, "has moved on", action)
        refused(ValueError, "read-only", lambda: late.position.__setitem__((0, 0), 1))
        refused(scree.UsageError, "temperature", lambda: engine.bodies.temperature)
        refused(scree.UnknownName, "there are: id, position", lambda: engine.bodies.read("places"))
        refused(scree.UnknownName, "body 12345", lambda: engine.bodies.row(12345))
        everything = engine.bodies.read()
    assert everything.quaternion.shape == (80, 4) and "torque" in repr(everything)
    assert everything.fields()["angular_velocity"].unit == "rad/s"


def a_ball_at_rest_has_its_weight_in_contact_wall_and_energies():
    """Load, contact force and overlap of a ball that has come to rest: m g, m g / k; 1e-9."""
    pack("rest", one_ball(gravity="[0, 0, -9.81]", step="1e-4", position="[0.02, 0.03, 0.0099]", more=FLOOR))
    with scree.Engine("rest.scene.h5") as engine:
        assert np.abs(engine.gravity - [0, 0, -9.81]).max() == 0 and engine.duration == 1 and engine.dt == 1e-4
        engine.run_until(0.99999)
        assert engine.steps == 10000 and abs(engine.time - 1) < 1e-12
        floor, contacts = engine.walls["floor"], engine.contacts()
        assert list(engine.walls) == ["floor"] and floor.name == "floor" and "floor" in repr(floor)
        assert np.abs(floor.load - [0, 0, -WEIGHT]).max() < 1e-9 * WEIGHT
        assert np.abs(floor.torque - np.cross([0.02, 0.03, 0], floor.load)).max() < 1e-9 * WEIGHT
        assert floor.quaternion.tolist() == [1, 0, 0, 0] and not floor.velocity.any() and not floor.angular_velocity.any() and floor.position.shape == (3,)
        assert len(contacts) == 1 and contacts.body_a[0] == engine.bodies.id[0] and contacts.feature.shape == (1,)
        assert np.abs(contacts.force[0] - [0, 0, WEIGHT]).max() < 1e-9 * WEIGHT and abs(contacts.normal_force[0] / WEIGHT - 1) < 1e-9
        assert abs(contacts.overlap[0] / (WEIGHT / 1e3) - 1) < 1e-9 and contacts.margin.shape == (1,) and contacts.normal[0, 2] == 1
        assert np.abs(contacts.point[0] - [0.02, 0.03, 0]).max() < 1e-3 and contacts.tangential_force.shape == (1, 3)
        energies = engine.energies()
        assert energies.kinetic == energies.translational + energies.rotational < 1e-15
        assert abs(energies.elastic / (0.5 * WEIGHT**2 / 1e3) - 1) < 1e-6 and energies.dissipated > 0
        others = ("tangential_elastic", "wall_work", "outer_work", "removed", "arrived", "bond", "fracture", "slept")
        assert not any(getattr(energies, name) for name in others), energies
        assert abs(energies.potential + energies.elastic + energies.dissipated + energies.kinetic - energies.balance) < 1e-15
        assert 1e-4 < engine.critical_step() < 1
        assert np.abs(engine.bodies.force[0]).max() < 1e-9 * WEIGHT
        refused(scree.UnknownName, "there are: floor", lambda: engine.walls["lid"])
        refused(scree.UsageError, "", lambda: floor.way)
        refused(scree.UsageError, "", lambda: floor.drive(0.1))
        refused(scree.UsageError, "a number expected", lambda: floor.drive("fast"))


def a_frame_is_the_whole_scene_on_every_rank():
    pack("balls", balls())
    found = {ranks: program("moments", ranks, scene="balls.scene.h5", steps=2500) for ranks in (1, 2, 3)}
    numbers, files = zip(*found.values())
    assert len(set(numbers)) == 1 and numbers[0] > 0.5, numbers
    with scree.Engine("balls.scene.h5") as engine:
        frame = engine.frame()
        path = frame.path
        engine.step(5)
        assert frame.time == 0 and len(frame.contacts) == 0 and frame.walls.name == ["box"] and os.path.exists(path)
        engine.write_frame("own.hdf")
        with h5py.File("own.hdf") as file:
            assert file["frame"].attrs["step"] == 5
        view = engine.frame().walls
        for chain in (lambda: engine.frame().bodies.position, lambda: engine.frame().walls.position, lambda: engine.frame().contacts.normal_force,
                      lambda: engine.frame().bodies[:3].velocity, lambda: view.force):
            assert len(chain()) in (80, 3, 1, 0), "the file lives as long as anything that was taken from its frame"
        bodies = frame.bodies
        del frame
        gc.collect()
        assert os.path.exists(path) and bodies.mass.shape == (80,)
        del bodies
        gc.collect()
        assert not os.path.exists(path)
        refused(scree.MachineError, "nowhere", lambda: engine.write_frame("nowhere/own.hdf"))


def functions_of_forces_see_bodies_during_the_call_only():
    pack("balls", balls())
    kept = []

    def look(bodies):
        kept[:] = [bodies, bodies.position, bodies[:3]]
        assert len(bodies) == 80 and set(bodies.shape_name) == {"ball"} and bodies.velocity.flags.writeable is False
        assert engine.steps >= 0 and engine.time >= 0 and engine.dt > 0

    def both(bodies):
        return np.zeros((len(bodies), 3)), np.tile([0, 0, 1e-7], (len(bodies), 1))

    with scree.Engine("balls.scene.h5") as engine:
        number = engine.add_force(look)
        engine.step(2)
        assert kept[1].shape == (80, 3) and (kept[1] == engine.bodies.position).all(), "arrays stay, and are of the new places"
        refused(scree.UsageError, "end with its call", lambda: kept[0].velocity)
        refused(scree.UsageError, "end with its call", lambda: kept[0].position)
        refused(scree.UsageError, "end with its call", lambda: kept[2].mass)
        engine.remove_force(number)
        engine.add_force(both, every=3)
        engine.step(1)
        torque = engine.bodies.torque
        assert np.abs(torque - [0, 0, 1e-7]).max() < 1e-20
        state = engine.save()
        for function, kind, text in (
                (lambda bodies: np.zeros((3, 3)), scree.UsageError, r"shape (3, 3) found, (80, 3) expected"),
                (lambda bodies: "much", scree.UsageError, "no array of numbers"),
                (lambda bodies: engine.step(), scree.UsageError, "within a step"),
                (lambda bodies: engine.bodies.position, scree.UsageError, "within a step"),
                (lambda bodies: engine.close(), scree.UsageError, "within a step"),
                (lambda bodies: [0, 0, math.nan], scree.UsageError, "a force of (0 0 nan) N, which is not finite"),
                (lambda bodies: 1 // 0, ZeroDivisionError, "by zero")):
            refused(kind, text, lambda: engine.add_force(function))  # it is called at once
            engine.step(1)  # nothing was added
        calls = []
        fails = engine.add_force(lambda bodies: calls.append(1) or (None if len(calls) < 5 else 1 // 0))
        refused(ZeroDivisionError, "by zero", lambda: engine.step(100))
        refused(scree.UsageError, "restore a saved state", engine.step)
        refused(scree.UsageError, "in the midst of a step", lambda: engine.bodies.position)
        calls.clear()  # as it is called again at once
        engine.restore(state)
        engine.remove_force(fails)
        engine.step(20)


def mistakes_are_told_with_a_cure():
    pack("balls", balls() + '[[bodies]]\nshape = "ball"\nmaterial = "glass"\nposition = [0, 0, 0.15]\nfixed = true\n')
    pack("other", balls(duration=0.01))
    engine = scree.Engine("balls.scene.h5")
    other = scree.Engine("other.scene.h5")
    state, foreign, walls = engine.save(), other.save(), other.walls
    other.close()
    stuck = int(engine.bodies.id[engine.bodies.fixed == 1][0])
    one, two = engine.bodies.id[engine.bodies.fixed == 0][:2].tolist()
    os.mkdir("empty.run")
    for kind, text, action in (
            (scree.UsageError, "the engine is closed; open another one", lambda: other.step()),
            (scree.UsageError, "the engine is closed", lambda: other.time),
            (scree.UsageError, "bodies: the engine is closed", lambda: other.bodies),
            (scree.UsageError, "steps: the engine is closed", lambda: other.steps),
            (scree.UsageError, "energies: the engine is closed", lambda: other.energies()),
            (scree.UsageError, "walls: the engine is closed", lambda: walls["box"].position),
            (scree.UsageError, "add_force: the engine is closed", lambda: other.add_force(lambda bodies: None)),
            (scree.UsageError, "insert: the engine is closed", lambda: other.insert("ball", "glass", [0, 0, 0.19])),
            (scree.UsageError, "frame: the engine is closed", lambda: other.frame()),
            (scree.UsageError, "after_step: the engine is closed", lambda: other.after_step(lambda engine: None)),
            (scree.InputError, "missing.scene.h5", lambda: scree.Engine("missing.scene.h5")),
            (scree.UsageError, "None for this process alone", lambda: scree.Engine("balls.scene.h5", comm=2)),
            (scree.UsageError, "a path expected", lambda: scree.Engine(2)),
            (scree.UsageError, "a whole number of at least 1", lambda: scree.Engine("balls.scene.h5", threads=0)),
            (scree.UsageError, "of a run folder", lambda: scree.Engine("balls.scene.h5", restart="latest")),
            (scree.InputError, "missing.h5: no such checkpoint; checkpoints are the files checkpoint_", lambda: scree.Engine("balls.scene.h5", restart="missing.h5")),
            (scree.InputError, "balls.scene.h6: no such checkpoint, did you mean 'balls.scene.h5'?", lambda: scree.Engine("balls.scene.h5", restart="balls.scene.h6")),
            (scree.InputError, "empty.run: is a folder, a checkpoint was expected", lambda: scree.Engine("balls.scene.h5", restart="empty.run")),
            (AttributeError, "Engine has no 'gravty' that could be set; did you mean 'gravity'?", lambda: setattr(engine, "gravty", 0)),
            (AttributeError, "Engine.dt cannot be set", lambda: setattr(engine, "dt", 1)),
            (AttributeError, "Engine.walls cannot be set", lambda: setattr(engine, "walls", 1)),
            (AttributeError, "Engine has no 'set_wrenches'; did you mean 'set_wrench'?", lambda: engine.set_wrenches),
            (AttributeError, "EngineBodies has no 'positions'; did you mean 'position'?", lambda: engine.bodies.positions),
            (AttributeError, "EngineBodies has no 'vel'; did you mean 'velocity'?", lambda: engine.bodies.vel),
            (AttributeError, "EngineBodies.velocity cannot be set", lambda: setattr(engine.bodies, "velocity", 1)),
            (AttributeError, "EngineWall.drive cannot be set", lambda: setattr(engine.walls["box"], "drive", 1)),
            (AttributeError, "EngineWall.name cannot be set", lambda: setattr(engine.walls["box"], "name", "lid")),
            (AttributeError, "Bodies has no 'positions'; did you mean 'position'?", lambda: engine.frame().bodies.positions),
            (scree.UsageError, "a whole number of at least 0", lambda: engine.step(-1)),
            (scree.UsageError, "a whole number expected", lambda: engine.step(0.5)),
            (scree.UsageError, "a number expected", lambda: engine.run_until("end")),
            (scree.UsageError, "no time that can be reached", lambda: engine.run_until(math.inf)),
            (scree.UsageError, "take ids from bodies", lambda: engine.set_wrench([10**6], [0, 0, 1])),
            (scree.UsageError, "name it once", lambda: engine.set_wrench([one, two, one], [0, 0, 1])),
            (scree.UsageError, "not a finite number", lambda: engine.set_wrench([one], [0, 0, math.nan])),
            (scree.UsageError, "fixed", lambda: engine.set_wrench([stuck], [0, 0, 1])),
            (scree.UsageError, "(2, 3) expected, a row for each body", lambda: engine.set_wrench([one, two], [[0, 0, 1]])),
            (scree.UsageError, "(1, 3) expected", lambda: engine.set_wrench([one], [0, 0, 1], torque=1)),
            (scree.UsageError, "bodies.id[mask]", lambda: engine.set_wrench(engine.bodies.id > 3, [0, 0, 1])),
            (scree.UsageError, "whole numbers", lambda: engine.set_wrench([1.5], [0, 0, 1])),
            (scree.UsageError, "no array of numbers", lambda: engine.set_wrench([one], ["much"])),
            (scree.UsageError, "take ids from bodies", lambda: engine.clear_wrench([10**6])),
            (scree.UsageError, "a function expected", lambda: engine.add_force([0, 0, 1])),
            (scree.UsageError, "at least 1", lambda: engine.add_force(lambda bodies: None, every=0)),
            (scree.UsageError, "never added", lambda: engine.remove_force(77)),
            (scree.UsageError, "a function expected", lambda: engine.after_step(3)),
            (scree.UsageError, "never added with after_step", lambda: engine.remove_after_step(1)),
            (scree.UsageError, "a state from save() expected", lambda: engine.restore("state")),
            (scree.UsageError, "of another scene", lambda: engine.restore(foreign)),
            (scree.UnknownName, "there are: ball", lambda: engine.insert("bell", "glass", [0, 0, 0.19])),
            (scree.UnknownName, "there are: glass", lambda: engine.insert("ball", "grass", [0, 0, 0.19])),
            (scree.UsageError, "(n, 3) or (3,) expected", lambda: engine.insert("ball", "glass", [0, 0])),
            (scree.UsageError, "one or 2 expected", lambda: engine.insert(["ball"], "glass", np.zeros((2, 3)))),
            (scree.UsageError, "divide it by its norm", lambda: engine.insert("ball", "glass", [0, 0, 0.19], quaternion=[1, 1, 0, 0])),
            (scree.UsageError, "expected a number > 0", lambda: engine.insert("ball", "glass", [0, 0, 0.19], scale=0)),
            (scree.UsageError, "position of body 1 of this call is (0 0 nan), which is not finite", lambda: engine.insert("ball", "glass", [[0, 0, 0.19], [0, 0, math.nan]])),
            (scree.UsageError, "angular_velocity of body 0 of this call is (inf 0 0)", lambda: engine.insert("ball", "glass", [0, 0, 0.19], angular_velocity=[math.inf, 0, 0])),
            (scree.UsageError, "velocity of body 0 of this call is (0 nan 0)", lambda: engine.insert("ball", "glass", [0, 0, 0.19], velocity=[0, math.nan, 0])),
            (scree.UsageError, "take ids from bodies", lambda: engine.remove([10**6])),
            (scree.ScreeError, "nowhere", lambda: engine.write_checkpoint("nowhere"))):
        refused(kind, text, action)
        engine.step(1)  # and it goes on
    twin = scree.Engine("balls.scene.h5")
    twin.step(engine.steps)
    assert twin.state_hash() == engine.state_hash(), "what was refused has changed nothing"
    twin.close()
    twin.close()
    refused(scree.UsageError, "closed", lambda: twin.restore(state))
    assert "closed" in repr(twin) and "step 0 at 0 s" in repr(state) and (state.time, state.steps) == (0, 0)
    engine.close()
    there = os.environ["SCREE_BIN"]
    away = os.path.join(os.getcwd(), "away", "bin")  # a folder with no library near it: the library is also searched for in ../lib
    os.makedirs(away)
    for name, value, text in (("SCREE_BIN", away, "set SCREE_ENGINE_LIBRARY to its path"), ("SCREE_ENGINE_LIBRARY", "lost.so", "no such file")):
        result = subprocess.run([sys.executable, "-c", "import scree; scree.Engine('balls.scene.h5')"], env=dict(ENV, SCREE_BIN=there) | {name: value}, capture_output=True, text=True)
        assert "UsageError: " in result.stderr and text in result.stderr, result.stderr


def only_one_thread_is_within_a_call():
    pack("balls", balls())
    with scree.Engine("balls.scene.h5") as engine:
        begun, ended = threading.Event(), []

        def look(bodies):
            begun.set()

        def work():
            engine.step(3000)
            ended.append(engine.steps)

        engine.add_force(look)
        begun.clear()
        thread = threading.Thread(target=work)
        thread.start()
        assert begun.wait(60)
        text = "another thread is within a call"
        for action in (engine.step, lambda: engine.time, lambda: engine.bodies, engine.state_hash, engine.close):
            refused(scree.UsageError, text, action)
        assert not ended, "the step must have been under way"
        thread.join()
        assert ended == [3000] and engine.steps == 3000


def an_error_of_one_rank_is_raised_on_all_within_a_second():
    pack("balls", balls())
    needs_mpi4py()
    for ranks, culprit in ((2, 1), (3, 0)):
        found = program("errors", ranks, scene="balls.scene.h5", culprit=culprit)
        own = ["UsageError", "UsageError", "UsageError", "UnknownName", "UsageError", "ValueError", "UsageError", "ZeroDivisionError", "UsageError", "InputError"]
        assert len(found) == len(own)
        for row, kind in zip(found, own):
            assert row["seconds"] < 1, row
            everywhere = kind == "InputError"
            assert all(k == (kind if rank == culprit or everywhere else "UsageError") for rank, k in enumerate(row["kinds"])), row
        assert f"rank {culprit}" in found[0]["texts"][1 - culprit] and "(1, 3) expected" in found[0]["texts"][1 - culprit]
        assert found[5]["texts"][culprit] == "the partner failed"
        assert "the force function fails_here failed: ValueError: the partner failed" in found[5]["texts"][1 - culprit], found[5]
    assert program("left_by_one_rank", 2, scene="balls.scene.h5")


def wait_for(condition, limit=100):
    begin = time.time()
    while not condition():
        assert time.time() - begin < limit, "waited too long"
        time.sleep(0.01)


def ctrl_c_stops_a_step_within_a_second_and_the_engine_goes_on():
    pack("balls", balls(duration=1000))
    for kind, ranks, target in (("plain", 1, 0), ("force", 1, 0), ("short", 1, 0), ("plain", 2, 1), ("force", 2, 0)):
        if ranks > 1:
            needs_mpi4py()
        ready = os.path.abspath(f"ready_{kind}_{ranks}")
        arguments = json.dumps({"scene": "balls.scene.h5", "kind": kind, "ready": ready})
        words = [*([MPIEXEC, "-n", str(ranks)] if ranks > 1 else []), sys.executable, PARTNER, "interrupted", arguments]
        process = subprocess.Popen(words, env=ENV, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        files = [f"{ready}.{rank}" for rank in range(ranks)]
        wait_for(lambda: all(os.path.exists(name) and os.path.getsize(name) for name in files) or process.poll() is not None)
        assert process.poll() is None, process.communicate()
        time.sleep(0.5)
        with open(files[target], encoding="utf-8") as file:
            pid = int(file.read())
        sent = time.time()
        os.kill(pid, signal.SIGINT)
        output, errors = process.communicate(timeout=600)
        assert process.returncode == 0, (kind, ranks, output, errors)
        caught, hashes = json.loads(output.strip().splitlines()[-1])
        assert all(0 < moment - sent < 1 for moment in caught), f"{kind} on {ranks} ranks: {[moment - sent for moment in caught]} s"
        assert hashes[0] == hashes[1], f"{kind} on {ranks} ranks: other bits after a stop"


def log_without_work(folder):
    """Columns of log.csv that are no times, without those that only the engine's has; the rows."""
    with open(os.path.join(folder, "log.csv"), encoding="utf-8") as file:
        rows = [line.strip().split(",") for line in file if not line.startswith("#")]
    kept = [k for k, name in enumerate(rows[0]) if name not in (*MEASURED, "outer_work", "removed", "inserted_bodies", "inserted_mass", "inserted") and not name.startswith("t_")]
    return [[row[k] for k in kept] for row in rows]


def a_run_folder_is_as_that_of_scree_solver():
    pack("balls", balls(duration=0.03, every=0.01))
    expected, steps = solver_hash("balls.scene.h5", "solver.run")
    for ranks in (1, 2):
        folder = f"engine{ranks}.run"
        assert program("with_folder", ranks, scene="balls.scene.h5", folder=folder) == [steps, True]
        assert sorted(os.listdir(folder)) == sorted([*os.listdir("solver.run"), "inserted.csv", "removed.csv"])
        assert not events(f"{folder}/inserted.csv") and not events(f"{folder}/removed.csv")
        assert log_without_work(folder) == log_without_work("solver.run") and len(log_without_work(folder)) > 3
        assert outcome(folder)["state_hash"] == expected and outcome(folder)["outcome"] == "completed"
    mine, theirs = scree.open("engine1.run"), scree.open("solver.run")
    assert (mine.frames.times == theirs.frames.times).all()
    for k in range(len(mine.frames)):
        assert (mine.frames[k].bodies.position == theirs.frames[k].bodies.position).all()
    with scree.Engine("balls.scene.h5", run="halted.run") as engine:
        assert not engine.is_over
        engine.run_until(0.015)
        refused(scree.UsageError, "open it without run", lambda: engine.restore(engine.save()))
    assert scree.open("halted.run").outcome["outcome"] != "completed"
    assert program("with_folder", 1, scene="balls.scene.h5", folder="halted.run", restart="latest") == [steps, True]
    assert outcome("halted.run")["state_hash"] == expected
    refused(scree.UsageError, "complete", lambda: scree.Engine("balls.scene.h5", run="halted.run", restart="auto"))
    engine = scree.Engine("balls.scene.h5", run="over.run")
    while not engine.is_over:  # the last of these calls would go beyond the end
        engine.step(steps // 3 + 1)
    assert engine.steps == steps
    refused(scree.UsageError, "give a longer time.duration", engine.step)
    engine.close()
    assert outcome("over.run")["state_hash"] == expected
    with scree.Engine("balls.scene.h5") as engine:  # without a folder it ends by the clock alone, and goes on when asked to
        engine.step(steps - 1)
        assert not engine.is_over
        engine.step()
        assert engine.is_over and engine.state_hash() == expected
        engine.step()
        assert engine.is_over and engine.steps == steps + 1


def events(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def what_a_program_inserts_and_removes_is_in_every_book():
    """Tables, log, run.json, report and statistics of a run that is left and goes on, on 1 and 2 ranks; mass to rounding; the balance to 1e-2 of the
    kinetic energy, which is the error of coarse steps and less than one body brings."""
    pack("balls", balls(duration=0.03, every=0.01))
    mass, start = 2500 * 4 / 3 * math.pi * 0.004**3, len(scree.open_scene("balls.scene.h5").start["id"])
    found = {}
    for ranks in (1, 2):
        folder = f"booked{ranks}.run"
        program("booked", ranks, scene="balls.scene.h5", folder=folder)
        hash_, left = program("booked", ranks, scene="balls.scene.h5", folder=folder, restart="latest", until=1)
        found[ranks] = hash_, events(f"{folder}/inserted.csv"), events(f"{folder}/removed.csv")
        assert abs(left - (start + 4 - 3) * mass) < 1e-12 * left
    assert found[1] == found[2], found
    _, inserted, removed = found[1]
    first = max(scree.open_scene("balls.scene.h5").start["id"]) + 1
    assert [int(row["id"]) for row in inserted] == list(range(first, first + 4)), inserted
    assert {(row["shape"], row["material"], row["inlet"]) for row in inserted} == {("ball", "glass", "")}
    assert [int(row["step"]) for row in inserted[:3]] == [101] * 3 and abs(float(inserted[0]["mass"]) / mass - 1) < 1e-12
    assert [float(inserted[0][k]) for k in "xyz"] == [-0.01, 0, 0.12] and abs(float(inserted[0]["diameter"]) / 0.008 - 1) < 1e-12
    assert [(int(row["id"]), int(row["step"]), row["removed_by"], row["outlet"]) for row in removed] == [(i, 151, "program", "") for i in (3, 5, 7)]
    run = scree.open("booked1.run")
    log, end = run.log, run.outcome
    assert log["inserted_bodies"][0] == log["removed_bodies"][0] == 0 and (log["inserted_bodies"][-1], log["removed_bodies"][-1]) == (4, 3)
    assert abs(log["inserted_mass"][-1] / (4 * mass) - 1) < 1e-12 and abs(log["removed_mass"][-1] / (3 * mass) - 1) < 1e-12
    assert log["inserted"][-1] > 4 * mass * 9.81 * 0.12 and log["removed"][-1] != 0
    scale = max(log["kinetic_translational"])
    assert abs(log["energy_error"]).max() < 1e-2 * scale < mass * 9.81 * 0.12, (log["energy_error"], scale)
    assert (end["inserted_bodies"], end["removed_bodies"], end["lost_bodies"], end["bodies"]) == (4, 3, 0, start + 1)
    assert abs(end["energy"]["inserted"] - log["inserted"][-1]) < 1e-12 * scale
    assert f"{start} bodies at the start, 4 came in" in repr(run)
    scree.call("post", "report", "booked1.run", "-o", "booked.html")
    with open("booked.html", encoding="utf-8") as file:
        page = file.read()
    for text in ("4 came in", "3 were removed by the program that stepped the run", "energy of inserted bodies", "inserted by the program"):
        assert text in page, text
    scree.call("post", "statistics", "booked1.run", "-o", "booked.statistics", "--no-charts")
    passed = {row["gate"]: float(row["mass"]) for row in events("booked.statistics/flow.csv")}
    assert abs(passed["inserted by the program"] / (4 * mass) - 1) < 1e-6 and abs(passed["removed by the program"] / (3 * mass) - 1) < 1e-6, passed
    with open("booked.statistics/energies.csv", encoding="utf-8") as file:
        assert "outer_work,removed,inserted,energy_error" in file.readline()


MARGINS = """
gravity = [0, 0, 0]
[time]
duration = 1
step = 2e-6
[contact]
margin_ratio = 0.03
%s
""" + GLASS + """
[shapes.rock]
file = "rock.shape.h5"
[[populations]]
shape = "rock"
material = "glass"
count = 4
size = { distribution = "uniform", min = "8 mm", max = "10 mm" }
region = { box = [[0, 0, 0], ["60 mm", "60 mm", "60 mm"]] }
"""


def places_and_sizes_of_new_bodies_are_checked():
    """Each mistake is told with where, found, expected and what to do; nothing is changed by it."""
    pile()
    box = '[domain]\nmin = [-0.05, -0.05, -0.01]\nmax = [0.05, 0.05, 0.3]\n'
    pack("walled", balls() + box)
    with scree.Engine("walled.scene.h5") as engine:
        ball, twin = engine.bodies, scree.Engine("walled.scene.h5")
        there, one = ball.position[7], int(ball.id[7])
        for text, arguments in (
                ("body 1 of this call: position (0 0 0.4) m is outside the domain of the scene, which reaches from (-0.05 -0.05 -0.01) m to (0.05 0.05 0.3) m; give a place within it",
                 {"position": [[0, 0, 0.15], [0, 0, 0.4]]}),
                (f"lies within body {one}; give a free place", {"position": there + [0.001, 0, 0]}),
                ("lies within body 0 of this call", {"position": [[0, 0, 0.15], [0, 0, 0.152]]}),
                ("is behind the surface of wall 'box'; give a free place", {"position": [0.04, 0, 0.15]}),
                ("expected a number > 0", {"position": [0, 0, 0.15], "scale": -1}),
                ("expected a number > 0", {"position": [0, 0, 0.15], "scale": math.inf}),
                ("requires a step of at most", {"position": [0, 0, 0.15], "scale": 1e-3})):
            refused(scree.UsageError, text, lambda: engine.insert("ball", "glass", **arguments))
        engine.step()
        twin.step()
        assert engine.state_hash() == twin.state_hash(), "what was refused has changed nothing"
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            engine.insert("ball", "glass", [[0, 0, 0.15], [0, 0.0078, 0.15], [0.02, 0.02, 0.15]])   # 5 % of the radius
            engine.insert("ball", "glass", [0, 0.0156, 0.15])   # touches one that waits, as deep as that, and is not reported again
            engine.insert("ball", "glass", [-0.02, 0, 0.15], scale=1.2)
            late, = engine.insert("ball", "glass", [-0.02, 0.0072, 0.15])   # much deeper
            engine.insert("ball", "glass", [-0.02, -0.0072, 0.15])
        assert [w.category for w in caught] == [scree.ScreeWarning] * 2, caught
        assert "40 % of the radius" in str(caught[1].message) and "at least twice as large" in str(caught[1].message), str(caught[1].message)
        for call, action in (("set_wrench", lambda: engine.set_wrench([one, late], [0, 0, 1e-3])), ("remove", lambda: engine.remove([late])), ("clear_wrench", lambda: engine.clear_wrench([late]))):
            refused(scree.UsageError, f"{call}: body {late} was inserted and joins in the next step; make a step first", action)
        text = str(caught[0].message)
        for part in ("1 of 3 bodies overlap others or walls by more than 2 % of a radius", "body 1 of 3 of this call", "with body 0 of this call", "200 um (5 % of the radius", "give free places"):
            assert part in text, (part, text)
        engine.step(3)
        assert len(engine.bodies) == 87
        engine.set_wrench([late], [0, 0, 1e-3])
        engine.remove([one])
        engine.insert("ball", "glass", there)   # the place of one that leaves in the same step
        engine.step()
        twin.close()
    pack("open", balls() + box.replace("0.3]", "0.1]") + 'outside = "keep"\n')
    with scree.Engine("open.scene.h5") as engine:
        engine.insert("ball", "glass", [0, 0, 0.15])
        engine.step()
    pack("round", one_ball(position="[0, 0, 0]", more='[domain]\nmin = [-0.05, -0.05, -0.05]\nmax = [0.05, 0.05, 0.05]\nperiodic = ["x"]\n'))
    with scree.Engine("round.scene.h5") as engine:
        number, = engine.insert("ball", "glass", [0.125, 0.02, 0])
        refused(scree.UsageError, "outside the domain", lambda: engine.insert("ball", "glass", [0, 0.06, 0]))
        refused(scree.UsageError, "lies within body", lambda: engine.insert("ball", "glass", [0.1, 0.001, 0]))
        engine.step()
        assert np.abs(engine.bodies.position[engine.bodies.row(number)] - [0.025, 0.02, 0]).max() < 1e-15
    pack("rocks", MARGINS % "")
    with scree.Engine("rocks.scene.h5") as engine:
        scale = float(engine.bodies.scale.max())
        refused(scree.UsageError, "for which the margins and the tables of mesh walls were not made (contact.margin_ratio)", lambda: engine.insert("rock", "glass", [0.1, 0, 0], scale=1.5 * scale))
        refused(scree.UsageError, "give the case a body or an inlet of this size", lambda: engine.insert("rock", "glass", [0.1, 0, 0], scale=0.5 * scale))
        engine.insert("rock", "glass", [0.1, 0, 0], scale=scale)
        engine.step()
    sticky = one_ball(more="").replace("friction = 0.3", 'friction = 0.3\nadhesion = "0.05 J/m^2"\nadhesion_model = "dmt"\nadhesion_range = "10 um"')
    pack("sticky", sticky)
    with scree.Engine("sticky.scene.h5") as engine:
        engine.insert("ball", "glass", [0.3, 0, 0], scale=2)   # a range that is given is that of all sizes
        engine.step()


def messages_of_run_folders_name_the_options_of_the_engine():
    pack("balls", balls(duration=0.01, every=0.005))
    pack("other", balls(duration=0.02, every=0.005))
    os.mkdir("strange.run")
    for name in ("strange.run/note.txt", "file.run"):
        with open(name, "w", encoding="utf-8") as file:
            file.write("mine")
    killed = "import os, scree; e = scree.Engine('balls.scene.h5', run='killed.run'); e.step(3); os.kill(os.getpid(), 9)"
    assert subprocess.run([sys.executable, "-c", killed], env=ENV, capture_output=True).returncode == -signal.SIGKILL
    first = scree.Engine("balls.scene.h5", run="first.run")
    first.step(10)
    for restart in ("auto", "latest", None):  # before its first checkpoint
        refused(scree.UsageError, 'run = "first.run": another run is at work in it', lambda: scree.Engine("balls.scene.h5", run="first.run", restart=restart))
    first.close()
    message = scree.open("first.run").outcome["message"]
    assert message == 'closed at step 10; continue with restart = "latest"', message
    for text, arguments in (
            ('run = "first.run": exists and is not empty; remove it, choose another name, or continue it with restart = "latest" or "auto"', {"run": "first.run"}),
            ('run = "strange.run": exists, is not empty and is no run; choose another folder', {"run": "strange.run"}),
            ('run = "strange.run": exists, is not empty and is no run', {"run": "strange.run", "restart": "auto"}),
            ('run = "file.run": exists and is a file', {"run": "file.run"}),
            ('restart = "latest": new.run holds no checkpoint; restart = "auto" begins from the scene', {"run": "new.run", "restart": "latest"}),
            ('restart = "latest": killed.run holds no checkpoint; restart = "auto" begins from the scene', {"run": "killed.run", "restart": "latest"}),
            ('run = "killed.run": exists and is not empty; remove it, choose another name, or continue it with restart = "auto"', {"run": "killed.run"}),
            ('restart = "latest": is the newest checkpoint of a run folder, and run is not given', {"restart": "latest"})):
        refused(scree.ScreeError, text, lambda: scree.Engine("balls.scene.h5", **arguments))
    refused(scree.UsageError, 'run = "first.run": holds a run of another scene', lambda: scree.Engine("other.scene.h5", run="first.run", restart="auto"))
    checkpoint = sorted(glob.glob("first.run/checkpoint_*"))[-1]
    refused(scree.InputError, f'restart = "{checkpoint}": was made from another scene', lambda: scree.Engine("other.scene.h5", run="third.run", restart=checkpoint))
    assert not os.path.exists("new.run")
    with scree.Engine("balls.scene.h5", run="killed.run", restart="auto") as engine:
        assert engine.steps == 0
        engine.step()
    scree.Engine("balls.scene.h5", run="no/such/deep.run").close()  # with the folders above it
    assert scree.open("no/such/deep.run").outcome["outcome"] == "interrupted"


def functions_after_steps_are_called_in_multiples():
    pack("balls", balls())
    plain = scree.Engine("balls.scene.h5")
    plain.run_until(0.012)
    with scree.Engine("balls.scene.h5") as engine:
        calls = []
        engine.after_step(lambda e: calls.append(e.steps), every=7)
        engine.after_step(lambda e: calls.append(-e.steps), every=5)
        engine.step(3)
        engine.step(12)
        engine.step(0)
        assert calls == [-5, 7, -10, 14, -15]
        for never in (math.nan, math.inf, 1e300):
            try:
                engine.run_until(never)
            except scree.UsageError as error:
                assert "no time that can be reached" in str(error), error
            else:
                raise AssertionError(never)
        engine.run_until(0.012)
        assert (engine.steps, engine.state_hash()) == (plain.steps, plain.state_hash())
        assert calls[-1] in (-(engine.steps // 5) * 5, engine.steps // 7 * 7)
        nested = engine.after_step(lambda e: e.step())
        refused(scree.UsageError, "after_step", engine.step)
        engine.remove_after_step(nested)
        refused(scree.UsageError, "never added", lambda: engine.remove_after_step(nested))
        calls.clear()
        engine.after_step(lambda e: calls.append("once") or engine.remove_after_step(last), every=1)
        last = engine.after_step(lambda e: calls.append("last"))
        before = engine.steps
        refused(scree.UsageError, "never added", lambda: engine.step(5))  # it removes the second one in each step
        assert "last" not in calls and calls.count("once") == 2 and engine.steps == before + 2
    plain.close()


def the_report_says_that_a_program_stepped_the_run():
    """How to run it again, what forces the program gave, and one relative error of the energy: of the log by the page of formats, of run.json and of the report."""
    pack("balls", balls(duration=0.2, every=0.02))
    with scree.Engine("balls.scene.h5", run="program.run") as engine:
        def field(bodies):
            return -30 * bodies.mass[:, None] * bodies.position - 0.5 * bodies.mass[:, None] * bodies.velocity

        engine.add_force(field)
        engine.set_wrench(engine.bodies.id[:7], [0, 0, 1e-4])
        engine.run_until(0.15)
    end, log = outcome("program.run"), scree.open("program.run").log
    assert end["program"] == {"force_functions": ["field"], "held_bodies": 7}, end["program"]
    assert "interrupted" == end["outcome"] and "closed at step" in end["message"]
    scale = max(max(log["kinetic_translational"] + log["kinetic_rotational"]), max(abs(log["elastic"]) + log["elastic_tangential"]), log["dissipated"][-1],
                abs(log["wall_work"][-1]), abs(log["outer_work"][-1]))
    expected = max(abs(log["energy_error"])) / scale
    assert 1e-6 < expected < 0.05 and abs(end["energy"]["error_relative"] / expected - 1) < 1e-7, (expected, end["energy"])
    scree.call("post", "report", "program.run", "-o", "program.html")
    with open("program.html", encoding="utf-8") as file:
        page = file.read()
    for text in ("A program stepped this run with the engine", "scree-decomposer pack balls.toml", "Forces of the program", "1 function within the step: field, and held forces on 7 bodies",
                 f"{end['energy']['outer_work'] * 1e3:.3g}"[:3], f"The largest error of all rows is {100 * expected:.3g} % of it (error_relative of run.json)"):
        assert text in page, text
    again = page[page.index("To run it again</h2>"):]
    assert "mpirun" not in again and "scree.Engine first" not in again and "The same program, ranks and threads" not in again, again


def warnings_go_to_python():
    heavy = one_ball(more='[[bodies]]\nshape = "ball"\nmaterial = "glass"\nposition = [3, 0, 0]\nscale = 100\n[[bodies]]\nshape = "ball"\nmaterial = "glass"\nposition = [0, 0.3, 0]\nscale = 0.1\n')
    pack("uneven", heavy.replace("step = 2e-5", ""))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        scree.Engine("uneven.scene.h5").close()
        scree.Engine("uneven.scene.h5").close()   # of another engine it is news again
    assert [w.category for w in caught] == 2 * [scree.ScreeWarning], caught
    assert "mass ratio" in str(caught[0].message) and caught[0].filename == os.path.abspath(__file__), (caught[0].filename, caught[0].lineno)


def engines_end_without_a_word():
    """Closed by the garbage collection where one rank has it alone, and left as they are at the end of a program."""
    pack("balls", balls(duration=0.03, every=0.01))
    engine = scree.Engine("balls.scene.h5", run="left.run")
    engine.step(10)
    state = engine.save()
    del engine
    gc.collect()
    assert outcome("left.run")["outcome"] != "completed"
    del state
    for text in ("e = scree.Engine('balls.scene.h5'); e.add_force(lambda b: None); e.step(3); s = e.save()",
                 "e = scree.Engine('balls.scene.h5', run='open.run'); e.step(3); raise SystemExit(0)",
                 "es = [scree.Engine('balls.scene.h5') for _ in range(3)]; [e.step(3) for e in es]; es[0].close(); es[0].close()"):
        result = subprocess.run([sys.executable, "-c", "import scree; " + text], env=ENV, capture_output=True, text=True)
        assert (result.returncode, result.stdout + result.stderr) == (0, ""), result


def it_runs_beside_h5py():
    pack("balls", balls(duration=0.02))
    expected, steps = solver_hash("balls.scene.h5", "balls.run")
    with scree.Engine("balls.scene.h5", run="own.run") as engine, h5py.File("own.h5", "w") as file:
        places = file.create_dataset("position", (10, 80, 3))
        for k in range(10):
            engine.step(steps // 10 if k < 9 else steps - 9 * (steps // 10))
            places[k] = engine.bodies.position
            file.flush()
        assert engine.state_hash() == expected
    with h5py.File("own.h5") as file:
        assert np.ptp(file["position"][()], axis=0).min() > 0
    assert outcome("own.run")["state_hash"] == expected and len(glob.glob("own.run/frame_*.hdf")) > 1


def a_restarted_run_goes_on_with_a_function_that_is_added_again():
    """A force of places is among the forces of a checkpoint: added again, it does not count twice."""
    def field(bodies):
        return -300 * bodies.mass[:, None] * bodies.position

    pack("balls", balls())
    os.mkdir("kept")
    with scree.Engine("balls.scene.h5") as engine:
        engine.add_force(field)
        engine.step(300)
        engine.write_checkpoint("kept")
        engine.step(200)
        expected = engine.state_hash(), engine.energies().outer_work
    with scree.Engine("balls.scene.h5", restart=glob.glob("kept/*.h5")[0]) as engine:
        engine.add_force(field)
        engine.step(200)
        assert (engine.state_hash(), engine.energies().outer_work) == expected


def loads_and_energies_are_known_after_a_restore():
    """Contacts as they stand, without their damping: within a hundredth in a bed that has come to rest."""
    pack("balls", balls(duration=1))
    with scree.Engine("balls.scene.h5") as engine:
        engine.run_until(0.6)
        before = engine.walls["box"].load, engine.energies(), engine.critical_step()
        engine.restore(engine.save())
        after = engine.walls["box"].load, engine.energies(), engine.critical_step()
        assert before[0][2] < 0 and np.linalg.norm(after[0] - before[0]) < 0.01 * np.linalg.norm(before[0]), (before[0], after[0])
        assert abs(after[1].elastic / before[1].elastic - 1) < 1e-12 and after[2] == before[2]


def a_function_may_change_threads_and_rounding():
    """As a library does that it calls: neither bits nor scratch memory of the run depend on that."""
    runtime, libm = ctypes.CDLL("libgomp.so.1"), ctypes.CDLL("libm.so.6")
    upward, nearest = 0x800, 0  # of x86

    def partner(bodies):
        runtime.omp_set_num_threads(8)
        libm.fesetround(upward)

    pack("pile", pile())
    hashes = set()
    for function in (lambda bodies: None, partner):
        with scree.Engine("pile.scene.h5", threads=2) as engine:
            engine.add_force(function)
            engine.step(400)
            hashes.add(engine.state_hash())
            rounding = libm.fegetround()
        libm.fesetround(nearest)
    assert len(hashes) == 1 and rounding == upward, (hashes, rounding)
    runtime.omp_set_num_threads(1)


def a_bad_function_can_be_removed_and_the_run_restored():
    pack("balls", balls())
    calls = []
    with scree.Engine("balls.scene.h5") as engine:
        engine.step(50)
        state, expected = engine.save(), engine.state_hash()
        bad = engine.add_force(lambda bodies: calls.append(1) or (None if len(calls) < 3 else 1 // 0))
        refused(ZeroDivisionError, "by zero", lambda: engine.step(10))
        refused(scree.UsageError, "the run has ended", engine.contacts)
        engine.remove_force(bad)
        engine.restore(state)
        assert engine.state_hash() == expected
        engine.step(10)
        engine.insert("ball", "glass", [0, 0, 0.15])
        refused(scree.UsageError, "make a step first", engine.save)
        engine.step()
        assert len(engine.bodies) == 81 and engine.save()
    with scree.Engine("balls.scene.h5", run="failed.run") as engine:
        engine.step(50)
        engine.add_force(lambda bodies: calls.append(1) or (None if len(calls) < 8 else 1 // 0))
        refused(ZeroDivisionError, "by zero", lambda: engine.step(10))
    assert outcome("failed.run")["outcome"] == "interrupted" and "failed: ZeroDivisionError: " in outcome("failed.run")["message"]


def what_reading_costs():
    """Printed, not judged: the machine is shared."""
    pack("many", balls(duration=1).replace("count = 80", "count = 200000\nmethod = \"lattice\"").replace('["25 mm", "25 mm", "60 mm"]', "[0.535, 0.535, 0.561]")
         .replace('["25 mm", "25 mm", "200 mm"]', "[0.54, 0.54, 1]"))
    with scree.Engine("many.scene.h5", threads=1) as engine:
        engine.step(2)

        def cost(action, n=5):
            begin = time.process_time()
            for _ in range(n):
                action()
            return 1e3 * (time.process_time() - begin) / n

        def median(action, before=lambda: None, n=41):
            """Of single calls [ms]. The first ones are not counted: the memory that they take is given back and taken again by the later ones."""
            found = []
            for _ in range(n + 5):
                before()
                begin = time.process_time()
                action()
                found.append(1e3 * (time.process_time() - begin))
            return sorted(found[5:])[n // 2]

        step, read = cost(engine.step), median(lambda: engine.bodies.position)
        after_step = median(lambda: engine.bodies.position, engine.step)
        everything = cost(lambda: engine.bodies.read())
        engine.add_force(lambda bodies: -1e-3 * bodies.velocity)
        print(f"{len(engine.bodies)} bodies: a step {step:.1f} ms, positions {read:.2f} ms, {after_step:.2f} ms after a step, all fields {everything:.1f} ms, a step with a function {cost(engine.step):.1f} ms")
    pack("one", one_ball())
    with scree.Engine("one.scene.h5", threads=1) as engine:
        step = cost(lambda: engine.step(10000), 1) / 10
        single = cost(engine.step, 5000) * 1e3
        engine.add_force(lambda bodies: -4 * bodies.position)
        print(f"one body: a step {step:.1f} us, with a call for each {single:.1f} us, with a function {cost(lambda: engine.step(10000), 1) / 10:.1f} us")


if __name__ == "__main__":
    main([
        bodies_are_those_of_one_moment, a_ball_at_rest_has_its_weight_in_contact_wall_and_energies, a_frame_is_the_whole_scene_on_every_rank,
        functions_of_forces_see_bodies_during_the_call_only, mistakes_are_told_with_a_cure, only_one_thread_is_within_a_call,
        an_error_of_one_rank_is_raised_on_all_within_a_second, ctrl_c_stops_a_step_within_a_second_and_the_engine_goes_on,
        a_run_folder_is_as_that_of_scree_solver, what_a_program_inserts_and_removes_is_in_every_book,
        places_and_sizes_of_new_bodies_are_checked, messages_of_run_folders_name_the_options_of_the_engine, functions_after_steps_are_called_in_multiples, the_report_says_that_a_program_stepped_the_run, warnings_go_to_python, engines_end_without_a_word,
        it_runs_beside_h5py, a_restarted_run_goes_on_with_a_function_that_is_added_again, loads_and_energies_are_known_after_a_restore,
        a_function_may_change_threads_and_rounding, a_bad_function_can_be_removed_and_the_run_restored, what_reading_costs,
    ])
