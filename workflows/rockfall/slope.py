#!/usr/bin/env python3
"""A stepped slope with a ditch at its foot, extruded along y. usage: slope.py SLOPE.obj

Three faces of 4 m at 70 degrees, benches of 2 m between them, a ditch of 3 m with a bank of 1.5 m, and level ground beyond."""
import sys

PROFILE = [(-3, 0), (1, 0), (2.46, -4), (4.46, -4), (5.92, -8), (7.92, -8), (9.38, -12), (12.38, -12), (13.88, -10.5), (60, -10.5)]  # x, z [m]
HALF_WIDTH = 25.0

if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        for x, z in PROFILE:
            file.write(f"v {x} {-HALF_WIDTH} {z}\nv {x} {HALF_WIDTH} {z}\n")
        for k in range(len(PROFILE) - 1):
            a, b, c, d = 2 * k + 1, 2 * k + 2, 2 * k + 3, 2 * k + 4
            file.write(f"f {a} {c} {d}\nf {a} {d} {b}\n")   # normals up
