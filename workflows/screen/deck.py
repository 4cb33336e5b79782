#!/usr/bin/env python3
"""A sheet with square openings, as OFF. usage: deck.py DECK.off LENGTH WIDTH OPENING LIGAMENT [m]

Openings lie in rows along x and y, with a rim of a ligament around them. Middle at the origin, normal along z.
"""
import sys

PATH = sys.argv[1]
LENGTH, WIDTH, OPENING, LIGAMENT = map(float, sys.argv[2:])


def lines(size):
    """Coordinates at which ligaments and openings begin and end: an odd number of strips, of which every second one is open."""
    count = int((size - LIGAMENT) / (OPENING + LIGAMENT) + 1e-9)
    at = [0.0]
    for _ in range(count):
        at += [at[-1] + LIGAMENT, at[-1] + LIGAMENT + OPENING]
    at.append(at[-1] + LIGAMENT)
    return [x - 0.5 * at[-1] for x in at]


xs, ys = lines(LENGTH), lines(WIDTH)
faces = []
for i in range(len(xs) - 1):
    for j in range(len(ys) - 1):
        if i % 2 == 1 and j % 2 == 1:
            continue
        a, b, c, d = (k * len(ys) + m for k, m in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
        faces += [(a, b, c), (a, c, d)]
with open(PATH, "w", encoding="utf-8") as file:
    file.write(f"OFF\n{len(xs) * len(ys)} {len(faces)} 0\n")
    for x in xs:
        for y in ys:
            file.write(f"{x:.17g} {y:.17g} 0\n")
    for face in faces:
        file.write("3 {} {} {}\n".format(*face))
