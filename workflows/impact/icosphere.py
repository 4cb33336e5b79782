#!/usr/bin/env python3
"""An icosphere of radius 1 as OBJ: the icosahedron, each triangle cut in four LEVEL times. usage: icosphere.py LEVEL FILE"""
import sys

import numpy as np

level, path = int(sys.argv[1]), sys.argv[2]
golden = (1 + 5**0.5) / 2
vertices = [np.array(v, float) / np.hypot(1, golden) for v in (
    (-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden), (0, 1, golden),
    (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1))]
triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
for _ in range(level):
    middles = {}

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in middles:
            between = vertices[a] + vertices[b]
            middles[key] = len(vertices)
            vertices.append(between / np.linalg.norm(between))
        return middles[key]
    triangles = [t for a, b, c in triangles for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                 for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
with open(path, "w", encoding="utf-8") as file:
    for v in vertices:
        file.write("v " + " ".join(repr(float(x)) for x in v) + "\n")
    for t in triangles:
        file.write("f " + " ".join(str(i + 1) for i in t) + "\n")
