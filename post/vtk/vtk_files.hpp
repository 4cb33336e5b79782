// VTK files of one frame: what ParaView and other readers open. Present only in builds with VTK.
//
// All are XML PolyData (.vtp), version 1, appended raw, zlib at its fastest: every reader of VTK has it. Points are float32.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/wall_loads.hpp"

namespace scree {

/// One mesh. Throws SystemError when it cannot be written, as all functions here.
void write_mesh_vtp(const std::string& path, const DrawnMesh& mesh);

/// All walls in one file; cell data "wall" is the wall's id, and where walls have load maps those of kLoadQuantities (float32, 0 on walls
/// without one).
void write_walls_vtp(const std::string& path, const Scene& scene, const std::vector<TriangleMesh>& walls,
                     const std::vector<WallPlace>& places, const std::vector<WallLoads>& loads);

/// Every body's own triangles in world coordinates; cell data id (int64), shape, material, rank (int32), velocity (3 x
/// float32) and speed (float32) [m/s]. In scenes with bonds also fragment (int64, see fragment_ids) and the point data apart (3 x
/// float32 [m], see ways_apart).   Cost: bodies x triangles in memory.
void write_surfaces_vtp(const std::string& path, const Frame& frame, const Scene& scene, const std::vector<DrawnMesh>& shapes);

/// One point per body, to put glyphs on: id (int64), shape, material, rank (int32), scale, quat (w x y z), velocity,
/// angular_velocity, speed (float32).
void write_bodies_vtp(const std::string& path, const FrameBodies& bodies);

/// One point per contact point: body_a, body_b (int64), normal (from b to a), overlap, normal_force, force (on a, whole),
/// tangential_force (float32). SI.
void write_contacts_vtp(const std::string& path, const FrameContacts& contacts);

/// The faces of the bonds that hold, as rectangles (BondFace); cell data body_a, body_b (int64), normal_stress, shear_stress [Pa], load,
/// energy [J] (float32), and point data apart as of surfaces.
void write_bonds_vtp(const std::string& path, const Frame& frame, const Scene& scene);

/// The contact network (contact_network.hpp): a line from centre to centre of each pair that presses, and from a centre to each
/// contact point with a wall. Point data, the same at both ends, so that a tube can take its radius from them: normal_force (sum over the
/// pair's contact points), tangential_force (size of its sum), force (3), contact_points, body_a, body_b. in   period   lines take the
/// short way through a periodic side
void write_network_vtp(const std::string& path, const Frame& frame, const Periodicity& period);

/// The twelve edges of the periodic cell of a scene with [cell]: of all cells with its images the one that is sheared least, its lowest
/// corner that of the box that bodies lie in. Field data, one row: normal_stress (xx, yy, zz), shear_stress (yz, xz, xy) [Pa] (float64).
void write_cell_vtp(const std::string& path, const FrameCell& cell, const Periodicity& period);

}  // namespace scree
