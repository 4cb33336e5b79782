// The law of a pair: that of its two materials, made for the pair where it depends on its overlap.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solver/neighbours/body_pair.hpp"
#include "solver/pairs/pair_pass.hpp"

namespace scree {

/// R* of a contact [m].
inline double radius_of(const PairView& view, const PairLaw& law) { return law.radius > 0 ? law.radius : contact_radius(view); }

/// One thread's. What it returns holds until it is asked again.
class LawOfPair {
 public:
  explicit LawOfPair(const PairPass& pass) : pass_(pass) {}

  const PairLaw& law(const PairView& view, const BodyPair& pair) {
    const PairLaw& law = pass_.scene.law(pass_.p.material[static_cast<std::size_t>(pair.a)], material_of_b(view, pair));
    if (!pass_.scene.laws_by_max_overlap()) return law;
    fitted_ = pass_.scene.for_max_overlap(law, view.max_overlap);
    return fitted_;
  }
  /// The same; where pairs go on beyond their largest overlap, with the overlap from which it goes on along its tangent.
  const PairLaw& limited_law(const PairView& view, const BodyPair& pair) {
    const PairLaw& of_pair = law(view, pair);
    if (!pass_.continues) return of_pair;
    fitted_ = of_pair;
    fitted_.limit = pass_.stop_ratio * view.max_overlap;
    return fitted_;
  }

 private:
  std::int32_t material_of_b(const PairView& view, const BodyPair& pair) const {
    return view.zone == nullptr ? pass_.p.material[static_cast<std::size_t>(pair.b)]
                                : pass_.scene.source().walls[static_cast<std::size_t>(view.zone->wall)].material;
  }

  const PairPass& pass_;
  PairLaw fitted_;  // to the maximum overlap of a pair
};

}  // namespace scree
