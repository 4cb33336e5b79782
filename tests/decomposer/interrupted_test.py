#!/usr/bin/env python3
"""A packing that a signal ends leaves no folder and no solver. usage: interrupted_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import os
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, main  # noqa: E402

CASE = """
[time]
duration = "5 ms"
[shapes.ball]
sphere = { radius = "1 mm" }
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = "10 kN/m"
restitution = 0.9
friction = 0
[[populations]]
shape = "ball"
material = "glass"
count = 3000
method = "settle"
region = { box = [[0, 0, 0], ["3 cm", "3 cm", "4 cm"]] }
[[walls]]
shape = { box_inside = [[0, 0, 0], ["3 cm", "3 cm", "20 cm"]] }
material = "glass"
"""


def processes_with(text):
    """Those whose command has it and that have not ended."""
    found = []
    for number in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{number}/cmdline", "rb") as file:
                if text.encode() in file.read():
                    found.append(int(number))
        except OSError:
            continue  # it has ended meanwhile
    return found


def an_interrupted_packing_leaves_nothing_behind():
    with open("case.toml", "w", encoding="utf-8") as file:
        file.write(CASE)
    for number in (signal.SIGINT, signal.SIGTERM):
        temporary = os.path.join(os.getcwd(), f"tmp{int(number)}")
        os.mkdir(temporary)
        tool = subprocess.Popen([os.path.join(BIN, "scree-decomposer"), "pack", "case.toml", "-o", "case.scene.h5"], env={**ENV, "TMPDIR": temporary},
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.time() + 60
        while not processes_with(temporary) and tool.poll() is None and time.time() < deadline:
            time.sleep(0.02)
        assert processes_with(temporary), "no solver has begun within a minute"
        time.sleep(0.3)
        tool.send_signal(number)
        assert tool.wait(60) == -number, tool.returncode
        assert processes_with(temporary) == [], "the solver goes on"
        left = [name for name in os.listdir(temporary) if name.startswith("scree-packing")]
        assert left == [], left
        assert not os.path.exists("case.scene.h5")


if __name__ == "__main__":
    main([an_interrupted_packing_leaves_nothing_behind])
