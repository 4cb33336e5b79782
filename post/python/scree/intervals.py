"""Intervals of numbers that scatter from seed to seed, and what a setting of the computation adds to a number. Nothing here runs anything.

Intervals are of 95 %:
- of the mean of fewer than 20 runs: Student's;
- of 20 runs and more: the studentised bootstrap (Efron and Tibshirani, An Introduction to the Bootstrap, 1993, section 12.5), which follows a skewed
  distribution. Fewer runs do not show the tails: the percentile bootstrap of 5 holds the mean in 85 % only;
- of 3 to 19 positive and skewed numbers: that of a lognormal distribution, from the logarithms (Olsson, Journal of Statistics Education 13(1),
  2005, section 3.4: Cox's method with Student's quantile). Logarithms whose variance is above 2 are of no such distribution, or of too few runs to
  say so (a number that is rounding in some runs); Student's is taken of these.

The value is always the mean of the runs.

An effect is the value at the setting of the case less the value at a finer setting, as differences between runs of the same seed. The effect of the
step is extrapolated to a step of zero by its measured order, if three steps show one.
"""
from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .errors import missing_package

CONFIDENCE = 0.95
BOOTSTRAP_FROM = 20      # runs; below this number a bootstrap is too narrow
RESAMPLES = 4000         # the ends of an interval are then reproducible to 3 % of its width
SKEWED = 0.3             # standard deviation over mean from which the logarithm is used: a normal distribution of positive numbers is rarely wider
ORDERS = (0.5, 4.0)      # of a step: measured orders outside are noise
RESOLVED = 0.5           # half width over value of a difference from which an order follows: above, its error is not linear any more
LOGNORMAL_FROM = 3       # runs: two have no shape
LARGEST_VARIANCE = 2     # of logarithms: up to a sigma of 1 intervals hold the truth in 93 % of 5 runs; without the limit one in a hundred is 100 times wider
MOST_SEEDS = 10_000
ROUNDING = 1e-9          # of a value: errors below it are those of sums


@dataclass(frozen=True)
class Interval:
    """A value with its interval of 95 %."""

    value: float     #: mean of the runs
    low: float       #: lower end
    high: float      #: upper end
    count: int       #: of runs
    method: str      #: "student", "bootstrap", "lognormal", or "none" with one run only

    @property
    def half(self) -> float:
        """Half width; the larger side of an interval that is not symmetric; NaN with one run."""
        return max(self.high - self.value, self.value - self.low)

    @property
    def is_seen(self) -> bool:
        """Whether the interval excludes zero."""
        return self.low > 0 or self.high < 0


def student_quantile(count: int) -> float:
    """Student's t of the interval of the mean of `count` runs."""
    try:
        from scipy.stats import t
    except ImportError as error:
        raise missing_package("an interval", "scipy") from error
    return float(t.ppf(0.5 + CONFIDENCE / 2, count - 1)) if count > 1 else math.nan


def _student(x: np.ndarray) -> Interval:
    mean = float(x.mean())
    half = student_quantile(len(x)) * float(x.std(ddof=1)) / math.sqrt(len(x))
    return Interval(mean, mean - half, mean + half, len(x), "student")


def _bootstrap(x: np.ndarray) -> Interval:
    mean, error = float(x.mean()), float(x.std(ddof=1)) / math.sqrt(len(x))
    drawn = x[np.random.default_rng(1).integers(0, len(x), (RESAMPLES, len(x)))]
    errors = drawn.std(axis=1, ddof=1) / math.sqrt(len(x))
    ratio = (drawn.mean(axis=1) - mean)[errors > 0] / errors[errors > 0]
    below, above = np.quantile(ratio, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2])
    return Interval(mean, mean - float(above) * error, mean - float(below) * error, len(x), "bootstrap")


def _lognormal(x: np.ndarray, logarithms: np.ndarray) -> Interval:
    mean, variance, count = float(x.mean()), float(logarithms.var(ddof=1)), len(x)
    middle = float(logarithms.mean()) + variance / 2
    half = student_quantile(count) * math.sqrt(variance / count + variance**2 / (2 * (count - 1)))
    return Interval(mean, min(mean, math.exp(middle - half)), max(mean, math.exp(middle + half)), count, "lognormal")


def mean_interval(samples: Iterable[float], *, is_signed: bool = False) -> Interval:
    """Interval of the mean of runs with different seeds.

    is_signed   true for differences, which the logarithm is never taken of
    With one run the ends are NaN; with runs that are all equal the interval has no width.
    """
    x = np.array(list(samples), dtype=float)
    if len(x) < 2:
        return Interval(float(x[0]) if len(x) else math.nan, math.nan, math.nan, len(x), "none")
    if np.ptp(x) == 0:
        return Interval(float(x[0]), float(x[0]), float(x[0]), len(x), "student")
    if len(x) >= BOOTSTRAP_FROM:
        return _bootstrap(x)
    if not is_signed and len(x) >= LOGNORMAL_FROM and x.min() > 0 and x.std(ddof=1) > SKEWED * x.mean():
        logarithms = np.log(x)
        if logarithms.var(ddof=1) <= LARGEST_VARIANCE:
            return _lognormal(x, logarithms)
    return _student(x)


@dataclass(frozen=True)
class Effect:
    """What a setting of the case adds to a number."""

    interval: Interval               #: of the effect, with its sign
    order: float | None = None       #: measured order of the step; None where the effect is not extrapolated
    note: str = ""                   #: why it is not extrapolated


Runs = Mapping[int, float]           # seed -> number


def _common(*runs: Runs) -> list[int]:
    return sorted(set(runs[0]).intersection(*runs[1:]))


def effect(case: Runs, finer: Runs) -> Effect | None:
    """Value at the setting of the case less value at the finer one, seed by seed; None without a seed that both have."""
    seeds = _common(case, finer)
    return Effect(mean_interval((case[s] - finer[s] for s in seeds), is_signed=True)) if seeds else None


def effect_of_step(case: Runs, finer: Runs, coarser: Runs, ratio: float = 2.0) -> Effect | None:
    """The same for the step, extrapolated to a step of zero where three steps show an order.

    With D1 the value at the step h less that at h / ratio, and D2 that at ratio h less that at h, the order is p = log(D2 / D1) / log(ratio), and the
    effect of h is D1 D2 / (D2 - D1) (Richardson, Phil. Trans. A 210, 1911). Its interval is that of the same expression, linear about the means, seed
    by seed. D1 and D2 - D1 must be known to half of their values; otherwise the effect is D1, the least that it can be.
    """
    plain = effect(case, finer)
    seeds = _common(case, finer, coarser)
    if plain is None or len(seeds) < 2:
        return plain and Effect(plain.interval, note="not extrapolated: that needs two seeds at three steps")
    near = np.array([case[s] - finer[s] for s in seeds])
    far = np.array([coarser[s] - case[s] for s in seeds])
    d1, d2 = float(near.mean()), float(far.mean())
    known = all(interval.half <= RESOLVED * abs(interval.value) for interval in (mean_interval(near, is_signed=True), mean_interval(far - near, is_signed=True)))
    if not known or d1 * d2 <= 0:
        return Effect(plain.interval, note="not extrapolated: the runs do not show its order")
    order = math.log(d2 / d1) / math.log(ratio)
    if not ORDERS[0] <= order <= ORDERS[1]:
        return Effect(plain.interval, note=f"not extrapolated: an order of {order:.2g} is none of a step")
    slope_near, slope_far = d2**2 / (d2 - d1) ** 2, -(d1**2) / (d2 - d1) ** 2
    value = d1 * d2 / (d2 - d1)
    spread = mean_interval(value + slope_near * (near - d1) + slope_far * (far - d2), is_signed=True)
    return Effect(spread, order=order)


def total_error(effects: Sequence[float], halves: Sequence[float]) -> float:
    """|sum of the signed effects| + root of the sum of squares of all half widths."""
    return abs(sum(effects)) + math.sqrt(sum(half**2 for half in halves))


def seeds_needed(goal: float, effects: Sequence[float], deviations: Sequence[float]) -> int | None:
    """Least number of seeds, of every part alike, with which the total error is at most the goal; None where no number is enough.

    deviations   standard deviation of one run, or of one difference, of each part
    """
    if abs(sum(effects)) >= goal:
        return None
    root = math.sqrt(sum(deviation**2 for deviation in deviations))
    if root == 0:
        return 2

    def is_enough(count: int) -> bool:
        return abs(sum(effects)) + student_quantile(count) * root / math.sqrt(count) <= goal

    low, high = 2, 2
    while not is_enough(high):
        if high >= MOST_SEEDS:
            return None
        low, high = high, 2 * high
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if is_enough(middle) else (middle + 1, high)
    return high


def deviation(interval: Interval) -> float:
    """Standard deviation of one run that the half width stands for, by Student; NaN with one run."""
    return interval.half * math.sqrt(interval.count) / student_quantile(interval.count) if interval.count > 1 else math.nan


def _digits(error: float) -> int:
    """Decimals that show one digit of an error, two where the first is a 1."""
    exponent = math.floor(math.log10(error))
    return -exponent + (1 if error / 10**exponent < 1.95 else 0)


def shown(value: float, half: float, effects: Mapping[str, float] | None = None, unit: str = "") -> str:
    """A number with its interval from seeds and its signed effects: "32.4 +- 0.8 (seeds) -0.3 (step) +0.1 (shape) deg".

    half     of the seeds; NaN where there is one run only, 0 where nothing scatters
    effects  by name; those that are zero in the digits shown are left out
    """
    effects = effects or {}
    sizes = [abs(x) for x in (half, *effects.values()) if math.isfinite(x) and abs(x) > ROUNDING * abs(value)]
    error = half if half in sizes else max(sizes, default=abs(value) * 1e-3)
    if not math.isfinite(value):
        return "none"
    shift = 0
    if value != 0 and not 1e-3 <= max(abs(value), error) < 1e6:
        shift = math.floor(math.log10(max(abs(value), error)))
    scale = 10.0**shift
    places = min(12, max(0, _digits(error / scale))) if error > 0 else 3

    def number(x: float, sign: str = "") -> str:
        text = f"{x / scale:{sign}.{places}f}"
        return text.replace("-", "") if float(text) == 0 else text

    text = number(value) + (f" +- {number(half)} (seeds)" if half > 0 else " (one seed)" if math.isnan(half) else "")
    text += "".join(f" {number(x, '+')} ({name})" for name, x in effects.items() if float(number(x)) != 0)
    text = f"({text})e{shift}" if shift else text
    return f"{text} {unit}".strip() if unit not in ("-", "") else text
