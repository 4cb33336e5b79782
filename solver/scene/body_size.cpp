#include "solver/scene/body_size.hpp"

#include <algorithm>

#include "core/storage/attraction.hpp"

namespace scree {

namespace {

constexpr double kScaleRounding = 1e-9;  // relative: a scale from a computed diameter is that of the case

bool is_above(double value, double limit) { return value > limit * (1 + kScaleRounding); }

double largest_radius(const BodyExtremes& extremes) { return *std::max_element(extremes.radius.begin(), extremes.radius.end()); }

/// Whether maximum overlaps, and tables of mesh walls, would have been made otherwise.
bool changes_margins(const SolverScene& scene, const BodyExtremes& made_for, const BodyExtremes& with) {
  const std::vector<Wall>& walls = scene.source().walls;
  const bool has_mesh_walls = std::any_of(walls.begin(), walls.end(), [](const Wall& w) { return w.kind == WallKind::mesh; });
  if (!scene.margins_by_size() || !(with.largest_margin > 0 || has_mesh_walls)) return false;
  const bool has_balls = with.least_ball < BodyExtremes::kNone;
  return is_above(with.largest_margin, made_for.largest_margin) || is_above(made_for.least_margin, with.least_margin) ||
         is_above(made_for.least_ball, with.least_ball) || (has_balls && is_above(largest_radius(with), largest_radius(made_for)));
}

}  // namespace

std::string size_fault(const SolverScene& scene, std::int32_t shape, std::int32_t material, double scale) {
  const Scene& source = scene.source();
  const BodyExtremes& made_for = scene.extremes();
  BodyExtremes with = made_for;
  scene.include_body(shape, material, scale, false, 0, with);
  const double radius = scale * scene.shape(shape).equivalent_radius;
  const char* const cure = "give a scale within that, or give the case a body or an inlet of this size";
  if (changes_margins(scene, made_for, with))
    return fmt::format(
        "an equivalent radius of {:g} m, for which the margins and the tables of mesh walls were not made (contact.margin_ratio): bodies "
        "and "
        "inlets of the case have margins from {:g} to {:g} m, {}equivalent radii of at most {:g} m; {}",
        radius, made_for.least_margin < BodyExtremes::kNone ? made_for.least_margin : 0, made_for.largest_margin,
        made_for.least_ball < BodyExtremes::kNone ? fmt::format("balls of at least {:g} m and ", made_for.least_ball) : "",
        largest_radius(made_for), cure);
  for (const MaterialPair& pair : source.pairs) {
    if (!attracts(pair) || (pair.a != material && pair.b != material)) continue;
    const Material &a = source.materials[static_cast<std::size_t>(pair.a)], &b = source.materials[static_cast<std::size_t>(pair.b)];
    const double needed = attraction_range(source.settings.law, pair, a, b, scene.largest_impact(pair, with).radius),
                 made = scene.law(pair.a, pair.b).reach;
    if (is_above(needed, made))
      return fmt::format(
          "an equivalent radius of {:g} m, for which the attraction of '{}' and '{}' was not made: it needs a range of {:g} m and has {:g} "
          "m; {}",
          radius, a.name, b.name, needed, made, cure);
  }
  return "";
}

}  // namespace scree
