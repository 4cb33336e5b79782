#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/one_line.hpp"
#include "core/base/units.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/edit/descriptors.hpp"
#include "mesher/make/extruded.hpp"
#include "mesher/make/generate.hpp"
#include "mesher/make/primitives.hpp"
#include "mesher/make/random_rock.hpp"
#include "mesher/make/rounded.hpp"

namespace scree {

namespace {

/// Default edge length of round shapes: about 25 edges around and 550 triangles on a sphere, whose volume is
/// then 2 % short. Finer is asked for, since every triangle costs time in each step.
constexpr double kEdgePerRadius = 0.25;
/// Default edge length of rounded edges: steps of at most an eighth of a circle, which leave out 8 % of the radius.
constexpr double kEdgePerRounding = 0.25 * std::numbers::pi;
/// Most triangles that a generated shape may have, by estimate from its area.
constexpr double kMaxTriangles = 5e6;
constexpr double kPi = std::numbers::pi;

double positive_length(const std::string& text, const char* option) {
  if (text.empty()) throw UsageError("generate: {} is missing; give a length, for instance {} \"5 mm\"", option, option);
  const double value = parse_quantity(text, Dimension::length, option);
  if (!(value > 0)) throw UsageError("{} = \"{}\": expected a length > 0", option, text);
  return value;
}

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

/// A number, or a place in a range "a..b" by the share u.
double number_in(const std::string& text, double u, const char* option) {
  const std::size_t dots = text.find("..");
  const auto number = [&](const std::string& part) { return parse_quantity(part, Dimension::none, option); };
  if (dots == std::string::npos) return number(text);
  const double low = number(text.substr(0, dots)), high = number(text.substr(dots + 2));
  if (!(low <= high)) throw UsageError("{} {}: the range runs backwards", option, text);
  return low + u * (high - low);
}

bool is_one_of(const std::string& what, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), what) != names.end();
}

/// Every option that has no meaning for a shape is refused, so that a misunderstanding does not go unseen.
void refuse_others(const GenerateOptions& options) {
  struct Use {
    const std::string& value;
    const char* option;
    std::vector<std::string> shapes;
  };
  const std::vector<std::string> platonic{"tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron"};
  std::vector<std::string> sized{"box", "ellipsoid", "superellipsoid", "hook", "u"};
  sized.insert(sized.end(), platonic.begin(), platonic.end());
  std::vector<std::string> edged{"box"};
  edged.insert(edged.end(), platonic.begin(), platonic.end());
  for (const Use& use :
       {Use{options.radius, "--radius", {"sphere", "cylinder", "capsule", "cone", "torus", "tablet", "hollow_cylinder", "lobes"}},
        Use{options.height, "--height", {"cylinder", "capsule", "cone", "tablet", "hollow_cylinder", "lobes"}},
        Use{options.cup, "--cup", {"tablet"}}, Use{options.bevel, "--bevel", {"tablet"}},
        Use{options.inner_radius, "--inner-radius", {"hollow_cylinder"}}, Use{options.hole_radius, "--hole-radius", {"hollow_cylinder"}},
        Use{options.hole_circle, "--hole-circle", {"hollow_cylinder"}}, Use{options.spread, "--spread", {"lobes"}},
        Use{options.size, "--size", sized}, Use{options.tube_radius, "--tube-radius", {"torus", "hook", "u"}},
        Use{options.upper_radius, "--upper-radius", {"cone"}}, Use{options.exponents, "--exponents", {"superellipsoid"}},
        Use{options.rounding, "--rounding", edged}, Use{options.diameter, "--diameter", {"rock", "stone"}}}) {
    if (!use.value.empty() && !is_one_of(options.what, use.shapes))
      throw UsageError("generate {}: {} has no meaning for it", options.what, use.option);
  }
  const bool is_random = is_one_of(options.what, {"rock", "stone"});
  if ((is_random || (is_one_of(options.what, platonic) && options.rounding.empty())) && !options.edge_length.empty())
    throw UsageError("generate {}: --edge-length has no meaning for it", options.what);
  if (!is_random && (options.count != 1 || options.triangles != 0))
    throw UsageError("generate {}: --count and --triangles are for rock and stone", options.what);
  if (options.holes != 0 && options.what != "hollow_cylinder") throw UsageError("generate {}: --holes has no meaning for it", options.what);
  if (options.lobes != 0 && options.what != "lobes") throw UsageError("generate {}: --lobes has no meaning for it", options.what);
  if (options.triangles < 0 || options.count < 1)
    throw UsageError("generate {}: --triangles {} and --count {}: expected numbers of at least 1", options.what, options.triangles,
                     options.count);
  if (options.analytic && options.what != "sphere") throw UsageError("generate {}: only a sphere can be --analytic", options.what);
  if (options.analytic && !options.edge_length.empty()) throw UsageError("generate sphere --analytic: --edge-length has no meaning for it");
}

void check_triangle_count(double area, double edge_length) {
  const double triangles = area / (0.433 * edge_length * edge_length);  // equilateral triangles
  if (triangles > kMaxTriangles) {
    throw UsageError("--edge-length: {:.3g} m would make about {:.2g} triangles, more than {:g}; give a larger one", edge_length, triangles,
                     kMaxTriangles);
  }
}

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
  check_triangle_count(4 * kPi * radius * radius, edge_length);
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

TriangleMesh make_mesh(const GenerateOptions& options) {
  const std::string& what = options.what;
  const auto radius = [&] { return positive_length(options.radius, "--radius"); };
  const auto height = [&] { return positive_length(options.height, "--height"); };
  const auto edge_length = [&](double usual, double area) {
    const double l = options.edge_length.empty() ? usual : positive_length(options.edge_length, "--edge-length");
    check_triangle_count(area, l);
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

using NamedMesh = std::pair<std::string, TriangleMesh>;

/// The variants of a random particle; `report` tells how their descriptors are distributed.
std::vector<NamedMesh> make_family(const GenerateOptions& options, const std::string& name, std::string& report) {
  if (options.count < 1 || options.count > 100'000) throw UsageError("--count {}: expected from 1 to 100000", options.count);
  RockForm form;
  form.diameter = positive_length(options.diameter, "--diameter");
  form.roughness = options.roughness;
  form.triangles = options.triangles > 0 ? options.triangles : (options.what == "rock" ? 320 : 120);
  std::vector<NamedMesh> family;
  std::vector<Descriptors> all;
  LongWork work("generate", options.count);
  for (std::int32_t i = 0; i < options.count; ++i) {
    work.advance();
    form.seed = options.seed + static_cast<std::uint64_t>(i);
    // two sequences of low discrepancy, so that a small family covers its ranges evenly
    const auto share = [&](double step) { return std::fmod(0.5 + static_cast<double>(form.seed % 1'000'003) * step, 1.0); };
    form.elongation = number_in(options.elongation, share(0.7548776662466927), "--elongation");
    form.flatness = number_in(options.flatness, share(0.5698402909980532), "--flatness");
    family.emplace_back(options.count == 1 ? name : fmt::format("{}_{}", name, i + 1),
                        options.what == "rock" ? random_rock(form) : crushed_stone(form));
    all.push_back(describe(family.back().second));
  }
  report = distribution_of(all);
  return family;
}

}  // namespace

const std::vector<std::string>& generated_shapes() {
  static const std::vector<std::string> names{
      "sphere",          "box",         "cylinder", "capsule",    "cone",         "torus",       "ellipsoid",
      "superellipsoid",  "tetrahedron", "cube",     "octahedron", "dodecahedron", "icosahedron", "tablet",
      "hollow_cylinder", "lobes",       "hook",     "u",          "rock",         "stone"};
  return names;
}

CommandResult generate_command(const GenerateOptions& options, const std::vector<std::string>& command) {
  expect_shape_path(options.output);
  refuse_others(options);
  const std::string name = options.name.empty() ? options.what : options.name;
  if (const std::string fault = fault_of_name(name); !fault.empty()) throw UsageError("--name: the name {}", fault);
  CommandResult result;
  std::vector<Shape> shapes;
  std::string report;
  if (options.analytic) {
    shapes.push_back(make_sphere(name, positive_length(options.radius, "--radius")));
    result.output = fmt::format("{}: analytic sphere of radius {}, volume {:.9g} m^3\n", name,
                                format_quantity(shapes[0].sphere_radius, Dimension::length), shapes[0].mass.volume);
  } else {
    std::vector<NamedMesh> meshes;
    if (options.what == "rock" || options.what == "stone") {
      meshes = make_family(options, name, report);
    } else {
      meshes.emplace_back(name, make_mesh(options));
    }
    for (auto& [shape_name, mesh] : meshes) {
      clean_mesh(mesh, false);
      const MeshCheck check = check_mesh(mesh);
      if (!check.is_solid()) {
        throw InputError("generate {}: the generated mesh is not a solid ({}); try another --edge-length or --seed", options.what,
                         check.problems.front());
      }
      shapes.push_back(make_solid(shape_name, std::move(mesh)));
      shapes.back().verdict = json_of(check);
      result.output +=
          fmt::format("{}: {} triangles, volume {:.9g} m^3\n", shape_name, shapes.back().mesh.triangle_count(), shapes.back().mass.volume);
    }
  }
  for (const Shape& shape : shapes) {
    // moments are of the fifth power of the size
    if (std::isnormal(shape.mass.volume) && std::isnormal(shape.mass.inertia[0].x)) continue;
    throw UsageError("generate {}: a body of volume {:g} m^3 cannot be computed with; give sizes from 1e-50 to 1e50 m", options.what,
                     shape.mass.volume);
  }
  Provenance provenance = shape_provenance(
      command,
      fmt::format(
          "generate {} radius={} height={} size={} edge-length={} tube-radius={} upper-radius={} "
          "exponents={} rounding={} diameter={} elongation={} flatness={} roughness={} triangles={} count={} analytic={} cup={} bevel={} "
          "inner-radius={} holes={} hole-radius={} hole-circle={} lobes={} spread={}",
          options.what, options.radius, options.height, options.size, options.edge_length, options.tube_radius, options.upper_radius,
          options.exponents, options.rounding, options.diameter, options.elongation, options.flatness, options.roughness, options.triangles,
          options.count, options.analytic, options.cup, options.bevel, options.inner_radius, options.holes, options.hole_radius,
          options.hole_circle, options.lobes, options.spread));
  provenance.seed = options.seed;
  write_shape_file(options.output, shapes, provenance_record(provenance));
  result.output += report + fmt::format("wrote {}\n", options.output);
  return result;
}

}  // namespace scree
