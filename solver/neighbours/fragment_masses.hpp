// What a contact moves on a body that bonds hold to others: the mass and inertia of the fragment, all that unbroken bonds connect.
//
// A contact on a piece of a stiff body lasts as long as the whole body takes to turn round, so that damping for a restitution needs
// the fragment and not with the piece. Fragments are found from the scene's table of bonds and from which bond broke when, both known on
// every rank, so that nothing travels and every rank computes the same bits; a checkpoint needs no more than the steps in which bonds
// broke. Bonds that broke count from the next multiple of kReviewSteps on (effects/bonds/bonds.hpp): ranks hear of them then, and a restart
// finds the same. Fragments with a fixed body or one that does not turn do not move as a whole: their pieces count alone.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/neighbours/bond_list.hpp"

namespace scree {

class FragmentMasses {
 public:
  /// Of a scene with all bonds holding.
  explicit FragmentMasses(const SolverScene& scene);

  /// Takes the bonds that broke before a step as broken: those that hold once never form again. Returns whether any fragment changed.
  /// Cost: O(bonds), and the fragments that changed.
  bool update(const std::vector<std::int64_t>& broken_at, std::int64_t before);

  /// Of a body by id; null where nothing that moves as a whole hangs on it.
  const BondedMass* of(std::int64_t id) const;
  /// Fills in ParticleSet::bonded, ghosts included. What it points to lives here, and stays there when fragments change.
  void assign_to(ParticleSet& p) const;

 private:
  struct Body {
    double mass;   ///< [kg]
    Vec3 inertia;  ///< principal [kg m^2]
    bool moves_freely;
  };
  /// A bond as seen from one of its bodies: how the other lies at rest, in the principal axes of the first.
  struct Neighbour {
    std::int32_t bond, body;
    Vec3 centre;
    Quat turn;
  };
  void find_fragment(std::int32_t first, std::vector<std::uint8_t>& is_found);

  const SolverScene& scene_;
  std::vector<std::int64_t> ids_;  // of bodies with bonds, ascending; all below go by this
  std::vector<Body> bodies_;
  std::vector<BondedMass> masses_;
  std::vector<std::int32_t> start_;
  std::vector<Neighbour> neighbours_;
  std::vector<std::uint8_t> is_broken_;  // of bonds
};

}  // namespace scree
