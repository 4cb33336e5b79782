#!/usr/bin/env bash
# What Snakemake asks of a job: running, success or failed. sacct knows of ended jobs too; a moment after submission it
# may know nothing yet.
state=$(sacct --noheader --parsable2 --format=State --jobs "$1" 2>/dev/null | head -n 1)
case "$state" in
  COMPLETED) echo success ;;
  ""|PENDING|CONFIGURING|RUNNING|SUSPENDED|COMPLETING|REQUEUED|RESIZING) echo running ;;
  *) echo failed ;;
esac
