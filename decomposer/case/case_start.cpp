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
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  s.where = t->where();
  if (t->has("checkpoint") && t->has("frame")) throw t->error("frame", "give either checkpoint or frame, not both");
  const std::vector<std::string> names = names_of_materials(c);
  for (const auto& material : s.materials) t->find_name("materials", material.second, names, "material");
  c.start = std::move(s);
}

}  // namespace scree
