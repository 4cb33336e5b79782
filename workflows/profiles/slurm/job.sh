#!/bin/bash
# properties = {properties}
# The script of each step's job. Slurm sends SIGUSR1 to this shell before the time of the job is over (--signal=B:USR1 of the profile), and to
# nothing below it; an untrapped one would end the shell, and with it the job, without a checkpoint. mpirun passes it on to all ranks:
# the solver writes a checkpoint and ends. Steps that start no mpirun go on until they are done or their time is.
# Snakemake fills in what stands in single braces.
below() {{ local child; for child in $(pgrep -P "$1"); do echo "$child"; below "$child"; done; }}
tell_solver() {{
  local process
  for process in $(below $$); do
    if [[ $(cat "/proc/$process/comm" 2>/dev/null) == mpirun ]]; then echo "job: the time is nearly over: asking the solver for a checkpoint" >&2; kill -USR1 "$process"; fi
  done
}}
trap tell_solver USR1
(
{exec_job}
) &
step=$!
code=0
wait "$step" || code=$?
while kill -0 "$step" 2>/dev/null; do code=0; wait "$step" || code=$?; done  # a trapped signal ends wait, not the step
exit "$code"
