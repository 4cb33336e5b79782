#include "solver/step/neighbour_lists.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/bodies/body_passes.hpp"
#include "solver/step/balls_alone.hpp"

namespace scree {

namespace {

// Body lists last about this many steps at the speed of the fastest body; a longer skin means fewer rebuilds but
// more pairs. It never changes a result.
constexpr double kListSteps = 40;
constexpr double kSmallestListSkin = 0.02, kLargestListSkin = 0.5;  // of the smallest radius
// Where balls go without a break, a pair that does not touch costs nothing in a step: measured from 40 to 1000 steps and 0.02 to 0.5, a
// falling and resting bed is fastest with these, by 15 %.
constexpr double kListStepsOfBalls = 300, kSmallestSkinOfBalls = 0.2;
constexpr double kShareOfRoom = 0.999;  // of the room that a periodic domain leaves: the rest is for rounding
// Of the skin. A pair of which one rank alone has a ghost, since reaches are rounded, is not in reach before lists are rebuilt.
constexpr double kShareOfSkin = 1 - 1e-6;

// Looking ahead: the next displacement is dt v + dt^2 a with an acceleration that is known from the last step only:
// its share counts twice, and this part of the skin stays in hand. A contact of N steps changes a displacement by at most
// (pi / N)^2 of the one before it, 2.5 % for N = 20. What is in hand is then more than a contact gives to a body at rest. Where
// contacts last less than kFewSteps, or the lists less than kStepsOfRoom of the fastest body or wall, the ranks agree at once
// instead: so they do until a first step has shown the forces.
constexpr double kSkinInHand = 0.2;
constexpr double kVelocityShare = 1.25, kAccelerationShare = 2;
constexpr double kFewSteps = 10, kStepsOfRoom = 4;

/// Whether contacts are slow enough to look ahead. The place of a force-controlled wall is not known beforehand, and no more is the cell.
bool can_agree_ahead(const RunState& s) {
  return s.comm.size() > 1 && s.clock.size.contact_time >= kFewSteps * s.clock.size.step && !s.scene.has_answering_walls() &&
         !s.particles.cell.deforms();
}

/// What a cell that has deformed since the lists were made takes of their skin [m]. Two bodies that were too far apart to be listed, by
/// the skin beyond their reach, are nearer by that, whatever they have moved beside the cell; for the ways of those that are listed it
/// counts also where the cell grows.
double skin_of_cell(const RunState& s, const UpperMatrix& listed, double skin) {
  const Cell& cell = s.particles.cell;
  if (!cell.deforms()) return 0;
  if (!(listed.diagonal.x > 0)) return 0;
  UpperMatrix stretch = cell.edges() * inverse(listed);
  for (int k = 0; k < 3; ++k) stretch[k] = cell.edges()[k] / listed[k] - 1;
  return stretch.largest_stretch() * longest_branch(s.facts.largest_radius, s.scene.contact_range(), skin);
}

/// How fast bodies that touch go towards each other with their cell, at most, each by half of it [m/s].
double speed_of_cell(const RunState& s) {
  const Cell& cell = s.particles.cell;
  return cell.deforms() ? cell.rate_of_step().largest_stretch() * (s.facts.largest_radius + s.scene.contact_range()) : 0;
}

}  // namespace

double NeighbourLists::skin_for(const RunState& s, double fastest) const {
  const double smallest = s.facts.smallest_radius;
  const bool balls = are_effects_idle(s) && are_balls_alone(s);
  double skin = std::clamp(2 * (balls ? kListStepsOfBalls : kListSteps) * fastest * s.clock.dt,
                           (balls ? kSmallestSkinOfBalls : kSmallestListSkin) * smallest, kLargestListSkin * smallest);
  // a quarter of a period holds the reach of a body, its half of the skin included (see check_period)
  for (int k = 0; k < 3; ++k) {
    const Periodicity& periodicity = s.particles.cell.periodicity();
    if (!periodicity.is_periodic(k)) continue;
    const double room = 0.25 * periodicity.period()[k] - s.facts.largest_radius - s.scene.contact_range();
    skin = std::min(skin, 2 * kShareOfRoom * room);
  }
  return skin;
}

double NeighbourLists::limit() const { return 0.5 * (kShareOfSkin * skin_); }

bool NeighbourLists::may_agree_ahead(const RunState& s, bool rebuilt) const {
  return can_agree_ahead(s) && 0.5 * (rebuilt ? skin_for(s, fastest_) : skin_) >= kStepsOfRoom * fastest_ * s.clock.dt;
}

StepReport NeighbourLists::look(const RunState& s, bool rebuilt) {
  const ParticleSet& p = s.particles;
  const double skin = rebuilt ? skin_for(s, fastest_) : skin_, of_cell = rebuilt ? 0 : skin_of_cell(s, edges_listed_, skin);
  const double limit = std::max(0.0, 0.5 * (kShareOfSkin * skin - of_cell)), dt = s.clock.dt;
  const bool ahead = can_agree_ahead(s);
  bool beyond = !rebuilt && (walls_moved(s, walls_listed_, s.walls) > limit || of_cell > 0.5 * skin), soon = beyond;
  double fastest = std::max(fastest_wall(s, s.walls), speed_of_cell(s));
  if (ahead && s.scene.has_driven_walls()) {
    std::vector<WallState> next;
    for (const Wall& wall : s.scene.source().walls) next.push_back(wall_state(wall, s.clock.time() + dt));
    soon = soon || walls_moved(s, rebuilt ? s.walls : walls_listed_, next) > limit;
    fastest = std::max(fastest, fastest_wall(s, next));
  }
  const double ask = ahead ? (1 - kSkinInHand) * limit : limit;
  if (ahead) {
#pragma omp parallel reduction(|| : beyond, soon) reduction(max : fastest)
    for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const double moved = rebuilt ? 0.0 : length(p.x[i] - p.x_listed[i]), speed = length(p.v[i]);
        const double gain = kAccelerationShare * dt * p.inverse_mass[i] * length(p.force[i]);
        // written so that a NaN position counts as used up, and is then found by the guard
        if (!(moved <= limit)) beyond = true;
        if (!(moved + kVelocityShare * dt * speed + dt * gain <= ask)) soon = true;
        fastest = std::max({fastest, speed, gain});  // from rest, the acceleration tells what comes
      }
    });
  } else {  // one thing to know, and no root of each body for it
    double squared = fastest * fastest;
#pragma omp parallel reduction(|| : beyond) reduction(max : squared)
    for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
      const RowsMoved found = find_rows_moved(p, limit * limit, begin, end);
      if (!rebuilt && found.beyond) beyond = true;
      squared = std::max(squared, found.squared_speed);
    });
    soon = soon || beyond;
    fastest = std::sqrt(squared);
  }
  StepReport report;
  const bool asked = std::exchange(rebuild_asked_, false);
  report.rebuild = beyond || soon || (asked && !rebuilt) ? 1 : 0;
  report.fastest = fastest;
  overrun_ = beyond;
  return report;
}

void NeighbourLists::rebuild(RunState& s, Balance& balance) {
  double& search = s.times[static_cast<std::size_t>(Phase::search)];
  const double& sort = s.times[static_cast<std::size_t>(Phase::sort)];
  const double sorted = sort;
  {
    const PhaseTimer timer(s.times, Phase::search);
    const WorkTimer work(balance.computing(), s.comm.size() > 1 ? 1 : 0);
    if (std::exchange(forget_asked_, false)) s.pairs.forget_candidates();
    s.pairs.rebuild(s.scene, s.particles, s.walls, skin_, s.times);
    std::copy(s.particles.x.begin(), s.particles.x.end(), s.particles.x_listed.begin());
    walls_listed_ = s.walls;
    edges_listed_ = s.particles.cell.edges();
    ++rebuilds_;
  }
  search -= sort - sorted;
}

}  // namespace scree
