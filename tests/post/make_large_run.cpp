// A run of any size for measuring the tools: scree_make_large_run FOLDER.run BODIES FRAMES
//
// A cubic lattice of balls and wedges that shakes, in a box, three contacts a body. Positions, velocities and forces differ from
// frame to frame and have random low bits, so that the files are no smaller than real ones.
#include <cstdlib>
#include <random>

#include "core/base/mpi_session.hpp"
#include "tests/post/sample_run.hpp"

namespace {

using namespace scree;

Frame shaken(const Scene& scene, std::int64_t side, std::int64_t number, double time) {
  Frame frame = test::sample_frame(scene, number, 0);
  frame.time = time;
  std::mt19937_64 generator(static_cast<std::uint64_t>(number));
  std::normal_distribution<double> random(0, 1);
  std::exponential_distribution<double> force(1);
  const auto n = static_cast<std::int64_t>(frame.bodies.size());
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    frame.bodies.position[i] += 1e-4 * Vec3{random(generator), random(generator), random(generator)};
    frame.bodies.velocity[i] = 0.1 * Vec3{random(generator), random(generator), random(generator)};
    frame.bodies.angular_velocity[i] = Vec3{random(generator), random(generator), random(generator)};
    frame.bodies.orientation[i] = normalised(Quat{random(generator), random(generator), random(generator), random(generator)});
  }
  const auto contact = [&](std::int64_t a, std::int64_t b) {
    const Vec3 &x = frame.bodies.position[static_cast<std::size_t>(a)], &y = frame.bodies.position[static_cast<std::size_t>(b)];
    test::add_contact(frame, a, b, 0, normalised(x - y), force(generator));
    frame.contacts.point.back() = 0.5 * (x + y);
    frame.contacts.tangential_force.back() = 0.1 * Vec3{random(generator), random(generator), random(generator)};
  };
  for (std::int64_t i = 0; i < n; ++i) {
    if ((i + 1) % side != 0 && i + 1 < n) contact(i, i + 1);
    if (i / side % side + 1 < side && i + side < n) contact(i, i + side);
    if (i + side * side < n) contact(i, i + side * side);
  }
  return frame;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const scree::mpi::Session session(argc, argv);
  const std::filesystem::path folder(argv[1]);
  const auto bodies = static_cast<std::size_t>(std::atoll(argv[2]));
  const int frames = std::atoi(argv[3]);
  const auto side = static_cast<std::int64_t>(std::ceil(std::cbrt(static_cast<double>(bodies))));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Scene scene = test::sample_scene(bodies);
  constexpr double kSpacing = 0.03;
  for (std::size_t i = 0; i < bodies; ++i) {
    const auto k = static_cast<std::int64_t>(i);
    scene.bodies.scale[i] = 1;
    scene.bodies.shape[i] = k % 2 == 0 ? 2 : 1;
    scene.bodies.position[i] = kSpacing * Vec3{0.5 + static_cast<double>(k % side), 0.5 + static_cast<double>(k / side % side),
                                               0.5 + static_cast<double>(k / side / side)};
  }
  scene.walls[0].lower = {0, 0, 0};
  scene.walls[0].upper = kSpacing * static_cast<double>(side) * Vec3{1, 1, 1};
  scene.walls.resize(1);
  write_scene_file((folder / "scene.h5").string(), scene);
  std::vector<FrameEntry> entries;
  for (int f = 0; f < frames; ++f) {
    entries.push_back({(folder / fmt::format("frame_{:06}.hdf", f)).string(), 0.01 * f});
    write_frame_file(MPI_COMM_SELF, entries.back().path, shaken(scene, side, f, entries.back().time));
  }
  write_frame_series(folder.string(), entries);
  h5::write_text_file((folder / "log.csv").string(), test::sample_log(0.05, 1e-7, 0.25));
  h5::write_text_file((folder / "run.json").string(),
                      test::sample_outcome(scene, test::sample_frame(scene, frames - 1, 0.01 * frames)).dump(1));
  return 0;
}
