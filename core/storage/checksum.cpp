#include "core/storage/checksum.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "core/base/error.hpp"

namespace scree {

std::uint64_t checksum_of_range(const std::string& path, std::int64_t first, std::int64_t last) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw SystemError("cannot open {}: {}", path, std::strerror(errno));
  constexpr std::int64_t kWordsAtATime = 1 << 15;
  std::vector<std::uint64_t> words(kWordsAtATime);
  std::uint64_t sum = 0;
  while (first < last) {
    const std::int64_t wanted = std::min(last - first, 8 * kWordsAtATime);
    std::fill(words.begin(), words.end(), 0);
    std::int64_t got = 0;
    while (got < wanted) {
      const ssize_t n = pread(file, reinterpret_cast<char*>(words.data()) + got, static_cast<std::size_t>(wanted - got), first + got);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        const int reason = errno;
        close(file);
        throw SystemError("cannot read {}: {}", path, std::strerror(reason));
      }
      if (n == 0) break;  // the end of the file
      got += n;
    }
    const std::int64_t count = (wanted + 7) / 8;
    const auto place = static_cast<std::uint64_t>(first / 8);
    for (std::int64_t i = 0; i < count; ++i) {
      sum += mix(words[static_cast<std::size_t>(i)] ^ mix(place + static_cast<std::uint64_t>(i)));
    }
    first += wanted;
  }
  close(file);
  return sum;
}

}  // namespace scree
