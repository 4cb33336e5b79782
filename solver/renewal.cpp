// When the body lists are used up, and their renewal: the cut, migration, ghosts, pairs.
#include <algorithm>
#include <cmath>

#include "solver/built_with.hpp"
#include "solver/simulation.hpp"

namespace scree {

namespace {

// Body lists last about this many steps at the speed of the fastest body; a longer skin means fewer renewals but
// more pairs. It never changes a result.
constexpr double kListSteps = 40;
constexpr double kSmallestListSkin = 0.02, kLargestListSkin = 0.5;  // of the smallest radius
constexpr double kShareOfRoom = 0.999;  // of the room that a periodic domain leaves: the rest is for rounding

// Ranks learn one step late that one of them needs new lists, so a rank asks for them while they still hold for a step that
// it has not computed. The next displacement is dt v + dt^2 a with an acceleration that is known from the last step only:
// its share counts twice, and this part of the skin stays in hand. A contact of N steps changes a displacement by at most
// (pi / N)^2 of the one before it, 2.5 % for N = 20; below kFewSteps the ranks agree at once instead.
constexpr double kSkinInHand = 0.2;
constexpr double kVelocityShare = 1.25, kAccelerationShare = 2;

}  // namespace

double Simulation::walls_moved(const std::vector<WallState>& walls) const {
  if (!scene_.has_driven_walls()) return 0;
  double moved = 0;
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const Quat turn = conjugate(walls_listed_[k].orientation) * walls[k].orientation;
    const double chord = 2 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned && chord > 0; ++i) {
      farthest = std::max(farthest, length(p_.x[i] - walls[k].position) + p_.radius[i]);
    }
    moved = std::max(moved, length(walls[k].position - walls_listed_[k].position) + chord * farthest);
  }
  return moved;
}

double Simulation::fastest_wall() const {
  double fastest = 0;
  for (const WallState& w : walls_) {
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned && length(w.angular_velocity) > 0; ++i) {
      farthest = std::max(farthest, length(p_.x[i] - w.position) + p_.radius[i]);
    }
    fastest = std::max(fastest, length(w.velocity) + farthest * length(w.angular_velocity));
  }
  return fastest;
}

StepNews Simulation::look_at_lists() {
  const double limit = 0.5 * skin_, dt = dt_;
  bool beyond = walls_moved(walls_) > limit, soon = beyond;
  if (looks_ahead_ && scene_.has_driven_walls()) {
    std::vector<WallState> next;
    for (const Wall& wall : scene_.source().walls) next.push_back(wall_state(wall, time() + dt));
    soon = soon || walls_moved(next) > limit;
  }
  double fastest = 0;
  const double ask = looks_ahead_ ? (1 - kSkinInHand) * limit : limit;
  const double ahead_v = looks_ahead_ ? kVelocityShare * dt : 0, ahead_a = looks_ahead_ ? kAccelerationShare * dt * dt : 0;
  const auto count = static_cast<std::ptrdiff_t>(p_.owned);
#pragma omp parallel for schedule(static) reduction(|| : beyond, soon) reduction(max : fastest)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double moved = length(p_.x[i] - p_.x_listed[i]), speed = length(p_.v[i]);
    // written so that a NaN position counts as used up, and is then found by the guard
    if (!(moved <= limit)) beyond = true;
    if (!(moved + ahead_v * speed + ahead_a * p_.inverse_mass[i] * length(p_.force[i]) <= ask)) soon = true;
    fastest = std::max(fastest, speed);
  }
  StepNews news;
  news.renew = beyond || soon || renewal_asked_ ? 1 : 0;
  renewal_asked_ = false;
  news.fastest = std::max(fastest, fastest_wall());
  lists_overrun_ = beyond;
  return news;
}

void Simulation::cut_anew(bool is_first) {
  const auto start = std::chrono::steady_clock::now();
  const double expected = halo_->rebalance(p_, balance_.work_of_bodies(p_));
  migrated_ += halo_->migrate(scene_, p_, pairs_);
  // the first one sends most bodies round and sets up the library: it says nothing about what the next would cost
  const double seconds = is_first ? 0 : std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  balance_.note_cut(seconds, expected, p_);
}

void Simulation::renew_lists(const StepNews& news) {
  {
    const PhaseTimer timer(times_, Phase::migrate);
    try {
      if (!failure_) check_domain();
    } catch (const Error& e) {
      fail(e);
    }
    agree_on_failures();
    if (!built_with::kRanks) {
      // nobody to send to
    } else if (balance_.is_cut_due(news)) {
      cut_anew(false);
      ++cuts_;
    } else {
      migrated_ += halo_->migrate(scene_, p_, pairs_);
    }
    if (removal_due_) remove_outside();
    removal_due_ = false;
    skin_ = std::clamp(2 * kListSteps * news.fastest * dt_, kSmallestListSkin * smallest_radius_,
                       kLargestListSkin * smallest_radius_);
    // a quarter of a period holds the reach of a body, its half of the skin included (see check_period)
    for (int k = 0; k < 3; ++k) {
      if (!scene_.periodicity().is_periodic(k)) continue;
      const double room = 0.25 * scene_.periodicity().period()[k] - scene_.largest_radius() - scene_.margin();
      skin_ = std::min(skin_, 2 * kShareOfRoom * room);
    }
    if (built_with::kRanks) halo_->make_ghosts(scene_, p_, skin_);
  }
  const double sorted = times_[static_cast<std::size_t>(Phase::sort)];
  {
    const PhaseTimer timer(times_, Phase::search);
    const WorkTimer work(balance_.computing(), comm_.size() > 1 ? 1 : 0);
    pairs_.rebuild(scene_, p_, walls_, skin_, times_);
    wall_pairs_.clear();
    for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
      if (pairs_.pairs()[k].key.zone >= 0) wall_pairs_.push_back(static_cast<std::int32_t>(k));
    }
    std::copy(p_.x.begin(), p_.x.end(), p_.x_listed.begin());
    walls_listed_ = walls_;
    ++renewals_;
  }
  times_[static_cast<std::size_t>(Phase::search)] -= times_[static_cast<std::size_t>(Phase::sort)] - sorted;
}

}  // namespace scree
