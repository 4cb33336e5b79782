#!/usr/bin/env bash
# The distance study, with few pairs, killed on the way and resumed: it ends, its page has no hole left, its picture is one, brute-force is on it.
# usage: distance_study_test.sh workflows/run FOLDER_WITH_PROGRAMS SCRATCH
set -euo pipefail
runner=$1; export SCREE_BIN=$2; scratch=$3
log=$scratch.log
source "$(dirname "$0")/killed_study.sh"
study distance-study --config pairs=64 seconds=0.001
out=$scratch/distance-study
page=$out/distance-study.md
[[ $(wc -l <"$out/distance-study.csv") -eq $((1 + 12 * (8 * 2 + 1))) ]]  # regimes, methods in two precisions and one in one
if grep -n '{[a-z_0-9]*}' "$page"; then echo "placeholders left in $page" >&2; exit 1; fi
grep -q '^| `pen7-hybrid` |' "$page"
[[ $(head -c 4 "$out/distance-study.png" | tail -c 3) == PNG ]]
