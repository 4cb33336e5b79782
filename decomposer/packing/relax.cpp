#include "decomposer/packing/relax.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/geometry/periodic.hpp"
#include "core/search/multilevel_grid.hpp"
#include "core/surface/touch_surface.hpp"
#include "decomposer/packing/margin_rule.hpp"
#include "decomposer/packing/separation.hpp"

namespace scree {

namespace {

/// Ways go this much beyond the gap, of the gap, so that what has gone its way has the gap whatever rounding does...
constexpr double kBeyond = 1e-9;
/// ... and this much beyond in units of the last place of the largest coordinate, which is how finely places can be told: without it a
/// pair that lies far from the origin is found too close again and again by less than it can be moved.
constexpr double kRoundings = 16;

/// Sweeps in which all is exact; a few bodies are parted by then, a bed is not.
constexpr int kExactSweeps = 20;
/// In a bed ways go further by this share of what was deepest at the start, at most kMaxBedWay of the smallest radius.
constexpr double kBedShare = 0.1, kMaxBedWay = 1e-3;
/// In a bed ways are this much longer than needed (successive over-relaxation): a bed of 25 000 balls takes 200 sweeps in place of 830.
/// At 2 they would never end. Carrying ways on from sweep to sweep (Nesterov) was tried and needs more sweeps: what is apart has no force.
constexpr double kOverRelaxed = 1.8;
/// Bodies have no room when all depths together have not fallen by a tenth in so many sweeps.
constexpr int kPatience = 200;
constexpr double kProgress = 0.9;

/// Of the radius of the largest body: nearer than this at the start all that are close touch and none is pressed, as far as their places
/// tell; each contact asks for kTouch of it and for rounding.
constexpr double kTouchesAll = 4 * kTouch;
/// The same after all sweeps, for bodies without room: ways that are kOverRelaxed leave 1 / (2 - kOverRelaxed) times what each contact
/// lacks, in a stack of some bodies together. A contact holds nothing that counts at this depth.
constexpr double kTouchesLeft = 100 * kTouch;

/// Of a body's radius: what it may go beyond two margins in a shallow parting, for places that were written down rounded.
constexpr double kWrittenRounding = 1e-6;

/// Two bodies, or a body and a wall, that start closer than they may.
struct Pressed {
  std::size_t body = 0;
  std::int64_t other = -1;  // body
  std::int64_t wall = -1;
  double depth = 0;  // way apart [m]
};

class Relaxer {
 public:
  Relaxer(Case& c, const SceneParts& parts, const Scene& scene, double gap)
      : case_(c), parts_(parts), scene_(scene), periodicity_(periodicity_of(c.settings.domain)) {
    double furthest = 0;
    for (const CaseBody& b : case_.bodies) {
      bodies_.push_back({&parts.shape(b.shape), b.scale, b.position, b.orientation});
      const double s = b.scale;
      mass_.push_back(c.materials[static_cast<std::size_t>(b.material)].density * bodies_.back().shape->shape.mass.volume * s * s * s);
      smallest_ = std::min(smallest_, bodies_.back().radius());
      largest_ = std::max(largest_, bodies_.back().radius());
      for (int k = 0; k < 3; ++k) furthest = std::max(furthest, std::abs(b.position[k]));
    }
    way_.resize(bodies_.size());
    listed_at_.resize(bodies_.size());
    gap_.least = gap;
    gap_.reached = gap * (1 + kBeyond) + kRoundings * std::numeric_limits<double>::epsilon() * furthest;
    choose_skin();
  }

  Relaxation run() {
    Relaxation result;
    list();
    find_pressed();
    if (pressed_.empty()) return result;
    if (case_.relax == Relax::shallow) refuse_deep();
    result.sweeps = part();
    result.hardest = describe(hardest());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double way = length(way_[i]);
      if (way == 0) continue;
      if (case_.relax == Relax::shallow && way > limit(i))
        refuse(hardest(), fmt::format("Separating all bodies in contact would move {} by {}", case_.bodies[i].where, metres(way)));
      ++result.moved;
      result.furthest = std::max(result.furthest, way);
      result.potential_change -= mass_[i] * dot(case_.settings.gravity, way_[i]);
      case_.bodies[i].position = bodies_[i].position;
    }
    return result;
  }

 private:
  bool is_fixed(std::size_t i) const { return case_.bodies[i].fixed; }
  double inverse_mass(std::size_t i) const { return is_fixed(i) ? 0 : 1 / mass_[i]; }
  /// Two margins of a body; of a ball that touches where it is drawn, what it may be pressed in [m].
  double layer(std::size_t i) const {
    if (scene_.settings.surface == TouchAt::drawn && bodies_[i].is_sphere()) return kPressedIn * bodies_[i].radius();
    return 2 * (common_margin(scene_.settings) + bodies_[i].margin());
  }
  /// How far a body may go in a shallow parting [m].
  double limit(std::size_t i) const { return layer(i) + 2 * (gap_.reached - gap_.least) + kWrittenRounding * bodies_[i].radius(); }

  // ---- which bodies are close ----

  void choose_skin() {
    skin_ = 2 * kRelaxShare * smallest_;
    // a period holds two diameters; what the grid searches with must not ask for more
    for (int k = 0; k < 3; ++k) {
      if (periodicity_.is_periodic(k)) skin_ = std::min(skin_, 0.5 * periodicity_.period()[k] - 2 * largest_ - gap_.least);
    }
    skin_ = std::max(skin_, 0.0);
  }

  void list() {
    std::vector<Vec3> centres;
    std::vector<double> reach;
    for (const PlacedBody& b : bodies_) {
      centres.push_back(b.position);
      reach.push_back(b.radius() + 0.5 * (gap_.least + skin_));
    }
    MultilevelGrid grid;
    grid.build(centres, reach, periodicity_.period());
    pairs_.clear();
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(bodies_.size()); ++i) {
      grid.for_each_partner(i, [&](std::int32_t j) {
        const auto a = static_cast<std::size_t>(std::max(i, j)), b = static_cast<std::size_t>(std::min(i, j));
        if (a != b && !(is_fixed(a) && is_fixed(b))) pairs_.push_back({a, b});
      });
    }
    std::sort(pairs_.begin(), pairs_.end());
    at_walls_.clear();
    const GapWanted near{gap_.least + skin_, gap_.least + skin_};
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (is_fixed(i)) continue;
      for (std::size_t w = 0; w < parts_.walls.size(); ++w) {
        if (is_near_wall(w, bodies_[i], near)) at_walls_.push_back({i, w});
      }
    }
    listed_at_ = way_;
  }

  bool is_near_wall(std::size_t w, const PlacedBody& body, const GapWanted& near) {
    if (parts_.walls[w].kind != WallKind::mesh) return length(separation_.from_wall(parts_.walls[w], nullptr, false, body, near)) > 0;
    const PlacedBody& mesh = parts_.wall_bodies[w];
    const Vec3 centre = (1 / mesh.scale) * rotate_inverse(mesh.orientation, body.position - mesh.position);
    Vec3 foot;
    std::int32_t triangle = -1;
    point_mesh_distance({&mesh.shape->shape.mesh, &mesh.shape->bvh}, centre, (body.radius() + near.least) / mesh.scale, foot, triangle);
    return triangle >= 0 || (parts_.wall_is_solid[w] && is_inside(mesh.shape->shape.mesh, centre));
  }

  bool list_is_worn() const {
    for (std::size_t i = 0; i < way_.size(); ++i) {
      if (length(way_[i] - listed_at_[i]) > 0.5 * skin_) return true;
    }
    return false;
  }

  Vec3 way_from_wall(std::size_t i, std::size_t w, const GapWanted& gap) {
    return separation_.from_wall(parts_.walls[w], &parts_.wall_bodies[w], parts_.wall_is_solid[w], bodies_[i], gap);
  }
  Vec3 way_from_body(std::size_t i, std::size_t j, const GapWanted& gap) {
    PlacedBody other = bodies_[j];
    if (periodicity_.any()) other.position = bodies_[i].position + periodicity_.nearest(other.position - bodies_[i].position);
    return separation_.from_body(bodies_[i], other, gap);
  }

  // ---- what is pressed ----

  void find_pressed() {
    const GapWanted exact{gap_.least, gap_.least};
    const auto note = [&](const Pressed& p) {
      if (p.depth > 0) pressed_.push_back(p);
    };
    for (const auto& [i, w] : at_walls_) note({i, -1, static_cast<std::int64_t>(w), length(way_from_wall(i, w, exact))});
    for (const auto& [i, j] : pairs_) note({i, static_cast<std::int64_t>(j), -1, length(way_from_body(i, j, exact))});
    for (const Pressed& p : pressed_) deepest_ = std::max(deepest_, p.depth);
  }

  double equivalent_radius(std::size_t i) const { return 0.5 * bodies_[i].scale * bodies_[i].shape->shape.equivalent_diameter(); }

  /// What the contact's spring holds at that depth, as one spring per pair; a barrier is left out.
  double energy_of(const Pressed& p) const {
    const std::int32_t a = case_.bodies[p.body].material;
    const std::int32_t b =
        p.wall >= 0 ? scene_.walls[static_cast<std::size_t>(p.wall)].material : case_.bodies[static_cast<std::size_t>(p.other)].material;
    const MaterialPair& pair = scene_.pair(a, b);
    const double r = equivalent_radius(p.body), other = p.wall >= 0 ? 1e300 : equivalent_radius(static_cast<std::size_t>(p.other));
    const Settings& s = scene_.settings;
    if (s.law == ContactLaw::hertz_mindlin) {
      const double radius = pair.contact_radius > 0 ? pair.contact_radius : 1 / (1 / r + 1 / other);
      const double modulus =
          effective_modulus(scene_.materials[static_cast<std::size_t>(a)], scene_.materials[static_cast<std::size_t>(b)]);
      return 8.0 / 15 * modulus * std::sqrt(radius) * std::pow(p.depth, 2.5);
    }
    // a layer is pressed over some area, at most about the cross-section of the smaller body
    const double area = std::numbers::pi * std::pow(std::min(r, other), 2);
    const double stiffness = s.gather == Gathering::area ? pair.layer_modulus * area / layer(p.body) : pair.spring(1 / (1 / r + 1 / other));
    return 0.5 * stiffness * p.depth * p.depth;
  }

  /// The contact of the body that would be thrown fastest by all that presses it.
  const Pressed& hardest() const {
    std::vector<double> energy(bodies_.size(), 0.0);
    for (const Pressed& p : pressed_) {
      energy[p.body] += energy_of(p);
      if (p.other >= 0) energy[static_cast<std::size_t>(p.other)] += energy_of(p);
    }
    const auto rate = [&](const Pressed& p) {
      const double own = energy[p.body] * inverse_mass(p.body);
      return p.other >= 0 ? std::max(own, energy[static_cast<std::size_t>(p.other)] * inverse_mass(static_cast<std::size_t>(p.other)))
                          : own;
    };
    return *std::max_element(pressed_.begin(), pressed_.end(), [&](const Pressed& p, const Pressed& q) {
      return rate(p) != rate(q) ? rate(p) < rate(q) : p.depth < q.depth;
    });
  }

  bool overlaps(const Pressed& p) const { return p.depth >= layer(p.body); }

  /// Wholly on the wrong side of a wall that is given by a formula.
  bool lies_outside(const Pressed& p) const {
    if (p.wall < 0 || scene_.walls[static_cast<std::size_t>(p.wall)].kind == WallKind::mesh) return false;
    const CaseBody& b = case_.bodies[p.body];
    return p.depth >= 2 * (b.scale * parts_.shape(b.shape).radius + common_margin(scene_.settings));
  }

  /// Balls touch each other, and walls that are no meshes, where they are drawn.
  bool has_margins(const Pressed& p) const {
    if (!(layer(p.body) > 0)) return false;
    const bool by_shape = scene_.settings.surface == TouchAt::drawn && bodies_[p.body].is_sphere();
    const bool other_is_mesh = p.wall >= 0 ? scene_.walls[static_cast<std::size_t>(p.wall)].kind == WallKind::mesh
                                           : !bodies_[static_cast<std::size_t>(p.other)].is_sphere();
    return !by_shape || other_is_mesh;
  }

  std::string describe(const Pressed& p) const {
    const std::size_t thrown =
        p.other >= 0 && inverse_mass(static_cast<std::size_t>(p.other)) > inverse_mass(p.body) ? static_cast<std::size_t>(p.other) : p.body;
    const std::string whom = p.wall >= 0 ? fmt::format("{} (wall '{}'){}", case_.walls[static_cast<std::size_t>(p.wall)].where,
                                                       scene_.walls[static_cast<std::size_t>(p.wall)].name,
                                                       overlaps(p) && !lies_outside(p) ? " or lies behind it" : "")
                                         : case_.bodies[static_cast<std::size_t>(p.other)].where;
    if (lies_outside(p))
      return fmt::format("{}: lies wholly {} {}", case_.bodies[p.body].where,
                         scene_.walls[static_cast<std::size_t>(p.wall)].kind == WallKind::plane ? "behind" : "outside of", whom);
    const double energy = energy_of(p), speed = std::sqrt(2 * energy * inverse_mass(thrown));
    const std::string deep = !overlaps(p)     ? fmt::format("starts {} within the margins of {}", metres(p.depth), whom)
                             : has_margins(p) ? fmt::format("overlaps {}, {} short of a gap of two margins", whom, metres(p.depth))
                                              : fmt::format("overlaps {} by {}", whom, metres(p.depth));
    return fmt::format("{}: {}; this stores {:.3g} J, a speed of {}", case_.bodies[p.body].where, deep, energy,
                       format_quantity(speed, Dimension::velocity));
  }

  [[noreturn]] void refuse(const Pressed& p, const std::string& why) const {
    if (lies_outside(p))
      throw InputError(
          "{}, on the side where no body can be; its centre would have to move by {} to lie inside: correct its position, or the wall",
          describe(p), metres(p.depth));
    if (case_.relax == Relax::all) throw InputError("{}. {}; give the bodies more room", describe(p), why);
    throw InputError(
        "{}. {}; by default no body is moved by more than two margins ({}). Move one of them, or set contact.relax = true, which "
        "separates them at any distance{}{}",
        describe(p), why, metres(layer(p.body)), overlaps(p) ? "" : ", or false, which lets them start as they are", thin_shapes());
  }

  /// Bodies that are drawn in touch are in each other where margins make them thicker than they are drawn.
  std::string thin_shapes() const {
    std::string text;
    for (std::size_t i = 0; i < parts_.scene_shape.size(); ++i) {
      if (parts_.scene_shape[i] < 0 || parts_.shape(static_cast<std::int32_t>(i)).margin == 0) continue;
      const Shape& drawn = scene_.shapes[static_cast<std::size_t>(parts_.scene_shape[i])];
      const double half = half_thickness(drawn);
      if (scene_.settings.margin_ratio <= half) continue;
      text += fmt::format(
          ". '{}' is thinner than two margins, and touches outside of its drawn surface: contact.margin_ratio = {:.2g} lets it touch where "
          "it is drawn (as stiff as the fastest impact then needs)",
          drawn.name, kThinShare * half);
    }
    return text;
  }

  /// What each pair by itself needs is enough to refuse a deep one at once.
  void refuse_deep() const {
    for (const Pressed& p : pressed_) {
      const double own = inverse_mass(p.body), other = p.other >= 0 ? inverse_mass(static_cast<std::size_t>(p.other)) : 0;
      const double share = std::min(own, other) > 0 ? std::max(own, other) / (own + other) : 1;
      const std::size_t goer = other > own ? static_cast<std::size_t>(p.other) : p.body;
      if (share * p.depth > limit(goer))
        refuse(p, fmt::format("Separating them would move {} by {}", case_.bodies[goer].where, metres(share * p.depth)));
    }
  }

  // ---- parting ----

  /// Gives the number of sweeps.
  int part() {
    std::vector<double> depths;  // all together, of each sweep
    for (int n = 1;; ++n) {
      if (list_is_worn()) list();
      const double depth = sweep(n > kExactSweeps ? kOverRelaxed : 1);
      if (depth == 0) return n - 1;
      depths.push_back(depth);
      if (n > kPatience && depth > kProgress * depths[static_cast<std::size_t>(n - 1 - kPatience)]) {
        if (tight_.depth - (gap_.reached - gap_.least) <= kTouchesLeft * largest_) {  // they fit exactly
          if (deepest_ <= kTouchesAll * largest_) std::fill(way_.begin(), way_.end(), Vec3{});
          return n;
        }
        refuse(tight_, fmt::format("This remains after {} sweeps of separation", n));
      }
      if (n == kExactSweeps) gap_.reached += std::min(kBedShare * deepest_, kMaxBedWay * smallest_);
    }
  }

  /// Goes through all that is close once; gives the sum of the depths found.
  /// in   longer   factor on ways
  double sweep(double longer) {
    double sum = 0, most = 0;
    const auto found = [&](const Pressed& p) {
      sum += p.depth;
      if (p.depth > most) {
        most = p.depth;
        tight_ = p;
      }
    };
    for (const auto& [i, w] : at_walls_) {
      const Vec3 way = way_from_wall(i, w, gap_);
      if (way == Vec3{}) continue;
      found({i, -1, static_cast<std::int64_t>(w), length(way)});
      move(i, longer * way);
    }
    for (const auto& [i, j] : pairs_) {
      Vec3 way = way_from_body(i, j, gap_);
      if (way == Vec3{}) continue;
      found({i, static_cast<std::int64_t>(j), -1, length(way)});
      way = capped(longer * way, kRelaxShare * std::min(bodies_[i].radius(), bodies_[j].radius()));
      const double own = inverse_mass(i), other = inverse_mass(j);
      move(i, (own / (own + other)) * way);
      move(j, -(other / (own + other)) * way);
    }
    return sum;
  }

  void move(std::size_t i, const Vec3& way) {
    way_[i] += way;
    bodies_[i].position += way;
    Vec3 image;
    periodicity_.wrap(bodies_[i].position, image);
  }

  static Vec3 capped(const Vec3& way, double most) { return length(way) > most ? (most / length(way)) * way : way; }

  Case& case_;
  const SceneParts& parts_;
  const Scene& scene_;
  Periodicity periodicity_;
  Separation separation_;
  GapWanted gap_;
  double skin_ = 0, smallest_ = 1e300, largest_ = 0, deepest_ = 0;  // [m]
  std::vector<PlacedBody> bodies_;                                  // in the domain where it is periodic
  std::vector<Vec3> way_, listed_at_;                               // gone so far, and when the lists were made [m]
  std::vector<double> mass_;                                        // [kg]
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;          // a body and one before it
  std::vector<std::pair<std::size_t, std::size_t>> at_walls_;       // a body and a wall
  std::vector<Pressed> pressed_;                                    // at the start
  Pressed tight_;                                                   // the deepest of the last sweep
};

}  // namespace

Relaxation relax_given_bodies(Case& c, const SceneParts& parts, const Scene& scene, double gap) {
  return c.bodies.empty() ? Relaxation{} : Relaxer(c, parts, scene, gap).run();
}

}  // namespace scree
