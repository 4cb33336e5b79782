#include "mesher/fracture/cut_signs.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

namespace scree {

namespace {

using Exact = boost::multiprecision::cpp_rational;
using Long = boost::multiprecision::cpp_bin_float_quad;

/// A double with a bound of how far it is from the true value. kRounding is twice the unit roundoff: the excess covers the rounding of
/// the bound itself, and products that underflow are far below what meshes of size 1 hold.
struct Bounded {
  static constexpr double kRounding = std::numeric_limits<double>::epsilon();
  double value = 0, error = 0;
  Bounded() = default;
  Bounded(double v) : value(v) {}  // NOLINT(google-explicit-constructor): reads as a number in the formulas below
  Bounded(double v, double e) : value(v), error(e) {}
  Bounded operator-() const { return {-value, error}; }
  friend Bounded operator+(const Bounded& a, const Bounded& b) {
    const double v = a.value + b.value;
    return {v, (a.error + b.error + kRounding * std::abs(v)) * (1 + 4 * kRounding)};
  }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return a + -b; }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    const double v = a.value * b.value;
    return {
        v, (std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error + kRounding * std::abs(v)) * (1 + 4 * kRounding)};
  }
};

int sign_of(const Bounded& x) { return x.value > x.error ? 1 : (x.value < -x.error ? -1 : 0); }
int sign_of(const Exact& x) { return x.sign(); }

/// Runs the formula in doubles, and in rational numbers where they leave the sign open.
template <class Formula>
int decided(Formula&& formula) {
  const int quick = formula(Bounded{});
  if (quick != 0) return quick;
  const int exact = formula(Exact{});
  if (exact == 0) throw DegenerateCut();
  return exact;
}

template <class N>
using Three = std::array<N, 3>;

template <class N>
Three<N> three(const Vec3& v) {
  return {N(v.x), N(v.y), N(v.z)};
}
template <class N>
N dot(const Three<N>& a, const Three<N>& b) {
  return N(a[0] * b[0]) + N(a[1] * b[1]) + N(a[2] * b[2]);
}
template <class N>
Three<N> cross(const Three<N>& a, const Three<N>& b) {
  return {N(a[1] * b[2]) - N(a[2] * b[1]), N(a[2] * b[0]) - N(a[0] * b[2]), N(a[0] * b[1]) - N(a[1] * b[0])};
}
template <class N>
N sum(const Three<N>& a) {
  return a[0] + a[1] + a[2];
}
template <class N>
N value(const CutPlane& plane, const Vec3& x) {
  return dot(three<N>(plane.normal), three<N>(x)) + N(plane.offset);
}
/// Values of the plane at the vertices of a triangle.
template <class N>
Three<N> values(const CutPlane& plane, const std::array<Vec3, 3>& t) {
  return {value<N>(plane, t[0]), value<N>(plane, t[1]), value<N>(plane, t[2])};
}
/// Barycentric coordinates, times their sum, of the point of the triangle in which p and q meet.
template <class N>
Three<N> barycentric(const std::array<Vec3, 3>& t, const CutPlane& p, const CutPlane& q) {
  return cross(values<N>(p, t), values<N>(q, t));
}
/// The homogeneous point of three planes: first its three coordinates, then its weight.
template <class N>
std::array<N, 4> meeting(const CutPlane& p, const CutPlane& q, const CutPlane& r) {
  const Three<N> a = three<N>(p.normal), b = three<N>(q.normal), c = three<N>(r.normal);
  const Three<N> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const N pa(p.offset), qb(q.offset), rc(r.offset);
  std::array<N, 4> x;
  for (std::size_t k = 0; k < 3; ++k) x[k] = -(N(pa * bc[k]) + N(qb * ca[k]) + N(rc * ab[k]));
  x[3] = dot(a, bc);
  return x;
}

}  // namespace

int sign_at(const CutPlane& plane, const Vec3& point) {
  return decided([&]<class N>(const N&) { return sign_of(value<N>(plane, point)); });
}

int sign_at_edge(const CutPlane& plane, const Vec3& a, const Vec3& b, const CutPlane& p) {
  return decided([&]<class N>(const N&) {
    const N pa = value<N>(p, a), pb = value<N>(p, b);
    return sign_of(N(N(pa * value<N>(plane, b)) - N(pb * value<N>(plane, a)))) * sign_of(N(pa - pb));
  });
}

int sign_at_triangle(const CutPlane& plane, const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q) {
  return decided([&]<class N>(const N&) {
    const Three<N> l = barycentric<N>(triangle, p, q);
    return sign_of(dot(l, values<N>(plane, triangle))) * sign_of(sum(l));
  });
}

int sign_at_planes(const CutPlane& plane, const CutPlane& p, const CutPlane& q, const CutPlane& r) {
  return decided([&]<class N>(const N&) {
    const std::array<N, 4> x = meeting<N>(p, q, r);
    const Three<N> n = three<N>(plane.normal);
    return sign_of(N(dot(n, Three<N>{x[0], x[1], x[2]}) + N(N(plane.offset) * x[3]))) * sign_of(x[3]);
  });
}

int sign_of_turn(const CutPlane& p, const CutPlane& q, const CutPlane& r) {
  return decided([&]<class N>(const N&) { return sign_of(dot(cross(three<N>(p.normal), three<N>(q.normal)), three<N>(r.normal))); });
}

int sign_of_crossing(const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q) {
  return decided([&]<class N>(const N&) { return sign_of(sum(barycentric<N>(triangle, p, q))); });
}

bool meets_before(const std::array<Vec3, 3>& first, const std::array<Vec3, 3>& second, const CutPlane& p, const CutPlane& q) {
  return decided([&]<class N>(const N&) {
           const Three<N> way = cross(three<N>(p.normal), three<N>(q.normal));
           const auto along = [&](const std::array<Vec3, 3>& t, const Three<N>& l) {
             return dot(l, Three<N>{dot(way, three<N>(t[0])), dot(way, three<N>(t[1])), dot(way, three<N>(t[2]))});
           };
           const Three<N> l1 = barycentric<N>(first, p, q), l2 = barycentric<N>(second, p, q);
           const N s1 = sum(l1), s2 = sum(l2);
           return sign_of(N(N(along(second, l2) * s1) - N(along(first, l1) * s2))) * sign_of(s1) * sign_of(s2);
         }) > 0;
}

Vec3 edge_point(const Vec3& a, const Vec3& b, const CutPlane& p) {
  const Long pa = value<Long>(p, a), pb = value<Long>(p, b), weight = pa - pb;
  const auto at = [&](double xa, double xb) { return static_cast<double>(Long((pa * Long(xb) - pb * Long(xa)) / weight)); };
  return {at(a.x, b.x), at(a.y, b.y), at(a.z, b.z)};
}

Vec3 triangle_point(const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q) {
  const Three<Long> l = barycentric<Long>(triangle, p, q);
  const Long weight = sum(l);
  const auto at = [&](int k) {
    return static_cast<double>(Long((l[0] * Long(triangle[0][k]) + l[1] * Long(triangle[1][k]) + l[2] * Long(triangle[2][k])) / weight));
  };
  return {at(0), at(1), at(2)};
}

Vec3 planes_point(const CutPlane& p, const CutPlane& q, const CutPlane& r) {
  const std::array<Long, 4> x = meeting<Long>(p, q, r);
  return {static_cast<double>(Long(x[0] / x[3])), static_cast<double>(Long(x[1] / x[3])), static_cast<double>(Long(x[2] / x[3]))};
}

}  // namespace scree
