// Work on many frames, shared out over processes, its results taken in order of time.
//
// Processes, not threads: the HDF5 library of Debian is not thread-safe, and a frame is read through it. A result waits in
// its process until it is its turn, so that memory is that of one frame in each process, whatever the number of frames.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace scree {

struct FramePool {
  int jobs = 0;               ///< processes; 0: as many as there are cores
  bool skip_damaged = false;  ///< leave out frames that cannot be read; else the first of them ends the work
};

/// What came of it.
struct FramePoolResult {
  std::vector<std::string> skipped;  ///< the messages of the frames that were left out, each with its file
};

/// Calls `task` for each frame in one of several processes, and `sink` for each result in the order of `frames`.
///
/// in   frames   indices of frames, handed to task and sink as they are
/// in   task     runs in a child process (with one job: in this one); what it returns is handed to `sink`, what else it does
///               to memory is lost
/// in   sink     runs here
/// Fails: what `task` throws first, in order of frames, is thrown here with its type; SystemError when a process dies.
/// Threads: call it before any are started.
FramePoolResult for_each_frame(const std::vector<std::size_t>& frames, const FramePool& pool,
                               const std::function<std::string(std::size_t)>& task,
                               const std::function<void(std::size_t, const std::string&)>& sink);

/// Numbers as bytes and back, for results.
std::string bytes_of(const std::vector<double>& values);
std::vector<double> doubles_of(const std::string& bytes);

}  // namespace scree
