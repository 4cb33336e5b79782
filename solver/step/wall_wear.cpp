#include "solver/step/wall_wear.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/worn_mesh.hpp"
#include "solver/step/wall_loads.hpp"

namespace scree {

namespace {

const TriangleMesh& mesh_of(const RunState& s, std::size_t wall) { return s.scene.wall_shape(static_cast<std::int32_t>(wall)).mesh; }

std::vector<Vec3> vertices_of(const RunState& s, std::size_t wall) {
  const auto first = s.totals.wear.vertices.begin() + s.scene.first_worn(wall);
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
  const double most = kMostWear * (s.scene.margins_by_size() ? s.scene.least_room() : s.scene.margin());
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

Looks look_at_pairs(RunState& s, const std::vector<std::int32_t>& which, ForceScratch& scratch) {
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
    if (spring.key >= kRollingKey) {
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

bool wear_is_due(const RunState& s) { return s.scene.worn_vertices() > 0 && !walls_due(s).empty(); }

void wear_walls(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  const std::vector<std::size_t> due = walls_due(s);
  LoadMap loads = s.totals.loads;
  add_over_ranks(s.comm.get(), loads);

  // 1. where the vertices go to: the same on every rank
  WearState next = s.totals.wear;
  failure.watch(s.clock.step, [&] {
    for (const std::size_t w : due) {
      const WearOfMesh wear = wear_due(s, w, loads, next.work);
      const std::vector<Vec3> before = vertices_of(s, w);
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
  const Looks before = look_at_pairs(s, which, scratch);
  s.totals.wear = std::move(next);
  for (const std::size_t w : due) s.scene.set_wall_vertices(static_cast<std::int32_t>(w), vertices_of(s, w));
  s.pairs.forget_candidates();
  failure.watch(s.clock.step, [&] {
    const Looks after = look_at_pairs(s, which, scratch);
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

void place_worn_vertices(const RunState& s) {
  for (std::size_t w = 0; w < s.scene.source().walls.size(); ++w) {
    if (s.scene.first_worn(w) >= 0) s.scene.set_wall_vertices(static_cast<std::int32_t>(w), vertices_of(s, w));
  }
}

WornAway worn_away(const RunState& s, std::size_t wall) {
  const Wall& of = s.scene.source().walls[wall];
  WornAway away;
  const TriangleMesh& mesh = mesh_of(s, wall);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
    away.volume += of.wear * s.totals.wear.work[static_cast<std::size_t>(s.scene.first_mapped(wall) + t)];
  const std::vector<Vec3>& drawn = s.scene.shape(of.shape).mesh.vertices;
  for (std::size_t v = 0; v < drawn.size(); ++v) away.depth = std::max(away.depth, of.scale * length(mesh.vertices[v] - drawn[v]));
  return away;
}

}  // namespace scree
