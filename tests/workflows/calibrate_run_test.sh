#!/usr/bin/env bash
# workflows/run calibrate with Scree itself: from nothing to its page, killed on the way, resumed, continued; and what only the tools can refuse.
# usage: calibrate_run_test.sh RUNNER BIN SCRATCH
set -euo pipefail
runner=$1; export SCREE_BIN=$2; scratch=$3
log=$scratch.log
rm -rf "$scratch"; mkdir -p "$scratch"

# sixty grains for a tenth of a second, since what is tested is the way, not the answer
small() { echo "set=$1:populations.0.count=60;$1:populations.0.region.cylinder.radius=12 mm;$1:time.duration=0.1 s;$1:output.every=20 ms;$1:walls.1.motion.start=0.02 s"; }
SMALL=$(small heap)
words=("target=heap:centre_of_mass_z=8 mm+-0.5 mm;heap:mean_speed.last=0.05+-0.02" "keys=pairs.0.friction,heap:pairs.1.friction=0.1..0.9" "$SMALL" start=6 replicas=2 batch=2 stop=0 experiments=none)

count() { find "$scratch/out/runs" -path '*.statistics/statistics.json' 2>/dev/null | wc -l; }

# killed when three of its runs are done, with all that it started
for attempt in 1 2 3 4; do
  rm -rf "$scratch/out"
  setsid "$runner" calibrate --out "$scratch/out" --cores 1 --config "${words[@]}" budget=10 >"$log" 2>&1 &
  session=$!
  while kill -0 "$session" 2>/dev/null && [[ $(count) -lt 3 ]]; do sleep 0.05; done
  pkill -KILL -s "$session" || true
  wait "$session" 2>/dev/null || true
  [[ -f "$scratch/out/calibration.md" ]] || break
  [[ $attempt -lt 4 ]] || { echo "it ended before each of four kills: nothing was tested"; exit 1; }
done
[[ $(count) -ge 2 ]] || { cat "$log"; echo "it ended before the kill"; exit 1; }   # the third may have been removed, had its program been killed first
for file in "$scratch"/out/runs/calibrate/*.run/run.json; do
  if [[ -f "${file%.run/run.json}.statistics/statistics.json" ]]; then echo "$file $(stat -c %.9Y "$file")"; fi
done >"$scratch/before"
[[ $(wc -l <"$scratch/before") -ge 2 ]]
unchanged() {
  while read -r file time; do
    [[ $(stat -c %.9Y "$file") == "$time" ]] || { echo "$file was made again: $time, now $(stat -c %.9Y "$file")"; exit 1; }
  done <"$scratch/before"
}

"$runner" calibrate --out "$scratch/out" --cores 1 --config "${words[@]}" budget=10 >"$log" 2>&1 || { cat "$log"; exit 1; }
unchanged
[[ $(count) -eq 10 ]] || { echo "$(count) runs, expected 10"; exit 1; }
grep -q '10 of 10 runs, 0 of them invalid' "$scratch/out/calibration.md"
grep -q '^| pairs.0.friction | \*\*0\.[0-9]*\*\*' "$scratch/out/calibration.md" || { cat "$scratch/out/calibration.md"; exit 1; }
grep -q '^| heap:mean_speed.last |' "$scratch/out/calibration.md"
[[ $(wc -l <"$scratch/out/runs.csv") -eq 11 && -s "$scratch/out/surface.png" && -s "$scratch/out/posterior.png" ]]
[[ $(cut -d, -f3 "$scratch/out/runs.csv" | sort -u | wc -l) -eq 11 ]] || { echo "seeds come twice"; cat "$scratch/out/runs.csv"; exit 1; }
# the tied key was set in both pairs, and the fixed ones
grep -q -- '--set pairs\.0\.friction=\(0\.[0-9]*\) --set pairs\.1\.friction=\1 ' "$scratch/out/runs/calibrate.log"
grep -q '^- \*\*bad\*\*: No keys within the bounds give the measured heap:mean_speed.last' "$scratch/out/calibration.md"

# done: nothing to do; a larger budget goes on
"$runner" calibrate --out "$scratch/out" --cores 1 --config "${words[@]}" budget=10 >"$log" 2>&1
grep -q 'Nothing to be done' "$log"
"$runner" calibrate --out "$scratch/out" --cores 1 --config "${words[@]}" budget=12 >"$log" 2>&1 || { cat "$log"; exit 1; }
[[ $(count) -eq 12 ]] || { echo "$(count) runs, expected 12"; exit 1; }
unchanged

# what to measure next: the sled is run at six points, and would fix the friction of its own pair; a scene without a key of the case is reported. Once more: no run is made again
cp "$(dirname "$runner")/calibrate/slide.toml" "$scratch/sled.toml"
sed -i 's/^\[output\]/[[materials]]\n[output]/' "$scratch/sled.toml"   # one that the decomposer refuses
further=("target=heap:centre_of_mass_z=8 mm+-5 mm" "${words[@]:1}")   # which leaves the key open
further=("${further[@]/experiments=none/experiments=slide;$scratch/sled.toml}" budget=12 survey=6)
for attempt in 1 2; do
  rm -f "$scratch/out/calibration.md"
  "$runner" calibrate --out "$scratch/out" --cores 1 --config "${further[@]}" >"$log" 2>&1 || { cat "$log"; exit 1; }
  [[ $(count) -eq 18 ]] || { echo "$(count) runs, expected 18"; exit 1; }
done
unchanged
grep -q '12 of 12 runs, 0 of them invalid, and 6 of experiments without a target' "$scratch/out/calibration.md" || { cat "$scratch/out/calibration.md"; exit 1; }
grep -q '^- \*\*slide:centre_of_mass_x\*\*, measured once, is expected to narrow the interval of pairs.0.friction' "$scratch/out/calibration.md" || { cat "$scratch/out/calibration.md"; exit 1; }
grep -q '^- sled was not tried: workflows/run .*/sled.toml cannot begin: ' "$scratch/out/calibration.md" || { cat "$scratch/out/calibration.md"; exit 1; }
[[ $(wc -l <"$scratch/out/runs.csv") -eq 19 ]]

# a second scene later: its first design must fit into the budget
if "$runner" calibrate --out "$scratch/out" --cores 1 --config "${words[@]/%0.02/0.02;drum:mean_speed=1+-1}" budget=18 >"$log" 2>&1; then echo "a budget that is too small was accepted"; exit 1; fi
grep -qF "budget=18 is too small: 12 runs are there, and the first design of drum takes 8 more" "$log" || { cat "$log"; exit 1; }

# a case of a user, in a folder of theirs, by a path from where they are
mkdir -p "$scratch/my folder"
cp "$(dirname "$runner")/calibrate/heap.toml" "$scratch/my folder/pile.toml"
(cd "$scratch/my folder" && "$runner" calibrate --out "$scratch/own" --cores 1 --config "target=pile.toml:mean_speed.last=0.2+-0.02" "keys=pile:pairs.0.friction=0.1..0.9" \
  "$(small pile)" start=6 replicas=1 budget=6 "statistics=--from 0.05") >"$log" 2>&1 || { cat "$log"; exit 1; }
grep -q '^| pile:mean_speed.last | 0.2 +- 0.02 m/s |' "$scratch/own/calibration.md"
[[ $(find "$scratch/own/runs/pile" -name statistics.json | wc -l) -eq 6 ]]

# refused TEXT WORDS...: a code other than 0, and the text
refused() {
  local text=$1; shift
  if "$runner" calibrate --out "$scratch/${folder:-bad}" --cores 1 --config "$@" >"$log" 2>&1; then echo "accepted: $*"; exit 1; fi
  grep -qF "$text" "$log" || { echo "'$text' is not in the answer to $*:"; cat "$log"; exit 1; }
}
refused "keys: pairs.0.frictoin: there is no key 'frictoin' in pairs.0" "target=heap:mass=1+-1" "keys=pairs.0.frictoin=0.1..0.9"
refused "did you mean 'friction'?" "target=heap:mass=1+-1" "keys=pairs.0.frictoin=0.1..0.9"
refused "keys: pairs.0.restitution, upper bound: pairs.0.restitution=1.5 is refused in heap" "target=heap:mass=1+-1" "keys=pairs.0.restitution=0.1..1.5"
refused "keys: populations.0.count, between the bounds: populations.0.count=57.77 is refused in heap" "target=heap:mass=1+-1" "keys=populations.0.count=50..71"
refused "set: populations.0.counts: there is no key 'counts'" "target=heap:mass=1+-1" "keys=pairs.0.restitution=0.1..0.5" "set=populations.0.counts=4"
refused "there is no quantity 'mas', did you mean 'mass'?" "target=heap:mas=1+-1" "keys=pairs.0.friction=0.1..0.9"
refused "no 'mass' in the summary of heap" "target=heap:mass@wall 0 disc=1+-1" "keys=pairs.0.friction=0.1..0.9" "$SMALL"
refused "mass is in kg, not in m" "target=heap:mass=1+-1 m" "keys=pairs.0.friction=0.1..0.9" "$SMALL"
refused "there is no group 'lid' in the summary of heap; there are: all, wall 0 disc" "target=heap:mass@lid=1+-1" "keys=pairs.0.friction=0.1..0.9" "$SMALL"
folder=hopper refused "is of the run (none given); there are: hopper-ball-13, hopper-ball-17" "target=hopper:discharge_rate=1+-1" "keys=pairs.0.friction=0.1..0.9" size=small
refused "there is no case file /" "target=nowhere/pile.toml:mass=1+-1" "keys=pairs.0.friction=0.1..0.9"
refused "budget=10 is too small: the first design takes 16 runs" "target=heap:mass=1+-1" "keys=pairs.0.friction=0.1..0.9" budget=10
refused "the runs in this folder are those of a calibration with other keys" "target=heap:mass=1+-1" "keys=pairs.0.friction=0.1..0.8" "$SMALL"
rm -rf "$scratch" "$log"
echo "all as expected"
