#include "mesher/io/sandbox.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>

#include "core/base/child_process.hpp"

namespace scree {

namespace {

// The child answers with one letter and then bytes: 'd' data, 'e' the text of an error, 'm' out of memory.
void be_the_child(int descriptor, const std::function<std::vector<char>()>& work, const ChildLimits& limits) {
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
  if (!write_exactly(descriptor, &kind, 1) || !write_exactly(descriptor, answer.data(), answer.size())) _exit(1);
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
  std::optional<ChildProcess> child;
  try {
    child.emplace(ChildProcess::fork([&](int descriptor) { be_the_child(descriptor, work, limits); }));
  } catch (const StartError& error) {
    throw SystemError("{}: {}", what, error.what());
  }
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::seconds(limits.seconds);
  std::vector<char> answer;
  bool out_of_time = false;
  while (!out_of_time) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    out_of_time = left <= 0;
    if (!out_of_time && child->read(answer, static_cast<int>(left)) == ChildProcess::Read::end) break;
  }
  if (out_of_time) child->kill();
  const ProcessEnd end = child->wait();
  const char* advice = "the file is probably damaged; export the model again, for instance as binary STL";
  if (out_of_time) throw InputError("{}: the importer did not end within {} s; {}", what, limits.seconds, advice);
  if (end.signal == SIGPROF)
    throw InputError("{}: the importer did not end within {:.3g} s of computing; {}", what, limits.cpu_seconds, advice);
  if (end.signal != 0)
    throw InputError("{}: the importer crashed with signal {} ({}); {}", what, end.signal, strsignal(end.signal), advice);
  if (!end.is_success() || answer.empty()) throw InputError("{}: the importer ended without an answer; {}", what, advice);
  const char kind = answer.front();
  answer.erase(answer.begin());
  if (kind == 'm') {
    throw InputError("{}: the importer ran out of memory at {} GiB; {}", what, limits.memory_bytes >> 30, advice);
  }
  if (kind == 'e') throw InputError(std::string(answer.begin(), answer.end()));
  return answer;
}

}  // namespace scree
