// Child processes: another program, or a copy of this one that does a part of its work.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace scree {

/// A child could not be started.
class StartError : public SystemError {
 public:
  /// in   what     "cannot start rsvg-convert"
  /// in   reason   of the system: "No such file or directory"
  StartError(const std::string& what, std::string reason) : SystemError("{}: {}", what, reason), reason_(std::move(reason)) {}
  const std::string& reason() const { return reason_; }

 private:
  std::string reason_;
};

/// How a child ended.
struct ProcessEnd {
  int code = 0;    ///< its exit code, 0 after a signal
  int signal = 0;  ///< that ended it, or 0
  bool is_success() const { return code == 0 && signal == 0; }
};

/// A running child. One that is not waited for is killed in the destructor.
/// Threads: start children before any thread.
class ChildProcess {
 public:
  /// A copy of this process does `work` with a descriptor whose bytes come out of output() here, and ends with exit code 0 when it
  /// returns; nothing of it is destroyed, and it prints no progress. `work` must not throw.
  /// Fails: throws StartError, also when there is no descriptor left for the pipe.
  static ChildProcess fork(const std::function<void(int)>& work);

  /// Another program: its path, or its name on the PATH, and its arguments.
  /// in   environment   "NAME=value" each; nothing: that of this process
  /// in   is_read       its stdout and stderr come out of output() here; else they are those of this process
  /// Fails: throws StartError, also when there is no such program.
  static ChildProcess start(std::vector<std::string> words, std::optional<std::vector<std::string>> environment, bool is_read);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  enum class Read { data, end, nothing_yet };
  /// Appends what the child has written; waits for it at most so long [ms], or for ever (-1). `end`: all its writers have gone.
  Read read(std::vector<char>& to, int wait);
  /// Reads exactly so many bytes; false when the child ends before.
  bool read_exactly(void* to, std::size_t size);

  /// Ends it at once.
  void kill();
  /// Waits until it has ended. Throws SystemError when the system no longer knows it.
  ProcessEnd wait();

 private:
  ChildProcess(int process, int output) : process_(process), output_(output) {}
  void close_output();

  int process_ = -1, output_ = -1;
};

/// Writes all bytes into a descriptor; false when the reader has gone.
bool write_exactly(int descriptor, const void* data, std::size_t size);

}  // namespace scree
