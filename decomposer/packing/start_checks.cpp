#include "decomposer/packing/start_checks.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/seam_meshes.hpp"
#include "core/storage/wall_zones.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

void check_attraction(const Case& c, const SceneParts& parts, const Scene& scene) {
  if (!std::any_of(scene.pairs.begin(), scene.pairs.end(), attracts)) return;
  const Settings& s = scene.settings;
  for (const CaseShape& shape : c.shapes) {
    if (shape.cell_size > 0)
      throw UsageError("{}.cell_size: does not go with the attraction of a pair (pull_off, adhesion or surface_tension)", shape.where);
  }
  for (const CaseWall& w : c.walls) {
    if (w.wall.cell_size > 0)
      throw UsageError("{}.cell_size: does not go with the attraction of a pair (pull_off, adhesion or surface_tension)", w.where);
  }
  const double reach = 2 * common_margin(s) + widest_range(scene);
  std::vector<double> radius(scene.materials.size(), 0.0);
  const auto add = [&](std::int32_t shape, std::int32_t material, double scale, std::int64_t id) {
    const Shape& of = parts.shape(shape).shape;
    double& largest = radius[static_cast<std::size_t>(material)];
    largest = std::max(largest, 0.5 * scale * of.equivalent_diameter());
    const auto body = [&] { return fmt::format("body {}", id); };
    check_thickness(of, scale, body, reach);
    check_is_ball_where_necks_are(scene, of, material, body);
  };
  for (std::size_t i = 0; i < c.bodies.size(); ++i)
    add(c.bodies[i].shape, c.bodies[i].material, c.bodies[i].scale, parts.first_id + static_cast<std::int64_t>(i));
  for (const Draw& d : parts.draws) add(d.shape, c.populations[d.population].material, d.scale, d.id);
  for (const Inlet& inlet : scene.inlets) {
    for (const Inlet::Share& share : inlet.shares) {
      const Shape& of = scene.shapes[static_cast<std::size_t>(share.shape)];
      double& largest = radius[static_cast<std::size_t>(inlet.material)];
      largest = std::max(largest, 0.5 * (inlet.size ? inlet.size->max : of.equivalent_diameter()));
      const auto body = [&] { return fmt::format("a body of the inlet '{}'", inlet.name); };
      check_thickness(of, scales_of(inlet.size, of).smallest, body, reach);
      check_is_ball_where_necks_are(scene, of, inlet.material, body);
    }
  }
  for (const CasePair& p : c.pairs) {
    const auto a = static_cast<std::size_t>(p.pair.a), b = static_cast<std::size_t>(p.pair.b);
    check_pressing(s, p.pair, scene.materials[a], scene.materials[b],
                   p.pair.contact_radius > 0 ? p.pair.contact_radius : std::max(radius[a], radius[b]),
                   s.surface == TouchAt::drawn ? 2 * s.margin_ratio * std::max(radius[a], radius[b]) : 2 * s.margin);
  }
}

void check_periodic_axes(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& notices) {
  const Domain& domain = c.settings.domain;
  const Periodicity periodicity = periodicity_of(domain);
  if (!periodicity.any()) return;
  const double gas = scene.settings.heat ? scene.settings.heat->gas_range : 0;
  const double range = common_margin(scene.settings) + 0.5 * std::max(widest_range(scene), gas);
  double largest = 0;
  const auto check = [&](double radius, std::int64_t id) {
    check_period(periodicity, radius, range, [&] { return fmt::format("body {}", id); });
    largest = std::max(largest, radius);
  };
  for (std::size_t i = 0; i < c.bodies.size(); ++i)
    check(c.bodies[i].scale * parts.shape(c.bodies[i].shape).radius, parts.first_id + static_cast<std::int64_t>(i));
  for (std::size_t i = 0; parts.carried && i < parts.carried->placed.size(); ++i)
    check(parts.carried->placed[i].radius(), parts.carried->from.bodies[i].id);
  for (const Draw& d : parts.draws) check(d.scale * parts.shape(d.shape).radius, d.id);
  for (const Inlet& inlet : scene.inlets) {
    for (const Inlet::Share& share : inlet.shares) {
      const Shape& shape = scene.shapes[static_cast<std::size_t>(share.shape)];
      const double radius = scales_of(inlet.size, shape).largest * shape.bounding_radius();
      check_period(periodicity, radius, range, [&] { return fmt::format("a body of the inlet '{}'", inlet.name); });
      largest = std::max(largest, radius);
    }
  }
  std::vector<std::string> dropped;
  wall_zones(scene.walls, periodicity, dropped);
  for (std::string& gap : check_meshes_at_seams(scene.walls, scene.shapes, domain, largest + 2 * range, scene.settings.duration)) {
    notices.push_back(std::move(gap));
  }
}

void check_needs_of_margin(const Case& c, const Settings& s) {
  if (s.margin > 0) return;
  for (const CaseWall& w : c.walls) {
    if (w.wall.kind != WallKind::mesh || s.surface == TouchAt::drawn) continue;
    throw UsageError(
        "{}: contact.margin = 0, but wall '{}' is a mesh and needs a margin > 0 (typically 1 to 3 % of a body's size); leave "
        "contact.margin out to have it derived",
        w.where, w.wall.name);
  }
  if (s.gather == Gathering::area)
    throw UsageError("{}: with contact.gather = \"area\" the margins are the elastic layer, but {}", c.path,
                     s.surface == TouchAt::drawn && !(c.margin_given && c.settings.margin == 0)
                         ? "balls have margins only with contact.surface = \"outside\": give it"
                         : "contact.margin = 0: give them a thickness");
  if (s.barrier > 0)
    throw UsageError(
        "{}: contact.barrier = {:g} needs margins: give contact.margin a value > 0; analytic spheres have margins only with "
        "contact.surface = \"outside\"",
        c.path, s.barrier);
}

}  // namespace

void check_start(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& notices) {
  check_periodic_axes(c, parts, scene, notices);
  check_needs_of_margin(c, scene.settings);
  check_attraction(c, parts, scene);
  const Settings& s = scene.settings;
  const bool is_frozen = s.heat && s.heat->frozen;
  const bool moves = !is_frozen && (parts.carried || !parts.draws.empty() || !c.inlets.empty() ||
                                    std::any_of(c.bodies.begin(), c.bodies.end(), [](const CaseBody& b) { return !b.fixed; }));
  if (s.law == ContactLaw::hertz_mindlin && moves && !scene.pairs.empty() && !(s.margin > 0) && !(s.impact_speed > 0) && !(s.step > 0)) {
    throw UsageError(
        "{}: contact.impact_speed is missing, and the case has no speed, no fall and no moving wall to derive it from: the step follows "
        "from the stiffness of a Hertz contact, which grows with its overlap; give the speed of the fastest impact, or time.step",
        c.path);
  }
}

}  // namespace scree
