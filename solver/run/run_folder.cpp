#include "solver/run/run_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/base/provenance.hpp"
#include "core/base/temporary_file.hpp"
#include "core/storage/written_by_program.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

constexpr const char* kLockName = ".lock";
// What the solver writes besides frames and checkpoints.
constexpr std::array kSingleFiles{"scene.h5", "log.csv", "ranks.csv", "steps.csv", "removed.csv", "run.json", "frames.hdf.series"};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) files.push_back(entry.path());
  return files;
}

/// "process 123 on node7 since 2026-01-01 12:00:00 UTC"
std::string owner_text() {
  char host[256] = "", date[64] = "";
  gethostname(host, sizeof host - 1);
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S UTC", &utc);
  return fmt::format("process {} on {} since {}", getpid(), host, date);
}

}  // namespace

bool is_left_over(const std::string& name) {
  constexpr std::string_view kEnding = ".tmp";
  if (!name.starts_with(".") || !name.ends_with(kEnding)) return false;
  const std::string inner = name.substr(1, name.size() - 1 - kEnding.size());
  const std::size_t dot = inner.rfind('.');
  if (dot == std::string::npos || dot + 1 == inner.size() || inner.find_first_not_of("0123456789", dot + 1) != std::string::npos)
    return false;
  const std::string target = inner.substr(0, dot);
  return frame_number_of(target) || checkpoint_step_of(target) ||
         std::find(kSingleFiles.begin(), kSingleFiles.end(), target) != kSingleFiles.end();
}

std::optional<std::int64_t> completed_at(const std::string& folder) {
  std::ifstream file(fs::path(folder) / "run.json");
  const nlohmann::json run = nlohmann::json::parse(file, nullptr, false);
  if (!run.is_object() || run.value("outcome", nlohmann::json()) != "completed") return {};
  const nlohmann::json steps = run.value("steps", nlohmann::json());
  if (!steps.is_number_integer()) return {};
  return steps.get<std::int64_t>();
}

bool is_folder_of_program(const std::string& folder) {
  std::ifstream file(fs::path(folder) / "run.json");
  const nlohmann::json run = nlohmann::json::parse(file, nullptr, false);
  return run.is_object() && run.contains("provenance") && is_written_by_program(run["provenance"]);
}

void check_run_folder(const std::string& folder, const std::string& scene_path, const std::string& scene_sha256, const std::string& restart,
                      const OptionWords& words) {
  const std::string given = words.folder(folder);
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder)) throw UsageError("{}: exists and is a file; name a folder", given);
  const std::vector<fs::path> files = files_in(folder);
  const auto counts = [](const fs::path& file) {
    const std::string name = file.filename().string();
    return name != kLockName && !is_left_over(name);
  };
  const bool is_empty = std::none_of(files.begin(), files.end(), counts);
  const fs::path scene = fs::path(folder) / "scene.h5";
  const bool has_scene = fs::exists(scene, error), has_checkpoint = !list_checkpoints(folder).empty();
  if (!is_empty && !has_scene && !has_checkpoint) throw UsageError("{}: exists, is not empty and is no run; choose another folder", given);
  if (!is_empty && restart.empty()) {
    // a run that is at work in it is what the user needs to know first: it must not be removed
    if (fs::exists(fs::path(folder) / kLockName, error)) const FolderLock lock(folder, words);
    throw UsageError("{}: exists and is not empty; remove it, choose another name, or continue it with {}", given,
                     has_checkpoint ? words.restart_choice() : words.restart("auto"));
  }
  if (has_scene && sha256_of_file(scene.string()) != scene_sha256) {
    throw UsageError(
        "{}: holds a run of another scene than {}; choose another folder. A run whose case has changed since, such as its "
        "duration, goes on from a new case: [start] run = \"{}\"",
        given, scene_path, folder);
  }
  if (exists && access(folder.c_str(), W_OK) != 0) {
    throw SystemError("{}: {}; choose a folder that is writable", given, std::strerror(errno));
  }
}

FolderLock::FolderLock(const std::string& folder, const OptionWords& words) : path_((fs::path(folder) / kLockName).string()) {
  const std::string given = words.folder(folder);
  const auto refuse = [&](const std::string& reason) {
    if (made_folder_) rmdir(folder.c_str());
    throw SystemError("{}: {}; choose a folder that is writable", given, reason);
  };
  std::error_code error;
  made_folder_ = fs::create_directories(folder, error);
  if (error) refuse(error.message());
  while (true) {
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file_ < 0) refuse(std::strerror(errno));
    while (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      const int reason = errno;
      if (reason == EINTR) continue;
      if (reason == EWOULDBLOCK) {
        std::array<char, 512> owner{};
        const ssize_t length = pread(file_, owner.data(), owner.size() - 1, 0);
        close(file_);
        throw UsageError("{}: another {} is at work in it ({}); wait for its end, stop it, or choose another folder", given,
                         words.of_engine ? "run" : "scree-solver", length > 0 ? owner.data() : "its name is not known");
      }
      warn_once("scree-solver", fmt::format("{}: no file locks here ({}): a second solver in the same folder would not be noticed", given,
                                            std::strerror(reason)));
      break;
    }
    // the owner before may have removed the file between our opening and locking it: then the lock is on no file at all
    struct stat held {
    }, named{};
    if (fstat(file_, &held) == 0 && stat(path_.c_str(), &named) == 0 && held.st_dev == named.st_dev && held.st_ino == named.st_ino) break;
    close(file_);
  }
  const std::string owner = owner_text();
  // on a full disk the lock holds without its text
  if (ftruncate(file_, 0) != 0 || pwrite(file_, owner.data(), owner.size(), 0) < 0) errno = 0;
}

FolderLock::~FolderLock() {
  unlink(path_.c_str());  // while it is still ours: see the constructor
  close(file_);
  if (made_folder_) rmdir(fs::path(path_).parent_path().c_str());  // succeeds only when it is empty
}

void open_run_folder(const std::string& folder, const std::string& scene_path) {
  std::error_code error;
  fs::remove(fs::path(folder) / "run.json", error);
  // the scene travels with the run, so that post needs nothing else
  TemporaryFile copy((fs::path(folder) / "scene.h5").string());
  if (fs::exists(copy.path())) return;
  if (!fs::copy_file(scene_path, copy.name(), fs::copy_options::overwrite_existing, error))
    throw SystemError("cannot write {}: {}", copy.path(), error.message());
  copy.publish();
}

std::vector<FrameEntry> trim_run_folder(const std::string& folder, const FrameSteps& steps, std::int64_t step) {
  std::vector<FrameEntry> kept;
  std::vector<fs::path> later;
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    if (const auto frame = frame_number_of(name)) {
      // a number that no run reaches must not overflow
      const std::int64_t frame_step = *frame > steps.last / steps.interval ? steps.last : *frame * steps.interval;
      if (frame_step <= step) {
        kept.push_back({file.string(), static_cast<double>(frame_step) * steps.step_size});
        continue;
      }
      later.push_back(file);
    } else if (const auto checkpoint = checkpoint_step_of(name); (checkpoint && *checkpoint > step) || is_left_over(name)) {
      later.push_back(file);
    }
  }
  std::sort(kept.begin(), kept.end(), [](const FrameEntry& l, const FrameEntry& r) { return l.time < r.time; });
  const fs::path series = fs::path(folder) / "frames.hdf.series";
  if (!kept.empty())
    write_frame_series(folder, kept);
  else
    fs::remove(series);
  for (const fs::path& file : later) fs::remove(file);
  return kept;
}

}  // namespace scree
