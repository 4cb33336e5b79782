// Whether two triangles have a point in common, decided exactly.
#pragma once

namespace scree {

/// True when the closed triangles a and b (three corners of three coordinates each) share a point: touching counts,
/// and so does a shared corner. Triangles that are segments or points are taken as such.
///
/// How: signs of determinants, first in floating point with a bound on their error, where that cannot decide with twice
/// the digits, and at last in exact arithmetic (expansions: sums of doubles that do not overlap).
/// Source: J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
/// Fails: never; false when a coordinate is not finite.   Cost: about 0.2 microseconds, one more for each sign that
/// needs exact arithmetic; no allocation.
/// Limits: bits below 2^-650 times the largest coordinate are lost. Single precision never has such.
bool triangles_intersect(const double a[9], const double b[9]);

}  // namespace scree
