// The kernel of mesh_forces.hpp, compiled once for every instruction set (Highway's foreach_target), as ball_forces.cpp.
//
// Letters: a, b the two bodies; x a contact point, n from B to A, w angular velocities; all in the frame of A about its centre. The order
// of operations is that of pair_view.cpp (pose, motion), potential_model.hpp (add_potential), chosen_law.cpp and pair_friction.hpp, line
// by line: whoever changes one changes both. Tests compare them (tests/solver/mesh_forces_test.cpp).
#include "solver/lanes/mesh_forces.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/mesh_forces.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/contact/pair_force.hpp"
#include "solver/lanes/ball_lanes-inl.hpp"
#include "solver/lanes/lane_contact-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

HWY_INLINE Lane at(const MeshNumbers& numbers, std::size_t k) { return Lane::load(numbers.data() + k); }
HWY_INLINE Lane3 at(const std::array<MeshNumbers, 3>& v, std::size_t k) { return {at(v[0], k), at(v[1], k), at(v[2], k)}; }
HWY_INLINE Lane larger(Lane a, Lane b) { return select(a < b, b, a); }  // std::max(a, b)

HWY_INLINE Lane power7(Lane x) {
  const Lane x2 = x * x, x4 = x2 * x2;
  return x4 * x2 * x;
}

/// Brings the numbers of each feature together.
HWY_INLINE void spread_rows(MeshPairs& pairs, std::size_t k) {
  const auto put = [k](const Lane& from, MeshNumbers& to) { from.store(to.data() + k); };
  for (MeshFeature& f : pairs.features) {
    const auto load = [&](std::size_t first, Lane* column) {
      load_columns([&](std::size_t lane) { return f.row[k + lane].data() + first; }, column);
    };
    Lane number[MeshFeature::kRow];
    for (std::size_t first = 0; first < MeshFeature::kRow; first += 4) load(first, number + first);
    for (std::size_t i = 0; i < 3; ++i) {
      put(number[i], f.x[i]);
      put(number[4 + i], f.n[i]);
      put(number[8 + i], f.gradient_force[i]);
      put(number[11 + i], f.gradient_couple[i]);
    }
    put(number[3], f.overlap);
    put(number[7], f.weight);
  }
}

/// Where A and B are and how they move (RelativePose, PairMotion).
struct MeshMotion {
  LaneQuat turn;
  LaneMatrix a_to_world, b_to_a;
  Lane3 branch, centre_b;  ///< of B, world and A frame
  Lane3 v_a, w_a, v_b, w_b;
  Lane inverse_mass;  ///< of both
  Lane3 inverse_inertia_a, inverse_inertia_b;
};

HWY_INLINE MeshMotion motion_in_lanes(const BallScene& scene, const Rows& a, const Rows& b) {
  const ParticleSet& p = scene.p;
  const LaneQuat qa = a.of(p.q), turn = conjugate(qa) * b.of(p.q);
  const LaneMatrix a_to_world(qa);
  const Lane3 xa = a.of(p.x), branch = image_of(scene.periodicity, xa, b.of(p.x)) - xa, vb = b.of(p.v);
  return {turn,
          a_to_world,
          LaneMatrix(turn),
          branch,
          rotate_inverse(qa, branch),
          a_to_world.transpose_times(a.of(p.v)),
          a_to_world.transpose_times(a.of(p.w)),
          a_to_world.transpose_times(p.cell.deforms() ? vb + velocity_along(p.cell, branch) : vb),
          a_to_world.transpose_times(b.of(p.w)),
          a.of(p.inverse_mass) + b.of(p.inverse_mass),
          a.of(p.inverse_inertia),
          b.of(p.inverse_inertia)};
}

/// The push of all features of each pair.
struct MeshPush {
  Lane largest, D;      ///< overlaps: of a feature, effective [m]
  Lane energy;          ///< U [J]
  Lane sum;             ///< of the features' parts [N]
  Lane3 force, torque;  ///< on A
};

/// PotentialModel::add_potential.
template <LaneLawKind kKind>
HWY_INLINE MeshPush push_in_lanes(const BallScene& scene, const LawRows<LaneLaw>& law, const Rows& a, const Rows& b, MeshPairs& pairs,
                                  std::size_t k) {
  const LaneLaws& laws = scene.laws;
  const Lane zero(0.0), half(0.5);
  Lane radius = zero;
  if (laws.needs_radius) {
    const Lane given = law.at(&LaneLaw::radius), ra = a.of(scene.p.equivalent_radius), rb = b.of(scene.p.equivalent_radius);
    radius = select(given > zero, given, ra * rb / (ra + rb));
  }
  MeshPush m;
  m.largest = m.sum = zero;
  for (const MeshFeature& f : pairs.features) m.largest = larger(m.largest, at(f.overlap, k));
  Lane norm = zero;
  for (const MeshFeature& f : pairs.features) {
    const Lane r = at(f.overlap, k) / m.largest;
    norm = norm + at(f.weight, k) * power7(r) * r;
  }
  m.D = m.largest * sqrt(sqrt(sqrt(norm)));
  Lane push;
  if constexpr (kKind == LaneLawKind::hertz_viscous) {
    const Lane c = law.at(&LaneLaw::stiffness) * sqrt(radius), root = sqrt(m.D);
    push = c * m.D * root;
    m.energy = Lane(0.4) * c * m.D * m.D * root;
  } else {
    const Lane stiffness = law.at(&LaneLaw::stiffness) + law.at(&LaneLaw::size_stiffness) * radius;
    push = stiffness * m.D;
    m.energy = half * stiffness * m.D * m.D;
  }
  const Lane slope = at(pairs.cluster_share, k) * push, of_weight = slope * m.D / Lane(static_cast<double>(kNorm));
  m.force = m.torque = Lane3{zero, zero, zero};
  for (MeshFeature& f : pairs.features) {
    const Lane r = at(f.overlap, k) / m.D, r7 = power7(r), part = slope * at(f.weight, k) * r7, c = of_weight * r7 * r;
    part.store(f.push.data() + k);
    m.sum = m.sum + part;
    const Lane3 force = part * at(f.n, k);
    m.force = m.force + force - c * at(f.gradient_force, k);
    m.torque = m.torque + cross(at(f.x, k), force) - c * at(f.gradient_couple, k);
  }
  return m;
}

HWY_INLINE Lane squares_over(const Lane3& t, const Lane3& inverse) {
  return t.x * t.x * inverse.x + t.y * t.y * inverse.y + t.z * t.z * inverse.z;
}

/// wrench_mobility, at least that of the centres.
HWY_INLINE Lane mobility_of(const MeshMotion& m, const MeshPush& push) {
  const Lane3 on_b = m.b_to_a.transpose_times(cross(m.centre_b, push.force) - push.torque);
  const Lane wrench = m.inverse_mass * dot(push.force, push.force) + squares_over(push.torque, m.inverse_inertia_a) +
                      squares_over(on_b, m.inverse_inertia_b);
  return larger(m.inverse_mass, wrench / (push.sum * push.sum));
}

template <LaneLawKind kKind, bool kFriction>
HWY_INLINE void forces_in_lanes(const BallScene& scene, double dt, MeshPairs& pairs, std::size_t k, MeshForces& out) {
  const LawRows<LaneLaw> law(scene.laws.laws, pairs.law.data() + k);
  const Lane zero(0.0), one(1.0), half(0.5), step(dt);
  const Rows a(pairs.a.data() + k), b(pairs.b.data() + k);
  spread_rows(pairs, k);
  const MeshMotion m = motion_in_lanes(scene, a, b);
  const MeshPush push = push_in_lanes<kKind>(scene, law, a, b, pairs, k);
  const Lane mobility = mobility_of(m, push);
  const LaneDamping damping = damping_of<kKind>(law, push.energy, push.sum, mobility, step);

  LaneQuat before = m.turn;
  if constexpr (kFriction) {
    const auto [v, w] = load_fours(pairs.turn, k);
    const auto turned = at(pairs.turned, k) > zero;
    const Lane3 xyz = select(turned, v, Lane3{m.turn.x, m.turn.y, m.turn.z});
    before = {select(turned, w, m.turn.w), xyz.x, xyz.y, xyz.z};
    store_fours(Lane3{m.turn.x, m.turn.y, m.turn.z}, m.turn.w, k, pairs.turn);
  }
  const LaneFriction friction{half_turn(before, m.turn),
                              law.at(&LaneLaw::friction),
                              law.at(&LaneLaw::friction_sliding),
                              law.at(&LaneLaw::tangential_ratio),
                              law.at(&LaneLaw::tangential_damping) * damping.chi,
                              Lane(kStiffnessRounding) * length(m.centre_b)};
  Lane stored = zero;
  Lane3 lost{zero, zero, zero}, lost_torque{zero, zero, zero};
  for (MeshFeature& f : pairs.features) {
    const Lane3 x = at(f.x, k), n = at(f.n, k);
    const Lane part = at(f.push, k), overlap = at(f.overlap, k);
    const Lane3 turning_a = cross(m.w_a, x), turning_b = cross(m.w_b, x - m.centre_b);
    const Lane3 velocity = m.v_a + turning_a - m.v_b - turning_b;
    const Lane vn = dot(velocity, n), damped = damped_push<kKind>(damping, part, overlap, vn, step);
    Lane3 dissipative = (damped - part) * n;
    if constexpr (kFriction) {
      const Lane3 slip = velocity - (half * step) * (cross(m.w_a, turning_a) - cross(m.w_b, turning_b)), vt = slip - dot(slip, n) * n;
      const auto [spring_force, spring_stiffness] = load_fours(f.spring, k);
      LaneSpring spring{spring_force, spring_stiffness, load_fours(f.normal, k).first};
      dissipative = dissipative + friction.force({n, vt, overlap, vn, part, damped}, push.D, at(f.kept, k) > zero, step, spring);
      stored = with_energy({spring.force, spring.stiffness}, stored);
      store_fours(spring.force, spring.stiffness, k, f.spring);
      store_fours(spring.normal, zero, k, f.normal);
    }
    lost = lost + dissipative;
    lost_torque = lost_torque + cross(x, dissipative);
  }

  // onto the bodies
  select(damping.fits & (mobility > zero), zero, one).store(out.left.data() + k);
  const Lane3 force_a = m.a_to_world.times(push.force + lost), torque_a = m.a_to_world.times(push.torque + lost_torque);
  const Lane3 lost_a = m.a_to_world.times(lost), lost_torque_a = m.a_to_world.times(lost_torque);
  const Lane3 torque_b = cross(m.branch, force_a) - torque_a, lost_torque_b = cross(m.branch, lost_a) - lost_torque_a;
  const Lane max_overlap = at(pairs.max_overlap, k), ratio = select(max_overlap > zero, push.largest / max_overlap, zero);
  store_fours(force_a, ratio, k, out.fours[0]);
  store_fours(torque_a, push.energy, k, out.fours[1]);
  store_fours(torque_b, stored, k, out.fours[2]);
  store_fours(lost_a, zero, k, out.fours[3]);
  store_fours(lost_torque_a, zero, k, out.fours[4]);
  store_fours(lost_torque_b, zero, k, out.fours[5]);
}

template <LaneLawKind kKind>
void forces_of_kind(const BallScene& scene, double dt, MeshPairs& pairs, MeshForces& out) {
  for (std::size_t k = 0; k < pairs.count; k += kLanes) {
    if (scene.laws.friction)
      forces_in_lanes<kKind, true>(scene, dt, pairs, k, out);
    else
      forces_in_lanes<kKind, false>(scene, dt, pairs, k, out);
  }
}

HWY_NOINLINE void forces_of_meshes(const BallScene& scene, double dt, MeshPairs& pairs, MeshForces& out) {
  switch (scene.laws.kind) {
    case LaneLawKind::linear_viscous:
      return forces_of_kind<LaneLawKind::linear_viscous>(scene, dt, pairs, out);
    case LaneLawKind::linear_hunt_crossley:
      return forces_of_kind<LaneLawKind::linear_hunt_crossley>(scene, dt, pairs, out);
    case LaneLawKind::hertz_viscous:
      return forces_of_kind<LaneLawKind::hertz_viscous>(scene, dt, pairs, out);
    case LaneLawKind::none:
      return;
  }
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(forces_of_meshes);

}  // namespace

void find_mesh_forces(const BallScene& scene, double dt, MeshPairs& pairs, MeshForces& forces) {
  // lanes beyond the last pair compute results that are not read, of rows that exist
  for (std::size_t k = pairs.count; k < kMeshPairs; ++k) {
    pairs.a[k] = pairs.a[0];
    pairs.b[k] = pairs.b[0];
    pairs.law[k] = pairs.law[0];
  }
  HWY_DYNAMIC_DISPATCH(forces_of_meshes)(scene, dt, pairs, forces);
}

}  // namespace scree
#endif
