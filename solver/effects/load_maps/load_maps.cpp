#include "solver/effects/load_maps/load_maps.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/contact/beginning.hpp"
#include "solver/features/wall_triangles.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

/// Appends what the features of a contact do to the triangles of the wall.
/// in   first_mapped   SolverScene::first_mapped of the wall
/// out  begun   takes what begins on a fragment
void append_loads(const ParticleSet& p, const PairContact& c, std::int32_t first_mapped, std::vector<LoadEntry>& entries,
                  std::vector<BegunOnFragment>& begun) {
  const Beginning begins = beginning_of(c.features, c.motion, c.friction_dt);
  const bool is_of_fragment = c.motion.is_bonded() && begins.overlaps > 0;
  const auto place = is_of_fragment ? static_cast<std::int32_t>(begun.size()) : -1;
  if (is_of_fragment) begun.push_back(begun_on_fragment(p, c, begins));
  thread_local std::vector<std::int32_t> triangles;
  for (std::size_t j = 0; j < c.features.list.size(); ++j) {
    const ContactFeature& f = c.features.list[j];
    const ContactOutput& out = c.outputs[j];
    triangles_of(c.view, c.lists, f, c.distance, triangles);
    if (triangles.empty()) continue;
    const double share = 1 / static_cast<double>(triangles.size());
    const double part = begins.overlaps > 0 ? share * std::max(0.0, f.overlap) / begins.overlaps : 0;
    LoadEntry entry{};
    entry.wall = c.view.zone->wall;
    entry.body = c.pair.a;
    entry.force = -share * (c.a_to_world * (out.normal_force * out.normal + out.tangential_force));
    entry.arm = c.a_to_world * f.x;
    entry.damping = (share * out.damping) * (c.a_to_world * f.n);
    entry.slid = share * out.slid;
    entry.contacts = part;
    entry.impact = is_of_fragment ? part : part * begins.energy[kNormalImpact];
    entry.begun = place;
    for (const std::int32_t t : triangles) {
      entry.triangle = first_mapped + t;
      entries.push_back(entry);
    }
  }
}

/// Adds the entries of the present forces to a map.
/// in   dt       that the forces count for [s]     in  events   whether what happened in the step counts too
void add_entries(const RunState& s, const std::vector<LoadEntry>& entries, double dt, bool events, LoadMap& map) {
  for (const LoadEntry& e : entries) {
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
    if (e.begun < 0) at[kImpactEnergy].add(e.impact);
  }
}

/// kLoadSums x ShortSum::kWords for each triangle.
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

/// Throws InputError for another number of words.
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

/// The same for all triangles on every rank. Collective.
void add_over_ranks(MPI_Comm comm, LoadMap& map) {
  std::vector<std::int64_t> words = words_of(map);
  add_words_over_ranks(comm, words);
  set_words(words, map);
}

/// What no column of a triangle holds: one line for each column of SCREE_FRAME_LOADS.
struct ComputedOfTriangle {
  const Wall& of;
  std::int32_t number;
  const TriangleLoad& load;
  std::int64_t wall() const { return of.id; }
  std::int32_t triangle() const { return number; }
  Vec3 impulse() const { return {load[kImpulseX].value(), load[kImpulseY].value(), load[kImpulseZ].value()}; }
  double sliding_work() const { return load[kSlidingWork].value(); }
  double damping_work() const { return load[kDampingWork].value(); }
  double contacts() const { return load[kContacts].value(); }
  double impact_energy() const { return load[kImpactEnergy].value(); }
};

void add_to_frame(const SolverScene& scene, const LoadMap& map, FrameLoads& loads) {
  for (std::size_t w = 0; w < scene.source().walls.size(); ++w) {
    const std::int32_t first = scene.first_mapped(w);
    if (first < 0) continue;
    const Wall& wall = scene.source().walls[w];
    for (std::int32_t t = 0; t < scene.shape(wall.shape).mesh.triangle_count(); ++t) {
      const ComputedOfTriangle computed{wall, t, map.triangles[static_cast<std::size_t>(first + t)]};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) loads.name.push_back(computed.name());
      SCREE_FRAME_LOADS(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
    }
  }
}

}  // namespace

LoadMaps::LoadMaps(const RunState& s) : state_(s), scene_(s.scene), entries_(most_threads()), begun_(most_threads()) {
  map_.triangles.resize(static_cast<std::size_t>(s.scene.mapped_triangles()));
}

void LoadMaps::before_forces(RunState&) {
  for (std::vector<LoadEntry>& of_thread : entries_) of_thread.clear();
  for (std::vector<BegunOnFragment>& of_thread : begun_) of_thread.clear();
}

bool LoadMaps::observes(const PairView& view) const {
  return view.zone != nullptr && scene_.first_mapped(static_cast<std::size_t>(view.zone->wall)) >= 0;
}

void LoadMaps::observe(const PairContact& c) {
  append_loads(state_.particles, c, scene_.first_mapped(static_cast<std::size_t>(c.view.zone->wall)), entries_[c.thread], begun_[c.thread]);
}

void LoadMaps::start(RunState& s) {
  for (const std::vector<LoadEntry>& of_thread : entries_) add_entries(s, of_thread, 0.5 * s.clock.dt, false, map_);
}

void LoadMaps::after_kick(RunState& s) {
  for (const std::vector<LoadEntry>& of_thread : entries_) add_entries(s, of_thread, s.clock.dt, true, map_);
}

/// As for the impulse of the wall (StepLevels::change).
void LoadMaps::on_step_change(RunState& s, double difference) {
  for (const std::vector<LoadEntry>& of_thread : entries_) add_entries(s, of_thread, difference, false, map_);
}

/// Pieces of one fragment strike together, on any ranks.
void LoadMaps::end_step(const StepParts& parts) {
  if (!parts.state.fragments) return;
  std::vector<BegunOnFragment> all;
  std::vector<std::size_t> first;  // of each thread
  for (const std::vector<BegunOnFragment>& of_thread : begun_) {
    first.push_back(all.size());
    all.insert(all.end(), of_thread.begin(), of_thread.end());
  }
  const std::vector<ShareOfImpact> shares = share_impacts(parts.state, all);
  for (std::size_t thread = 0; thread < entries_.size(); ++thread) {
    for (const LoadEntry& e : entries_[thread]) {
      if (e.begun < 0 || !(e.impact > 0)) continue;
      const ShareOfImpact& of = shares[first[thread] + static_cast<std::size_t>(e.begun)];
      map_.triangles[static_cast<std::size_t>(e.triangle)][kImpactEnergy].add(e.impact * of.share * of.energy[kNormalImpact]);
    }
  }
}

LoadMap LoadMaps::of_all_ranks(const RunState& s) const {
  LoadMap map = map_;
  add_over_ranks(s.comm.get(), map);
  return map;
}

EffectRecord LoadMaps::record(const RunState& s) const { return {{.integers = words_of(of_all_ranks(s))}}; }

void LoadMaps::restore(RunState& s, const EffectRecord& record) {
  if (s.comm.rank() == 0) set_words(record.front().integers, map_);
}

void LoadMaps::add_frame(const RunState& s, Frame& frame) const {
  // at the present moment: without the half of the last step that lies ahead
  LoadMap now = map_;
  for (const std::vector<LoadEntry>& of_thread : entries_) add_entries(s, of_thread, -0.5 * s.clock.dt, false, now);
  add_over_ranks(s.comm.get(), now);
  if (s.comm.rank() == 0) add_to_frame(s.scene, now, frame.loads);
}

std::vector<PlanLine> LoadMaps::plan(const RunState& s) const {
  std::vector<PlanLine> lines;
  for (const Wall& wall : s.scene.source().walls) {
    if (!wall.load_map) continue;
    const auto triangles = static_cast<double>(s.scene.shape(wall.shape).mesh.triangle_count());
    lines.emplace_back("load map", fmt::format("'{}': {:.0f} triangles, {:.1f} kB on each rank", wall.name, triangles,
                                               triangles * sizeof(TriangleLoad) / 1e3));
  }
  return lines;
}

EffectKind load_maps_effect() {
  return {{"", "the load map of a wall differs", {{"loads", "", static_cast<std::int64_t>(kLoadSums * ShortSum::kWords), false}}},
          {"load maps", "no wall has one"},
          [](const RunState& s) -> std::unique_ptr<Effect> {
            if (s.scene.mapped_triangles() == 0) return nullptr;
            return std::make_unique<LoadMaps>(s);
          }};
}

}  // namespace scree
