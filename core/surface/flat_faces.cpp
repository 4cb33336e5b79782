#include "core/surface/flat_faces.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

namespace scree {

namespace {

template <class T>
void make_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// tan of half the angle between two ways, by which mean value weights are made.
double half_tangent(const Vec3& a, const Vec3& b) { return length(cross(a, b)) / (length(a) * length(b) + dot(a, b)); }

}  // namespace

struct FlatFaces::Inside {
  std::vector<std::int32_t> vertices, around;  // what is sought, what is known
  Eigen::SparseMatrix<double> weights;         // of the known
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sought;
};

FlatFaces::FlatFaces(const TriangleMesh& mesh)
    : features_(find_features(mesh)), face_corners_(static_cast<std::size_t>(features_.region_count)) {
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)])
      if (features_.corner_of[static_cast<std::size_t>(v)] >= 0) face_corners_[face(t)].push_back(v);
  for (std::vector<std::int32_t>& corners : face_corners_) {
    make_unique(corners);
    if (corners.size() > 3) rigid_faces_.push_back(corners);
  }
  find_outlines(mesh);
  find_edges(mesh);
  find_insides(mesh);
}

void FlatFaces::find_outlines(const TriangleMesh& mesh) {
  std::vector<std::int32_t> of_face(face_corners_.size(), -1);
  std::int32_t count = 0;
  for (std::size_t f = 0; f < face_corners_.size(); ++f)
    if (face_corners_[f].size() > 3) of_face[f] = count++;
  outlines_.resize(static_cast<std::size_t>(count));
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (of_face[face(t)] < 0) continue;
    FaceOutline& outline = outlines_[static_cast<std::size_t>(of_face[face(t)])];
    const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
    outline.normal += cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    outline.triangles.push_back(t);
    outline.vertices.insert(outline.vertices.end(), corners.begin(), corners.end());
    for (std::size_t k = 0; k < 3; ++k)
      if (features_.edge_kind(static_cast<std::size_t>(t), k) != EdgeKind::flat)
        outline.sides.push_back({corners[k], corners[(k + 1) % 3]});
  }
  for (FaceOutline& outline : outlines_) {
    const double doubled = length(outline.normal);
    outline.area = 0.5 * doubled;
    if (doubled > 0) outline.normal = normalised(outline.normal);
    make_unique(outline.vertices);
    std::sort(outline.sides.begin(), outline.sides.end());
    // straight edges: on from sides that begin at corners
    for (const auto& [from, second] : outline.sides) {
      if (!is_corner(from)) continue;
      std::int32_t to = second;
      for (std::size_t step = 0; !is_corner(to) && step < outline.sides.size(); ++step) {
        const auto next = std::lower_bound(outline.sides.begin(), outline.sides.end(), std::array{to, 0});
        if (next == outline.sides.end() || (*next)[0] != to) break;  // winding is not the same everywhere
        to = (*next)[1];
      }
      outline.edges.push_back({from, to});
    }
    for (auto* pairs : {&outline.sides, &outline.edges})
      for (auto& pair : *pairs)
        for (std::int32_t& v : pair)
          v = static_cast<std::int32_t>(std::lower_bound(outline.vertices.begin(), outline.vertices.end(), v) - outline.vertices.begin());
  }
}

void FlatFaces::find_edges(const TriangleMesh& mesh) {
  std::vector<std::vector<std::int32_t>> next(mesh.vertices.size());  // over sharp edges
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (features_.edge_kind(static_cast<std::size_t>(t), k) == EdgeKind::flat) continue;
      const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
      const std::int32_t a = corners[k], b = corners[(k + 1) % 3];
      next[static_cast<std::size_t>(a)].push_back(b);
      next[static_cast<std::size_t>(b)].push_back(a);
    }
  }
  for (std::vector<std::int32_t>& ends : next) make_unique(ends);
  for (const std::int32_t from : features_.corners) {
    for (std::int32_t at : next[static_cast<std::size_t>(from)]) {
      std::vector<std::int32_t> between;
      for (std::int32_t last = from; features_.corner_of[static_cast<std::size_t>(at)] < 0;) {
        between.push_back(at);
        const std::vector<std::int32_t>& ends = next[static_cast<std::size_t>(at)];
        last = std::exchange(at, ends[0] == last ? ends[1] : ends[0]);
      }
      if (from > at) continue;  // found from its other end
      edges_.push_back({from, at});
      const Vec3 &a = mesh.vertices[static_cast<std::size_t>(from)], along = mesh.vertices[static_cast<std::size_t>(at)] - a;
      for (const std::int32_t v : between)
        on_edges_.push_back({v, from, at, dot(mesh.vertices[static_cast<std::size_t>(v)] - a, along) / squared_length(along)});
    }
  }
  make_unique(edges_);
}

void FlatFaces::find_insides(const TriangleMesh& mesh) {
  std::vector<char> is_inside(mesh.vertices.size(), 1);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (features_.edge_kind(static_cast<std::size_t>(t), k) != EdgeKind::flat)
        for (const std::size_t end : {k, (k + 1) % 3})
          is_inside[static_cast<std::size_t>(mesh.triangles[static_cast<std::size_t>(t)][end])] = 0;
  std::vector<std::vector<std::int32_t>> of_face(face_corners_.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
    if (std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return is_inside[static_cast<std::size_t>(v)] != 0; }))
      of_face[face(t)].push_back(t);
  }
  for (const std::vector<std::int32_t>& triangles : of_face) {
    if (triangles.empty()) continue;
    const auto found = std::make_shared<Inside>();
    Inside& inside = *found;
    for (const std::int32_t t : triangles)
      for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)])
        (is_inside[static_cast<std::size_t>(v)] ? inside.vertices : inside.around).push_back(v);
    make_unique(inside.vertices);
    make_unique(inside.around);
    if (inside.around.empty()) continue;  // closed and flat: no body
    const auto place = [](const std::vector<std::int32_t>& in, std::int32_t v) {
      return static_cast<Eigen::Index>(std::lower_bound(in.begin(), in.end(), v) - in.begin());
    };
    // row of v: sum over its neighbours w_vj (x_v - x_j) = 0, each w from the two triangles at v j; equal ones where a triangle has no area
    const auto factorise = [&](bool has_mean_values) {
      std::vector<Eigen::Triplet<double>> sought, known;
      for (const std::int32_t t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
          const std::int32_t v = corners[k];
          if (!is_inside[static_cast<std::size_t>(v)]) continue;
          const Vec3& from = mesh.vertices[static_cast<std::size_t>(v)];
          const std::int32_t ends[2] = {corners[(k + 1) % 3], corners[(k + 2) % 3]};
          const Vec3 ways[2] = {mesh.vertices[static_cast<std::size_t>(ends[0])] - from,
                                mesh.vertices[static_cast<std::size_t>(ends[1])] - from};
          const double tangent = half_tangent(ways[0], ways[1]);
          const Eigen::Index row = place(inside.vertices, v);
          for (int e = 0; e < 2; ++e) {
            const double weight = has_mean_values ? tangent / length(ways[e]) : 1;
            if (!std::isfinite(weight)) return false;
            sought.emplace_back(row, row, weight);
            if (is_inside[static_cast<std::size_t>(ends[e])])
              sought.emplace_back(row, place(inside.vertices, ends[e]), -weight);
            else
              known.emplace_back(row, place(inside.around, ends[e]), weight);
          }
        }
      }
      const auto size = static_cast<Eigen::Index>(inside.vertices.size());
      Eigen::SparseMatrix<double> matrix(size, size);
      matrix.setFromTriplets(sought.begin(), sought.end());
      inside.weights.resize(size, static_cast<Eigen::Index>(inside.around.size()));
      inside.weights.setFromTriplets(known.begin(), known.end());
      inside.sought.compute(matrix);
      return inside.sought.info() == Eigen::Success;
    };
    if (!factorise(true) && !factorise(false)) continue;
    insides_.push_back(found);
  }
}

void FlatFaces::spread(std::vector<Vec3>& field) const {
  for (const OnEdge& v : on_edges_)
    field[static_cast<std::size_t>(v.vertex)] =
        (1 - v.share) * field[static_cast<std::size_t>(v.first)] + v.share * field[static_cast<std::size_t>(v.second)];
  for (const std::shared_ptr<const Inside>& of_face : insides_) {
    const Inside& inside = *of_face;
    Eigen::MatrixX3d known(static_cast<Eigen::Index>(inside.around.size()), 3);
    for (std::size_t i = 0; i < inside.around.size(); ++i) {
      const Vec3& value = field[static_cast<std::size_t>(inside.around[i])];
      known.row(static_cast<Eigen::Index>(i)) << value.x, value.y, value.z;
    }
    const Eigen::MatrixX3d found = inside.sought.solve(inside.weights * known);
    for (std::size_t i = 0; i < inside.vertices.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      field[static_cast<std::size_t>(inside.vertices[i])] = {found(row, 0), found(row, 1), found(row, 2)};
    }
  }
}

}  // namespace scree
