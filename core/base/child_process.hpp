// Child processes: another program, or a copy of this one that does a part of its work.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/interruption.hpp"

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

/// A running child. One that is not waited for is killed in the destructor; another program also when a signal ends this process.
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

  /// Another program that works for this one and ends with it: when this process ends, in whatever way, the system sends it SIGTERM.
  /// Signals of the terminal do not reach it, it reads nothing, and what it writes into kServerOutput comes out of read() here.
  /// in   says    a descriptor for its stdout and stderr
  /// in   given   descriptors that it has as kServerOutput + 1 and so on
  /// Fails: throws StartError when no process can be started; a program that does not exist ends with exit code 127.
  static ChildProcess serve(std::vector<std::string> words, int says, const std::vector<int>& given);
  static constexpr int kServerOutput = 3;

  /// Another program that reads from its stdin what feed() is given here.
  /// in   says   a descriptor for its stdout and stderr
  /// Fails: throws StartError, also when there is no such program.
  static ChildProcess start_fed(std::vector<std::string> words, int says);

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  enum class Read { data, end, nothing_yet };
  /// Appends what the child has written; waits for it at most so long [ms], or indefinitely (-1). `end`: all its writers have gone.
  Read read(std::vector<char>& to, int wait);
  /// Reads exactly so many bytes; false when the child ends before.
  bool read_exactly(void* to, std::size_t size);

  /// Writes all bytes to the stdin of a child of start_fed; false when it reads no longer.
  bool feed(const void* data, std::size_t size);
  void end_feed();

  /// Its number; -1 when it has ended and was waited for.
  int process() const { return process_; }
  /// Ends it at once.
  void kill();
  /// Asks it to end (SIGTERM), waits, and kills it when it has not ended after so long [ms].
  void end(int patience);
  /// Waits until it has ended. Throws SystemError when the system no longer knows it.
  ProcessEnd wait();

 private:
  ChildProcess(int process, int output) : process_(process), output_(output) {}
  /// another program
  ChildProcess(int process, int output, int input)
      : process_(process), output_(output), input_(input), interrupted_(std::make_unique<EndedWhenInterrupted>(process)) {}
  void close_output();

  int process_ = -1, output_ = -1, input_ = -1;
  std::unique_ptr<EndedWhenInterrupted> interrupted_;
};

/// A file without a name, in memory: it goes with the last process that has it open, however that ends.
class MemoryFile {
 public:
  /// Fails: throws SystemError.
  MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile();

  int descriptor() const { return descriptor_; }
  /// What has been written into it so far, by whomever.
  std::string text() const;

 private:
  int descriptor_;
};

/// Writes all bytes into a descriptor; false when the reader has gone.
bool write_exactly(int descriptor, const void* data, std::size_t size);

}  // namespace scree
