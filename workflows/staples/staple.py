#!/usr/bin/env python3
"""The mesh of a staple. usage: staple.py RATIO OUTPUT.off

A bar of square section is bent at two sharp corners: a crown of WIDTH, and two legs that stand out from the crown by RATIO times WIDTH.
"""
import sys

WIDTH, THICKNESS = 13.0, 1.0   # [mm]

if len(sys.argv) != 3:
    raise SystemExit("usage: staple.py RATIO OUTPUT.off")
RATIO, OUTPUT = sys.argv[1:]
half, top = WIDTH / 2, THICKNESS + float(RATIO) * WIDTH
if not top > THICKNESS:
    raise SystemExit(f"staple.py: an arm length of {RATIO} widths: expected a number above 0")
# seen along y: the crown is below, the legs point up
outline = [(-half, 0), (half, 0), (half, top), (half - THICKNESS, top), (half - THICKNESS, THICKNESS), (THICKNESS - half, THICKNESS), (THICKNESS - half, top), (-half, top)]
front = [(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7)]
count = len(outline)
triangles = front + [(c + count, b + count, a + count) for a, b, c in front]
for i in range(count):
    j = (i + 1) % count
    triangles += [(i, i + count, j + count), (i, j + count, j)]
with open(OUTPUT, "w", encoding="utf-8") as file:
    file.write(f"OFF\n# staple {WIDTH:g} mm wide and {THICKNESS:g} mm thick, legs of {RATIO} widths [mm]\n{2 * count} {len(triangles)} 0\n")
    for y in (-THICKNESS / 2, THICKNESS / 2):
        file.writelines(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, z in outline)
    file.writelines(f"3 {a} {b} {c}\n" for a, b, c in triangles)
