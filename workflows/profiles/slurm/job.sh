#!/bin/bash
# properties = {properties}
# The script of each step's job. Slurm sends SIGUSR1 to this shell before the time of the job is over (--signal=B:USR1 of the profile), and to
# nothing below it; an untrapped one would end the shell, and with it the job, without a checkpoint. mpirun passes it on to all ranks:
# the solver writes a checkpoint and ends. Steps that start no mpirun go on until they are done or their time is.
# Snakemake fills in what stands in single braces.
asked=
trap 'asked=yes' USR1
below() {{ local child; for child in $(pgrep -P "$1"); do echo "$child"; below "$child"; done; }}
ask_solver() {{
  local process
  for process in $(below $$); do
    [[ $(cat "/proc/$process/comm" 2>/dev/null) == mpirun ]] || continue
    echo "job: the time is nearly over: asking the solver for a checkpoint" >&2
    kill -USR1 "$process" && return
  done
  return 1
}}

(
{exec_job}
) &
step=$!
while kill -0 "$step" 2>/dev/null; do
  if [[ -z "$asked" ]]; then wait "$step"  # which a signal ends, too
  elif ask_solver; then asked=
  else sleep 1; fi  # the solver is not there yet
done
wait "$step"  # its exit code
