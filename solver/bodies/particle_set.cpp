#include "solver/bodies/particle_set.hpp"

namespace scree {

namespace {

/// Applies one action to every column, so that no function forgets one.
template <class Set, class Action>
void for_each_column(Set& p, Action&& action) {
#define SCREE_COLUMN_STATE(type, name, dataset, unit, uses, what) action(p.name);
#define SCREE_COLUMN_DERIVED(type, name, what) action(p.name);
  SCREE_BODY_STATE(SCREE_COLUMN_STATE)
  SCREE_BODY_DERIVED(SCREE_COLUMN_DERIVED)
#undef SCREE_COLUMN_STATE
#undef SCREE_COLUMN_DERIVED
}

}  // namespace

std::size_t ParticleSet::row_bytes() const {
  std::size_t bytes = 0;
  for_each_column(*this, [&bytes](const auto& column) { bytes += sizeof(column[0]); });
  return bytes;
}

void ParticleSet::resize(std::size_t count) {
  for_each_column(*this, [count](auto& column) { column.resize(count); });
}

void ParticleSet::copy_row(std::size_t from, std::size_t to) {
  for_each_column(*this, [from, to](auto& column) { column[to] = column[from]; });
}

ParticleRecord record_of(const ParticleSet& p, std::size_t i) {
  ParticleRecord r{};
  for_each_body_column([&](const auto& c) { r.*c.field = (p.*c.column)[i]; });
  return r;
}

double body_mass(const SolverScene& scene, std::int32_t shape, std::int32_t material, double scale) {
  return scene.source().materials[static_cast<std::size_t>(material)].density * (scale * scale * scale) * scene.shape(shape).volume;
}

void append_record(ParticleSet& p, const ParticleRecord& r, const SolverScene& scene) {
  const std::size_t i = p.size();
  p.resize(i + 1);
  for_each_body_column([&](const auto& c) { (p.*c.column)[i] = r.*c.field; });
  const SolverShape& shape = scene.shape(r.shape);
  const double density = scene.source().materials[static_cast<std::size_t>(r.material)].density;
  const double s3 = r.scale * r.scale * r.scale;
  p.radius[i] = r.scale * shape.radius;
  p.ball_radius[i] = shape.kind == ShapeKind::sphere && !(shape.cell_size > 0) && !(shape.margin > 0) ? r.scale * shape.rounding : 0.0;
  p.equivalent_radius[i] = r.scale * shape.equivalent_radius;
  p.mass[i] = body_mass(scene, r.shape, r.material, r.scale);
  p.inertia[i] = (density * s3 * r.scale * r.scale) * shape.inertia;
  p.isotropic[i] = shape.isotropic ? 1 : 0;
  p.inverse_mass[i] = r.fixed ? 0.0 : 1 / p.mass[i];
  p.inverse_inertia[i] = r.fixed || r.lock_rotation ? Vec3{} : Vec3{1 / p.inertia[i].x, 1 / p.inertia[i].y, 1 / p.inertia[i].z};
  p.weights[i] = scene.weights(r.shape, r.scale);
  p.pull_weights[i] = scene.pull_weights(r.shape, r.scale);
  p.dissipative_force[i] = {};
  p.dissipative_torque[i] = {};
  p.x_listed[i] = r.x;
}

void wrap_positions(ParticleSet& p) {
  for_each_awake_row(p, [&](std::size_t i) { p.x_listed[i] += p.cell.periodicity().wrap(p.x[i], p.image[i]); });
}

ParticleRecord make_record(const SolverScene& scene, const BodyAtStart& body) {
  ParticleRecord r{};
  r.id = body.id;
  r.shape = body.shape;
  r.material = body.material;
  r.fixed = body.fixed ? 1 : 0;
  r.lock_rotation = body.lock_rotation ? 1 : 0;
  r.scale = body.scale;
  r.x = body.position;
  const SolverShape& shape = scene.shape(r.shape);
  r.q = normalised(body.orientation * shape.body_from_principal);
  r.q_remainder = {0, 0, 0, 0};
  if (!r.fixed) {
    r.v = body.velocity;
    if (!r.lock_rotation) {
      r.w = body.angular_velocity;
      const double density = scene.source().materials[static_cast<std::size_t>(r.material)].density;
      const double s5 = std::pow(r.scale, 5);
      const Vec3 w_body = rotate_inverse(r.q, r.w);
      const Vec3 inertia = (density * s5) * shape.inertia;
      r.L = rotate(r.q, Vec3{inertia.x * w_body.x, inertia.y * w_body.y, inertia.z * w_body.z});
    }
  }
  r.work = 1;
  r.temperature = body.temperature;
  scene.periodicity().wrap(r.x, r.image);
  return r;
}

ParticleRecord initial_record(const SolverScene& scene, std::size_t body) {
  const BodyTable& b = scene.source().bodies;
  return make_record(
      scene, {b.id[body], b.shape[body], b.material[body], b.fixed[body] != 0, b.lock_rotation[body] != 0, b.scale[body], b.position[body],
              b.orientation[body], b.velocity[body], b.angular_velocity[body], scene.source().settings.heat ? b.temperature[body] : 0});
}

}  // namespace scree
