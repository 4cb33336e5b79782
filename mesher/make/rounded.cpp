#include "mesher/make/rounded.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

namespace {

/// Triangles of one flat face have normals that agree to rounding; neighbouring faces of the solids meant here differ by 0.6 rad and more.
constexpr double kSameDirection = 1e-9;

/// A flat face: its normal, and its distance from the origin.
struct Face {
  Vec3 normal;
  double distance;
};

/// The distinct faces of a solid, and which one each triangle is a part of.
struct Faces {
  std::vector<Face> faces;
  std::vector<std::size_t> of_triangle;
};

Faces faces_of(const TriangleMesh& solid) {
  Faces found;
  for (const auto& [a, b, c] : solid.triangles) {
    const auto at = [&](std::int32_t i) { return solid.vertices[static_cast<std::size_t>(i)]; };
    const Vec3 normal = normalised(cross(at(b) - at(a), at(c) - at(a)));
    std::size_t face = 0;
    while (face < found.faces.size() && length(found.faces[face].normal - normal) > kSameDirection) ++face;
    if (face == found.faces.size()) found.faces.push_back({normal, dot(normal, at(a))});
    found.of_triangle.push_back(face);
  }
  return found;
}

/// Makes the rounded solid: vertices are a corner of the inner solid plus the radius in a direction, each once.
class Rounding {
 public:
  Rounding(const TriangleMesh& solid, Faces faces, double radius, double edge_length)
      : solid_(solid), radius_(radius), edge_length_(edge_length), flat_(std::move(faces)) {}

  TriangleMesh make() {
    place_corners();
    for (std::size_t t = 0; t < solid_.triangles.size(); ++t) {
      const auto& triangle = solid_.triangles[t];
      const Vec3& normal = flat_.faces[flat_.of_triangle[t]].normal;
      add({vertex(triangle[0], normal), vertex(triangle[1], normal), vertex(triangle[2], normal)});
    }
    add_strips();
    for (std::int32_t corner = 0; corner < solid_.vertex_count(); ++corner) add_patch(corner);
    return std::move(mesh_);
  }

 private:
  /// Faces that meet at each corner, and the corner of the inner solid, whose faces lie one radius deeper.
  void place_corners() {
    normals_.resize(solid_.vertices.size());
    for (std::size_t t = 0; t < solid_.triangles.size(); ++t) {
      for (const std::int32_t corner : solid_.triangles[t]) {
        auto& meeting = normals_[static_cast<std::size_t>(corner)];
        const Vec3 normal = flat_.faces[flat_.of_triangle[t]].normal;
        if (std::find(meeting.begin(), meeting.end(), normal) == meeting.end()) meeting.push_back(normal);
      }
    }
    for (std::size_t i = 0; i < solid_.vertices.size(); ++i) {
      // of a regular corner all faces make the same angle with the mean of their normals
      Vec3 mean{};
      for (const Vec3& normal : normals_[i]) mean = mean + normal;
      middle_.push_back(normalised(mean));
      const double along = dot(middle_[i], normals_[i].front());
      for (const Vec3& normal : normals_[i])
        if (std::abs(dot(middle_[i], normal) - along) > kSameDirection) throw InternalError("rounded: a corner is not regular");
      inner_.push_back(solid_.vertices[i] - (radius_ / along) * middle_[i]);
    }
  }

  /// Steps of an arc between two directions.
  int steps(const Vec3& a, const Vec3& b) const {
    const double angle = std::atan2(length(cross(a, b)), dot(a, b));
    return std::max(1, static_cast<int>(std::ceil(angle * radius_ / edge_length_ - kSameDirection)));
  }

  std::int32_t vertex(std::int32_t corner, const Vec3& direction) {
    const auto [entry, is_new] =
        known_.try_emplace({static_cast<double>(corner), direction.x, direction.y, direction.z}, mesh_.vertex_count());
    if (is_new) mesh_.vertices.push_back(inner_[static_cast<std::size_t>(corner)] + radius_ * direction);
    return entry->second;
  }

  void add(const std::array<std::int32_t, 3>& triangle) { mesh_.triangles.push_back(triangle); }

  /// Direction i of n steps of the arc from a to b; the same bits from either end.
  static Vec3 between(const Vec3& a, const Vec3& b, int i, int n) {
    if (i == 0) return a;
    if (i == n) return b;
    return normalised(static_cast<double>(n - i) * a + static_cast<double>(i) * b);
  }

  /// Quarter pipes along the edges between two faces.
  void add_strips() {
    std::map<std::array<std::int32_t, 2>, std::size_t> left_of;
    for (std::size_t t = 0; t < solid_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) left_of[{solid_.triangles[t][k], solid_.triangles[t][(k + 1) % 3]}] = flat_.of_triangle[t];
    for (const auto& [edge, face] : left_of) {
      const auto [a, b] = edge;
      const std::size_t other = left_of.at({b, a});
      if (a > b || face == other) continue;
      const Vec3 from = flat_.faces[face].normal, to = flat_.faces[other].normal;
      const int n = steps(from, to);
      for (int i = 0; i < n; ++i) {
        const Vec3 here = between(from, to, i, n), next = between(from, to, i + 1, n);
        add({vertex(b, here), vertex(a, here), vertex(a, next)});
        add({vertex(b, here), vertex(a, next), vertex(b, next)});
      }
    }
  }

  /// The part of a ball at a corner: one triangle between three faces, else a fan about the middle.
  void add_patch(std::int32_t corner) {
    auto around = normals_[static_cast<std::size_t>(corner)];
    const Vec3 middle = middle_[static_cast<std::size_t>(corner)];
    const Vec3 u = normalised(around[0] - dot(around[0], middle) * middle), v = cross(middle, u);
    std::sort(around.begin(), around.end(),
              [&](const Vec3& a, const Vec3& b) { return std::atan2(dot(a, v), dot(a, u)) < std::atan2(dot(b, v), dot(b, u)); });
    if (around.size() == 3) return add_spherical(corner, around[0], around[1], around[2]);
    for (std::size_t i = 0; i < around.size(); ++i) add_spherical(corner, around[i], around[(i + 1) % around.size()], middle);
  }

  /// A spherical triangle in n^2 flat ones; n is that of the arc from a to b, which a strip shares.
  void add_spherical(std::int32_t corner, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int n = steps(a, b);
    const auto at = [&](int i, int j) {  // i steps towards b, j towards c
      const int left = n - i - j;
      if (left == n) return vertex(corner, a);
      if (i == n) return vertex(corner, b);
      if (j == n) return vertex(corner, c);
      // with a weight of zero two terms are left, whose sum has the same bits in either order
      return vertex(corner, normalised(static_cast<double>(left) * a + static_cast<double>(i) * b + static_cast<double>(j) * c));
    };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        add({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) add({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }

  const TriangleMesh& solid_;
  double radius_, edge_length_;
  Faces flat_;
  std::vector<std::vector<Vec3>> normals_;
  std::vector<Vec3> middle_, inner_;
  std::map<std::array<double, 4>, std::int32_t> known_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh rounded(const TriangleMesh& solid, double radius, double edge_length) {
  Faces faces = faces_of(solid);
  double inside = std::numeric_limits<double>::infinity();
  for (const Face& face : faces.faces) inside = std::min(inside, face.distance);
  if (!(radius < inside)) {
    throw UsageError("--rounding: a radius of {} found, expected one below that of the largest ball inside, {}",
                     format_quantity(radius, Dimension::length), format_quantity(inside, Dimension::length));
  }
  return Rounding(solid, std::move(faces), radius, edge_length).make();
}

}  // namespace scree
