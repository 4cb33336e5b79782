// Can this run be trusted? The questions that a reviewer asks first, each with its answer, limit and evidence.
#pragma once

#include <string>
#include <vector>

#include "post/run/run_folder.hpp"

namespace scree {

enum class Judgement { good, doubtful, bad, information };

struct Verdict {
  std::string question;  ///< "Energy balance"
  Judgement judgement = Judgement::information;
  std::string answer;    ///< "closed to 0.02 %"
  std::string evidence;  ///< how it was measured and what the limit means
};

/// Limits of the verdicts. They are those of the project's acceptance, not of taste.
inline constexpr double kEnergyGood = 0.01;  ///< balance error over the largest energy that was in play
inline constexpr double kEnergyDoubtful = 0.05;
inline constexpr double kOverlapDoubtful = 0.8;  ///< overlap over margin; at 1 the surfaces themselves would touch
inline constexpr double kRestKinetic = 1e-6;     ///< kinetic energy over its peak
inline constexpr double kStepGood = 0.2;         ///< step over the critical step of the contacts: where energies hold to a per cent
inline constexpr double kStepDoubtful =
    0.5;  ///< above it energies err by per cents; the solver refuses a given step only above kMostCritical (solver/step/step_size.hpp)
inline constexpr double kImbalanceGood = 1.3;  ///< largest over mean work of the ranks; more costs time, never correctness

std::vector<Verdict> judge(const Run& run);

/// The error of the energy balance, and what it is held against.
///
/// in play   the largest of: peak kinetic energy, energy dissipated, peak elastic energy, work of the walls, range of the potential
///           energy; at least what a fall of kStillFall diameters gives all bodies, so that a scene in which nothing moves is not judged
///           by rounding
/// lasting   the largest error beyond a tenth of the elastic energy of its time, and that of the last row in full: the step's error
///           within a contact (4 % of its energy at 12 steps) goes as the contact ends
struct EnergyBalance {
  double in_play = 0, lasting = 0, largest = 0;  ///< [J]
};
EnergyBalance energy_balance(const Run& run);
inline constexpr double kContactError = 0.1;  ///< of the elastic energy that the error within contacts may be
inline constexpr double kStillFall = 1e-6;    ///< diameters; the solver's own measure of rest

/// The record of where the run comes from: of run.json, or of the first frame while there is none.
nlohmann::json provenance_of(const Run& run);

/// "good", "doubtful", "bad", "for information".
const char* name_of(Judgement judgement);

}  // namespace scree
