#include "solver/forces.hpp"

#include "solver/pass_through.hpp"
#include "solver/triangle_contacts.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>

namespace scree {

ForceScratch::ForceScratch() {
  for (int t = 0; t < omp_get_max_threads(); ++t) distance.push_back(make_mesh_distance_scratch());
}

namespace {

// The skin of a pair follows its speed: long enough that lists are renewed every few tens of steps, short enough
// that they stay small. It never changes a result.
constexpr double kSkinSteps = 24;           // steps that a skin lasts at the present relative speed
constexpr double kSmallestSkin = 0.25;      // of the margin sum
constexpr double kLargestSkin = 0.1;        // of the smaller radius

/// Times one pair where that is asked for: reading the clock twice takes a tenth of an average pair.
class PairClock {
 public:
  PairClock(std::vector<float>& seconds, std::int32_t pair)
      : slot_(seconds.empty() ? nullptr : &seconds[static_cast<std::size_t>(pair)]) {
    if (slot_ != nullptr) start_ = Clock::now();
  }
  ~PairClock() {
    if (slot_ != nullptr) *slot_ = std::chrono::duration<float>(Clock::now() - start_).count();
  }
  PairClock(const PairClock&) = delete;
  PairClock& operator=(const PairClock&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  float* slot_;
  Clock::time_point start_;
};

struct PairView {
  PairBody a, b;
  PairMotion motion;
  double radius_a = 0, radius_b = 0, margin = 0;
  const WallZone* zone = nullptr;
  double cell_size = 0;           // of a mesh wall that has cells [m]
};

PairView view_of(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                 const BodyPair& pair) {
  PairView view;
  const auto i = static_cast<std::size_t>(pair.a);
  view.a = {&scene.shape(p.shape[i]), p.scale[i], p.x[i], p.q[i]};
  view.radius_a = p.radius[i];
  view.margin = 2 * scene.margin();
  PairMotion& m = view.motion;
  const Quat to_a = conjugate(p.q[i]);
  Vec3 v_b, w_b, inverse_inertia_b;
  double inverse_mass_b = 0;
  if (pair.b >= 0) {
    const auto j = static_cast<std::size_t>(pair.b);
    view.b = {&scene.shape(p.shape[j]), p.scale[j], p.x[j], p.q[j]};
    if (scene.periodicity().any()) view.b.x = p.x[i] + scene.periodicity().nearest(p.x[j] - p.x[i]);
    view.radius_b = p.radius[j];
    v_b = p.v[j];
    w_b = p.w[j];
    inverse_mass_b = p.inverse_mass[j];
    inverse_inertia_b = p.inverse_inertia[j];
  } else {
    view.zone = &scene.zones()[static_cast<std::size_t>(pair.key.zone)];
    const Wall& wall = scene.source().walls[static_cast<std::size_t>(view.zone->wall)];
    const WallState& state = walls[static_cast<std::size_t>(view.zone->wall)];
    view.b.x = state.position;
    view.b.q = state.orientation;
    view.radius_b = 2 * view.radius_a;  // the wall is the frame of the pair's motion
    if (view.zone->kind == WallZone::Kind::mesh) {
      view.b.shape = &scene.shape(wall.shape);
      view.b.scale = wall.scale;
      view.cell_size = wall.cell_size;
      view.radius_b = std::max(view.radius_b, wall.scale * view.b.shape->radius);
    }
    v_b = state.velocity;
    w_b = state.angular_velocity;
  }
  m.v_a = rotate(to_a, p.v[i]);
  m.w_a = rotate(to_a, p.w[i]);
  m.v_b = rotate(to_a, v_b);
  m.w_b = rotate(to_a, w_b);
  m.centre_b = rotate(to_a, view.b.x - view.a.x);
  m.inverse_mass_a = p.inverse_mass[i];
  m.inverse_mass_b = inverse_mass_b;
  m.inverse_inertia_a = p.inverse_inertia[i];
  m.inverse_inertia_b = inverse_inertia_b;
  m.b_to_a = matrix_of(to_a * view.b.q);
  return view;
}

/// R* of the bodies' equivalent spheres [m]: 1/R* = 1/R_a + 1/R_b. A wall is flat, but for the inside of a sphere.
double contact_radius(const PairView& view) {
  const double a = view.a.scale * view.a.shape->equivalent_radius;
  if (view.zone == nullptr) {
    const double b = view.b.scale * view.b.shape->equivalent_radius;
    return a * b / (a + b);
  }
  return view.zone->kind == WallZone::Kind::sphere && view.zone->radius > a ? a * view.zone->radius / (view.zone->radius - a) : a;
}

bool is_sphere_pair(const PairView& view) {
  return view.zone == nullptr && view.a.shape->kind == ShapeKind::sphere && view.b.shape->kind == ShapeKind::sphere;
}

/// A sphere against a mesh, be that a body or a wall.
bool is_sphere_mesh_pair(const PairView& view) {
  if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) return false;
  return (view.a.shape->kind == ShapeKind::sphere) != (view.b.shape->kind == ShapeKind::sphere);
}

/// Renews the lists of one pair. Returns false when its meshes intersect.
bool renew_lists(const PairView& view, bool triangles, double dt, MeshDistanceScratch& scratch, CandidateLists& lists) {
  const PairMotion& m = view.motion;
  const double small = std::min(view.radius_a, view.radius_b);
  const double speed = length(m.v_a - m.v_b) + (length(m.w_a) + length(m.w_b)) * small;
  const double lower = std::min(kSmallestSkin * view.margin, kLargestSkin * small);
  const double skin = std::clamp(kSkinSteps * speed * dt, lower, kLargestSkin * small);
  if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) {
    list_zone_pair(view.a, view.b, *view.zone, view.margin, skin, view.radius_a, lists);
    return true;
  }
  if (is_sphere_pair(view)) {
    list_sphere_pair(view.a, view.b, skin, view.radius_a, view.radius_b, lists);
    return true;
  }
  if (is_sphere_mesh_pair(view)) {
    return list_sphere_mesh_pair(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
  }
  if (triangles) return list_triangle_contacts(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
  return list_mesh_pair(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
}

void append_contacts(const BodyPair& pair, const PairView& view, const std::vector<ContactFeature>& features,
                     const std::vector<ContactOutput>& outputs, FrameContacts& out) {
  // In files the lower id is A; a wall may have the lower id, then everything is mirrored.
  const bool mirrored = pair.key.b < pair.key.a;
  const double side = mirrored ? -1 : 1;
  for (std::size_t j = 0; j < features.size(); ++j) {
    const ContactFeature& f = features[j];
    out.body_a.push_back(std::min(pair.key.a, pair.key.b));
    out.body_b.push_back(std::max(pair.key.a, pair.key.b));
    // the zone of a wall is part of the key: two faces of a box touch the same corner
    out.feature.push_back(f.key + (pair.key.zone < 0 ? 0 : pair.key.zone));
    out.point.push_back(view.a.x + rotate(view.a.q, f.x));
    out.normal.push_back(side * rotate(view.a.q, f.n));
    out.depth.push_back(f.depth);
    out.margin.push_back(view.margin);
    out.normal_force.push_back(outputs[j].normal_force);
    out.tangential_force.push_back(side * rotate(view.a.q, outputs[j].tangential_force));
  }
}

/// Exponent of the effective depth in the normal force of the scene's law.
double normal_exponent(const LawChoice& choice) {
  double exponent = 1;
  int index = 0;
  const auto look = [&]<class Entry>(const Entry&) {
    if (index++ == choice.law) exponent = Entry::Normal::kExponent;
  };
  std::apply([&](const auto&... entry) { (look(entry), ...); }, kLaws);
  return exponent;
}

}  // namespace

void evaluate_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                    std::span<const std::int32_t> which, double dt, double friction_dt, std::int64_t step,
                    ForceScratch& scratch, PairList& list, FrameContacts* out, const PairLooker* look) {
  const auto count = static_cast<std::ptrdiff_t>(which.size());
  std::atomic<std::int32_t> intersecting{-1}, passing{-1};
  const bool only_looks = out != nullptr || look != nullptr;
  const PairForceFunction force_of = pair_force_function(scene.law_choice());
  const bool independent = scene.law_choice().independent;
  const bool needs_radius = scene.law_choice().needs_radius;
  const double exponent = normal_exponent(scene.law_choice());
#pragma omp parallel if (!only_looks)
  {
    std::vector<ContactFeature> features;
    std::vector<ContactOutput> outputs;
    std::vector<CellShare> cells;
    MeshDistanceScratch& distance = *scratch.distance[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(dynamic, 8)
    for (std::ptrdiff_t n = 0; n < count; ++n) {
      const std::int32_t k = which[static_cast<std::size_t>(n)];
      const PairClock clock(scratch.pair_seconds, k);
      BodyPair& pair = list.pairs()[static_cast<std::size_t>(k)];
      PairResult& result = list.results()[static_cast<std::size_t>(k)];
      result.active = false;
      result.contact_count = 0;
      PairView view = view_of(scene, p, walls, pair);
      double motion = 0;
      if (pair.lists.skin >= 0) motion = motion_since_listed(pair.lists, view.a, view.b, view.radius_a, view.radius_b);
      const bool has_mesh = view.zone == nullptr ? !is_sphere_pair(view) : view.zone->kind == WallZone::Kind::mesh;
      // a body behind a plane or in a cylinder is still seen
      if (motion > 0 && has_mesh && dt > 0 &&
          may_have_passed_through(view.a, view.b, view.motion, view.radius_a, view.radius_b, view.margin, dt, motion, pair.lists, distance)) {
        passing.store(k);
      }
      if (pair.lists.skin < 0 || motion > pair.lists.skin) {
        if (!renew_lists(view, independent, dt, distance, pair.lists)) {
          intersecting.store(k);
          continue;
        }
        motion = 0;
      }
      if (is_sphere_pair(view)) {
        sphere_pair_features(view.a, view.b, view.margin, features);
      } else if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) {
        zone_pair_features(view.a, view.b, *view.zone, view.margin, motion, pair.lists, features);
      } else if (is_sphere_mesh_pair(view)) {
        sphere_mesh_features(view.a, view.b, view.margin, motion, pair.lists, features);
      } else if (independent) {
        triangle_contact_features(view.a, view.b, view.margin, motion, pair.lists, features);
      } else {
        mesh_pair_features(view.a, view.b, view.margin, motion, pair.lists, features);
      }
      if (features.empty()) {
        if (!only_looks) pair.springs.clear();
        continue;
      }
      std::int32_t material_b = 0;
      if (pair.b >= 0) {
        material_b = p.material[static_cast<std::size_t>(pair.b)];
      } else {
        material_b = scene.source().walls[static_cast<std::size_t>(view.zone->wall)].material;
      }
      const PairLaw& law = scene.law(p.material[static_cast<std::size_t>(pair.a)], material_b);
      PairMotion& relative = view.motion;
      if (needs_radius) relative.radius = law.radius > 0 ? law.radius : contact_radius(view);
      if (independent) {
        cells.clear();
        for (std::size_t j = 0; j < features.size(); ++j) cells.push_back({static_cast<std::int64_t>(j), static_cast<std::int32_t>(j), 1, {}});
        relative.independent = true;
        relative.cells = &cells;
      } else if (view.cell_size > 0) {
        find_cell_shares(view.a, view.b, view.cell_size, features, cells);
        relative.cells = &cells;
      }
      // Looking must not change anything: it works on a copy of the springs.
      std::vector<FrictionSpring> copy;
      if (only_looks) copy = pair.springs;
      const PairForce f = force_of(features, law, relative, dt, friction_dt, only_looks ? copy : pair.springs,
                                     out != nullptr ? &outputs : nullptr);
      if (look != nullptr) (*look)({pair, features, f, relative, exponent, law.friction > 0 ? law.tangential_ratio : 0.0});
      const Quat& q = view.a.q;
      result.active = true;
      result.contact_count = static_cast<std::int32_t>(features.size());
      result.force_a = rotate(q, f.force);
      result.torque_a = rotate(q, f.torque);
      result.torque_b = rotate(q, cross(view.motion.centre_b, f.force) - f.torque);
      result.lossy_force_a = rotate(q, f.lossy_force);
      result.lossy_torque_a = rotate(q, f.lossy_torque);
      result.lossy_torque_b = rotate(q, cross(view.motion.centre_b, f.lossy_force) - f.lossy_torque);
      result.elastic = f.elastic;
      result.tangential_elastic = f.tangential_elastic;
      result.depth_ratio = view.margin > 0 ? f.deepest / view.margin : 0;
      if (out != nullptr && counts_here(pair, p)) append_contacts(pair, view, features, outputs, *out);
    }
  }
  const auto describe = [&](const PairKey& key) {
    return key.zone < 0 ? fmt::format("bodies {} and {}", key.a, key.b) : fmt::format("body {} and wall {}", key.a, key.b);
  };
  const char* cure = step == 0 ? "they overlap at the start: move them, or let scree-decomposer part them with contact.relax = true"
                               : "the contact is too soft for this speed or load: raise the stiffness or the margin, or lower the speed";
  if (intersecting.load() >= 0) {
    throw RunInvalid("step {}: {} intersect; {}", step, describe(list.pairs()[static_cast<std::size_t>(intersecting.load())].key), cure);
  }
  if (passing.load() >= 0) {
    throw RunInvalid("step {}: {} move by more than the sum of their margins in a step of {:.3g} s and could have passed through each other "
                     "unseen; reduce the step", step, describe(list.pairs()[static_cast<std::size_t>(passing.load())].key), dt);
  }
  for (std::int32_t k : which) {
    const PairResult& r = list.results()[static_cast<std::size_t>(k)];
    if (r.active && !(r.depth_ratio < kStopDepthRatio)) {
      throw RunInvalid("step {}: {} touch to {:.3f} of their margin (limit {}); {}", step,
                       describe(list.pairs()[static_cast<std::size_t>(k)].key), r.depth_ratio, kStopDepthRatio, cure);
    }
  }
}

void look_at_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                   std::span<const std::int32_t> which, std::int64_t step, ForceScratch& scratch, PairList& list,
                   const PairLooker& look) {
  const std::vector<PairResult> kept = list.results();
  evaluate_pairs(scene, p, walls, which, 0, 0, step, scratch, list, nullptr, &look);
  list.results() = kept;
}

}  // namespace scree
