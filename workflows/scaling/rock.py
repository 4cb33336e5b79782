#!/usr/bin/env python3
"""Writes a bumpy rock of 320 triangles and mean radius 1 as an OBJ file. usage: rock.py SEED FILE.obj

An icosphere of level 2 whose radius follows twelve random waves; not convex. No file of anybody else is needed."""
import math
import random
import sys


def icosphere(level):
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    unit = lambda p: tuple(c / math.sqrt(sum(x * x for x in p)) for c in p)
    points = [unit(p) for p in points]
    for _ in range(level):
        middle, finer = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(unit(tuple((p + q) / 2 for p, q in zip(points[a], points[b]))))
            return middle[key]

        for a, b, c in faces:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return points, faces


def main():
    seed, path = int(sys.argv[1]), sys.argv[2]
    generator = random.Random(seed)
    waves = []
    for i in range(12):
        d = [generator.gauss(0, 1) for _ in range(3)]
        size = (2.5 + 3.5 * i / 12) / math.sqrt(sum(c * c for c in d))
        waves.append(([size * c for c in d], generator.uniform(0, 2 * math.pi)))
    points, faces = icosphere(2)
    with open(path, "w") as f:
        for p in points:
            bumps = sum(math.sin(sum(a * b for a, b in zip(w, p)) + shift) for w, shift in waves)
            r = min(1.6, max(0.5, 1 + 0.22 * math.sqrt(2 / 12) * bumps))
            f.write("v %.17g %.17g %.17g\n" % tuple(r * c for c in p))
        for face in faces:
            f.write("f %d %d %d\n" % tuple(v + 1 for v in face))


main()
