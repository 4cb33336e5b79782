#include "solver/engine/body_fields.hpp"

namespace scree {

namespace {

/// Columns of the bodies that are read as they lie.
const double* as_numbers(const std::vector<double>& column) { return column.data(); }
const double* as_numbers(const std::vector<Vec3>& column) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return reinterpret_cast<const double*>(column.data());
}
const double* as_numbers(const std::vector<Quat>& column) {
  static_assert(sizeof(Quat) == 4 * sizeof(double));
  return reinterpret_cast<const double*>(column.data());
}

/// A field of no bodies has a place too.
template <class Value>
const Value* shown(const Value* data) {
  static const Value kNone = 0;
  return data == nullptr ? &kNone : data;
}

/// Fills a column by rows.
template <class Column, class OfRow>
const Column& filled(Column& column, std::size_t rows, const OfRow& of_row) {
  column.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) column[i] = of_row(i);
  return column;
}

}  // namespace

const double* BodyFields::reals(const LoadedScene& loaded, const RunState& s, const std::string& field) {
  const ParticleSet& p = s.particles;
  if (field == "velocity") return shown(as_numbers(p.v));
  if (field == "angular_velocity") return shown(as_numbers(p.w));
  if (field == "force") return shown(as_numbers(p.force));
  if (field == "torque") return shown(as_numbers(p.torque));
  if (field == "mass") return shown(as_numbers(p.mass));
  if (field == "radius") return shown(as_numbers(p.radius));
  if (field == "scale") return shown(as_numbers(p.scale));
  if (field == "temperature") return loaded.scene.settings.heat ? shown(as_numbers(p.temperature)) : nullptr;
  if (field == "position") {
    if (loaded.origin == Vec3{}) return shown(as_numbers(p.x));
    return shown(as_numbers(filled(position_, p.owned, [&](std::size_t i) { return p.x[i] + loaded.origin; })));
  }
  if (field == "quaternion")
    return shown(as_numbers(filled(quaternion_, p.owned, [&](std::size_t i) { return mesh_orientation(s.scene, p.shape[i], p.q[i]); })));
  if (field == "volume") {
    return shown(as_numbers(filled(volume_, p.owned, [&](std::size_t i) {
      return p.mass[i] / s.scene.source().materials[static_cast<std::size_t>(p.material[i])].density;
    })));
  }
  if (field == "diameter") return shown(as_numbers(filled(diameter_, p.owned, [&](std::size_t i) { return 2 * p.equivalent_radius[i]; })));
  return nullptr;
}

const std::int64_t* BodyFields::integers(const RunState& s, const std::string& field) {
  const ParticleSet& p = s.particles;
  if (field == "id") return shown(p.id.data());
  if (field == "shape") return shown(filled(shape_, p.owned, [&](std::size_t i) { return p.shape[i]; }).data());
  if (field == "material") return shown(filled(material_, p.owned, [&](std::size_t i) { return p.material[i]; }).data());
  if (field == "fixed") return shown(filled(fixed_, p.owned, [&](std::size_t i) { return p.fixed[i]; }).data());
  if (field == "asleep") return shown(filled(asleep_, p.owned, [&](std::size_t i) { return p.rest[i] == kAsleep ? 1 : 0; }).data());
  return nullptr;
}

}  // namespace scree
