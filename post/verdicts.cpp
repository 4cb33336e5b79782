#include "post/verdicts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "post/provenance_chain.hpp"

namespace scree {

namespace {

double largest(const LogTable& log, const char* column) {
  double value = 0;
  if (log.has(column)) {
    for (double v : log.column(column)) {
      if (std::isfinite(v)) value = std::max(value, std::abs(v));
    }
  }
  return value;
}

double number_in(const nlohmann::json& object, const char* key, double otherwise) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return otherwise;
  return object[key].get<double>();
}

std::string percent(double part) { return part > 0 && part < 1e-4 ? fmt::format("{:.1e} %", 100 * part) : fmt::format("{:.3g} %", 100 * part); }

Verdict judge_outcome(const Run& run) {
  Verdict v{"Outcome", Judgement::good, "", ""};
  if (!run.is_finished()) {
    v.judgement = Judgement::doubtful;
    v.answer = "not finished";
    v.evidence = "There is no run.json: the run is still being written, or was killed. This page shows the whole frames so far.";
    return v;
  }
  const std::string outcome = run.outcome.value("outcome", "?"), message = run.outcome.value("message", "");
  v.answer = outcome;
  v.judgement = outcome == "completed" ? Judgement::good : (outcome == "interrupted" ? Judgement::doubtful : Judgement::bad);
  v.evidence = outcome == "completed" ? fmt::format("{:.0f} steps, {:.6g} s of simulated time", number_in(run.outcome, "steps", 0),
                                                    number_in(run.outcome, "time", 0))
                                      : message;
  return v;
}

Verdict judge_energy(const Run& run) {
  Verdict v{"Energy balance", Judgement::information, "", ""};
  if (run.log.rows() == 0) {
    v.answer = "unknown";
    v.evidence = "There is no log.csv.";
    return v;
  }
  double peak = 0;
  const auto &translational = run.log.column("kinetic_translational"), &rotational = run.log.column("kinetic_rotational");
  for (std::size_t i = 0; i < translational.size(); ++i) peak = std::max(peak, translational[i] + rotational[i]);
  const double scale = std::max(peak, run.log.column("dissipated").back());
  const double error = largest(run.log, "energy_error");
  const double relative = scale > 0 ? error / scale : 0;
  v.answer = "closed to " + percent(relative);
  v.judgement = relative <= kEnergyGood ? Judgement::good : (relative <= kEnergyDoubtful ? Judgement::doubtful : Judgement::bad);
  v.evidence = fmt::format("Largest error of kinetic + potential + elastic + dissipated - wall work in the log, {:.3g} J, over the larger of "
                           "the peak kinetic energy and the energy dissipated, {:.3g} J. Dissipation is summed from the contact forces. "
                           "Good up to {}.", error, scale, percent(kEnergyGood));
  return v;
}

Verdict judge_depth(const Run& run) {
  Verdict v{"Contact depth", Judgement::information, "", ""};
  const double ratio = std::max(largest(run.log, "max_depth_ratio"), number_in(run.outcome, "max_depth_ratio", 0));
  if (run.scene.settings.margin <= 0) {
    v.answer = "no margin in this case";
    v.evidence = "Contacts begin at touch; there is no boundary layer to use up.";
    return v;
  }
  v.answer = fmt::format("at most {:.3f} of the margin", ratio);
  v.judgement = ratio < kDepthDoubtful ? Judgement::good : (ratio < 1 ? Judgement::doubtful : Judgement::bad);
  v.evidence = "Depth over the sum of both margins, the largest of all contacts and steps. Below 1 no two surfaces ever met; "
               "near 1 choose a larger stiffness or margin.";
  return v;
}

Verdict judge_rest(const Run& run) {
  Verdict v{"Came to rest", Judgement::information, "", ""};
  if (run.log.rows() == 0) {
    v.answer = "unknown";
    return v;
  }
  const auto &translational = run.log.column("kinetic_translational"), &rotational = run.log.column("kinetic_rotational");
  double peak = 0;
  for (std::size_t i = 0; i < translational.size(); ++i) peak = std::max(peak, translational[i] + rotational[i]);
  const double last = translational.back() + rotational.back();
  const double part = peak > 0 ? last / peak : 0;
  v.evidence = fmt::format("Kinetic energy at the end is {:.2e} of its peak of {:.4g} J.", part, peak);
  if (!run.scene.settings.stop_at_rest) {
    v.answer = part < kRestKinetic ? "yes" : "no, and the case does not ask for it";
    if (part < kRestKinetic) v.judgement = Judgement::good;
    v.evidence += fmt::format(" At rest means below {:.0e} of the peak.", kRestKinetic);
  } else if (!run.outcome.contains("came_to_rest")) {
    v.answer = "known at the end";
  } else {
    const bool rests = run.outcome["came_to_rest"] == true;
    v.answer = rests ? fmt::format("yes, after {:.4g} s", number_in(run.outcome, "time", 0)) : "no, still moving when its time was up";
    v.judgement = rests ? Judgement::good : Judgement::doubtful;
    v.evidence += " The case asks for it (stop_at_rest): at rest means that for as long as a body takes to fall its own diameter, the bodies "
                  "had less than a millionth of the energy of such a fall.";
    if (!rests) v.evidence += " A longer duration, or rolling friction for what rocks and spins, gives them time.";
  }
  return v;
}

Verdict judge_bodies(const Run& run) {
  Verdict v{"Lost bodies", Judgement::good, "", ""};
  if (!run.is_finished()) {
    v.judgement = Judgement::information;
    v.answer = "known at the end";
    return v;
  }
  const double lost = number_in(run.outcome, "lost_bodies", 0), outside = number_in(run.outcome, "bodies_outside_domain", 0);
  v.answer = lost == 0 && outside == 0 ? "none" : fmt::format("{:.0f} lost, {:.0f} outside the domain", lost, outside);
  if (lost != 0 || outside != 0) v.judgement = Judgement::bad;
  v.evidence = fmt::format("{} bodies in the scene, {:.0f} at the end.", run.scene.bodies.size(),
                           number_in(run.outcome, "bodies", static_cast<double>(run.scene.bodies.size()) - lost));
  if (const double removed = number_in(run.outcome, "removed_bodies", 0); removed > 0) {
    v.evidence += fmt::format(" {:.0f} were taken out as the case asks for, because they left the domain.", removed);
  }
  return v;
}

Verdict judge_step(const Run& run) {
  Verdict v{"Step margin", Judgement::information, "", ""};
  const double step = number_in(run.outcome, "step_size", 0), critical = number_in(run.outcome, "critical_step", 0);
  if (!(step > 0) || !(critical > 0)) {
    v.answer = run.is_finished() ? "no contact to judge by" : "known at the end";
    v.evidence = "The critical step of the contacts stands in run.json of a run that has ended and that had contacts.";
    return v;
  }
  const double ratio = step / critical;
  v.answer = fmt::format("{:.3g} of the critical step", ratio);
  v.judgement = ratio <= kStepGood ? Judgement::good : (ratio <= kStepDoubtful ? Judgement::doubtful : Judgement::bad);
  v.evidence = fmt::format("Step {:.4g} s, smallest critical step of all contacts {:.4g} s. Good up to {}.", step, critical, kStepGood);
  return v;
}

Verdict judge_imbalance(const Run& run) {
  Verdict v{"Balance of the ranks", Judgement::information, "one rank", ""};
  if (!run.is_finished()) {
    v.answer = "known at the end";
    return v;
  }
  const double ranks = number_in(run.outcome, "ranks", 1), imbalance = number_in(run.outcome, "mean_imbalance", 0);
  if (ranks <= 1) {
    v.evidence = "Nothing is shared out.";
    return v;
  }
  v.answer = imbalance > 0 ? fmt::format("{:.2f} on {:.0f} ranks", imbalance, ranks) : "unknown";
  if (imbalance > 0) v.judgement = imbalance <= kImbalanceGood ? Judgement::good : Judgement::doubtful;
  v.evidence = fmt::format("Largest over mean work of the ranks, mean over the run; 1 is perfect, good up to {}. It costs time and changes no result.",
                           kImbalanceGood);
  return v;
}

Verdict judge_files(const Run& run) {
  Verdict v{"Files behind the run", Judgement::good, "", ""};
  const nlohmann::json record = provenance_of(run);
  const std::vector<ChainFile> files = check_files(record, run.folder);
  std::string missing, changed;
  std::size_t same = 0;
  for (const ChainFile& file : files) {
    if (file.state == ChainFile::State::same) ++same;
    if (file.state == ChainFile::State::missing) missing += (missing.empty() ? "" : ", ") + file.file;
    if (file.state == ChainFile::State::changed) changed += (changed.empty() ? "" : ", ") + file.found;
  }
  v.answer = fmt::format("{} of {} as they were", same, files.size());
  v.evidence = "Inputs in the provenance chain, looked for as they are named and beside the run, compared by SHA-256";
  if (files.empty()) {
    v.judgement = Judgement::doubtful;
    v.answer = "no record";
    v.evidence = "The run has no provenance record, or it names no inputs";
  }
  if (!missing.empty()) {
    v.judgement = Judgement::doubtful;
    v.evidence += "; missing, so that the run cannot be repeated from here: " + missing;
  }
  if (!changed.empty()) {
    v.judgement = Judgement::bad;
    v.evidence += "; changed since: " + changed;
  }
  v.evidence += ".";
  return v;
}

Verdict judge_frames(const Run& run) {
  Verdict v{"Frames", Judgement::good, fmt::format("all {} can be read", run.frames.size()), "None was left out."};
  if (run.damaged.empty()) return v;
  v.judgement = Judgement::doubtful;
  v.answer = fmt::format("{} of {} left out", run.damaged.size(), run.damaged.size() + run.frames.size());
  v.evidence = "They cannot be read:";
  for (const std::string& message : run.damaged) v.evidence += " " + message + ";";
  v.evidence.back() = '.';
  return v;
}

Verdict judge_meshes(const Run& run) {
  Verdict v{"Mesh certificates", Judgement::good, "", ""};
  std::set<std::int32_t> used(run.scene.bodies.shape.begin(), run.scene.bodies.shape.end());
  std::size_t solid = 0, analytic = 0;
  std::string unchecked, refused;
  for (std::int32_t k : used) {
    const Shape& shape = run.scene.shapes[static_cast<std::size_t>(k)];
    if (shape.kind == ShapeKind::sphere) {
      ++analytic;
    } else if (!shape.verdict.is_object() || !shape.verdict.contains("solid")) {
      unchecked += (unchecked.empty() ? "" : ", ") + shape.name;
    } else if (shape.verdict.value("solid", false)) {
      ++solid;
    } else {
      refused += (refused.empty() ? "" : ", ") + shape.name;
    }
  }
  v.answer = fmt::format("{} of {} solid", solid + analytic, used.size());
  if (!unchecked.empty()) v.judgement = Judgement::doubtful;
  if (!refused.empty()) v.judgement = Judgement::bad;
  v.evidence = "Closed, oriented, without crossing surfaces, as scree-mesher checked each mesh at import";
  if (analytic > 0) v.evidence += fmt::format("; {} analytic {} no mesh", analytic, analytic == 1 ? "ball has" : "balls have");
  if (!unchecked.empty()) v.evidence += "; without a certificate: " + unchecked;
  if (!refused.empty()) v.evidence += "; not solid: " + refused;
  v.evidence += ".";
  return v;
}

}  // namespace

std::vector<Verdict> judge(const Run& run) {
  return {judge_outcome(run), judge_energy(run), judge_depth(run),     judge_step(run),  judge_bodies(run),
          judge_meshes(run),  judge_rest(run),   judge_imbalance(run), judge_files(run), judge_frames(run)};
}

nlohmann::json provenance_of(const Run& run) {
  return run.outcome.contains("provenance") ? run.outcome["provenance"] : load_frame(run, 0).provenance;
}

const char* name_of(Judgement judgement) {
  switch (judgement) {
    case Judgement::good: return "good";
    case Judgement::doubtful: return "doubtful";
    case Judgement::bad: return "bad";
    case Judgement::information: break;
  }
  return "for information";
}

}  // namespace scree
