#!/usr/bin/env python3
"""Calibration without Scree: an analytic stand-in with a known answer and known noise. usage: calibrate_test.py WORKFLOWS SCRATCH

- Intervals hold the hidden keys as often as they say, over many seeds, with one answer and with two.
- The surrogate finds the noise, and says where it does not know the answer.
- A ridge is reported as one, with its number; keys that are distinguished are not; answers out of reach and intervals at a bound are said.
- The loop stops by itself or at the budget; killed anywhere and begun again, it repeats no run and ends with the same numbers.
- Wrong words are refused with what was found and what was expected.
"""
import json
import math
import os
import pathlib
import shutil
import sys

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
WORKFLOWS, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:])
sys.dont_write_bytecode = True
sys.path.insert(0, str(WORKFLOWS / "calibrate"))
import numpy as np  # noqa: E402

import calibrate  # noqa: E402
import page  # noqa: E402
from experiments import POINTS, proposal, spread  # noqa: E402
from posterior import ROUGH, narrowing, posterior, sobol  # noqa: E402
from settings import SIGMAS, read  # noqa: E402
from surrogate import Surrogate  # noqa: E402

shutil.rmtree(SCRATCH, ignore_errors=True)
SCRATCH.mkdir(parents=True)
os.chdir(SCRATCH)


# --- the stand-in: a heap whose angle saturates with both keys, and a drum that feels the first one more
def heap(x):
    return 10 + 25 * (1 - np.exp(-2.5 * x[:, 0])) * (0.4 + 0.6 * np.tanh(2.5 * x[:, 1]))


def drum(x):
    return 20 + 12 * x[:, 0] - 6 * x[:, 1] ** 2


ANSWERS = {"heap": (heap, 1.5), "drum": (drum, 1.0)}   # with the standard deviation of one run


def one(seed, names, half):
    """Hidden keys, fitted to measured answers by 24 runs of each. half: standard deviation of the measurements."""
    random = np.random.default_rng(seed)
    hidden = random.random(2)
    points = sobol(20, 2, seed)
    points = np.concatenate([points, points[:2], points[:2]])
    surrogates = [Surrogate(points, ANSWERS[name][0](points) + ANSWERS[name][1] * random.standard_normal(len(points))) for name in names]
    measured = [(float(ANSWERS[name][0](hidden[None])[0] + half * random.standard_normal()), half) for name in names]
    found = posterior(surrogates, measured, 2, seed, ROUGH)
    return [low <= value <= high for value, (low, high) in zip(hidden, map(found.interval, range(2)))], surrogates, found


inside = {"one": [], "two": []}
noise = []
for seed in range(25):
    for which, names in (("one", ["heap"]), ("two", ["heap", "drum"])):
        held, surrogates, found = one(seed, names, 0.5)
        inside[which] += held
        noise.append([surrogate.noise for surrogate in surrogates][-1] if which == "two" else 1.0)
for which, held in inside.items():
    # 50 intervals of 95 %: fewer than 42 hold with a probability of 8e-4 (binomial)
    assert sum(held) >= 42, f"{which}: {sum(held)} of {len(held)} intervals hold the hidden key"
print({which: f"{sum(held)} of {len(held)} inside" for which, held in inside.items()})
ratio = np.exp(np.mean(np.log([n for n in noise if n != 1.0])))
assert 0.85 < ratio < 1.15, f"noise of 1 found as {ratio}"   # 25 fits with 24 runs each: 1 / sqrt(2 * 20 * 25) = 3 %, and a prior

# the same as scikit-learn says of each member
places = sobol(64, 2, 9)
there = [member.predict(places, return_std=True) for member in surrogates[0].members]
mean, unsure = surrogates[0].predict(places)
assert np.allclose((mean - surrogates[0].middle) / surrogates[0].scale, np.mean([entry[0] for entry in there], axis=0), atol=1e-9)
variance = np.mean([entry[1] ** 2 - np.exp(member.kernel_.theta[-1]) for entry, member in zip(there, surrogates[0].members)], axis=0) + np.var([entry[0] for entry in there], axis=0)
ours, its = ([function(member.kernel_.theta) for member in surrogates[0].members] for function in (surrogates[0]._likelihood, surrogates[0].best.log_marginal_likelihood))
assert np.allclose(np.diff(ours), np.diff(its), atol=1e-6)
assert np.allclose((unsure / surrogates[0].scale) ** 2, variance, atol=1e-7)

# intervals are not wide for safety either: a likelihood that is known is met exactly
class Exact:
    noise = 0.0

    def predict(self, points):
        return points[:, 0] + points[:, 1], np.zeros(len(points))


class First(Exact):
    def predict(self, points):
        return points[:, 0], np.zeros(len(points))


found = posterior([First()], [(0.4, 0.01)], 2, 0)
low, high = found.interval(0)
assert abs(low - (0.4 - SIGMAS * 0.01)) < 1.5e-3 and abs(high - (0.4 + SIGMAS * 0.01)) < 1.5e-3, (low, high)
low, high = found.interval(1)
assert abs(high - low - 0.95) < 0.02, (low, high)
assert narrowing(found.even(), 0, 1) > 0.9
# x + y known to 0.01: a ridge. x is uniform in 0 to 0.8, but where y is known it has a deviation of 0.01
found = posterior([Exact()], [(0.8, 0.01)], 2, 0)
assert narrowing(found.even(), 0, 1) < 0.15 and narrowing(found.even(), 1, 0) < 0.15
assert abs(found.even()[:, 0].std() - 0.8 / math.sqrt(12)) < 0.02
# one that lies at the bound reaches it
low, high = posterior([First()], [(0.0, 0.05)], 1, 0).interval(0)
assert low < 0.002 and abs(high - SIGMAS * 0.05) < 3e-3, (low, high)


# --- the loop, with runs that are written to disk as Scree's would be
class Killed(Exception):
    pass


WORDS = {"target": "heap:angle_of_repose=20+-1;drum:angle_of_repose=25+-0.6", "keys": "pairs.0.friction=0..1;pairs.0.rolling_friction=0..1", "budget": "40", "start": "10",
         "stop": "0.2"}


def loop(folder, words, kill_at=()):
    """Calibrates in the folder; killed after so many runs, and begun again. Returns what calibrate.calibrate does, the runs made and their number."""
    os.makedirs(folder, exist_ok=True)
    made, kills = [], list(kill_at)
    settings = read(words)
    path = os.path.join(folder, "runs.json")

    def make(names):
        for name in names:
            file = os.path.join(folder, name)
            if os.path.exists(file):
                continue
            if kills and len(made) >= kills[0]:
                kills.pop(0)
                raise Killed
            run = runs.content["runs"][name]
            function, deviation = ANSWERS[run["scene"]]
            value = function(np.array([run["place"]]))[0] + deviation * np.random.default_rng(run["seed"]).standard_normal()
            pathlib.Path(file).write_text(repr(float(value)))
            made.append(name)

    def answers(target):
        names = [name for name, run in runs.all.items() if run["scene"] == target.scene.name and os.path.exists(os.path.join(folder, name))]
        return names, [runs.all[name]["place"] for name in names], [float(pathlib.Path(folder, name).read_text()) for name in names]

    while True:
        runs = calibrate.Runs(settings, path)
        if not runs.all:
            for scene in settings.scenes:
                for place in calibrate.first_design(settings):
                    runs.add(scene, place)
            runs.write()
        try:
            result = calibrate.calibrate(settings, runs, make, answers, [(target.value, target.deviation) for target in settings.targets], report=lambda text: None)
            return settings, runs, made, result
        except Killed:
            continue


settings, runs, made, whole = loop("whole", WORDS)
assert len(runs.all) <= 40 and len(made) == len(set(made)) == len(runs.all)
assert whole[3] in ("precise", "budget") and (whole[3] == "budget") == (max(whole[2]) > 0.2), whole[2:]
_, again, made_again, killed = loop("killed", WORDS, kill_at=(3, 21, 29, 35))
assert len(made_again) == len(set(made_again)), "a run was made twice after a kill"
assert again.content == runs.content, "other runs were asked for after a kill"
assert [killed[1].interval(k) for k in range(2)] == [whole[1].interval(k) for k in range(2)]
# done already: nothing more is run, also not for other targets or a stop that is met; a larger budget goes on with the same runs
_, _, more, _ = loop("killed", {**WORDS, "target": "heap:angle_of_repose=21+-30;drum:angle_of_repose=25+-30"})
assert not more, more
_, larger, more, _ = loop("killed", {**WORDS, "budget": "46", "stop": "0"})
assert len(more) == 46 - len(runs.all) and set(runs.all) < set(larger.all), more
try:
    loop("killed", {**WORDS, "keys": "pairs.0.friction=0..0.9;pairs.0.rolling_friction=0..1"})
    raise AssertionError("other bounds with the runs of these were accepted")
except calibrate.Stop as error:
    assert error.code == 2 and "other keys" in str(error) and "Give another --out folder" in str(error), error
# a target that is easily met stops before the budget
_, _, few, easy = loop("easy", {**WORDS, "target": "heap:angle_of_repose=20+-20", "stop": "0.5"})
assert easy[3] == "precise" and len(few) == 14, (easy[2:], len(few))   # the first design: 10 points, two of them three times

# --- what the page says
def said(settings, result, failed=0):
    measured = [(target.value, target.deviation) for target in settings.targets]
    numbers = page.judge(settings, measured, result[0], result[1], result[2], result[3])
    return numbers, " ".join(text for _, text in page.verdicts(settings, numbers, ["deg"] * len(measured), failed))


settings, _, _, result = loop("ridge", {**WORDS, "target": "heap:angle_of_repose=22+-1.5", "budget": "30"})
numbers, text = said(settings, result, failed=1)
assert "cannot be distinguished" in text and min(numbers["pairs"][0]["narrowing"]) < page.NOT_APART, (numbers["pairs"], text)
ridge = [station["answers"][0] for station in numbers["ridge"]]
assert max(ridge) - min(ridge) < 4 and numbers["ridge"][0]["keys"] != numbers["ridge"][-1]["keys"], numbers["ridge"]   # of the 17 degrees that the box has
assert "1 runs became invalid" in text
assert page.is_open(numbers)
numbers, text = said(settings := read(WORDS), whole)
assert numbers["pairs"][0]["told_apart"] == "yes" and "cannot be distinguished" not in text, (numbers["pairs"], text)
settings, _, _, result = loop("far", {**WORDS, "target": "heap:angle_of_repose=60+-1", "budget": "18"})
numbers, text = said(settings, result)
assert "No keys within the bounds give the measured heap:angle_of_repose" in text and numbers["answers"][0]["off"] < -3, text
assert not page.is_open(numbers)   # intervals mean nothing there: nothing is proposed

# --- what to measure next: the expected width of an interval is the width that comes out, on the mean, when the number is then measured
random = np.random.default_rng(4)
places = spread(found.even(400), 12)
assert len(np.unique(places, axis=0)) == 12
FURTHER = {"drum": (drum, 1.0), "slide": (lambda x: 10 * (1 - 0.9 * x[:, 0]), 0.0), "deaf": (lambda x: 5.0 + 0 * x[:, 0], 1.0), "spin": (lambda x: 3 + 8 * x[:, 1], 0.2)}
points = sobol(20, 2, 3)
alone = Surrogate(points, heap(points) + 1.5 * random.standard_normal(20))
for name, (function, scatter) in FURTHER.items():
    expected, came, fixed_to = [], [], []
    for seed in range(12):
        hidden = random.random(2)
        answer = (float(heap(hidden[None])[0]), 0.75)
        before = posterior([alone], [answer], 2, seed, ROUGH)
        now = np.array([high - low for low, high in map(before.interval, range(2))])
        places = spread(before.even(400), 12)
        further = Surrogate(places, function(places) + scatter * random.standard_normal(12))
        entry = proposal(before.even(POINTS), further, 0.3, now)
        truth = before.even(12)[seed][None]   # measured as certainly as it says
        after = posterior([alone, further], [answer, (float(function(truth)[0] + entry["deviation"] * random.standard_normal()), entry["deviation"])], 2, seed, ROUGH)
        expected.append(entry["widths"])
        came.append([high - low for low, high in map(after.interval, range(2))])
        fixed_to.append(now)
    expected, came, now = (np.mean(entries, axis=0) for entries in (expected, came, fixed_to))
    print(f"{name}: intervals {now.round(2)} before, {expected.round(3)} expected, {came.round(3)} after the measurement")
    # twelve draws of a width that scatters by up to half of itself: 15 % each, and twice that
    assert np.all(np.abs(came / expected - 1) < 0.3), (name, expected, came)
    if name == "deaf":
        assert np.all(expected > 0.9 * now), (expected, now)
    if name == "slide":
        assert expected[0] < 0.15, expected
    if name == "spin":
        assert expected[1] < 0.33, expected

# charts of one key on a logarithmic scale, and of two; one key has no pairs
for name, words in (("one", {"target": "heap:angle_of_repose=20+-1", "keys": "pairs.0.stiffness=1 kN/m..100 kN/m log", "budget": "18"}), ("ridge", {**WORDS, "budget": "40"})):
    settings = read(words)
    points = sobol(18, len(settings.keys), 1)
    surrogate = Surrogate(points, heap(np.column_stack([points, points])[:, :2]))
    found = posterior([surrogate], [(20.0, 0.5)], len(settings.keys), 0)
    numbers, text = said(read({**words, "target": "heap:angle_of_repose=20+-1"}), ([surrogate], found, [0.1], "precise"))
    assert len(numbers["pairs"]) == len(settings.keys) - 1
    page.draw_surface(settings, [(20.0, 0.5)], [surrogate], found, ["deg"], numbers)
    page.draw_posterior(settings, found, numbers)
    for chart in ("surface", "posterior"):
        assert os.path.getsize(f"{chart}.png") > 10_000 and settings.keys[0].name in pathlib.Path(f"{chart}.svg").read_text()
        os.rename(f"{chart}.png", f"{chart}-{name}.png")
    # an answer that no keys give: the chart says so, and draws no interval
    assert page.keys_fit(numbers) and page.NO_FIT not in pathlib.Path("surface.svg").read_text()
    numbers["answers"][0]["off"] = 12.0
    page.draw_surface(settings, [(20.0, 0.5)], [surrogate], found, ["deg"], numbers)
    drawn = pathlib.Path("surface.svg").read_text()
    assert page.NO_FIT in drawn and "interval of the key" not in drawn and "dots: posterior" not in drawn

# --- words
def refused(words, *parts):
    try:
        read(words)
    except ValueError as error:
        assert all(part in str(error) for part in parts), f"{words}: {error}"
        return
    raise AssertionError(f"{words}: accepted")


good = {"target": "heap:angle_of_repose=34+-1", "keys": "pairs.0.friction=0.1..0.9"}
settings = read({**good, "size": "small"})
assert settings.budget < 60 and settings.words == ("ranks=1", "size=small") and settings.targets[0].uncertainty == 1
assert read({**good, "target": "heap: angle_of_repose = 34 ± 1 deg"}).targets[0].unit == "deg"
assert read({**good, "target": "heap:granular_temperature=1e-3 m^2/s^2+-1e-4 m^2/s^2"}).targets[0].unit == "m^2/s^2"
assert read({**good, "target": {"heap": "mass=12+-1 g"}}).targets[0].unit == "g"          # Snakemake reads "heap: mass" as a table
assert read({**good, "target": "hopper/hopper-ball-11:discharge_rate.last=50 g/s+-2 g/s"}).targets[0].scene.run == "hopper-ball-11"
assert read({**good, "target": "heap:power@wall 0 plate.max=-1e-3+-1e-4"}).targets[0].group == "wall 0 plate"
assert [read({**good, "case": "column"}).scenes[0].case, read({**good, "case": "column", "target": "a=1+-1"}).scenes[0].case] == ["calibrate", "column"]
key = read({**good, "keys": "pairs.*.stiffness,pairs.0.x=500 N/m..50 kN/m log"}).keys[0]
assert math.isclose(key.low, 0.5) and key.text(0.5) == "5 kN/m" and len(key.paths) == 2 and math.isclose(key.place(key.value(0.3)), 0.3)
refused({"target": "heap:x=1+-1"}, "target is given without keys")
refused({"keys": good["keys"]}, "keys is given without target")
refused({**good, "target": "heap:angle_of_repose=34"}, "'heap:angle_of_repose=34' found; expected [SCENE:]QUANTITY")
refused({**good, "target": "heap:angle_of_repose=34+-0"}, "expected one above 0")
refused({**good, "target": "pile:angle_of_repose=34+-1"}, "no scene and no case 'pile'", "heap, drum, slide", "repose")
refused({**good, "target": "heap:angle_of_repose.end=34+-1"}, "no '.end'", "mean, last, min, max")
refused({**good, "target": "heap:angle_of_repose=34+-1 furlong"}, "'furlong' is no unit")
refused({**good, "target": "heap:a=3+-1;heap:a=4+-1"}, "is there twice")
refused({**good, "keys": "pairs.0.friction=0.1,0.9"}, "'pairs.0.friction=0.1,0.9' found; expected KEY=LOWER..UPPER")
refused({**good, "keys": "pairs.0.friction=0.9..0.1"}, "the lower bound 0.9 is not below the upper bound 0.1")
refused({**good, "keys": "pairs.0.friction=0.5..0.5"}, "not below")
refused({**good, "keys": "pairs.0.friction=0..0.5 log"}, "lower bound above 0")
refused({**good, "keys": "populations.0.size=1 mm..5 kg"}, "units of different kinds")
refused({**good, "keys": "pairs.0.friction=0..1;pairs.0.friction=0..1"}, "is there twice")
refused({**good, "keys": "pairs.0.friction=0..0.5;pairs.*.friction=0.6..1"}, "keys: pairs.*.friction replaces pairs.0.friction")
refused({**good, "keys": "pairs.0.friction=0..0.5;pairs.00.friction=0.6..1"}, "keys: pairs.00.friction replaces pairs.0.friction")
refused({**good, "set": "pairs.0.friction=0.9", "keys": "pairs.*.friction=0..1"}, "set: the key pairs.*.friction replaces pairs.0.friction")
assert len(read({**good, "keys": "pairs.*.friction=0..0.5;pairs.0.friction=0.6..1"}).keys) == 2   # the second counts for the first pair
assert read({**good, "set": "pairs.*.friction=0.9", "keys": "pairs.0.friction=0..1"}).fixed
refused({**good, "set": "seed=7"}, "set: 'seed' is what replicas differ in")
refused({**good, "target": "heap:a=1e400+-1"}, "a number is too large")
refused({**good, "keys": "pairs.0.friction=0..1e400"}, "a bound is too large")
refused({**good, "keys": "drum:pairs.0.friction=0..1"}, "no target has the scene 'drum'")
refused({**good, "keys": "seed=1..5"}, "'seed' is what replicas differ in")
refused({**good, "keys": ";".join(f"k{n}=0..1" for n in range(7))}, "7 found; expected 1 to 6")
refused({**good, "budget": "10"}, "budget=10 is too small", "takes 16 runs (12 points, 2 of them with 3 seeds, in 1 scene)")
refused({**good, "experiments": "pile"}, "experiments: there is no scene and no case 'pile'")
refused({**good, "experiments": "drum;heap"}, "experiments: heap has a target")
refused({**good, "experiments": "drum;drum"}, "experiments: drum is there twice")
refused({**good, "survey": "3"}, "survey=3 found", "at least 6")
assert [scene.name for scene in read(good).experiments] == ["drum", "slide"]                     # of this folder, that have no target
assert [scene.name for scene in read({**good, "experiments": "column; slide"}).experiments] == ["column", "slide"]
assert not read({**good, "experiments": "none"}).experiments and not read({**good, "target": "column:mass=1+-1 kg"}).experiments
assert read({**good, "set": "slide:time.duration=0.1 s"}).fixed == (("slide", "time.duration=0.1 s"),)
refused({**good, "start": "4", "replicas": "1"}, "makes 4 runs of a scene; a fit needs 6")
refused({**good, "target": "no/where.toml:mass=1+-1"}, "there is no case file /", "no/where.toml")
refused({**good, "budget": "many"}, "budget=many found; expected a whole number")
refused({**good, "set": "populations.0.count"}, "expected KEY=VALUE")

shutil.rmtree(SCRATCH, ignore_errors=True)
print("all as expected")
