#include "post/run/run_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "core/storage/frame_check.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// What is read of run.json, by type. A number may be null, as JSON writes one that is not finite: it is not known then.
constexpr std::array kTexts{"outcome", "message", "state_hash", "step_limited_by"};
constexpr std::array kNumbers{"steps",          "step_size",     "critical_step",         "time",         "ranks",
                              "threads",        "bodies",        "removed_bodies",        "removed_mass", "inserted_bodies",
                              "inserted_mass",  "lost_bodies",   "bodies_outside_domain", "wall_seconds", "max_depth_ratio",
                              "mean_imbalance", "peak_rss_bytes"};
constexpr std::array kObjects{"phases", "energy", "memory", "deep_contacts"};
/// Lists of records, and what is read of each.
constexpr std::array kLists{"inlets", "outlets", "drives"};
constexpr std::array kNumbersOfRecords{"bodies", "mass", "owed", "shortfall", "wall"};

nlohmann::json read_outcome(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) return nullptr;
  nlohmann::json run = nlohmann::json::parse(stream, nullptr, false);
  if (!run.is_object()) throw InputError("{}: not JSON; the file is damaged, run the solver again", path);
  const nlohmann::json version = run.value("format_version", nlohmann::json(kRunFormatVersion));
  if (!version.is_number_integer() || version.get<std::int64_t>() > kRunFormatVersion) {
    throw InputError("{}: version {} of a run folder, this Scree reads up to version {}; use a newer Scree", path, version.dump(),
                     kRunFormatVersion);
  }
  const auto wrong = [&](const std::string& key, const char* expected, const nlohmann::json& found) {
    return InputError("{}: {} is {}, {} expected; the file is damaged, run the solver again", path, key, found.type_name(), expected);
  };
  if (!run.contains("outcome")) throw InputError("{}: 'outcome' is missing; the file is damaged, run the solver again", path);
  for (const char* key : kTexts) {
    if (run.contains(key) && !run[key].is_string()) throw wrong(key, "a text", run[key]);
  }
  const auto check_number = [&](nlohmann::json& object, const char* key, const std::string& name) {
    if (!object.contains(key)) return;
    if (object[key].is_null())
      object.erase(key);
    else if (!object[key].is_number())
      throw wrong(name, "a number", object[key]);
  };
  for (const char* key : kNumbers) check_number(run, key, key);
  for (const char* key : kObjects) {
    if (run.contains(key) && !run[key].is_object()) throw wrong(key, "an object", run[key]);
  }
  if (run.contains("deep_contacts")) {
    nlohmann::json& deep = run["deep_contacts"];
    if (deep.contains("text") && !deep["text"].is_string()) throw wrong("deep_contacts.text", "a text", deep["text"]);
    if (deep.contains("deepest") && !deep["deepest"].is_object()) throw wrong("deep_contacts.deepest", "an object", deep["deepest"]);
  }
  for (const char* key : kLists) {
    if (!run.contains(key)) continue;
    if (!run[key].is_array()) throw wrong(key, "a list", run[key]);
    for (nlohmann::json& record : run[key]) {
      if (!record.is_object()) throw wrong(fmt::format("an entry of {}", key), "an object", record);
      for (const char* number : kNumbersOfRecords) check_number(record, number, fmt::format("{} of an entry of {}", number, key));
    }
  }
  return run;
}

/// A finished run has a record for each inlet and outlet of its scene.
void check_records(const Run& run, const std::string& path) {
  for (const auto& [key, expected] : {std::pair{"inlets", run.scene.inlets.size()}, std::pair{"outlets", run.scene.outlets.size()}}) {
    if (run.outcome->contains(key) && (*run.outcome)[key].size() != expected) {
      throw InputError("{}: {} holds {} records, but the scene has {}; the file is damaged or of another run", path, key,
                       (*run.outcome)[key].size(), expected);
    }
  }
}

}  // namespace

bool LogTable::has(const std::string& name) const { return std::find(names.begin(), names.end(), name) != names.end(); }

const std::vector<double>& LogTable::column(const std::string& name) const {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end()) throw InputError("log.csv: the column '{}' is missing", name);
  return columns[static_cast<std::size_t>(it - names.begin())];
}

LogTable read_log(const std::string& path) {
  LogTable table;
  const std::optional<CsvTable> csv = read_csv(path);
  if (!csv) return table;
  table.names = csv->names;
  if (table.names.empty() || table.names[0] != "step") throw InputError("{}: its first line is no header; 'step,time,...' expected", path);
  table.columns.resize(table.names.size());
  for (const CsvTable::Row& row : csv->rows) {
    if (row.cells.size() != table.names.size() || !row.is_ended) {
      // the last line of a run in progress may be half written
      if (&row == &csv->rows.back()) break;
      throw InputError("{}:{}: {} values found, {} expected", path, row.line, row.cells.size(), table.names.size());
    }
    for (std::size_t c = 0; c < row.cells.size(); ++c) {
      char* end = nullptr;
      const double value = std::strtod(row.cells[c].c_str(), &end);
      const bool is_number = end != row.cells[c].c_str() && *end == '\0';
      table.columns[c].push_back(is_number ? value : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return table;
}

bool Run::is_finished() const { return outcome->is_object(); }

bool Run::has_program() const { return log.has("outer_work"); }

namespace {

double latest_count(const Run& run, const char* name) {
  if (run.is_finished()) return run.outcome->value(name, 0.0);
  if (run.log.rows() == 0 || !run.log.has(name)) return 0;
  const double count = run.log.column(name).back();
  return std::isfinite(count) ? count : 0;
}

}  // namespace

double Run::inserted() const { return latest_count(*this, "inserted_bodies"); }
double Run::removed() const { return latest_count(*this, "removed_bodies"); }
bool Run::lets_in() const { return !scene.inlets.empty() || inserted() > 0; }
bool Run::lets_out() const { return !scene.outlets.empty() || scene.settings.domain.outside == Outside::remove || removed() > 0; }

std::string Run::notice() const {
  if (!is_finished()) {
    return fmt::format("{}: no run.json: the run is still being written, or was killed; the {} complete frames so far are used", folder,
                       frames.size());
  }
  const std::string word = outcome->value("outcome", "?");
  if (word == "completed") return "";
  return fmt::format("{}: the run did not complete: {}: {}", folder, word, outcome->value("message", ""));
}

Run open_run(const std::string& folder) {
  Run run;
  fs::path path(folder);
  if (path.filename().empty()) path = path.parent_path();
  run.folder = path.string();
  run.name = path.filename().string();
  if (run.name == "." || run.name == "..") run.name = fs::canonical(path).filename().string();
  if (run.name.size() > 4 && run.name.ends_with(".run")) run.name.resize(run.name.size() - 4);
  if (!fs::is_directory(path)) throw InputError("{}: no such run folder; give the NAME.run that scree-solver wrote", folder);
  run.outcome = read_outcome((path / "run.json").string());
  run.scene = read_scene_file((path / "scene.h5").string());
  check_records(run, (path / "run.json").string());
  run.frames = list_frames(run.folder);
  if (run.frames.empty()) throw InputError("{}: holds no frame yet", folder);
  run.log = read_log((path / "log.csv").string());
  for (const Wall& wall : run.scene.walls) run.boundary_ids.insert(wall.id);
  for (std::size_t i = 0; i < run.scene.bodies.size(); ++i) {
    if (run.scene.bodies.fixed[i] != 0) run.boundary_ids.insert(run.scene.bodies.id[i]);
  }
  return run;
}

void drop_damaged_frames(Run& run) {
  std::vector<FrameEntry> whole;
  for (const FrameEntry& entry : run.frames) {
    try {
      const h5::File file(entry.path);
      whole.push_back(entry);
    } catch (const InputError& error) {
      run.damaged.emplace_back(error.what());
    }
  }
  if (whole.empty())
    throw InputError("{}: none of its {} frames can be read; the first: {}", run.folder, run.frames.size(), run.damaged.front());
  run.frames = std::move(whole);
}

namespace {

/// A run that has ended knows how many bodies came in: they have the ids above all others, in their order.
void check_ids_that_came(const Run& run, const Frame& frame, const std::string& path) {
  if (!run.outcome->contains("inserted_bodies") || frame.bodies.size() == 0) return;
  std::int64_t largest = -1;
  for (const std::int64_t id : run.scene.bodies.id) largest = std::max(largest, id);
  for (const Wall& wall : run.scene.walls) largest = std::max(largest, wall.id);
  const double last = static_cast<double>(largest) + (*run.outcome)["inserted_bodies"].get<double>();
  const std::int64_t id = frame.bodies.id.back();
  if (id > largest && static_cast<double>(id) > last)
    throw InputError("{}: holds body {}, which the run does not have: the last that came in is {:.0f}; the frame is damaged", path, id,
                     last);
}

}  // namespace

Frame load_frame(const Run& run, std::size_t index, FrameParts parts) {
  const std::string& path = run.frames.at(index).path;
  Frame frame = read_frame_file(path, parts);
  check_frame(run.scene, frame, path, run.has_program());
  check_ids_that_came(run, frame, path);
  // a contact of two bodies on either side of a periodic side is written where one of them sees it: beyond the side
  if (const Periodicity period = periodicity_of(run.scene, frame); period.any()) {
    Vec3 image;
    for (Vec3& point : frame.contacts.point) period.wrap(point, image);
  }
  return frame;
}

std::size_t find_frame(const Run& run, std::int64_t number, const char* option) {
  if (number == -1) return run.frames.size() - 1;
  const std::string wanted = fmt::format("frame_{:06}.hdf", number);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    if (fs::path(run.frames[i].path).filename() == wanted) return i;
  }
  throw UsageError("{} {}: {} has no {}; its frames go from {} to {}, and -1 is the last", option, number, run.folder, wanted,
                   fs::path(run.frames.front().path).filename().string(), fs::path(run.frames.back().path).filename().string());
}

}  // namespace scree
