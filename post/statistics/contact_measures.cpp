#include "post/statistics/contact_measures.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/numbers.hpp"
#include "post/run/contact_network.hpp"

namespace scree {

namespace {

Mat3 not_defined() { return {{Vec3{kNaN, kNaN, kNaN}, Vec3{kNaN, kNaN, kNaN}, Vec3{kNaN, kNaN, kNaN}}}; }

void add_dyad(Mat3& sum, const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) sum[i] += a[i] * b;
}

Mat3 scaled(const Mat3& m, double factor) { return {{factor * m[0], factor * m[1], factor * m[2]}}; }

/// Size of the deviator, sqrt(s:s).
double deviator_norm(const Mat3& m) {
  const double mean = (m[0].x + m[1].y + m[2].z) / 3;
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double s = 0.5 * (m[i][j] + m[j][i]) - (i == j ? mean : 0);
      sum += s * s;
    }
  }
  return std::sqrt(sum);
}

Vec3 force_on_a(const FrameContacts& c, std::size_t i) { return c.normal_force[i] * c.normal[i] + c.tangential_force[i]; }

}  // namespace

double anisotropy(const Mat3& fabric) { return std::sqrt(1.5) * 7.5 * deviator_norm(fabric); }

bool Group::holds(const FrameView& view, std::size_t row) const {
  const FrameBodies& b = view.frame.bodies;
  if (view.is_particle[row] == 0) return false;
  if (material >= 0 && b.material[row] != material) return false;
  if (shape >= 0 && b.shape[row] != shape) return false;
  return region == nullptr || view.facts.images_in(*region, b.position[row]) > 0;
}

bool Group::holds_contact(const FrameView& view, std::size_t contact) const {
  if (region != nullptr) return view.facts.images_in(*region, view.frame.contacts.point[contact]) > 0;
  if (material < 0 && shape < 0) return true;
  for (const std::int32_t row : {view.row_a[contact], view.row_b[contact]}) {
    if (row >= 0 && holds(view, static_cast<std::size_t>(row))) return true;
  }
  return false;
}

ContactMeasures contact_measures(const FrameView& view, const Group& group, double volume) {
  ContactMeasures m;
  const FrameContacts& c = view.frame.contacts;
  const FrameBodies& b = view.frame.bodies;
  std::vector<std::uint8_t> member(b.size());
  std::size_t members = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    member[i] = group.holds(view, i) ? 1 : 0;
    members += member[i];
  }
  // a body that lies outside the region still stresses it with the part of its branch that is inside
  const auto stresses = [&](std::int32_t row) {
    return view.particle(row) && (group.region != nullptr || member[static_cast<std::size_t>(row)] != 0);
  };
  const auto branch_part = [&](const Vec3& centre, const Vec3& branch) {
    if (group.region == nullptr) return 1.0;
    double sum = 0;
    view.facts.for_each_image(*group.region, [&](const Vec3& shift) {
      if (const auto part = group.region->part_inside(centre + shift - branch, centre + shift)) sum += part->second - part->first;
    });
    return sum;
  };

  std::vector<std::int32_t> neighbours(b.size());
  std::size_t points = 0, among = 0, ends = 0, pulling = 0;
  double among_force = 0, tension = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!carries(c.normal_force[i])) continue;
    const std::int32_t a = view.row_a[i], o = view.row_b[i];
    // pairs stand together: count a neighbour at the first of its points that carries
    bool is_first = true;
    for (std::size_t k = i; is_first && k > 0 && c.body_a[k - 1] == c.body_a[i] && c.body_b[k - 1] == c.body_b[i]; --k)
      is_first = !carries(c.normal_force[k - 1]);
    for (const std::int32_t row : {a, o}) {
      if (row < 0 || member[static_cast<std::size_t>(row)] == 0) continue;
      if (is_first) ++neighbours[static_cast<std::size_t>(row)];
      ++ends;
    }
    const Vec3 force = force_on_a(c, i);
    if (stresses(a)) {
      const Vec3& x = b.position[static_cast<std::size_t>(a)];
      const Vec3 branch = view.facts.period.nearest(x - c.point[i]);
      add_dyad(m.stress, branch_part(x, branch) * force, branch);
      if (c.normal_force[i] < 0) tension -= branch_part(x, branch) * dot(force, branch);
    }
    if (stresses(o)) {
      const Vec3& x = b.position[static_cast<std::size_t>(o)];
      const Vec3 branch = view.facts.period.nearest(x - c.point[i]);
      add_dyad(m.stress, -branch_part(x, branch) * force, branch);
      if (c.normal_force[i] < 0) tension += branch_part(x, branch) * dot(force, branch);
    }
    if (!group.holds_contact(view, i)) continue;
    ++points;
    m.normal_force += c.normal_force[i];
    m.tangential_force += length(c.tangential_force[i]);
    m.largest_normal_force = std::max(m.largest_normal_force, c.normal_force[i]);
    if (c.normal_force[i] < 0) {
      ++pulling;
      m.tensile_force -= c.normal_force[i];
    }
    if (!view.particle(a) || !view.particle(o)) continue;
    ++among;
    among_force += std::abs(c.normal_force[i]);
    add_dyad(m.fabric, c.normal[i], c.normal[i]);
    add_dyad(m.force_fabric, std::abs(c.normal_force[i]) * c.normal[i], c.normal[i]);
  }

  m.normal_force = points > 0 ? m.normal_force / static_cast<double>(points) : kNaN;
  m.tangential_force = points > 0 ? m.tangential_force / static_cast<double>(points) : kNaN;
  m.tensile = points > 0 ? static_cast<double>(pulling) / static_cast<double>(points) : kNaN;
  m.tensile_force = pulling > 0 ? m.tensile_force / static_cast<double>(pulling) : kNaN;
  m.cohesive_pressure = volume > 0 ? tension / 3 / volume : kNaN;
  m.fabric = among > 0 ? scaled(m.fabric, 1 / static_cast<double>(among)) : not_defined();
  m.force_fabric = among > 0 ? scaled(m.force_fabric, 1 / among_force) : not_defined();
  m.fabric_anisotropy = anisotropy(m.fabric);
  m.force_fabric_anisotropy = anisotropy(m.force_fabric);
  m.stress = volume > 0 ? scaled(m.stress, 1 / volume) : not_defined();
  m.pressure = (m.stress[0].x + m.stress[1].y + m.stress[2].z) / 3;
  m.deviatoric_stress = std::sqrt(1.5) * deviator_norm(m.stress);

  std::size_t all = 0, with_one = 0, rattlers = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (member[i] == 0) continue;
    all += static_cast<std::size_t>(neighbours[i]);
    with_one += neighbours[i] == 1 ? 1U : 0U;
    rattlers += neighbours[i] < 2 ? 1U : 0U;
  }
  const auto per = [](std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : kNaN;
  };
  m.coordination = per(all, members);
  m.rattlers = per(rattlers, members);
  m.coordination_without_rattlers = per(all - with_one, members - rattlers);
  m.points_per_particle = per(ends, members);
  return m;
}

ForceChains force_chains(const FrameView& view) {
  const FrameContacts& c = view.frame.contacts;
  const FrameBodies& b = view.frame.bodies;
  std::vector<Mat3> moment(b.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!carries(c.normal_force[i])) continue;
    const Vec3 force = force_on_a(c, i);
    for (const auto& [row, sign] : {std::pair{view.row_a[i], 1.0}, std::pair{view.row_b[i], -1.0}}) {
      if (!view.particle(row)) continue;
      const auto r = static_cast<std::size_t>(row);
      add_dyad(moment[r], sign * force, view.facts.period.nearest(b.position[r] - c.point[i]));
    }
  }
  std::vector<double> load(b.size());
  std::vector<Vec3> direction(b.size());
  double total = 0;
  std::size_t loaded = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Mat3& s = moment[i];
    if (s == Mat3{}) continue;
    Eigen::Matrix3d symmetric;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) symmetric(j, k) = 0.5 * (s[j][k] + s[k][j]);
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(symmetric);
    load[i] = solver.eigenvalues()[2];
    const Eigen::Vector3d v = solver.eigenvectors().col(2);
    direction[i] = {v[0], v[1], v[2]};
    total += load[i];
    ++loaded;
  }
  ForceChains result;
  if (loaded == 0) return result;
  const double mean = total / static_cast<double>(loaded);

  // what hangs together, by union and find
  std::vector<std::int32_t> parent(b.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      std::int32_t& p = parent[static_cast<std::size_t>(i)];
      p = parent[static_cast<std::size_t>(p)];
      i = p;
    }
    return i;
  };
  const double aligned = std::cos(std::acos(-1.0) / 4);
  const auto strong = [&](std::int32_t row) { return view.particle(row) && load[static_cast<std::size_t>(row)] > mean; };
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!carries(c.normal_force[i]) || !strong(view.row_a[i]) || !strong(view.row_b[i])) continue;
    const auto p = static_cast<std::size_t>(view.row_a[i]), q = static_cast<std::size_t>(view.row_b[i]);
    const Vec3 line = normalised(view.facts.period.nearest(b.position[p] - b.position[q]));
    if (std::abs(dot(line, direction[p])) < aligned || std::abs(dot(line, direction[q])) < aligned) continue;
    parent[static_cast<std::size_t>(root(view.row_a[i]))] = root(view.row_b[i]);
  }
  std::map<std::int32_t, std::vector<std::int64_t>> together;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (strong(static_cast<std::int32_t>(i))) together[root(static_cast<std::int32_t>(i))].push_back(b.id[i]);
  }
  for (auto& [first, ids] : together) {
    if (ids.size() < 3) continue;
    result.members += ids.size();
    result.chains.push_back(std::move(ids));
  }
  return result;
}

ForceDistribution force_distribution(const FrameView& view, std::size_t bins, double largest) {
  const FrameContacts& c = view.frame.contacts;
  ForceDistribution d{std::vector<double>(bins, kNaN), std::vector<double>(bins, kNaN)};
  double sum = 0;
  std::size_t count = 0;
  for (const double f : c.normal_force) {
    if (!(f > 0)) continue;
    sum += f;
    ++count;
  }
  if (count == 0) return d;
  std::fill(d.normal.begin(), d.normal.end(), 0);
  std::fill(d.tangential.begin(), d.tangential.end(), 0);
  const double mean = sum / static_cast<double>(count), width = largest / static_cast<double>(bins);
  const double share = 1 / (static_cast<double>(count) * width);
  const auto add = [&](std::vector<double>& density, double force) {
    const double place = force / mean / width;
    if (place < static_cast<double>(bins)) density[static_cast<std::size_t>(place)] += share;
  };
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!(c.normal_force[i] > 0)) continue;
    add(d.normal, c.normal_force[i]);
    add(d.tangential, length(c.tangential_force[i]));
  }
  return d;
}

}  // namespace scree
