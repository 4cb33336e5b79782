#include "mesher/commands/generate_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/base/units.hpp"
#include "core/geometry/blades.hpp"
#include "mesher/make/generate.hpp"
#include "mesher/make/primitives.hpp"
#include "mesher/make/rounded.hpp"
#include "mesher/make/sections.hpp"

namespace scree {

double positive_length(const std::string& text, const char* option) {
  if (text.empty()) throw UsageError("generate: {} is missing; give a length, for instance {} \"5 mm\"", option, option);
  const double value = parse_quantity(text, Dimension::length, option);
  if (!(value > 0)) throw UsageError("{} = \"{}\": expected a length > 0", option, text);
  return value;
}

namespace {

/// Default edge length of round shapes: about 25 edges around and 550 triangles on a sphere, whose volume is
/// then 2 % short. Finer is asked for, since every triangle costs time in each step.
constexpr double kEdgePerRadius = 0.25;
/// Default edge length of rounded edges: steps of at most an eighth of a circle, which leave out 8 % of the radius.
constexpr double kEdgePerRounding = 0.25 * std::numbers::pi;
/// Most triangles that a generated shape may have, by estimate from its area.
constexpr double kMostGenerated = 5e6;

std::vector<std::string> split(const std::string& text, std::size_t count, const char* option) {
  std::vector<std::string> parts{""};
  for (char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() == count) return parts;
  throw UsageError("{} = \"{}\": {} {} found, {} expected, for instance {} {}", option, text, text.empty() ? 0 : parts.size(),
                   count == 3 ? "lengths" : "numbers", count, option, count == 3 ? "\"4 cm, 2 cm, 1 cm\"" : "\"0.5, 0.5\"");
}

Vec3 size_of(const std::string& text) {
  const std::vector<std::string> parts = split(text, 3, "--size");
  return {positive_length(parts[0], "--size"), positive_length(parts[1], "--size"), positive_length(parts[2], "--size")};
}

void check_triangle_count(double triangles, double edge_length) {
  if (triangles > kMostGenerated) {
    throw UsageError("--edge-length: {:.3g} m would make about {:.2g} triangles, more than {:g}; give a larger one", edge_length, triangles,
                     kMostGenerated);
  }
}

/// Of a surface of equilateral triangles.
void check_area(double area, double edge_length) { check_triangle_count(area / (0.433 * edge_length * edge_length), edge_length); }

/// Steps around a circle for an edge length: a multiple of 4, at least 8.
int sectors_for(double radius, double edge_length) {
  return std::max(8, 4 * static_cast<int>(std::lround(0.5 * kPi * radius / edge_length)));
}

/// Level of an icosphere whose edges, 1.1 radii at level 0, are not longer.
int level_for(double radius, double edge_length) {
  return std::clamp(static_cast<int>(std::ceil(std::log2(1.1 * radius / edge_length))), 0, 9);
}

/// A box or Platonic solid with its edges and corners rounded, where that is asked for.
TriangleMesh rounded_as_asked(const TriangleMesh& solid, const GenerateOptions& options) {
  if (options.rounding.empty()) return solid;
  const double radius = positive_length(options.rounding, "--rounding");
  const double edge_length =
      options.edge_length.empty() ? kEdgePerRounding * radius : positive_length(options.edge_length, "--edge-length");
  check_area(4 * kPi * radius * radius, edge_length);
  return rounded(solid, radius, edge_length);
}

TriangleMesh make_tablet(const GenerateOptions& options, double radius, double height, double edge_length) {
  const double cup = positive_length(options.cup, "--cup");
  if (cup > radius) throw UsageError("--cup {}: a cap deeper than the radius {}; expected at most that", options.cup, options.radius);
  const double bevel = options.bevel.empty() ? 0 : positive_length(options.bevel, "--bevel");
  if (!(bevel < radius))
    throw UsageError("--bevel {}: no flat face is left; expected less than the radius {}", options.bevel, options.radius);
  const double arc = 2 * std::atan2(cup, radius) * 0.5 * (radius * radius + cup * cup) / cup;
  return tablet(radius, height, cup, bevel, sectors_for(radius, edge_length),
                std::max(2, static_cast<int>(std::lround(arc / edge_length))));
}

TriangleMesh make_hollow_cylinder(const GenerateOptions& options, double radius, double height, double edge_length) {
  constexpr int kMostHoles = 100;
  Drilled disc{radius, options.inner_radius.empty() ? 0 : positive_length(options.inner_radius, "--inner-radius"), options.holes, 0, 0};
  if (options.inner_radius.empty() && options.holes == 0)
    throw UsageError("generate hollow_cylinder: no hole; give --inner-radius for one in the middle, --holes for others around it");
  if (options.holes != 0 && (options.holes < 2 || options.holes > kMostHoles))
    throw UsageError("--holes {}: expected from 2 to {}; for one in the middle, give --inner-radius", options.holes, kMostHoles);
  if (options.holes == 0 && !(options.hole_radius.empty() && options.hole_circle.empty()))
    throw UsageError("--hole-radius and --hole-circle are of holes around the middle: give their number with --holes");
  if (options.holes != 0) {
    disc.hole_radius = positive_length(options.hole_radius, "--hole-radius");
    disc.circle = options.hole_circle.empty() ? 0.5 * (disc.radius + disc.inner) : positive_length(options.hole_circle, "--hole-circle");
  }
  if (const std::string fault = fault_of(disc); !fault.empty()) {
    throw UsageError("generate hollow_cylinder: {}: radius {:g} m, inner radius {:g} m, {} holes of radius {:g} m at {:g} m from the axis",
                     fault, disc.radius, disc.inner, disc.holes, disc.hole_radius, disc.circle);
  }
  int sectors = sectors_for(radius, edge_length);
  if (disc.holes != 0) sectors = disc.holes * ((sectors + disc.holes - 1) / disc.holes);
  return extruded(drilled(disc, sectors, disc.holes == 0 ? 0 : sectors_for(disc.hole_radius, edge_length)), height);
}

TriangleMesh make_lobes(const GenerateOptions& options, double radius, double height, double edge_length) {
  constexpr int kMostLobes = 100;
  if (options.lobes < 2 || options.lobes > kMostLobes) throw UsageError("--lobes {}: expected from 2 to {}", options.lobes, kMostLobes);
  const double spread = options.spread.empty() ? radius : positive_length(options.spread, "--spread");
  if (!(radius > spread * std::sin(kPi / options.lobes))) {
    throw UsageError("--spread {}: {} lobes of radius {} do not overlap their neighbours; expected less than {:g} m", options.spread,
                     options.lobes, options.radius, radius / std::sin(kPi / options.lobes));
  }
  const double arc = arc_of_lobe(options.lobes, radius, spread);
  return extruded(lobes(options.lobes, radius, spread, std::max(4, static_cast<int>(std::lround(arc / edge_length)))), height);
}

TriangleMesh make_screw(const GenerateOptions& options, double radius, double length, double edge_length) {
  constexpr int kMostStarts = 100;
  if (options.starts < 0 || options.starts > kMostStarts)
    throw UsageError("--starts {}: expected from 1 to {}", options.starts, kMostStarts);
  const Screw screw{positive_length(options.shaft_radius, "--shaft-radius"),
                    radius,
                    positive_length(options.pitch, "--pitch"),
                    positive_length(options.thickness, "--thickness"),
                    std::max(1, options.starts),
                    options.left_handed};
  if (const std::string fault = fault_of(screw); !fault.empty()) {
    throw UsageError("generate screw: {}: shaft radius {:g} m, radius {:g} m, {} flights {:g} m thick in a pitch of {:g} m", fault,
                     screw.shaft, screw.radius, screw.starts, screw.thickness, screw.pitch);
  }
  const int sectors = sectors_for(radius, edge_length);
  // a ring of corners for each of so many layers
  check_triangle_count(4 * sectors * (sectors * length / screw.pitch + 1), edge_length);
  return screw_mesh(screw, length, sectors);
}

TriangleMesh make_paddle_wheel(const GenerateOptions& options, double radius, double height, double edge_length) {
  constexpr int kMostBlades = 100;
  if (options.blades < 1 || options.blades > kMostBlades)
    throw UsageError("--blades {}: expected from 1 to {}", options.blades, kMostBlades);
  const PaddleWheel wheel{positive_length(options.shaft_radius, "--shaft-radius"), radius,
                          positive_length(options.thickness, "--thickness"), options.blades};
  if (const std::string fault = fault_of(wheel); !fault.empty()) {
    throw UsageError("generate paddle_wheel: {}: shaft radius {:g} m, radius {:g} m, {} blades {:g} m thick", fault, wheel.shaft,
                     wheel.radius, wheel.blades, wheel.thickness);
  }
  const double turn = options.twist.empty() ? 0 : parse_quantity(options.twist, Dimension::angle, "--twist");
  const int sectors = sectors_for(radius, edge_length);
  const double layers = std::max(1.0, std::ceil(sectors * std::abs(turn) / (2 * kPi)));
  check_triangle_count(4 * (sectors + 4 * wheel.blades) * layers, edge_length);
  return extruded(section_of(wheel, sectors), height, turn, static_cast<int>(layers));
}

/// A prism along x whose upper face may be narrower than the lower one.
TriangleMesh make_sleeper(const GenerateOptions& options) {
  const Vec3 size = size_of(options.size);
  const double top = options.top_width.empty() ? size.y : positive_length(options.top_width, "--top-width");
  TriangleMesh mesh = box_mesh(size);
  for (Vec3& p : mesh.vertices)
    if (p.z > 0) p.y *= top / size.y;
  return mesh;
}

}  // namespace

TriangleMesh generated_mesh(const GenerateOptions& options) {
  const std::string& what = options.what;
  const auto radius = [&] { return positive_length(options.radius, "--radius"); };
  const auto height = [&] { return positive_length(options.height, "--height"); };
  const auto edge_length = [&](double usual, double area) {
    const double l = options.edge_length.empty() ? usual : positive_length(options.edge_length, "--edge-length");
    check_area(area, l);
    return l;
  };
  if (what == "sphere") {
    const double r = radius();
    return generate_sphere(r, edge_length(kEdgePerRadius * r, 4 * kPi * r * r));
  }
  if (what == "box") {
    const Vec3 size = size_of(options.size);
    if (options.edge_length.empty() || !options.rounding.empty()) return rounded_as_asked(box_mesh(size), options);
    return generate_box(size, edge_length(0, 2 * (size.x * size.y + size.y * size.z + size.z * size.x)));
  }
  if (what == "cylinder") {
    const double r = radius(), h = height(), l = edge_length(kEdgePerRadius * r, 2 * kPi * r * (r + h));
    const int layers = options.edge_length.empty() ? 1 : std::max(1, static_cast<int>(std::lround(h / l)));
    return generate_cylinder(r, h, l, layers);
  }
  if (what == "capsule") {
    const double r = radius(), h = height();
    return capsule(r, h, sectors_for(r, edge_length(kEdgePerRadius * r, 2 * kPi * r * (2 * r + h))));
  }
  if (what == "cone") {
    const double r = radius();
    const double upper = options.upper_radius.empty() ? 0 : positive_length(options.upper_radius, "--upper-radius");
    return cone(r, upper, height(), sectors_for(r, edge_length(kEdgePerRadius * r, 4 * kPi * r * r)));
  }
  if (what == "tablet" || what == "hollow_cylinder" || what == "lobes") {
    const double r = radius(), h = height(), l = edge_length(kEdgePerRadius * r, 4 * kPi * r * (r + h));
    if (what == "tablet") return make_tablet(options, r, h, l);
    return what == "lobes" ? make_lobes(options, r, h, l) : make_hollow_cylinder(options, r, h, l);
  }
  if (what == "screw" || what == "paddle_wheel") {
    const double r = radius(), h = height(), l = edge_length(kEdgePerRadius * r, 4 * kPi * r * (r + h));
    return what == "screw" ? make_screw(options, r, h, l) : make_paddle_wheel(options, r, h, l);
  }
  if (what == "sleeper") return make_sleeper(options);
  if (what == "torus") {
    const double ring = radius(), tube = positive_length(options.tube_radius, "--tube-radius");
    if (!(tube < ring)) throw UsageError("--tube-radius {} must be smaller than --radius {}", options.tube_radius, options.radius);
    const double l = edge_length(0.5 * tube, 4 * kPi * kPi * ring * tube);
    return torus(ring, tube, sectors_for(ring + tube, l), sectors_for(tube, l));
  }
  if (what == "ellipsoid" || what == "superellipsoid") {
    const Vec3 axes = 0.5 * size_of(options.size);
    const double largest = std::max({axes.x, axes.y, axes.z});
    const int level = level_for(largest, edge_length(kEdgePerRadius * largest, 4 * kPi * largest * largest));
    if (what == "ellipsoid") return ellipsoid(axes, level);
    const std::vector<std::string> parts = split(options.exponents, 2, "--exponents");
    const double e = parse_quantity(parts[0], Dimension::none, "--exponents"), n = parse_quantity(parts[1], Dimension::none, "--exponents");
    if (!(std::min(e, n) >= 0.1 && std::max(e, n) <= 2)) throw UsageError("--exponents {}: expected from 0.1 to 2", options.exponents);
    return superellipsoid(axes, e, n, level);
  }
  if (what == "hook" || what == "u") {
    const Vec3 size = size_of(options.size);  // width, left leg, right leg
    const double tube = positive_length(options.tube_radius, "--tube-radius");
    if (!(2.2 * tube < size.x))
      throw UsageError("--tube-radius {}: the legs would touch; it must be below 0.45 of the width", options.tube_radius);
    const double l = edge_length(0.7 * tube, 2 * kPi * tube * (1.6 * size.x + size.y + size.z));
    return rod(u_path(size.x, size.y, size.z, std::max(8, sectors_for(0.5 * size.x, l) / 2)), tube, sectors_for(tube, l));
  }
  TriangleMesh mesh = platonic_solid(what);
  const double edge = positive_length(options.size, "--size");
  for (Vec3& p : mesh.vertices) p *= edge;
  return rounded_as_asked(mesh, options);
}

}  // namespace scree
