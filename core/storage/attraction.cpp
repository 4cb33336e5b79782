#include "core/storage/attraction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/contact_limits.hpp"
#include "core/storage/jkr.hpp"

namespace scree {

namespace {

/// The push of a contact: c d^p.
struct Push {
  double c, power;
  double overlap_of_force(double force) const { return std::pow(force / c, 1 / power); }
  double energy(double overlap) const { return c * std::pow(overlap, power + 1) / (power + 1); }
};

Push push_of(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (law == ContactLaw::hertz_mindlin) return {4.0 / 3 * effective_modulus(a, b) * std::sqrt(radius), 1.5};
  return {pair.stiffness, 1};
}

Jkr neck_of(const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  return {pair.adhesion, effective_modulus(a, b), radius};
}

// Willett's fit: 1 + kLinear x + kSquare x^2, and the largest slope of its inverse (at x = 0.073)
constexpr double kLinear = 2.1, kSquare = 10, kSteepest = 2.45;

/// (1 + theta / 2) V^(1/3): where a bridge ruptures but for the term with R. That one is a tenth of it at most, also where a bridge is
/// larger than its bodies.
double rupture_of(const MaterialPair& pair, double radius) {
  const double size = std::cbrt(pair.bridge_volume), rupture = (1 + 0.5 * pair.contact_angle) * size;
  if (pair.bridge_rupture == BridgeRupture::lian) return rupture;
  return rupture * (1 + 0.1 * (radius > 0 ? std::min(1.0, size / (2 * radius)) : 1));
}

}  // namespace

double pull_off_factor(AdhesionModel model) { return (model == AdhesionModel::jkr ? 1.5 : 2.0) * std::numbers::pi; }

double pull_off_force(const MaterialPair& pair, double radius) {
  if (pair.surface_tension > 0) return 4 * std::numbers::pi * radius * pair.surface_tension * std::cos(pair.contact_angle);
  return pair.adhesion > 0 ? pull_off_factor(pair.adhesion_model) * pair.adhesion * radius : pair.pull_off;
}

RestingContact resting_contact(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (pull_kind(pair) == PullKind::neck) {
    const Jkr neck = neck_of(pair, a, b, radius);
    const double y = std::cbrt(6.0);  // where push and pull are equal
    return {neck.overlap(y), -neck.released_at_touch() - neck.energy(y)};
  }
  const Push push = push_of(law, pair, a, b, radius);
  const double force = pull_off_force(pair, radius), overlap = push.overlap_of_force(force);
  return {overlap, force * overlap - push.energy(overlap)};
}

double attraction_range(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (pull_kind(pair) == PullKind::neck) return radius > 0 ? neck_of(pair, a, b, radius).tear_off : 0;
  if (pull_kind(pair) == PullKind::bridge) return rupture_of(pair, pair.contact_radius);
  if (!(pair.separation_energy > 0)) return pair.adhesion_range;
  return std::max(0.0, 2 * (pair.separation_energy - resting_contact(law, pair, a, b, radius).energy) / pull_off_force(pair, radius));
}

double parting_energy(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (pull_kind(pair) == PullKind::neck) return neck_of(pair, a, b, radius).released_at_touch();
  if (pull_kind(pair) == PullKind::bridge) return LiquidBridge(pair, radius).energy_at(0);
  return 0.5 * pull_off_force(pair, radius) * attraction_range(law, pair, a, b, radius);
}

double steepest_pull(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (pull_kind(pair) == PullKind::neck) return 0;
  if (pull_kind(pair) == PullKind::bridge) return LiquidBridge(pair, radius).steepest();
  if (settings.gather == Gathering::area) return 2 * pair.adhesion / (pair.adhesion_range * pair.adhesion_range);
  return pull_off_force(pair, radius) / attraction_range(settings.law, pair, a, b, radius);
}

LiquidBridge::LiquidBridge(const MaterialPair& pair, double radius)
    : force(pull_off_force(pair, radius)), scale(2 * std::sqrt(pair.bridge_volume / (2 * radius))), rupture(rupture_of(pair, radius)) {}

double LiquidBridge::force_at(double gap) const {
  const double x = gap / scale;
  return gap < rupture ? force / (1 + kLinear * x + kSquare * x * x) : 0;
}

double neck_stiffness(const MaterialPair& pair, const Material& a, const Material& b, double radius, double mass, double speed) {
  const Jkr neck = neck_of(pair, a, b, radius);
  const double y = neck.root(impact_overlap(ContactLaw::hertz_mindlin, pair, a, b, radius, mass, speed));
  return 2 * effective_modulus(a, b) * std::sqrt(radius * neck.push_overlap(y));
}

double LiquidBridge::steepest() const { return kSteepest * force / scale; }

double LiquidBridge::energy_at(double gap) const {
  const double root = std::sqrt(4 * kSquare - kLinear * kLinear);
  const auto integral = [&](double g) { return std::atan((2 * kSquare * g / scale + kLinear) / root); };
  return gap < rupture ? force * scale * 2 / root * (integral(rupture) - integral(gap)) : 0;
}

double widest_range(const Scene& scene) {
  double range = 0;
  for (const MaterialPair& p : scene.pairs) {
    if (!attracts(p)) continue;
    const Material &a = scene.materials[static_cast<std::size_t>(p.a)], &b = scene.materials[static_cast<std::size_t>(p.b)];
    range = std::max(range, attraction_range(scene.settings.law, p, a, b, p.contact_radius));
  }
  return range;
}

namespace {

AttractionFault bridge_fault(const Settings& settings, const MaterialPair& pair) {
  if (pair.pull_off > 0 || pair.adhesion > 0)
    return {"surface_tension", "is of a liquid bridge, and this pair has pull_off or adhesion too; keep one of them"};
  if (settings.gather != Gathering::potential) return {"surface_tension", "goes with contact.gather = \"potential\" only"};
  if (pair.adhesion_range > 0 || pair.separation_energy > 0) {
    return {pair.adhesion_range > 0 ? "adhesion_range" : "separation_energy",
            "is not used with a liquid bridge, which reaches as far as its volume lets it; remove it"};
  }
  if (!(pair.bridge_volume > 0)) return {"surface_tension", "needs bridge_volume, the volume of each bridge (for instance \"1 mm^3\")"};
  if (!(pair.contact_angle < 0.5 * std::numbers::pi)) {
    return {"contact_angle", fmt::format("{:.4g} degrees found, expected less than 90: such a liquid does not wet, and no bridge holds",
                                         pair.contact_angle * 180 / std::numbers::pi)};
  }
  return {};
}

AttractionFault neck_fault(const Settings& settings, const MaterialPair& pair) {
  if (pair.adhesion_model != AdhesionModel::jkr)
    return {"adhesion_hysteresis", "is of the theory of JKR; it goes with adhesion_model = \"jkr\""};
  if (settings.law != ContactLaw::hertz_mindlin || settings.gather != Gathering::potential) {
    return {"adhesion_hysteresis",
            "goes with contact.law = \"hertz-mindlin\" and contact.gather = \"potential\" only; with others, adhesion_range says how far "
            "the attraction acts"};
  }
  if (pair.adhesion_range > 0 || pair.separation_energy > 0) {
    return {pair.adhesion_range > 0 ? "adhesion_range" : "separation_energy",
            "is not used with adhesion_hysteresis: the neck tears where the theory says; remove one of them"};
  }
  if (settings.barrier > 0) return {"adhesion_hysteresis", "does not go with contact.barrier"};
  return {};
}

}  // namespace

AttractionFault attraction_fault(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b) {
  if (pair.adhesion_hysteresis && !(pair.adhesion > 0))
    return {"adhesion_hysteresis", "goes with adhesion, the work of adhesion, and adhesion_model = \"jkr\""};
  if (!(pair.surface_tension > 0) && (pair.bridge_volume > 0 || pair.contact_angle > 0))
    return {pair.bridge_volume > 0 ? "bridge_volume" : "contact_angle", "goes with surface_tension, that of the liquid"};
  if (!(pair.surface_tension > 0) && pair.bridge_rupture != BridgeRupture::willett)
    return {"bridge_rupture", "goes with surface_tension, that of the liquid"};
  if (pair.surface_tension > 0) return bridge_fault(settings, pair);
  if (pull_kind(pair) == PullKind::neck) return neck_fault(settings, pair);
  if (!attracts(pair)) {
    if (pair.adhesion_range > 0)
      return {"adhesion_range", "goes with pull_off or adhesion, which say how strong the attraction is; give one of them"};
    if (pair.separation_energy > 0)
      return {"separation_energy", "goes with pull_off or adhesion, which say how strong the attraction is; give one of them"};
    return {};
  }
  const char* force = pair.adhesion > 0 ? "adhesion" : "pull_off";
  if (pair.pull_off > 0 && pair.adhesion > 0) return {"pull_off", "is the force that `adhesion` gives too; keep one of them"};
  if (settings.gather == Gathering::pairs) return {force, "goes with contact.gather = \"potential\" or \"area\" only"};
  if (settings.gather == Gathering::area) {
    if (pair.pull_off > 0)
      return {"pull_off", "is the force of one contact, and contact.gather = \"area\" has none; give adhesion, the work for each area"};
    if (pair.separation_energy > 0)
      return {"separation_energy", "is of one contact, and contact.gather = \"area\" has none; give adhesion_range in its place"};
    if (!(pair.adhesion_range > 0))
      return {"adhesion", "needs adhesion_range, the gap over which the attraction acts (for instance \"10 um\")"};
    return {};
  }
  if (pair.adhesion_range > 0 && pair.separation_energy > 0)
    return {"separation_energy", "is what adhesion_range gives too; keep one of them"};
  if (!(pair.adhesion_range > 0) && !(pair.separation_energy > 0)) {
    return {
        force,
        "needs adhesion_range, the gap over which the attraction acts (for instance \"10 um\"), or separation_energy, the work that parts "
        "a contact"};
  }
  if (!(pair.separation_energy > 0)) return {};
  if (!(pair.contact_radius > 0) && (pair.adhesion > 0 || settings.law == ContactLaw::hertz_mindlin)) {
    return {"separation_energy",
            "is of one contact, but here the force goes with R* of every two bodies; give contact_radius, or adhesion_range in its place"};
  }
  const double least = resting_contact(settings.law, pair, a, b, pair.contact_radius).energy;
  if (!(pair.separation_energy > least)) {
    return {
        "separation_energy",
        fmt::format("is not above {}, which it takes to undo the overlap of a contact at rest alone, and leaves no range; give more, or a "
                    "stiffer contact",
                    format_quantity(least, Dimension::energy))};
  }
  return {};
}

double impact_overlap(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius, double mass,
                      double speed) {
  if (pull_kind(pair) == PullKind::neck) {
    const Jkr neck = neck_of(pair, a, b, radius);
    const double arrives = 0.5 * mass * speed * speed - neck.released_at_touch();
    double y = std::cbrt(6.0);  // beyond it the energy rises; a body at rest comes to rest here
    for (double step = y; step > 1e-12 * y;) {
      if (neck.energy(y + step) < arrives)
        y += step, step *= 2;
      else
        step *= 0.5;
    }
    return neck.overlap(y);
  }
  const Push push = push_of(law, pair, a, b, radius);
  const double force = pull_off_force(pair, radius), arrives = 0.5 * mass * speed * speed + parting_energy(law, pair, a, b, radius);
  const auto left = [&](double d) { return arrives + force * d - push.energy(d); };  // rises, then falls below 0 once
  double low = push.overlap_of_force(force), high = low + 1e-300;
  while (left(high) > 0) high *= 2;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (left(middle) > 0 ? low : high) = middle;
  }
  return high;
}

void check_pressing(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b, double radius,
                    double margin) {
  if (!attracts(pair) || !(margin > 0) || settings.barrier > 0) return;
  if (settings.gather == Gathering::area) {
    const double pressure = 2 * pair.adhesion / pair.adhesion_range, overlap = pressure / pair.layer_modulus * margin;
    if (overlap < kStopOverlapRatio * margin) return;
    throw UsageError(
        "pairs: '{}' and '{}': a traction of {} (twice adhesion over adhesion_range) alone presses surfaces through their margins, whose "
        "layer_modulus is {}; raise layer_modulus or adhesion_range",
        a.name, b.name, format_quantity(pressure, Dimension::pressure), format_quantity(pair.layer_modulus, Dimension::pressure));
  }
  if (!(radius > 0)) return;
  const double overlap = resting_contact(settings.law, pair, a, b, radius).overlap;
  if (overlap < kStopOverlapRatio * margin) return;
  throw UsageError(
      "pairs: '{}' and '{}': a pull-off force of {} alone presses a contact {} deep, through the margins of {}; raise the stiffness or the "
      "margin",
      a.name, b.name, format_quantity(pull_off_force(pair, radius), Dimension::force), format_quantity(overlap, Dimension::length),
      format_quantity(margin, Dimension::length));
}

void check_is_ball_where_necks_are(const Scene& scene, const Shape& shape, std::int32_t material,
                                   const std::function<std::string()>& body) {
  if (shape.kind == ShapeKind::sphere) return;
  for (const MaterialPair& pair : scene.pairs) {
    if (pull_kind(pair) != PullKind::neck || (pair.a != material && pair.b != material)) continue;
    throw UsageError(
        "pairs: {} has the shape '{}' and the material '{}', which sticks by adhesion_hysteresis: that is the theory of JKR, of balls; for "
        "other shapes give adhesion_range in its place",
        body(), shape.name, scene.materials[static_cast<std::size_t>(material)].name);
  }
}

void check_thickness(const Shape& shape, double scale, const std::function<std::string()>& body, double reach) {
  const bool is_ball = shape.kind == ShapeKind::sphere;
  const double thickness = scale * (is_ball ? 2 * shape.sphere_radius : 2 * shape.mass.volume / shape.area);
  if (reach <= thickness) return;
  throw UsageError(
      "pairs: margins and the range of the attraction reach {} together, further than {} ('{}') is thick ({}, {}): what lies "
      "behind it would be attracted through it; reduce adhesion_range or the margins",
      format_quantity(reach, Dimension::length), body(), shape.name, format_quantity(thickness, Dimension::length),
      is_ball ? "its diameter" : "twice its volume over its area");
}

}  // namespace scree
