// The kernel of edge_lanes.hpp, compiled once for every instruction set, as ball_forces.cpp. The order of operations is that of
// edge_features.cpp, line by line: whoever changes one changes both. Tests compare them (tests/solver/edge_lanes_test.cpp).
//
// Letters of docs/reference/contact-law.md section 3.2: u, v edge vectors, s, t parameters, r = x_A - x_B = g n.
#include "solver/lanes/edge_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/edge_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/bodies/lanes-inl.hpp"
#include "solver/lanes/columns-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// The numbers of EdgeRow, an edge in each lane.
class LaneEdges {
 public:
  HWY_INLINE explicit LaneEdges(const EdgeRow* const* rows) : rows_(rows) {
    static_assert(offsetof(EdgeRow, ends) == 0 && offsetof(EdgeRow, into) == 6 * sizeof(double) &&
                  offsetof(EdgeRow, conormal) == 12 * sizeof(double) && sizeof(EdgeRow) == 20 * sizeof(double));
    Lane column[12];
    for (std::size_t first = 0; first < 12; first += 4) load(first, column + first);
    start = {column[0], column[1], column[2]};
    along = {column[3], column[4], column[5]};
    into[0] = {column[6], column[7], column[8]};
    into[1] = {column[9], column[10], column[11]};
  }
  /// Most edges do not need them.
  HWY_INLINE void load_conormals(Lane3* conormal) const {
    Lane column[8];
    load(12, column);
    load(16, column + 4);  // and what stands after them
    conormal[0] = {column[0], column[1], column[2]};
    conormal[1] = {column[3], column[4], column[5]};
  }

  Lane3 start, along, into[2];

 private:
  HWY_INLINE void load(std::size_t first, Lane* column) const {
    load_columns([this, first](std::size_t lane) { return reinterpret_cast<const double*>(rows_[lane]) + first; }, column);
  }

  const EdgeRow* const* rows_;
};

struct LaneRotation {
  Lane3 row[3];
  HWY_INLINE Lane3 times(const Lane3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
  HWY_INLINE Lane3 transpose_times(const Lane3& v) const { return v.x * row[0] + v.y * row[1] + v.z * row[2]; }
};

/// smooth_switch() of arguments above 0.
HWY_INLINE Lane smooth_switch(Lane y, Lane& derivative) {
  const Lane zero(0.0), one(1.0);
  const auto is_on = y >= one;
  derivative = select(is_on, zero, Lane(6.0) * y * (one - y));
  return select(is_on, one, y * y * (Lane(3.0) - Lane(2.0) * y));
}

HWY_INLINE Lane smaller(Lane a, Lane b) { return select(b < a, b, a); }  // std::min(a, b)

HWY_INLINE void examine_in_lanes(const EdgeQueue& queue, std::size_t k, EdgeAnswers& out) {
  const Lane zero(0.0), half(0.5), one(1.0);
  static_assert(sizeof(EdgePose) == 128 && offsetof(EdgePose, margin) == 14 * sizeof(double));
  Lane pose[16];
  for (std::size_t first = 0; first < 16; first += 4) {
    const auto at = [&](std::size_t lane) { return queue.poses[static_cast<std::size_t>(queue.pose[k + lane])].rotation.data() + first; };
    load_columns(at, pose + first);
  }
  const LaneRotation rotation{{{pose[0], pose[1], pose[2]}, {pose[3], pose[4], pose[5]}, {pose[6], pose[7], pose[8]}}};
  const Lane3 centre{pose[9], pose[10], pose[11]};
  const Lane scale_a = pose[12], scale_b = pose[13], margin = pose[14];
  const LaneEdges a(queue.a.data() + k), b(queue.b.data() + k);

  // where the lines are nearest
  const Lane3 pa = scale_a * a.start, u = scale_a * a.along;
  const Lane3 pb = rotation.times(scale_b * b.start) + centre, v = rotation.times(scale_b * b.along);
  const Lane3 r0 = pa - pb;
  const Lane uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r0), vr = dot(v, r0);
  const Lane det = uu * vv - uv * uv, sine2 = det / (uu * vv);
  const Lane s = (uv * vr - vv * ur) / det, t = (uu * vr - uv * ur) / det;
  const Lane3 xa = pa + s * u, xb = pb + t * v, r = xa - xb;
  const Lane g = length(r);
  auto found = (sine2 > Lane(kParallelCutoff)) & (s > zero) & (s < one) & (t > zero) & (t < one) & (g < margin) & (g > zero);
  const Lane3 n = (one / g) * r;

  // how far the normal leans out of the wedge over each face
  const Lane3 n_b = rotation.transpose_times(n);
  Lane y[4];
  Lane3 conormal[4];  // those of B in its own frame, until they are needed in that of A
  for (const bool of_a : {true, false}) {
    const std::size_t first = of_a ? 0 : 2;
    const Lane sign(of_a ? -1.0 : 1.0);
    const LaneEdges& edges = of_a ? a : b;
    const auto may_lean = [&](std::size_t side) { return sign * dot(of_a ? n : n_b, edges.into[side]) > zero; };
    const Mask<double> leans[2] = {may_lean(0), may_lean(1)};
    y[first] = y[first + 1] = zero;
    const bool has_folds = !of_a && queue.has_walls;
    if (!has_folds && !any(leans[0] | leans[1])) continue;
    edges.load_conormals(conormal + first);
    if (has_folds) {
      const Lane3 &one_face = conormal[2], &other = conormal[3];
      const auto in_fold = (dot(one_face, other) < Lane(kShallowFold)) & (dot(n_b, one_face) + dot(n_b, other) > zero);
      found = found & !in_fold;
    }
    for (std::size_t side = 0; side < 2; ++side) {
      Lane3& c = conormal[first + side];
      if (!of_a) c = rotation.times(c);
      y[first + side] = select(leans[side], sign * dot(n, c), zero);
      found = found & (y[first + side] < Lane(kFadeWedge));
    }
  }

  // a product of switches, and their slopes
  const Lane from_end_s = smaller(s, one - s), from_end_t = smaller(t, one - t);
  Lane of_s, of_t, of_sine, of_y[4], switch_y[4];
  const Lane switch_s = smooth_switch(from_end_s / Lane(kFadeEnd), of_s), switch_t = smooth_switch(from_end_t / Lane(kFadeEnd), of_t),
             switch_sine = smooth_switch(sine2 / Lane(kFadeParallel), of_sine);
  Lane weight = switch_s * switch_t * switch_sine;
  for (std::size_t i = 0; i < 4; ++i) {
    of_y[i] = zero;
    switch_y[i] = one;
    const auto leans = y[i] > zero;
    if (!any(leans)) continue;
    Lane slope;
    switch_y[i] = select(leans, smooth_switch(one - y[i] / Lane(kFadeWedge), slope), one);
    of_y[i] = select(leans, slope, zero);
    weight = weight * switch_y[i];
  }
  found = found & (weight >= Lane(kWeightCutoff));
  const auto store = [k](const Lane3& three, Lane last, EdgeAnswers::Fours& to) {
    hn::StoreInterleaved4(three.x.v, three.y.v, three.z.v, last.v, Tag<double>(), to.data() + 4 * k);
  };
  store(half * (xa + xb), margin - g, out.place);
  store(n, weight, out.direction);

  // gradient of the weight
  const Lane3 none{zero, zero, zero};
  of_s = of_s * (weight / switch_s / Lane(kFadeEnd) * select(s < half, one, -one));
  of_t = of_t * (weight / switch_t / Lane(kFadeEnd) * select(t < half, one, -one));
  of_sine = of_sine * (weight / switch_sine / Lane(kFadeParallel));
  auto faded = !(equal(of_s, zero) & equal(of_t, zero) & equal(of_sine, zero));
  Lane3 across = none, turning = none;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto counts = !equal(of_y[i], zero);
    if (!any(counts)) continue;
    faded = faded | counts;
    const Lane c = (i < 2 ? weight : -weight) / switch_y[i] * of_y[i] / Lane(kFadeWedge), over = c / g;
    const Lane3 tp = conormal[i] - dot(conormal[i], n) * n;
    across = select(counts, across + over * tp, across);
    of_s = select(counts, of_s + over * dot(tp, u), of_s);
    of_t = select(counts, of_t - over * dot(tp, v), of_t);
    if (i < 2) turning = select(counts, turning + c * cross(conormal[i], n), turning);
  }
  const Lane is_found = select(found, one, zero), is_faded = select(faded, one, zero);
  if (!any(faded)) {
    store(none, is_found, out.force);
    store(none, is_faded, out.couple);
    return;
  }
  const Lane p = -(vv * of_s + uv * of_t) / det, q = -(uv * of_s + uu * of_t) / det;
  const Lane3 force = across + p * u - q * v;
  Lane3 couple = cross(xa, force) + p * cross(u, r) + turning;
  if (const auto is_near_parallel = !equal(of_sine, zero); any(is_near_parallel))
    couple = select(is_near_parallel, couple + (of_sine * Lane(-2.0) * uv / (uu * vv)) * cross(u, v), couple);
  store(select(faded, force, none), is_found, out.force);
  store(select(faded, couple, none), is_faded, out.couple);
}

HWY_NOINLINE void examine_all(const EdgeQueue& queue, EdgeAnswers& out) {
  for (std::size_t k = 0; k < queue.count; k += kLanes) examine_in_lanes(queue, k, out);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(examine_all);

}  // namespace

void examine_edges_at_once(EdgeQueue& queue, EdgeAnswers& answers) {
  constexpr std::size_t kMaxLanes = 8;
  static_assert(kEdgesAtOnce % kMaxLanes == 0);
  for (std::size_t k = queue.count; k % kMaxLanes != 0; ++k) {  // lanes beyond the last edge repeat it
    queue.pose[k] = queue.pose[queue.count - 1];
    queue.a[k] = queue.a[queue.count - 1];
    queue.b[k] = queue.b[queue.count - 1];
  }
  HWY_DYNAMIC_DISPATCH(examine_all)(queue, answers);
}

}  // namespace scree
#endif
