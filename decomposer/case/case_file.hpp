// case.toml as a person wrote it, checked and in SI. The page of the language is CASE.md.
#pragma once

#include <string>
#include <vector>

#include "decomposer/case/case.hpp"

namespace scree {

/// Reads and checks a case; opens no other file.
/// Throws InputError when the file cannot be read, UsageError for everything that is wrong in it: syntax, unknown
/// keys, types, units, ranges, names, features that are not built yet, material pairs that can meet and are missing.
/// in   changes   keys set on the command line (case_settings.hpp)
Case read_case(const std::string& path, const std::vector<std::string>& changes = {});
/// The same from text; relative paths are taken from `folder`.
Case parse_case(const std::string& text, const std::string& path, const std::string& folder, const std::vector<std::string>& changes = {});

}  // namespace scree
