// scree-peers-triangles: the distance of two triangles, Scree against FCL and CGAL on the same pairs in the same run.
//   1 read the options   2 make or read the pairs   3 time all in turn   4 compare with exact arithmetic   5 print
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "tests/benchmarks/distance/methods/distance_methods.hpp"
#include "tests/benchmarks/distance/regimes.hpp"
#include "tests/benchmarks/peers/peer_scene.hpp"
#include "tests/benchmarks/peers/rounds.hpp"
#include "tests/distance/exact_oracle.hpp"

namespace {

using scree::Pair18;
constexpr const char* kTool = "scree-peers-triangles";

/// Answers of one program: distances of the first pairs, at least as many as are checked.
using Distances = std::vector<double>;

void solve_fcl(std::span<const Pair18> pairs, Distances& distances) {
  using Vector = fcl::Vector3<double>;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double* x = pairs[i].data();
    Vector a[3], b[3], p, q;
    for (int k = 0; k < 3; ++k) {
      a[k] = Vector(x[3 * k], x[3 * k + 1], x[3 * k + 2]);
      b[k] = Vector(x[9 + 3 * k], x[10 + 3 * k], x[11 + 3 * k]);
    }
    distances[i] = fcl::detail::TriangleDistance<double>::triDistance(a, b, p, q);
  }
}

template <class Kernel>
void solve_cgal(std::span<const Pair18> pairs, Distances& distances) {
  using Point = typename Kernel::Point_3;
  using Triangle = typename Kernel::Triangle_3;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double* x = pairs[i].data();
    const Triangle a(Point(x[0], x[1], x[2]), Point(x[3], x[4], x[5]), Point(x[6], x[7], x[8]));
    const Triangle b(Point(x[9], x[10], x[11]), Point(x[12], x[13], x[14]), Point(x[15], x[16], x[17]));
    distances[i] = std::sqrt(std::max(0.0, CGAL::to_double(CGAL::squared_distance(a, b))));
  }
}

/// Scree's batch: the arrays it works on, and the answers.
template <class Real>
struct Batch {
  scree::PairBatch<Real> in;
  std::vector<Real> values, distance, points, code;
  scree::AnswerBatch<Real> out;

  explicit Batch(const std::vector<Pair18>& pairs) {
    std::int64_t stride = 0;
    const std::vector<double> all = scree::structure_of_arrays(pairs, stride);
    values.assign(all.begin(), all.end());
    const auto padded = static_cast<std::size_t>(stride);
    for (std::size_t c = 0; c < 18; ++c)
      for (std::size_t i = pairs.size(); i < padded; ++i) values[c * padded + i] = values[c * padded + pairs.size() - 1];
    distance.resize(padded), points.resize(6 * padded), code.resize(padded);
    in = {values.data(), stride, static_cast<std::int64_t>(pairs.size())};
    out = {distance.data(), points.data(), code.data(), stride};
  }
  Distances answers() const { return Distances(distance.begin(), distance.end()); }
};

/// Pairs of neighbouring faces of two rocks close to contact: what a simulation really asks for.
std::vector<Pair18> rock_pairs(std::size_t count) {
  const std::vector<scree::PeerShape> shapes = scree::make_peer_shapes("rock", 1280, 4, 1);
  const auto scratch = scree::make_mesh_distance_scratch();
  scree::Random random(5);
  std::vector<Pair18> pairs;
  std::vector<scree::TrianglePair> found;
  while (pairs.size() < count) {
    const scree::PeerShape& a = shapes[static_cast<std::size_t>(random.integer(0, 3))];
    const scree::PeerShape& b = shapes[static_cast<std::size_t>(random.integer(0, 3))];
    const scree::Placement placement = scree::placed_near(a, b, random.rotation(), random.direction(), 1e-2, *scratch);
    scree::triangle_pairs_within({&a.mesh, &a.bvh}, {&b.mesh, &b.bvh}, placement, 0.1, *scratch, found);
    for (const scree::TrianglePair& pair : found) {
      Pair18 p;
      for (int k = 0; k < 3; ++k) {
        const scree::Vec3 u = a.mesh.corner(pair.a, k), v = placement.rotation * b.mesh.corner(pair.b, k) + placement.translation;
        for (int c = 0; c < 3; ++c) {
          p[static_cast<std::size_t>(3 * k + c)] = u[c];
          p[static_cast<std::size_t>(9 + 3 * k + c)] = v[c];
        }
      }
      if (pairs.size() < count) pairs.push_back(p);
    }
  }
  return pairs;
}

std::vector<Pair18> read_pairs(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw scree::SystemError("{}: cannot be read", path);
  const auto bytes = static_cast<std::size_t>(file.tellg());
  if (bytes == 0 || bytes % sizeof(Pair18) != 0)
    throw scree::InputError("{}: {} bytes; expected a multiple of 144 (18 doubles a pair: A0 A1 A2 B0 B1 B2)", path, bytes);
  std::vector<Pair18> pairs(bytes / sizeof(Pair18));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(pairs.data()), static_cast<std::streamsize>(bytes));
  if (!file) throw scree::SystemError("{}: could not be read to its end", path);
  return pairs;
}

/// Over the pairs that were checked: the largest |d - d*| / max(L, d*), and how many pairs are said to touch although they do
/// not or the reverse. Below kTouch of the longest edge either answer is right, since the corners themselves are rounded.
struct Error {
  double largest = 0;
  int wrong_touches = 0;
};
constexpr double kTouch = 1e-6;
Error error_of(const Distances& answers, const std::vector<Pair18>& pairs, const std::vector<double>& truth) {
  Error error;
  for (std::size_t i = 0; i < std::min(truth.size(), answers.size()); ++i) {
    const double size = std::max(scree::longest_edge(pairs[i]), truth[i]);
    const double difference = std::abs(answers[i] - truth[i]) / size;
    error.largest = std::isnan(difference) ? INFINITY : std::max(error.largest, difference);
    error.wrong_touches += (answers[i] == 0 && truth[i] > kTouch * size) || (truth[i] == 0 && answers[i] > kTouch * size) ? 1 : 0;
  }
  return error;
}

std::string measure(const std::string& name, const std::vector<Pair18>& pairs, std::size_t checked, int rounds) {
  constexpr std::size_t kExactPairs = 64;  // the exact kernel takes 50 microseconds a pair
  const std::span<const Pair18> all(pairs), few = all.first(std::min(kExactPairs, pairs.size()));
  std::vector<Pair18> rounded = pairs;  // single precision sees other numbers: relative to the first corner, rounded
  for (Pair18& p : rounded) {
    const scree::Vec3 origin = scree::corner(p, 0);
    for (std::size_t i = 0; i < 18; ++i) {
      const volatile float value = static_cast<float>(p[i] - origin[static_cast<int>(i % 3)]);
      p[i] = value;
    }
  }
  Batch<double> brute(pairs), hybrid(pairs);
  Batch<float> single(rounded);
  Distances fcl(pairs.size()), simple(pairs.size()), filtered(pairs.size()), exact(few.size());
  std::vector<scree::Contender> contenders = {
      {"Scree brute-force double", [&] { scree::triangle_distances(scree::DistanceMethod::brute_force, brute.in, brute.out); },
       pairs.size()},
      {"Scree hybrid double", [&] { scree::triangle_distances(scree::DistanceMethod::hybrid, hybrid.in, hybrid.out); }, pairs.size()},
      {"Scree brute-force single", [&] { scree::triangle_distances(scree::DistanceMethod::brute_force, single.in, single.out); },
       pairs.size()},
      {"FCL TriangleDistance double", [&] { solve_fcl(all, fcl); }, pairs.size()},
      {"CGAL Simple_cartesian double", [&] { solve_cgal<CGAL::Simple_cartesian<double>>(all, simple); }, pairs.size()},
      {"CGAL EPICK", [&] { solve_cgal<CGAL::Exact_predicates_inexact_constructions_kernel>(all, filtered); }, pairs.size()},
      {"CGAL EPECK (exact)", [&] { solve_cgal<CGAL::Exact_predicates_exact_constructions_kernel>(few, exact); }, few.size()},
  };
  scree::run_rounds(contenders, rounds, 0.02);

  std::vector<double> truth, truth_rounded;
  for (std::size_t i = 0; i < std::min(checked, pairs.size()); ++i) {
    truth.push_back(static_cast<double>(scree::oracle::distance(pairs[i].data())));
    truth_rounded.push_back(static_cast<double>(scree::oracle::distance(rounded[i].data())));
  }
  const Distances answers[] = {brute.answers(), hybrid.answers(), single.answers(), fcl, simple, filtered, exact};
  std::string csv;
  for (std::size_t k = 0; k < contenders.size(); ++k) {
    const scree::Contender& c = contenders[k];
    const bool of_single = k == 2;
    const Error error = error_of(answers[k], of_single ? rounded : pairs, of_single ? truth_rounded : truth);
    const double ratio = c.least() / contenders[0].least();
    fmt::print("{:<14}{:<30}{:>10.2f}{:>10.2f}{:>10.2f}{:>9.1f}{:>12.1e}{:>8}\n", name, c.name, 1e-6 / c.least(), 1e-6 / c.median(),
               1e9 * c.least(), ratio, error.largest, error.wrong_touches);
    csv += fmt::format("{},{},{},{:.4f},{:.4f},{:.3f},{:.3e},{},{}\n", name, c.name, c.items, 1e9 * c.least(), 1e9 * c.median(), ratio,
                       error.largest, error.wrong_touches, std::min(truth.size(), c.items));
  }
  return csv;
}

int run(int argc, char** argv) {
  std::vector<std::string> files, regimes = {"near-1e-3", "near-1e-6", "touching", "intersecting", "separated"};
  std::string csv_file;
  // so many that the branches of FCL and CGAL cannot be learnt by heart over the repetitions: 2048 pairs flatter them by 2.5
  std::size_t count = 32768, checked = 1000;
  int rounds = 7;
  const auto app =
      scree::make_command_line(kTool, "Times the distance of two triangles in Scree, FCL and CGAL, and compares all with exact arithmetic.",
                               {{"scree-peers-triangles", "rocks near contact and the regimes of scree-bench-distance"},
                                {"scree-peers-triangles --pairs p.bin", "your own pairs, 18 little-endian doubles each"}});
  app->add_option("--pairs", files, "Files of pairs")->type_name("FILE");
  app->add_option("--regime", regimes, "Generated regimes, of scree-bench-distance")->capture_default_str();
  app->add_option("--count", count, "Pairs of a set")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--check", checked, "Compare so many of a set with exact arithmetic")->capture_default_str();
  app->add_option("--rounds", rounds, "How often all programs take turns")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--csv", csv_file, "Write the table here")->type_name("OUT");
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  std::vector<std::pair<std::string, std::vector<Pair18>>> sets;
  for (const std::string& file : files) sets.emplace_back(std::filesystem::path(file).stem().string(), read_pairs(file));
  if (files.empty()) {
    sets.emplace_back("rocks", rock_pairs(count));
    for (const std::string& name : regimes) sets.emplace_back(name, scree::make_regime(name, count, 1));
  }
  fmt::print("{:<14}{:<30}{:>10}{:>10}{:>10}{:>9}{:>12}{:>8}   Scree uses {}\n", "pairs", "program", "M/s best", "median", "ns/pair",
             "x time", "max error", "wrong", scree::simd_target());
  std::string csv = "pairs,program,count,ns_least,ns_median,times_scree,error_max,wrong_touches,checked\n";
  for (const auto& [name, pairs] : sets) csv += measure(name, pairs, checked, rounds);
  scree::write_table(csv_file, csv);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
