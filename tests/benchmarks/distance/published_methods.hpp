// The penalty variants as published, rebuilt from their descriptions for comparison only.
//
// Source: K. Krestenitis, T. Weinzierl, T. Koziara, PPAM 2017; K. Krestenitis, T. Weinzierl, CCPE 2018, and the
// public code of that work. Their faults are kept: the penalty of PEN4 is not scale invariant, the convergence tests
// look at the last step, and the points need not lie on the triangles.
//
//   pen4   r = 1e5 lambda,   delta = 1e-2 T, times 1e4 after every step, 4 steps; failed when the last step is
//          longer than 1/8 margin of x, margin 0.01
//   pen7   r = 1e8 lambda^2, delta = 1e-16 T, times 2000 after the 4th step, 7 steps; failed when the last step is
//          longer than 1e-8
//   T = trace of the Hessian 2 G, lambda = sqrt(0.0125 T). Hybrid: batches of 8 pairs; a mean of the last steps above
//   1e-8 sends the whole batch to brute force.
#pragma once

#include "tests/benchmarks/distance/methods/distance_methods.hpp"

namespace scree {

enum class PublishedMethod { pen4, pen7, pen4_hybrid, pen7_hybrid };

void published_distances(PublishedMethod method, const PairBatch<double>& pairs, const AnswerBatch<double>& answers);
void published_distances(PublishedMethod method, const PairBatch<float>& pairs, const AnswerBatch<float>& answers);

/// Fused multiply-adds that one core does with the SIMD target in use, measured now [GFLOP/s], 2 per operation.
double measured_fma_peak(bool single);

}  // namespace scree
