#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/one_line.hpp"
#include "core/base/units.hpp"
#include "mesher/commands/certificate.hpp"
#include "mesher/commands/generate_mesh.hpp"
#include "mesher/edit/descriptors.hpp"
#include "mesher/make/random_rock.hpp"

namespace scree {

namespace {

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
  std::vector<std::string> sized{"box", "ellipsoid", "superellipsoid", "hook", "u", "sleeper"};
  sized.insert(sized.end(), platonic.begin(), platonic.end());
  std::vector<std::string> edged{"box"};
  edged.insert(edged.end(), platonic.begin(), platonic.end());
  for (const Use& use :
       {Use{options.radius,
            "--radius",
            {"sphere", "cylinder", "capsule", "cone", "torus", "tablet", "hollow_cylinder", "lobes", "screw", "paddle_wheel"}},
        Use{options.height, "--height", {"cylinder", "capsule", "cone", "tablet", "hollow_cylinder", "lobes", "screw", "paddle_wheel"}},
        Use{options.shaft_radius, "--shaft-radius", {"screw", "paddle_wheel"}},
        Use{options.thickness, "--thickness", {"screw", "paddle_wheel"}}, Use{options.pitch, "--pitch", {"screw"}},
        Use{options.twist, "--twist", {"paddle_wheel"}}, Use{options.top_width, "--top-width", {"sleeper"}},
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
  if (options.blades != 0 && options.what != "paddle_wheel") throw UsageError("generate {}: --blades has no meaning for it", options.what);
  if ((options.starts != 0 || options.left_handed) && options.what != "screw")
    throw UsageError("generate {}: --starts and --left-handed are for screws", options.what);
  if (options.what == "sleeper" && !options.edge_length.empty()) throw UsageError("generate sleeper: --edge-length has no meaning for it");
  if (options.triangles < 0 || options.count < 1)
    throw UsageError("generate {}: --triangles {} and --count {}: expected numbers of at least 1", options.what, options.triangles,
                     options.count);
  if (options.analytic && options.what != "sphere") throw UsageError("generate {}: only a sphere can be --analytic", options.what);
  if (options.analytic && !options.edge_length.empty()) throw UsageError("generate sphere --analytic: --edge-length has no meaning for it");
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
      "sphere",  "box",        "cylinder",     "capsule",     "cone",   "torus",           "ellipsoid", "superellipsoid", "tetrahedron",
      "cube",    "octahedron", "dodecahedron", "icosahedron", "tablet", "hollow_cylinder", "lobes",     "hook",           "u",
      "sleeper", "screw",      "paddle_wheel", "rock",        "stone"};
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
      if (options.what == "stone" && options.triangles > 0 && planes_of_stone(options.triangles) > options.triangles / 8)
        result.notices.push_back(
            fmt::format("generate stone: --triangles {} is too few for a body: {} planes cut it, the fewest, as with {}", options.triangles,
                        planes_of_stone(options.triangles), 8 * planes_of_stone(options.triangles)));
    } else {
      meshes.emplace_back(name, generated_mesh(options));
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
  std::string of_machines;  // files of other shapes stay as they were
  if (options.what == "screw" || options.what == "paddle_wheel" || options.what == "sleeper")
    of_machines = fmt::format(" shaft-radius={} pitch={} thickness={} starts={} left-handed={} blades={} twist={} top-width={}",
                              options.shaft_radius, options.pitch, options.thickness, options.starts, options.left_handed, options.blades,
                              options.twist, options.top_width);
  Provenance provenance = shape_provenance(
      command,
      fmt::format(
          "generate {} radius={} height={} size={} edge-length={} tube-radius={} upper-radius={} "
          "exponents={} rounding={} diameter={} elongation={} flatness={} roughness={} triangles={} count={} analytic={} cup={} bevel={} "
          "inner-radius={} holes={} hole-radius={} hole-circle={} lobes={} spread={}{}",
          options.what, options.radius, options.height, options.size, options.edge_length, options.tube_radius, options.upper_radius,
          options.exponents, options.rounding, options.diameter, options.elongation, options.flatness, options.roughness, options.triangles,
          options.count, options.analytic, options.cup, options.bevel, options.inner_radius, options.holes, options.hole_radius,
          options.hole_circle, options.lobes, options.spread, of_machines));
  provenance.seed = options.seed;
  write_shape_file(options.output, shapes, provenance_record(provenance));
  result.output += report + fmt::format("wrote {}\n", options.output);
  return result;
}

}  // namespace scree
