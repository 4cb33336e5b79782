// Can this run be trusted? The questions that a reviewer asks first, each with its answer, limit and evidence.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/storage/energy_in_play.hpp"
#include "post/report/verdict.hpp"

namespace scree {

std::vector<Verdict> judge(const Run& run);

/// The error of the energy balance, and what it is held against.
///
/// largest   of all rows: over what is in play it is `error_relative` of run.json
/// lasting   the largest error beyond a tenth of the elastic energy of its time, and that of the last row in full: the step's error
///           within a contact (4 % of its energy at 12 steps) goes as the contact ends
struct EnergyBalance {
  double lasting = 0, largest = 0;  ///< [J]
  EnergyInPlay in_play;
};
EnergyBalance energy_balance(const Run& run);

/// Error of the restitution of an impact that takes so many steps, the worst of three laws, restitutions from 0.3 to 0.9 and 41 phases of
/// touch (docs/results/work-precision.md, P1).
double restitution_error(double steps);
inline constexpr double kContactError = 0.1;  ///< of the elastic energy that the error within contacts may be

/// Pairs of triangles of a solid that pass through or touch each other, as scree-mesher found them; 0 where it did not look.
std::int64_t crossing_pairs(const Shape& shape);

/// The record of where the run comes from: of run.json, or of the first frame while there is none.
nlohmann::json provenance_of(const Run& run);

/// "good", "doubtful", "bad", "for information".
const char* name_of(Judgement judgement);

}  // namespace scree
