#!/usr/bin/env python3
"""What goes wrong on a cluster, done on purpose: nothing is lost but the steps since the last checkpoint, and every file is whole
or absent. usage: faults_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import contextlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from mpi_environment import grace_before_kill  # noqa: E402
from tool_runs import BIN, ENV, PILE, SOLVER, children, command, main, make_killed, outcome, physics_of_log, run  # noqa: E402


def make_pile(bodies, duration, name="pile.scene.h5", frames=10):
    """Five checkpoints in `duration`, and so many frames."""
    subprocess.run([PILE, str(bodies), str(duration), name], check=True)
    with h5py.File(name, "r+") as f:
        settings = json.loads(f["settings"][()])
        settings["settings"]["output_every"] = duration / frames
        del f["settings"]
        f.create_dataset("settings", data=np.bytes_(json.dumps(settings)))


def checkpoints(folder):
    return sorted(os.path.join(folder, n) for n in os.listdir(folder) if n.startswith("checkpoint_")) if os.path.isdir(folder) else []


def step_of(path):
    return int(os.path.basename(path)[len("checkpoint_"):-len(".h5")])


def expect_every_file_whole(folder):
    for name in os.listdir(folder):
        if name.startswith("."):
            continue  # under a temporary name: never taken for a file of the run
        path = os.path.join(folder, name)
        if name.endswith((".hdf", ".h5")):
            with h5py.File(path, "r") as f:  # reads every byte of every dataset
                f.visititems(lambda _, item: item[()] if isinstance(item, h5py.Dataset) else None)
        if name.startswith("checkpoint_"):
            with open(path, "rb") as f:
                promised = int(f.read(512).split(b"\n")[1].split()[1])
            assert os.path.getsize(path) == promised, path
        if name == "log.csv":
            with open(path) as f:
                text = f.read()
            lengths = {len(line.split(",")) for line in text.splitlines() if line[:1].isdigit()}
            assert len(lengths) <= 1 and text.endswith("\n"), f"{path}: a row is not whole"


def start(ranks, *arguments, **env):
    return subprocess.Popen(command(ranks, *arguments), env=dict(ENV, OMP_NUM_THREADS="1", **env), stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, text=True)


def wait_for_checkpoint(child, folder, after=-1):
    deadline = time.time() + 120
    while not any(step_of(c) > after for c in checkpoints(folder)):
        assert child.poll() is None, f"ended with {child.returncode}: {child.stderr.read()}"
        assert time.time() < deadline, "no checkpoint appeared"
        time.sleep(0.005)


def rank_processes(child, ranks):
    deadline = time.time() + 60
    while len(children(child.pid)) < ranks:
        assert child.poll() is None and time.time() < deadline
        time.sleep(0.005)
    return children(child.pid)[:ranks]


# ---- killed ranks

def kill_at_random(runs, seed):
    """Each run of three ranks is killed, one rank at a random time, and continued on another number of ranks until it is complete."""
    make_pile(27, 0.15)
    begin = time.time()
    run(3, "pile.scene.h5", "-o", "whole.run")
    usual = time.time() - begin
    limit = 120 + 40 * usual  # a busy machine takes as many times longer, and mpirun has a grace of its own
    whole, random_state, killed = physics_of_log("whole.run"), random.Random(seed), 0
    number = 0
    while killed < runs:  # a run that ends before its time to be killed does not count
        number += 1
        assert number <= 4 * runs, "runs end before they can be killed"
        folder = f"killed{number}.run"
        begin = time.time()
        child = start(3, "pile.scene.h5", "-o", folder, **grace_before_kill(1))
        ranks = rank_processes(child, 3)
        time.sleep(random_state.uniform(0, usual))
        victim = random_state.randrange(3)
        with contextlib.suppress(ProcessLookupError):
            os.kill(ranks[victim], signal.SIGKILL)
        code = child.wait(timeout=limit)
        if code != 0:
            killed += 1
            assert not os.path.exists(f"{folder}/run.json") or outcome(folder)["outcome"] == "completed"
        else:
            usual = time.time() - begin  # of a machine that has more to spare, or less, than when the test began
        if os.path.isdir(folder):
            expect_every_file_whole(folder)
        kept = [step_of(c) for c in checkpoints(folder)]
        told = run(random_state.choice((1, 2, 4)), "pile.scene.h5", "-o", folder, "--restart", "auto", limit=limit)
        assert "damaged" not in told.stderr and "truncated" not in told.stderr, told.stderr
        assert outcome(folder)["outcome"] == "completed"
        assert physics_of_log(folder) == whole, f"run {number} (rank {victim} killed, checkpoints {kept}) is another run"
        assert not [n for n in os.listdir(folder) if n.endswith(".tmp")], "temporary files stay behind"
        shutil.rmtree(folder)
    print(f"{killed} runs of some {usual:.1f} s were killed before their end, {number - killed} were too fast for that; all ended alike")


def killed_ranks_lose_only_the_steps_since_the_last_checkpoint():
    kill_at_random(3, seed=1)


def fifty_killed_ranks():
    kill_at_random(50, seed=2)


# ---- damaged checkpoints

def damaged_checkpoints_are_refused_and_the_one_before_is_used():
    make_pile(8, 0.25)
    run(2, "pile.scene.h5", "-o", "whole.run")
    newest, older = checkpoints("whole.run")[-1], checkpoints("whole.run")[-2]
    with open(newest, "rb") as f:
        good = f.read()
    random_state = random.Random(3)
    places = [0, 30, 511, 512, 520, len(good) - 1] + [random_state.randrange(len(good)) for _ in range(6)]
    damages = [("truncated", good[:n]) for n in (len(good) - 1, len(good) // 2, 600)]
    damages += [("too short", good[:n]) for n in (0, 100)]
    for place in places:  # one bit, anywhere: header of HDF5, names, data, our own lines
        flipped = bytearray(good)
        flipped[place] ^= 1 << random_state.randrange(8)
        damages.append((f"bit flipped at byte {place}", bytes(flipped)))
    for number, (what, data) in enumerate(damages):
        with open(newest, "wb") as f:
            f.write(data)
        refused = run(1, "pile.scene.h5", "-o", "other.run", "--restart", newest, expect=3).stderr
        assert newest in refused and refused.count("error:") == 1, (what, refused)
        assert any(word in refused for word in ("truncated", "damaged", "does not begin")), (what, refused)
        if number % 4 == 0:  # a restart costs a run
            os.remove("whole.run/run.json")  # as a run that was killed
            told = run(1 + number % 3, "pile.scene.h5", "-o", "whole.run", "--restart", "latest").stderr
            assert told.count("warning") == 1 and f"the run goes on from {older}" in told, (what, told)
            with open(newest, "rb") as f:
                again = f.read()
            assert again != data, "the damaged checkpoint is still there"
            assert outcome("whole.run")["outcome"] == "completed"
    for path in (newest, older):
        with open(path, "r+b") as f:
            f.truncate(1000)
    os.remove("whole.run/run.json")
    assert "no older checkpoint is left" in run(2, "pile.scene.h5", "-o", "whole.run", "--restart", "latest", expect=3).stderr


# ---- restart and verify

def a_restart_continues_bit_for_bit_on_any_ranks_and_threads_its_log_included():
    make_pile(27, 0.2)
    run(1, "pile.scene.h5", "-o", "whole.run")
    whole = physics_of_log("whole.run")
    child = start(2, "pile.scene.h5", "-o", "stopped.run")
    wait_for_checkpoint(child, "stopped.run")
    child.send_signal(signal.SIGUSR1)  # at whatever step: mostly not one at which the log has a row
    assert child.wait(timeout=60) == 128 + signal.SIGUSR1
    for ranks, threads in ((1, 1), (3, 1), (2, 2)):
        folder = f"r{ranks}t{threads}.run"
        shutil.copytree("stopped.run", folder)
        run(ranks, "pile.scene.h5", "-o", folder, "--restart", "latest", threads=threads)
        assert physics_of_log(folder) == whole, folder
        assert outcome(folder)["state_hash"] == outcome("whole.run")["state_hash"]
        assert sorted(n for n in os.listdir(folder) if n.startswith("frame")) == sorted(n for n in os.listdir("whole.run") if n.startswith("frame"))


def verify_says_the_same_or_names_step_body_and_field():
    make_pile(27, 0.1)
    run(2, "pile.scene.h5", "-o", "a.run")
    before = {n: os.path.getmtime(os.path.join("a.run", n)) for n in os.listdir("a.run")}
    for ranks, threads, arguments in ((1, 1, ["--from", "start"]), (3, 1, []), (2, 2, ["--from", "start", "--steps", "600"])):
        said = run(ranks, "verify", "a.run", *arguments, threads=threads).stdout
        assert said.startswith("the same, bit for bit") and f"{ranks} ranks x {threads} threads" in said, said
    assert before == {n: os.path.getmtime(os.path.join("a.run", n)) for n in os.listdir("a.run")}, "verify wrote into the run"
    assert "use --steps" in run(1, "verify", "a.run", "--steps", "1", expect=2).stderr
    assert "use --steps" in run(1, "verify", "a.run", "--from", "start", "--steps", "1", expect=2).stderr, "the start alone says nothing of steps"
    # the last bit of one velocity in one frame
    shutil.copytree("a.run", "frame.run")
    with h5py.File("frame.run/frame_000005.hdf", "r+") as f:
        row = list(f["VTKHDF/PointData/id"][:]).index(11)
        v = f["VTKHDF/PointData/velocity"][row]
        v[2] = np.nextafter(v[2], 0)
        f["VTKHDF/PointData/velocity"][row] = v
    said = run(2, "verify", "frame.run", "--from", "start", expect=5).stdout
    assert "not the same" in said and "body 11, velocity" in said and "1 difference;" in said, said
    # another hash in the log: told with the step, and where it was still equal
    shutil.copytree("a.run", "log.run")
    with open("log.run/log.csv") as f:
        lines = f.readlines()
    column = lines[0].rstrip().split(",").index("state_hash")
    cells, earlier = lines[14].split(","), lines[13].split(",")[0]
    cells[column] = "0" * 32
    lines[14] = ",".join(cells)
    with open("log.run/log.csv", "w") as f:
        f.writelines(lines)
    said = run(1, "verify", "log.run", "--from", "start", expect=5).stdout
    assert f"equal until step {earlier}, different at step {cells[0]}" in said, said
    assert "no such" in run(1, "verify", "nothing.run", expect=3).stderr


# ---- full disks

@contextlib.contextmanager
def small_disk(kind, kilobytes):
    """A folder on a small file system, or None where that cannot be mounted."""
    os.mkdir("small")
    if kind == "tmpfs":
        words = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", "small"]
    else:
        with open("image", "wb") as f:
            f.truncate(kilobytes * 1024)
        if shutil.which("mke2fs", path="/sbin:/usr/sbin") is None:
            words = ["false"]
        else:
            subprocess.run(["/sbin/mke2fs", "-q", "-t", kind, "image"], check=True)
            words = ["mount", "-o", "loop", "image", "small"]
    mounted = os.geteuid() == 0 and subprocess.run(words, capture_output=True).returncode == 0
    if not mounted:
        print(f"left out: this machine does not let us mount a small {kind}")
    try:
        yield "small" if mounted else None
    finally:
        if mounted:
            subprocess.run(["umount", "small"], check=True)
        os.rmdir("small")


def expect_stopped_by_disk(child, folder, reason):
    """The run ends with 4, tells the file and the reason once, and what it leaves is whole."""
    told = child.communicate(timeout=120)[1]
    assert child.returncode == 4, (child.returncode, told)
    assert told.count("error:") == 1 and folder in told and reason in told, told
    expect_every_file_whole(folder)
    assert not os.path.exists(f"{folder}/run.json")
    assert not [n for n in os.listdir(folder) if n.endswith(".tmp")], os.listdir(folder)
    return told


def a_full_disk_ends_the_run_with_whole_files_and_the_run_goes_on_with_more_room():
    make_pile(64, 0.05)
    run(2, "pile.scene.h5", "-o", "whole.run")
    size = sum(os.path.getsize(os.path.join("whole.run", n)) for n in os.listdir("whole.run")) // 1024
    for kind in ("tmpfs", "ext2"):  # ext2 cannot reserve space
        with small_disk(kind, size // 2) as folder:
            if folder is None:
                continue
            expect_stopped_by_disk(start(2, "pile.scene.h5", "-o", f"{folder}/full.run"), f"{folder}/full.run", "No space left on device")
            shutil.copytree(f"{folder}/full.run", f"{kind}.run")
        run(2, "pile.scene.h5", "-o", f"{kind}.run", "--restart", "auto")
        assert physics_of_log(f"{kind}.run") == physics_of_log("whole.run")


def no_room_for_a_frame_or_a_checkpoint_is_an_error_with_and_without_reserved_space():
    """The largest size that a process may give a file stands in for the disk: that needs no mount. Set once the run has begun."""
    make_pile(64, 0.2, "frames.scene.h5", frames=10)
    make_pile(64, 0.2, "checkpoints.scene.h5", frames=1)
    for kind, file in (("frames", "frame_000001.hdf"), ("checkpoints", "checkpoint_")):
        for env in ({}, {"LD_PRELOAD": os.path.join(BIN, "libscree_no_fallocate.so")}):
            for ranks in (1, 2, 4):
                folder = f"{kind}{ranks}{len(env)}.run"
                child = start(ranks, f"{kind}.scene.h5", "-o", folder, **env)
                while not os.path.exists(f"{folder}/frame_000000.hdf"):
                    assert child.poll() is None, child.stderr.read()
                    time.sleep(0.002)
                for pid in rank_processes(child, ranks) if ranks > 1 else [child.pid]:
                    resource.prlimit(pid, resource.RLIMIT_FSIZE, (40000, 40000))
                told = expect_stopped_by_disk(child, folder, "File too large")
                assert file in told, told
                assert os.listdir(folder).count("frame_000001.hdf") == 0 and not checkpoints(folder)


def a_disk_that_is_full_for_a_checkpoint_leaves_the_one_before():
    """A small disk is filled by us once a checkpoint is there, so that the next one finds no room."""
    make_pile(64, 0.2, frames=1)
    run(2, "pile.scene.h5", "-o", "whole.run")
    for kind in ("tmpfs", "ext2"):
        with small_disk(kind, 4000) as folder:
            if folder is None:
                continue
            child = start(2, "pile.scene.h5", "-o", f"{folder}/full.run")
            wait_for_checkpoint(child, f"{folder}/full.run")
            with open(f"{folder}/ballast", "wb") as f, contextlib.suppress(OSError):
                # leaves room for the log, so that the checkpoint is what fails
                disk = os.statvfs(folder)
                f.write(b"x" * (disk.f_bfree * disk.f_bsize - 60000))
                f.flush()
            told = expect_stopped_by_disk(child, f"{folder}/full.run", "No space left on device")
            assert "checkpoint_" in told, told
            assert checkpoints(f"{folder}/full.run")
            os.remove(f"{folder}/ballast")
            run(3, "pile.scene.h5", "-o", f"{folder}/full.run", "--restart", "latest")
            assert physics_of_log(f"{folder}/full.run") == physics_of_log("whole.run")


# ---- stalled ranks

def a_stalled_rank_ends_the_run_within_the_limit_and_is_named():
    make_pile(27, 100, "long.scene.h5")
    for stalled_rank in (0, 2):
        folder = f"stalled{stalled_rank}.run"
        child = start(3, "long.scene.h5", "-o", folder, "--stall-limit", "4", **grace_before_kill(1))
        while not os.path.exists(f"{folder}/frame_000000.hdf"):
            assert child.poll() is None, child.stderr.read()
            time.sleep(0.02)
        time.sleep(0.5)
        victim = rank_processes(child, 3)[stalled_rank]
        os.kill(victim, signal.SIGSTOP)
        begin = time.time()
        told = child.communicate(timeout=60)[1]
        took = time.time() - begin
        assert child.returncode == 4, (child.returncode, told)
        assert f"rank {stalled_rank} (process {victim}) does not run" in told and "nothing has moved for 4 s" in told, told
        assert 4 <= took < 14, f"{took:.1f} s"  # limit, a second or two for the lower ranks, and mpirun's own grace
        expect_every_file_whole(folder)
    # suspended as a whole for longer than the limit, and continued: no stall
    child = start(2, "long.scene.h5", "-o", "suspended.run", "--stall-limit", "1")
    while not os.path.exists("suspended.run/frame_000000.hdf"):
        time.sleep(0.02)
    ranks = rank_processes(child, 2)
    for number, pause in ((signal.SIGSTOP, 2.5), (signal.SIGCONT, 1.5)):
        for pid in ranks:
            os.kill(pid, number)
        time.sleep(pause)
    child.send_signal(signal.SIGUSR1)
    assert child.wait(timeout=60) == 128 + signal.SIGUSR1, child.stderr.read()


# ---- jobs

FAKE_SRUN = """#!/bin/bash
# as SLURM would: starts the ranks, and asks them to stop when the time of the job is over: after forty more rows of the log
ranks=$SLURM_NTASKS
while [[ $1 == --* ]]; do shift; done
rows() { cat *.run/log.csv 2>/dev/null | wc -l; }
first=$(rows)
mpirun -n "$ranks" "$@" & child=$!
(while [[ $(rows) -lt $((first + 40)) ]] && kill -0 $child; do sleep 0.02; done; kill -USR1 $child) 2>/dev/null &
wait $child
"""
FAKE_SCONTROL = """#!/bin/bash
[[ $1 == requeue && $2 == 42 ]] && touch requeued
"""


def a_job_requeues_itself_until_the_run_is_complete():
    make_pile(27, 0.3, "a pile's.scene.h5")
    script = run(1, "a pile's.scene.h5", "--print-slurm", threads=2).stdout
    assert "#SBATCH --cpus-per-task=2" in script and "#SBATCH --signal=USR1@" in script and "#SBATCH --requeue" in script, script
    assert "#SBATCH --ntasks=3" in run(3, "a pile's.scene.h5", "--print-slurm").stdout
    with open("job.sh", "w") as f:
        f.write(script)
    subprocess.run(["bash", "-n", "job.sh"], check=True)
    os.mkdir("cluster")
    for name, text in (("srun", FAKE_SRUN), ("scontrol", FAKE_SCONTROL)):
        with open(f"cluster/{name}", "w") as f:
            f.write(text)
        os.chmod(f"cluster/{name}", 0o755)
    env = dict(ENV, PATH=f"{os.getcwd()}/cluster:{BIN}:{os.environ['PATH']}", SLURM_JOB_ID="42", SLURM_NTASKS="2", SLURM_CPUS_PER_TASK="1")
    jobs = 0
    while True:
        jobs += 1
        assert jobs < 20, "the job never ends"
        result = subprocess.run(["bash", "job.sh"], env=env, capture_output=True, text=True, timeout=250)
        if os.path.exists("requeued"):
            os.remove("requeued")
            with open("a pile's.run/checkpoint_backup.h5", "w") as f:
                f.write("a file of the user: it is no checkpoint, and not the newest\n")
            assert result.returncode == 138, result.stderr
            continue
        assert result.returncode == 0, result.stderr
        break
    print(f"{jobs} jobs")
    assert jobs > 1 and outcome("a pile's.run")["outcome"] == "completed"
    assert "the same" in run(2, "verify", "a pile's.run", "--from", "start").stdout
    # a job whose time is over before it gets anywhere must not go round for ever
    with open("cluster/srun", "w") as f:
        f.write("#!/bin/bash\nexit 138\n")
    result = subprocess.run(["bash", "job.sh"], env=env, capture_output=True, text=True)
    assert result.returncode == 4 and "not requeued" in result.stderr and not os.path.exists("requeued")


def restart_auto_starts_what_has_no_checkpoint_and_refuses_other_folders():
    make_pile(8, 0.02)
    os.mkdir("thesis")
    with open("thesis/chapter1.tex", "w") as f:
        f.write("years of work\n")
    assert "is no run" in run(1, "pile.scene.h5", "-o", "thesis", "--restart", "auto", expect=2).stderr
    assert os.listdir("thesis") == ["chapter1.tex"]
    run(1, "pile.scene.h5", "-o", "a.run", "--restart", "auto")
    assert outcome("a.run")["outcome"] == "completed"
    make_killed("a.run", keep=0)
    run(2, "pile.scene.h5", "-o", "a.run", "--restart", "auto")
    assert outcome("a.run")["outcome"] == "completed" and len(checkpoints("a.run")) == 2


TESTS = [killed_ranks_lose_only_the_steps_since_the_last_checkpoint, fifty_killed_ranks,
         damaged_checkpoints_are_refused_and_the_one_before_is_used,
         a_restart_continues_bit_for_bit_on_any_ranks_and_threads_its_log_included,
         verify_says_the_same_or_names_step_body_and_field,
         a_full_disk_ends_the_run_with_whole_files_and_the_run_goes_on_with_more_room,
         no_room_for_a_frame_or_a_checkpoint_is_an_error_with_and_without_reserved_space,
         a_disk_that_is_full_for_a_checkpoint_leaves_the_one_before, a_stalled_rank_ends_the_run_within_the_limit_and_is_named,
         a_job_requeues_itself_until_the_run_is_complete, restart_auto_starts_what_has_no_checkpoint_and_refuses_other_folders]
main(TESTS)
