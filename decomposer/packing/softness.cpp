#include "decomposer/packing/softness.hpp"

#include <algorithm>
#include <cmath>

#include "core/storage/plasticity.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

// Of the smallest diameter, how far the fastest impact may press balls without margins into each other while they are poured, and how far
// what they weigh: impacts pass, and make the steps of stiff small balls long (1 GPa and 2 mm: 15 times); what a bed weighs lasts, and
// changes how it lies. Bodies with margins may use up kOverlapShare of them.
constexpr double kImpactOfDiameter = 0.1, kWeightOfDiameter = 0.02;
// The largest force in a bed over that of its mean pressure on the area of a body: forces are distributed exponentially.
constexpr double kLargestForce = 5;
// A softer bed takes steps that are longer by the root of this and then has to be made stiff: below, it is not worth it.
constexpr double kWorth = 16;
constexpr double kSoftestShare = 1e-4;
constexpr double kRestitution = 0.1;

bool is_known(ContactLaw law) { return law == ContactLaw::linear || law == ContactLaw::hunt_crossley || law == ContactLaw::hertz_mindlin; }

/// Force [N] of the softest pair at an overlap, of bodies of the smallest size.
double softest_force(const Case& c, const Scene& scene, double smallest, double overlap) {
  double softest = 1e300;
  for (const CasePair& p : c.pairs) {
    if (c.settings.law != ContactLaw::hertz_mindlin) {
      softest = std::min(softest, p.pair.spring(0.25 * smallest) * overlap);
      continue;
    }
    const double modulus =
        effective_modulus(scene.materials[static_cast<std::size_t>(p.pair.a)], scene.materials[static_cast<std::size_t>(p.pair.b)]);
    const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.25 * smallest;
    softest = std::min(softest, 4.0 / 3 * modulus * std::sqrt(radius) * std::pow(overlap, 1.5));
  }
  return softest;
}

/// What the poured bodies of a region weigh on the area of the largest of them, at most [N].
double load_of_bed(const Case& c, const SceneParts& parts, const Scene& scene, double largest) {
  const double g = length(c.settings.gravity);
  if (!(g > 0)) return 0;
  const Vec3 down = (1 / g) * c.settings.gravity;
  double area = 1e300, weight = 0;
  for (const Draw& d : parts.draws) {
    const CasePopulation& p = c.populations[d.population];
    if (p.method != PackingMethod::settle) continue;
    const Region& region = parts.regions[d.population];
    const Vec3 e = region.box.extent();
    area = std::min(area, region.volume / (std::abs(down.x) * e.x + std::abs(down.y) * e.y + std::abs(down.z) * e.z));
    weight += scene.materials[static_cast<std::size_t>(p.material)].density * d.volume * g;
  }
  return weight / area * largest * largest;
}

}  // namespace

double softness_of_pouring(const Case& c, const SceneParts& parts, const Scene& scene, const PackingReport& report) {
  if (!is_known(c.settings.law) || c.settings.gather == Gathering::area || c.settings.barrier > 0) return 1;
  // a softer contact is pressed deeper by its own attraction, and sticks the more
  if (std::any_of(c.pairs.begin(), c.pairs.end(), [](const CasePair& p) { return attracts(p.pair); })) return 1;
  double smallest = 1e300, largest = 0, least_margin = 1e300;
  for (const Draw& d : parts.draws) {
    if (c.populations[d.population].method != PackingMethod::settle) continue;
    const double diameter = d.scale * parts.shape(d.shape).shape.equivalent_diameter();
    smallest = std::min(smallest, diameter);
    largest = std::max(largest, diameter);
    if (const double own = d.scale * parts.shape(d.shape).margin; own > 0) least_margin = std::min(least_margin, own);
  }
  if (!(largest > 0) || c.pairs.empty()) return 1;
  // of two bodies; of a body and a mesh wall where margins go with size
  const double margins = least_margin < 1e300 ? least_margin : 2 * common_margin(scene.settings);
  const auto allowed = [&](double of_diameter) { return margins > 0 ? kOverlapShare * margins : of_diameter * smallest; };
  // overlaps of impacts go with a power of the stiffness, that of the law
  const double power = c.settings.law == ContactLaw::hertz_mindlin ? 2.5 : 2;
  const double for_impacts = std::pow(report.impact_overlap / allowed(kImpactOfDiameter), power);
  const double for_weight =
      kLargestForce * load_of_bed(c, parts, scene, largest) / softest_force(c, scene, smallest, allowed(kWeightOfDiameter));
  const double share = std::max({for_impacts, for_weight, kSoftestShare});
  return share * kWorth <= 1 ? share : 1;
}

void soften(Scene& scene, double share) {
  for (Material& m : scene.materials) m.young *= share;
  for (MaterialPair& p : scene.pairs) {
    p.stiffness *= share;
    p.modulus *= share;
  }
  scene.settings.step = 0;
}

namespace {

bool can_lose_by_damping(const Scene& scene, const MaterialPair& pair) {
  return scene.settings.law != ContactLaw::hunt_crossley || pair.restitution_speed > 0;
}

}  // namespace

void make_elastic(Scene& scene) {
  if (std::none_of(scene.pairs.begin(), scene.pairs.end(), yields)) return;
  // the damping of hunt-crossley goes with a speed: that of a fall by its own size
  double largest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    largest =
        std::max(largest, scene.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].equivalent_diameter());
  const double fall = std::sqrt(2 * length(scene.settings.gravity) * largest);
  for (MaterialPair& p : scene.pairs) {
    if (!yields(p)) continue;
    if (!can_lose_by_damping(scene, p)) p.restitution_speed = fall;
    if (can_lose_by_damping(scene, p)) p.restitution *= std::sqrt(1 - p.plasticity);
    p.plasticity = p.adhesive_ratio = 0;
  }
}

void damp(Scene& scene) {
  for (MaterialPair& p : scene.pairs) {
    if (can_lose_by_damping(scene, p)) p.restitution = std::min(p.restitution, kRestitution);
  }
}

namespace {

bool has_balls(const Scene& scene) {
  return std::any_of(scene.shapes.begin(), scene.shapes.end(), [](const Shape& s) { return s.kind == ShapeKind::sphere; });
}

}  // namespace

void stop_spins(Scene& scene) {
  constexpr double kTorsion = 0.01;  // of R* times the normal force: a spin of 10 rad/s of a ball of a millimetre ends within a millisecond
  if (!has_balls(scene)) return;
  for (MaterialPair& p : scene.pairs)
    if (!(p.torsional_friction > 0)) p.torsional_friction = kTorsion;
}

bool may_roll(const Scene& scene) {
  return has_balls(scene) &&
         std::any_of(scene.pairs.begin(), scene.pairs.end(), [](const MaterialPair& p) { return !(p.rolling_friction > 0); });
}

void stop_rolls(Scene& scene) {
  if (!has_balls(scene)) return;
  for (MaterialPair& p : scene.pairs)
    if (!(p.rolling_friction > 0)) p.rolling_friction = kRollingAtRest;
}

}  // namespace scree
