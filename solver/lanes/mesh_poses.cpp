// The kernel of mesh_poses.hpp, compiled once for every instruction set, as ball_forces.cpp. The order of operations is that of
// pair_features.hpp (RelativePose) and pair_features.cpp (follow_motion), line by line: whoever changes one changes both. Tests compare
// them (tests/solver/mesh_poses_test.cpp).
#include "solver/lanes/mesh_poses.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/mesh_poses.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/lanes/ball_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// motion_between() of pair_features.cpp.
HWY_INLINE Lane motion_between(const Lane3& centre, const LaneQuat& p, const Lane3& old_centre, const LaneQuat& q, Lane size) {
  const Lane one(1.0), side = select(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < Lane(0.0), -one, one);
  const Lane w = p.w - side * q.w, x = p.x - side * q.x, y = p.y - side * q.y, z = p.z - side * q.z;
  return length(centre - old_centre) + Lane(2.0) * sqrt(w * w + x * x + y * y + z * z) * size;
}

/// Four numbers of the lists of each pair.
template <class First>
HWY_INLINE void load_listed(const MeshPoses& pairs, std::size_t k, Lane* column, First&& first) {
  load_columns([&](std::size_t lane) { return first(*pairs.lists[k + lane]); }, column);
}

HWY_INLINE void poses_in_lanes(const ParticleSet& p, MeshPoses& pairs, std::size_t k) {
  const Rows a(pairs.a.data() + k), b(pairs.b.data() + k);
  const LaneQuat qa = a.of(p.q), turn = conjugate(qa) * b.of(p.q);
  const LaneMatrix rotation(turn);
  const Lane3 xa = a.of(p.x), branch = image_of(p.cell.periodicity(), xa, b.of(p.x)) - xa, centre = rotate_inverse(qa, branch);
  double* const first = &pairs.pose[k].turn.w;
  constexpr std::size_t kStride = sizeof(RelativePose) / sizeof(double);
  static_assert(kStride == 16);
  const Lane3 &row0 = rotation.row(0), &row1 = rotation.row(1), &row2 = rotation.row(2);
  store_rows({turn.w, turn.x, turn.y}, turn.z, first, kStride);
  store_rows(row0, row1.x, first + 4, kStride);
  store_rows({row1.y, row1.z, row2.x}, row2.y, first + 8, kStride);
  store_rows({row2.z, centre.x, centre.y}, centre.z, first + 12, kStride);

  // follow_motion()
  const Lane radius_a = a.of(p.radius), radius_b = b.of(p.radius);
  const auto frame_is_a = radius_a > radius_b;
  const Lane size = select(radius_b < radius_a, radius_b, radius_a);
  const Lane3 smaller = select(frame_is_a, centre, -rotation.transpose_times(centre));
  Lane listed[4], listed_turn[4], last[4], last_turn[4];
  load_listed(pairs, k, listed, [](const CandidateLists& lists) { return &lists.centre.x; });
  load_listed(pairs, k, listed_turn, [](const CandidateLists& lists) { return &lists.turn.w; });
  load_listed(pairs, k, last, [](const CandidateLists& lists) { return &lists.last_centre.x; });
  load_listed(pairs, k, last_turn, [](const CandidateLists& lists) { return &lists.last_turn.w; });
  const auto quaternion = [](const Lane* q) { return LaneQuat{q[0], q[1], q[2], q[3]}; };
  const Lane step = motion_between(smaller, turn, {last[0], last[1], last[2]}, quaternion(last_turn), size);
  const Lane moved = motion_between(smaller, turn, {listed[0], listed[1], listed[2]}, quaternion(listed_turn), size);
  moved.store(pairs.moved.data() + k);
  const Lane way = last[3] + Lane(kWayRounding) * step;
  store_columns([&](std::size_t lane) { return &pairs.lists[k + lane]->last_centre.x; }, smaller, way);
  store_columns([&](std::size_t lane) { return &pairs.lists[k + lane]->last_turn.w; }, {turn.w, turn.x, turn.y}, turn.z);

  // is_fast() of pair_evaluation.cpp
  const Lane3 wa = a.of(p.w), wb = b.of(p.w), vb = b.of(p.v);
  const Lane3 v = (a.of(p.v) - (p.cell.deforms() ? vb + velocity_along(p.cell, branch) : vb)) + cross(select(frame_is_a, wa, wb), branch);
  const Lane3 spin = wa - wb;
  (Lane(2.0) * (dot(v, v) + size * size * dot(spin, spin))).store(pairs.squared_speed.data() + k);
}

HWY_NOINLINE void all_poses(const ParticleSet& p, MeshPoses& pairs) {
  for (std::size_t k = 0; k < pairs.count; k += kLanes) poses_in_lanes(p, pairs, k);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(all_poses);

}  // namespace

void find_mesh_poses(const ParticleSet& p, MeshPoses& pairs) {
  // lanes beyond the last pair repeat it: what they write is what it has, since it has not moved since
  for (std::size_t k = pairs.count; k < MeshPoses::kPairs; ++k) {
    pairs.a[k] = pairs.a[pairs.count - 1];
    pairs.b[k] = pairs.b[pairs.count - 1];
    pairs.lists[k] = pairs.lists[pairs.count - 1];
  }
  HWY_DYNAMIC_DISPATCH(all_poses)(p, pairs);
}

}  // namespace scree
#endif
