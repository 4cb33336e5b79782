// Work in a child process with limits: third-party importers can crash, hang or ask for all memory when a
// file is broken, and must not take the tool with them.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace scree {

/// Limits of the child: far above what scans of millions of triangles need, and small enough that a machine
/// survives a file whose header promises 10^12 triangles.
struct ChildLimits {
  std::size_t memory_bytes = std::size_t{8} << 30;  ///< address space; see child_memory_is_limited
  int seconds = 900;                                ///< wall clock: a busy machine gives a child less than all of a core
  double cpu_seconds = 300;                         ///< computing time; needing more is a fault of the file, whatever else the machine does
};

/// Runs `work` in a forked child and returns the bytes that it returned.
///
/// in   what   for messages: "reading rock.stl"
/// Fails: InputError with the child's own message when work throws; InputError when the child crashes, runs
/// out of memory or out of time.   Threads: call it before any are started.
std::vector<char> run_in_child(const std::string& what, const std::function<std::vector<char>()>& work, const ChildLimits& limits = {});

/// False in builds with AddressSanitizer or ThreadSanitizer, which reserve terabytes of address space.
bool child_memory_is_limited();

}  // namespace scree
