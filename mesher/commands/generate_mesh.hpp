// The meshes that `generate` makes from its options, but for random ones.
#pragma once

#include <string>

#include "core/geometry/triangle_mesh.hpp"
#include "mesher/commands/commands.hpp"

namespace scree {

/// A length > 0 [m] from the text of an option. Throws UsageError, also where the text is empty.
double positive_length(const std::string& text, const char* option);

/// The shape of this name. Throws UsageError for values that make no such solid, or too many triangles.
TriangleMesh generated_mesh(const GenerateOptions& options);

}  // namespace scree
