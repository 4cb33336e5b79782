// Files that are there whole or not at all.
#pragma once

#include <string>

#include "core/base/interruption.hpp"

namespace scree {

/// The name under which a file is written until it is complete, "DIR/.NAME.PID.tmp". What is written there without publish() is removed by
/// the destructor, and when a signal ends this process. Makes no file itself.
class TemporaryFile {
 public:
  /// in   path   of the complete file
  explicit TemporaryFile(std::string path);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& name() const { return name_; }
  /// fsync of the file, rename over the path, fsync of the folder. Once. Throws SystemError.
  void publish();

 private:
  std::string path_, name_;
  RemovedWhenInterrupted interrupted_;
};

}  // namespace scree
