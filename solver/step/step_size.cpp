#include "solver/step/step_size.hpp"

#include "solver/laws/restitution.hpp"
#include "solver/step/approach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// What of one material can be touched, by smoothness: analytic spheres and walls without edges, or everything else.
struct Touchable {
  std::array<double, 2> mobility{0, 0};      ///< the two largest of moving bodies [1/kg]
  std::array<std::int64_t, 2> body{-1, -1};  ///< whose
  double least = 1e300;                      ///< mobility of the most sluggish moving body [1/kg]
  std::int64_t still = 0;                    ///< fixed bodies and walls

  void add(double w, std::int64_t id) {
    for (std::size_t i = 0; i < 2; ++i) {
      if (body[i] == id) return;
      // the lower id wins among equals: the name does not depend on ranks
      if (w > mobility[i] || (w == mobility[i] && (body[i] < 0 || id < body[i]))) {
        std::swap(w, mobility[i]);
        std::swap(id, body[i]);
      }
    }
  }
};

/// Inverse mass of the easiest contact on a body [1/kg].
/// Times the extent of the body's contacts: of a layer, the largest area that it can have in contact.
double mobility_of(const SolverScene& scene, const ParticleSet& p, std::size_t i, double tangential_ratio) {
  const SolverShape& shape = scene.shape(p.shape[i]);
  const double extent = scene.contact_extent().of_body(p.shape[i], p.scale[i]);
  if (shape.kind == ShapeKind::sphere) {
    // A ball's normal passes its centre; only friction, with its softer spring, turns it. The two do not add up.
    const double r = p.radius[i], turning = p.lock_rotation[i] ? 0.0 : r * r * p.inverse_inertia[i].x;
    const double tangential = tangential_ratio * (p.inverse_mass[i] + turning);
    return extent * std::max(p.inverse_mass[i], tangential);
  }
  const double s = p.scale[i], density = scene.source().materials[static_cast<std::size_t>(p.material[i])].density;
  return extent * (p.inverse_mass[i] + (p.lock_rotation[i] ? 0.0 : shape.rotational_mobility / (density * s * s * s)));
}

/// Of every material, smooth then rough; the same on every rank.
std::vector<Touchable> touchables(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p) {
  const Scene& source = scene.source();
  std::vector<Touchable> mine(2 * source.materials.size());
  // of each material, the largest tangential over normal tangent stiffness of a pair with friction
  std::vector<double> tangential(source.materials.size(), 0.0);
  for (const MaterialPair& pair : source.pairs) {
    const PairLaw& law = scene.law(pair.a, pair.b);
    if (!(law.friction > 0)) continue;
    for (const std::int32_t m : {pair.a, pair.b}) {
      double& ratio = tangential[static_cast<std::size_t>(m)];
      ratio = std::max(ratio, law.tangential_ratio / scene.law_choice().exponent);
    }
  }
  for (std::size_t i = 0; i < p.owned; ++i) {
    Touchable& t = mine[2 * static_cast<std::size_t>(p.material[i]) + (scene.shape(p.shape[i]).kind == ShapeKind::sphere ? 0 : 1)];
    if (p.fixed[i])
      ++t.still;
    else {
      const double mobility = mobility_of(scene, p, i, tangential[static_cast<std::size_t>(p.material[i])]);
      t.add(mobility, p.id[i]);
      t.least = std::min(t.least, mobility);
    }
  }
  const auto ranks = static_cast<std::size_t>(comm.size());
  std::vector<Touchable> all(mine.size());
  for (const auto& block : comm.exchange(std::vector<std::vector<Touchable>>(ranks, mine))) {
    for (std::size_t k = 0; k < block.size(); ++k) {
      all[k].still += block[k].still;
      all[k].least = std::min(all[k].least, block[k].least);
      for (std::size_t i = 0; i < 2; ++i) {
        if (block[k].body[i] >= 0) all[k].add(block[k].mobility[i], block[k].body[i]);
      }
    }
  }
  for (const Wall& wall : source.walls) ++all[2 * static_cast<std::size_t>(wall.material) + (wall.kind == WallKind::mesh ? 1 : 0)].still;
  return all;
}

}  // namespace

StepSize derive_step_size(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p) {
  const Scene& source = scene.source();
  const std::vector<Touchable> all = touchables(comm, scene, p);
  StepSize result;
  double stiffest = 0, softest = 1e300;  // omega^2 of contacts that can occur [1/s^2]
  double fastest = 0;                    // omega (1 + zeta) of the pairs that are strongly damped [1/s]
  std::string most_damped;
  for (const MaterialPair& pair : source.pairs) {
    for (std::size_t roughness = 0; roughness < 4; ++roughness) {
      const std::size_t rough_a = roughness & 1, rough_b = roughness >> 1;
      const Touchable &a = all[2 * static_cast<std::size_t>(pair.a) + rough_a], &b = all[2 * static_cast<std::size_t>(pair.b) + rough_b];
      // a smooth body on a smooth one touches once
      const double features = rough_a + rough_b == 0 ? 1.0 : scene.contact_extent().of_rough_pair();
      const auto consider = [&](double mobility, const std::string& name) {
        const PairLaw& law = scene.law(pair.a, pair.b);
        const double omega2 = law.step_stiffness * features * mobility, rate = std::sqrt(omega2) * (1 + law.step_damping);
        if (law.step_damping > kStrongDamping && rate > fastest) {
          fastest = rate;
          most_damped = fmt::format("{} at restitution {:g}", name, std::max(pair.restitution, kLeastRestitution));
        }
        if (!(omega2 > stiffest)) return;
        stiffest = omega2;
        result.limited_by = name;
      };
      const auto body = [&](const Touchable& t, std::size_t i, std::int32_t material) {
        return fmt::format("body {} ({})", t.body[i], source.materials[static_cast<std::size_t>(material)].name);
      };
      const auto still = [&](std::int32_t material) { return "fixed " + source.materials[static_cast<std::size_t>(material)].name; };
      if (a.body[0] >= 0 && (b.body[0] >= 0 || b.still > 0)) {
        softest = std::min(softest, scene.law(pair.a, pair.b).step_stiffness * features * a.least);
      }
      if (&a == &b) {
        if (a.body[1] >= 0) consider(a.mobility[0] + a.mobility[1], body(a, 0, pair.a) + " on " + body(a, 1, pair.a));
      } else if (a.body[0] >= 0 && b.body[0] >= 0) {
        consider(a.mobility[0] + b.mobility[0], body(a, 0, pair.a) + " on " + body(b, 0, pair.b));
      }
      if (a.body[0] >= 0 && b.still > 0) consider(a.mobility[0], body(a, 0, pair.a) + " on " + still(pair.b));
      if (b.body[0] >= 0 && a.still > 0) consider(b.mobility[0], body(b, 0, pair.b) + " on " + still(pair.a));
    }
  }
  if (stiffest > 0) {
    result.contact_time = std::numbers::pi / std::sqrt(stiffest);
    result.slowest_contact_time = std::numbers::pi / std::sqrt(std::min(softest, stiffest));
    if (!(result.contact_time > 0) || !std::isfinite(result.contact_time)) {
      throw InputError(
          "the stiffest contact that can occur, {}, would last {} s: stiffness and mass are too far apart for a step; check "
          "density, stiffness and sizes",
          result.limited_by, result.contact_time);
    }
  }
  if (source.settings.step > 0) {
    result.step = source.settings.step;
    result.given = true;
    if (stiffest > 0 && result.step > kMostCritical * result.critical()) {
      throw UsageError(
          "time.step = {:g} s is {:.3g} times the critical step {:.4g} s of {}; use at most {:.3g} s (20 steps a contact), "
          "or leave it out",
          result.step, result.step / result.critical(), result.critical(), result.limited_by, result.contact_time / 20);
    }
    if (result.step * fastest > std::numbers::pi / kStepsPerDamping) {
      constexpr double kRoundDown = 0.99;  // three digits that are not above the limit
      throw UsageError(
          "time.step = {:g} s is too long for the damping of {}: they would rebound otherwise; use at most {:.3g} s, or leave it out",
          result.step, most_damped, kRoundDown * std::numbers::pi / (kStepsPerDamping * fastest));
    }
    return result;
  }
  if (stiffest > 0) {
    result.step = result.contact_time / source.settings.steps_per_contact;
    if (result.step * fastest > std::numbers::pi / kStepsPerDamping) {
      result.step = std::numbers::pi / (kStepsPerDamping * fastest);
      result.limited_by = "the damping of " + most_damped;
    }
  } else {
    result.step = source.settings.duration > 0 ? source.settings.duration / 1000 : 1;
    result.limited_by = "no contact can occur: a thousandth of the duration";
  }
  if (source.settings.step_control == StepControl::quantised) return result;  // speed and spin choose the level

  if (stiffest > 0 && scene.margin() > 0) {
    const double way = kMarginPerStep * 2 * scene.margin();
    const Approach approach = fastest_approach(scene, way / result.step);
    if (approach.speed > 0) {
      result.step = way / approach.speed;
      result.limited_by = "the approach of " + approach.who + " against their margins";
    }
  }
  const BodyTable& bodies = source.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double spin = length(bodies.angular_velocity[b]);
    if (bodies.fixed[b] || bodies.lock_rotation[b] || scene.shape(bodies.shape[b]).isotropic || !(spin * result.step > kTurnPerStep))
      continue;
    result.step = kTurnPerStep / spin;
    result.limited_by = fmt::format("the spin of body {}", bodies.id[b]);
  }
  return result;
}

}  // namespace scree
