#include "decomposer/packing/child_solver.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include "core/base/child_process.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// A folder that lives as long as this.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "scree-packing-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw SystemError("cannot make a temporary folder {}: {}", name, std::strerror(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// Variables by which Open MPI would take the child for a rank of this program's own job. The user's settings stay.
bool is_of_this_job(const std::string& variable) {
  for (const char* kept : {"OMPI_ALLOW_RUN_AS_ROOT"}) {
    if (variable.starts_with(kept)) return false;
  }
  for (const char* own : {"PMIX_", "ORTE_", "PRTE_", "OMPI_MCA_orte_", "OMPI_MCA_ess", "OMPI_MCA_pmix", "OMPI_MCA_initial_wdir"}) {
    if (variable.starts_with(own)) return true;
  }
  return variable.starts_with("OMPI_") && !variable.starts_with("OMPI_MCA_");
}

std::vector<std::string> solver_words(const ChildSolver& solver) {
  if (!solver.command.empty()) return solver.command;
  std::error_code failed;
  const fs::path beside = fs::read_symlink("/proc/self/exe", failed).parent_path() / "scree-solver";
  return {!failed && fs::exists(beside) ? beside.string() : "scree-solver"};
}

/// What the solver says while it runs, line by line.
class Talk {
 public:
  explicit Talk(const std::function<void(double)>& progress) : progress_(progress) {}

  void add(const char* bytes, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      if (bytes[i] == '\n') {
        take();
        line_.clear();
      } else {
        line_ += bytes[i];
      }
    }
  }
  void tell() const {
    if (progress_) progress_(share_);
  }
  /// The last line that tells what went wrong.
  std::string error() {
    take();
    return error_.empty() ? "it said nothing" : error_;
  }

 private:
  void take() {
    const auto at = line_.find("error: ");
    if (at != std::string::npos) error_ = line_.substr(at + 7);
    double percent = 0;
    char sign = 0;
    if (std::sscanf(line_.c_str(), "solver: %lf %c", &percent, &sign) != 2 || sign != '%') return;
    share_ = 0.01 * percent;
    tell();
  }

  const std::function<void(double)>& progress_;
  std::string line_, error_;
  double share_ = 0;
};

}  // namespace

Frame run_solver(const ChildSolver& solver, const Scene& scene, const std::function<void(double)>& progress) {
  const TemporaryFolder folder;
  const std::string scene_path = folder / "packing.scene.h5", run = folder / "packing.run";
  write_scene_file(scene_path, scene);

  std::vector<std::string> words = solver_words(solver), variables;
  words.insert(words.end(), {scene_path, "-o", run});
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!is_of_this_job(*variable)) variables.emplace_back(*variable);
  }
  std::optional<ChildProcess> child;
  try {
    child.emplace(ChildProcess::start(words, variables, true));
  } catch (const StartError& error) {
    throw SystemError("cannot start {}, which this packing needs: {}; give its command with --solver", words.front(), error.reason());
  }
  Talk talk(progress);
  constexpr int kAgain = 1000;  // [ms] a run that says nothing new is still told of: the time goes on
  std::vector<char> bytes;
  for (auto state = ChildProcess::Read::data; state != ChildProcess::Read::end; bytes.clear()) {
    state = child->read(bytes, kAgain);
    if (state == ChildProcess::Read::nothing_yet) talk.tell();
    talk.add(bytes.data(), bytes.size());
  }
  const ProcessEnd end = child->wait();
  const int code = end.signal == 0 ? end.code : 128 + end.signal;
  if (code == 2 || code == 3 || code == 5) throw RunInvalid(talk.error());
  if (code != 0) throw SystemError("{} ended with {}: {}", words.front(), code, talk.error());
  return read_frame_file(list_frames(run).back().path);
}

}  // namespace scree
