// Unique contact features of one body pair: every corner of one body against the nearest point of the other
// surface, and every convex edge against every convex edge. Source: docs/reference/contact-law.md section 3.1.
//
// All arithmetic is in the principal frame of body A with its centre as origin, so a scene far from the world's
// origin behaves as one at it. Candidates carry the slack that the pair's relative motion must use up before they
// can come within the margin; a step looks at those few whose slack is used up. A candidate of two meshes that was looked at and
// is no feature gets a new slack, by what it lacks now (candidate_slack.hpp): those that are near but do not touch are looked at
// rarely.
#pragma once

#include <cstdint>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

/// A body as the pair arithmetic sees it. Walls: shape null for analytic zones.
struct PairBody {
  const SolverShape* shape = nullptr;
  double scale = 1;
  Vec3 x;
  Quat q;
  const double* weights = nullptr;  ///< of the shape's corners; null: all 1 (solver/scene/density_weights.hpp)
  double cluster_scale = 1;         ///< factor on the clusters of that table, for another depth than it was made for

  double weight(std::int32_t corner) const {
    if (weights == nullptr) return 1;
    const double w = weights[corner];
    return cluster_scale == 1 ? w : w / (w + cluster_scale * (1 - w));
  }
  double cluster(std::int32_t corner) const { return weights == nullptr ? 0.0 : 1 / weight(corner) - 1; }
  /// Of both ends of an edge of the shape together.
  double weight_of_ends(std::int32_t edge) const {
    if (weights == nullptr) return 2;
    return weight(shape->edge_corner(edge, 0)) + weight(shape->edge_corner(edge, 1));
  }
};

/// Pose of B in the frame of A: what every function on a pair needs, made once a pair and step.
struct RelativePose {
  Quat turn;      ///< B to A
  Mat3 rotation;  ///< the same
  Vec3 centre;    ///< of B, A frame [m]
  RelativePose() = default;
  RelativePose(const PairBody& a, const PairBody& b)
      : turn(conjugate(a.q) * b.q), rotation(matrix_of(turn)), centre(rotate_inverse(a.q, b.x - a.x)) {}
  Vec3 a_from_b(const Vec3& p) const { return rotation * p + centre; }
  Vec3 b_from_a(const Vec3& p) const { return transpose_times(rotation, p - centre); }
};

/// Corner of one side against one triangle of the other (triangle -1: an analytic zone or a sphere's point).
struct CornerCandidate {
  std::int32_t corner, triangle;
  float slack;  ///< motion since it was listed before which it is no feature, rounded down [m]
};

struct EdgeCandidate {
  std::int32_t edge_a, edge_b;
  float slack;
};

/// Kept candidates of one pair, and the relative pose they were found at. What every step reads of it comes first, in fours as lanes load
/// them (lanes/mesh_poses.hpp).
struct alignas(64) CandidateLists {
  Vec3 centre;       ///< of the smaller body in the larger one's frame, when listed [m]
  double skin = -1;  ///< [m]; < 0: no lists yet
  Quat turn;         ///< B to A, when listed
  Vec3 last_centre;  ///< as `centre` and `turn`, at the end of the way
  double way = 0;    ///< of the pair: motion from step to step since listed, so that slacks can count from any step [m]
  Quat last_turn;
  double first_slack = 0;       ///< motion at which the first candidate, or what is not listed, can come within the margin [m]
  double next_examination = 0;  ///< way at which the first candidate of two meshes that have no feature is to be looked at [m]
  std::vector<float> slacks;    ///< of all candidates of two meshes, as they are now (due_candidates.hpp) [m]
  std::vector<CornerCandidate> corners_a, corners_b;  ///< sorted by (corner, triangle)
  std::vector<EdgeCandidate> edges;                   ///< sorted by (edge_a, edge_b)
};
/// Of a step's motion in the way of a pair: far above the rounding of a sum of as many steps as there may be.
inline constexpr double kWayRounding = 1 + 1e-9;

/// One feature below the margin.
struct Feature6 {
  Vec3 force, couple;  ///< coefficients of a translation and of a rotation about A's centre
};

/// What lanes read of it comes first, in fours (lanes/mesh_forces.hpp).
struct ContactFeature {
  Vec3 x;          ///< contact point, mid-gap, A frame [m]
  double overlap;  ///< margin sum minus gap, > 0 [m]
  Vec3 n;          ///< unit, from B to A, A frame
  double weight;   ///< a_j in (0, 1], fading and shares of minima; without its cluster as found, with it once solve_weights() has been
  Feature6 weight_gradient;  ///< of the weight, for a virtual motion of A against B; where it is `faded`
  double cluster;  ///< how many others share the place of the feature, where D is the margin of one body (contact/cluster_weights.hpp)
  /// unique within the pair: kind in bits 60 and 61, then two indices. A vertex has the place of its minimum for the second
  /// (features/surface_minima.hpp), 0 on a convex body; that of a ball on a mesh is this place alone
  std::int64_t key;
  bool faded;  ///< weight depends on the pose
};

/// Slack of a candidate found at `distance`: what lies beyond the margin, rounded down, with room for the rounding of the
/// distance itself relative to `size` [m].
float slack_below(double distance, double margin, double size);

/// Kinds of features in bits 60 and 61 of their keys.
inline constexpr std::int64_t kCornerOfA = 0, kCornerOfB = 1, kEdgeEdge = 2;
inline std::int64_t make_key(std::int64_t kind, std::int64_t i, std::int64_t j) { return (kind << 60) | (i << 30) | j; }
struct FeatureIndices {
  std::int64_t kind;
  std::int32_t first, second;
};
inline FeatureIndices indices_of_key(std::int64_t key) {
  constexpr std::int64_t kIndex = (std::int64_t{1} << 30) - 1;
  return {key >> 60, static_cast<std::int32_t>((key >> 30) & kIndex), static_cast<std::int32_t>(key & kIndex)};
}

/// Motion that a pair has made since its lists were made: no point of the smaller body has moved further against
/// the larger one [m].
double motion_since_listed(const CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b);
/// The same, and adds to the way of the pair what it has moved since the last call or since its lists were made.
double follow_motion(CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b);

/// Makes the lists of two meshes: every feature pair that can come below `margin` (sum of both) while the motion
/// stays within `skin`. Returns false when triangles of the two bodies intersect.
/// in   sharing   of the minima of a vertex (features/surface_minima.hpp) [m]
bool list_mesh_pair(const PairBody& a, const PairBody& b, double margin, double sharing, double skin, double radius_a, double radius_b,
                    MeshDistanceScratch& scratch, CandidateLists& lists);

/// Gap and normal (wall frame) of a point against an analytic zone; the point may lie behind it: gap < 0.
double zone_gap(const WallZone& zone, const Vec3& p, Vec3& normal);

/// Same for a body against an analytic zone of a wall (b is the wall's pose).
void list_zone_pair(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double skin, double radius_a,
                    CandidateLists& lists);

/// Same for two analytic spheres.
void list_sphere_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                      CandidateLists& lists);

/// Empties the lists and notes the pose that they are made at: how each of these functions begins. With nothing listed
/// first_slack is the skin.
void begin_lists(const PairBody& a, const PairBody& b, double skin, double radius_a, double radius_b, CandidateLists& lists);
/// Fills first_slack from the candidates: how each of these functions ends.
void end_lists(CandidateLists& lists);

/// Same for an analytic sphere and a mesh, in either order.
bool list_sphere_mesh_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                           MeshDistanceScratch& scratch, CandidateLists& lists);

/// Features below the margin at the present pose, to which the way of the pair leads, in ascending key order. Gives the candidates that
/// it looks at new slacks.
/// in   margin, sharing   as list_mesh_pair     in   size   bounding radius of the smaller body [m]
void mesh_pair_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                        CandidateLists& lists, std::vector<ContactFeature>& features);
/// `motion` is motion_since_listed.
void zone_pair_features(const PairBody& a, const RelativePose& pose, const WallZone& zone, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features);
/// Every local minimum of the distance between the centre and the surface, with its weight (features/surface_minima.hpp). As the centre
/// goes from one region to the next the potential is continuous.
void sphere_mesh_features(const PairBody& a, const PairBody& b, double margin, double motion, const CandidateLists& lists,
                          std::vector<ContactFeature>& features);
void sphere_pair_features(const PairBody& a, const PairBody& b, double margin, std::vector<ContactFeature>& features);

}  // namespace scree
