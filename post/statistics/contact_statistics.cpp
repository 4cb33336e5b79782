#include "post/statistics/contact_statistics.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>

#include "post/run/contact_network.hpp"

namespace scree {

namespace {

double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  if (low + 1 >= sorted.size()) return sorted.back();
  return sorted[low] + (place - static_cast<double>(low)) * (sorted[low + 1] - sorted[low]);
}

void add_dyad(Mat3& sum, const Vec3& n) {
  for (int i = 0; i < 3; ++i) sum[i] += n[i] * n;
}

void divide(Mat3& m, std::size_t count) {
  for (int i = 0; i < 3 && count > 0; ++i) m[i] *= 1.0 / static_cast<double>(count);
}

Vec3 eigenvalues(const Mat3& m) {
  Eigen::Matrix3d a;
  for (int i = 0; i < 3; ++i) a.row(i) << m[i].x, m[i].y, m[i].z;
  const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a, Eigen::EigenvaluesOnly).eigenvalues();
  return {values[0], values[1], values[2]};
}

nlohmann::json json_of(const Distribution& d) {
  return {{"count", d.count},   {"mean", d.mean}, {"min", d.smallest}, {"q05", d.q05},    {"q25", d.q25},
          {"median", d.median}, {"q75", d.q75},   {"q95", d.q95},      {"max", d.largest}};
}

nlohmann::json json_of(const Mat3& m) {
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({m[i].x, m[i].y, m[i].z});
  return rows;
}

}  // namespace

Distribution distribution_of(std::vector<double> sample) {
  Distribution d;
  d.count = sample.size();
  if (sample.empty()) return d;
  std::sort(sample.begin(), sample.end());
  d.mean = std::accumulate(sample.begin(), sample.end(), 0.0) / static_cast<double>(sample.size());
  d.smallest = sample.front();
  d.largest = sample.back();
  d.q05 = quantile(sample, 0.05);
  d.q25 = quantile(sample, 0.25);
  d.median = quantile(sample, 0.5);
  d.q75 = quantile(sample, 0.75);
  d.q95 = quantile(sample, 0.95);
  return d;
}

ContactStatistics contact_statistics(const Frame& frame, const std::unordered_set<std::int64_t>& boundary) {
  ContactStatistics s;
  s.time = frame.time;
  std::unordered_map<std::int64_t, std::size_t> neighbours;  // of each particle
  for (std::int64_t id : frame.bodies.id) {
    if (!boundary.contains(id)) neighbours.emplace(id, 0);
  }
  s.particles = neighbours.size();

  const FrameContacts& c = frame.contacts;
  std::map<std::pair<std::int64_t, std::int64_t>, Vec3> resultant;
  std::size_t points_of_particles = 0, among_particles = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (c.margin[i] > 0) s.max_overlap_ratio = std::max(s.max_overlap_ratio, c.overlap[i] / c.margin[i]);
    if (!carries(c.normal_force[i])) continue;
    const bool a_moves = !boundary.contains(c.body_a[i]), b_moves = !boundary.contains(c.body_b[i]);
    ++s.contacts;
    s.contact_forces.push_back(c.normal_force[i]);
    resultant[{c.body_a[i], c.body_b[i]}] += c.normal_force[i] * c.normal[i] + c.tangential_force[i];
    points_of_particles += (a_moves ? 1U : 0U) + (b_moves ? 1U : 0U);
    add_dyad(s.fabric_with_walls, c.normal[i]);
    if (a_moves && b_moves) {
      add_dyad(s.fabric, c.normal[i]);
      ++among_particles;
    }
  }
  divide(s.fabric, among_particles);
  divide(s.fabric_with_walls, s.contacts);
  s.fabric_principal = eigenvalues(s.fabric);

  std::vector<double> pair_forces;
  for (const auto& [pair, force] : resultant) {
    pair_forces.push_back(length(force));
    const auto a = neighbours.find(pair.first), b = neighbours.find(pair.second);
    if (a != neighbours.end()) ++a->second;
    if (b != neighbours.end()) ++b->second;
    if (a != neighbours.end() && b != neighbours.end()) {
      ++s.pairs_of_particles;
    } else if (a != neighbours.end() || b != neighbours.end()) {
      ++s.pairs_with_walls;
    }
  }
  s.contact_force = distribution_of(s.contact_forces);
  s.pair_force = distribution_of(std::move(pair_forces));

  std::size_t all = 0, with_one = 0;
  for (const auto& [id, count] : neighbours) {
    all += count;
    with_one += count == 1 ? 1U : 0U;
    s.rattlers += count < 2 ? 1U : 0U;
  }
  if (s.particles > 0) {
    s.coordination = static_cast<double>(all) / static_cast<double>(s.particles);
    s.contacts_per_particle = static_cast<double>(points_of_particles) / static_cast<double>(s.particles);
  }
  if (s.particles > s.rattlers) {
    s.coordination_without_rattlers = static_cast<double>(all - with_one) / static_cast<double>(s.particles - s.rattlers);
  }
  return s;
}

nlohmann::json json_of(const ContactStatistics& s) {
  return {{"time", s.time},
          {"particles", s.particles},
          {"contacts", s.contacts},
          {"pairs_of_particles", s.pairs_of_particles},
          {"pairs_with_walls", s.pairs_with_walls},
          {"rattlers", s.rattlers},
          {"coordination", s.coordination},
          {"coordination_without_rattlers", s.coordination_without_rattlers},
          {"contacts_per_particle", s.contacts_per_particle},
          {"max_depth_ratio", s.max_overlap_ratio},
          {"normal_force_per_contact", json_of(s.contact_force)},
          {"force_per_pair", json_of(s.pair_force)},
          {"fabric", json_of(s.fabric)},
          {"fabric_principal", {s.fabric_principal.x, s.fabric_principal.y, s.fabric_principal.z}},
          {"fabric_with_walls", json_of(s.fabric_with_walls)}};
}

std::string table_of(const ContactStatistics& s) {
  const auto row = [](const Distribution& d) {
    return fmt::format("mean {:.4g} N; 5 % {:.4g}, 25 % {:.4g}, median {:.4g}, 75 % {:.4g}, 95 % {:.4g}, largest {:.4g} N", d.mean, d.q05,
                       d.q25, d.median, d.q75, d.q95, d.largest);
  };
  std::string text;
  text += fmt::format("time                       {:.6g} s\n", s.time);
  text += fmt::format("particles                  {} ({} rattlers: fewer than two neighbours)\n", s.particles, s.rattlers);
  text += fmt::format("pairs in contact           {} among particles, {} with walls; {} contact points\n", s.pairs_of_particles,
                      s.pairs_with_walls, s.contacts);
  text += fmt::format("coordination number        {:.3f} neighbours per particle ({:.3f} without rattlers); {:.3f} contact points\n",
                      s.coordination, s.coordination_without_rattlers, s.contacts_per_particle);
  text += fmt::format("normal force per contact   {}\n", row(s.contact_force));
  text += fmt::format("force per pair             {}\n", row(s.pair_force));
  text += "fabric tensor              ";
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("{}[{: .4f} {: .4f} {: .4f}]\n", i == 0 ? "" : "                           ", s.fabric[i].x, s.fabric[i].y,
                        s.fabric[i].z);
  }
  text += fmt::format("                           principal {:.4f} {:.4f} {:.4f} (isotropic: 0.3333)\n", s.fabric_principal.x,
                      s.fabric_principal.y, s.fabric_principal.z);
  text += fmt::format("overlap / margin           at most {:.4f}\n", s.max_overlap_ratio);
  return text;
}

}  // namespace scree
