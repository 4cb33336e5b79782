#!/usr/bin/env python3
"""What an engine is after a restart, and after a step that failed. usage: engine_restart_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import glob
import math
import os

from engine_cases import FLOOR, balls, main, one_ball, outcome, pack, program, refused  # isort: skip

import h5py  # noqa: E402
import numpy as np  # noqa: E402
import scree  # noqa: E402

MASS = 1000 * 4 / 3 * math.pi * 0.01**3  # of one_ball()


def drag_and_spring(bodies):
    return -4.0 * bodies.mass[:, None] * bodies.velocity - 300 * bodies.mass[:, None] * bodies.position


def loads_and_energies_are_known_after_a_restart():
    """Contacts as they stand, without their damping: within a hundredth in a bed that has come to rest; with a run folder and without. The log
    goes on with the same rows."""
    pack("bed", balls(duration=1, every=0.3, time="sleep = true\nsleep_tolerance = 0.01"))
    pack("balls", balls(duration=1, every=0.3))
    for name in ("balls", "bed"):
        scene, folder = f"{name}.scene.h5", f"{name}.run"
        with scree.Engine(scene, run=folder) as engine:
            engine.run_until(0.6)
            before = engine.walls["box"].load, engine.energies(), engine.contacts().force
            hash_ = engine.state_hash()
        with scree.Engine(scene, run=f"{name}_whole.run") as engine:
            engine.run_until(0.6)
            engine.step(300)
            expected = engine.state_hash()
            engine.run_until(0.95)
        newest = sorted(glob.glob(f"{folder}/checkpoint_*"))[-1]
        for arguments in ({"restart": newest}, {"run": folder, "restart": "latest"}):
            with scree.Engine(scene, **arguments) as engine:
                after = engine.walls["box"].load, engine.energies(), engine.contacts().force
                assert before[0][2] < 0 and np.linalg.norm(after[0] - before[0]) < 0.01 * np.linalg.norm(before[0]), (name, before[0], after[0])
                assert before[1].elastic > 0 and abs(after[1].elastic / before[1].elastic - 1) < 1e-12, (name, before[1], after[1])
                assert abs(after[1].balance - before[1].balance) < 1e-6 * before[1].dissipated, (name, before[1], after[1])
                assert after[2].shape == before[2].shape and engine.state_hash() == hash_
                engine.step(300)
                assert engine.state_hash() == expected, (name, arguments)
                engine.run_until(0.95)
        found, whole = scree.open(folder).log, scree.open(f"{name}_whole.run").log
        assert found["time"][-1] > 0.89 and len(found["time"]) == len(whole["time"])
        for column in ("energy_error", "max_depth_ratio", "dissipated", "elastic", "elastic_tangential", "force_z@box", "outer_work"):
            assert (found[column] == whole[column]).all(), (name, column, found[column], whole[column])


def a_restart_with_functions_has_the_bits_of_the_run_that_went_on():
    """A drag is called with the velocities of half a step before, which a checkpoint does not have: it has the forces."""
    pack("balls", balls())
    os.mkdir("kept")
    expected = program("with_functions", 2, scene="balls.scene.h5", steps=403, further=300, folder="kept")
    path, = glob.glob("kept/*.h5")
    assert expected[2] == 300
    for ranks in (1, 2, 3):
        found = program("with_functions", ranks, scene="balls.scene.h5", steps=403, further=300, path=path)
        assert found == expected, (ranks, found, expected)
    for every in (1, 3):
        with scree.Engine("balls.scene.h5", run=f"on{every}.run") as engine:
            engine.add_force(drag_and_spring, every)
            engine.step(400)
        with scree.Engine("balls.scene.h5", run=f"on{every}.run", restart="latest") as engine:
            engine.add_force(drag_and_spring, every)
            engine.step(200)
            found = engine.state_hash(), engine.energies().outer_work
        with scree.Engine("balls.scene.h5") as engine:
            engine.add_force(drag_and_spring, every)
            engine.step(600)
            assert (engine.state_hash(), engine.energies().outer_work) == found, every


def a_state_between_a_restart_and_its_first_step_is_that_of_the_checkpoint():
    pack("balls", balls())
    for folder in ("kept", "again"):
        os.mkdir(folder)
    with scree.Engine("balls.scene.h5") as engine:
        engine.add_force(drag_and_spring)
        engine.step(300)
        engine.write_checkpoint("kept")
        engine.step(200)
        expected = engine.state_hash()
    path, = glob.glob("kept/*.h5")
    calls = []

    def counted(bodies):
        calls.append(engine.steps)
        return drag_and_spring(bodies)

    with scree.Engine("balls.scene.h5", restart=path) as engine:
        early = engine.save()
        engine.add_force(counted)
        assert not calls, "its forces are those of the checkpoint"
        late = engine.save()
        engine.write_checkpoint("again")
        for state in (None, late, early):
            if state is not None:
                engine.restore(state)
            engine.step(200)
            assert engine.state_hash() == expected
            assert calls == list(range(301, 501)), calls[:3]
            calls.clear()
    with scree.Engine("balls.scene.h5", restart=glob.glob("again/*.h5")[0]) as engine:
        engine.add_force(drag_and_spring)
        engine.step(200)
        assert engine.state_hash() == expected
    with scree.Engine("balls.scene.h5", restart=path) as engine:  # a function that is not added again acts in the first half kick only
        work = [engine.energies().outer_work]
        for _ in range(3):
            engine.step()
            work.append(engine.energies().outer_work)
        assert work[1] != work[0] and work[1] == work[2] == work[3], work
        engine.add_force(counted)
        assert calls == [303], "it is a new one, and called at once"
    with scree.Engine("balls.scene.h5", restart=path) as engine:
        engine.add_force(drag_and_spring)
        calls.clear()
        engine.add_force(counted)
        assert calls == [300], "the checkpoint had one function"
        force = engine.bodies.force
        engine.restore(early)
        engine.step(1)
        assert (force != engine.bodies.force).any()


def a_step_that_failed_leaves_no_state_that_could_be_taken_for_one():
    """Whatever the number of steps of the call: the error names the step and the function, and nothing is read but a frame to look at."""
    pack("fall", one_ball(gravity="[0, 0, -10]", step="1e-3", duration=0.02).replace("every = 0.1", "every = 0.002"))

    def mine(bodies):
        if engine.steps >= 4:
            raise ValueError("my own")

    for count in (1, 4, 50):
        with scree.Engine("fall.scene.h5") as engine:
            engine.step(2)
            state = engine.save()
            number = engine.add_force(mine)
            try:
                while True:
                    engine.step(count)
            except ValueError as error:
                assert str(error) == "my own"
            assert engine.steps == 4, (count, engine.steps)
            for read in (lambda: engine.bodies.velocity, engine.bodies.read, engine.energies, engine.contacts, engine.state_hash, engine.critical_step, engine.save, engine.step):
                text = refused(scree.UsageError, "step 4: the force function mine failed: ValueError: my own", read)
                assert "restore a saved state" in text and "write_frame" in text, text
            engine.write_frame(f"look{count}.hdf")
            with h5py.File(f"look{count}.hdf") as file:
                assert file["frame"].attrs["step"] == 4
            assert len(engine.frame().bodies) == 1
            engine.remove_force(number)
            engine.restore(state)
            engine.step(8)
            assert abs(engine.bodies.velocity[0, 2] + 0.1) < 1e-15, "10 steps of 1 ms"
    with scree.Engine("fall.scene.h5", run="failed.run") as engine:
        engine.add_force(mine)
        refused(ValueError, "my own", lambda: engine.step(50))
    end = outcome("failed.run")
    assert (end["outcome"], end["message"], end["steps"]) == ("interrupted", "ended by an error: step 4: the force function mine failed: ValueError: my own", 4), end
    with scree.Engine("fall.scene.h5", run="nan.run") as engine:
        engine.add_force(lambda bodies: [0, 0, math.nan if engine.steps >= 4 else 0.0])
        text = refused(scree.RunInvalid, "step 4: the force function lambda of engine_restart_test.py:", lambda: engine.step(50))
        assert "gives body 0 a force of (0 0 nan) N, which is not finite; check what it is computed from" in text, text
    end = outcome("nan.run")
    assert (end["outcome"], end["message"], end["steps"]) == ("invalid", text, 4), end


def a_force_of_its_own_that_is_too_strong_for_the_step_is_named():
    """A drag C is stable for C dt < 2 m, a spring for w dt < 2: below they are, and above the message has these limits."""
    pack("one", one_ball(step="1e-4", position="[0.1, 0, 0.1]", body="velocity = [0.01, 0, 0]", more=FLOOR))
    dt = 1e-4
    for kind, limit in (("drag", 2 * MASS / dt), ("spring", MASS * (2 / dt)**2)):
        for part, is_stable in ((0.97, True), (1.1, False)):
            def force(bodies):
                return -part * limit * (bodies.velocity if kind == "drag" else bodies.position - [0.1, 0, 0.1])

            with scree.Engine("one.scene.h5") as engine:
                engine.add_force(force)
                if is_stable:
                    engine.step(3000)
                    assert abs(engine.bodies.velocity[0, 0]) < 0.1
                else:
                    text = refused(scree.RunInvalid, "forces of the program give it", lambda: engine.step(3000))
                    assert f"drag C is stable below 2 m / dt = {2 * MASS / dt:.3g} N s/m" in text and f"spring below m (2 / dt)^2 = {MASS * (2 / dt)**2:.3g} N/m" in text, text
                    assert "give a step of at most" not in text, text


if __name__ == "__main__":
    main([
        loads_and_energies_are_known_after_a_restart, a_restart_with_functions_has_the_bits_of_the_run_that_went_on,
        a_state_between_a_restart_and_its_first_step_is_that_of_the_checkpoint, a_step_that_failed_leaves_no_state_that_could_be_taken_for_one,
        a_force_of_its_own_that_is_too_strong_for_the_step_is_named,
    ])
