#!/usr/bin/env bash
# Pictures without a screen: the tools start an X server of their own, and none is left behind however they end.
# usage: screen_test.sh SCREE_POST SCREE_MESHER MAKE_SAMPLE_RUN FOLDER
set -u
post=$1 mesher=$2 make=$3 folder=$4
screen="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/support/with_screen"
failures=0
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder" || exit 1
"$make" sample.run || exit 1
unset DISPLAY XAUTHORITY
export SCREE_TEST_MARK="screen-$$-$RANDOM"  # servers of other tests on this machine are none of ours

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }
servers() {
  local p
  for p in $(pgrep -x Xvfb); do grep -qs "SCREE_TEST_MARK=$SCREE_TEST_MARK" "/proc/$p/environ" && echo "$p"; done
}
none_left() {  # a server that was asked to end needs a moment
  for _ in $(seq 200); do [[ -z $(servers) ]] && return; sleep 0.05; done
  fail "$1: left behind: $(servers)"
}
# expect CODE TEXT COMMAND...: the exit code, and a text in what it prints
expect() {
  local code=$1 text=$2 found; shift 2
  local output; output=$("$@" 2>&1); found=$?
  [[ $found -eq $code && $output == *"$text"* ]] || fail "$* : exit $found (expected $code), expected text '$text' in: $output"
}
is_picture() { [[ $(head -c 4 "$1" 2>/dev/null | tail -c 3) == PNG ]] || fail "$1 is no picture"; }

# 1. no display, one that does not answer, two at once; nothing is said about it
[[ $("$post" picture sample.run -o none.png 2>&1) == "scree-post: wrote none.png" ]] || fail "words other than the picture's"
is_picture none.png
expect 0 "wrote dead.png" env DISPLAY=:4095 "$post" picture sample.run -o dead.png;  is_picture dead.png
cmp -s none.png dead.png || fail "the same frame looks different"
"$post" picture sample.run -o one.png >/dev/null 2>&1 & first=$!
"$post" picture sample.run -o two.png >/dev/null 2>&1 & second=$!
wait $first || fail "the first of two"
wait $second || fail "the second of two"
cmp -s none.png one.png && cmp -s none.png two.png || fail "two at once draw other pictures"
"$mesher" generate box --size "1 m, 1 m, 1 m" -o box.shape.h5 >/dev/null || fail "no box"
expect 0 "wrote refined.png" "$mesher" refine box.shape.h5 -o refined.shape.h5 --times 2 --picture refined.png;  is_picture refined.png
expect 0 "wrote box.png" "$mesher" info box.shape.h5 --picture box.png;  is_picture box.png
expect 2 "a picture" "$mesher" info box.shape.h5 --picture box.jpg
none_left "done"

# 2. a display that answers is used, and no other is started
expect 0 "wrote given.png" "$screen" env PATH=/nowhere "$post" picture sample.run -o given.png;  is_picture given.png
none_left "a display is there"

# 3. Xvfb is missing, or fails with words of its own
expect 4 "install the package xvfb" env PATH=/nowhere "$post" picture sample.run -o x.png
expect 0 "install the package xvfb" env PATH=/nowhere "$post" report sample.run -o report.html
mkdir bin && printf '#!/bin/sh\necho "no room on the disk" >&2\nexit 1\n' >bin/Xvfb && chmod +x bin/Xvfb
expect 4 "no room on the disk" env PATH="$PWD/bin:$PATH" "$post" picture sample.run -o x.png
for command in "simplify --triangles 12" repair; do  # the mesh is written all the same
  read -r -a words <<<"$command"
  expect 0 "no x.png: no X display" env PATH=/nowhere "$mesher" "${words[0]}" box.shape.h5 "${words[@]:1}" -o "${words[0]}.shape.h5" --picture x.png
  [[ -s ${words[0]}.shape.h5 ]] || fail "${words[0]} wrote nothing"
done
[[ ! -e x.png ]] || fail "x.png should not be there"

# 4. the tool ends with an error, or by a signal while it draws
expect 4 "cannot write nowhere/x.png" "$post" picture sample.run -o nowhere/x.png
none_left "an error"
set -m  # else a shell that is no terminal's starts its jobs with SIGINT ignored
for signal in TERM INT KILL ABRT; do
  "$post" picture sample.run -o killed.png --size 4096 4096 --network >/dev/null 2>&1 & tool=$!
  for _ in $(seq 400); do [[ -n $(servers) ]] && break; sleep 0.02; done
  [[ -n $(servers) ]] || fail "$signal: no server was started"
  kill -$signal $tool 2>/dev/null || fail "$signal: the tool had ended before"
  wait $tool 2>/dev/null
  none_left "$signal"
  [[ ! -e killed.png ]] || fail "$signal: a picture is there"
done
# 5. the display of somebody else, which wants a key: no word of it from the libraries that a tool loads
if command -v xauth mcookie >/dev/null; then
  for number in 9 8 7 6 5; do
    [[ -e /tmp/.X11-unix/X$number || -e /tmp/.X$number-lock ]] && continue
    xauth -q -f key add ":$number" . "$(mcookie)" 2>/dev/null
    Xvfb ":$number" -auth "$PWD/key" >/dev/null 2>&1 & other=$!
    for _ in $(seq 100); do [[ -e /tmp/.X11-unix/X$number ]] && break; sleep 0.05; done
    said=$("$make" other.run 2>&1)
    [[ $said != *Authorization* ]] || fail "said of the display of another: $said"
    kill $other; wait $other 2>/dev/null
    break
  done
fi
echo "$failures failures"
[[ $failures -eq 0 ]]
