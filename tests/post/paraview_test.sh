#!/usr/bin/env bash
# ParaView 5.11 or newer opens the generated script, and its glyphs cover the same pixels as the expanded surfaces.
# usage: paraview_test.sh SCREE_POST MAKE_SAMPLE_RUN FOLDER COMPARE_PICTURES.py    Exit 77: skipped.
# ParaView's Python modules conflict with Debian's libvtk9-dev, so it is looked for on PATH and never installed by setup.
set -eu
screen="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/tests/support/with_screen"
post=$1 make=$2 folder=$3 compare=$4
for tool in pvbatch Xvfb; do
  command -v $tool >/dev/null || { echo "SKIPPED: $tool is not on PATH"; exit 77; }
done
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
# our own tools must not load ParaView's libraries, so these paths are for pvbatch alone
env -u LD_LIBRARY_PATH "$make" sample.run
env -u LD_LIBRARY_PATH "$post" paraview sample.run
mv sample.run moved.run && mkdir sub && mv moved.run sub/sample.run  # the script finds its run from where it is now
cd /
for frame in 0 2; do
  for kind in "" --surfaces; do
    "$screen" pvbatch "$folder/sub/sample.run/paraview/open_in_paraview.py" --plain --size 800 600 \
      --frame $frame $kind --picture "$folder/frame$frame$kind.png"
  done
  pvbatch "$compare" "$folder/frame$frame.png" "$folder/frame$frame--surfaces.png"
done
if cmp -s "$folder/frame0.png" "$folder/frame2.png"; then echo "FAILED: frames 0 and 2 look the same"; exit 1; fi
"$screen" pvbatch "$folder/sub/sample.run/paraview/open_in_paraview.py" --picture "$folder/full.png"
test -s "$folder/full.png"
for option in "--colour velocity" "--colour rank" "--colour material" --network "--network --frame 0"; do  # frame 0 has no contacts
  picture="$folder/$(echo "$option" | tr -d ' -').png"
  "$screen" pvbatch "$folder/sub/sample.run/paraview/open_in_paraview.py" $option --picture "$picture"
  if cmp -s "$folder/full.png" "$picture"; then echo "FAILED: $option changes nothing"; exit 1; fi
done
