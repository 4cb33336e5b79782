#include "core/storage/h5.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/base/near_file.hpp"
#include "core/storage/h5_crash.hpp"

namespace scree::h5 {

namespace {

herr_t keep_innermost(unsigned /*n*/, const H5E_error2_t* error, void* text) {
  // Walked upward: the first entry is where the failure happened.
  auto* message = static_cast<std::string*>(text);
  if (message->empty() && error->desc != nullptr) *message = error->desc;
  return 0;
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw SystemError("{}: {}", what, library_error());
}

/// Handle of an object of a file that is read: what cannot be opened is the file's fault.
Handle readable(hid_t id, Handle::Closer closer, const std::string& where) {
  if (id < 0) throw InputError("{} cannot be opened: {}; the file is damaged", where, library_error());
  return Handle(id, closer, where);
}

/// Writes a file and gives it its name; throws when the disk refuses.
void write_whole(TemporaryFile& temporary, const char* data, std::size_t size) {
  std::FILE* file = std::fopen(temporary.name().c_str(), "wb");
  if (file == nullptr) throw SystemError("cannot create {}: {}", temporary.path(), std::strerror(errno));
  errno = 0;
  const bool written = std::fwrite(data, 1, size, file) == size;
  int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (reason == 0) reason = errno;
  if (!written || !closed)
    throw SystemError("cannot write {}: {}; free some space or choose another folder", temporary.path(), std::strerror(reason));
  temporary.publish();
}

}  // namespace

void silence_library() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::string library_error() {
  std::string message;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &message);
  H5Eclear2(H5E_DEFAULT);
  return message.empty() ? "unknown HDF5 error" : message;
}

Handle::Handle(hid_t id, Closer closer, const std::string& what) : id_(id), closer_(closer) {
  if (id_ < 0) throw SystemError("{}: {}", what, library_error());
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = other.id_;
    closer_ = other.closer_;
    other.id_ = -1;
  }
  return *this;
}

void Handle::reset() noexcept {
  if (id_ >= 0 && closer_ != nullptr) closer_(id_);
  id_ = -1;
}

bool Group::has(const std::string& name) const { return H5Lexists(id(), name.c_str(), H5P_DEFAULT) > 0; }
bool Group::has_attribute(const std::string& name) const { return H5Aexists(id(), name.c_str()) > 0; }

Group Group::create_group(const std::string& name) const {
  const std::string where = path_ + "/" + name;
  return {Handle(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "cannot create " + where), where};
}

Group Group::open_group(const std::string& name) const {
  if (!has(name)) throw InputError("{}: the group '{}' is missing; the file is damaged or of another kind", path_, name);
  const std::string where = path_ + "/" + name;
  return {readable(H5Gopen2(id(), name.c_str(), H5P_DEFAULT), H5Gclose, where), where};
}

std::int64_t Group::child_count() const {
  H5G_info_t info;
  if (H5Gget_info(id(), &info) < 0) throw InputError("{} cannot be listed: {}; the file is truncated or damaged", path_, library_error());
  return static_cast<std::int64_t>(info.nlinks);
}

void Group::write_attribute(const std::string& name, const std::string& text) const {
  const std::string what = "cannot write attribute " + path_ + "@" + name;
  // Fixed-length ASCII: the only string attribute that VTK's reader accepts.
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, what);
  check(H5Tset_size(type.id(), text.empty() ? 1 : text.size()), what);
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), what);
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, what);
  Handle attribute(H5Acreate2(id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, what);
  check(H5Awrite(attribute.id(), type.id(), text.empty() ? "" : text.c_str()), what);
}

void Group::write_attribute(const std::string& name, double value) const {
  const std::string what = "cannot write attribute " + path_ + "@" + name;
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, what);
  Handle attribute(H5Acreate2(id(), name.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, what);
  check(H5Awrite(attribute.id(), H5T_NATIVE_DOUBLE, &value), what);
}

void Group::write_attribute(const std::string& name, std::int64_t value) const {
  const std::string what = "cannot write attribute " + path_ + "@" + name;
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, what);
  Handle attribute(H5Acreate2(id(), name.c_str(), H5T_STD_I64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose, what);
  check(H5Awrite(attribute.id(), H5T_NATIVE_INT64, &value), what);
}

namespace {

/// What a value in a file is, whatever its width.
enum class Content { text, number, whole_number };

const char* name_of(H5T_class_t type) {
  switch (type) {
    case H5T_INTEGER:
      return "whole numbers";
    case H5T_FLOAT:
      return "floating-point numbers";
    case H5T_STRING:
      return "texts";
    case H5T_COMPOUND:
      return "compound values";
    case H5T_ENUM:
      return "words of an enumeration";
    default:
      return "values of another kind";
  }
}

/// Refuses what has not the class of what is wanted: the library would convert it in silence where it can, or write beyond the memory
/// that is meant for it.
void expect_content(hid_t type, Content content, const std::string& where) {
  const H5T_class_t found = H5Tget_class(type);
  if (content == Content::text) {
    if (found != H5T_STRING || H5Tis_variable_str(type) > 0) throw InputError("{} is not a fixed-length text; the file is damaged", where);
    return;
  }
  if (found == H5T_INTEGER || (content == Content::number && found == H5T_FLOAT)) return;
  throw InputError("{} has {}, {} expected; the file is damaged", where, name_of(found),
                   content == Content::number ? "numbers" : "whole numbers");
}

/// Refuses a dataset that cannot be read into such memory without a loss: numbers with a fraction as whole numbers.
void expect_memory_type(const Handle& dataset, hid_t memory_type, const std::string& where) {
  const Handle type(H5Dget_type(dataset.id()), H5Tclose, where);
  expect_content(type.id(), H5Tget_class(memory_type) == H5T_INTEGER ? Content::whole_number : Content::number, where);
}

/// Refuses a size that the file itself cannot hold, which a damaged header can ask for.
void expect_bytes(hid_t object, double bytes, double most_per_byte, const std::string& where) {
  const Handle file(H5Iget_file_id(object), H5Fclose, where);
  hsize_t file_bytes = 0;
  check(H5Fget_filesize(file.id(), &file_bytes), where);
  if (bytes > most_per_byte * static_cast<double>(file_bytes))
    throw InputError("{}: {:.0f} bytes found, more than the file can hold; it is damaged", where, bytes);
}

/// Reads the one value of an attribute or of a dataset: `take` is given its type once class, size and space are what is wanted.
template <class Take>
void read_one(hid_t object, hid_t object_type, hid_t object_space, Content content, const std::string& where, Take&& take) {
  const Handle type(object_type, H5Tclose, where), space(object_space, H5Sclose, where);
  const hssize_t values = H5Sget_simple_extent_npoints(space.id());
  if (values != 1) throw InputError("{} has {} values, one expected; the file is damaged", where, values);
  expect_content(type.id(), content, where);
  expect_bytes(object, static_cast<double>(H5Tget_size(type.id())), 1, where);
  if (take(type.id()) < 0) throw InputError("{}: {}; the file is truncated or damaged", where, library_error());
}

/// The only way to read an attribute.
template <class Take>
void read_attribute(const Group& group, const std::string& name, Content content, Take&& take) {
  if (!group.has_attribute(name)) {
    throw InputError("{}: the attribute '{}' is missing; the file is damaged or of another kind", group.path(), name);
  }
  const std::string where = group.path() + "@" + name;
  const Handle attribute = readable(H5Aopen(group.id(), name.c_str(), H5P_DEFAULT), H5Aclose, where);
  read_one(attribute.id(), H5Aget_type(attribute.id()), H5Aget_space(attribute.id()), content, where,
           [&](hid_t type) { return take(attribute.id(), type); });
}

Handle open_dataset(const Group& group, const std::string& name) {
  if (!group.has(name)) throw InputError("{}: the dataset '{}' is missing; the file is damaged or of another kind", group.path(), name);
  return readable(H5Dopen2(group.id(), name.c_str(), H5P_DEFAULT), H5Dclose, group.path() + "/" + name);
}

}  // namespace

std::string Group::read_text_attribute(const std::string& name) const {
  std::string text;
  read_attribute(*this, name, Content::text, [&](hid_t attribute, hid_t type) {
    text.resize(H5Tget_size(type));
    return H5Aread(attribute, type, text.data());
  });
  return text.substr(0, text.find('\0'));
}

double Group::read_double_attribute(const std::string& name) const {
  double value = 0;
  read_attribute(*this, name, Content::number, [&](hid_t attribute, hid_t) { return H5Aread(attribute, H5T_NATIVE_DOUBLE, &value); });
  return value;
}

std::int64_t Group::read_integer_attribute(const std::string& name) const {
  std::int64_t value = 0;
  read_attribute(*this, name, Content::whole_number, [&](hid_t attribute, hid_t) { return H5Aread(attribute, H5T_NATIVE_INT64, &value); });
  return value;
}

void Group::write_text(const std::string& name, const std::string& text) const {
  const std::string what = "cannot write " + path_ + "/" + name;
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, what);
  check(H5Tset_size(type.id(), text.empty() ? 1 : text.size()), what);
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), what);
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), what);
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, what);
  Handle dataset(H5Dcreate2(id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, what);
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.empty() ? "" : text.c_str()), what);
}

std::string Group::read_text(const std::string& name) const {
  const Handle dataset = open_dataset(*this, name);
  std::string text;
  read_one(dataset.id(), H5Dget_type(dataset.id()), H5Dget_space(dataset.id()), Content::text, path_ + "/" + name, [&](hid_t type) {
    text.resize(H5Tget_size(type));
    return H5Dread(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  });
  return text.substr(0, text.find('\0'));
}

std::int64_t Group::array_size(const std::string& name, std::int64_t columns) const {
  const Handle dataset = open_dataset(*this, name);
  const std::string where = path_ + "/" + name;
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, where), type(H5Dget_type(dataset.id()), H5Tclose, where);
  const int rank = H5Sget_simple_extent_ndims(space.id());
  hsize_t extent[2] = {0, 1};
  if (rank < 1 || rank > 2) throw InputError("{}: {} dimensions found, 1 or 2 expected", where, rank);
  H5Sget_simple_extent_dims(space.id(), extent, nullptr);
  const std::int64_t found = rank == 1 ? 1 : static_cast<std::int64_t>(extent[1]);
  if (found != columns) throw InputError("{}: {} columns found, {} expected", where, found, columns);
  expect_content(type.id(), Content::number, where);
  // no file holds more than deflate can press into it
  constexpr double kMaxDeflated = 1032;  // RFC 1951: 258 bytes from two bits, at best
  expect_bytes(dataset.id(), static_cast<double>(extent[0]) * static_cast<double>(columns) * static_cast<double>(H5Tget_size(type.id())),
               kMaxDeflated, where);
  return static_cast<std::int64_t>(extent[0]) * columns;
}

void Group::write_raw(const std::string& name, const void* data, std::int64_t count, std::int64_t columns, hid_t type,
                      const std::string& unit) const {
  const std::string what = "cannot write " + path_ + "/" + name;
  const hsize_t extent[2] = {static_cast<hsize_t>(count / columns), static_cast<hsize_t>(columns)};
  const int rank = columns == 1 ? 1 : 2;
  Handle space(H5Screate_simple(rank, extent, nullptr), H5Sclose, what);
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, what);
  constexpr hsize_t kChunkRows = 16384;         // a chunk of a few hundred kB: good for deflate and for partial reads
  constexpr hsize_t kSmallestCompressed = 512;  // below this a chunk index costs more than it saves
  if (extent[0] >= kSmallestCompressed) {
    const hsize_t chunk[2] = {std::min(extent[0], kChunkRows), extent[1]};
    check(H5Pset_chunk(properties.id(), rank, chunk), what);
    check(H5Pset_shuffle(properties.id()), what);
    check(H5Pset_deflate(properties.id(), 1), what);
  }
  Handle dataset(H5Dcreate2(id(), name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Dclose, what);
  if (count > 0) check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), what);
  if (!unit.empty()) {
    const Group attributes(std::move(dataset), path_ + "/" + name);
    attributes.write_attribute("unit", unit);
  }
}

void Group::read_raw(const std::string& name, void* data, hid_t type) const {
  const std::string what = "cannot read " + path_ + "/" + name;
  const Handle dataset = open_dataset(*this, name);
  expect_memory_type(dataset, type, path_ + "/" + name);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, what);
  if (H5Sget_simple_extent_npoints(space.id()) == 0) return;
  if (H5Dread(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0) {
    throw InputError("{}: {}; the file is truncated or damaged", what, library_error());
  }
}

void Group::read_raw_rows(const std::string& name, void* data, std::int64_t first, std::int64_t count, std::int64_t columns,
                          hid_t type) const {
  const std::int64_t rows = array_size(name, columns) / columns;
  if (first < 0 || count < 0 || first > rows || count > rows - first)
    throw InputError("{}/{}: {} rows found, {} from row {} on expected; the file is damaged", path_, name, rows, count, first);
  if (count == 0) return;
  const std::string what = "cannot read " + path_ + "/" + name;
  const Handle dataset = open_dataset(*this, name);
  expect_memory_type(dataset, type, path_ + "/" + name);
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, what);
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  const hsize_t start[2] = {static_cast<hsize_t>(first), 0}, extent[2] = {static_cast<hsize_t>(count), static_cast<hsize_t>(columns)};
  const Handle memory(H5Screate_simple(dimensions, extent, nullptr), H5Sclose, what);
  check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, extent, nullptr), what);
  if (H5Dread(dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, data) < 0) {
    throw InputError("{}: {}; the file is truncated or damaged", what, library_error());
  }
}

// The library works in memory, and the finished image is written here. On a full disk HDF5 1.10.8 cannot close
// a file whose last flush failed, keeps it open inside and crashes when it ends (a tmpfs of 8 kB shows it).
NewFile::NewFile(const std::string& path) : temporary_(path) {
  silence_library();
  set_opened("");  // no file that was read is to blame for a crash as this one is written
  // made now, so that a folder that is missing or not writable is told before the work
  const int probe = open(temporary_.name().c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (probe < 0) throw SystemError("cannot create {}: {}; choose a folder that exists and is writable", path, std::strerror(errno));
  close(probe);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, path);
  constexpr std::size_t kGrowth = std::size_t{1} << 22;  // of the image, at a time
  check(H5Pset_fapl_core(access.id(), kGrowth, false), "cannot prepare " + path);
  file_ = Handle(H5Fcreate(temporary_.name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, "cannot create " + path);
  root_ = std::make_unique<Group>(Handle(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose, path), path + ":");
}

void NewFile::commit() {
  root_.reset();
  const std::string what = "cannot write " + temporary_.path();
  check(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), what);
  const ssize_t size = H5Fget_file_image(file_.id(), nullptr, 0);
  std::vector<char> image(size > 0 ? static_cast<std::size_t>(size) : 0);
  if (size <= 0 || H5Fget_file_image(file_.id(), image.data(), image.size()) != size) throw SystemError("{}: {}", what, library_error());
  file_.reset();
  write_whole(temporary_, image.data(), image.size());
}

namespace {

/// A mesh where a file of Scree is expected: the way from the one to the other.
std::string advice_for_mesh(const std::string& path) {
  const std::filesystem::path file(path);
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".toml") {
    return fmt::format("; a case is packed first: scree-decomposer pack {} -o {}, and that file is named here", path,
                       (file.parent_path() / file.stem()).string() + ".scene.h5");
  }
  const std::array<const char*, 8> meshes{".stl", ".obj", ".ply", ".off", ".3ds", ".dae", ".step", ".stp"};
  if (std::find(meshes.begin(), meshes.end(), ending) == meshes.end()) return "";
  return fmt::format(
      "; import the mesh first: scree-mesher import {} -o {} (with --unit mm where its numbers are millimetres, with --surface "
      "for an open wall), and name that file",
      path, (file.parent_path() / file.stem()).string() + ".shape.h5");
}

}  // namespace

File::File(const std::string& path) : path_(path) {
  silence_library();
  std::error_code failed;  // of a name that is too long, for one
  if (!std::filesystem::exists(path, failed))
    throw InputError("{}: {}{}", path, failed ? failed.message() : "no such file", near_file(path));
  if (std::filesystem::is_directory(path, failed)) throw InputError("{}: is a folder, an HDF5 file was expected", path);
  set_opened(path);
  if (H5Fis_hdf5(path.c_str()) <= 0) throw InputError("{}: not an HDF5 file, or truncated at its start{}", path, advice_for_mesh(path));
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) throw InputError("{}: cannot be opened: {}; the file is truncated or damaged, make it again", path, library_error());
  file_ = Handle(id, H5Fclose, path);
  root_ = std::make_unique<Group>(readable(H5Gopen2(id, "/", H5P_DEFAULT), H5Gclose, path), path + ":");
}

void write_text_file(const std::string& path, const std::string& text) {
  TemporaryFile temporary(path);
  write_whole(temporary, text.data(), text.size());
}

}  // namespace scree::h5
