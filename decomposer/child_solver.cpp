#include "decomposer/child_solver.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/error.hpp"

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

/// The line of the solver's talk that tells what went wrong.
std::string error_of(const std::string& path) {
  std::ifstream file(path);
  std::string line, found;
  while (std::getline(file, line)) {
    const auto at = line.find("error: ");
    if (at != std::string::npos) found = line.substr(at + 7);
  }
  return found.empty() ? "it said nothing" : found;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> result;
  for (std::string& word : words) result.push_back(word.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

Frame run_solver(const ChildSolver& solver, const Scene& scene) {
  const TemporaryFolder folder;
  const std::string scene_path = folder / "packing.scene.h5", run = folder / "packing.run", talk = folder / "talk.txt";
  write_scene_file(scene_path, scene);

  std::vector<std::string> words = solver_words(solver), variables;
  words.insert(words.end(), {scene_path, "-o", run});
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!is_of_this_job(*variable)) variables.emplace_back(*variable);
  }
  std::vector<char*> argv = pointers(words), envp = pointers(variables);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, talk.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw SystemError("cannot start {}, which this packing needs: {}; say how with --solver", words.front(), std::strerror(failed));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw SystemError("lost sight of {}: {}", words.front(), std::strerror(errno));
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (code == 2 || code == 3 || code == 5) throw RunInvalid(error_of(talk));
  if (code != 0) throw SystemError("{} ended with {}: {}", words.front(), code, error_of(talk));
  return read_frame_file(list_frames(run).back().path);
}

}  // namespace scree
