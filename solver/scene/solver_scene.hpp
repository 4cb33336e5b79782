// What the time loop reads of a scene: shapes in their principal frames, contact laws by material pair, walls
// split into zones. Built once, the same on every rank, never written afterwards.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/bvh.hpp"
#include "core/geometry/features.hpp"
#include "core/geometry/periodic.hpp"
#include "core/storage/scene_file.hpp"
#include "core/storage/seam_meshes.hpp"
#include "core/storage/wall_state.hpp"
#include "core/storage/wall_zones.hpp"
#include "solver/laws/laws.hpp"

namespace scree {

/// A feature edge of a shape: from `start` along `along` (not unit).
struct ShapeEdge {
  Vec3 start, along;
};

/// A shape in its principal frame (origin at the centre of mass, inertia diagonal), scale 1.
/// A wall's surface keeps its file frame.
struct SolverShape {
  ShapeKind kind = ShapeKind::solid;
  double rounding = 0;  ///< radius of an analytic sphere about its only corner [m]
  TriangleMesh mesh;
  Bvh bvh;
  FeatureTable features;
  std::vector<std::int32_t> spoke_start;  ///< corners + 1: ranges in spoke_end
  std::vector<std::int32_t> spoke_end;    ///< vertices to which mesh edges lead from each corner
  double radius = 0;                      ///< bounding radius about the origin, rounding included [m]
  double volume = 0;                      ///< [m^3]
  double cell_size = 0;                   ///< of a very large body, scale 1 [m]; 0: none
  double contact_area = 0;       ///< largest_contact_area at scale 1, with a margin sum of the scene's [m^2]; 0 but for gather = "area"
  double equivalent_radius = 0;  ///< of the ball of equal volume [m]; 0 for a surface
  Vec3 inertia;                  ///< principal moments for density 1 [m^5]
  Quat body_from_principal;
  /// Largest [r]x^T I^-1 [r]x over all surface points r, density 1, scale 1 [1/m^3]: what rotation adds to the inverse
  /// mass of a contact at worst. It is convex in r, so the corners decide. See derive_step_size.
  double rotational_mobility = 0;
  /// Largest |r x n| over the surface points r with their normals n [m]: how fast a spin of 1 rad/s moves the surface along its
  /// normal at most. 0 for a ball.
  double turning_arm = 0;
  bool isotropic = false;  ///< all three moments equal: no gyroscopic splitting needed

  /// A corner, and an edge, of `features`.
  const Vec3& corner(std::int32_t c) const {
    return mesh.vertices[static_cast<std::size_t>(features.corners[static_cast<std::size_t>(c)])];
  }
  ShapeEdge edge(std::int32_t e) const {
    const FeatureEdge& ends = features.edges[static_cast<std::size_t>(e)];
    const Vec3& start = mesh.vertices[static_cast<std::size_t>(ends.vertex_a)];
    return {start, mesh.vertices[static_cast<std::size_t>(ends.vertex_b)] - start};
  }
  /// Across an edge into one of its two faces (see core/geometry/features.hpp).
  Vec3 edge_conormal(std::int32_t e, int side) const { return conormal(mesh, features.edges[static_cast<std::size_t>(e)], side); }

  /// Bytes held: at most 160 a triangle.
  std::size_t memory() const;
};

/// What the solver keeps of a shape as read.
SolverShape make_solver_shape(const Shape& source);

class SolverScene {
 public:
  /// Throws UsageError for what this solver does not do yet, InputError for contradictions.
  explicit SolverScene(const Scene& scene);

  const Scene& source() const { return *scene_; }
  const SolverShape& shape(std::int32_t s) const { return shapes_[static_cast<std::size_t>(s)]; }
  const std::vector<SolverShape>& shapes() const { return shapes_; }
  const PairLaw& law(std::int32_t material_a, std::int32_t material_b) const {
    return laws_[static_cast<std::size_t>(material_a) * material_count_ + static_cast<std::size_t>(material_b)];
  }
  const std::vector<WallZone>& zones() const { return zones_; }
  double margin() const { return margin_; }  ///< of each body [m]
  const Periodicity& periodicity() const { return periodicity_; }
  double largest_radius() const { return largest_radius_; }  ///< bounding, of all bodies [m]
  /// Names of planes of boxes and cylinders that lie across a periodic axis and were left out.
  const std::vector<std::string>& dropped_zones() const { return dropped_zones_; }
  /// Lines about mesh walls that end near a seam, see check_meshes_at_seams.
  const std::vector<std::string>& seam_gaps() const { return seam_gaps_; }
  const LawChoice& law_choice() const { return law_choice_; }
  /// gather = "pairs": how many springs a contact of two bodies may have: two faces, edges or corners that lie over each other make about
  /// as many pairs as both have triangles there; more is rare. 0 otherwise.
  std::int64_t springs_per_pair() const { return springs_per_pair_; }
  double normal_exponent() const { return law_choice_.exponent; }  ///< of the effective overlap in the normal force
  bool has_friction() const { return law_choice_.friction; }
  bool has_damping() const { return has_damping_; }
  bool has_driven_walls() const { return has_driven_walls_; }

 private:
  PairLaw make_pair_law(const MaterialPair& pair) const;

  const Scene* scene_;
  std::vector<SolverShape> shapes_;
  std::vector<PairLaw> laws_;
  std::size_t material_count_ = 0;
  std::vector<WallZone> zones_;
  std::vector<std::string> dropped_zones_, seam_gaps_;
  Periodicity periodicity_;
  double margin_ = 0, largest_radius_ = 0;
  LawChoice law_choice_;
  std::int64_t springs_per_pair_ = 0;
  bool has_damping_ = false, has_driven_walls_ = false;
};

}  // namespace scree
