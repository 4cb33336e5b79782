// Distance of two triangles by Newton's method on a penalised problem, with a certificate.
//
// Unknown x = (u, v, p, q): P = A0 + u e1 + v e2, Q = B0 + p f1 + q f2. Minimise
//   |P - Q|^2 / 2 + r / 2 sum max(0, c_i(x))^2,   c = {-u, -v, u + v - 1, -p, -q, p + q - 1}
// from x = 1/3, a fixed number of steps: (G + penalties + delta I) dx = gradient, G the Gram matrix of the edges.
// Source: K. Krestenitis, T. Weinzierl, Concurr. Comput. Pract. Exp. 2018. Departures: r and delta are multiples of
// the trace of G, so that the answer does not depend on units; the iterate only selects the active constraints, the
// problem with these as equations is solved exactly (polish); and the answer is judged by its optimality, not by
// the last step.
//
// Certificates, with D = P - Q and G_i = -D . A_i, the height of vertex i towards B (B likewise):
//   declared  the plane normal to D through P has A on one side up to gap_a = max G_i - G(P), so the distance is at
//             least |D| - (gap_a + gap_b) / |D|: a proof of separation, good to its tolerance.
//   strict    the optimality conditions hold with room to spare: vertices with weight are level with the highest, those
//             without lie clearly lower, and the system of the polish is well conditioned. Then the optimum is unique
//             and the error is of second order in the tolerance: below rounding.
// Neither holds for intersecting triangles, as it should be.
#if defined(SCREE_CORE_DISTANCE_PENALTY_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_CORE_DISTANCE_PENALTY_INL_HPP_
#undef SCREE_CORE_DISTANCE_PENALTY_INL_HPP_
#else
#define SCREE_CORE_DISTANCE_PENALTY_INL_HPP_
#endif

#include <algorithm>

#include "core/distance/brute_force-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// Measured best over regimes: the attainable accuracy goes as the square root of the roundoff.
/// level, below: of a height over |D| times the longest edge of its triangle. conditioned: least pivot over diagonal;
/// level^2 / (2 conditioned) must stay below a roundoff. weightless: a barycentric weight that counts as none.
/// thinnest2: squared ratio of twice the area to the longest edge squared below which no triangle is certified.
template <class T>
struct PenaltySettings;
template <>
struct PenaltySettings<double> {
  static constexpr double penalty = 1e5, regularisation = 1e-7, declared = 1e-9;
  static constexpr double level = 1e-9, below = 1e-6, conditioned = 0x1p-8, weightless = 0x1p-50, thinnest2 = 0x1p-20;
};
template <>
struct PenaltySettings<float> {
  static constexpr float penalty = 1e2f, regularisation = 1e-6f, declared = 1e-4f;
  static constexpr float level = 1e-4f, below = 1e-3f, conditioned = 0x1p-4f, weightless = 0x1p-21f, thinnest2 = 0x1p-8f;
};

/// Upper triangle of a symmetric 4 x 4 matrix.
template <class T>
struct Symmetric4 {
  Pack<T> m00, m01, m02, m03, m11, m12, m13, m22, m23, m33;
};

/// Solves m x = b; returns the least ratio of a pivot to its diagonal entry.
template <class T>
HWY_INLINE Pack<T> solve4(const Symmetric4<T>& m, const Pack<T> b[4], Pack<T> x[4]) {
  using V = Pack<T>;
  const V one(T(1));
  const V i0 = one / m.m00, l1 = m.m01 * i0, l2 = m.m02 * i0, l3 = m.m03 * i0;
  const V a11 = neg_mul_add(l1, m.m01, m.m11), a12 = neg_mul_add(l1, m.m02, m.m12), a13 = neg_mul_add(l1, m.m03, m.m13);
  V a22 = neg_mul_add(l2, m.m02, m.m22), a23 = neg_mul_add(l2, m.m03, m.m23), a33 = neg_mul_add(l3, m.m03, m.m33);
  const V i1 = one / a11, k2 = a12 * i1, k3 = a13 * i1;
  a22 = neg_mul_add(k2, a12, a22);
  a23 = neg_mul_add(k2, a13, a23);
  a33 = neg_mul_add(k3, a13, a33);
  const V i2 = one / a22, j3 = a23 * i2;
  a33 = neg_mul_add(j3, a23, a33);
  const V c1 = neg_mul_add(l1, b[0], b[1]);
  const V c2 = neg_mul_add(k2, c1, neg_mul_add(l2, b[0], b[2]));
  const V c3 = neg_mul_add(j3, c2, neg_mul_add(k3, c1, neg_mul_add(l3, b[0], b[3])));
  x[3] = c3 / a33;
  x[2] = neg_mul_add(j3, x[3], c2 * i2);
  x[1] = neg_mul_add(k3, x[3], neg_mul_add(k2, x[2], c1 * i1));
  x[0] = neg_mul_add(l3, x[3], neg_mul_add(l2, x[2], neg_mul_add(l1, x[1], b[0] * i0)));
  return min(min(a11 / m.m11, a22 / m.m22), a33 / m.m33);
}

/// The two triangles as the penalised problem sees them.
template <class T>
struct PenaltyProblem {
  Pack3<T> e1, e2, f1, f2, w;
  Symmetric4<T> gram;
  HWY_INLINE PenaltyProblem(const TrianglePack<T>& a, const TrianglePack<T>& b) {
    e1 = a.p[1] - a.p[0];
    e2 = a.p[2] - a.p[0];
    f1 = b.p[1] - b.p[0];
    f2 = b.p[2] - b.p[0];
    w = a.p[0] - b.p[0];
    gram = {dot(e1, e1),  dot(e1, e2),  -dot(e1, f1), -dot(e1, f2), dot(e2, e2),
            -dot(e2, f1), -dot(e2, f2), dot(f1, f1),  dot(f1, f2),  dot(f2, f2)};
  }
  HWY_INLINE Pack3<T> difference(const Pack<T> x[4]) const {
    return neg_mul_add(x[2], f1, neg_mul_add(x[3], f2, mul_add(x[0], e1, mul_add(x[1], e2, w))));
  }
  HWY_INLINE Pack<T> trace() const { return (gram.m00 + gram.m11) + (gram.m22 + gram.m33); }
  /// One Newton step: returns dx, to be subtracted from x. `scale` multiplies G and its gradient (1, or 2 where the
  /// objective is taken without the half).
  HWY_INLINE void step(const Pack<T> x[4], Pack<T> scale, Pack<T> r, Pack<T> delta, Pack<T> dx[4]) const {
    using V = Pack<T>;
    const V zero(T(0)), one(T(1));
    const V m0 = max(-x[0], zero), m1 = max(-x[1], zero), m2 = max(x[0] + x[1] - one, zero);
    const V m3 = max(-x[2], zero), m4 = max(-x[3], zero), m5 = max(x[2] + x[3] - one, zero);
    const V r0 = select(m0 > zero, r, zero), r1 = select(m1 > zero, r, zero), r2 = select(m2 > zero, r, zero);
    const V r3 = select(m3 > zero, r, zero), r4 = select(m4 > zero, r, zero), r5 = select(m5 > zero, r, zero);
    const Pack3<T> d = difference(x);
    const V gradient[4] = {mul_add(scale, dot(d, e1), r * (m2 - m0)), mul_add(scale, dot(d, e2), r * (m2 - m1)),
                           mul_sub(r, m5 - m3, scale * dot(d, f1)), mul_sub(r, m5 - m4, scale * dot(d, f2))};
    const Symmetric4<T>& g = gram;
    const Symmetric4<T> h = {mul_add(scale, g.m00, r0 + r2 + delta),
                             mul_add(scale, g.m01, r2),
                             scale * g.m02,
                             scale * g.m03,
                             mul_add(scale, g.m11, r1 + r2 + delta),
                             scale * g.m12,
                             scale * g.m13,
                             mul_add(scale, g.m22, r3 + r5 + delta),
                             mul_add(scale, g.m23, r5),
                             mul_add(scale, g.m33, r4 + r5 + delta)};
    solve4(h, gradient, dx);
  }
};

/// Barycentric coordinates into the triangle (feasible, not the nearest point).
template <class T>
HWY_INLINE void into_triangle(Pack<T>& u, Pack<T>& v) {
  const Pack<T> zero(T(0)), one(T(1));
  u = max(u, zero);
  v = max(v, zero);
  const Pack<T> shrink = one / max(u + v, one);
  u = u * shrink;
  v = v * shrink;
}

/// The part of a triangle that the violated constraints leave: base point and up to two directions.
template <class T>
struct ActiveSet {
  Pack<T> base_u, base_v, along_u, along_v;  ///< base, and the direction of an edge or the first one of the face
  Mask<T> has_first, has_second;
  HWY_INLINE ActiveSet(Pack<T> u, Pack<T> v) {
    using V = Pack<T>;
    const V zero(T(0)), one(T(1));
    const Mask<T> cu = u < zero, cv = v<zero, cs = u + v> one;
    const Mask<T> at_vertex = (cu & cv) | (cv & cs) | (cu & cs);
    const Mask<T> on_edge = (cu | cv | cs) & !at_vertex;
    const Mask<T> third = on_edge & cs;
    base_u = select((cv & cs) | third, one, zero);
    base_v = select(cu & cs, one, zero);
    along_u = select(on_edge & cu, zero, select(third, V(T(-1)), one));
    along_v = select(on_edge & (cu | cs), one, zero);
    has_first = !at_vertex;
    has_second = !(at_vertex | on_edge);
  }
};

/// The least distance on the selected vertex, edge or face of each triangle, taken as unbounded. The equations are
/// those of the Gram matrix restricted to the free directions; a fixed direction gets a row of the identity.
/// Returns the condition (see solve4).
template <class T>
HWY_INLINE Pack<T> polish(const PenaltyProblem<T>& problem, Pack<T> x[4]) {
  using V = Pack<T>;
  const V zero(T(0)), one(T(1));
  const ActiveSet<T> a(x[0], x[1]), b(x[2], x[3]);
  const Pack3<T> e = mul_add(a.along_u, problem.e1, a.along_v * problem.e2), f = mul_add(b.along_u, problem.f1, b.along_v * problem.f2);
  const V base[4] = {a.base_u, a.base_v, b.base_u, b.base_v};
  const Pack3<T> d = problem.difference(base);
  const Symmetric4<T>& g = problem.gram;
  const Mask<T> a1 = a.has_first, a2 = a.has_second, b1 = b.has_first, b2 = b.has_second;
  // only two parallel faces are singular; this keeps them finite and is below rounding otherwise
  const V last = problem.trace() * V(sizeof(T) == 4 ? T(1e-7) : T(1e-15));
  const Symmetric4<T> h = {select(a1, dot(e, e), one),
                           select(a2, dot(e, problem.e2), zero),
                           select(a1 & b1, -dot(e, f), zero),
                           select(a1 & b2, -dot(e, problem.f2), zero),
                           select(a2, g.m11, one),
                           select(a2 & b1, -dot(problem.e2, f), zero),
                           select(a2 & b2, g.m13, zero),
                           select(b1, dot(f, f), one),
                           select(b2, dot(f, problem.f2), zero),
                           select(b2, g.m33 + last, one)};
  const V right[4] = {select(a1, -dot(d, e), zero), select(a2, -dot(d, problem.e2), zero), select(b1, dot(d, f), zero),
                      select(b2, dot(d, problem.f2), zero)};
  V y[4];
  const V condition = solve4(h, right, y);
  x[0] = mul_add(y[0], a.along_u, a.base_u);
  x[1] = mul_add(y[0], a.along_v, a.base_v) + y[1];
  x[2] = mul_add(y[2], b.along_u, b.base_u);
  x[3] = mul_add(y[2], b.along_v, b.base_v) + y[3];
  return condition;
}

/// Which barycentric weights are 0, as 1 for vertex 0, 2 for vertex 1, 4 for vertex 2.
template <class T>
HWY_INLINE Pack<T> zero_weights(Pack<T> u, Pack<T> v) {
  using V = Pack<T>;
  const V zero(T(0)), one(T(1));
  return select(u + v >= one, one, zero) + select(u <= zero, V(T(2)), zero) + select(v <= zero, V(T(4)), zero);
}

/// Added to codes: the answer is not certified; it came from the fallback; zero_weights of A + 8 * those of B.
inline constexpr int kCodeUncertified = 512, kCodeFellBack = 1024, kCodeWeights = 2048;

/// Strict optimality on one triangle: heights 0, g1, g2 of its vertices, weights 1 - u - v, u, v, unit of height.
template <class T>
HWY_INLINE Mask<T> is_optimal(Pack<T> g1, Pack<T> g2, Pack<T> u, Pack<T> v, Pack<T> unit) {
  using V = Pack<T>;
  const V highest = max(max(V(T(0)), g1), g2), level = V(PenaltySettings<T>::level) * unit, below = V(PenaltySettings<T>::below) * unit;
  const auto fits = [&](V overlap, V weight) {
    const Mask<T> used = weight > V(PenaltySettings<T>::weightless);
    return (used & (overlap <= level)) | ((!used) & (overlap >= below));
  };
  return fits(highest, V(T(1)) - u - v) & fits(highest - g1, u) & fits(highest - g2, v);
}

/// Answer of the penalty method; code has kCodeUncertified in lanes without the certificate. unusual: lanes whose size
/// is so far from 1 that they have to be scaled first.
template <class T, bool kStrict>
HWY_INLINE Solution<T> penalty(const TrianglePack<T>& A, const TrianglePack<T>& B, int steps, Mask<T>& unusual) {
  using V = Pack<T>;
  const V zero(T(0)), one(T(1)), third(T(1) / T(3));
  const PenaltyProblem<T> problem(A, B);
  const V trace = max(problem.trace(), V(Limits<T>::tiny));
  const V r = trace * V(PenaltySettings<T>::penalty), delta = trace * V(PenaltySettings<T>::regularisation);
  V x[4] = {third, third, third, third};
  for (int k = 0; k < steps; ++k) {
    V dx[4];
    problem.step(x, one, r, delta, dx);
    for (int c = 0; c < 4; ++c) x[c] = x[c] - dx[c];
  }
  const V condition = polish(problem, x);
  // a singular system leaves a lane without numbers: vertex 0 stands in, and the certificate will not hold
  for (int c = 0; c < 4; ++c) x[c] = select(abs(x[c]) <= V(Limits<T>::huge), x[c], zero);
  into_triangle(x[0], x[1]);
  into_triangle(x[2], x[3]);

  const Pack3<T> d = problem.difference(x);
  Solution<T> out;
  out.distance = sqrt(dot(d, d));
  out.difference = d;
  out.point_a = mul_add(x[0], problem.e1, mul_add(x[1], problem.e2, A.p[0]));
  out.point_b = mul_add(x[2], problem.f1, mul_add(x[3], problem.f2, B.p[0]));

  // certificate, each triangle in its own unit; one too thin is not judged
  const Symmetric4<T>& g = problem.gram;
  const V g1 = -dot(d, problem.e1), g2 = -dot(d, problem.e2), h1 = dot(d, problem.f1), h2 = dot(d, problem.f2);
  const V la2 = max(max(g.m00, g.m11), g.m00 + g.m11 - g.m01 - g.m01);
  const V lb2 = max(max(g.m22, g.m33), g.m22 + g.m33 - g.m23 - g.m23);
  const V unit_a = out.distance * sqrt(la2), unit_b = out.distance * sqrt(lb2), thinnest(PenaltySettings<T>::thinnest2);
  const V size2 = problem.trace() + dot(problem.w, problem.w);
  unusual = !((size2 >= V(Limits<T>::smallest_squared)) & (size2 <= V(Limits<T>::largest_squared)));
  Mask<T> certified = (!unusual) & (mul_sub(g.m00, g.m11, g.m01 * g.m01) >= thinnest * la2 * la2) &
                      (mul_sub(g.m22, g.m33, g.m23 * g.m23) >= thinnest * lb2 * lb2) & (out.distance > zero);
  if constexpr (kStrict) {
    // nearer than this nothing is proven: brute force decides exactly. Four levels: one of each triangle, and twice that
    constexpr T least = std::max(Limits<T>::contact_ratio, 4 * PenaltySettings<T>::level);
    const V least2 = V(least * least) * max(la2, lb2);
    certified = certified & (dot(d, d) > least2) & (condition >= V(PenaltySettings<T>::conditioned)) &
                is_optimal(g1, g2, x[0], x[1], unit_a) & is_optimal(h1, h2, x[2], x[3], unit_b);
  } else {
    const V declared(PenaltySettings<T>::declared);
    const auto gap = [&](V k1, V k2, V u, V v) { return max(max(zero, k1), k2) - mul_add(u, k1, v * k2); };
    certified = certified & (gap(g1, g2, x[0], x[1]) <= declared * unit_a) & (gap(h1, h2, x[2], x[3]) <= declared * unit_b);
  }
  out.code =
      V(T(kCodeWeights)) + zero_weights(x[0], x[1]) + V(T(8)) * zero_weights(x[2], x[3]) + select(certified, zero, V(T(kCodeUncertified)));
  return out;
}

/// The same for lanes of any size.
template <class T, bool kStrict>
HWY_NOINLINE void penalty_scaled(const TrianglePack<T>& A, const TrianglePack<T>& B, int steps, Mask<T> lanes, Solution<T>& out) {
  const ScaledPair<T> scaled(A, B);
  Mask<T> unusual;
  Solution<T> s;
  scaled.put_back(penalty<T, kStrict>(scaled.a, scaled.b, steps, unusual), s);
  out.distance = select(lanes, s.distance, out.distance);
  out.point_a = select(lanes, s.point_a, out.point_a);
  out.point_b = select(lanes, s.point_b, out.point_b);
  out.code = select(lanes, s.code, out.code);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
