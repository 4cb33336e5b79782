#include "core/distance/triangle_intersection.hpp"

#include <algorithm>
#include <cmath>

namespace scree {
namespace {

using Corner = const double*;

/// A number as a sum of doubles that do not overlap, least first, without zeros: its sign is that of the last one.
template <int kCapacity>
struct Expansion {
  double part[kCapacity];
  int count = 0;
  void append(double x) {
    if (x != 0) part[count++] = x;
  }
  int sign() const { return count == 0 ? 0 : (part[count - 1] > 0 ? 1 : -1); }
};

/// a + b = high + low exactly (Knuth).
void two_sum(double a, double b, double& high, double& low) {
  high = a + b;
  const double b_part = high - a, a_part = high - b_part;
  low = (a - a_part) + (b - b_part);
}

Expansion<2> difference(double a, double b) {
  double high = 0, low = 0;
  two_sum(a, -b, high, low);
  Expansion<2> e;
  e.append(low);
  e.append(high);
  return e;
}

/// Sum, or difference with sign = -1: the parts of both in the order of their size, added one by one.
template <int kA, int kB>
Expansion<kA + kB> sum(const Expansion<kA>& a, const Expansion<kB>& b, double sign = 1) {
  Expansion<kA + kB> out;
  double carry = 0, low = 0;
  for (int i = 0, j = 0; i < a.count || j < b.count;) {
    const bool from_a = j == b.count || (i < a.count && std::abs(a.part[i]) < std::abs(b.part[j]));
    const double next = from_a ? a.part[i++] : sign * b.part[j++];
    two_sum(carry, next, carry, low);
    out.append(low);
  }
  out.append(carry);
  return out;
}

template <int kA>
Expansion<2 * kA> scaled(const Expansion<kA>& a, double factor) {
  Expansion<2 * kA> out;
  double carry = 0, low = 0;
  for (int i = 0; i < a.count; ++i) {
    const double product = a.part[i] * factor, rest = std::fma(a.part[i], factor, -product);
    two_sum(carry, rest, carry, low);
    out.append(low);
    two_sum(carry, product, carry, low);
    out.append(low);
  }
  out.append(carry);
  return out;
}

template <int kA>
Expansion<4 * kA> product(const Expansion<kA>& a, const Expansion<2>& b) {
  return sum(scaled(a, b.count > 0 ? b.part[0] : 0), scaled(a, b.count > 1 ? b.part[1] : 0));
}

/// A number of twice the precision, high + low: relative error of a product or a sum at most 2^-102 of its operands.
struct Double2 {
  double high, low;
};
Double2 difference2(double a, double b) {
  Double2 d{};
  two_sum(a, -b, d.high, d.low);
  return d;
}
Double2 operator*(const Double2& a, const Double2& b) {
  const double high = a.high * b.high;
  Double2 p{};
  two_sum(high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high), p.high, p.low);
  return p;
}
Double2 operator+(const Double2& a, const Double2& b) {
  double high = 0, low = 0, rest_high = 0, rest_low = 0;
  two_sum(a.high, b.high, high, low);
  two_sum(a.low, b.low, rest_high, rest_low);
  Double2 s{};
  two_sum(high, low + rest_high, s.high, s.low);
  two_sum(s.high, s.low + rest_low, s.high, s.low);
  return s;
}
Double2 operator-(const Double2& a, const Double2& b) { return a + Double2{-b.high, -b.low}; }

/// Sign of (a - c) x (b - c) with coordinate `axis` left out.
int orient2d(Corner a, Corner b, Corner c, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]), determinant = left - right;
  // Shewchuk's bound (3 + 16 eps) eps, rounded up; the constant is far below any bit that counts (see kLargest)
  const double bound = 0x1.9p-52 * (std::abs(left) + std::abs(right)) + 0x1p-1000;
  if (determinant > bound) return 1;
  if (determinant < -bound) return -1;
  return sum(product(difference(a[x], c[x]), difference(b[y], c[y])), product(difference(a[y], c[y]), difference(b[x], c[x])), -1).sign();
}

/// Sign of det(a - d, b - d, c - d).
int orient3d(Corner a, Corner b, Corner c, Corner d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2], bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
  const double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
  const double bxcy = bx * cy, cxby = cx * by, cxay = cx * ay, axcy = ax * cy, axby = ax * by, bxay = bx * ay;
  const double determinant = az * (bxcy - cxby) + bz * (cxay - axcy) + cz * (axby - bxay);
  const double permanent = (std::abs(bxcy) + std::abs(cxby)) * std::abs(az) + (std::abs(cxay) + std::abs(axcy)) * std::abs(bz) +
                           (std::abs(axby) + std::abs(bxay)) * std::abs(cz);
  // Shewchuk's bound (7 + 56 eps) eps, rounded up
  const double bound = 0x1.dp-51 * permanent + 0x1p-1000;
  if (determinant > bound) return 1;
  if (determinant < -bound) return -1;

  // most pairs that touch by accident are decided by twice the digits; the constant covers what underflows
  const Double2 a2[3] = {difference2(a[0], d[0]), difference2(a[1], d[1]), difference2(a[2], d[2])};
  const Double2 b2[3] = {difference2(b[0], d[0]), difference2(b[1], d[1]), difference2(b[2], d[2])};
  const Double2 c2[3] = {difference2(c[0], d[0]), difference2(c[1], d[1]), difference2(c[2], d[2])};
  const auto minor2 = [](const Double2* u, const Double2* v) { return u[0] * v[1] - v[0] * u[1]; };
  const Double2 sum2 = minor2(b2, c2) * a2[2] + minor2(c2, a2) * b2[2] + minor2(a2, b2) * c2[2];
  const double bound2 = 0x1p-95 * permanent + 0x1p-700;
  if (sum2.high > bound2) return 1;
  if (sum2.high < -bound2) return -1;

  const Expansion<2> p[3] = {difference(a[0], d[0]), difference(a[1], d[1]), difference(a[2], d[2])};
  const Expansion<2> q[3] = {difference(b[0], d[0]), difference(b[1], d[1]), difference(b[2], d[2])};
  const Expansion<2> r[3] = {difference(c[0], d[0]), difference(c[1], d[1]), difference(c[2], d[2])};
  const auto minor = [](const Expansion<2>* u, const Expansion<2>* v) { return sum(product(u[0], v[1]), product(v[0], u[1]), -1); };
  return sum(sum(product(minor(q, r), p[2]), product(minor(r, p), q[2])), product(minor(p, q), r[2])).sign();
}

bool ranges_overlap(double a0, double a1, double b0, double b1) {
  return std::max(a0, a1) >= std::min(b0, b1) && std::max(b0, b1) >= std::min(a0, a1);
}

/// Closed segments p q and r s in the projection along axis.
bool segments_meet_2d(Corner p, Corner q, Corner r, Corner s, int axis) {
  for (int k = 1; k < 3; ++k) {
    const int c = (axis + k) % 3;
    if (!ranges_overlap(p[c], q[c], r[c], s[c])) return false;
  }
  return orient2d(r, s, p, axis) * orient2d(r, s, q, axis) <= 0 && orient2d(p, q, r, axis) * orient2d(p, q, s, axis) <= 0;
}

/// An axis along which the three points project onto a triangle with area; -1 when they are on one line.
int projection_axis(Corner a, Corner b, Corner c) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(a, b, c, axis) != 0) return axis;
  return -1;
}

bool segments_meet(Corner p, Corner q, Corner r, Corner s) {
  for (int c = 0; c < 3; ++c)
    if (!ranges_overlap(p[c], q[c], r[c], s[c])) return false;
  if (orient3d(p, q, r, s) != 0) return false;
  int axis = projection_axis(p, q, r);
  if (axis < 0) axis = projection_axis(p, q, s);
  if (axis < 0) axis = projection_axis(r, s, p);
  if (axis < 0) axis = projection_axis(r, s, q);
  return axis < 0 || segments_meet_2d(p, q, r, s, axis);  // all on one line: the ranges decide
}

/// Signs of det of edge i of one triangle and edge j of the other, each computed when first asked for: both directions of
/// the test need them, and those near 0 are dear.
class EdgeSigns {
 public:
  EdgeSigns(const Corner p[3], const Corner f[3]) : p_(p), f_(f) {}
  int operator()(int i, int j) {
    int& sign = sign_[i][j];
    if (sign == kUnknown) sign = orient3d(p_[i], p_[(i + 1) % 3], f_[j], f_[(j + 1) % 3]);
    return sign;
  }

 private:
  static constexpr int kUnknown = 2;
  const Corner *p_, *f_;
  int sign_[3][3] = {{kUnknown, kUnknown, kUnknown}, {kUnknown, kUnknown, kUnknown}, {kUnknown, kUnknown, kUnknown}};
};

/// Segment p q, at sides hp and hq of the plane of the triangle f, against f. axis: see projection_axis; sign(k): of the
/// segment and edge k of f.
template <class Sign>
bool segment_meets_triangle(Corner p, Corner q, int hp, int hq, const Corner f[3], int axis, const Sign& sign) {
  if (hp * hq > 0) return false;
  if (hp != 0 || hq != 0) {
    const int w0 = sign(0), w1 = sign(1);
    if (w0 * w1 < 0) return false;
    const int w2 = sign(2);
    return w0 * w2 >= 0 && w1 * w2 >= 0;
  }
  const int o0 = orient2d(f[0], f[1], p, axis), o1 = orient2d(f[1], f[2], p, axis), o2 = orient2d(f[2], f[0], p, axis);
  if (o0 * o1 >= 0 && o1 * o2 >= 0 && o0 * o2 >= 0) return true;  // p lies in f
  for (int k = 0; k < 3; ++k)
    if (segments_meet_2d(p, q, f[k], f[(k + 1) % 3], axis)) return true;
  return false;
}

/// The edges of p against f, which has area; h: sides of the corners of p; sign(i, k): of edge i of p and edge k of f.
template <class Sign>
bool edges_meet_triangle(const Corner p[3], const int h[3], const Corner f[3], int axis, const Sign& sign) {
  for (int i = 0; i < 3; ++i)
    if (segment_meets_triangle(p[i], p[(i + 1) % 3], h[i], h[(i + 1) % 3], f, axis, [&](int k) { return sign(i, k); })) return true;
  return false;
}

/// Sides of the corners of p; false when all are on one side, and nothing can meet.
bool find_sides(const Corner p[3], const Corner f[3], int h[3]) {
  for (int k = 0; k < 3; ++k) h[k] = orient3d(f[0], f[1], f[2], p[k]);
  return !(h[0] == h[1] && h[1] == h[2] && h[0] != 0);
}

/// Coordinates are scaled to this: products of three stay finite, and bits down to 2^-358 multiply without loss.
constexpr int kLargest = 300;

}  // namespace

bool triangles_intersect(const double a[9], const double b[9]) {
  double largest = 0;
  for (int k = 0; k < 9; ++k) {
    if (!std::isfinite(a[k]) || !std::isfinite(b[k])) return false;
    largest = std::max({largest, std::abs(a[k]), std::abs(b[k])});
  }
  for (int c = 0; c < 3; ++c)
    if (std::max({a[c], a[3 + c], a[6 + c]}) < std::min({b[c], b[3 + c], b[6 + c]}) ||
        std::max({b[c], b[3 + c], b[6 + c]}) < std::min({a[c], a[3 + c], a[6 + c]}))
      return false;
  // neighbours in a mesh
  for (int i = 0; i < 9; i += 3)
    for (int j = 0; j < 9; j += 3)
      if (a[i] == b[j] && a[i + 1] == b[j + 1] && a[i + 2] == b[j + 2]) return true;
  const int shift = kLargest - std::ilogb(largest);
  const double half = std::ldexp(1.0, shift / 2), rest = std::ldexp(1.0, shift - shift / 2);  // one factor may be out of range
  double sa[9], sb[9];
  for (int k = 0; k < 9; ++k) {
    sa[k] = a[k] * half * rest;
    sb[k] = b[k] * half * rest;
  }
  const Corner p[3] = {sa, sa + 3, sa + 6}, f[3] = {sb, sb + 3, sb + 6};
  int hp[3], hf[3];
  if (!find_sides(p, f, hp) || !find_sides(f, p, hf)) return false;
  const int axis_p = projection_axis(p[0], p[1], p[2]), axis_f = projection_axis(f[0], f[1], f[2]);
  // a triangle without area is the union of its edges
  EdgeSigns sign(p, f);
  if (axis_f >= 0 && edges_meet_triangle(p, hp, f, axis_f, [&](int i, int j) { return sign(i, j); })) return true;
  if (axis_p >= 0) return edges_meet_triangle(f, hf, p, axis_p, [&](int i, int j) { return sign(j, i); });
  if (axis_f >= 0) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (segments_meet(p[i], p[(i + 1) % 3], f[j], f[(j + 1) % 3])) return true;
  return false;
}

}  // namespace scree
