// Two analytic spheres: part of pair_features.hpp.
#include "solver/features/pair_features.hpp"

#include <algorithm>

namespace scree {

void list_sphere_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                      CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const double gap = length(a.x - b.x) - a.scale * a.shape->rounding - b.scale * b.shape->rounding;
  lists.first_slack = std::min(skin, static_cast<double>(slack_below(gap, margin, radius_a + radius_b)));
}

void sphere_pair_features(const PairBody& a, const PairBody& b, double margin, std::vector<ContactFeature>& features) {
  features.clear();
  const double radius_a = a.scale * a.shape->rounding, radius_b = b.scale * b.shape->rounding;
  const Vec3 between = a.x - b.x;
  const double distance = length(between);
  const double gap = distance - radius_a - radius_b;
  if (gap >= margin || distance <= 0) return;
  ContactFeature f{};
  f.key = make_key(kCornerOfA, 0, 0);
  f.n = rotate_inverse(a.q, (1 / distance) * between);
  f.x = (-(radius_a + 0.5 * gap)) * f.n;
  f.overlap = margin - gap;
  f.weight = 1;
  features.push_back(f);
}

}  // namespace scree
