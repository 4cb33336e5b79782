# To be sourced, with the runner, a scratch folder and a log in the variables of these names.

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
