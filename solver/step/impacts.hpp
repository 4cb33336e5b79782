// Impacts and what contacts dissipate, by pair of materials: sums since the start of the run, which no order of contacts, ranks or threads
// changes, so that frames and checkpoints have the same bits on any of them. Kept where the case asks for it (output.impacts).
//
//   impact        of a pair that begins to touch: no feature of it was within the margins one step before (beginning_of). Its energy is
//   that of
//                 the motion that the contact takes up, along the normals and along the surfaces: m v^2 / 2 with the reduced mass of two
//                 balls that meet head on. Each goes to the bin of its size.
//   dissipation   by cause: damping along the normal, friction (its damping included), rolling and torsional resistance. What springs of
//                 friction store is taken off when the sums are read: it is not lost.
//
// Each rank adds what its own bodies do, as for all that is dissipated (add_dissipation): ghosts have no velocities at the end of a step.
// The sums of all pairs are the dissipation of contacts in log.csv. Cost: per contact and step about a microsecond; kImpactBins x 176 bytes
// for each pair of materials and rank.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "solver/contact/pair_force.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/ranks/exact_sum.hpp"

namespace scree {

struct RunState;

enum Loss : std::size_t { kDampingLoss, kFrictionLoss, kRollingLoss, kLosses };
enum ImpactPart : std::size_t { kNormalImpact, kShearImpact, kImpactParts };

/// Two bins for each power of two: from 2^-80 J (8e-25) to 2^40 J (1e12); the first and the last take what lies beyond.
inline constexpr int kFirstImpactPower = -80;
inline constexpr std::size_t kImpactBins = 240;
/// in   energy   [J], > 0
std::size_t impact_bin(double energy);
/// Lower end of a bin, or upper end of the one before [J].
double impact_bin_end(std::size_t bin);

struct ImpactBin {
  std::array<std::int64_t, kImpactParts> count{};
  std::array<ShortSum, kImpactParts> energy;  ///< [J]
};

struct MaterialPairTotals {
  std::array<ShortSum, kLosses> lost;  ///< [J]; friction and rolling with what their springs store
  std::array<ImpactBin, kImpactBins> bins;
};

/// Of one rank, or of all; empty where nobody asked for it.
struct ImpactTotals {
  std::vector<MaterialPairTotals> pairs;  ///< material_pair(a, b)
};

/// Row of a pair of materials, in any order.
inline std::size_t material_pair(std::size_t a, std::size_t b) { return a < b ? b * (b + 1) / 2 + a : a * (a + 1) / 2 + b; }
inline std::size_t material_pairs(std::size_t materials) { return materials * (materials + 1) / 2; }

/// A pair of bodies in contact, world axes; forces on A, and torques about the centres.
struct ImpactEntry {
  std::int32_t materials;                        ///< row of ImpactTotals
  std::int32_t a, b;                             ///< rows of the particle set; -1: a wall
  std::int32_t wall;                             ///< index in the scene; -1: none
  bool counts_here;                              ///< this rank counts what the pair has once
  Vec3 damping, damping_a, damping_b;            ///< force, torques
  Vec3 friction, friction_a, friction_b;         ///< force, torques
  Vec3 rolling;                                  ///< torque
  double surface_friction, surface_rolling;      ///< on a surface that moves [W]
  double stored_by_friction, stored_by_rolling;  ///< in springs [J]
  std::array<double, kImpactParts> impact{};     ///< of a contact that begins [J]; 0: none
};

/// What a contact begins with.
struct Beginning {
  double overlaps = 0;  ///< sum of those above 0 [m]; 0: nothing begins
  std::array<double, kImpactParts>
      energy{};  ///< of the motion along the wrench of unit pressures at the features, and along the surfaces [J]
};
/// in   friction_dt   the step that lies behind the pair [s]; 0: none, as at the start
Beginning beginning_of(const PairFeatures& features, const PairMotion& motion, double friction_dt);

/// A pair in contact, as its force was just worked out.
struct RecordedContact {
  const PairView& view;
  const PairMotion& motion;
  const PairFeatures& features;
  const std::vector<ContactOutput>& outputs;
  const PairForce& force;
  const Mat3& a_to_world;
  const BodyPair& pair;
  std::size_t materials;
  bool counts_here;
  double friction_dt;  ///< [s]; 0: as at the start
};
ImpactEntry impact_entry(const RecordedContact& contact);

/// Adds the entries of the present forces.
/// in   dt       that the forces count for [s]     in  events   whether what happened in the step counts too
void book_impacts(const RunState& s, double dt, bool events, ImpactTotals& totals);

/// At the present moment: of all ranks, without the half of the last step that lies ahead and without what springs store. Collective.
ImpactTotals impacts_now(const RunState& s);

/// The same on every rank. Collective.
void add_over_ranks(MPI_Comm comm, ImpactTotals& totals);

/// As checkpoints and hashes take them: kImpactWords for each pair of materials.
inline constexpr std::size_t kImpactWords = kLosses * ShortSum::kWords + kImpactBins * kImpactParts * (1 + ShortSum::kWords);
std::vector<std::int64_t> words_of(const ImpactTotals& totals);
/// in   words   as many as words_of() gives for so many pairs. Throws InputError.
void set_words(const std::vector<std::int64_t>& words, ImpactTotals& totals);

}  // namespace scree
