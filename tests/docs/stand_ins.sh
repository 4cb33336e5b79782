#!/usr/bin/env bash
# What the commands of a page need and do not make, in the folder where it is called. usage: stand_ins.sh PAGE.md
set -euo pipefail

# rock.stl, and case.toml of a few of these rocks for as long as is said
rock_and_case() {
  scree-mesher simplify /usr/share/assimp/models/3DS/fels.3ds -o rock.stl --unit cm --triangles 100
  cat >case.toml <<CASE
[time]
duration = $1
[shapes.fels]
file = "rock.shape.h5"
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = "800 N/m"
restitution = 0.3
friction = 0.4
[contact]
margin = "1 mm"
[[populations]]
shape = "fels"
material = "stone"
count = 24
size = "8 mm"
region = { box = [[-0.02, -0.02, 0], [0.02, 0.02, 0.06]] }
[[walls]]
shape = { box_inside = [[-0.02, -0.02, 0], [0.02, 0.02, 0.1]] }
material = "stone"
[output]
every = $2
contacts = true
CASE
}
# a scene of it
scene() {
  rock_and_case "$2" "$3"
  scree-mesher import rock.stl -o rock.shape.h5
  scree-decomposer pack case.toml -o "$1.scene.h5"
}
run() {
  scene "$@"
  scree-solver "$1.scene.h5" -o "$1.run"
}

case "$1" in
  README.md) rock_and_case 0.02 0.01 ;;
  decomposer/README.md) rock_and_case 0.02 0.01; scree-mesher import rock.stl -o rock.shape.h5 ;;
  solver/README.md) scene boulders 0.02 0.01 ;;
  post/README.md)
    run boulders 0.24 0.01
    for name in exact hull sphere; do cp -r boulders.run $name.run; done
    printf 'case,integrator,step,wall_median,error_traj\nI3,euler,1e-3,1,0.1\nI3,euler,1e-4,8,0.0005\n' >errors.csv ;;
  post/python/README.md)
    run boulders 0.1 0.01
    sed 's/^file = "rock.shape.h5"/sphere = { radius = "4 mm" }/; s/shapes.fels/shapes.ball/; s/stone/glass/g; /^\[\[populations/,/^region/d' case.toml >balls.toml ;;
  post/STATISTICS.md)
    run drum 2.5 0.1
    cp -r drum.run silo.run ;;
  tests/benchmarks/distance/README.md)
    /usr/bin/python3 -c "import random, struct; open('p.bin', 'wb').write(struct.pack('<1800d', *(random.uniform(-1, 1) for _ in range(1800))))" ;;
esac
