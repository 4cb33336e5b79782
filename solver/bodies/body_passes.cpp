// Compiled once for every instruction set (Highway's foreach_target), for the baseline, never with -march=native. Rows that do not fill a
// vector are copied into one, with bodies at rest beside them: so each formula stands here once.
#include "solver/bodies/body_passes.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/bodies/body_passes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// Rows of a column from i on, as many as there are lanes; beyond `left` of them what `other` says.
HWY_INLINE Lane column(const double* rows, std::size_t left, double other) {
  if (left >= kLanes) return Lane::load(rows);
  alignas(64) double some[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) some[k] = k < left ? rows[k] : other;
  return Lane::load(some);
}
HWY_INLINE Lane3 column(const Vec3* rows, std::size_t left) {
  Lane3 v;
  if (left >= kLanes) {
    hn::LoadInterleaved3(Tag<double>(), &rows->x, v.x.v, v.y.v, v.z.v);
    return v;
  }
  Vec3 some[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) some[k] = k < left ? rows[k] : Vec3{};
  hn::LoadInterleaved3(Tag<double>(), &some[0].x, v.x.v, v.y.v, v.z.v);
  return v;
}
HWY_INLINE LaneQuat column(const Quat* rows, std::size_t left) {
  LaneQuat q;
  if (left >= kLanes) {
    hn::LoadInterleaved4(Tag<double>(), &rows->w, q.w.v, q.x.v, q.y.v, q.z.v);
    return q;
  }
  Quat some[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) some[k] = k < left ? rows[k] : Quat{};
  hn::LoadInterleaved4(Tag<double>(), &some[0].w, q.w.v, q.x.v, q.y.v, q.z.v);
  return q;
}
HWY_INLINE void put(Lane value, double* rows, std::size_t left) {
  if (left >= kLanes) return value.store(rows);
  alignas(64) double some[kLanes];
  value.store(some);
  for (std::size_t k = 0; k < left; ++k) rows[k] = some[k];
}

HWY_NOINLINE void add_dissipation(ParticleSet& p, double dt, std::size_t begin, std::size_t end) {
  const Lane zero(0.0), time(-dt);
  for (std::size_t i = begin; i < end; i += kLanes) {
    const std::size_t left = end - i;
    const auto moves = column(&p.inverse_mass[i], left, 0) > zero;
    const Lane power = dot(column(&p.dissipative_force[i], left), column(&p.v[i], left)) +
                       dot(column(&p.dissipative_torque[i], left), column(&p.w[i], left));
    put(column(&p.dissipated[i], left, 0) + select(moves, time * power, zero), &p.dissipated[i], left);
  }
}

HWY_NOINLINE void add_way(const ParticleSet& p, double rounding, std::size_t begin, std::size_t end, Vec3* x_before, Quat* q_before,
                          double* way) {
  const Lane zero(0.0), factor(rounding);
  for (std::size_t i = begin; i < end; i += kLanes) {
    const std::size_t left = end - i;
    const Lane3 shift = column(&p.x[i], left) - column(&x_before[i], left);
    const auto is_ball = column(&p.ball_radius[i], left, 1) > zero;
    Lane gone = length(shift);
    if (any(!is_ball)) {
      // A point at R from the centre moves by 2 R sin(angle / 2), two unit quaternions differ by 2 sin(angle / 4).
      const LaneQuat q = column(&p.q[i], left), old = column(&q_before[i], left);
      const Lane w = q.w - old.w, x = q.x - old.x, y = q.y - old.y, z = q.z - old.z;
      const Lane turned = Lane(2.0) * column(&p.radius[i], left, 0) * sqrt(w * w + x * x + y * y + z * z);
      gone = gone + select(is_ball, zero, turned);
      for (std::size_t k = i; k < std::min(end, i + kLanes); ++k) q_before[k] = p.q[k];
    }
    for (std::size_t k = i; k < std::min(end, i + kLanes); ++k) x_before[k] = p.x[k];
    put(column(&way[i], left, 0) + factor * gone, &way[i], left);
  }
}

HWY_NOINLINE std::size_t find_far(const ParticleSet& p, double dt, double share, std::size_t begin, std::size_t end) {
  const Lane time_squared(dt * dt), part(share);
  for (std::size_t i = begin; i < end; i += kLanes) {
    const Lane3 v = column(&p.v[i], end - i);
    const Lane limit = part * column(&p.radius[i], end - i, 0);
    if (!any(dot(v, v) * time_squared > limit * limit)) continue;
    for (std::size_t k = i; k < std::min(end, i + kLanes); ++k) {
      const double way = share * p.radius[k];
      if (squared_length(p.v[k]) * (dt * dt) > way * way) return k;
    }
  }
  return end;
}

HWY_NOINLINE RowsMoved find_moved(const ParticleSet& p, double limit_squared, std::size_t begin, std::size_t end) {
  const Lane limit(limit_squared);
  Lane fastest(0.0);
  RowsMoved found;
  for (std::size_t i = begin; i < end; i += kLanes) {
    const Lane3 v = column(&p.v[i], end - i), moved = column(&p.x[i], end - i) - column(&p.x_listed[i], end - i);
    // written so that a place that is no number counts as beyond
    if (any(!(dot(moved, moved) <= limit))) found.beyond = true;
    const Lane speed = dot(v, v);
    fastest = select(speed > fastest, speed, fastest);  // one that is no number is left out
  }
  alignas(64) double speeds[kLanes];
  fastest.store(speeds);
  for (const double speed : speeds) found.squared_speed = std::max(found.squared_speed, speed);
  return found;
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(add_dissipation);
HWY_EXPORT(add_way);
HWY_EXPORT(find_far);
HWY_EXPORT(find_moved);

}  // namespace

void add_dissipation_of_rows(ParticleSet& p, double dt, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(add_dissipation)(p, dt, begin, end);
}

void add_way_of_rows(const ParticleSet& p, double rounding, std::size_t begin, std::size_t end, std::vector<Vec3>& x_before,
                     std::vector<Quat>& q_before, std::vector<double>& way) {
  HWY_DYNAMIC_DISPATCH(add_way)(p, rounding, begin, end, x_before.data(), q_before.data(), way.data());
}

std::size_t find_row_that_goes_far(const ParticleSet& p, double dt, double share, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(find_far)(p, dt, share, begin, end);
}

RowsMoved find_rows_moved(const ParticleSet& p, double limit_squared, std::size_t begin, std::size_t end) {
  return HWY_DYNAMIC_DISPATCH(find_moved)(p, limit_squared, begin, end);
}

}  // namespace scree
#endif
