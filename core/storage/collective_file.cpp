#include "core/storage/collective_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/storage/checksum.hpp"

namespace scree {

namespace {

constexpr std::int64_t kUserBlock = 512;            // [B] the smallest that HDF5 allows
constexpr std::int64_t kMetadataReserve = 1 << 17;  // [B] headers, attributes, chunk indices of some 40 datasets

int rank_of(MPI_Comm communicator) {
  int rank = 0;
  MPI_Comm_rank(communicator, &rank);
  return rank;
}

/// Throws an Error of type E with the same text on every rank when any rank has a message.
template <class E>
void agree(MPI_Comm communicator, std::string message) {
  const int rank = rank_of(communicator);
  int size = 1;
  MPI_Comm_size(communicator, &size);
  const int mine = message.empty() ? size : rank;
  int first = size;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, communicator);
  if (first == size) return;
  int count = static_cast<int>(message.size());
  MPI_Bcast(&count, 1, MPI_INT, first, communicator);
  message.resize(static_cast<std::size_t>(count));
  MPI_Bcast(message.data(), count, MPI_CHAR, first, communicator);
  throw E("{}{}", message, first == 0 ? "" : fmt::format(" (rank {})", first));
}

/// pwrite until everything is written. Returns 0 or the reason.
int write_all(int file, const char* data, std::int64_t bytes, std::int64_t at) {
  while (bytes > 0) {
    const ssize_t n = pwrite(file, data, static_cast<std::size_t>(bytes), at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    if (n == 0) return ENOSPC;
    data += n;
    at += n;
    bytes -= n;
  }
  return 0;
}

/// Takes the space of a file for good. Returns 0 or the reason.
int take_space(int file, std::int64_t bytes) {
  int reason = 0;
  do {
    reason = fallocate(file, 0, 0, bytes) == 0 ? 0 : errno;
  } while (reason == EINTR);
  if (reason != EOPNOTSUPP && reason != ENOSYS) return reason;
  // this file system cannot reserve: what is written is taken, once it is known to have arrived
  const std::vector<char> zeros(std::size_t{1} << 20);
  for (std::int64_t at = 0; at < bytes; at += static_cast<std::int64_t>(zeros.size())) {
    reason = write_all(file, zeros.data(), std::min(static_cast<std::int64_t>(zeros.size()), bytes - at), at);
    if (reason != 0) return reason;
  }
  while (fsync(file) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

/// The bytes of an HDF5 file with nothing in it.
std::vector<char> empty_file(const std::string& name, std::int64_t user_block) {
  const std::string what = "cannot prepare " + name;
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, what);
  H5Pset_fapl_core(access.id(), std::size_t{1} << 16, false);
  const h5::Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, what);
  H5Pset_userblock(creation.id(), static_cast<hsize_t>(user_block));
  const h5::Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, what);
  H5Fflush(file.id(), H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file.id(), nullptr, 0);
  if (size <= 0) throw SystemError("{}: {}", what, h5::library_error());
  std::vector<char> image(static_cast<std::size_t>(size));
  if (H5Fget_file_image(file.id(), image.data(), image.size()) != size) throw SystemError("{}: {}", what, h5::library_error());
  return image;
}

/// An empty HDF5 file that already has the length it may need at most. Returns what is wrong, or "".
std::string make_room(const std::string& temporary, const std::string& path, std::int64_t bytes, std::int64_t user_block) {
  const int file = open(temporary.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) {
    return fmt::format("cannot create {}: {}; choose a folder that exists and is writable", path, std::strerror(errno));
  }
  int reason = take_space(file, bytes);
  if (reason == 0) {
    std::vector<char> image;
    try {
      image = empty_file(temporary, user_block);
    } catch (const Error& error) {
      close(file);
      return error.what();
    }
    reason = write_all(file, image.data(), static_cast<std::int64_t>(image.size()), user_block);
  }
  if (close(file) != 0 && reason == 0) reason = errno;
  if (reason == 0) return "";
  return fmt::format("cannot write {}: {}; it needs up to {} bytes; free some space and restart from the last checkpoint", path,
                     std::strerror(reason), bytes);
}

/// The user block of a checksummed file.
std::string user_block_text(std::int64_t bytes, std::uint64_t checksum) {
  std::string text = fmt::format("scree-checksummed-file 1\nbytes {}\nchecksum {:016x}\n", bytes, checksum);
  text.resize(static_cast<std::size_t>(kUserBlock), '\n');
  return text;
}

/// Sum over all ranks of the checksum behind the user block. Collective. A rank that cannot read leaves a message.
std::uint64_t shared_checksum(MPI_Comm communicator, const std::string& path, std::int64_t bytes, std::string& problem) {
  int ranks = 1;
  MPI_Comm_size(communicator, &ranks);
  const std::int64_t words = (bytes - kUserBlock + 7) / 8, rank = rank_of(communicator);
  std::uint64_t sum = 0;
  try {
    const std::int64_t last = rank + 1 == ranks ? bytes : kUserBlock + 8 * (words * (rank + 1) / ranks);
    sum = checksum_of_range(path, kUserBlock + 8 * (words * rank / ranks), last);
  } catch (const Error& error) {
    problem = error.what();
  }
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, communicator);
  return sum;
}

}  // namespace

Rows distribute(MPI_Comm communicator, std::int64_t local) {
  Rows rows{local, 0, 0};
  MPI_Exscan(&local, &rows.start, 1, MPI_INT64_T, MPI_SUM, communicator);
  if (rank_of(communicator) == 0) rows.start = 0;
  MPI_Allreduce(&local, &rows.total, 1, MPI_INT64_T, MPI_SUM, communicator);
  return rows;
}

std::string broadcast_text(MPI_Comm communicator, std::string text) {
  std::int64_t count = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&count, 1, MPI_INT64_T, 0, communicator);
  text.resize(static_cast<std::size_t>(count));
  MPI_Bcast(text.data(), static_cast<int>(count), MPI_CHAR, 0, communicator);
  return text;
}

CollectiveFile::CollectiveFile(MPI_Comm communicator, std::string path, std::int64_t bytes, Kind kind)
    : communicator_(communicator), rank_(rank_of(communicator)), kind_(kind), path_(std::move(path)) {
  h5::silence_library();
  if (rank_ == 0) made_ = std::make_unique<TemporaryFile>(path_);
  temporary_ = broadcast_text(communicator, rank_ == 0 ? made_->name() : std::string());
  const std::int64_t user_block = kind == Kind::checksummed ? kUserBlock : 0;
  agree<SystemError>(communicator, rank_ == 0 ? make_room(temporary_, path_, bytes + kMetadataReserve, user_block) : "");
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, temporary_);
  H5Pset_fapl_mpio(access.id(), communicator, MPI_INFO_NULL);
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);  // a failed close must not leave the file half open
  transfer_ = h5::Handle(H5Pcreate(H5P_DATASET_XFER), H5Pclose, temporary_);
  H5Pset_dxpl_mpio(transfer_.id(), H5FD_MPIO_COLLECTIVE);
  file_ = H5Fopen(temporary_.c_str(), H5F_ACC_RDWR, access.id());
  agree<SystemError>(communicator, file_ < 0 ? "cannot create " + path_ + ": " + h5::library_error() : "");
  root_ = std::make_unique<h5::Group>(h5::Handle(H5Gopen2(file_, "/", H5P_DEFAULT), H5Gclose, temporary_), path_ + ":");
}

CollectiveFile::~CollectiveFile() { close(); }

void CollectiveFile::note(herr_t status, const std::string& what) {
  if (status < 0 && error_.empty()) error_ = what + ": " + h5::library_error();
}

void CollectiveFile::close() {
  root_.reset();
  if (file_ < 0) return;
  note(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush");
  note(H5Fclose(file_), "close");
  file_ = -1;
}

void CollectiveFile::write(const h5::Group& group, const std::string& name, const void* data, Rows rows, std::int64_t columns, hid_t type,
                           const std::string& unit) {
  const std::string what = group.path() + "/" + name;
  const hsize_t extent[2] = {static_cast<hsize_t>(rows.total), static_cast<hsize_t>(columns)};
  const int dimensions = columns == 1 ? 1 : 2;
  const h5::Handle space(H5Screate_simple(dimensions, extent, nullptr), H5Sclose, what);
  const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, what);
  H5Pset_fill_time(properties.id(), H5D_FILL_TIME_NEVER);  // every row is written below
  constexpr hsize_t kSmallestCompressed = 512;             // below this a chunk index costs more than it saves
  if (kind_ == Kind::plain && extent[0] >= kSmallestCompressed) {
    const hsize_t chunk[2] = {std::min(extent[0], hsize_t{kChunkRows}), extent[1]};
    H5Pset_chunk(properties.id(), dimensions, chunk);
    H5Pset_shuffle(properties.id());
    H5Pset_deflate(properties.id(), 1);
  }
  h5::Handle dataset(H5Dcreate2(group.id(), name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), H5Dclose,
                     "cannot create " + what);
  if (rows.total > 0) {
    const hsize_t start[2] = {static_cast<hsize_t>(rows.start), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(rows.local), extent[1]};
    const h5::Handle memory(H5Screate_simple(dimensions, count, nullptr), H5Sclose, what);
    if (rows.local > 0) {
      H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr);
    } else {
      H5Sselect_none(space.id());
      H5Sselect_none(memory.id());
    }
    const char nothing = 0;
    note(H5Dwrite(dataset.id(), type, memory.id(), space.id(), transfer_.id(), rows.local > 0 ? data : &nothing), what);
  }
  if (!unit.empty()) h5::Group(std::move(dataset), what).write_attribute("unit", unit);
}

void CollectiveFile::write_text(const h5::Group& group, const std::string& name, const std::string& text) {
  const std::string what = group.path() + "/" + name;
  const h5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose, what);
  H5Tset_size(type.id(), std::max<std::size_t>(text.size(), 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  const h5::Handle space(H5Screate(H5S_SCALAR), H5Sclose, what);
  const h5::Handle dataset(H5Dcreate2(group.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
                           "cannot create " + what);
  const h5::Handle memory(H5Screate(H5S_SCALAR), H5Sclose, what);
  if (rank_ != 0) {
    H5Sselect_none(space.id());
    H5Sselect_none(memory.id());
  }
  note(H5Dwrite(dataset.id(), type.id(), memory.id(), space.id(), transfer_.id(), text.empty() ? "" : text.c_str()), what);
}

void CollectiveFile::commit() {
  close();
  const auto message = [&](const std::string& problem) { return problem.empty() ? problem : "cannot write " + path_ + ": " + problem; };
  agree<SystemError>(communicator_, message(error_));
  std::string problem;
  if (kind_ == Kind::checksummed) {
    std::error_code error;
    std::int64_t bytes = rank_ == 0 ? static_cast<std::int64_t>(std::filesystem::file_size(temporary_, error)) : 0;
    if (error) problem = error.message();
    MPI_Bcast(&bytes, 1, MPI_INT64_T, 0, communicator_);
    const std::uint64_t checksum = shared_checksum(communicator_, temporary_, bytes, problem);
    if (rank_ == 0 && problem.empty()) {
      const std::string block = user_block_text(bytes, checksum);
      const int file = open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
      int reason = file < 0 ? errno : write_all(file, block.data(), kUserBlock, 0);
      if (file >= 0 && ::close(file) != 0 && reason == 0) reason = errno;
      if (reason != 0) problem = std::strerror(reason);
    }
    agree<SystemError>(communicator_, message(problem));
  }
  if (rank_ == 0) {
    try {
      made_->publish();
    } catch (const SystemError& error) {
      problem = error.what();
    }
  }
  agree<SystemError>(communicator_, problem);
}

void check_checksum(MPI_Comm communicator, const std::string& path) {
  const bool root = rank_of(communicator) == 0;
  std::string problem, block(static_cast<std::size_t>(kUserBlock), '\0');
  std::int64_t bytes = 0;
  if (root) {
    std::error_code error;
    bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
    const int file = error ? -1 : open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
      problem = fmt::format("{}: {}", path, error ? error.message() : std::strerror(errno));
    } else {
      const ssize_t got = pread(file, block.data(), block.size(), 0);
      ::close(file);
      const std::string opening = user_block_text(0, 0).substr(0, user_block_text(0, 0).find('\n') + 1);
      long long promised = 0;
      if (got < 0 || !block.starts_with(opening) || std::sscanf(block.c_str() + opening.size(), "bytes %lld", &promised) != 1) {
        problem = fmt::format("{}: does not begin with \"{}\"; it is damaged, of another kind, or of an older version", path,
                              opening.substr(0, opening.size() - 1));
      } else if (bytes < promised) {
        problem = fmt::format("{}: truncated: {} bytes found, {} expected", path, bytes, promised);
      }
    }
  }
  agree<InputError>(communicator, problem);
  MPI_Bcast(&bytes, 1, MPI_INT64_T, 0, communicator);
  const std::uint64_t checksum = shared_checksum(communicator, path, bytes, problem);
  if (root && problem.empty() && block != user_block_text(bytes, checksum)) {
    problem = fmt::format("{}: damaged: its contents do not match their checksum", path);
  }
  agree<InputError>(communicator, problem);
}

}  // namespace scree
