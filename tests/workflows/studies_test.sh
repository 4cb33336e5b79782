#!/usr/bin/env bash
# The studies of validation, stability, work-precision, scaling and peers run one case or a small size and write their tables, each killed on the way and resumed.
# usage: studies_test.sh RUNNER BIN SCRATCH
set -euo pipefail
runner=$1; export SCREE_BIN=$2; scratch=$3
log=$scratch.log
rm -rf "$scratch"
source "$(dirname "$0")/killed_study.sh"

study validation --config only=G2
grep -q '| G2 | regular tetrahedron | U | 2 | 0 |' "$scratch/validation/validation.md"
test -f "$scratch/validation/errors.csv"

study stability --config only=X9
grep -q '2 held, 0 refused with a named reason, 0 failed' "$scratch/stability/stability.md"

study work-precision --config studies=margin repeats=1
test "$(grep -c '^margin corner' "$scratch/work-precision/errors.csv")" -eq 32
grep -q '^margin corner,error_traj,.*,yes,' "$scratch/work-precision/fronts/fronts.csv"
grep -q '^margin corner,error_traj,0.01,' "$scratch/work-precision/fronts/best.csv"

study scaling --config size=small
test "$(wc -l <"$scratch/scaling/scaling/scaling.csv")" -eq 13   # twelve timed runs on one to four ranks
test -s "$scratch/scaling/model/efficiency.svg"

if [[ -x "$SCREE_BIN/scree-peers-scene" ]]; then  # of the programs, those that are installed; Scree is
  study peers --config size=small
  grep -q '| Scree |' "$scratch/peers/peers.md"
  test -s "$scratch/peers/peers.png"
fi
rm -rf "$scratch" "$log"
