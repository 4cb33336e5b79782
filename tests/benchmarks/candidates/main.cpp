// scree-bench-candidates: which triangles of two bodies can touch, by search, by kept lists and by all pairs.
//   1 read the options   2 two rocks in random poses   3 two rocks along trajectories   4 a dense packing   5 write
#include <time.h>

#include <cstdio>
#include <fstream>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/geometry/features.hpp"
#include "core/search/multilevel_grid.hpp"
#include "tests/benchmarks/candidates/all_pairs.hpp"
#include "tests/benchmarks/candidates/trajectories.hpp"
#include "tests/benchmarks/distance/methods/kept_pairs.hpp"
#include "tests/benchmarks/distance/published_methods.hpp"

namespace {

using namespace scree;

struct Options {
  std::vector<int> levels = {0, 1, 2, 3, 4, 5};
  int poses = 24, steps = 2000, check = 0, bodies = 500;
  double margin = 0.01, speed = 1e-3, skin = 0, roughness = 0.22;
  std::vector<std::string> paths;
  std::string csv, simd = "best";
};

/// One line of the table and of the CSV.
struct Row {
  std::string what;
  int triangles = 0;
  double microseconds = 0;   ///< a pair of bodies: a query, or a step
  double candidates = 0;     ///< triangle pairs within the margin, or kept
  double expired = 0;        ///< share of the kept pairs that a step looked at
  double bytes = 0;          ///< a kept pair
  double list_steps = 0;     ///< steps that a list served
  std::int64_t misses = -1;  ///< against all pairs; -1: not compared
};

/// Processor time of this thread: other programs on the machine do not count, but for what they do to the caches.
double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Best of some repetitions of about a millisecond, in microseconds a call.
template <class Call>
double time_call(const Call& call) {
  double start = seconds();
  call();
  const int repetitions = std::max(1, static_cast<int>(1e-3 / std::max(1e-9, seconds() - start)));
  double best = 1e300;
  for (int round = 0; round < 5; ++round) {
    start = seconds();
    for (int k = 0; k < repetitions; ++k) call();
    best = std::min(best, (seconds() - start) / repetitions);
  }
  return 1e6 * best;
}

void print_row(const Row& row) {
  const auto or_blank = [](double x, const char* format) { return x > 0 ? fmt::format(fmt::runtime(format), x) : std::string("-"); };
  fmt::print("{:<26}{:>10}{:>14.3f}{:>13}{:>11}{:>9}{:>12}{:>9}\n", row.what, row.triangles, row.microseconds,
             or_blank(row.candidates, "{:.1f}"), or_blank(100 * row.expired, "{:.2f}"), or_blank(row.bytes, "{:.2f}"),
             or_blank(row.list_steps, "{:.1f}"), row.misses < 0 ? "-" : fmt::format("{}", row.misses));
  std::fflush(stdout);
}

/// Queries of two rocks near contact; every pose is also solved by all pairs when that is asked for.
void measure_poses(const BenchShape& a, const BenchShape& b, const Options& options, std::vector<Row>& rows) {
  const int triangles = a.mesh.triangle_count();
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  AllPairs reference;
  Row all{"all pairs", triangles}, near{"search, margin", triangles}, wide{"search, margin + skin", triangles},
      distance{"distance", triangles};
  near.misses = options.check > 0 ? 0 : -1;
  wide.misses = distance.misses = near.misses;
  const double skin = 0.04;
  std::vector<TrianglePair> pairs;
  const bool time_all = static_cast<double>(triangles) * triangles < 1e7;
  for (int pose = 0; pose < options.poses; ++pose) {
    Trajectory path(a, b, 1, options.margin, options.speed, Path::jitter, static_cast<std::uint64_t>(pose));
    for (int k = 0; k < 8 * (pose % 5); ++k) path.advance();
    const Placement p = path.placement();
    double least = 0;
    if (time_all && pose < 4)
      all.microseconds += time_call([&] { reference.below(a.view(), b.view(), p, options.margin, least); }) / std::min(4, options.poses);
    const auto query = [&](double reach, Row& row) {
      row.microseconds += time_call([&] { triangle_pairs_within(a.view(), b.view(), p, reach, *scratch, pairs); }) / options.poses;
      row.candidates += static_cast<double>(pairs.size()) / options.poses;
      if (options.check == 0) return;
      std::vector<ClosePair> found;
      const std::vector<ClosePair> expected = reference.below(a.view(), b.view(), p, reach, least);
      for (const TrianglePair& pair : pairs) {
        const auto known = std::find_if(expected.begin(), expected.end(), [&](const ClosePair& c) { return c.pair == pair; });
        found.push_back({pair, known == expected.end() ? 0 : known->distance});
      }
      row.misses += count_differences(std::move(found), expected, reach, 1e-14);
    };
    query(options.margin, near);
    query(options.margin + skin, wide);
    double d = 0;
    distance.microseconds += time_call([&] { d = mesh_distance(a.view(), b.view(), p, 1e308, *scratch); }) / options.poses;
    if (options.check > 0) {
      reference.below(a.view(), b.view(), p, 0, least);
      distance.misses += std::abs(d - least) > 1e-14;
    }
  }
  if (time_all) rows.push_back(all);
  rows.insert(rows.end(), {near, wide, distance});
}

/// Kept lists along a path.
Row measure_path(const BenchShape& a, const BenchShape& b, const std::string& name, Path kind, const Options& options) {
  Row row{"kept, " + name, a.mesh.triangle_count()};
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  AllPairs reference;
  std::vector<Placement> placements;
  std::vector<ClosePair> close;
  row.misses = options.check > 0 ? 0 : -1;
  const int seeds = 4, steps = std::max(1, options.steps / seeds);
  double per_pair = 0;
  KeptPairs::Counts sum;
  for (int seed = 0; seed < seeds; ++seed) {
    Trajectory path(a, b, 1, options.margin, options.speed, kind, static_cast<std::uint64_t>(100 + seed));
    placements.assign(1, path.placement());
    for (int k = 1; k < steps; ++k) {
      path.advance();
      placements.push_back(path.placement());
    }
    double best = 1e300;
    for (int round = 0; round < 3; ++round) {
      KeptPairs kept;
      kept.fix_skin(options.skin);
      const double start = seconds();
      for (const Placement& p : placements) kept.update(a.view(), b.view(), p, options.margin, *scratch, close);
      best = std::min(best, 1e6 * (seconds() - start) / steps);
      if (round > 0) continue;
      per_pair = std::max(per_pair, static_cast<double>(kept.memory()) / std::max(1.0, static_cast<double>(kept.pair_count())));
      const KeptPairs::Counts& c = kept.counts();
      sum.lists += c.lists;
      sum.scanned += c.scanned;
      sum.filtered += c.filtered;
      sum.decided += c.decided;
      sum.steps += c.steps;
    }
    row.microseconds += best / seeds;
    if (options.check == 0) continue;
    KeptPairs kept;
    kept.fix_skin(options.skin);
    for (std::size_t k = 0; k < placements.size(); ++k) {
      kept.update(a.view(), b.view(), placements[k], options.margin, *scratch, close);
      double least = 0;
      if (static_cast<int>(k) % options.check == 0)
        row.misses +=
            count_differences(close, reference.below(a.view(), b.view(), placements[k], options.margin, least), options.margin, 1e-14);
    }
  }
  row.candidates = static_cast<double>(sum.scanned) / static_cast<double>(sum.steps);
  row.expired = static_cast<double>(sum.filtered + sum.decided) / static_cast<double>(std::max<std::int64_t>(1, sum.scanned));
  row.list_steps = static_cast<double>(sum.steps) / static_cast<double>(sum.lists);
  row.bytes = per_pair;
  return row;
}

/// A dense packing: rocks of one shape on a lattice of close packing, turned at random, that shake and turn. A pair costs
/// what it costs when thousands of others go through the caches between two of its steps.
Row measure_packing(const BenchShape& shape, const Options& options) {
  Row row{fmt::format("packing of {}", options.bodies), shape.mesh.triangle_count()};
  Random random(5);
  const double radius = static_cast<double>(shape.bvh.radius), mean = 0.5 * (1 + radius);
  std::vector<Vec3> home, x;
  std::vector<Quat> q;
  const int edge = static_cast<int>(std::ceil(std::cbrt(options.bodies / 4.0)));
  const double cell = std::sqrt(2.0) * 2 * mean;
  for (int i = 0; static_cast<int>(home.size()) < options.bodies && i < 4 * edge * edge * edge; ++i) {
    const int c = i / 4, corner = i % 4;
    const Vec3 base{static_cast<double>(c % edge), static_cast<double>(c / edge % edge), static_cast<double>(c / edge / edge)};
    const Vec3 part[4] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    home.push_back(cell * (base + part[corner]));
    q.push_back(random.rotation());
  }
  x = home;
  std::vector<double> reach(x.size(), radius + options.margin + 0.05);
  MultilevelGrid grid;
  grid.build(x, reach);
  struct Pair {
    std::int32_t a, b;
    KeptPairs kept;
  };
  std::vector<Pair> pairs;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(x.size()); ++i)
    grid.for_each_partner(i, [&](std::int32_t j) { pairs.push_back({i, j, {}}); });
  std::sort(pairs.begin(), pairs.end(), [](const Pair& l, const Pair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
  if (pairs.empty()) return row;
  // grow every body until it nearly touches: a packing without intersections, in which every body has neighbours in contact
  std::vector<double> scale(x.size(), 0.8);
  const MeshDistanceScratchPtr distance_scratch = make_mesh_distance_scratch();
  for (int sweep = 0; sweep < 6; ++sweep) {
    std::vector<double> room(x.size(), 1e308);
    for (const Pair& pair : pairs) {
      const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
      const Placement p = relative_placement(x[a], q[a], scale[a], x[b], q[b], scale[b]);
      const double gap = scale[a] * mesh_distance(shape.view(), shape.view(), p, 10.0, *distance_scratch) - 0.5 * options.margin;
      for (const std::size_t i : {a, b}) room[i] = std::min(room[i], gap);
    }
    for (std::size_t i = 0; i < x.size(); ++i) scale[i] += 0.45 * std::max(0.0, room[i]) / radius;
  }
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  AllPairs reference;
  std::vector<ClosePair> close;
  const int steps = std::max(20, options.steps / 20);
  double time = 0, touching = 0;
  row.misses = options.check > 0 ? 0 : -1;
  std::vector<Vec3> axis;
  for (std::size_t i = 0; i < x.size(); ++i) axis.push_back(random.direction());
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      // swings through a third of the margin, at the speed, and as much of a turn
      const double swing = options.margin / 3 * std::sin(3 * options.speed / options.margin * step + static_cast<double>(i));
      x[i] = home[i] + swing * axis[i];
      q[i] = normalised(quaternion_of(axis[i], 0.3 * options.speed * std::cos(static_cast<double>(i))) * q[i]);
    }
    for (Pair& pair : pairs) {
      const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
      const Placement p = relative_placement(x[a], q[a], scale[a], x[b], q[b], scale[b]);
      const double margin = options.margin / scale[a];
      if (step == 0) pair.kept.fix_skin(options.skin);
      const double start = seconds();
      pair.kept.update(shape.view(), shape.view(), p, margin, *scratch, close);
      time += seconds() - start;
      touching += !close.empty();
      double least = 0;
      if (options.check > 0 && step % (50 * options.check) == 0)
        row.misses += count_differences(close, reference.below(shape.view(), shape.view(), p, margin, least), margin, 1e-14);
    }
  }
  KeptPairs::Counts sum;
  double bytes = 0, kept = 0;
  for (const Pair& pair : pairs) {
    const KeptPairs::Counts& c = pair.kept.counts();
    sum.lists += c.lists;
    sum.scanned += c.scanned;
    sum.filtered += c.filtered + c.decided;
    sum.steps += c.steps;
    bytes += static_cast<double>(pair.kept.memory());
    kept += static_cast<double>(pair.kept.pair_count());
  }
  row.what += fmt::format(", {:.0f} % touch", 100 * touching / static_cast<double>(sum.steps));
  row.microseconds = 1e6 * time / static_cast<double>(sum.steps);
  row.candidates = static_cast<double>(sum.scanned) / static_cast<double>(sum.steps);
  row.expired = static_cast<double>(sum.filtered) / static_cast<double>(std::max<std::int64_t>(1, sum.scanned));
  row.list_steps = static_cast<double>(sum.steps) / static_cast<double>(sum.lists);
  row.bytes = bytes / std::max(1.0, kept);
  return row;
}

/// What a shape costs, in bytes a triangle.
void print_memory(const BenchShape& shape) {
  const double count = shape.mesh.triangle_count();
  const double mesh =
      static_cast<double>(shape.mesh.vertices.size() * sizeof(Vec3) + shape.mesh.triangles.size() * sizeof(Triangle)) / count;
  const double tree = static_cast<double>(shape.bvh.memory()) / count,
               features = static_cast<double>(find_features(shape.mesh).memory()) / count;
  fmt::print("{:>9} triangles: bytes a triangle: mesh {:.1f}, tree {:.1f}, features {:.1f}, together {:.1f}\n", shape.mesh.triangle_count(),
             mesh, tree, features, mesh + tree + features);
}

int run(int argc, char** argv) {
  // 1 options
  Options options;
  const auto app = make_command_line(
      "scree-bench-candidates",
      "Times the search for triangle pairs of two rocks near contact: by descent, by kept lists and by all pairs, on one core.",
      {{"scree-bench-candidates", "rocks of 20 to 20480 triangles"},
       {"scree-bench-candidates --levels 1 --steps 10000 --check 1", "every step against all pairs"}},
      "");
  app->add_option("--levels", options.levels, "Rocks of 20 * 4^level triangles")->capture_default_str()->check(CLI::Range(0, 8));
  app->add_option("--poses", options.poses, "Random poses of the single queries")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--steps", options.steps, "Steps along each path")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--path", options.paths, "roll, spin, slide, jitter, tumble (default: all)")->type_name("NAME");
  app->add_option("--margin", options.margin, "Sum of the margins, of the mean radius")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app->add_option("--speed", options.speed, "Motion of the surfaces in a step, of the mean radius")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app->add_option("--skin", options.skin, "Skin of the kept lists; 0: tuned at run time")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app->add_option("--check", options.check, "Compare every n-th step, and all poses, with all pairs; 0: none")->capture_default_str();
  app->add_option("--bodies", options.bodies, "Bodies in the packing; 0: none")->capture_default_str();
  app->add_option("--simd", options.simd, "best, avx512, avx2, sse4, scalar")->capture_default_str();
  app->add_option("--csv", options.csv, "Write the table here")->type_name("OUT");
  if (!parse_command_line(*app, argc, argv)) return 0;
  limit_simd(options.simd);
  for (const std::string& name : options.paths) {
    if (std::none_of(all_paths().begin(), all_paths().end(), [&](const auto& p) { return p.first == name; }))
      throw UsageError("--path: '{}' is not known; expected roll, spin, slide, jitter or tumble", name);
  }

  std::vector<Row> rows;
  fmt::print("{}: margin {:g}, {:g} a step, of the mean radius; measured FMA peak of one core: {:.1f} GFLOP/s double, {:.1f} single\n",
             simd_target(), options.margin, options.speed, measured_fma_peak(false), measured_fma_peak(true));
  fmt::print("{:<26}{:>10}{:>14}{:>13}{:>11}{:>9}{:>12}{:>9}\n", "method", "triangles", "us per pair", "tri pairs", "looked at%", "bytes",
             "steps/list", "misses");
  for (const int level : options.levels) {
    const BenchShape a(test::rock(11, level, options.roughness)), b(test::rock(12, level, options.roughness));
    const std::size_t first = rows.size();
    measure_poses(a, b, options, rows);           // 2
    for (const auto& [name, path] : all_paths())  // 3
      if (options.paths.empty() || std::find(options.paths.begin(), options.paths.end(), name) != options.paths.end())
        rows.push_back(measure_path(a, b, name, path, options));
    if (options.bodies > 1 && level <= 3) rows.push_back(measure_packing(a, options));  // 4
    for (std::size_t k = first; k < rows.size(); ++k) print_row(rows[k]);
    print_memory(a);
  }

  // 5 write
  std::int64_t misses = 0;
  std::string csv = "method,triangles,us_per_pair,triangle_pairs,looked_at_share,bytes_per_kept_pair,steps_per_list,misses\n";
  for (const Row& row : rows) {
    misses += std::max<std::int64_t>(0, row.misses);
    csv += fmt::format("\"{}\",{},{:.4f},{:.2f},{:.5f},{:.3f},{:.2f},{}\n", row.what, row.triangles, row.microseconds, row.candidates,
                       row.expired, row.bytes, row.list_steps, row.misses < 0 ? "" : fmt::format("{}", row.misses));
  }
  if (!options.csv.empty()) {
    std::ofstream out(options.csv);
    out << csv;
    if (!out) throw SystemError("{}: cannot be written", options.csv);
  }
  if (misses > 0) throw InternalError(fmt::format("{} pairs differ from all pairs", misses));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main("scree-bench-candidates", [&] { return run(argc, argv); });
}
