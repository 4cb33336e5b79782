#include "solver/features/triangle_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "core/distance/plain_distance.hpp"
#include "core/distance/triangle_distance.hpp"

namespace scree {

namespace {

/// Below this part of the margin the difference of the closest points has lost half of its digits, and the normal of their features
/// serves (triangle_distance.hpp).
constexpr double kNormalOfFeatures = 0x1p-26;

/// The kernel's last digits depend on the instruction set: of pairs that may be this close beyond the margin, distances and points are
/// computed again in plain code.
constexpr double kRounding = 0x1p-30;

/// Closest points of two triangles, A frame. Those within the margin have the same bits on any instruction set.
TriangleDistance distance_of(const PairBody& a, const PairBody& b, const Mat3& b_to_a, const Vec3& centre_b, std::int32_t ta,
                             std::int32_t tb, double margin) {
  Vec3 corner_a[3], corner_b[3];
  for (int k = 0; k < 3; ++k) {
    corner_a[k] = a.scale * a.shape->mesh.corner(ta, k);
    corner_b[k] = b_to_a * (b.scale * b.shape->mesh.corner(tb, k)) + centre_b;
  }
  TriangleDistance d = triangle_distance(corner_a, corner_b);
  if (d.intersecting || d.distance > (1 + kRounding) * margin) return d;
  const PlainNearest plain = nearest_of_triangles(corner_a, corner_b);
  d.distance = std::sqrt(plain.squared);
  d.point_a = plain.a;
  d.point_b = plain.b;
  if (d.distance > kNormalOfFeatures * margin) d.normal = (1 / d.distance) * (plain.a - plain.b);
  return d;
}

}  // namespace

bool list_triangle_contacts(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                            MeshDistanceScratch& scratch, CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const Placement placement = relative_placement(a.x, a.q, a.scale, b.x, b.q, b.scale);
  thread_local std::vector<TrianglePair> pairs;
  if (triangle_pairs_within({&a.shape->mesh, &a.shape->bvh}, {&b.shape->mesh, &b.shape->bvh}, placement, (margin + skin) / a.scale, scratch,
                            pairs)) {
    return false;
  }
  const Mat3 b_to_a = matrix_of(conjugate(a.q) * b.q);
  const Vec3 centre_b = rotate_inverse(a.q, b.x - a.x);
  for (const TrianglePair& pair : pairs) {
    const double distance = distance_of(a, b, b_to_a, centre_b, pair.a, pair.b, margin).distance;
    lists.edges.push_back({pair.a, pair.b, slack_below(distance, margin, std::min(radius_a, radius_b))});
  }
  std::sort(lists.edges.begin(), lists.edges.end(), [](const EdgeCandidate& l, const EdgeCandidate& r) {
    return l.edge_a != r.edge_a ? l.edge_a < r.edge_a : l.edge_b < r.edge_b;
  });
  end_lists(lists);
  return true;
}

void triangle_contact_features(const PairBody& a, const PairBody& b, double margin, double motion, const CandidateLists& lists,
                               std::vector<ContactFeature>& features) {
  features.clear();
  if (lists.edges.empty()) return;
  const Mat3 b_to_a = matrix_of(conjugate(a.q) * b.q);
  const Vec3 centre_b = rotate_inverse(a.q, b.x - a.x);
  for (const EdgeCandidate& candidate : lists.edges) {
    if (candidate.slack > motion) continue;
    const TriangleDistance d = distance_of(a, b, b_to_a, centre_b, candidate.edge_a, candidate.edge_b, margin);
    if (d.distance >= margin) continue;
    ContactFeature f{};
    f.key = (std::int64_t{candidate.edge_a} << 30) | candidate.edge_b;
    f.x = 0.5 * (d.point_a + d.point_b);
    f.n = d.normal;
    f.overlap = margin - d.distance;
    f.weight = 1;
    features.push_back(f);
  }
}

}  // namespace scree
