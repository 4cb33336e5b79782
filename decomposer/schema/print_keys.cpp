// Prints the keys of the case language as JSON, for make_schema.py.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "decomposer/case/case_file.hpp"
#include "decomposer/case/case_sections.hpp"

namespace {

const char* range_name(scree::Range range) {
  using scree::Range;
  switch (range) {
    case Range::any:
      return "any";
    case Range::positive:
      return "positive";
    case Range::not_negative:
      return "not_negative";
    case Range::unit_interval:
      return "unit_interval";
    case Range::fraction:
      return "fraction";
  }
  return "";
}

}  // namespace

int main() {
  return scree::run_main("print_keys", [&] {
    nlohmann::json all = nlohmann::json::array();
    for (const scree::KeyDescription& d : scree::describe_case()) {
      const std::string unit = d.dimension == scree::Dimension::none ? "" : scree::dimension_name(d.dimension);
      all.push_back({{"table", d.table},
                     {"key", d.key},
                     {"type", d.type},
                     {"dimension", unit},
                     {"range", range_name(d.range)},
                     {"words", d.words},
                     {"default", d.otherwise},
                     {"meaning", d.meaning}});
    }
    fmt::print("{}\n", all.dump());
    return 0;
  });
}
