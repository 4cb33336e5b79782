#!/usr/bin/env bash
# scree-post as a user runs it: what it prints, what it leaves, and its exit codes.
# usage: tool_test.sh SCREE_POST MAKE_SAMPLE_RUN FOLDER HAVE_VTK
set -u
post=$1 make=$2 folder=$3 vtk=$4
failures=0
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder" || exit 1
"$make" sample.run || exit 1

# expect CODE TEXT COMMAND...: the exit code, and a text in what it prints
expect() {
  local code=$1 text=$2 found; shift 2
  local output; output=$("$@" 2>&1); found=$?
  if [[ $found -ne $code || $output != *"$text"* ]]; then
    echo "FAILED: $* : exit $found (expected $code), expected text '$text' in:"; echo "$output"; failures=$((failures + 1))
  fi
}
there() { [[ -s $1 ]] || { echo "FAILED: $1 is missing or empty"; failures=$((failures + 1)); }; }
absent() { [[ ! -e $1 ]] || { echo "FAILED: $1 should not be there"; failures=$((failures + 1)); }; }

expect 0 "wrote bodies.csv" "$post" bodies sample.run -o bodies.csv;  there bodies.csv
expect 0 "coordination number" "$post" contacts sample.run/ -o contacts.csv;  there contacts.csv;  there contacts.summary.json
expect 0 "coordination_number" "$post" statistics sample.run -o st --by-material --profile r:4 --profile z --region "low=box:-1,-1,-1,1,1,0.1" --repose cone --discharge "z=6 cm"
for file in summary.csv series.csv walls.csv profile_r.csv profile_z_over_time.csv force_distribution.csv pair_correlation.csv statistics.json stress.svg; do there st/$file; done
if command -v rsvg-convert >/dev/null; then there st/stress.png; fi
expect 0 "SVG only" env PATH=/nowhere "$(command -v "$post")" statistics sample.run -o st2 --frames last
expect 2 "no frame between" "$post" statistics sample.run -o st3 --from 7
expect 0 "coordination_number" "$post" statistics sample.run -o st4 --from "0 ms" --to "1 h" --no-charts
expect 2 "for instance" "$post" statistics sample.run -o st5 --from "2 mm"
expect 2 "write -o bodies.csv" "$post" bodies sample.run -o bodies
expect 2 "write -o contacts.csv" "$post" contacts sample.run -o contacts
expect 2 "write -o page.html" "$post" report sample.run -o page;  absent page
expect 2 "write --json page.json" "$post" report sample.run -o page.html --json page;  absent page.html
expect 2 "write -o look.png" "$post" picture sample.run -o look
expect 2 "is no axis" "$post" statistics sample.run -o st3 --profile q:4
expect 0 "Energy balance" "$post" report sample.run -o report.html;  there report.html
expect 0 "scree-post report" "$post" --help
expect 0 "scree-post" "$post" --version

cp -r sample.run other.run
expect 0 "bit by bit" "$post" compare sample.run other.run -o cmp;  there cmp/statistics.csv;  there cmp/divergence.svg;  there cmp/comparison.json
expect 2 "one run is given" "$post" compare sample.run -o cmp2
printf 'case,integrator,step,wall_median,error_e\na,x,1e-3,1,0.1\na,x,1e-4,8,0.01\n' >errors.csv
expect 0 "error_e <= 0.1: step 1e-3 (1 s" "$post" error-vs-time errors.csv -o fronts --at 0.1;  there fronts/a-error_e.svg;  there fronts/best.csv
expect 3 "no such file" "$post" error-vs-time nothing.csv -o fronts2
expect 0 "Files behind the run" "$post" report sample.run -o numbered.html --json report.json --frame 1;  there report.json

expect 2 "did you mean 'report'" "$post" reprot sample.run -o x.html
expect 2 "output" "$post" bodies sample.run
expect 3 "nowhere.run" "$post" bodies nowhere.run -o x.csv
expect 4 "No such file" "$post" bodies sample.run -o nowhere/x.csv
absent x.csv
if [[ $vtk == 1 ]]; then
  expect 0 "3 frames" "$post" paraview sample.run;  there sample.run/paraview/sample.pvd;  there sample.run/paraview/open_in_paraview.py
  expect 0 "network.pvd" "$post" vtk sample.run -o vtk --what network,walls --frames 1:2 --jobs 2;  there vtk/network_000002.vtp;  absent vtk/network_000000.vtp
  expect 2 "it has: box, wedge, ball" "$post" vtk sample.run -o vtk2 --shape bol
  expect 2 "region 'ring:1'" "$post" vtk sample.run -o vtk2 --region ring:1
  expect 0 "wrote forces.png" "$post" picture sample.run -o forces.png --network --time \
    --from 0 0 1 --at 0.1 0.1 0.1 --zoom 2 --size 320 240;  there forces.png
  expect 0 "wrote speed.png" "$post" picture sample.run -o speed.png --colour velocity;  there speed.png
  expect 2 "--frame 9" "$post" picture sample.run -o x.png --frame 9
  absent x.png
  expect 0 "wrote rocks.png" "$post" picture sample.run -o rocks.png --frame 1;  there rocks.png
else
  expect 2 "libvtk9-dev" "$post" paraview sample.run
fi

# a run in progress: no run.json yet
cp -r sample.run running.run && rm running.run/run.json
expect 0 "still being written" "$post" bodies running.run -o running.csv;  there running.csv

# damage
cp -r sample.run cut.run && truncate -s 3000 cut.run/frame_000002.hdf
expect 3 "frame_000002.hdf" "$post" bodies cut.run -o cut.csv;  absent cut.csv
expect 3 "frame_000002.hdf" "$post" statistics cut.run -o cut_st --no-charts;  absent cut_st/series.csv
expect 0 "left out: cut.run/frame_000002.hdf" "$post" bodies cut.run -o cut.csv --skip-damaged;  there cut.csv
cp -r sample.run newer.run && sed -i 's/"format_version": 1,/"format_version": 7,/' newer.run/run.json
expect 3 "version 7" "$post" report newer.run -o newer.html;  absent newer.html

# nothing but whole files is left
leftover=$(find . -name '*.tmp')
[[ -z $leftover ]] || { echo "FAILED: left behind: $leftover"; failures=$((failures + 1)); }
echo "$failures failures"
[[ $failures -eq 0 ]]
