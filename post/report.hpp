// report.html: one self-contained page about a run. It opens from a file, offline, and prints.
#pragma once

#include <string>
#include <vector>

#include "post/run_folder.hpp"

namespace scree {

struct ReportResult {
  std::vector<std::string> verdicts;  ///< one line each, for the terminal
  std::vector<std::string> notes;     ///< what the page lacks and why (no picture without a display)
};

/// Writes the page: verdicts, what was run, picture, charts, contact statistics, cost, provenance, commands.
/// Fails: InputError (damaged run, file named), SystemError.   Cost: every frame is read once.
ReportResult write_report(const Run& run, const std::string& path);

}  // namespace scree
