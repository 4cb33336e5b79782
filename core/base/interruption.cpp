// A handler may do little (signal-safety(7)): it reads what is listed in atomics, and has /bin/rm remove it.
#include "core/base/interruption.hpp"

#include <pthread.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>

namespace scree {

namespace {

constexpr std::size_t kPlaces = 64, kNowhere = kPlaces;
std::array<std::atomic<char*>, kPlaces> paths{};
std::array<std::atomic<pid_t>, kPlaces> children{};

void end_and_remove(int number) {
  for (auto& child : children) {
    const pid_t process = child.load();
    if (process <= 0) continue;
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
  for (auto& path : paths) {
    char* const name = path.load();
    if (name == nullptr) continue;
    const pid_t remover = _Fork();
    if (remover == 0) {
      char program[] = "/bin/rm", force[] = "-rf", end[] = "--";
      char* words[] = {program, force, end, name, nullptr};
      execv(program, words);
      _exit(127);
    }
    if (remover > 0) waitpid(remover, nullptr, 0);
  }
  signal(number, SIG_DFL);
  raise(number);
}

/// In a copy of the process: what its parent has made is not its own.
void forget() {
  for (auto& child : children) child = 0;
  for (auto& path : paths) path = nullptr;
}

/// The place that it takes, or kNowhere.
template <class T>
std::size_t add(std::array<std::atomic<T>, kPlaces>& list, T value) {
  for (std::size_t i = 0; i < kPlaces; ++i) {
    T free{};
    if (list[i].compare_exchange_strong(free, value)) return i;
  }
  return kNowhere;
}

}  // namespace

void listen_to_interruptions() {
  pthread_atfork(nullptr, nullptr, forget);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(number, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = end_and_remove;
    sigfillset(&ours.sa_mask);
    sigaction(number, &ours, nullptr);
  }
}

RemovedWhenInterrupted::RemovedWhenInterrupted(const std::string& path) {
  char* const name = strdup(path.c_str());
  place_ = add(paths, name);
  if (place_ == kNowhere) std::free(name);
}

RemovedWhenInterrupted::~RemovedWhenInterrupted() {
  if (place_ != kNowhere) std::free(paths[place_].exchange(nullptr));
}

EndedWhenInterrupted::EndedWhenInterrupted(pid_t process) : place_(add(children, process)) {}

EndedWhenInterrupted::~EndedWhenInterrupted() {
  if (place_ != kNowhere) children[place_] = 0;
}

}  // namespace scree
