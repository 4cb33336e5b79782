#include "solver/step/critical_step.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace scree {

namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat12 = Eigen::Matrix<double, 12, 12, Eigen::RowMajor>;

template <class Matrix>
double largest_eigenvalue(const Matrix& m) {
  return std::max(0.0, Eigen::SelfAdjointEigenSolver<Matrix>(m, Eigen::EigenvaluesOnly).eigenvalues()(m.rows() - 1));
}

Eigen::Map<const Mat12> matrix(const std::array<double, 144>& values) { return Eigen::Map<const Mat12>(values.data()); }

/// Wrench of a unit force f on A at x (and -f on B), mass-normalised in the principal axes of both.
std::array<double, 12> mode_of(const PairMotion& m, const Vec3& x, const Vec3& f) {
  const auto root = [](double v) { return std::sqrt(v); };
  const Vec3 torque_a = cross(x, f);
  const Vec3 force_b = transpose_times(m.b_to_a, -f), torque_b = transpose_times(m.b_to_a, cross(x - m.centre_b, -f));
  const double ma = root(m.inverse_mass_a), mb = root(m.inverse_mass_b);
  return {ma * f.x,
          ma * f.y,
          ma * f.z,
          root(m.inverse_inertia_a.x) * torque_a.x,
          root(m.inverse_inertia_a.y) * torque_a.y,
          root(m.inverse_inertia_a.z) * torque_a.z,
          mb * force_b.x,
          mb * force_b.y,
          mb * force_b.z,
          root(m.inverse_inertia_b.x) * torque_b.x,
          root(m.inverse_inertia_b.y) * torque_b.y,
          root(m.inverse_inertia_b.z) * torque_b.z};
}

}  // namespace

void PairStiffness::add_mode(double s, double c, const std::array<double, 12>& mode) {
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = 0; j < 12; ++j) {
      const double product = mode[i] * mode[j];
      stiffness[12 * i + j] += s * product;
      damping[12 * i + j] += c * product;
    }
  }
}

PairStiffness linearise(const PairContact& look) {
  PairStiffness result;
  result.key = look.pair.key;
  result.a = look.pair.a;
  result.b = look.pair.b;
  const PairForce& force = look.force;
  const double p = look.exponent;
  /// A point with its tangent stiffness, its normal force and the chi of its damping, and friction of f / overlap along.
  const auto add_point = [&](const Vec3& x, const Vec3& n, double stiffness, double normal, double chi, double overlap) {
    result.add_mode(stiffness, chi * normal, mode_of(look.motion, x, n));
    if (!(look.law.friction > 0)) return;
    // any two directions across the normal
    const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = normalised(cross(n, other)), v = cross(n, u);
    const double kappa = look.law.tangential_ratio * normal / overlap, c = tangential_damping_share(look.law, p) * chi * normal;
    result.add_mode(kappa, c, mode_of(look.motion, x, u));
    result.add_mode(kappa, c, mode_of(look.motion, x, v));
  };
  if (look.motion.area != nullptr) {
    double energy = 0, pressed = 0;
    for (const AreaPatch& patch : look.motion.area->patches) {
      energy += patch.energy;
      pressed += patch.force;
    }
    if (!(energy > 0)) return result;
    const double modulus = force.elastic / energy, overlap = 2 * energy / pressed;
    for (const AreaPoint& point : look.motion.area->points) {
      const double stiffness = modulus * point.area;
      add_point(point.x, point.n, stiffness, stiffness * overlap, force.damping, overlap);
    }
    return result;
  }
  if (look.motion.independent) {
    // U_j = c d_j^(p + 1), each with a dashpot by its own energy
    double sum = 0;
    for (const ContactFeature& f : look.features) sum += std::pow(f.overlap, p + 1);
    for (const ContactFeature& f : look.features) {
      const double share = std::pow(f.overlap, p + 1) / sum, normal = (p + 1) * share * force.elastic / f.overlap;
      add_point(f.x, f.n, p * normal / f.overlap, normal, force.damping / std::sqrt(share), f.overlap);
    }
    return result;
  }
  // features that share a potential, each with its weight in it: all of them, or those of a cell
  struct Member {
    std::int64_t cell;
    std::size_t feature;
    double weight;
  };
  std::vector<Member> members;
  if (look.motion.cells == nullptr) {
    for (std::size_t j = 0; j < look.features.size(); ++j) members.push_back({0, j, look.features[j].weight});
  } else {
    for (const CellShare& s : *look.motion.cells) {
      const auto j = static_cast<std::size_t>(s.feature);
      members.push_back({s.cell, j, look.features[j].weight * std::pow(s.weight, kNorm / (1 + p))});
    }
  }
  struct Group {
    std::size_t begin, end;
    double D;
  };
  std::vector<Group> groups;
  double energy = 0;  // over the constant of the law
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end) {
    double sum = 0;
    for (end = begin; end < members.size() && members[end].cell == members[begin].cell; ++end) {
      sum += members[end].weight * std::pow(look.features[members[end].feature].overlap / force.largest_overlap, kNorm);
    }
    const double D = force.largest_overlap * std::pow(sum, 1.0 / kNorm);
    if (D > 0) groups.push_back({begin, end, D});
    energy += std::pow(D, p + 1);
  }
  for (const Group& group : groups) {
    // U(D) of exponent p in the force has U' = (p + 1) U / D and U'' = p U' / D
    const double D = group.D, slope = (p + 1) * (force.elastic - force.barrier) * std::pow(D, p - 1) / energy;  // U' / D
    std::array<double, 12> common{};
    for (std::size_t m = group.begin; m < group.end; ++m) {
      const ContactFeature& f = look.features[members[m].feature];
      const double weight = members[m].weight, r = f.overlap / D, r6 = std::pow(r, kNorm - 2), normal = slope * D * weight * r6 * r;
      const auto along = mode_of(look.motion, f.x, f.n);
      for (std::size_t i = 0; i < 12; ++i) common[i] += weight * r6 * r * along[i];
      add_point(f.x, f.n, (kNorm - 1) * slope * weight * r6, normal, force.damping, D);
    }
    result.add_mode(-(kNorm - 1 - p) * slope, 0, common);
  }
  if (!(look.law.barrier > 0)) return result;
  const Barrier barrier(look.law);
  for (const ContactFeature& f : look.features) {
    const double gap = look.law.margin - f.overlap;
    if (barrier.acts(gap)) add_point(f.x, f.n, f.weight * barrier.curvature(gap), f.weight * barrier.force(gap), force.damping, f.overlap);
  }
  return result;
}

StabilityBound::StabilityBound(std::size_t rows) : rows_(rows) {}

void StabilityBound::add(const PairStiffness& pair) {
  bool is_alone = pair.b >= 0;
  for (int side = 0; side < 2; ++side) {
    const std::int32_t row = side == 0 ? pair.a : pair.b;
    if (row < 0) continue;
    Row& r = rows_[static_cast<std::size_t>(row)];
    const std::size_t corner = side == 0 ? 0 : 6 * 12 + 6;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        r.stiffness[6 * i + j] += pair.stiffness[corner + 12 * i + j];
        r.damping[6 * i + j] += pair.damping[corner + 12 * i + j];
      }
    }
    is_alone = is_alone && r.bound.pairs == 0;
    ++r.bound.pairs;
  }
  links_.push_back({pair.key, pair.a, pair.b, is_alone ? static_cast<std::int32_t>(alone_.size()) : -1});
  if (is_alone) alone_.push_back(pair);
}

const BodyBound& StabilityBound::bound_of(std::size_t row) {
  Row& r = rows_[row];
  if (!r.is_exact) {
    r.bound.lambda = largest_eigenvalue(Mat6(Eigen::Map<const Mat6>(r.stiffness.data())));
    r.bound.gamma = largest_eigenvalue(Mat6(Eigen::Map<const Mat6>(r.damping.data())));
    r.is_exact = true;
  }
  return r.bound;
}

void StabilityBound::set_bound(std::size_t row, const BodyBound& bound) {
  rows_[row].bound = bound;
  rows_[row].is_exact = true;
}

CriticalStep StabilityBound::critical_step(bool corrected) {
  constexpr double kAboveRounding = 1 + 1e-12;  // a norm found in rounded arithmetic stays above the eigenvalue
  // fourth root of |M^4|: at most 6^(1/8) = 1.25 times the largest eigenvalue
  const auto norm = [](const std::array<double, 36>& values) {
    const Eigen::Map<const Mat6> m(values.data());
    const double scale = m.norm();
    if (!(scale > 0)) return 0.0;
    const Mat6 one = m / scale, two = one * one, four = two * two;
    return kAboveRounding * scale * std::sqrt(std::sqrt(four.norm()));
  };
  std::vector<std::array<double, 2>> above(rows_.size(), {0, 0});  // at least lambda and gamma of each row
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& r = rows_[i];
    if (r.is_exact)
      above[i] = {r.bound.lambda, r.bound.gamma};
    else if (r.bound.pairs > 0)
      above[i] = {norm(r.stiffness), norm(r.damping)};
  }
  std::vector<double> below(links_.size());  // at most the step of each pair; for one that is alone, its blocks bound it as well
  std::size_t first = 0;
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const Link& link = links_[k];
    auto [lambda, gamma] = above[static_cast<std::size_t>(link.a)];
    if (link.b >= 0) {
      lambda += above[static_cast<std::size_t>(link.b)][0];
      gamma += above[static_cast<std::size_t>(link.b)][1];
    }
    below[k] = largest_stable_step(lambda, gamma, corrected) / kAboveRounding;
    if (below[k] < below[first]) first = k;
  }
  const auto step_of = [&](const Link& link) {
    const BodyBound& a = bound_of(static_cast<std::size_t>(link.a));
    double lambda = a.lambda, gamma = a.gamma;
    if (link.b >= 0) {
      const BodyBound& b = bound_of(static_cast<std::size_t>(link.b));
      if (a.pairs == 1 && b.pairs == 1) {
        const PairStiffness& pair = alone_[static_cast<std::size_t>(link.alone)];
        lambda = largest_eigenvalue(Mat12(matrix(pair.stiffness)));
        gamma = largest_eigenvalue(Mat12(matrix(pair.damping)));
      } else {
        lambda += b.lambda;
        gamma += b.gamma;
      }
    }
    return largest_stable_step(lambda, gamma, corrected);
  };
  CriticalStep result;
  if (links_.empty()) return result;
  const double enough = step_of(links_[first]);
  for (std::size_t k = 0; k < links_.size(); ++k) {
    if (below[k] > std::min(enough, result.step)) continue;
    const double step = step_of(links_[k]);
    if (step < result.step) result = {step, links_[k].key};
  }
  return result;
}

double largest_stable_step(double lambda, double gamma, bool corrected) {
  if (!(lambda > 0) && !(gamma > 0)) return std::numeric_limits<double>::infinity();
  if (!corrected) return 4 / (gamma + std::sqrt(gamma * gamma + 4 * lambda));
  if (!(lambda > 0)) return 4 / gamma;  // 2 s / (1 + s / 4) = 4 at s = 4
  // In units of 2 / sqrt(lambda): z x^3 + x^2 + z x - 1 = 0 with z = gamma / (2 sqrt(lambda)); rising and convex, so Newton's steps
  // come down to the root from 1 without passing it. A large z begins at 1 / z, which is above the root too.
  const double root = std::sqrt(lambda), z = gamma / (2 * root);
  double x = z > 1 ? 1 / z : 1;
  for (int i = 0; i < 100; ++i) {
    const double value = ((z * x + 1) * x + z) * x - 1, slope = (3 * z * x + 2) * x + z, next = x - value / slope;
    if (!(next < x)) break;
    x = next;
  }
  return 2 * x / root;
}

}  // namespace scree
