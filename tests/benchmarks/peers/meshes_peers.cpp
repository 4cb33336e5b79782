// scree-peers-meshes: the distance of two concave rocks near contact, Scree against FCL on the same meshes and poses.
//
// FCL answers with one smallest distance. A simulation needs every pair of triangles within the margins, which FCL does not
// offer; so Scree is timed for both. Every distance is compared with the exact one: the smallest over all pairs of triangles in
// rational arithmetic (only pairs whose rounded distance comes within 1e-9 of the smallest are solved exactly).
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/distance.h>

#include <cstdio>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "tests/benchmarks/peers/peer_scene.hpp"
#include "tests/benchmarks/peers/rounds.hpp"
#include "tests/distance/exact_oracle.hpp"
#include "tests/distance/triangle_pairs.hpp"

namespace {

constexpr const char* kTool = "scree-peers-meshes";
constexpr double kReaches[] = {0.04, 0.01};  // both margins together, over the radius: of the scene here, and a narrow one

using scree::PeerShape;
using scree::Placement;
using scree::Vec3;
using FclModel = fcl::BVHModel<fcl::OBBRSS<double>>;

std::shared_ptr<FclModel> fcl_model(const PeerShape& shape) {
  auto model = std::make_shared<FclModel>();
  std::vector<fcl::Vector3d> vertices;
  std::vector<fcl::Triangle> triangles;
  for (const Vec3& p : shape.mesh.vertices) vertices.emplace_back(p.x, p.y, p.z);
  for (const scree::Triangle& t : shape.mesh.triangles)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]), static_cast<std::size_t>(t[2]));
  model->beginModel();
  model->addSubModel(vertices, triangles);
  model->endModel();
  return model;
}

fcl::Transform3d fcl_transform(const Placement& p) {
  fcl::Transform3d x = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) x.linear()(i, j) = p.rotation[i][j];
    x.translation()[i] = p.translation[i];
  }
  return x;
}

/// The smallest distance over all pairs of triangles, in exact arithmetic.
double exact_distance(const PeerShape& a, const PeerShape& b, const Placement& placement) {
  std::vector<scree::Pair18> row(static_cast<std::size_t>(b.mesh.triangle_count()));
  std::vector<std::pair<double, scree::Pair18>> near;
  double least = 1e300;
  for (std::int32_t i = 0; i < a.mesh.triangle_count(); ++i) {
    for (std::int32_t j = 0; j < b.mesh.triangle_count(); ++j)
      for (int k = 0; k < 3; ++k) {
        const Vec3 u = a.mesh.corner(i, k), v = placement.rotation * b.mesh.corner(j, k) + placement.translation;
        for (int c = 0; c < 3; ++c) {
          row[static_cast<std::size_t>(j)][static_cast<std::size_t>(3 * k + c)] = u[c];
          row[static_cast<std::size_t>(j)][static_cast<std::size_t>(9 + 3 * k + c)] = v[c];
        }
      }
    const std::vector<double> distances = scree::solve_distances(row);
    for (std::size_t j = 0; j < distances.size(); ++j) {
      if (distances[j] > least + 1e-9) continue;
      least = std::min(least, distances[j]);
      near.emplace_back(distances[j], row[j]);
    }
  }
  double exact = 1e300;
  for (const auto& [distance, pair] : near)
    if (distance <= least + 1e-9) exact = std::min(exact, static_cast<double>(scree::oracle::distance(pair.data())));
  return exact;
}

std::string measure(int triangles, double gap, std::size_t poses, std::size_t checked, int rounds) {
  const std::vector<PeerShape> shapes = scree::make_peer_shapes("rock", triangles, 2, 1);
  const PeerShape &a = shapes[0], &b = shapes[1];
  const scree::MeshView view_a{&a.mesh, &a.bvh}, view_b{&b.mesh, &b.bvh};
  const auto scratch = scree::make_mesh_distance_scratch();
  scree::Random random(4242);
  std::vector<Placement> placements;
  std::vector<fcl::Transform3d> transforms;
  for (std::size_t i = 0; i < poses; ++i) {
    placements.push_back(scree::placed_near(a, b, random.rotation(), random.direction(), gap, *scratch));
    transforms.push_back(fcl_transform(placements.back()));
  }
  const auto model_a = fcl_model(a), model_b = fcl_model(b);
  const fcl::DistanceRequestd request(true);
  std::vector<double> own(poses), theirs(poses);
  std::vector<scree::TrianglePair> pairs;
  std::size_t found[] = {0, 0};
  const auto within = [&](std::size_t k) {
    found[k] = 0;
    for (const Placement& p : placements) {
      scree::triangle_pairs_within(view_a, view_b, p, kReaches[k], *scratch, pairs);
      found[k] += pairs.size();
    }
  };
  std::vector<scree::Contender> contenders = {
      {fmt::format("Scree all pairs within {}", kReaches[0]), [&] { within(0); }, poses},
      {fmt::format("Scree all pairs within {}", kReaches[1]), [&] { within(1); }, poses},
      {"Scree mesh_distance",
       [&] {
         for (std::size_t i = 0; i < poses; ++i) own[i] = scree::mesh_distance(view_a, view_b, placements[i], 1e9, *scratch);
       },
       poses},
      {"FCL distance OBBRSS",
       [&] {
         for (std::size_t i = 0; i < poses; ++i) {
           fcl::DistanceResultd result;
           fcl::distance(model_a.get(), fcl::Transform3d::Identity(), model_b.get(), transforms[i], request, result);
           theirs[i] = result.min_distance;
         }
       },
       poses},
  };
  scree::run_rounds(contenders, rounds, 0.05);
  double own_error = 0, their_error = 0;
  for (std::size_t i = 0; i < std::min(checked, poses); ++i) {
    const double exact = exact_distance(a, b, placements[i]);
    own_error = std::max(own_error, std::abs(own[i] - exact));
    their_error = std::max(their_error, std::abs(theirs[i] - exact));
  }
  const double errors[] = {own_error, own_error, own_error, their_error};
  std::string csv;
  for (std::size_t k = 0; k < contenders.size(); ++k) {
    const scree::Contender& c = contenders[k];
    const double ratio = contenders[3].least() / c.least();
    fmt::print("{:>9}{:>8.0e}  {:<32}{:>10.2f}{:>10.2f}{:>9.1f}{:>12.1e}", triangles, gap, c.name, 1e6 * c.least(), 1e6 * c.median(), ratio,
               errors[k]);
    fmt::print("{}\n", k < 2 ? fmt::format("   {:.1f} pairs", static_cast<double>(found[k]) / static_cast<double>(poses)) : "");
    csv += fmt::format("{},{},{},{:.4f},{:.4f},{:.3f},{:.3e},{}\n", triangles, gap, c.name, 1e6 * c.least(), 1e6 * c.median(), ratio,
                       errors[k], std::min(checked, poses));
  }
  return csv;
}

int run(int argc, char** argv) {
  std::vector<int> triangles = {80, 320, 1280, 5120};
  std::vector<double> gaps = {5e-3, 1e-3};
  std::size_t poses = 1000, checked = 10;  // 100 poses are learnt by heart: Scree would seem twice as fast at 320 triangles
  int rounds = 7;
  std::string csv_file;
  const auto app = scree::make_command_line(kTool, "Times the distance of two concave rocks near contact in Scree and FCL.",
                                            {{"scree-peers-meshes --triangles 1280", "one size"}});
  app->add_option("--triangles", triangles, "Of each rock")->capture_default_str();
  app->add_option("--gap", gaps, "Smallest distance of the surfaces over the radius")->capture_default_str();
  app->add_option("--poses", poses, "How many")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--check", checked, "Compare so many with exact arithmetic")->capture_default_str();
  app->add_option("--rounds", rounds, "How often all programs take turns")->capture_default_str()->check(CLI::PositiveNumber);
  app->add_option("--csv", csv_file, "Write the table here")->type_name("OUT");
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  fmt::print("{:>9}{:>8}  {:<32}{:>10}{:>10}{:>9}{:>12}   Scree uses {}\n", "triangles", "gap", "program", "us best", "median", "FCL/it",
             "max error", scree::simd_target());
  std::string csv = "triangles,gap,program,us_least,us_median,fcl_over_it,error_max,checked\n";
  for (const int t : triangles)
    for (const double gap : gaps) csv += measure(t, gap, poses, checked, rounds);
  scree::write_table(csv_file, csv);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
