#include "core/storage/attraction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/contact_limits.hpp"

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

}  // namespace

double pull_off_factor(AdhesionModel model) { return (model == AdhesionModel::jkr ? 1.5 : 2.0) * std::numbers::pi; }

double pull_off_force(const MaterialPair& pair, double radius) {
  return pair.adhesion > 0 ? pull_off_factor(pair.adhesion_model) * pair.adhesion * radius : pair.pull_off;
}

RestingContact resting_contact(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  const Push push = push_of(law, pair, a, b, radius);
  const double force = pull_off_force(pair, radius), overlap = push.overlap_of_force(force);
  return {overlap, force * overlap - push.energy(overlap)};
}

double attraction_range(ContactLaw law, const MaterialPair& pair, const Material& a, const Material& b, double radius) {
  if (!(pair.separation_energy > 0)) return pair.adhesion_range;
  return std::max(0.0, 2 * (pair.separation_energy - resting_contact(law, pair, a, b, radius).energy) / pull_off_force(pair, radius));
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

AttractionFault attraction_fault(const Settings& settings, const MaterialPair& pair, const Material& a, const Material& b) {
  if (!attracts(pair)) {
    if (pair.adhesion_range > 0)
      return {"adhesion_range", "goes with pull_off or adhesion, which say how strong the attraction is; give one of them"};
    if (pair.separation_energy > 0)
      return {"separation_energy", "goes with pull_off or adhesion, which say how strong the attraction is; give one of them"};
    return {};
  }
  const char* force = pair.adhesion > 0 ? "adhesion" : "pull_off";
  if (pair.pull_off > 0 && pair.adhesion > 0) return {"pull_off", "is the force that `adhesion` gives too; keep one of them"};
  if (settings.gather != Gathering::potential) return {force, "goes with contact.gather = \"potential\" only"};
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
  const Push push = push_of(law, pair, a, b, radius);
  const double force = pull_off_force(pair, radius),
               arrives = 0.5 * mass * speed * speed + 0.5 * force * attraction_range(law, pair, a, b, radius);
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
  if (!attracts(pair) || !(radius > 0) || !(margin > 0) || settings.barrier > 0) return;
  const double overlap = resting_contact(settings.law, pair, a, b, radius).overlap;
  if (overlap < kStopOverlapRatio * margin) return;
  throw UsageError(
      "pairs: '{}' and '{}': a pull-off force of {} alone presses a contact {} deep, through the margins of {}; raise the stiffness or the "
      "margin",
      a.name, b.name, format_quantity(pull_off_force(pair, radius), Dimension::force), format_quantity(overlap, Dimension::length),
      format_quantity(margin, Dimension::length));
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
