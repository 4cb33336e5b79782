"""What a relation is, and what it gets to work with.

A relation is a function of a Trial that returns when it holds, throws Violation with what differs when it does not, and NotApplicable when it
says nothing about the case. It draws from trial.random only, so that its name, the case and the seed make it the same again.

`spoil` says how the self-test changes what the relation reads, so that it must find a violation: each relation is shown able to fail.
"""
import random

from tools import NotApplicable, Refused, Violation  # noqa: F401  (relations import them from here)

RELATIONS = {}
kStepsInTurns = 4000   # that more ranks than cores may take
# say nothing of a case whose bodies stay as they are (heat.frozen): forces move nothing there, and load maps and impacts are refused
OF_MOTION = {"a_load_map_is_no_physics", "recording_impacts_is_no_physics", "momentum", "angular_momentum", "weights_at_rest", "rest_is_rest",
             "finer_steps_keep_energy", "energy_balance", "no_rebound_above_arrival", "started_from_its_run"}


class Relation:
    def __init__(self, function, spoil, group):
        self.function, self.spoil, self.group, self.name = function, spoil, group, function.__name__


def relation(group, spoil):
    """group: 'bits', 'near' (runs within a tolerance) or 'sums' (one run, or what post makes of it)."""
    def keep(function):
        RELATIONS[function.__name__] = Relation(function, spoil, group)
        return function
    return keep


class Trial:
    """A case, its scene and its run on one rank with one thread; spoil changes runs after the first, in a self-test only."""

    def __init__(self, tools, case, seed):
        self.tools, self.case, self.seed = tools, case, seed
        self.kept_scene = self.kept_run = None
        self.spoil, self.random = None, None

    def begin(self, name):
        self.random = random.Random(f"{self.seed} {name}")
        if name in OF_MOTION and self.case.words.get("heat", {}).get("frozen"):
            raise NotApplicable("nothing moves")

    @property
    def scene(self):
        if self.kept_scene is None:
            self.kept_scene = self.tools.pack(self.case)
        return self.kept_scene

    @property
    def run(self):
        if self.kept_run is None:
            self.kept_run = self.tools.solve(self.scene)
        return self.kept_run

    def completed(self):
        """The run, where it came to its end."""
        if not self.run.completed():
            raise NotApplicable("the run becomes invalid: " + (self.run.record or {}).get("message", "")[:200])
        return self.run

    def seen(self, run):
        """Any other run passes here before it is compared."""
        if self.spoil is not None:
            self.spoil(run)
        return run

    def solve(self, scene=None, **how):
        return self.seen(self.tools.solve(scene or self.scene, **how))

    def solve_case(self, case, *arguments, **how):
        return self.solve(self.tools.pack(case, *arguments), **how)

    def short(self, most=kStepsInTurns):
        """Scene and serial run of the first `most` steps of the case."""
        if self.run.steps <= most:
            return self.scene, self.run
        scene = self.tools.pack(self.case, "--set", f"time.duration={self.scene.general['duration'] * most / self.run.steps!r}")
        return scene, self.tools.solve(scene)

    def parallel(self):
        """Some way to run in parallel. Long runs get no more ranks and threads than cores, since a step of ranks that take turns takes a
        millisecond."""
        how = {"ranks": self.random.choice([1, 2, 2, 3, 3, 4]), "threads": self.random.choice([1, 1, 2, 3])}
        if self.run.steps > kStepsInTurns:
            how = {"ranks": min(how["ranks"], 2), "threads": 1} if how["ranks"] > 1 else {"ranks": 1, "threads": min(how["threads"], 2)}
        words = []
        if self.random.random() < 0.4:
            words += ["--halo", self.random.choice(["overlap", "blocking"])]
        if self.random.random() < 0.4:
            words += ["--send", self.random.choice(["selected", "all"])]
        if self.random.random() < 0.4:
            words += ["--cut", self.random.choice(["rcb", "rib", "hsfc", "body"])]
        return how | {"arguments": words}


def require(condition, text):
    if not condition:
        raise Violation(text)
