// How much of a shape can be in contact at once: what the derived step needs where stiffness grows with it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/storage/scene_file.hpp"
#include "solver/scene/body_extremes.hpp"
#include "solver/scene/solver_shape.hpp"

namespace scree {

/// For the way in which a scene gathers contacts. This one is that of gather = "potential".
class ContactExtent {
 public:
  virtual ~ContactExtent() = default;
  /// Factor on the mobility of a body. gather = "area": the largest area that it can have in contact [m^2], stiffness being per area.
  virtual double of_body(std::int32_t shape, double scale) const;
  /// Factor on the stiffness of a contact of two bodies that are not both smooth.
  /// gather = "potential": n^(2/q), q = 8, for a face on a face, with n = 4 corners; n = 8 where a shape has valleys: a cube at the edge of
  /// a box touches both faces with four corners each
  /// gather = "pairs": how many springs a contact of two bodies may have. Two faces, edges or corners that lie over each other make about
  /// as many pairs as both have triangles there; more is rare
  virtual double of_rough_pair(const std::vector<SolverShape>& shapes, const BodyExtremes& extremes) const;
};

/// Whether a shape that bodies or walls have has valleys (SolverShape::has_valleys).
bool has_valleys(const std::vector<SolverShape>& shapes, const BodyExtremes& extremes);

/// Throws UsageError where the way of gathering needs margins and there are none.
std::unique_ptr<const ContactExtent> make_contact_extent(const Scene& scene, const std::vector<SolverShape>& shapes);

/// Largest area that a body may have in contact at scale 1 [m^2]: its largest flat region, or the cap that its bounding sphere
/// presses into a layer of the given thickness.
double largest_contact_area(const SolverShape& shape, double thickness);

/// The largest number of triangles that come within `thickness` of a plane on which the mesh lies: of how many a face, an edge or a
/// corner of it consists for gather = "pairs".   Cost: O(T) for each of at most kSpringDirections planes.
std::int64_t triangles_on_plane(const TriangleMesh& mesh, double thickness);
/// So many normals of triangles and of vertices each are tried: all of them of a mesh that anybody would gather in pairs.
inline constexpr std::size_t kSpringDirections = 2000;

}  // namespace scree
