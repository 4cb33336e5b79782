// A body against an analytic zone of a wall: part of pair_features.hpp.
#include "solver/features/pair_features.hpp"

namespace scree {

double zone_gap(const WallZone& zone, const Vec3& p, Vec3& normal) {
  const Vec3 r = p - zone.point;
  switch (zone.kind) {
    case WallZone::Kind::plane:
      normal = zone.direction;
      return dot(r, zone.direction);
    case WallZone::Kind::cylinder: {
      const Vec3 radial = r - dot(r, zone.direction) * zone.direction;
      const double rho = length(radial);
      normal = rho > 0 ? (-1 / rho) * radial : Vec3{};
      return zone.radius - rho;
    }
    case WallZone::Kind::sphere: {
      const double rho = length(r);
      normal = rho > 0 ? (-1 / rho) * r : Vec3{};
      return zone.radius - rho;
    }
    case WallZone::Kind::mesh:
      break;
  }
  SCREE_ASSERT(false, "a mesh zone has no closed-form gap");
  return 0;
}

void list_zone_pair(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double skin, double radius_a,
                    CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, 2 * radius_a, lists);  // the wall is the frame
  const RelativePose pose(a, b);
  const auto corner_count = static_cast<std::int32_t>(a.shape->features.corners.size());
  for (std::int32_t c = 0; c < corner_count; ++c) {
    Vec3 normal;
    const double gap = zone_gap(zone, pose.b_from_a(a.scale * a.shape->corner(c)), normal) - a.scale * a.shape->rounding;
    if (gap < margin + skin) {
      lists.corners_a.push_back({c, -1, slack_below(gap, margin, radius_a)});
    }
  }
  end_lists(lists);
}

void zone_pair_features(const PairBody& a, const RelativePose& pose, const WallZone& zone, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features) {
  features.clear();
  for (const CornerCandidate& candidate : lists.corners_a) {
    if (candidate.slack > motion) continue;
    const Vec3 p = a.scale * a.shape->corner(candidate.corner);
    Vec3 normal;
    const double gap = zone_gap(zone, pose.b_from_a(p), normal) - a.scale * a.shape->rounding;
    if (gap >= margin) continue;
    ContactFeature f{};
    f.key = make_key(kCornerOfA, candidate.corner, 0);
    f.n = pose.rotation * normal;
    f.x = p - (a.scale * a.shape->rounding + 0.5 * gap) * f.n;
    f.overlap = margin - gap;
    f.weight = 1;
    f.cluster = a.cluster(candidate.corner);
    features.push_back(f);
  }
}

}  // namespace scree
