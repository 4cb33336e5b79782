#!/usr/bin/env python3
"""What a run folder holds, and what a restart does with it. usage: folder_test.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time

import h5py
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from tool_runs import BIN, ENV, PILE, command, main, make_killed, outcome, physics_of_log, run  # noqa: E402


def make_pile(bodies, duration, name="pile.scene.h5", *more):
    subprocess.run([PILE, str(bodies), str(duration), name, *more], check=True)


def checkpoints(folder):
    return sorted(n for n in os.listdir(folder) if n.startswith("checkpoint_"))


def contents(folder):
    """Every file with its bytes and its time."""
    found = {}
    for name in os.listdir(folder):
        with open(os.path.join(folder, name), "rb") as f:
            found[name] = (f.read(), os.stat(f.fileno()).st_mtime_ns)
    return found


def change_settings(scene, **changes):
    with h5py.File(scene, "r+") as f:
        settings = json.loads(f["settings"][()])
        settings["settings"].update(changes)
        del f["settings"]
        f.create_dataset("settings", data=np.bytes_(json.dumps(settings)))


def rows_of(path):
    with open(path) as f:
        return [row for row in csv.DictReader(f) if not row["step"].startswith("#")]


def start(*arguments, **env):
    return subprocess.Popen(command(1, *arguments), env=dict(ENV, OMP_NUM_THREADS="1", **env), stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, text=True)


def wait_until(child, happened):
    deadline = time.time() + 60
    while not happened():
        assert child.poll() is None, child.stderr.read()
        assert time.time() < deadline
        time.sleep(0.001)


def a_finished_run_is_left_as_it_is():
    make_pile(8, 0.02)
    run(2, "pile.scene.h5", "-o", "a.run")
    before = contents("a.run")
    last = os.path.join("a.run", checkpoints("a.run")[-1])
    for ranks, word in ((1, "latest"), (2, "auto"), (1, last)):
        told = run(ranks, "pile.scene.h5", "-o", "a.run", "--restart", word).stderr
        assert f"a.run: complete at step {outcome('a.run')['steps']}" in told and "nothing was changed" in told, told
        assert contents("a.run") == before, word


def a_folder_that_is_refused_is_left_as_it_is():
    make_pile(8, 0.02)
    make_pile(9, 0.02, "other.scene.h5")
    run(1, "pile.scene.h5", "-o", "a.run")
    first = os.path.join("a.run", checkpoints("a.run")[0])
    os.mkdir("thesis")
    for name in ("run.json", "chapter1.tex"):
        with open(f"thesis/{name}", "w") as f:
            f.write("years of work\n")
    for folder, scene, restart, code in (("a.run", "other.scene.h5", ["--restart", "latest"], 2), ("a.run", "other.scene.h5", ["--restart", "auto"], 2),
                                         ("a.run", "other.scene.h5", ["--restart", first], 2), ("a.run", "pile.scene.h5", [], 2),
                                         ("thesis", "pile.scene.h5", [], 2), ("thesis", "pile.scene.h5", ["--restart", "auto"], 2),
                                         ("thesis", "pile.scene.h5", ["--restart", "latest"], 2), ("thesis", "pile.scene.h5", ["--restart", first], 2)):
        before = contents(folder)
        told = run(1, scene, "-o", folder, *restart, expect=code).stderr
        assert folder in told and contents(folder) == before, (folder, scene, restart, told)
    # a folder that is not there yet is not made by a run that is refused
    run(2, "other.scene.h5", "-o", "new.run", "--restart", first, expect=3)
    run(2, "pile.scene.h5", "-o", "new.run", "--restart", "latest", expect=3)
    assert not os.path.exists("new.run")


def only_names_that_the_solver_writes_count():
    make_pile(8, 0.05)
    run(1, "pile.scene.h5", "-o", "a.run")
    whole = physics_of_log("a.run")
    names = checkpoints("a.run")
    foreign = {"checkpoint_backup.h5": names[0], "checkpoint_1.h5": names[0], "checkpoint_000000000001_old.h5": names[0],
               "checkpoint_999999999999.h5.bak": names[0], "frame_backup.hdf": "frame_000001.hdf", "frame_9.hdf": "frame_000001.hdf",
               ".notes.tmp": "log.csv", ".log.csv.tmp": "log.csv"}
    for name, source in foreign.items():
        shutil.copy(f"a.run/{source}", f"a.run/{name}")
    shutil.copy("a.run/log.csv", "a.run/.log.csv.4711.tmp")  # what a killed solver leaves
    make = sorted(n for n in os.listdir("a.run") if n.startswith("frame_0"))
    assert "the same" in run(1, "verify", "a.run").stdout
    os.remove("a.run/run.json")
    os.remove(f"a.run/{names[-1]}")
    run(1, "pile.scene.h5", "-o", "a.run", "--restart", "latest")
    inputs = outcome("a.run")["provenance"]["inputs"]
    assert inputs[-1]["path"].endswith(names[0]), inputs[-1]["path"]
    assert physics_of_log("a.run") == whole
    assert sorted(n for n in os.listdir("a.run") if n.startswith("frame_0")) == make
    assert set(foreign) <= set(os.listdir("a.run")), "files of others were removed"
    assert ".log.csv.4711.tmp" not in os.listdir("a.run")
    with open("a.run/frames.hdf.series") as f:
        assert [e["name"] for e in json.load(f)["files"]] == make
    # a copy under another step's name is not that step
    os.remove("a.run/run.json")
    shutil.copy(f"a.run/{names[0]}", "a.run/checkpoint_000000999999.h5")
    told = run(1, "pile.scene.h5", "-o", "a.run", "--restart", "latest").stderr
    assert "as its name does not say" in told, told


def a_second_solver_on_a_folder_is_refused():
    make_pile(8, 100)
    child = start("pile.scene.h5", "-o", "a.run")
    wait_until(child, lambda: os.path.exists("a.run/frame_000000.hdf"))
    told = run(2, "pile.scene.h5", "-o", "a.run", "--restart", "auto", expect=2).stderr
    assert f"another scree-solver is at work in it (process {child.pid} on {socket.gethostname()}" in told, told
    assert child.poll() is None
    child.kill()  # leaves its lock file, and nobody who holds it
    child.wait()
    assert os.path.exists("a.run/.lock")
    child = start("pile.scene.h5", "-o", "a.run", "--restart", "auto")
    with open("a.run/.lock") as f:
        wait_until(child, lambda: str(child.pid) in (f.seek(0), f.read())[1])
    wait_until(child, lambda: os.path.exists("a.run/frame_000000.hdf"))
    child.send_signal(signal.SIGUSR1)
    assert child.wait(timeout=60) == 128 + signal.SIGUSR1
    assert not os.path.exists("a.run/.lock")


def the_list_of_frames_never_names_one_that_is_gone():
    make_pile(27, 1.0)
    run(1, "pile.scene.h5", "-o", "a.run")
    make_killed("a.run")
    child = start("pile.scene.h5", "-o", "a.run", "--restart", "latest")
    wait_until(child, lambda: not os.path.exists("a.run/frame_000010.hdf"))
    wait_until(child, lambda: not os.path.exists("a.run/frame_000009.hdf"))
    child.kill()
    child.wait()
    assert not os.path.exists("a.run/frame_000010.hdf"), "the run was over before it could be killed"
    with open("a.run/frames.hdf.series") as f:
        listed = [e["name"] for e in json.load(f)["files"]]
    assert all(os.path.exists(f"a.run/{name}") for name in listed) and len(listed) >= 9, listed


def a_log_is_on_the_disk_before_the_checkpoint_that_relies_on_it():
    make_pile(8, 0.05, "drain.scene.h5", "1", "3e5", "drain")
    run(1, "drain.scene.h5", "-o", "a.run", env={"LD_PRELOAD": os.path.join(BIN, "libscree_sync_order.so"), "SCREE_SYNC_LOG": os.path.abspath("order")})
    synced, seen = {}, 0
    with open("order") as f:
        for line in f:
            what, size, path = line.rstrip("\n").split(" ", 2)
            name = os.path.basename(path)
            if what == "sync":
                synced[name] = int(size)
            elif name.startswith("checkpoint_"):
                assert synced.get("log.csv") == int(size), f"{name}: {size} bytes of log, {synced.get('log.csv')} of them on the disk"
                assert {"ranks.csv", "removed.csv"} <= set(synced), synced
                seen += 1
    assert seen >= 5, seen


def verify_compares_scenes_far_from_the_origin_in_the_world():
    make_pile(8, 0.02, "far.scene.h5", "1", "3e5", "far")
    run(2, "far.scene.h5", "-o", "far.run")
    said = run(1, "verify", "far.run", "--from", "start").stdout
    assert said.startswith("the same, bit for bit"), said


def the_record_of_a_restarted_run_covers_all_of_it():
    """Stopped in the middle and continued on other ranks; and killed between its last checkpoint and its outcome."""
    make_pile(27, 0.3)
    run(1, "pile.scene.h5", "-o", "whole.run")
    whole = outcome("whole.run")
    physics = ("energy", "critical_step", "critical_contact", "max_depth_ratio", "state_hash", "steps", "mean_imbalance")
    assert whole["critical_step"] and whole["energy"]["elastic_final"] > 0 and whole["energy"]["dissipated"] > 0, whole["energy"]
    child = start("pile.scene.h5", "-o", "parts.run")
    wait_until(child, lambda: os.path.exists("parts.run/frame_000007.hdf"))  # the stiffest contacts have been by then
    child.send_signal(signal.SIGUSR1)
    assert child.wait(timeout=60) == 128 + signal.SIGUSR1
    first = outcome("parts.run")
    assert first["steps"] < whole["steps"]
    run(1, "pile.scene.h5", "-o", "parts.run", "--restart", "latest")
    second = outcome("parts.run")
    for name in physics:
        assert second[name] == whole[name], (name, second[name], whole[name])
    for name in ("wall_seconds", "list_renewals", "peak_rss_bytes"):
        assert second[name] > first[name] or name == "peak_rss_bytes" and second[name] == first[name], (name, first[name], second[name])
    assert all(second["phases"][p] >= first["phases"][p] for p in first["phases"]), (first["phases"], second["phases"])
    times = [float(row["t_contact"]) for row in rows_of("parts.run/log.csv")]
    assert times == sorted(times), "the times in the log begin anew"
    # everything is there but the outcome
    os.remove("parts.run/run.json")
    before = contents("parts.run")
    run(2, "pile.scene.h5", "-o", "parts.run", "--restart", "latest")
    third = outcome("parts.run")
    for name in physics + ("list_renewals", "cuts"):
        assert third[name] == second[name] or name == "list_renewals", (name, third[name], second[name])
    assert third["wall_seconds"] >= second["wall_seconds"] - 1, (third["wall_seconds"], second["wall_seconds"])
    after = contents("parts.run")
    for name in before:
        if name.startswith("frame_") or name == "log.csv":
            assert after[name][0] == before[name][0], f"{name} is another"


def a_checkpoint_of_version_3_is_read():
    """tests/data/checkpoint_v3.h5 is of step 1644 of 2055, from the last solver that wrote this version and two.scene.h5 beside it."""
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")
    old = os.path.join(data, "checkpoint_v3.h5")
    run(2, os.path.join(data, "two.scene.h5"), "-o", "a.run", "--restart", old)
    result = outcome("a.run")
    assert result["steps"] == 2055, result["steps"]
    with h5py.File(old, "r") as f:
        assert result["energy"]["initial_balance"] == f.attrs["energy_reference"]
        assert result["energy"]["kinetic_peak"] >= f.attrs["kinetic_peak"] > 0 and result["energy"]["error_max"] >= f.attrs["energy_error"] > 0
        assert result["max_depth_ratio"] >= f.attrs["max_depth_ratio"] > 0
    # and of the present version, what it goes on with
    with h5py.File(os.path.join("a.run", checkpoints("a.run")[-1]), "r") as f:
        assert f.attrs["format_version"] == 7 and f["record"].attrs["kinetic_peak"] == result["energy"]["kinetic_peak"]


def a_checkpoint_of_version_4_is_read_with_its_springs():
    """tests/data/checkpoint_v4.h5 is of step 513 of 1026, from the last solver that wrote this version and sliding.scene.h5 beside it: bodies in
    contact, whose springs have no normals."""
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")
    old = os.path.join(data, "checkpoint_v4.h5")
    run(1, os.path.join(data, "sliding.scene.h5"), "-o", "sliding.run", "--restart", old)
    assert outcome("sliding.run")["steps"] == 1026
    run(2, os.path.join(data, "sliding.scene.h5"), "-o", "whole.run")
    with h5py.File(old, "r") as f, h5py.File(os.path.join("sliding.run", checkpoints("sliding.run")[-1]), "r") as now, \
            h5py.File(os.path.join("whole.run", checkpoints("whole.run")[-1]), "r") as whole:
        assert "normal" not in f["springs"] and (f["springs/feature"][()] < 3 << 60).sum() == len(now["springs/feature"])
        stiffness, normal = now["springs/stiffness"][()], now["springs/normal"][()]
        # contacts of balls are in world axes since version 6: without a turn and a normal
        pair, turned = (np.stack([now[f"{table}/{name}"][()] for name in ("a", "b", "zone")], axis=1).tolist() for table in ("springs", "turns"))
        has_turn = np.array([p in turned for p in pair])
        assert has_turn.any() and not has_turn.all(), "both kinds of pairs"
        assert abs(np.linalg.norm(normal[has_turn], axis=1) - 1).max() < 1e-12 and not normal[~has_turn].any()
        assert (stiffness < 0).any(), "nothing slides"
        # the step after the restart knows no normals, which turn by less than the margin over the size
        order, same = (np.argsort(file["bodies/id"][()]) for file in (now, whole))
        error = abs(now["bodies/x"][()][order] - whole["bodies/x"][()][same]).max()
        assert error < 1e-9, error


def a_checkpoint_of_version_6_is_read_with_all_that_pairs_remember():
    """tests/data/checkpoint_v6.h5 is from the last solver that kept all of it in one table, of remembering.scene.h5 beside it: cubes and balls that roll
    on each other with liquid bridges. The solver compares the hash of what it has read with that of the file."""
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")
    old = os.path.join(data, "checkpoint_v6.h5")
    run(2, os.path.join(data, "remembering.scene.h5"), "-o", "remembering.run", "--restart", old)
    with h5py.File(old, "r") as f, h5py.File(os.path.join("remembering.run", checkpoints("remembering.run")[0]), "r") as now:
        key = f["springs/feature"][()]
        assert f.attrs["format_version"] == 6
        for table, first, last in (("springs", 0, 3 << 60), ("rolling_springs", 3 << 60, 4 << 60), ("links", 5 << 60, 6 << 60), ("turns", 7 << 60, (8 << 60) - 1)):
            before = ((key >= first) & (key < last)).sum()
            assert before > 0 and len(now[f"{table}/a"]) == before, (table, before, len(now[f"{table}/a"]))


def a_run_keeps_checkpoints_by_the_clock_and_they_change_nothing():
    for name, by_clock in (("clock.scene.h5", True), ("never.scene.h5", False)):
        make_pile(8, 0.2, name)
        change_settings(name, checkpoint_every=0, checkpoint_by_clock=by_clock)
    log = {"LD_PRELOAD": os.path.join(BIN, "libscree_sync_order.so"), "SCREE_SYNC_LOG": os.path.abspath("order")}

    def named():
        with open("order") as f:
            names = [line.rstrip("\n").split(" ", 2) for line in f]
        os.remove("order")
        return [os.path.basename(path) for what, _, path in names if what == "name" and "checkpoint_" in path]

    counts = {}
    for scene, ranks, interval in (("never", 1, "0.02"), ("clock", 1, "0"), ("clock", 1, "0.02"), ("clock", 3, "0.02"), ("clock", 1, "1800")):
        folder = f"{scene}{ranks}_{interval}.run"
        run(ranks, f"{scene}.scene.h5", "-o", folder, "--checkpoint-interval", interval, env=log)
        written = named()
        assert len(written) == len(set(written)), written
        counts[folder] = len(written)
        assert physics_of_log(folder) == physics_of_log("never1_0.02.run"), folder
    assert counts["never1_0.02.run"] == counts["clock1_0.run"] == counts["clock1_1800.run"] == 1, counts
    assert counts["clock1_0.02.run"] > 2 and counts["clock3_0.02.run"] > 2, counts
    make_killed("clock3_0.02.run")
    run(2, "clock.scene.h5", "-o", "clock3_0.02.run", "--restart", "latest")
    assert physics_of_log("clock3_0.02.run") == physics_of_log("never1_0.02.run")


def walls_in_frames_carry_the_forces_of_the_log():
    make_pile(27, 0.2)
    change_settings("pile.scene.h5", step=2e-5)  # so that frames are written at steps at which the log has rows
    run(2, "pile.scene.h5", "-o", "a.run")
    log = {int(row["step"]): row for row in rows_of("a.run/log.csv")}
    compared = 0
    for name in sorted(n for n in os.listdir("a.run") if n.startswith("frame_")):
        with h5py.File(f"a.run/{name}", "r") as f:
            row = log.get(int(f["frame"].attrs["step"]))
            if row is None or f["contacts/depth"].shape[0] == 0:
                continue
            wall = int(f["walls/id"][0])
            for quantity in ("force", "torque"):
                logged = [float(row[f"wall{wall}_{quantity}_{axis}"]) for axis in "xyz"]
                assert list(f[f"walls/{quantity}"][0]) == logged, (name, quantity, list(f[f"walls/{quantity}"][0]), logged)
            compared += any(logged)
    assert compared > 2, compared


TESTS = [a_finished_run_is_left_as_it_is, a_folder_that_is_refused_is_left_as_it_is, only_names_that_the_solver_writes_count,
         a_second_solver_on_a_folder_is_refused, the_list_of_frames_never_names_one_that_is_gone,
         a_log_is_on_the_disk_before_the_checkpoint_that_relies_on_it, verify_compares_scenes_far_from_the_origin_in_the_world,
         the_record_of_a_restarted_run_covers_all_of_it, a_checkpoint_of_version_3_is_read, a_checkpoint_of_version_4_is_read_with_its_springs,
         a_checkpoint_of_version_6_is_read_with_all_that_pairs_remember,
         a_run_keeps_checkpoints_by_the_clock_and_they_change_nothing, walls_in_frames_carry_the_forces_of_the_log]
main(TESTS)
