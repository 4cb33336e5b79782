// Timing of several programs in turn, so that whatever else the machine does hits all of them alike.
#pragma once

#include <algorithm>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace scree {

/// CPU seconds of this process: other load on the machine counts only through the shared caches and clocks.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Contender {
  std::string name;
  std::function<void()> work;  ///< does all items once
  std::size_t items = 1;
  std::vector<double> seconds = {};  ///< an item, best of each round
  double least() const { return *std::min_element(seconds.begin(), seconds.end()); }
  double median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// Every contender in turn, `rounds` times; in its turn it repeats its work for at least `turn` seconds.
inline void run_rounds(std::vector<Contender>& contenders, int rounds, double turn) {
  for (Contender& c : contenders) c.work();  // warm
  for (int round = 0; round < rounds; ++round)
    for (Contender& c : contenders) {
      double best = 1e300;
      const double begin = cpu_seconds();
      do {
        const double start = cpu_seconds();
        c.work();
        best = std::min(best, cpu_seconds() - start);
      } while (cpu_seconds() - begin < turn);
      c.seconds.push_back(best / static_cast<double>(c.items));
    }
}

/// Writes a table; nothing when no file was asked for. Throws SystemError when the disk does not take it.
inline void write_table(const std::string& path, const std::string& csv) {
  if (path.empty()) return;
  std::ofstream file(path);
  file << csv;
  file.close();
  if (!file) throw SystemError("{}: cannot be written", path);
}

}  // namespace scree
