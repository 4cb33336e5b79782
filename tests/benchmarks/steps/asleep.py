"""What sleep saves: rocks of 320 triangles that fall in a wide box and come to rest, with `time.sleep` and without, and a step of the heap
when it sleeps against one of the same heap awake.

A step's seconds are those of its phases; the two runs of a pair go at the same time of day, one after the other: compare them only where
nothing else runs.
"""
import os

import large
import scene

LAYERS = 6
MARGIN = 0.05 * scene.RADIUS
STIFFNESS = 3e4   # stops the last rock of 11 g, which falls at 1.6 m/s, within 0.7 of both margins
STEP = 6e-5       # 20 and more to a contact
ROLLING = 0.02    # and torsional: a round rock in a hole between others rolls for ever where nothing resists, and keeps its neighbours awake
TOLERANCE = 0.01   # of the weight; with the thousandth that is the default the heap sleeps at the same time, after more waking
SECONDS = {False: 4.0, True: 0.02}
TILES = {False: 4, True: 1}


def loose(out, side, layers):
    """A scene of rocks side by side that do not touch, to be repeated: its file, and the frame in which it begins."""
    folder, shapes = out / "asleep", out / "asleep-shapes"
    if not (folder / "loose.run" / "run.json").exists():
        folder.mkdir(parents=True, exist_ok=True)
        scene.make_shapes(shapes, scene.Family("rock", 320))
        state, length = scene.lattice(side * side * layers, max(row[4] for row in scene.read_shapes(shapes)), side=side, margin=MARGIN)
        for name, sleeps in (("loose", False), ("loose-asleep", True)):
            path = folder / f"{name}.toml"
            scene.write_case(path, shapes, state, length, STEP, 0.05)
            words = path.read_text()
            rest = f"\nsleep = true\nsleep_tolerance = {TOLERANCE!r}" if sleeps else ""
            rolling = f"\nrolling_friction = {ROLLING}\ntorsional_friction = {ROLLING}"
            for old, new in ((f"step = {scene.STEP!r}", f"step = {STEP!r}{rest}"), (f"stiffness = {scene.STIFFNESS}", f"stiffness = {STIFFNESS}{rolling}"),
                             (f"margin = {scene.MARGIN!r}", f"margin = {MARGIN!r}")):
                assert old in words
                words = words.replace(old, new)
            path.write_text(words)
            scene.solve(folder, name)
    return [(folder / f"{name}.scene.h5", folder / f"{name}.run" / "frame_000000.hdf") for name in ("loose", "loose-asleep")]


def spent(log):
    """Seconds of all phases up to each row of a log."""
    return [sum(column) for column in zip(*scene.phases(log).values())]


def of_last_steps(log):
    """Seconds of a step: the mean of the last tenth of the rows."""
    seconds, first = spent(log), -max(2, len(log["step"]) // 10)
    return (seconds[-1] - seconds[first]) / (log["step"][-1] - log["step"][first])


def measure(out, quick):
    tiles, seconds = TILES[quick], SECONDS[quick]
    side, layers = (4, 2) if quick else (10, LAYERS)
    logs, bodies = [], side * side * layers * tiles ** 2
    for sleeps, (unit, frame) in enumerate(loose(out, side, layers)):
        _, run, _, solver = large.solve(out, "asleep" if sleeps else "awake", unit, frame, tiles, seconds)
        log = scene.read_log(run)
        print(f"{bodies} rocks of 320 triangles, {seconds:g} s, {'with' if sleeps else 'without'} sleep: {solver[1]:.0f} s of one core, kinetic energy at the end "
              f"{log['kinetic_translational'][-1] + log['kinetic_rotational'][-1]:.3g} J; load {os.getloadavg()[0]:.1f}", flush=True)
        logs.append(log)
    awake, asleep = logs
    cost, cost_asleep = spent(awake), spent(asleep)
    for share in (0.25, 0.5, 0.75, 1):
        row = round(share * (len(asleep["step"]) - 1))
        print(f"until {asleep['time'][row]:.3g} s, {100 * asleep['asleep'][row] / bodies:.2f} % asleep: {cost[row] / cost_asleep[row]:.2f} times as fast", flush=True)
    of_asleep, of_awake = of_last_steps(asleep), of_last_steps(awake)
    print(f"a step at the end: {1e3 * of_asleep:.3f} ms of {1e3 * of_awake:.3f} ms ({100 * of_asleep / of_awake:.2f} %)", flush=True)
