// The sections of the report that say what was run: verdicts, case, provenance, commands. HTML.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "post/report/verdicts.hpp"
#include "post/run/provenance_chain.hpp"
#include "post/run/run_folder.hpp"

namespace scree {

std::string verdict_section(const std::vector<Verdict>& verdicts);
std::string case_section(const Run& run);
/// in   record   the provenance of a frame     in   files   what it names, as they are found now
std::string provenance_section(const nlohmann::json& record, const std::vector<ChainFile>& files);
/// The commands that make the run again.
std::string repeat_section(const Run& run, const nlohmann::json& record);

}  // namespace scree
