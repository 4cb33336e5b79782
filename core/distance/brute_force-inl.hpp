// Exact distance of two triangles by enumeration with shared subexpressions, branch free in the common case.
//
// The closest points of two disjoint triangles lie on an edge of each, or on a vertex of one and the face of
// the other. So the answer is the least of
//   9 edge-edge distances    from the cross product of the edges: the Gram determinant aa bb - ab^2 would lose
//                            half of the digits on nearly parallel edges
//   2 vertex-face distances  one for each face: only the vertex nearest to the plane can be a solution that is
//                            not also on an edge
// and 0 when an edge of one pierces the other. Every candidate is evaluated at explicit points of the two
// triangles, so no rounding can make the answer smaller than the truth by more than the evaluation's own error.
//
// Letters: a[i], b[j] edges from vertex i to i+1; r(i,j) = A_i - B_j; P = A_i + s a_i, Q = B_j + t b_j;
// n = a_i x b_j; m = b_j x r(i,j); D = P - Q. Recurrences along i (A_{i+1} = A_i + a_i):
//   b.r += a.b      b x r -= a x b      and along j      a.r -= a.b
// and with g = a.b / a.a, h = a.b / b.b the second and third clamp of the segment-segment solution cost one
// fused multiply-add each. The edges of a triangle sum to 0, so n, a.b and the signs of the third edge of A are sums
// of those of the other two: additions, which run beside the multiplications.
//
// Rare lanes are flagged and solved again (solve_rare), lane by lane, so the answer of a pair never depends on its
// neighbours in the batch: those where the signs say that an edge pierces a face, those that all but touch, and those
// whose size would overflow or underflow a fourth power of a length. Whether a pair intersects is then decided
// exactly (triangle_intersection.hpp): distance 0 means a common point, touching included, and nothing else does.
// Thin triangles are rare lanes as well: in double precision the sums for a.b, and a vertex-face solution without
// correction, need a bounded aspect; in single precision their rounding is too large. Single precision settles its
// rare lanes in double.
#if defined(SCREE_CORE_DISTANCE_BRUTE_FORCE_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_CORE_DISTANCE_BRUTE_FORCE_INL_HPP_
#undef SCREE_CORE_DISTANCE_BRUTE_FORCE_INL_HPP_
#else
#define SCREE_CORE_DISTANCE_BRUTE_FORCE_INL_HPP_
#endif

#include "core/distance/simd-inl.hpp"
#include "core/distance/triangle_intersection.hpp"

#ifdef __clang__
#define SCREE_UNROLL_3 _Pragma("unroll 3")
#else
#define SCREE_UNROLL_3 _Pragma("GCC unroll 3")
#endif

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

template <class T>
struct Limits;
template <>
struct Limits<double> {
  /// Unit roundoff.
  static constexpr double u = 1.1102230246251565e-16;
  /// Squared sizes handled without scaling: fourth powers, slivers included, stay normal numbers.
  static constexpr double smallest_squared = 0x1p-300, largest_squared = 0x1p+300;
  static constexpr double huge = 1e300, tiny = 1e-300;
  /// Pairs closer than this times the longest edge are looked at exactly. The sign of a determinant is wrong when two
  /// lines are nearer than its error e over the sine of their angle, and the triangles then are at most sqrt(e) apart:
  /// 2e-7 for 400 roundoffs (counted: 150). Far below any margin, so that it costs nothing.
  static constexpr double contact_ratio = 0x1p-22;
};
template <>
struct Limits<float> {
  static constexpr float u = 5.9604645e-8f;
  static constexpr float smallest_squared = 0x1p-24f, largest_squared = 0x1p+40f;
  static constexpr float huge = 3e38f, tiny = 1e-37f;
  /// Here sqrt(e) would be a hundredth: signs are taken with their error instead (see the end of brute_force), and this only keeps
  /// distances exact that are all rounding.
  static constexpr float contact_ratio = 0x1p-20f;
  /// Errors of the signed volumes and of the heights of pairs that meet, in cubes of the longest edge (counted: 150 and 30
  /// roundoffs).
  static constexpr float slack = 192 * u, height_slack = 64 * u;
};

/// Crossings of an edge and a face that agree within this times the longest edge make up the point of an intersection.
inline constexpr int kCrossingRoundoffs = 4;
/// Lanes of the widest vector.
inline constexpr int kWidestLanes = 16;
/// A determinant beyond this many roundoffs of its terms has a certain sign (counted: at most 11).
inline constexpr int kCertainRoundoffs = 16;
/// The short cuts of the common case need triangles whose height is at least 2^-9 of their longest edge: then the
/// error they make, (2^9 roundoffs)^2 / 2 over a distance of at least the contact ratio, is far below a roundoff.
/// In single precision the limit is 2^-7: there the corrected foot of a vertex on a thin face is off as much.
template <class T>
inline constexpr T kThinnest2 = sizeof(T) == 8 ? T(0x1p-18) : T(0x1p-14);

/// Pairs in the lanes of one vector, in eighteen rows of a batch, read where they are needed.
template <class T>
struct PairRows {
  const T* values;
  std::int64_t stride;
  /// Corner 0-2 of A, 3-5 of B.
  HWY_INLINE Pack3<T> corner(int k) const {
    const T* at = values + 3 * k * stride;
    return {Pack<T>::load(at), Pack<T>::load(at + stride), Pack<T>::load(at + 2 * stride)};
  }
  HWY_INLINE TrianglePack<T> triangle(int side) const { return {{corner(3 * side), corner(3 * side + 1), corner(3 * side + 2)}}; }
};
template <class T>
HWY_INLINE void store_corner(const Pack3<T>& p, T* to, std::int64_t stride) {
  p.x.store(to);
  p.y.store(to + stride);
  p.z.store(to + 2 * stride);
}

/// Where the closest points are, as a small number in a lane (see decode_features):
/// 3 i + j edge i of A, edge j of B; 9 + k vertex k of A, face of B; 12 + k face of A, vertex k of B;
/// 15 + i edge i of A through B; 18 + i edge i of B through A.
inline constexpr int kCodeVertexA = 9, kCodeVertexB = 12, kCodeEdgeA = 15, kCodeEdgeB = 18;
/// Added for edge-edge codes, when the point is an end of the edge.
inline constexpr int kCodeS0 = 32, kCodeS1 = 64, kCodeT0 = 128, kCodeT1 = 256;

template <class T>
struct Solution {
  Pack<T> distance;
  Pack3<T> point_a, point_b, difference;  ///< difference = point_a - point_b, without their rounding
  Pack<T> code;
};

/// How much of the solution is wanted.
enum class Want { distance, points, points_and_difference };

/// Signs that decide piercing: w[i][j] = a_i . (b_j x r_ij), heights of A's vertices over B's plane and of B's over A's.
template <class T>
struct Orientation {
  Pack<T> w[3][3], height_a[3], height_b[3];
};

template <class T>
HWY_INLINE Pack<T> longest_squared(const Pack3<T> a[3]) {
  return max(max(dot(a[0], a[0]), dot(a[1], a[1])), dot(a[2], a[2]));
}

/// Both triangles of each lane over the largest power of two in them, exactly.
template <class T>
struct ScaledPair {
  TrianglePack<T> a, b;
  Pack<T> unit;    ///< what they were divided by
  Pack<T> poison;  ///< 0, or no number when a coordinate is none

  HWY_INLINE ScaledPair(const TrianglePack<T>& A, const TrianglePack<T>& B) {
    using V = Pack<T>;
    const V zero(T(0)), one(T(1));
    const Pack3<T> r = A.p[0] - B.p[0];
    V size = largest_component(r), sum = r.x + r.y + r.z;
    for (int k = 0; k < 3; ++k) {
      const Pack3<T> ea = A.p[(k + 1) % 3] - A.p[k], eb = B.p[(k + 1) % 3] - B.p[k];
      size = max(size, max(largest_component(ea), largest_component(eb)));
      sum = sum + (ea.x + ea.y + ea.z) + (eb.x + eb.y + eb.z);
    }
    const V power = power_of_two_below(size);
    unit = select(power > zero, power, one);
    poison = zero * sum;
    const V inverse = one / unit;
    for (int k = 0; k < 3; ++k) {
      a.p[k] = inverse * A.p[k];
      b.p[k] = inverse * B.p[k];
    }
  }

  /// The solution of the scaled pair in the units of the original.
  HWY_INLINE void put_back(const Solution<T>& s, Solution<T>& out) const {
    out.distance = mul_add(unit, s.distance, poison);
    out.point_a = unit * s.point_a;
    out.point_b = unit * s.point_b;
    out.difference = unit * s.difference;
    out.code = s.code;
  }
};

/// Edges of P against the face F, in the lanes where something may meet: out becomes the crossing whose points agree
/// best; those that agree within rounding are counted and summed; certain collects the lanes in which signs beyond
/// doubt prove an intersection. w[i][j] belongs to edge i of P and edge j of F; height to the vertices of P.
template <class T>
HWY_INLINE void cross_face(const TrianglePack<T>& p, const TrianglePack<T>& f, const Pack<T> w[3][3], const Pack<T> height[3],
                           Pack<T> w_certain, Pack<T> height_certain, Pack<T> crossing2, Mask<T> lanes, bool p_is_a, Solution<T>& out,
                           Pack<T>& count, Pack3<T>& sum, Mask<T>& certain) {
  using V = Pack<T>;
  const V zero(T(0)), one(T(1));
  const Pack3<T> f0 = f.p[1] - f.p[0], f2 = f.p[0] - f.p[2], n = cross(f2, f0);
  const Pack3<T> gu = cross(n, f2), gv = cross(n, f0);
  const V inverse = one / max(dot(n, n), V(Limits<T>::tiny));
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const Pack3<T> edge = p.p[k] - p.p[i];
    const V rise = height[i] - height[k];
    const Mask<T> flat = abs(rise) <= zero;
    const V s = select(flat, zero, clamp01(height[i] / select(flat, one, rise)));
    // the crossing in the face's coordinates x = u f0 - v f2, once corrected, then clamped into the face
    const Pack3<T> x = mul_add(s, edge, p.p[i] - f.p[0]);
    V u = dot(gu, x) * inverse, v = dot(gv, x) * inverse;
    Pack3<T> d = neg_mul_add(u, f0, mul_add(v, f2, x));
    u = max(mul_add(dot(gu, d), inverse, u), zero);
    v = max(mul_add(dot(gv, d), inverse, v), zero);
    const V shrink = one / max(u + v, one);
    u = u * shrink;
    v = v * shrink;
    d = neg_mul_add(u, f0, mul_add(v, f2, x));
    const V d2 = dot(d, d), distance = sqrt(d2);
    const Pack3<T> on_p = mul_add(s, edge, p.p[i]), on_f = mul_add(u, f0, neg_mul_add(v, f2, f.p[0]));
    const Mask<T> better = lanes & (distance < out.distance);
    out.distance = select(better, distance, out.distance);
    out.point_a = select(better, p_is_a ? on_p : on_f, out.point_a);
    out.point_b = select(better, p_is_a ? on_f : on_p, out.point_b);
    out.code = select(better, V(static_cast<T>((p_is_a ? kCodeEdgeA : kCodeEdgeB) + i)), out.code);
    const V least = min(min(abs(w[i][0]), abs(w[i][1])), abs(w[i][2]));
    const V signs = sign_differs_and(sign_all_equal(w[i][0], w[i][1], w[i][2]), height[i], height[k]);
    const Mask<T> pierces =
        lanes & mask_of_sign(signs) & (least > w_certain) & (abs(height[i]) > height_certain) & (abs(height[k]) > height_certain);
    certain = certain | pierces;
    const Mask<T> meets = pierces | (lanes & (d2 <= crossing2));
    count = select(meets, count + one, count);
    sum = select(meets, sum + on_p, sum);
  }
}

/// 1 in the lanes whose triangles have a common point, by exact arithmetic, 0 in the others.
template <class T>
HWY_INLINE Pack<T> decide_exactly(const TrianglePack<T>& a, const TrianglePack<T>& b, Mask<T> lanes) {
  alignas(64) T coordinates[18][kWidestLanes], wanted[kWidestLanes] = {};
  for (int k = 0; k < 3; ++k) {
    store_corner(a.p[k], coordinates[3 * k], kWidestLanes);
    store_corner(b.p[k], coordinates[9 + 3 * k], kWidestLanes);
  }
  select(lanes, Pack<T>(T(1)), Pack<T>(T(0))).store(wanted);
  for (std::int64_t lane = 0; lane < lane_count<T>(); ++lane) {
    if (wanted[lane] == 0) continue;
    double pair[18];
    for (int c = 0; c < 18; ++c) pair[c] = static_cast<double>(coordinates[c][lane]);
    wanted[lane] = triangles_intersect(pair, pair + 9) ? T(1) : T(0);
  }
  return Pack<T>::load(wanted);
}

/// Lanes in which signs say that an edge pierces a face, or in which the distance is close to 0. exact_a, exact_b: the
/// coordinates as they were given, scaled as they were solved; o from the full kernel.
template <class T>
HWY_NOINLINE void settle_contact(const TrianglePack<T>& exact_a, const TrianglePack<T>& exact_b, const ScaledPair<T>& scaled,
                                 const Orientation<T>& o, Mask<T> lanes, Solution<T>& out) {
  using V = Pack<T>;
  const TrianglePack<T>&a = scaled.a, &b = scaled.b;
  const V zero(T(0)), one(T(1)), half(T(0.5));
  const Pack3<T> ea[3] = {a.p[1] - a.p[0], a.p[2] - a.p[1], a.p[0] - a.p[2]};
  const Pack3<T> eb[3] = {b.p[1] - b.p[0], b.p[2] - b.p[1], b.p[0] - b.p[2]};
  const V la2 = longest_squared(ea), lb2 = longest_squared(eb), l2 = max(la2, lb2);
  const V la = sqrt(la2), lb = sqrt(lb2);
  const Pack3<T> r = a.p[0] - b.p[0];
  const V reach = sqrt(dot(r, r)) + la + lb;
  const V crossing2 = l2 * V(T(kCrossingRoundoffs * kCrossingRoundoffs) * Limits<T>::u * Limits<T>::u);
  const V scale = V(T(kCertainRoundoffs) * Limits<T>::u) * reach;
  V transposed[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) transposed[j][i] = o.w[i][j];
  V count = zero;
  Pack3<T> sum{zero, zero, zero};
  Mask<T> certain = one < zero;
  Solution<T> met = out;
  cross_face(a, b, o.w, o.height_a, scale * la * lb, scale * lb2, crossing2, lanes, true, met, count, sum, certain);
  cross_face(b, a, transposed, o.height_b, scale * la * lb, scale * la2, crossing2, lanes, false, met, count, sum, certain);
  Mask<T> meeting = certain;
  const Mask<T> undecided = lanes & !certain;
  if (any(undecided)) meeting = meeting | (decide_exactly(exact_a, exact_b, undecided) > zero);
  const V inverse = one / max(count, one);
  const Pack3<T> middle = select(count > zero, inverse * sum, half * (met.point_a + met.point_b));
  // apart by less than a distance can tell: any number below its rounding, but not 0
  const V least = sqrt(l2) * V(Limits<T>::u * Limits<T>::u);
  out.distance = select(meeting, zero, select(lanes, max(out.distance, least), out.distance));
  out.point_a = select(meeting, middle, out.point_a);
  out.point_b = select(meeting, middle, out.point_b);
  out.difference = select(meeting, Pack3<T>{zero, zero, zero}, out.difference);
  out.code = select(meeting, met.code, out.code);
}

/// Best candidate so far: squared distance, its two parameters, its code.
template <class T>
struct Candidate {
  Pack<T> squared, s, t, code;
  HWY_INLINE void offer(Pack<T> squared_, Pack<T> s_, Pack<T> t_, Pack<T> code_) {
    const Mask<T> better = squared_ < squared;
    squared = min(squared_, squared);
    s = select(better, s_, s);
    t = select(better, t_, t);
    code = select(better, code_, code);
  }
  HWY_INLINE void offer_if(Mask<T> better, Pack<T> squared_, Pack<T> s_, Pack<T> t_, Pack<T> code_) {
    squared = select(better, squared_, squared);
    s = select(better, s_, s);
    t = select(better, t_, t);
    code = select(better, code_, code);
  }
};

/// The vertex nearest to the plane of a face, against the face. f0, f2: edges of the face that leave and enter its
/// vertex 0; q[k] = vertex k minus that vertex 0, or its negative when kNegated (then D = P - Q keeps its sign).
/// kCorrected: for slivers the first solution is off by roundoff times aspect. Returns the square of twice the area.
template <class T, bool kNegated, bool kCorrected>
HWY_INLINE Pack<T> vertex_face(const Pack3<T>& f0, const Pack3<T>& f2, const Pack3<T> q[3], int code, Pack<T> height[3],
                               Candidate<T>& best) {
  using V = Pack<T>;
  const V zero(T(0)), one(T(1));
  const Pack3<T> n = kNegated ? cross(f0, f2) : cross(f2, f0);
  SCREE_UNROLL_3
  for (int k = 0; k < 3; ++k) height[k] = dot(n, q[k]);
  const V h0 = abs(height[0]), h1 = abs(height[1]), h2 = abs(height[2]);
  const Mask<T> first = h1 < h0;
  const Mask<T> second = h2 < min(h0, h1);
  const Pack3<T> p = select(second, q[2], select(first, q[1], q[0]));
  const V c = select(second, V(T(code + 2)), select(first, V(T(code + 1)), V(T(code))));
  // foot = vertex 0 + u f0 - v f2
  const Pack3<T> gu = cross(n, f2), gv = cross(n, f0);
  const V nn = dot(n, n), inverse = one / max(nn, V(Limits<T>::tiny));
  V u = dot(gu, p) * inverse, v = dot(gv, p) * inverse;
  const auto residual = [&] { return kNegated ? mul_add(u, f0, neg_mul_add(v, f2, p)) : neg_mul_add(u, f0, mul_add(v, f2, p)); };
  Pack3<T> d = residual();
  if constexpr (kCorrected) {
    u = mul_add(dot(gu, d), inverse, u);
    v = mul_add(dot(gv, d), inverse, v);
    d = residual();
  }
  const V squared = dot(d, d);
  const Mask<T> inside = min(min(u, v), one - (u + v)) >= zero;
  best.offer_if(inside & (squared < best.squared), squared, u, v, c);
  return nn;
}

/// Lanes whose solution has to be looked at again, and why.
template <class T>
struct RareLanes {
  Mask<T> contact;  ///< signs say that an edge pierces a face, or the distance is close to 0
  Mask<T> thin;     ///< a triangle of too large an aspect for the short cuts
  Mask<T> unusual;  ///< size far from 1, or no number
};

/// The common case: right in every lane that is not rare. kShort takes the short cuts that need a bounded aspect.
template <class T, Want kWant, bool kShort>
HWY_INLINE Solution<T> brute_force(const PairRows<T>& pair, Orientation<T>& o, RareLanes<T>& rare) {
  using V = Pack<T>;
  // in single precision there is no room for them
  constexpr bool kShortCuts = kShort && sizeof(T) == 8;
  const V zero(T(0)), one(T(1)), tiny(Limits<T>::tiny);
  Pack3<T> a[3];
  V aa[3], inverse_aa[3], ar[3], la2, lb2, size2;
  SCREE_UNROLL_3
  for (int i = 0; i < 3; ++i) {
    const Pack3<T> corner = pair.corner(i);
    a[i] = pair.corner((i + 1) % 3) - corner;
    aa[i] = dot(a[i], a[i]);
    inverse_aa[i] = one / max(aa[i], tiny);
    ar[i] = dot(a[i], corner - pair.corner(3)) * inverse_aa[i];
  }
  la2 = max(max(aa[0], aa[1]), aa[2]);
  size2 = aa[0] + aa[1];

  // edges against edges
  Candidate<T> best;
  SCREE_UNROLL_3
  for (int j = 0; j < 3; ++j) {
    const Pack3<T> b0 = pair.corner(3 + j), b = pair.corner(3 + (j + 1) % 3) - b0, r0 = pair.corner(0) - b0;
    const V bb = dot(b, b), inverse_bb = one / max(bb, tiny);
    lb2 = j == 0 ? bb : max(lb2, bb);
    if (j < 2) size2 = size2 + bb;
    // in three steps for the three edges of A at once: the processor looks ahead less far than one of them is long
    Pack3<T> m[3], n[3];
    V ab[3], g[3], h[3], s[3], t[3], squared[3], br[3];
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      // the edges of a triangle sum to 0, and so do their products with b
      const bool last = kShort && i == 2;
      ab[i] = kShortCuts && i == 2 ? ab[0] + ab[1] : dot(a[i], b);
      g[i] = ab[i] * inverse_aa[i];
      h[i] = ab[i] * inverse_bb;
      m[i] = i == 0 ? cross(b, r0) : (last ? n[1] - m[1] : m[i - 1] - n[i - 1]);
      n[i] = last ? n[0] + n[1] : cross(a[i], b);
      if (i < 2 || !kShort) o.w[i][j] = dot(a[i], m[i]);
      s[i] = dot(m[i], n[i]) / max(dot(n[i], n[i]), tiny);
      br[i] = i == 0 ? dot(b, r0) * inverse_bb : br[i - 1] + h[i - 1];
    }
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      s[i] = clamp01(s[i]);
      if (kShortCuts && i == 2) {  // ab, g and h have the other sign
        t[i] = clamp01(neg_mul_add(s[i], h[i], br[i]));
        s[i] = clamp01(neg_mul_sub(t[i], g[i], ar[i]));
        if (j < 2) ar[i] = ar[i] + g[i];
      } else {
        t[i] = clamp01(mul_add(s[i], h[i], br[i]));
        s[i] = clamp01(mul_sub(t[i], g[i], ar[i]));
        if (j < 2) ar[i] = ar[i] - g[i];
      }
    }
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      const Pack3<T> r = i == 0 ? r0 : pair.corner(i) - b0;
      const Pack3<T> d = neg_mul_add(t[i], b, mul_add(s[i], a[i], r));
      squared[i] = dot(d, d);
    }
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      if (i == 0 && j == 0) {
        best = {squared[0], s[0], t[0], zero};
      } else {
        best.offer(squared[i], s[i], t[i], V(T(3 * i + j)));
      }
    }
  }

  // vertices against faces
  Pack3<T> q[3];
  {
    const Pack3<T> b0 = pair.corner(3), f0 = pair.corner(4) - b0, f2 = b0 - pair.corner(5);
    SCREE_UNROLL_3
    for (int k = 0; k < 3; ++k) q[k] = pair.corner(k) - b0;
    const V nn = vertex_face<T, false, !kShortCuts>(f0, f2, q, kCodeVertexA, o.height_a, best);
    rare.thin = nn <= V(kThinnest2<T>) * lb2 * lb2;
  }
  {
    const Pack3<T> a0 = pair.corner(0), f0 = pair.corner(1) - a0, f2 = a0 - pair.corner(2);
    SCREE_UNROLL_3
    for (int k = 0; k < 3; ++k) q[k] = a0 - pair.corner(3 + k);
    const V nn = vertex_face<T, true, !kShortCuts>(f0, f2, q, kCodeVertexB, o.height_b, best);
    rare.thin = rare.thin | (nn <= V(kThinnest2<T>) * la2 * la2);
  }

  Solution<T> out;
  out.distance = sqrt(best.squared);
  out.code = best.code;
  if constexpr (kWant == Want::distance) {
    out.point_a = out.point_b = out.difference = Pack3<T>{zero, zero, zero};
  } else {
    // weights of the vertices 1 and 2 of each triangle, from the winner's parameters
    const V code = best.code, s = best.s, t = best.t, os = one - s, ot = one - t;
    const Mask<T> i0 = code < V(T(3)), i1 = code < V(T(6)), ee = code < V(T(9)), va = code < V(T(12));
    const V first = where_not(i0, select(i1, V(T(3)), select(ee, V(T(6)), select(va, V(T(9)), V(T(12))))));
    const V k = code - first;
    const Mask<T> k0 = k < V(T(0.5)), k1 = k < V(T(1.5));
    const V e1 = select(i0, s, where(i1, os)), e2 = where_not(i0, select(i1, s, os));
    const V f1 = select(k0, t, where(k1, ot)), f2 = where_not(k0, select(k1, t, ot));
    const V v1 = where_not(k0, where(k1, one)), v2 = where_not(k1, one);
    const V wa1 = select(ee, e1, select(va, v1, s)), wa2 = select(ee, e2, select(va, v2, t));
    const V wb1 = select(ee, f1, select(va, s, v1)), wb2 = select(ee, f2, select(va, t, v2));
    const Pack3<T> a0 = pair.corner(0), b0 = pair.corner(3), a1 = pair.corner(1) - a0, a2 = a0 - pair.corner(2);
    const Pack3<T> b1 = pair.corner(4) - b0, b2 = b0 - pair.corner(5);
    out.point_a = mul_add(wa1, a1, neg_mul_add(wa2, a2, a0));
    out.point_b = mul_add(wb1, b1, neg_mul_add(wb2, b2, b0));
    if constexpr (kWant == Want::points_and_difference) {
      const Pack3<T> on_a = mul_add(wa1, a1, neg_mul_add(wa2, a2, a0 - b0));
      out.difference = neg_mul_add(wb1, b1, mul_add(wb2, b2, on_a));
    } else {
      out.difference = Pack3<T>{zero, zero, zero};
    }
    // an end of the edge or the other, so the sum of both is one of them
    const V ends = (where(s <= zero, V(T(kCodeS0))) + where(s >= one, V(T(kCodeS1)))) +
                   (where(t <= zero, V(T(kCodeT0))) + where(t >= one, V(T(kCodeT1))));
    out.code = code + where(ee, ends);
  }

  // an edge goes through a face when it passes its three edges on one side and its ends lie on both sides
  if (kShort) {
    // sum over i of w[i][j] = b_j . (a_0 x a_1), the rise of B's edge over A's plane
    SCREE_UNROLL_3
    for (int j = 0; j < 3; ++j) o.w[2][j] = (o.height_b[(j + 1) % 3] - o.height_b[j]) - (o.w[0][j] + o.w[1][j]);
  }
  V signs;
  if constexpr (kShort && sizeof(T) == 4) {
    // beyond doubt no edge does: for each, the sum of both tests
    const V l2 = max(la2, lb2), l3 = l2 * sqrt(l2), slack = V(Limits<T>::slack) * l3, height_slack = V(Limits<T>::height_slack) * l3;
    // negative where a volume is surely negative, and where it is surely positive
    V below[3][3], above[3][3], a_below[3], a_above[3], b_below[3], b_above[3];
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      SCREE_UNROLL_3
      for (int j = 0; j < 3; ++j) below[i][j] = o.w[i][j] + slack, above[i][j] = slack - o.w[i][j];
      a_below[i] = o.height_a[i] + height_slack, a_above[i] = height_slack - o.height_a[i];
      b_below[i] = o.height_b[i] + height_slack, b_above[i] = height_slack - o.height_b[i];
    }
    V apart;
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      // the line passes the face, for it has edges on both sides, or both ends are on one side
      const V passes_b = sign_and(sign_or(below[i][0], below[i][1], below[i][2]), sign_or(above[i][0], above[i][1], above[i][2]));
      const V passes_a = sign_and(sign_or(below[0][i], below[1][i], below[2][i]), sign_or(above[0][i], above[1][i], above[2][i]));
      const V both = sign_and(sign_or(passes_b, sign_and(a_below[i], a_below[k]), sign_and(a_above[i], a_above[k])),
                              sign_or(passes_a, sign_and(b_below[i], b_below[k]), sign_and(b_above[i], b_above[k])));
      apart = i == 0 ? both : sign_and(apart, both);
    }
    // what meets is nearer than twice the smaller triangle is long
    signs = sign_not(sign_or(apart, mul_sub(V(T(4)), min(la2, lb2), best.squared)));
  } else {
    V through[3], back[3];
    SCREE_UNROLL_3
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      through[i] = sign_differs_and(sign_all_equal(o.w[i][0], o.w[i][1], o.w[i][2]), o.height_a[i], o.height_a[k]);
      back[i] = sign_differs_and(sign_all_equal(o.w[0][i], o.w[1][i], o.w[2][i]), o.height_b[i], o.height_b[k]);
    }
    signs = sign_or(through[0], through[1], sign_or(through[2], back[0], sign_or(back[1], back[2])));
  }
  rare.contact = mask_of_sign(signs) | (best.squared <= max(la2, lb2) * V(Limits<T>::contact_ratio * Limits<T>::contact_ratio));
  // a sum, not a maximum, so that a coordinate that is no number shows; all six vertices are in it
  const V all2 = size2 + best.squared;
  rare.unusual = !((all2 >= V(Limits<T>::smallest_squared)) & (all2 <= V(Limits<T>::largest_squared)));
  return out;
}

/// Of these lanes, those in which signs beyond doubt say that an edge of one triangle pierces the other. From the beginning,
/// like solve_rare; sizes near 1.
template <class T>
HWY_NOINLINE Mask<T> surely_meet(const PairRows<T>& pair, Mask<T> lanes) {
  using V = Pack<T>;
  // roundoffs of the longest edge squared times the way across both triangles (counted: 24)
  constexpr T kSureRoundoffs = T(64) * Limits<T>::u;
  const TrianglePack<T> a = pair.triangle(0), b = pair.triangle(1);
  Pack3<T> ea[3], eb[3];
  for (int k = 0; k < 3; ++k) {
    ea[k] = a.p[(k + 1) % 3] - a.p[k];
    eb[k] = b.p[(k + 1) % 3] - b.p[k];
  }
  const Pack3<T> na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]), r = a.p[0] - b.p[0];
  V w[3][3], height_a[3], height_b[3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) w[i][j] = dot(ea[i], cross(eb[j], a.p[i] - b.p[j]));
    height_a[i] = dot(nb, a.p[i] - b.p[0]);
    height_b[i] = dot(na, b.p[i] - a.p[0]);
  }
  const V la2 = longest_squared(ea), lb2 = longest_squared(eb), l2 = max(la2, lb2);
  const V slack = V(kSureRoundoffs) * l2 * (sqrt(dot(r, r)) + sqrt(la2) + sqrt(lb2));
  const auto pierces = [&](const V& w0, const V& w1, const V& w2, const V& h0, const V& h1) {
    const V least = min(min(min(abs(w0), abs(w1)), abs(w2)), min(abs(h0), abs(h1)));
    return mask_of_sign(sign_differs_and(sign_all_equal(w0, w1, w2), h0, h1)) & (least > slack);
  };
  Mask<T> meet = V(T(1)) < V(T(0));
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    meet = meet | pierces(w[i][0], w[i][1], w[i][2], height_a[i], height_a[k]);
    meet = meet | pierces(w[0][i], w[1][i], w[2][i], height_b[i], height_b[k]);
  }
  return meet & lanes;
}

template <class T, Want kWant, bool kShort>
HWY_NOINLINE void solve_once(const PairRows<T>& pair, Orientation<T>& o, RareLanes<T>& rare, Solution<T>& out) {
  out = brute_force<T, kWant, kShort>(pair, o, rare);
}

/// The answer in every lane, from the beginning and scaled to a size near 1. The kernel proper keeps nothing for this:
/// holding its operands over the branch would cost the common case a good part of its speed. unsettled: lanes of
/// single precision that all but touch, which double precision has to decide.
template <class T, Want kWant>
HWY_NOINLINE void solve_rare(const PairRows<T>& pair, Solution<T>& out, Mask<T>& unsettled) {
  const TrianglePack<T> a = pair.triangle(0), b = pair.triangle(1);
  const ScaledPair<T> scaled(a, b);
  alignas(64) T values[18 * kWidestLanes];
  for (int k = 0; k < 3; ++k) {
    store_corner(scaled.a.p[k], values + 3 * k * kWidestLanes, kWidestLanes);
    store_corner(scaled.b.p[k], values + (9 + 3 * k) * kWidestLanes, kWidestLanes);
  }
  const PairRows<T> rows{values, kWidestLanes};
  Orientation<T> o;
  RareLanes<T> rare;
  Solution<T> s;
  solve_once<T, kWant, true>(rows, o, rare, s);
  unsettled = rare.contact | rare.thin;
  if constexpr (sizeof(T) == 8) {
    if (any(unsettled)) {
      RareLanes<T> again;
      Solution<T> full;
      solve_once<T, kWant, false>(rows, o, again, full);
      const Mask<T> contact = unsettled & (rare.contact | again.contact);
      if (any(contact)) settle_contact(a, b, scaled, o, contact, full);
      s.distance = select(unsettled, full.distance, s.distance);
      s.point_a = select(unsettled, full.point_a, s.point_a);
      s.point_b = select(unsettled, full.point_b, s.point_b);
      s.difference = select(unsettled, full.difference, s.difference);
      s.code = select(unsettled, full.code, s.code);
    }
  }
  scaled.put_back(s, out);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
