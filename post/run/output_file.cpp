#include "post/run/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"

namespace scree {

OutputFile::OutputFile(std::string path)
    : path_(std::move(path)), temporary_(h5::temporary_name(path_)), interrupted_(std::in_place, temporary_) {
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) {
    throw SystemError("cannot create {}: {}; choose a folder that exists and is writable", path_, std::strerror(errno));
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void OutputFile::add(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) throw SystemError("cannot write {}: {}", path_, std::strerror(errno));
}

void OutputFile::commit() {
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (!closed) throw SystemError("cannot write {}: {}", path_, std::strerror(errno));
  h5::publish_file(temporary_, path_);
  temporary_.clear();
  interrupted_.reset();
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path)) {
    throw SystemError("cannot make the folder {}: {}", path, error ? error.message() : "a file of that name exists");
  }
}

}  // namespace scree
