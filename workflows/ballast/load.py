#!/usr/bin/env python3
"""A sleeper under a cyclic load, stepped by Scree's engine. usage: load.py NAME.scene.h5 NAME.run NAME.csv LOWEST HIGHEST FREQUENCY [--restart latest]

First a drag lets the sleeper sink at LOWERED. From REST on, a vertical force presses on it, beyond its own weight: a ramp to the LOWEST load in RAMP, then
LOWEST + (HIGHEST - LOWEST) (1 - cos(2 pi FREQUENCY t)) / 2. Loads have units, as in "0.5 kN". Every WINDOW steps the force is set to that of the middle
of the window, and held: its work is that of the law but for terms of second order. It is a function of the number of the step alone, so that a run that is
killed and resumed has the same bits. NAME.csv has time, load and height of the sleeper [s, N, m].
"""
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "post", "python")]
import scree  # noqa: E402
from run_record import si  # noqa: E402

REST, RAMP, LOWERED = 0.75, 0.1, 0.5   # s, s, m/s
WINDOW, ROW = 8, 32                    # steps


def load(time, lowest, highest, frequency):
    """Force downwards [N] at a time [s]."""
    if time < REST + RAMP:
        return lowest * max(0.0, (time - REST) / RAMP)
    return lowest + 0.5 * (highest - lowest) * (1 - math.cos(2 * math.pi * frequency * (time - REST - RAMP)))


def rows_before(table, time):
    """The complete rows of an earlier part of the run, up to a time."""
    if not os.path.exists(table):
        return []
    with open(table, encoding="utf-8") as file:
        lines = [line for line in file.read().split("\n")[1:-1] if line.count(",") == 2]
    return [line for line in lines if float(line.split(",")[0]) < time]


def main():
    if len(sys.argv) < 7:
        sys.exit(__doc__)
    scene, folder, table, lowest, highest, frequency, *restart = sys.argv[1:]
    if restart not in ([], ["--restart", "latest"]):
        sys.exit(f"load.py: '{' '.join(restart)}' is unknown; use --restart latest")
    try:
        law = si(lowest), si(highest), si(frequency)
    except ValueError as reason:
        sys.exit(f"load.py: {reason}")
    if not (0 < law[0] < law[1] and law[2] > 0):
        sys.exit(f"load.py: loads {lowest} and {highest} at {frequency}: expected 0 < LOWEST < HIGHEST and a frequency above 0")
    with scree.Engine(scene, run=folder, restart="latest" if restart else None) as engine:
        bodies = engine.bodies
        row = int(bodies.mass.argmax())   # the sleeper is the heaviest body
        sleeper, weight = [int(bodies.id[row])], -float(engine.gravity[2]) * float(bodies.mass[row])
        kept = rows_before(table, engine.steps * engine.dt) if restart else []
        with open(table, "w", encoding="utf-8", buffering=1) as file:   # line by line: a killed run has all rows
            file.write("\n".join(["time,load,height", *kept]) + "\n")
            while not engine.is_over:
                if engine.steps % WINDOW == 0:
                    time = engine.steps * engine.dt
                    bodies = engine.bodies
                    row = int((bodies.id == sleeper[0]).argmax())
                    height, speed = float(bodies.position[row, 2]), float(bodies.velocity[row, 2])
                    if time < REST:
                        force = now = speed * weight / LOWERED
                    else:
                        force, now = load(time + 0.5 * WINDOW * engine.dt, *law), load(time, *law)
                    engine.set_wrench(sleeper, [0, 0, -force])
                    if engine.steps % ROW == 0:
                        file.write(f"{time!r},{now!r},{height!r}\n")
                engine.step(WINDOW - engine.steps % WINDOW)


if __name__ == "__main__":
    main()
