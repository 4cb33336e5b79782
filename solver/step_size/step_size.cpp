#include "solver/step_size/step_size.hpp"

#include "core/base/units.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/plasticity.hpp"
#include "solver/bodies/bodies_to_come.hpp"
#include "solver/laws/restitution.hpp"
#include "solver/scene/hollow_walls.hpp"
#include "solver/step_size/approach.hpp"
#include "solver/step_size/bond_stiffness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace scree {

namespace {

/// What of one material can be touched, by smoothness: analytic spheres and walls without edges, or everything else.
struct Touchable {
  std::array<double, 2> mobility{0, 0};      ///< the two largest of moving bodies [1/kg]
  std::array<std::int64_t, 2> body{-1, -1};  ///< whose
  double least = 1e300;                      ///< mobility of the most sluggish moving body [1/kg]
  std::int64_t still = 0;                    ///< fixed bodies and walls
  // for stiffness by size, radius times mobility [m/kg]: k (w_a + w_b) of a pair is at most 2 modulus times the larger of its two
  double sized = 0, least_sized = 1e300;
  std::int64_t sized_body = -1;

  void add_sized(double radius, double w, std::int64_t id) {
    least_sized = std::min(least_sized, radius * w);
    if (!(radius * w > sized || (radius * w == sized && (sized_body < 0 || id < sized_body)))) return;
    sized = radius * w;
    sized_body = id;
  }
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
std::vector<Touchable> touchables(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& present,
                                  const ParticleSet& joining) {
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
  const auto add = [&](const ParticleSet& p, std::size_t i) {
    Touchable& t = mine[2 * static_cast<std::size_t>(p.material[i]) + (scene.shape(p.shape[i]).kind == ShapeKind::sphere ? 0 : 1)];
    if (p.fixed[i])
      ++t.still;
    else {
      const double mobility = mobility_of(scene, p, i, tangential[static_cast<std::size_t>(p.material[i])]);
      t.add(mobility, p.id[i]);
      t.add_sized(p.scale[i] * scene.shape(p.shape[i]).equivalent_radius, mobility, p.id[i]);
      t.least = std::min(t.least, mobility);
    }
  };
  for (std::size_t i = 0; i < present.owned; ++i) add(present, i);
  for (std::size_t i = 0; i < joining.size(); ++i) add(joining, i);
  const auto ranks = static_cast<std::size_t>(comm.size());
  std::vector<Touchable> all(mine.size());
  for (const auto& block : comm.exchange(std::vector<std::vector<Touchable>>(ranks, mine))) {
    for (std::size_t k = 0; k < block.size(); ++k) {
      all[k].still += block[k].still;
      all[k].least = std::min(all[k].least, block[k].least);
      all[k].least_sized = std::min(all[k].least_sized, block[k].least_sized);
      if (block[k].sized_body >= 0) all[k].add_sized(1, block[k].sized, block[k].sized_body);
      for (std::size_t i = 0; i < 2; ++i) {
        if (block[k].body[i] >= 0) all[k].add(block[k].mobility[i], block[k].body[i]);
      }
    }
  }
  for (std::size_t w = 0; w < source.walls.size(); ++w) {
    const Wall& wall = source.walls[w];
    Touchable& t = all[2 * static_cast<std::size_t>(wall.material) + (wall.kind == WallKind::mesh ? 1 : 0)];
    ++t.still;
    // of a layer, the area that a wall has in contact is not known before: what is too light is found as it runs
    const Drive* drive = scene.drive(w);
    if (drive == nullptr || !(drive->inertia > 0) || source.settings.gather == Gathering::area) continue;
    const double mobility = scene.lever(w) * scene.lever(w) / drive->inertia;
    t.add(mobility, wall.id);
    const std::vector<double>& radii = scene.extremes().radius;
    t.add_sized(radii.empty() ? 0 : *std::max_element(radii.begin(), radii.end()), mobility, wall.id);
  }
  return all;
}

/// The extremes of the scene's bodies and of all that there are now or join, of all ranks. Collective.
BodyExtremes present_extremes(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p,
                              std::span<const ParticleRecord> joining) {
  BodyExtremes mine = scene.extremes();
  for (std::size_t i = 0; i < p.owned; ++i) scene.include_body(p.shape[i], p.material[i], p.scale[i], p.fixed[i] != 0, 0, mine);
  for (const ParticleRecord& r : joining) scene.include_body(r.shape, r.material, r.scale, r.fixed != 0, length(r.v), mine);
  // all numbers in a row, so that one exchange does
  std::vector<double> row{mine.bounding_radius};
  for (const auto* of_kind : {&mine.mass, &mine.radius, &mine.speed, &mine.smallest_scale})
    row.insert(row.end(), of_kind->begin(), of_kind->end());
  for (const auto& block : comm.exchange(std::vector<std::vector<double>>(static_cast<std::size_t>(comm.size()), row))) {
    BodyExtremes other = mine;
    auto next = block.begin();
    other.bounding_radius = *next++;
    for (auto* of_kind : {&other.mass, &other.radius, &other.speed, &other.smallest_scale}) {
      for (double& value : *of_kind) value = *next++;
    }
    mine.include(other);
  }
  return mine;
}

/// The limits of the contacts of two materials, each smooth or rough.
class ContactLimits {
 public:
  ContactLimits(const SolverScene& scene, const BodyExtremes& extremes, ContactLimit& limit)
      : scene_(scene), extremes_(extremes), of_rough_pair_(scene.extent_of_rough_pair(extremes)), limit_(limit) {
    in_valleys_ = scene.source().settings.gather == Gathering::potential && scene.has_valleys(extremes);
  }

  void add(const MaterialPair& pair, const Touchable& a, bool rough_a, const Touchable& b, bool rough_b) {
    const PairLaw& law = scene_.law(pair.a, pair.b);
    // a smooth body on a smooth one touches once
    const double stiffness = scene_.step_stiffness(pair, extremes_), features = rough_a || rough_b ? of_rough_pair_ : 1.0;
    const auto consider = [&](double mobility, const std::string& name) {
      const double omega2 = stiffness * features * mobility, rate = std::sqrt(omega2) * (1 + law.step_damping);
      if (law.step_damping > kStrongDamping && rate > limit_.damped_rate) {
        limit_.damped_rate = rate;
        limit_.most_damped = fmt::format("{} at restitution {:g}", name, std::max(pair.restitution, kMinRestitution));
      }
      if (!(omega2 > stiffest_)) return;
      stiffest_ = omega2;
      limit_.who = features > 1 && in_valleys_ ? name + " in a valley" : name;
    };
    const auto body = [&](const Touchable& t, std::size_t i, std::int32_t material) {
      for (const Wall& wall : scene_.source().walls) {
        if (t.body[i] == wall.id) return fmt::format("wall '{}' ({})", wall.name, name_of(material));
      }
      if (t.body[i] >= kIdToCome) return fmt::format("a body to come ({})", name_of(material));
      return fmt::format("body {} ({})", t.body[i], name_of(material));
    };
    if (pair.modulus > 0 && !(pair.contact_radius > 0) && stiffness > 0) {  // each with whatever it can touch
      const auto by_size = [&](const Touchable& t, std::int32_t material, const Touchable& other, std::int32_t against) {
        const bool touches = &t == &other ? t.body[1] >= 0 || t.still > 0 : other.body[0] >= 0 || other.still > 0;
        if (t.sized_body < 0 || !touches) return;
        Touchable named;
        named.body[0] = t.sized_body;
        const double steepest = 2 * pair.modulus * steepening(pair);
        consider(steepest * hollow_factor(scene_.source(), pair, extremes_) / stiffness * t.sized,
                 body(named, 0, material) + " on " + name_of(against));
        softest_ = std::min(softest_, steepest * features * t.least_sized);
      };
      by_size(a, pair.a, b, pair.b);
      if (&a != &b) by_size(b, pair.b, a, pair.a);
      return;
    }
    const auto still = [&](std::int32_t material) { return "fixed " + name_of(material); };
    if (a.body[0] >= 0 && (b.body[0] >= 0 || b.still > 0)) softest_ = std::min(softest_, stiffness * features * a.least);
    if (&a == &b) {
      if (a.body[1] >= 0) consider(a.mobility[0] + a.mobility[1], body(a, 0, pair.a) + " on " + body(a, 1, pair.a));
    } else if (a.body[0] >= 0 && b.body[0] >= 0) {
      consider(a.mobility[0] + b.mobility[0], body(a, 0, pair.a) + " on " + body(b, 0, pair.b));
    }
    if (a.body[0] >= 0 && b.still > 0) consider(a.mobility[0], body(a, 0, pair.a) + " on " + still(pair.b));
    if (b.body[0] >= 0 && a.still > 0) consider(b.mobility[0], body(b, 0, pair.b) + " on " + still(pair.a));
  }

  /// Fills in the times.
  void finish() {
    if (!(stiffest_ > 0)) return;
    limit_.time = std::numbers::pi / std::sqrt(stiffest_);
    limit_.slowest_time = std::numbers::pi / std::sqrt(std::min(softest_, stiffest_));
  }

 private:
  const std::string& name_of(std::int32_t material) const { return scene_.source().materials[static_cast<std::size_t>(material)].name; }

  const SolverScene& scene_;
  const BodyExtremes& extremes_;
  double of_rough_pair_;
  bool in_valleys_ = false;  ///< n is that of faces in a valley
  ContactLimit& limit_;
  double stiffest_ = 0, softest_ = 1e300;  // omega^2 [1/s^2]
};

/// Longest step that follows the contacts, and why.
double longest_step(const ContactLimit& limit, double steps_per_contact, std::string& why) {
  const double step = limit.time / steps_per_contact;
  why = limit.who;
  if (!(step * limit.damped_rate > std::numbers::pi / kStepsPerDamping)) return step;
  why = "the damping of " + limit.most_damped;
  return std::numbers::pi / (kStepsPerDamping * limit.damped_rate);
}

/// Throws UsageError when a step that the case gives is too long.
void check_given_step(const StepSize& given, const ContactLimit& limit) {
  if (limit.time > 0 && given.step > kMaxCritical * given.critical()) {
    throw UsageError(
        "time.step = {:g} s is {:.3g} times the critical step {:.4g} s of {}; use at most {:.3g} s (20 steps a contact), "
        "or leave it out",
        given.step, given.step / given.critical(), given.critical(), limit.who, limit.time / 20);
  }
  if (given.step * limit.damped_rate > std::numbers::pi / kStepsPerDamping) {
    constexpr double kRoundDown = 0.99;  // three digits that are not above the limit
    throw UsageError(
        "time.step = {:g} s is too long for the damping of {}: they would rebound otherwise; use at most {:.3g} s, or leave it out",
        given.step, limit.most_damped, kRoundDown * std::numbers::pi / (kStepsPerDamping * limit.damped_rate));
  }
}

/// Shortens the step to what attraction asks for: its range is crossed in a number of steps at the fastest impact expected.
void follow_ranges(const SolverScene& scene, StepSize& result) {
  const Scene& source = scene.source();
  for (const MaterialPair& pair : source.pairs) {
    const double speed = attracts(pair) ? scene.largest_impact(pair, scene.extremes()).speed : 0;
    if (!(speed > 0)) continue;
    const double range = scene.law(pair.a, pair.b).reach, sticking = scene.sticking_speed(pair);
    const double at_impact = kRangePerStep * range / speed, at_sticking = sticking > 0 ? kStickingPerStep * range / sticking : at_impact;
    const double longest = std::max(at_impact, at_sticking);
    if (!(result.crossing > 0) || longest < result.crossing) result.crossing = longest;
    if (result.given || !(longest < result.step)) continue;
    result.step = longest;
    result.limited_by =
        fmt::format("the range of the attraction of '{}' and '{}', {} crossed at {}{}",
                    source.materials[static_cast<std::size_t>(pair.a)].name, source.materials[static_cast<std::size_t>(pair.b)].name,
                    format_quantity(range, Dimension::length), format_quantity(at_impact < longest ? sticking : speed, Dimension::velocity),
                    at_impact < longest ? ", at which the lightest stick" : "");
  }
}

/// Shortens the step to what approaches and spins ask for as the scene starts.
void follow_motion_at_start(const SolverScene& scene, StepSize& result) {
  if (result.contact_time > 0 && scene.smallest_max_overlap() > 0) {
    const double way = kMarginPerStep * scene.smallest_max_overlap();
    const Approach approach = fastest_approach(scene, way / result.step);
    if (approach.speed > 0) {
      result.step = way / approach.speed;
      result.limited_by = "the approach of " + approach.who + " against their margins";
    }
  }
  for (std::size_t w = 0; w < scene.source().walls.size() && result.contact_time > 0 && scene.smallest_max_overlap() > 0; ++w) {
    // as fast as a wall may become that answers to force
    const Drive* drive = scene.drive(w);
    if (drive == nullptr || !(drive->most_rate < kUnlimitedRate)) continue;
    const double way = kMarginPerStep * scene.smallest_max_overlap(), speed = drive->most_rate * scene.lever(w);
    if (!(speed * result.step > way)) continue;
    result.step = way / speed;
    result.limited_by = fmt::format("the speed of wall '{}' against the margins", scene.source().walls[w].name);
  }
  const BodyTable& bodies = scene.source().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double spin = length(bodies.angular_velocity[b]);
    if (bodies.fixed[b] || bodies.lock_rotation[b] || scene.shape(bodies.shape[b]).isotropic || !(spin * result.step > kTurnPerStep))
      continue;
    result.step = kTurnPerStep / spin;
    result.limited_by = fmt::format("the spin of body {}", bodies.id[b]);
  }
}

/// Shortens the step to what the bonds of the scene ask for. Throws UsageError when a step that the case gives is not stable for them.
void follow_bonds(const SolverScene& scene, StepSize& result) {
  const CriticalStep critical = critical_step_of_bonds(scene);
  if (result.given && result.step > critical.step) {
    throw UsageError("time.step = {:g} s is {:.3g} times the critical step {:.4g} s of the {}; use at most {:.3g} s, or leave it out",
                     result.step, result.step / critical.step, critical.step, critical.name(), kBondShare * critical.step);
  }
  if (result.given || !(kBondShare * critical.step < result.step)) return;
  result.step = kBondShare * critical.step;
  result.limited_by = "the " + critical.name();
}

/// The same for a body that comes in later: what it meets is taken to stand still.
void follow_motion_of(const SolverScene& scene, const ParticleRecord& r, StepSize& result) {
  const double way = kMarginPerStep * scene.smallest_max_overlap(), speed = length(r.v), spin = length(r.w);
  if (result.contact_time > 0 && way > 0 && speed * result.step > way) {
    result.step = way / speed;
    result.limited_by = "the velocity of bodies to come against their margins";
  }
  if (!scene.shape(r.shape).isotropic && spin * result.step > kTurnPerStep) {
    result.step = kTurnPerStep / spin;
    result.limited_by = "the spin of bodies to come";
  }
}

}  // namespace

ContactLimit limit_of_contacts(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p,
                               std::span<const ParticleRecord> joining) {
  ParticleSet more;
  for (const ParticleRecord& r : joining) append_record(more, r, scene);
  const std::vector<Touchable> all = touchables(comm, scene, p, more);
  const BodyExtremes extremes = present_extremes(comm, scene, p, joining);
  ContactLimit limit;
  ContactLimits limits(scene, extremes, limit);
  for (const MaterialPair& pair : scene.source().pairs) {
    for (std::size_t roughness = 0; roughness < 4; ++roughness) {
      const std::size_t rough_a = roughness & 1, rough_b = roughness >> 1;
      limits.add(pair, all[2 * static_cast<std::size_t>(pair.a) + rough_a], rough_a != 0,
                 all[2 * static_cast<std::size_t>(pair.b) + rough_b], rough_b != 0);
    }
  }
  limits.finish();
  return limit;
}

StepSize derive_step_size(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p) {
  const Settings& settings = scene.source().settings;
  const std::vector<ParticleRecord> to_come = bodies_to_come(scene);
  const ContactLimit limit = limit_of_contacts(comm, scene, p, to_come);
  const bool can_touch = !limit.who.empty();
  StepSize result;
  result.contact_time = limit.time;
  result.slowest_contact_time = limit.slowest_time;
  result.limited_by = limit.who;
  if (can_touch && (!(limit.time > 0) || !std::isfinite(limit.time))) {
    throw InputError(
        "the stiffest contact that can occur, {}, would last {} s: stiffness and mass are too far apart for a step; check "
        "density, stiffness and sizes",
        limit.who, limit.time);
  }
  if (settings.step > 0) {
    result.step = settings.step;
    result.given = true;
    check_given_step(result, limit);
    follow_ranges(scene, result);
    follow_bonds(scene, result);
    return result;
  }
  if (can_touch) {
    result.step = longest_step(limit, settings.steps_per_contact, result.limited_by);
  } else {
    result.step = settings.duration > 0 ? settings.duration / 1000 : 1;
    result.limited_by = "no contact can occur: a thousandth of the duration";
  }
  follow_bonds(scene, result);
  if (settings.step_control != StepControl::quantised) {  // else speed and spin choose the level
    if (can_touch) follow_ranges(scene, result);
    follow_motion_at_start(scene, result);
    for (const ParticleRecord& r : to_come) follow_motion_of(scene, r, result);
  }
  return result;
}

void check_step(const StepSize& run, const ContactLimit& with_them, const Settings& settings, std::int64_t step) {
  if (!(with_them.time > 0)) return;
  std::string why;
  double longest = longest_step(with_them, settings.steps_per_contact, why);
  if (run.given) {
    constexpr double kCriticalPerContact = 2 / std::numbers::pi;
    const double damped = with_them.damped_rate > 0 ? std::numbers::pi / (kStepsPerDamping * with_them.damped_rate) : 1e300;
    longest = std::min(kMaxCritical * kCriticalPerContact * with_them.time, damped);
  }
  constexpr double kRounding = 1 + 1e-9;
  if (run.step <= kRounding * longest) return;
  throw RunInvalid("step {}: with the bodies that join, {} requires a step of at most {:.3g} s, and the run has {:.4g} s; give time.step",
                   step, why, longest, run.step);
}

}  // namespace scree
