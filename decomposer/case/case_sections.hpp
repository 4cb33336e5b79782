// The long sections of a case file, read one by one; read_case puts them together.
#pragma once

#include <string>
#include <vector>

#include "decomposer/case/case_file.hpp"
#include "decomposer/case/case_table.hpp"

namespace scree {

/// A path of a case as it can be opened: relative ones start from the folder of the case.
std::string resolved(const std::string& folder, const std::string& file);
/// `orientation` of a table, a unit quaternion [w, x, y, z]; none: no rotation.
Quat read_orientation(const CaseTable& t);

/// { start, end, radius } and { centre, radius }, into the fields of a wall of that kind.
void read_cylinder(const CaseTable& t, Wall& wall);
void read_sphere(const CaseTable& t, Wall& wall);

/// [[walls]]
void read_walls(const CaseTable& top, const std::string& folder, const std::vector<std::string>& materials, Case& c);
/// [[populations]]; after the walls, since a region may be the inside of one.
void read_populations(const CaseTable& top, const std::string& folder, const std::vector<std::string>& shapes,
                      const std::vector<std::string>& materials, Case& c);

}  // namespace scree
