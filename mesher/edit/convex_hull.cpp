#include "mesher/edit/convex_hull.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

#include "core/base/error.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

/// qhull's state, its copy of the points, and what it says.
class Qhull {
 public:
  explicit Qhull(const std::vector<Vec3>& points) : says_(open_memstream(&text_, &size_)) {
    for (const Vec3& p : points) coordinates_.insert(coordinates_.end(), {p.x, p.y, p.z});
    qh_zero(&state_, says_);
    std::string command = "qhull Qt Pp";  // triangles alone, no remarks on rounding
    error_ = qh_new_qhull(&state_, 3, static_cast<int>(points.size()), coordinates_.data(), False, command.data(), nullptr, says_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    int kept = 0, blocks = 0;
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &kept, &blocks);
    std::fclose(says_);
    std::free(text_);
  }

  int error() const { return error_; }
  /// The first line of what it says.
  std::string words() {
    std::fflush(says_);
    const std::string all(text_, size_);
    return all.substr(0, all.find('\n'));
  }

  std::vector<Triangle> triangles() {
    std::vector<Triangle> result;
    qhT* qh = &state_;  // by this name for the macros of the library
    for (facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      Triangle corners{};
      std::size_t count = 0;
      vertexT *vertex = nullptr, **vertexp = nullptr;
      FOREACHvertex_(facet->vertices) corners[count++ % 3] = qh_pointid(qh, vertex->point);
      SCREE_ASSERT(count == 3, "a face of {} vertices", count);
      if (facet->toporient != qh_ORIENTclock) std::swap(corners[0], corners[1]);
      result.push_back(corners);
    }
    return result;
  }

 private:
  qhT state_{};
  std::vector<double> coordinates_;
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* says_;
  int error_ = 0;
};

}  // namespace

TriangleMesh convex_hull(const std::vector<Vec3>& points) {
  Box3 box;
  for (const Vec3& p : points) box.add(p);
  if (points.size() < 4 || !(length(box.extent()) > 0)) return {};
  Qhull qhull(points);
  if (qhull.error() == qh_ERRsingular) return {};
  if (qhull.error() != qh_ERRnone)
    throw InputError("these {} points have no convex hull that rounding allows: {}", points.size(), qhull.words());
  TriangleMesh mesh;
  mesh.vertices = points;
  mesh.triangles = qhull.triangles();
  drop_unreferenced(mesh);
  return mesh;
}

}  // namespace scree
