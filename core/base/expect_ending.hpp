// The names of files that a tool writes.
#pragma once

#include <initializer_list>
#include <string>

namespace scree {

/// Refuses, with UsageError, the name of a file to write that has none of these endings, and says what to write.
/// in   option   "-o"     in   what   "a scene"     in   endings   ".scene.h5"; the first is the one to write
void expect_ending(const std::string& option, const std::string& path, const std::string& what, std::initializer_list<const char*> endings);

}  // namespace scree
