#include "solver/effects/cell/cell_sums.hpp"

#include <omp.h>

#include <algorithm>
#include <span>
#include <vector>

#include "solver/state/run_state.hpp"

namespace scree {

namespace {

/// Contact and kinetic part by rows, then what is lost.
constexpr std::size_t kFromContacts = 0, kKinetic = 9, kLost = 18, kSums = 24;
using Sums = std::vector<ShortSum>;

template <bool kAll>
void add_dyad(const Vec3& f, const Vec3& r, std::size_t first, Sums& sums) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (kAll || i == j) sums[first + static_cast<std::size_t>(3 * i + j)].add(f[i] * r[j]);
    }
  }
}

template <bool kAll>
void add_contacts(const RunState& s, std::span<const std::int32_t> pairs, Sums& sums) {
  const ParticleSet& p = s.particles;
  PairResult of_block;
  for (const std::int32_t k : pairs) {
    const PairResult& result = s.pairs.result_of(k, of_block);
    if (!result.active) continue;
    const BodyPair& pair = s.pairs.stored_pairs()[static_cast<std::size_t>(k)];
    if (pair.b < 0) {  // a plane across z, without friction: how far from it the centre of the body is
      const Wall& plane = s.scene.source().walls[static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall)];
      sums[kFromContacts + 8].add(result.force_a.z * (p.x[static_cast<std::size_t>(pair.a)].z - plane.point.z));
      continue;
    }
    const Vec3 r = p.cell.periodicity().nearest(p.x[static_cast<std::size_t>(pair.a)] - p.x[static_cast<std::size_t>(pair.b)]);
    add_dyad<kAll>(result.force_a, r, kFromContacts, sums);
    const Vec3& lost = result.dissipative_force_a;
    for (int i = 0; i < 3; ++i) sums[kLost + static_cast<std::size_t>(i)].add(lost[i] * r[i]);
    if (!kAll) continue;
    sums[kLost + 3].add(lost.y * r.z);
    sums[kLost + 4].add(lost.x * r.z);
    sums[kLost + 5].add(lost.x * r.y);
  }
}

template <bool kAll>
void add_motion(const ParticleSet& p, std::size_t begin, std::size_t end, Sums& sums) {
  for (std::size_t i = begin; i < end; ++i) add_dyad<kAll>(p.mass[i] * p.v[i], p.v[i], kKinetic, sums);
}

template <bool kAll>
CellSums sums_of(const RunState& s) {
  const auto part = [](std::span<const std::int32_t> pairs, std::size_t n, std::size_t parts) {
    const std::size_t begin = pairs.size() * n / parts, end = pairs.size() * (n + 1) / parts;
    return pairs.subspan(begin, end - begin);
  };
  const auto parts = static_cast<std::size_t>(omp_get_max_threads());
  std::vector<Sums> of_part(parts, Sums(kSums));
#pragma omp parallel for schedule(static, 1)
  for (std::size_t n = 0; n < parts; ++n) {
    add_contacts<kAll>(s, part(s.pairs.inner(), n, parts), of_part[n]);
    add_contacts<kAll>(s, part(s.pairs.outer(), n, parts), of_part[n]);
    add_motion<kAll>(s.particles, s.particles.owned * n / parts, s.particles.owned * (n + 1) / parts, of_part[n]);
  }
  Sums& all = of_part[0];
  for (std::size_t n = 1; n < parts; ++n) {
    for (std::size_t k = 0; k < kSums; ++k) all[k].add(of_part[n][k]);
  }
  if (s.comm.size() > 1) add_over_ranks(s.comm.get(), all);
  CellSums found;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto at = static_cast<std::size_t>(3 * i + j);
      found.contact[static_cast<std::size_t>(i)][j] = all[kFromContacts + at].value();
      found.kinetic[static_cast<std::size_t>(i)][j] = all[kKinetic + at].value();
    }
  }
  for (int c = 0; c < 6; ++c) found.lost[c] = all[kLost + static_cast<std::size_t>(c)].value();
  return found;
}

}  // namespace

CellSums cell_sums(const RunState& s) { return sums_of<true>(s); }
CellSums diagonal_cell_sums(const RunState& s) { return sums_of<false>(s); }

}  // namespace scree
