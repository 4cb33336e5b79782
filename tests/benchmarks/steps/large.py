"""Large scenes end to end: a settled box of a thousand bodies repeated side by side, cut for two ranks, solved, its last frame read again.

A bed of any size is the same bed, so what a body costs can be compared from 10^3 to 10^6. Of balls (Hertz-Mindlin, friction) and of rocks of
80 triangles. Seconds of a step are those of its phases on one thread, runs of different lengths subtracted, since a start of a million bodies
takes longer than so few steps; memory is the largest of a process.
"""
import os
import subprocess
import time

import compare
import scene

ROCK_TRIANGLES = 80
SIDE = 10   # bodies of the unit along each axis as it starts
COPIES = {False: ((1, 4000), (10, 100), (32, 20)), True: ((1, 20), (2, 10))}   # along x and y, and steps; quick
SETTLE_SECONDS = {False: 0.5, True: 0.02}


def rocks(out, quick):
    """Scene and last frame of the unit."""
    side = 4 if quick else SIDE
    folder, shapes = out / f"large-rock-{side}", out / "large-shapes"
    if not (folder / "settle.run" / "run.json").exists():
        scene.make_shapes(shapes, scene.Family("rock", ROCK_TRIANGLES))
        state, length = scene.lattice(side ** 3, max(row[4] for row in scene.read_shapes(shapes)), side=side)
        scene.run_scree(folder, "settle", shapes, state, length, SETTLE_SECONDS[quick])
    return folder / "settle.scene.h5", sorted((folder / "settle.run").glob("frame_*.hdf"))[-1], scene.STEP


def balls(out, quick):
    side = 4 if quick else SIDE
    compare.bed_of_balls(out, side, 1, SETTLE_SECONDS[quick])
    folder = out / f"balls-{side}"
    return folder / "settle.scene.h5", sorted((folder / "settle.run").glob("frame_*.hdf"))[-1], compare.BALL_STEP


def timed(command, **options):
    """Wall and CPU seconds and peak memory [bytes] of a program."""
    start = time.monotonic()
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    words = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}\nended with {process.returncode}: {words[-1500:]}")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def solve(out, name, unit, frame, copies, duration):
    """Seconds of the tools and files of one bed and run of so long; the run's folder."""
    packed, run = out / f"{name}.scene.h5", out / f"{name}.run"
    tile = timed(["scree-decomposer", "tile", unit, "--frame", frame, "--copies", f"{copies},{copies},1", "--duration", repr(duration), "-o", packed])
    scene.run_tool(["rm", "-rf", run])
    solver = timed(["scree-solver", packed, "-o", run], env=scene.one_core())
    return packed, run, tile, solver


def step_seconds(run):
    """Of all phases but output, from the start to the last row of the log."""
    return sum(column[-1] for column in scene.phases(scene.read_log(run)).values())


def measure(out, kind, quick):
    unit, frame, step = {"balls": balls, "rocks": rocks}[kind](out, quick)
    first = None
    for copies, steps in COPIES[quick]:
        name = f"large-{kind}"
        _, run, _, _ = solve(out, name, unit, frame, copies, (steps // 10) * step)
        short = step_seconds(run)
        packed, run, tile, long = solve(out, name, unit, frame, copies, (steps + steps // 10) * step)
        bodies = (4 if quick else SIDE) ** 3 * copies ** 2
        cost = (step_seconds(run) - short) / (steps * bodies)
        first = first or cost
        cut = timed(["scree-decomposer", "partition", packed, "--ranks", "2", "-o", out / f"{name}.cut.scene.h5"])
        statistics = timed(["scree-post", "statistics", run, "-o", out / f"{name}.statistics"])
        last = sorted(run.glob("frame_*.hdf"))[-1]
        print(f"{bodies:8} {kind}: {1e6 * cost:.3f} us a body and step ({cost / first:.2f} of the first); solver {long[2] / 2**30:.2f} GiB, "
              f"{long[2] / bodies:.0f} bytes a body; scene {packed.stat().st_size / 1e6:.0f} MB, frame {last.stat().st_size / 1e6:.0f} MB; "
              f"pack {tile[0]:.1f} s ({tile[2] / 2**30:.2f} GiB), cut {cut[0]:.1f} s ({cut[2] / 2**30:.2f} GiB), "
              f"solve {steps + steps // 10} steps {long[0]:.1f} s, statistics {statistics[0]:.1f} s ({statistics[2] / 2**30:.2f} GiB); "
              f"load {os.getloadavg()[0]:.1f}", flush=True)
