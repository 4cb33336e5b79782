// The folder of a run: the names of its files, which run may write in it, and what a restart keeps.
//
// Only names that the solver itself gives count; whatever else lies in the folder is left as it is. The page of the files is
// core/storage/RUN_FORMAT.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/storage/frame_file.hpp"
#include "core/storage/run_files.hpp"
#include "solver/run/option_words.hpp"

namespace scree {

/// Whether a file is what a killed solver left of a file of its own, "." NAME "." PROCESS ".tmp".
bool is_left_over(const std::string& name);

/// Whether run.json says that a program stepped the run.
bool is_folder_of_program(const std::string& folder);

/// The step at which a run ended, when its run.json says that it is complete.
std::optional<std::int64_t> completed_at(const std::string& folder);

/// Refuses a folder that this run must not write in; touches nothing.
/// in   restart   as in RunOptions
/// in   words     for messages
/// Fails: throws UsageError (a file, not empty, another scene, no run), InputError (no checkpoint), SystemError (not writable).
void check_run_folder(const std::string& folder, const std::string& scene_path, const std::string& scene_sha256, const std::string& restart,
                      const OptionWords& words);

/// The right to write in a run folder: one solver at a time has it, on whatever machine. Made by rank 0 alone.
///
/// How: an exclusive flock on the file ".lock", which the system gives up when the process ends, however it ends; so a killed
/// run leaves nothing to clean up. The file names the owner for the message that the next one gets, and is removed at the end.
/// Makes the folder when there is none, and removes it again when nothing was written into it.
/// Fails: throws UsageError that names the owner when another process holds it, SystemError when the folder cannot be written.
/// Limits: on a file system without locks (Lustre mounted without flock) a warning is all.
class FolderLock {
 public:
  FolderLock(const std::string& folder, const OptionWords& words);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string path_;
  int file_ = -1;
  bool made_folder_ = false;
};

/// Removes the outcome of the run before, and copies the scene into the folder when it is not there yet.
void open_run_folder(const std::string& folder, const std::string& scene_path);

/// The steps at which frames are written: every `interval`-th, and `last`.
struct FrameSteps {
  std::int64_t interval, last;
  double step_size;  ///< [s]
};

/// Removes what a run left that lies after the step it continues from (-1: everything of a run without a checkpoint), and
/// the halves of files whose writers were killed: all of it is made again. Gives the frames that stay. The list of frames is
/// written first, so that it never names one that is gone.
std::vector<FrameEntry> trim_run_folder(const std::string& folder, const FrameSteps& steps, std::int64_t step);

}  // namespace scree
