#include "core/storage/h5_crash.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstring>
#include <string_view>

#include "core/base/error.hpp"

namespace scree::h5 {

namespace {

// What a handler reads was laid down before: it may neither allocate nor lock.
std::array<char, 4096> opened{};
const char* the_program = "";
alignas(16) std::array<char, 65536> stack{};  // a damaged file can make the library recurse until the stack is full

void say(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool is_in_library() {
  std::array<void*, 64> frames{};
  const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
  return std::any_of(frames.begin(), frames.begin() + count, [](void* frame) {
    Dl_info info{};
    return dladdr(frame, &info) != 0 && info.dli_fname != nullptr && std::strstr(info.dli_fname, "libhdf5") != nullptr;
  });
}

/// Comes once: after it, the signal does what it does by default, which is what raise() asks for where the library is not to blame.
void on_crash(int signal, siginfo_t* info, void* /*context*/) {
  const bool is_sent = info->si_code <= 0 && info->si_pid != getpid();  // by another process
  if (is_sent || opened[0] == '\0' || !is_in_library()) {
    raise(signal);
    return;
  }
  say(the_program);
  say(": error: ");
  say(opened.data());
  say(": the HDF5 library crashed while it read this file; the file is damaged, make it again\n");
  _exit(static_cast<int>(ExitCode::bad_data));
}

}  // namespace

void explain_crashes([[maybe_unused]] const char* program) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  the_program = program;
  std::array<void*, 1> first{};
  backtrace(first.data(), 1);  // loads what it needs, which a handler must not do
  stack_t own{};
  own.ss_sp = stack.data();
  own.ss_size = stack.size();
  sigaltstack(&own, nullptr);
  struct sigaction action {};
  action.sa_sigaction = on_crash;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_RESETHAND | SA_ONSTACK);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT}) sigaction(signal, &action, nullptr);
#endif
}

void set_opened(const std::string& path) {
  const std::size_t length = std::min(path.size(), opened.size() - 1);
  std::memcpy(opened.data(), path.data(), length);
  opened[length] = '\0';
}

}  // namespace scree::h5
