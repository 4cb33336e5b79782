#!/usr/bin/env bash
# The studies of validation, stability, work-precision, scaling and peers start, run one case or a small size and write their tables.
# usage: studies_test.sh RUNNER BIN SCRATCH
set -euo pipefail
runner=$1; export SCREE_BIN=$2; scratch=$3
rm -rf "$scratch"

"$runner" validation --config only=G2 --out "$scratch/validation" --cores 1 >"$scratch.log" 2>&1 || { cat "$scratch.log"; exit 1; }
grep -q '| G2 | regular tetrahedron | U | 2 | 0 |' "$scratch/validation/validation.md"
test -f "$scratch/validation/errors.csv"

"$runner" stability --config only=X9 --out "$scratch/stability" --cores 1 >"$scratch.log" 2>&1 || { cat "$scratch.log"; exit 1; }
grep -q '2 held, 0 refused with a named reason, 0 failed' "$scratch/stability/stability.md"

"$runner" work-precision --config studies=margin repeats=1 --out "$scratch/work-precision" --cores 1 >"$scratch.log" 2>&1 || { cat "$scratch.log"; exit 1; }
test "$(grep -c '^margin corner' "$scratch/work-precision/errors.csv")" -eq 24
grep -q '^margin corner,error_traj,.*,yes,' "$scratch/work-precision/fronts/fronts.csv"
grep -q '^margin corner,error_traj,0.01,' "$scratch/work-precision/fronts/best.csv"

"$runner" scaling --config size=small --out "$scratch/scaling" --cores 1 >"$scratch.log" 2>&1 || { cat "$scratch.log"; exit 1; }
test "$(wc -l <"$scratch/scaling/scaling/scaling.csv")" -eq 13   # twelve timed runs on one to four ranks
test -s "$scratch/scaling/model/efficiency.svg"

if [[ -x "$SCREE_BIN/scree-peers-scene" ]]; then  # of the programs, those that are installed; Scree is
  "$runner" peers --config size=small --out "$scratch/peers" --cores 1 >"$scratch.log" 2>&1 || { cat "$scratch.log"; exit 1; }
  grep -q '| Scree |' "$scratch/peers/peers.md"
  test -s "$scratch/peers/peers.png"
fi
rm -rf "$scratch" "$scratch.log"
