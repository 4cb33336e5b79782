// What follows from the values of a scene.
#include <cmath>

#include "core/base/error.hpp"
#include "core/storage/scene.hpp"

namespace scree {

double Inlet::owed(double time) const {
  const double amount = rate.amount(std::min(time, stop) - start);
  if (rate.by_number) return count >= 0 ? std::min(amount, static_cast<double>(count)) : amount;
  return std::min(amount, limit);
}

void BodyTable::add(const BodyRow& r) {
  SCREE_ASSERT(owner.empty(), "{} owners", owner.size());
  id.push_back(r.id);
  shape.push_back(r.shape);
  material.push_back(r.material);
  scale.push_back(r.scale);
  position.push_back(r.position);
  orientation.push_back(r.orientation);
  velocity.push_back(r.velocity);
  angular_velocity.push_back(r.angular_velocity);
  fixed.push_back(r.fixed ? 1 : 0);
  lock_rotation.push_back(r.lock_rotation ? 1 : 0);
  population.push_back(r.population);
  temperature.push_back(r.temperature);
  heat_source.push_back(r.heat_source);
  heat_table.push_back(r.heat_table);
}

BodyRow BodyTable::row(std::size_t i) const {
  return {id[i],
          shape[i],
          material[i],
          scale[i],
          position[i],
          orientation[i],
          velocity[i],
          angular_velocity[i],
          fixed[i] != 0,
          lock_rotation[i] != 0,
          population[i],
          i < temperature.size() ? temperature[i] : 0,
          i < heat_source.size() ? heat_source[i] : 0,
          i < heat_table.size() ? heat_table[i] : -1};
}

const MaterialPair& Scene::pair(std::int32_t a, std::int32_t b) const {
  for (const MaterialPair& p : pairs) {
    if ((p.a == a && p.b == b) || (p.a == b && p.b == a)) return p;
  }
  const auto name = [&](std::int32_t m) {
    return m >= 0 && static_cast<std::size_t>(m) < materials.size() ? materials[static_cast<std::size_t>(m)].name : std::to_string(m);
  };
  throw InputError("the scene has no contact properties for the materials '{}' and '{}'; add [[pairs]] between = [\"{}\", \"{}\"]", name(a),
                   name(b), name(a), name(b));
}

bool Scene::balls_touch_beside_meshes() const {
  if (settings.surface != TouchAt::drawn || !(settings.margin_ratio > 0)) return false;
  const auto is_ball = [this](std::int32_t shape) { return shapes[static_cast<std::size_t>(shape)].kind == ShapeKind::sphere; };
  return std::any_of(bodies.shape.begin(), bodies.shape.end(), is_ball) ||
         std::any_of(inlets.begin(), inlets.end(), [&](const Inlet& inlet) {
           return std::any_of(inlet.shares.begin(), inlet.shares.end(), [&](const Inlet::Share& share) { return is_ball(share.shape); });
         });
}

double Scene::mass(std::size_t body) const { return mass(bodies.shape[body], bodies.material[body], bodies.scale[body]); }

double Scene::mass(std::int32_t shape, std::int32_t material, double scale) const {
  return materials[static_cast<std::size_t>(material)].density * shapes[static_cast<std::size_t>(shape)].mass.volume * scale * scale *
         scale;
}

double effective_modulus(const Material& a, const Material& b) {
  return 1 / ((1 - a.poisson * a.poisson) / a.young + (1 - b.poisson * b.poisson) / b.young);
}

double effective_shear_modulus(const Material& a, const Material& b) {
  return 1 / (2 * (2 - a.poisson) * (1 + a.poisson) / a.young + 2 * (2 - b.poisson) * (1 + b.poisson) / b.young);
}

double hertz_impact_overlap(double modulus, double radius, double mass, double speed) {
  return std::pow(15 * mass * speed * speed / (16 * modulus * std::sqrt(radius)), 0.4);
}

}  // namespace scree
