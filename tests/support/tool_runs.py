"""What the end-to-end tests of scree-solver share. usage of a test: TEST.py BIN_FOLDER MPIEXEC [TEST...]"""
import csv
import glob
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

from mpi_environment import mpi_environment

BIN, MPIEXEC = sys.argv[1], sys.argv[2]
SOLVER, PILE = os.path.join(BIN, "scree-solver"), os.path.join(BIN, "scree_make_pile")
ENV = mpi_environment()


def command(ranks, *arguments):
    return ([MPIEXEC, "-n", str(ranks)] if ranks > 1 else []) + [SOLVER, *arguments]


def run(ranks, *arguments, threads=1, expect=0, env=None, limit=280, **options):
    """limit: in seconds, after which a run counts as hanging."""
    words = command(ranks, *arguments)
    result = subprocess.run(words, env=dict(ENV, OMP_NUM_THREADS=str(threads), **(env or {})), capture_output=True, text=True, timeout=limit,
                            **options)
    assert result.returncode == expect, f"{words}: exit {result.returncode}, expected {expect}\n{result.stdout}\n{result.stderr}"
    return result


def pack(name, text, expect=0):
    """Packs a case into NAME.scene.h5; what was said."""
    with open(name + ".toml", "w", encoding="utf-8") as file:
        file.write(text)
    result = subprocess.run([os.path.join(BIN, "scree-decomposer"), "pack", name + ".toml", "-o", name + ".scene.h5"], env=ENV, capture_output=True,
                            text=True, timeout=200)
    assert result.returncode == expect, f"exit {result.returncode}, expected {expect}\n{result.stderr}"
    return result.stderr


def children(pid):
    found = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat") as f:
                if int(f.read().rsplit(")", 1)[1].split()[1]) == pid:
                    found.append(int(entry))
        except (OSError, ValueError, IndexError):
            continue  # not a process, or gone meanwhile
    return sorted(found)


def outcome(folder):
    with open(os.path.join(folder, "run.json")) as f:
        return json.load(f)


def make_killed(folder, keep=1):
    """Makes a complete run one that was killed after its oldest checkpoints, of which `keep` stay."""
    os.remove(os.path.join(folder, "run.json"))
    for name in sorted(n for n in os.listdir(folder) if n.startswith("checkpoint_"))[keep:]:
        os.remove(os.path.join(folder, name))


MEASURED = ("imbalance", "ghosts", "bytes_sent", "steps_per_second")


def physics_of_log(folder):
    """Every column of log.csv but what is measured or depends on the ranks: times, imbalance, ghosts, bytes."""
    with open(os.path.join(folder, "log.csv")) as f:
        rows = list(csv.reader(f))
    kept = [i for i, name in enumerate(rows[0]) if name not in MEASURED and not name.startswith("t_")]
    names = [rows[0][i] for i in kept]
    assert {"contacts", "max_depth_ratio", "critical_step", "state_hash"} < set(names), names
    return [[row[i] for i in kept] for row in rows]


def column(folder, name):
    """A column of log.csv, as numbers."""
    import numpy
    with open(os.path.join(folder, "log.csv")) as file:
        rows = [line.strip().split(",") for line in file if not line.startswith("#")]
    at = rows[0].index(name)
    return numpy.array([float(row[at]) for row in rows[1:]])


def frames_of(folder, groups):
    """Of each frame: the groups that it has, by GROUP/NAME, where bodies are by id, and what was dissipated."""
    import h5py
    found = []
    for path in sorted(glob.glob(f"{folder}/frame_*.hdf")):
        with h5py.File(path) as file:
            found.append({f"{group}/{name}": file[group][name][()] for group in groups if group in file for name in file[group]})
            found[-1]["x"] = file["VTKHDF/Points"][()][file["VTKHDF/PointData/id"][()].argsort()]
            found[-1]["dissipated"] = file["frame"].attrs["dissipated"]
    return found


def same_frames(a, b, needed, what):
    """Two results of frames_of agree to the bit, and have what is needed."""
    import numpy
    assert len(a) == len(b) > 3, (len(a), len(b))
    for k, (f, g) in enumerate(zip(a, b)):
        assert f.keys() == g.keys() and needed in f
        for name in f:
            assert numpy.array_equal(f[name], g[name]), f"{what}: {name} of frame {k}"


class Skipped(Exception):
    """This machine cannot run the test: its process ends with 77, which CTest counts as skipped."""


def main(tests):
    """Runs the tests named on the command line, or all, each in a folder of its own. An unknown name is an error: nothing passes unrun."""
    known = {t.__name__: t for t in tests}
    chosen = sys.argv[3:] or list(known)
    unknown = [name for name in chosen if name not in known]
    if unknown:
        sys.exit(f"{sys.argv[0]}: no test is called {', '.join(unknown)}; there are {', '.join(known)}")
    for test in (known[name] for name in chosen):
        home, folder = os.getcwd(), tempfile.mkdtemp()
        os.chdir(folder)
        try:
            begin = time.time()
            test()
            print(f"passed {test.__name__} in {time.time() - begin:.1f} s", flush=True)
        except Skipped as reason:
            print(f"skipped {test.__name__}: {reason}", flush=True)
            sys.exit(77)
        finally:
            os.chdir(home)
            shutil.rmtree(folder, ignore_errors=True)
