// When the body lists are used up, and their rebuild: the cut, migration, ghosts, pairs.
#include <algorithm>
#include <cmath>

#include "solver/built_with.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

namespace {

// Body lists last about this many steps at the speed of the fastest body; a longer skin means fewer rebuilds but
// more pairs. It never changes a result.
constexpr double kListSteps = 40;
constexpr double kSmallestListSkin = 0.02, kLargestListSkin = 0.5;  // of the smallest radius
constexpr double kShareOfRoom = 0.999;                              // of the room that a periodic domain leaves: the rest is for rounding
// Of the skin. A pair of which one rank alone has a ghost, since reaches are rounded, is not in reach before lists are rebuilt.
constexpr double kShareOfSkin = 1 - 1e-6;

// Ranks learn one step late that one of them needs new lists, so a rank asks for them while they still hold for a step that
// it has not computed. The next displacement is dt v + dt^2 a with an acceleration that is known from the last step only:
// its share counts twice, and this part of the skin stays in hand. A contact of N steps changes a displacement by at most
// (pi / N)^2 of the one before it, 2.5 % for N = 20. What is in hand is then more than a contact gives to a body at rest. Where
// contacts last less than kFewSteps, or the lists less than kStepsOfRoom of the fastest body or wall, the ranks agree at once
// instead: so they do until a first step has shown the forces.
constexpr double kSkinInHand = 0.2;
constexpr double kVelocityShare = 1.25, kAccelerationShare = 2;
constexpr double kFewSteps = 10, kStepsOfRoom = 4;

}  // namespace

double Simulation::walls_moved(const std::vector<WallState>& from, const std::vector<WallState>& to) const {
  if (!scene_.has_driven_walls()) return 0;
  double moved = 0;
  for (std::size_t k = 0; k < to.size(); ++k) {
    const Quat turn = conjugate(from[k].orientation) * to[k].orientation;
    const double chord = 2 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned && chord > 0; ++i) {
      farthest = std::max(farthest, length(p_.x[i] - to[k].position) + p_.radius[i]);
    }
    moved = std::max(moved, length(to[k].position - from[k].position) + chord * farthest);
  }
  return moved;
}

double Simulation::fastest_wall(const std::vector<WallState>& walls) const {
  double fastest = 0;
  for (const WallState& w : walls) {
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned && length(w.angular_velocity) > 0; ++i) {
      farthest = std::max(farthest, length(p_.x[i] - w.position) + p_.radius[i]);
    }
    fastest = std::max(fastest, length(w.velocity) + farthest * length(w.angular_velocity));
  }
  return fastest;
}

double Simulation::list_skin(double fastest) const {
  double skin = std::clamp(2 * kListSteps * fastest * dt_, kSmallestListSkin * smallest_radius_, kLargestListSkin * smallest_radius_);
  // a quarter of a period holds the reach of a body, its half of the skin included (see check_period)
  for (int k = 0; k < 3; ++k) {
    if (!scene_.periodicity().is_periodic(k)) continue;
    const double room = 0.25 * scene_.periodicity().period()[k] - scene_.largest_radius() - scene_.margin();
    skin = std::min(skin, 2 * kShareOfRoom * room);
  }
  return skin;
}

bool Simulation::may_look_ahead(double skin) const {
  return comm_.size() > 1 && step_size_.contact_time >= kFewSteps * step_size_.step && 0.5 * skin >= kStepsOfRoom * fastest_ * dt_;
}

/// What this rank has to tell. `rebuilt`: new lists are made in this step, for bodies of this speed [m/s].
StepReport Simulation::look_at_lists(bool rebuilt, double speed_of_lists) {
  const double limit = 0.5 * kShareOfSkin * (rebuilt ? list_skin(speed_of_lists) : skin_), dt = dt_;
  const bool ahead = comm_.size() > 1 && step_size_.contact_time >= kFewSteps * step_size_.step;
  bool beyond = !rebuilt && walls_moved(walls_listed_, walls_) > limit, soon = beyond;
  double fastest = fastest_wall(walls_);
  if (ahead && scene_.has_driven_walls()) {
    std::vector<WallState> next;
    for (const Wall& wall : scene_.source().walls) next.push_back(wall_state(wall, time() + dt));
    soon = soon || walls_moved(rebuilt ? walls_ : walls_listed_, next) > limit;
    fastest = std::max(fastest, fastest_wall(next));
  }
  const double ask = ahead ? (1 - kSkinInHand) * limit : limit;
  const double ahead_v = ahead ? kVelocityShare * dt : 0, ahead_a = ahead ? kAccelerationShare * dt : 0;
  const auto count = static_cast<std::ptrdiff_t>(p_.owned);
#pragma omp parallel for schedule(static) reduction(|| : beyond, soon) reduction(max : fastest)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const double moved = rebuilt ? 0.0 : length(p_.x[i] - p_.x_listed[i]), speed = length(p_.v[i]);
    const double gain = ahead_a * p_.inverse_mass[i] * length(p_.force[i]);
    // written so that a NaN position counts as used up, and is then found by the guard
    if (!(moved <= limit)) beyond = true;
    if (!(moved + ahead_v * speed + dt * gain <= ask)) soon = true;
    fastest = std::max({fastest, speed, gain});  // from rest, the acceleration tells what comes
  }
  StepReport report;
  report.rebuild = beyond || soon || (rebuild_asked_ && !rebuilt) ? 1 : 0;
  rebuild_asked_ = false;
  report.fastest = fastest;
  lists_overrun_ = beyond;
  return report;
}

void Simulation::cut_anew(bool is_first) {
  const auto start = std::chrono::steady_clock::now();
  const double expected = halo_->rebalance(p_, balance_.work_of_bodies(p_));
  migrated_ += halo_->migrate(scene_, p_, pairs_);
  // the first one sends most bodies round and sets up the library: it says nothing about what the next would cost
  const double seconds = is_first ? 0 : std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  balance_.note_cut(seconds, expected, p_);
}

void Simulation::rebuild_lists(const StepReport& report) {
  {
    const PhaseTimer timer(times_, Phase::migrate);
    try {
      if (!failure_) check_finite();
    } catch (const Error& e) {
      fail(e);
    }
    agree_on_failures();
    if (!built_with::kRanks) {
      // nobody to send to
    } else if (balance_.is_cut_due(report)) {
      cut_anew(false);
      ++cuts_;
    } else {
      migrated_ += halo_->migrate(scene_, p_, pairs_);
    }
    if (removal_due_) remove_outside();
    removal_due_ = false;
    skin_ = list_skin(report.fastest);
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
    ++rebuilds_;
  }
  times_[static_cast<std::size_t>(Phase::search)] -= times_[static_cast<std::size_t>(Phase::sort)] - sorted;
}

}  // namespace scree
