#include "decomposer/packing/margin_rule.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/contact_limits.hpp"
#include "core/storage/plasticity.hpp"

namespace scree {

namespace {

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

struct FastestImpact {
  double speed = 0;     ///< [m/s]
  std::string of_wall;  ///< where most of it is the speed of a wall, how much and which
};

/// Fastest impact to expect: initial speeds, the highest fall, the fastest wall.
FastestImpact fastest_impact(const Case& c, const SceneParts& parts, const Scene& scene) {
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
  std::string wall_name;
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    // what rides on a surface has its speed where it leaves it
    const Wall& wall = scene.walls[i];
    const std::vector<Vec3> points = wall_points(parts, i);
    const double moves = moves_away(wall.motion, points, starts) ? 0 : wall.motion.fastest(points);
    const double fastest = std::max(moves, wall.surface.motion.fastest(points));
    if (!(fastest > wall_speed)) continue;
    wall_speed = fastest;
    wall_name = fmt::format("{} (wall '{}')", c.walls[i].where, wall.name);
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
  const double all = fall + (movers >= 2 ? 2 : 1) * speed + wall_speed;
  return {all, wall_speed > 0.5 * all
                   ? fmt::format(", of which {} are the speed of {}", format_quantity(wall_speed, Dimension::velocity), wall_name)
                   : ""};
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
  double steepening = 1;             ///< of the steepest contact that yields
};

/// Sets of stiffness, margin and speed that go together, each with the step that it asks for.
std::string choices(const Sizing& s) {
  const double good = kNoticeShare * s.smallest, deeper = s.derived / good;
  const auto cost = [&](double stiffness) {
    const double step = std::numbers::pi * std::sqrt(s.lightest / (2 * stiffness * s.steepening)) / s.settings.steps_per_contact;
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
      "to {}, at which it touches where it is drawn",
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

/// The parts of choose_margin(), in their order.
class MarginRule {
 public:
  MarginRule(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report)
      : case_(c), parts_(parts), scene_(scene), settings_(scene.settings), report_(report) {}

  void choose() {
    choose_surface();
    find_bodies();
    find_softest();
    find_depth();
    choose_sizes();
    if (!case_.margin_given && heaviest_ > 0 && !(settings_.margin > 0)) derive();
    set_ratio();
    check_use();
  }

 private:
  void choose_surface();
  void find_bodies();
  void add(const Shape& s, std::int32_t material, double scale, bool moves);
  void find_softest();
  void find_depth();
  void choose_sizes();
  void derive();
  double derived_by_size();
  void check_derived(double derived) const;
  void set_ratio();
  void check_use() const;

  const Case& case_;
  const SceneParts& parts_;
  Scene& scene_;
  Settings& settings_;
  PackingReport& report_;

  bool by_size_ = false;                                                    // margins are proportional to the size of bodies
  double heaviest_ = 0, lightest_ = 1e300, smallest_ = 1e300, widest_ = 0;  // of bodies that move [kg], diameters [m]
  bool has_meshes_ = false, has_balls_ = false, has_wall_meshes_ = false;
  bool from_touch_ = false;  // spheres touch where they touch; a barrier is made of margins
  std::vector<MeshBody> meshes_, fixed_meshes_;
  Thinnest thinnest_;
  double softest_ = 1e300;  // [N/m]
  double depth_ = 0;        // of the fastest impact [m]
  std::string impact_of_wall_;
  std::string pulled_;  // what attracts, for messages
  // Margins by size are those of bodies with meshes. Where balls alone move they are those of the fixed meshes, of which the smallest must
  // bear the blow of the heaviest ball.
  bool balls_on_fixed_ = false;
  double sides_ = 2;  // a mesh wall and a ball have no margin in addition to that of the body that they meet
  MeshBody median_, least_, hit_;
};

void MarginRule::choose_surface() {
  // bodies that rest on each other do so as their run had them touch
  if (parts_.carried && !case_.surface_given) settings_.surface = parts_.carried->from.scene.settings.surface;
  // cells of a cut have corners too sharp to be moved in by a margin (docs/develop/decisions/023)
  const bool has_pieces = std::any_of(case_.shapes.begin(), case_.shapes.end(), [](const CaseShape& s) { return s.falls_apart(); });
  if (has_pieces && !case_.surface_given) settings_.surface = TouchAt::outside;
  by_size_ = settings_.surface == TouchAt::drawn;
}

void MarginRule::add(const Shape& s, std::int32_t material, double scale, bool moves) {
  has_meshes_ = has_meshes_ || s.kind != ShapeKind::sphere;
  has_balls_ = has_balls_ || s.kind == ShapeKind::sphere;
  const double mass = scene_.materials[static_cast<std::size_t>(material)].density * s.mass.volume * scale * scale * scale;
  if (s.kind != ShapeKind::sphere) (moves ? meshes_ : fixed_meshes_).push_back({mass, 0.5 * scale * s.equivalent_diameter()});
  if (!moves) return;
  thinnest_.add(s);
  heaviest_ = std::max(heaviest_, mass);
  lightest_ = std::min(lightest_, mass);
  smallest_ = std::min(smallest_, scale * s.equivalent_diameter());
  widest_ = std::max(widest_, scale * s.equivalent_diameter());
}

void MarginRule::find_bodies() {
  // a part on a guide comes down on bodies with all of its mass
  for (const Wall& wall : scene_.walls) {
    if (const std::optional<Drive> drive = wall.motion.drive(); drive && !drive->guide.turns)
      heaviest_ = std::max(heaviest_, drive->inertia);
  }
  for (const CaseBody& b : case_.bodies) add(parts_.shape(b.shape).shape, b.material, b.scale, !b.fixed);
  for (const Draw& d : parts_.draws) add(parts_.shape(d.shape).shape, case_.populations[d.population].material, d.scale, true);
  if (parts_.carried) {
    for (const BodyRow& row : parts_.carried->from.bodies)
      add(parts_.carried->shapes[static_cast<std::size_t>(row.shape)].shape, row.material, row.scale, !row.fixed);
  }
  for (const CaseInlet& i : case_.inlets) {
    for (const auto& share : i.shares) {
      const Shape& shape = parts_.shape(share.first).shape;
      const ScaleRange scales = scales_of(i.size, shape);
      for (const double scale : {scales.smallest, scales.largest}) add(shape, i.material, scale, true);
    }
  }
  const bool is_frozen = case_.settings.heat && case_.settings.heat->frozen;
  if (case_.settings.impact_speed > 0) {
    report_.fastest_impact = case_.settings.impact_speed;
  } else if (!is_frozen) {
    const FastestImpact impact = fastest_impact(case_, parts_, scene_);
    report_.fastest_impact = impact.speed;
    impact_of_wall_ = impact.of_wall;
  }
  settings_.impact_speed = report_.fastest_impact;
  for (const CaseWall& w : case_.walls) has_wall_meshes_ = has_wall_meshes_ || w.wall.kind == WallKind::mesh;
  from_touch_ = !has_meshes_ && (by_size_ || !has_wall_meshes_) && !(case_.settings.barrier > 0);
}

void MarginRule::find_softest() {
  if (case_.settings.law == ContactLaw::hertz_mindlin) {
    // the stiffness of a linear spring that the worst impact presses as deep: k = m v^2 / d^2
    for (const CasePair& p : case_.pairs) {
      const double modulus =
          effective_modulus(scene_.materials[static_cast<std::size_t>(p.pair.a)], scene_.materials[static_cast<std::size_t>(p.pair.b)]);
      const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.25 * smallest_;  // two bodies of the smallest size
      const double pressed = heaviest_ > 0 ? hertz_impact_overlap(modulus, radius, heaviest_, report_.fastest_impact) : 0;
      if (pressed > 0) softest_ = std::min(softest_, heaviest_ * std::pow(report_.fastest_impact / pressed, 2));
    }
  } else if (case_.settings.gather != Gathering::area) {  // a layer has no stiffness of one contact; its margin is given
    for (const CasePair& p : case_.pairs) softest_ = std::min(softest_, p.pair.spring(0.25 * widest_));  // by size: two of the largest
  }
}

/// What attracts is pressed deeper, and not by its speed alone.
void MarginRule::find_depth() {
  depth_ = heaviest_ > 0 && softest_ < 1e300 ? report_.fastest_impact * std::sqrt(heaviest_ / softest_) : 0;
  for (const CasePair& p : case_.pairs) {
    if (!attracts(p.pair) || !(heaviest_ > 0) || case_.settings.gather == Gathering::area) continue;  // margins of layers are given
    const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.5 * widest_;          // R* of the largest body on a wall
    const Material &a = scene_.materials[static_cast<std::size_t>(p.pair.a)], &b = scene_.materials[static_cast<std::size_t>(p.pair.b)];
    const double pressed = impact_overlap(case_.settings.law, p.pair, a, b, radius, heaviest_, report_.fastest_impact);
    if (pressed <= depth_) continue;
    constexpr double kWorthTelling = 1.01;
    const bool tells = pressed > kWorthTelling * depth_;
    depth_ = pressed;
    if (!tells) continue;
    pulled_ = fmt::format(", and the attraction of {} of '{}' and '{}'", format_quantity(pull_off_force(p.pair, radius), Dimension::force),
                          a.name, b.name);
  }
  report_.impact_overlap = depth_;
}

/// The bodies that a margin by size is of, and a margin that is given or kept.
void MarginRule::choose_sizes() {
  sides_ = by_size_ && !from_touch_ && (has_wall_meshes_ || has_balls_) ? 1 : 2;  // balls alone: both press
  balls_on_fixed_ = meshes_.empty() && !fixed_meshes_.empty();
  const std::vector<MeshBody>& sized = balls_on_fixed_ ? fixed_meshes_ : meshes_;
  median_ = median_of(sized);
  least_ = smallest_of(sized);
  hit_ = balls_on_fixed_ ? least_ : largest_of(sized);
  double& margin = settings_.margin;
  if (by_size_ && case_.margin_given && settings_.margin_ratio > 0) margin = settings_.margin_ratio * median_.radius;
  const Settings* before = parts_.carried ? &parts_.carried->from.scene.settings : nullptr;
  double margin_before = before == nullptr ? 0 : before->margin;
  if (by_size_ && before != nullptr) margin_before = before->margin_ratio * median_.radius;
  // bodies that rest on each other do so at the margins of their run
  const bool keeps_margin =
      !case_.margin_given && before != nullptr && before->surface == settings_.surface && (margin_before > 0 || from_touch_);
  report_.margin_from = case_.margin_given ? "given" : keeps_margin ? "that of the run" : "derived";
  if (keeps_margin) margin = margin_before;
}

constexpr double kSmallestShare = 0.01;  // of a margin, of the smallest body's diameter

/// Of the smallest body: the largest moving body decides for blows, the smallest for what lies on it.
double MarginRule::derived_by_size() {
  double between = softest_;  // of the largest body on the smallest
  for (const CasePair& p : case_.pairs)
    if (p.pair.modulus > 0) between = std::min(between, p.pair.spring(1 / (1 / hit_.radius + 1 / least_.radius)));
  const double load = balls_on_fixed_ ? heaviest_ : hit_.mass;
  const double pinch = kLoadOfSmallest * load * length(settings_.gravity) / between;
  const double needed = std::max(depth_ / (sides_ * kOverlapShare * hit_.radius), pinch / (sides_ * kOverlapShare * least_.radius));
  double ratio = std::max(needed, 2 * kSmallestShare);
  if (ratio > thinnest_.half) {
    const bool is_free = needed <= thinnest_.ratio();
    report_.notices.push_back(thin_text(thinnest_, is_free ? "" : stiffer_cure(case_, softest_, needed / thinnest_.ratio())));
    if (is_free) ratio = thinnest_.ratio();
  }
  if (balls_on_fixed_) smallest_ = 2 * least_.radius;  // what the margin rounds
  return ratio * least_.radius;
}

void MarginRule::derive() {
  const bool is_sized = by_size_ && least_.radius > 0;
  const double derived = is_sized ? derived_by_size() : std::max(depth_ / (sides_ * kOverlapShare), kSmallestShare * smallest_);
  check_derived(derived);
  if (!from_touch_) settings_.margin = is_sized ? derived / least_.radius * median_.radius : derived;
}

/// Refuses a margin that is too wide for the smallest body, and says so of one that is nearly.
void MarginRule::check_derived(double derived) const {
  // Without margins the solver has no guard against depth: the same limits hold, of the depth that margins would be made for. Not for
  // Hertz contacts: what is soft there is so by its material, not by choice.
  if (from_touch_ && case_.settings.law == ContactLaw::hertz_mindlin) return;
  // the depth of a blow is proportional to the root of the stiffness, that of what lies on a body to the stiffness: less would do for that
  const double needed =
      softest_ * std::pow(from_touch_ ? depth_ / (2 * kOverlapShare * kNoticeShare * smallest_) : derived / (kNoticeShare * smallest_), 2);
  const std::string from =
      fmt::format("the heaviest body ({}), the fastest impact expected ({}{}) and the softest pair ({}){}",
                  format_quantity(heaviest_, Dimension::mass), format_quantity(report_.fastest_impact, Dimension::velocity),
                  impact_of_wall_, format_quantity(softest_, Dimension::stiffness), pulled_);
  const bool by_modulus = std::any_of(case_.pairs.begin(), case_.pairs.end(), [](const CasePair& p) { return p.pair.modulus > 0; });
  const std::string cure = by_modulus ? fmt::format("a modulus {:.3g} times as large would bring it to", needed / softest_)
                                      : fmt::format("a stiffness of {} would bring it to", format_quantity(needed, Dimension::stiffness));
  const std::string advice = from_touch_
                                 ? fmt::format("{} press spheres into each other by {}, {:.0f} % of the smallest diameter; {} {:.0f} %",
                                               from, metres(depth_), 100 * depth_ / smallest_, cure, 100 * 2 * kOverlapShare * kNoticeShare)
                                 : fmt::format("the margin derived from {} is {}, {:.0f} % of the smallest body; {} {:.0f} %", from,
                                               metres(derived), 100 * derived / smallest_, cure, 100 * kNoticeShare);
  if (derived > kLargestShare * smallest_) {
    double steepest = 1;
    for (const CasePair& p : case_.pairs) steepest = std::max(steepest, steepening(p.pair));
    throw UsageError("{}: contact.margin: {}; raise it, or give contact.margin{}\n{}", case_.path, advice,
                     from_touch_ ? " (0: run it as it is)" : "",
                     choices({case_.settings, from_touch_ ? depth_ / (2 * kOverlapShare) : derived, smallest_, lightest_, softest_,
                              report_.fastest_impact, by_modulus, from_touch_, steepest}));
  }
  constexpr double kClearly = 1.05;  // nearer, both percentages of the advice read the same
  if (derived > kClearly * kNoticeShare * smallest_) report_.notices.push_back(advice);
}

void MarginRule::set_ratio() {
  double& margin = settings_.margin;
  if (has_meshes_ && !(margin > 0)) {
    throw UsageError(
        "{}: contact.margin = 0: meshes need a margin > 0 (typically 1 to 3 % of the body's size); leave it out to have it derived",
        case_.path);
  }
  if (!by_size_) return;
  settings_.margin_ratio = median_.radius > 0 ? margin / median_.radius : 0;
  if (has_meshes_ && !(settings_.margin_ratio > 0)) settings_.margin_ratio = kRatioOfFixed;
  if (settings_.margin_ratio > 0) return;
  if (margin > 0 && case_.margin_given)
    report_.notices.push_back(
        fmt::format("contact.margin = {} is of no effect: all bodies are balls, which touch where they are drawn", metres(margin)));
  margin = 0;
}

/// How much of the margins an impact uses up.
void MarginRule::check_use() const {
  const double layer = by_size_ ? sides_ * settings_.margin_ratio * hit_.radius : 2 * settings_.margin;
  if (layer > 0) report_.overlap_share = depth_ / layer;
  constexpr double kWarnShare = 0.8;
  if (!(report_.overlap_share > kWarnShare)) return;
  report_.notices.push_back(fmt::format(
      "the fastest impact expected ({}{}) of the heaviest body or part ({}) would use up {:.2f} of the margins, of which {} end the run; "
      "raise stiffness to {} or margin to {}",
      format_quantity(report_.fastest_impact, Dimension::velocity), impact_of_wall_, format_quantity(heaviest_, Dimension::mass),
      report_.overlap_share, kStopOverlapRatio,
      format_quantity(softest_ * std::pow(report_.overlap_share / kOverlapShare, 2), Dimension::stiffness),
      metres(settings_.margin * report_.overlap_share / kOverlapShare)));
}

}  // namespace

double half_thickness(const Shape& shape) {
  return shape.area > 0 ? shape.mass.volume / (shape.area * 0.5 * shape.equivalent_diameter()) : 1e300;
}

void choose_margin(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report) {
  MarginRule(c, parts, scene, report).choose();
}

}  // namespace scree
