// Prints what the reader of a case asks of its tables, as JSON: print_reads CASE.toml...
// make_schema.py makes the schema of the case language of it.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/error.hpp"
#include "decomposer/case/case_file.hpp"

namespace {

const char* kind_name(scree::CaseRead::Kind kind) {
  using Kind = scree::CaseRead::Kind;
  switch (kind) {
    case Kind::allowed:
      return "allowed";
    case Kind::number:
      return "number";
    case Kind::integer:
      return "integer";
    case Kind::boolean:
      return "boolean";
    case Kind::text:
      return "text";
    case Kind::word:
      return "word";
    case Kind::vector:
      return "vector";
    case Kind::numbers:
      return "numbers";
    case Kind::vectors:
      return "vectors";
    case Kind::texts:
      return "texts";
    case Kind::corners:
      return "corners";
    case Kind::table:
      return "table";
    case Kind::tables:
      return "tables";
    case Kind::named_tables:
      return "named_tables";
    case Kind::named_numbers:
      return "named_numbers";
  }
  return "";
}

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

int main(int argc, char** argv) {
  return scree::run_main("print_reads", [&] {
    nlohmann::json all = nlohmann::json::array();
    for (int i = 1; i < argc; ++i) {
      std::ifstream stream(argv[i]);
      if (!stream) throw scree::InputError("{}: cannot be read", argv[i]);
      std::ostringstream text;
      text << stream.rdbuf();
      scree::CaseReads reads;
      scree::parse_case(text.str(), argv[i], std::filesystem::path(argv[i]).parent_path().string(), {}, &reads);
      for (const scree::CaseRead& r : reads) {
        const std::string unit = r.dimension == scree::Dimension::none ? "" : scree::dimension_name(r.dimension);
        all.push_back({{"table", r.table},
                       {"key", r.key},
                       {"kind", kind_name(r.kind)},
                       {"dimension", unit},
                       {"range", range_name(r.range)},
                       {"words", r.words}});
      }
    }
    fmt::print("{}\n", all.dump());
    return 0;
  });
}
