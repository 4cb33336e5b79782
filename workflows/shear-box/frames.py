#!/usr/bin/env python3
"""The halves of a shear box as OFF. usage: frames.py LOWER.off UPPER.off SIDE SPLIT GAP HEIGHT LEDGE [m]

The box is SIDE wide, its middle at x = y = 0. The lower half has a floor at z = 0 and sides up to SPLIT; the upper half has sides from SPLIT + GAP to
HEIGHT. Where one half has moved past the other, a LEDGE at the split keeps the grains in: outwards along x, on both halves.
"""
import sys

LOWER, UPPER = sys.argv[1:3]
SIDE, SPLIT, GAP, HEIGHT, LEDGE = map(float, sys.argv[3:])
A = 0.5 * SIDE


def sides(low, high):
    corners = [(-A, -A), (A, -A), (A, A), (-A, A)]
    return [[(*p, low), (*q, low), (*q, high), (*p, high)] for p, q in zip(corners, corners[1:] + corners[:1])]


def ledges(z):
    return [[(s * A, -A, z), (s * (A + LEDGE), -A, z), (s * (A + LEDGE), A, z), (s * A, A, z)] for s in (-1, 1)]


def write(path, quads):
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{4 * len(quads)} {2 * len(quads)} 0\n")
        for quad in quads:
            for x, y, z in quad:
                file.write(f"{x:.17g} {y:.17g} {z:.17g}\n")
        for k in range(len(quads)):
            file.write(f"3 {4 * k} {4 * k + 1} {4 * k + 2}\n3 {4 * k} {4 * k + 2} {4 * k + 3}\n")


write(LOWER, [[(-A, -A, 0), (A, -A, 0), (A, A, 0), (-A, A, 0)], *sides(0, SPLIT), *ledges(SPLIT)])
write(UPPER, [*sides(SPLIT + GAP, HEIGHT), *ledges(SPLIT + GAP)])
