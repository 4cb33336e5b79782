// What a message about a missing file adds.
#pragma once

#include <string>

namespace scree {

/// ", did you mean 'folder/name'?" of the file in the same folder whose name is nearest to one that is not there; "" where none is near.
std::string near_file(const std::string& path);

}  // namespace scree
