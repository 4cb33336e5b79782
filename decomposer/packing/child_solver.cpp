#include "decomposer/packing/child_solver.hpp"

#include <cstdio>

#include "core/base/error.hpp"
#include "decomposer/packing/child_tool.hpp"

namespace scree {

namespace {

std::vector<std::string> solver_words(const ChildSolver& solver) {
  return solver.command.empty() ? std::vector<std::string>{tool_beside("scree-solver")} : solver.command;
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

  std::vector<std::string> words = solver_words(solver);
  words.insert(words.end(), {scene_path, "-o", run});
  Talk talk(progress);
  const int code = run_tool(words, "this packing", "give its command with --solver", [&](const char* bytes, std::size_t size) {
    if (size == 0) talk.tell();  // a run that says nothing new is still told of: the time goes on
    talk.add(bytes, size);
  });
  if (code == 2 || code == 3 || code == 5) throw RunInvalid(talk.error());
  if (code != 0) throw SystemError("{} ended with {}: {}", words.front(), code, talk.error());
  return read_frame_file(list_frames(run).back().path);
}

}  // namespace scree
