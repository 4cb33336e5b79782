// What a message about a misspelt word proposes.
#pragma once

#include <string>
#include <vector>

namespace scree {

/// The candidate nearest to a misspelt word by edit distance, or "" when none is near.
std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace scree
