// [start]: bodies that come from a run. What is in that run, packing/from_run.cpp finds.
#include "decomposer/case/case_sections.hpp"

namespace scree {

void start_section(CaseKeys& k, Case& c) {
  CaseStart s;
  k.path({"run", kRequired,
          "folder of a run: this case begins with its bodies, their velocities, ids and shapes, and the history of their contacts. "
          "Populations, bodies and walls of this case are added to them"},
         s.run);
  k.integer({"checkpoint", "the last", "step of the checkpoint to read, the number in its name"}, s.checkpoint, 0);
  k.integer({"frame", "none", "number of a frame to read instead of a checkpoint: contacts start without springs"}, s.frame, 0);
  k.named_texts({"materials", "as in the run", "`{ NAME IN THE RUN = \"NAME HERE\", ... }`: materials that have another name here"},
                s.materials);
  k.boolean({"continue", "false",
             "`true`: this case goes on where the run ended. Its bodies and populations are those of the run and are not placed again, "
             "walls of the same name stand where they stood, and motions go on"},
            s.goes_on);
  k.section({"leave_out", "none", "bodies whose centres lie in this region stay behind, with what their contacts remember"},
            [&](CaseKeys& below) { region_section(below, c, s.leave_out.emplace()); });
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  s.where = t->where();
  if (t->has("checkpoint") && t->has("frame")) throw t->error("frame", "give either checkpoint or frame, not both");
  if (s.goes_on && t->has("frame"))
    throw t->error("frame", "a frame holds no springs and no ways of walls: continue goes on from a checkpoint");
  if (!t->has("leave_out")) s.leave_out.reset();
  const std::vector<std::string> names = names_of_materials(c);
  for (const auto& material : s.materials) t->find_name("materials", material.second, names, "material");
  c.start = std::move(s);
}

}  // namespace scree
