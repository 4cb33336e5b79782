#!/usr/bin/env python3
"""Runs every command of a page: its ```sh blocks, in order, in one empty folder. usage: commands_test.py PAGE.md BIN SCRATCH"""
import os
import re
import shutil
import subprocess
import sys

PAGE, BIN, SCRATCH = sys.argv[1:4]
shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)
blocks = re.findall(r"^```sh\n(.*?)^```", open(PAGE, encoding="utf-8").read(), flags=re.S | re.M)
assert blocks, f"{PAGE} has no commands"
environment = dict(os.environ, PATH=BIN + os.pathsep + os.environ["PATH"])
for block in blocks:
    result = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=SCRATCH, env=environment, capture_output=True, text=True, timeout=240)
    assert result.returncode == 0, f"{PAGE}: exit {result.returncode} of\n{block}\n{result.stdout}\n{result.stderr}"
# links of the page lead somewhere
for target in re.findall(r"\]\(([^)#:]+)\)", open(PAGE, encoding="utf-8").read()):
    assert os.path.exists(os.path.join(os.path.dirname(PAGE), target)), f"{PAGE}: the link to {target} leads nowhere"
shutil.rmtree(SCRATCH)
print(f"{len(blocks)} blocks of commands ran")
