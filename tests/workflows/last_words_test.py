#!/usr/bin/env python3
"""The last line of a workflow that fails is the message of the step that failed; exit code, signals, Ctrl-C and live output are Snakemake's.

last_words_test.py WORKFLOWS BIN SCRATCH
"""
import os
import pty
import shutil
import signal
import subprocess
import sys
import time

WORKFLOWS, BIN, SCRATCH = sys.argv[1:4]
sys.path.insert(0, WORKFLOWS)
from run_snakemake import LastErrors, WholeMessages  # noqa: E402

SNAKEFILE = """
rule all:
    input: "a", "b"
rule a:
    output: "a"
    shell: "bash step.sh"
rule b:
    output: "b"
    shell: "touch of_b; sleep 1; echo 'scree-post: note: of b' >&2; touch b"
"""
MPIRUN = "-" * 74 + "\nPrimary job  terminated normally, but 1 process returned\na non-zero exit code. Per user-direction, the job has been aborted.\n"


def write(name, text):
    with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
        file.write(text)


def command(step, snakefile=SNAKEFILE, *words, stream="2"):
    write("Snakefile", snakefile)
    write("step.sh", step)
    for name in ("a", "b"):
        if os.path.exists(os.path.join(SCRATCH, name)):
            os.remove(os.path.join(SCRATCH, name))
    return ["/usr/bin/python3", os.path.join(WORKFLOWS, "run_snakemake.py"), stream, "--snakefile", os.path.join(SCRATCH, "Snakefile"),
            "--directory", SCRATCH, "--cores", "2", *words]


def ends(last, step, *words, code=1, snakefile=SNAKEFILE, stream="2"):
    result = subprocess.run(command(step, snakefile, *words, stream=stream), capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
    lines = result.stderr.splitlines()[-len(last):] if last else []
    assert result.returncode == code and lines == last, (result.returncode, code, last, result.stdout, result.stderr)
    return result


def wait_for(what, is_there, patience=200.0):
    end = time.monotonic() + patience
    while not is_there():
        assert time.monotonic() < end, f"waited {patience} s for {what}"
        time.sleep(0.02)


def read(name):
    with open(os.path.join(SCRATCH, name), encoding="utf-8") as file:
        return file.read()


shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)

# a tool, with words of mpirun and of another step below it
result = ends(["scree-solver: error: drum.toml:14: too soft"],
              f"cat >&2 <<'END'\nscree-solver: warning: of no matter\nscree-solver: error: drum.toml:14: too soft\n{MPIRUN}END\nexit 5\n")
assert result.stderr.count("scree-solver: error") == 2 and "Complete log" in result.stderr, result.stderr   # as it came, and last
# a message of several lines as a whole, without the colours of a terminal, written at once as the tools do: what a shell writes line by
# line may have words of Snakemake in between
write("message", "scree-mesher: \033[31merror:\033[0m two things:\n  one\n  two\n")
ends(["scree-mesher: error: two things:", "  one", "  two"], "cat message >&2; exit 3")
# programs that are not Scree's; no word at all
ends(["ValueError: no such frame"], "/usr/bin/python3 -c 'raise ValueError(\"no such frame\")'")
ends(["workflows/run: error: the step 'a' failed without a message of its own"], "exit 7")
# both steps, each once
ends(["scree-post: error: of b", "scree-mesher: error: of a"], "sleep 3; echo 'scree-mesher: error: of a' >&2; exit 1", "--keep-going",
     snakefile=SNAKEFILE.replace("touch b", "echo 'scree-post: error: of b' >&2; exit 4"))
# a step that is done when it is tried again is no failure, and one that goes well has no last words
assert ends([], "[ -f tried ] || { touch tried; echo 'scree-post: error: once' >&2; exit 4; }; touch a", "--retries", "1", code=0
            ).stderr.count("scree-post: error: once") == 1
assert ends([], "touch a", code=0).stderr.splitlines()[-1].startswith("Complete log")

# wrong words: for Snakemake, in a Snakefile (a dry run, too, whose own output is on stdout), in a step that is written in Python
ends(["snakemake: error: unrecognized arguments: --nonsense"], "", "--nonsense", code=2)
says = 'raise WorkflowError("size=huge: use one of: full, small")\n'
for words, stream in (([], "2"), (["--dry-run"], "1")):
    ends(["workflows/run: error: size=huge: use one of: full, small"], "", *words, snakefile=says, stream=stream)
ends(["workflows/run: error: Missing input files for rule a: output: a affected files: /no/such"], "",
     snakefile=SNAKEFILE.replace('    output: "a"', '    input: "/no/such"\n    output: "a"'))
ends(["workflows/run: error: ValueError: no point"], "",
     snakefile=SNAKEFILE.replace('    shell: "bash step.sh"', '    run:\n        raise WorkflowError("ValueError: no point")'))
assert "bash step.sh" in ends([], "", "--dry-run", "--printshellcmds", code=0, stream="1").stdout

# a job of a queue: its log has the message
write("slurm-17-pack.log", "scree-decomposer: error: of the job\n[Thu Nov 26]\nError in rule pack:\n    jobid: 0\n    output: x\n")
queue = LastErrors(SCRATCH)
for line in ("Error in rule pack:", "    jobid: 3", "    output: x", "", "Error executing rule pack on cluster (jobid: 3, external: 17, jobscript: x.sh)."):
    queue.line(line)
assert queue.text() == "scree-decomposer: error: of the job", queue.text()

# Snakemake writes a message and the end of its last line apart: a step that speaks between them has lines of its own
read_end, write_end = os.pipe()
with os.fdopen(write_end, "w") as sink:
    lines = WholeMessages(sink)
    lines.write("rule a:\n    resources: tmpdir=/tmp")
    os.write(sink.fileno(), b"scree-mesher: error: of a\n")
    lines.write("\n")
    lines.write("the end")
    lines.close()
with os.fdopen(read_end) as source:
    assert source.read() == "scree-mesher: error: of a\nrule a:\n    resources: tmpdir=/tmp\nthe end"

# What a step says is there while it runs, and a step on a terminal sees one, of its size. The step has a trap since bash without one ignores
# SIGINT when the program that it waits for ends by itself at that moment.
slow = "trap 'exit 130' INT; echo first >&2; test -t 2 && stty size <&2 >&2; touch here; while [ ! -f go ]; do sleep 0.02; done; touch a"
with open(os.path.join(SCRATCH, "log"), "w", encoding="utf-8") as log:
    process = subprocess.Popen(command(slow), stdout=log, stderr=log, stdin=subprocess.DEVNULL)
wait_for("the first line of a step that runs", lambda: "\nfirst\n" in read("log"))
write("go", "")
assert process.wait(200) == 0, read("log")


def on_a_terminal(step, act):
    """The code and the output of a run on a terminal of 33 lines of 111, after act(terminal, pid) when both steps are at work.

    A step that Snakemake starts just after Ctrl-C would not know of it, and would have the last word.
    """
    for name in ("here", "go", "of_b"):
        if os.path.exists(os.path.join(SCRATCH, name)):
            os.remove(os.path.join(SCRATCH, name))
    words = command(step)
    pid, terminal = pty.fork()
    if pid == 0:
        subprocess.run(["stty", "rows", "33", "cols", "111"], check=False)
        os.execv(words[0], words)
    wait_for("the steps", lambda: all(os.path.exists(os.path.join(SCRATCH, name)) for name in ("here", "of_b")))
    act(terminal, pid)
    said = b""
    try:
        while some := os.read(terminal, 4096):
            said += some
    except OSError:   # all have gone
        pass
    os.close(terminal)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), said.decode()


code, said = on_a_terminal(slow, lambda terminal, pid: write("go", ""))
assert code == 0 and "33 111" in said and "\x1b[3" in said, (code, said)

# Ctrl-C reaches the steps, SIGTERM lets them end; the last line is that of a step, if it has one
asked = "trap \"echo 'scree-solver: error: interrupted' >&2; touch asked; exit 130\" INT TERM; touch here; while true; do sleep 0.02; done"
code, said = on_a_terminal(asked, lambda terminal, pid: os.write(terminal, b"\x03"))
assert code == 1 and os.path.exists(os.path.join(SCRATCH, "asked")) and said.splitlines()[-1] == "scree-solver: error: interrupted", (code, said)
code, said = on_a_terminal(slow, lambda terminal, pid: os.write(terminal, b"\x03"))
assert code == 1 and said.splitlines()[-1] == "workflows/run: interrupted; the same command goes on from here", (code, said)
code, said = on_a_terminal(slow, lambda terminal, pid: (os.kill(pid, signal.SIGTERM), write("go", "")))
assert code == 1 and "Finished job 1" in said and said.splitlines()[-1].startswith("workflows/run: interrupted"), (code, said)

# killed, it is killed; a step that outlives it can still write
for name in ("here", "go", "a"):
    if os.path.exists(os.path.join(SCRATCH, name)):
        os.remove(os.path.join(SCRATCH, name))
with open(os.path.join(SCRATCH, "log"), "w", encoding="utf-8") as log:
    process = subprocess.Popen(command(slow.replace("touch a", "echo last >&2 && touch outlived")), stdout=log, stderr=log, stdin=subprocess.DEVNULL)
wait_for("the step", lambda: os.path.exists(os.path.join(SCRATCH, "here")))
process.kill()
assert process.wait(200) == -signal.SIGKILL
write("go", "")
wait_for("the step that outlives", lambda: os.path.exists(os.path.join(SCRATCH, "outlived")) and "\nlast\n" in read("log"))

# through the runner, with the tools: a case of a user with a wrong word
write("case.toml", "[time]\nduration = 3\n[[walls]]\nnam = 'floor'\n")
result = subprocess.run([os.path.join(WORKFLOWS, "run"), os.path.join(SCRATCH, "case.toml")], capture_output=True, text=True, check=False,
                        env=dict(os.environ, SCREE_BIN=BIN))
last = result.stderr.splitlines()[-1]
assert result.returncode == 1 and last.startswith("scree-decomposer: error: ") and "nam" in last, (result.returncode, result.stderr)
shutil.rmtree(SCRATCH)
print("all as expected")
