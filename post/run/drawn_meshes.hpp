// The triangles that stand for shapes and walls in pictures: meshes as they are, analytic things tessellated.
#pragma once

#include <vector>

#include "core/picture/view.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"
#include "post/run/wall_extent.hpp"

namespace scree {

/// A surface to draw. Normals are given where the true surface is curved (spheres), else empty: flat triangles.
struct DrawnMesh {
  TriangleMesh mesh;
  std::vector<Vec3> normals;
};

/// Unit sphere of 20 * 4^level triangles, inscribed.
TriangleMesh icosphere(int level);

/// A shape at scale 1 in its own axes. A ball becomes 320 triangles inscribed in it.
DrawnMesh drawn_shape(const Shape& shape);

/// A mesh of at most about `most` triangles: vertices within a cell of a grid become one, and triangles that collapse go.
/// For pictures of very many bodies, each a few pixels large; thin parts may vanish.   Cost: O(triangles), some passes.
TriangleMesh coarse_mesh(const TriangleMesh& mesh, std::size_t most);

/// A wall in its own frame: world = position + rotate(orientation, point), as in a frame's wall state.
///
/// How: a plane is drawn as a square, and a box, which may reach far above the pile, is cut, so that walls
/// reach `room` and not much further. Drawn only: the solver's walls are what the case says.
/// in   frame   where given, a wall that wears is drawn as it is there; else as it was at the start
TriangleMesh drawn_wall(const Wall& wall, const Scene& scene, const Box3& room, const Frame* frame = nullptr);

/// A wall as bodies meet it, in the world: whole, and without the faces that lie across a periodic axis. A plane is a square about `room`.
/// in   place      of the wall in the frame     in   room   in the world [m]     in   frame   for a wall that wears
/// in   deviation  [m] largest distance of the facets of a round wall from it
TriangleMesh wall_surface_in(const Frame& frame, const Wall& wall, const Scene& scene, const WallPlace& place, const Box3& room,
                             double deviation);

/// Vertices of a wall as worn in a frame, axes and scale of its mesh; none where it does not wear.
std::vector<Vec3> worn_vertices_of(const Wall& wall, const Frame& frame);

/// Bounding radius of each shape of the scene at scale 1 [m].
std::vector<double> bounding_radii(const Scene& scene);

/// Box that holds the bounding spheres of all bodies; without bodies, the walls that have an end and the regions of the inlets.
Box3 room_of(const FrameBodies& bodies, const Scene& scene);

/// Of each wall of the scene in a frame; where the frame has none, the scene's.
std::vector<WallPlace> wall_places(const Frame& frame, const Scene& scene);

/// The box of room_of() with the walls that a picture is to show: those that have an end and are not much larger than what the bodies fill,
/// as drums, hoppers and bowls; of a larger one, and of one that has moved away from all bodies, what lies near them. Planes and boxes do
/// not count: they are drawn to fit.
Box3 seen_room(const Frame& frame, const Scene& scene);

View view_of(const Box3& room, const Vec3& gravity);

/// Colour of a shape, red green blue in 0..1: tones of stone that also differ in brightness.
Vec3 shape_colour(std::int32_t shape);
inline constexpr std::int32_t kShapeColours = 8;  ///< then they begin again

}  // namespace scree
