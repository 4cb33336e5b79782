#!/usr/bin/env python3
"""Programs that step scenes on ranks: partner.py FUNCTION ARGUMENTS_AS_JSON. Rank 0 prints the result as JSON. Alone it needs no mpi4py."""
import json
import os
import sys
import time

import numpy as np
import scree


def world():
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", "1")) == 1:
        return None
    from mpi4py import MPI
    return MPI.COMM_WORLD


COMM = world()
RANK, SIZE = (0, 1) if COMM is None else (COMM.rank, COMM.size)


def mine(rows):
    """This rank's part of a list that all ranks give together, in the order of ranks."""
    return rows[len(rows) * RANK // SIZE:len(rows) * (RANK + 1) // SIZE]


def gathered(value):
    return [value] if COMM is None else COMM.allgather(value)


def total(value):
    return sum(gathered(value))


def to_the_end(scene, steps, parts=1):
    with scree.Engine(scene, COMM) as engine:
        for _ in range(parts):
            engine.step(steps // parts)
        engine.step(steps % parts)
        engine.run_until(engine.duration)
        assert total(len(engine.bodies)) == len(scree.open_scene(scene).start["id"])
        return engine.state_hash(), engine.steps


def pushed(scene, ids, steps, force, torque=None, by="wrench"):
    """Forces on some bodies from the start."""
    with scree.Engine(scene, COMM) as engine:
        if by == "wrench":
            named = mine(ids)[::-1]  # whichever rank owns them
            engine.set_wrench(named, force, torque)
        else:
            engine.add_force(lambda bodies: np.isin(bodies.id, ids)[:, None] * np.array(force))
        engine.step(steps)
        return engine.state_hash()


def pull(bodies):
    """Follows places and velocities."""
    return -2.0 * bodies.mass[:, None] * bodies.velocity - 300 * bodies.mass[:, None] * bodies.position


def repeated(scene, before, window, kind):
    """Hashes and energies of a window that is made twice from memory, and of one that was never interrupted."""
    found = []
    for keeps in (True, False):
        with scree.Engine(scene, COMM) as engine:
            if kind == "wrench":
                engine.set_wrench(mine(list(range(10, 30))), [1e-3, -2e-3, 3e-3], [1e-6, 0, 2e-6])
            elif kind.startswith("force"):
                engine.add_force(pull, every=int(kind[5:]))
            engine.step(before)
            state = engine.save() if keeps else None
            for _ in range(2 if keeps else 1):
                if keeps:
                    engine.restore(state)
                engine.step(window)
                found.append((engine.state_hash(), vars(engine.energies())))
            if keeps:
                assert (state.steps, engine.steps) == (before, before + window)
    return found


def until_checkpoint(scene, steps, folder):
    with scree.Engine(scene, COMM) as engine:
        engine.set_wrench(mine(list(range(5, 25))), [2e-3, 1e-3, 1e-3], [0, 2e-6, 0])
        engine.step(steps)
        engine.write_checkpoint(folder)
        engine.step(steps)
        return engine.state_hash(), vars(engine.energies())


def from_checkpoint(scene, steps, path):
    with scree.Engine(scene, COMM, restart=path) as engine:
        assert engine.steps == steps
        engine.step(steps)
        return engine.state_hash(), vars(engine.energies())


def swirl(bodies):
    """A force and a torque that follow velocities: of some bodies only, and 0 at first for those at rest."""
    return -0.3 * bodies.mass[:, None] * bodies.velocity[:, [1, 0, 2]], -1e-7 * bodies.angular_velocity


def heat_of_program(engine, first):
    """Changes what a program gives to bodies of all ranks: at the start, and once more in between."""
    if first:
        engine.set_heat_source(mine(list(range(5, 40)))[::-1], 0.05)
        engine.set_medium(mine(list(range(20, 70))), 2e-3, 400)
    else:
        engine.set_medium(mine(list(range(30, 50))), 1e-3, 350)
        engine.clear_heat(mine(list(range(5, 10))))
        engine.set_heat_source(None, 0.01 + 1e-4 * (engine.bodies.id % 7))


def heated(scene, steps, folder=None, path=None, repeats=1):
    """A pile that a program heats, through a checkpoint or a state in memory in between. Hash, heat and what passed from the media, by id."""
    ids = list(range(20, 70))
    found = []
    with scree.Engine(scene, COMM, restart=path) as engine:
        if path is None:
            heat_of_program(engine, True)
            engine.step(steps)
            heat_of_program(engine, False)
            engine.step(7)
        assert engine.steps == steps + 7
        if folder is not None:
            engine.write_checkpoint(folder)
        state = engine.save() if repeats > 1 else None
        for _ in range(repeats):
            if state is not None:
                engine.restore(state)
            engine.step(steps)
            part = mine(ids)
            taken = dict(sorted((i, q) for rows in gathered(list(zip(part, engine.take_medium_heat(part).tolist()))) for i, q in rows))
            again = engine.take_medium_heat(part)
            assert not again.any(), "what was taken is gone"
            heat = vars(engine.heat())
            found.append((engine.state_hash(), {name: heat[name] for name in heat if name not in ("critical_step", "biot")}, taken))
    assert all(row == found[0] for row in found), found
    return found[0]


def heat_comes_and_goes(scene):
    """Bodies of a scene with heat come from all ranks and go, some to another rank on the way, with a medium each."""
    with scree.Engine(scene, COMM) as engine:
        begin = engine.heat()
        first = sorted(int(i) for part in gathered(engine.bodies.id.tolist()) for i in part)
        engine.set_medium(None, 3e-3, 350)
        engine.step(200)
        places = mine([[0.011 * x, 0.011 * y, 0.12] for x in (-1, 0, 1) for y in (-1, 0, 1)])
        ids = engine.insert("ball", "glass", np.reshape(places, (-1, 3)), velocity=[0.2, 0.1, -0.3], temperature=500)
        more = engine.insert("ball", "glass", np.add(np.reshape(places, (-1, 3)), [0, 0, 0.03]))
        engine.step(1)
        arrived = engine.heat()
        hot, mild = ({int(i): t for part in gathered(list(zip(engine.bodies.id.tolist(), engine.bodies.temperature.tolist()))) for i, t in part}[i]
                     for i in (sorted(i for part in gathered(some.tolist()) for i in part)[0] for some in (ids, more)))
        engine.set_medium(ids, 3e-3, 350)
        engine.step(300)
        left = mine(first[3:7]) + ([int(ids[0])] if RANK == 0 else [])
        named = mine(first) + ids.tolist()   # those that are to leave too
        engine.remove(left)
        engine.step(100)
        taken = float(sum(gathered(float(engine.take_medium_heat(named).sum()))))
        refused = ""
        try:
            engine.take_medium_heat(left)
        except scree.UsageError as error:
            refused = str(error)
        end = engine.heat()
        return engine.state_hash(), vars(begin), vars(arrived), vars(end), taken, hot, mild, refused


def with_functions(scene, steps, further, folder=None, path=None):
    """Steps with three functions, one that is called in every 7th step; from a checkpoint, they are added again in the same order.
    Hash, energies and calls at the end."""
    calls = []

    def counted(bodies):
        calls.append(1)
        return pull(bodies)

    with scree.Engine(scene, COMM, restart=path) as engine:
        for function, every in ((counted, 1), (swirl, 7), (lambda bodies: None, 1)):
            engine.add_force(function, every)
        if folder is not None:
            engine.step(steps)
            engine.write_checkpoint(folder)
        else:
            assert engine.steps == steps
        calls.clear()
        engine.step(further)
        return engine.state_hash(), vars(engine.energies()), len(calls)


def come_and_go(scene):
    """Bodies come in from all ranks and go; what is counted each time."""
    rows = []
    with scree.Engine(scene, COMM) as engine:
        def count(ids, leaving=0.0):
            bodies, energies = engine.bodies, engine.energies()
            rows.append({"arrived": energies.arrived, "removed": energies.removed, "leaving": leaving, "ids": ids, "bodies": total(len(bodies)), "mass": total(float(bodies.mass.sum())), "hash": engine.state_hash(),
                         "balance": energies.balance, "kinetic": energies.kinetic, "known": sorted(int(i) for part in gathered(bodies.id.tolist()) for i in part)})

        engine.step(200)
        count([])
        places = [[0.011 * x, 0.011 * y, 0.12] for x in (-1, 0, 1) for y in (-1, 0, 1)]
        part = mine(places)
        ids = engine.insert("ball", "glass", np.reshape(part, (-1, 3)), velocity=[0, 0, -0.3], scale=1.1)
        more = engine.insert(["ball"] * len(part), "glass", np.add(np.reshape(part, (-1, 3)), [0, 0, 0.03]), velocity=[[0, 0, -0.3]] * len(part))
        ids, more = (sorted(int(i) for part in gathered(some.tolist()) for i in part) for some in (ids, more))
        engine.step(1)
        row = {int(i): x for part in gathered(list(zip(engine.bodies.id.tolist(), engine.bodies.position.tolist()))) for i, x in part}
        for i, place in zip(ids, places):
            assert np.abs(np.subtract(row[i], place)).max() <= 1e-16, (row[i], place)
        count(ids + more)
        engine.step(600)
        count([])
        leave = engine.bodies[np.isin(engine.bodies.id, ids[:4] + [3, 5])]
        energy = 0.5 * leave.mass * ((leave.velocity**2).sum(axis=1) + 0.4 * leave.radius**2 * (leave.angular_velocity**2).sum(axis=1))
        energy = total(float((energy + 9.81 * leave.mass * leave.position[:, 2]).sum()))
        engine.remove(mine(ids[:4] + [3, 5]))
        engine.step(1)
        count([], energy)
        engine.step(600)
        count([])
        return rows


def moments(scene, steps):
    """The whole scene as a frame, on every rank, against what ranks read."""
    with scree.Engine(scene, COMM) as engine:
        engine.step(steps)
        frame, bodies, contacts = engine.frame(), engine.bodies.read(), engine.contacts()
        assert (frame.step, frame.time, frame.number) == (engine.steps, engine.time, steps)
        engine.step(1)
        for name in ("position", "quaternion", "velocity", "angular_velocity", "shape", "material", "scale"):
            all_ranks = {i: row for part in gathered(list(zip(bodies.id.tolist(), getattr(bodies, name).tolist()))) for i, row in part}
            assert getattr(frame.bodies, name).tolist() == [all_ranks[i] for i in frame.bodies.id.tolist()], name
        for name in ("mass", "volume", "diameter"):
            here, there = getattr(bodies, name), getattr(frame.bodies, name)[np.searchsorted(frame.bodies.id, bodies.id)]
            assert np.abs(here / there - 1).max(initial=0) < 1e-12, name
        assert total(len(contacts)) == len(frame.contacts) > 20, (total(len(contacts)), len(frame.contacts))
        keys = sorted(key for part in gathered(list(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), contacts.overlap.tolist(), *contacts.force.T.tolist()))) for key in part)
        c = frame.contacts
        assert keys == sorted(zip(c.body_a.tolist(), c.body_b.tolist(), c.overlap.tolist(), *c.force.T.tolist()))
        box = engine.walls["box"]
        assert frame.walls.position[0].tolist() == box.position.tolist()
        return frame.measures()["coordination_number"], sorted(os.listdir("."))


def errors(scene, culprit):
    """Errors that one rank makes: of each, the class and text on every rank, and how long after the first rank the last one raised [s]."""
    here, found = RANK == culprit, []

    def attempt(action):
        try:
            action()
            kind, text = "none", ""
        except Exception as error:
            kind, text = type(error).__name__, str(error)
        times = gathered(time.time())
        found.append({"kinds": gathered(kind), "texts": gathered(text), "seconds": max(times) - min(times)})

    def fails_here(bodies):
        if here and engine.steps > 30:
            raise ValueError("the partner failed")

    def fails_after(engine):
        if here:
            raise ZeroDivisionError("after the step")

    with scree.Engine(scene, COMM) as engine:
        begin = engine.save()
        attempt(lambda: engine.set_wrench([1], np.zeros((2, 3)) if here else [0, 0, 0]))
        attempt(lambda: engine.set_wrench([10**6] if here else [], [0, 0, 0]))
        attempt(lambda: engine.clear_wrench([1] if here else None))
        attempt(lambda: engine.insert("ball" if not here else "bell", "glass", [0, 0, 0.15]))
        attempt(lambda: engine.add_force("no function" if here else pull))
        engine.step(30)
        engine.add_force(fails_here)
        attempt(lambda: engine.step(100))
        attempt(lambda: engine.step())
        engine.restore(begin)
        engine.step(10)
    with scree.Engine(scene, COMM) as engine:
        engine.after_step(fails_after, every=5)
        attempt(lambda: engine.step(100))
        assert engine.steps == 5
    attempt(lambda: scree.Engine(scene if not here else 3, COMM))
    attempt(lambda: scree.Engine("missing.scene.h5", COMM))
    return found


def left_by_one_rank(scene):
    """An exception of one rank's own leaves the `with` without waiting for the others."""
    engine = scree.Engine(scene, COMM)
    begin = time.time()
    try:
        with engine:
            if RANK == 1:
                raise ValueError("of this rank alone")
    except ValueError:
        assert time.time() - begin < 1
        assert "closed" not in repr(engine)
        engine.close()
    return "closed" in repr(engine)


def interrupted(scene, kind, ready, culprit=0):
    """Steps until a signal comes; when it came through, and whether the engine goes on with the same bits."""
    engine = scree.Engine(scene, COMM)
    if kind == "force":
        engine.add_force(pull)
    begin = engine.save()
    engine.step(200)
    with open(f"{ready}.{RANK}", "w", encoding="utf-8") as file:
        file.write(str(os.getpid()))
    caught = 0.0
    try:
        while True:
            engine.step(10**7 if kind != "short" else 3)
    except KeyboardInterrupt:
        caught = time.time()
    steps = engine.steps
    engine.step(100)
    hashes = [engine.state_hash()]
    engine.restore(begin)
    engine.step(steps + 100)
    hashes.append(engine.state_hash())
    engine.close()
    return gathered(caught), hashes


def with_folder(scene, folder, restart=None, until=None):
    with scree.Engine(scene, COMM, run=folder, restart=restart) as engine:
        while not engine.is_over and (until is None or engine.time < until):
            engine.step(50 if until is not None else 1)
        return engine.steps, engine.is_over


def booked(scene, folder, restart=None, until=0.015):
    """Bodies come and go in a run with a folder, which is left at `until` and goes on after a restart."""
    with scree.Engine(scene, COMM, run=folder, restart=restart) as engine:
        if restart is None:
            engine.step(100)
            places = mine([[-0.01, 0, 0.12], [0.01, 0, 0.12], [0, 0.01, 0.14]])
            engine.insert("ball", "glass", np.reshape(places, (-1, 3)), velocity=[0, 0, -0.3])
            engine.step(50)
            engine.remove(mine([3, 5, 7]))
        else:
            engine.insert("ball", "glass", mine([[0, 0, 0.15]]) or np.zeros((0, 3)))
        while not engine.is_over and engine.time < until:
            engine.step(1)
        return engine.state_hash(), total(float(engine.bodies.mass.sum()))


def driven(scene, rate, until):
    with scree.Engine(scene, COMM) as engine:
        lid = engine.walls["lid"]
        lid.drive(rate)
        engine.run_until(until)
        frame = engine.frame()
        return engine.time, lid.way, lid.rate, lid.position.tolist(), frame.bodies.position.tolist()


if __name__ == "__main__":
    result = globals()[sys.argv[1]](**json.loads(sys.argv[2]))
    if RANK == 0:
        print(json.dumps(result))
