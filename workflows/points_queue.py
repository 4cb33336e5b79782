"""Runs of a case at many points of its keys: a file of points for workflows/run (pipeline.smk), which makes what is missing and nothing twice."""
import contextlib
import json
import os
import re
import shlex
import shutil
import signal
import subprocess

from config_words import snakefile_of, words_of

RUNNER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "run")
GRACE = 20.0   # [s] for the checkpoints of the solvers that are interrupted


class PointsQueue:
    """Calls workflows/run. words: for its --config, those that the case reads; further: its other words."""

    def __init__(self, cores, words=(), further=()):
        self.cores, self.words, self.further = cores, tuple(words), tuple(further)
        self.received = None   # signal that interrupted a call
        self.env = dict(os.environ)
        tool = shutil.which("scree-solver")
        if tool and "SCREE_BIN" not in self.env:
            self.env["SCREE_BIN"] = os.path.dirname(tool)   # built already; not again by each call

    def call(self, case, folder, points, files, seconds=None):
        """Makes the files in the folder; returns the exit code and what was printed.

        points   name of a run -> {"case": a run of the case or None, key: value, ...}: all that were ever asked for, so that none is made again
        seconds  after which it is interrupted; the solvers then write checkpoints, from which the next call goes on. The exit code is then negative
        """
        os.makedirs(folder, exist_ok=True)
        file = os.path.abspath(os.path.join(folder, "points.json"))
        with open(file, "w", encoding="utf-8") as text:
            json.dump(points, text, indent=1)
        known = words_of(snakefile_of(case)).all
        words = [word for word in self.words if word.partition("=")[0] in known]
        command = [RUNNER, case, *files, "--out", folder, "--cores", str(self.cores), "--keep-going", *self.further, "--config", f"points={file}", *words]
        with open(f"{folder}.log", "a+", encoding="utf-8", errors="replace") as log:
            begin = log.tell()
            log.write(f"\n$ {shlex.join(command)}\n")
            log.flush()
                # its own process group: an interrupt then reaches Snakemake and its steps alike, as Ctrl-C on a terminal does
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=self.env, process_group=0)
            before = {number: signal.signal(number, lambda received, _: self._pass_on(process, received)) for number in (signal.SIGTERM, signal.SIGINT)}
            try:
                code = self._wait(process, seconds)
            finally:
                for number, action in before.items():
                    signal.signal(number, action)
            log.seek(begin)
            return code, log.read()

    def _pass_on(self, process, number):
        self.received = number
        self._send(process, number)

    @staticmethod
    def _send(process, number):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, number)

    def _wait(self, process, seconds):
        try:
            return process.wait(seconds)
        except subprocess.TimeoutExpired:
            self._send(process, signal.SIGINT)
        try:
            process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self._send(process, signal.SIGKILL)
            process.wait()
        return -signal.SIGINT


def tool_errors(text):
    """Messages of tools in what workflows/run printed, each once."""
    return list(dict.fromkeys(re.findall(r"^scree-\w+: error: .*$", text, flags=re.M)))


def cannot_begin(text):
    """Why workflows/run did not get to its first step."""
    lines = re.findall(r"^(?:WorkflowError.*|workflows/run: .*|points: .*)$(?:\n(?!File).+)?", text, flags=re.M)
    return " ".join(" ".join(lines).split())


def invalid(folder, name):
    """Message of a run that became invalid; None of one that did not."""
    record = os.path.join(folder, f"{name}.failed.json")
    if not os.path.exists(record):
        return None
    with open(record, encoding="utf-8") as file:
        failed = json.load(file)
    return failed.get("message", "invalid") if failed.get("outcome") == "invalid" else None
