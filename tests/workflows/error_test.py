#!/usr/bin/env python3
"""The error of a case without Scree: closed forms with known noise and known biases. usage: error_test.py WORKFLOWS SCRATCH

- Intervals and effects of whole campaigns hold what was put in; the total holds the truth.
- A step of 8 to a contact, a stiffness 100 times too soft, shapes of 20 triangles: each is named as the largest error.
- The budget is kept on a clock, whatever runs take; what it did not allow is listed; no run is made twice, not in a second call either.
- Goals add seeds where these narrow the total most; a goal that no seeds reach ends, and names the part and what helps.
- Settings of all cases that Scree ships are cases as well; what a case does not allow has its reason.
- Wrong words are refused with what was found and what was expected.
"""
import math
import os
import pathlib
import shutil
import subprocess
import sys

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
WORKFLOWS, SCRATCH = (pathlib.Path(word).resolve() for word in sys.argv[1:])
sys.dont_write_bytecode = True
sys.path[:0] = [str(WORKFLOWS / "error"), str(WORKFLOWS), str(WORKFLOWS.parent / "post" / "python")]
import numpy as np  # noqa: E402

import answers  # noqa: E402
import page  # noqa: E402
import scree  # noqa: E402
from campaign import Campaign, Stop  # noqa: E402
from plan import MOST, SHARE, affordable, makespan  # noqa: E402
from run_record import si  # noqa: E402
from settings import remarks, settings_of  # noqa: E402

shutil.rmtree(SCRATCH, ignore_errors=True)
SCRATCH.mkdir(parents=True)
os.chdir(SCRATCH)

CASE = {"seed": 3, "time": {"steps_per_contact": 30}, "pairs": [{"stiffness": "2 kN/m"}], "contact": {"margin": "0.4 mm"}, "shapes": {"rock": {"file": "rock.shape.h5"}}}
SHAPES = {"rock": {"finer": "/made/rock-finer.shape.h5", "coarser": "/made/rock-coarser.shape.h5"}}


class Heap:
    """A stand-in for the runs of a case: an angle that the settings bias, with noise that is a function of seed and setting. Its clock runs as runs do."""

    def __init__(self, case=None, triangles=320, noise=0.5, own=0.2, cost=2.0, draw=0, refused=(), invalid=(), is_seeded=True, slow=1.0):
        self.case, self.triangles, self.noise, self.own, self.cost, self.draw = case or CASE, triangles, noise, own, cost, draw
        self.refused, self.invalid, self.is_seeded, self.slow = refused, invalid, is_seeded, slow
        self.settings = settings_of(self.case, 4e-4, SHAPES)
        self.named = {setting.name: setting for setting in self.settings}
        self.made, self.time, self.cores = {}, 0.0, 2

    TRUTH = 30.0

    def biases(self, name):
        keys = self.named[name].keys
        steps = float(keys.get("time.steps_per_contact", si(self.case["time"]["steps_per_contact"])))
        stiffness = float(keys.get("pairs.0.stiffness", si(self.case["pairs"][0]["stiffness"])))
        margin = float(keys.get("contact.margin", si(self.case["contact"]["margin"])))
        triangles = self.triangles * {"shape-finer": 4, "shape-coarser": 0.25}.get(name, 1)
        return {"step": -360 / steps**2, "stiffness": 0.4 * math.sqrt(2000 / stiffness), "margin": 500 * margin, "shape": 60 / triangles}

    def value(self, name, seed):
        """With scatter of the seed that all settings share but for a part of their own."""
        shared = np.random.default_rng([self.draw, seed]).standard_normal() if self.is_seeded else 0.0
        own = np.random.default_rng([self.draw, seed, list(self.named).index(name) + 1]).standard_normal() if self.is_seeded else 0.0
        return self.TRUTH + sum(self.biases(name).values()) + self.noise * shared + self.own * own

    def make(self, jobs, seconds):
        end = math.inf if seconds is None else self.time + seconds
        free = [self.time + 3.0] * self.cores
        for job in jobs:
            if job in self.made or job[0] in self.refused or job in self.invalid:
                continue
            place = free.index(min(free))
            free[place] += self.slow * self.cost * self.named[job[0]].cost
            if free[place] > end:
                self.time = end + 2.0   # checkpoints of the runs that are interrupted
                return False
            self.made[job] = self.value(*job)
        self.time = max(free)
        return True

    def is_there(self, job):
        return job in self.made

    def result(self, job):
        if job not in self.made:
            return None
        return {"numbers": {"angle_of_repose": (self.made[job], "deg"), "bodies": (20.0, "-")}, "cost": self.slow * self.cost * self.named[job[0]].cost, "hash": str(self.made[job] if job[0] == "case" else 0)}

    def failure(self, job):
        return "restitution needs more steps" if job[0] in self.refused else "a body left the domain" if job in self.invalid else None

    def campaign(self, count=5, goals=(), seconds=None, **more):
        return Campaign(self.settings, self.case["seed"], count, self, self.cores, [answers.goal_of(goal) for goal in goals], seconds=seconds, clock=lambda: self.time, **more)

    def measured(self, **words):
        campaign = self.campaign(**words).run()
        return campaign, campaign.answer("angle_of_repose")


# --- 500 campaigns of known noise and bias
inside = dict.fromkeys(("seeds", "step", "stiffness", "margin", "shape", "total"), 0)
wrong_signs, orders = 0, []
for draw in range(500):
    heap = Heap(draw=draw)
    _, answer = heap.measured()
    case = heap.biases("case")
    inside["seeds"] += answer.seeds.low <= heap.TRUTH + sum(case.values()) <= answer.seeds.high
    for part, entry in answer.effects.items():
        true = case[part] - heap.biases(f"{part}-finer")[part]
        if entry.order is not None:
            true, orders = case["step"], orders + [entry.order]
        inside[part] += entry.interval.low <= true <= entry.interval.high
        wrong_signs += entry.interval.is_seen and entry.interval.value * true < 0
    known = case["step"] + sum(case[part] - heap.biases(f"{part}-finer")[part] for part in ("stiffness", "margin", "shape"))
    inside["total"] += abs(answer.seeds.value - (heap.TRUTH + sum(case.values()) - known)) <= answer.total
print("of 500 campaigns hold what was put in:", {part: f"{100 * count / 500:.1f} %" for part, count in inside.items()}, f"{len(orders)} orders measured")
for part in ("seeds", "step", "stiffness", "margin", "shape"):
    assert 0.925 <= inside[part] / 500 <= 0.975, (part, inside[part] / 500)
assert inside["total"] / 500 >= 0.95, inside["total"]
assert wrong_signs == 0.0 or wrong_signs / 2000 < 0.005, wrong_signs   # a seen effect of the wrong sign is a draw beyond 95 %

# --- poor settings are named
for part, poor, triangles in (("step", {"time": {"steps_per_contact": 8}}, 320), ("stiffness", {"pairs": [{"stiffness": "20 N/m"}]}, 320), ("shape", {}, 20)):
    heap = Heap({**CASE, **poor}, triangles)
    campaign, answer = heap.measured()
    assert answer.largest[0] == part, (part, answer.largest, answer.text)
    sign = heap.biases("case")[part] - heap.biases(f"{part}-finer")[part]
    assert answer.effects[part].interval.is_seen and answer.effects[part].interval.value * sign > 0, answer.text
    if part == "step":
        assert abs(answer.effects["step"].order - 2) < 0.3 and abs(answer.effects["step"].interval.value + 360 / 64) < 1, answer.effects["step"]

# --- goals: seeds are added until the total is narrow enough; the forecast of the first five is right within a factor
ratios = []
for draw in range(1, 9):
    heap = Heap(noise=1.5, own=0.3, draw=draw)
    campaign, answer = heap.measured(goals=["repose.angle=1.2 deg"])
    assert answer.is_enough and answer.seeds.count > 5, (answer.text, answer.total, answer.counts)
    assert max(answer.counts.values()) == answer.seeds.count, "the seeds scatter most, and get most of the runs"
    _, early = Heap(noise=1.5, own=0.3, draw=draw).measured()
    early.goal = 1.2
    ratios.append((early.seeds_for_goal or math.inf) / answer.seeds.count)
assert 0.5 < sorted(ratios)[4] < 2, ratios
_, percent = Heap(noise=1.5, own=0.3).measured(goals=["angle_of_repose=1 %"])
assert abs(percent.goal - 0.01 * percent.seeds.value) < 1e-12
poor = Heap({**CASE, "time": {"steps_per_contact": 8}})
campaign, answer = poor.measured(goals=["angle_of_repose=0.5 deg"])
assert not answer.is_enough and answer.seeds_for_goal is None and len(poor.made) < 60, (answer.total, len(poor.made))
assert "no number of seeds" in page.verdict(answer, campaign) and "a smaller step" in page.verdict(answer, campaign), page.verdict(answer, campaign)
best = page.cheapest(answer, campaign)
assert best is None or best[0] != "case", best

# --- the budget is kept, whatever the runs take
for cost in (0.5, 5.0, 40.0):
    for seconds in (60.0, 240.0, 900.0):
        heap = Heap(cost=cost)
        campaign = heap.campaign(seconds=seconds)
        try:
            campaign.run()
        except Stop as stop:
            assert stop.code == 5 and "budget" in str(stop) and cost + 3 > 0.5 * seconds, (cost, seconds, str(stop))
        assert heap.time <= seconds, (cost, seconds, heap.time)
        missing = [job for job in campaign.wanted() if job not in campaign.left] if campaign.results else []
        assert not missing, (cost, seconds, missing)
heap = Heap(cost=10.0)
campaign = heap.campaign(seconds=500.0)
heap.slow = 4.0            # another program begins to use the cores: estimates are wrong by four, and the queue is interrupted
campaign.run()
assert heap.time <= 500 and campaign.left and len(heap.made) > 5, (heap.time, len(heap.made))
heap = Heap(cost=1.0)
table = lambda campaign: setattr(heap, "time", heap.time + 30.0)  # noqa: E731  a table that takes half a minute, on a machine that others use
heap.campaign(seconds=200.0, write=table).run()
assert heap.time <= 200 and len(heap.made) > 5, (heap.time, len(heap.made))
chosen, left = affordable([("case", 1), ("shape-finer", 1), ("case", 2)], {"case": 1.0, "shape-finer": 50.0}.get, 2, 100.0, {}, budget=120.0)
assert chosen == [("case", 1), ("case", 2)] and left == [("shape-finer", 1)], "a setting gets a third of the budget at most"
assert SHARE * 120 < 50 and makespan([3, 1, 1, 1], 2) == 3

# --- without a goal, a budget is for effects that are not seen
short, _ = Heap(own=1.5).measured()
longer, answer = Heap(own=1.5).measured(seconds=3600.0)
assert len(longer.results) > len(short.results) and max(answer.counts.values()) <= MOST

# --- no run is made twice; a second call goes on
heap = Heap(cost=5.0)
heap.campaign(seconds=120.0).run()
there = dict(heap.made)
heap.time = 0.0
_, answer = heap.measured()
assert all(heap.made[job] == value for job, value in there.items()) and list(heap.made)[:len(there)] == list(there) and len(heap.made) > len(there)
_, whole = Heap(cost=5.0).measured()
assert (whole.text, whole.total) == (answer.text, answer.total), "in two calls as in one"

# --- settings that cannot be run have their reason in the table; the others are measured
heap = Heap(refused=("step-coarser", "margin-finer"), invalid=(("case", 4),))
campaign, answer = heap.measured()
assert set(answer.effects) == {"step", "stiffness", "shape"} and answer.missing["margin"] == "failed: restitution needs more steps", answer.missing
assert answer.seeds.count == 4 and answer.effects["step"].order is None
campaign.title, campaign.case_title, campaign.times, campaign.remarks = "heap", "a heap", "", remarks(CASE)
page.write(campaign, *campaign.answers())
text = pathlib.Path("error.md").read_text(encoding="utf-8")
for wanted in ("failed: restitution needs more steps", answer.text, "Not in the total: margin", "The same in all runs: bodies = 20", "![Total error"):
    assert wanted in text, (wanted, text)
assert pathlib.Path("error.png").stat().st_size > 10_000
try:
    Heap(invalid=(("case", 3),)).campaign().run()
    raise AssertionError("a case that cannot be run was measured")
except Stop as stop:
    assert stop.code == 5 and "a body left the domain" in str(stop), str(stop)

# --- a case without random numbers: one run of each setting
heap = Heap(is_seeded=False)
campaign, answer = heap.measured()
assert not campaign.is_seeded and len(heap.made) == 1 + len(heap.settings) and answer.seeds.half == 0
assert abs(answer.effects["step"].interval.value + 360 / 900) < 1e-9 and abs(answer.effects["step"].order - 2) < 1e-6, answer.effects["step"]

# --- the settings of shipped cases are cases, with keys twice or half of what they were
count = 0
for path in sorted([*WORKFLOWS.glob("*/*.toml"), *WORKFLOWS.parent.glob("decomposer/schema/cases/*.toml")]):
    case = scree.Case(path)
    if case.problems():
        continue
    files = {name: {"finer": f"/made/{name}.shape.h5", "coarser": f"{name}: too few"} if "file" in shape else dict.fromkeys(("finer", "coarser"), "a ball")
             for name, shape in case.data.get("shapes", {}).items()}
    for setting in settings_of(case.data, 1e-4, files):
        assert bool(setting.keys) != bool(setting.why_not) or setting.name == "case", (path, setting)
        changed = case.copy()
        for key, value in setting.keys.items():
            before = changed[key] if key in changed else None
            changed[key] = value if value.endswith(".h5") else float(value)
            if before is not None and not value.endswith(".h5") and si(before) != 0:
                assert any(math.isclose(float(value) / si(before), ratio) for ratio in (0.5, 2, 2**0.5, 2**-0.5, 2**0.4, 2**-0.4)), (path, setting.name, key, before, value)
            count += 1
        assert not changed.problems(), (path, setting.name, changed.problems())
assert count > 300, count
frozen = settings_of({"heat": {"frozen": True}, "start": {"run": "bed.run"}, "bonds": [{}]}, 0.0, {})
assert {setting.name: setting.why_not for setting in frozen}["step-finer"].startswith("heat.frozen"), frozen
assert all(setting.why_not for setting in frozen if setting.name != "case")
assert len(remarks({"start": {}, "bonds": [{}]})) == 2

# --- wrong words
RUN = str(WORKFLOWS / "run")
for words, expected in (
        (["nope", "--error"], "no case 'nope'"), (["boulders", "--error", "--goal", "solid_fraction"], "expected QUANTITY=ERROR[ UNIT]"),
        (["boulders", "--error", "--goal", "solid_fraction=-1"], "above 0"), (["boulders", "--error", "--goal", "mass=1 furlong"], "'furlong' is no unit"),
        (["boulders", "--error", "--budget", "10"], "expected a time above 0 with its unit"), (["boulders", "--error", "--seeds", "one"], "expected a whole number of at least 2"),
        (["boulders", "--error", "--config", "sweep=seed=1|2"], "a sweep has no place here"), (["boulders", "--error", "--quantity", "none.py:f"], "there is no file")):
    result = subprocess.run([RUN, *words], capture_output=True, text=True, check=False)
    assert result.returncode == 2 and expected in result.stderr and result.stderr.startswith("workflows/run: error: ") and "Traceback" not in result.stderr, (words, result)
for name, names, expected in (("repose.angle", ["angle_of_repose", "mass"], None), ("mas", ["mass"], "did you mean 'mass'"), ("force", ["force_x", "force_y"], "could be force_x, force_y")):
    try:
        assert answers.name_in(name, names, "--goal") == names[0] and expected is None
    except answers.Wrong as reason:
        assert expected and expected in str(reason), (name, str(reason))
try:
    answers.goal_in_unit(answers.goal_of("mass=1 deg"), "kg", 2.0)
    raise AssertionError("a mass in degrees")
except answers.Wrong as reason:
    assert "in kg, not in deg" in str(reason)
print("all as expected")
