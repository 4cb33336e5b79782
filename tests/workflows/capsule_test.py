#!/usr/bin/env python3
"""A capsule of small cases: made, made again with the same bytes, verified without the original files, and refused in every damaged or hostile form.

capsule_test.py RUNNER BIN SCRATCH
"""
import copy
import hashlib
import json
import os
import shutil
import stat
import subprocess
import sys
import zipfile

RUNNER, BIN, SCRATCH = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3])
WORKFLOWS = os.path.dirname(RUNNER)
VERIFY = os.path.join(WORKFLOWS, "verify")
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(WORKFLOWS, "capsule"))
from archive import Archive, Bad, Entry, write  # noqa: E402
from contents import check_capsule, check_crate  # noqa: E402

ENVIRONMENT = dict(os.environ, SCREE_BIN=BIN)
HOME = os.path.join(SCRATCH, "the author's {x} \"folder\"")
AWAY = os.path.join(SCRATCH, "elsewhere")
CRATE = "ro-crate-metadata.json"
TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
MATERIALS = """
[materials.rock]
density = 2600
[[pairs]]
between = ["rock", "rock"]
stiffness = "100 kN/m"
friction = 0.5
restitution = 0.3
[[walls]]
shape = { box_inside = [["-9 cm", "-9 cm", "0 cm"], ["9 cm", "9 cm", "30 cm"]] }
material = "rock"
"""
BED = """
title = "two kinds of grains"
[time]
duration = "20 ms"
[shapes.stone]
file = "forms/a stone.shape.h5"
[shapes.cube]
file = "cube.shape.h5"
[[populations]]
shapes = { stone = 0.5, cube = 0.5 }
material = "rock"
count = 6
size = "3 cm"
region = { box = [["-9 cm", "-9 cm", "1 cm"], ["9 cm", "9 cm", "12 cm"]] }
""" + MATERIALS
LATER = """
title = "the same grains a little later"
[time]
duration = "10 ms"
[start]
run = "case.out/case.run"
""" + MATERIALS
CITATION = "cff-version: 1.2.0\ntitle: grains\nlicense: CC-BY-4.0\nauthors:\n  - family-names: Doe\n    given-names: Jane\n    orcid: https://orcid.org/0000-0002-1825-0097\n"


def put(name, text):
    path = os.path.join(HOME, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def command(*words, code, said=""):
    result = subprocess.run(words, capture_output=True, text=True, env=ENVIRONMENT, cwd=SCRATCH)
    text = result.stdout + result.stderr
    assert result.returncode == code and said in text, (words, result.returncode, code, said, text)
    assert "Traceback" not in text, text
    return text


def verified(capsule, *words, code=0, said="", out="out"):
    folder = os.path.join(SCRATCH, out)
    text = command(VERIFY, capsule, "--out", folder, *words, code=code, said=said)
    if code in (2, 3):
        assert not os.path.exists(folder), f"{folder} was made for a capsule that cannot be used"
    shutil.rmtree(folder, ignore_errors=True)
    return text


def contents(capsule):
    with zipfile.ZipFile(capsule) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def repacked(capsule, change):
    """A capsule with other files, whose recorded sizes and hashes agree with them: what a person could make who changes it on purpose."""
    files = contents(capsule)
    change(files)
    if CRATE in files:
        crate = json.loads(files[CRATE])
        for entity in crate["@graph"]:
            name = entity["@id"].replace("%20", " ")
            if name in files and name != CRATE:
                entity["sha256"], entity["contentSize"] = hashlib.sha256(files[name]).hexdigest(), str(len(files[name]))
        files[CRATE] = json.dumps(crate).encode()
    target = os.path.join(SCRATCH, "changed.zip")
    write(target, [Entry(name, content) for name, content in files.items()])
    return target


def with_json(capsule, change):
    def change_file(files):
        value = json.loads(files["capsule.json"])
        change(value)
        files["capsule.json"] = json.dumps(value).encode()
    return repacked(capsule, change_file)


def check_made(capsule):
    files = contents(capsule)   # by zipfile: other programs read a capsule, too
    crate = {entity["@id"]: entity for entity in json.loads(files[CRATE])["@graph"]}
    root = crate["./"]
    assert crate[CRATE]["conformsTo"] == {"@id": "https://w3id.org/ro/crate/1.1"} and crate[CRATE]["about"] == {"@id": "./"} and crate[CRATE]["@type"] == "CreativeWork"
    assert root["@type"] == "Dataset" and root["datePublished"][:2] == "20" and root["name"] and root["description"], root
    assert crate[root["license"]["@id"]]["name"] == "CC-BY-4.0" and crate[root["author"][0]["@id"]] == {"@id": "https://orcid.org/0000-0002-1825-0097", "@type": "Person", "name": "Jane Doe"}
    parts = {part["@id"].replace("%20", " ") for part in root["hasPart"]}
    assert parts == set(files) - {CRATE}, parts ^ set(files)
    for name in parts:
        entity = crate[name.replace(" ", "%20")]
        assert entity["@type"] == "File" and entity["sha256"] == hashlib.sha256(files[name]).hexdigest() and entity["contentSize"] == str(len(files[name])), entity
    references = [value for entity in crate.values() for values in entity.values() for value in (values if isinstance(values, list) else [values]) if isinstance(value, dict)]
    assert all(set(value) == {"@id"} and (value["@id"] in crate or value["@id"].startswith("https://w3id.org/")) for value in references), references
    assert {"cases/case.toml", "cases/later.toml", "meshes/a stone.off", "results/later.bodies.csv", "runs/case/run.json", "runs/later/log.csv", "CITATION.cff"} <= set(files), sorted(files)
    capsule = json.loads(files["capsule.json"])
    with open(os.path.join(HOME, "later.out/later.run/run.json"), encoding="utf-8") as file:
        assert capsule["runs"][-1]["state_hash"] == json.load(file)["state_hash"]
    assert [run["name"] for run in capsule["runs"]] == ["case", "later"] and capsule["runs"][1]["start"] == "case", capsule["runs"]
    assert ["import", {"file": "meshes/a stone.off"}, "--name", "a stone"] in [shape["made_by"] for shape in capsule["shapes"]], capsule["shapes"]
    assert HOME not in files["capsule.json"].decode(), "the capsule asks for paths of the machine on which it was made"


def checked(path):
    """As verify does before it unpacks anything: the message, empty if nothing is wrong."""
    try:
        archive = Archive(path)
        check_crate(archive)
        check_capsule(archive)
        return ""
    except Bad as reason:
        return str(reason)


def check_changed_bytes(capsule):
    with open(capsule, "rb") as file:
        whole = file.read()
    target = os.path.join(SCRATCH, "flipped.zip")

    def flip(at):
        with open(target, "wb") as file:
            file.write(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])

    # a byte of each file, and all kinds of bytes of the zip file itself
    for name, (offset, size, _) in Archive(capsule).files.items():
        flip(offset + size // 2)
        assert f"{name!r} has other bytes" in checked(target), (name, checked(target))
    verified(target, code=3, said="has other bytes than the capsule was made with")
    for at in [*range(0, len(whole), len(whole) // 100), *range(len(whole) - 100, len(whole))]:
        flip(at)
        assert checked(target), f"byte {at} of {len(whole)} was changed, and nothing was found"
    for end in (0, 1, 21, 22, len(whole) // 2, len(whole) - 1):
        with open(target, "wb") as file:
            file.write(whole[:end])
        verified(target, code=3, said="flipped.zip: ")
    with open(target, "wb") as file:
        file.write(whole + b"more")
    verified(target, code=3, said="flipped.zip: ")

    # the same on purpose, with a new checksum: the recorded sha256 names it
    files = contents(capsule)
    files["results/later.bodies.csv"] = files["results/later.bodies.csv"].replace(b"1", b"2", 1)
    write(target, [Entry(name, content) for name, content in files.items()])
    verified(target, code=3, said="results/later.bodies.csv has other bytes than recorded: sha256 ")


def check_other_bits(capsule, small, meshes):
    def other_hash(value):
        value["runs"][1]["state_hash"] = "0" * 32
    text = verified(with_json(capsule, other_hash), code=5, said=f"expected {'0' * 32}")
    assert "case: same bits" in text and "later: other bits: state hash " in text and "not the same bits: 1 of 2 runs are the same" in text, text

    def other_gravity(files):
        files["cases/case.toml"] = b"gravity = [0, 0, -1.62]\n" + files["cases/case.toml"]
    verified(repacked(small, other_gravity), "--meshes", meshes, code=5, said="; the same up to step 0, other at step ")

    def other_seed(files):
        files["cases/case.toml"] = b"seed = 77\n" + files["cases/case.toml"]
    verified(repacked(small, other_seed), "--meshes", meshes, code=5, said="they differ from the first step on: other shapes or another packing")

    def no_case(files):
        files["cases/case.toml"] = b"title = 5"
    verified(repacked(small, no_case), "--meshes", meshes, code=4, said="case: not computed: scree-decomposer: error: ")


def check_hostile_zips(capsule):
    files = contents(capsule)
    target = os.path.join(SCRATCH, "hostile.zip")

    def zipped(name, content=b"x", change=None, compression=zipfile.ZIP_STORED):
        with zipfile.ZipFile(target, "w", compression) as archive:
            for other, data in files.items():
                archive.writestr(zipfile.ZipInfo(other), data)
            info = zipfile.ZipInfo(name)
            info.compress_type = compression
            if change:
                change(info)
            archive.writestr(info, content)

    def link(info):
        info.external_attr = (stat.S_IFLNK | 0o777) << 16

    outside = os.path.join(AWAY, "pwned")
    for name, said in (("../pwned", "leads out of the folder"), ("cases/../../pwned", "leads out of the folder"), (outside, "absolute path"), ("..\\pwned", "backslash"), ("C:pwned", "absolute path"),
                       ("cases/", "it is a folder"), ("a//b", "a part that is empty"), ("./a", "a part that is empty"), ("a\nb", "control character"), ("README.md/x", "also that of a file"),
                       ("n" * 300, "too long"), ("zextra", "not as workflows/run writes it")):
        zipped(name)
        assert said in checked(target), (name, said, checked(target))
        if name.endswith("pwned"):
            verified(target, code=3, said=said)
    zipped("zlink", b"/etc/passwd", link)
    verified(target, code=3, said="'zlink' is a link")
    zipped("zbomb", bytes(50_000_000), compression=zipfile.ZIP_DEFLATED)
    assert os.path.getsize(target) < 1_000_000
    verified(target, code=3, said="'zbomb' is compressed")
    with zipfile.ZipFile(target, "w") as archive:
        for name in ("README.md", "READMEXmd"):   # zipfile writes no name twice without a warning
            archive.writestr(zipfile.ZipInfo(name), b"x")
    with open(target, "rb") as file:
        text = file.read()
    with open(target, "wb") as file:
        file.write(text.replace(b"READMEXmd", b"README.md"))
    verified(target, code=3, said="two files have the name 'README.md'")
    with open(target, "wb") as file:
        file.write(b"no zip at all")
    verified(target, code=3, said="is no zip file, or is damaged")

    def refused(change, said):
        message = checked(repacked(capsule, change))
        assert said in message, (said, message)

    refused(lambda files: files.pop("capsule.json"), "capsule.json is missing")
    refused(lambda files: files.pop(CRATE), f"has no {CRATE}")
    refused(lambda files: files.pop("README.md"), "README.md is missing")
    refused(lambda files: files.update({"added.txt": b""}), "added.txt is not among the files")
    for content, said in ((b"{", "is no JSON"), (b"[]", "expected an object"), (b"\xff", "is no JSON"), (b"[" * 100000, "is no JSON"), (b"{}", "expected scree-capsule")):
        for name in ("capsule.json", CRATE) if content != b"{}" else ("capsule.json",):
            files = contents(capsule)
            files[name] = content
            if name != CRATE:
                refused(lambda files: files.update({name: content}), said)
                continue
            write(target, [Entry(other, data) for other, data in files.items()])
            assert said in checked(target), (said, checked(target))
    verified(target, code=3, said=f"{CRATE} is no JSON")
    assert not os.listdir(AWAY), os.listdir(AWAY)


def check_hostile_words(capsule):
    def shape_words(words):
        return lambda value: value["shapes"][0].update(made_by=words)

    for change, said in ((shape_words(["import", "-o", "x"]), "is no output"), (shape_words(["import", f"--output={AWAY}/x"]), "is no output"), (shape_words(["generate", "-ox"]), "is no output"),
                         (shape_words(["hull", {"file": "../x"}]), "a file of the capsule"), (shape_words(["hull", {"file": []}]), "a file of the capsule"),
                         (shape_words(["hull", "--picture=x.png"]), "is no output"), (shape_words(["sh", "-c"]), "words that begin with"),
                         (lambda value: value["shapes"][0].update(file="../../x.shape.h5"), "without '..'"), (lambda value: value["runs"][0].update(name="../x"), "without '..'"),
                         (lambda value: value["runs"][0].update(settings=["--solver=sh"]), "expected KEY=VALUE"), (lambda value: value["runs"][0].update(case="/etc/passwd"), "a file of the capsule"),
                         (lambda value: value["runs"][0].update(start="later"), "an earlier run"),
                         (lambda value: value["runs"][0].update(log="/dev/zero"), "runs[0].log"), (lambda value: value["runs"][0]["settings"].append("shapes.x.file=/tmp/x.shape.h5"), "a shape of the capsule"),
                         (lambda value: value["runs"][0]["settings"].append('walls.0.shape={file="/etc/passwd"}'), "a shape of the capsule"),
                         (lambda value: value["runs"][0]["settings"].append('walls.*.shape.file = "/etc/passwd"'), "a shape of the capsule"),
                         (lambda value: value["runs"][0]["settings"].append('start={run="/tmp/secret.run"}'), "start.run of cases/case.toml"),
                         (lambda value: value["runs"][0]["settings"].append("walls.7.shape.file=x"), "no place for the setting"),
                         (lambda value: value.update(shapes=[], runs=value["runs"][:1]), "a shape of the capsule"), (lambda value: value["runs"][0].update(name="x" * 254), "at most 200 bytes"), (lambda value: value.update(runs=[]), "at least one run"),
                         (lambda value: value.update(format_version=99), "format_version 99 found")):
        message = checked(with_json(capsule, change))
        assert said in message, (said, message)

    # any value of any kind at any place: a clear message or none, never an exception
    original = json.loads(contents(capsule)["capsule.json"])

    def places(value, path=()):
        yield path
        for key, part in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
            yield from places(part, (*path, key))

    count, archive, changed = 0, Archive(capsule), None
    others = {name: archive.read(name) for name in archive.files if name.startswith("cases/")}
    archive.read = lambda name: others.get(name) or json.dumps(changed).encode()   # in memory: thousands of files would take a minute
    for path in list(places(original))[1:]:
        for wrong in (None, -1, [], {}, "../x", "\ud800", [[]], {"file": []}):
            changed = copy.deepcopy(original)
            place = changed
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = wrong
            try:
                check_capsule(archive)
            except Bad as reason:
                count += 1
                assert "capsule.json" in str(reason), reason
    assert count > 200, count


def check_starts():
    """A run that begins with a checkpoint which is not written again belongs to no capsule."""
    from recipe import Recipe, Refused
    with open(os.path.join(SCRATCH, "run.json"), "w") as file:
        json.dump({"steps": 5279, "step_size": 1.8943836545405096e-05, "settings": {"settings": {"checkpoint_every": 0.02, "checkpoint_by_clock": False}}}, file)
    start = lambda step: {"start": {"file": f"checkpoint_{step:012}.h5"}}  # noqa: E731
    for step in (1056, 2112, 4224, 5279):   # 20 ms, 40 ms, 80 ms, the end
        Recipe.check_start(None, "later.run", start(step), SCRATCH)
    for step in (1055, 1057, 3000):
        try:
            Recipe.check_start(None, "later.run", start(step), SCRATCH)
        except Refused as reason:
            assert f"step {step} of" in str(reason) and "[output] checkpoint" in str(reason), reason
        else:
            raise AssertionError(f"step {step} was taken")
    os.remove(os.path.join(SCRATCH, "run.json"))


def main():
    shutil.rmtree(SCRATCH, ignore_errors=True)
    os.makedirs(AWAY)
    check_starts()
    put("case.toml", BED)
    put("later.toml", LATER)
    put("meshes.toml", "cube = 'generate box --size \"1 cm, 1 cm, 1 cm\"'\n")
    put("forms/a stone.off", TETRAHEDRON)
    capsule, again, small = (os.path.join(SCRATCH, name) for name in ("capsule.zip", "again.zip", "small.zip"))
    command(RUNNER, os.path.join(HOME, "case.toml"), "case.run/run.json", "--capsule-limit", "0", "--capsule", small, code=0, said="has no licence")
    os.remove(os.path.join(HOME, "meshes.toml"))   # the second case has no shapes of its own
    later = (RUNNER, os.path.join(HOME, "later.toml"), "later.run/run.json", "later.bodies.csv")
    put("CITATION.cff", CITATION)
    command(*later, "--capsule", capsule, code=0, said="2 runs; verify it with: workflows/verify")
    command(*later, "--cores", "1", "--capsule", again, code=0)
    with open(capsule, "rb") as one, open(again, "rb") as other:
        assert one.read() == other.read(), "two capsules of the same runs differ"
    check_made(capsule)

    command(RUNNER, "boulders", "--capsule", code=2, said="--capsule needs the name of a zip file")
    command(RUNNER, "boulders", "--capsule", "nowhere/x.zip", code=2, said="--capsule needs the name of a zip file")
    command(RUNNER, "boulders", "--capsule-limit", "x", code=2, said="--capsule-limit needs a number")
    for words, said in (((), "which capsule?"), (("nope.zip",), "no file 'nope.zip'"), ((capsule, "--out"), "--out needs a folder"), ((capsule, "--bits"), "unknown argument"),
                        ((capsule, "--out", HOME), "is no empty folder"), ((capsule, "--meshes", "nowhere"), "no folder")):
        command(VERIFY, *words, code=2, said=said)
    command(VERIFY, "--help", code=0, said="same bits")

    # another machine has the capsule only
    meshes = os.path.join(HOME, "forms")
    os.rename(meshes, os.path.join(SCRATCH, "meshes"))
    shutil.rmtree(HOME)
    text = verified(capsule, said="same bits: 2 of 2 runs")
    assert "case: same bits" in text and "later: same bits" in text, text
    command(VERIFY, capsule, "--files", code=0, said="have the bytes that they were recorded with")
    assert not os.path.exists(os.path.join(SCRATCH, "capsule.verify"))
    verified(small, code=3, said="meshes/a stone.off is not in the capsule", out="small")
    verified(small, "--meshes", os.path.join(SCRATCH, "meshes"), said="same bits: 1 of 1 runs")

    check_changed_bytes(capsule)
    check_other_bits(capsule, small, os.path.join(SCRATCH, "meshes"))
    check_hostile_zips(capsule)
    check_hostile_words(capsule)
    shutil.rmtree(SCRATCH)


if __name__ == "__main__":
    main()
    print("all as expected")
