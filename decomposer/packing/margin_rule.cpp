#include "decomposer/packing/margin_rule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/contact_limits.hpp"

namespace scree {

namespace {

std::string metres(double value) { return format_quantity(value, Dimension::length); }

/// Points that span a wall: where things can fall to, and what its rotation moves.
std::vector<Vec3> wall_points(const SceneParts& parts, std::size_t i) {
  const Wall& w = parts.walls[i];
  switch (w.kind) {
    case WallKind::plane:
      return {w.point};
    case WallKind::box_inside:
      return {w.lower,
              w.upper,
              {w.upper.x, w.lower.y, w.lower.z},
              {w.lower.x, w.upper.y, w.lower.z},
              {w.lower.x, w.lower.y, w.upper.z},
              {w.lower.x, w.upper.y, w.upper.z},
              {w.upper.x, w.lower.y, w.upper.z},
              {w.upper.x, w.upper.y, w.lower.z}};
    case WallKind::cylinder_inside: {
      std::vector<Vec3> points;
      for (const Vec3& end : {w.axis_start, w.axis_end}) {
        for (int k = 0; k < 3; ++k) {
          Vec3 arm;
          arm[k] = w.radius;
          points.push_back(end + arm);
          points.push_back(end - arm);
        }
      }
      return points;
    }
    case WallKind::sphere_inside: {
      std::vector<Vec3> points;
      for (int k = 0; k < 3; ++k) {
        Vec3 arm;
        arm[k] = w.radius;
        points.push_back(w.point + arm);
        points.push_back(w.point - arm);
      }
      return points;
    }
    case WallKind::mesh:
      return parts.wall_bodies[i].world_vertices();
  }
  return {};
}

/// A wall that leaves all places where bodies start behind it, such as a gate that drops: nothing runs into it, nor it into anything.
bool moves_away(const WallMotion& motion, const std::vector<Vec3>& points, const std::vector<Vec3>& starts) {
  const auto* along = std::get_if<Translate>(&motion.kind);
  if (along == nullptr || along->rate == 0 || points.empty()) return false;
  const Vec3 way = (along->rate > 0 ? 1.0 : -1.0) * along->axis;
  double nearest = 1e300, farthest = -1e300;
  for (const Vec3& p : points) nearest = std::min(nearest, dot(way, p));
  for (const Vec3& p : starts) farthest = std::max(farthest, dot(way, p));
  return farthest <= nearest;
}

/// Fastest impact to expect: initial speeds, the highest fall, the fastest wall.
double fastest_impact(const Case& c, const SceneParts& parts, const Scene& scene) {
  double speed = 0;
  std::size_t movers = parts.draws.size();
  for (const CaseBody& b : c.bodies) {
    const double lever = b.scale * parts.shape(b.shape).radius;
    speed = std::max(speed, length(b.velocity) + lever * length(b.angular_velocity));
    movers += b.fixed ? 0 : 1;
  }
  for (const Draw& d : parts.draws) {
    const CasePopulation& p = c.populations[d.population];
    const double lever = d.scale * parts.shape(d.shape).radius;
    speed = std::max(speed, length(p.velocity) + lever * length(p.angular_velocity));
  }
  for (const CaseInlet& i : c.inlets) {
    for (const auto& share : i.shares) {
      const PackShape& shape = parts.shape(share.first);
      const double lever = scales_of(i.size, shape.shape).largest * shape.radius;
      speed = std::max(speed, length(i.velocity) + lever * length(i.angular_velocity));
    }
    movers += 2;
  }
  std::vector<Vec3> starts;
  for (const CaseBody& b : c.bodies) starts.push_back(b.position);
  for (std::size_t i = 0; parts.carried && i < parts.carried->placed.size(); ++i) starts.push_back(parts.carried->placed[i].position);
  for (const std::vector<Region>* regions : {&parts.regions, &parts.inlets}) {
    for (const Region& r : *regions) {
      for (int corner = 0; corner < 8; ++corner) {
        starts.push_back({(corner & 1 ? r.box.upper : r.box.lower).x, (corner & 2 ? r.box.upper : r.box.lower).y,
                          (corner & 4 ? r.box.upper : r.box.lower).z});
      }
    }
  }
  double wall_speed = 0;
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    // what rides on a surface has its speed where it leaves it
    const Wall& wall = scene.walls[i];
    const std::vector<Vec3> points = wall_points(parts, i);
    if (!moves_away(wall.motion, points, starts)) wall_speed = std::max(wall_speed, wall.motion.fastest(points));
    wall_speed = std::max(wall_speed, wall.surface.motion.fastest(points));
  }
  for (std::size_t i = 0; parts.carried && i < parts.carried->placed.size(); ++i) {
    const BodyRow& row = parts.carried->from.bodies[i];
    speed = std::max(speed, length(row.velocity) + parts.carried->placed[i].radius() * length(row.angular_velocity));
    movers += row.fixed ? 0 : 1;
  }
  const double g = length(c.settings.gravity);
  double fall = 0;
  if (g > 0) {
    const Vec3 up = (-1.0 / g) * c.settings.gravity;
    double top = -1e300, bottom = 1e300;
    for (const Vec3& p : starts) {
      top = std::max(top, dot(up, p));
      bottom = std::min(bottom, dot(up, p));
    }
    bool has_walls = !scene.walls.empty();
    for (std::size_t i = 0; i < scene.walls.size(); ++i) {
      const WallMotion& motion = scene.walls[i].motion;
      double lower = 0;  // where it stops
      for (const Vec3& way : motion.displacements(c.settings.duration)) {
        if (!motion.drive() && motion.end() < c.settings.duration) lower = std::min(lower, dot(up, way));
      }
      for (const Vec3& p : wall_points(parts, i)) bottom = std::min(bottom, dot(up, p) + lower);
    }
    // what is poured falls before the run begins
    const bool poured =
        std::any_of(c.populations.begin(), c.populations.end(), [](const CasePopulation& p) { return p.method == PackingMethod::settle; });
    fall = g * c.settings.duration;
    if (poured)
      fall = std::sqrt(2 * g * std::max(0.0, top - bottom));
    else if (has_walls && top > bottom)
      fall = std::min(fall, std::sqrt(2 * g * (top - bottom)));
  }
  return fall + (movers >= 2 ? 2 : 1) * speed + wall_speed;
}

constexpr double kNoticeShare = 0.05, kLargestShare = 0.2;  // margins that are told, and refused, over the smallest body's diameter

/// What a margin was derived from.
struct Sizing {
  const Settings& settings;
  double derived = 0, smallest = 0;  ///< margin, smallest diameter [m]
  double lightest = 0;               ///< [kg]
  double softest = 0;                ///< [N/m]
  double speed = 0;                  ///< of the fastest impact [m/s]
  bool by_modulus = false;           ///< stiffness goes with size
  bool balls_alone = false;          ///< which have no margins: what is derived is their overlap
};

/// Sets of stiffness, margin and speed that go together, each with the step that it asks for.
std::string choices(const Sizing& s) {
  const double good = kNoticeShare * s.smallest, deeper = s.derived / good;
  const auto cost = [&](double stiffness) {
    const double step = std::numbers::pi * std::sqrt(s.lightest / (2 * stiffness)) / s.settings.steps_per_contact;
    return fmt::format("a step of about {}, {:.2g} steps", format_quantity(step, Dimension::time), s.settings.duration / step);
  };
  const std::string margin = s.balls_alone
                                 ? fmt::format("overlaps of {:.0f} % of the smallest ball", 100 * 2 * kOverlapShare * kNoticeShare)
                                 : fmt::format("a margin of {} ({:.0f} % of the smallest body)", metres(good), 100 * kNoticeShare);
  std::string text = "  what goes together:";
  const double stiffer = s.softest * deeper * deeper;
  if (s.settings.law == ContactLaw::hertz_mindlin)
    text += fmt::format("\n  - materials.young {:.3g} times as large: {}, {}", std::pow(deeper, 2.5), margin, cost(stiffer));
  else if (s.by_modulus)
    text += fmt::format("\n  - pairs.modulus {:.3g} times as large: {}", deeper * deeper, margin);
  else
    text += fmt::format("\n  - pairs.stiffness = \"{}\": {}, {}", format_quantity(stiffer, Dimension::stiffness), margin, cost(stiffer));
  text += fmt::format("\n  - contact.impact_speed = \"{}\", where nothing meets faster than that: {}, {}",
                      format_quantity(s.speed / deeper, Dimension::velocity), margin, cost(s.softest));
  constexpr double kMaxShare = 0.5;
  if (s.balls_alone) {
    text += fmt::format("\n  - contact.margin = 0: {}", cost(s.softest));
  } else if (s.derived < kMaxShare * s.smallest) {
    text += fmt::format("\n  - contact.margin = \"{}\", {:.0f} % of the smallest body, whose shape is then rounded by as much: {}",
                        metres(s.derived), 100 * s.derived / s.smallest, cost(s.softest));
  }
  return text;
}

/// A body with a mesh.
struct MeshBody {
  double mass = 0, radius = 0;  ///< [kg], of the ball of its volume [m]
};

MeshBody median_of(std::vector<MeshBody> bodies) {
  if (bodies.empty()) return {};
  const auto middle = bodies.begin() + static_cast<std::ptrdiff_t>(bodies.size() / 2);
  std::nth_element(bodies.begin(), middle, bodies.end(), [](const MeshBody& a, const MeshBody& b) { return a.mass < b.mass; });
  return *middle;
}
bool is_smaller(const MeshBody& a, const MeshBody& b) { return a.radius < b.radius; }
MeshBody largest_of(const std::vector<MeshBody>& all) {
  return all.empty() ? MeshBody{} : *std::max_element(all.begin(), all.end(), is_smaller);
}
MeshBody smallest_of(const std::vector<MeshBody>& all) {
  return all.empty() ? MeshBody{} : *std::min_element(all.begin(), all.end(), is_smaller);
}

/// The thinnest of the shapes with meshes that move.
struct Thinnest {
  const Shape* shape = nullptr;
  double half = 1e300;  ///< see half_thickness()
  std::set<const Shape*> seen;

  void add(const Shape& s) {
    if (s.kind == ShapeKind::sphere || !seen.insert(&s).second) return;
    const double of_shape = half_thickness(s);
    if (of_shape >= half) return;
    half = of_shape;
    shape = &s;
  }
  double ratio() const { return kThinShare * half; }
};

/// in   cure   what would make a margin possible that is thin enough; empty where it is taken
std::string thin_text(const Thinnest& thinnest, const std::string& cure) {
  const std::string ratio = fmt::format("contact.margin_ratio = {:.2g}", thinnest.ratio());
  if (cure.empty()) return fmt::format("'{}' is thinner than two margins of 2 % of its radius: {} is taken", thinnest.shape->name, ratio);
  return fmt::format(
      "'{}' is thinner than the two margins that the fastest impact asks for, and touches outside of its drawn surface; {} would bring it "
      "to "
      "{}, at which it touches where it is drawn",
      thinnest.shape->name, cure, ratio);
}

/// What makes the margin so many times narrower: depths go with the root of the stiffness.
std::string stiffer_cure(const Case& c, double softest, double narrower) {
  const double stiffer = narrower * narrower;
  if (c.settings.law == ContactLaw::hertz_mindlin) return fmt::format("materials.young {:.3g} times as large", std::pow(narrower, 2.5));
  if (std::any_of(c.pairs.begin(), c.pairs.end(), [](const CasePair& p) { return p.pair.modulus > 0; }))
    return fmt::format("pairs.modulus {:.3g} times as large", stiffer);
  return fmt::format("pairs.stiffness = \"{}\"", format_quantity(softest * stiffer, Dimension::stiffness));
}

/// Weights of the largest body that the smallest must bear within its margins, lying under it.
constexpr double kLoadOfSmallest = 10;
/// Margin of fixed meshes over their radius where nothing meets them.
constexpr double kRatioOfFixed = 0.02;

}  // namespace

double half_thickness(const Shape& shape) {
  return shape.area > 0 ? shape.mass.volume / (shape.area * 0.5 * shape.equivalent_diameter()) : 1e300;
}

void choose_margin(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report) {
  Settings& settings = scene.settings;
  // bodies that rest on each other do so as their run had them touch
  if (parts.carried && !c.surface_given) settings.surface = parts.carried->from.scene.settings.surface;
  // cells of a cut have corners too sharp to be moved in by a margin (docs/develop/decisions/023)
  const bool has_pieces = std::any_of(c.shapes.begin(), c.shapes.end(), [](const CaseShape& s) { return s.falls_apart(); });
  if (has_pieces && !c.surface_given) settings.surface = TouchAt::outside;
  const bool by_size = settings.surface == TouchAt::drawn;
  double heaviest = 0, lightest = 1e300, smallest = 1e300, widest = 0;
  bool has_meshes = false, has_balls = false;
  std::vector<MeshBody> meshes, fixed_meshes;
  Thinnest thinnest;
  const auto add = [&](const Shape& s, std::int32_t material, double scale, bool moves) {
    has_meshes = has_meshes || s.kind != ShapeKind::sphere;
    has_balls = has_balls || s.kind == ShapeKind::sphere;
    const double mass = scene.materials[static_cast<std::size_t>(material)].density * s.mass.volume * scale * scale * scale;
    if (s.kind != ShapeKind::sphere) (moves ? meshes : fixed_meshes).push_back({mass, 0.5 * scale * s.equivalent_diameter()});
    if (!moves) return;
    thinnest.add(s);
    heaviest = std::max(heaviest, mass);
    lightest = std::min(lightest, mass);
    smallest = std::min(smallest, scale * s.equivalent_diameter());
    widest = std::max(widest, scale * s.equivalent_diameter());
  };
  // a part on a guide comes down on bodies with all of its mass
  for (const Wall& wall : scene.walls) {
    if (const std::optional<Drive> drive = wall.motion.drive(); drive && !drive->guide.turns) heaviest = std::max(heaviest, drive->inertia);
  }
  for (const CaseBody& b : c.bodies) add(parts.shape(b.shape).shape, b.material, b.scale, !b.fixed);
  for (const Draw& d : parts.draws) add(parts.shape(d.shape).shape, c.populations[d.population].material, d.scale, true);
  if (parts.carried) {
    for (const BodyRow& row : parts.carried->from.bodies)
      add(parts.carried->shapes[static_cast<std::size_t>(row.shape)].shape, row.material, row.scale, !row.fixed);
  }
  for (const CaseInlet& i : c.inlets) {
    for (const auto& share : i.shares) {
      const Shape& shape = parts.shape(share.first).shape;
      const ScaleRange scales = scales_of(i.size, shape);
      for (const double scale : {scales.smallest, scales.largest}) add(shape, i.material, scale, true);
    }
  }
  report.fastest_impact = c.settings.impact_speed > 0 ? c.settings.impact_speed : fastest_impact(c, parts, scene);
  scene.settings.impact_speed = report.fastest_impact;
  bool wall_meshes = false;
  for (const CaseWall& w : c.walls) wall_meshes = wall_meshes || w.wall.kind == WallKind::mesh;
  // spheres touch where they touch; a barrier is made of margins
  const bool from_touch = !has_meshes && (by_size || !wall_meshes) && !(c.settings.barrier > 0);
  double softest = 1e300;
  if (c.settings.law == ContactLaw::hertz_mindlin) {
    // the stiffness of a linear spring that the worst impact presses as deep: k = m v^2 / d^2
    for (const CasePair& p : c.pairs) {
      const double modulus =
          effective_modulus(scene.materials[static_cast<std::size_t>(p.pair.a)], scene.materials[static_cast<std::size_t>(p.pair.b)]);
      const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.25 * smallest;  // two bodies of the smallest size
      const double pressed = heaviest > 0 ? hertz_impact_overlap(modulus, radius, heaviest, report.fastest_impact) : 0;
      if (pressed > 0) softest = std::min(softest, heaviest * std::pow(report.fastest_impact / pressed, 2));
    }
  } else {
    // a layer has no stiffness of one contact; its margin is given
    if (c.settings.gather != Gathering::area) {
      for (const CasePair& p : c.pairs) softest = std::min(softest, p.pair.spring(0.25 * widest));  // by size: two of the largest
    }
  }
  double depth = heaviest > 0 && softest < 1e300 ? report.fastest_impact * std::sqrt(heaviest / softest) : 0;
  // what attracts is pressed deeper, and not by its speed alone
  std::string pulled;
  for (const CasePair& p : c.pairs) {
    if (!attracts(p.pair) || !(heaviest > 0) || c.settings.gather == Gathering::area) continue;  // margins of layers are given
    const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.5 * widest;      // R* of the largest body on a wall
    const Material &a = scene.materials[static_cast<std::size_t>(p.pair.a)], &b = scene.materials[static_cast<std::size_t>(p.pair.b)];
    const double pressed = impact_overlap(c.settings.law, p.pair, a, b, radius, heaviest, report.fastest_impact);
    if (pressed <= depth) continue;
    constexpr double kWorthTelling = 1.01;
    const bool tells = pressed > kWorthTelling * depth;
    depth = pressed;
    if (!tells) continue;
    pulled = fmt::format(", and the attraction of {} of '{}' and '{}'", format_quantity(pull_off_force(p.pair, radius), Dimension::force),
                         a.name, b.name);
  }

  report.impact_overlap = depth;
  // a mesh wall and a ball have no margin beside that of the body that they meet
  const double sides = by_size && (wall_meshes || has_balls) ? 1 : 2;
  // Margins that go with size are those of bodies with meshes. Where balls alone move they are those of the fixed meshes, of which the
  // smallest must bear the blow of the heaviest ball.
  const bool balls_on_fixed = meshes.empty() && !fixed_meshes.empty();
  const std::vector<MeshBody>& sized = balls_on_fixed ? fixed_meshes : meshes;
  const MeshBody median = median_of(sized), least = smallest_of(sized), hit = balls_on_fixed ? least : largest_of(sized);
  const double load = balls_on_fixed ? heaviest : hit.mass;
  double& margin = settings.margin;
  if (by_size && c.margin_given && settings.margin_ratio > 0) margin = settings.margin_ratio * median.radius;
  const Settings* before = parts.carried ? &parts.carried->from.scene.settings : nullptr;
  double margin_before = before == nullptr ? 0 : before->margin;
  if (by_size && before != nullptr) margin_before = before->margin_ratio * median.radius;
  // bodies that rest on each other do so at the margins of their run
  const bool keeps_margin =
      !c.margin_given && before != nullptr && before->surface == settings.surface && (margin_before > 0 || from_touch);
  report.margin_from = c.margin_given ? "given" : keeps_margin ? "that of the run" : "derived";
  if (keeps_margin) margin = margin_before;
  if (!c.margin_given && heaviest > 0 && !(margin > 0)) {
    constexpr double kSmallestShare = 0.01;  // of the smallest body's diameter
    double derived = std::max(depth / (sides * kOverlapShare), kSmallestShare * smallest);
    if (by_size && !sized.empty()) {
      // margins go with size: the largest moving body decides for blows, the smallest for what lies on it
      double between = softest;  // of the largest body on the smallest
      for (const CasePair& p : c.pairs)
        if (p.pair.modulus > 0) between = std::min(between, p.pair.spring(1 / (1 / hit.radius + 1 / least.radius)));
      const double pinch = kLoadOfSmallest * load * length(settings.gravity) / between;
      const double needed = std::max(depth / (sides * kOverlapShare * hit.radius), pinch / (sides * kOverlapShare * least.radius));
      double ratio = std::max(needed, 2 * kSmallestShare);
      if (ratio > thinnest.half) {
        const bool is_free = needed <= thinnest.ratio();
        report.notices.push_back(thin_text(thinnest, is_free ? "" : stiffer_cure(c, softest, needed / thinnest.ratio())));
        if (is_free) ratio = thinnest.ratio();
      }
      derived = ratio * least.radius;
      if (balls_on_fixed) smallest = 2 * least.radius;  // what the margin rounds
    }
    // the depth of a blow goes with the root of the stiffness, that of what lies on a body with the stiffness: less would do for that
    const double needed = from_touch ? heaviest * std::pow(report.fastest_impact / (kOverlapShare * 2 * kNoticeShare * smallest), 2)
                                     : softest * std::pow(derived / (kNoticeShare * smallest), 2);
    const std::string from = fmt::format(
        "the heaviest body ({}), the fastest impact expected ({}) and the softest pair ({}){}", format_quantity(heaviest, Dimension::mass),
        format_quantity(report.fastest_impact, Dimension::velocity), format_quantity(softest, Dimension::stiffness), pulled);
    const bool by_modulus = std::any_of(c.pairs.begin(), c.pairs.end(), [](const CasePair& p) { return p.pair.modulus > 0; });
    const std::string cure = by_modulus ? fmt::format("a modulus {:.3g} times as large would bring it to", needed / softest)
                                        : fmt::format("a stiffness of {} would bring it to", format_quantity(needed, Dimension::stiffness));
    // Without margins the solver has no guard against depth: the same limits hold, of the depth that margins would be made for. Not for
    // Hertz contacts: what is soft there is so by its material, not by choice.
    const bool is_free_of_limits = from_touch && c.settings.law == ContactLaw::hertz_mindlin;
    const std::string advice = from_touch
                                   ? fmt::format("{} press spheres into each other by {}, {:.0f} % of the smallest diameter; {} {:.0f} %",
                                                 from, metres(depth), 100 * depth / smallest, cure, 100 * 2 * kOverlapShare * kNoticeShare)
                                   : fmt::format("the margin derived from {} is {}, {:.0f} % of the smallest body; {} {:.0f} %", from,
                                                 metres(derived), 100 * derived / smallest, cure, 100 * kNoticeShare);
    if (derived > kLargestShare * smallest && !is_free_of_limits) {
      throw UsageError("{}: contact.margin: {}; raise it, or give contact.margin{}\n{}", c.path, advice,
                       from_touch ? " (0: run it as it is)" : "",
                       choices({c.settings, from_touch ? depth / (2 * kOverlapShare) : derived, smallest, lightest, softest,
                                report.fastest_impact, by_modulus, from_touch}));
    }
    if (derived > kNoticeShare * smallest && !is_free_of_limits) report.notices.push_back(advice);
    if (!from_touch) margin = by_size && !sized.empty() ? derived / least.radius * median.radius : derived;
  }
  if (has_meshes && !(margin > 0)) {
    throw UsageError(
        "{}: contact.margin = 0: meshes need a margin > 0 (typically 1 to 3 % of the body's size); leave it out to have it derived",
        c.path);
  }
  if (by_size) settings.margin_ratio = median.radius > 0 ? margin / median.radius : 0;
  if (by_size && has_meshes && !(settings.margin_ratio > 0)) settings.margin_ratio = kRatioOfFixed;
  if (by_size && !(settings.margin_ratio > 0)) {
    if (margin > 0 && c.margin_given)
      report.notices.push_back(
          fmt::format("contact.margin = {} is of no effect: all bodies are balls, which touch where they are drawn", metres(margin)));
    margin = 0;
  }
  const double layer = by_size ? sides * settings.margin_ratio * hit.radius : 2 * margin;
  if (layer > 0) report.overlap_share = depth / layer;
  constexpr double kWarnShare = 0.8;
  if (report.overlap_share > kWarnShare) {
    report.notices.push_back(fmt::format(
        "the fastest impact expected ({}) of the heaviest body or part ({}) would use up {:.2f} of the margins, of which {} end the run; "
        "raise stiffness to {} or margin to {}",
        format_quantity(report.fastest_impact, Dimension::velocity), format_quantity(heaviest, Dimension::mass), report.overlap_share,
        kStopOverlapRatio, format_quantity(softest * std::pow(report.overlap_share / kOverlapShare, 2), Dimension::stiffness),
        metres(margin * report.overlap_share / kOverlapShare)));
  }
}

}  // namespace scree
