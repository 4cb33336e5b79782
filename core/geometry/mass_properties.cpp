#include "core/geometry/mass_properties.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numbers>

namespace scree {

MassProperties mass_properties(const TriangleMesh& mesh) {
  MassProperties result;
  const Vec3 origin = bounding_box(mesh).centre();
  double volume6 = 0;  // six times the volume
  Vec3 first{};        // 24 times the first moment
  Mat3 second{};       // 120 times the second moment, sum of (x x^T)
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 a = mesh.corner(t, 0) - origin, b = mesh.corner(t, 1) - origin, c = mesh.corner(t, 2) - origin;
    const double det = dot(a, cross(b, c));
    const Vec3 sum = a + b + c;
    volume6 += det;
    first += det * sum;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        second[i][j] += det * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
      }
    }
  }
  result.volume = volume6 / 6;
  if (!(std::abs(result.volume) > 0)) return result;
  const Vec3 local = (1.0 / (4 * volume6)) * first;
  result.centre = origin + local;
  Mat3 covariance{};
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      covariance[i][j] = second[i][j] / 120 - result.volume * local[i] * local[j];
      covariance[j][i] = covariance[i][j];
    }
  }
  const double trace = covariance[0].x + covariance[1].y + covariance[2].z;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result.inertia[i][j] = (i == j ? trace : 0.0) - covariance[i][j];
  }
  find_principal_frame(result);
  return result;
}

MassProperties sphere_mass_properties(double radius) {
  MassProperties result;
  result.volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const double moment = 0.4 * result.volume * radius * radius;
  for (int i = 0; i < 3; ++i) result.inertia[i][i] = moment;
  result.principal_moments = {moment, moment, moment};
  return result;
}

namespace {

void make_largest_positive(Eigen::Matrix3d& axes, int column) {
  Eigen::Index row = 0;
  axes.col(column).cwiseAbs().maxCoeff(&row);
  if (axes(row, column) < 0) axes.col(column) = -axes.col(column);
}

/// Of two equal moments any axes in their plane are principal, and rounding would choose: another triangulation of one solid would get
/// other axes, and integrators that turn about one axis after another would move it otherwise. So one axis is the projection of a
/// coordinate axis: of the one that lies closest to the plane, and of several the first. Three equal moments keep the coordinate axes.
void fix_axes_of_equal_moments(Eigen::Vector3d& moments, Eigen::Matrix3d& axes) {
  // Of the largest moment. Rounding of the mass integrals is below; dropping what couples the two changes the tensor by less than this.
  constexpr double kEqualMoments = 1e-12;
  constexpr double kAsClose = 1e-6;  // components that differ by less count as equal, so that rounding does not choose between them
  const double limit = kEqualMoments * moments(2);
  const bool lower = moments(1) - moments(0) <= limit, upper = moments(2) - moments(1) <= limit;
  if (lower && upper) {
    moments.setConstant(moments.mean());
    axes.setIdentity();
  } else if (lower || upper) {
    const int single = lower ? 2 : 0, first = lower ? 0 : 1;
    make_largest_positive(axes, single);
    const Eigen::Vector3d u = axes.col(single);
    int closest = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(u(i)) < std::abs(u(closest)) - kAsClose) closest = i;
    }
    const Eigen::Vector3d across = (Eigen::Vector3d::Unit(closest) - u(closest) * u).normalized();
    axes.col(first) = across;
    axes.col(first + 1) = u.cross(across);
    moments.segment(first, 2).setConstant(moments.segment(first, 2).mean());
  }
}

}  // namespace

void find_principal_frame(MassProperties& mass) {
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia(i, j) = mass.inertia[i][j];
  }
  // A tensor that is diagonal but for rounding keeps its axes: a box stays a box, and a sphere unrotated.
  // Relative to the largest entry; larger values would tilt slender bodies by as much [rad].
  constexpr double kDiagonalTolerance = 1e-14;
  const double largest = inertia.cwiseAbs().maxCoeff();
  const double off = std::max({std::abs(inertia(0, 1)), std::abs(inertia(0, 2)), std::abs(inertia(1, 2))});
  const bool ascending = inertia(0, 0) <= inertia(1, 1) && inertia(1, 1) <= inertia(2, 2);
  const bool isotropic =
      std::max({inertia(0, 0), inertia(1, 1), inertia(2, 2)}) - std::min({inertia(0, 0), inertia(1, 1), inertia(2, 2)}) <=
      kDiagonalTolerance * largest;
  if (off <= kDiagonalTolerance * largest && (ascending || isotropic)) {
    mass.principal_moments = {inertia(0, 0), inertia(1, 1), inertia(2, 2)};
    mass.body_from_principal = Quat{};
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d moments = solver.eigenvalues();
  Eigen::Matrix3d axes = solver.eigenvectors();
  // Fix the signs, which the solver leaves open: the largest component of the first two axes is positive.
  for (int c = 0; c < 2; ++c) make_largest_positive(axes, c);
  axes.col(2) = axes.col(0).cross(axes.col(1));
  fix_axes_of_equal_moments(moments, axes);
  Mat3 rotation;
  for (int i = 0; i < 3; ++i) rotation[i] = {axes(i, 0), axes(i, 1), axes(i, 2)};
  mass.body_from_principal = quaternion_of(rotation);
  mass.principal_moments = {moments(0), moments(1), moments(2)};
}

}  // namespace scree
