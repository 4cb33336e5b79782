#!/usr/bin/env python3
"""The engine against scree-solver and closed forms: bits, forces from outside, states, bodies that come and go. usage: engine_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import ctypes
import glob
import math
import os
import shutil
import subprocess

from engine_cases import FLOOR, Skipped, balls, main, one_ball, pack, pile, program, run, solver_hash  # isort: skip

import numpy as np  # noqa: E402
import scree  # noqa: E402

DENSITY, RADIUS = 1000, 0.01  # of one_ball()
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3
RANKS_AND_THREADS = ((1, 1), (1, 2), (2, 1), (3, 1))


def the_engine_has_the_bits_of_scree_solver_on_any_ranks_and_threads():
    for name, text in (("balls", balls()), ("pile", pile())):
        pack(name, text)
        expected = list(solver_hash(f"{name}.scene.h5", f"{name}.run"))
        for ranks, threads in RANKS_AND_THREADS:
            found = program("to_the_end", ranks, threads, scene=f"{name}.scene.h5", steps=expected[1], parts=7)
            assert found == expected, f"{name} on {ranks} ranks with {threads} threads: {found}, scree-solver {expected}"


def a_step_that_is_quantised_has_the_bits_of_scree_solver():
    pack("halved", balls(duration=0.04, time='step_control = "quantised"'))
    expected = list(solver_hash("halved.scene.h5", "halved.run"))
    assert program("to_the_end", 2, scene="halved.scene.h5", steps=expected[1]) == expected


def a_window_repeated_from_memory_has_the_same_bits():
    pack("balls", balls())
    pack("pile", pile())
    for scene, ranks, kind in (("balls", 1, "plain"), ("pile", 1, "plain"), ("pile", 2, "plain"), ("balls", 3, "wrench"), ("balls", 1, "wrench"), ("balls", 1, "force1"), ("balls", 2, "force1"),
                               ("balls", 1, "force7")):
        first, second, through = program("repeated", ranks, scene=f"{scene}.scene.h5", before=500, window=300, kind=kind)
        assert first == second, f"{kind} on {ranks} ranks: the second time {second}, the first {first}"
        assert first[0] == through[0], f"{kind} on {ranks} ranks: restored {first[0]}, never interrupted {through[0]}"
        assert first[1] == through[1], (first[1], through[1])


def a_restart_from_a_checkpoint_goes_on_with_the_held_wrenches():
    pack("balls", balls())
    os.mkdir("kept")
    expected = program("until_checkpoint", 2, scene="balls.scene.h5", steps=400, folder="kept")
    path, = glob.glob("kept/*.h5")
    for ranks in (1, 2, 3):
        found = program("from_checkpoint", ranks, scene="balls.scene.h5", steps=400, path=path)
        assert found == expected, (ranks, found, expected)
    assert expected[1]["outer_work"] != 0


def a_constant_wrench_has_the_bits_of_the_key_force():
    force, places = [0.002, 0.001, -0.0005], [[0.012 * x, 0.012 * y, 0.006 + 0.011 * z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in range(3)]
    head, _, tail = balls(duration=0.02).partition("[[populations]]")
    wall = tail[tail.index("[[walls]]"):]
    for name, key in (("given", f"force = {force}"), ("plain", "")):
        pack(name, head + "".join(f"""
[[bodies]]
shape = "ball"
material = "glass"
position = {place}
velocity = [0, 0, -0.4]
{key}
""" for place in places) + wall)
    expected, steps = solver_hash("given.scene.h5", "given.run")
    assert solver_hash("plain.scene.h5", "plain.run")[0] != expected
    ids = scree.open_scene("plain.scene.h5").start["id"].tolist()
    for ranks, threads in RANKS_AND_THREADS:
        for by in ("wrench", "function"):
            found = program("pushed", ranks, threads, scene="plain.scene.h5", ids=ids, steps=steps, force=force, by=by)
            assert found == expected, f"{by} on {ranks} ranks with {threads} threads"


def what_a_partner_does_to_threads_and_rounding_changes_no_bit():
    compiler = shutil.which("gcc")
    if compiler is None:
        raise Skipped("no gcc: the rounding mode cannot be set")
    with open("partner.c", "w", encoding="utf-8") as file:
        file.write("""
#include <fenv.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
unsigned get_control(void) { return _mm_getcsr() & ~0x3fu; }
void disturb(void) { fesetround(FE_UPWARD); _mm_setcsr(_mm_getcsr() | 0x8040u); }
#else
unsigned get_control(void) { return (unsigned)fegetround(); }
void disturb(void) { fesetround(FE_UPWARD); }
#endif
void restore(void) { fesetenv(FE_DFL_ENV); }
""")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", "partner.so", "partner.c", "-lm"], check=True)
    partner, openmp = ctypes.CDLL("./partner.so"), ctypes.CDLL("libgomp.so.1")
    pack("pile", pile())
    expected, steps = solver_hash("pile.scene.h5", "pile.run")
    pushes = {}
    for is_disturbed in (False, True):
        with scree.Engine("pile.scene.h5", threads=2) as engine, scree.Engine("pile.scene.h5", threads=2) as pushed:
            pushed.set_wrench(pushed.bodies.id, [1e-3, 1e-4, -1e-3], [1e-7, 1e-6, 0])
            for part in range(4):
                if is_disturbed:
                    partner.disturb()
                    openmp.omp_set_num_threads(3 + part)
                before = partner.get_control(), openmp.omp_get_max_threads()
                engine.step(steps // 4 + (steps % 4 if part == 3 else 0))
                pushed.step(200)
                assert (partner.get_control(), openmp.omp_get_max_threads()) == before, "the engine left other settings than it met"
            hashes = engine.state_hash(), pushed.state_hash()
            assert (partner.get_control(), openmp.omp_get_max_threads()) == before
            partner.restore()
        openmp.omp_set_num_threads(1)
        pushes[is_disturbed] = hashes[1]
        assert hashes[0] == expected, f"disturbed {is_disturbed}: {hashes[0]}, scree-solver {expected}"
    assert pushes[True] == pushes[False]


def spring(steps_per_period):
    """A ball of 1 cm at x = 0.1 m, at rest, on a spring with a period of so many steps. Returns its stiffness and w."""
    pack("spring", one_ball(duration=100))
    w = 2 * math.pi / (steps_per_period * 2e-5)
    return MASS * w * w, w


def a_spring_within_the_step_has_the_period_and_energy_of_leapfrog():
    """T = 2 pi sqrt(m/k) (w dt / 2) / asin(w dt / 2), 1e-7: zeros of x between two steps are linear to 1e-9 T. The energy that leapfrog keeps,
    m v^2 / 2 + k x^2 / 2 (1 - (w dt / 2)^2), to 1e-12, and the kinetic one against the work of the spring to rounding."""
    periods, k, w = 20, *spring(1000)
    with scree.Engine("spring.scene.h5") as engine:
        h = 0.5 * w * engine.dt
        engine.add_force(lambda bodies: -k * bodies.position)
        zeros, kept, last = [], [], engine.bodies.position[0, 0]
        while engine.time < 1.02 * periods * 2 * math.pi / w:
            engine.step()
            bodies = engine.bodies
            x, v = bodies.position[0, 0], bodies.velocity[0, 0]
            kept.append(0.5 * MASS * v * v + 0.5 * k * x * x * (1 - h * h))
            if last < 0 <= x:
                zeros.append(engine.time - engine.dt * x / (x - last))
            last = x
        energies = engine.energies()
        period = (zeros[-1] - zeros[0]) / (len(zeros) - 1)
        expected = 2 * math.pi / w * h / math.asin(h)
        assert len(zeros) == periods and abs(period / expected - 1) < 1e-7, period / expected - 1
        assert abs(expected * w / (2 * math.pi) - 1) > 1e-6, "the factor of leapfrog must be seen"
        assert np.ptp(kept) < 1e-10 * kept[0], np.ptp(kept) / kept[0]
        assert abs(energies.translational - energies.outer_work) < 1e-12 * kept[0], (energies, kept[0])
        assert abs(energies.balance) < 1e-12 * kept[0]
        assert abs(bodies.force[0, 0] / (-k * x) - 1) < 1e-12, "the force of the step is in bodies.force"


def a_spring_that_is_held_for_a_step_gains_energy():
    """x' = x + h u - h^2 x / 2, u' = u - h x with u = v / w, h = w dt: the determinant is 1 + h^2 / 2, so that the energy grows by pi h in a period; 5 %."""
    steps, periods = 1000, 5
    k, w = spring(steps)
    with scree.Engine("spring.scene.h5") as engine:
        energy = []
        for _ in range(periods):
            for _ in range(steps):
                engine.set_wrench(engine.bodies.id, -k * engine.bodies.position)
                engine.step()
            x, v = engine.bodies.position[0, 0], engine.bodies.velocity[0, 0]
            energy.append(0.5 * MASS * v * v + 0.5 * k * x * x)
        grown = math.log(energy[-1] / energy[0]) / (periods - 1)
        assert abs(grown / (math.pi * w * engine.dt) - 1) < 0.05, (grown, math.pi * w * engine.dt)


def a_constant_torque_turns_a_ball_by_its_inertia():
    """w = T t / (2/5 m r^2), to 1e-12."""
    pack("ball", one_ball())
    with scree.Engine("ball.scene.h5") as engine:
        torque = np.array([1e-6, -2e-6, 3e-6])
        engine.set_wrench(engine.bodies.id, [0, 0, 0], torque)
        engine.step(5000)
        expected = torque * engine.time / (0.4 * MASS * RADIUS**2)
        assert np.abs(engine.bodies.angular_velocity[0] / expected - 1).max() < 1e-12
        assert not engine.bodies.velocity.any()
        work = 0.5 * 0.4 * MASS * RADIUS**2 * expected @ expected
        assert abs(engine.energies().outer_work / work - 1) < 1e-12


def a_ball_with_its_own_drag_falls_at_the_speed_of_stokes():
    """v = m g / c after 20 relaxation times, to 1e-6; on the way v = m g / c (1 - exp(-c t / m)), and as in a fluid of the same drag and no density, to
    1e-4: drag follows the velocity of half a step before, dt / (2 m / c) = 6e-5."""
    viscosity = 0.5
    c = 6 * math.pi * viscosity * RADIUS
    end = -MASS * 9.81 / c
    pack("fall", one_ball(gravity="[0, 0, -9.81]", step="1e-4"))
    for name, fluid in (("own", ""), ("stokes", f'[fluid]\ndensity = 1e-9\nviscosity = {viscosity}\ndrag = "stokes"\n')):
        pack(name, one_ball(gravity="[0, 0, -9.81]", step="5e-6", more=fluid))
    with scree.Engine("own.scene.h5") as engine, scree.Engine("stokes.scene.h5") as fluid:
        engine.add_force(lambda bodies: -c * bodies.velocity)
        for _ in range(3):
            engine.step(2000)
            fluid.step(2000)
            speed = engine.bodies.velocity[0, 2]
            assert abs(speed / (end * (1 - math.exp(-c * engine.time / MASS))) - 1) < 1e-4 and abs(speed / fluid.bodies.velocity[0, 2] - 1) < 1e-4
    with scree.Engine("fall.scene.h5") as engine:
        engine.add_force(lambda bodies: -c * bodies.velocity)
        engine.run_until(20 * MASS / c)
        assert abs(engine.bodies.velocity[0, 2] / end - 1) < 1e-6
        number = engine.add_force(lambda bodies: [0, 0, 2 * c])
        engine.run_until(engine.time + 20 * MASS / c)
        assert abs(engine.bodies.velocity[0, 2] / (2 + end) - 1) < 1e-6
        engine.remove_force(number)
        engine.run_until(engine.time + 20 * MASS / c)
        assert abs(engine.bodies.velocity[0, 2] / end - 1) < 1e-6


def a_drag_within_the_step_shortens_a_period_by_its_share():
    """Its velocities are half a step old: T = 2 pi / sqrt(w^2 - g^2), g = C / (2 m), less C dt / (4 m) of itself, 3 %. n steps take n + 1 calls."""
    k, w = spring(1000)
    calls, periods = [], 20
    c = 0.2 * MASS * w
    with scree.Engine("spring.scene.h5") as engine:
        def force(bodies):
            calls.append(engine.steps)
            return -k * bodies.position - c * bodies.velocity

        engine.add_force(force)
        assert calls == [0], "for the first half kick"
        zeros, last = [], engine.bodies.position[0, 0]
        while len(zeros) < periods + 1:
            engine.step()
            x = engine.bodies.position[0, 0]
            if last < 0 <= x:
                zeros.append(engine.time - engine.dt * x / (x - last))
            last = x
        assert calls == list(range(engine.steps + 1))
        period, g = (zeros[-1] - zeros[0]) / periods, c / (2 * MASS)
        share = 1 - period * math.sqrt(w * w - g * g) / (2 * math.pi)
        assert abs(share / (c * engine.dt / (4 * MASS)) - 1) < 0.03, (share, c * engine.dt / (4 * MASS))


def the_books_close_with_the_work_of_forces_and_torques():
    """Kinetic and potential energy less outer_work stay to rounding: a ball, and a box that turns about a principal axis, under weight and a wrench."""
    pile()
    pack("two", one_ball(gravity="[0, 0, -9.81]", more="""
[shapes.rock]
file = "rock.shape.h5"
[[bodies]]
shape = "rock"
material = "glass"
position = [0, 0.2, 0]
""").replace("margin = 0", "margin = 1e-4"))
    with scree.Engine("two.scene.h5") as engine:
        ball, rock = engine.bodies.id[engine.bodies.shape_name == "ball"], engine.bodies.id[engine.bodies.shape_name == "rock"]
        start = engine.energies()
        for force, torque in (([0.02, -0.01, 0.03], [1e-5, -2e-5, 0]), ([-0.05, 0.01, 0.1], [0, 3e-5, 2e-5])):
            engine.set_wrench(ball, force, torque)
            engine.set_wrench(rock, force, [0, 0, torque[1]])
            engine.step(3000)
            now = engine.energies()
            scale = now.kinetic + abs(now.potential) + abs(now.outer_work)
            assert now.rotational > 0 and abs(now.outer_work) > 1e-3 * now.kinetic
            assert abs(now.kinetic + now.potential - start.potential - now.outer_work) < 1e-12 * scale, (now, start)
            assert abs(now.balance - start.balance) < 1e-12 * scale
        engine.clear_wrench()
        work = engine.energies().outer_work
        engine.step(100)
        assert engine.energies().outer_work == work


def a_body_asleep_wakes_when_its_wrench_changes_by_more_than_the_tolerance():
    text = one_ball(gravity="[0, 0, -9.81]", step="1e-4", position="[0, 0, 0.0099]", time="sleep = true\nsleep_tolerance = 0.01", more=FLOOR)
    pack("sleep", text)
    most = 0.01 * MASS * 9.81
    with scree.Engine("sleep.scene.h5") as engine:
        ball = engine.bodies.id

        def asleep_after(steps, force=None):
            if force is not None:
                engine.set_wrench(ball, [0, 0, force])
            engine.step(steps)
            return bool(engine.bodies.asleep[0])

        assert asleep_after(6000)
        place = engine.bodies.position[0].tolist()
        assert asleep_after(200, 0.6 * most) and engine.bodies.position[0].tolist() == place, "below the tolerance it sleeps on"
        assert asleep_after(1, -0.3 * most)
        assert not asleep_after(1, 1.2 * most), "the change counts from when it fell asleep"
        assert asleep_after(6000), "it falls asleep with a wrench on it"
        assert asleep_after(100, 0.5 * most)
        engine.clear_wrench()
        assert not asleep_after(1), "what held it is gone"
        assert asleep_after(6000)
        engine.add_force(lambda bodies: [0, 0, 2 * most * (engine.time > 2.0)])
        assert asleep_after(1)
        engine.run_until(2.0)
        assert not asleep_after(3)


def bodies_come_and_go_with_their_ids_mass_and_energy():
    pack("balls", balls())
    small, large = 2500 * 4 / 3 * math.pi * 0.0044**3, 2500 * 4 / 3 * math.pi * 0.004**3
    expected = program("come_and_go", 1, scene="balls.scene.h5")
    before, come, fallen, gone, end = expected
    assert come["bodies"] == before["bodies"] + 18 and come["ids"] == list(range(max(before["known"]) + 1, max(before["known"]) + 19))
    assert abs(come["mass"] - before["mass"] - 9 * (small + large)) < 1e-12 * come["mass"]
    assert fallen["bodies"] == come["bodies"] and fallen["known"] == sorted(before["known"] + come["ids"])
    assert gone["known"] == [i for i in fallen["known"] if i not in (3, 5, *come["ids"][:4])] == end["known"]
    assert abs(fallen["mass"] - gone["mass"] - 4 * small - 2 * large) < 1e-12 * gone["mass"]
    brought = sum(m * (0.5 * 0.3**2 + 9.81 * z) for m, z in ((small, 0.12), (large, 0.15))) * 9
    assert abs((come["arrived"] - before["arrived"]) / brought - 1) < 1e-12 and come["removed"] == before["removed"] == 0
    assert abs((gone["removed"] - fallen["removed"]) / gone["leaving"] - 1) < 1e-3, "but for what contacts did in the step in which they left"
    for row, of in ((come, before), (gone, fallen)):
        assert abs(row["balance"] - of["balance"]) < 1e-4 * of["kinetic"], "what came and went is booked; the rest is the error of one step"
    for ranks in (2, 3):
        found = program("come_and_go", ranks, scene="balls.scene.h5")
        for row, of in zip(found, expected):
            assert {k: row[k] for k in ("ids", "bodies", "hash", "known")} == {k: of[k] for k in ("ids", "bodies", "hash", "known")}, f"{ranks} ranks"


def a_driven_wall_is_where_a_prescribed_one_is():
    """A lid that is driven at a constant rate against one with `translate`: its place and the bodies, to 1e-9."""
    more = """
[[walls]]
name = "lid"
shape = { plane = { point = [0, 0, "75 mm"], normal = [0, 0, -1] } }
material = "glass"
motion = { %s }
"""
    pack("driven", balls(duration=0.1) + more % 'outer = { direction = [0, 0, -1], max_speed = "0.5 m/s" }')
    pack("prescribed", balls(duration=0.1) + more % "translate = { velocity = [0, 0, -0.5] }")
    run(1, "prescribed.scene.h5", "-o", "prescribed.run")
    last = scree.open("prescribed.run").frames[-1]
    hashes = set()
    for ranks in (1, 2):
        time, way, rate, place, positions = program("driven", ranks, scene="driven.scene.h5", rate=0.5, until=0.1)
        assert time == last.time and abs(way - 0.5 * time) < 1e-9 and rate == 0.5, (time, last.time, way)
        assert np.abs(np.subtract(place, last.walls.position[last.walls.row("lid")])).max() < 1e-9
        assert np.abs(np.subtract(positions, last.bodies.position)).max() < 1e-9, (ranks, np.abs(np.subtract(positions, last.bodies.position)).max())
        hashes.add(str(positions))
    assert len(hashes) == 1


if __name__ == "__main__":
    main([
        the_engine_has_the_bits_of_scree_solver_on_any_ranks_and_threads, a_step_that_is_quantised_has_the_bits_of_scree_solver,
        a_window_repeated_from_memory_has_the_same_bits, a_restart_from_a_checkpoint_goes_on_with_the_held_wrenches,
        a_constant_wrench_has_the_bits_of_the_key_force, what_a_partner_does_to_threads_and_rounding_changes_no_bit,
        a_spring_within_the_step_has_the_period_and_energy_of_leapfrog, a_spring_that_is_held_for_a_step_gains_energy,
        a_constant_torque_turns_a_ball_by_its_inertia, a_ball_with_its_own_drag_falls_at_the_speed_of_stokes, a_drag_within_the_step_shortens_a_period_by_its_share,
        the_books_close_with_the_work_of_forces_and_torques, a_body_asleep_wakes_when_its_wrench_changes_by_more_than_the_tolerance,
        bodies_come_and_go_with_their_ids_mass_and_energy, a_driven_wall_is_where_a_prescribed_one_is,
    ])
