#include "post/statistics/frame_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/base/units.hpp"
#include "core/storage/wall_axis.hpp"
#include "core/storage/wall_state.hpp"
#include "post/run/event_table.hpp"
#include "post/statistics/bed.hpp"
#include "post/statistics/contact_kinds.hpp"

namespace scree {

namespace {

constexpr std::size_t kForceBins = 40, kShells = 80, kChainLengths = 18;
constexpr double kLargestForce = 8;  // over the mean: what lies above is one in thousands
constexpr double kPairReach = 4;     // mean diameters
constexpr std::size_t kShortestChain = 3;

// The order here is that of the columns; numbers_of fills them in the same order.
/// in   has_heat   of the scene: bodies have temperatures
std::vector<Quantity> group_quantities(bool has_heat) {
  std::vector<Quantity> q{
      {"particle_count", "-", "bodies that are free to move"},
      {"mass", "kg", "of the particles"},
      {"coordination_number", "-", "neighbours per particle, walls included"},
      {"coordination_number_without_rattlers", "-", "of particles with two neighbours or more"},
      {"rattler_fraction", "-", "share of particles with fewer than two neighbours"},
      {"contact_points_per_particle", "-", "several per neighbour for meshes"},
      {"point_contacts", "-", "contacts in a point per particle"},
      {"edge_contacts", "-", "contacts along an edge per particle"},
      {"face_contacts", "-", "contacts with a face per particle"},
      {"constraints", "-", "per particle: 3, 5, 6 of contacts in a point, along an edge, with a face; shared by two particles"},
      {"constraints_frictionless", "-", "per particle: 1, 2, 3 of these contacts, not shared"},
      {"mean_normal_force", "N", "per contact point"},
      {"max_normal_force", "N", "per contact point"},
      {"mean_tangential_force", "N", "per contact point"},
      {"tensile_fraction", "-", "share of contact points that pull"},
      {"mean_tensile_force", "N", "of the contact points that pull"}};
  const auto tensor = [&q](const std::string& name, const std::string& unit, const std::string& meaning) {
    for (const char* ij : {"xx", "yy", "zz", "xy", "xz", "yz"}) q.push_back({name + "_" + ij, unit, meaning});
  };
  tensor("fabric", "-", "mean of n n over contact points among particles");
  q.push_back({"fabric_anisotropy", "-", "sqrt(3/2 A:A), A = 15/2 deviator of the fabric"});
  tensor("force_fabric", "-", "sum of f_n n n over sum of f_n");
  q.push_back({"force_fabric_anisotropy", "-", "the same of the force fabric"});
  tensor("stress", "Pa", "contact stress, compression positive");
  q.insert(q.end(), {{"pressure", "Pa", "a third of the trace of the stress"},
                     {"deviatoric_stress", "Pa", "sqrt(3/2 s:s) of the deviator"},
                     {"cohesive_pressure", "Pa", "tension that contacts which pull carry, in the pressure with the opposite sign"},
                     {"kinetic_pressure", "Pa", "of the velocity fluctuations: density times granular temperature"},
                     {"solid_fraction", "-", "of the inner 80 % of the bed, under its own surface; of a region: of its volume"},
                     {"solid_fraction_of_container", "-",
                      "of the container from the lowest to the highest point of the particles; of a cell that is periodic along this way, "
                      "of the whole cell"},
                     {"velocity_x", "m/s", "mean by mass"},
                     {"velocity_y", "m/s", "mean by mass"},
                     {"velocity_z", "m/s", "mean by mass"},
                     {"mean_speed", "m/s", "mean by mass"},
                     {"mean_spin", "rad/s", "mean by number"},
                     {"granular_temperature", "m^2/s^2", "a third of the mean square of the velocity about its mean"},
                     {"centre_of_mass_x", "m", "of the particles"},
                     {"centre_of_mass_y", "m", "of the particles"},
                     {"centre_of_mass_z", "m", "of the particles"}});
  if (has_heat)
    q.insert(q.end(), {{"temperature", "K", "mean by mass"}, {"temperature_spread", "K", "its standard deviation by mass, over bodies"}});
  q.insert(q.end(), {{"force_chain_share", "-", "particles in force chains over all"},
                     {"force_chain_count", "-", "chains of three or more"},
                     {"force_chain_length", "-", "mean number of particles in a chain"},
                     {"mixing_index", "-", "Lacey: 1 mixed at random, the value of mixing_index_apart where the kinds are in two layers"},
                     {"mixing_index_apart", "-", "the same if the kinds were apart in two layers: what the cells resolve"},
                     {"segregation_fine", "-", "of the finest third of the particles: 1 apart from all others, 0 among them at random"},
                     {"segregation_middle", "-", "of those between the finest and the coarsest third"},
                     {"segregation_coarse", "-", "of the coarsest third"},
                     {"angle_of_repose", "deg", "of the free surface"},
                     {"discharged_mass", "kg", "passed through the level since the start, or removed at the sides of the domain"},
                     {"discharge_rate", "kg/s", "since the frame before"},
                     {"kinetic_energy", "J", "of the bodies that are counted"},
                     {"potential_energy", "J", "of the bodies that are counted"},
                     {"elastic_energy", "J", "of all contacts of the scene"},
                     {"dissipated_energy", "J", "since the start, of the whole scene"},
                     {"energy_error", "J", "of the balance, from log.csv"}});
  return q;
}

/// Value of a column of the log at a time, between its rows; NaN outside or without it.
double log_value(const LogTable& log, const std::string& name, double time) {
  if (!log.has(name) || log.rows() == 0) return kNaN;
  const std::vector<double>&t = log.column("time"), &v = log.column(name);
  const double slack = 1e-9 * std::max(std::abs(t.front()), std::abs(t.back()));
  if (time < t.front() - slack || time > t.back() + slack) return kNaN;
  const auto it = std::lower_bound(t.begin(), t.end(), time);
  const auto i = static_cast<std::size_t>(it - t.begin());
  if (i >= t.size()) return v.back();
  if (i == 0 || t[i] == time) return v[i];
  return v[i - 1] + (v[i] - v[i - 1]) * (time - t[i - 1]) / (t[i] - t[i - 1]);
}

/// What a wall does on the bodies [W], from the force and the torque about the world's origin that they exert on it.
double power_of(const Wall& wall, double time, const Vec3& force, const Vec3& torque) {
  const WallState at = wall_state(wall, time);
  return -(dot(force, at.velocity) + dot(torque - cross(at.position, force), at.angular_velocity));
}

std::vector<double> centres(double low, double width, std::size_t count) {
  std::vector<double> c(count);
  for (std::size_t i = 0; i < count; ++i) c[i] = low + (static_cast<double>(i) + 0.5) * width;
  return c;
}

ProfileBins bins_of(const std::string& text, const Container& container, double low, double high) {
  ProfileBins bins;
  const std::size_t colon = text.find(':');
  const std::string axis = text.substr(0, colon);
  bins.count = 20;
  if (colon != std::string::npos) {
    char* end = nullptr;
    const long count = std::strtol(text.c_str() + colon + 1, &end, 10);
    if (*end != '\0' || count < 1 || count > 10000)
      throw UsageError("--profile {}: '{}' is no number of bins between 1 and 10000", text, text.substr(colon + 1));
    bins.count = static_cast<std::size_t>(count);
  }
  if (axis != "x" && axis != "y" && axis != "z" && axis != "r")
    throw UsageError("--profile {}: '{}' is no axis; expected x, y, z or r, as in z:20", text, axis);
  bins.axis = axis[0];
  const Box3 box = container.room.bounds();
  if (bins.axis == 'r') {
    bins.high = container.room.kind == Region::Kind::cylinder ? container.room.radius : 0;
    for (int k = 0; k < 3 && container.room.kind != Region::Kind::cylinder; ++k) {
      if (k != container.vertical) bins.high = bins.high > 0 ? std::min(bins.high, 0.5 * box.extent()[k]) : 0.5 * box.extent()[k];
    }
  } else {
    const int k = bins.axis - 'x';
    bins.low = k == container.vertical ? low : box.lower[k];
    bins.high = k == container.vertical ? high : box.upper[k];
  }
  return bins;
}

/// Layers of a profile go with the container, or with the cell: the part of it that they have at the start they have in each frame.
ProfileBins bins_in_frame(const ProfileBins& bins, const SceneFacts& start, const SceneFacts& now) {
  if (bins.axis == 'r') return bins;
  const int k = bins.axis - 'x';
  if (k == start.container.vertical && !start.is_endless()) return bins;  // heights are those of the bed
  const auto ends = [k](const SceneFacts& facts) {
    if (k == facts.container.vertical) return std::pair{facts.cell_lower[k], facts.cell_lower[k] + facts.period.period()[k]};
    const Box3 box = facts.container.room.bounds();
    return std::pair{box.lower[k], box.upper[k]};
  };
  const auto [low, high] = ends(start);
  const auto [low_now, high_now] = ends(now);
  if (!(high > low) || (low == low_now && high == high_now)) return bins;
  const double stretch = (high_now - low_now) / (high - low);
  ProfileBins moved = bins;
  moved.low = low_now + (bins.low - low) * stretch;
  moved.high = low_now + (bins.high - low) * stretch;
  return moved;
}

/// 1 for the bodies that are larger than the median one, 0 for the others; where none is larger, 0 for those that are smaller and 1 for the
/// others. By row.
std::vector<std::int32_t> sorts_by_size(const std::vector<double>& volumes) {
  constexpr double kSame = 1e-9;  // relative: sizes of one entry differ by rounding
  std::vector<std::int32_t> sorts;
  if (volumes.empty()) return sorts;
  std::vector<double> sorted = volumes;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = *middle;
  const bool is_largest = *std::max_element(sorted.begin(), sorted.end()) <= (1 + kSame) * median;
  for (const double volume : volumes) sorts.push_back(volume > (is_largest ? 1 - kSame : 1 + kSame) * median ? 1 : 0);
  return sorts;
}

}  // namespace

StatisticsPlan::StatisticsPlan(const Run& the_run, const StatisticsOptions& the_options) : run(the_run), options(the_options) {
  const RunBodies bodies(run);
  within = Within::named(run, options.within);
  extent = extent_of_bodies(run, options.frames, within, options.pool, options.without);
  facts = std::make_unique<SceneFacts>(run, options.container, extent.box, extent.most);
  note_turning_box();
  quantities = group_quantities(run.scene.settings.heat.has_value());
  add_groups();
  const int up = facts->container.vertical;
  if (facts->is_endless()) {
    add_profiles(facts->cell_lower[up], facts->cell_lower[up] + facts->period.period()[up]);
  } else {
    const bool is_empty = extent.box.is_empty();
    add_profiles(is_empty ? 0 : extent.box.lower[up], is_empty ? 0 : extent.box.upper[up]);
  }
  note_potential_energy();
  add_distributions(extent.diameter);
  choose_kinds(bodies);
  if (!options.discharge.empty()) read_discharge(options.discharge);
  read_masses();
  for (const char* component : {"x", "y", "z"}) wall_quantities.push_back({fmt::format("force_{}", component), "N", "on the wall"});
  for (const char* component : {"x", "y", "z"})
    wall_quantities.push_back({fmt::format("torque_{}", component), "N m", "on the wall, about the world's origin"});
  wall_quantities.push_back({"power", "W", "of the wall on the bodies: of a wall of given motion from the frame, else from log.csv"});
  wall_answers =
      std::any_of(run.scene.walls.begin(), run.scene.walls.end(), [](const Wall& wall) { return wall.motion.drive().has_value(); });
  if (wall_answers) {
    wall_quantities.push_back({"way", "m or rad", "from where it was placed, of a wall that answers to force, from log.csv"});
    wall_quantities.push_back({"rate", "m/s or rad/s", "the same, of its speed"});
  }
  wall_turns = std::any_of(run.scene.walls.begin(), run.scene.walls.end(), [](const Wall& wall) { return own_axis(wall, 0).has_value(); });
  if (wall_turns) wall_quantities.push_back({"axis_torque", "N m", "on the wall, about the axis about which it or its surface turns"});
  wall_begin = table_begin(tables.size());
}

void StatisticsPlan::note_turning_box() {
  if (facts->container.wall < 0 || facts->container.room.kind != Region::Kind::box) return;
  const Wall& wall = run.scene.walls[static_cast<std::size_t>(facts->container.wall)];
  const auto parts = wall.motion.parts();
  if (std::none_of(parts.begin(), parts.end(), [](const WallMotion& part) { return part.turn_axis().has_value(); })) return;
  gaps.emplace_back("solid_fraction",
                    fmt::format("the box '{}' turns, and solid fractions and profiles take its room as it is at the start, without "
                                "the turn; give the room with --container, or a part of it with --region",
                                wall.name));
}

void StatisticsPlan::note_potential_energy() {
  const Settings& s = run.scene.settings;
  for (int k = 0; k < 3; ++k) {
    if (s.domain.periodic[static_cast<std::size_t>(k)] && s.gravity[k] != 0) has_endless_fall = true;
  }
  if (has_endless_fall && (!options.without.empty() || !within.is_everywhere()))
    gaps.emplace_back("potential_energy",
                      "gravity acts along a periodic axis, and frames do not have how often a body went through its sides: the energy "
                      "of a part of the bodies is not known, and frames where some are left out have none");
}

void StatisticsPlan::add_groups() {
  const Scene& scene = run.scene;
  groups.push_back({"all", nullptr, -1, -1});
  for (const Region& region : options.regions)
    groups.push_back({"region " + region.name, &region, -1, -1});  // in our own copy of the options
  for (std::size_t m = 0; options.by_material && m < scene.materials.size(); ++m) {
    groups.push_back({"material " + scene.materials[m].name, nullptr, static_cast<std::int32_t>(m), -1});
  }
  for (std::size_t s = 0; options.by_shape && s < scene.shapes.size(); ++s) {
    if (scene.shapes[s].kind != ShapeKind::surface)
      groups.push_back({"shape " + scene.shapes[s].name, nullptr, -1, static_cast<std::int32_t>(s)});
  }
}

void StatisticsPlan::add_profiles(double low, double high) {
  std::vector<std::string> wanted = options.profiles;
  if (wanted.empty()) wanted.push_back(std::string(1, static_cast<char>('x' + facts->container.vertical)));
  for (const std::string& text : wanted) {
    const ProfileBins bins = bins_of(text, facts->container, low, high);
    if (!(bins.high > bins.low)) continue;  // no bodies
    profiles.push_back(bins);
    const std::string axis(1, bins.axis);
    StatisticsTable table{"profile_" + axis,
                          "Profile along " + axis,
                          {bins.axis == 'r' ? "distance_from_axis" : axis, "m", "middle of the layer"},
                          centres(bins.low, bins.width(), bins.count),
                          {},
                          {}};
    table.columns = {{"solid_fraction", "-", "of the layer"}, {"particle_count", "-", "centres in the layer"},
                     {"velocity_x", "m/s", "mean by mass"},   {"velocity_y", "m/s", "mean by mass"},
                     {"velocity_z", "m/s", "mean by mass"},   {"granular_temperature", "m^2/s^2", "about the mean velocity of the layer"}};
    tables.push_back(std::move(table));
  }
}

void StatisticsPlan::add_distributions(double diameter) {
  tables.push_back(
      {"force_distribution",
       "Distribution of contact forces",
       {"force_over_mean_normal_force", "-", "middle of the bin"},
       centres(0, kLargestForce / kForceBins, kForceBins),
       {{"probability_density_normal", "-", "of the normal force"}, {"probability_density_tangential", "-", "of the tangential force"}},
       {}});
  const double reach = kPairReach * diameter;
  tables.push_back({"pair_correlation",
                    "Pair correlation of the centres",
                    {"distance", "m", "middle of the shell"},
                    centres(0, reach / kShells, kShells),
                    {{"pair_correlation", "-", "1 where places do not depend on one another"}},
                    {}});
  tables.push_back({"force_chain_lengths",
                    "Force chains by length",
                    {"particles", "-", "in a chain; the last row holds all longer ones"},
                    centres(kShortestChain - 0.5, 1, kChainLengths),
                    {{"chain_count", "-", "chains of that length"}},
                    {}});
}

void StatisticsPlan::choose_kinds(const RunBodies& bodies) {
  std::string mixing = options.mixing;
  std::vector<const RunBody*> particles;
  for (const RunBody& body : bodies.all) {
    if (!run.boundary_ids.contains(body.id) && !options.without.contains(body.id)) particles.push_back(&body);
  }
  if (particles.empty() || mixing == "none") return;
  if (mixing == "auto") {
    const bool several =
        std::any_of(particles.begin(), particles.end(), [&](auto* p) { return p->material != particles.front()->material; });
    mixing = several ? "material" : std::string("half-") + static_cast<char>('x' + facts->container.vertical);
  }
  if (mixing.starts_with("half-")) return choose_halves(mixing.back());
  std::vector<std::int32_t> sorts;
  if (mixing == "size") {
    std::vector<double> volumes;
    for (const RunBody* p : particles) volumes.push_back(facts->volume[static_cast<std::size_t>(p->shape)] * std::pow(p->scale, 3));
    sorts = sorts_by_size(volumes);
  } else {
    for (const RunBody* p : particles) sorts.push_back(mixing == "population" ? p->origin : mixing == "shape" ? p->shape : p->material);
  }
  // of sizes the larger are kind 1, else those that are as the first particle
  for (std::size_t i = 0; i < particles.size(); ++i) kind[particles[i]->id] = sorts[i] == (mixing == "size" ? 1 : sorts.front()) ? 1 : 0;
}

void StatisticsPlan::note_coarse_cells(const Frame& frame, char axis_name) {
  constexpr double kCoarse = 0.5;  // an index that halves apart must not have: the cells tell little of this axis
  const FrameView view(*facts, frame);
  std::vector<std::uint8_t> kinds;
  for (const std::int64_t id : frame.bodies.id) kinds.push_back(kind.contains(id) ? kind.at(id) : 2);
  const double index = mixing_index(view, kinds);
  if (!(index > kCoarse)) return;
  gaps.emplace_back(
      "mixing_index",
      fmt::format("the halves along {} have an index of {:.2f} in the frame in which they are apart, where 0 is meant: cells of "
                  "about 12 particles reach across the bed along {}; choose the halves along another axis, or other kinds, with "
                  "--mixing",
                  axis_name, index, axis_name));
}

void StatisticsPlan::choose_halves(char axis_name) {
  const int axis = axis_name - 'x';
  // the first frame that has particles
  for (const std::size_t f : options.frames) {
    const Frame frame = within.part_of(run, load_frame(run, f, FrameParts::bodies));
    const FrameBodies& b = frame.bodies;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (!run.boundary_ids.contains(b.id[i]) && !options.without.contains(b.id[i])) rows.push_back(i);
    }
    if (rows.empty()) continue;
    std::vector<double> places;
    for (const std::size_t i : rows) places.push_back(b.position[i][axis]);
    const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
    std::nth_element(places.begin(), middle, places.end());
    for (const std::size_t i : rows) kind[b.id[i]] = b.position[i][axis] >= *middle ? 1 : 0;
    note_coarse_cells(frame, axis_name);
    break;
  }
  if (run.lets_in())
    gaps.emplace_back("mixing_index",
                      fmt::format("its kinds are the halves along {} of the first frame with bodies: what came in later is of "
                                  "neither; choose kinds with --mixing",
                                  axis_name));
}

CountedFrame StatisticsPlan::load(std::size_t index) const {
  CountedFrame counted{load_frame(run, index)};
  Frame& frame = counted.frame;
  const std::size_t in_frame = frame.bodies.size();
  if (!options.without.empty()) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      if (!options.without.contains(frame.bodies.id[i])) rows.push_back(i);
    }
    take_rows(frame.bodies, rows);
    rows.clear();
    for (std::size_t i = 0; i < frame.contacts.size(); ++i) {
      if (!options.without.contains(frame.contacts.body_a[i]) && !options.without.contains(frame.contacts.body_b[i])) rows.push_back(i);
    }
    take_rows(frame.contacts, rows);
  }
  const FrameBodies& b = frame.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const bool is_above = discharge_axis < 0 || b.position[i][discharge_axis] > discharge_level;
    if (run.boundary_ids.contains(b.id[i]) || !is_above) continue;
    counted.mass_above += facts->volume[static_cast<std::size_t>(b.shape[i])] * b.scale[i] * b.scale[i] * b.scale[i] *
                          run.scene.materials[static_cast<std::size_t>(b.material[i])].density;
  }
  frame = within.part_of(run, std::move(frame));
  counted.is_whole = frame.bodies.size() == in_frame;
  return counted;
}

double StatisticsPlan::Steps::at(double when) const {
  const auto after = std::upper_bound(time.begin(), time.end(), when);
  return after == time.begin() ? 0 : mass[static_cast<std::size_t>(after - time.begin()) - 1];
}

void StatisticsPlan::read_masses() {
  const Scene& scene = run.scene;
  const auto counts = [&](std::int64_t id) { return !run.boundary_ids.contains(id) && !options.without.contains(id); };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (counts(scene.bodies.id[i])) start_mass_ += scene.mass(i);
  }
  const auto read = [&](const char* name, const char* text, Steps& steps) {
    const std::string path = run.folder + name;
    steps.is_known = std::filesystem::exists(path);
    if (!steps.is_known) return;
    const EventTable table(path, {"time", "id", "mass"}, {text});
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const bool is_counted = table.is_whole(row) && counts(static_cast<std::int64_t>(table.number(row, 1)));
      if (!is_counted) continue;
      steps.time.push_back(table.number(row, 0));
      steps.mass.push_back((steps.mass.empty() ? 0 : steps.mass.back()) + table.number(row, 2));
    }
  };
  if (run.lets_in()) read("/inserted.csv", "inlet", came_in_);
  if (run.lets_out()) read("/removed.csv", "outlet", removed_);
}

double StatisticsPlan::discharged(const CountedFrame& counted) const {
  const double time = counted.frame.time;
  if (discharge_axis < 0) {
    if (!run.lets_out()) return kNaN;
    if (removed_.is_known) return removed_.at(time);
  }
  // what came in by now counts as what was there from the start; without its table as the log has it, between its rows
  const double came_in = !run.lets_in() ? 0 : came_in_.is_known ? came_in_.at(time) : log_value(run.log, "inserted_mass", time);
  return start_mass_ + came_in - counted.mass_above;
}

void StatisticsPlan::read_discharge(const std::string& text) {
  if (text.size() < 3 || text[0] < 'x' || text[0] > 'z' || text[1] != '=') {
    throw UsageError("--discharge {}: expected an axis and a height along it, as in z=0.1 or \"z=5 cm\"", text);
  }
  discharge_axis = text[0] - 'x';
  discharge_level = parse_quantity(text.substr(2), Dimension::length, "--discharge " + text);
}

std::size_t StatisticsPlan::index_of(const std::string& quantity) const {
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    if (quantities[q].name == quantity) return q;
  }
  throw InternalError("no quantity " + quantity);
}

std::size_t StatisticsPlan::table_begin(std::size_t table) const {
  std::size_t begin = groups.size() * quantities.size();
  for (std::size_t t = 0; t < table; ++t) begin += tables[t].coordinates.size() * tables[t].columns.size();
  return begin;
}

std::vector<double> StatisticsPlan::numbers_of(const CountedFrame& counted) const {
  const Frame& frame = counted.frame;
  const FrameView view(*facts, frame);
  const bool has_contacts = run.scene.settings.output_contacts;
  const ForceChains chains = has_contacts ? force_chains(view) : ForceChains{};
  std::vector<double> row;
  row.reserve(size());
  const auto add_vector = [&row](const Vec3& v) { row.insert(row.end(), {v.x, v.y, v.z}); };
  const auto add_tensor = [&row](const Mat3& t) {
    row.insert(row.end(), {t[0].x, t[1].y, t[2].z, 0.5 * (t[0].y + t[1].x), 0.5 * (t[0].z + t[2].x), 0.5 * (t[1].z + t[2].y)});
  };

  const BedSolid bed = bed_solid(view);
  const std::vector<BodyConstraints> constraints =
      has_contacts ? body_constraints(view, surface_contacts(view)) : std::vector<BodyConstraints>{};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Group group = groups[g];
    std::optional<Region> part;
    if (group.region != nullptr) group.region = &part.emplace(view.facts.within_a_period(*group.region));
    const double room = group.region != nullptr ? group.region->volume() : view.room_between(view.lowest, view.highest);
    const MotionMeasures motion = motion_measures(view, group);
    ContactMeasures c;
    ConstraintMeasures k;
    if (has_contacts) {
      c = contact_measures(view, group, room);
      k = constraint_measures(view, group, constraints);
    }
    const std::size_t begin = row.size();
    row.insert(row.end(), {motion.particles, motion.mass, c.coordination, c.coordination_without_rattlers, c.rattlers,
                           c.points_per_particle, k.point, k.edge, k.face, k.with_friction, k.without_friction, c.normal_force,
                           c.largest_normal_force, c.tangential_force, c.tensile, c.tensile_force});
    add_tensor(c.fabric);
    row.push_back(c.fabric_anisotropy);
    add_tensor(c.force_fabric);
    row.push_back(c.force_fabric_anisotropy);
    add_tensor(c.stress);
    row.insert(row.end(), {c.pressure, c.deviatoric_stress, c.cohesive_pressure});
    if (!has_contacts) std::fill(row.begin() + static_cast<std::ptrdiff_t>(begin) + 2, row.end(), kNaN);
    row.push_back(room > 0 ? motion.mass / room * motion.granular_temperature : kNaN);
    double solid = kNaN, of_container = kNaN;
    if (group.region != nullptr) {
      solid = region_solid_fraction(view, *group.region);
    } else {
      double own = 0;
      for (std::size_t i = 0; i < view.volume.size(); ++i) own += group.holds(view, i) ? view.volume[i] : 0;
      const double share = view.particle_volume > 0 ? own / view.particle_volume : kNaN;
      solid = bed.fraction * share;
      of_container = bed.of_container * share;
    }
    row.insert(row.end(), {solid, of_container});
    add_vector(motion.velocity);
    row.insert(row.end(), {motion.speed, motion.spin, motion.granular_temperature});
    add_vector(motion.centre);
    if (run.scene.settings.heat) row.insert(row.end(), {motion.temperature, motion.temperature_spread});
    const std::size_t whole_only = row.size();
    if (g == 0) {
      add_whole(counted, view, chains, row);
    }
    row.resize(g == 0 ? row.size() : whole_only + (quantities.size() - (whole_only - begin)), kNaN);
    SCREE_ASSERT(row.size() == (g + 1) * quantities.size(), "{} numbers", row.size());
  }

  add_tables(view, chains, row);
  add_walls(frame, row);
  SCREE_ASSERT(row.size() == size(), "{} numbers, {} expected", row.size(), size());
  return row;
}

void StatisticsPlan::add_whole(const CountedFrame& counted, const FrameView& view, const ForceChains& chains,
                               std::vector<double>& row) const {
  const Frame& frame = view.frame;
  const bool has_contacts = run.scene.settings.output_contacts;
  const double count = static_cast<double>(chains.chains.size());
  row.insert(row.end(),
             {has_contacts && view.particles > 0 ? static_cast<double>(chains.members) / static_cast<double>(view.particles) : kNaN,
              has_contacts ? count : kNaN, count > 0 ? static_cast<double>(chains.members) / count : kNaN});
  std::vector<std::uint8_t> kinds(frame.bodies.size(), 2);
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (const auto it = kind.find(frame.bodies.id[i]); it != kind.end()) kinds[i] = it->second;
  }
  row.push_back(mixing_index(view, kinds));
  row.push_back(mixing_index_apart(view, kinds));
  for (const double segregation : size_segregation(view)) row.push_back(segregation);
  row.push_back(options.repose == "cone" ? angle_of_repose_cone(view) : (options.repose == "slope" ? angle_of_repose_slope(view) : kNaN));
  row.push_back(discharged(counted));
  row.push_back(kNaN);  // the rate needs the frame before: see run_statistics
  BodyEnergies energies{frame.kinetic, frame.potential};
  if (!counted.is_whole) {
    energies = energies_of_bodies(view);
    if (has_endless_fall) energies.potential = kNaN;
  }
  row.insert(row.end(),
             {energies.kinetic, energies.potential, frame.elastic, frame.dissipated, log_value(run.log, "energy_error", frame.time)});
}

void StatisticsPlan::add_tables(const FrameView& view, const ForceChains& chains, std::vector<double>& row) const {
  for (const ProfileBins& bins : profiles) {
    const Profile p = profile(view, bins_in_frame(bins, *facts, view.facts));
    for (std::size_t k = 0; k < bins.count; ++k) {
      row.insert(row.end(), {p.solid_fraction[k], p.particles[k]});
      row.insert(row.end(), {p.velocity[k].x, p.velocity[k].y, p.velocity[k].z});
      row.push_back(p.granular_temperature[k]);
    }
  }
  const ForceDistribution forces = force_distribution(view, kForceBins, kLargestForce);
  for (std::size_t k = 0; k < kForceBins; ++k) row.insert(row.end(), {forces.normal[k], forces.tangential[k]});
  const StatisticsTable& pairs = tables[profiles.size() + 1];
  const double shell = pairs.coordinates.size() > 1 ? pairs.coordinates[1] - pairs.coordinates[0] : 0;
  const std::vector<double> g = pair_correlation(view, kShells, shell * kShells);
  row.insert(row.end(), g.begin(), g.end());
  std::vector<double> lengths(kChainLengths, run.scene.settings.output_contacts ? 0.0 : kNaN);
  for (const auto& chain : chains.chains) lengths[std::min(chain.size() - kShortestChain, kChainLengths - 1)] += 1;
  row.insert(row.end(), lengths.begin(), lengths.end());
}

void StatisticsPlan::add_walls(const Frame& frame, std::vector<double>& row) const {
  const auto add_vector = [&row](const Vec3& v) { row.insert(row.end(), {v.x, v.y, v.z}); };
  const FrameWalls& walls = frame.walls;
  for (const Wall& wall : run.scene.walls) {
    const auto it = std::find(walls.id.begin(), walls.id.end(), wall.id);
    const auto i = static_cast<std::size_t>(it - walls.id.begin());
    add_vector(it != walls.id.end() ? walls.force[i] : Vec3{kNaN, kNaN, kNaN});
    add_vector(it != walls.id.end() ? walls.torque[i] : Vec3{kNaN, kNaN, kNaN});
    const std::string power = fmt::format("wall{}_power", wall.id);
    // the log has rows of its own: at the time of a frame, force times speed is exact, and a value between two rows is not
    const bool is_driven = wall.motion.is_prescribed() && !wall.motion.drive() && !wall.surface.motion.is_prescribed();
    const bool is_known = is_driven && it != walls.id.end() && run.log.has(power);
    row.push_back(is_known ? power_of(wall, frame.time, walls.force[i], walls.torque[i]) : log_value(run.log, power, frame.time));
    for (const char* name : {"way", "rate"}) {
      if (wall_answers) row.push_back(log_value(run.log, fmt::format("wall{}_{}", wall.id, name), frame.time));
    }
    if (wall_turns) {
      const std::optional<TurnAxis> axis = own_axis(wall, frame.time);
      row.push_back(axis && it != walls.id.end() ? axis_torque(*axis, walls.force[i], walls.torque[i]) : kNaN);
    }
  }
}

}  // namespace scree
