#include "post/run/frame_pool.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <thread>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"

namespace scree {

namespace {

/// How a task ended, as it is sent: then the bytes of the result or the message.
constexpr std::uint8_t kDone = 0, kSkipped = 255;  // between them: the exit code of an error

struct Answer {
  std::uint8_t status = kDone;
  std::string bytes;
};

Answer answer_of(const std::function<std::string(std::size_t)>& task, std::size_t frame, bool skip_damaged) {
  try {
    return {kDone, task(frame)};
  } catch (const InputError& error) {
    return {skip_damaged ? kSkipped : static_cast<std::uint8_t>(error.code()), error.what()};
  } catch (const Error& error) {
    return {static_cast<std::uint8_t>(error.code()), error.what()};
  } catch (const std::bad_alloc&) {
    return {static_cast<std::uint8_t>(ExitCode::system), "out of memory; give fewer --jobs"};
  } catch (const std::exception& error) {
    return {static_cast<std::uint8_t>(ExitCode::internal), error.what()};
  }
}

[[noreturn]] void throw_again(const Answer& answer) {
  switch (static_cast<ExitCode>(answer.status)) {
    case ExitCode::usage:
      throw UsageError(answer.bytes);
    case ExitCode::bad_data:
      throw InputError(answer.bytes);
    case ExitCode::system:
      throw SystemError(answer.bytes);
    case ExitCode::run_invalid:
      throw RunInvalid(answer.bytes);
    default:
      throw InternalError(answer.bytes);
  }
}

bool write_all(int descriptor, const void* data, std::size_t size) {
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

bool read_all(int descriptor, void* data, std::size_t size) {
  char* at = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t n = read(descriptor, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

/// The child processes: ended and waited for on every way out.
class Children {
 public:
  Children() = default;
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children() {
    for (const Child& child : children_) {
      close(child.descriptor);
      kill(child.process, SIGKILL);  // one that has ended is still ours until it is waited for
      waitpid(child.process, nullptr, 0);
    }
  }
  /// Starts a child that runs `work` with the descriptor it writes to.
  void start(const std::function<void(int)>& work) {
    int ends[2];
    if (pipe(ends) != 0) throw SystemError("cannot make a pipe: {}", std::strerror(errno));
    std::fflush(nullptr);  // what waits in buffers must not be printed twice
    const pid_t process = fork();
    if (process < 0) {
      close(ends[0]);
      close(ends[1]);
      throw SystemError("cannot start a process: {}; give fewer --jobs", std::strerror(errno));
    }
    if (process == 0) {
      print_progress(false);
      close(ends[0]);
      for (const Child& child : children_) close(child.descriptor);
      work(ends[1]);
      _exit(0);
    }
    close(ends[1]);
    children_.push_back({process, ends[0]});
  }
  Answer receive(std::size_t child, std::size_t frame) {
    Answer answer;
    std::uint64_t size = 0;
    const int descriptor = children_[child].descriptor;
    bool whole = read_all(descriptor, &answer.status, 1) && read_all(descriptor, &size, sizeof size);
    if (whole) {
      answer.bytes.resize(size);
      whole = read_all(descriptor, answer.bytes.data(), size);
    }
    if (!whole) {
      throw SystemError(
          "a process of scree-post died at frame {} of the list; was it killed, or is there too little memory? Give fewer --jobs", frame);
    }
    return answer;
  }

 private:
  struct Child {
    pid_t process;
    int descriptor;
  };
  std::vector<Child> children_;
};

}  // namespace

FramePoolResult for_each_frame(const std::vector<std::size_t>& frames, const FramePool& pool,
                               const std::function<std::string(std::size_t)>& task,
                               const std::function<void(std::size_t, const std::string&)>& sink) {
  FramePoolResult result;
  const auto take = [&](std::size_t frame, const Answer& answer) {
    if (answer.status == kSkipped) {
      result.skipped.push_back(answer.bytes);
    } else if (answer.status != kDone) {
      throw_again(answer);
    } else {
      sink(frame, answer.bytes);
    }
  };
  LongWork work("frames", static_cast<double>(frames.size()));
  const auto done = [&](std::size_t count) { work.update(static_cast<double>(count), fmt::format("{} of {}", count, frames.size())); };
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t jobs = std::min(frames.size(), pool.jobs > 0 ? static_cast<std::size_t>(pool.jobs) : cores);
  if (jobs <= 1) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      take(frames[i], answer_of(task, frames[i], pool.skip_damaged));
      done(i + 1);
    }
    return result;
  }
  Children children;
  for (std::size_t j = 0; j < jobs; ++j) {
    children.start([&, j](int descriptor) {
      for (std::size_t i = j; i < frames.size(); i += jobs) {
        const Answer answer = answer_of(task, frames[i], pool.skip_damaged);
        const std::uint64_t size = answer.bytes.size();
        if (!write_all(descriptor, &answer.status, 1) || !write_all(descriptor, &size, sizeof size) ||
            !write_all(descriptor, answer.bytes.data(), size)) {
          return;  // the parent has gone
        }
      }
    });
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    take(frames[i], children.receive(i % jobs, frames[i]));
    done(i + 1);
  }
  return result;
}

std::string bytes_of(const std::vector<double>& values) {
  std::string bytes(values.size() * sizeof(double), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::vector<double> doubles_of(const std::string& bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
  return values;
}

}  // namespace scree
