// A verdict on a run, and the limits of all verdicts.
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
inline constexpr double kBallsDoubtful = 0.2;    ///< overlap over radius: twelve such contacts have 9 % of a ball in its neighbours
inline constexpr double kBallsBad = 0.5;
inline constexpr double kRestKinetic = 1e-6;  ///< kinetic energy over its peak
/// Step over the critical step of all contacts at once. A motion at a share r of its critical step keeps its energy to r^2 / 4 while its
/// contacts last, and all of it when they end: 1 % at 0.2, 4.7 % at 0.5, 20 % at 0.9, still stable at 0.99 (X1 in
/// docs/results/stability.md). A body with many neighbours is held by all of them: a bed of balls with 12 steps a contact is at 0.5 to 0.8,
/// and its energies hold to 0.5 % (docs/user/theory.md). That accuracy is judged by the energy balance; this verdict is on stability.
inline constexpr double kStepGood = 0.9;
/// The critical step in the log is a lower bound, 0.738 to 1 of the true one (docs/results/validation-demands.md): above 1 / 0.738 a motion
/// of the contacts was unstable for certain, however briefly.
inline constexpr double kStepDoubtful = 1.35;
/// Steps that an impact of the stiffest pair takes; with fewer its restitution misses what the validation plan demands of it.
inline constexpr double kContactStepsGood = 8;
/// What a servo misses on average of the force asked, over the last tenth of the log. Beds that still give way take more.
inline constexpr double kServoForce = 0.05;
/// Of what an inlet is to bring in: what has no room at the end of a run that is not blocked is the last body or two.
inline constexpr double kShortfallGood = 0.01;
inline constexpr double kImbalanceGood = 1.3;  ///< largest over mean work of the ranks; more costs time, never correctness

}  // namespace scree
