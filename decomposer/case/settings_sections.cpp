// The sections of a case that hold its settings. Their keys are in core/storage/scene_keys.cpp, since scene files keep them.
#include <filesystem>
#include <optional>

#include "core/storage/scene_keys.hpp"
#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

void time_section(CaseKeys& k, Settings& s) {
  time_keys(k, s);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  if (s.stop_at_rest && !(length(s.gravity) > 0)) throw t->error("stop_at_rest", "needs gravity: without it rest cannot be told");
  if (t->has("sleep_tolerance") && !s.sleep) throw t->error("sleep_tolerance", "is for sleep = true; add it, or leave sleep_tolerance out");
  if (t->has("step") && t->has("steps_per_contact")) {
    throw t->error("step", "the step is given twice; give either step or steps_per_contact");
  }
}

void domain_section(CaseKeys& k, Domain& d) {
  const CaseTable* t = k.table();
  if (t != nullptr) {
    d.bounded = t->has("min") || t->has("max");
    if (t->has("periodic") && !t->has("min")) throw t->error("periodic", "a periodic axis needs min and max");
  }
  domain_keys(k, d);
  for (int axis = 0; t != nullptr && d.bounded && axis < 3; ++axis) {
    if (!(d.lower[axis] < d.upper[axis])) throw t->error("min", "must be below max in x, y and z");
  }
}

void relax_key(CaseKeys& k, Relax& relax) {
  const CaseTable* t = k.table();
  const bool is_word = t != nullptr && t->is_text("relax");
  if (t != nullptr && t->has("relax") && !is_word && !t->is_boolean("relax")) {
    throw t->error("relax", "expected true, false or \"shallow\"");
  }
  if (k.when(is_word)) {
    k.only_word(
        {"relax", "",
         "bodies of `[[bodies]]` that start pressed into each other or into a wall store energy and would be thrown. `\"shallow\"`: "
         "they are parted before the run starts, the shortest way, until they just touch, where that moves none by more than two of its "
         "margins (a ball: 2 % of its radius); a note reports how far. Otherwise they are refused, with the energy that is stored and the "
         "speed that it is. `true`: "
         "parted however far that is, also from overlaps. `false`: overlaps are refused, and the others start pressed as they are. Both of "
         "a pair move in inverse proportion to their masses, fixed ones stay; in a crowd, gaps become up to a tenth wider than requested. "
         "Packings and what comes from a run are left as they are"},
        "shallow");
  }
  if (k.when(!is_word)) {
    bool all = false;
    k.boolean({"relax"}, all);
    if (t != nullptr && t->has("relax")) relax = all ? Relax::all : Relax::none;
  }
}

void contact_section(CaseKeys& k, Case& c) {
  Settings& s = c.settings;
  contact_keys(k, s);
  relax_key(k, c.relax);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  c.margin_given = t->has("margin") || t->has("margin_ratio");
  c.surface_given = t->has("surface");
  if (t->has("margin") && t->has("margin_ratio")) throw t->error("margin_ratio", "says the same as margin; give one of them");
  if (t->has("margin_ratio") && s.surface == TouchAt::outside)
    throw t->error("margin_ratio", "goes with surface = \"drawn\"; with \"outside\" all bodies have one margin");
  if (s.barrier > 0 && s.gather != Gathering::potential) throw t->error("barrier", "goes with gather = \"potential\" only");
  if (s.on_overlap == OnOverlap::proceed) {
    if (s.gather != Gathering::potential) throw t->error("on_overlap", "\"continue\" goes with gather = \"potential\" only");
    if (s.barrier > 0)
      throw t->error("on_overlap", "\"continue\" does not go with a barrier, which lets no surfaces meet; leave out one of both");
    c.no_wall_moves = t->error("on_overlap",
                               "\"continue\" is for what a wall that moves presses on, and no wall of this case moves; a contact "
                               "that is too soft needs a larger stiffness. Leave on_overlap out");
  }
  if (t->has("weights") && s.gather != Gathering::potential) throw t->error("weights", "goes with gather = \"potential\" only");
  if (s.gather == Gathering::area && s.law == ContactLaw::hertz_mindlin)
    throw t->error("gather", "\"area\" has a law of its own; use it with law = \"linear\" or \"hunt-crossley\"");
  if (s.gather == Gathering::area && !c.margin_given)
    throw t->error("gather", "\"area\" needs contact.margin, the thickness of the elastic layer");
}

/// Returns where it is, for what it does not go with, which is known later.
std::string cell_section(CaseKeys& k, CellControl& cell) {
  k.section({"strain_rate", "none"}, [&](CaseKeys& below) {
    for (std::size_t c = 0; c < 6; ++c) {
      constexpr const char* kLength = "of the length along this axis, `-(dh/dt) / h`: positive as it becomes shorter; or a table";
      constexpr const char* kShear =
          "of a shear, `-L` with L the change of the velocity along the first axis over the way along the second: positive where the upper "
          "side moves backwards, as a positive shear stress asks for; or a table";
      over_time_key(below, {kUpperNames[c], "0", c < 3 ? kLength : kShear}, "of the run, ascending", "rate", "rates",
                    Dimension::strain_rate, Range::any, cell.strain_rate[c]);
    }
  });
  k.section({"stress", "none"}, [&](CaseKeys& below) {
    constexpr const char* kNormal = "normal stress across this axis, positive in compression";
    constexpr const char* kShear = "shear stress, of either sign, that of the strain rate which it brings about; 0: the shear moves freely";
    for (int c = 0; c < 6; ++c) {
      const char* name = kUpperNames[static_cast<std::size_t>(c)];
      below.number({name, "none", c < 3 ? kNormal : kShear}, cell.stress[c], Dimension::pressure, c < 3 ? Range::positive : Range::any);
      if (below.table() == nullptr) continue;
      cell.is_stress_asked[static_cast<std::size_t>(c)] = below.table()->has(name);
      if (cell.by_stress(c) && cell.by_rate(c)) throw below.table()->error(name, "has a strain_rate as well; an axis follows one of both");
    }
  });
  k.section({"stop_when", "the run ends at `time.duration`"}, [&](CaseKeys& below) {
    cell_stop_keys(below, cell);
    if (below.table() != nullptr && cell.stop_stress_error > 0 && !cell.any_by_stress())
      throw below.table()->error("stress_error", "no axis has a target; give one in cell.stress, or leave stress_error out");
    if (below.table() != nullptr && cell.stop_stress_error > 0 && cell.stress.diagonal == Vec3{} && cell.stress.above == Vec3{})
      throw below.table()->error(
          "stress_error", "is a share of the largest target in cell.stress, and all are 0; give another target, or leave stress_error out");
  });
  return k.table() == nullptr ? std::string() : k.table()->where();
}

}  // namespace

void settings_sections(CaseKeys& k, Case& c) {
  Settings& s = c.settings;
  s.title = std::filesystem::path(c.path).stem().string();
  s.gravity = {0, 0, -9.81};
  run_keys(k, s);
  std::optional<UsageError> cannot_empty;  // known after the domain
  k.section({"time", kRequired}, [&](CaseKeys& below) {
    time_section(below, s);
    if (s.stop_when_empty && below.table() != nullptr) {
      cannot_empty = below.table()->error(
          "stop_when_empty", "no body can leave; give [domain] with min, max and outside = \"remove\", or leave stop_when_empty out");
    }
  });
  k.section({"domain", "unbounded"}, [&](CaseKeys& below) { domain_section(below, s.domain); });
  if (cannot_empty && !(s.domain.bounded && s.domain.outside == Outside::remove)) throw *cannot_empty;
  k.section({"fluid", "bodies move in a void, at no cost"}, [&](CaseKeys& below) {
    fluid_keys(below, s.fluid.emplace());
    if (below.table() != nullptr && s.sleep && length(s.fluid->velocity) > 0) {
      throw below.table()->error(
          "velocity", "does not go with time.sleep: a body asleep would not feel the stream; use a fluid at rest, or leave sleep out");
    }
  });
  k.section({"heat", "bodies have no temperature, at no cost"}, [&](CaseKeys& below) { heat_keys(below, s.heat.emplace()); });
  std::string where_cell;
  k.section({"cell", "the domain stays as it is, at no cost"},
            [&](CaseKeys& below) { where_cell = cell_section(below, s.cell.emplace()); });
  k.section({"contact"}, [&](CaseKeys& below) { contact_section(below, c); });
  k.section({"motion"}, [&](CaseKeys& below) { motion_keys(below, s); });
  s.output_every = s.duration / 100;
  k.section({"output"}, [&](CaseKeys& below) {
    output_keys(below, s);
    if (below.table() != nullptr && s.sleep && s.output_impacts)
      throw below.table()->error(
          "impacts", "does not go with time.sleep, since losses of contacts that sleep are not recorded; leave out one of both");
    if (below.table() != nullptr) s.checkpoint_by_clock = !below.table()->has("checkpoint");  // 0 asks for none but the last
  });
  if (where_cell.empty()) return;
  if (const CellBlocker blocker = cell_blocker(s); blocker.key != nullptr)
    throw UsageError("{}: does not go with {}: {}", where_cell, blocker.key, blocker.why);
}

}  // namespace scree
