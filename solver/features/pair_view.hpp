// Where both sides of a pair are and how they move: what is made once a pair and step, and read by the contact models and laws.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/bodies/particle_set.hpp"
#include "solver/features/pair_features.hpp"
#include "solver/features/surface_minima.hpp"
#include "solver/features/wall_cells.hpp"

namespace scree {

/// What meets what.
enum class PairGeometry : std::uint8_t {
  two_spheres,
  sphere_mesh,  ///< in either order; the mesh may be a wall
  body_zone,    ///< any body and an analytic zone of a wall
  two_meshes,   ///< B may be a mesh wall
};

/// Where both sides of a pair are: all that finding its features takes.
struct PairView {
  PairBody a, b;  ///< b.shape is null for an analytic zone
  RelativePose pose;
  double radius_a = 0, radius_b = 0;  ///< bounding; of a wall at least twice that of its body, so that the wall is the frame [m]
  double margin = 0;                  ///< gap of the meshes at which touch begins: the margin sum [m]
  double max_overlap = 0;             ///< overlap at which meshes or centres would meet: what contacts may use up [m]; 0: no limit
  double off_middle = 0;              ///< where the surfaces as drawn meet is so much further from A than the middle of the gap [m]
  double reach = 0;                   ///< gap at which something may act: the margin sum, and what laws reach beyond it [m]
  const WallZone* zone = nullptr;     ///< null for two bodies
  double cell_size = 0;               ///< [m]; 0: none
  CellSide cells = CellSide::none;
  PairGeometry geometry = PairGeometry::two_spheres;
  bool weights_follow_overlap = true;  ///< the radius of clusters follows D
  double cluster_depth = 0;            ///< D for which the clusters of features are told [m]
  bool has_mesh() const { return geometry == PairGeometry::sphere_mesh || geometry == PairGeometry::two_meshes; }
};

/// A ball contact as the tables of lanes know it.
struct BallContactRows {
  bool is_one = false;     ///< the pair is a ball contact; else the rest says nothing
  std::int32_t wall = -1;  ///< row of LaneLaws::zones; -1: two balls
  std::size_t law = 0;     ///< row of LaneLaws::laws
};

/// A pair of two balls, or of a ball and a plane or cylinder, with a law that lanes have, is a ball contact: by the scene and its bodies
/// alone, never by the step. Its force is that of laws/ball-inl.hpp, and its springs are in world axes.
BallContactRows find_ball_contact(const LaneLaws& laws, const ParticleSet& p, std::int32_t a, std::int32_t b, std::int32_t zone);
inline bool is_ball_contact(const SolverScene& scene, const ParticleSet& p, std::int32_t a, std::int32_t b, std::int32_t zone) {
  return find_ball_contact(scene.ball_laws(), p, a, b, zone).is_one;
}

/// See find_minima(): of two meshes [m].
inline double sharing_of_vertices(const PairView& view) { return kSharingOfVertices * view.margin; }

/// in   a, b   rows of the particle set; b is -1 for a wall     in  zone  index into SolverScene::zones(), -1 for two bodies
/// Of a ball contact, balls are seen as if they had not turned: the frame of A has the axes of the world.
PairView view_of(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::int32_t a, std::int32_t b,
                 std::int32_t zone);

/// The same of two bodies that are meshes, whose pose is known.   out   view   all of it
void view_two_meshes(const SolverScene& scene, const ParticleSet& p, std::int32_t a, std::int32_t b, const RelativePose& pose,
                     PairView& view);

/// What an attraction needs of both sides to weigh features beside their weights in the push.
struct PullView {
  double range = 0;  ///< of the attraction of the two materials [m]; 0: none
  double at = 0;     ///< the D that the tables of weights were made for [m]
  PairBody a, b;     ///< with the weights of their corners in an attraction
};
PullView pull_view_of(const SolverScene& scene, const ParticleSet& p, std::int32_t a, std::int32_t b, const PairView& view, double range);

/// Velocities of both sides, world axes.
struct PairVelocities {
  Vec3 v_a, w_a, v_b, w_b;
  Vec3 pivot_b, pivot_v_b;  ///< a point of B and its velocity; arms of slip are taken to it
};

/// Within a step the bodies' are those of half a step before, and so are the walls'; at its end, where springs do not move, those of now.
/// In a cell that deforms, B moves with it against A, whose velocity is taken as it is: the pair sees no more than the difference.
[[gnu::always_inline]] inline PairVelocities velocities_of(const ParticleSet& p, const std::vector<WallState>& walls, std::int32_t a,
                                                           std::int32_t b, const PairView& view, bool in_step) {
  const auto i = static_cast<std::size_t>(a);
  if (b >= 0) {
    const auto j = static_cast<std::size_t>(b);
    if (p.cell.deforms()) {
      const Vec3 v_b = p.v[j] + p.cell.velocity_along(view.b.x - view.a.x, in_step);
      return {p.v[i], p.w[i], v_b, p.w[j], view.b.x, v_b};
    }
    return {p.v[i], p.w[i], p.v[j], p.w[j], view.b.x, p.v[j]};
  }
  const WallState& state = walls[static_cast<std::size_t>(view.zone->wall)];
  if (in_step) return {p.v[i], p.w[i], state.velocity_before, state.angular_velocity_before, state.pivot, state.pivot_velocity_before};
  return {p.v[i], p.w[i], state.velocity, state.angular_velocity, view.b.x, state.velocity};
}

/// How the surface of a wall moves beneath a body, beside the wall's own motion.
struct SurfaceBeneath : SurfaceVelocity {  ///< A frame, about A's centre
  Quat turned;                             ///< how far it has turned in the step, frame of B
};
SurfaceBeneath surface_beneath(const WallState& wall, const PairView& view, const Mat3& a_to_world, bool in_step);

/// Velocities and inverse masses of both sides, A frame (its principal axes, origin at its centre).
struct PairMotion {
  Vec3 v_a, w_a, v_b, w_b;
  Vec3 centre_b;            ///< of B [m]
  Vec3 pivot_b, pivot_v_b;  ///< a point of B and its velocity [m, m/s]: its centre; of a wall that turns, on the axis
  double inverse_mass_a, inverse_mass_b;
  Vec3 inverse_inertia_a;  ///< principal
  Vec3 inverse_inertia_b;  ///< principal of B
  Mat3 b_to_a;
  Quat turn;                                ///< the same rotation, B to A
  double radius = 0;                        ///< R* [m]; filled only when the law asks for it (LawChoice::needs_radius)
  const SurfaceBeneath* surface = nullptr;  ///< of a wall whose surface moves
  /// Where bonds hold a body to others: what damping needs in place of the body; null for both pieces of one fragment.
  const BondedMass *bonded_a = nullptr, *bonded_b = nullptr;
  bool is_bonded() const { return bonded_a != nullptr || bonded_b != nullptr; }
  bool ball_a = false, ball_b = false;  ///< its contact point follows the normal, not its own spin
};

/// At which the normal of a contact turns, where A or B is a ball [rad/s].
Vec3 spin_of_normal(const PairMotion& motion, const Vec3& n);

PairMotion motion_of(const ParticleSet& p, std::int32_t a, std::int32_t b, const PairView& view, const PairVelocities& world,
                     const Mat3& a_to_world);

/// R* of the bodies' equivalent spheres [m]: 1/R* = 1/R_a + 1/R_b. A wall is flat, but for the inside of a sphere.
double contact_radius(const PairView& view);

}  // namespace scree
