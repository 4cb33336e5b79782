// Another tool of Scree as a child process, with a folder for its files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/interruption.hpp"

namespace scree {

/// A folder that lives as long as this, and not longer than the process.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
  std::optional<RemovedWhenInterrupted> interrupted_;
};

/// The tool of this name beside this program, or else the one on the PATH.
std::string tool_beside(const char* name);

/// What a tool said went wrong: of its lines the last with "error: ", from there on.
std::string error_said(const std::string& said);

/// Runs a command to its end. The child does not see that this program has started MPI.
/// in   hear    given what it writes, and nothing in each second in which it writes nothing
/// in   what_for, cure   of the message when it cannot be started: "this packing", "give its command with --solver"
/// Returns its exit code, 128 + n after signal n.   Throws SystemError when it cannot be started.
int run_tool(const std::vector<std::string>& words, const std::string& what_for, const std::string& cure,
             const std::function<void(const char* bytes, std::size_t size)>& hear);

}  // namespace scree
