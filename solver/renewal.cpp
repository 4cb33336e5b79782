// When the body lists are used up, and their renewal: the cut, migration, ghosts, pairs.
#include <algorithm>

#include "solver/simulation.hpp"

namespace scree {

namespace {

// Body lists last about this many steps at the speed of the fastest body; a longer skin means fewer renewals but
// more pairs. It never changes a result.
constexpr double kListSteps = 40;
constexpr double kSmallestListSkin = 0.02, kLargestListSkin = 0.5;  // of the smallest radius
// A cut costs about as much as tens of steps: not more often than this, and only for a real gain.
constexpr std::int64_t kStepsBetweenCuts = 500;
constexpr double kCutThreshold = 1.10;

}  // namespace

bool Simulation::lists_used_up() const {
  double limit = 0.5 * skin_;
  double walls_moved = 0;
  if (scene_.has_driven_walls()) {
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned; ++i) {
      for (const WallState& w : walls_) farthest = std::max(farthest, length(p_.x[i] - w.position) + p_.radius[i]);
    }
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      const Quat turn = conjugate(walls_listed_[k].orientation) * walls_[k].orientation;
      const double chord = 2 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
      walls_moved = std::max(walls_moved, length(walls_[k].position - walls_listed_[k].position) + chord * farthest);
    }
  }
  if (walls_moved > limit) return true;
  bool used = false;
  const auto count = static_cast<std::ptrdiff_t>(p_.owned);
#pragma omp parallel for schedule(static) reduction(|| : used)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    // written so that a NaN position counts as used up, and is then found by the guard
    if (!(squared_length(p_.x[i] - p_.x_listed[i]) <= limit * limit)) used = true;
  }
  return used;
}

void Simulation::check_domain() {
  const Domain& domain = scene_.source().settings.domain;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!is_finite(p_.x[i]) || !is_finite(p_.v[i]) || !is_finite(p_.L[i])) {
      throw RunInvalid("step {}: the state of body {} is not a finite number; the step is too large or the contact too stiff",
                       step_, p_.id[i]);
    }
    if (!domain.bounded || domain.outside != "stop") continue;
    const Vec3& x = p_.x[i];
    if (x.x < domain.lower.x || x.y < domain.lower.y || x.z < domain.lower.z || x.x > domain.upper.x ||
        x.y > domain.upper.y || x.z > domain.upper.z) {
      throw RunInvalid("step {}: body {} left the domain at ({:g}, {:g}, {:g}) m; widen domain or set outside = \"keep\"",
                       step_, p_.id[i], x.x, x.y, x.z);
    }
  }
}

void Simulation::renew_lists() {
  {
    PhaseTimer timer(times_, Phase::migrate);
    std::unique_ptr<Error> error = std::move(failure_);
    try {
      if (!error) check_domain();
    } catch (const Error& e) {
      error = std::make_unique<Error>(e);
    }
    mpi::agree(comm_, error.get());
    if (comm_.size() > 1) {
      // measured work of a body: what its pairs keep and look at
      std::fill(p_.work.begin(), p_.work.end(), 1.0);
      for (const BodyPair& pair : pairs_.pairs()) {
        const double work = 0.5 + 0.02 * static_cast<double>(pair.lists.corners_a.size() + pair.lists.corners_b.size() +
                                                             2 * pair.lists.edges.size());
        p_.work[static_cast<std::size_t>(pair.a)] += work;
        if (pair.b >= 0) p_.work[static_cast<std::size_t>(pair.b)] += work;
      }
      double mine = 0;
      for (std::size_t i = 0; i < p_.owned; ++i) mine += p_.work[i];
      const double mean = comm_.sum(mine) / comm_.size();
      const double largest = comm_.max(mine);
      const bool due = step_ - last_cut_step_ >= kStepsBetweenCuts && largest > kCutThreshold * mean;
      if (due) {
        halo_->rebalance(p_);
        last_cut_step_ = step_;
        ++cuts_;
      }
    }
    migrated_ += halo_->migrate(scene_, p_, pairs_);
    double fastest = 0, smallest = 1e300;
    for (std::size_t i = 0; i < p_.owned; ++i) {
      fastest = std::max(fastest, length(p_.v[i]));
      smallest = std::min(smallest, p_.radius[i]);
    }
    for (const WallState& w : walls_) fastest = std::max(fastest, length(w.velocity));
    fastest = comm_.max(fastest);
    smallest = -comm_.max(-smallest);
    skin_ = std::clamp(2 * kListSteps * fastest * step_size_.step, kSmallestListSkin * smallest, kLargestListSkin * smallest);
    halo_->make_ghosts(scene_, p_, skin_);
  }
  PhaseTimer timer(times_, Phase::search);
  pairs_.rebuild(scene_, p_, walls_, skin_);
  wall_pairs_.clear();
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (pairs_.pairs()[k].key.zone >= 0) wall_pairs_.push_back(static_cast<std::int32_t>(k));
  }
  std::copy(p_.x.begin(), p_.x.end(), p_.x_listed.begin());
  walls_listed_ = walls_;
  ++renewals_;
}

}  // namespace scree
