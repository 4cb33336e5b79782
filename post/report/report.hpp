// report.html: one self-contained page about a run. It opens from a file, offline, and prints.
#pragma once

#include <string>
#include <vector>

#include "core/base/json_record.hpp"
#include "post/run/run_folder.hpp"
#include "post/statistics/statistics.hpp"

namespace scree {

struct ReportOptions {
  std::int64_t frame = -1;         ///< of the picture and the 3D view: number as in the name of the file, -1 the last
  StatisticsOptions statistics{};  ///< of all frames
  std::string apparatus;           ///< what set_apparatus_apart did, for the page
};

struct ReportResult {
  std::vector<std::string> verdicts;  ///< one line each, for the terminal
  std::vector<std::string> notes;     ///< what the page lacks and why (no picture without a display)
  JsonRecord numbers;                 ///< format "scree-report": the numbers that the page shows
};

/// Writes the page: verdicts, what was run, pictures, a 3D view, statistics and charts, cost, provenance, commands.
/// Fails: InputError (damaged run, file named), SystemError.   Cost: every frame is read once.
ReportResult write_report(const Run& run, const std::string& path, const ReportOptions& options);

}  // namespace scree
