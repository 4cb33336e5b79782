// What the time loop reads of a scene: shapes in their principal frames, contact laws by material pair, walls
// split into zones. Built once, the same on every rank, never written afterwards.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "core/placing/region.hpp"
#include "core/storage/scene_file.hpp"
#include "core/storage/seam_meshes.hpp"
#include "core/storage/wall_state.hpp"
#include "core/storage/wall_zones.hpp"
#include "solver/laws/laws.hpp"
#include "solver/scene/body_extremes.hpp"
#include "solver/scene/contact_extent.hpp"
#include "solver/scene/density_weights.hpp"
#include "solver/scene/lane_laws.hpp"
#include "solver/scene/solver_shape.hpp"

namespace scree {

/// D over the range that the weights of an attraction are tabulated for: at touch D is the range, and a table of a radius 1.5 times that of
/// the cluster there knows a cluster also where the mesh is so coarse that few vertices lie within it. Pull-off of icospheres of any level
/// is then 1.00 to 1.07 F_c; with a table of the radius itself up to 1.14 F_c.
inline constexpr double kPullTableDepth = 2.2;

class SolverScene {
 public:
  /// Throws UsageError for what this solver does not do yet, InputError for contradictions.
  explicit SolverScene(const Scene& scene);
  SolverScene(const SolverScene&) = delete;
  SolverScene& operator=(const SolverScene&) = delete;

  const Scene& source() const { return *scene_; }
  const SolverShape& shape(std::int32_t s) const { return shapes_[static_cast<std::size_t>(s)]; }
  const std::vector<SolverShape>& shapes() const { return shapes_; }
  const PairLaw& law(std::int32_t material_a, std::int32_t material_b) const {
    return laws_[static_cast<std::size_t>(material_a) * material_count_ + static_cast<std::size_t>(material_b)];
  }
  /// Weights of the corners of a body's shape at a scale; null where all are 1. Made at the first call, which is that of a body's arrival.
  const double* weights(std::int32_t shape, double scale) const;
  const double* wall_weights(std::int32_t wall) const { return wall_weights_[static_cast<std::size_t>(wall)]; }
  /// The shape of a mesh wall as it is now: that of the scene, until the wall is worn.
  const SolverShape& wall_shape(std::int32_t wall) const { return *wall_shapes_[static_cast<std::size_t>(wall)]; }
  /// Gives a mesh wall other places for its vertices. It is all that changes of a scene once it is made: between steps, on every rank
  /// alike. Candidates and lists made before do not hold after.   Cost: that of a shape's tree and features.
  void set_wall_vertices(std::int32_t wall, const std::vector<Vec3>& vertices) const;
  /// Vertices of all walls that wear, wall after wall; 0: none does.
  std::int32_t worn_vertices() const { return worn_vertices_; }
  /// Of a wall that wears, where its vertices begin among them; -1 of any other.
  std::int32_t first_worn(std::size_t wall) const { return first_worn_[wall]; }
  /// The same for an attraction, of clusters that lie within its widest range.
  const double* pull_weights(std::int32_t shape, double scale) const;
  const double* wall_pull_weights(std::int32_t wall) const { return wall_pull_weights_[static_cast<std::size_t>(wall)]; }
  double widest_range() const { return law_choice_.attraction ? reach_ : 0; }  ///< of the attraction of any two materials [m]; 0: none
  /// The D of an attraction that its tables are made for [m].
  double pull_table_depth() const { return kPullTableDepth * widest_range(); }
  /// Whether the radius of clusters can follow D: features of a barrier, and of a law that reaches beyond the margins, need fixed weights.
  bool weights_follow_overlap() const { return weights_follow_overlap_; }
  /// What there is of weights so far; null where all are 1.
  const DensityWeights* density_weights() const { return weights_.get(); }
  /// That the case gives to a body; null for most.
  const BodyForce* given_force(std::int64_t id) const;
  const std::vector<WallZone>& zones() const { return zones_; }
  /// Of the scene's outlets, one for each.
  const std::vector<Region>& outlets() const { return outlets_; }
  /// Whether touch begins where surfaces were drawn, with margins that go with the size of bodies (core/surface/touch_surface.hpp).
  bool margins_by_size() const { return scene_->settings.surface == TouchAt::drawn; }
  /// Whether contacts go on beyond their maximum overlap (contact/overlap_limit.hpp).
  bool continues() const { return scene_->settings.on_overlap == OnOverlap::proceed; }
  /// Whether bodies and contacts stay as they are: only temperatures change.
  bool is_frozen() const { return scene_->settings.heat && scene_->settings.heat->frozen; }
  double margin() const { return margin_; }  ///< of each body [m]; 0 where margins go with size
  /// What the scene's law or attraction reaches beyond the margins [m].
  double reach() const { return reach_; }
  /// How far from its surface a body may act: the margin of all bodies, which radii do not have in them, and half of that reach [m].
  double contact_range() const { return margin_ + 0.5 * reach_; }
  /// Least and largest overlap at which two meshes, or a mesh and a wall, would meet [m]; 0 where there are none.
  double smallest_max_overlap() const { return smallest_max_overlap_; }
  double largest_max_overlap() const { return largest_max_overlap_; }
  /// The same of two bodies with meshes.
  double max_overlap_of(std::int32_t shape_a, double scale_a, std::int32_t shape_b, double scale_b) const {
    return margins_by_size() ? scale_a * shape(shape_a).margin + scale_b * shape(shape_b).margin : 2 * margin_;
  }
  /// D for which the clusters of mesh walls are told [m].
  double wall_table_depth() const { return margins_by_size() ? extremes_.largest_margin : margin_; }
  /// Whether laws have numbers that go with the maximum overlap of a pair; then for_max_overlap() gives them.
  bool laws_by_max_overlap() const { return laws_by_max_overlap_; }
  /// The law of two materials for a pair with this maximum overlap [m].
  PairLaw for_max_overlap(const PairLaw& law, double max_overlap) const;
  double shortest_range() const { return shortest_range_; }  ///< of the attraction of any two materials [m]; 0: none attract each other
  /// Speed at which the attraction of two materials takes all motion of their lightest bodies as they part [m/s]; huge where that is not
  /// known.
  double sticking_speed(const MaterialPair& pair) const;
  /// The largest of it over the range, of any two materials [1/s].
  double fastest_sticking() const { return fastest_sticking_; }
  const Periodicity& periodicity() const { return periodicity_; }
  /// Of the bodies that the scene starts with and that its inlets can bring. What follows from all bodies is asked for the extremes of
  /// those that there are.
  const BodyExtremes& extremes() const { return extremes_; }
  /// Takes in a body of this scene's shapes and materials. in   speed   as it joins [m/s]
  void include_body(std::int32_t shape, std::int32_t material, double scale, bool fixed, double speed, BodyExtremes& extremes) const;
  /// Throws for a body that cannot join: UsageError or InputError naming it.
  void check_body(std::int64_t id, std::int32_t shape, double scale) const;
  /// Throws UsageError for a wall of triangles that bodies of this bounding radius could miss at a seam, see check_meshes_at_seams.
  void check_seams(double radius) const;
  /// Stiffest tangent expected of the contacts of two materials [N/m], of a layer per area [N/m^3]: the step is derived from it.
  double step_stiffness(const MaterialPair& pair, const BodyExtremes& extremes) const;
  /// The severest impact to be expected between two materials.
  LargestImpact largest_impact(const MaterialPair& pair, const BodyExtremes& extremes) const;
  /// The largest F_c of their contacts [N] (laws/attraction.hpp); 0 where they do not attract each other.
  double largest_pull_off(const MaterialPair& pair, const BodyExtremes& extremes) const;
  /// Names of planes of boxes and cylinders that lie across a periodic axis and were left out.
  const std::vector<std::string>& dropped_zones() const { return dropped_zones_; }
  /// Lines about mesh walls that end near a seam, see check_meshes_at_seams.
  const std::vector<std::string>& seam_gaps() const { return seam_gaps_; }
  const LawChoice& law_choice() const { return law_choice_; }
  /// What pairs in lanes read of the laws, without zones of walls; kind none where no pair of the scene may go in lanes.
  const LaneLaws& lane_laws() const { return lane_laws_; }
  /// The same with the zones that balls meet, where they have a path of their own (pairs/ball_evaluation.hpp).
  const LaneLaws& ball_laws() const { return ball_laws_; }
  /// How stiffness grows with what touches at once.
  const ContactExtent& contact_extent() const { return *contact_extent_; }
  double extent_of_rough_pair(const BodyExtremes& extremes) const { return contact_extent_->of_rough_pair(shapes_, extremes); }
  /// Whether vertices may touch several faces of a shape at once.
  bool has_valleys(const BodyExtremes& extremes) const { return scree::has_valleys(shapes_, extremes); }
  bool has_friction() const { return law_choice_.friction; }
  bool has_damping() const { return has_damping_; }
  bool has_driven_walls() const { return has_driven_walls_; }
  /// Some wall moves in answer to force.
  bool has_answering_walls() const { return !drives_.empty(); }
  /// How a wall answers to force; null of one that does not.
  const Drive* drive(std::size_t wall) const { return wall < drives_.size() && drives_[wall] ? &*drives_[wall] : nullptr; }
  /// How far a wall that answers to force has a point from the axis that it turns about [m]; 1 of one that goes along a direction.
  double lever(std::size_t wall) const { return levers_[wall]; }
  /// Of a wall that has an inertia, at a place in the world: 1 over the mass that a contact there meets [1/kg]; 0 of any other.
  double wall_mobility(std::size_t wall, const Vec3& at) const;
  bool has_moving_surfaces() const { return has_moving_surfaces_; }
  /// Triangles of all walls with a load map, wall after wall; 0: none has one.
  std::int32_t mapped_triangles() const { return mapped_triangles_; }
  /// Of a wall with a load map, where its triangles begin among them; -1 of any other.
  std::int32_t first_mapped(std::size_t wall) const { return first_mapped_[wall]; }

 private:
  void include_inlets();
  void prepare_laws();
  void prepare_barrier();
  void check_on_overlap() const;
  void prepare_weights();
  void check_necks() const;
  PairLaw make_pair_law(const MaterialPair& pair, const BodyExtremes& extremes) const;
  void check_margin(ShapeKind kind) const;
  void find_max_overlaps();
  void check_solid(std::int64_t id, std::int32_t shape) const;
  /// Whether a body's reach fits into the periods and through nothing thinner than itself. in   who   its name, asked only for a message
  void check_fits(std::int32_t shape, double scale, const std::function<std::string()>& who) const;
  void add_attraction(const MaterialPair& pair, const BodyExtremes& extremes, PairLaw& law) const;

  const Scene* scene_;
  std::vector<SolverShape> shapes_;
  std::vector<PairLaw> laws_;
  std::size_t material_count_ = 0;
  std::vector<WallZone> zones_;
  std::vector<Region> outlets_;
  std::vector<std::string> dropped_zones_, seam_gaps_;
  Periodicity periodicity_;
  double margin_ = 0, reach_ = 0, shortest_range_ = 0, fastest_sticking_ = 0, smallest_max_overlap_ = 0, largest_max_overlap_ = 0;
  BodyExtremes extremes_;
  LawChoice law_choice_;
  LaneLaws lane_laws_, ball_laws_;
  std::shared_ptr<const ContactExtent> contact_extent_;
  std::vector<std::int32_t> first_mapped_;  ///< of each wall
  std::int32_t mapped_triangles_ = 0;
  std::vector<std::int32_t> first_worn_;  ///< of each wall
  std::int32_t worn_vertices_ = 0;
  /// What a worn wall has in place of what is the scene's.
  struct WornWall {
    SolverShape shape;
    std::vector<double> weights, pull_weights;
  };
  mutable std::vector<std::unique_ptr<WornWall>> worn_walls_;  ///< of each wall; null: as it was
  mutable std::vector<const SolverShape*> wall_shapes_;        ///< of each wall; null of one that is no mesh
  double wall_weight_radius() const;
  std::vector<double> levers_;                ///< of each wall
  std::vector<std::optional<Drive>> drives_;  ///< of each wall; empty where none answers to force
  std::shared_ptr<DensityWeights> weights_;   ///< null: all 1
  mutable std::vector<const double*> wall_weights_;
  std::shared_ptr<DensityWeights> pull_weights_;
  mutable std::vector<const double*> wall_pull_weights_;
  bool weights_follow_overlap_ = true, has_damping_ = false, has_driven_walls_ = false, has_moving_surfaces_ = false,
       laws_by_max_overlap_ = false;
};

}  // namespace scree
