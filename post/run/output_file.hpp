// A text file written piece by piece, and there whole or not at all.
#pragma once

#include <cstdio>
#include <string>

#include "core/base/temporary_file.hpp"

namespace scree {

class OutputFile {
 public:
  /// Throws SystemError when it cannot be created.
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();
  /// Throws SystemError (disk full).
  void add(const std::string& text);
  /// Gives the file its name.
  void commit();

 private:
  TemporaryFile temporary_;
  std::FILE* file_ = nullptr;
};

/// Makes a folder and those above it. Throws SystemError.
void make_folder(const std::string& path);

}  // namespace scree
