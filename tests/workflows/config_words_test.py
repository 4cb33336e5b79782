#!/usr/bin/env python3
"""Words of --config, keys of sweeps and quantities of calibrate that no case has are refused before anything runs; --help creates nothing.

config_words_test.py WORKFLOWS BIN SCRATCH

- Every word that a Snakefile reads is known: a use of config that cannot be followed is an error here.
- Every key that the workflows and pages set is a key of the case language.
- Refusals: exit 2, the word, the nearest word, the known words; no folder is made.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

WORKFLOWS, BIN, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
RUNNER, ROOT = WORKFLOWS / "run", WORKFLOWS.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(WORKFLOWS))
import case_keys  # noqa: E402
import config_words  # noqa: E402
import points_queue  # noqa: E402
import sweep_quantity  # noqa: E402
from config_words import Wrong, given_in, module_of, words_of  # noqa: E402

shutil.rmtree(SCRATCH, ignore_errors=True)
SCRATCH.mkdir(parents=True)
OUT = SCRATCH / "out"
SNAKEFILES = {path.parent.name: path for path in sorted(WORKFLOWS.glob("*/Snakefile"))}


def run(*words, cwd=SCRATCH):
    environment = {**os.environ, "SCREE_BIN": str(BIN), "PWD": str(cwd)}
    return subprocess.run([RUNNER, *map(str, words)], capture_output=True, text=True, env=environment, cwd=cwd)


def wrong(function, *arguments):
    try:
        function(*arguments)
    except Wrong as reason:
        return str(reason)
    raise AssertionError(f"{arguments}: accepted")


def wrong_quantity(word, case):
    try:
        sweep_quantity.check(word, [case])
    except sweep_quantity.Wrong as reason:
        return str(reason)
    raise AssertionError(f"{word}: accepted")


# --- 1. every word that a Snakefile reads is known, and has a meaning for --help
def all_of(text):
    (SCRATCH / "Snakefile").write_text(text)
    return words_of(str(SCRATCH / "Snakefile")).all


assert all_of('A = config.get("a", 1)  # config[name]\nB = config["b"] if "c" in config else f"{config[\'d\']}"\nif "e" not in config:\n    config.setdefault("f", 2)\n'
              "rule x:\n    params: config=1\n    shell: \"run --config {params.config}\"\n") == ["a", "b", "d", "f", "c", "e"]
for text in ("A = config[name]\n", "A = config.get(name, 1)\n", "A = dict(config)\n", "for word in config:\n    pass\n", "A = config\n", 'configfile: "a.yaml"\n',
             'A = "a" in config.keys()\n', "read(config, 1)\n"):
    assert "its words cannot be found" in wrong(all_of, text), text
(SCRATCH / "shared.smk").write_text('B = config["b"]\n')
assert all_of('A = config["a"]\ninclude: "shared.smk"\n') == ["a", "b"]

PIPELINE = words_of(str(WORKFLOWS / "pipeline.smk"))
assert {"ranks", "threads", "minutes", "statistics", "sweep", "replicas", "plot", "points"} == set(PIPELINE.all), PIPELINE.all
for name, path in SNAKEFILES.items():
    words = words_of(str(path))   # raises for a use of config that cannot be followed
    known = {*words.all, *(module_of(words.checked_by).WORDS if words.checked_by else ())}
    without = {*known} - {*words.described, "size"} - (set() if not words.checked_by else set(re.findall(r"^\| `(\w+)` \|", (path.parent / "README.md").read_text(), re.M)))
    assert not without, f"{path}: describe in the comment at its top, '#   WORD=VALUE  meaning': {', '.join(sorted(without))}"
    assert set(words.described) <= known, f"{path}: described, but not read: {set(words.described) - known}"
    assert not re.search(r"^\s*(script|module|configfile)\s*:", path.read_text(), re.M), f"{path}: config reaches a file that config_words.py does not read"
assert not [path for path in WORKFLOWS.glob("**/*.py") if "snakemake.config" in path.read_text() or "configfile" in path.read_text() and path.name != "config_words.py"]

# --- 2. keys of the case language: those that are in use are accepted
for text, key in ((path, key) for path in [*SNAKEFILES.values(), *ROOT.glob("docs/user/*.md"), *WORKFLOWS.glob("**/*.md")]
                  for key in re.findall(r"""--set ["']?([\w.*-]+)=|"sweep=([\w.*-]+)=""", path.read_text())):
    key = key[0] or key[1]
    assert key in ("KEY", "--") or case_keys.problem_of(key) is None, (text, key, case_keys.problem_of(key))
count = 0


def keys_in(value, path=()):
    yield ".".join(path)
    if isinstance(value, (dict, list)):
        for name, below in value.items() if isinstance(value, dict) else enumerate(value):
            yield from keys_in(below, (*path, str(name)))


for path in WORKFLOWS.glob("*/*.toml"):
    case = tomllib.loads(path.read_text())
    for key in list(keys_in(case))[1:] if "materials" in case else []:   # others are no cases
        count += 1
        assert case_keys.problem_of(key) is None, (path, key, case_keys.problem_of(key))
assert count > 1000, count
for key, says in (("pairs.*.frictoin", "no key 'frictoin' in pairs.*, did you mean 'friction'?"), ("friction", "did you mean 'pairs.*.friction'?"),
                  ("pairs.rock.friction", "pairs is a list"), ("walls.0.motion.rotat.rate", "did you mean 'rotate'?"), ("seed.0", "seed is a value"),
                  ("par.0.friction", "did you mean 'pairs'?"), ("materials.rock.densty", "did you mean 'density'?"), ("zzz", "there are: ")):
    assert says in str(case_keys.problem_of(key)), (key, case_keys.problem_of(key))

axes = case_keys.axes_of('pairs.*.friction=0.2|0.4; populations.0.region={ box = [[0, 0, 0], [1, 1, 1]] };title="a, b=c"|"d"')
assert [len(axis) for axis in axes] == [2, 1, 2] and axes[0] == [("pairs.*.friction", "0.2"), ("pairs.*.friction", "0.4")], axes
for sweep, corrected in (("pairs.0.friction=0.2|0.6,time.duration=1 s|2 s", "pairs.0.friction=0.2|0.6;time.duration=1 s|2 s"),
                         ("seed=1;pairs.0.friction=0.2, time.duration=1 s, gravity.2=-9|-8", "seed=1;pairs.0.friction=0.2;time.duration=1 s;gravity.2=-9|-8"),
                         ("pairs.0.friction=0.2|0.6 seed=1|2", "pairs.0.friction=0.2|0.6;seed=1|2")):
    assert f'"sweep={corrected}"' in wrong(case_keys.axes_of, sweep), wrong(case_keys.axes_of, sweep)
assert "expected KEY=VALUE|VALUE" in wrong(case_keys.axes_of, "seed=1;friction")
# a comma between values, where the bar belongs; in quotes and brackets a comma is part of a value
for sweep, corrected in (("pairs.*.friction=0.2,0.6", "pairs.*.friction=0.2|0.6"), ("seed=1|2;pairs.*.friction=0.2, 0.4|0.6", "seed=1|2;pairs.*.friction=0.2|0.4|0.6"),
                         ('walls.0.shape.plane.normal=[0, 0, 1],[0, 1, 1]', 'walls.0.shape.plane.normal=[0, 0, 1]|[0, 1, 1]')):
    said = wrong(case_keys.axes_of, sweep)
    assert "values of a sweep are separated by |" in said and f'"sweep={corrected}"' in said, said
assert len(case_keys.axes_of('title="a, b"|\'c, d\';gravity=[0, 0, -9.81]|[1, 0, -9];populations.0.region={ box = [[0, 0, 0], [1, 1, 1]] }')) == 3
assert case_keys.axes_of('title="x;y|z"|"w"') == [[("title", '"x;y|z"'), ("title", '"w"')]]
assert "seed stands there twice" in wrong(case_keys.axes_of, "seed=1|2;gravity.2=-9|-8;seed=3|4")
OWN = str(WORKFLOWS / "own_case.smk")
for words, says in ((["replicas=abc"], "replicas=abc: expected a whole number from 1"), (["ranks=-1"], "expected a whole number from 0"), (["threads=0"], "from 1 on"),
                    (["minutes="], "minutes=: a value is missing"), (["sweep=seed=1|2", "replicas=2"], "the sweep has seeds of its own")):
    assert says in wrong(config_words.check, OWN, "own.toml", words), words
config_words.check(OWN, "own.toml", ["sweep=seed=1|2", "replicas=1", "ranks=0"])
(SCRATCH / "still.toml").write_text('[[walls]]\nname = "floor"\n')
(SCRATCH / "all.toml").write_text('[heat]\n[[walls]]\nwear = {}\n[[walls]]\nmotion = [{ rotate = {} }, { servo = {} }]\n')
for word in ("temperature", "temperature_spread", "way", "rate@floor", "sliding_power", "volume_worn"):
    assert "have no " + word.partition("@")[0] in wrong_quantity(word, str(SCRATCH / "still.toml")), word
    sweep_quantity.check(word.partition("@")[0], [str(SCRATCH / "all.toml")])
sweep_quantity.check("temperature", [str(SCRATCH / "still.toml")], changed=("heat.frozen",))

# --- 3. what is behind --config
assert given_in(["a", "--config", "x=1", "y=--from 2", "-n", "b", "--until", "c"]) == ["x=1", "y=--from 2"]
assert given_in(["--config=x=1", "-n"]) == ["x=1"] == given_in(["-Cx=1"]) and not given_in(["--configfile", "x"])
assert "--config a=1 b=2" in wrong(given_in, ["--config", "a=1", "-n", "--config", "b=2"])

# --- 4. the runner refuses them, dry run or not, and makes nothing
shutil.copy(WORKFLOWS / "calibrate/heap.toml", SCRATCH / "own.toml")
HEAP = ["target=heap:angle_of_repose=34+-1", "keys=pairs.0.friction=0.1..0.8"]
KNOWN = "There are: size, ranks, threads, statistics, sweep, replicas, points, plot, minutes"
for case, words, *says in (
        ("repose", ["replica=3"], "--config replica=3: repose has no word 'replica', did you mean 'replicas'?", KNOWN), ("repose", ["swep=seed=1|2"], "did you mean 'sweep'?"),
        ("repose", ["tube=3"], "has no word 'tube'; there are: size, "), ("repose", ["size=small", "thread=2"], "did you mean 'threads'?"),
        ("repose", ["statistic=x"], "did you mean 'statistics'?"), ("repose", ["size"], "expected WORD=VALUE"), ("validation", ["replicas=3"], "there are: tiers, "),
        ("own.toml", ["size=smal"], "own.toml has no word 'size'"), ("own.toml", ["replica=2"], "did you mean 'replicas'?"),
        ("repose", ["sweep=pairs.0.friction=0.2|0.6,seed=1"], '"sweep=pairs.0.friction=0.2|0.6;seed=1"'), ("repose", ["sweep=pairs.0.frictoin=1"], "did you mean 'friction'?"),
        ("own.toml", ["sweep=walls.0.motion.rotat.rate=20 rpm"], "did you mean 'rotate'?"),
        ("own.toml", ["sweep=pairs.*.friction=0.2,0.6"], "values of a sweep are separated by |", '"sweep=pairs.*.friction=0.2|0.6"'),
        ("calibrate", ["budgt=3"], "calibrate has no word 'budgt', did you mean 'budget'?"), ("calibrate", [*HEAP, "size=small"], "calibrate has no word 'size'"),
        ("calibrate", ["target=heap:angel_of_repose=34+-1", HEAP[1]], "no quantity 'angel_of_repose', did you mean 'angle_of_repose'?"),
        ("calibrate", [HEAP[0], "keys=pairs.0.frictoin=0.1..0.8"], "keys: pairs.0.frictoin", "did you mean 'friction'?"),
        ("calibrate", [*HEAP, "set=populations.0.counts=4"], "set: populations.0.counts", "did you mean 'count'?"),
        ("calibrate", ["points=none.json", "budget=3"], "calibrate has no word 'budget'")):
    for dry in ([], ["--dry-run"]):
        result = run(case, *dry, "--out", OUT, "--config", *words)
        assert result.returncode == 2 and result.stderr.startswith("workflows/run: error: ") and len(result.stderr.splitlines()) == 1 and not result.stdout, (case, words, result)
        assert all(text in result.stderr for text in says), (case, words, says, result.stderr)
        assert not OUT.exists(), (case, words)
result = run("repose", "--error", "--out", OUT, "--config", "thread=2")
assert result.returncode == 2 and "did you mean 'threads'?" in result.stderr and not OUT.exists(), result

# --- 5. right ones pass
for case, words, said in (
        ("repose", ["size=small", "replicas=2", "sweep=pairs.0.friction=0.2|0.6;time.duration=1 s|2 s", "plot=mass", "threads=2"], "time.duration=2 s"),
        ("own.toml", ["statistics=--from 1", "ranks=2", "minutes=3"], "--from 1"), ("calibrate", [*HEAP, "budget=60", "threads=2"], "calibration.md"),
        ("calibrate", ["target=hopper/hopper-ball-13:discharge_rate=1+-1", HEAP[1], "size=small"], "calibration.md"), ("tube", ["frictions=0.1,0.2", "seeds=1,2"], "ball-0.2-2"),
        ("shear-box", ["stresses=20,60"], "'walls.2.motion.servo.stress=60 kPa'"), ("shear-box", ["stresses=7.5", "size=small"], "shear-box-small-7.5.scene.h5")):
    result = run(case, "--dry-run", "--out", OUT, "--config", *words)
    assert result.returncode == 0 and said in result.stdout and not OUT.exists(), (case, words, result)

# a list of stresses is refused before anything runs where one of them is none
for words, says in (("stresses=20,abc", "'abc' found, expected stresses of the lid in kPa"), ("stresses=0", "'0' found"), ("stresses=20,40,20", "20 stands there twice")):
    result = run("shear-box", "--dry-run", "--out", OUT, "--config", words)
    assert result.returncode != 0 and says in result.stderr.splitlines()[-1], (words, result)

# words of a calibration go to those of its cases that read them
queue = points_queue.PointsQueue(1, ("ranks=1", "size=small"))
points_queue.RUNNER = "/bin/echo"
for case, there in (("hopper", True), ("calibrate", False)):
    said = queue.call(case, str(SCRATCH / case), {}, [])[1].splitlines()[-1]
    assert "ranks=1" in said and ("size=small" in said) == there, said

# --- 6. --help: what the case is, its words; it makes nothing
before = sorted(path for path in WORKFLOWS.glob("*/*"))
for case in [*SNAKEFILES, "own.toml"]:
    words = words_of(str(SNAKEFILES.get(case, WORKFLOWS / "own_case.smk")))
    for help_word in ("--help", "-h") if case == "repose" else ("--help",):
        result = run(case, "--out", OUT, help_word)
        assert result.returncode == 0 and not result.stderr and "snakemake --help" in result.stdout.splitlines()[-1], (case, result)
        known = [word for word in words.all if word in words.own or not words.checked_by] + (["target", "keys", "budget"] if words.checked_by else [])
        assert all(f"\n  {word}=" in result.stdout for word in known), (case, known, result.stdout)
        assert len(result.stdout.splitlines()[0]) > 40 and "Snakemake is" not in result.stdout, (case, result.stdout)
assert "--budget" in run("repose", "--error", "--help").stdout
assert not OUT.exists() and before == sorted(WORKFLOWS.glob("*/*")) and not (SCRATCH / "own.out").exists()

shutil.rmtree(SCRATCH)
print("all as expected")
