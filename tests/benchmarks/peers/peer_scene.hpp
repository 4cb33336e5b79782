// The scene that all programs of the comparison share: shapes, the state of a bed of bodies, and an independent
// judge of a state.
//
// Text files, so that every peer reads the same numbers whatever it is written in:
//   shapes.txt       one line a shape: volume [m^3], principal moments at density 1 (3) [m^5], bounding radius [m]
//   shape_K.obj      origin at the centre of mass, axes principal, outward
//   *.state          one line a body: shape, position (3) [m], orientation w x y z, velocity (3) [m/s],
//                    angular velocity (3, world) [rad/s]
#pragma once

#include <string>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "core/geometry/bvh.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct PeerShape {
  TriangleMesh mesh;  ///< about the centre of mass, principal axes [m]
  double volume = 0;  ///< [m^3]
  Vec3 moments;       ///< principal, density 1 [m^5]
  double bounding_radius = 0;
  Bvh bvh;
};

struct PeerBody {
  std::int32_t shape = 0;
  Vec3 position;
  Quat orientation;
  Vec3 velocity, angular_velocity;  ///< world
};

/// `count` shapes whose ball of equal volume has the given radius. "rock": concave, rms roughness 0.15 of the
/// radius; "convex": an icosphere under an affine map with axes 1, 0.85, 0.7, which keeps every corner on the hull.
/// Throws UsageError unless triangles is 20, 80, 320, 1280 or 5120.
std::vector<PeerShape> make_peer_shapes(const std::string& kind, int triangles, int count, double radius);

/// Places b, turned by `rotation`, along `direction` from a so that the surfaces are `gap` apart (relative error 1e-9).
Placement placed_near(const PeerShape& a, const PeerShape& b, const Quat& rotation, const Vec3& direction, double gap,
                      MeshDistanceScratch& scratch);

void write_peer_shapes(const std::string& folder, const std::vector<PeerShape>& shapes);
/// Throws InputError when a file is missing or no number can be read where one belongs.
std::vector<PeerShape> read_peer_shapes(const std::string& folder);

std::vector<PeerBody> read_peer_state(const std::string& path);
void write_peer_state(const std::string& path, const std::vector<PeerBody>& bodies);

/// What is wrong with a state, measured on the true triangles whatever the program's own contact model believes.
struct Verdict {
  int touching_pairs = 0;             ///< body pairs nearer than `reach`
  int intersecting_pairs = 0;         ///< body pairs whose surfaces cut each other, or one inside the other
  double deepest = 0;                 ///< how deep a corner lies in another body or behind a wall [m]
  double kinetic = 0, potential = 0;  ///< [J]; potential from the floor z = 0
  double largest_speed = 0;           ///< [m/s]
};

/// in   box_length   walls at x = 0, x = L, y = 0, y = L, floor at z = 0 [m]
/// in   reach        two bodies nearer than this touch [m]
/// Cost: all pairs of bounding spheres, then descents.
Verdict judge_state(const std::vector<PeerShape>& shapes, const std::vector<PeerBody>& bodies, double box_length, double density,
                    double gravity, double reach);

}  // namespace scree
