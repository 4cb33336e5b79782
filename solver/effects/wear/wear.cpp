#include "solver/effects/wear/wear.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/worn_mesh.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/effects/load_maps/load_maps.hpp"
#include "solver/pairs/forces.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

const TriangleMesh& mesh_of(const RunState& s, std::size_t wall) { return s.scene.wall_shape(static_cast<std::int32_t>(wall)).mesh; }

std::vector<Vec3> vertices_of(const RunState& s, const WearState& state, std::size_t wall) {
  const auto first = state.vertices.begin() + s.scene.first_worn(wall);
  return {first, first + s.scene.shape(s.scene.source().walls[wall].shape).mesh.vertex_count()};
}

std::vector<std::size_t> walls_due(const RunState& s) {
  std::vector<std::size_t> due;
  for (std::size_t w = 0; w < s.scene.source().walls.size(); ++w) {
    if (s.scene.first_worn(w) >= 0 && s.clock.step % wear_steps(s.scene.source().walls[w], s.clock.size.step) == 0) due.push_back(w);
  }
  return due;
}

/// The side of each triangle of a wall that bodies press on, since the start of the run. Nothing is behind a closed surface.
std::vector<signed char> pushed_sides(const RunState& s, std::size_t wall, const LoadMap& loads) {
  const TriangleMesh& mesh = mesh_of(s, wall);
  std::vector<signed char> pushed;
  if (is_closed(mesh)) return std::vector<signed char>(mesh.triangles.size(), -1);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const TriangleLoad& load = loads.triangles[static_cast<std::size_t>(s.scene.first_mapped(wall) + t)];
    const Vec3 impulse{load[kImpulseX].value(), load[kImpulseY].value(), load[kImpulseZ].value()};
    const double along = dot(impulse, cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
    pushed.push_back(along > 0 ? 1 : along < 0 ? -1 : 0);
  }
  return pushed;
}

/// What a wall is to lose for the sliding work since it was worn last.
WearOfMesh wear_due(const RunState& s, std::size_t wall, const LoadMap& loads, std::vector<double>& work) {
  const Wall& of = s.scene.source().walls[wall];
  WearOfMesh due{{}, pushed_sides(s, wall, loads)};
  const double per_work = of.wear / (of.scale * of.scale * of.scale);
  for (std::size_t t = 0; t < due.pushed.size(); ++t) {
    const std::size_t row = static_cast<std::size_t>(s.scene.first_mapped(wall)) + t;
    const double now = loads.triangles[row][kSlidingWork].value();
    due.volume.push_back(per_work * std::max(0.0, now - work[row]));
    work[row] = now;
  }
  return due;
}

void check_depth(const RunState& s, std::size_t wall, const std::vector<Vec3>& before, const std::vector<Vec3>& after) {
  const Wall& of = s.scene.source().walls[wall];
  double deepest = 0;
  for (std::size_t v = 0; v < before.size(); ++v) deepest = std::max(deepest, of.scale * length(after[v] - before[v]));
  const double most = kMaxWear * (s.scene.margins_by_size() ? s.scene.smallest_max_overlap() : s.scene.margin());
  if (deepest <= most) return;
  throw RunInvalid("step {}: wall '{}' wears by {} at a time, more than a tenth of the margin ({}); give its wear an `every` of at most {}",
                   s.clock.step, of.name, format_quantity(deepest, Dimension::length), format_quantity(most, Dimension::length),
                   format_quantity(0.5 * of.wear_every * most / deepest, Dimension::time));
}

/// Features of a pair where they are, for its springs to find theirs again.
struct Feature {
  std::int64_t key;
  Vec3 x;
};
struct PairLook {
  std::vector<Feature> features;
  double elastic = 0;
};
using Looks = std::map<std::int32_t, PairLook>;  // by index of the pair

Looks record_features(RunState& s, const std::vector<std::int32_t>& which, ForceScratch& scratch) {
  Looks looks;
  visit_pairs(s.scene, s.particles, s.walls, which, s.clock.step, scratch, s.pairs, [&](const PairContact& c) {
    PairLook& look = looks[static_cast<std::int32_t>(&c.pair - s.pairs.pairs().data())];
    look.elastic = c.force.elastic;
    for (const ContactFeature& f : c.features.list) look.features.push_back({f.key, f.x});
  });
  return looks;
}

/// Gives each spring the key of the feature that is nearest to where its own was, the same one before others as near. A feature takes one
/// spring; one that finds none goes, and with it what it stored.
void rename_springs(const PairLook& before, const PairLook& after, double farthest, std::vector<FrictionSpring>& springs) {
  std::vector<FrictionSpring> kept;
  for (FrictionSpring spring : springs) {
    if (!is_of_feature(spring)) {
      kept.push_back(spring);
      continue;
    }
    const auto was = std::find_if(before.features.begin(), before.features.end(), [&](const Feature& f) { return f.key == spring.key; });
    if (was == before.features.end()) continue;
    const Feature* found = nullptr;
    double nearest = farthest;
    for (const Feature& f : after.features) {
      const double distance = length(f.x - was->x);
      if (distance < nearest || (distance == nearest && found != nullptr && f.key == spring.key)) {
        nearest = distance;
        found = &f;
      }
    }
    if (found == nullptr) continue;
    spring.key = found->key;
    kept.push_back(spring);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const FrictionSpring& l, const FrictionSpring& r) { return l.key < r.key; });
  kept.erase(std::unique(kept.begin(), kept.end(), [](const FrictionSpring& l, const FrictionSpring& r) { return l.key == r.key; }),
             kept.end());
  springs = std::move(kept);
}

}  // namespace

std::int64_t wear_steps(const Wall& wall, double step) { return std::max<std::int64_t>(1, std::llround(wall.wear_every / step)); }

Wear::Wear(const RunState& s) {
  state_.work.resize(static_cast<std::size_t>(s.scene.mapped_triangles()));
  for (const Wall& wall : s.scene.source().walls) {
    if (!(wall.wear > 0)) continue;
    const std::vector<Vec3>& vertices = s.scene.shape(wall.shape).mesh.vertices;
    state_.vertices.insert(state_.vertices.end(), vertices.begin(), vertices.end());
  }
}

bool Wear::after_step(const StepParts& parts) {
  const std::vector<std::size_t> due = walls_due(parts.state);
  if (due.empty()) return false;
  parts.agree_on_failures();
  wear_walls(parts, due);
  return true;
}

void Wear::wear_walls(const StepParts& parts, const std::vector<std::size_t>& due) {
  RunState& s = parts.state;
  ForceScratch& scratch = parts.scratch;
  FirstFailure& failure = parts.failure;
  const LoadMap loads = s.effect<LoadMaps>()->of_all_ranks(s);  // a wall that wears has a map

  // 1. where the vertices go to: the same on every rank
  WearState next = state_;
  failure.watch(s.clock.step, [&] {
    for (const std::size_t w : due) {
      const WearOfMesh wear = wear_due(s, w, loads, next.work);
      const std::vector<Vec3> before = vertices_of(s, next, w);
      std::vector<Vec3> after;
      try {
        after = worn_vertices(mesh_of(s, w), wear);
      } catch (const InputError& error) {
        throw RunInvalid("step {}: wall '{}' cannot be worn further: {}; use a finer mesh, or end the run here", s.clock.step,
                         s.scene.source().walls[w].name, error.what());
      }
      check_depth(s, w, before, after);
      std::copy(after.begin(), after.end(), next.vertices.begin() + s.scene.first_worn(w));
    }
  });
  if (failure.exists()) return;

  // 2. pairs with these walls as they are, and as they are after that
  std::vector<std::int32_t> which;
  for (const std::int32_t k : s.pairs.with_walls()) {
    const auto zone = static_cast<std::size_t>(s.pairs.pairs()[static_cast<std::size_t>(k)].key.zone);
    const auto wall = static_cast<std::size_t>(s.scene.zones()[zone].wall);
    if (s.pairs.results()[static_cast<std::size_t>(k)].active && std::find(due.begin(), due.end(), wall) != due.end()) which.push_back(k);
  }
  const Looks before = record_features(s, which, scratch);
  state_ = std::move(next);
  for (const std::size_t w : due) s.scene.set_wall_vertices(static_cast<std::int32_t>(w), vertices_of(s, state_, w));
  s.pairs.forget_candidates();
  failure.watch(s.clock.step, [&] {
    const Looks after = record_features(s, which, scratch);
    const PairLook nothing;
    for (const std::int32_t k : which) {
      const auto was = before.find(k), is = after.find(k);
      const PairLook &left = was != before.end() ? was->second : nothing, &now = is != after.end() ? is->second : nothing;
      s.totals.walls.dissipated.add(left.elastic);
      s.totals.walls.dissipated.add(-now.elastic);
      s.pairs.results()[static_cast<std::size_t>(k)].elastic = now.elastic;
      rename_springs(left, now, 2 * s.scene.contact_range(), s.pairs.pairs()[static_cast<std::size_t>(k)].state.springs);
    }
  });
}

void Wear::begin(RunState& s) {
  for (std::size_t w = 0; w < s.scene.source().walls.size(); ++w) {
    if (s.scene.first_worn(w) >= 0) s.scene.set_wall_vertices(static_cast<std::int32_t>(w), vertices_of(s, state_, w));
  }
}

std::vector<WornWall> Wear::at_end(const RunState& s) const {
  const LoadMap loads = s.effect<LoadMaps>()->of_all_ranks(s);
  std::vector<WornWall> walls;
  for (std::size_t w = 0; w < s.scene.source().walls.size(); ++w) {
    if (s.scene.first_worn(w) < 0) continue;
    const Wall& of = s.scene.source().walls[w];
    WornWall worn{w, mesh_of(s, w), 0, 0, ""};
    std::vector<double> work = state_.work;
    try {
      worn.mesh.vertices = worn_vertices(worn.mesh, wear_due(s, w, loads, work));
    } catch (const InputError& error) {
      worn.fault = error.what();
    }
    for (std::int32_t t = 0; t < worn.mesh.triangle_count(); ++t)
      worn.volume += of.wear * work[static_cast<std::size_t>(s.scene.first_mapped(w) + t)];
    const std::vector<Vec3>& drawn = s.scene.shape(of.shape).mesh.vertices;
    for (std::size_t v = 0; v < drawn.size(); ++v) worn.depth = std::max(worn.depth, of.scale * length(worn.mesh.vertices[v] - drawn[v]));
    walls.push_back(std::move(worn));
  }
  return walls;
}

EffectRecord Wear::record(const RunState&) const {
  StateArray vertices;
  for (const Vec3& v : state_.vertices) vertices.reals.insert(vertices.reals.end(), {v.x, v.y, v.z});
  return {vertices, {.reals = state_.work}};
}

void Wear::restore(RunState&, const EffectRecord& record) {
  const std::vector<double>&vertices = record[0].reals, &work = record[1].reals;
  if (vertices.size() != 3 * state_.vertices.size() || work.size() != state_.work.size()) {
    throw InputError("worn walls of {} vertices and {} triangles instead of {} and {}; the file is damaged or of another scene",
                     vertices.size() / 3, work.size(), state_.vertices.size(), state_.work.size());
  }
  for (std::size_t v = 0; v < state_.vertices.size(); ++v) state_.vertices[v] = {vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]};
  state_.work = work;
}

namespace {

/// One line for each column of SCREE_FRAME_WEAR.
struct ComputedOfVertex {
  const Wall& of;
  const Vec3& place;
  std::int64_t wall() const { return of.id; }
  Vec3 vertex() const { return place; }
};

}  // namespace

void Wear::add_frame(const RunState& s, Frame& frame) const {
  if (s.comm.rank() != 0) return;
  FrameWear& wear = frame.wear;
  for (std::size_t w = 0; w < s.scene.source().walls.size(); ++w) {
    const std::int32_t first = s.scene.first_worn(w);
    if (first < 0) continue;
    const Wall& wall = s.scene.source().walls[w];
    for (std::int32_t v = 0; v < s.scene.shape(wall.shape).mesh.vertex_count(); ++v) {
      const ComputedOfVertex computed{wall, state_.vertices[static_cast<std::size_t>(first + v)]};
#define SCREE_FILL_COMPUTED(type, name, path, unit, csv, uses, what) wear.name.push_back(computed.name());
      SCREE_FRAME_WEAR(SCREE_FILL_COMPUTED)
#undef SCREE_FILL_COMPUTED
    }
  }
}

std::vector<PlanLine> Wear::plan(const RunState& s) const {
  std::vector<PlanLine> lines;
  for (const Wall& wall : s.scene.source().walls) {
    if (!(wall.wear > 0)) continue;
    lines.emplace_back("wear", fmt::format("'{}': {} per sliding work, every {} steps", wall.name,
                                           format_quantity(wall.wear, Dimension::wear_coefficient), wear_steps(wall, s.clock.size.step)));
  }
  return lines;
}

EffectKind wear_effect() {
  return {{"wear", "the vertices of a wall that wears differ", {{"vertices", "m", 3}, {"work", "J"}}},
          {"wear", "no wall wears"},
          [](const RunState& s) -> std::unique_ptr<Effect> {
            if (s.scene.worn_vertices() == 0) return nullptr;
            return std::make_unique<Wear>(s);
          }};
}

}  // namespace scree
