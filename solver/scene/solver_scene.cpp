#include "solver/scene/solver_scene.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/storage/plasticity.hpp"
#include "solver/scene/hollow_walls.hpp"

namespace scree {

namespace {

/// Calls action.operator()<Entry, Normal>() with the line of a scene's law, and what its normal law is for the way of gathering.
/// Throws UsageError where the two do not go together.
template <class Action>
void with_law(const Settings& settings, Action&& action) {
  const bool in_layer = settings.gather == Gathering::area;
  bool known = false;
  std::string others;
  const auto look = [&]<class Entry>(const Entry&) {
    using InLayer = typename Entry::Normal::InLayer;
    if (in_layer && std::is_void_v<InLayer>) return;
    others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", word_of(Entry::kLaw));
    if (Entry::kLaw != settings.law) return;
    known = true;
    if (!in_layer) action.template operator()<Entry, typename Entry::Normal>();
    if constexpr (!std::is_void_v<InLayer>) {
      if (in_layer) action.template operator()<Entry, InLayer>();
    }
  };
  std::apply([&](const auto&... entry) { (look(entry), ...); }, kLaws);
  if (known) return;
  throw UsageError("contact.law = \"{}\" is not known{}; use one of {}", word_of(settings.law),
                   in_layer ? " with contact.gather = \"area\"" : "", others);
}

/// How far a wall has a point from its axis [m]; 1 of one that goes along a direction.
double lever_of(const Scene& scene, const Wall& wall, const Guide& guide) {
  if (!guide.turns) return 1;
  double lever = 0;
  const auto include = [&](const Vec3& x, double around) { lever = std::max(lever, length(cross(guide.axis, x - guide.centre)) + around); };
  switch (wall.kind) {
    case WallKind::mesh:
      for (const Vec3& v : scene.shapes[static_cast<std::size_t>(wall.shape)].mesh.vertices)
        include(wall.position + wall.scale * rotate(wall.orientation, v), 0);
      break;
    case WallKind::box_inside:
      for (int corner = 0; corner < 8; ++corner)
        include(
            {(corner & 1 ? wall.upper : wall.lower).x, (corner & 2 ? wall.upper : wall.lower).y, (corner & 4 ? wall.upper : wall.lower).z},
            0);
      break;
    case WallKind::cylinder_inside:
      include(wall.axis_start, wall.radius);
      include(wall.axis_end, wall.radius);
      break;
    case WallKind::sphere_inside:
      include(wall.point, wall.radius);
      break;
    case WallKind::plane:
      throw InputError("wall '{}': a plane that turns in answer to force has no end and so any lever; use a plate or another mesh",
                       wall.name);
  }
  return lever;
}

double step_curvature_of_barrier(const PairLaw& law) { return Barrier(law).curvature(kBarrierStepGap * kBarrierShare * law.margin); }

}  // namespace

SolverScene::SolverScene(const Scene& scene)
    : scene_(&scene),
      material_count_(scene.materials.size()),
      margin_(scene.settings.surface == TouchAt::outside ? scene.settings.margin : 0),
      extremes_(scene.materials.size(), scene.shapes.size()) {
  const Settings& settings = scene.settings;
  const auto& periodic = settings.domain.periodic;
  if (!settings.domain.bounded && (periodic[0] || periodic[1] || periodic[2])) {
    throw UsageError("domain.periodic: a periodic axis needs domain.min and domain.max");
  }
  periodicity_ = periodicity_of(settings.domain);
  if (!(settings.duration >= 0)) throw InputError("time.duration = {:g} s; expected >= 0", settings.duration);

  for (const Shape& shape : scene.shapes) shapes_.push_back(make_solver_shape(shape, settings));
  const BodyTable& bodies = scene.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    check_solid(bodies.id[b], bodies.shape[b]);
    include_body(bodies.shape[b], bodies.material[b], bodies.scale[b], bodies.fixed[b] != 0, length(bodies.velocity[b]), extremes_);
  }
  include_inlets();
  for (const Wall& wall : scene.walls)
    if (wall.kind == WallKind::mesh) check_margin(ShapeKind::surface);
  find_max_overlaps();
  contact_extent_ = make_contact_extent(scene, shapes_);
  prepare_laws();
  prepare_barrier();
  check_on_overlap();
  prepare_weights();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto who = [&] { return fmt::format("body {}", bodies.id[b]); };
    check_fits(bodies.shape[b], bodies.scale[b], who);
    check_is_ball_where_necks_are(scene, scene.shapes[static_cast<std::size_t>(bodies.shape[b])], bodies.material[b], who);
  }
  for (const Inlet& inlet : scene.inlets) {
    for (const Inlet::Share& share : inlet.shares) {
      check_is_ball_where_necks_are(scene, scene.shapes[static_cast<std::size_t>(share.shape)], inlet.material,
                                    [&] { return fmt::format("a body of the inlet '{}'", inlet.name); });
      const auto [smallest, largest] = scales_of(inlet.size, scene.shapes[static_cast<std::size_t>(share.shape)]);
      for (const double scale : {smallest, largest})
        check_fits(share.shape, scale, [&] { return fmt::format("a body of the inlet '{}'", inlet.name); });
    }
  }
  zones_ = wall_zones(scene.walls, periodicity_, dropped_zones_);
  seam_gaps_ =
      check_meshes_at_seams(scene.walls, scene.shapes, settings.domain, extremes_.bounding_radius + 2 * contact_range(), settings.duration);
  for (const Outlet& outlet : scene.outlets)
    outlets_.push_back(region_of(outlet.region, scene.shapes, fmt::format("outlet '{}'", outlet.name)));
  for (const Wall& wall : scene.walls) {
    has_driven_walls_ = has_driven_walls_ || wall.motion.is_prescribed();
    drives_.push_back(wall.motion.drive());
    levers_.push_back(drives_.back() ? lever_of(scene, wall, drives_.back()->guide) : 1.0);
    has_moving_surfaces_ = has_moving_surfaces_ || wall.surface.moves();
    first_mapped_.push_back(wall.load_map ? mapped_triangles_ : -1);
    if (wall.load_map) mapped_triangles_ += shape(wall.shape).mesh.triangle_count();
    first_worn_.push_back(wall.wear > 0 ? worn_vertices_ : -1);
    if (wall.wear > 0) worn_vertices_ += shape(wall.shape).mesh.vertex_count();
    wall_shapes_.push_back(wall.kind == WallKind::mesh ? &shape(wall.shape) : nullptr);
  }
  worn_walls_.resize(scene.walls.size());
  if (std::none_of(drives_.begin(), drives_.end(), [](const auto& drive) { return drive.has_value(); })) drives_.clear();
  lane_laws_ = make_lane_laws(*this);
  ball_laws_ = make_ball_laws(*this);
}

const BodyForce* SolverScene::given_force(std::int64_t id) const {
  const std::vector<BodyForce>& forces = scene_->forces;
  const auto found = std::lower_bound(forces.begin(), forces.end(), id, [](const BodyForce& f, std::int64_t key) { return f.id < key; });
  return found != forces.end() && found->id == id ? &*found : nullptr;
}

double SolverScene::wall_mobility(std::size_t wall, const Vec3& at) const {
  const Drive* drive = this->drive(wall);
  if (drive == nullptr || !(drive->inertia > 0)) return 0;
  return (drive->guide.turns ? squared_length(cross(drive->guide.axis, at - drive->guide.centre)) : 1.0) / drive->inertia;
}

/// Bodies to come count from the start on: the step is derived from all that there will be.
void SolverScene::include_inlets() {
  for (const Inlet& inlet : scene_->inlets) {
    for (const Inlet::Share& share : inlet.shares) {
      const Shape& of = scene_->shapes[static_cast<std::size_t>(share.shape)];
      if (of.kind == ShapeKind::surface) throw InputError("inlet '{}': shape '{}' is a surface without mass", inlet.name, of.name);
      check_margin(of.kind);
      const auto [smallest, largest] = scales_of(inlet.size, of);
      for (const double scale : {smallest, largest})
        include_body(share.shape, inlet.material, scale, false, length(inlet.velocity), extremes_);
    }
  }
}

void SolverScene::check_solid(std::int64_t id, std::int32_t of) const {
  if (shape(of).kind == ShapeKind::surface) {
    throw InputError("body {}: shape '{}' is a surface without mass; import it without --surface", id,
                     scene_->shapes[static_cast<std::size_t>(of)].name);
  }
  check_margin(shape(of).kind);
}

void SolverScene::check_body(std::int64_t id, std::int32_t of, double scale) const {
  check_solid(id, of);
  check_fits(of, scale, [&] { return fmt::format("body {}", id); });
}

void SolverScene::check_fits(std::int32_t of, double scale, const std::function<std::string()>& who) const {
  check_period(periodicity_, scale * shape(of).radius, contact_range(), who);
  if (law_choice_.attraction) check_thickness(scene_->shapes[static_cast<std::size_t>(of)], scale, who, 2 * contact_range());
}

void SolverScene::check_seams(double radius) const {
  const Settings& settings = scene_->settings;
  for (const std::string& gap :
       check_meshes_at_seams(scene_->walls, scene_->shapes, settings.domain, radius + 2 * contact_range(), settings.duration))
    warn_once("scree-solver", gap);
}

void SolverScene::include_body(std::int32_t of, std::int32_t material, double scale, bool fixed, double speed,
                               BodyExtremes& extremes) const {
  const auto s = static_cast<std::size_t>(of), m = static_cast<std::size_t>(material);
  const double mass = scene_->mass(of, material, scale);
  extremes.bounding_radius = std::max(extremes.bounding_radius, scale * shapes_[s].radius);
  extremes.radius[m] = std::max(extremes.radius[m], scale * shapes_[s].equivalent_radius);
  extremes.speed[m] = std::max(extremes.speed[m], speed);
  if (!fixed) extremes.mass[m] = std::max(extremes.mass[m], mass);
  if (!fixed) extremes.least_mass[m] = std::min(extremes.least_mass[m], mass);
  extremes.smallest_scale[s] = std::min(extremes.smallest_scale[s], scale);
  if (const double margin = scale * shapes_[s].margin; margin > 0) {
    extremes.least_margin = std::min(extremes.least_margin, margin);
    extremes.largest_margin = std::max(extremes.largest_margin, margin);
  }
  if (shapes_[s].kind == ShapeKind::sphere) extremes.least_ball = std::min(extremes.least_ball, scale * shapes_[s].rounding);
}

void SolverScene::prepare_laws() {
  laws_by_max_overlap_ = margins_by_size() && (scene_->settings.gather == Gathering::area || scene_->settings.barrier > 0);

  law_choice_.law = scene_->settings.law;
  law_choice_.gathering = scene_->settings.gather;
  bool shares_cells = true;
  with_law(scene_->settings, [&]<class Entry, class Normal>() {
    law_choice_.exponent = least_tangent_over_secant<Normal>();
    law_choice_.lag_corrected = Entry::Damp::kLagCorrected;
    law_choice_.needs_radius = Normal::kNeedsRadius;
    shares_cells = PowerLaw<Normal> && !PullingLaw<Normal>;
    law_choice_.attraction = std::any_of(scene_->pairs.begin(), scene_->pairs.end(), attracts);
    law_choice_.yields = std::any_of(scene_->pairs.begin(), scene_->pairs.end(), yields);
    if (law_choice_.yields && !(PowerLaw<Normal> && !PullingLaw<Normal>))
      throw UsageError("pairs: contact.law = \"{}\" has no force that goes with one power of the overlap, which plasticity needs",
                       word_of(Entry::kLaw));
    if (law_choice_.yields && law_choice_.attraction)
      throw UsageError(
          "pairs: some materials have a plasticity, others pull_off, adhesion or surface_tension; in one scene either contacts are plastic "
          "or "
          "bodies attract each other (adhesive_ratio is the attraction of contacts that yield)");
    if (law_choice_.attraction && PullingLaw<Normal>)
      throw UsageError("pairs: contact.law = \"{}\" attracts by itself and does not go with pull_off, adhesion or surface_tension",
                       word_of(Entry::kLaw));
  });
  shares_cells = shares_cells && !law_choice_.attraction && !law_choice_.yields;
  laws_.resize(material_count_ * material_count_);
  for (const MaterialPair& pair : scene_->pairs) {
    const PairLaw law = make_pair_law(pair, extremes_);
    law_choice_.friction = law_choice_.friction || law.friction > 0;
    law_choice_.needs_radius = law_choice_.needs_radius || law.pull_off_per_radius > 0 || law.size_stiffness > 0;
    if (law.size_stiffness > 0 && (attracts(pair) || scene_->settings.barrier > 0))
      throw UsageError("pairs: a modulus does not go with attraction or a barrier; give a stiffness");
    law_choice_.necks = law_choice_.necks || law.neck_adhesion > 0;
    law_choice_.remembers = law_choice_.remembers || remembers(pair);
    law_choice_.rolling = law_choice_.rolling || law.rolling_friction > 0 || law.torsional_friction > 0;
    has_damping_ = has_damping_ || law.damping_ratio > 0 || law.damping_slope > 0;
    reach_ = std::max(reach_, law.reach);
    if (attracts(pair)) {
      shortest_range_ = shortest_range_ > 0 ? std::min(shortest_range_, law.reach) : law.reach;
      fastest_sticking_ = std::max(fastest_sticking_, sticking_speed(pair) / law.reach);
    }
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    laws_[a * material_count_ + b] = law;
    laws_[b * material_count_ + a] = law;
  }
  law_choice_.needs_radius = law_choice_.needs_radius || law_choice_.rolling;
  if (law_choice_.necks) check_necks();
  weights_follow_overlap_ = !(scene_->settings.barrier > 0) && ((law_choice_.attraction && !law_choice_.necks) || !(reach_ > 0));
  if (shares_cells) return;
  bool has_cells = false;
  for (const Wall& wall : scene_->walls) has_cells = has_cells || wall.cell_size > 0;
  for (const SolverShape& s : shapes_) has_cells = has_cells || s.cell_size > 0;
  if (has_cells && law_choice_.attraction)
    throw UsageError("cell_size: does not go with attraction (pull_off, adhesion or surface_tension of a pair)");
  if (has_cells && law_choice_.yields) throw UsageError("cell_size: does not go with the plasticity of a pair");
  if (has_cells) {
    throw UsageError("cell_size: contact.law = \"{}\" has no force that goes with one power of the overlap, which cells need",
                     word_of(law_choice_.law));
  }
}

const double* SolverScene::weights(std::int32_t of, double scale) const {
  if (!weights_ || shape(of).kind != ShapeKind::solid) return nullptr;
  return weights_->of_body(shape(of), of, scale);
}

const double* SolverScene::pull_weights(std::int32_t of, double scale) const {
  if (!pull_weights_ || shape(of).kind != ShapeKind::solid) return nullptr;
  return pull_weights_->of_body(shape(of), of, scale);
}

void SolverScene::prepare_weights() {
  const Settings& settings = scene_->settings;
  wall_weights_.assign(scene_->walls.size(), nullptr);
  wall_pull_weights_ = wall_weights_;
  if (settings.gather != Gathering::potential || settings.weights == VertexWeights::unit) return;
  if (margins_by_size() ? extremes_.largest_margin > 0 : margin_ > 0)
    weights_ = std::make_shared<DensityWeights>(wall_table_depth(),
                                                margins_by_size() ? DensityWeights::Depth::of_shape : DensityWeights::Depth::one);
  if (widest_range() > 0 && !law_choice_.necks)
    pull_weights_ = std::make_shared<DensityWeights>(pull_table_depth(), DensityWeights::Depth::one);
  const double radius = wall_weight_radius();
  for (std::size_t w = 0; w < scene_->walls.size(); ++w) {
    const Wall& wall = scene_->walls[w];
    if (wall.kind != WallKind::mesh) continue;
    if (weights_) wall_weights_[w] = weights_->of_wall(shape(wall.shape), wall.shape, wall.scale, radius);
    if (pull_weights_) wall_pull_weights_[w] = pull_weights_->of_wall(shape(wall.shape), wall.shape, wall.scale, radius);
  }
}

/// Of the largest body: a wall's surface has no radius of its own.
double SolverScene::wall_weight_radius() const {
  double radius = 0;
  for (const double r : extremes_.radius) radius = std::max(radius, r);
  if (!(radius > 0))
    for (const SolverShape& s : shapes_) radius = std::max(radius, s.equivalent_radius);
  return radius;
}

void SolverScene::prepare_barrier() {
  const Settings& settings = scene_->settings;
  if (!(settings.barrier > 0)) return;
  if (settings.gather != Gathering::potential)
    throw UsageError("contact.barrier = {:g}: goes with contact.gather = \"potential\" only", settings.barrier);
  if (!(largest_max_overlap_ > 0)) throw UsageError("contact.barrier = {:g}: needs margins; give contact.margin", settings.barrier);
  for (PairLaw& law : laws_) {
    law.margin = largest_max_overlap_;
    law.barrier = settings.barrier * law.step_stiffness;
    law.step_stiffness += step_curvature_of_barrier(law);
  }
}

double SolverScene::step_stiffness(const MaterialPair& pair, const BodyExtremes& extremes) const {
  const PairLaw& as_made = law(pair.a, pair.b);
  double stiffness = make_pair_law(pair, extremes).step_stiffness;
  if (as_made.barrier > 0) stiffness += step_curvature_of_barrier(as_made);
  if (!attracts(pair)) return stiffness;
  const Material &a = scene_->materials[static_cast<std::size_t>(pair.a)], &b = scene_->materials[static_cast<std::size_t>(pair.b)];
  const LargestImpact impact = largest_impact(pair, extremes);
  if (pull_kind(pair) == PullKind::neck)
    return impact.radius > 0 ? std::max(stiffness, neck_stiffness(pair, a, b, impact.radius, impact.mass, impact.speed)) : stiffness;
  return std::max(stiffness, steepest_pull(scene_->settings, pair, a, b, impact.radius));
}

PairLaw SolverScene::make_pair_law(const MaterialPair& pair, const BodyExtremes& extremes) const {
  PairLaw law;
  law.friction = pair.friction;
  law.friction_sliding = pair.friction_sliding < 0 ? pair.friction : pair.friction_sliding;
  if (pair.tangential_ratio >= 0) law.tangential_ratio = pair.tangential_ratio;
  law.tangential_damping = pair.tangential_damping;
  law.rolling_friction = pair.rolling_friction;
  law.torsional_friction = pair.torsional_friction;
  law.rolling_spring = pair.rolling_model != RollingModel::constant;
  law.radius = pair.contact_radius;
  law.step_damping = damping_ratio_of_restitution(pair.restitution);
  const LawInput input{pair,
                       scene_->materials[static_cast<std::size_t>(pair.a)],
                       scene_->materials[static_cast<std::size_t>(pair.b)],
                       margins_by_size() && extremes.least_ball < BodyExtremes::kNone ? 0 : largest_max_overlap_,
                       smallest_max_overlap_,
                       !(scene_->settings.step > 0) && !is_frozen(),
                       continues(),
                       [&] { return largest_impact(pair, extremes); }};
  with_law(scene_->settings, [&]<class Entry, class Normal>() {
    Normal::prepare(input, law);
    Entry::Damp::prepare(input, law);
  });
  if (attracts(pair)) add_attraction(pair, extremes, law);
  if (const AttractionFault fault = plasticity_fault(scene_->settings, pair); fault.key[0] != 0)
    throw UsageError("pairs: '{}' and '{}': {} {}", input.a.name, input.b.name, fault.key, fault.text);
  if (yields(pair)) {
    for_law(scene_->settings.law, [&]<class Entry>() {
      if constexpr (PowerLaw<typename Entry::Normal>) prepare_yielding(pair.plasticity, pair.adhesive_ratio, Entry::Normal::kExponent, law);
    });
  }
  return law;
}

/// The fastest impact of the heaviest bodies.
LargestImpact SolverScene::largest_impact(const MaterialPair& pair, const BodyExtremes& extremes) const {
  const auto either = [&](const std::vector<double>& of_material) {
    return std::max(of_material[static_cast<std::size_t>(pair.a)], of_material[static_cast<std::size_t>(pair.b)]);
  };
  const double given = scene_->settings.impact_speed;
  return {pair.contact_radius > 0 ? pair.contact_radius : hollow_factor(*scene_, pair, extremes) * either(extremes.radius),
          either(extremes.mass), given == 0 ? 2 * either(extremes.speed) : given};
}

}  // namespace scree
