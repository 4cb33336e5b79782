#!/usr/bin/env bash
# Balls pressed by a lid, without gravity: the stress from the contacts is the force on each of six walls over its area, to 1 %.
# The forces on the walls are summed by the solver, the stress by scree-post from the contact records.
# usage: wall_stress_test.sh BIN FOLDER
set -eu
bin=$1 folder=$2
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
"$bin/scree-mesher" generate sphere --radius 1cm --analytic -o ball.shape.h5 >/dev/null
cat >pressed.toml <<'CASE'
title = "balls pressed by a lid"
seed = 3
gravity = [0, 0, 0]
[time]
duration = "0.7 s"
steps_per_contact = 20
[shapes.ball]
file = "ball.shape.h5"
[materials.glass]
density = "2500 kg/m^3"
[materials.plate]
density = "2500 kg/m^3"               # not used: walls are driven
[[pairs]]
between = ["glass", "glass"]
stiffness = "2 kN/m"                  # soft, so that the test is short; the balls overlap by some per cent
restitution = 0.3
friction = 0.3
[[pairs]]
between = ["glass", "plate"]
stiffness = "2 kN/m"
restitution = 0.3
friction = 0                          # so that only the two walls across an axis carry its stress, and both the same
[contact]
margin = 0
[[populations]]
shapes = { ball = 1 }
material = "glass"
count = 250
region = { box = [[0.001, 0.001, 0.001], [0.139, 0.139, 0.189]] }
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [1, 0, 0] } }
material = "plate"
[[walls]]
shape = { plane = { point = [0.14, 0, 0], normal = [-1, 0, 0] } }
material = "plate"
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 1, 0] } }
material = "plate"
[[walls]]
shape = { plane = { point = [0, 0.14, 0], normal = [0, -1, 0] } }
material = "plate"
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "plate"
[[walls]]
shape = { plane = { point = [0, 0, 0.19], normal = [0, 0, -1] } }
material = "plate"
motion = { translate = { velocity = [0, 0, -0.4] }, stop = 0.2725 }   # to z = 0.081: a solid fraction of 0.66
[output]
every = "0.05 s"
contacts = true
CASE
"$bin/scree-decomposer" pack pressed.toml -o pressed.scene.h5 >/dev/null
"$bin/scree-solver" pressed.scene.h5 -o pressed.run >/dev/null 2>solver.log || { cat solver.log; exit 1; }
"$bin/scree-post" statistics pressed.run -o statistics --from 0.6 --no-charts --container box:0,0,0,0.14,0.14,0.081 \
  --region "room=box:0,0,0,0.14,0.14,0.081" >/dev/null 2>&1
/usr/bin/python3 - <<'CHECK'
import json
with open("statistics/statistics.json") as f:
    numbers = json.load(f)
stress = numbers["groups"]["region room"]
walls = list(numbers["walls"].values())
side, height = 0.14, 0.081
for axis, (low, high, area) in {"xx": (0, 1, side * height), "yy": (2, 3, side * height), "zz": (4, 5, side * side)}.items():
    gauge = [abs(walls[w]["force_" + axis[0]]["mean"]) / area for w in (low, high)]
    inside = stress["stress_" + axis]["mean"]
    print("%s: contacts %.6g Pa, walls %.6g and %.6g Pa" % (axis, inside, *gauge))
    assert inside > 100, "nothing presses"
    for pressure in gauge:
        assert abs(inside / pressure - 1) < 0.01, (axis, inside, pressure)
fabric = numbers["groups"]["all"]
for tensor in ("fabric", "force_fabric"):
    assert abs(sum(fabric["%s_%s" % (tensor, k)]["mean"] for k in ("xx", "yy", "zz")) - 1) < 1e-12, tensor
assert abs(stress["solid_fraction"]["mean"] - 0.66) < 0.01, stress["solid_fraction"]
CHECK
