#!/usr/bin/env python3
"""Runs a case, and packs it with all that its runs can be computed again from. usage: make.py FILE.zip LIMIT_MB NAME 2 WORDS FOR SNAKEMAKE...

Called by workflows/run --capsule, with the words that run_snakemake.py would get; Snakemake runs in this process first, so signals and the lock
of the folder are as without a capsule.
"""
import json
import os
import platform
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.dirname(HERE)]
sys.dont_write_bytecode = True
import run_snakemake  # noqa: E402
from archive import Archive, Bad, Entry, write  # noqa: E402
from contents import FORMAT, FORMAT_VERSION, check_capsule, check_crate  # noqa: E402
from crate import METADATA, NO_LICENCE, cited, id_of, metadata, package_of  # noqa: E402
from recipe import Recipe, Refused  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(HERE))
TOOLS = ("scree-mesher", "scree-decomposer", "scree-solver", "scree-post")
# ends of results that are no figure, table or page: they are made again by verify, or are of use only with the frames of the run
NO_RESULTS = (".shape.h5", ".scene.h5", ".toml")


def run_snakemake_first(words):
    try:
        sys.argv = ["run_snakemake.py", *words]
        run_snakemake.main()
    except SystemExit as end:
        if end.code:
            raise


def made_by_snakemake(words):
    """Names of the files that the workflow makes, from its own summary."""
    told = subprocess.run(["snakemake", *words, "--nolock", "--summary"], capture_output=True, text=True)
    if told.returncode != 0:
        raise Refused(f"snakemake --summary ended with {told.returncode}: {told.stderr.strip()[-500:]}")
    rows = [line.split("\t")[0] for line in told.stdout.splitlines()]
    return sorted(set(rows[rows.index("output_file") + 1:]))


def run_folders(out, outputs):
    """Of the runs that the workflow makes; of a study that calls other workflows (calibrate), those in the folder of the results."""
    own = [os.path.dirname(os.path.join(out, name)) for name in outputs if name.endswith(".run/run.json")]
    if own:
        return own
    found = []
    for folder, folders, names in os.walk(out):
        folders[:] = sorted(name for name in folders if name != ".snakemake")
        if folder.endswith(".run") and "run.json" in names:
            with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
                if json.load(file).get("outcome") == "completed":
                    found.append(folder)
    return found


def results(out, outputs):
    return {f"results/{name}": os.path.join(out, name) for name in outputs
            if ".run/" not in name and not name.endswith(NO_RESULTS) and os.path.isfile(os.path.join(out, name))}


def workflow_files(snakefile):
    """The workflow as it stands: what draws the figures. It is there to be read; verify does not run it."""
    folder, own = os.path.dirname(snakefile), {}
    if os.path.basename(snakefile) == "Snakefile":
        for name in sorted(os.listdir(folder)):
            if os.path.isfile(os.path.join(folder, name)):
                own[f"workflow/{os.path.basename(folder)}/{name}"] = os.path.join(folder, name)
    else:
        own[f"workflow/{os.path.basename(snakefile)}"] = snakefile
    own["workflow/pipeline.smk"] = os.path.join(ROOT, "workflows/pipeline.smk")
    return own


def versions():
    told = {tool: subprocess.run([tool, "--version"], capture_output=True, text=True, check=True).stdout.splitlines() for tool in TOOLS}
    system = platform.freedesktop_os_release().get("PRETTY_NAME", "") if hasattr(platform, "freedesktop_os_release") else ""
    snakemake = sys.modules["snakemake"].__version__   # which ran in this process
    return {"tools": told, "system": system, "machine": platform.machine(), "python": platform.python_version(), "snakemake": snakemake}


def licence_and_authors(case):
    """Of the folder of a case of the user, else of Scree: (entity of the licence, authors, files)."""
    folder = os.path.dirname(case) if case else ROOT
    authors, spdx = cited(os.path.join(folder, "CITATION.cff"))
    files = {f"licences/{name}": os.path.join(folder, name) for name in ("LICENSE", "LICENSE.txt", "LICENSE.md", "LICENCE") if os.path.isfile(os.path.join(folder, name))}
    if os.path.isfile(os.path.join(folder, "CITATION.cff")):
        files["CITATION.cff"] = os.path.join(folder, "CITATION.cff")
    texts = [name for name in files if name.startswith("licences/")]
    if spdx:
        entity = {"@id": f"https://spdx.org/licenses/{spdx}", "@type": "CreativeWork", "name": spdx, "description": f"licence {spdx} of case, results and text of this capsule"}
    elif texts:
        entity = {"@id": id_of(texts[0]), "@type": "CreativeWork", "name": os.path.basename(texts[0]), "description": "licence of case, results and text of this capsule"}
    else:
        entity = {"@id": NO_LICENCE, "@type": "CreativeWork", "name": "no licence was given", "description": "Ask the author of the case before you use or pass on these files."}
        print("workflows/run: note: no LICENSE or CITATION.cff in the folder of the case; the capsule has no licence, so others have no right to use it", file=sys.stderr)
    return entity, authors, files


def readme(capsule):
    rows = "\n".join(f"| {run['name']} | {run['bodies']} | {run['steps']} | `{run['state_hash']}` | {run['wall_seconds']:.3g} s |" for run in capsule["runs"])
    left = "".join(f"- `{item['name']}`: {item['bytes']} bytes, sha256 `{item['sha256']}`. {item['how']}\n" for item in capsule["left_out"])
    solver = capsule["versions"]["tools"]["scree-solver"]
    return f"""# {capsule['title']}

This zip file is a capsule of Scree, a toolkit for the discrete element method: cases, meshes, expected results and versions of a simulation. To compute its runs again and
compare the bits of their final states, in a clone of Scree:

    workflows/verify CAPSULE.zip

It was made with `{' '.join(capsule['command'])}`, {solver[0]}, {' '.join(solver[1].split())}, on {capsule['versions']['system']}.

| run | bodies | steps | state hash | run time |
|---|---|---|---|---|
{rows}

- `capsule.json`: the words by which shapes, scenes and runs are made, and the expected state hash of each run
- `cases`, `meshes`: inputs
- `runs`: the record (`run.json`) and the log of each run
- `results`: figures, tables and reports
- `workflow`: the programs that make the figures, to be read
- `licences`: of the case and of meshes from Debian packages
- `ro-crate-metadata.json`: size and sha256 of each file, as RO-Crate 1.1
""" + (f"\nFiles above the size limit are not in the capsule:\n\n{left}" if left else "")


def make(target, limit, name, words):
    snakefile, out = words[words.index("--snakefile") + 1], words[words.index("--directory") + 1]
    outputs = made_by_snakemake(words)
    recipe = Recipe(out)
    for folder in run_folders(out, outputs):
        recipe.run(folder)
    if not recipe.runs:
        raise Refused(f"{name} makes no run of scree-solver in {out}; a capsule needs one")
    case = os.environ["SCREE_CASE"] if os.path.basename(snakefile) == "own_case.smk" else None
    licence, authors, licence_files = licence_and_authors(case)
    files = {**recipe.files, **results(out, outputs), **workflow_files(snakefile), **licence_files}
    beside = os.path.join(os.path.dirname(case), "meshes.toml") if case else ""
    if os.path.isfile(beside):
        files["workflow/meshes.toml"] = beside

    left_out, mesh_licences, meshes = [], {}, []
    for inside in sorted(recipe.files):
        if not inside.startswith("meshes/"):
            continue
        package = package_of(files[inside])
        how = f"Debian package {package[0]} {package[1]}: {files[inside]}" if package else "from the author of the case"
        meshes.append({"name": inside, "from": how, **({"path": files[inside]} if package else {})})
        if package and os.path.isfile(package[2]):
            mesh_licences[inside] = id_of(f"licences/{package[0]}")
            files[f"licences/{package[0]}"] = package[2]
    entries = []
    for inside, path in sorted(files.items()):
        entry = Entry(inside, path)
        if entry.size <= limit or not inside.startswith(("meshes/", "results/")):   # logs show where bits differ
            entries.append(entry)
            continue
        how = next((mesh["from"] for mesh in meshes if mesh["name"] == inside), "A run of the case makes it again.")
        left_out.append({"name": inside, "bytes": entry.size, "sha256": entry.sha256, "how": how, **({"path": path} if how.startswith("Debian") else {})})

    command = ["workflows/run", name, *without_profile(words[words.index("--printshellcmds") + 1:])]
    capsule = {"format": FORMAT, "format_version": FORMAT_VERSION, "title": f"{name.removesuffix('.toml')}: {recipe.runs[-1]['title']}", "command": command, "date": max(recipe.dates),
               "versions": versions(), "meshes": meshes, "shapes": recipe.shapes, "runs": recipe.runs, "left_out": left_out}
    entries.append(Entry("capsule.json", (json.dumps(capsule, indent=1, ensure_ascii=False) + "\n").encode()))
    entries.append(Entry("README.md", readme(capsule).encode()))
    entries.sort(key=lambda entry: entry.name)
    entries.append(Entry(METADATA, metadata(capsule, entries, authors, licence, mesh_licences).encode()))
    part = target + ".part"
    try:
        write(part, entries)
        archive = Archive(part)   # a capsule that verify would refuse is found here
        check_crate(archive)
        check_capsule(archive)
        os.replace(part, target)
    finally:
        if os.path.exists(part):
            os.remove(part)
    return capsule, len(entries)


def without_profile(words):
    words, kept = iter(words), []
    for word in words:
        if word == "--profile":
            next(words, None)
        else:
            kept.append(word)
    return kept


def main():
    target, limit, name, *words = sys.argv[1:]
    run_snakemake_first(words)
    try:
        capsule, count = make(target, round(float(limit) * 1_000_000), name, without_profile(words[1:]))
    except (Refused, Bad) as reason:
        print(f"workflows/run: error: no capsule: {reason}", file=sys.stderr)
        sys.exit(3)
    except OSError as error:
        print(f"workflows/run: error: no capsule: {error.filename or target}: {error.strerror}", file=sys.stderr)
        sys.exit(4)
    if any(run["git_dirty"] for run in capsule["runs"]):
        print("workflows/run: note: the tools were built from changed sources, which the capsule does not have; others may get other bits", file=sys.stderr)
    print(f"{target}: {count} files, {os.path.getsize(target)} bytes, {len(capsule['runs'])} runs; verify it with: workflows/verify {target}", file=sys.stderr)


if __name__ == "__main__":
    main()
