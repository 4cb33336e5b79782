"""Which runs are made next, and what fits into the budget. Pure: knows settings, seeds and costs, and runs nothing."""
import heapq
import math
import os
import sys

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "post", "python")]
from scree.intervals import student_quantile  # noqa: E402
from settings import CASE, PARTS  # noqa: E402

SHARE = 1 / 3            # of the budget that one setting may take, so that a costly one leaves time for the others
MARGIN = 1.15            # of estimated times: runs side by side slow each other down
FEW = 3                  # seeds of settings that only the chart shows
MOST = 40                # seeds of a setting that a goal may ask for


def first_jobs(settings, seeds, count):
    """(name of a setting, seed) in the order in which they are worth most: the case, then every finer setting with the same seed, then the next seed.

    Coarser steps follow, since an order of the step takes three steps; other coarser settings are for the chart alone.
    """
    order = []
    for place, setting in enumerate(setting for setting in settings if not setting.why_not):
        most = count if setting.name == CASE or setting.is_finer or setting.part == "step" else min(FEW, count)
        late = 0.0 if setting.name == CASE else 0.5 if setting.is_finer else 1.5 if setting.part == "step" else 2.5
        order += [(number + late, place, setting.name, seeds[number]) for number in range(min(most, len(seeds)))]
    return [(name, seed) for _, _, name, seed in sorted(order)]


class Costs:
    """Core time [s] of a run at each setting: what was measured, else what the setting is expected to take."""

    def __init__(self, settings, of_case):
        self.of_case = of_case
        self.expected = {setting.name: setting.cost for setting in settings}
        self.measured = {}

    def add(self, name, seconds):
        self.measured.setdefault(name, []).append(seconds)

    def mean(self, name):
        runs = self.measured.get(name)
        return sum(runs) / len(runs) if runs else None

    def of(self, name):
        case = self.mean(CASE) or self.of_case
        return self.mean(name) or case * self.expected[name]


def makespan(costs, cores):
    """Wall time of runs of one core each that are started in this order."""
    free = [0.0] * max(1, cores)
    for cost in costs:
        heapq.heappush(free, heapq.heappop(free) + cost)
    return max(free)


def affordable(jobs, cost, cores, seconds, spent=None, budget=math.inf):
    """Those of the jobs that fit into so many seconds of wall time, in their order, and those that do not.

    spent    core time that each setting has taken so far; budget: core time of all. A setting gets at most its share, the case any.
    """
    chosen, left, taken = [], [], dict(spent or {})
    for name, seed in jobs:
        mine = cost(name) * MARGIN
        over = name != CASE and taken.get(name, 0.0) + mine > SHARE * budget
        if over or makespan([cost(other) * MARGIN for other, _ in chosen] + [mine], cores) > seconds:
            left.append((name, seed))
            continue
        chosen.append((name, seed))
        taken[name] = taken.get(name, 0.0) + mine
    return chosen, left


def narrower(half, count, further):
    """Half width to expect with so many further seeds."""
    return half * math.sqrt(count / (count + further)) * student_quantile(count + further) / student_quantile(count)


def next_jobs(parts, settings, seeds, cores, cost, there):
    """Runs that narrow the total most for their core time; empty where no setting may have more seeds.

    parts    "seeds" and parts of the computation -> (half width, number of seeds that it is from)
    seeds    all seeds that may be used, in order
    there    setting -> seeds that are done, or cannot be done
    """
    counts = {name: count for name, (_, count) in parts.items()}
    halves = {name: half for name, (half, _) in parts.items()}
    finer = {setting.part: setting.name for setting in settings if setting.is_finer and not setting.why_not}
    jobs = []

    def needed(part, further):
        names = [CASE] if part == "seeds" else [CASE, finer[part]]
        wanted = seeds[:counts[part] + further]
        return [(name, seed) for name in names for seed in wanted if seed not in there.get(name, ()) and (name, seed) not in jobs]

    while len(jobs) < 2 * cores:
        best = None
        for part in ("seeds", *PARTS):
            if part not in parts or (part != "seeds" and part not in finer) or counts[part] < 2 or counts[part] >= MOST or not halves[part] > 0:
                continue
            further = min(max(1, counts[part] // 3), MOST - counts[part])
            added = needed(part, further)
            price = sum(cost(name) for name, _ in added) or 1e-9
            gain = (halves[part] ** 2 - narrower(halves[part], counts[part], further) ** 2) / price
            if best is None or gain > best[0]:
                best = gain, part, further, added
        if best is None:
            break
        _, part, further, added = best
        halves[part] = narrower(halves[part], counts[part], further)
        counts[part] += further
        jobs += added
    return jobs
