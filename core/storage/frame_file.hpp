// frame_000123.hdf: one output frame, a valid VTKHDF 1.0 UnstructuredGrid of points that ParaView 5.11 and
// newer open directly, with contacts and wall state in extra groups. The page of the format is RUN_FORMAT.md.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

inline constexpr const char* kFrameFormat = "scree-frame";
inline constexpr std::int64_t kFrameFormatVersion = 1;

/// Bodies of one frame, in any order when written (each rank gives its own), by ascending id when read.
struct FrameBodies {
  std::vector<std::int64_t> id;
  std::vector<std::int32_t> shape, material, rank;
  std::vector<double> scale;
  std::vector<Vec3> position;          ///< [m], world
  std::vector<Quat> orientation;       ///< mesh axes to world, w x y z
  std::vector<Vec3> velocity;          ///< [m/s]
  std::vector<Vec3> angular_velocity;  ///< [rad/s], world
  std::size_t size() const { return id.size(); }
};

/// Contacts of one frame. a < b, normal from b to a, force on a.
struct FrameContacts {
  std::vector<std::int64_t> body_a, body_b;
  std::vector<std::int64_t> feature;   ///< key, unique within the body pair
  std::vector<Vec3> point;             ///< [m]
  std::vector<Vec3> normal;            ///< unit
  std::vector<double> overlap;         ///< [m], margin sum minus gap
  std::vector<double> margin;          ///< [m], margin sum
  std::vector<double> normal_force;    ///< [N], on a along the normal
  std::vector<Vec3> tangential_force;  ///< [N], on a
  std::size_t size() const { return body_a.size(); }
};

struct FrameWalls {
  std::vector<std::int64_t> id;
  std::vector<Vec3> position;  ///< displacement of the wall's frame [m]
  std::vector<Quat> orientation;
  std::vector<Vec3> force, torque;  ///< on the wall, torque about the world origin [N], [N m]
};

struct Frame {
  std::int64_t number = 0, step = 0;
  double time = 0;                                                 ///< [s]
  double kinetic = 0, potential = 0, elastic = 0, dissipated = 0;  ///< [J], whole scene
  FrameBodies bodies;
  FrameContacts contacts;
  FrameWalls walls;
  nlohmann::json provenance;
};

/// Collective: every rank gives its own bodies and contacts (possibly none); walls and scalars are rank 0's.
/// Written under a temporary name and renamed by rank 0 when complete. Throws SystemError on every rank.
void write_frame_file(MPI_Comm communicator, const std::string& path, const Frame& frame);

/// Serial. Bodies come sorted by id, contacts by (a, b, feature). Throws InputError when damaged.
Frame read_frame_file(const std::string& path);

struct FrameEntry {
  std::string path;  ///< full
  double time = 0;
};
/// The frames of a run folder as frames.hdf.series lists them, ascending in time. Throws InputError.
std::vector<FrameEntry> list_frames(const std::string& run_folder);
/// Writes frames.hdf.series whole or not at all (rank 0 only). Names are relative to the run folder.
void write_frame_series(const std::string& run_folder, const std::vector<FrameEntry>& frames);

}  // namespace scree
