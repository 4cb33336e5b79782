// Keys of a case set on the command line: --set pairs.0.friction=0.4
#pragma once

#include <toml++/toml.h>
#include <string>
#include <vector>

namespace scree {

/// Changes a parsed case.
///
/// in/out  file      the case
/// in      settings  "KEY=VALUE" each, in order. KEY: names with dots between; [[tables]] by number from 0, or * for all of
///                   them ("pairs.*.friction"). VALUE: as in the file; quotes around a text may be left out ("2 mm").
/// A key that the case does not have is added, so that a default can be changed; whether it exists at all is for the
/// reader of the case to say. Throws UsageError for a setting that cannot be understood or names a [[table]] that is not there.
void apply_settings(toml::table& file, const std::vector<std::string>& settings);

/// The case as it then is, as a TOML file that says where it comes from: what the scene keeps of its making.
std::string text_with_settings(const toml::table& file, const std::string& path, const std::vector<std::string>& settings);

}  // namespace scree
