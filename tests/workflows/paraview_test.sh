#!/usr/bin/env bash
# pvbatch opens the script that each workflow writes for ParaView, in its small size, and draws a picture with bodies in it.
# usage: paraview_test.sh RUNNER BIN SCRATCH    Exit 77: skipped. Pictures stay in SCRATCH/*.png, to be looked at.
# ParaView's Python modules conflict with Debian's libvtk9-dev, so it is looked for on PATH and never installed by setup.
set -euo pipefail
screen="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/tests/support/with_screen"
runner=$1; export SCREE_BIN=$2; scratch=$3
for tool in pvbatch Xvfb; do
  command -v $tool >/dev/null || { echo "SKIPPED: $tool is not on PATH"; exit 77; }
done
rm -rf "$scratch"; mkdir -p "$scratch"
for pair in boulders/boulders-small hopper/hopper-ball-13 column/column-small repose/repose-cube drum/drum-small shape-dial/dial-hull; do
  name=${pair%/*} run=${pair#*/}
  # our own tools must not load ParaView's libraries, so these paths are for pvbatch alone
  env -u LD_LIBRARY_PATH -u PYTHONPATH "$runner" "$name" "$run.run/paraview/open_in_paraview.py" --out "$scratch/$name" --config size=small ranks=1 >"$scratch/$name.log" 2>&1 ||
    { cat "$scratch/$name.log"; exit 1; }
  for option in "" --network; do
    if [[ $option == --network && ! -e "$scratch/$name/$run.run/paraview/network.pvd" ]]; then continue; fi  # hopper keeps no contacts
    picture="$scratch/$run$option.png"
    "$screen" pvbatch "$scratch/$name/$run.run/paraview/open_in_paraview.py" --size 640 480 $option --picture "$picture"
    env -u LD_LIBRARY_PATH -u PYTHONPATH /usr/bin/python3 - "$picture" <<'PYTHON'
import sys
from matplotlib.image import imread
picture = imread(sys.argv[1])[:, :, :3]
drawn = (abs(picture - picture[0, 0]).max(axis=2) > 0.05).mean()  # other than the ground
assert picture.shape == (480, 640, 3) and drawn > 0.02, f"{sys.argv[1]}: {picture.shape}, {drawn:.3f} of it drawn on"
print(f"{sys.argv[1]}: {drawn:.2f} of the picture drawn on")
PYTHON
  done
  rm -rf "${scratch:?}/$name"
done
