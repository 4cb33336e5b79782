// Errors: what went wrong is the user's, the machine's, the run's or our own mistake, and the type says
// which. Only main() prints them, and only it maps them to exit codes (see run_main).
#pragma once

#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace scree {

/// Exit codes of every tool.
enum class ExitCode : int {
  done = 0,
  internal = 1,     ///< our mistake
  usage = 2,        ///< command line or case file
  bad_data = 3,     ///< a mesh or a file that cannot be used
  system = 4,       ///< I/O or MPI
  run_invalid = 5,  ///< the simulation became invalid: NaN, energy, depth
  signal_base = 128
};

/// Base of every error that Scree throws on purpose.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// The user's mistake in a command or case: where, what was found, what was expected, what to do. Exit 2.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
  template <class... Args>
  explicit UsageError(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : Error(ExitCode::usage, fmt::format(format, std::forward<Args>(args)...)) {}
};

/// Input data that cannot be used: a broken mesh, a truncated or newer file. Exit 3.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(ExitCode::bad_data, message) {}
  template <class... Args>
  explicit InputError(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : Error(ExitCode::bad_data, fmt::format(format, std::forward<Args>(args)...)) {}
};

/// The machine's mistake: disk, memory, network. Exit 4.
class SystemError : public Error {
 public:
  explicit SystemError(const std::string& message) : Error(ExitCode::system, message) {}
  template <class... Args>
  explicit SystemError(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : Error(ExitCode::system, fmt::format(format, std::forward<Args>(args)...)) {}
};

/// The simulation cannot be continued honestly: body, contact and step are named. Exit 5.
class RunInvalid : public Error {
 public:
  explicit RunInvalid(const std::string& message) : Error(ExitCode::run_invalid, message) {}
  template <class... Args>
  explicit RunInvalid(fmt::format_string<Args...> format, Args&&... args) requires(sizeof...(Args) > 0)
      : Error(ExitCode::run_invalid, fmt::format(format, std::forward<Args>(args)...)) {}
};

/// Our own mistake, thrown by SCREE_ASSERT. Exit 1.
class InternalError : public Error {
 public:
  explicit InternalError(const std::string& message) : Error(ExitCode::internal, message) {}
};

/// Runs the body of a main() and maps what it throws to a message on stderr and an exit code.
/// The message is "TOOL: error: TEXT", in red on a terminal unless NO_COLOR is set.
/// Exceptions of gmsh, which are plain std::string, are caught as well. What a signal would leave behind is removed: see interruption.hpp.
int run_main(const std::string& tool, const std::function<int()>& body);

/// Prints "TOOL: warning: TEXT" to stderr the first time a text is given, and counts all of them.
void warn_once(const std::string& tool, const std::string& text);

namespace detail {
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line, const std::string& values);
}

}  // namespace scree

/// Our own invariants. On unless SCREE_NO_ASSERT is defined: their cost is outside the kernels.
#ifndef SCREE_NO_ASSERT
#define SCREE_ASSERT(condition, ...)                                                                                    \
  do {                                                                                                                  \
    if (!(condition)) ::scree::detail::assertion_failed(#condition, __FILE__, __LINE__, ::fmt::format("" __VA_ARGS__)); \
  } while (false)
#else
#define SCREE_ASSERT(condition, ...) static_cast<void>(0)
#endif
