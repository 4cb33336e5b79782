#include "solver/step/wall_loads.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "solver/features/wall_triangles.hpp"
#include "solver/step/impacts.hpp"

namespace scree {

void append_loads(const MappedContact& c, MeshDistanceScratch& scratch, std::vector<LoadEntry>& entries) {
  const Beginning begins = beginning_of(c.features, c.motion, c.friction_dt);
  thread_local std::vector<std::int32_t> triangles;
  for (std::size_t j = 0; j < c.features.list.size(); ++j) {
    const ContactFeature& f = c.features.list[j];
    const ContactOutput& out = c.outputs[j];
    triangles_of(c.view, c.lists, f, scratch, triangles);
    if (triangles.empty()) continue;
    const double share = 1 / static_cast<double>(triangles.size());
    const double part = begins.overlaps > 0 ? share * std::max(0.0, f.overlap) / begins.overlaps : 0;
    LoadEntry entry{};
    entry.wall = c.view.zone->wall;
    entry.body = c.body;
    entry.force = -share * (c.a_to_world * (out.normal_force * out.normal + out.tangential_force));
    entry.arm = c.a_to_world * f.x;
    entry.damping = (share * out.damping) * (c.a_to_world * f.n);
    entry.slid = share * out.slid;
    entry.contacts = part;
    entry.impact = part * begins.energy[kNormalImpact];
    for (const std::int32_t t : triangles) {
      entry.triangle = c.first_mapped + t;
      entries.push_back(entry);
    }
  }
}

void book_loads(const RunState& s, double dt, bool events, LoadMap& map) {
  for (const LoadEntry& e : s.loads) {
    TriangleLoad& at = map.triangles[static_cast<std::size_t>(e.triangle)];
    const WallState& wall = s.walls[static_cast<std::size_t>(e.wall)];
    const auto body = static_cast<std::size_t>(e.body);
    const Vec3 force = rotate_inverse(wall.orientation, e.force);
    for (int k = 0; k < 3; ++k) at[kImpulseX + static_cast<std::size_t>(k)].add(dt * force[k]);
    // with the velocities of now, as all that is dissipated (add_dissipation): those of half a step ago lag behind a force that grows
    const Vec3 from_wall = s.particles.x[body] + e.arm - wall.position;
    const Vec3 velocity = s.particles.v[body] + cross(s.particles.w[body], e.arm) - wall.velocity - cross(wall.angular_velocity, from_wall);
    at[kDampingWork].add(-dt * dot(e.damping, velocity));
    if (!events) continue;
    if (e.slid > 0) at[kSlidingWork].add(e.slid);
    if (!(e.contacts > 0)) continue;
    at[kContacts].add(e.contacts);
    at[kImpactEnergy].add(e.impact);
  }
}

LoadMap loads_now(const RunState& s) {
  LoadMap map = s.totals.loads;
  book_loads(s, -0.5 * s.clock.dt, false, map);
  add_over_ranks(s.comm.get(), map);
  return map;
}

void add_over_ranks(MPI_Comm comm, LoadMap& map) {
  std::vector<std::int64_t> words = words_of(map);
  constexpr std::size_t kAtOnce = std::size_t{1} << 27;  // numbers in one message are counted by an int
  for (std::size_t first = 0; first < words.size(); first += kAtOnce) {
    MPI_Allreduce(MPI_IN_PLACE, words.data() + first, static_cast<int>(std::min(kAtOnce, words.size() - first)), MPI_INT64_T, MPI_SUM,
                  comm);
  }
  set_words(words, map);
}

std::vector<std::int64_t> words_of(const LoadMap& map) {
  std::vector<std::int64_t> words;
  words.reserve(map.triangles.size() * kLoadSums * ShortSum::kWords);
  for (const TriangleLoad& load : map.triangles) {
    for (const ShortSum& sum : load) {
      const ShortSum::Words w = sum.words();
      words.insert(words.end(), w.begin(), w.end());
    }
  }
  return words;
}

void set_words(const std::vector<std::int64_t>& words, LoadMap& map) {
  if (words.size() != map.triangles.size() * kLoadSums * ShortSum::kWords) {
    throw InputError("load maps of {} numbers instead of {}; the file is damaged or of another scene", words.size(),
                     map.triangles.size() * kLoadSums * ShortSum::kWords);
  }
  auto next = words.begin();
  for (TriangleLoad& load : map.triangles) {
    for (ShortSum& sum : load) {
      ShortSum::Words w{};
      std::copy_n(next, w.size(), w.begin());
      next += static_cast<std::ptrdiff_t>(w.size());
      sum.set_words(w);
    }
  }
}

}  // namespace scree
