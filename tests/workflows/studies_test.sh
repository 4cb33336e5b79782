#!/usr/bin/env bash
# The studies of validation, stability, work-precision, scaling and peers run one case or a small size and write their tables, each killed on the way and resumed.
# usage: studies_test.sh RUNNER BIN SCRATCH
set -euo pipefail
runner=$1; export SCREE_BIN=$2; scratch=$3
log=$scratch.log
rm -rf "$scratch"

# Runs a study until one of its programs is at work, sends SIGKILL to all that it started, and runs it again to its end.
study() {
  local out=$scratch/$1 session
  for _ in 1 2 3 4; do  # on a busy machine the study may have ended before the signal comes; then another one is killed
    rm -rf "$out"
    setsid "$runner" "$@" --out "$out" --cores 1 >"$log" 2>&1 &
    session=$!
    while kill -0 "$session" 2>/dev/null && ! pgrep -s "$session" '^scree-' >/dev/null; do sleep 0.01; done
    pkill -KILL -s "$session" || true
    wait "$session" 2>/dev/null || true
    "$runner" "$@" --out "$out" --cores 1 >"$log" 2>&1 || { cat "$log"; exit 1; }
    if grep -q 'the last run was killed; resuming' "$log"; then return; fi
  done
  echo "$1: ended before each of four kills: nothing was tested"
  exit 1
}

study validation --config only=G2
grep -q '| G2 | regular tetrahedron | U | 2 | 0 |' "$scratch/validation/validation.md"
test -f "$scratch/validation/errors.csv"

study stability --config only=X9
grep -q '2 held, 0 refused with a named reason, 0 failed' "$scratch/stability/stability.md"

study work-precision --config studies=margin repeats=1
test "$(grep -c '^margin corner' "$scratch/work-precision/errors.csv")" -eq 24
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
