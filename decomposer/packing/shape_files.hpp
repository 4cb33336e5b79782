// The shape files that a case names: each is read once.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/storage/shape_file.hpp"
#include "decomposer/case/case.hpp"
#include "decomposer/packing/packing_report.hpp"

namespace scree {

class ShapeFiles {
 public:
  /// in   where   the key that names it, for messages
  /// Fails: InputError, when there is no such file or no shape can be read from it.
  const ShapeFile& open(const std::string& file, const std::string& where);
  /// The shape of bodies; one without a file is an analytic sphere.   Fails: as open(); InputError for a surface, UsageError for the name
  Shape body_shape(const CaseShape& s);
  /// The one shape of a wall's file, as it lies there.   Fails: as open(); InputError for several shapes or a sphere
  const Shape& wall_shape(const CaseWall& wall);

  /// What was opened, with the history of each, in the order of opening.
  const std::vector<InputRecord>& inputs() const { return inputs_; }

 private:
  std::map<std::string, ShapeFile> files_;
  std::vector<InputRecord> inputs_;
};

/// Which shapes of a case have bodies, or inlets that will bring some.
std::vector<bool> used_shapes(const Case& c);

/// Reads every shape file that the case names and that is there, as packing would. Returns the others, each with the key that names it.
/// Fails: as ShapeFiles.
std::vector<std::string> check_shape_files(const Case& c);

}  // namespace scree
