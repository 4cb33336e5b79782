#!/usr/bin/env python3
"""Checks, repairs and remeshes meshes from other sources, and writes a page with the outcome of each.

    workflows/corpus/corpus.py OUT [--mesher scree-mesher] [--fetch] [--table docs/results/mesh-corpus.md]

Meshes come from Debian packages that are installed, or, with --fetch, are unpacked under OUT/packages (apt-get download,
dpkg -x: nothing is installed). Each mesh ends as

    certified   as it is
    repaired    by `repair`
    remeshed    by `remesh`, with the distance from the original
    refused     with the reason

and anything else (a crash, a hang, an exit code that means neither) fails the run.
"""
import argparse
import glob
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import time

# package and files (glob)
CORPUS = [
    ("openuniverse-common", "usr/share/openuniverse/3dmodels/*.bmf"),
    ("assimp-testmodels", "usr/share/assimp/models/3DS/fels.3ds"),
    ("assimp-testmodels", "usr/share/assimp/models/3DS/*.3ds"),
    ("assimp-testmodels", "usr/share/assimp/models/Collada/*.dae"),
    ("assimp-testmodels", "usr/share/assimp/models/OBJ/*.obj"),
    ("assimp-testmodels", "usr/share/assimp/models/OFF/*.off"),
    ("assimp-testmodels", "usr/share/assimp/models/PLY/*.ply"),
    ("assimp-testmodels", "usr/share/assimp/models/STL/*.stl"),
    ("glmark2-data", "usr/share/glmark2/models/*.3ds"),
    ("glmark2-data", "usr/share/glmark2/models/*.obj"),
    ("occt-misc", "usr/share/opencascade/data/stl/*.stl"),
    ("netgen-doc", "usr/share/doc/netgen/examples/*.stl*"),
    ("gmsh-doc", "usr/share/doc/gmsh-doc/**/*.stl*"),
    ("gmsh-doc", "usr/share/doc/gmsh/**/*.stl*"),
]
TIME_LIMIT = 180  # [s] a step; the tool's own limit on importers is longer


def find(package, pattern, root):
    for base in ("/", os.path.join(root, package)):
        found = sorted(glob.glob(os.path.join(base, pattern), recursive=True))
        if found:
            return found
    return []


def fetch(package, root):
    folder = os.path.join(root, package)
    if os.path.isdir(folder):
        return
    os.makedirs(folder)
    subprocess.run(["apt-get", "download", package], cwd=folder, check=False, stdout=subprocess.DEVNULL)
    for name in glob.glob(os.path.join(folder, "*.deb")):
        subprocess.run(["dpkg", "-x", name, folder], check=True)
        os.remove(name)


def run(command):
    start = time.monotonic()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
        return done.returncode, done.stdout, done.stderr, time.monotonic() - start
    except subprocess.TimeoutExpired:
        return "hang", "", f"no end within {TIME_LIMIT} s", time.monotonic() - start


def last_error(text):
    lines = [line for line in text.splitlines() if ": error: " in line]
    return lines[-1].split(": error: ", 1)[1] if lines else text.strip()[-200:]


def reason(text, path):
    """The reason without the path and without the advice."""
    text = text.replace(path + ": ", "").split("; what to do:")[0].split(" (after it was")[0]
    return text.replace("cannot be a rigid body: ", "").replace("|", "/").strip()


def certify(mesher, path, out, faults):
    """Outcome, triangles, volume and what was done or what is wrong."""
    shape = os.path.join(out, "result.shape.h5")
    if os.path.exists(shape):
        os.remove(shape)
    code, stdout, stderr, _ = run([mesher, "check", path, "--json", "--unit", "m"])
    if code not in (0, 2, 3):
        faults.append(f"{path}: check ended with {code}: {stderr[-300:]}")
        return "FAULT", 0, "", stderr[-100:]
    found = json.loads(stdout) if stdout.startswith("{") else None
    if code != 0 and found is None:
        return "refused", 0, "", reason(last_error(stderr), path)
    triangles = found["stored"]["triangles"]
    if code == 0:
        return "certified", triangles, f"{found['volume']:.6g}", "; ".join(found["remarks"])
    why = ""
    for word, command in (("repaired", ["repair"]), ("remeshed", ["remesh", "--triangles", "3000"])):
        code, stdout, stderr, _ = run([mesher, command[0], path, "-o", shape, "--unit", "m"] + command[1:])
        if code not in (0, 3):
            faults.append(f"{path}: {command[0]} ended with {code}: {stderr[-300:]}")
            return "FAULT", triangles, "", stderr[-100:]
        if os.path.exists(shape) != (code == 0):
            faults.append(f"{path}: {command[0]} ended with {code}, but a file {'is' if code else 'is not'} there")
        if code != 0:
            why = why or reason(last_error(stderr), path)  # that of the repair: it names what is wrong with the mesh
        else:
            with_volume = [line for line in stdout.splitlines() if ", volume " in line]
            volume = with_volume[-1].rsplit(", volume ", 1)[1].split(" ")[0] if with_volume else ""
            notes = [line.split(": ", 1)[1] for line in stdout.splitlines() if ": " in line and "wrote" not in line][:-1]
            notes = [note for note in notes if "exactly equal" not in note and "centre of mass" not in note]
            # a certificate must hold when the file is read again
            code, _, stderr, _ = run([mesher, "describe", shape])
            if code != 0:
                faults.append(f"{path}: what {command[0]} wrote is refused: {stderr[-300:]}")
            return word, triangles, volume, "; ".join(notes)
    return "refused", triangles, "", why


MEANING = {
    "certified": "accepted as it is",
    "repaired": "accepted after `scree-mesher repair`",
    "remeshed": "accepted after `scree-mesher remesh --triangles 3000`: a new surface around all that the mesh encloses",
    "refused": "no solid could be made; the reasons are below",
    "FAULT": "a crash, a hang or a wrong exit code",
}
FAR = 10  # [% of the extent] a remeshed mesh that is further from its original is named at the top


def page_of(rows):
    """The page: counts and reasons first, all meshes folded below. rows: mesh, package, triangles, outcome, volume, note."""
    counts = {word: sum(row[3] == word for row in rows) for word in MEANING}
    lines = ["# Meshes from other sources", "",
             "Meshes of Debian packages, each checked, repaired or remeshed by `scree-mesher`. Made by",
             "`workflows/corpus/corpus.py OUT --fetch --table docs/results/mesh-corpus.md`.", "", "## Findings", "",
             f"**{summary_of(rows)}.**", "", "| outcome | meshes | meaning |", "|---|---|---|"]
    lines += [f"| {word} | {n} | {MEANING[word]} |" for word, n in counts.items() if n]
    kinds = {}
    for row in rows:
        if row[3] == "refused":
            first = re.split(r"[:;]", row[5])[0]
            kind = re.sub(r" as \.\w+", "", re.sub(r"^\d+ ", "N ", first))
            kinds.setdefault(kind, []).append(row[0])
    if kinds:
        lines += ["", "| reason of refusals | meshes |", "|---|---|"]
        lines += [f"| {kind} | {len(names)}: {', '.join(names)} |" for kind, names in sorted(kinds.items(), key=lambda item: -len(item[1]))]
    far = [(float(found[1]), row[0]) for row in rows if row[3] == "remeshed" and (found := re.search(r"\(([\d.]+) % of its extent\)", row[5]))]
    far = sorted((item for item in far if item[0] > FAR), reverse=True)
    if far:
        lines += ["", f"Inspect a remeshed mesh before use: {len(far)} of them are more than {FAR} % of their extent away from the original,",
                  ", ".join(f"{name} ({share:.0f} %)" for share, name in far) + "."]
    lines += ["", f"<details><summary>All {len(rows)} meshes</summary>", "", "Volumes are in cubic units of the files.", "",
              "| mesh | package | triangles | outcome | volume | what was done, or what is wrong |", "|---|---|---|---|---|---|"]
    for name, package, triangles, outcome, volume, note in rows:
        lines.append(f"| {name} | {package} | {triangles} | {outcome} | {volume} | {note if len(note) <= 330 else note[:327] + '...'} |")
    return "\n".join(lines) + "\n\n</details>\n"


def summary_of(rows):
    counts = {word: sum(row[3] == word for row in rows) for word in MEANING}
    return f"{len(rows)} meshes: " + ", ".join(f"{n} {word}" for word, n in counts.items() if n)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--mesher", default="scree-mesher")
    parser.add_argument("--fetch", action="store_true", help="unpack missing packages under OUT/packages")
    parser.add_argument("--table", help="write the page into this file")
    parser.add_argument("--least", type=int, default=0, help="fail when there are fewer meshes than this")
    options = parser.parse_args()
    root = os.path.join(options.out, "packages")
    os.makedirs(root, exist_ok=True)
    faults, rows, seen = [], [], set()
    begin = time.monotonic()
    for done, (package, pattern) in enumerate(CORPUS):
        if done > 0:
            left = (time.monotonic() - begin) / done * (len(CORPUS) - done)
            print(f"{package}: {done + 1} of {len(CORPUS)} packages, about {left:.0f} s left", file=sys.stderr, flush=True)
        files = find(package, pattern, root)
        if not files and options.fetch:
            fetch(package, root)
            files = find(package, pattern, root)
        for path in files:
            if path in seen:
                continue
            seen.add(path)
            source = path
            if path.endswith(".gz"):
                source = os.path.join(options.out, os.path.basename(path)[:-3])
                with gzip.open(path, "rb") as packed, open(source, "wb") as plain:
                    shutil.copyfileobj(packed, plain)
            start = time.monotonic()
            outcome, triangles, volume, note = certify(options.mesher, source, options.out, faults)
            rows.append((os.path.basename(path), package, triangles, outcome, volume, note))
            print(f"{outcome:<10} {time.monotonic() - start:6.1f} s  {path}", flush=True)
    print(summary_of(rows))
    if options.table:
        with open(options.table, "w", encoding="utf-8") as file:
            file.write(page_of(rows))
    for fault in faults:
        print("FAULT:", fault, file=sys.stderr)
    if len(rows) < options.least:
        faults.append("too few meshes")
        print(f"only {len(rows)} meshes were found, {options.least} expected: run with --fetch", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
