#!/usr/bin/env python3
"""Damages a run in all ways that come to mind, one input at a time, and has the tools and the Python package read it.

usage: fuzz_runs.py BIN SCRATCH COUNT [SEED]

Tools are run by the servers beside them (tool_server.cpp), which load libraries once. BIN may be a build with sanitizers; it needs all tools,
whichever way they were built, and of each the server: cmake --build --preset asan --target scree-mesher scree_served_post ...
An input is a copy of rich.run, or of loose.run, with values, types, shapes, attributes, keys, cells, rows or bytes of one of its files changed: frames, scene,
checkpoints (whose checksum then refuses most), run.json, frames.hdf.series and tables. A tool may end with 0, 2, 3 or 5: by a signal, an
internal error (1), a fault of the machine (4) or after 300 s (signal 14) it has failed, and so has Python with an exception that is no ScreeError. Input number n
of a seed is always the same: a finding is repeated by COUNT = n:n; one that this does not repeat came of the runs of scree-post before it in the same process.
Ends with 1 when something was found; the run is then kept as SCRATCH/found-N.run. Where HDF5 ends this process itself, the file SCRATCH/input has the number, and
the damaged run is SCRATCH/changed.run.
"""
import faulthandler
import json
import os
import random
import resource
import shutil
import subprocess
import sys
import warnings

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
sys.path.insert(0, os.path.join(HERE, "..", "..", "post", "python"))
import scree  # noqa: E402
from rich_run import MATERIALS, make_rich_run  # noqa: E402

warnings.simplefilter("ignore")
NUMBERS = (0, -1, 1, -5, 2**31 - 1, -2**31, 2**31, 2**53, 2**62, -2**63, 2**63 - 1, 1e-320, 1e308, -1e308, 1e20, float("nan"), float("inf"), -float("inf"), 0.5, 3)
VALUES = (None, True, "", "x", "x" * 70000, [], {}, [1, [2]], {"a": {}}, *NUMBERS)
CELLS = ("", "x", "nan", "inf", "-1", "1e400", "9" * 30, '"', "-0", "0x10", "1 2", "\0", "#")
ALLOWED = (0, 2, 3, 5)
PACK = """
[time]
duration = 0.01
[contact]
margin = "0.4 mm"
surface = "outside"
""" + MATERIALS + """\
[start]
run = "changed_loose.run"
"""


def datasets(file):
    found = []
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    return found


def groups(file):
    found = ["/"]
    file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Group) else None)
    return found


def change_value(rng, file):
    """One element of one dataset, or all of it."""
    data = file[rng.choice(datasets(file))]
    if data.dtype.kind not in "iuf" or data.size == 0:
        return change_text(rng, file)
    values = data[()]
    limits = numpy.iinfo(values.dtype) if values.dtype.kind in "iu" else None
    value = rng.choice(NUMBERS)
    if limits is not None:
        value = int(numpy.clip(value if value == value else 0, limits.min, limits.max))
    flat = values.reshape(-1)
    flat[rng.randrange(flat.size) if rng.random() < 0.8 else slice(None)] = value
    data[...] = values


def change_text(rng, file):
    """A value inside one of the JSON texts."""
    name = rng.choice([n for n in datasets(file) if file[n].dtype.kind == "S" and file[n].shape == ()] or ["provenance"])
    try:
        value = json.loads(file[name][()])
    except ValueError:
        return
    change_json(rng, value)
    del file[name]
    file[name] = numpy.bytes_(json.dumps(value).encode() + b" ")


def change_form(rng, file):
    """Type or shape of a dataset."""
    name = rng.choice(datasets(file))
    old = file[name][()]
    how = rng.randrange(6)
    del file[name]
    if how == 0:
        return
    if how == 1 and isinstance(old, numpy.ndarray):
        file[name] = old[: old.shape[0] // 2] if old.ndim else old
    elif how == 2:
        file[name] = numpy.full(rng.choice((0, 1, 3, 5000)), rng.choice((b"text", 0.5, 7)))
    elif how == 3:
        file.create_group(name)
    elif how == 4 and isinstance(old, numpy.ndarray) and old.dtype.kind in "iuf":
        file[name] = old.astype(rng.choice(("i1", "u1", "<i8", "<u8", "<f4", ">f8")))
    else:
        file[name] = numpy.concatenate([numpy.atleast_1d(old)] * 2)


def change_attribute(rng, file):
    places = [name for name in groups(file) if len(file[name].attrs)]
    attributes = file[rng.choice(places)].attrs
    name = rng.choice(sorted(attributes))
    del attributes[name]
    if rng.random() < 0.9:
        value = rng.choice((b"text", b"", 0.5, 7, numpy.full(6000, 1.5), numpy.full(6000, b"ABCDEFGHIJ"), numpy.zeros((2, 2)), h5py.Empty("<f8"), "variable", *(
            n for n in NUMBERS if -2**63 <= n < 2**63 or isinstance(n, float))))
        attributes.create(name, value)


def change_json(rng, value):
    """One value somewhere in a JSON tree."""
    node = value
    while True:
        if not isinstance(node, (dict, list)) or not node:
            return
        key = rng.choice(sorted(node)) if isinstance(node, dict) else rng.randrange(len(node))
        if isinstance(node[key], (dict, list)) and node[key] and rng.random() < 0.8:
            node = node[key]
            continue
        if rng.random() < 0.2:
            del node[key]
        elif isinstance(node, list) and rng.random() < 0.3:
            node.append(node[key])
        else:
            node[key] = rng.choice(VALUES)
        return


def change_bytes(rng, path):
    with open(path, "rb") as file:
        data = bytearray(file.read())
    if not data:
        return
    if rng.random() < 0.15:
        del data[rng.randrange(len(data)):]
    elif rng.random() < 0.2:
        begin = rng.randrange(len(data))
        data[begin:begin] = data[begin : begin + rng.choice((1, 8, 200))]
    else:
        for _ in range(rng.choice((1, 1, 2, 8))):
            data[rng.randrange(len(data))] = rng.choice((0, 255, rng.randrange(256)))
    with open(path, "wb") as file:
        file.write(data)


def change_table(rng, path):
    with open(path, encoding="utf-8", errors="replace") as file:
        rows = [line.split(",") for line in file.read().splitlines()]
    row = rng.randrange(len(rows))
    how = rng.randrange(4)
    if how == 0:
        rows[row][rng.randrange(len(rows[row]))] = rng.choice(CELLS)
    elif how == 1:
        del rows[row]
    elif how == 2:
        rows[row].append(rng.choice(CELLS))
    else:
        rows.insert(row, rows[rng.randrange(len(rows))])
    with open(path, "w", encoding="utf-8", errors="replace") as file:
        file.write("\n".join(",".join(cells) for cells in rows) + "\n")


def damage(rng, folder):
    """Changes one file of a run; returns its name and what was done."""
    names = sorted(name for name in os.listdir(folder) if not name.endswith("_worn.shape.h5"))
    kinds = {"frame": [n for n in names if n.startswith("frame_")], "scene": ["scene.h5"], "checkpoint": [n for n in names if n.startswith("checkpoint_")],
             "json": [n for n in names if n in ("run.json", "frames.hdf.series")], "table": [n for n in names if n.endswith(".csv")]}
    kind = rng.choice(("frame", "frame", "frame", "scene", "checkpoint", "json", "json", "table"))
    name = rng.choice(kinds[kind])
    path = os.path.join(folder, name)
    if rng.random() < 0.15:
        change_bytes(rng, path)
        return name, "bytes"
    change = rng.choice((change_value, change_value, change_form, change_attribute, change_text))
    try:
        if kind == "json":
            with open(path, encoding="utf-8") as file:
                value = json.load(file)
            change_json(rng, value)
            with open(path, "w", encoding="utf-8") as file:
                file.write(json.dumps(value) if rng.random() < 0.97 else "[" * 100000)
            return name, "value"
        if kind == "table":
            change_table(rng, path)
            return name, "cells"
        with h5py.File(path, "r+") as file:
            change(rng, file)
    except (OSError, ValueError, TypeError, OverflowError, KeyError, IndexError, RuntimeError):
        change_bytes(rng, path)  # it is damaged already, or h5py will not write that
    return name, change.__name__


class Tools:
    """Starts a server for each tool when it is first asked for. A run may have 6 GiB of memory."""
    def __init__(self, binaries):
        self.binaries, self.servers = binaries, {}
        self.environment = {**os.environ, "LD_BIND_NOW": "1",  # else each copy of a process looks up the same symbols again
                            "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}  # else the solver would start its own program again, the server

    def server(self, tool):
        """The running server of a tool and how many requests it may have yet."""
        if tool not in self.servers:
            program = os.path.join(self.binaries, tool.replace("scree-", "scree_served_"))
            with open(program, "rb") as file:
                sanitized = b"__asan_init" in file.read()

            def limits():
                if not sanitized:  # the shadow of all memory needs room
                    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
                resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

            words = [program] + (["--one-process"] if tool == "scree-post" else [])
            self.servers[tool] = [subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, preexec_fn=limits, env=self.environment), 500]
        return self.servers[tool]

    def run(self, words):
        """Exit code of the tool, or minus the signal that ended it, and what it said."""
        tool = words[0]
        server = self.server(tool)
        server[0].stdin.write("\n".join([str(len(words)), os.path.join(self.binaries, tool), *words[1:]]) + "\n")
        server[0].stdin.flush()
        answer = server[0].stdout.readline()
        server[1] -= 1
        code = int(answer) if answer else server[0].wait()  # without an answer the server has ended in the run
        if not answer or server[1] == 0:
            server[0].communicate()
            del self.servers[tool]
        with open("said", encoding="utf-8", errors="replace") as file:
            return code, file.read()


def read_in_python(folder):
    run = scree.open(folder)
    str(run)
    for table in ("log", "ranks"):
        getattr(run, table)
    for frame in run.frames:
        frame.kinetic, frame.measures(), frame.number
        for rows in (frame.bodies, frame.contacts, frame.walls):
            for name in rows.fields():
                getattr(rows, name)
        frame.bodies.mass, frame.bodies.shape_name, frame.bodies.kinetic_energy, frame.bodies.is_particle
        frame.meshes(frame.bodies[:3])
        for wall in frame.walls.id[:2]:
            frame.wall_mesh(int(wall))
    run.provenance, run.case


def reader(rng):
    """Words of a tool that reads changed.run, or changed_loose.run to start with it, or None for the package."""
    post = [["statistics", "changed.run", "-o", "st", "--no-charts", "--jobs", "1"], ["bodies", "changed.run", "-o", "b.csv"], ["contacts", "changed.run", "-o", "c.csv"],
            ["fragments", "changed.run", "-o", "f.csv"], ["vtk", "changed.run", "-o", "v", "--jobs", "1"]]
    choice = rng.random()
    if choice < 0.19:
        return None
    if choice < 0.2:
        return ["scree-post", "bed", "changed.run", "-o", "bed", "--frame", str(rng.choice((-1, 0, 1, 2)))]
    if choice < 0.89:
        return ["scree-post", *rng.choice(post)]
    if choice < 0.9:  # it draws charts: a second
        return ["scree-post", "compare", "rich.run", "changed.run", "-o", "cmp", "--jobs", "1"]
    if choice < 0.901:  # it draws pictures: seconds
        return ["scree-post", "report", "changed.run", "-o", "r.html"]
    if choice < 0.93:  # these three make a copy of the process, of which sanitizers make a slow one
        return ["scree-solver", "changed.run/scene.h5", "--plan"]
    if choice < 0.965:
        return ["scree-decomposer", "pack", "from.toml", "-o", "x.scene.h5"] + (["--set", "start.frame=2"] if rng.random() < 0.5 else [])
    return ["scree-solver", "rich.scene.h5", "-o", "changed.run", "--restart", "latest"]


def main():
    binaries, scratch, count = os.path.abspath(sys.argv[1]), sys.argv[2], sys.argv[3]
    seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
    numbers = range(int(count.split(":")[0]), int(count.split(":")[1]) + 1) if ":" in count else range(int(count))
    known = os.path.join(HERE, "..", "sanitizers", "asan.supp")
    # where each block was allocated costs half of the time; who repeats a finding asks for it with malloc_context_size=30
    os.environ.setdefault("ASAN_OPTIONS", f"detect_leaks=0:max_allocation_size_mb=6144:allocator_may_return_null=1:malloc_context_size=0:quarantine_size_mb=16:suppressions={known}")
    os.environ.setdefault("UBSAN_OPTIONS", "print_stacktrace=1")
    os.makedirs(scratch, exist_ok=True)
    os.chdir(scratch)
    for name in ("rich", "loose"):
        if not os.path.exists(f"{name}.run/run.json"):
            make_rich_run(binaries, ".", bonds=name == "rich", every=0.04)
    with open("from.toml", "w", encoding="utf-8") as file:
        file.write(PACK)
    found, ends, tools = 0, {}, Tools(binaries)
    changed = {}  # of each folder that is damaged the files that are to be restored; nothing of those that are to be copied
    faulthandler.enable()
    for number in numbers:
        with open("input", "w", encoding="utf-8") as file:
            file.write(f"{number}")
        rng = random.Random(f"{seed} {number}")
        words = reader(rng)
        restarts = words is not None and "--restart" in words
        whole, folder = ("loose.run", "changed_loose.run") if words is not None and "from.toml" in words else ("rich.run", "changed.run")
        for name in changed.get(folder, ()):
            shutil.copyfile(f"{whole}/{name}", f"{folder}/{name}")
        if folder not in changed:
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(whole, folder)
        if restarts:
            os.remove(f"{folder}/run.json")
        damages = [damage(rng, folder) for _ in range(rng.choice((1, 1, 1, 2)))]
        what = " and ".join(": ".join(done) for done in damages)
        changed[folder] = [name for name, _ in damages]
        if restarts:
            del changed[folder]
        if words is None:
            try:
                read_in_python(folder)
                end, failed, says = "python: read", False, ""
            except scree.ScreeError as error:
                end, failed, says = "python: refused", False, str(error)
            except Exception as error:  # noqa: BLE001  what must not be
                end, failed, says = f"python: {type(error).__name__}", True, str(error)
        else:
            code, says = tools.run(words)
            end, failed = f"{words[0]} {words[1] if words[0] != 'scree-solver' else words[-1]}: {code}", code not in ALLOWED
        ends[end] = ends.get(end, 0) + 1
        if failed:
            found += 1
            shutil.rmtree(f"found-{number}.run", ignore_errors=True)
            shutil.copytree(folder, f"found-{number}.run")
            print(f"FOUND {number} of seed {seed}: {what}; {end}; {' '.join(words or [])}\n  {says[-400:]}", flush=True)
    print(f"{len(numbers)} inputs, {found} findings")
    for end, times in sorted(ends.items()):
        print(f"  {times:6} {end}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
