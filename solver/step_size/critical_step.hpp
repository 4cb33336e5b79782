// The largest stable step of the contacts that there are, and the pair that sets it.
//
// Every pair is linearised: stiffness K and damping C on the twelve velocities of its two bodies, mass-normalised. Per body,
// lambda_b is the largest eigenvalue of the sum of its blocks of K, gamma_b that of C. The largest squared frequency of the
// whole network is at most max over pairs of lambda_a + lambda_b: with G_b the mass-normalised square root of the stiffness at
// body b, the frequencies are the eigenvalues of sum_b G_b^T G_b, a sum of blocks on the contacts of b with norm lambda_b, and
// a contact lies in the blocks of its two bodies only. A pair that touches nothing else is solved as it is, exactly.
//
// The leapfrog with damping divided by 1 + gamma h / 4 (laws/damping.hpp) is stable while
//     h^2 lambda + 2 h gamma / (1 + h gamma / 4) <= 4.
// What is left out: geometric stiffness (forces times curvature, smaller by overlap over lever) and the fading of edges.
// Source: docs/reference/validation-plan.md section 2, with the sum over the two bodies of a pair in place of twice the largest.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "solver/contact/pair_stiffness.hpp"
#include "solver/pairs/forces.hpp"

namespace scree {

/// The pair as it is now.
PairStiffness linearise(const PairContact& look, LineariseFunction function);

/// What a body contributes to the bound of its pairs.
struct BodyBound {
  double lambda = 0, gamma = 0;  ///< [1/s^2], [1/s]
  std::int64_t pairs = 0;        ///< how many pairs it touches in
};

/// In place of a zone in the key of what a bond joins.
inline constexpr std::int32_t kBondZone = -2;

struct CriticalStep {
  double step = std::numeric_limits<double>::infinity();  ///< [s]
  PairKey key{-1, -1, -1};
  /// "bodies 3 and 7", for the user.
  std::string name() const {
    if (key.a < 0) return "no contact";
    if (key.zone == kBondZone) return fmt::format("bond of bodies {} and {}", key.a, key.b);
    return key.zone < 0 ? fmt::format("bodies {} and {}", key.a, key.b) : fmt::format("body {} and wall {}", key.a, key.b);
  }
};
/// Gathers the pairs in contact and finds the one that limits the step.
///
/// Eigenvalues are the dear part, and few are needed: a norm bounds each from above, and only bodies whose bound could still
/// set the step are solved. Memory: 72 numbers a body, and the matrices of pairs that touch nothing else.
class StabilityBound {
 public:
  explicit StabilityBound(std::size_t rows);
  /// Pairs must come sorted by key: the sums then have one order on any number of ranks.
  /// in   of_wall   what the inertia of a wall adds to omega^2 of its contacts [1/s^2]; 0 of one that cannot be pushed
  void add(const PairStiffness& pair, double of_wall = 0);
  /// The bound of a row, exact.
  const BodyBound& bound_of(std::size_t row);
  /// Takes the bound of a ghost from its owner, which knows all of its pairs.
  void set_bound(std::size_t row, const BodyBound& bound);
  /// in   corrected  damping is divided by 1 + h gamma / 4, as viscous damping is (laws/damping.hpp)
  CriticalStep critical_step(bool corrected = true);

 private:
  struct Row {
    std::array<double, 36> stiffness{}, damping{};  ///< sums over its pairs, mass-normalised
    BodyBound bound;
    bool is_exact = false;
  };
  struct Link {
    PairKey key;
    std::int32_t a, b, alone;  ///< rows; place in alone_ when neither touched anything before, else -1
    double of_wall;
  };
  /// At most the step of each link; of one that is alone its blocks bound it as well.
  std::vector<double> steps_below(bool corrected) const;
  double step_of(const Link& link, bool corrected);

  std::vector<Row> rows_;
  std::vector<Link> links_;
  std::vector<PairStiffness> alone_;
};

/// Largest h with h^2 lambda + 2 h gamma / (1 + h gamma / 4) <= 4, without the divisor when not corrected; infinite when both are 0.
double largest_stable_step(double lambda, double gamma, bool corrected = true);

}  // namespace scree
