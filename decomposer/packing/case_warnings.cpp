#include "decomposer/packing/case_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/distance/mesh_distance.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/domain_side.hpp"
#include "core/storage/plasticity.hpp"
#include "decomposer/packing/start_points.hpp"

namespace scree {

namespace {

// Where a number is more likely a slip than meant. Each is far from what stones, plastics, metals and grains have.
constexpr double kLightest = 100;    // [kg/m^3] of a body: balsa has more, only foams and snow have less; g/cm^3 ends at 23
constexpr double kHeaviest = 25000;  // [kg/m^3] osmium has 22 590
constexpr double kSoftest = 1000;    // [Pa] Young's modulus of jelly: GPa or MPa was left out
constexpr double kMaxFriction = 2;   // rubber on dry concrete has 1: more looks like an angle in degrees
constexpr double kCold = 100;        // [K] colder than nitrogen boils at
constexpr double kFastest = 300;     // [m/s] of an impact, the speed of sound
constexpr double kMaxFrames = 1e5, kMaxSteps = 1e9;
constexpr double kLiquid = 1e-4;           // [Pa s] viscosity above that of any gas
constexpr double kThinnestLiquid = 50;     // [kg/m^3] liquid hydrogen has 70
constexpr double kFarLarger = 1000;        // extents, of a container and of the bodies in it: mm were taken for m
constexpr double kFarSmaller = 100;        // a wall beside the bodies that meet it
constexpr double kPressedShare = 0.5;      // of the margins, by a body's own weight
constexpr double kPressedDiameter = 0.01;  // the same where there is no margin: spheres no longer behave like spheres
constexpr double kAlong = 0.5;             // of a surface's velocity
constexpr double kSurely = 1.0 / 3;        // of the time of a contact: levers shorten it by no more than that

constexpr double kWideMargin = 0.2;    // of a body's radius: what rolls and packs is then no longer the shape
constexpr double kFarTouch = 0.5;      // of a margin, on the mean of a shape's surface
constexpr double kCentrifuges = 1;     // Froude number of a container that turns: what is in it no longer falls
constexpr double kFlings = 10;         // of any other part that turns: that of fast mixers
constexpr int kSeams = 4;              // edges around a hole that a missing triangle or two leave: an opening that is meant is rounder
constexpr double kSmallOpening = 0.9;  // of the wall's length: above it is its border

std::string seconds(double value) { return format_quantity(value, Dimension::time); }

void warn_of_materials(const Case& c, std::vector<std::string>& warnings) {
  std::set<std::int32_t> of_movers;
  for (const CaseBody& b : c.bodies) {
    if (!b.fixed) of_movers.insert(b.material);
  }
  for (const CasePopulation& p : c.populations) of_movers.insert(p.material);
  for (const CaseInlet& i : c.inlets) of_movers.insert(i.material);
  for (const std::int32_t index : of_movers) {
    const Material& m = c.materials[static_cast<std::size_t>(index)];
    if (m.density < kLightest) {
      warnings.push_back(fmt::format("materials.{}.density = {:g} kg/m^3 is less than wood has (above {:g}); was \"{:g} g/cm^3\" meant?",
                                     m.name, m.density, kLightest, m.density));
    } else if (m.density > kHeaviest) {
      warnings.push_back(fmt::format("materials.{}.density = {:g} kg/m^3 is more than any metal has (below {:g}); is the unit right?",
                                     m.name, m.density, kHeaviest));
    }
    if (m.young > 0 && m.young < kSoftest) {
      warnings.push_back(fmt::format("materials.{}.young = {:g} Pa is softer than jelly ({:g} Pa); was \"{:g} GPa\" or \"{:g} MPa\" meant?",
                                     m.name, m.young, kSoftest, m.young, m.young));
    }
  }
  std::string frictionless;
  for (const CasePair& p : c.pairs) {
    const std::string name =
        fmt::format("{} on {}", c.materials[static_cast<std::size_t>(p.pair.a)].name, c.materials[static_cast<std::size_t>(p.pair.b)].name);
    if (!p.friction_given) frictionless += (frictionless.empty() ? "" : ", ") + name;
    if (p.pair.friction > kMaxFriction) {
      warnings.push_back(fmt::format("{}: friction = {:g} of {} is a coefficient, the tangent of an angle; {:g} degrees would be {:.3g}",
                                     p.where, p.pair.friction, name, p.pair.friction,
                                     std::abs(std::tan(p.pair.friction * std::numbers::pi / 180))));
    }
  }
  if (!frictionless.empty())
    warnings.push_back(
        fmt::format("no friction is given, so that there is none: {}; write friction = 0 where that is meant", frictionless));
}

/// Post and Python find walls by their names: of two of one name the first, or both.
void warn_of_names(const Case& c, std::vector<std::string>& warnings) {
  std::map<std::string, const CaseWall*> first;
  for (const CaseWall& w : c.walls) {
    const auto [known, is_new] = first.emplace(w.wall.name, &w);
    if (!is_new)
      warnings.push_back(
          fmt::format("{}.name = \"{}\" is the name of {} too; tables and Python find walls by their names, so give each its own", w.where,
                      w.wall.name, known->second->where));
  }
}

/// A temperature without a unit is in kelvin, and 20 is liquid hydrogen.
void warn_of_temperatures(const Case& c, std::vector<std::string>& warnings) {
  if (!c.settings.heat) return;
  double coldest = 1e300;
  std::string where;
  const auto look = [&](double kelvin, const std::string& of) {
    if (!(kelvin > 0) || kelvin >= coldest) return;
    coldest = kelvin;
    where = of;
  };
  look(c.settings.heat->temperature, "heat");
  for (const CaseBody& b : c.bodies) look(b.temperature, b.where);
  for (const CasePopulation& p : c.populations) look(p.temperature, p.where);
  for (const CaseInlet& i : c.inlets) look(i.temperature, i.where);
  for (const CaseWall& w : c.walls) {
    if (w.wall.heat.has_temperature()) look(w.wall.heat.temperature.least(), w.where);
  }
  if (coldest < kCold)
    warnings.push_back(
        fmt::format("{}: a temperature of {:g} K is that of liquid gases; was \"{:g} degC\" meant?", where, coldest, coldest));
}

void warn_of_surroundings(const Case& c, std::vector<std::string>& warnings) {
  const Settings& s = c.settings;
  const double g = length(s.gravity);
  constexpr double kEarth = 9.81, kNear = 0.01;
  for (const auto& [factor, unit] : {std::pair{100.0, "cm/s^2"}, {1000.0, "mm/s^2"}}) {
    if (std::abs(g / (factor * kEarth) - 1) < kNear) {
      warnings.push_back(fmt::format("gravity of {:g} m/s^2 is {:g} times that of the Earth; was \"{:g} {}\" meant?", g, factor, g, unit));
    }
  }
  if (s.fluid && s.fluid->viscosity > kLiquid && s.fluid->density < kThinnestLiquid) {
    warnings.push_back(fmt::format(
        "fluid.density = {:g} kg/m^3 is that of a gas, and fluid.viscosity = {:g} Pa s that of a liquid; was \"{:g} g/cm^3\" meant?",
        s.fluid->density, s.fluid->viscosity, s.fluid->density));
  }
  const bool moves = c.start || !c.populations.empty() || !c.inlets.empty() ||
                     std::any_of(c.bodies.begin(), c.bodies.end(), [](const CaseBody& b) { return !b.fixed; }) ||
                     std::any_of(c.walls.begin(), c.walls.end(), [](const CaseWall& w) { return w.wall.motion.drive().has_value(); });
  if (!moves)
    warnings.push_back("nothing moves: the case has no population, no inlet, no body that is not fixed and no wall that answers to force");
  if (moves && g > 0 && !has_support(c) && !s.fluid) {
    warnings.push_back(
        fmt::format("nothing holds the bodies: no wall, no fixed body, and gravity of {:g} m/s^2: they all fall freely, {} until the end",
                    g, metres(0.5 * g * s.duration * s.duration)));
  }
}

void warn_of_times(const Case& c, std::vector<std::string>& warnings) {
  const Settings& s = c.settings;
  if (!(s.duration > 0)) return;
  if (s.output_every > s.duration) {
    warnings.push_back(fmt::format("output.every = {} is longer than the run of {}: only its first and last state are kept",
                                   seconds(s.output_every), seconds(s.duration)));
  } else if (s.duration / s.output_every > kMaxFrames) {
    warnings.push_back(fmt::format("output.every = {} makes {:.3g} frames of a run of {}", seconds(s.output_every),
                                   s.duration / s.output_every, seconds(s.duration)));
  }
  for (const CaseWall& w : c.walls) {
    if (w.wall.wear > 0 && w.wall.wear_every > s.duration) {
      warnings.push_back(
          fmt::format("{}: wear.every = {} is longer than the run of {}: the wall keeps its shape in the run; its file at the end has what "
                      "was worn off",
                      w.where, seconds(w.wall.wear_every), seconds(s.duration)));
    }
  }
  for (const CaseWall& w : c.walls) {
    for (const auto& [motion, what] : {std::pair{&w.wall.motion, "wall"}, std::pair{&w.wall.surface.motion, "the surface of wall"}}) {
      if (!motion->is_prescribed() || motion->start < s.duration) continue;
      warnings.push_back(fmt::format("{}: {} '{}' starts to move at {}, and the run ends at {}", w.where, what, w.wall.name,
                                     seconds(motion->start), seconds(s.duration)));
    }
  }
  const bool loses = s.fluid || std::any_of(c.pairs.begin(), c.pairs.end(),
                                            [](const CasePair& p) { return p.pair.restitution < 1 || p.pair.friction > 0; });
  for (const CaseWall& w : c.walls) {
    if (!s.stop_at_rest || !w.wall.motion.drive() || !(w.wall.motion.end() >= s.duration)) continue;
    warnings.push_back(
        fmt::format("time.stop_at_rest: {}: wall '{}' ({}) may move until the end ({}), so that the run never ends before; give its motion "
                    "a stop, or leave "
                    "stop_at_rest out",
                    w.where, w.wall.name, w.wall.motion.word(), seconds(s.duration)));
  }
  if (s.sleep && !(length(s.gravity) > 0))
    warnings.push_back("time.sleep: without gravity nothing sleeps, since no weight says which force is small; leave it out");
  for (const CaseWall& w : c.walls) {
    if (const char* why = s.sleep ? sleep_blocker(w.wall) : nullptr)
      warnings.push_back(fmt::format("time.sleep: {}: no body sleeps that touches wall '{}': it {}", w.where, w.wall.name, why));
  }
  if (s.stop_at_rest && !loses)
    warnings.push_back(
        "time.stop_at_rest: nothing takes energy away (restitution 1 and no friction in all pairs), so that nothing comes to rest");
}

/// Moving bodies of a packed scene and those of its inlets, by what matters here.
struct Movers {
  double lightest = 1e300, smallest = 1e300, largest = 0;  ///< [kg]; extents [m]
  double narrowest = 1e300;                                ///< of their boxes [m]
  struct Heaviest {
    double mass = 0, diameter = 0;
  };
  std::vector<Heaviest> of_material;
};

Movers movers_of(const Case& c, const SceneParts& parts, const Scene& scene) {
  Movers movers;
  movers.of_material.resize(scene.materials.size());
  std::vector<double> radius, width;  // of each shape at scale 1
  for (const Shape& shape : scene.shapes) {
    const Vec3 box = bounding_box(shape.mesh).extent();
    radius.push_back(shape.bounding_radius());
    width.push_back(2 * shape.sphere_radius + std::min({box.x, box.y, box.z}));
  }
  const auto add = [&](std::size_t of_shape, double scale, std::int32_t material) {
    const Shape& shape = scene.shapes[of_shape];
    const double mass = scene.materials[static_cast<std::size_t>(material)].density * shape.mass.volume * scale * scale * scale;
    movers.lightest = std::min(movers.lightest, mass);
    movers.smallest = std::min(movers.smallest, 2 * scale * radius[of_shape]);
    movers.largest = std::max(movers.largest, 2 * scale * radius[of_shape]);
    movers.narrowest = std::min(movers.narrowest, scale * width[of_shape]);
    Movers::Heaviest& heaviest = movers.of_material[static_cast<std::size_t>(material)];
    if (mass > heaviest.mass) heaviest = {mass, scale * shape.equivalent_diameter()};
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] == 0) add(static_cast<std::size_t>(scene.bodies.shape[i]), scene.bodies.scale[i], scene.bodies.material[i]);
  }
  for (const CaseInlet& i : c.inlets) {
    for (const auto& share : i.shares) {
      const auto shape = static_cast<std::size_t>(parts.scene_shape[static_cast<std::size_t>(share.first)]);
      const ScaleRange scales = scales_of(i.size, scene.shapes[shape]);
      for (const double scale : {scales.smallest, scales.largest}) add(shape, scale, i.material);
    }
  }
  return movers;
}

double longest(const Box3& box) {
  const Vec3 e = box.extent();
  return std::max({e.x, e.y, e.z});
}

void warn_of_extents(const Case& c, const SceneParts& parts, const Movers& movers, std::vector<std::string>& warnings) {
  double most = 0;
  std::string name;
  const auto consider = [&](double extent, const std::string& what) {
    if (extent <= most) return;
    most = extent;
    name = what;
  };
  for (std::size_t i = 0; i < parts.walls.size(); ++i) {
    const Wall& w = parts.walls[i];
    if (w.kind == WallKind::plane) continue;
    const double extent = longest(w.kind == WallKind::mesh ? parts.wall_bodies[i].world_box() : region_of(w).box);
    const std::string what = fmt::format("{} (wall '{}')", c.walls[i].where, w.name);
    if (!(w.cell_size > 0)) consider(extent, what);  // terrain may be as long as it likes
    if (extent * kFarSmaller < movers.smallest) {
      warnings.push_back(
          fmt::format("{} is {} long, and the smallest body is {} across: {:.0f} times as much; is the unit of one of them right?", what,
                      metres(extent), metres(movers.smallest), movers.smallest / extent));
    }
  }
  for (std::size_t k = 0; k < parts.regions.size(); ++k) consider(longest(parts.regions[k].box), c.populations[k].where + ".region");
  if (c.settings.domain.bounded && parts.walls.empty()) consider(longest({c.settings.domain.lower, c.settings.domain.upper}), "the domain");
  if (most > kFarLarger * movers.largest) {
    warnings.push_back(fmt::format("{} is {} long, and the largest body is {} across: {:.0f} times less; is the unit of one of them right?",
                                   name, metres(most), metres(movers.largest), most / movers.largest));
  }
}

/// Bodies are placed in the part of a region that lies in the domain; in a container that reaches beyond it they leave the domain.
void warn_of_domain(const Case& c, const SceneParts& parts, std::vector<std::string>& warnings) {
  Domain domain = c.settings.domain;
  if (!domain.bounded) return;
  constexpr double kRounding = 1e-9;  // of the extent: what is drawn on a side lies on it
  const Vec3 by = kRounding * (domain.upper - domain.lower);
  domain.lower -= by;
  domain.upper += by;
  const auto beyond = [&](const Box3& box) {
    const std::string lower = beyond_side(domain, box.lower, false), upper = beyond_side(domain, box.upper, false);
    return lower.empty() || upper.empty() ? lower + upper : lower + " and " + upper;
  };
  for (std::size_t k = 0; k < c.populations.size(); ++k) {
    const std::string sides = beyond(parts.regions[k].box);
    if (sides.empty() || c.populations[k].region.wall >= 0) continue;
    warnings.push_back(
        fmt::format("{}.region reaches {}: bodies are placed in the part of it that lies in the domain, and its solid fraction "
                    "is of the whole region",
                    c.populations[k].where, sides));
  }
  if (domain.outside != Outside::stop) return;
  for (std::size_t i = 0; i < parts.walls.size(); ++i) {
    const Wall& wall = parts.walls[i];
    if (wall.kind == WallKind::plane || wall.kind == WallKind::mesh) continue;  // a mesh may be a floor, wider than what is computed
    if (const std::string sides = beyond(region_of(wall).box); !sides.empty())
      warnings.push_back(
          fmt::format("{} (wall '{}') reaches {}: a body that gets there leaves the domain, which ends the run (outside = "
                      "\"stop\"); widen the domain",
                      c.walls[i].where, wall.name, sides));
  }
}

/// The largest part of a velocity that lies along a surface somewhere on a wall, of 1.
double share_along(const Wall& wall, const Scene& scene, const Vec3& direction) {
  const auto along = [&](const Vec3& normal) { return length(cross(direction, normalised(normal))); };
  if (wall.kind == WallKind::plane) return along(wall.normal);
  if (wall.kind != WallKind::mesh) return 1;
  const TriangleMesh& mesh = scene.shapes[static_cast<std::size_t>(wall.shape)].mesh;
  const Vec3 here = rotate_inverse(wall.orientation, direction);
  double most = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 normal = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (squared_length(normal) > 0) most = std::max(most, length(cross(here, normalised(normal))));
  }
  return most;
}

void warn_of_surfaces(const Case& c, const Scene& scene, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    const Wall& wall = scene.walls[i];
    if (!wall.surface.moves()) continue;
    const std::string what = fmt::format("{}: the surface of wall '{}'", c.walls[i].where, wall.name);
    const bool grips = std::any_of(scene.pairs.begin(), scene.pairs.end(),
                                   [&](const MaterialPair& p) { return (p.a == wall.material || p.b == wall.material) && p.friction > 0; });
    if (!grips) warnings.push_back(what + " moves, and no pair with its material has friction: it moves nothing");
    const auto* belt = std::get_if<Translate>(&wall.surface.motion.kind);
    if (belt == nullptr) continue;
    const double share = share_along(wall, scene, belt->axis);
    if (share < kAlong) {
      warnings.push_back(fmt::format("{} moves at {:g} m/s, of which at most {:.3g} m/s lie along it; only that counts", what,
                                     std::abs(belt->rate), share * std::abs(belt->rate)));
    }
  }
}

/// A contact of the lightest body by the stiffest pair [s]; 0 where a law has no stiffness.
double shortest_contact(const Case& c, const Movers& movers) {
  double stiffest = 0;
  for (const CasePair& p : c.pairs) {
    // of two of the lightest bodies, by size
    const double volume = movers.lightest / c.materials[static_cast<std::size_t>(p.pair.a)].density;
    stiffest = std::max(stiffest, steepening(p.pair) * p.pair.spring(0.5 * std::cbrt(volume * 3 / (4 * std::numbers::pi))));
  }
  return stiffest > 0 ? std::numbers::pi * std::sqrt(movers.lightest / (2 * stiffest)) : 0;
}

void warn_of_steps(const Case& c, const Movers& movers, std::vector<std::string>& warnings) {
  const Settings& s = c.settings;
  const double contact = shortest_contact(c, movers);
  if (!(contact > 0 && s.duration > 0)) return;
  if (s.duration < kSurely * contact) {
    warnings.push_back(
        fmt::format("time.duration = {} is less than a single contact takes ({} of the lightest body, {}, by the stiffest pair)",
                    seconds(s.duration), seconds(contact), format_quantity(movers.lightest, Dimension::mass)));
  }
  if (s.step > contact) {
    warnings.push_back(fmt::format(
        "time.step = {} is {:.3g} times the time that a contact of the lightest body by the stiffest pair takes ({}): the solver "
        "refuses a step above the critical one; leave out time.step, or give at most {}",
        seconds(s.step), s.step / contact, seconds(contact), seconds(contact / s.steps_per_contact)));
  }
  const double step = s.step > 0 ? s.step : contact / s.steps_per_contact;
  if (s.duration / step > kMaxSteps) {
    warnings.push_back(
        fmt::format("time.duration = {} takes about {:.2g} steps of {} (the lightest body, {}, by the stiffest pair); a softer pair or "
                    "larger bodies make it fewer",
                    seconds(s.duration), s.duration / step, seconds(step), format_quantity(movers.lightest, Dimension::mass)));
  }
}

void warn_of_stiffness(const Case& c, const Scene& scene, const Movers& movers, std::vector<std::string>& warnings) {
  const Settings& s = scene.settings;
  for (const CasePair& p : c.pairs) {
    Movers::Heaviest body;
    double density = 1;
    for (const std::int32_t m : {p.pair.a, p.pair.b}) {
      const Movers::Heaviest& other = movers.of_material[static_cast<std::size_t>(m)];
      if (other.mass <= body.mass) continue;
      body = other;
      density = scene.materials[static_cast<std::size_t>(m)].density;
    }
    const double weight = body.mass * length(s.gravity) * (s.fluid ? std::abs(1 - s.fluid->density / density) : 1.0);
    const double spring = p.pair.spring(0.5 * body.diameter);
    double depth = spring > 0 ? weight / spring : 0;
    if (s.law == ContactLaw::hertz_mindlin && body.diameter > 0) {
      const double modulus =
          effective_modulus(scene.materials[static_cast<std::size_t>(p.pair.a)], scene.materials[static_cast<std::size_t>(p.pair.b)]);
      const double radius = p.pair.contact_radius > 0 ? p.pair.contact_radius : 0.5 * body.diameter;
      depth = std::cbrt(9 * weight * weight / (16 * modulus * modulus * radius));
    }
    const double margins = s.surface == TouchAt::drawn ? s.margin_ratio * body.diameter : 2 * s.margin;
    const double most = margins > 0 ? kPressedShare * margins : kPressedDiameter * body.diameter;
    if (!(depth > most)) continue;
    warnings.push_back(fmt::format(
        "{}: the heaviest body ({}) is pressed {} into the floor by its own weight, {}; a stiffer pair or a lighter body is needed",
        p.where, format_quantity(body.mass, Dimension::mass), metres(depth),
        margins > 0 ? fmt::format("{:.2f} of the margins, which end the run at 1", depth / margins)
                    : fmt::format("{:.1f} % of its diameter", 100 * depth / body.diameter)));
  }
}

/// Both theories are of small contacts: of a neck much smaller than its balls, and of a bridge that does not fill the room between them.
void warn_of_neck_or_bridge(const Scene& scene, const CasePair& p, double radius, std::vector<std::string>& warnings) {
  constexpr double kDeep = 0.05, kMuch = 0.1;  // of R*; of R^3: beyond Willett's fit
  const Material &a = scene.materials[static_cast<std::size_t>(p.pair.a)], &b = scene.materials[static_cast<std::size_t>(p.pair.b)];
  if (pull_kind(p.pair) == PullKind::neck) {
    const double overlap = resting_contact(scene.settings.law, p.pair, a, b, radius).overlap;
    if (!(overlap > kDeep * radius)) return;
    warnings.push_back(
        fmt::format("{}: adhesion alone presses balls of R* = {} {} into each other, {:.0f} % of R*, where JKR's theory of small contacts "
                    "does not hold; a "
                    "stiffer material (young) or a smaller adhesion is needed",
                    p.where, metres(radius), metres(overlap), 100 * overlap / radius));
    return;
  }
  const double share = p.pair.bridge_volume / std::pow(2 * radius, 3);
  if (!(share > kMuch)) return;
  warnings.push_back(
      fmt::format("{}: bridge_volume is {:.2g} R^3 with R = 2 R* = {}; the force of a bridge is known for less than {:g} R^3, beyond that "
                  "the liquid fills "
                  "the room between bodies",
                  p.where, share, metres(2 * radius), kMuch));
}

/// Above this share of the radius of the smallest ball of equal volume an attraction acts between bodies that are far from touching.
constexpr double kWideRange = 0.1;

/// A range that is not small beside the bodies: the force then acts over distances at which the model means nothing, between bodies that
/// have others in between.
void warn_of_range(const Case& c, const Scene& scene, std::vector<std::string>& warnings) {
  std::vector<double> smallest(scene.materials.size(), 1e300);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    double& mine = smallest[static_cast<std::size_t>(scene.bodies.material[i])];
    const Shape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])];
    if (scene.bodies.fixed[i] == 0) mine = std::min(mine, scene.bodies.scale[i] * shape.equivalent_diameter());
  }
  for (const CasePair& p : c.pairs) {
    const double diameter = std::min(smallest[static_cast<std::size_t>(p.pair.a)], smallest[static_cast<std::size_t>(p.pair.b)]);
    if (!(p.pair.adhesion_range > kWideRange * 0.5 * diameter) || diameter >= 1e300) continue;
    warnings.push_back(
        fmt::format("{}: adhesion_range = {} is {:.2g} of the radius of the smallest body ({} across): it attracts bodies that are far "
                    "from touching, where {} "
                    "or less is meant",
                    p.where, metres(p.pair.adhesion_range), p.pair.adhesion_range / (0.5 * diameter), metres(diameter),
                    metres(kWideRange * 0.5 * diameter)));
  }
}

/// Whether a ray meets a triangle.   Source: Moller, Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997.
bool meets(const Vec3& from, const Vec3& way, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, p = cross(way, v);
  const double det = dot(u, p);
  if (det == 0) return false;
  const Vec3 t = from - a, q = cross(t, u);
  const double s = dot(t, p) / det, r = dot(way, q) / det;
  return s >= 0 && r >= 0 && s + r <= 1 && dot(v, q) / det > 0;
}

/// Whether what falls straight from a point meets a wall; walls by formula hold what is in them.
bool falls_on(const Wall& wall, const PlacedBody& body, const Vec3& from, const Vec3& way) {
  switch (wall.kind) {
    case WallKind::plane:
      return dot(wall.normal, way) * dot(wall.normal, from - wall.point) < 0;
    case WallKind::box_inside:
    case WallKind::cylinder_inside:
    case WallKind::sphere_inside:
      return true;
    case WallKind::mesh: {
      const TriangleMesh& mesh = body.shape->shape.mesh;
      const Vec3 here = (1 / wall.scale) * rotate_inverse(wall.orientation, from - wall.position);
      const Vec3 along = rotate_inverse(wall.orientation, way);
      for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
        if (meets(here, along, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))) return true;
      return false;
    }
  }
  return true;
}

/// Gravity that points away from every wall: up, in most cases.
void warn_of_fall(const SceneParts& parts, const Scene& scene, const Movers& movers, std::vector<std::string>& warnings) {
  const Settings& s = scene.settings;
  const double g = length(s.gravity), fall = 0.5 * g * s.duration * s.duration;
  const bool goes_round = s.domain.periodic[0] || s.domain.periodic[1] || s.domain.periodic[2];
  const bool may_catch =
      std::any_of(scene.walls.begin(), scene.walls.end(), [](const Wall& w) { return w.motion.is_prescribed() && !w.motion.turn_axis(); });
  if (scene.walls.empty() || !(g > 0) || !(fall > movers.largest) || goes_round || may_catch || !scene.bodies.size()) return;
  if (std::any_of(scene.bodies.fixed.begin(), scene.bodies.fixed.end(), [](std::uint8_t fixed) { return fixed != 0; })) return;
  const std::vector<Vec3> starts = start_points(parts, scene);
  for (const Vec3& from : starts) {
    for (std::size_t w = 0; w < parts.walls.size(); ++w)
      if (falls_on(parts.walls[w], parts.wall_bodies[w], from, (1 / g) * s.gravity)) return;
  }
  if (starts.empty()) return;
  warnings.push_back(
      fmt::format("gravity = [{:g}, {:g}, {:g}] points away from every wall: below none of the bodies is one, they fall {} until the "
                  "end; is its direction right?",
                  s.gravity.x, s.gravity.y, s.gravity.z, metres(fall)));
}

/// [[outlets]] too thin to hold the centre of a body.
void warn_of_outlets(const Case& c, const SceneParts& parts, const Movers& movers, std::vector<std::string>& warnings) {
  for (std::size_t k = 0; k < parts.outlets.size(); ++k) {
    const Vec3 e = parts.outlets[k].box.extent();
    const double narrow = std::min({e.x, e.y, e.z});
    if (!(2 * narrow < movers.narrowest)) continue;
    warnings.push_back(
        fmt::format("{}: the outlet '{}' is {} thick, and the smallest body {}: only a body whose centre comes into it leaves, and one "
                    "that rests on a wall behind it never does; make it thicker than a body",
                    c.outlets[k].where, c.outlets[k].name, metres(narrow), metres(movers.narrowest)));
  }
}

/// The edges around an opening of a surface.
struct Rim {
  Box3 box;  ///< [m], in the mesh's frame
  int edges = 0;
  double width() const {  // of a flat rim: its box's extent in the middle
    const Vec3 e = box.extent();
    return std::max({std::min(e.x, e.y), std::min(e.y, e.z), std::min(e.x, e.z)});
  }
};

std::vector<Rim> rims_of(const TriangleMesh& mesh) {
  std::map<std::int32_t, std::int32_t> next;  // along edges that have one triangle
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for_each_edge(half, [&](std::size_t first, std::size_t last) {
    if (last - first != 1) return;
    const HalfEdge& h = half[first];
    next[h.is_forward ? h.high : h.low] = h.is_forward ? h.low : h.high;
  });
  std::vector<Rim> rims;
  while (!next.empty()) {
    const std::int32_t begin = next.begin()->first;
    Rim rim;
    std::int32_t at = begin;
    for (auto found = next.find(at); found != next.end(); found = next.find(at)) {
      rim.box.add(mesh.vertices[static_cast<std::size_t>(at)]);
      ++rim.edges;
      at = found->second;
      next.erase(found);
    }
    if (at == begin) rims.push_back(rim);
  }
  return rims;
}

/// Openings of walls of triangles: too narrow for any body, or where a triangle is missing.
void warn_of_openings(const Case& c, const SceneParts& parts, const Movers& movers, std::vector<std::string>& warnings) {
  for (std::size_t w = 0; w < c.walls.size(); ++w) {
    const Wall& wall = parts.walls[w];
    if (wall.kind != WallKind::mesh) continue;
    const TriangleMesh& mesh = parts.wall_bodies[w].shape->shape.mesh;
    const double whole = longest(bounding_box(mesh));
    for (const Rim& rim : rims_of(mesh)) {
      if (longest(rim.box) > kSmallOpening * whole) continue;  // its outer border
      const double width = wall.scale * rim.width();
      const Vec3 at = wall.position + wall.scale * rotate(wall.orientation, 0.5 * (rim.box.lower + rim.box.upper));
      const std::string what = fmt::format(
          "{}: wall '{}' has {} near ({:.4g}, {:.4g}, {:.4g}) m, {} wide with {} edges, and the smallest body is {}", c.walls[w].where,
          wall.name, rim.edges > kSeams ? "an opening" : "a hole", at.x, at.y, at.z, metres(width), rim.edges, metres(movers.narrowest));
      if (rim.edges <= kSeams && !c.walls[w].file.empty()) {
        warnings.push_back(what + "; where it is not meant, close it: scree-mesher repair");
        break;  // more of them say no more
      }
      if (width < movers.narrowest) warnings.push_back(what + ": none passes");
    }
  }
}

/// Bodies on both sides of a closed wall of triangles: a region that reaches through it.
void warn_of_closed_walls(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& warnings) {
  constexpr double kMostTests = 1e8;  // of a body against a triangle: some seconds
  const BodyTable& bodies = scene.bodies;
  for (std::size_t w = 0; w < c.walls.size(); ++w) {
    const Wall& wall = parts.walls[w];
    if (wall.kind != WallKind::mesh) continue;
    TriangleMesh mesh = parts.wall_bodies[w].shape->shape.mesh;
    const double tests = static_cast<double>(bodies.size()) * static_cast<double>(mesh.triangles.size());
    if (tests > kMostTests || !is_closed(mesh)) continue;
    if (mass_properties(mesh).volume < 0) {  // the inside of a container, whose normals look in
      turn_inside_out(mesh);
    }
    std::size_t inside = 0, outside = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies.fixed[b]) continue;
      const Vec3 at = (1 / wall.scale) * rotate_inverse(wall.orientation, bodies.position[b] - wall.position);
      (is_inside(mesh, at) ? inside : outside) += 1;
    }
    if (inside == 0 || outside == 0) continue;
    warnings.push_back(fmt::format("{}: {} of {} bodies start inside of the closed wall '{}', the others outside{}", c.walls[w].where,
                                   inside, inside + outside, wall.name,
                                   c.populations.empty() ? "" : "; a region that reaches through it places bodies on both sides"));
  }
}

/// Margins that make another body of a shape, and touch that is not where the shape is drawn.
void warn_of_margins(const Scene& scene, const PackingReport& report, std::vector<std::string>& warnings) {
  for (const PackingReport::Rounding& r : report.roundings) {
    if (r.mean > kFarTouch * r.margin) {
      warnings.push_back(fmt::format(
          "shape '{}' touches {} from its drawn surface on the mean, {:.2f} of its margin of {}: it is too thin or too sharp to "
          "be moved in by that, and all of it is larger than drawn; a smaller contact.margin_ratio, or a smoother shape, is needed",
          r.shape, metres(r.mean), r.mean / r.margin, metres(r.margin)));
    }
  }
  const Settings& s = scene.settings;
  double least = 1e300, margin = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Shape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])];
    if (scene.bodies.fixed[i] != 0 || shape.kind == ShapeKind::sphere) continue;
    least = std::min(least, 0.5 * scene.bodies.scale[i] * shape.equivalent_diameter());
  }
  if (least < 1e300) margin = s.surface == TouchAt::drawn ? s.margin_ratio * least : s.margin;
  if (!(margin > kWideMargin * least)) return;
  warnings.push_back(
      fmt::format("contact.margin is {:.2f} of the radius of the smallest body with a mesh, {}: its edges are rounded by {}; {} or less "
                  "keeps its shape, with a stiffer pair",
                  margin / least, metres(least), metres(margin), metres(kWideMargin / 2 * least)));
}

/// Containers that turn so fast that nothing falls in them: revolutions a minute, given as radians a second.
void warn_of_turns(const Case& c, const SceneParts& parts, std::vector<std::string>& warnings) {
  const double g = length(c.settings.gravity);
  for (std::size_t i = 0; i < c.walls.size() && g > 0; ++i) {
    const Wall& wall = parts.walls[i];
    const auto* turn = std::get_if<Rotate>(&c.walls[i].wall.motion.kind);  // as it is later: it may stand still at the start
    if (turn == nullptr || std::abs(dot(turn->axis, c.settings.gravity)) > 0.5 * g) continue;
    double radius = wall.radius;
    if (wall.kind == WallKind::mesh) {
      radius = 0;
      for (const Vec3& p : parts.wall_bodies[i].world_vertices()) radius = std::max(radius, length(cross(turn->axis, p - turn->centre)));
    }
    const bool holds = wall.kind != WallKind::mesh || (c.walls[i].form && !c.walls[i].form->inside.triangles.empty());
    const double rate = std::abs(turn->rate), froude = rate * rate * radius / g, rpm = rate * 30 / std::numbers::pi;
    const double as_rpm = froude * std::pow(rate / rpm, 2);  // were the same number revolutions a minute
    if (!(froude > (holds ? kCentrifuges : kFlings)) || as_rpm > kCentrifuges) continue;
    warnings.push_back(
        fmt::format("{}: wall '{}' turns at {:.4g} rad/s ({:.4g} rpm), a Froude number of {:.3g} at its radius of {}{}; was \"{:.4g} rpm\" "
                    "({:.4g} rad/s, {:.2g}) meant?",
                    c.walls[i].where, wall.name, rate, rpm, froude, metres(radius),
                    holds ? ": what is in it is pressed to the wall and does not fall" : "", rate, rate * std::numbers::pi / 30, as_rpm));
  }
}

/// A contact that is softened for the sake of the step gives back more of what pressed it together than the attraction itself holds.
void warn_of_attraction(const Case& c, const Scene& scene, const Movers& movers, std::vector<std::string>& warnings) {
  for (const CasePair& p : c.pairs) {
    if (!attracts(p.pair) || scene.settings.gather == Gathering::area) continue;
    double radius = p.pair.contact_radius;
    for (const std::int32_t m : {p.pair.a, p.pair.b}) {
      if (!(p.pair.contact_radius > 0)) radius = std::max(radius, 0.5 * movers.of_material[static_cast<std::size_t>(m)].diameter);
    }
    if (!(radius > 0)) continue;
    const Material &a = scene.materials[static_cast<std::size_t>(p.pair.a)], &b = scene.materials[static_cast<std::size_t>(p.pair.b)];
    if (pull_kind(p.pair) != PullKind::potential) {
      warn_of_neck_or_bridge(scene, p, radius, warnings);
      continue;
    }
    const double range = attraction_range(scene.settings.law, p.pair, a, b, radius), work = 0.5 * pull_off_force(p.pair, radius) * range;
    const RestingContact rest = resting_contact(scene.settings.law, p.pair, a, b, radius);
    if (!(rest.energy > work)) continue;
    warnings.push_back(fmt::format(
        "{}: to part a contact at rest takes {} to undo its overlap of {}, and {} against the attraction over its range: it sticks the "
        "more the "
        "softer it is; a stiffer pair, a wider adhesion_range, or separation_energy in its place is needed",
        p.where, format_quantity(rest.energy, Dimension::energy), metres(rest.overlap), format_quantity(work, Dimension::energy)));
  }
}

}  // namespace

std::vector<std::string> warnings_of_case(const Case& c) {
  std::vector<std::string> warnings;
  warn_of_materials(c, warnings);
  warn_of_surroundings(c, warnings);
  warn_of_temperatures(c, warnings);
  warn_of_names(c, warnings);
  warn_of_times(c, warnings);
  return warnings;
}

std::vector<std::string> warnings_of_case(const Case& c, const SceneParts& parts, const Scene& scene, const PackingReport& report) {
  std::vector<std::string> warnings = warnings_of_case(c);
  const Movers movers = movers_of(c, parts, scene);
  if (!(movers.largest > 0)) return warnings;
  warn_of_extents(c, parts, movers, warnings);
  warn_of_domain(c, parts, warnings);
  warn_of_steps(c, movers, warnings);
  warn_of_stiffness(c, scene, movers, warnings);
  warn_of_attraction(c, scene, movers, warnings);
  warn_of_range(c, scene, warnings);
  warn_of_surfaces(c, scene, warnings);
  warn_of_fall(parts, scene, movers, warnings);
  warn_of_outlets(c, parts, movers, warnings);
  warn_of_openings(c, parts, movers, warnings);
  warn_of_closed_walls(c, parts, scene, warnings);
  warn_of_margins(scene, report, warnings);
  warn_of_turns(c, parts, warnings);
  if (scene.settings.heat && movers.largest > 0 && scene.settings.heat->gas_range > movers.largest) {
    warnings.push_back(
        fmt::format("heat.gas_range = {} is wider than the largest body ({}): pairs with other bodies between them would conduct, and "
                    "each body with all in that range; beds are right with a hundredth of a radius (docs/user/theory.md)",
                    metres(scene.settings.heat->gas_range), metres(movers.largest)));
  }
  if (scene.settings.impact_speed > kFastest) {
    warnings.push_back(
        fmt::format("the fastest impact to expect is {}, from the speeds, falls and walls of the case; are their units right (rad/s, rpm)?",
                    format_quantity(scene.settings.impact_speed, Dimension::velocity)));
  }
  return warnings;
}

}  // namespace scree
