#!/usr/bin/env python3
"""End-to-end tests of scree-solver as a user runs it. usage: run_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from mpi_environment import grace_before_kill  # noqa: E402
from tool_runs import BIN, ENV, MPIEXEC, PILE, SOLVER, Skipped, children, main, make_killed, outcome, physics_of_log, run  # noqa: E402


def same_state_for_any_ranks_and_threads():
    subprocess.run([PILE, "27", "0.2", "pile.scene.h5"], check=True)
    hashes = {}
    for ranks in (1, 2, 3, 4):
        for threads in (1, 2):
            folder = f"r{ranks}t{threads}.run"
            run(ranks, "pile.scene.h5", "-o", folder, threads=threads)
            hashes[folder] = outcome(folder)["state_hash"]
            assert physics_of_log(folder) == physics_of_log("r1t1.run"), f"{folder}: another log than that of one rank"
    run(2, "pile.scene.h5", "-o", "blocking.run", "--halo", "blocking")
    hashes["blocking.run"] = outcome("blocking.run")["state_hash"]
    for width in ("avx2", "sse4", "scalar"):  # docs/reference/validation-plan.md P7: any vector width, with and without fused multiply-add
        run(1, "pile.scene.h5", "-o", f"{width}.run", "--simd", width)
        hashes[f"{width}.run"] = outcome(f"{width}.run")["state_hash"]
    assert len(set(hashes.values())) == 1, hashes
    result = outcome("r1t1.run")
    assert result["max_depth_ratio"] < 1 and result["energy"]["error_relative"] < 0.01, result["energy"]


SERVOS = """
[time]
duration = 0.12
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.ore]
density = 2500
[[pairs]]
between = ["ore", "ore"]
stiffness = "20 kN/m"
restitution = 0.3
[[bodies]]
shape = "ball"
material = "ore"
position = [0, 0, "5 mm"]
[[walls]]
name = "floor"
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "ore"
[[walls]]
name = "lid"
shape = { plane = { point = [0, 0, "12 mm"], normal = [0, 0, -1] } }
material = "ore"
motion = { servo = { direction = [0, 0, -1], force = "1 N", max_speed = "0.1 m/s" } }
[[walls]]
name = "lost"
shape = { plane = { point = [0, 0, "1 m"], normal = [0, 0, -1] } }
material = "ore"
motion = { servo = { direction = [0, 0, 1], force = "1 N", max_speed = "0.5 m/s" } }
"""


def what_walls_did_that_answer_to_force_is_in_the_record():
    with open("servos.toml", "w", encoding="utf-8") as case:
        case.write(SERVOS)
    subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", "servos.toml", "-o", "servos.scene.h5"], check=True, env=ENV, capture_output=True)
    said = run(1, "servos.scene.h5", "-o", "servos.run").stderr
    lid, lost = outcome("servos.run")["drives"]
    assert lid["name"] == "lid" and lid["kind"] == "servo" and lid["note"] is None, lid
    assert abs(lid["force"] + lid["asked"]) < 0.01 and abs(lid["way"] - 2.1e-3) < 1e-5, lid  # on a ball of 10 mm, 50 um deep on both sides
    assert lost["force"] == 0 and abs(lost["way"] - 0.06) < 1e-3 and "touches nothing" in lost["note"], lost
    assert lost["note"] in said, said


# the lower edge of a cube, tilted, falls on the outer upper edge of a box
EDGE_ON_BOX = """
[time]
duration = 0.1
[shapes.cube]
file = "cube.shape.h5"
[materials.ore]
density = 2500
[[pairs]]
between = ["ore", "ore"]
stiffness = "20 kN/m"
restitution = 0.3
[contact]
margin = "0.2 mm"
[[bodies]]
shape = "cube"
material = "ore"
position = ["3.5 mm", 0, "8.2 mm"]
orientation = [0.8923991008, 0.3696438106, 0.2391176184, -0.0990457605]
velocity = [0, 0, -0.3]
lock_rotation = true
[[walls]]
name = "block"
shape = { box = { corners = [["-5 cm", "-5 cm", "-5 cm"], [0, "5 cm", 0]] } }
material = "ore"
"""


def a_body_that_meets_a_box_from_outside_bounces_off_it():
    """The edge of a cube meets that of a box made by a form, which faces inwards."""
    subprocess.run([os.path.join(BIN, "scree-mesher"), "generate", "box", "--size", "10 mm, 10 mm, 10 mm", "-o", "cube.shape.h5"], check=True, env=ENV,
                   capture_output=True)
    with open("edge.toml", "w", encoding="utf-8") as case:
        case.write(EDGE_ON_BOX)
    subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", "edge.toml", "-o", "edge.scene.h5"], check=True, env=ENV, capture_output=True, text=True)
    run(1, "edge.scene.h5", "-o", "edge.run")
    result = outcome("edge.run")
    assert 0.05 < result["max_depth_ratio"] < 1 and result["energy"]["error_relative"] < 0.01, result


POURED = """
[time]
duration = "1 ms"
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.ore]
density = 2500
[[pairs]]
between = ["ore", "ore"]
stiffness = "20 kN/m"
restitution = 0.3
friction = 0.3
[[populations]]
shape = "ball"
material = "ore"
count = 2
method = "settle"
region = { box = [[0, 0, 0], ["11 mm", "11 mm", "4 cm"]] }
[[walls]]
shape = { box_inside = [[0, 0, 0], ["11 mm", "11 mm", "6 cm"]] }
material = "ore"
"""
SPY = """
import os, sys
with open("seen.txt", "w") as file:
    file.write(" ".join(sorted(os.environ)))
os.execv({solver!r}, [{solver!r}, *sys.argv[1:]])
"""


def alone_a_tool_looks_for_no_network_and_its_settings_of_mpi_stay_its_own():
    free = {name: value for name, value in ENV.items() if name not in ("OMPI_MCA_pml", "OMPI_MCA_btl")}
    talking = dict(free, OMPI_MCA_pml_base_verbose="10")

    def said(*words, **settings):
        return subprocess.run(words, env=dict(talking, **settings), capture_output=True, text=True, timeout=60).stderr

    assert "component cm" not in (alone := said(SOLVER, "--version")) and "component ob1 selected" in alone, alone
    assert "component cm" in said(MPIEXEC, "-n", "1", SOLVER, "--version"), "under mpirun all networks are to be looked for"
    assert "component ob1 selected" not in (asked := said(SOLVER, "--version", OMPI_MCA_pml="cm")) and "component cm" in asked, asked
    with open("poured.toml", "w", encoding="utf-8") as case, open("spy.py", "w", encoding="utf-8") as spy:
        case.write(POURED)
        spy.write(SPY.format(solver=SOLVER))
    subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", "poured.toml", "-o", "poured.scene.h5", "--solver", "/usr/bin/python3 " + os.path.abspath("spy.py")],
                   check=True, env=dict(free, OMP_NUM_THREADS="1"), capture_output=True)
    with open("seen.txt", encoding="utf-8") as file:
        seen = file.read().split()
    assert "OMPI_MCA_mpi_yield_when_idle" in seen and not {"OMPI_MCA_pml", "OMPI_MCA_btl"} & set(seen), seen


def a_killed_run_continues_to_the_same_end():
    subprocess.run([PILE, "27", "1.0", "pile.scene.h5"], check=True)
    run(2, "pile.scene.h5", "-o", "whole.run")
    child = subprocess.Popen([MPIEXEC, "-n", "2", SOLVER, "pile.scene.h5", "-o", "killed.run"],
                             # the surviving rank waits for the dead one: mpirun ends it after this many seconds
                             env=dict(ENV, OMP_NUM_THREADS="1", **grace_before_kill(2)),
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.time() + 60
    while not [n for n in (os.listdir("killed.run") if os.path.isdir("killed.run") else []) if n.startswith("checkpoint_")]:
        assert child.poll() is None and time.time() < deadline, "no checkpoint appeared"
        time.sleep(0.005)
    ranks = children(child.pid)
    assert len(ranks) == 2, ranks
    os.kill(ranks[-1], signal.SIGKILL)
    child.wait(timeout=60)
    assert not os.path.exists("killed.run/run.json"), "a killed run must not look complete"
    for name in os.listdir("killed.run"):  # whole files only: every one opens
        if name.endswith((".hdf", ".h5")) and not name.startswith("."):
            subprocess.run(["h5ls", os.path.join("killed.run", name)], check=True, stdout=subprocess.DEVNULL)
    last = max(int(n[len("checkpoint_"):-len(".h5")]) for n in os.listdir("killed.run") if n.startswith("checkpoint_") and n.endswith(".h5"))
    said = run(3, "pile.scene.h5", "-o", "killed.run", "--restart", "latest").stderr
    steps = outcome("killed.run")["steps"]
    assert f"{steps} steps ({steps - last} of them since the restart), " in said, (last, said)
    assert outcome("killed.run")["state_hash"] == outcome("whole.run")["state_hash"]
    with open("killed.run/log.csv") as f, open("whole.run/log.csv") as g:
        assert [l.split(",")[0] for l in f] == [l.split(",")[0] for l in g], "log rows differ"


def a_signal_keeps_a_checkpoint_and_tells_it_in_the_exit_code():
    subprocess.run([PILE, "27", "100", "long.scene.h5"], check=True)
    # To one process; to every rank, as a queueing system does; and to mpirun, which passes SIGUSR1 on at once.
    # (SIGTERM to mpirun itself reaches the ranks only after its own grace period, and its exit code is mpirun's.)
    for number, ranks, to in ((signal.SIGINT, 1, "process"), (signal.SIGTERM, 2, "ranks"), (signal.SIGUSR1, 2, "process")):
        folder = f"stopped{int(number)}.run"
        command = ([MPIEXEC, "-n", str(ranks)] if ranks > 1 else []) + [SOLVER, "long.scene.h5", "-o", folder]
        child = subprocess.Popen(command, env=dict(ENV, OMP_NUM_THREADS="1"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not os.path.exists(f"{folder}/frame_000000.hdf"):
            assert child.poll() is None
            time.sleep(0.02)
        time.sleep(0.3)
        if to == "process":
            child.send_signal(number)
        else:
            for pid in children(child.pid):
                os.kill(pid, number)
        child.wait(timeout=60)
        assert child.returncode == 128 + number, (number, child.returncode)
        result = outcome(folder)
        assert result["outcome"] == "interrupted" and result["exit_code"] == 128 + number, result["outcome"]
        assert [n for n in os.listdir(folder) if n.startswith("checkpoint_")]


def bad_input_is_told_once_with_its_exit_code():
    subprocess.run([PILE, "8", "0.01", "pile.scene.h5"], check=True)
    result = run(2, "missing.scene.h5", expect=3)
    assert result.stderr.count("missing.scene.h5: no such file") == 1, result.stderr
    with open("pile.scene.h5", "rb") as f:
        data = f.read()
    with open("cut.scene.h5", "wb") as f:
        f.write(data[: len(data) // 2])
    assert "truncated" in run(2, "cut.scene.h5", expect=3).stderr
    with open("text.scene.h5", "w") as f:
        f.write("not a scene\n")
    assert "not an HDF5 file" in run(1, "text.scene.h5", expect=3).stderr
    run(1, "pile.scene.h5", "-o", "a.run")
    assert "not empty" in run(2, "pile.scene.h5", "-o", "a.run", expect=2).stderr
    assert "is a file" in run(1, "pile.scene.h5", "-o", "text.scene.h5", expect=2).stderr
    assert "/proc/a.run" in run(2, "pile.scene.h5", "-o", "/proc/a.run", expect=4).stderr
    assert "holds no checkpoint" in run(1, "pile.scene.h5", "-o", "empty.run", "--restart", "latest", expect=3).stderr
    assert run(1, "pile.scene.h5", "--no-such-option", expect=2).stderr
    import h5py
    with h5py.File("pile.scene.h5", "r+") as f:
        f.attrs["format_version"] = 99
    assert "newer" in run(1, "pile.scene.h5", "-o", "b.run", expect=3).stderr


def a_scene_that_one_rank_cannot_read_ends_all_ranks():
    """Each rank reads for itself: a file that is missing, damaged or another one on one machine must not leave the others waiting."""
    subprocess.run([PILE, "8", "0.01", "pile.scene.h5"], check=True)
    subprocess.run([PILE, "8", "0.02", "other.scene.h5"], check=True)
    with open("pile.scene.h5", "rb") as f, open("cut.scene.h5", "wb") as g:
        data = f.read()
        g.write(data[: len(data) // 2])
    for name, words in (("missing.scene.h5", "no such file"), ("cut.scene.h5", "truncated"), ("other.scene.h5", "another file")):
        for rank in (1, 2):
            # a shell chooses: mpirun of Open MPI 5.0.7 (Debian 13) ends by a signal when it is given several programs
            choice = f'[ "$OMPI_COMM_WORLD_RANK" = {rank} ] && exec "$0" {name} --plan; exec "$0" pile.scene.h5 --plan'
            command = [MPIEXEC, "--oversubscribe", "-n", "3", "bash", "-c", choice, SOLVER]
            result = subprocess.run(command, env=dict(ENV, OMP_NUM_THREADS="1"), capture_output=True, text=True, timeout=60)
            assert result.returncode == 3, (name, result.returncode, result.stderr)
            assert words in result.stderr and f"rank {rank}" in result.stderr, result.stderr


def threads_that_are_bound_to_one_core_are_told():
    """mpirun binds each of one or two ranks to one core, and all its threads with it."""
    if os.cpu_count() < 2:
        raise Skipped("needs two cores")
    subprocess.run([PILE, "8", "0.01", "pile.scene.h5"], check=True)
    one = {min(os.sched_getaffinity(0))}
    for threads, bound in (("2", True), ("1", False)):
        environment = {key: value for key, value in dict(ENV, OMP_NUM_THREADS=threads).items() if key not in ("OMP_PROC_BIND", "OMP_PLACES")}
        result = subprocess.run([SOLVER, "pile.scene.h5", "-o", f"bound{threads}.run"], env=environment, capture_output=True, text=True, timeout=60,
                                preexec_fn=lambda: os.sched_setaffinity(0, one))
        assert result.returncode == 0, result.stderr
        assert ("2 threads of a rank share one of the machine's cores" in result.stderr and "--bind-to none" in result.stderr) == bound, result.stderr


def few_bodies_take_one_thread_and_the_same_bits():
    """Threads of few bodies wait for each other more than they compute, for minutes where other processes have the cores."""
    subprocess.run([PILE, "27", "0.05", "pile.scene.h5"], check=True)
    free = {key: value for key, value in ENV.items() if key not in ("OMP_NUM_THREADS", "OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
    for name, environment in (("free", free), ("given", dict(free, OMP_NUM_THREADS="2"))):
        result = subprocess.run([SOLVER, "pile.scene.h5", "-o", f"{name}.run"], env=environment, capture_output=True, text=True, timeout=120)
        assert result.returncode == 0, result.stderr
        assert f"1 ranks x {1 if name == 'free' else 2} threads" in result.stderr, result.stderr
    free_run, given = outcome("free.run"), outcome("given.run")
    assert (free_run["threads"], given["threads"]) == (1, 2), (free_run["threads"], given["threads"])
    assert free_run["state_hash"] == given["state_hash"]
    assert free_run["slowdown"] >= 1, free_run["slowdown"]
    plan = subprocess.run([SOLVER, "pile.scene.h5", "--plan"], env=free, capture_output=True, text=True, timeout=120).stdout
    assert "cores are used" not in plan, plan  # no more cores help
    plan = subprocess.run([SOLVER, "pile.scene.h5", "--plan"], env=dict(free, OMP_NUM_THREADS="2"), capture_output=True, text=True, timeout=120).stdout
    assert "2 cores are used, so few bodies keep 1 busy" in plan, plan


def a_full_disk_is_an_error_and_leaves_no_broken_file():
    if os.geteuid() != 0:
        raise Skipped("mounting a small tmpfs needs root")
    os.mkdir("small")
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", "small"], capture_output=True).returncode != 0:
        raise Skipped("this machine does not allow mounting a tmpfs")
    try:
        subprocess.run([PILE, "64", "0.2", "pile.scene.h5"], check=True)
        result = run(2, "pile.scene.h5", "-o", "small/full.run", expect=4)
        assert "small/full.run" in result.stderr, result.stderr
        for name in os.listdir("small/full.run"):
            if name.endswith((".hdf", ".h5")) and not name.startswith("."):
                subprocess.run(["h5ls", os.path.join("small/full.run", name)], check=True, stdout=subprocess.DEVNULL)
    finally:
        subprocess.run(["umount", "small"], check=True)


def a_run_that_becomes_invalid_stops_all_ranks_and_names_the_contact():
    # a hundred times too soft for its fall; whatever step is the first bad one, no rank may hang in an output
    subprocess.run([PILE, "27", "0.3", "soft.scene.h5", "2", "3000"], check=True)
    for ranks in (1, 2, 4):
        folder = f"soft{ranks}.run"
        result = run(ranks, "soft.scene.h5", "-o", folder, expect=5)
        assert "of their margin" in result.stderr or "intersect" in result.stderr, result.stderr
        told = outcome(folder)
        assert told["outcome"] == "invalid" and told["exit_code"] == 5 and "step " in told["message"], told["message"]


def a_scene_cut_for_other_ranks_is_cut_again_with_a_notice():
    subprocess.run([PILE, "8", "0.02", "pile.scene.h5"], check=True)
    subprocess.run([os.path.join(BIN, "scree-decomposer"), "partition", "pile.scene.h5", "--ranks", "3", "-o", "cut.scene.h5"],
                   env=ENV, check=True, stdout=subprocess.DEVNULL)
    assert "cut for 3 ranks, this run has 2: it is cut again" in run(2, "cut.scene.h5", "-o", "two.run").stderr
    assert "cut again" not in run(3, "cut.scene.h5", "-o", "three.run").stderr
    assert outcome("two.run")["state_hash"] == outcome("three.run")["state_hash"]


def same_state_through_periodic_axes_and_with_removed_bodies():
    """On any number of ranks, with ghosts through the seams, and after a restart."""
    for domain, count in (("periodic", 27), ("drain", 12)):
        scene = f"{domain}.scene.h5"
        subprocess.run([PILE, str(count), "0.1", scene, "1", "3e5", domain], check=True)
        hashes, removed = set(), set()
        for ranks in (1, 2, 3):
            folder = f"{domain}{ranks}.run"
            run(ranks, scene, "-o", folder)
            result = outcome(folder)
            hashes.add(result["state_hash"])
            assert result["lost_bodies"] == 0, result["lost_bodies"]
            if domain == "drain":
                assert result["removed_bodies"] > 2 and result["bodies"] == count - result["removed_bodies"], result["removed_bodies"]
                with open(os.path.join(folder, "removed.csv")) as f:
                    rows = f.read()
                assert len(rows.splitlines()) == 2 + result["removed_bodies"], rows
                removed.add(rows)
        assert len(hashes) == 1, hashes
        assert domain != "drain" or len(removed) == 1, removed
        # from a checkpoint in the middle, on another number of ranks: as if nothing had happened
        folder = f"{domain}1.run"
        make_killed(folder)
        run(2, scene, "-o", folder, "--restart", "latest")
        again = outcome(folder)
        assert again["state_hash"] in hashes, "a restart ends elsewhere"
        assert again["energy"]["error_relative"] == result["energy"]["error_relative"], again["energy"]
        if domain == "drain":
            with open(os.path.join(folder, "removed.csv")) as f:
                assert {f.read()} == removed
            assert again["removed_bodies"] == result["removed_bodies"], again["removed_bodies"]


def same_state_with_quantised_steps():
    """Levels are chosen at the same steps on any number of ranks and after a restart, and every change is told."""
    subprocess.run([PILE, "12", "0.15", "quantised.scene.h5", "1", "3e5", "quantised"], check=True)
    hashes, tables = set(), set()
    for ranks in (1, 2, 3):
        folder = f"quantised{ranks}.run"
        run(ranks, "quantised.scene.h5", "-o", folder)
        hashes.add(outcome(folder)["state_hash"])
        with open(os.path.join(folder, "steps.csv")) as f:
            tables.add(f.read())
    assert len(hashes) == 1, hashes
    assert len(tables) == 1, tables
    rows = [line.split(",") for line in tables.copy().pop().splitlines()[2:]]
    assert rows, "the step never changed"
    base = outcome("quantised1.run")["step_size"]
    for row in rows:
        share = base / float(row[2])
        assert share in (1, 2, 4, 8, 16, 32), row
    folder = "quantised1.run"
    make_killed(folder)
    run(2, "quantised.scene.h5", "-o", folder, "--restart", "latest")
    assert outcome(folder)["state_hash"] in hashes, "a restart ends elsewhere"
    with open(os.path.join(folder, "steps.csv")) as f:
        assert {f.read()} == tables
    assert abs(outcome(folder)["energy"]["error_relative"]) < 0.02, outcome(folder)["energy"]


def a_run_that_stops_at_rest_stops_there_after_a_restart_too():
    """Restarted within the time that bodies have to lie still, and before; on other numbers of ranks."""
    subprocess.run([PILE, "8", "20", "rest.scene.h5", "1", "3e5", "rest"], check=True)
    run(1, "rest.scene.h5", "-o", "whole.run")
    whole = outcome("whole.run")
    assert whole["outcome"] == "completed" and 0.3 < whole["time"] < 10 and whole["came_to_rest"] is True, whole["time"]
    begin = time.time()
    child = subprocess.Popen([SOLVER, "rest.scene.h5", "-o", "early.run"], env=dict(ENV, OMP_NUM_THREADS="1"), stderr=subprocess.DEVNULL)
    while not os.path.exists("early.run/frame_000002.hdf"):
        assert child.poll() is None and time.time() < begin + 60
        time.sleep(0.002)
    child.send_signal(signal.SIGUSR1)
    child.wait(timeout=60)
    if child.returncode == 0:
        print("left out: the run was over before it could be stopped early")
    else:
        run(3, "rest.scene.h5", "-o", "early.run", "--restart", "latest")
    for ranks, folder in ((2, "late2.run"), (3, "late3.run")):
        shutil.copytree("whole.run", folder)
        checkpoints = sorted(n for n in os.listdir(folder) if n.startswith("checkpoint_"))
        at = int(checkpoints[-2][len("checkpoint_"):-len(".h5")])
        make_killed(folder)
        left = (whole["steps"] - at) * whole["step_size"]
        assert 0 < left < 0.1, f"the checkpoint lies {left} s before the end, not within the 0.12 s for which bodies have lain still"
        run(ranks, "rest.scene.h5", "-o", folder, "--restart", "latest")
    for folder in ("early.run", "late2.run", "late3.run"):
        again = outcome(folder)
        for name in ("steps", "time", "state_hash", "outcome", "came_to_rest"):
            assert again[name] == whole[name], (folder, name, again[name], whole[name])
        assert physics_of_log(folder) == physics_of_log("whole.run"), folder
        assert sorted(n for n in os.listdir(folder) if n.startswith("frame_")) == sorted(n for n in os.listdir("whole.run") if n.startswith("frame_"))


def a_run_that_loses_all_bodies_says_so():
    """No body is no body at rest, and its state has a hash like any other."""
    subprocess.run([PILE, "4", "2", "emptied.scene.h5", "1", "3e5", "emptied"], check=True)
    hashes = set()
    for ranks in (1, 2):
        result = run(ranks, "emptied.scene.h5", "-o", f"emptied{ranks}.run")
        assert "no body is left" in result.stderr, result.stderr
        told = outcome(f"emptied{ranks}.run")
        assert told["bodies"] == 0 and told["no_body_left"] is True and told["came_to_rest"] is False, told
        assert told["message"] and told["time"] < 1.9, (told["message"], told["time"])
        hashes.add(told["state_hash"])
    assert len(hashes) == 1 and hashes != {"0" * 32}, hashes


def a_run_that_stops_when_empty_stops_then_on_any_ranks_and_after_a_restart():
    """Four rocks fall one above the other, with 0.5 m/s from the start, through the end of the domain at 0.09 m; a fixed one stays."""
    subprocess.run([PILE, "4", "3", "leaves.scene.h5", "1", "3e5", "leaves"], check=True)
    import h5py
    with h5py.File("leaves.scene.h5") as file:
        highest = sorted(file["bodies/position"][:, 2])[-2]
    last = (-0.5 + (0.25 + 2 * 9.81 * (highest - 0.09)) ** 0.5) / 9.81
    end = 0.03 * math.ceil(last / 0.03)
    assert 0.002 < end - last < 0.028, (last, end)
    told = []
    for ranks in (1, 2):
        result = run(ranks, "leaves.scene.h5", "-o", f"leaves{ranks}.run")
        assert "no body is left that is free to move" in result.stderr, result.stderr
        told.append(outcome(f"leaves{ranks}.run"))
        assert abs(told[-1]["time"] - end) < 1e-3, (told[-1]["time"], end)
        assert told[-1]["bodies"] == 1 and told[-1]["removed_bodies"] == 4 and told[-1]["no_body_left"] is True, told[-1]
    shutil.copytree("leaves1.run", "leaves3.run")
    make_killed("leaves3.run")
    run(3, "leaves.scene.h5", "-o", "leaves3.run", "--restart", "latest")
    told.append(outcome("leaves3.run"))
    for name in ("steps", "time", "state_hash", "message"):
        assert len({str(t[name]) for t in told}) == 1, [t[name] for t in told]


def the_plan_says_what_is_in_and_out():
    subprocess.run([PILE, "8", "0.01", "pile.scene.h5"], check=True)
    text = run(1, "pile.scene.h5", "--plan").stdout
    for piece in ("in   triangles", "out  fluid", "out  halo and migration", "out  driven walls", "bytes per body", "limited by"):
        assert piece in text, text
    assert "in   halo and migration" in run(2, "pile.scene.h5", "--plan").stdout
    assert not os.path.exists("pile.run"), "a plan writes nothing"
    told = {key: value for key, value in re.findall(r"^  (wall time|memory in all|disk|would help) +(.*)$", text, re.M)}
    assert "us a step" in told["wall time"] and "half the stiffness" in told["would help"], text
    assert 5 < float(re.match(r"([\d.]+) MB now", told["memory in all"])[1]) < 500, text
    run(1, "pile.scene.h5", "-o", "pile.run")
    amount, unit = re.match(r"about ([\d.]+) (kB|MB)", told["disk"]).groups()
    used = sum(os.path.getsize(os.path.join("pile.run", name)) for name in os.listdir("pile.run"))
    assert 0.6 < float(amount) * {"kB": 1e3, "MB": 1e6}[unit] / used < 1.6, (told["disk"], used)


TESTS = [same_state_for_any_ranks_and_threads, a_killed_run_continues_to_the_same_end,
         a_signal_keeps_a_checkpoint_and_tells_it_in_the_exit_code, bad_input_is_told_once_with_its_exit_code,
         a_scene_that_one_rank_cannot_read_ends_all_ranks,
         a_full_disk_is_an_error_and_leaves_no_broken_file, a_scene_cut_for_other_ranks_is_cut_again_with_a_notice,
         a_run_that_becomes_invalid_stops_all_ranks_and_names_the_contact,
         same_state_through_periodic_axes_and_with_removed_bodies, same_state_with_quantised_steps,
         a_run_that_stops_at_rest_stops_there_after_a_restart_too, a_run_that_loses_all_bodies_says_so,
         a_run_that_stops_when_empty_stops_then_on_any_ranks_and_after_a_restart,
         what_walls_did_that_answer_to_force_is_in_the_record,
         a_body_that_meets_a_box_from_outside_bounces_off_it, the_plan_says_what_is_in_and_out,
         alone_a_tool_looks_for_no_network_and_its_settings_of_mpi_stay_its_own,
         threads_that_are_bound_to_one_core_are_told, few_bodies_take_one_thread_and_the_same_bits]

main(TESTS)
