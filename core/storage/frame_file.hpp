// frame_000123.hdf: one output frame, a valid VTKHDF 1.0 UnstructuredGrid of points that ParaView 5.11 and
// newer open directly, with contacts and wall state in extra groups. The page of the format is RUN_FORMAT.md.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/json_record.hpp"
#include "core/geometry/vec3.hpp"
#include "core/storage/frame_columns.hpp"

namespace scree {

inline constexpr const char* kFrameFormat = "scree-frame";
inline constexpr std::int64_t kFrameFormatVersion = 1;

/// A column of bodies, contacts or walls, for what goes over all of them.
template <class Rows, class T>
struct FrameColumn {
  using Value = T;
  const char* name;       ///< of the member
  std::string_view path;  ///< in the file
  const char* unit;
  std::string_view csv;
  unsigned uses;  ///< see FrameUse
  std::vector<T> Rows::*column;
  std::string_view group() const { return path.substr(0, path.rfind('/')); }
  std::string_view dataset() const { return path.substr(path.rfind('/') + 1); }
};

#define SCREE_FRAME_MEMBER(type, name, path, unit, csv, uses, what) std::vector<type> name;
#define SCREE_FRAME_STORED_MEMBER(type, name, member, path, unit, csv, uses, what) std::vector<type> name;
#define SCREE_FRAME_VISIT(type, name, path, unit, csv, uses, what) \
  action(FrameColumn<Self, type>{#name, path, unit, csv, uses, &Self::name});
#define SCREE_FRAME_STORED_VISIT(type, name, member, path, unit, csv, uses, what) SCREE_FRAME_VISIT(type, name, path, unit, csv, uses, what)

/// Bodies of one frame, in any order when written (each rank gives its own), by ascending id when read.
struct FrameBodies {
  SCREE_FRAME_BODIES(SCREE_FRAME_STORED_MEMBER, SCREE_FRAME_MEMBER)
  bool has_temperature = false;  ///< whether the scene has heat, the same on every rank; else temperatures are 0 and not in files
  std::size_t size() const { return id.size(); }
  /// Whether files have this column.
  template <class Column>
  bool has(const Column& column) const {
    return (column.uses & kOfHeat) == 0 || has_temperature;
  }
  /// Calls action(FrameColumn) for every column, in the order of the table.
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameBodies;
    SCREE_FRAME_BODIES(SCREE_FRAME_STORED_VISIT, SCREE_FRAME_VISIT)
  }
};

/// Whether files of these rows have a column: all of a table that has nothing to say of it.
template <class Table, class Column>
bool has_column(const Table& table, const Column& column) {
  if constexpr (requires { table.has(column); })
    return table.has(column);
  else
    return true;
}

/// Contacts of one frame, in any order when written, by (a, b, feature) when read.
struct FrameContacts {
  SCREE_FRAME_CONTACTS(SCREE_FRAME_MEMBER)
  std::size_t size() const { return body_a.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameContacts;
    SCREE_FRAME_CONTACTS(SCREE_FRAME_VISIT)
  }
};

/// Bonds that hold, in any order when written, by their rows in the scene when read.
struct FrameBonds {
  SCREE_FRAME_BONDS(SCREE_FRAME_MEMBER)
  std::size_t size() const { return bond.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameBonds;
    SCREE_FRAME_BONDS(SCREE_FRAME_VISIT)
  }
};

/// Walls of one frame, in the order of the scene.
struct FrameWalls {
  SCREE_FRAME_WALLS(SCREE_FRAME_MEMBER)
  std::size_t size() const { return id.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameWalls;
    SCREE_FRAME_WALLS(SCREE_FRAME_VISIT)
  }
};
/// Triangles of walls with load maps, in the order of the walls and of their meshes.
struct FrameLoads {
  SCREE_FRAME_LOADS(SCREE_FRAME_MEMBER)
  std::size_t size() const { return wall.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameLoads;
    SCREE_FRAME_LOADS(SCREE_FRAME_VISIT)
  }
};
/// Vertices of walls that wear, in the order of the walls and of their meshes.
struct FrameWear {
  SCREE_FRAME_WEAR(SCREE_FRAME_MEMBER)
  std::size_t size() const { return wall.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameWear;
    SCREE_FRAME_WEAR(SCREE_FRAME_VISIT)
  }
};
/// The periodic cell where it deforms: one row.
struct FrameCell {
  SCREE_FRAME_CELL(SCREE_FRAME_MEMBER)
  std::size_t size() const { return lower.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameCell;
    SCREE_FRAME_CELL(SCREE_FRAME_VISIT)
  }
};
/// Bins of energy that have impacts, by pair of materials.
struct FrameImpacts {
  SCREE_FRAME_IMPACTS(SCREE_FRAME_MEMBER)
  std::size_t size() const { return material_a.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameImpacts;
    SCREE_FRAME_IMPACTS(SCREE_FRAME_VISIT)
  }
};
/// What contacts have dissipated, by pair of materials.
struct FrameLosses {
  SCREE_FRAME_LOSSES(SCREE_FRAME_MEMBER)
  std::size_t size() const { return material_a.size(); }
  template <class Action>
  static void visit(Action&& action) {
    using Self = FrameLosses;
    SCREE_FRAME_LOSSES(SCREE_FRAME_VISIT)
  }
};
#undef SCREE_FRAME_MEMBER
#undef SCREE_FRAME_STORED_MEMBER
#undef SCREE_FRAME_VISIT
#undef SCREE_FRAME_STORED_VISIT

/// What a frame has once. Plain data.
struct FrameScalars {
#define SCREE_FRAME_SCALAR(type, name, unit, what) type name = 0;
  SCREE_FRAME_SCALARS(SCREE_FRAME_SCALAR)
#undef SCREE_FRAME_SCALAR
  /// Calls action(name, value) for every one, of a constant or of one that is read.
  template <class Scalars, class Action>
  static void visit(Scalars& scalars, Action&& action) {
#define SCREE_FRAME_SCALAR(type, name, unit, what) action(#name, scalars.name);
    SCREE_FRAME_SCALARS(SCREE_FRAME_SCALAR)
#undef SCREE_FRAME_SCALAR
  }
};

struct Frame : FrameScalars {
  FrameBodies bodies;
  FrameContacts contacts;
  FrameWalls walls;
  FrameLoads loads;        ///< empty where no wall has a load map
  FrameImpacts impacts;    ///< empty before the first impact, and where none are recorded
  FrameLosses losses;      ///< empty where impacts are not recorded
  FrameWear wear;          ///< empty where no wall wears
  FrameCell cell;          ///< empty where the domain stays as it is
  bool has_bonds = false;  ///< whether the scene has bonds, broken ones included; the same on every rank
  FrameBonds bonds;
  JsonRecord provenance;
};

/// The components of a value, as tables and ParaView files have them.
template <class T>
constexpr int component_count = std::is_same_v<T, Vec3>   ? 3
                                : std::is_same_v<T, Quat> ? 4
                                                          : 1;
template <class T>
auto component(const T& value, int k) {
  if constexpr (std::is_same_v<T, Vec3>) {
    return value[k];
  } else if constexpr (std::is_same_v<T, Quat>) {
    return k == 0 ? value.w : k == 1 ? value.x : k == 2 ? value.y : value.z;
  } else {
    return value;
  }
}

/// Leaves the rows with these indices, in this order; an index may come once.
template <class Rows>
void take_rows(Rows& rows, const std::vector<std::size_t>& indices) {
  Rows::visit([&](const auto& c) {
    auto& values = rows.*c.column;
    if (values.empty()) return;  // a column that the scene does not have
    std::decay_t<decltype(values)> taken;
    taken.reserve(indices.size());
    for (const std::size_t i : indices) taken.push_back(values[i]);
    values = std::move(taken);
  });
}

/// Collective: every rank gives its own bodies and contacts (possibly none); walls, loads, impacts, losses, wear, cell and scalars are rank
/// 0's. Written under a temporary name and renamed by rank 0 when complete. Throws SystemError on every rank.
void write_frame_file(MPI_Comm communicator, const std::string& path, const Frame& frame);

/// What rows of bodies and contacts take in a file, as if nothing in it could be compressed.
std::int64_t frame_rows_bytes(std::int64_t bodies, std::int64_t contacts);

/// Which parts of a frame are read: all, or bodies and walls without contacts, loads and bonds, which are most of a file.
enum class FrameParts { all, bodies };

/// Serial. Bodies come sorted by id, contacts by (a, b, feature). Throws InputError when damaged.
Frame read_frame_file(const std::string& path, FrameParts parts = FrameParts::all);

struct FrameEntry {
  std::string path;  ///< full
  double time = 0;
};
/// The frames of a run folder as frames.hdf.series lists them, ascending in time. Throws InputError.
std::vector<FrameEntry> list_frames(const std::string& run_folder);
/// Writes frames.hdf.series whole or not at all (rank 0 only). Names are relative to the run folder.
void write_frame_series(const std::string& run_folder, const std::vector<FrameEntry>& frames);

}  // namespace scree
