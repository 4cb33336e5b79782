#!/usr/bin/env bash
# The workflow runner as a user meets it, as far as nothing has to be simulated: wrong words, help, dry run, lock.
#   runner_test.sh RUNNER SCRATCH BIN
set -uo pipefail
runner=$1
scratch=$2
bin=$3
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

# the profile for Slurm, with a queue that runs at once what it is sent: the words reach sbatch, the outcome comes back
expect 2 "there are:" "$runner" boulders --dry-run --profile none
mkdir -p "$scratch/queue"
cat >"$scratch/queue/sbatch" <<'QUEUE'
#!/usr/bin/env bash
echo "$@" >>"$(dirname "$0")/log"
code=0; bash "${@: -1}" >&2 || code=$?
echo "$code" >"$(dirname "$0")/job.$$"; echo "$$"
QUEUE
cat >"$scratch/queue/sacct" <<'QUEUE'
#!/usr/bin/env bash
[[ "$(cat "$(dirname "$0")/job.${@: -1}")" == 0 ]] && echo COMPLETED || echo FAILED
QUEUE
chmod +x "$scratch/queue/sbatch" "$scratch/queue/sacct"
expect 0 "steps (100%) done" env PATH="$scratch/queue:$PATH" SCREE_BIN="$bin" "$runner" boulders boulders-small.toml --profile slurm --out "$scratch/slurm" --config size=small
expect 0 "--ntasks=1 --cpus-per-task=1" cat "$scratch/queue/log"

# the job script of the profile: a signal that comes before the solver is there waits for it; steps without one go on to their own end
mkdir -p "$scratch/told"
printf '#!/bin/bash\ntrap "echo told; exit 138" USR1\nfor i in {1..100}; do sleep 0.1; done\n' >"$scratch/told/mpirun"; chmod +x "$scratch/told/mpirun"
told() {  # told STEP: the script with that step, sent SIGUSR1 after half a second
  /usr/bin/python3 -c 'import sys; print(open(sys.argv[1]).read().format(properties="", exec_job=sys.argv[2]))' "$(dirname "$runner")/profiles/slurm/job.sh" "$1" >"$scratch/job.sh"
  bash "$scratch/job.sh" & local job=$! code=0
  sleep 0.5; kill -USR1 "$job"; wait "$job" || code=$?; return "$code"
}
expect 138 "told" told "sleep 1; $(printf %q "$scratch")/told/mpirun"
expect 138 "told" told "$(printf %q "$scratch")/told/mpirun"
expect 3 "" told "sleep 1; exit 3"
expect 0 "" told "sleep 1"

# a copy of the repository, results and a queue in folders with blanks: no step takes a path for two words, by hand or by the queue
copy="$scratch/a copy"; mkdir -p "$copy/tests"
cp -r "$(dirname "$runner")" "$copy/workflows"
cp -r "$(dirname "$runner")/../tests/validation" "$copy/tests"
rm -rf "$copy"/workflows/*/out
mv "$scratch/queue" "$scratch/a queue"
expect 0 "steps (100%) done" env PATH="$scratch/a queue:$PATH" SCREE_BIN="$bin" \
  "$copy/workflows/run" boulders boulders-small.toml --profile slurm --out "$scratch/an out" --config size=small
for name in $(cd "$copy/workflows" && ls -d */ | tr -d /); do
  [[ -f "$copy/workflows/$name/Snakefile" ]] || continue
  steps=$("$copy/workflows/run" "$name" --dry-run --out "$scratch/an out/$name" 2>&1) || { echo "FAILED: $name --dry-run: $steps"; failures=$((failures + 1)); }
  # within quotes the folder is followed by the rest of its path and a quote
  loose=$(grep -v "^ *input:" <<<"$steps" | sed "s,'[^']*/a copy/[^']*',,g" | grep "/a copy/" || true)
  [[ -z "$loose" ]] || { printf 'FAILED: a path with a blank is not quoted in %s:\n%s\n' "$name" "$loose"; failures=$((failures + 1)); }
done

# what the runner would build there configures
expect 0 "Build files have been written" cmake -S "$(dirname "$runner")/.." -B "$scratch/a build" -G Ninja

[[ $failures -eq 0 ]] && echo "all as expected"
exit "$((failures > 0))"
