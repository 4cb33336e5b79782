"""The loop: make the runs that are worth most, as far as the budget goes, until the plan is done or the goals are reached.

Where runs come from is not its business: `source` is the queue of workflows/run (error.py), or a closed form in the tests.
"""
import math
import time

from answers import answer_of, first_names, goal_in_unit, name_in
from plan import MOST, Costs, affordable, first_jobs, makespan, next_jobs
from settings import CASE

RESERVE = 20.0          # [s] of the budget for the table, the chart and checkpoints of interrupted runs, until a table was written
RESERVE_SHARE = 0.15    # of the budget, where that is less
CHECKPOINTS = 10.0      # [s] of runs that are interrupted
SAFETY = 4.0            # times that the longest table took: the first one has no chart, and other programs may come between
START = 4.0             # [s] of a call of the queue, before its first run
SMALL = 0.7             # half widths of the seeds: what is not seen and below adds a fifth to the root of the squares at most
KNOWN = 0.5             # root of the squares of all half widths over the sum of the effects below which more seeds change nothing


class Stop(Exception):
    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


class Campaign:
    """What is known of the settings so far.

    source   make(jobs, seconds) -> whether it came to its end in that time; result(job) -> {"numbers": name -> (value, unit), "cost": core seconds,
             "hash": of the last state} or None; failure(job) -> message or None; is_there(job): from a call before
    write    called with this after every call of the queue: writes the table
    goals    list of answers.Goal; asked: names of quantities; seconds: budget, None for none
    """

    def __init__(self, settings, first_seed, count, source, cores, goals=(), asked=(), seconds=None, used=0.0, clock=time.monotonic, say=lambda text: None,
                 write=lambda campaign: None):
        self.settings, self.count, self.source, self.cores = settings, count, source, cores
        self.goals, self.asked, self.seconds, self.clock, self.say = list(goals), list(asked), seconds, clock, say
        self.named = {setting.name: setting for setting in settings}
        self.seeds = [first_seed + number for number in range(max(MOST, count))]
        self.results = {}                 # job -> result
        self.failed_runs, self.failed = {}, {}
        self.left, self.is_seeded, self.is_cut = [], True, False
        self.costs = Costs(settings, 1.0)
        self.a_run = 1.0                  # [s] of a core for packing and statistics of a run
        self.began = clock() - used
        self.write = write
        self.reserve = 0.0 if seconds is None else min(RESERVE, RESERVE_SHARE * seconds)

    @property
    def used(self):
        return self.clock() - self.began

    @property
    def time_left(self):
        """[s] for runs."""
        return math.inf if self.seconds is None else self.seconds - self.reserve - self.used

    def there(self, setting):
        return [seed for name, seed in self.results if name == setting]

    def values(self, quantity):
        values = {}
        for (setting, seed), result in self.results.items():
            if quantity in result["numbers"]:
                values.setdefault(setting, {})[seed] = result["numbers"][quantity][0]
        return values

    def cost(self, setting):
        return self.costs.of(setting) + self.a_run

    def make(self, jobs):
        begin = self.clock()
        fresh = [job for job in jobs if not self.source.is_there(job)]
        if fresh:
            self.say(f"{len(fresh)} runs{f' ({len(jobs) - len(fresh)} more are there)' if len(fresh) < len(jobs) else ''}, about {makespan([self.cost(name) for name, _ in fresh], self.cores) + START:.0f} s"
                     + (f"; {max(0.0, self.seconds - self.used):.0f} s of the budget are left" if self.seconds else ""))
        is_whole = self.source.make(jobs, None if self.seconds is None else max(1.0, self.time_left))
        new = []
        for job in jobs:
            result = self.source.result(job)
            if result:
                self.results[job] = result
                self.costs.add(job[0], result["cost"])
                new += [result["cost"]] if job in fresh else []
            elif is_whole:
                self.fail(job)
        if new and is_whole and len(fresh) == len(jobs):
            self.a_run = min(max(0.0, self.clock() - begin - START - makespan(new, self.cores)) * min(self.cores, len(new)) / len(new), 10 * self.a_run + 10)
        self.is_cut = self.is_cut or not is_whole
        self.find_seeded()
        return any(job in self.results for job in jobs)

    def fail(self, job):
        message = self.source.failure(job) or "no message"
        self.failed_runs[job] = message
        self.say(f"{job[0]}, seed {job[1]}: {message}")
        if job[0] != CASE:
            self.failed[job[0]] = message
        elif job[1] == self.seeds[0]:
            raise Stop(5, f"the case itself cannot be run: {message}")

    def find_seeded(self):
        hashes = [self.results[job]["hash"] for job in self.results if job[0] == CASE]
        if len(hashes) > 1:
            self.is_seeded = len(set(hashes)) > 1

    def is_open(self, job):
        return job not in self.results and job not in self.failed_runs and job[0] not in self.failed and (self.is_seeded or job[1] == self.seeds[0])

    def quantities(self):
        """Names that every run of the case has, in the order of its first run."""
        first = self.results[(CASE, self.seeds[0])]["numbers"]
        return [name for name in first if all(name in result["numbers"] for job, result in self.results.items() if job[0] == CASE)]

    def answer(self, name):
        first = self.results[(CASE, self.seeds[0])]["numbers"][name]
        why = {setting.name: setting.why_not for setting in self.settings if setting.why_not}
        why |= {name: f"failed: {message}" for name, message in self.failed.items()}
        why |= {job: "the budget did not allow it" for job, _ in self.left if job not in why}
        answer = answer_of(name, first[1], self.values(name), self.settings, why, self.is_seeded)
        for goal in self.goals:
            if name_in(goal.name, self.quantities(), "--goal") == name:
                answer.goal = goal_in_unit(goal, answer.unit, answer.seeds.value)
        return answer

    def goal_answers(self):
        return [self.answer(name) for name in dict.fromkeys(name_in(goal.name, self.quantities(), "--goal") for goal in self.goals)]

    def check_names(self):
        """Goals and quantities that the first run does not have are errors now, not after hours."""
        for goal in self.goals:
            self.answer(name_in(goal.name, self.quantities(), "--goal"))
        self.asked = [name_in(name, self.quantities(), "--quantity") for name in self.asked]

    def wanted(self):
        jobs = [job for job in first_jobs(self.settings, self.seeds, self.count) if self.is_open(job)]
        if jobs or not self.is_seeded:
            return jobs
        if self.goals:
            open_goals = [answer for answer in self.goal_answers() if not answer.is_enough and not self.is_hopeless(answer)]
            worst = max(open_goals, key=lambda answer: answer.total / answer.goal, default=None)
        else:
            worst = self.least_seen() if self.seconds else None
        if worst is None:
            return []
        parts = {part: (half, worst.counts[part]) for part, half in worst.halves.items() if math.isfinite(half)}
        if not self.goals:
            parts = {part: entry for part, entry in parts.items() if part in self.unseen(worst)}
        there = {}
        for name, seed in [*self.results, *self.failed_runs]:
            there.setdefault(name, set()).add(seed)
        return [job for job in next_jobs(parts, self.settings, self.seeds, self.cores, self.cost, there) if self.is_open(job)]

    @staticmethod
    def unseen(answer):
        """Parts whose effect is neither seen nor known to be small compared with the interval of the seeds."""
        return [part for part, entry in answer.effects.items()
                if entry.interval.count < MOST and not entry.interval.is_seen and entry.interval.half > SMALL * answer.seeds.half > 0]

    def least_seen(self):
        """Without a goal a budget is for effects that are not seen: of the numbers of the first table, the one with the widest."""
        answers = [answer for answer in self.answers()[1] if self.unseen(answer)]
        return max(answers, key=lambda answer: max(answer.halves[part] for part in self.unseen(answer)) / answer.seeds.half, default=None)

    @staticmethod
    def is_hopeless(answer):
        """The effects alone are larger than the goal, and are known: more seeds change nothing."""
        root = math.sqrt(sum(half**2 for half in answer.halves.values() if math.isfinite(half)))
        return abs(answer.bias) >= answer.goal and root <= KNOWN * abs(answer.bias)

    def spent(self):
        return {name: sum(costs) + self.a_run * len(costs) for name, costs in self.costs.measured.items()}

    def run(self):
        """All of it. Raises Stop where the case itself cannot be run."""
        first = (CASE, self.seeds[0])
        if not self.make([first]):
            raise Stop(5, f"the budget of {self.seconds:.0f} s ended before the first run of the case; give a larger --budget (the run goes on from its checkpoint)")
        self.check_names()
        self.write_table()
        while jobs := self.wanted():
            is_there = {name for name, seed in jobs if self.source.is_there((name, seed))}
            free = [job for job in jobs if job[0] in is_there and self.source.is_there(job)]
            chosen, self.left = affordable([job for job in jobs if job not in free], self.cost, self.cores, self.time_left - START, self.spent(),
                                           math.inf if self.seconds is None else self.seconds * self.cores)
            if not chosen and not free or self.is_cut:
                self.left = jobs if self.is_cut else self.left
                break
            # one run of each finer setting first: then their costs are known
            unknown = list({name: (name, seed) for name, seed in reversed(chosen) if name not in self.costs.measured and self.named[name].is_finer}.values())
            second = [job for job in chosen if job[0] == CASE][:1] if len(self.there(CASE)) == 1 else []
            if not self.make(free or unknown + second or chosen):
                if self.is_cut:
                    self.left = [job for job in self.wanted()]
                    break
            self.write_table()
        self.write_table()
        return self

    def write_table(self):
        """After every call of the queue: a user can read it while the runs go on, and the time that it takes is known when the budget ends."""
        begin = self.clock()
        self.write(self)
        self.reserve = max(self.reserve, CHECKPOINTS + SAFETY * (self.clock() - begin))

    def answers(self):
        """(all numbers, those of the first table)."""
        names = self.quantities()
        asked = list(dict.fromkeys([*(name_in(goal.name, names, "--goal") for goal in self.goals), *self.asked]))
        answers = {name: self.answer(name) for name in names}
        first = [answers[name] for name in first_names(asked, answers)]
        return [*answers.values()], first
