#include "post/run/body_colours.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Sums over the lines of the contact network, by row of the frame; a line counts for both of its bodies.
std::vector<double> over_neighbours(const Run& run, const Frame& frame, const std::function<double(const NetworkLine&)>& what) {
  std::vector<double> sum(frame.bodies.size(), 0.0);
  std::set<std::pair<std::int32_t, std::int64_t>> walls;  // a wall has a line for each of its points
  const auto add = [&](std::int32_t row, std::int64_t other, std::int32_t other_row, double value, bool counts) {
    if (row < 0 || (counts && other_row < 0 && !walls.emplace(row, other).second)) return;
    sum[static_cast<std::size_t>(row)] += value;
  };
  const bool counts = !what;
  for (const NetworkLine& line : network_of(frame, periodicity_of(run.scene, frame))) {
    const double value = counts ? 1 : what(line);
    add(line.index_a, line.body_b, line.index_b, value, counts);
    add(line.index_b, line.body_a, line.index_a, value, counts);
  }
  return sum;
}

struct Source {
  const Run& run;
  const RunBodies& bodies;
  const Frame& frame;
  std::vector<double> diameter_of_shape;  ///< equivalent, at scale 1 [m]
  double diameter(std::size_t i) const {
    return frame.bodies.scale[i] * diameter_of_shape[static_cast<std::size_t>(frame.bodies.shape[i])];
  }
  double mass(std::size_t i) const {
    return std::numbers::pi / 6 * std::pow(diameter(i), 3) *
           run.scene.materials[static_cast<std::size_t>(frame.bodies.material[i])].density;
  }
  Vec3 start(std::size_t i) const {
    const RunBody* body = bodies.find(frame.bodies.id[i]);
    return body != nullptr ? body->start : Vec3{kNone, kNone, kNone};
  }
};

using Number = double (*)(const Source&, std::size_t);
struct Field {
  const char* name;
  const char* title;
  Number number;  ///< null: a kind, or of contacts
};

double speed_of(const Source& s, std::size_t i) { return length(s.frame.bodies.velocity[i]); }

const std::vector<Field>& fields() {
  static const std::vector<Field> all{
      {"shape", "", nullptr},
      {"material", "", nullptr},
      {"population", "", nullptr},
      {"rank", "", nullptr},
      {"fragment", "", nullptr},
      {"velocity", "speed [m/s]", speed_of},
      {"velocity-x", "velocity x [m/s]", [](const Source& s, std::size_t i) { return s.frame.bodies.velocity[i].x; }},
      {"velocity-y", "velocity y [m/s]", [](const Source& s, std::size_t i) { return s.frame.bodies.velocity[i].y; }},
      {"velocity-z", "velocity z [m/s]", [](const Source& s, std::size_t i) { return s.frame.bodies.velocity[i].z; }},
      {"spin", "angular speed [rad/s]", [](const Source& s, std::size_t i) { return length(s.frame.bodies.angular_velocity[i]); }},
      {"energy", "kinetic energy of translation [J]",
       [](const Source& s, std::size_t i) { return 0.5 * s.mass(i) * squared_length(s.frame.bodies.velocity[i]); }},
      {"size", "equivalent diameter [m]", [](const Source& s, std::size_t i) { return s.diameter(i); }},
      {"mass", "mass [kg]", [](const Source& s, std::size_t i) { return s.mass(i); }},
      {"x", "x [m]", [](const Source& s, std::size_t i) { return s.frame.bodies.position[i].x; }},
      {"y", "y [m]", [](const Source& s, std::size_t i) { return s.frame.bodies.position[i].y; }},
      {"z", "z [m]", [](const Source& s, std::size_t i) { return s.frame.bodies.position[i].z; }},
      {"start-x", "x at the start [m]", [](const Source& s, std::size_t i) { return s.start(i).x; }},
      {"start-y", "y at the start [m]", [](const Source& s, std::size_t i) { return s.start(i).y; }},
      {"start-z", "z at the start [m]", [](const Source& s, std::size_t i) { return s.start(i).z; }},
      {"temperature", "temperature [K]", [](const Source& s, std::size_t i) { return s.frame.bodies.temperature[i]; }},
      {"neighbours", "neighbours", nullptr},
      {"force", "sum of normal forces [N]", nullptr},
      {"id", "id", [](const Source& s, std::size_t i) { return static_cast<double>(s.frame.bodies.id[i]); }}};
  return all;
}

/// Fragments by the lowest id of their bodies, counted from 0 among all bodies with bonds: what breaks off keeps the colour of the rest.
BodyColours fragments_of_frame(const Run& run, const Frame& frame) {
  if (run.scene.bonds.empty()) throw UsageError("--colour fragment: the scene of {} has no bonds", run.folder);
  std::vector<std::int64_t> bonded;
  for (const Bond& bond : run.scene.bonds) bonded.insert(bonded.end(), {bond.a, bond.b});
  std::sort(bonded.begin(), bonded.end());
  bonded.erase(std::unique(bonded.begin(), bonded.end()), bonded.end());
  BodyColours colours{"fragment", true, {}, {}};
  std::map<int, std::size_t> pieces;
  for (const std::int64_t id : fragment_ids(run.scene, frame.bodies, frame.bonds.bond)) {
    const auto kind =
        static_cast<int>(id < 0 ? bonded.end() - bonded.begin() : std::lower_bound(bonded.begin(), bonded.end(), id) - bonded.begin());
    colours.value.push_back(kind);
    ++pieces[kind];
  }
  for (const auto& [kind, count] : pieces) {
    colours.kinds[kind] = kind == static_cast<int>(bonded.size()) ? "without bonds"
                          : count == 1                            ? "1 piece"
                                                                  : fmt::format("{} pieces", count);
  }
  return colours;
}

BodyColours kinds_of(const Run& run, const Source& source, const std::string& name) {
  const FrameBodies& b = source.frame.bodies;
  BodyColours colours{name, true, {}, {}};
  const auto name_of = [&](int kind) -> std::string {
    if (name == "shape") return run.scene.shapes[static_cast<std::size_t>(kind)].name;
    if (name == "material") return run.scene.materials[static_cast<std::size_t>(kind)].name;
    return fmt::format("{} {}", name, kind);
  };
  if (name == "population") {
    for (const std::int64_t id : b.id) {
      const RunBody* body = source.bodies.find(id);
      colours.value.push_back(body != nullptr ? body->origin : static_cast<double>(source.bodies.origins.size() - 1));
    }
    for (const std::int32_t kind : source.bodies.used_origins())
      colours.kinds[kind] = source.bodies.origins[static_cast<std::size_t>(kind)];
    return colours;
  }
  if (name == "fragment") return fragments_of_frame(run, source.frame);
  const std::vector<std::int32_t>& now = name == "shape" ? b.shape : (name == "material" ? b.material : b.rank);
  colours.value.assign(now.begin(), now.end());
  for (const std::int32_t kind : now) colours.kinds.emplace(kind, name_of(kind));
  if (name == "rank") return colours;
  for (const std::int32_t kind : name == "shape" ? source.bodies.shapes() : source.bodies.materials())
    colours.kinds.emplace(kind, name_of(kind));
  return colours;
}

}  // namespace

const std::vector<std::string>& body_colour_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Field& field : fields()) all.emplace_back(field.name);
    return all;
  }();
  return names;
}

std::string body_colour_list() {
  std::string list;
  const std::vector<std::string>& names = body_colour_names();
  for (std::size_t i = 0; i < names.size(); ++i) list += (i == 0 ? "" : (i + 1 < names.size() ? ", " : " or ")) + names[i];
  return list;
}

BodyColours body_colours(const Run& run, const RunBodies& bodies, const Frame& frame, const std::string& name) {
  const auto field = std::find_if(fields().begin(), fields().end(), [&](const Field& f) { return name == f.name; });
  if (field == fields().end()) throw UsageError("--colour {}: expected {}", name, body_colour_list());
  Source source{run, bodies, frame, {}};
  for (const Shape& shape : run.scene.shapes) source.diameter_of_shape.push_back(shape.equivalent_diameter());
  if (field->title[0] == '\0') return kinds_of(run, source, name);
  if (name == "temperature" && !frame.bodies.has_temperature)
    throw UsageError("--colour temperature: the scene of {} has no heat; add a table [heat] to the case and run it again", run.folder);
  BodyColours colours{field->title, false, {}, {}};
  if (field->number == nullptr) {
    if (!run.scene.settings.output_contacts)
      throw UsageError("--colour {}: {} kept no contacts; set contacts = true in [output] of the case and run it again", name, run.folder);
    if (name == "force")
      colours.value = over_neighbours(run, frame, [](const NetworkLine& line) { return std::abs(line.normal_force); });
    else
      colours.value = over_neighbours(run, frame, nullptr);
    return colours;
  }
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) colours.value.push_back(field->number(source, i));
  return colours;
}

}  // namespace scree
