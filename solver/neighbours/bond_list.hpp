// The bonds of a scene, and those that this rank computes.
//
// The scene's table of bonds is on every rank; what changes is in which step each broke. A bond is computed by the owners of both ends,
// from the same bits, and both decide alike that it breaks; the other ranks hear of it when lists are rebuilt (share_broken), before a body
// could bring the bond to them. A pair that bonds hold has no contact: its indices are taken out of the lists of pairs
// (PairList::hold_apart) until the last of its bonds breaks. Bodies get the forces of their bonds in ascending order of bonds, after all
// contacts.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "solver/laws/bond.hpp"
#include "solver/neighbours/pair_list.hpp"

namespace scree {

inline constexpr std::int64_t kHolds = -1;  ///< in place of the step in which a bond broke

/// A bond with its bodies at hand.
struct ListedBond {
  std::int32_t bond = 0;      ///< row of the scene's table
  std::int32_t a = 0, b = 0;  ///< rows in ParticleSet
  BondLaw law;
};

class BondList {
 public:
  explicit BondList(const SolverScene& scene);

  /// Of each bond the step in which it broke, or kHolds. What other ranks decided since the lists were made is not in it.
  const std::vector<std::int64_t>& broken_at() const { return broken_at_; }
  void set_broken_at(std::vector<std::int64_t> steps);
  void mark_broken(std::int32_t bond, std::int64_t step);

  /// Lists the bonds that hold and of which a body is owned here. Throws RunInvalid when the other body is not among the rows.
  void list(const ParticleSet& p);
  const std::vector<ListedBond>& listed() const { return listed_; }
  const std::vector<BondForce>& forces() const { return forces_; }
  /// Whether bonds hold the two bodies of a pair.
  bool holds(const PairKey& key) const { return holding_.contains({key.a, key.b}); }

  /// Forces of all listed bonds that hold; adds them to the bodies.
  void compute(const ParticleSet& p);
  /// Sets the forces of these listed bonds to zero.
  void forget(const std::vector<std::size_t>& listed);
  void sum_onto_bodies(ParticleSet& p) const;
  /// Indices of the listed bonds that are loaded to what they hold, in ascending order of bonds.
  std::vector<std::size_t> overloaded() const;

  /// How far bonded bodies are apart beyond the sum of their bounding spheres, at most [m]; ranks see each other that much further.
  double farthest_gap(const ParticleSet& p) const;
  /// The same from the places of bodies by id.
  double farthest_gap(const std::map<std::int64_t, Vec3>& places, const std::map<std::int64_t, double>& radii) const;
  /// Ids of all bodies with bonds, ascending.
  const std::vector<std::int64_t>& bodies() const { return bodies_; }

  const std::vector<Bond>& table() const { return scene_.source().bonds; }
  /// Bonds that were marked as broken since the last call.
  std::vector<std::int32_t> take_news() { return std::exchange(news_, {}); }
  bool has_news() const { return !news_.empty(); }
  /// Of each listed bond, whether it was counted here when the list was made.
  const std::vector<std::uint8_t>& counted() const { return counted_; }
  bool counts_here(const ListedBond& bond, const ParticleSet& p) const { return static_cast<std::size_t>(bond.a) < p.owned; }
  bool is_broken(const ListedBond& bond) const { return broken_at_[static_cast<std::size_t>(bond.bond)] != kHolds; }

 private:
  BondMotion motion_of(const ParticleSet& p, const ListedBond& bond) const;
  BondLaw law_of(const ParticleSet& p, const Bond& bond, std::size_t a, std::size_t b) const;
  void count_holding();

  const SolverScene& scene_;
  std::vector<std::int64_t> broken_at_, bodies_;
  std::vector<std::int32_t> news_;
  std::vector<std::uint8_t> counted_;
  std::vector<ListedBond> listed_;
  std::vector<BondForce> forces_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::int32_t> holding_;  // bonds that hold each pair
  std::vector<std::int32_t> rows_, start_, entry_;                         // bodies with bonds, and (listed bond, side) of each
};

}  // namespace scree
