// HDF5 handles that own what they hold, and typed reads and writes of whole arrays.
//
// A constructor gives a valid handle or throws; a destructor never throws. Errors of the library become
// SystemError when writing and InputError when reading, with file and object named. HDF5 is used from one
// thread per rank. Collective (MPI) writing is in collective_file; everything here is serial.
#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/temporary_file.hpp"
#include "core/geometry/vec3.hpp"

namespace scree::h5 {

/// Move-only owner of an hid_t, closed by the function that fits its kind.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Closer closer, const std::string& what);
  Handle(Handle&& other) noexcept : id_(other.id_), closer_(other.closer_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }
  hid_t id() const { return id_; }
  bool is_open() const { return id_ >= 0; }
  void reset() noexcept;

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

template <class T>
hid_t native_type();
template <>
inline hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t native_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}
template <>
inline hid_t native_type<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}

class Group {
 public:
  Group(Handle handle, std::string path) : handle_(std::move(handle)), path_(std::move(path)) {}
  hid_t id() const { return handle_.id(); }
  const std::string& path() const { return path_; }

  bool has(const std::string& name) const;  ///< link or group of that name
  bool has_attribute(const std::string& name) const;
  Group create_group(const std::string& name) const;
  Group open_group(const std::string& name) const;  ///< throws InputError when it is missing
  std::int64_t child_count() const;                 ///< links; names of them sort as text, so what has numbers is opened by number

  // attributes
  void write_attribute(const std::string& name, const std::string& text) const;
  void write_attribute(const std::string& name, const char* text) const { write_attribute(name, std::string(text)); }
  void write_attribute(const std::string& name, double value) const;
  void write_attribute(const std::string& name, std::int64_t value) const;
  void write_attribute(const std::string& name, std::int32_t value) const { write_attribute(name, static_cast<std::int64_t>(value)); }
  std::string read_text_attribute(const std::string& name) const;
  double read_double_attribute(const std::string& name) const;
  std::int64_t read_integer_attribute(const std::string& name) const;

  // long text (provenance, settings) as a scalar string dataset
  void write_text(const std::string& name, const std::string& text) const;
  std::string read_text(const std::string& name) const;

  // arrays: rows x columns, row-major; columns 1 gives a one-dimensional dataset
  template <class T>
  void write_array(const std::string& name, std::span<const T> values, std::int64_t columns, const std::string& unit) const {
    write_raw(name, values.data(), static_cast<std::int64_t>(values.size()), columns, native_type<T>(), unit);
  }
  template <class T>
  void write_array(const std::string& name, const std::vector<T>& values, std::int64_t columns, const std::string& unit) const {
    write_array(name, std::span<const T>(values), columns, unit);
  }
  void write_array(const std::string& name, const std::vector<Vec3>& values, const std::string& unit) const {
    write_raw(name, values.data(), 3 * static_cast<std::int64_t>(values.size()), 3, H5T_NATIVE_DOUBLE, unit);
  }
  void write_array(const std::string& name, const std::vector<Quat>& values, const std::string& unit) const {
    write_raw(name, values.data(), 4 * static_cast<std::int64_t>(values.size()), 4, H5T_NATIVE_DOUBLE, unit);
  }
  /// Reads a whole dataset; throws InputError when it is missing, has another number of columns, or is truncated.
  template <class T>
  std::vector<T> read_array(const std::string& name, std::int64_t columns) const {
    std::vector<T> values(static_cast<std::size_t>(array_size(name, columns)));
    read_raw(name, values.data(), native_type<T>());
    return values;
  }
  std::vector<Vec3> read_vectors(const std::string& name) const {
    std::vector<Vec3> values(static_cast<std::size_t>(array_size(name, 3) / 3));
    read_raw(name, values.data(), H5T_NATIVE_DOUBLE);
    return values;
  }
  std::vector<Quat> read_quaternions(const std::string& name) const {
    std::vector<Quat> values(static_cast<std::size_t>(array_size(name, 4) / 4));
    read_raw(name, values.data(), H5T_NATIVE_DOUBLE);
    return values;
  }
  /// Rows of a dataset of one dimension.
  std::int64_t row_count(const std::string& name) const { return array_size(name, 1); }
  /// Reads `count` rows from row `first` on; T is Vec3, Quat or a number. Throws InputError when there are not so many.
  template <class T>
  std::vector<T> read_rows(const std::string& name, std::int64_t first, std::int64_t count) const {
    std::vector<T> values(static_cast<std::size_t>(count));
    if constexpr (std::is_same_v<T, Vec3>) {
      read_raw_rows(name, values.data(), first, count, 3, H5T_NATIVE_DOUBLE);
    } else if constexpr (std::is_same_v<T, Quat>) {
      read_raw_rows(name, values.data(), first, count, 4, H5T_NATIVE_DOUBLE);
    } else {
      read_raw_rows(name, values.data(), first, count, 1, native_type<T>());
    }
    return values;
  }

 private:
  std::int64_t array_size(const std::string& name, std::int64_t columns) const;  // elements
  void write_raw(const std::string& name, const void* data, std::int64_t count, std::int64_t columns, hid_t type,
                 const std::string& unit) const;
  void read_raw(const std::string& name, void* data, hid_t type) const;
  void read_raw_rows(const std::string& name, void* data, std::int64_t first, std::int64_t count, std::int64_t columns, hid_t type) const;

  Handle handle_;
  std::string path_;  // "file.h5:/group", for messages
};

/// A file written whole or not at all: under a temporary name beside the target, synced and renamed by
/// commit(). Destroyed without commit(), it removes the temporary file. Needs twice the file's size in memory.
class NewFile {
 public:
  explicit NewFile(const std::string& path);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  const Group& root() const { return *root_; }
  void commit();

 private:
  TemporaryFile temporary_;
  Handle file_;
  std::unique_ptr<Group> root_;
};

/// An existing file, read-only. Throws InputError when it is missing, not HDF5 or truncated.
class File {
 public:
  explicit File(const std::string& path);
  const Group& root() const { return *root_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Handle file_;
  std::unique_ptr<Group> root_;
};

/// Stops the library from printing its own error stack; ours names file and object. Called by every opener.
void silence_library();

/// Text of the library's current error stack, innermost message, for our own messages.
std::string library_error();

/// Writes a small text file whole or not at all.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace scree::h5
