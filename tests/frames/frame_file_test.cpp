// Frames written by 1, 2 and 4 ranks, read back serially. What is expected is the function of the id in
// frame_values.hpp, bit for bit: a frame stores doubles and loses nothing.
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/storage/h5.hpp"
#include "tests/frames/frame_fixture.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

int world_rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
int world_size() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// A fresh folder, the same on every rank, one for each number of ranks since they may run at once.
fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(SCREE_TEST_FOLDER) / (name + "_" + std::to_string(world_size()));
  if (world_rank() == 0) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder;
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void expect_whole(const Frame& frame, std::int64_t count, int owners) {
  ASSERT_EQ(frame.bodies.size(), static_cast<std::size_t>(count));
  for (std::int64_t id = 0; id < count; ++id) {
    const auto i = static_cast<std::size_t>(id);
    EXPECT_EQ(frame.bodies.id[i], id);
    EXPECT_EQ(frame.bodies.shape[i], id % 3);
    EXPECT_EQ(frame.bodies.material[i], id % 2);
    EXPECT_EQ(frame.bodies.rank[i], id % owners);
    EXPECT_EQ(frame.bodies.scale[i], 1 + 0.001 * static_cast<double>(id));
    EXPECT_EQ(frame.bodies.position[i], test::position_of(id));
    EXPECT_EQ(frame.bodies.orientation[i], test::orientation_of(id));
    EXPECT_EQ(frame.bodies.velocity[i], test::velocity_of(id));
    EXPECT_EQ(frame.bodies.angular_velocity[i], test::spin_of(id));
  }
  ASSERT_EQ(frame.contacts.size(), static_cast<std::size_t>(count > 0 ? count - 1 : 0));
  for (std::size_t i = 0; i < frame.contacts.size(); ++i) {
    const auto id = static_cast<std::int64_t>(i);
    EXPECT_EQ(frame.contacts.body_a[i], id);
    EXPECT_EQ(frame.contacts.body_b[i], id + 1);
    EXPECT_EQ(frame.contacts.feature[i], 7 * id + (std::int64_t{1} << 40));
    EXPECT_EQ(frame.contacts.overlap[i], 1e-5 * static_cast<double>(id));
    EXPECT_EQ(frame.contacts.normal_force[i], 3.0 * static_cast<double>(id));
    EXPECT_EQ(frame.contacts.tangential_force[i], (Vec3{static_cast<double>(id), 0, 0}));
  }
  EXPECT_EQ(frame.number, 12);
  EXPECT_EQ(frame.step, 3400);
  EXPECT_EQ(frame.time, 0.25);
  EXPECT_EQ(frame.kinetic, 1.5);
  EXPECT_EQ(frame.potential, -2.5);
  EXPECT_EQ(frame.elastic, 0.125);
  EXPECT_EQ(frame.dissipated, 3);
  ASSERT_EQ(frame.walls.id.size(), 2u);
  EXPECT_EQ(frame.walls.id[1], count + 1);
  EXPECT_EQ(frame.walls.position[1], (Vec3{0, 0, 0.5}));
  EXPECT_EQ(frame.walls.force[1], (Vec3{4, 5, 6}));
  EXPECT_EQ(frame.walls.torque[0], (Vec3{-1, -2, -3}));
  EXPECT_EQ(frame.provenance->at("text"), "Größe");
}

void write_and_compare(const std::string& name, std::int64_t count, int owners) {
  const fs::path folder = fresh_folder(name);
  const std::string path = (folder / "frame_000012.hdf").string();
  write_frame_file(MPI_COMM_WORLD, path, test::share_of(count, world_rank(), owners));
  if (world_rank() == 0) {
    expect_whole(read_frame_file(path), count, owners);
    EXPECT_EQ(files_in(folder), 1u) << "something is left beside the frame";
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

// 10 rows are stored contiguously, 3000 and 40000 in compressed chunks (one, several).
TEST(FrameFile, a_few_bodies_come_back_bit_for_bit) { write_and_compare("few", 10, world_size()); }
TEST(FrameFile, thousands_of_bodies_come_back_bit_for_bit) { write_and_compare("thousands", 3000, world_size()); }
TEST(FrameFile, several_chunks_come_back_bit_for_bit) { write_and_compare("chunks", 40000, world_size()); }
TEST(FrameFile, a_rank_may_own_nothing) {
  write_and_compare("idle_few", 10, 1);
  write_and_compare("idle_thousands", 3000, 1);
}
TEST(FrameFile, one_body_on_any_number_of_ranks) { write_and_compare("one", 1, world_size()); }
TEST(FrameFile, a_frame_without_bodies_is_a_frame) { write_and_compare("none", 0, world_size()); }

TEST(FrameFile, a_missing_folder_is_a_system_error_on_every_rank) {
  const std::string path = (fresh_folder("missing") / "nowhere" / "frame_000000.hdf").string();
  try {
    write_frame_file(MPI_COMM_WORLD, path, test::share_of(10, world_rank(), 1));
    FAIL() << "written into a folder that does not exist";
  } catch (const SystemError& error) {
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
  }
}

/// A tmpfs of the given size mounted for one test; says so when this process may not mount.
class SmallDisk {
 public:
  SmallDisk(fs::path folder, const char* size) : folder_(std::move(folder)) {
    int mounted = 0;
    if (world_rank() == 0) mounted = mount("none", folder_.c_str(), "tmpfs", 0, size) == 0 ? 1 : 0;
    MPI_Bcast(&mounted, 1, MPI_INT, 0, MPI_COMM_WORLD);
    mounted_ = mounted == 1;
  }
  ~SmallDisk() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (mounted_ && world_rank() == 0) umount(folder_.c_str());
  }
  bool mounted() const { return mounted_; }

 private:
  fs::path folder_;
  bool mounted_ = false;
};

TEST(FrameFile, a_full_disk_is_a_system_error_on_every_rank_and_leaves_nothing) {
  const fs::path folder = fresh_folder("full");
  const SmallDisk disk(folder, "size=1m");
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small tmpfs needs root";
  const std::string path = (folder / "frame_000000.hdf").string();
  write_frame_file(MPI_COMM_WORLD, path, test::share_of(100, world_rank(), world_size()));  // this one fits
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string next = (folder / "frame_000001.hdf").string();
  try {
    write_frame_file(MPI_COMM_WORLD, next, test::share_of(20000, world_rank(), world_size()));
    ADD_FAILURE() << "4 MB written into 1 MB";
  } catch (const SystemError& error) {
    EXPECT_NE(std::string(error.what()).find("No space left"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(next), std::string::npos) << error.what();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (world_rank() == 0) {
    EXPECT_EQ(files_in(folder), 1u) << "only the first, whole frame may be there";
    EXPECT_EQ(read_frame_file(path).bodies.size(), 100u);
  }
}

template <class Table>
void expect_on_page(const std::string& page) {
  Table::visit([&](const auto& c) {
    const bool is_listed =
        page.find(fmt::format("`{}`", c.path)) != std::string::npos || page.find(fmt::format("`{}`", c.dataset())) != std::string::npos;
    EXPECT_TRUE(is_listed) << c.path;
  });
}

TEST(FrameFile, every_quantity_is_on_the_page_of_the_format) {
  std::ifstream file(SCREE_RUN_FORMAT);
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  expect_on_page<FrameBodies>(page);
  expect_on_page<FrameContacts>(page);
  expect_on_page<FrameWalls>(page);
  FrameScalars scalars;
  FrameScalars::visit(scalars, [&](const char* name, const auto&) {
    const bool is_listed =
        page.find(fmt::format("`{}`", name)) != std::string::npos || page.find(fmt::format("`frame@{}`", name)) != std::string::npos;
    EXPECT_TRUE(is_listed) << name;
  });
}

// From here on serial: rank 0 spoils whole frames and reads them.

std::string message_of_reading(const std::string& path) {
  try {
    read_frame_file(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FrameFile, a_truncated_frame_is_refused_by_name_wherever_it_was_cut) {
  const fs::path folder = fresh_folder("truncated");
  const std::string whole = (folder / "frame_000012.hdf").string();
  write_frame_file(MPI_COMM_WORLD, whole, test::share_of(3000, world_rank(), world_size()));
  if (world_rank() != 0) return;
  for (const double part : {0.0, 0.1, 0.5, 0.9, 0.999}) {
    const std::string cut = (folder / "cut.hdf").string();
    fs::copy_file(whole, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, static_cast<std::uintmax_t>(part * static_cast<double>(fs::file_size(whole))));
    EXPECT_NE(message_of_reading(cut).find("cut.hdf"), std::string::npos) << part;
  }
}

TEST(FrameFile, a_newer_version_is_refused_with_both_versions) {
  const fs::path folder = fresh_folder("newer");
  const std::string path = (folder / "frame_000012.hdf").string();
  write_frame_file(MPI_COMM_WORLD, path, test::share_of(3, world_rank(), world_size()));
  if (world_rank() != 0) return;
  {
    const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, path);
    const h5::Handle attribute(H5Aopen(file.id(), "format_version", H5P_DEFAULT), H5Aclose, path);
    const std::int64_t newer = kFrameFormatVersion + 1;
    H5Awrite(attribute.id(), H5T_NATIVE_INT64, &newer);
  }
  const std::string message = message_of_reading(path);
  EXPECT_NE(message.find("version " + std::to_string(kFrameFormatVersion + 1)), std::string::npos) << message;
}

TEST(FrameFile, the_list_of_frames_comes_back_in_time_order) {
  const fs::path folder = fresh_folder("series");
  if (world_rank() != 0) return;
  const std::string b = (folder / "frame_000001.hdf").string(), a = (folder / "frame_000000.hdf").string();
  write_frame_series(folder.string(), {{b, 1.0 / 3.0}, {a, 0.0}});
  const std::vector<FrameEntry> frames = list_frames(folder.string());
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].path, a);
  EXPECT_EQ(frames[0].time, 0.0);
  EXPECT_EQ(frames[1].path, b);
  EXPECT_EQ(frames[1].time, 1.0 / 3.0);
}

TEST(FrameFile, a_folder_that_is_no_run_is_refused) {
  const fs::path folder = fresh_folder("no_run");
  if (world_rank() != 0) return;
  EXPECT_THROW(list_frames(folder.string()), InputError);
  EXPECT_THROW(list_frames((folder / "nowhere").string()), InputError);
  std::ofstream(folder / "frames.hdf.series") << "{\"files\": 3}";
  EXPECT_THROW(list_frames(folder.string()), InputError);
}

}  // namespace
}  // namespace scree
