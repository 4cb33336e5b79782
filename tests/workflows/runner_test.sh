#!/usr/bin/env bash
# The workflow runner as a user meets it, as far as nothing has to be simulated: wrong words, help, dry run, lock.
#   runner_test.sh RUNNER SCRATCH
set -uo pipefail
runner=$1
scratch=$2
failures=0
rm -rf "$scratch"; mkdir -p "$scratch"

# expect CODE TEXT COMMAND...: the command ends with that code, and its output has that text
expect() {
  local code=$1 text=$2; shift 2
  local output status=0
  output=$("$@" 2>&1) || status=$?
  if [[ $status -ne $code || "$output" != *"$text"* ]]; then
    printf 'FAILED: %s\n  exit %s, expected %s with "%s" in:\n%s\n' "$*" "$status" "$code" "$text" "$output"
    failures=$((failures + 1))
  fi
}

expect 2 "boulders" "$runner"
expect 2 "no case 'nope'" "$runner" nope
expect 2 "no case '../boulders'" "$runner" ../boulders
expect 2 "needs a number" "$runner" boulders --cores many
expect 0 "--dry-run" "$runner" --help

# a dry run names every step and leaves nothing behind
expect 0 "scree-decomposer pack boulders.toml" "$runner" boulders --dry-run --out "$scratch/out"
expect 0 "boulders-small.scene.h5" "$runner" boulders --dry-run --out "$scratch/out" --config size=small
expect 1 "use one of: full, small" "$runner" boulders --dry-run --out "$scratch/out" --config size=huge
[[ ! -e "$scratch/out" ]] || { echo "FAILED: a dry run left $scratch/out behind"; failures=$((failures + 1)); }

[[ $failures -eq 0 ]] && echo "all as expected"
exit "$((failures > 0))"
