// What a program that a signal ends would leave behind: half of a file, a folder of its own, a child that works for it.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>

namespace scree {

/// While it lives, a file or folder that is removed when SIGINT, SIGTERM or SIGHUP ends this process. Signals that are ignored or handled
/// otherwise stay so. A copy of the process (ChildProcess::fork) removes nothing.
/// Threads: any.   Cost: none but at the signal. Beyond 64 of them at one time, those that come later are left behind.
class RemovedWhenInterrupted {
 public:
  /// in   path   absolute, or relative to a working directory that does not change
  explicit RemovedWhenInterrupted(const std::string& path);
  ~RemovedWhenInterrupted();
  RemovedWhenInterrupted(const RemovedWhenInterrupted&) = delete;
  RemovedWhenInterrupted& operator=(const RemovedWhenInterrupted&) = delete;

 private:
  std::size_t place_;
};

/// The same of a child: it is ended (SIGKILL) and waited for, before anything is removed.
class EndedWhenInterrupted {
 public:
  explicit EndedWhenInterrupted(pid_t process);
  ~EndedWhenInterrupted();
  EndedWhenInterrupted(const EndedWhenInterrupted&) = delete;
  EndedWhenInterrupted& operator=(const EndedWhenInterrupted&) = delete;

 private:
  std::size_t place_;
};

}  // namespace scree
