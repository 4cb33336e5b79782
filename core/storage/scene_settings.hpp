// The settings of a scene file, which have a source file of their own; everybody else includes scene_file.hpp.
#pragma once

#include <string>

#include "core/storage/scene.hpp"

namespace scree {

/// Fills settings, materials, pairs and walls of a scene whose shapes are there.
/// in   where   of the text in its file, for messages
/// Throws InputError when a value is missing or cannot be.
void read_settings_json(const nlohmann::json& text, const std::string& where, Scene& scene);

}  // namespace scree
