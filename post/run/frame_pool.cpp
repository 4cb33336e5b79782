#include "post/run/frame_pool.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <thread>

#include "core/base/child_process.hpp"
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

ChildProcess start_child(const std::function<void(int)>& work) {
  try {
    return ChildProcess::fork(work);
  } catch (const StartError& error) {
    throw SystemError("{}; give fewer --jobs", error.what());
  }
}

/// in   frame   for the message
Answer receive(ChildProcess& child, std::size_t frame) {
  Answer answer;
  std::uint64_t size = 0;
  bool whole = child.read_exactly(&answer.status, 1) && child.read_exactly(&size, sizeof size);
  if (whole) {
    answer.bytes.resize(size);
    whole = child.read_exactly(answer.bytes.data(), size);
  }
  if (!whole) {
    throw SystemError(
        "a process of scree-post died at frame {} of the list; was it killed, or is there too little memory? Give fewer --jobs", frame);
  }
  return answer;
}

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
  std::vector<ChildProcess> children;
  for (std::size_t j = 0; j < jobs; ++j) {
    children.push_back(start_child([&, j](int descriptor) {
      for (std::size_t i = j; i < frames.size(); i += jobs) {
        const Answer answer = answer_of(task, frames[i], pool.skip_damaged);
        const std::uint64_t size = answer.bytes.size();
        if (!write_exactly(descriptor, &answer.status, 1) || !write_exactly(descriptor, &size, sizeof size) ||
            !write_exactly(descriptor, answer.bytes.data(), size)) {
          return;  // the parent has gone
        }
      }
    }));
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    take(frames[i], receive(children[i % jobs], frames[i]));
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
