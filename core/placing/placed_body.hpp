// Geometry of packing: a placed body, its distance to another, and whether walls and regions hold it.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Upper bounds of distance searches lie this factor above the gap asked for, so that "at least the gap" is told
/// from rounding in the search (1e-16 relative); a larger value only makes searches longer.
inline constexpr double kJustAbove = 1 + 1e-9;

/// Gap of two bodies that intersect.
inline constexpr double kIntersect = -1e300;

/// Of a body's radius: closer counts as touching.
inline constexpr double kTouch = 1e-9;

/// Of its size, by which a body without margins may stand in what it rests on: it has no margin that tells how far contact may press it.
inline constexpr double kPressedIn = 0.02;

/// A shape with its tree, shared by all bodies of that shape.
struct PackShape {
  Shape shape;  ///< its mesh is the one that contacts are computed with (core/surface/touch_surface.hpp)
  Bvh bvh;
  double margin = 0;        ///< around that mesh at scale 1 [m]; 0 where all bodies have one margin
  double radius = 0;        ///< bounding radius at scale 1, margin included [m]
  double inner_radius = 0;  ///< of the largest ball about the centre within the solid at scale 1 [m]; 0 when the centre is outside
};

/// A shape with its tree and radii, ready to be placed.   in   settings   of the scene: where touch begins
PackShape make_pack_shape(Shape shape, const Settings& settings = {});

/// A body at a place. Borrows its shape.
struct PlacedBody {
  const PackShape* shape = nullptr;
  double scale = 1;
  Vec3 position;
  Quat orientation;

  double radius() const { return scale * shape->radius; }
  double margin() const { return scale * shape->margin; }
  /// How far the surface lies around the mesh: of an analytic sphere its radius, of a mesh its margin [m].
  double rounding() const { return scale * (shape->shape.sphere_radius + shape->margin); }
  bool is_sphere() const { return shape->shape.kind == ShapeKind::sphere; }
  /// Vertices in world coordinates, and their box, rounding included.
  std::vector<Vec3> world_vertices() const;
  void world_vertices(std::vector<Vec3>& result) const;
  Box3 world_box() const;
};

/// Gap between the surfaces of two bodies [m], or upper_bound when it is not below it; where meshes with margins press into each other it
/// is below 0, by less than their margins. kIntersect when they are deeper in each other. A body in the solid of the other counts as
/// intersecting; one in a hollow of the other does not.
double gap_between(const PlacedBody& a, const PlacedBody& b, double upper_bound, MeshDistanceScratch& scratch);

/// Whether a wall leaves a body a gap of at least `gap`, on the particles' side. For a mesh wall `mesh` is its
/// placed surface and `is_solid` tells that it bounds a solid, in which no body may be.
bool wall_allows(const Wall& wall, const PlacedBody* mesh, bool is_solid, const PlacedBody& body, const std::vector<Vec3>& vertices,
                 double gap, MeshDistanceScratch& scratch);

/// Placed bodies by place: a hash of cells on levels by size (cell ratio 2), to which bodies can be added one by one.
class PlacedGrid {
 public:
  void insert(std::int32_t index, const Vec3& centre, double radius);
  /// Calls visit(index) for every body whose ball comes within `reach` of the centre; stops when visit returns false.
  template <class Visit>
  void for_each_near(const Vec3& centre, double reach, Visit&& visit) const {
    for (const auto& [level, count] : level_count_) {
      const double size = std::ldexp(1.0, level);
      const double far = reach + 0.5 * size;  // a body of this level has a radius of at most half a cell
      for (std::int64_t x = cell(centre.x - far, size); x <= cell(centre.x + far, size); ++x) {
        for (std::int64_t y = cell(centre.y - far, size); y <= cell(centre.y + far, size); ++y) {
          for (std::int64_t z = cell(centre.z - far, size); z <= cell(centre.z + far, size); ++z) {
            const auto it = cells_.find({level, x, y, z});
            if (it == cells_.end()) continue;
            for (const Ball& ball : it->second) {
              const double sum = reach + ball.radius;
              if (squared_length(ball.centre - centre) < sum * sum && !visit(ball.index)) return;
            }
          }
        }
      }
    }
  }

 private:
  struct Ball {
    Vec3 centre;
    double radius;
    std::int32_t index;
  };
  struct Key {
    int level;
    std::int64_t x, y, z;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& k) const {
      std::uint64_t h = static_cast<std::uint64_t>(k.level) + 77;
      for (std::int64_t v : {k.x, k.y, k.z}) {
        h = (h ^ static_cast<std::uint64_t>(v)) * 0xBF58476D1CE4E5B9ull;
        h ^= h >> 29;
      }
      return static_cast<std::size_t>(h);
    }
  };
  static std::int64_t cell(double x, double size) { return static_cast<std::int64_t>(std::floor(x / size)); }
  std::unordered_map<Key, std::vector<Ball>, Hash> cells_;
  std::unordered_map<int, int> level_count_;
};

}  // namespace scree
