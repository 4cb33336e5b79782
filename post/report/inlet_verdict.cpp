#include "post/report/inlet_verdict.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace scree {

Verdict judge_inlets(const Run& run) {
  Verdict v{"Inlets", Judgement::information, "known at the end", ""};
  if (!run.outcome->contains("inlets")) return v;
  v.judgement = Judgement::good;
  double most = 0;
  for (std::size_t k = 0; k < run.scene.inlets.size(); ++k) {
    const Inlet& inlet = run.scene.inlets[k];
    const nlohmann::json& record = (*run.outcome)["inlets"][k];
    const auto number = [&](const char* key) { return record.contains(key) && record[key].is_number() ? record[key].get<double>() : 0.0; };
    const double owed = number("owed"), missing = number("shortfall"), share = owed > 0 ? missing / owed : 0;
    if (!v.evidence.empty()) v.evidence += " ";
    v.evidence += fmt::format("'{}': {:.0f} bodies, {:.4g} kg came in", inlet.name, number("bodies"), number("mass"));
    if (missing > 0)
      v.evidence += fmt::format("; {:.4g} of {:.4g} {} found no room by the end, and {:.0f} times there was none", missing, owed,
                                inlet.rate.by_number ? "bodies" : "kg", number("times_blocked"));
    v.evidence += ".";
    if (share > most) {
      most = share;
      v.answer = fmt::format("{:.3g} % of '{}' found no room", 100 * share, inlet.name);
    }
  }
  if (most == 0) v.answer = "all came in that was due";
  if (most > kShortfallGood) {
    v.judgement = Judgement::doubtful;
    v.evidence += " A larger region, a smaller rate or faster bodies (velocity) give room.";
  }
  return v;
}

}  // namespace scree
