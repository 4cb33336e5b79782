#include "post/run/apparatus.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "post/run/run_bodies.hpp"

namespace scree {

namespace {

double size_of(const Scene& scene, const RunBody& body) {
  return body.scale * scene.shapes[static_cast<std::size_t>(body.shape)].bounding_radius();
}

bool is_of(const Scene& scene, const RunBody& body, const std::string& name) {
  return scene.shapes[static_cast<std::size_t>(body.shape)].name == name ||
         scene.materials[static_cast<std::size_t>(body.material)].name == name;
}

/// Whether each body is meant by one of the names.
std::vector<bool> named(const Scene& scene, const RunBodies& bodies, const std::vector<std::string>& names) {
  std::vector<bool> chosen(bodies.all.size());
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
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = chosen[i] || is_of(scene, bodies.all[i], name);
  }
  return chosen;
}

/// Bodies of [[bodies]] that are much larger than those of the populations; where there are none of these, than those that came in.
std::vector<bool> large(const Scene& scene, const RunBodies& bodies) {
  std::vector<bool> chosen(bodies.all.size());
  const std::string given = "[[bodies]]";
  const auto is_given = [&](const RunBody& body) { return bodies.origins[static_cast<std::size_t>(body.origin)] == given; };
  const auto is_poured = [&](const RunBody& body) {
    return bodies.origins[static_cast<std::size_t>(body.origin)].starts_with("population ");
  };
  std::vector<double> sizes, came_in;
  for (const RunBody& body : bodies.all) {
    if (body.is_fixed || is_given(body)) continue;
    (is_poured(body) ? sizes : came_in).push_back(size_of(scene, body));
  }
  if (sizes.empty()) sizes = came_in;
  if (sizes.empty()) return chosen;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i] = is_given(bodies.all[i]) && size_of(scene, bodies.all[i]) >= kApparatusSize * *middle;
  return chosen;
}

}  // namespace

std::string set_apparatus_apart(Run& run, const std::vector<std::string>& names) {
  const Scene& scene = run.scene;
  const RunBodies bodies(run);
  const std::vector<bool> chosen = names.empty() ? large(scene, bodies) : named(scene, bodies, names);
  std::string list;
  std::size_t count = 0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const RunBody& body = bodies.all[i];
    if (!chosen[i] || !run.boundary_ids.insert(body.id).second) continue;
    const std::string& shape = scene.shapes[static_cast<std::size_t>(body.shape)].name;
    if (++count <= 5) list += fmt::format("{}{} ({})", count > 1 ? ", " : "", body.id, shape);
  }
  if (count == 0) return "";
  return fmt::format("{} {} counted as apparatus, not as particles: {}{}", count, count == 1 ? "body is" : "bodies are", list,
                     count > 5 ? " and more" : "");
}

std::unordered_set<std::int64_t> ids_left_out(const Run& run, const std::vector<std::string>& names) {
  std::unordered_set<std::int64_t> ids;
  if (names.empty()) return ids;
  const Scene& scene = run.scene;
  const RunBodies bodies(run);
  for (const std::string& name : names) {
    std::vector<std::int64_t> found;
    for (const RunBody& body : bodies.all) {
      if (is_of(scene, body, name) || fmt::format("{}", body.id) == name) found.push_back(body.id);
    }
    for (const Wall& wall : scene.walls) {
      if (wall.name == name || fmt::format("{}", wall.id) == name) found.push_back(wall.id);
    }
    if (found.empty()) {
      std::vector<std::string> words;  // the mesh of a wall has the name of the wall
      const auto add = [&](const std::string& word) {
        if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
      };
      for (const Shape& shape : scene.shapes) add(shape.name);
      for (const Material& material : scene.materials) add(material.name);
      for (const Wall& wall : scene.walls) add(wall.name.empty() ? fmt::format("{}", wall.id) : wall.name);
      const std::string list = fmt::format("{}", fmt::join(words, ", "));
      throw UsageError("--without {}: no body and no wall of the run has this shape, material, name or id; it has: {}, and ids of bodies",
                       name, list);
    }
    ids.insert(found.begin(), found.end());
  }
  return ids;
}

}  // namespace scree
