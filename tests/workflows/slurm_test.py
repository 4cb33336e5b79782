#!/usr/bin/env python3
"""Slurm itself: a cluster of one node on this machine takes runs over the ends of their jobs, with the bits of a run without an end.

usage: slurm_test.py ROOT BIN SCRATCH     Exit 77: skipped, Slurm is not installed.

Starts munge, slurmctld and slurmd (Debian's slurm-wlm) with a configuration, keys, ports and folders of their own, and ends them again. Jobs have
two minutes: Slurm asks for the checkpoint up to a minute earlier than it is told to, and looks at the time of jobs only every half a minute.
With less, a job may be asked before its solver runs.
"""
import contextlib
import csv
import getpass
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from mpi_environment import MPI_VARIABLES  # noqa: E402

ROOT, BIN, SCRATCH = (os.path.abspath(word) for word in sys.argv[1:4])
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "scontrol", "snakemake")
PATIENCE = 1800  # s, for a run over all its jobs, also on a busy machine
MINUTES = 2  # of a job
SIGNAL = 40  # s before its end
UNBROKEN = 110  # s of the run without an end: longer than a job has until it is asked to stop
PILE = """\
seed = 3
[time]
duration = "{duration:g} s"
[shapes.rock]
file = "rock.shape.h5"
[materials.chalk]
density = 1500
[[pairs]]
between = ["chalk", "chalk"]
stiffness = "20 kN/m"
restitution = 0.3
friction = 0.4
[contact]
margin = "0.4 mm"
[[populations]]
shape = "rock"
material = "chalk"
count = 60
region = {{ box = [["-17 mm", "-17 mm", "2 mm"], ["17 mm", "17 mm", "100 mm"]] }}
[[walls]]
shape = {{ box_inside = [["-18 mm", "-18 mm", 0], ["18 mm", "18 mm", "200 mm"]] }}
material = "chalk"
[output]
every = "{every:g} s"
contacts = false
"""
CONFIGURATION = """\
ClusterName=scree
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# a job that is requeued may start again when its credential has expired
AuthInfo=socket={folder}/munge/socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmdParameters=config_overrides
# without cgroups, which a container may lack
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=pmix
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=1,sched_min_interval=500000
ReturnToService=2
JobRequeue=1
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""

# of a job that this test may run in, nothing is passed on
ENV = {name: value for name, value in os.environ.items() if not name.startswith(("SLURM_", "PMIX_", "OMPI_COMM", "SBATCH_"))}
ENV.update(PATH=f"{BIN}:{os.environ['PATH']}:/usr/sbin", SCREE_BIN=BIN, OMP_NUM_THREADS="1", OMPI_MCA_btl_vader_single_copy_mechanism="none",
           **MPI_VARIABLES)


def called(*words, cwd=SCRATCH, **options):
    result = subprocess.run([str(word) for word in words], cwd=cwd, env=ENV, capture_output=True, text=True, timeout=PATIENCE, **options)
    assert result.returncode == 0, f"exit {result.returncode} of {' '.join(map(str, words))}\n{result.stdout[-3000:]}\n{result.stderr[-3000:]}"
    return result.stdout


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


@contextlib.contextmanager
def cluster():
    """A cluster of one node; its daemons end with the block."""
    folder = os.path.join(SCRATCH, "cluster")
    for name in ("munge", "state", "spool"):
        os.makedirs(os.path.join(folder, name), mode=0o700)
    key = os.path.join(folder, "munge/key")
    with open(key, "wb") as file:
        file.write(os.urandom(128))
    os.chmod(key, 0o400)
    configuration = os.path.join(folder, "slurm.conf")
    with open(configuration, "w", encoding="utf-8") as file:
        file.write(CONFIGURATION.format(host=socket.gethostname().split(".")[0], ports=free_ports(2), user=getpass.getuser(), folder=folder))
    ENV["SLURM_CONF"] = configuration
    munge = [f"--{name}={folder}/munge/{file}" for name, file in (("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("seed-file", "seed"))]
    daemons = []
    try:
        for words in (["munged", "--foreground", "--force", *munge], ["slurmctld", "-D", "-f", configuration], ["slurmd", "-D", "-f", configuration]):
            with open(os.path.join(folder, words[0] + ".log"), "w", encoding="utf-8") as log:
                daemons.append(subprocess.Popen(words, env=ENV, stdin=subprocess.DEVNULL, stdout=log, stderr=log))
            time.sleep(1)
        deadline = time.monotonic() + 60
        while "idle" not in subprocess.run(["sinfo", "--noheader", "--format=%T"], env=ENV, capture_output=True, text=True).stdout:
            logs = "".join(open(os.path.join(folder, name), encoding="utf-8").read()[-2000:] for name in ("munged.log", "slurmctld.log", "slurmd.log"))
            assert time.monotonic() < deadline and all(one.poll() is None for one in daemons), f"Slurm does not come up\n{logs}"
            time.sleep(0.5)
        yield
    finally:
        subprocess.run(["scancel", f"--user={getpass.getuser()}"], env=ENV, capture_output=True)
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and subprocess.run(["squeue", "--noheader"], env=ENV, capture_output=True, text=True).stdout.strip():
            time.sleep(0.5)
        for one in reversed(daemons):
            one.terminate()
            try:
                one.wait(timeout=20)
            except subprocess.TimeoutExpired:
                one.kill()
                one.wait()


def of_run(folder):
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        return json.load(file)


def hashes(folder):
    """The hash of the state in every row of the log."""
    with open(os.path.join(folder, "log.csv"), encoding="utf-8") as file:
        return {row["step"]: row["state_hash"] for row in csv.DictReader(file) if not row["step"].startswith("#")}


def same_bits(folder, unbroken):
    assert of_run(folder)["outcome"] == "completed", of_run(folder)
    assert of_run(folder)["state_hash"] == of_run(unbroken)["state_hash"], "another state at the end"
    assert hashes(folder) == hashes(unbroken) and len(hashes(folder)) > 10, "other states on the way"
    frames = [sorted(name for name in os.listdir(path) if name.startswith("frame_")) for path in (folder, unbroken)]
    assert frames[0] == frames[1] and len(frames[0]) > 5, frames


def make_unbroken(factor):
    """The case, of a length that this machine takes some time for, and its run without an end."""
    called("scree-mesher", "generate", "rock", "--diameter", "8 mm", "--triangles", "80", "--seed", "1", "--name", "rock", "-o", "rock.shape.h5")

    def run(duration):
        with open(os.path.join(SCRATCH, "pile.toml"), "w", encoding="utf-8") as file:
            file.write(PILE.format(duration=duration, every=duration / 10))
        shutil.rmtree(os.path.join(SCRATCH, "unbroken.run"), ignore_errors=True)
        called("scree-decomposer", "pack", "pile.toml", "-o", "pile.scene.h5", "--ranks", "2")
        started = time.monotonic()
        called("mpirun", "-n", "2", "scree-solver", "pile.scene.h5", "-o", "unbroken.run")
        return time.monotonic() - started

    short = 0.15
    duration = short * factor * UNBROKEN / min(run(short) for _ in range(2))
    taken = run(duration)
    print(f"{duration:.2f} s of the case take {taken:.0f} s without an end", flush=True)


def state(job):
    said = called("scontrol", "--oneliner", "show", "job", job)
    return re.search(r" JobState=(\w+)", said)[1], int(re.search(r" Restarts=(\d+)", said)[1])


def a_job_script_takes_a_run_over_the_ends_of_its_jobs():
    script = called("scree-solver", "pile.scene.h5", "-o", "queued.run", "--print-slurm")
    with open(os.path.join(SCRATCH, "job.sh"), "w", encoding="utf-8") as file:
        file.write(script)
    job = called("sbatch", "--parsable", f"--time={MINUTES}", f"--signal=USR1@{SIGNAL}", "job.sh").strip()
    deadline = time.monotonic() + PATIENCE
    while state(job)[0] not in ("COMPLETED", "FAILED", "TIMEOUT", "CANCELLED", "NODE_FAIL"):
        assert time.monotonic() < deadline, f"still {state(job)} after {PATIENCE} s"
        time.sleep(1)
    with open(os.path.join(SCRATCH, f"queued.{job}.log"), encoding="utf-8") as file:
        log = file.read()
    outcome, requeued = state(job)
    assert outcome == "COMPLETED", f"{outcome}\n{log[-3000:]}"
    checkpoints = log.count("a checkpoint was kept")
    print(f"job script: {requeued} times requeued, {checkpoints} checkpoints asked for", flush=True)
    assert requeued == checkpoints, log[-3000:]
    if requeued:
        same_bits(os.path.join(SCRATCH, "queued.run"), os.path.join(SCRATCH, "unbroken.run"))
    return requeued > 0


def workflows_here():
    """A copy of the workflows with a case of this test, and the profile as a centre would change it."""
    home = os.path.join(SCRATCH, "copy")
    shutil.rmtree(home, ignore_errors=True)
    shutil.copytree(os.path.join(ROOT, "workflows"), os.path.join(home, "workflows"), ignore=shutil.ignore_patterns("out", ".snakemake"))
    for name, text in (("pile", open(os.path.join(SCRATCH, "pile.toml"), encoding="utf-8").read()), ("wrong", "no case at all\n")):
        case = os.path.join(home, "workflows", name)
        os.makedirs(case)
        with open(os.path.join(case, "case.toml"), "w", encoding="utf-8") as file:
            file.write(text)
        with open(os.path.join(case, "Snakefile"), "w", encoding="utf-8") as file:
            file.write("SHAPES = {'rock': \"generate rock --diameter '8 mm' --triangles 80 --seed 1\"}\nRUNS = {'pile': ('case.toml', '')}\n\n"
                       "rule all:\n    input: 'pile.run/run.json'\n\ninclude: '../pipeline.smk'\n")
    profile = os.path.join(home, "our centre")
    shutil.copytree(os.path.join(ROOT, "workflows/profiles/slurm"), profile)
    path = os.path.join(profile, "config.yaml")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for old, new in (("USR1@120", f"USR1@{SIGNAL}"), ("latency-wait: 60", "latency-wait: 5"), ("restart-times: 20", "restart-times: 60")):
        assert old in text, old
        text = text.replace(old, new)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return home, profile


def workflow(home, profile, name, code):
    out = os.path.join(SCRATCH, f"{name} out")
    result = subprocess.run([os.path.join(home, "workflows/run"), name, "--profile", profile, "--out", out, "--config", f"minutes={MINUTES}"],
                            env=ENV, capture_output=True, text=True, timeout=PATIENCE)
    logs = {file: open(os.path.join(out, file), encoding="utf-8").read() for file in sorted(os.listdir(out)) if file.startswith("slurm-")}
    assert result.returncode == code, f"{name}: exit {result.returncode}\n{(result.stdout + result.stderr)[-3000:]}\n{''.join(logs.values())[-3000:]}"
    return out, logs


def a_workflow_does_so_too():
    home, profile = workflows_here()
    out, logs = workflow(home, profile, "pile", 0)
    told = sum("asking the solver for a checkpoint" in log for log in logs.values())
    solves = [log for name, log in logs.items() if name.endswith("-solve.log")]
    print(f"workflow: {len(solves)} jobs of the solver, {told} asked for a checkpoint", flush=True)
    assert told == len(solves) - 1 and sum("a checkpoint was kept" in log for log in solves) == told, "".join(solves)[-3000:]
    if told:
        same_bits(os.path.join(out, "pile.run"), os.path.join(SCRATCH, "unbroken.run"))
    return told > 0


def a_step_that_fails_ends_the_workflow():
    home, profile = workflows_here()
    path = os.path.join(profile, "config.yaml")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace("restart-times: 60", "restart-times: 1"))
    _, logs = workflow(home, profile, "wrong", 1)
    packs = [log for name, log in logs.items() if name.endswith("-pack.log")]
    assert len(packs) == 2 and all("scree-decomposer: error: pile.toml" in log for log in packs), packs


missing = [name for name in NEEDED if not shutil.which(name, path=ENV["PATH"])]
if missing:
    print(f"SKIPPED: no {', '.join(missing)}: run ./setup --developer")
    sys.exit(77)
shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)
with cluster():
    for trial in range(3):  # a machine that has become faster may be through before the first signal: then a longer run is taken
        make_unbroken(3**trial)
        for name in ("queued.run", "pile out"):
            shutil.rmtree(os.path.join(SCRATCH, name), ignore_errors=True)
        if trial == 0:
            a_step_that_fails_ends_the_workflow()
        if a_job_script_takes_a_run_over_the_ends_of_its_jobs() and a_workflow_does_so_too():
            break
    else:
        sys.exit("FAILED: three times, each longer, a run was through before its job was to end: nothing was tested")
shutil.rmtree(SCRATCH)
print("the same bits over the ends of jobs")
