#include "post/run/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/base/error.hpp"

namespace scree {

OutputFile::OutputFile(const std::string& path) : temporary_(path), file_(std::fopen(temporary_.name().c_str(), "wb")) {
  if (file_ == nullptr) throw SystemError("cannot create {}: {}; choose a folder that exists and is writable", path, std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
}

void OutputFile::add(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
    throw SystemError("cannot write {}: {}", temporary_.path(), std::strerror(errno));
}

void OutputFile::commit() {
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (!closed) throw SystemError("cannot write {}: {}", temporary_.path(), std::strerror(errno));
  temporary_.publish();
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path)) {
    throw SystemError("cannot make the folder {}: {}", path, error ? error.message() : "a file of that name exists");
  }
}

}  // namespace scree
