// Packing: nothing overlaps, margins are kept, and the same seed gives the same scene.
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "core/base/error.hpp"
#include "core/partition/partition.hpp"
#include "decomposer/cut/predicted_work.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "tests/decomposer/brute_distance.hpp"
#include "tests/support/margins.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

/// A hollow box: outer and inner surface, the inner one facing the hollow.
TriangleMesh shell(double outer, double inner) {
  TriangleMesh mesh = box_mesh({outer, outer, outer});
  TriangleMesh hole = box_mesh({inner, inner, inner});
  const std::int32_t shift = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), hole.vertices.begin(), hole.vertices.end());
  for (const Triangle& t : hole.triangles) mesh.triangles.push_back({t[0] + shift, t[2] + shift, t[1] + shift});
  return mesh;
}

class Packing : public ::testing::Test {
 protected:
  Packing() : folder_(fs::temp_directory_path() / ("scree_packing_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    const auto write = [&](const std::string& name, const Shape& shape) {
      write_shape_file((folder_ / (name + ".shape.h5")).string(), {shape}, {{"tool", "test"}});
    };
    write("l", make_solid("l", test::l_shape()));
    write("rock", make_solid("rock", test::rock(5, 1)));
    write("cube", make_solid("cube", box_mesh({1, 1, 1})));
    write("shell", make_solid("shell", shell(1, 0.8)));
    TriangleMesh ramp;  // one open square, inclined
    ramp.vertices = {{-1, -1, 0.1}, {1, -1, 0.3}, {1, 1, 0.3}, {-1, 1, 0.1}};
    ramp.triangles = {{0, 1, 2}, {0, 2, 3}};
    write("ramp", make_surface("ramp", ramp));
    // off its origin: a region and a wall keep the coordinates of their file
    TriangleMesh lump = test::icosphere(2);
    for (Vec3& p : lump.vertices) p = 0.2 * p + Vec3{0, 0, 0.5};
    write("lump", make_solid("lump", lump));
  }
  ~Packing() override { fs::remove_all(folder_); }

  PackedScene pack(const std::string& text) const {
    return build_scene(test::touching_outside(parse_case(text, "case.toml", folder_.string())));
  }
  std::string failure(const std::string& text, ExitCode code = ExitCode::bad_data) const {
    try {
      pack(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << e.what();
      return e.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return "";
  }
  fs::path folder_;
};

const std::string kHead = R"(
seed = 3
gravity = [0, 0, -9.81]
[time]
duration = 1
[shapes.l]
file = "l.shape.h5"
[shapes.rock]
file = "rock.shape.h5"
[shapes.cube]
file = "cube.shape.h5"
[shapes.shell]
file = "shell.shape.h5"
[shapes.ball]
sphere = { radius = 0.5 }
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 1e7
restitution = 0.5
[contact]
margin = "2 mm"
)";
const std::string kBox = R"(
[[walls]]
shape = { box_inside = [[0, 0, 0], [0.5, 0.5, 0.5]] }
material = "stone"
)";
const std::string kMixture = R"(
[[populations]]
shapes = { l = 0.5, rock = 0.3, ball = 0.2 }
material = "stone"
count = 30
size = { distribution = "uniform", min = "60 mm", max = "90 mm" }
region = { box = [[-0.1, -0.1, -0.1], [0.6, 0.6, 0.6]] }
)";

std::vector<test::WorldTriangle> world_triangles(const Shape& shape, double scale, const Vec3& x, const Quat& q) {
  std::vector<test::WorldTriangle> result;
  for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
    test::WorldTriangle w;
    for (int k = 0; k < 3; ++k) w.p[k] = x + scale * rotate(q, shape.mesh.corner(t, k));
    result.push_back(w);
  }
  return result;
}

/// Smallest gap over all pairs of bodies, by brute force; bodies inside one another count as 0.
double smallest_gap(const Scene& s) {
  const BodyTable& b = s.bodies;
  std::vector<std::vector<test::WorldTriangle>> meshes;
  for (std::size_t i = 0; i < b.size(); ++i) {
    meshes.push_back(world_triangles(s.shapes[static_cast<std::size_t>(b.shape[i])], b.scale[i], b.position[i], b.orientation[i]));
  }
  const auto radius = [&](std::size_t i) { return b.scale[i] * s.shapes[static_cast<std::size_t>(b.shape[i])].sphere_radius; };
  const auto reach = [&](std::size_t i) { return b.scale[i] * s.shapes[static_cast<std::size_t>(b.shape[i])].bounding_radius(); };
  double smallest = 1e300;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (length(b.position[i] - b.position[j]) - reach(i) - reach(j) > smallest) continue;  // cannot lower it
      double gap = 0;
      if (meshes[i].empty() && meshes[j].empty()) {
        gap = length(b.position[i] - b.position[j]) - radius(i) - radius(j);
      } else if (meshes[i].empty() || meshes[j].empty()) {
        const std::size_t ball = meshes[i].empty() ? i : j, mesh = meshes[i].empty() ? j : i;
        double d = 1e300;
        for (const test::WorldTriangle& t : meshes[mesh]) {
          d = std::min(d, test::face_distance(b.position[ball], t));
          for (int k = 0; k < 3; ++k) {
            d = std::min(d, test::segment_distance(t.p[k], t.p[(k + 1) % 3], b.position[ball], b.position[ball] + Vec3{1e-13, 0, 0}));
          }
        }
        gap = test::ray_says_inside(meshes[mesh], b.position[ball]) ? 0 : d - radius(ball);
      } else {
        gap = test::brute_mesh_distance(meshes[i], meshes[j]);
        if (test::ray_says_inside(meshes[i], meshes[j][0].p[0]) || test::ray_says_inside(meshes[j], meshes[i][0].p[0])) gap = 0;
      }
      smallest = std::min(smallest, gap);
    }
  }
  return smallest;
}

TEST_F(Packing, all_bodies_keep_the_margins_from_each_other_by_brute_force) {
  const PackedScene packed = pack(kHead + kMixture + kBox);
  ASSERT_EQ(packed.scene.bodies.size(), 30u);
  const double gap = smallest_gap(packed.scene);
  EXPECT_GE(gap, 2 * 0.002 * (1 - 1e-9));  // contact starts at the sum of two margins
  EXPECT_LT(gap, 0.05);                    // dense enough to be a test
}

TEST_F(Packing, all_bodies_keep_the_margins_from_the_walls) {
  const Scene s = pack(kHead + kMixture + kBox).scene;
  double least = 1e300;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const Shape& shape = s.shapes[static_cast<std::size_t>(s.bodies.shape[i])];
    for (const Vec3& p : shape.mesh.vertices) {
      const Vec3 x = s.bodies.position[i] + s.bodies.scale[i] * rotate(s.bodies.orientation[i], p);
      for (int k = 0; k < 3; ++k)
        least = std::min({least, x[k] - s.bodies.scale[i] * shape.sphere_radius, 0.5 - x[k] - s.bodies.scale[i] * shape.sphere_radius});
    }
  }
  EXPECT_GE(least, 2 * 0.002 * (1 - 1e-12));
  EXPECT_LT(least, 0.02);
}

TEST_F(Packing, the_same_seed_gives_the_same_scene_bit_for_bit_and_another_seed_another) {
  const Scene a = pack(kHead + kMixture + kBox).scene, b = pack(kHead + kMixture + kBox).scene;
  EXPECT_EQ(a.bodies.position, b.bodies.position);
  EXPECT_EQ(a.bodies.orientation, b.bodies.orientation);
  EXPECT_EQ(a.bodies.scale, b.bodies.scale);
  EXPECT_EQ(a.bodies.shape, b.bodies.shape);
  std::string other = kHead + kMixture + kBox;
  other.replace(other.find("seed = 3"), 8, "seed = 4");
  EXPECT_NE(pack(other).scene.bodies.position, a.bodies.position);
}

TEST_F(Packing, ids_count_bodies_then_walls_then_populations) {
  const std::string body = "[[bodies]]\nshape = \"cube\"\nmaterial = \"stone\"\nposition = [0.25, 0.25, 0.25]\nscale = 0.05\n";
  const PackedScene packed = pack(kHead + body + kMixture + kMixture + kBox);
  const Scene& s = packed.scene;
  EXPECT_EQ(s.bodies.id.front(), 0);
  EXPECT_EQ(s.walls[0].id, 1);
  for (std::size_t i = 1; i < s.bodies.size(); ++i) {
    EXPECT_EQ(s.bodies.id[i], static_cast<std::int64_t>(i + 1));
    EXPECT_EQ(s.bodies.population[i], i <= 30 ? 0 : 1);
  }
  EXPECT_EQ(s.bodies.population[0], -1);
  EXPECT_GE(smallest_gap(s), 2 * 0.002 * (1 - 1e-9));
}

TEST_F(Packing, shares_are_by_number_and_exact) {
  const Scene s = pack(kHead + kMixture + kBox).scene;
  std::map<std::string, int> count;
  for (std::int32_t shape : s.bodies.shape) ++count[s.shapes[static_cast<std::size_t>(shape)].name];
  EXPECT_EQ(count["l"], 15);
  EXPECT_EQ(count["rock"], 9);
  EXPECT_EQ(count["ball"], 6);
}

TEST_F(Packing, sizes_are_diameters_of_equivalent_spheres) {
  const Scene s = pack(kHead + kMixture + kBox).scene;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const double volume = s.mass(i) / 2500;
    const double diameter = std::cbrt(6 * volume / std::numbers::pi);
    EXPECT_GE(diameter, 0.06 * (1 - 1e-12));
    EXPECT_LE(diameter, 0.09 * (1 + 1e-12));
  }
}

TEST_F(Packing, a_mass_or_a_solid_fraction_is_met_to_within_half_a_body) {
  const auto population = [](const std::string& amount) {
    return "[[populations]]\nshape = \"cube\"\nmaterial = \"stone\"\n" + amount +
           "\nsize = \"50 mm\"\nregion = { box = [[0.01, 0.01, 0.01], [0.49, 0.49, 0.49]] }\n";
  };
  const double volume = std::numbers::pi / 6 * std::pow(0.05, 3), mass = 2500 * volume;
  Scene s = pack(kHead + population("mass = \"4 kg\"") + kBox).scene;
  EXPECT_EQ(s.bodies.size(), static_cast<std::size_t>(std::lround(4 / mass)));
  const PackedScene packed = pack(kHead + population("solid_fraction = 0.1") + kBox);
  EXPECT_EQ(packed.scene.bodies.size(), static_cast<std::size_t>(std::lround(0.1 * std::pow(0.48, 3) / volume)));
  EXPECT_NEAR(packed.report.solid_fraction[0], 0.1, 0.5 * volume / std::pow(0.48, 3));
  EXPECT_NEAR(packed.report.container_volume, 0.125, 1e-15);
}

TEST_F(Packing, an_impossible_packing_says_how_many_were_placed_and_what_to_do) {
  std::string text = kHead + kMixture + kBox;
  text.replace(text.find("count = 30"), 10, "count = 700");
  const std::string message = failure(text);
  for (const char* part : {"case.toml:", "populations[0]", " of 700 bodies", "solid fraction reached is 0.", "Enlarge the region"}) {
    EXPECT_NE(message.find(part), std::string::npos) << part << " not in: " << message;
  }
  const int placed = std::stoi(message.substr(message.find("placed ") + 7));
  EXPECT_GT(placed, 30);  // kMixture itself can be placed: it did try
  EXPECT_LT(placed, 700);
}

TEST_F(Packing, rocks_are_placed_at_random_as_densely_as_only_a_vacancy_map_finds) {
  const std::string dense = R"(
[[populations]]
shape = "rock"
material = "stone"
solid_fraction = 0.265
size = { distribution = "uniform", min = "0.45 m", max = "0.5 m" }
region = { box = [[0, 0, 0], [4, 4, 4]] }
)";
  const PackedScene packed = pack(kHead + dense);
  EXPECT_NEAR(packed.report.solid_fraction[0], 0.265, 0.001);
  EXPECT_GT(packed.report.attempts, 32 * packed.scene.bodies.size());  // it did need the vacancy map
  EXPECT_GE(smallest_gap(packed.scene), 2 * packed.scene.settings.margin * (1 - 1e-9));
}

TEST_F(Packing, a_place_at_the_seam_of_a_periodic_axis_is_found) {
  // a ball of diameter 1 m in a channel of its own width leaves 22 mm, around the seam, for the centre of another
  const std::string channel = R"(
[domain]
min = [0, -1, -1]
max = [2.03, 2, 2]
periodic = ["x"]
[[bodies]]
shape = "ball"
material = "stone"
position = [1.015, 0.5, 0.5]
[[populations]]
shape = "ball"
material = "stone"
count = 1
region = { box = [[0, 0, 0], [2.03, 1, 1]] }
)";
  const PackedScene packed = pack(kHead + channel);
  EXPECT_GE(std::abs(packed.scene.bodies.position[1].x - 1.015), 1.004);
  EXPECT_GT(packed.report.attempts, 32u);  // plain draws missed it: the vacancy map has the seam
}

TEST_F(Packing, a_body_larger_than_its_region_is_an_impossible_packing) {
  std::string text = kHead + kMixture + kBox;
  text.replace(text.find("[[-0.1, -0.1, -0.1], [0.6, 0.6, 0.6]]"), 37, "[[0.2, 0.2, 0.2], [0.255, 0.255, 0.255]]");
  text.replace(text.find("count = 30"), 10, "count = 1");
  text.replace(text.find("l = 0.5, rock = 0.3, ball = 0.2"), 31, "ball = 1");
  const std::string says = failure(text);
  EXPECT_NE(says.find("is larger than the region"), std::string::npos) << says;
}

TEST_F(Packing, a_mesh_wall_is_kept_clear_of) {
  const std::string ramp = "[[walls]]\nshape = { file = \"ramp.shape.h5\" }\nmaterial = \"stone\"\nposition = [0, 0, 0.05]\n";
  const Scene s = pack(kHead + kMixture + kBox + ramp).scene;
  ASSERT_EQ(s.walls[1].kind, WallKind::mesh);
  const auto wall = world_triangles(s.shapes[static_cast<std::size_t>(s.walls[1].shape)], 1, {0, 0, 0.05}, {});
  double least = 1e300;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const Shape& shape = s.shapes[static_cast<std::size_t>(s.bodies.shape[i])];
    if (shape.kind == ShapeKind::sphere) continue;
    least = std::min(
        least, test::brute_mesh_distance(wall, world_triangles(shape, s.bodies.scale[i], s.bodies.position[i], s.bodies.orientation[i])));
  }
  EXPECT_GE(least, 2 * 0.002 * (1 - 1e-9));
}

TEST_F(Packing, a_solid_used_as_a_wall_keeps_the_place_of_its_file_and_holds_nobody) {
  const std::string lump = "[[walls]]\nshape = { file = \"lump.shape.h5\" }\nmaterial = \"stone\"\nposition = [0.25, 0.25, -0.25]\n";
  const Scene s = pack(kHead + kMixture + kBox + lump).scene;  // the lump's centre is now the centre of the box
  for (const Vec3& x : s.bodies.position) EXPECT_GT(length(x - Vec3{0.25, 0.25, 0.25}), 0.19);
}

TEST_F(Packing, a_file_that_is_not_there_is_told_with_its_neighbour_and_a_mesh_with_the_way_to_a_shape) {
  const auto wall = [&](const std::string& file) {
    return failure(kHead + kMixture + kBox + "[[walls]]\nshape = { file = \"" + file + "\" }\nmaterial = \"stone\"\n");
  };
  EXPECT_NE(wall("lumb.shape.h5").find("lump.shape.h5'?"), std::string::npos);
  std::ofstream(folder_ / "tray.STL") << "solid tray\nendsolid\n";
  const std::string mesh = wall("tray.STL");
  EXPECT_NE(mesh.find("scree-mesher import"), std::string::npos) << mesh;
  EXPECT_NE(mesh.find("tray.shape.h5"), std::string::npos) << mesh;
}

TEST_F(Packing, regions_may_be_cylinders_spheres_and_the_insides_of_walls) {
  const std::string population = "\n[[populations]]\nshape = \"ball\"\nmaterial = \"stone\"\ncount = 60\nsize = \"30 mm\"\n";
  const Vec3 axis = normalised(Vec3{1, 2, 2});
  const Scene in_cylinder =
      pack(kHead + population + "region = { cylinder = { start = [0, 0, 0], end = [0.1, 0.2, 0.2], radius = 0.1 } }\n").scene;
  for (const Vec3& p : in_cylinder.bodies.position) {
    const double along = dot(p, axis);
    EXPECT_LE(length(p - along * axis), 0.1 - 0.015);
    EXPECT_GE(along, 0.015);
    EXPECT_LE(along, 0.3 - 0.015);
  }
  const Scene in_sphere = pack(kHead + population + "region = { sphere = { centre = [1, 0, 0], radius = 0.15 } }\n").scene;
  for (const Vec3& p : in_sphere.bodies.position) EXPECT_LE(length(p - Vec3{1, 0, 0}), 0.15 - 0.015);

  // lifters as wide as they are, hollow to the solver: no ball may start in one, where its surface alone would let it lie
  const std::string drum =
      "\n[[walls]]\nname = \"mill\"\nmaterial = \"stone\"\nshape = { drum = { start = [0, 0, 0], end = [0, 0, 0.2], radius = 0.2, "
      "lifters = { count = 4, height = 0.08, width = 0.15, top_width = 0.1 } } }\nposition = [2, 0, 0]\n";
  const Scene in_drum = pack(kHead + population + "region = { inside_wall = \"mill\" }\n" + drum).scene;
  ASSERT_EQ(in_drum.bodies.size(), 60u);
  int beside_lifters = 0;
  for (const Vec3& p : in_drum.bodies.position) {
    const double x = p.x - 2, radius = std::hypot(x, p.y);
    EXPECT_LE(radius, 0.2 - 0.015);
    EXPECT_GE(p.z, 0.015);
    EXPECT_LE(p.z, 0.185);
    beside_lifters += radius > 0.12 ? 1 : 0;
    for (const auto& [along, side] : {std::pair{x, p.y}, {-x, p.y}, {p.y, x}, {-p.y, x}}) {
      EXPECT_FALSE(along > 0.12 && std::abs(side) < 0.05) << "in a lifter: " << p.x << ' ' << p.y;
    }
  }
  EXPECT_GT(beside_lifters, 0);
  EXPECT_NE(
      failure(kHead + population + "region = { inside_wall = \"drum\" }\n" + drum, ExitCode::usage).find("there is no wall named 'drum'"),
      std::string::npos);

  // a wall from a file holds bodies where it is closed, whichever side its triangles face
  TriangleMesh crate = box_mesh({0.3, 0.2, 0.4});
  for (const bool faces_in : {false, true}) {
    if (faces_in)
      for (Triangle& t : crate.triangles) std::swap(t[1], t[2]);
    write_shape_file((folder_ / "crate.shape.h5").string(), {make_surface("crate", crate)}, {});
    const std::string file =
        "\n[[walls]]\nname = \"crate\"\nmaterial = \"stone\"\nshape = { file = \"crate.shape.h5\" }\nposition = [3, 0, 0]\n";
    const Scene in_crate = pack(kHead + population + "region = { inside_wall = \"crate\" }\n" + file).scene;
    const Box3 box = bounding_box(crate);
    for (const Vec3& p : in_crate.bodies.position) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(p[k] - (k == 0 ? 3 : 0), box.lower[k] + 0.015);
        EXPECT_LE(p[k] - (k == 0 ? 3 : 0), box.upper[k] - 0.015);
      }
    }
    if (!faces_in) {
      write_shape_file((folder_ / "crate.shape.h5").string(), {make_solid("crate", crate)}, {});
      EXPECT_NE(
          failure(kHead + population + "region = { inside_wall = \"crate\" }\n" + file, ExitCode::bad_data).find("is a solid, and no body"),
          std::string::npos);
    }
    TriangleMesh open = crate;
    open.triangles.pop_back();
    write_shape_file((folder_ / "crate.shape.h5").string(), {make_surface("crate", open)}, {});
    EXPECT_NE(failure(kHead + population + "region = { inside_wall = \"crate\" }\n" + file, ExitCode::bad_data).find("is not closed"),
              std::string::npos);
  }
}

/// Kolmogorov and Smirnov's distance of 10 000 balls from a closed form, by number.
template <class Cdf>
double distance_of_sizes(const Scene& s, Cdf&& cdf) {
  std::vector<double> sizes;
  for (const double scale : s.bodies.scale) sizes.push_back(scale);  // balls of diameter 1
  std::sort(sizes.begin(), sizes.end());
  double worst = 0;
  const auto n = static_cast<double>(sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double wanted = cdf(sizes[i]), below = static_cast<double>(i) / n;
    worst = std::max({worst, std::abs(below - wanted), std::abs(below + 1 / n - wanted)});
  }
  return worst;
}

TEST_F(Packing, sizes_follow_what_was_asked_within_one_percent_at_ten_thousand_bodies) {
  const auto packed = [&](const std::string& size) {
    return pack(kHead +
                "[[populations]]\nshape = \"ball\"\nmaterial = \"stone\"\ncount = 10000\nregion = { box = [[0, 0, 0], [5, 5, 5]] }\nsize = "
                "{ "
                "distribution = " +
                size + ", min = \"60 mm\", max = \"90 mm\" }\n")
        .scene;
  };
  constexpr double kAsked = 0.01;
  EXPECT_LT(distance_of_sizes(packed("\"uniform\""), [](double d) { return (d - 0.06) / 0.03; }), kAsked);
  const auto phi = [](double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); };
  const auto truncated = [&](const auto& f) { return [f](double d) { return (f(d) - f(0.06)) / (f(0.09) - f(0.06)); }; };
  EXPECT_LT(distance_of_sizes(packed("\"normal\", mean = 0.07, sigma = 0.01"), truncated([&](double d) { return phi((d - 0.07) / 0.01); })),
            kAsked);
  EXPECT_LT(distance_of_sizes(packed("\"lognormal\", median = 0.07, sigma = 0.1"),
                              truncated([&](double d) { return phi(std::log(d / 0.07) / 0.1); })),
            kAsked);
  EXPECT_LT(distance_of_sizes(packed("\"weibull\", scale = 0.07, shape = 8"),
                              truncated([](double d) { return 1 - std::exp(-std::pow(d / 0.07, 8)); })),
            kAsked);
  EXPECT_LT(distance_of_sizes(packed("\"power\", exponent = 3"), truncated([](double d) { return -1 / (d * d); })), kAsked);
}

TEST_F(Packing, a_mixture_by_mass_has_its_shares_of_the_mass) {
  const Scene s = pack(kHead +
                       "[[populations]]\nshapes = { cube = 0.25, ball = 0.75 }\nshares_by = \"mass\"\nmaterial = \"stone\"\ncount = 300\n"
                       "size = { distribution = \"uniform\", min = 0.05, max = 0.1 }\nregion = { box = [[0, 0, 0], [2, 2, 2]] }\n")
                      .scene;
  double mass[2] = {0, 0}, heaviest = 0;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const bool is_ball = s.shapes[static_cast<std::size_t>(s.bodies.shape[i])].kind == ShapeKind::sphere;
    mass[is_ball ? 1 : 0] += s.mass(i);
    heaviest = std::max(heaviest, s.mass(i));
  }
  EXPECT_NEAR(mass[0], 0.25 * (mass[0] + mass[1]), heaviest);  // to one body
}

TEST_F(Packing, aligned_bodies_scatter_about_their_direction_as_asked) {
  const std::string population =
      "[[populations]]\nshape = \"brick\"\nmaterial = \"stone\"\ncount = 2000\nregion = { box = [[0, 0, 0], [9, 9, 9]] }\n";
  write_shape_file((folder_ / "brick.shape.h5").string(), {make_solid("brick", box_mesh({0.1, 0.3, 0.2}))}, {{"tool", "test"}});
  const std::string head = kHead + "[shapes.brick]\nfile = \"brick.shape.h5\"\n";
  const Vec3 direction = normalised(Vec3{1, -1, 2});
  const auto tilts = [&](const std::string& orientation, const Vec3& axis) {
    double square = 0, turned = 0;
    const Scene s = pack(head + population + "orientation = { align = [1, -1, 2]" + orientation + " }\n").scene;
    for (const Quat& q : s.bodies.orientation) {
      const double cosine = std::min(1.0, std::abs(dot(rotate(q, axis), direction)));
      square += std::acos(cosine) * std::acos(cosine) / 2000;
      turned += dot(rotate(q, {axis.z, axis.x, axis.y}), normalised(cross(direction, {0, 0, 1}))) / 2000;
    }
    EXPECT_NEAR(turned, 0, 4 * std::sqrt(0.5 / 2000));  // about itself it is turned at random
    return std::sqrt(square);
  };
  EXPECT_LT(tilts("", {0, 1, 0}), 1e-7);  // the longest axis
  EXPECT_LT(tilts(", axis = \"shortest\"", {1, 0, 0}), 1e-7);
  EXPECT_LT(tilts(", axis = [0, 0, 1]", {0, 0, 1}), 1e-7);
  // two components of 0.1 each: the square of the tilt has mean and deviation 0.02
  EXPECT_NEAR(tilts(", scatter = 0.1", {0, 1, 0}), std::sqrt(0.02), 4 * 0.5 * std::sqrt(0.02 / 2000));
  const Scene given = pack(head + population + "orientation = [0.6, 0, 0.8, 0]\n").scene;
  for (const Quat& q : given.bodies.orientation) EXPECT_EQ(q, (Quat{0.6, 0, 0.8, 0}));
}

TEST_F(Packing, a_lattice_fills_a_box_evenly_and_keeps_all_gaps) {
  const std::string population =
      "[[populations]]\nshapes = { l = 1, rock = 1, ball = 1 }\nmaterial = \"stone\"\nmethod = \"lattice\"\nsize = \"45 mm\"\n"
      "count = 60\nregion = { box = [[0, 0, 0], [0.5, 0.5, 0.5]] }\n";
  const Scene s = pack(kHead + population + kBox).scene;
  ASSERT_EQ(s.bodies.size(), 60u);
  EXPECT_GE(smallest_gap(s), 0.004 * (1 - 1e-12));
  Vec3 mean;
  for (const Vec3& p : s.bodies.position) mean += (1.0 / 60) * p;
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], 0.25, 0.05);
  // without jitter, cubes that are not turned make a wall with a gap of two margins: 4 x 4 x 4 of 0.12 in 4 * 0.12 + 5 * 0.004
  const std::string cubes =
      "[[populations]]\nshape = \"cube\"\nmaterial = \"stone\"\nmethod = \"lattice\"\njitter = 0\norientation = [1, 0, 0, 0]\n"
      "size = 0.14888\nregion = { box = [[0.004, 0.004, 0.004], [0.497, 0.497, 0.497]] }\ncount = ";
  EXPECT_EQ(pack(kHead + cubes + "64\n").scene.bodies.size(), 64u);
  const std::string says = failure(kHead + cubes + "65\n");
  EXPECT_NE(says.find("the region has 64"), std::string::npos) << says;
  // a lid over the two lower layers leaves 32 of these places, wherever among the others they lie
  for (const char* lid : {"point = [0, 0, 0.26], normal = [0, 0, -1]", "point = [0, 0, 0.24], normal = [0, 0, 1]"}) {
    const std::string wall = fmt::format("\n[[walls]]\nshape = {{ plane = {{ {} }} }}\nmaterial = \"stone\"\n", lid);
    EXPECT_EQ(pack(kHead + cubes + "32" + wall).scene.bodies.size(), 32u) << lid;
    const std::string more = failure(kHead + cubes + "33" + wall);
    EXPECT_NE(more.find("of which 32 were free"), std::string::npos) << more;
  }
}

TEST_F(Packing, impossible_requests_are_refused_before_work_starts) {
  const auto refusal = [&](const std::string& amount,
                           const std::string& region = "region = { box = [[0.01, 0.01, 0.01], [0.49, 0.49, 0.49]] }") {
    return failure(kHead + "[[populations]]\nshape = \"ball\"\nmaterial = \"stone\"\nsize = \"20 mm\"\n" + amount + "\n" + region + "\n" +
                   kBox);
  };
  const auto says = [](const std::string& text, const char* part) { EXPECT_NE(text.find(part), std::string::npos) << text; };
  says(refusal("solid_fraction = 0.6"), "cannot be reached by random placement");
  says(refusal("solid_fraction = 0.76\nmethod = \"compact\""), "more than equal balls can have");
  says(refusal("count = 1000000000000"), "the bodies alone take");  // and not after drawing them all
  says(refusal("mass = \"1 t\""), "the bodies alone take");
  says(refusal("count = 3", "region = { box = [[0.1, 0.1, 0.1], [0.4, 0.4, 0.115]] }"), "is larger than the region");
  says(refusal("count = 3", "region = { box = [[0.6, 0.1, 0.1], [0.9, 0.4, 0.4]] }"), "lies outside");
  says(refusal("count = 3", "region = { box = [[0.1, 0.1, 0.1], [0.4, 0.4, 0.4]] }\n[domain]\nmin = [1, 0, 0]\nmax = [2, 1, 1]"),
       "outside the domain along x");
}

TEST_F(Packing, a_region_may_be_a_closed_mesh) {
  std::string text = kHead + kMixture;
  text.replace(text.find("{ box = [[-0.1, -0.1, -0.1], [0.6, 0.6, 0.6]] }"), 47, "{ inside = \"lump.shape.h5\" }");
  text.replace(text.find("count = 30"), 10, "count = 5");
  const Scene s = pack(text).scene;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const Shape& shape = s.shapes[static_cast<std::size_t>(s.bodies.shape[i])];
    for (const Vec3& p : shape.mesh.vertices) {
      const Vec3 x = s.bodies.position[i] + s.bodies.scale[i] * rotate(s.bodies.orientation[i], p);
      EXPECT_LT(length(x - Vec3{0, 0, 0.5}), 0.2);  // the icosphere lies inside its sphere
    }
  }
}

TEST_F(Packing, cylinder_and_sphere_walls_hold_their_bodies) {
  const std::string cylinder =
      "[[walls]]\nshape = { cylinder_inside = { start = [0.25, 0.25, 0], end = [0.25, 0.25, 0.5], radius = 0.2 } }\nmaterial = \"stone\"\n";
  const std::string sphere =
      "[[walls]]\nshape = { sphere_inside = { centre = [0.25, 0.25, 0.25], radius = 0.22 } }\nmaterial = \"stone\"\n";
  std::string text = kHead + kMixture + cylinder + sphere;
  text.replace(text.find("count = 30"), 10, "count = 8");
  const Scene s = pack(text).scene;
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    const Shape& shape = s.shapes[static_cast<std::size_t>(s.bodies.shape[i])];
    const double rounding = s.bodies.scale[i] * shape.sphere_radius;
    for (const Vec3& p : shape.mesh.vertices) {
      const Vec3 x = s.bodies.position[i] + s.bodies.scale[i] * rotate(s.bodies.orientation[i], p) - Vec3{0.25, 0.25, 0.25};
      EXPECT_LE(std::hypot(x.x, x.y) + rounding, 0.2 - 0.004 + 1e-12);
      EXPECT_LE(length(x) + rounding, 0.22 - 0.004 + 1e-12);
    }
  }
}

std::string cube_at(double x, double scale, const std::string& more = "", const std::string& shape = "cube") {
  return fmt::format("[[bodies]]\nshape = \"{}\"\nmaterial = \"stone\"\nposition = [{}, 0, 0]\nscale = {}\n{}\n", shape, x, scale, more);
}

TEST_F(Packing, given_bodies_that_overlap_are_refused_by_name) {
  const std::string message = failure(kHead + cube_at(0, 1) + cube_at(0.9, 1));
  EXPECT_NE(message.find("bodies[1]"), std::string::npos) << message;
  EXPECT_NE(message.find("overlaps case.toml"), std::string::npos) << message;
  EXPECT_NO_THROW(pack(kHead + cube_at(0, 1) + cube_at(1.1, 1)));
}

TEST_F(Packing, given_bodies_closer_than_the_margins_are_a_notice) {
  std::string text = kHead;
  text.replace(text.find("margin = "), 0, "relax = false\n");
  const PackedScene packed = pack(text + cube_at(0, 1) + cube_at(1.001, 1) + cube_at(2.2, 1));
  ASSERT_FALSE(packed.report.notices.empty());
  int told = 0;
  for (const std::string& notice : packed.report.notices) told += notice.find("starts in contact") != std::string::npos ? 1 : 0;
  EXPECT_EQ(told, 1);
}

TEST_F(Packing, many_given_bodies_in_contact_are_counted_and_the_first_ones_named) {
  std::string text = kHead;
  text.replace(text.find("margin = "), 0, "relax = false\n");
  for (int n = 0; n < 9; ++n) text += cube_at(1.001 * n, 1);
  const PackedScene packed = pack(text);
  int named = 0, counted = 0;
  for (const std::string& notice : packed.report.notices) {
    named += notice.find("starts in contact") != std::string::npos ? 1 : 0;
    counted += notice.find("8 pairs of given bodies") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(named, 5);
  EXPECT_EQ(counted, 1);
}

TEST_F(Packing, a_body_inside_the_solid_of_another_is_refused_but_one_in_a_hollow_is_not) {
  EXPECT_NE(failure(kHead + cube_at(0, 1) + cube_at(0, 0.3)).find("overlaps"), std::string::npos);
  EXPECT_NE(failure(kHead + cube_at(0, 0.3) + cube_at(0, 1)).find("overlaps"), std::string::npos);
  EXPECT_NO_THROW(pack(kHead + cube_at(0, 1, "", "shell") + cube_at(0, 0.3)));
  EXPECT_NE(failure(kHead + cube_at(0, 1, "", "ball") + cube_at(0, 0.3)).find("overlaps"), std::string::npos);
}

const std::string kRelaxed = [] {
  std::string text = kHead;
  return text.replace(text.find("margin = "), 0, "relax = true\n");
}();

std::string told(const PackedScene& packed) { return fmt::format("{}", fmt::join(packed.report.notices, "\n")); }

// X10 relaxed: along the axis with the shortest way out, each in inverse proportion to its mass, to two margins exactly.
TEST_F(Packing, bodies_that_overlap_are_parted_the_shortest_way_where_the_case_asks_for_it) {
  for (const double scale : {1.0, 0.5}) {
    const PackedScene packed = pack(kRelaxed + cube_at(0, 1) + cube_at(0.4, scale));
    const std::vector<Vec3>& x = packed.scene.bodies.position;
    const double apart = 0.5 + 0.5 * scale + 0.004, mass = scale * scale * scale;
    EXPECT_NEAR(x[1].x - x[0].x, apart, 1e-10);
    EXPECT_NEAR(x[0].x + mass * x[1].x, mass * 0.4, 1e-12) << "the centre of mass moved";
    for (const Vec3& p : x) EXPECT_EQ(std::abs(p.y) + std::abs(p.z), 0);
    EXPECT_NE(told(packed).find("2 bodies separated"), std::string::npos) << told(packed);
    EXPECT_NE(told(packed).find("changed by 0 J"), std::string::npos) << told(packed);
    EXPECT_EQ(told(packed).find("starts in contact"), std::string::npos) << told(packed);
  }
}

TEST_F(Packing, bodies_at_one_place_inside_each_other_and_behind_walls_are_parted) {
  const PackedScene same = pack(kRelaxed + cube_at(0, 1) + cube_at(0, 1) + cube_at(0.1, 0.3));
  EXPECT_GE(smallest_gap(same.scene), 0.004 * (1 - 1e-12));
  // an L around the end of a fixed one, not convex
  const PackedScene hooked = pack(kRelaxed + cube_at(0, 1, "fixed = true", "l") + cube_at(0.1, 1, "", "l"));
  EXPECT_GE(smallest_gap(hooked.scene), 0.004 * (1 - 1e-12));
  EXPECT_EQ(hooked.scene.bodies.position[0], (Vec3{0, 0, 0}));
  // behind a plane and too near to the sides of a box; the way up costs 2500 kg 9.81 m/s^2 2.504 m
  const std::string plane = "[[walls]]\nshape = { plane = { point = [0, 0, 2], normal = [0, 0, 1] } }\nmaterial = \"stone\"\n";
  const PackedScene lifted = pack(kRelaxed + plane + cube_at(0, 1));
  EXPECT_NEAR(lifted.scene.bodies.position[0].z, 2.504, 1e-10);
  EXPECT_NE(told(lifted).find(fmt::format("changed by {:.3g} J", 2500 * 9.81 * 2.504)), std::string::npos) << told(lifted);
  // what is legal stays: a cube in the hollow of a shell
  const PackedScene shell = pack(kRelaxed + cube_at(0, 1, "", "shell") + cube_at(0, 0.3));
  EXPECT_EQ(shell.scene.bodies.position[1], (Vec3{0, 0, 0}));
}

TEST_F(Packing, bodies_without_room_to_be_parted_are_refused_by_name) {
  std::string box = "[[walls]]\nshape = { box_inside = [[-0.6, -0.6, -0.6], [0.6, 0.6, 0.6]] }\nmaterial = \"stone\"\n";
  EXPECT_NE(failure(kRelaxed + box + cube_at(0, 1) + cube_at(0, 1)).find("sweeps of separation"), std::string::npos);
}

TEST_F(Packing, a_body_behind_a_wall_is_refused) {
  const std::string plane = "[[walls]]\nshape = { plane = { point = [1, 0, 0], normal = [1, 0, 0] } }\nmaterial = \"stone\"\n";
  EXPECT_NE(failure(kHead + cube_at(0, 0.5) + plane).find("lies wholly behind "), std::string::npos);
  const std::string box = "[[walls]]\nname = \"crate\"\nshape = { box_inside = [[-1, -1, -1], [1, 1, 1]] }\nmaterial = \"stone\"\n";
  const std::string outside = failure(kHead + cube_at(3, 0.5) + box);
  EXPECT_NE(outside.find("walls[0] (wall 'crate'), on the side where no body can be"), std::string::npos) << outside;
  EXPECT_EQ(outside.find("contact.relax"), std::string::npos) << outside;
  EXPECT_NO_THROW(pack(kHead + cube_at(2, 0.5) + plane));
  EXPECT_NO_THROW(pack(kHead + cube_at(0, 0.5, "fixed = true") + plane));
}

TEST_F(Packing, a_body_outside_the_domain_is_refused) {
  EXPECT_NE(failure(kHead + cube_at(0, 1) + "[domain]\nmin = [1, 1, 1]\nmax = [2, 2, 2]\n").find("outside the domain"), std::string::npos);
}

TEST_F(Packing, populations_keep_clear_of_given_bodies) {
  const std::string big = "[[bodies]]\nshape = \"cube\"\nmaterial = \"stone\"\nposition = [0.25, 0.25, 0.25]\nscale = 0.25\n";
  std::string text = kHead + big + kMixture + kBox;
  text.replace(text.find("count = 30"), 10, "count = 15");
  EXPECT_GE(smallest_gap(pack(text).scene), 2 * 0.002 * (1 - 1e-9));
}

// A gate that drops away from a body hits nothing: what counts is the fall to where it stops.
TEST_F(Packing, a_gate_that_moves_away_is_no_impact) {
  const auto fastest = [&](const char* velocity) {
    std::string text =
        kHead + "[[bodies]]\nshape = \"cube\"\nmaterial = \"stone\"\nposition = [0, 0, 2]\n" +
        "[[walls]]\nshape = { plate = { corner = [-3, -3, 0], side_a = [6, 0, 0], side_b = [0, 6, 0] } }\nmaterial = \"stone\"\n" +
        "motion = { translate = { velocity = [0, 0, " + velocity + "] }, stop = 0.25 }\n";
    return pack(text).report.fastest_impact;
  };
  EXPECT_NEAR(fastest("-4"), std::sqrt(2 * 9.81 * 3), 1e-12);
  EXPECT_NEAR(fastest("0.4"), std::sqrt(2 * 9.81 * 2) + 0.4, 1e-12);
}

TEST_F(Packing, a_margin_that_is_refused_comes_with_what_goes_together) {
  std::string text = kHead + "[[bodies]]\nshape = \"cube\"\nmaterial = \"stone\"\nposition = [0, 0, 4.5]\n" +
                     "[[walls]]\nshape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }\nmaterial = \"stone\"\n";
  text.replace(text.find("[contact]\nmargin = \"2 mm\"\n"), 26, "");
  const auto with = [&](const std::string& stiffness, const std::string& more) {
    std::string t = text;
    t.replace(t.find("stiffness = 1e7"), 15, "stiffness = " + stiffness);
    return t + more;
  };
  const std::string said = failure(with("1e5", ""), ExitCode::usage);
  const std::string first = "- pairs.stiffness = \"", second = "- contact.impact_speed = \"";
  ASSERT_NE(said.find(first), std::string::npos) << said;
  ASSERT_NE(said.find(second), std::string::npos) << said;
  const auto value = [&](const std::string& after) {
    const std::size_t begin = said.find(after) + after.size();
    return "\"" + said.substr(begin, said.find('"', begin) - begin) + "\"";
  };
  // each of them is taken, with the margin that was promised
  const double good = 0.05 * std::cbrt(6 / std::numbers::pi);
  EXPECT_NEAR(pack(with(value(first), "")).scene.settings.margin, good, 1e-3 * good);
  EXPECT_NEAR(pack(with("1e5", "[contact]\nimpact_speed = " + value(second) + "\n")).scene.settings.margin, good, 1e-3 * good);
}

TEST_F(Packing, the_margin_follows_the_design_rule_when_it_is_not_given) {
  // a cube of 1 m and 2500 kg that falls 4.5 m in 1 s at most: v = sqrt(2 g 4.5), depth = v sqrt(m/k) = 0.4 x 2 margins
  std::string text = kHead + "[[bodies]]\nshape = \"cube\"\nmaterial = \"stone\"\nposition = [0, 0, 4.5]\n" +
                     "[[walls]]\nshape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }\nmaterial = \"stone\"\n";
  text.replace(text.find("[contact]\nmargin = \"2 mm\"\n"), 26, "");
  text.replace(text.find("stiffness = 1e7"), 15, "stiffness = 1e9");
  const PackedScene packed = pack(text);
  const double speed = std::sqrt(2 * 9.81 * 4.5);
  EXPECT_NEAR(packed.report.fastest_impact, speed, 1e-12);
  EXPECT_NEAR(packed.scene.settings.margin, speed * std::sqrt(2500 / 1e9) / 0.8, 1e-15);
  EXPECT_NEAR(packed.report.overlap_share, 0.4, 1e-12);
}

TEST_F(Packing, a_margin_that_could_not_be_kept_small_is_refused_with_a_stiffness) {
  std::string text = kHead + cube_at(0, 1, "velocity = [100, 0, 0]");
  text.replace(text.find("[contact]\nmargin = \"2 mm\"\n"), 26, "");
  text += cube_at(3, 1);
  EXPECT_NE(failure(text, ExitCode::usage).find("a stiffness of"), std::string::npos);
}

TEST_F(Packing, margin_zero_is_for_analytic_spheres_only) {
  std::string text = kHead;
  text.replace(text.find("margin = \"2 mm\""), 15, "margin = 0");
  EXPECT_NE(failure(text + cube_at(0, 1), ExitCode::usage).find("margin > 0"), std::string::npos);
  EXPECT_NO_THROW(pack(text + cube_at(0, 1, "", "ball")));
}

TEST_F(Packing, a_missing_shape_file_is_named_with_the_line_that_asks_for_it) {
  std::string text = kHead + kMixture;
  text.replace(text.find("l.shape.h5"), 10, "x.shape.h5");
  const std::string message = failure(text);
  EXPECT_NE(message.find("shapes.l"), std::string::npos) << message;
  EXPECT_NE(message.find("no such file"), std::string::npos) << message;
}

TEST_F(Packing, a_file_of_several_shapes_wants_a_name) {
  write_shape_file((folder_ / "two.shape.h5").string(), {make_sphere("a", 1), make_sphere("b", 2)}, {});
  std::string text = kHead + cube_at(0, 1);
  text.replace(text.find("cube.shape.h5\""), 14, "two.shape.h5\"");
  EXPECT_NE(failure(text, ExitCode::usage).find("(a, b)"), std::string::npos);
  text.replace(text.find("two.shape.h5\""), 13, "two.shape.h5\"\nname = \"b\"");
  EXPECT_EQ(pack(text).scene.shapes[0].sphere_radius, 2);
}

TEST_F(Packing, the_inputs_hold_hash_and_history_of_every_file) {
  const PackedScene packed = pack(kHead + kMixture + kBox);
  ASSERT_EQ(packed.inputs.size(), 3u);  // the case, and the two shape files that are used
  EXPECT_EQ(packed.inputs[0].path, "case.toml");
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_EQ(packed.inputs[i].sha256, sha256_of_file(packed.inputs[i].path));
    EXPECT_EQ((*packed.inputs[i].history)["tool"], "test");
  }
}

TEST_F(Packing, bodies_in_contact_are_expected_to_cost_more_than_one_alone_also_across_a_periodic_side) {
  const std::string periodic = "[domain]\nmin = [-5, -5, -5]\nmax = [5, 5, 5]\nperiodic = [\"x\"]\n";
  for (const auto& [first, second] : {std::pair{0.0, 1.001}, {-4.5, 4.499}}) {
    const std::vector<double> work =
        predicted_work(pack(kHead + periodic + cube_at(first, 1) + cube_at(second, 1) + cube_at(2.75, 1)).scene).of_body;
    ASSERT_EQ(work.size(), 3u);
    EXPECT_EQ(work[0], work[1]);
    EXPECT_GT(work[0], 1.5 * work[2]);
  }
}

TEST_F(Packing, a_cube_against_a_wall_and_a_body_of_three_moments_are_expected_to_cost_more_than_a_cube_in_the_air) {
  const std::string wall = "[[walls]]\nshape = { plane = { point = [-0.501, 0, 0], normal = [1, 0, 0] } }\nmaterial = \"stone\"\n";
  const std::vector<double> work =
      predicted_work(pack(kHead + cube_at(0, 1) + cube_at(5, 1) + cube_at(10, 1, "", "l") + wall).scene).of_body;
  ASSERT_EQ(work.size(), 3u);
  EXPECT_GT(work[0], 1.5 * work[1]);
  EXPECT_GT(work[2], 1.5 * work[1]);
}

TEST_F(Packing, a_partition_gives_every_body_the_rank_of_its_box_and_balances_the_work) {
  Scene s = pack(kHead + kMixture + kBox).scene;
  const PredictedWork predicted = predicted_work(s);
  const std::vector<double>& work = predicted.of_body;
  partition_scene(s, predicted, 3);
  const CutBoxes boxes{s.partition.lower, s.partition.upper};
  std::vector<double> sum(3, 0.0);
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    EXPECT_EQ(s.bodies.owner[i], boxes.rank_of(s.bodies.position[i]));
    sum[static_cast<std::size_t>(s.bodies.owner[i])] += work[i];
  }
  // both owners compute a pair across ranks: the half that the other's body bears comes on top
  for (const PairWork& pair : predicted.pairs) {
    const auto a = static_cast<std::size_t>(s.bodies.owner[static_cast<std::size_t>(pair.a)]);
    const auto b = static_cast<std::size_t>(s.bodies.owner[static_cast<std::size_t>(pair.b)]);
    if (a == b) continue;
    sum[a] += 0.5 * pair.work;
    sum[b] += 0.5 * pair.work;
  }
  const double mean = (sum[0] + sum[1] + sum[2]) / 3;
  EXPECT_NEAR(s.partition.predicted_imbalance, *std::max_element(sum.begin(), sum.end()) / mean, 1e-12);
  // a part lies between two cuts, and each may take one body too many
  EXPECT_LT(s.partition.predicted_imbalance, 1 + 2 * *std::max_element(work.begin(), work.end()) / mean);
}

}  // namespace
}  // namespace scree
