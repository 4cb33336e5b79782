// *.scene.h5: everything the solver needs, standing alone. The page of the format is SCENE_FORMAT.md.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/storage/scene.hpp"

namespace scree {

/// Writes whole or not at all.
void write_scene_file(const std::string& path, const Scene& scene);
/// Throws InputError when the file is missing, damaged, of another kind or of a newer version, or when an
/// index, a quaternion or a number in it cannot be right.
Scene read_scene_file(const std::string& path);

/// Settings, materials, pairs and walls as JSON, as stored in the scene and repeated in run.json.
nlohmann::json settings_json(const Scene& scene);

}  // namespace scree
