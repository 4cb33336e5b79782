// A sum that keeps what rounding takes from it: temperatures of bodies, what passed from their media, places in a cell that deforms.
#pragma once

namespace scree {

/// Source: D. Knuth, The Art of Computer Programming 2, 4.2.2.   in/out   sum, remainder   what the sum lacks
inline void add_keeping_rest(double term, double& sum, double& remainder) {
  const double before = sum, change = term + remainder;
  sum = before + change;
  const double part = sum - before;
  remainder = (before - (sum - part)) + (change - part);
}

}  // namespace scree
