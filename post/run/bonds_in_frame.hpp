// Bonds as a frame has them: which bodies they hold together, and where their faces are with what they bear.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "post/run/run_folder.hpp"

namespace scree {

/// Rows of all bonds of a scene: those that hold at the start.
std::vector<std::int64_t> all_bonds(const Scene& scene);
/// Of each body of a frame the lowest id of its fragment, all that bonds that hold connect; -1 where it never had a bond.
/// in   holding   rows of the scene's bonds that hold
/// Cost: O(bonds log bonds).
std::vector<std::int64_t> fragment_ids(const Scene& scene, const FrameBodies& bodies, const std::vector<std::int64_t>& holding);

/// For views in which fragments stand apart: of each body the way from the centre of its parent, all that it was bonded with at the start,
/// to that of its fragment [m]; zero while the parent is whole, and for bodies without bonds.
std::vector<Vec3> ways_apart(const Scene& scene, const Frame& frame);
/// The frame with each body moved by this share of that way.
Frame taken_apart(const Scene& scene, Frame frame, double share);

/// The face of a bond that holds, as a rectangle of its area whose second moments have the ratio of its own.
struct BondFace {
  std::int64_t body_a = 0, body_b = 0;
  std::array<Vec3, 4> corners;  ///< about the middle between both sides of the face
  double normal_stress = 0;     ///< mean over the face [Pa]; tension > 0
  double shear_stress = 0;      ///< the same along it, without torsion
  double load = 0;              ///< share of what it holds
  double energy = 0;            ///< [J]
};
/// In the order of the frame; those of which a body is not in the frame are left out.
std::vector<BondFace> bond_faces(const Scene& scene, const Frame& frame);

/// What pictures and the script for ParaView can colour faces of bonds by.
struct BondQuantity {
  const char* name;
  const char* title;
  double BondFace::*value;
  bool has_signs;  ///< tension and pressure
};
inline constexpr std::array<BondQuantity, 3> kBondQuantities{
    {{"normal_stress", "normal stress of bonds [Pa]", &BondFace::normal_stress, true},
     {"shear_stress", "shear stress of bonds [Pa]", &BondFace::shear_stress, false},
     {"load", "share of strength", &BondFace::load, false}}};
std::vector<std::string> bond_quantity_names();
/// Fails: UsageError for another name.
const BondQuantity& bond_quantity(const std::string& name);

}  // namespace scree
