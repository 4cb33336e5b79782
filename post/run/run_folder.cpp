#include "post/run/run_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>

#include "core/base/csv.hpp"
#include "core/base/error.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

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
  return run;
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

std::string Run::notice() const {
  if (!is_finished()) {
    return fmt::format("{}: no run.json: the run is still being written, or was killed; the {} complete frames so far are used", folder,
                       frames.size());
  }
  const std::string word = outcome.value("outcome", "?");
  if (word == "completed") return "";
  return fmt::format("{}: the run did not complete: {}: {}", folder, word, outcome.value("message", ""));
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

Frame load_frame(const Run& run, std::size_t index) {
  const std::string& path = run.frames.at(index).path;
  Frame frame = read_frame_file(path);
  const auto shapes = static_cast<std::int32_t>(run.scene.shapes.size());
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const std::int32_t shape = frame.bodies.shape[i];
    if (shape < 0 || shape >= shapes) {
      throw InputError("{}: body {} has shape {}, but the scene has {} shapes; frame and scene.h5 do not belong together", path,
                       frame.bodies.id[i], shape, shapes);
    }
  }
  // a contact of two bodies on either side of a periodic side is written where one of them sees it: beyond the side
  if (const Periodicity period = periodicity_of(run.scene); period.any()) {
    Vec3 image;
    for (Vec3& point : frame.contacts.point) period.wrap(point, image);
  }
  return frame;
}

std::size_t find_frame(const Run& run, std::int64_t number) {
  if (number == -1) return run.frames.size() - 1;
  const std::string wanted = fmt::format("frame_{:06}.hdf", number);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    if (fs::path(run.frames[i].path).filename() == wanted) return i;
  }
  throw UsageError("--frame {}: {} has no {}; its frames go from {} to {}, and -1 is the last", number, run.folder, wanted,
                   fs::path(run.frames.front().path).filename().string(), fs::path(run.frames.back().path).filename().string());
}

}  // namespace scree
