// What a contact law is made from: two materials of a scene as they meet.
#pragma once

#include <functional>

#include "core/storage/scene_file.hpp"

namespace scree {

/// The severest impact to be expected between two materials.
struct LargestImpact {
  double radius = 0;  ///< R* of the contact [m]
  double mass = 0;    ///< [kg]
  double speed = 0;   ///< [m/s]; 0: not known
};

struct LawInput {
  const MaterialPair& pair;
  const Material &a, &b;
  double max_overlap;                             ///< largest overlap at which meshes meet [m]; 0: no limit
  double smallest_max_overlap;                    ///< the least of it [m]
  bool limits_step;                               ///< the step follows from it: it is not given, and bodies move (not heat.frozen)
  bool continues;                                 ///< contacts go on beyond their maximum overlap, along the tangent that they have there
  std::function<LargestImpact()> largest_impact;  ///< goes over all bodies
};

}  // namespace scree
