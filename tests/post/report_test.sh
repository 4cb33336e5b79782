#!/usr/bin/env bash
# The reports of made-up runs, opened in headless Chromium: one with pictures, one of bodies that come and go, one of a single frame, one of
# a run of 200 bodies and 100 frames, whose page stays small.
# usage: report_test.sh SCREE_POST MAKE_SAMPLE_RUN FOLDER REPORT_TEST.py    Exit 77: skipped.
set -eu
post=$1 make=$2 folder=$3 test=$4
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
"$make" sample.run
env -u DISPLAY "$post" report sample.run -o report.html --json report.json
"$post" bodies sample.run -o report.csv

"$make" large.run 200 100
env -u DISPLAY "$post" report large.run -o large.html
bytes=$(stat -c %s large.html)
[[ $bytes -gt 100000 && $bytes -lt 10000000 ]] || { echo "FAILED: the page of 200 bodies and 100 frames has $bytes bytes, below 10 MB expected"; exit 1; }
grep -q "All 100 frames are played" large.html || { echo "FAILED: large.html does not play 100 frames"; exit 1; }

# without Xvfb on the path they have no pictures, which cost most of the time
"$make" come.run 12 9 come-and-go
rm come.run/run.json  # as of a run that was killed
env -u DISPLAY PATH=/nonexistent "$post" report come.run -o come.html --json come.json --frame 4
"$post" bodies come.run -o come.csv
"$make" one.run 12 1
env -u DISPLAY PATH=/nonexistent "$post" report one.run -o one.html
exec /usr/bin/python3 "$test" report.html report.json shots
