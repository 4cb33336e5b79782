#include "solver/run/run_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/csv.hpp"
#include "core/storage/h5.hpp"

namespace scree {

namespace {

std::string header_of(const Scene& scene) {
  std::string names =
      "step,time,kinetic_translational,kinetic_rotational,potential,elastic,elastic_tangential,dissipated,wall_work,"
      "energy_error,contacts,max_depth_ratio,imbalance";
  std::string units = "# units: -,s,J,J,J,J,J,J,J,J,-,-,-";
  for (std::size_t p = 0; p < static_cast<std::size_t>(Phase::count); ++p) {
    names += std::string(",t_") + phase_name(static_cast<Phase>(p));
    units += ",s";
  }
  names += ",t_wait_longest,ghosts,bytes_sent,steps_per_second,removed_bodies,removed_mass,critical_step,state_hash";
  units += ",s,-,B,1/s,-,kg,s,-";
  for (const Wall& wall : scene.walls) {
    for (const char* quantity : {"force", "torque", "impulse"}) {
      for (const char* axis : {"x", "y", "z"}) names += fmt::format(",wall{}_{}_{}", wall.id, quantity, axis);
    }
    names += fmt::format(",wall{}_power", wall.id);
    units += ",N,N,N,N m,N m,N m,N s,N s,N s,W";
  }
  return names + "\n" + units + "\n";
}

}  // namespace

std::size_t TableRows::column(const std::string& name) const {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

TableRows read_table(const std::string& path) {
  constexpr std::size_t kMostDigits = 18;  // of a step: more would not fit
  const auto is_step = [](const std::string& cell) {
    return !cell.empty() && cell.size() <= kMostDigits && cell.find_first_not_of("0123456789") == std::string::npos;
  };
  TableRows table;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && !file.eof()) {  // eof: the line has no end
    if (line.starts_with("#")) continue;
    std::vector<std::string> cells = csv_cells(line);
    if (table.names.empty())
      table.names = std::move(cells);
    else if (cells.size() == table.names.size() && is_step(cells[0]))
      table.rows.push_back(std::move(cells));
  }
  return table;
}

void start_table(const std::string& path, const std::string& header, std::int64_t keep_up_to_step) {
  std::string text = header;
  if (keep_up_to_step >= 0) {
    const TableRows old = read_table(path);
    for (std::size_t row = 0; row < old.rows.size(); ++row) {
      if (old.step(row) > keep_up_to_step) continue;
      for (const std::string& cell : old.rows[row]) text.append(csv_cell(cell)).append(1, ',');
      text.back() = '\n';
    }
  }
  h5::write_text_file(path, text);
}

void append_to_table(const std::string& path, const std::string& rows) {
  std::FILE* file = std::fopen(path.c_str(), "ab");
  if (file == nullptr) throw SystemError("cannot write {}: {}", path, std::strerror(errno));
  const long size = std::ftell(file);
  errno = 0;
  const bool written = std::fwrite(rows.data(), 1, rows.size(), file) == rows.size();
  int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (written && closed) return;
  if (reason == 0) reason = errno;
  // a row that a full disk cut short must not stay
  std::error_code error;
  if (size >= 0) std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size), error);
  throw SystemError("cannot write {}: {}; free some space and restart from the last checkpoint", path, std::strerror(reason));
}

void sync_table(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int reason = errno;
  if (file >= 0) close(file);
  if (!synced) throw SystemError("cannot write {}: {}; free some space and restart from the last checkpoint", path, std::strerror(reason));
}

RunLog::RunLog(const std::string& path, const Scene& scene, std::int64_t keep_up_to_step) : path_(path) {
  start_table(path, header_of(scene), keep_up_to_step);
}

void RunLog::add_row(std::int64_t step, double time, const Energies& e, double energy_error, std::int64_t contacts,
                     double max_overlap_ratio, double imbalance, const std::vector<RankMeasures>& ranks, double steps_per_second,
                     const RemovedTotals& removed, double critical_step, const std::vector<WallLoad>& loads,
                     const std::vector<WallState>& walls, const std::string& state_hash) {
  std::string row = fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.9g},{},{:.9g},{:.6g}", step, time,
                                e.translational, e.rotational, e.potential, e.elastic, e.tangential_elastic, e.dissipated, e.wall_work,
                                energy_error, contacts, max_overlap_ratio, imbalance);
  for (std::size_t p = 0; p < static_cast<std::size_t>(Phase::count); ++p) {
    double sum = 0;
    for (const RankMeasures& m : ranks) sum += m.times[p];
    row += fmt::format(",{:.6g}", sum / static_cast<double>(ranks.size()));
  }
  double longest_wait = 0;
  std::int64_t ghosts = 0, bytes = 0;
  for (const RankMeasures& m : ranks) {
    longest_wait = std::max(longest_wait, m.times[static_cast<std::size_t>(Phase::wait)]);
    ghosts += m.ghosts;
    bytes += m.bytes + m.rebuild_bytes;
  }
  row += fmt::format(",{:.6g},{},{},{:.6g},{:.0f},{:.17g},{:.6g},{}", longest_wait, ghosts, bytes, steps_per_second, removed.count,
                     removed.mass, critical_step, state_hash);
  for (std::size_t w = 0; w < loads.size(); ++w) {
    for (const Vec3& v : {loads[w].force, loads[w].torque, loads[w].impulse}) row += fmt::format(",{:.17g},{:.17g},{:.17g}", v.x, v.y, v.z);
    row += fmt::format(",{:.17g}", loads[w].power(walls[w]));
  }
  append_to_table(path_, row + "\n");
}

std::string step_header() { return "step,time,step_size,reason\n# units: -,s,s,-\n"; }

std::string step_rows(const std::vector<StepChange>& changes) {
  std::string rows;
  for (const StepChange& c : changes) rows += fmt::format("{},{:.17g},{:.17g},{}\n", c.step, c.time, c.step_size, csv_cell(c.reason));
  return rows;
}

std::string removed_header() { return "step,time,id,mass,x,y,z,velocity_x,velocity_y,velocity_z\n# units: -,s,-,kg,m,m,m,m/s,m/s,m/s\n"; }

std::string removed_rows(const std::vector<RemovedBody>& bodies) {
  std::string rows;
  for (const RemovedBody& b : bodies) {
    rows += fmt::format("{},{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", b.step, b.time, b.id, b.mass, b.x.x,
                        b.x.y, b.x.z, b.v.x, b.v.y, b.v.z);
  }
  return rows;
}

}  // namespace scree
