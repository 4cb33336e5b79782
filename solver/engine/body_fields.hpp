// Fields of the bodies of this rank, by the names of scree_engine.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/run/loaded_scene.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// Holds those that do not lie in the state as they are read: each until it is asked for again.
class BodyFields {
 public:
  /// Row after row; null for a field that there is none of. Valid until the state changes.
  const double* reals(const LoadedScene& loaded, const RunState& s, const std::string& field);
  const std::int64_t* integers(const RunState& s, const std::string& field);

 private:
  std::vector<double> volume_, diameter_;
  std::vector<Vec3> position_;
  std::vector<Quat> quaternion_;
  std::vector<std::int64_t> shape_, material_, fixed_, asleep_;
};

}  // namespace scree
