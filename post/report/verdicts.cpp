#include "post/report/verdicts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>

#include "core/base/units.hpp"
#include "post/report/drive_verdict.hpp"
#include "post/report/inlet_verdict.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/provenance_chain.hpp"

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

std::string percent(double part) {
  return part > 0 && part < 1e-4 ? fmt::format("{:.1e} %", 100 * part) : fmt::format("{:.3g} %", 100 * part);
}

Verdict judge_outcome(const Run& run) {
  Verdict v{"Outcome", Judgement::good, "", ""};
  if (!run.is_finished()) {
    v.judgement = Judgement::doubtful;
    v.answer = "not finished";
    v.evidence = "There is no run.json: the run is still being written, or was killed. This page shows the complete frames so far.";
    return v;
  }
  const std::string outcome = run.outcome->value("outcome", "?"), message = run.outcome->value("message", "");
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
  const EnergyBalance e = energy_balance(run);
  const double relative = relative_energy_error(e.lasting, e.in_play, run.scene);
  const double largest = relative_energy_error(e.largest, e.in_play, run.scene);
  v.answer = "closed to " + percent(relative);
  v.judgement = relative <= kEnergyGood ? Judgement::good : (relative <= kEnergyDoubtful ? Judgement::doubtful : Judgement::bad);
  v.evidence = fmt::format(
      "Lasting error of kinetic + potential + elastic + dissipated - wall work{} in the log, {:.3g} J, over the largest energy in play, "
      "{:.3g} J. The largest error of all rows is {} of it (error_relative of run.json){}. Dissipation is summed from the contact forces. "
      "Good "
      "up to {}.",
      run.has_program() ? " - work of outer forces + energy of removed bodies - energy of inserted bodies" : "", e.lasting,
      std::max(e.in_play.largest(), still_fall_energy(run.scene)), percent(largest),
      largest > std::max(kEnergyGood, relative) ? ", during contacts, and vanished when they ended; more steps per contact reduce it" : "",
      percent(kEnergyGood));
  return v;
}

/// Contacts that the run went on with beyond their maximum overlap; of a run that is not finished, from its log.
std::optional<Verdict> judge_deep_contacts(const Run& run) {
  const nlohmann::json record = run.outcome->contains("deep_contacts") ? (*run.outcome)["deep_contacts"] : nlohmann::json::object();
  const double steps = std::max(number_in(record, "contact_steps", 0), largest(run.log, "deep_contact_steps"));
  if (!(steps > 0)) return std::nullopt;
  const double excess = std::max(number_in(record.contains("deepest") ? record["deepest"] : nlohmann::json(), "excess", 0),
                                 largest(run.log, "deepest_excess"));
  Verdict v{"Contact overlap", Judgement::doubtful, "", ""};
  v.answer = fmt::format("deeper than the law has room for, by {} at most", format_quantity(excess, Dimension::length));
  v.evidence = record.contains("text") ? record["text"].get<std::string>() + "." : fmt::format("{:.0f} contact-steps so far.", steps);
  v.evidence +=
      " Up to that depth the case has this run go on (contact.on_overlap) where a wall leaves bodies no place: the force there grows along "
      "the tangent of the law. A wider gap, or a wall that a torque or a force moves, leaves none of it.";
  return v;
}

/// Largest overlap over its maximum of contacts that have no mesh, in some frames; nothing where frames keep no contacts.
std::optional<double> largest_of_balls(const Run& run) {
  constexpr std::size_t kFrames = 40;  // evenly, with the last
  const Scene& scene = run.scene;
  if (!scene.settings.output_contacts || run.frames.empty()) return std::nullopt;
  std::set<std::int64_t> with_mesh;
  for (const Wall& wall : scene.walls) {
    if (wall.kind == WallKind::mesh) with_mesh.insert(wall.id);
  }
  double found = 0;
  const std::size_t every = run.frames.size() / kFrames + 1;
  for (std::size_t back = 0; back < run.frames.size(); back += every) {
    const Frame frame = load_frame(run, run.frames.size() - 1 - back);
    std::set<std::int64_t> meshes = with_mesh;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      if (scene.shapes[static_cast<std::size_t>(frame.bodies.shape[i])].kind != ShapeKind::sphere) meshes.insert(frame.bodies.id[i]);
    }
    const FrameContacts& c = frame.contacts;
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (c.margin[i] > 0 && !meshes.contains(c.body_a[i]) && !meshes.contains(c.body_b[i]))
        found = std::max(found, c.overlap[i] / c.margin[i]);
    }
  }
  return found;
}

Verdict judge_depth(const Run& run) {
  if (const std::optional<Verdict> deep = judge_deep_contacts(run)) return *deep;
  Verdict v{"Contact overlap", Judgement::information, "", ""};
  const double ratio = std::max(largest(run.log, "max_depth_ratio"), number_in(run.outcome, "max_depth_ratio", 0));
  if (run.scene.settings.margin <= 0) {
    if (!(ratio > 0)) {
      v.answer = "no contact";
      return v;
    }
    v.answer = fmt::format("at most {:.3f} of the radius", ratio);
    v.judgement = ratio < kBallsDoubtful ? Judgement::good : (ratio < kBallsBad ? Judgement::doubtful : Judgement::bad);
    v.evidence = fmt::format(
        "Overlap over the radius of the smaller ball, the largest of all contacts and steps. Laws of contact are those of small overlaps: "
        "up to "
        "{:g} of the radius, balls still pack and flow like rigid ones; near {:g} they have become another material. A larger stiffness, "
        "or "
        "slower motion, brings it down.",
        kBallsDoubtful, kBallsBad);
    return v;
  }
  if (run.scene.balls_touch_beside_meshes()) {
    const std::optional<double> of_balls = ratio < kBallsDoubtful ? std::nullopt : largest_of_balls(run);
    const double doubtful = of_balls && *of_balls < kBallsDoubtful ? kOverlapDoubtful : kBallsDoubtful;
    v.answer = fmt::format("at most {:.3f} of its maximum{}", ratio,
                           of_balls ? fmt::format("; of balls {:.3f} in the frames", *of_balls) : std::string());
    v.judgement = ratio < doubtful ? Judgement::good : (ratio < 1 ? Judgement::doubtful : Judgement::bad);
    v.evidence = fmt::format(
        "Overlap over its maximum, the largest of all contacts and steps. The maximum is the sum of both margins where there are meshes, "
        "of which {:g} are usual, and the radius of the smaller ball of two balls, or of a ball on a wall, of which {:g} are much. "
        "The columns depth and margin of the contacts in the frames say which contacts are deep.",
        kOverlapDoubtful, kBallsDoubtful);
    return v;
  }
  v.answer = fmt::format("at most {:.3f} of the margin", ratio);
  v.judgement = ratio < kOverlapDoubtful ? Judgement::good : (ratio < 1 ? Judgement::doubtful : Judgement::bad);
  v.evidence =
      "Overlap over the sum of both margins, the largest of all contacts and steps. Below 1 no two surfaces ever touched; "
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
  if (run.log.has("asleep")) {
    const std::vector<double>& asleep = run.log.column("asleep");
    const double mean = std::accumulate(asleep.begin(), asleep.end(), 0.0) / static_cast<double>(asleep.size());
    v.evidence += fmt::format(" {:.0f} bodies sleep at the end, {:.4g} on average over the rows of the log", asleep.back(), mean);
    const auto bodies = static_cast<double>(run.scene.bodies.size());
    v.evidence +=
        !run.lets_in() && bodies > 0 ? fmt::format(" ({:.0f} and {:.0f} %).", 100 * asleep.back() / bodies, 100 * mean / bodies) : ".";
  }
  if (run.outcome->contains("no_body_left")) {
    v.answer = "no body is left";
  } else if (!run.scene.settings.stop_at_rest) {
    v.answer = part < kRestKinetic ? "yes" : "no; the case does not require it";
    if (part < kRestKinetic) v.judgement = Judgement::good;
    v.evidence += fmt::format(" At rest means below {:.0e} of the peak.", kRestKinetic);
  } else if (!run.outcome->contains("came_to_rest")) {
    v.answer = "known at the end";
  } else {
    const bool rests = (*run.outcome)["came_to_rest"] == true;
    v.answer =
        rests ? fmt::format("yes, after {:.4g} s", number_in(run.outcome, "time", 0)) : "no, still moving at the end of the duration";
    v.judgement = rests ? Judgement::good : Judgement::doubtful;
    v.evidence +=
        " The case requires it (stop_at_rest): at rest means that for the time in which a body falls its own diameter, the kinetic energy "
        "of the bodies stays below a millionth of the energy of such a fall.";
    if (!rests) v.evidence += " A longer duration helps, or rolling friction for bodies that rock or spin.";
  }
  return v;
}

/// Bodies in the last frame that lie below everything that could hold them: no wall and no fixed body reaches as low.
/// None without gravity, without walls, or where a plane that faces upward holds all.
std::size_t bodies_below_all(const Run& run) {
  const Scene& scene = run.scene;
  if (!(squared_length(scene.settings.gravity) > 0)) return 0;
  const Vec3 down = normalised(scene.settings.gravity);
  const Frame last = load_frame(run, run.frames.size() - 1);
  double deepest = -std::numeric_limits<double>::infinity();
  const std::vector<WallPlace> places = wall_places(last, scene);
  const auto reach = [&](const TriangleMesh& mesh, double scale, const Vec3& position, const Quat& orientation) {
    for (const Vec3& p : mesh.vertices) deepest = std::max(deepest, dot(down, position + rotate(orientation, scale * p)));
  };
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    if (wall.kind == WallKind::plane && dot(wall.normal, down) < 0) return 0;
    // box, cylinder and sphere hold what is inside them, and nothing is beyond
    if (wall.kind == WallKind::box_inside || wall.kind == WallKind::cylinder_inside || wall.kind == WallKind::sphere_inside) return 0;
    if (wall.kind == WallKind::mesh)
      reach(scene.shapes[static_cast<std::size_t>(wall.shape)].mesh, wall.scale, places[w].position, places[w].orientation);
  }
  const FrameBodies& b = last.bodies;
  std::set<std::int64_t> fixed;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] != 0) fixed.insert(scene.bodies.id[i]);
  }
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Shape& shape = scene.shapes[static_cast<std::size_t>(b.shape[i])];
    if (fixed.contains(b.id[i])) deepest = std::max(deepest, dot(down, b.position[i]) + b.scale[i] * shape.bounding_radius());
  }
  if (!std::isfinite(deepest)) return 0;
  std::size_t below = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double radius = b.scale[i] * scene.shapes[static_cast<std::size_t>(b.shape[i])].bounding_radius();
    if (!fixed.contains(b.id[i]) && dot(down, b.position[i]) - radius > deepest && dot(down, b.velocity[i]) > 0) ++below;
  }
  return below;
}

Verdict judge_bodies(const Run& run) {
  Verdict v{"Lost bodies", Judgement::good, "", ""};
  const std::size_t below = bodies_below_all(run);
  if (!run.is_finished()) {
    v.judgement = Judgement::information;
    v.answer = "known at the end";
    return v;
  }
  const double lost = number_in(run.outcome, "lost_bodies", 0), outside = number_in(run.outcome, "bodies_outside_domain", 0);
  const double removed = number_in(run.outcome, "removed_bodies", 0);
  v.answer = lost == 0 && outside == 0 ? "none" : fmt::format("{:.0f} lost, {:.0f} outside the domain", lost, outside);
  const double inserted = number_in(run.outcome, "inserted_bodies", 0), all = static_cast<double>(run.scene.bodies.size()) + inserted;
  v.evidence = fmt::format("{} bodies in the scene, {}{:.0f} at the end.", run.scene.bodies.size(),
                           inserted > 0 ? fmt::format("{:.0f} came in, ", inserted) : "",
                           number_in(run.outcome, "bodies", static_cast<double>(run.scene.bodies.size()) - lost));
  if (removed > 0) {
    v.answer += fmt::format(", {:.0f} of {:.0f} removed", removed, all);
    const bool by_domain = run.scene.settings.domain.outside == Outside::remove, by_outlets = !run.scene.outlets.empty();
    const bool by_case = by_domain || by_outlets;
    v.evidence += fmt::format(" {:.0f} were removed", removed);
    if (by_case)
      v.evidence += by_outlets ? " as the case requires, by outlets or because they left the domain"
                               : " as the case requires, because they left the domain";
    if (run.has_program()) v.evidence += by_case ? ", or by the program that stepped the run" : " by the program that stepped the run";
    v.evidence += ".";
  }
  if (below > 0) {
    v.answer = (v.answer == "none" ? std::string() : v.answer + ", ") + fmt::format("{} of {:.0f} fall below all walls", below, all);
    v.judgement = Judgement::doubtful;
    v.evidence +=
        " Bodies below all walls have no further contacts: check the walls for openings, or give a domain with outside = \"remove\" "
        "where bodies are "
        "meant to leave.";
  }
  if (lost != 0 || outside != 0) v.judgement = Judgement::bad;
  return v;
}

Verdict judge_step(const Run& run) {
  Verdict v{"Step margin", Judgement::information, "", ""};
  const double step = number_in(run.outcome, "step_size", 0), critical = number_in(run.outcome, "critical_step", 0);
  if (!(step > 0) || !(critical > 0)) {
    v.answer = run.is_finished() ? "no contact to judge by" : "known at the end";
    v.evidence = "The critical step of the contacts is in run.json after the end of a run that had contacts.";
    return v;
  }
  const double ratio = step / critical, given = run.scene.settings.step, steps = run.scene.settings.steps_per_contact;
  v.answer = fmt::format("{:.3g} of the critical step", ratio);
  v.judgement = ratio <= kStepGood ? Judgement::good : (ratio <= kStepDoubtful ? Judgement::doubtful : Judgement::bad);
  v.evidence = fmt::format(
      "Step {:.4g} s, smallest critical step of all contacts at once {:.4g} s, a lower bound. While contacts last, the energy of their "
      "fastest "
      "motion errs by up to {}, and by nothing when they end; see the energy balance for their sum. Good up to {}.",
      step, critical, ratio < 1 ? percent(ratio * ratio / 4) : "more than a quarter", kStepGood);
  if (!(given > 0)) {
    v.evidence +=
        fmt::format(" An impact takes {:.3g} steps or more: its restitution errs by up to {:.1g}.", steps, restitution_error(steps));
    if (steps < kContactStepsGood) v.judgement = std::max(v.judgement, Judgement::doubtful);
  }
  if (v.judgement != Judgement::good) {
    const double more = std::max(std::ceil(steps * ratio / kStepGood), kContactStepsGood);
    v.evidence += given > 0 ? fmt::format(" For a good verdict give time.step = {:.2g} s, or leave it out.", critical * kStepGood)
                            : fmt::format(" For a good verdict give time.steps_per_contact = {:.0f}.", more);
  }
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
  v.evidence = fmt::format(
      "Largest over mean work of the ranks, mean over the run; 1 is perfect, good up to {}. It costs time and changes no result.",
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
    v.evidence = "The run has no provenance record, or it lists no inputs";
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
  for (const Inlet& inlet : run.scene.inlets) {
    for (const Inlet::Share& share : inlet.shares) used.insert(share.shape);
  }
  std::size_t solid = 0, analytic = 0;
  std::string unchecked, refused, crossed;
  for (std::int32_t k : used) {
    const Shape& shape = run.scene.shapes[static_cast<std::size_t>(k)];
    if (shape.kind == ShapeKind::sphere) {
      ++analytic;
    } else if (!shape.verdict->is_object() || !shape.verdict->contains("solid")) {
      unchecked += (unchecked.empty() ? "" : ", ") + shape.name;
    } else if (shape.verdict->value("solid", false)) {
      ++solid;
      if (const std::int64_t pairs = crossing_pairs(shape); pairs > 0)
        crossed += fmt::format("{}{} ({} {})", crossed.empty() ? "" : ", ", shape.name, pairs, pairs == 1 ? "pair" : "pairs");
    } else {
      refused += (refused.empty() ? "" : ", ") + shape.name;
    }
  }
  v.answer = fmt::format("{} of {} solid", solid + analytic, used.size());
  if (!unchecked.empty() || !crossed.empty()) v.judgement = Judgement::doubtful;
  if (!refused.empty()) v.judgement = Judgement::bad;
  v.evidence = fmt::format("Closed, oriented{}, as scree-mesher checked each mesh at import",
                           crossed.empty() && unchecked.empty() && refused.empty() ? ", without crossing surfaces" : "");
  if (!crossed.empty()) {
    v.answer += ", with triangles that cross";
    v.evidence += "; triangles pass through or touch each other, and volume counts twice where the surface is folded over: " + crossed +
                  "; scree-mesher repair cuts such places out";
  }
  if (analytic > 0) v.evidence += fmt::format("; {} analytic {} no mesh", analytic, analytic == 1 ? "ball has" : "balls have");
  if (!unchecked.empty()) v.evidence += "; without a certificate: " + unchecked;
  if (!refused.empty()) v.evidence += "; not solid: " + refused;
  v.evidence += ".";
  return v;
}

}  // namespace

double restitution_error(double steps) {
  static constexpr std::array<std::pair<double, double>, 8> kMeasured{
      {{4, .31}, {5, .1}, {6, .05}, {8, .023}, {12, .012}, {20, .006}, {30, .003}, {100, 7e-4}}};
  if (steps < kMeasured.front().first) return 1;
  for (std::size_t i = 1; i < kMeasured.size(); ++i) {
    const auto [left, high] = kMeasured[i - 1];
    const auto [right, low] = kMeasured[i];
    if (steps <= right) return high * std::pow(low / high, std::log(steps / left) / std::log(right / left));
  }
  return kMeasured.back().second;  // an upper bound of what still falls
}

std::int64_t crossing_pairs(const Shape& shape) {
  return shape.verdict->is_object() ? static_cast<std::int64_t>(number_in(shape.verdict, "self_intersections", 0)) : 0;
}

EnergyBalance energy_balance(const Run& run) {
  EnergyBalance balance;
  const LogTable& log = run.log;
  if (log.rows() == 0) return balance;
  const auto at = [&log](const char* name, std::size_t row) {
    return log.has(name) && std::isfinite(log.column(name)[row]) ? log.column(name)[row] : 0.0;
  };
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const double elastic = at("elastic", i) + at("elastic_tangential", i), error = std::abs(at("energy_error", i));
    balance.in_play.add_row(at("kinetic_translational", i) + at("kinetic_rotational", i), at("elastic", i), at("elastic_tangential", i),
                            at("bond", i));
    balance.largest = std::max(balance.largest, error);
    balance.lasting = std::max(balance.lasting, i + 1 == log.rows() ? error : error - kContactError * elastic);
  }
  const std::size_t last = log.rows() - 1;
  balance.in_play.dissipated = at("dissipated", last);
  balance.in_play.wall_work = at("wall_work", last);
  balance.in_play.outer_work = at("outer_work", last);
  balance.in_play.cell_work = at("cell_work", last);
  return balance;
}

std::vector<Verdict> judge(const Run& run) {
  std::vector<Verdict> all{judge_outcome(run), judge_energy(run), judge_depth(run),     judge_step(run),  judge_bodies(run),
                           judge_meshes(run),  judge_rest(run),   judge_imbalance(run), judge_files(run), judge_frames(run)};
  const std::vector<Wall>& walls = run.scene.walls;
  if (std::any_of(walls.begin(), walls.end(), [](const Wall& wall) { return wall.motion.drive().has_value(); }))
    all.insert(all.begin() + 4, judge_drives(run));
  if (!run.scene.inlets.empty()) all.insert(all.begin() + 4, judge_inlets(run));
  return all;
}

nlohmann::json provenance_of(const Run& run) {
  return run.outcome->contains("provenance") ? nlohmann::json((*run.outcome)["provenance"])
                                             : nlohmann::json(*load_frame(run, 0).provenance);
}

const char* name_of(Judgement judgement) {
  switch (judgement) {
    case Judgement::good:
      return "good";
    case Judgement::doubtful:
      return "doubtful";
    case Judgement::bad:
      return "bad";
    case Judgement::information:
      break;
  }
  return "for information";
}

}  // namespace scree
