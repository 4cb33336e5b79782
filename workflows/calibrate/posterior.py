"""Which keys agree with the measured answers: the posterior over the box of the bounds, its intervals, its ridges, and where to run next.

How: uniform prior in the box; each measured answer is Gaussian about the surrogate's mean, with the variance of the measurement and that of the
surrogate together. Weighted Sobol points in a box that is shrunk about what has weight: no chain to converge, the same numbers every time.
Keys run from 0 to 1 between their bounds throughout.
"""
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

POINTS = 2**12        # of a round; 2^12 place the ends of intervals to a hundredth of their width
ROUGH = 2**10         # enough to choose where to run next
ENOUGH = 0.2          # of the points of a round have weight: effective number
ROUNDS = 8
OUT_OF_REACH = 12.0   # log-likelihood below the best from where on a point has no weight: exp(-12) of the best


def sobol(count, dimension, seed):
    """Points of a scrambled Sobol sequence; count is rounded up to a power of two, as the sequence wants it, and cut."""
    return qmc.Sobol(dimension, seed=seed).random_base2(int(np.ceil(np.log2(max(count, 2)))))[:count]


def log_likelihood(points, surrogates, measured):
    """Of points in the box. measured: a (value, standard deviation) for each surrogate."""
    total = np.zeros(len(points))
    for surrogate, (value, deviation) in zip(surrogates, measured):
        mean, unsure = surrogate.predict(points)
        variance = deviation**2 + unsure**2
        total -= 0.5 * np.log(variance) + 0.5 * (value - mean) ** 2 / variance
    return total


@dataclass
class Posterior:
    points: np.ndarray    # N x D
    weights: np.ndarray   # N, sum 1
    likelihood: np.ndarray  # logarithm, N

    @property
    def mean(self):
        return self.weights @ self.points

    @property
    def covariance(self):
        off = self.points - self.mean
        return (self.weights[:, None] * off).T @ off

    def even(self, count=2000):
        """Points of equal weight."""
        order = np.argsort(self.points[:, 0], kind="stable")   # so that the draws are spread along the first key
        cumulative = np.cumsum(self.weights[order])
        return self.points[order[np.minimum(np.searchsorted(cumulative, (np.arange(count) + 0.5) / count), len(order) - 1)]]

    def best(self):
        """Of the points that meet the answers about equally well (within 0.5 of the best log-likelihood), the one nearest to the mean."""
        close = np.flatnonzero(self.likelihood >= self.likelihood.max() - 0.5)
        return self.points[close[np.argmin(((self.points[close] - self.mean) ** 2).sum(axis=1))]]

    def interval(self, key, share=0.95):
        """The shortest interval that holds that share; it may end at a bound."""
        order = np.argsort(self.points[:, key])
        x = np.concatenate([[0.0], self.points[order, key], [1.0]])
        cumulative = np.concatenate([[0.0], np.cumsum(self.weights[order]), [1.0]])
        starts = np.linspace(0, 1 - share, 201)
        low, high = np.interp(starts, cumulative, x), np.interp(starts + share, cumulative, x)
        k = np.argmin(high - low)
        return float(low[k]), float(high[k])


def posterior(surrogates, measured, dimension, seed=0, count=POINTS):
    """The posterior; the box is shrunk until enough points have weight."""
    low, high = np.zeros(dimension), np.ones(dimension)
    for number in range(ROUNDS):
        points = low + (high - low) * sobol(count, dimension, seed + number)
        likelihood = log_likelihood(points, surrogates, measured)
        weights = np.exp(likelihood - likelihood.max())
        if weights.sum() ** 2 / (weights**2).sum() >= ENOUGH * POINTS * min(1, count / POINTS) or number + 1 == ROUNDS:
            break
        inside = points[likelihood > likelihood.max() - OUT_OF_REACH]
        spare = 0.1 * (inside.max(axis=0) - inside.min(axis=0)) + (high - low) / count ** (1 / dimension)
        new_low, new_high = np.maximum(0, inside.min(axis=0) - spare), np.minimum(1, inside.max(axis=0) + spare)
        if np.prod((new_high - new_low) / (high - low)) > 0.7:   # a ridge across the box: more points instead
            count = min(2 * count, 2**15)
        low, high = new_low, new_high
    return Posterior(points, weights / weights.sum(), likelihood)


def narrowing(points, one, other, bins=12):
    """Deviation of one key where the other is known, over its deviation where it is not: near 1 when they are distinguished, near 0 on a ridge.
    points: of equal weight."""
    order = np.argsort(points[:, other], kind="stable")
    within = np.mean([points[part, one].var() for part in np.array_split(order, bins)])
    return float(np.sqrt(within / points[:, one].var()))


def ridge(points, stations=5):
    """Points along the widest direction, in curves: means of the points of equal weight, ordered along it. stations x D."""
    values, vectors = np.linalg.eigh(np.cov(points.T).reshape(points.shape[1], -1))
    along = (points - points.mean(axis=0)) @ vectors[:, -1]
    return np.array([points[part].mean(axis=0) for part in np.array_split(np.argsort(along, kind="stable"), stations)])


def unsure_share(surrogates, measured, points):
    """For each answer: standard deviation of the surrogate, over the points of the posterior, in those of the measurement."""
    return [float(np.sqrt(np.mean(surrogate.predict(points)[1] ** 2)) / deviation) for surrogate, (_, deviation) in zip(surrogates, measured)]


def next_runs(scenes, measured, found, count, seed):
    """Where `count` more runs narrow the answers most, over the posterior: greedy, each as if those before it had been made.

    in   scenes    name -> surrogates of its answers
    in   measured  name -> (value, standard deviation) of each of these
    out  list of (name of the scene, point)
    The gain of a run at x: sum over answers and points p of the posterior of cov(x, p)^2 / (var(x) + noise^2), over the variance of the answer at p.
    """
    dimension = found.points.shape[1]
    places = found.even(120)
    random = np.random.default_rng(seed)
    near = np.clip(places[random.permutation(len(places))[:60]] + 0.05 * random.standard_normal((60, dimension)), 0, 1)
    candidates = np.concatenate([near, sobol(60, dimension, seed)])
    everything = np.concatenate([candidates, places])
    n = len(candidates)
    parts = []
    for name, surrogates in scenes.items():
        for surrogate, (_, deviation) in zip(surrogates, measured[name]):
            covariance = surrogate.covariance(everything)
            parts.append((name, covariance, surrogate.noise**2, deviation**2 + np.maximum(np.diag(covariance)[n:], 0)))
    chosen = []
    for _ in range(count):
        gains = {name: np.zeros(n) for name in scenes}
        for name, covariance, noise, variance in parts:
            gains[name] += (covariance[:n, n:] ** 2 / variance).sum(axis=1) / (np.maximum(np.diag(covariance)[:n], 0) + noise)
        scene = max(gains, key=lambda name: gains[name].max())
        k = int(np.argmax(gains[scene]))
        chosen.append((scene, candidates[k]))
        parts = [(name, covariance - np.outer(covariance[:, k], covariance[k]) / (covariance[k, k] + noise) if name == scene else covariance, noise, variance)
                 for name, covariance, noise, variance in parts]
    return chosen
