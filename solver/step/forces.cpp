#include "solver/step/forces.hpp"

#include "solver/built_with.hpp"
#include "solver/contact/pass_through.hpp"
#include "solver/contact/triangle_contacts.hpp"
#include "solver/neighbours/work_shares.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>

namespace scree {

ForceScratch::ForceScratch() {
  for (int t = 0; t < omp_get_max_threads(); ++t) distance.push_back(make_mesh_distance_scratch());
}

namespace {

// The skin of a pair follows its speed: long enough that lists are rebuilt every few tens of steps, short enough
// that they stay small. It never changes a result.
constexpr double kSkinSteps = 24;       // steps that a skin lasts at the present relative speed
constexpr double kSmallestSkin = 0.25;  // of the margin sum
constexpr double kLargestSkin = 0.1;    // of the smaller radius

constexpr std::size_t kPairsAtOnce = 64;  // that a thread takes

/// Times one pair where that is asked for: reading the clock twice takes a tenth of an average pair.
class PairClock {
 public:
  PairClock(std::vector<float>& seconds, std::int32_t pair) : slot_(seconds.empty() ? nullptr : &seconds[static_cast<std::size_t>(pair)]) {
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

/// Where both sides of a pair are: all that finding its features takes.
struct PairView {
  PairBody a, b;
  RelativePose pose;
  double radius_a = 0, radius_b = 0, margin = 0;
  const WallZone* zone = nullptr;
  double cell_size = 0;  // [m]
  CellSide cells = CellSide::none;
};

PairView view_of(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, const BodyPair& pair) {
  PairView view;
  const auto i = static_cast<std::size_t>(pair.a);
  view.a = {&scene.shape(p.shape[i]), p.scale[i], p.x[i], p.q[i]};
  view.radius_a = p.radius[i];
  view.margin = 2 * scene.margin();
  if (pair.b >= 0) {
    const auto j = static_cast<std::size_t>(pair.b);
    view.b = {&scene.shape(p.shape[j]), p.scale[j], p.x[j], p.q[j]};
    if (scene.periodicity().any()) view.b.x = p.x[i] + scene.periodicity().nearest(p.x[j] - p.x[i]);
    view.radius_b = p.radius[j];
    const double cells_a = view.a.scale * view.a.shape->cell_size, cells_b = view.b.scale * view.b.shape->cell_size;
    view.cell_size = std::max(cells_a, cells_b);
    if (view.cell_size > 0) view.cells = cells_a > cells_b ? CellSide::a : cells_b > cells_a ? CellSide::b : CellSide::both;
  } else {
    view.zone = &scene.zones()[static_cast<std::size_t>(pair.key.zone)];
    const Wall& wall = scene.source().walls[static_cast<std::size_t>(view.zone->wall)];
    const WallState& state = walls[static_cast<std::size_t>(view.zone->wall)];
    view.b.x = state.position;
    view.b.q = state.orientation;
    view.radius_b = 2 * view.radius_a;  // the wall is the frame of the pair's motion
    const double wall_cells = view.zone->kind == WallZone::Kind::mesh ? wall.cell_size : 0.0,
                 own_cells = view.a.scale * view.a.shape->cell_size;
    view.cell_size = std::max(own_cells, wall_cells);
    if (view.cell_size > 0) view.cells = own_cells > wall_cells ? CellSide::a : CellSide::b;
    if (view.zone->kind == WallZone::Kind::mesh) {
      view.b.shape = &scene.shape(wall.shape);
      view.b.scale = wall.scale;
      view.radius_b = std::max(view.radius_b, wall.scale * view.b.shape->radius);
    }
  }
  view.pose = RelativePose(view.a, view.b);
  return view;
}

/// Velocities of both sides, world axes.
struct PairVelocities {
  Vec3 v_a, w_a, v_b, w_b;
  Vec3 pivot_b, pivot_v_b;  ///< a point of B and its velocity; arms of slip are taken to it
};

/// Within a step the bodies' are those of half a step before, and so are the walls'; at its end, where springs do not move, those of now.
PairVelocities velocities_of(const ParticleSet& p, const std::vector<WallState>& walls, const BodyPair& pair, const PairView& view,
                             bool in_step) {
  const auto i = static_cast<std::size_t>(pair.a);
  if (pair.b >= 0) {
    const auto j = static_cast<std::size_t>(pair.b);
    return {p.v[i], p.w[i], p.v[j], p.w[j], view.b.x, p.v[j]};
  }
  const WallState& state = walls[static_cast<std::size_t>(view.zone->wall)];
  if (in_step) return {p.v[i], p.w[i], state.velocity_before, state.angular_velocity_before, state.pivot, state.pivot_velocity_before};
  return {p.v[i], p.w[i], state.velocity, state.angular_velocity, view.b.x, state.velocity};
}

/// All that the law asks for, A frame.
PairMotion motion_of(const ParticleSet& p, const BodyPair& pair, const PairView& view, const PairVelocities& world,
                     const Mat3& a_to_world) {
  PairMotion m;
  m.v_a = transpose_times(a_to_world, world.v_a);
  m.w_a = transpose_times(a_to_world, world.w_a);
  m.v_b = transpose_times(a_to_world, world.v_b);
  m.w_b = transpose_times(a_to_world, world.w_b);
  m.centre_b = m.pivot_b = view.pose.centre;
  m.pivot_v_b = m.v_b;
  if (!(world.pivot_b == view.b.x)) {
    m.pivot_b = rotate_inverse(view.a.q, world.pivot_b - view.a.x);
    m.pivot_v_b = transpose_times(a_to_world, world.pivot_v_b);
  }
  m.b_to_a = view.pose.rotation;
  m.turn = view.pose.turn;
  const auto i = static_cast<std::size_t>(pair.a);
  m.inverse_mass_a = p.inverse_mass[i];
  m.inverse_inertia_a = p.inverse_inertia[i];
  m.inverse_mass_b = 0;
  if (pair.b >= 0) {
    const auto j = static_cast<std::size_t>(pair.b);
    m.inverse_mass_b = p.inverse_mass[j];
    m.inverse_inertia_b = p.inverse_inertia[j];
  }
  return m;
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

template <std::size_t kBytes>
void prefetch(const void* begin) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t n = 0; n < kBytes; n += kCacheLine) __builtin_prefetch(static_cast<const char*>(begin) + n);
}

/// What a pair keeps lies in several places: asked for together and first, it arrives while the pose is worked out. A bed of 10 000
/// rocks is more than the caches hold; there this takes a twentieth off a step.
void prefetch_pair(const BodyPair& pair, const PairResult& result) {
  prefetch<1>(pair.lists.corners_a.data());  // the rest of a list follows by itself
  prefetch<1>(pair.lists.corners_b.data());
  prefetch<1>(pair.lists.edges.data());
  prefetch<4 * sizeof(FrictionSpring)>(pair.state.springs.data());
  prefetch<sizeof(PairResult)>(&result);
}

bool is_sphere_pair(const PairView& view) {
  if constexpr (!built_with::kMeshes) return view.zone == nullptr;
  return view.zone == nullptr && view.a.shape->kind == ShapeKind::sphere && view.b.shape->kind == ShapeKind::sphere;
}

/// A sphere against a mesh, be that a body or a wall.
bool is_sphere_mesh_pair(const PairView& view) {
  if constexpr (!built_with::kMeshes) return false;
  if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) return false;
  return (view.a.shape->kind == ShapeKind::sphere) != (view.b.shape->kind == ShapeKind::sphere);
}

/// First look of may_have_passed_through, without its frames: false only where it says false.
bool is_fast(const PairView& view, const PairVelocities& m, double dt) {
  const bool frame_is_a = view.radius_a > view.radius_b;
  const double small = frame_is_a ? view.radius_b : view.radius_a;
  const Vec3 velocity = (m.v_a - m.v_b) + cross(frame_is_a ? m.w_a : m.w_b, view.b.x - view.a.x);
  constexpr double kRounding = 1 - 1e-9;  // these velocities are rounded otherwise than those
  const double limit = kRounding * view.margin / dt;
  return 2 * (squared_length(velocity) + small * small * squared_length(m.w_a - m.w_b)) > limit * limit;
}

/// Rebuilds the lists of one pair. Returns false when its meshes intersect.
bool rebuild_lists(const PairView& view, const PairVelocities& m, bool triangles, bool area, double dt, MeshDistanceScratch& scratch,
                   CandidateLists& lists) {
  const double small = std::min(view.radius_a, view.radius_b);
  const double speed = length(m.v_a - m.v_b) + (length(m.w_a) + length(m.w_b)) * small;
  const double lower = std::min(kSmallestSkin * view.margin, kLargestSkin * small);
  const double skin = std::clamp(kSkinSteps * speed * dt, lower, kLargestSkin * small);
  if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) {
    if (area && view.a.shape->kind != ShapeKind::sphere)
      list_area_zone(view.a, view.b, *view.zone, view.margin, skin, view.radius_a, lists);
    else
      list_zone_pair(view.a, view.b, *view.zone, view.margin, skin, view.radius_a, lists);
    return true;
  }
  if (is_sphere_pair(view)) {
    list_sphere_pair(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, lists);
    return true;
  }
  if (is_sphere_mesh_pair(view)) {
    return list_sphere_mesh_pair(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
  }
  if (triangles || area) return list_triangle_contacts(view.a, view.b, view.margin, skin, view.radius_a, view.radius_b, scratch, lists);
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
    out.normal.push_back(side * rotate(view.a.q, outputs[j].normal));
    out.overlap.push_back(f.overlap);
    out.margin.push_back(view.margin);
    out.normal_force.push_back(outputs[j].normal_force);
    out.tangential_force.push_back(side * rotate(view.a.q, outputs[j].tangential_force));
  }
}

}  // namespace

double evaluate_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls,
                      std::span<const std::int32_t> which, double dt, double friction_dt, std::int64_t step, ForceScratch& scratch,
                      PairList& list, FrameContacts* out, const PairVisitor* look) {
  std::atomic<std::int32_t> intersecting{-1}, passing{-1};
  const bool only_looks = out != nullptr || look != nullptr;
  const PairForceFunction force_of = pair_force_function(scene.law_choice());
  const bool independent = scene.law_choice().independent;
  const bool is_area = scene.law_choice().area;
  // a barrier makes room for gaps that are otherwise too near to be followed
  const double stop_ratio = scene.source().settings.barrier > 0 ? 1 - kBarrierShare * kLeastBarrierGap : kStopOverlapRatio;
  const bool needs_radius = scene.law_choice().needs_radius;
  const double exponent = scene.normal_exponent();
  const TravelBounds& ways = list.travel();
  const auto way_of = [&ways](const IdlePair& rest) { return ways[rest.a] + (rest.b >= 0 ? ways[rest.b] : 0.0); };
  double largest_overlap = 0;
  bool too_deep = false;
  WorkShares shares(which.size(), omp_get_max_threads(), kPairsAtOnce);
#pragma omp parallel if (!only_looks) reduction(max : largest_overlap) reduction(|| : too_deep)
  {
    std::vector<ContactFeature> features;
    std::vector<ContactOutput> outputs;
    std::vector<CellShare> cells;
    AreaContact layer;
    MeshDistanceScratch& distance = *scratch.distance[static_cast<std::size_t>(omp_get_thread_num())];
    shares.take(omp_get_thread_num(), [&](std::size_t n) {
      const std::int32_t k = which[n];
      IdlePair& rest = list.idle()[static_cast<std::size_t>(k)];
      if (way_of(rest) < rest.way) return;  // its result says so already
      const PairClock clock(scratch.pair_seconds, k);
      BodyPair& pair = list.pairs()[static_cast<std::size_t>(k)];
      PairResult& result = list.results()[static_cast<std::size_t>(k)];
      prefetch_pair(pair, result);
      result.active = false;
      result.contact_count = 0;
      const PairView view = view_of(scene, p, walls, pair);
      const PairVelocities velocities = velocities_of(p, walls, pair, view, friction_dt > 0);
      double moved = 0;
      if (pair.lists.skin >= 0) moved = motion_since_listed(pair.lists, view.pose, view.radius_a, view.radius_b);
      const bool has_mesh = built_with::kMeshes && (view.zone == nullptr ? !is_sphere_pair(view) : view.zone->kind == WallZone::Kind::mesh);
      // a body behind a plane or in a cylinder is still seen
      if (has_mesh && dt > 0 && moved > pair.lists.first_slack && is_fast(view, velocities, dt) &&
          may_have_passed_through(view.a, view.b, motion_of(p, pair, view, velocities, matrix_of(view.a.q)), view.radius_a, view.radius_b,
                                  view.margin, dt, moved, pair.lists, distance)) {
        passing.store(k);
      }
      if (pair.lists.skin < 0 || moved > pair.lists.skin) {
        if (!rebuild_lists(view, velocities, independent, is_area, dt, distance, pair.lists)) {
          intersecting.store(k);
          return;
        }
        moved = 0;
      }
      if (moved < pair.lists.first_slack) {
        // nothing can be within the margin before both have gone what is left
        if (only_looks) return;
        if (pair.b >= 0 || !scene.has_driven_walls()) rest.way = way_of(rest) + (pair.lists.first_slack - moved);
        pair.state.springs.clear();
        return;
      }
      rest.way = kNeverIdle;
      const bool has_layer =
          is_area && view.a.shape->kind != ShapeKind::sphere && (view.b.shape == nullptr || view.b.shape->kind != ShapeKind::sphere);
      if (is_sphere_pair(view)) {
        sphere_pair_features(view.a, view.b, view.margin, features);
      } else if (has_layer && view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) {
        area_zone_features(view.a, view.b, *view.zone, view.margin, moved, pair.lists, features, layer);
      } else if (view.zone != nullptr && view.zone->kind != WallZone::Kind::mesh) {
        zone_pair_features(view.a, view.pose, *view.zone, view.margin, moved, pair.lists, features);
      } else if (is_sphere_mesh_pair(view)) {
        sphere_mesh_features(view.a, view.b, view.margin, moved, pair.lists, features);
      } else if (built_with::kMeshes && has_layer) {
        area_features(view.a, view.b, view.margin, moved, view.radius_a <= view.radius_b, pair.lists, features, layer);
      } else if (built_with::kMeshes && independent) {
        triangle_contact_features(view.a, view.b, view.margin, moved, pair.lists, features);
      } else if (built_with::kMeshes) {
        mesh_pair_features(view.a, view.b, view.pose, view.margin, moved, pair.lists, features);
      }
      if (features.empty()) {
        if (!only_looks) pair.state.springs.clear();
        return;
      }
      std::int32_t material_b = 0;
      if (pair.b >= 0) {
        material_b = p.material[static_cast<std::size_t>(pair.b)];
      } else {
        material_b = scene.source().walls[static_cast<std::size_t>(view.zone->wall)].material;
      }
      const PairLaw& law = scene.law(p.material[static_cast<std::size_t>(pair.a)], material_b);
      const Mat3 a_to_world = matrix_of(view.a.q);
      PairMotion relative = motion_of(p, pair, view, velocities, a_to_world);
      if (needs_radius) relative.radius = law.radius > 0 ? law.radius : contact_radius(view);
      if (has_layer) {
        relative.area = &layer;
      } else if (independent) {
        cells.clear();
        for (std::size_t j = 0; j < features.size(); ++j)
          cells.push_back({static_cast<std::int64_t>(j), static_cast<std::int32_t>(j), 1, {}});
        relative.independent = true;
        relative.cells = &cells;
      } else if (view.cells != CellSide::none) {
        find_cell_shares(view.a, view.b, view.cell_size, view.cells, features, cells);
        relative.cells = &cells;
        relative.cell_energy = energy_share(view.cells);
      }
      // Looking must not change anything: it works on a copy of the springs.
      std::vector<FrictionSpring> copy;
      if (only_looks) copy = pair.state.springs;
      const PairForce f =
          force_of(features, law, relative, dt, friction_dt, only_looks ? copy : pair.state.springs, out != nullptr ? &outputs : nullptr);
      if (look != nullptr) (*look)({pair, features, f, relative, exponent, law});
      result.active = true;
      result.contact_count = static_cast<std::int32_t>(features.size());
      // torques about B's centre: T_B = (x_B - x_A) x F - T_A
      const Vec3 branch = view.b.x - view.a.x;
      result.force_a = a_to_world * f.force;
      result.torque_a = a_to_world * f.torque;
      result.torque_b = cross(branch, result.force_a) - result.torque_a;
      result.dissipative_force_a = a_to_world * f.dissipative_force;
      result.dissipative_torque_a = a_to_world * f.dissipative_torque;
      result.dissipative_torque_b = cross(branch, result.dissipative_force_a) - result.dissipative_torque_a;
      result.elastic = f.elastic;
      result.tangential_elastic = f.tangential_elastic;
      result.overlap_ratio = view.margin > 0 ? f.largest_overlap / view.margin : 0;
      largest_overlap = std::max(largest_overlap, result.overlap_ratio);
      if (!(result.overlap_ratio < stop_ratio)) too_deep = true;  // or not a number
      if (out != nullptr && counts_here(pair, p)) append_contacts(pair, view, features, outputs, *out);
    });
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
    throw RunInvalid(
        "step {}: {} move by more than the sum of their margins in a step of {:.3g} s and could have passed through each other "
        "unseen; reduce the step",
        step, describe(list.pairs()[static_cast<std::size_t>(passing.load())].key), dt);
  }
  for (std::size_t n = 0; n < which.size() && too_deep; ++n) {
    const std::int32_t k = which[n];
    const PairResult& r = list.results()[static_cast<std::size_t>(k)];
    if (r.active && !(r.overlap_ratio < stop_ratio)) {
      throw RunInvalid("step {}: {} touch to {:.3f} of their margin (limit {}); {}", step,
                       describe(list.pairs()[static_cast<std::size_t>(k)].key), r.overlap_ratio, stop_ratio, cure);
    }
  }
  return largest_overlap;
}

void visit_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::span<const std::int32_t> which,
                 std::int64_t step, ForceScratch& scratch, PairList& list, const PairVisitor& look) {
  const std::vector<PairResult> kept = list.results();
  evaluate_pairs(scene, p, walls, which, 0, 0, step, scratch, list, nullptr, &look);
  list.results() = kept;
}

}  // namespace scree
