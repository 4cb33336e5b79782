// scree-bench-distance: error and time of the triangle distance methods.
//   1 read the options   2 make or read the pairs   3 measure the peak   4 run each method   5 write
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "tests/benchmarks/distance/published_methods.hpp"
#include "tests/benchmarks/distance/regimes.hpp"
#include "tests/benchmarks/distance/study.hpp"

namespace {

constexpr const char* kTool = "scree-bench-distance";

/// 18 little-endian doubles a pair.
std::vector<scree::Pair18> read_pairs(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw scree::SystemError("{}: cannot be read", path);
  const auto bytes = static_cast<std::size_t>(file.tellg());
  if (bytes == 0 || bytes % sizeof(scree::Pair18) != 0)
    throw scree::InputError("{}: {} bytes; expected a multiple of 144 (18 doubles a pair: A0 A1 A2 B0 B1 B2)", path, bytes);
  std::vector<scree::Pair18> pairs(bytes / sizeof(scree::Pair18));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(pairs.data()), static_cast<std::streamsize>(bytes));
  if (!file) throw scree::SystemError("{}: could not be read to its end", path);
  return pairs;
}

int run(int argc, char** argv) {
  // 1 options
  std::string pairs_file, answers_file, csv_file, simd = "best";
  std::vector<std::string> methods, precisions = {"double", "single"}, regimes;
  std::size_t count = 2048, checked = 2048;
  double seconds = 0.05;
  const auto app = scree::make_command_line(
      kTool, "Measures error and time of the triangle distance methods, of Scree and as published, on one core.",
      {{"scree-bench-distance", "all methods over all regimes"},
       {"scree-bench-distance --method brute-force --simd avx2 --csv out.csv", "one method at 256 bits"},
       {"scree-bench-distance --pairs p.bin --method hybrid --precision double --answers a.bin", "your own pairs"}},
      "");
  app->add_option("--pairs", pairs_file, "File of pairs: 18 little-endian doubles each (A0 A1 A2 B0 B1 B2)")->type_name("FILE");
  app->add_option("--regime", regimes, "Generated regimes (default: all)")->type_name("NAME");
  app->add_option("--count", count, "Pairs a regime")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--method", methods,
                  "brute-force, brute-force-distance, penalty, hybrid, pen4, pen7, pen4-hybrid, pen7-hybrid, brute-force-indexed (single)")
      ->type_name("M");
  app->add_option("--precision", precisions, "double, single")->check(CLI::IsMember({"double", "single"}))->capture_default_str();
  app->add_option("--simd", simd, "best, avx512, avx2, sse4, scalar")->capture_default_str();
  app->add_option("--seconds", seconds, "Time each method and set for this long")->capture_default_str();
  app->add_option("--check", checked, "Compare this many pairs of a set with exact arithmetic")->capture_default_str();
  app->add_option("--csv", csv_file, "Write the table here")->type_name("OUT");
  app->add_option("--answers", answers_file, "Write the answers, 64 bytes a pair (one set, method and precision)")->type_name("FILE");
  if (!scree::parse_command_line(*app, argc, argv)) return 0;
  scree::limit_simd(simd);
  const bool all_methods = methods.empty();
  if (all_methods) methods = scree::study_methods();
  if (regimes.empty()) regimes = scree::regime_names();
  if (!answers_file.empty() && (methods.size() != 1 || precisions.size() != 1 || (pairs_file.empty() && regimes.size() != 1)))
    throw scree::UsageError("--answers: needs one --method, one --precision and one set of pairs (--pairs or one --regime)");

  // 2 pairs
  std::vector<std::pair<std::string, std::vector<scree::Pair18>>> sets;
  if (!pairs_file.empty()) {
    sets.emplace_back(std::filesystem::path(pairs_file).filename().string(), read_pairs(pairs_file));
  } else {
    for (const std::string& name : regimes) sets.emplace_back(name, scree::make_regime(name, count, 1));
  }

  // 3 what the core can do
  std::string csv =
      "case,method,precision,simd,pairs,ns_per_pair,million_pairs_per_s,fma_peak_gflops,error_median,error_p99,error_max,"
      "wrong_flags,uncertified,fell_back,not_a_number,commit,compiler,share_of_fma_peak\n";
  const std::array<double, 2> peak = {scree::measured_fma_peak(false), scree::measured_fma_peak(true)};
  fmt::print("{}: measured FMA peak of one core: {:.1f} GFLOP/s double, {:.1f} single\n", scree::simd_target(), peak[0], peak[1]);
  fmt::print("{:<15}{:<22}{:<8}{:>8}{:>9}{:>10}{:>10}{:>10}{:>8}{:>8}{:>8}{:>8}\n", "case", "method", "real", "ns/pair", "M/s", "median",
             "p99", "max error", "flags%", "uncert%", "fell%", "peak%");

  // 4 run, 5 write
  std::vector<scree::AnswerRecord> answers;
  for (const auto& [name, pairs] : sets)
    for (const std::string& precision : precisions) {
      const bool single = precision == "single";
      const scree::StudyCase study = scree::make_study_case(name, pairs, single, checked);
      for (const std::string& method : methods) {
        if (all_methods && !scree::has_precision(method, single)) continue;
        const scree::StudyRow row = scree::run_study(study, method, seconds, answers_file.empty() ? nullptr : &answers);
        const double share = scree::operations_of(method, single) / row.nanoseconds / peak[single ? 1 : 0];
        fmt::print("{:<15}{:<22}{:<8}{:>8.2f}{:>9.1f}{:>10.1e}{:>10.1e}{:>10.1e}{:>8.2f}{:>8.2f}{:>8.2f}{:>8}{}\n", name, method, precision,
                   row.nanoseconds, 1e3 / row.nanoseconds, row.error_median, row.error_p99, row.error_max, 100 * row.wrong_flags,
                   100 * row.uncertified, 100 * row.fell_back, share > 0 ? fmt::format("{:.1f}", 100 * share) : "",
                   row.not_a_number > 0 ? fmt::format("  {} NaN", row.not_a_number) : "");
        csv += fmt::format("{},{},{},{},{},{:.4f},{:.3f},{:.2f},{:.4e},{:.4e},{:.4e},{:.6f},{:.6f},{:.6f},{},{},{},{:.4f}\n", name, method,
                           precision, scree::simd_target(), pairs.size(), row.nanoseconds, 1e3 / row.nanoseconds, peak[single ? 1 : 0],
                           row.error_median, row.error_p99, row.error_max, row.wrong_flags, row.uncertified, row.fell_back,
                           row.not_a_number, scree::kGitHash, scree::kCompiler, share);
      }
    }
  const auto write = [](const std::string& path, const char* data, std::size_t size) {
    std::ofstream file(path, std::ios::binary);
    file.write(data, static_cast<std::streamsize>(size));
    file.close();
    if (!file) throw scree::SystemError("{}: cannot be written", path);
  };
  if (!csv_file.empty()) write(csv_file, csv.data(), csv.size());
  if (!answers_file.empty())
    write(answers_file, reinterpret_cast<const char*>(answers.data()), answers.size() * sizeof(scree::AnswerRecord));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
