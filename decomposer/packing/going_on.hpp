// A case that goes on where a run ended ([start] with `continue`), and bodies of a run that stay behind (`leave_out`).
#pragma once

#include <string>
#include <vector>

#include "core/placing/region.hpp"
#include "decomposer/packing/from_run.hpp"

namespace scree {

/// Takes bodies and populations out of the case, since the run has them, and puts each wall that has the name of a wall of the run where
/// that one stood. A motion that is the same as in the run goes on at its clock; another one begins at 0 s, from where the wall stood.
///
/// in   c      with a start that goes on     out   c, from.start.clock, notices: what does not go on
/// Throws UsageError for a wall that has another form than that of its name in the run, or cannot go on from where that one stood.
void go_on(Case& c, FromRun& from, std::vector<std::string>& notices);

/// Whether a wall that goes on has the surface of that of its name in the run.
/// in   wall   of the case     in   surface   its mesh
/// Throws UsageError when it has not.
void check_surface_goes_on(const Case& c, const FromRun& from, const Wall& wall, const TriangleMesh& surface);

/// Takes out the bodies whose centres lie in a region, and what their pairs remember.
/// Throws UsageError when no body is left.
void leave_out(const Case& c, const Region& region, FromRun& from);

}  // namespace scree
