#!/usr/bin/env python3
"""Intervals hold the truth as often as they say, and effects of settings are found with their sign."""
import math
import unittest

import numpy as np
from scree.intervals import deviation, effect, effect_of_step, mean_interval, seeds_needed, shown, student_quantile, total_error

DRAWS = 500
HELD = (0.925, 0.975)   # of 500 draws at 95 %: three standard deviations are 0.029


def held(draw, truth, count, seed=1):
    """Share of the draws whose interval holds the truth."""
    random = np.random.default_rng(seed)
    intervals = [mean_interval(draw(random, count)) for _ in range(DRAWS)]
    return sum(entry.low <= truth <= entry.high for entry in intervals) / DRAWS, intervals


class IntervalsTest(unittest.TestCase):
    def test_normal_numbers(self):
        for count in (3, 5, 12):
            share, intervals = held(lambda random, n: 20 + 2 * random.standard_normal(n), 20, count)
            self.assertTrue(HELD[0] <= share <= HELD[1], (count, share))
            self.assertEqual({entry.method for entry in intervals}, {"student"})

    def test_half_widths_are_those_of_the_tables_of_student(self):
        self.assertAlmostEqual(student_quantile(5), 2.776, places=3)   # 4 degrees of freedom
        interval = mean_interval([11, 12, 13, 14, 15])
        self.assertAlmostEqual(interval.half, 2.776445 * math.sqrt(2.5 / 5), places=5)
        self.assertAlmostEqual(deviation(interval), math.sqrt(2.5))

    def test_skewed_positive_numbers_by_their_logarithm(self):
        for sigma, count in ((0.6, 5), (1.0, 5), (0.6, 10)):
            share, intervals = held(lambda random, n: np.exp(sigma * random.standard_normal(n)), math.exp(sigma**2 / 2), count)
            self.assertTrue(HELD[0] <= share <= HELD[1], (sigma, count, share))
            self.assertGreater(sum(entry.method == "lognormal" for entry in intervals), 0.7 * DRAWS)

    def test_the_value_is_the_mean_of_the_runs_however_they_scatter(self):
        """Numbers that are rounding in some runs, and nothing in others."""
        for runs in ([1e-4, 0.01, 1], [1, 2, 30], [1e-8, 1, 1, 1, 1], [6.8e-35, 9.4e-35, 5.6e-35, 3.3e-4, 3.1e-4], [1e-300, 1e-20, 1], [1.0, 2.0, 3.5], [0.0, 1, 1]):
            interval = mean_interval(runs)
            self.assertEqual(interval.value, np.mean(runs), runs)
            self.assertTrue(interval.low <= interval.value <= interval.high, runs)
            self.assertLess(interval.half, 5 * max(runs), runs)

    def test_the_bootstrap_from_twenty_runs_on(self):
        for name, draw, truth in (("normal", lambda random, n: random.standard_normal(n), 0.0), ("gamma", lambda random, n: random.gamma(3, 1, n), 3.0)):
            share, intervals = held(draw, truth, 20)
            self.assertTrue(HELD[0] <= share <= HELD[1], (name, share))
            self.assertEqual({entry.method for entry in intervals}, {"bootstrap"})

    def test_a_percentile_bootstrap_of_five_would_hold_too_little(self):
        """Why there is none: what this module refuses to do."""
        random, inside = np.random.default_rng(1), 0
        for _ in range(DRAWS):
            x = random.standard_normal(5)
            low, high = np.quantile(x[random.integers(0, 5, (500, 5))].mean(axis=1), [0.025, 0.975])
            inside += low <= 0 <= high
        self.assertLess(inside / DRAWS, 0.88)

    def test_paired_effects_are_found_with_their_sign(self):
        """The scatter of a seed is the same at both settings but for a part: differences see a tenth of what two means would."""
        random, inside, signs = np.random.default_rng(2), 0, 0
        for draw in range(DRAWS):
            bias = 0.5 if draw % 2 else -0.5
            seeds = {seed: 10 + random.standard_normal() for seed in range(5)}
            case = {seed: value + bias + 0.15 * random.standard_normal() for seed, value in seeds.items()}
            finer = {seed: value + 0.15 * random.standard_normal() for seed, value in seeds.items()}
            found = effect(case, finer).interval
            inside += found.low <= bias <= found.high
            signs += found.is_seen and found.value * bias > 0
            self.assertFalse(found.is_seen and found.value * bias < 0)
        self.assertTrue(HELD[0] <= inside / DRAWS <= HELD[1], inside / DRAWS)
        self.assertGreater(signs / DRAWS, 0.9)

    def test_the_step_is_extrapolated_by_its_measured_order(self):
        for order in (1, 2):
            random, inside = np.random.default_rng(3), 0
            for _ in range(DRAWS):
                at = [{seed: 5 + 0.4 * h**order + 0.01 * random.standard_normal() for seed in range(5)} for h in (1.0, 0.5, 2.0)]
                found = effect_of_step(*at)
                self.assertIsNotNone(found.order)
                self.assertLess(abs(found.order - order), 0.35)
                inside += found.interval.low <= 0.4 <= found.interval.high
            self.assertTrue(HELD[0] <= inside / DRAWS <= HELD[1], (order, inside / DRAWS))

    def test_the_step_is_exact_without_noise(self):
        found = effect_of_step(*({seed: seed + 0.3 * h**2 for seed in range(3)} for h in (1.0, 0.5, 2.0)))
        self.assertAlmostEqual(found.interval.value, 0.3)
        self.assertAlmostEqual(found.order, 2)
        self.assertLess(found.interval.half, 1e-12)

    def test_noise_has_no_order(self):
        random, extrapolated, inside = np.random.default_rng(4), 0, 0
        for _ in range(DRAWS):
            found = effect_of_step(*({seed: random.standard_normal() for seed in range(5)} for _ in range(3)))
            extrapolated += found.order is not None
            inside += found.interval.low <= 0 <= found.interval.high
        self.assertLess(extrapolated / DRAWS, 0.01)
        self.assertTrue(HELD[0] <= inside / DRAWS <= HELD[1], inside / DRAWS)

    def test_totals_and_seeds_for_a_goal(self):
        self.assertAlmostEqual(total_error([0.3, -0.1], [0.3, 0.4]), 0.7)
        self.assertIsNone(seeds_needed(0.2, [0.3, -0.1], [1.0]))
        self.assertIsNone(seeds_needed(1e-6, [], [1.0]))   # more than 10 000
        needed = seeds_needed(0.5, [0.1], [0.3, 0.4])
        width = lambda count: 0.1 + student_quantile(count) * 0.5 / math.sqrt(count)  # noqa: E731
        self.assertLessEqual(width(needed), 0.5)
        self.assertGreater(width(needed - 1), 0.5)

    def test_few_runs(self):
        self.assertTrue(math.isnan(mean_interval([3.0]).half))
        self.assertFalse(mean_interval([3.0]).is_seen)
        self.assertEqual(mean_interval([3.0, 3.0, 3.0]).half, 0)
        self.assertIsNone(effect({1: 2.0}, {2: 3.0}))
        self.assertIn("two seeds", effect_of_step({1: 2.0}, {1: 3.0}, {}).note)

    def test_numbers_are_shown_with_their_errors(self):
        self.assertEqual(shown(32.41, 0.82, {"step": -0.31, "shape": 0.13}, "deg"), "32.4 +- 0.8 (seeds) -0.3 (step) +0.1 (shape) deg")
        self.assertEqual(shown(32.41, 0.16, {"step": 0.001}), "32.41 +- 0.16 (seeds)")
        self.assertEqual(shown(4.213e-9, 2e-11, {"margin": -3e-11}, "m^3"), "(4.21 +- 0.02 (seeds) -0.03 (margin))e-9 m^3")
        self.assertEqual(shown(1234.0, 56.0), "1234 +- 56 (seeds)")
        self.assertEqual(shown(-0.001, 0.03), "0.00 +- 0.03 (seeds)")
        self.assertEqual(shown(2.0, math.nan, {"step": 0.1}), "2.00 (one seed) +0.10 (step)")
        self.assertEqual(shown(20.0, 0.0), "20.00")


if __name__ == "__main__":
    unittest.main()
