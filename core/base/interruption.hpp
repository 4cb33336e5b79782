// What a program that a signal ends would leave behind: half of a file, a folder of its own, a child that works for it.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <string>

namespace scree {

/// Has SIGINT, SIGTERM and SIGHUP remove what is listed before they end this process. For programs: signals of a process that uses a
/// library belong to its own program. Signals that are ignored or handled already stay so. Once.
void listen_to_interruptions();

/// While it lives, a file or folder that is removed when SIGINT, SIGTERM or SIGHUP ends this process, if it listens. A copy of the process
/// (fork) removes only what it has made itself.
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
