#include "decomposer/packing/child_tool.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "core/base/child_process.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// Variables by which Open MPI would take the child for a rank of this program's own job. The user's settings stay.
bool is_of_this_job(const std::string& variable) {
  for (const char* kept : {"OMPI_ALLOW_RUN_AS_ROOT", "PRTE_ALLOW_RUN_AS_ROOT", "PRTE_MCA_rmaps_default", "PRTE_MCA_hwloc_default"}) {
    if (variable.starts_with(kept)) return false;
  }
  for (const char* own : {"PMIX_", "ORTE_", "PRTE_", "OMPI_MCA_orte_", "OMPI_MCA_ess", "OMPI_MCA_pmix", "OMPI_MCA_initial_wdir"}) {
    if (variable.starts_with(own)) return true;
  }
  return variable.starts_with("OMPI_") && !variable.starts_with("OMPI_MCA_");
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "scree-packing-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw SystemError("cannot make a temporary folder {}: {}", name, std::strerror(errno));
  path_ = name;
  interrupted_.emplace(name);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string tool_beside(const char* name) {
  std::error_code failed;
  const fs::path beside = fs::read_symlink("/proc/self/exe", failed).parent_path() / name;
  return !failed && fs::exists(beside) ? beside.string() : name;
}

std::string error_said(const std::string& said) {
  const auto at = said.rfind("error: ");
  if (at == std::string::npos) return "it said nothing";
  return said.substr(at + 7, said.find('\n', at) - at - 7);
}

int run_tool(const std::vector<std::string>& words, const std::string& what_for, const std::string& cure,
             const std::function<void(const char* bytes, std::size_t size)>& hear) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!is_of_this_job(*variable)) variables.emplace_back(*variable);
  }
  std::optional<ChildProcess> child;
  try {
    child.emplace(ChildProcess::start(words, variables, true));
  } catch (const StartError& error) {
    throw SystemError("cannot start {}, which {} needs: {}; {}", words.front(), what_for, error.reason(), cure);
  }
  constexpr int kAgain = 1000;  // [ms]
  std::vector<char> bytes;
  for (auto state = ChildProcess::Read::data; state != ChildProcess::Read::end; bytes.clear()) {
    state = child->read(bytes, kAgain);
    hear(bytes.data(), bytes.size());
  }
  const ProcessEnd end = child->wait();
  return end.signal == 0 ? end.code : 128 + end.signal;
}

}  // namespace scree
