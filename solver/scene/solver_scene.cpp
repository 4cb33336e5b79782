#include "solver/scene/solver_scene.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solver/laws/restitution.hpp"
#include "solver/scene/contact_extent.hpp"

namespace scree {

namespace {

/// See SolverShape::turning_arm. At an edge or a corner the normal may point anywhere between those of its faces; |r x n| is
/// largest at one of these unless it passes a right angle on the way: with a normal that points inwards the whole radius counts.
double turning_arm_of(const TriangleMesh& mesh) {
  double arm = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const Vec3 doubled = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    if (!(squared_length(doubled) > 0)) continue;
    const Vec3 n = normalised(doubled);
    for (int k = 0; k < 3; ++k) {
      const Vec3& r = mesh.corner(t, k);
      arm = std::max(arm, dot(r, n) > 0 ? length(cross(r, n)) : length(r));
    }
  }
  return arm;
}

}  // namespace

SolverShape make_solver_shape(const Shape& source) {
  SolverShape shape;
  shape.kind = source.kind;
  shape.rounding = source.sphere_radius;
  shape.cell_size = source.cell_size;
  shape.mesh = source.mesh;  // a copy holds what it needs and no more
  if (source.kind != ShapeKind::surface) {
    shape.volume = source.mass.volume;
    shape.inertia = source.mass.principal_moments;
    shape.body_from_principal = source.mass.body_from_principal;
    const Quat principal_from_body = conjugate(shape.body_from_principal);
    if (!(shape.body_from_principal == Quat{})) {
      for (Vec3& p : shape.mesh.vertices) p = rotate(principal_from_body, p);
    }
    // Moments equal to within the rounding of the mass integrals count as equal.
    constexpr double kIsotropicTolerance = 1e-12;
    const double low = std::min({shape.inertia.x, shape.inertia.y, shape.inertia.z});
    const double high = std::max({shape.inertia.x, shape.inertia.y, shape.inertia.z});
    Eigen::Vector3d inverse(1 / shape.inertia.x, 1 / shape.inertia.y, 1 / shape.inertia.z);
    for (const Vec3& r : shape.mesh.vertices) {
      Eigen::Matrix3d lever;
      lever << 0, -r.z, r.y, r.z, 0, -r.x, -r.y, r.x, 0;
      const Eigen::Matrix3d mobility = lever.transpose() * inverse.asDiagonal() * lever;
      const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mobility, Eigen::EigenvaluesOnly).eigenvalues()(2);
      shape.rotational_mobility = std::max(shape.rotational_mobility, largest);
    }
    // A ball's normal passes its centre: only friction, with its softer spring, turns it.
    shape.rotational_mobility += kTangentialStiffnessRatio * shape.rounding * shape.rounding * inverse(0);
    shape.turning_arm = turning_arm_of(shape.mesh);
    shape.isotropic = high - low <= kIsotropicTolerance * high;
    shape.equivalent_radius = 0.5 * source.equivalent_diameter();
  }
  shape.features = find_features(shape.mesh);
  // the other two vertices of every triangle at a corner, each once
  std::vector<std::vector<std::int32_t>> spokes(shape.features.corners.size());
  for (const Triangle& t : shape.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t c = shape.features.corner_of[static_cast<std::size_t>(t[k])];
      if (c < 0) continue;
      for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) spokes[static_cast<std::size_t>(c)].push_back(t[other]);
    }
  }
  shape.spoke_start = {0};
  for (auto& of_corner : spokes) {
    std::sort(of_corner.begin(), of_corner.end());
    of_corner.erase(std::unique(of_corner.begin(), of_corner.end()), of_corner.end());
    shape.spoke_end.insert(shape.spoke_end.end(), of_corner.begin(), of_corner.end());
    shape.spoke_start.push_back(static_cast<std::int32_t>(shape.spoke_end.size()));
  }
  shape.spoke_start.shrink_to_fit();
  shape.spoke_end.shrink_to_fit();
  shape.bvh = build_bvh(shape.mesh);
  shape.radius = bounding_radius(shape.mesh) + shape.rounding;
  return shape;
}

std::size_t SolverShape::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(mesh.vertices) + bytes(mesh.triangles) + bvh.memory() + features.memory() + bytes(spoke_start) + bytes(spoke_end);
}

namespace {

/// Finds a word of the case language in the list of laws.
LawChoice choose_law(ContactLaw law, Gathering gathering) {
  LawChoice choice;
  choice.gathering = gathering;
  std::string known;
  int index = 0;
  bool found = false;
  const auto look = [&]<class Entry>(const Entry& entry) {
    using InLayer = typename Entry::Normal::InLayer;
    const bool in_layer = gathering == Gathering::area;
    if (!in_layer || !std::is_void_v<InLayer>) {
      if (law == entry.law) {
        choice.law = index;
        choice.needs_radius = entry.needs_radius || in_layer;
        choice.exponent = Entry::Normal::kExponent;
        if constexpr (!std::is_void_v<InLayer>) choice.exponent = in_layer ? InLayer::kExponent : choice.exponent;
        found = true;
      }
      known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", word_of(entry.law));
    }
    ++index;
  };
  std::apply([&](const auto&... entry) { (look(entry), ...); }, kLaws);
  if (!found) {
    throw UsageError("contact.law = \"{}\" is not known{}; use one of {}", word_of(law),
                     gathering == Gathering::area ? " with contact.gather = \"area\"" : "", known);
  }
  return choice;
}

}  // namespace

SolverScene::SolverScene(const Scene& scene) : scene_(&scene), material_count_(scene.materials.size()) {
  const Settings& settings = scene.settings;
  const auto& periodic = settings.domain.periodic;
  if (!settings.domain.bounded && (periodic[0] || periodic[1] || periodic[2])) {
    throw UsageError("domain.periodic: a periodic axis needs domain.min and domain.max");
  }
  periodicity_ = Periodicity(settings.domain.lower, settings.domain.upper, periodic);
  if (!(settings.duration >= 0)) throw InputError("time.duration = {:g} s; expected >= 0", settings.duration);

  for (const Shape& shape : scene.shapes) shapes_.push_back(make_solver_shape(shape));
  margin_ = settings.margin;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (shape(scene.bodies.shape[b]).kind == ShapeKind::surface) {
      throw InputError("body {}: shape '{}' is a surface without mass; import it without --surface", scene.bodies.id[b],
                       scene.shapes[static_cast<std::size_t>(scene.bodies.shape[b])].name);
    }
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const double radius = scene.bodies.scale[b] * shape(scene.bodies.shape[b]).radius;
    largest_radius_ = std::max(largest_radius_, radius);
    check_period(periodicity_, radius, margin_, scene.bodies.id[b]);
  }
  bool has_meshes = false;
  for (std::int32_t s : scene.bodies.shape) has_meshes = has_meshes || shape(s).kind != ShapeKind::sphere;
  for (const Wall& wall : scene.walls) has_meshes = has_meshes || wall.kind == WallKind::mesh;
  if (has_meshes && !(margin_ > 0)) {
    throw UsageError("contact.margin = {:g} m; meshes need a margin > 0 (typically 1 to 3 % of the body's size)", margin_);
  }

  law_choice_ = choose_law(settings.law, settings.gather);
  if (law_choice_.gathering == Gathering::area) {
    if (!(margin_ > 0))
      throw UsageError("contact.margin = 0: with contact.gather = \"area\" the margins are the elastic layer; give them a thickness");
    for (SolverShape& shape : shapes_) shape.contact_area = largest_contact_area(shape, 2 * margin_);
  }
  if (law_choice_.gathering == Gathering::pairs) {
    std::vector<double> smallest(shapes_.size(), 0.0);  // scale of each shape
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      double& scale = smallest[static_cast<std::size_t>(scene.bodies.shape[b])];
      scale = scale > 0 ? std::min(scale, scene.bodies.scale[b]) : scene.bodies.scale[b];
    }
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      if (smallest[s] > 0 && shapes_[s].kind == ShapeKind::solid) {
        springs_per_pair_ = std::max(springs_per_pair_, 2 * triangles_on_plane(shapes_[s].mesh, 2 * margin_ / smallest[s]));
      }
    }
  }
  laws_.resize(material_count_ * material_count_);
  for (const MaterialPair& pair : scene.pairs) {
    const PairLaw law = make_pair_law(pair);
    law_choice_.friction = law_choice_.friction || law.friction > 0;
    law_choice_.rolling = law_choice_.rolling || law.rolling_friction > 0 || law.torsional_friction > 0;
    has_damping_ = has_damping_ || law.damping_ratio > 0 || law.damping_slope > 0;
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    laws_[a * material_count_ + b] = law;
    laws_[b * material_count_ + a] = law;
  }
  if (settings.barrier > 0) {
    if (settings.gather != Gathering::potential)
      throw UsageError("contact.barrier = {:g}: goes with contact.gather = \"potential\" only", settings.barrier);
    if (!(margin_ > 0)) throw UsageError("contact.barrier = {:g}: needs margins; give contact.margin", settings.barrier);
    for (PairLaw& law : laws_) {
      law.margin = 2 * margin_;
      law.barrier = settings.barrier * law.step_stiffness;
      law.step_stiffness += Barrier(law).curvature(kBarrierStepGap * kBarrierShare * law.margin);
    }
  }
  law_choice_.needs_radius = law_choice_.needs_radius || law_choice_.rolling;
  zones_ = wall_zones(scene.walls, periodicity_, dropped_zones_);
  seam_gaps_ = check_meshes_at_seams(scene.walls, scene.shapes, settings.domain, largest_radius_ + 2 * margin_, settings.duration);
  for (const Wall& wall : scene.walls) has_driven_walls_ = has_driven_walls_ || wall.motion.is_prescribed();
}

PairLaw SolverScene::make_pair_law(const MaterialPair& pair) const {
  const Settings& settings = scene_->settings;
  const Material& a = scene_->materials[static_cast<std::size_t>(pair.a)];
  const Material& b = scene_->materials[static_cast<std::size_t>(pair.b)];
  PairLaw law;
  law.stiffness = pair.stiffness;
  law.friction = pair.friction;
  law.friction_sliding = pair.friction_sliding < 0 ? pair.friction : pair.friction_sliding;
  if (pair.tangential_ratio >= 0) law.tangential_ratio = pair.tangential_ratio;
  law.tangential_damping = pair.tangential_damping;
  law.rolling_friction = pair.rolling_friction;
  law.torsional_friction = pair.torsional_friction;
  law.rolling_spring = pair.rolling_model != RollingModel::constant;
  law.radius = pair.contact_radius;
  law.step_stiffness = pair.stiffness;
  law.step_damping = damping_ratio_of_restitution(pair.restitution);
  if (law_choice_.gathering == Gathering::area) {
    if (!(pair.layer_modulus > 0)) {
      throw UsageError("pairs: '{}' and '{}': layer_modulus is missing; contact.gather = \"area\" needs it", a.name, b.name);
    }
    law.stiffness = law.step_stiffness = pair.layer_modulus / (2 * margin_);
  }
  if (settings.law == ContactLaw::hunt_crossley) {
    if (pair.restitution < 1) {
      if (!(pair.restitution_speed > 0)) {
        throw UsageError(
            "pairs: '{}' and '{}': restitution_speed is missing; with Hunt-Crossley damping restitution depends on the "
            "speed of the impact, so give the speed at which it is {:g}",
            a.name, b.name, pair.restitution);
      }
      law.damping_slope = hunt_crossley_number_of_restitution(pair.restitution) / pair.restitution_speed;
    }
    return law;
  }
  law.damping_ratio = law.step_damping;
  if (settings.law != ContactLaw::hertz_mindlin) return law;
  if (!(a.young > 0 && b.young > 0)) {
    throw UsageError("materials: '{}' and '{}' need young (Young's modulus) for contact.law = \"hertz-mindlin\"", a.name, b.name);
  }
  const double modulus = effective_modulus(a, b);
  law.stiffness = 4.0 / 3 * modulus;
  if (pair.tangential_ratio < 0) law.tangential_ratio = 6 * effective_shear_modulus(a, b) / modulus;
  // The stiffest tangent 2 E* sqrt(R* d), at the overlap of the fastest impact of the heaviest bodies.
  double mass = 0, radius = 0, speed = settings.impact_speed;
  const BodyTable& bodies = scene_->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies.material[i] != pair.a && bodies.material[i] != pair.b) continue;
    radius = std::max(radius, bodies.scale[i] * shape(bodies.shape[i]).equivalent_radius);
    if (bodies.fixed[i] == 0) mass = std::max(mass, scene_->mass(i));
    if (settings.impact_speed == 0) speed = std::max(speed, 2 * length(bodies.velocity[i]));
  }
  if (pair.contact_radius > 0) radius = pair.contact_radius;
  double overlap = hertz_impact_overlap(modulus, radius, mass, speed);
  if (margin_ > 0) overlap = speed > 0 ? std::min(overlap, 2 * margin_) : 2 * margin_;
  if (!(overlap > 0) && !(settings.step > 0) && mass > 0) {
    throw UsageError(
        "contact.impact_speed is missing: the step follows from the stiffness of a Hertz contact, which grows with its overlap; "
        "give the speed of the fastest impact, or time.step");
  }
  law.step_stiffness = 2 * modulus * std::sqrt(radius * overlap);
  return law;
}

}  // namespace scree
