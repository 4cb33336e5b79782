// scree-bench-broad-phase: cost per body of the multilevel grid against the number of bodies and their sizes.
//   1 read the options   2 make the scenes   3 time them in turns   4 compare with brute force   5 write
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <random>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/search/multilevel_grid.hpp"

namespace {

using scree::MultilevelGrid;
using scree::PeriodicImage;
using scree::Vec3;

struct Scene {
  std::string name;
  double ratio = 1;           ///< largest over smallest radius
  std::vector<Vec3> centres;  ///< in random order: the worst for caches
  std::vector<double> radii;
  Vec3 period;
  // measured
  double build_ns = 1e300, search_ns = 1e300, unordered_ns = 1e300;  ///< a body, best of the rounds
  std::int64_t pairs = 0, missed = -1, memory = 0;
  int levels = 0;
};

/// Balls of one solid fraction, thrown into a cube. Sizes: number density proportional to r^-exponent between the
/// largest radius and largest / ratio; both ends occur.
Scene make_scene(const std::string& name, std::size_t count, double ratio, double exponent, double fraction, bool periodic, unsigned seed) {
  std::mt19937_64 g(seed);
  std::uniform_real_distribution<double> u(0, 1);
  Scene scene;
  scene.name = name;
  scene.ratio = ratio;
  double volume = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double k = 1 - exponent;
    double r = k == 0 ? std::pow(ratio, u(g) - 1) : std::pow(1 + u(g) * (std::pow(ratio, k) - 1), 1 / k) / ratio;
    if (i == 0) r = 1;
    if (i == 1) r = 1 / ratio;
    scene.radii.push_back(r);
    volume += 4.0 / 3 * 3.14159265358979 * r * r * r;
  }
  const double side = std::max(std::cbrt(volume / fraction), 4.0);
  for (std::size_t i = 0; i < count; ++i) scene.centres.push_back({side * (u(g) - 0.5), side * (u(g) - 0.5), side * (u(g) - 0.5)});
  if (periodic) scene.period = {side, side, side};
  return scene;
}

/// Processor time of this thread: other programs on the machine do not count, but for what they do to the caches.
double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The number of repetitions makes 1e5 bodies at least, and each has places of its own: the processor learns the
/// branches of a small scene by heart when it sees it twice.
void measure(Scene& scene, MultilevelGrid& grid) {
  const auto count = static_cast<std::int32_t>(scene.centres.size());
  const int repetitions = std::max(1, 100000 / count);
  const double each = 1e9 / (static_cast<double>(count) * repetitions);
  std::mt19937_64 g(7);
  double build = 0, search = 0, unordered = 0;
  std::int64_t pairs = 0, again = 0;
  grid.build(scene.centres, scene.radii, scene.period);  // memory is kept between builds: not timed
  for (int k = 0; k < repetitions; ++k) {
    std::vector<Vec3> centres = scene.centres;
    if (k > 0) std::shuffle(centres.begin(), centres.end(), g);
    for (Vec3& x : centres) x.x = k % 2 == 0 ? x.x : -x.x;
    double start = seconds();
    grid.build(centres, scene.radii, scene.period);
    build += seconds() - start;
    start = seconds();
    for (std::int32_t place = 0; place < count; ++place) grid.for_each_partner_at(place, [&](std::int32_t) { ++pairs; });
    search += seconds() - start;
    start = seconds();
    for (std::int32_t i = 0; i < count; ++i) grid.for_each_partner(i, [&](std::int32_t) { ++again; });
    unordered += seconds() - start;
  }
  SCREE_ASSERT(pairs == again, "{} pairs in order, {} as given", pairs, again);
  scene.build_ns = std::min(scene.build_ns, each * build);
  scene.search_ns = std::min(scene.search_ns, each * search);
  scene.unordered_ns = std::min(scene.unordered_ns, each * unordered);
  scene.pairs = pairs / repetitions;
  scene.memory = static_cast<std::int64_t>(grid.memory());
  scene.levels = grid.level_count();
}

/// Pairs of all bodies that the grid did not find, plus those that it found wrongly or twice.
std::int64_t count_errors(const Scene& scene) {
  MultilevelGrid grid;
  grid.build(scene.centres, scene.radii, scene.period);
  std::vector<std::pair<std::int32_t, std::int32_t>> found, expected;
  const auto count = static_cast<std::int32_t>(scene.centres.size());
  for (std::int32_t i = 0; i < count; ++i)
    grid.for_each_partner(i, [&](std::int32_t j) { found.emplace_back(std::min(i, j), std::max(i, j)); });
  for (std::int32_t i = 0; i < count; ++i) {
    for (std::int32_t j = i + 1; j < count; ++j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      Vec3 between = scene.centres[a] - scene.centres[b];
      for (int c = 0; c < 3; ++c)
        if (scene.period[c] > 0) between[c] -= scene.period[c] * std::nearbyint(between[c] / scene.period[c]);
      const double reach = scene.radii[a] + scene.radii[b];
      if (squared_length(between) < reach * reach) expected.emplace_back(i, j);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::pair<std::int32_t, std::int32_t>> difference;
  std::set_symmetric_difference(found.begin(), found.end(), expected.begin(), expected.end(), std::back_inserter(difference));
  return static_cast<std::int64_t>(difference.size());
}

int run(int argc, char** argv) {
  // 1 options
  std::vector<std::size_t> counts = {1000, 10000, 100000, 1000000};
  std::vector<double> ratios = {1, 10, 100, 1e3, 1e4};
  std::size_t ratio_count = 100000, checked = 10000;
  double fraction = 0.6;
  int rounds = 3;
  std::string csv_file;
  const auto app =
      scree::make_command_line("scree-bench-broad-phase",
                               "Times the multilevel grid: cost per body against the number of bodies and the ratio of sizes, on one core.",
                               {{"scree-bench-broad-phase", "the whole table"},
                                {"scree-bench-broad-phase --counts 1000000 --ratios 1", "only a million equal bodies"}},
                               "");
  app->add_option("--counts", counts, "Numbers of equal bodies at one density")->capture_default_str();
  app->add_option("--ratios", ratios, "Ratios of the largest radius to the smallest")->capture_default_str()->check(CLI::Range(1.0, 1e12));
  app->add_option("--count", ratio_count, "Bodies in the scenes of different sizes")->capture_default_str();
  app->add_option("--fraction", fraction, "Solid fraction")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--rounds", rounds, "Times to measure each scene, in turns; the best counts")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app->add_option("--check", checked, "Compare scenes up to this size with brute force")->capture_default_str();
  app->add_option("--csv", csv_file, "Write the table here")->type_name("OUT");
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  // 2 scenes
  std::vector<Scene> scenes;
  for (const std::size_t n : counts) scenes.push_back(make_scene("equal", n, 1, 1, fraction, false, 1));
  for (const std::size_t n : counts) scenes.push_back(make_scene("periodic", n, 1, 1, fraction, true, 1));
  for (const double ratio : ratios) scenes.push_back(make_scene("log-uniform", ratio_count, ratio, 1, fraction, false, 2));
  for (const double ratio : ratios) scenes.push_back(make_scene("power-law-3", ratio_count, ratio, 3, fraction, false, 3));

  // 3 time
  for (int round = 0; round < rounds; ++round) {
    for (Scene& scene : scenes) {
      MultilevelGrid grid;
      measure(scene, grid);
    }
  }

  // 4 compare, 5 write
  std::string csv = "sizes,bodies,ratio,levels,pairs_per_body,build_ns,search_ns,search_unordered_ns,total_ns,bytes_per_body,errors\n";
  fmt::print("{:<13}{:>9}{:>8}{:>8}{:>12}{:>10}{:>11}{:>14}{:>10}{:>12}{:>8}\n", "sizes", "bodies", "ratio", "levels", "pairs/body",
             "build ns", "search ns", "as given ns", "total ns", "bytes/body", "errors");
  std::int64_t errors = 0;
  for (Scene& scene : scenes) {
    const double n = static_cast<double>(scene.centres.size());
    if (scene.centres.size() <= checked) {
      scene.missed = count_errors(scene);
      errors += scene.missed;
    }
    const std::string verdict = scene.missed < 0 ? "" : fmt::format("{}", scene.missed);
    const double per_body = static_cast<double>(scene.pairs) / n, bytes = static_cast<double>(scene.memory) / n;
    fmt::print("{:<13}{:>9}{:>8g}{:>8}{:>12.2f}{:>10.1f}{:>11.1f}{:>14.1f}{:>10.1f}{:>12.0f}{:>8}\n", scene.name, scene.centres.size(),
               scene.ratio, scene.levels, per_body, scene.build_ns, scene.search_ns, scene.unordered_ns, scene.build_ns + scene.search_ns,
               bytes, verdict.empty() ? "-" : verdict);
    csv += fmt::format("{},{},{},{},{:.4f},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f},{}\n", scene.name, scene.centres.size(), scene.ratio,
                       scene.levels, per_body, scene.build_ns, scene.search_ns, scene.unordered_ns, scene.build_ns + scene.search_ns, bytes,
                       verdict);
  }
  if (!csv_file.empty()) {
    std::ofstream out(csv_file);
    out << csv;
    if (!out) throw scree::SystemError("{}: cannot be written", csv_file);
  }
  if (errors > 0) throw scree::InternalError(fmt::format("{} pairs differ from brute force", errors));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main("scree-bench-broad-phase", [&] { return run(argc, argv); });
}
