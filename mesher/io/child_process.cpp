#include "mesher/io/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"

namespace scree {

namespace {

// The child answers with one letter and then bytes: 'd' data, 'e' the text of an error, 'm' out of memory.
void write_all(int descriptor, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(descriptor, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

[[noreturn]] void be_the_child(int descriptor, const std::function<std::vector<char>()>& work, const ChildLimits& limits) {
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (child_memory_is_limited()) {
    const rlimit memory{limits.memory_bytes, limits.memory_bytes};
    setrlimit(RLIMIT_AS, &memory);
  }
  for (int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPROF}) std::signal(signal, SIG_DFL);
  itimerval computing{};  // finer than RLIMIT_CPU, which counts whole seconds
  computing.it_value.tv_sec = static_cast<time_t>(limits.cpu_seconds);
  computing.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (limits.cpu_seconds - std::floor(limits.cpu_seconds)));
  setitimer(ITIMER_PROF, &computing, nullptr);
  // importers write warnings of their own; what matters comes through the pipe
  if (const int null = open("/dev/null", O_WRONLY); null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
  }
  char kind = 'd';
  std::vector<char> answer;
  try {
    answer = work();
  } catch (const std::bad_alloc&) {
    kind = 'm';
  } catch (const std::exception& error) {
    kind = 'e';
    answer.assign(error.what(), error.what() + std::strlen(error.what()));
  }
  write_all(descriptor, &kind, 1);
  write_all(descriptor, answer.data(), answer.size());
  _exit(0);  // no destructors: they belong to the parent
}

}  // namespace

bool child_memory_is_limited() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC
  return false;
#elif defined(__has_feature)  // Clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  return false;
#else
  return true;
#endif
#else
  return true;
#endif
}

std::vector<char> run_in_child(const std::string& what, const std::function<std::vector<char>()>& work, const ChildLimits& limits) {
  int ends[2];
  if (pipe(ends) != 0) throw SystemError("{}: cannot make a pipe: {}", what, std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) {
    const int fault = errno;
    close(ends[0]);
    close(ends[1]);
    throw SystemError("{}: cannot start a child process: {}", what, std::strerror(fault));
  }
  if (child == 0) {
    print_progress(false);
    close(ends[0]);
    be_the_child(ends[1], work, limits);
  }
  close(ends[1]);

  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::seconds(limits.seconds);
  std::vector<char> answer;
  std::vector<char> buffer(1 << 16);
  bool out_of_time = false;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd wait_for{ends[0], POLLIN, 0};
    const int ready = left > 0 ? poll(&wait_for, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) {
      out_of_time = true;
      break;
    }
    const ssize_t size = read(ends[0], buffer.data(), buffer.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    answer.insert(answer.end(), buffer.begin(), buffer.begin() + size);
  }
  close(ends[0]);
  if (out_of_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const char* advice = "the file is probably damaged; export the model again, for instance as binary STL";
  if (out_of_time) throw InputError("{}: the importer did not end within {} s; {}", what, limits.seconds, advice);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
    throw InputError("{}: the importer did not end within {:.3g} s of computing; {}", what, limits.cpu_seconds, advice);
  if (WIFSIGNALED(status)) {
    throw InputError("{}: the importer crashed with signal {} ({}); {}", what, WTERMSIG(status), strsignal(WTERMSIG(status)), advice);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty()) {
    throw InputError("{}: the importer ended without an answer; {}", what, advice);
  }
  const char kind = answer.front();
  answer.erase(answer.begin());
  if (kind == 'm') {
    throw InputError("{}: the importer ran out of memory at {} GiB; {}", what, limits.memory_bytes >> 30, advice);
  }
  if (kind == 'e') throw InputError(std::string(answer.begin(), answer.end()));
  return answer;
}

}  // namespace scree
