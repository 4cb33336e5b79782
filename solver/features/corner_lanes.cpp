// The kernel of corner_lanes.hpp, compiled once for every instruction set, as ball_forces.cpp. The order of operations is that of
// nearest_on_triangle.hpp, line by line: whoever changes one changes both. Tests compare them (tests/solver/corner_lanes_test.cpp).
//
// Plain code leaves at the first region of the triangle that the point is in; lanes work out all seven and choose, the last first, so that
// the first one has the last word.
#include "solver/features/corner_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/features/corner_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

HWY_INLINE Lane3 load(const CornerVectors& from, std::size_t k) {
  return {Lane::load(from.x.data() + k), Lane::load(from.y.data() + k), Lane::load(from.z.data() + k)};
}

HWY_INLINE void examine_in_lanes(const CornerQueue& queue, std::size_t k, CornerAnswers& out) {
  const Lane zero(0.0);
  const Lane3 p = load(queue.p, k), a = load(queue.a, k), b = load(queue.b, k), c = load(queue.c, k);
  const Lane3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const Lane d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  const Lane vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  const Lane beyond_b = d4 - d3, beyond_c = d5 - d6;
  const auto at_a = (d1 <= zero) & (d2 <= zero), at_b = (d3 >= zero) & (d4 <= d3), at_c = (d6 >= zero) & (d5 <= d6);
  const auto on_ab = (vc <= zero) & (d1 >= zero) & (d3 <= zero), on_ac = (vb <= zero) & (d2 >= zero) & (d6 <= zero),
             on_bc = (va <= zero) & (beyond_b >= zero) & (beyond_c >= zero);

  // inside and on edges: one quotient
  const Lane over = select(on_ab, d1, select(on_ac, d2, select(on_bc, beyond_b, Lane(1.0))));
  const Lane under = select(on_ab, d1 - d3, select(on_ac, d2 - d6, select(on_bc, beyond_b + beyond_c, va + vb + vc)));
  const Lane t = over / under;
  Lane3 q = a + (vb * t) * ab + (vc * t) * ac;
  q = select(on_bc, b + t * (c - b), q);
  q = select(on_ac, a + t * ac, q);
  q = select(at_c, c, q);
  q = select(on_ab, a + t * ab, q);
  q = select(at_b, b, q);
  q = select(at_a, a, q);
  Lane place = select(on_bc, Lane(1.0), Lane(-1.0));
  place = select(on_ac, Lane(2.0), place);
  place = select(at_c, Lane(5.0), place);
  place = select(on_ab, zero, place);
  place = select(at_b, Lane(4.0), place);
  place = select(at_a, Lane(3.0), place);
  const Lane3 apart = p - q;
  const Lane squared = dot(apart, apart);
  q.x.store(out.nearest.x.data() + k);
  q.y.store(out.nearest.y.data() + k);
  q.z.store(out.nearest.z.data() + k);
  place.store(out.place.data() + k);
  squared.store(out.squared.data() + k);
  sqrt(squared).store(out.distance.data() + k);
}

HWY_NOINLINE void examine_all_vertices(const CornerQueue& queue, CornerAnswers& out) {
  for (std::size_t k = 0; k < queue.count; k += kLanes) examine_in_lanes(queue, k, out);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(examine_all_vertices);

}  // namespace

void examine_vertices_at_once(CornerQueue& queue, CornerAnswers& answers) {
  constexpr std::size_t kMaxLanes = 8;
  static_assert(kCornersAtOnce % kMaxLanes == 0);
  for (std::size_t k = queue.count; k % kMaxLanes != 0; ++k) {  // lanes beyond the last corner repeat it
    for (CornerVectors* of : {&queue.p, &queue.a, &queue.b, &queue.c}) of->set(k, of->at(queue.count - 1));
  }
  HWY_DYNAMIC_DISPATCH(examine_all_vertices)(queue, answers);
}

}  // namespace scree
#endif
