#include "core/base/temporary_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/base/error.hpp"

namespace scree {

namespace {

std::string temporary_name(const std::string& path) {
  const std::filesystem::path target(path);
  return (target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), getpid())).string();
}

}  // namespace

TemporaryFile::TemporaryFile(std::string path) : path_(std::move(path)), name_(temporary_name(path_)), interrupted_(name_) {}

// after publish() there is nothing of that name
TemporaryFile::~TemporaryFile() { std::remove(name_.c_str()); }

void TemporaryFile::publish() {
  const int file = open(name_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0 || fsync(file) != 0) {
    const int reason = errno;
    if (file >= 0) close(file);
    throw SystemError("cannot write {}: {}", path_, std::strerror(reason));
  }
  close(file);
  if (std::rename(name_.c_str(), path_.c_str()) != 0) throw SystemError("cannot rename {} to {}: {}", name_, path_, std::strerror(errno));
  const std::string folder = std::filesystem::path(path_).parent_path().string();
  const int directory = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory >= 0) {
    fsync(directory);
    close(directory);
  }
}

}  // namespace scree
