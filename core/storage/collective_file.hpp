// A new HDF5 file that all ranks write together: whole under its name, or absent.
//
// Every rank hands in its own rows of each array. An array is one dataset, in which a rank owns a run of rows whose start is
// the prefix sum of the row counts.
//
// A full disk is the failure that is met in practice, and the one that parallel HDF5 takes badly: tried with Open MPI 4.1 and
// HDF5 1.10.8 on a full tmpfs, two ranks crash in the next collective call and four wait indefinitely. So rank 0 first makes the
// file as long as it can become, with space that is truly taken: reserved by the file system, or filled with zeros where it
// cannot reserve (ext2, ext3, NFS 3). When that fails, all ranks are told before HDF5 has begun. The file is cut to its length
// when it is closed. Errors that come later are collected, not thrown, until all ranks have made the same collective calls.
// Limits: a file system that writes each block to a new place (btrfs, ZFS) can still run full later; the watchdog of the
// solver then ends the wait.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/temporary_file.hpp"
#include "core/storage/h5.hpp"

namespace scree {

/// The rows of one distributed array: this rank's run and the whole.
struct Rows {
  std::int64_t local = 0, start = 0, total = 0;
};

/// The runs of all ranks, one after the other. Collective.
Rows distribute(MPI_Comm communicator, std::int64_t local);

/// Rank 0's text on every rank. Collective.
std::string broadcast_text(MPI_Comm communicator, std::string text);

class CollectiveFile {
 public:
  enum class Kind {
    plain,       ///< deflated where it pays; HDF5 begins at the first byte
    checksummed  ///< contiguous; the first 512 bytes (HDF5's user block) tell length and checksum: see check_checksum()
  };

  /// Makes the file under a temporary name with room for `bytes` of data, as rank 0 gives them. Collective.
  /// Fails: throws SystemError with the same text on every rank.
  CollectiveFile(MPI_Comm communicator, std::string path, std::int64_t bytes, Kind kind);
  CollectiveFile(const CollectiveFile&) = delete;
  CollectiveFile& operator=(const CollectiveFile&) = delete;
  /// The temporary file is removed when commit() was not reached.
  ~CollectiveFile();

  const h5::Group& root() const { return *root_; }

  /// Rows that a deflated array of so many takes on the disk when nothing in it can be compressed: whole chunks.
  static std::int64_t rows_on_disk(std::int64_t rows) {
    return rows <= kChunkRows ? rows : (rows + kChunkRows - 1) / kChunkRows * kChunkRows;
  }

  /// `rows.local` rows of this rank at `rows.start`. Collective.
  template <class T>
  void write(const h5::Group& group, const std::string& name, const std::vector<T>& values, Rows rows, const std::string& unit) {
    if constexpr (std::is_same_v<T, Vec3>) {
      write(group, name, values.data(), rows, 3, H5T_NATIVE_DOUBLE, unit);
    } else if constexpr (std::is_same_v<T, Quat>) {
      write(group, name, values.data(), rows, 4, H5T_NATIVE_DOUBLE, unit);
    } else {
      write(group, name, values.data(), rows, 1, h5::native_type<T>(), unit);
    }
  }
  void write(const h5::Group& group, const std::string& name, const void* data, Rows rows, std::int64_t columns, hid_t type,
             const std::string& unit);
  /// The same text on every rank, written by rank 0. Collective.
  void write_text(const h5::Group& group, const std::string& name, const std::string& text);

  /// Closes the file, adds the checksum, and gives it its name. Collective. Throws SystemError on every rank.
  void commit();

 private:
  static constexpr std::int64_t kChunkRows = 16384;  // a few hundred kB: good for deflate and for partial reads

  void close();
  void note(herr_t status, const std::string& what);

  MPI_Comm communicator_;
  int rank_ = 0;
  Kind kind_;
  std::string path_;
  std::unique_ptr<TemporaryFile> made_;  // of rank 0
  std::string temporary_;
  hid_t file_ = -1;  // not a Handle: closing it is collective and its failure must be heard
  h5::Handle transfer_;
  std::unique_ptr<h5::Group> root_;
  std::string error_;
};

/// Reads a `checksummed` file once, shared out among the ranks, before anything in it is believed. Collective.
/// Fails: throws InputError on every rank when it is missing, of another kind, truncated, or any bit is not as it was written.
void check_checksum(MPI_Comm communicator, const std::string& path);

}  // namespace scree
