#!/usr/bin/env bash
# The report of the made-up run, with pictures, opened in headless Chromium.
# usage: report_test.sh SCREE_POST MAKE_SAMPLE_RUN FOLDER REPORT_TEST.py    Exit 77: skipped.
set -eu
post=$1 make=$2 folder=$3 test=$4
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
"$make" sample.run
env -u DISPLAY "$post" report sample.run -o report.html --json report.json
exec /usr/bin/python3 "$test" report.html report.json shots
