#include "post/run/apparatus.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

namespace {

double size_of(const Scene& scene, std::size_t i) {
  return scene.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].bounding_radius();
}

/// Whether each body is meant by one of the names.
std::vector<bool> named(const Scene& scene, const std::vector<std::string>& names) {
  std::vector<bool> chosen(scene.bodies.size());
  for (const std::string& name : names) {
    bool known = false;
    for (const Shape& shape : scene.shapes) known = known || shape.name == name;
    for (const Material& material : scene.materials) known = known || material.name == name;
    if (!known) {
      std::string list;
      for (const Shape& shape : scene.shapes) list += (list.empty() ? "" : ", ") + shape.name;
      for (const Material& material : scene.materials) list += ", " + material.name;
      throw UsageError("--apparatus {}: no shape and no material of the scene; it has: {}", name, list);
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      chosen[i] = chosen[i] || scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].name == name ||
                  scene.materials[static_cast<std::size_t>(scene.bodies.material[i])].name == name;
    }
  }
  return chosen;
}

/// Bodies of [[bodies]] that are much larger than those of the populations.
std::vector<bool> large(const Scene& scene) {
  std::vector<bool> chosen(scene.bodies.size());
  std::vector<double> sizes;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (scene.bodies.population[i] >= 0 && scene.bodies.fixed[i] == 0) sizes.push_back(size_of(scene, i));
  }
  if (sizes.empty()) return chosen;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i] = scene.bodies.population[i] < 0 && size_of(scene, i) >= kApparatusSize * *middle;
  return chosen;
}

}  // namespace

std::string set_apparatus_apart(Run& run, const std::vector<std::string>& names) {
  const Scene& scene = run.scene;
  const std::vector<bool> chosen = names.empty() ? large(scene) : named(scene, names);
  std::string list;
  std::size_t count = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!chosen[i] || !run.boundary_ids.insert(scene.bodies.id[i]).second) continue;
    const std::string& shape = scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].name;
    if (++count <= 5) list += fmt::format("{}{} ({})", count > 1 ? ", " : "", scene.bodies.id[i], shape);
  }
  if (count == 0) return "";
  return fmt::format("{} {} counted as apparatus, not as particles: {}{}", count, count == 1 ? "body is" : "bodies are", list,
                     count > 5 ? " and more" : "");
}

std::unordered_set<std::int64_t> ids_left_out(const Run& run, const std::vector<std::string>& names) {
  const Scene& scene = run.scene;
  std::unordered_set<std::int64_t> ids;
  for (const std::string& name : names) {
    std::vector<std::int64_t> found;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      if (scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].name == name ||
          scene.materials[static_cast<std::size_t>(scene.bodies.material[i])].name == name || fmt::format("{}", scene.bodies.id[i]) == name)
        found.push_back(scene.bodies.id[i]);
    }
    for (const Wall& wall : scene.walls) {
      if (wall.name == name || fmt::format("{}", wall.id) == name) found.push_back(wall.id);
    }
    if (found.empty()) {
      std::string list;
      for (const Shape& shape : scene.shapes) list += (list.empty() ? "" : ", ") + shape.name;
      for (const Material& material : scene.materials) list += ", " + material.name;
      for (const Wall& wall : scene.walls) list += wall.name.empty() ? fmt::format(", {}", wall.id) : ", " + wall.name;
      throw UsageError("--without {}: no body and no wall of the scene has this shape, material, name or id; it has: {}, and ids of bodies",
                       name, list);
    }
    ids.insert(found.begin(), found.end());
  }
  return ids;
}

}  // namespace scree
