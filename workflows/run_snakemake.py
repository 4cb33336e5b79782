#!/usr/bin/env python3
"""Snakemake, whose last words are those that matter. usage: run_snakemake.py 1|2 WORDS FOR SNAKEMAKE...

All that it and its steps write (to stderr, 2; a dry run writes to stdout, 1) appears at once, as ever. When Snakemake ends with another code
than 0, its own text of a failed step ("Error in rule", the command again, where its log is) stands below the message of the tool that failed;
so this message is written once more, as the last line on stderr. Of several steps that failed each has its own.

Snakemake runs in this process: signals, Ctrl-C, exit code and a kill mean to it what they mean without this file. The copy of the
output is made by a child that no signal but a kill ends. It lives until the last writer has gone, so that a solver that outlives its workflow
does not die of its first message. On a terminal the steps write to a terminal of the same size, and keep colours and progress.
"""
import contextlib
import fcntl
import glob
import os
import pty
import re
import runpy
import select
import shutil
import signal
import socket
import sys
import termios
import threading

COLOURS = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")
TIME = re.compile(r"^\[\w{3} \w{3} +\d+ [\d:]{8} \d{4}\]")   # of Snakemake, which a step may write behind before the line ends
TOOL_ERROR = re.compile(r"\S+: (?:internal )?error: .+")               # as all tools of Scree and argparse say it (core/base/error.hpp)
PROGRAM = re.compile(r"(?!\S+: (?:note|warning):?)[^\s:\[]+: \S.*")    # as most programs do: "cp: cannot ...", the end of a traceback
EXCEPTION = re.compile(r"\w*(?:Error|Exception)(?: in .*)?:")          # of Snakemake or of a Snakefile; the message is in the lines below
FAILED = re.compile(r"Error (?:in|executing) rule ([^\s:]+)(?: on cluster \(jobid: (\d+), external: (\S+?),)?")
SILENT = "workflows/run: error: the step '{}' failed without a message of its own"
MOST_LINES = 8      # of one message
PATIENCE = 5.0      # [s] for the copy of the last lines, on a busy machine
QUIET = 0.05        # [s] without a word: what a terminal had under way has come


class LastErrors:
    """Reads the lines of Snakemake and its steps as they come, and knows the messages of the steps that failed at last."""

    def __init__(self, folder="."):
        self.folder = folder
        self.failed = {}          # job -> message; a step that is tried again and done is none
        self.tool, self.program, self.exception = [], "", []
        self.reading = None       # the message that goes on in indented lines below
        self.step = None          # the rule whose job follows
        self.rules = set()        # that have failed
        self.is_interrupted = False

    def line(self, text):
        text = TIME.sub("", COLOURS.sub("", text.split("\r")[-1]).rstrip())
        job = re.fullmatch(r" +jobid: (\d+)", text)
        if self.step and job:
            self.failed[job[1]] = self.message(self.step)
            self.step = None
        elif done := re.fullmatch(r"Finished job (\d+)\.", text):
            self.failed.pop(done[1], None)
        elif failed := FAILED.match(text):
            self.rules.add(failed[1])
            if failed[3]:
                self.failed[failed[2]] = self.message(failed[1], failed[3])
            else:
                self.step = failed[1]
            self.reading = None
        elif text.startswith(("Terminating processes on user request", "Will exit after finishing currently running jobs")):
            self.is_interrupted = True
        elif EXCEPTION.fullmatch(text):
            self.exception = self.reading = []
        elif self.reading is not None and text and (text[0] == " " or not self.reading) and not text.startswith("  File "):
            if len(self.reading) < MOST_LINES:
                self.reading.append(text if self.reading is self.tool else text.strip())
        elif not text and self.reading is self.tool and self.tool:
            pass   # an empty line of another step may come within the message
        else:
            self.reading = None
            if TOOL_ERROR.fullmatch(text):
                self.tool = self.reading = [text]
            elif PROGRAM.fullmatch(text):
                self.program = text

    def message(self, rule, external=None):
        """Of a step that has failed just now. Messages of other steps that run at the same time are not mistaken for it more than once."""
        if external:   # what the job of a queue said stands in its log (profiles/slurm)
            for path in glob.glob(os.path.join(glob.escape(self.folder), f"slurm-{external}-{glob.escape(rule)}.log")):
                with contextlib.suppress(OSError), open(path, encoding="utf-8", errors="replace") as log:
                    inner = LastErrors(self.folder)
                    for text in log:
                        inner.line(text)
                    return inner.text() or f"workflows/run: error: the step '{rule}' failed; its output is in {path}"
        said = "\n".join(self.tool) or self.program
        self.tool, self.program = [], ""
        return said or SILENT.format(rule)

    def text(self):
        """What to say at the end; empty where Snakemake's own last line is all there is."""
        silent = {SILENT.format(rule) for rule in self.rules}
        said = [text for text in dict.fromkeys(self.failed.values()) if text not in silent]
        if not said and self.exception:   # of a Snakefile, or of a step that is written in it, whose text stands below "Error in rule"
            said = ["workflows/run: error: " + " ".join(self.exception)]
        elif not said and self.is_interrupted:
            said = ["workflows/run: interrupted; the same command goes on from here"]
        return "\n".join(said or list(self.failed.values()))


def copy(source, control, sink, last):
    """Writes what comes from source to sink until no writer is left, and the last errors when control says how Snakemake has ended."""
    for descriptor in map(int, os.listdir("/proc/self/fd")):   # among them the lock of the workflow, which is that of Snakemake alone
        if descriptor > 2 and descriptor not in (source, control, sink):
            with contextlib.suppress(OSError):
                os.close(descriptor)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1):
        signal.signal(number, signal.SIG_IGN)
    rest = b""

    def pass_on():
        nonlocal rest
        try:
            some = os.read(source, 1 << 16)
        except OSError:   # a terminal without writers
            some = b""
        left = memoryview(some)
        with contextlib.suppress(OSError):   # no reader any more
            while left:
                left = left[os.write(sink, left):]
        *lines, rest = (rest + some).split(b"\n")
        for text in lines:
            last.line(text.decode(errors="replace"))
        return bool(some)

    def finish():
        code = os.read(control, 16)   # empty: Snakemake was killed
        if not code:
            return
        while select.select([source], [], [], QUIET)[0] and pass_on():
            pass
        if int(code) != 0 and (text := last.text()):
            os.write(2, (text + "\n").encode(errors="replace"))
        os.write(control, b"said")

    open_ends = [source, control]
    while source in open_ends:
        ready = select.select(open_ends, [], [])[0]
        if source in ready and not pass_on():
            open_ends.remove(source)
        elif source not in ready:
            open_ends.remove(control)
            finish()
    if control in open_ends:
        finish()


class WholeMessages:
    """A stream that passes on what is written to it when a line ends. Snakemake writes a message and the end of its last line apart, and what a step
    says would come between.
    """

    def __init__(self, stream):
        self._stream, self._rest, self._lock = stream, "", threading.Lock()

    def write(self, text):
        with self._lock:
            self._rest += text
            if self._rest.endswith("\n"):
                self._stream.write(self._rest)
                self._stream.flush()
                self._rest = ""
        return len(text)

    def close(self):
        """At the end: what has no end of a line, too."""
        self._stream.write(self._rest)
        self._rest = ""
        self._stream.flush()

    def __getattr__(self, name):
        return getattr(self._stream, name)


def terminal_like(of):
    """Both ends of a terminal of the size of this one that changes nothing on the way."""
    reader, writer = pty.openpty()
    mode = termios.tcgetattr(writer)
    mode[1] &= ~termios.OPOST
    termios.tcsetattr(writer, termios.TCSANOW, mode)
    size = fcntl.ioctl(of, termios.TIOCGWINSZ, b"\0" * 8)
    fcntl.ioctl(writer, termios.TIOCSWINSZ, size)
    return reader, writer


def main():
    captured, words = int(sys.argv[1]), sys.argv[2:]
    snakemake = shutil.which("snakemake")
    if snakemake is None:
        sys.exit("workflows/run: error: there is no snakemake; ./setup installs it")
    folder = words[words.index("--directory") + 1] if "--directory" in words else "."
    reader, writer = terminal_like(captured) if os.isatty(captured) else os.pipe()
    ours, theirs = socket.socketpair()
    shown = os.dup(captured)
    if os.fork() == 0:
        try:
            ours.close()
            copy(reader, theirs.fileno(), shown, LastErrors(folder))
        finally:
            os._exit(0)
    theirs.close()
    os.close(reader)
    os.dup2(writer, captured)
    os.close(writer)
    code = 1
    sys.stderr = errors = WholeMessages(sys.stderr)
    try:
        sys.argv = [snakemake, *words]
        runpy.run_path(snakemake, run_name="__main__")
        code = 0
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    finally:
        with contextlib.suppress(OSError):
            sys.stdout.flush()
            errors.close()
        os.dup2(shown, captured)
        with contextlib.suppress(OSError):
            ours.settimeout(PATIENCE)
            ours.send(str(code).encode())
            ours.recv(16)
    sys.exit(code)


if __name__ == "__main__":
    main()
