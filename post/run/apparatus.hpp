// Bodies that are not of the packing: a lid, a plate, a stamp. They press on it as a wall does.
#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "post/run/run_folder.hpp"

namespace scree {

/// A body of [[bodies]] this many times as large as the middle one of the populations is apparatus: a lid as wide as its packing, not an
/// intruder or a large stone among others. Smaller, and stones would be set apart; larger, and the lid of a narrow vessel would count.
inline constexpr double kApparatusSize = 5;

/// Counts apparatus as walls from now on (Run::boundary_ids): its mass, its height and what presses it belong to no stress, no
/// solid fraction and no mean of the particles, while its contacts still stress the particles that it touches.
///
/// in   names   shapes or materials whose bodies are apparatus; with none, large bodies of [[bodies]] in a scene that has populations or
/// inlets Returns what was set apart, one line; empty: nothing. Fails: UsageError where a name is neither a shape nor a material; those of
/// the scene are listed.
std::string set_apparatus_apart(Run& run, const std::vector<std::string>& names);

/// Bodies and walls to leave out of statistics altogether, with all their contacts: by shape, material, name of a wall, or id.
/// Fails: UsageError where a name is none of these; those of the scene are listed.
std::unordered_set<std::int64_t> ids_left_out(const Run& run, const std::vector<std::string>& names);

}  // namespace scree
