"""A Gaussian process in place of the simulation: an answer as a function of the keys, with what is not known about it.

How: answer = f + noise, f a Gaussian process of covariance a^2 Matern 5/2 with a length for each key, by scikit-learn. Amplitude, lengths and noise
are not known either: members with other values are drawn from a Gaussian about the most probable ones (Laplace), by their probability. Their
spread is part of the uncertainty; without it, intervals from few runs are too narrow.
Source: Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), sections 2.2, 5.4 and eqs. 5.10 to 5.12 (leave one out).
"""
import warnings

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import minimize
from scipy.spatial.distance import cdist
from scipy.stats import multivariate_t
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

# Mean and deviation of the logarithms of amplitude squared, lengths and noise variance, where keys run from 0 to 1 and answers have mean 0 and
# deviation 1. Weak: an answer changes over something between a fifth of the bounds and five times their width.
PRIOR_AMPLITUDE = (np.log(1.5), 1.2)
PRIOR_LENGTH = (np.log(1.0), 0.8)
PRIOR_NOISE = (np.log(0.1), 2.0)
MEMBERS = 10
DRAWS = 60        # of which the members are the more probable ones
BLOCK = 512       # points at a time, so that their arrays stay in the cache


def covariance_of(theta, a, b):
    """Of f at the points a and b, as the kernels of scikit-learn, which take ten times as long for few points."""
    distance = np.sqrt(5) * cdist(a / np.exp(theta[1:-1]), b / np.exp(theta[1:-1]))
    return np.exp(theta[0]) * (1 + distance + distance**2 / 3) * np.exp(-distance)


class Surrogate:
    """An answer of the runs as a function of their point.

    in   points   N x D, each 0 to 1; a point may come several times (replicas)
    in   answers  N
    Cost: 0.2 s for 50 runs.
    """

    def __init__(self, points, answers):
        self.points, self.answers = np.asarray(points, float), np.asarray(answers, float)
        self.middle, self.scale = self.answers.mean(), self.answers.std() or 1.0
        self._y = (self.answers - self.middle) / self.scale
        dimension = self.points.shape[1]
        self._kernel = ConstantKernel(1.0, (1e-4, 1e4)) * Matern(np.ones(dimension), (1e-2, 1e2), nu=2.5) + WhiteKernel(0.1, (1e-8, 1e2))
        prior = np.array([PRIOR_AMPLITUDE] + [PRIOR_LENGTH] * dimension + [PRIOR_NOISE])

        def negative(model, theta):
            """Minus the logarithm of the probability of the hyperparameters, and its slope."""
            value, slope = model.log_marginal_likelihood(theta, eval_gradient=True, clone_kernel=False)
            z = (theta - prior[:, 0]) / prior[:, 1]
            return 0.5 * z @ z - value, z / prior[:, 1] - slope

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")   # of values at their bounds, which the priors keep them from
            model = self._fitted(prior[:, 0])
            starts = [prior[:, 0], prior[:, 0] + np.array([0.0] + [-1.0] * dimension + [-2.0])]
            best = min((minimize(lambda theta: negative(model, theta), start, jac=True, bounds=self._kernel.bounds, method="L-BFGS-B", options={"ftol": 1e-7}) for start in starts),
                       key=lambda result: result.fun)
            self.best = self._fitted(best.x)
            # Laplace: the curvature from differences of the slopes
            step = 1e-3
            curvature = np.array([(negative(model, best.x + step * unit)[1] - negative(model, best.x - step * unit)[1]) / (2 * step)
                                  for unit in np.eye(len(best.x))])
            values, vectors = np.linalg.eigh(0.5 * (curvature + curvature.T))
            covariance = (vectors / np.maximum(values, 1 / prior[:, 1].max() ** 2)) @ vectors.T
            draw = multivariate_t(best.x, covariance, df=6, seed=1)
            thetas = np.clip(draw.rvs(DRAWS), *self._kernel.bounds.T)
            worth = np.array([self._likelihood(theta) for theta in thetas]) - 0.5 * (((thetas - prior[:, 0]) / prior[:, 1]) ** 2).sum(axis=1) - draw.logpdf(thetas)
            worth = np.exp(worth - worth.max())
            # systematic draws by their worth
            chosen = np.searchsorted(np.cumsum(worth / worth.sum()), (np.arange(MEMBERS) + 0.5) / MEMBERS)
            self.thetas = thetas[np.minimum(chosen, DRAWS - 1)]
            self.members = [self._fitted(theta) for theta in self.thetas]

    def _likelihood(self, theta):
        """Logarithm of the probability of the answers, but for a constant."""
        lower = np.linalg.cholesky(covariance_of(theta, self.points, self.points) + (np.exp(theta[-1]) + 1e-9) * np.eye(len(self._y)))
        return -0.5 * (solve_triangular(lower, self._y, lower=True) ** 2).sum() - np.log(np.diag(lower)).sum()

    def _fitted(self, theta):
        return GaussianProcessRegressor(self._kernel.clone_with_theta(theta), alpha=1e-9, optimizer=None).fit(self.points, self._y)

    @property
    def noise(self):
        """Standard deviation of one run about the mean over seeds."""
        return self.scale * float(np.sqrt(np.mean(np.exp(self.thetas[:, -1]))))

    def predict(self, points):
        """Mean over seeds at the points, and the standard deviation of what is known of it."""
        parts = [self._predict(points[start:start + BLOCK]) for start in range(0, len(points), BLOCK)]
        return tuple(np.concatenate(part) for part in zip(*parts))

    def _predict(self, points):
        means, variances = [], []
        for theta, member in zip(self.thetas, self.members):
            between = covariance_of(theta, points, self.points)
            means.append(between @ member.alpha_.ravel())
            spread = solve_triangular(member.L_, between.T, lower=True, check_finite=False)
            variances.append(np.maximum(np.exp(theta[0]) - (spread**2).sum(axis=0), 0))
        mean = np.mean(means, axis=0)
        return self.middle + self.scale * mean, self.scale * np.sqrt(np.mean(variances, axis=0) + np.var(means, axis=0))

    def covariance(self, points):
        """Covariance of the mean over seeds at the points, of the most probable member."""
        _, covariance = self.best.predict(points, return_cov=True)
        return self.scale**2 * (covariance - np.exp(self.best.kernel_.theta[-1]) * np.eye(len(points)))

    def left_out(self):
        """For each run, how many standard deviations its answer lies off what all other runs say."""
        inverse = np.linalg.inv(self.best.L_ @ self.best.L_.T)
        return self.best.alpha_.ravel() / np.sqrt(np.diag(inverse))
