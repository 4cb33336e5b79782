#include "solver/scene/contact_extent.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

class AreaExtent : public ContactExtent {
 public:
  AreaExtent(const Scene& scene, const std::vector<SolverShape>& shapes) {
    const Settings& settings = scene.settings;
    const bool by_size = settings.surface == TouchAt::drawn;
    if (!((by_size ? settings.margin_ratio : settings.margin) > 0))
      throw UsageError("contact.margin = 0: with contact.gather = \"area\" the margins are the elastic layer; give them a thickness");
    for (const SolverShape& shape : shapes) area_.push_back(largest_contact_area(shape, 2 * (by_size ? shape.margin : settings.margin)));
  }
  double of_body(std::int32_t shape, double scale) const override { return area_[static_cast<std::size_t>(shape)] * scale * scale; }
  double of_rough_pair(const std::vector<SolverShape>&, const BodyExtremes&) const override { return 1; }

 private:
  std::vector<double> area_;  ///< of each shape at scale 1 [m^2]
};

class PairsExtent : public ContactExtent {
 public:
  explicit PairsExtent(double margin) : margin_(margin) {}
  double of_rough_pair(const std::vector<SolverShape>& shapes, const BodyExtremes& extremes) const override {
    std::int64_t springs = 0;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      if (extremes.smallest_scale[s] == BodyExtremes::kNone || shapes[s].kind != ShapeKind::solid) continue;
      springs = std::max(springs, 2 * triangles_on_plane(shapes[s].mesh, shapes[s].margin > 0 ? 2 * shapes[s].margin
                                                                                              : 2 * margin_ / extremes.smallest_scale[s]));
    }
    return std::max(ContactExtent::of_rough_pair(shapes, extremes), static_cast<double>(springs));
  }

 private:
  double margin_;
};

}  // namespace

double ContactExtent::of_body(std::int32_t, double) const { return 1; }
double ContactExtent::of_rough_pair(const std::vector<SolverShape>& shapes, const BodyExtremes& extremes) const {
  return std::sqrt(std::sqrt(has_valleys(shapes, extremes) ? 8.0 : 4.0));
}

bool has_valleys(const std::vector<SolverShape>& shapes, const BodyExtremes& extremes) {
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const bool is_there = shapes[s].kind == ShapeKind::surface || extremes.smallest_scale[s] != BodyExtremes::kNone;
    if (is_there && shapes[s].has_valleys) return true;
  }
  return false;
}

std::unique_ptr<const ContactExtent> make_contact_extent(const Scene& scene, const std::vector<SolverShape>& shapes) {
  switch (scene.settings.gather) {
    case Gathering::area:
      return std::make_unique<AreaExtent>(scene, shapes);
    case Gathering::pairs:
      return std::make_unique<PairsExtent>(scene.settings.margin);
    case Gathering::potential:
      break;
  }
  return std::make_unique<ContactExtent>();
}

double largest_contact_area(const SolverShape& shape, double thickness) {
  std::vector<double> area(static_cast<std::size_t>(shape.features.region_count), 0.0);
  for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
    const Vec3 p[3] = {shape.mesh.corner(t, 0), shape.mesh.corner(t, 1), shape.mesh.corner(t, 2)};
    area[static_cast<std::size_t>(shape.features.region[static_cast<std::size_t>(t)])] += 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
  }
  double largest = 2 * std::numbers::pi * shape.radius * thickness;
  for (const double flat : area) largest = std::max(largest, flat);
  return largest;
}

std::int64_t triangles_on_plane(const TriangleMesh& mesh, double thickness) {
  std::vector<Vec3> of_triangle, of_vertex(mesh.vertices.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    of_triangle.push_back(cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)]) of_vertex[static_cast<std::size_t>(v)] += of_triangle.back();
  }
  std::int64_t most = 0;
  std::vector<double> height(mesh.vertices.size());
  for (const std::vector<Vec3>* directions : {&of_triangle, &of_vertex}) {
    const std::size_t stride = directions->size() / kSpringDirections + 1;
    for (std::size_t d = 0; d < directions->size(); d += stride) {
      const double norm = length((*directions)[d]);
      if (!(norm > 0)) continue;
      for (std::size_t v = 0; v < height.size(); ++v) height[v] = dot((*directions)[d], mesh.vertices[v]) / norm;
      const double within = *std::max_element(height.begin(), height.end()) - thickness;
      most =
          std::max(most, std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
                     return std::any_of(t.begin(), t.end(), [&](std::int32_t v) { return height[static_cast<std::size_t>(v)] > within; });
                   }));
    }
  }
  return most;
}

}  // namespace scree
