#include "core/base/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/base/long_work.hpp"

namespace scree {

namespace {

/// What this process reads its children from. A copy of it closes them: else it would keep the pipes of the others open, and a child would
/// not notice that this process has gone.
std::vector<int>& outputs() {
  static std::vector<int> open;
  return open;
}

/// The ends of a pipe: { to read, to write }. Programs that are started later inherit neither.
std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw StartError("cannot make a pipe", std::strerror(errno));
  return ends;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> result;
  for (std::string& word : words) result.push_back(word.data());
  result.push_back(nullptr);
  return result;
}

}  // namespace

ChildProcess ChildProcess::fork(const std::function<void(int)>& work) {
  const std::array<int, 2> ends = make_pipe();
  std::fflush(nullptr);  // what waits in buffers must not be printed twice
  const pid_t process = ::fork();
  if (process < 0) {
    const int reason = errno;
    close(ends[0]);
    close(ends[1]);
    throw StartError("cannot start a process", std::strerror(reason));
  }
  if (process == 0) {
    print_progress(false);
    close(ends[0]);
    for (const int output : outputs()) close(output);
    work(ends[1]);
    _exit(0);  // no destructors: they belong to the parent
  }
  close(ends[1]);
  outputs().push_back(ends[0]);
  return {process, ends[0]};
}

ChildProcess ChildProcess::start(std::vector<std::string> words, std::optional<std::vector<std::string>> environment, bool is_read) {
  const std::vector<char*> arguments = pointers(words);
  std::vector<char*> variables;
  if (environment) variables = pointers(*environment);
  std::array<int, 2> ends{-1, -1};
  if (is_read) ends = make_pipe();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (is_read) {
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  }
  pid_t process = 0;
  const int failed = posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environment ? variables.data() : environ);
  posix_spawn_file_actions_destroy(&actions);
  if (is_read) close(ends[1]);
  if (failed != 0) {
    if (is_read) close(ends[0]);
    throw StartError("cannot start " + words.front(), std::strerror(failed));
  }
  if (is_read) outputs().push_back(ends[0]);
  return {process, ends[0], -1};
}

ChildProcess ChildProcess::serve(std::vector<std::string> words, int says, const std::vector<int>& given) {
  const std::vector<char*> arguments = pointers(words);
  const pid_t parent = getpid();
  return fork([&](int output) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) return;  // it has gone already, and will not be told of again
    setpgid(0, 0);
    // above all that are placed, so that placing one overwrites none that is still to be placed
    constexpr int kAbove = 64;
    std::vector<int> placed{open("/dev/null", O_RDONLY), says, says, output};
    placed.insert(placed.end(), given.begin(), given.end());
    for (int& descriptor : placed) descriptor = fcntl(descriptor, F_DUPFD_CLOEXEC, kAbove);
    for (std::size_t i = 0; i < placed.size(); ++i) dup2(placed[i], static_cast<int>(i));
    signal(SIGPIPE, SIG_DFL);
    execvp(arguments[0], arguments.data());
    _exit(127);
  });
}

ChildProcess ChildProcess::start_fed(std::vector<std::string> words, int says) {
  const std::vector<char*> arguments = pointers(words);
  std::array<int, 2> ends{};  // a socket, since writing to a pipe without a reader would end this process by SIGPIPE
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) throw StartError("cannot make a pipe", std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, says, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, says, STDERR_FILENO);
  pid_t process = 0;
  const int failed = posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) {
    close(ends[0]);
    throw StartError("cannot start " + words.front(), std::strerror(failed));
  }
  outputs().push_back(ends[0]);
  return {process, -1, ends[0]};
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      output_(std::exchange(other.output_, -1)),
      input_(std::exchange(other.input_, -1)),
      interrupted_(std::move(other.interrupted_)) {}

ChildProcess::~ChildProcess() {
  close_output();
  end_feed();
  if (process_ < 0) return;
  kill();
  interrupted_.reset();
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void ChildProcess::close_output() {
  if (output_ < 0) return;
  std::erase(outputs(), output_);
  close(std::exchange(output_, -1));
}

ChildProcess::Read ChildProcess::read(std::vector<char>& to, int wait) {
  pollfd ready{output_, POLLIN, 0};
  const int found = poll(&ready, 1, wait);
  if (found == 0 || (found < 0 && errno == EINTR)) return Read::nothing_yet;
  char buffer[1 << 16];
  const ssize_t size = found < 0 ? -1 : ::read(output_, buffer, sizeof buffer);
  if (size < 0 && errno == EINTR) return Read::nothing_yet;
  if (size <= 0) return Read::end;
  to.insert(to.end(), buffer, buffer + size);
  return Read::data;
}

bool ChildProcess::read_exactly(void* to, std::size_t size) {
  char* at = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t n = ::read(output_, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool ChildProcess::feed(const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = send(input_, at, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

void ChildProcess::end_feed() {
  if (input_ < 0) return;
  std::erase(outputs(), input_);
  close(std::exchange(input_, -1));
}

void ChildProcess::end(int patience) {
  constexpr int kLook = 10;  // [ms] between two looks
  close_output();
  if (process_ < 0) return;
  ::kill(process_, SIGTERM);
  for (int waited = 0; waited < patience; waited += kLook) {
    if (const pid_t ended = waitpid(process_, nullptr, WNOHANG); ended == process_ || (ended < 0 && errno != EINTR)) {
      process_ = -1;
      return;
    }
    poll(nullptr, 0, kLook);
  }
  kill();
  wait();
}

void ChildProcess::kill() {
  if (process_ > 0) ::kill(process_, SIGKILL);  // one that has ended is still ours until it is waited for
}

ProcessEnd ChildProcess::wait() {
  close_output();
  end_feed();
  const pid_t process = std::exchange(process_, -1);
  // its number is its own until it is waited for, and must not be listed afterwards
  siginfo_t ended;
  while (waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  interrupted_.reset();
  int status = 0;
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) throw SystemError("lost sight of a child process: {}", std::strerror(errno));
  }
  return WIFSIGNALED(status) ? ProcessEnd{0, WTERMSIG(status)} : ProcessEnd{WEXITSTATUS(status), 0};
}

MemoryFile::MemoryFile() : descriptor_(memfd_create("scree", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw SystemError("cannot make a file in memory: {}", std::strerror(errno));
}

MemoryFile::~MemoryFile() { close(descriptor_); }

std::string MemoryFile::text() const {
  std::string text;
  char buffer[4096];
  for (ssize_t n = 0; (n = pread(descriptor_, buffer, sizeof buffer, static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  return text;
}

bool write_exactly(int descriptor, const void* data, std::size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = write(descriptor, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace scree
