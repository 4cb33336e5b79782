// Frames: collective writing (collective_file.hpp), serial reading. The pieces of VTKHDF are exactly the runs of rows of the
// ranks, so that a parallel ParaView reads them without any exchange.
#include "core/storage/frame_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "core/base/utf8.hpp"
#include "core/storage/collective_file.hpp"
#include "core/storage/shape_file.hpp"

namespace scree {

namespace {

constexpr std::int64_t kPieceOverhead = 4096;  // [B] piece tables and alignment, per rank

/// Scalars of the frame as rank 0 has them.
struct Header {
  std::int64_t number, step, wall_count;
  double time, kinetic, potential, elastic, dissipated;
};

void check_sizes(const Frame& frame) {
  const FrameBodies& b = frame.bodies;
  const std::size_t n = b.size();
  SCREE_ASSERT(b.shape.size() == n && b.material.size() == n && b.rank.size() == n && b.scale.size() == n && b.position.size() == n &&
               b.orientation.size() == n && b.velocity.size() == n && b.angular_velocity.size() == n);
  const FrameContacts& c = frame.contacts;
  const std::size_t m = c.size();
  SCREE_ASSERT(c.body_b.size() == m && c.feature.size() == m && c.point.size() == m && c.normal.size() == m && c.overlap.size() == m &&
               c.margin.size() == m && c.normal_force.size() == m && c.tangential_force.size() == m);
  const FrameWalls& w = frame.walls;
  const std::size_t k = w.id.size();
  SCREE_ASSERT(w.position.size() == k && w.orientation.size() == k && w.force.size() == k && w.torque.size() == k);
}

void write_vtkhdf(CollectiveFile& file, MPI_Comm communicator, const FrameBodies& bodies, const Rows& rows) {
  const h5::Group vtk = file.root().create_group("VTKHDF");
  {
    const std::int64_t version[2] = {1, 0};
    const hsize_t two = 2;
    const h5::Handle space(H5Screate_simple(1, &two, nullptr), H5Sclose, "VTKHDF@Version");
    const h5::Handle attribute(H5Acreate2(vtk.id(), "Version", H5T_STD_I64LE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                               "VTKHDF@Version");
    H5Awrite(attribute.id(), H5T_NATIVE_INT64, version);
  }
  vtk.write_attribute("Type", "UnstructuredGrid");

  // one piece per rank: n points, n vertex cells, n connectivity entries, n + 1 offsets
  const std::vector<std::int64_t> count{rows.local};
  const Rows pieces = distribute(communicator, 1);
  for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"}) file.write(vtk, name, count, pieces, "");
  std::vector<std::int64_t> offsets(bodies.size() + 1);
  std::iota(offsets.begin(), offsets.end(), 0);
  const std::vector<std::int64_t> connectivity(offsets.begin(), offsets.end() - 1);
  const std::vector<std::uint8_t> types(bodies.size(), 1);  // VTK_VERTEX
  file.write(vtk, "Points", bodies.position, rows, "m");
  file.write(vtk, "Connectivity", connectivity, rows, "");
  file.write(vtk, "Offsets", offsets, {rows.local + 1, rows.start + pieces.start, rows.total + pieces.total}, "");
  file.write(vtk, "Types", types, rows, "");

  const h5::Group data = vtk.create_group("PointData");
  file.write(data, "id", bodies.id, rows, "");
  file.write(data, "quat", bodies.orientation, rows, "");
  file.write(data, "shape", bodies.shape, rows, "");
  file.write(data, "material", bodies.material, rows, "");
  file.write(data, "rank", bodies.rank, rows, "");
  file.write(data, "scale", bodies.scale, rows, "");
  file.write(data, "velocity", bodies.velocity, rows, "m/s");
  file.write(data, "angular_velocity", bodies.angular_velocity, rows, "rad/s");
}

void write_contacts(CollectiveFile& file, const FrameContacts& contacts, const Rows& rows) {
  const h5::Group group = file.root().create_group("contacts");
  file.write(group, "body_a", contacts.body_a, rows, "");
  file.write(group, "body_b", contacts.body_b, rows, "");
  file.write(group, "feature", contacts.feature, rows, "");
  file.write(group, "point", contacts.point, rows, "m");
  file.write(group, "normal", contacts.normal, rows, "");
  file.write(group, "depth", contacts.overlap, rows, "m");
  file.write(group, "margin", contacts.margin, rows, "m");
  file.write(group, "normal_force", contacts.normal_force, rows, "N");
  file.write(group, "tangential_force", contacts.tangential_force, rows, "N");
}

void write_walls(CollectiveFile& file, const FrameWalls& walls, const Rows& rows) {
  const h5::Group group = file.root().create_group("walls");
  file.write(group, "id", walls.id, rows, "");
  file.write(group, "position", walls.position, rows, "m");
  file.write(group, "orientation", walls.orientation, rows, "");
  file.write(group, "force", walls.force, rows, "N");
  file.write(group, "torque", walls.torque, rows, "N m");
}

}  // namespace

void write_frame_file(MPI_Comm communicator, const std::string& path, const Frame& frame) {
  check_sizes(frame);
  int rank = 0, size = 1;
  MPI_Comm_rank(communicator, &rank);
  MPI_Comm_size(communicator, &size);

  // what only rank 0 knows
  Header header{frame.number,  frame.step,      static_cast<std::int64_t>(frame.walls.id.size()),
                frame.time,    frame.kinetic,   frame.potential,
                frame.elastic, frame.dissipated};
  MPI_Bcast(&header, static_cast<int>(sizeof header), MPI_BYTE, 0, communicator);
  const std::string provenance = broadcast_text(communicator, rank == 0 ? json_text(frame.provenance) : std::string());
  const Rows bodies = distribute(communicator, static_cast<std::int64_t>(frame.bodies.size()));
  const Rows contacts = distribute(communicator, static_cast<std::int64_t>(frame.contacts.size()));
  const Rows walls{rank == 0 ? header.wall_count : 0, rank == 0 ? 0 : header.wall_count, header.wall_count};

  // room on the disk, uncompressed
  constexpr std::int64_t kBodyBytes = 8 + 3 * 4 + 8 + 8 * (3 + 4 + 3 + 3) + 8 + 8 + 1;
  constexpr std::int64_t kContactBytes = 8 * (3 + 3 + 3 + 1 + 1 + 1 + 3);
  constexpr std::int64_t kWallBytes = 8 * (1 + 3 + 4 + 3 + 3);
  const std::int64_t bytes = kBodyBytes * CollectiveFile::rows_on_disk(bodies.total) +
                             kContactBytes * CollectiveFile::rows_on_disk(contacts.total) + kWallBytes * walls.total +
                             static_cast<std::int64_t>(provenance.size()) + kPieceOverhead * size;

  CollectiveFile file(communicator, path, bytes, CollectiveFile::Kind::plain);
  const h5::Group& root = file.root();
  root.write_attribute("format", kFrameFormat);
  root.write_attribute("format_version", kFrameFormatVersion);
  file.write_text(root, "provenance", provenance);
  write_vtkhdf(file, communicator, frame.bodies, bodies);
  write_contacts(file, frame.contacts, contacts);
  write_walls(file, rank == 0 ? frame.walls : FrameWalls{}, walls);
  {
    const h5::Group scalars = root.create_group("frame");
    scalars.write_attribute("number", header.number);
    scalars.write_attribute("step", header.step);
    scalars.write_attribute("time", header.time);
    scalars.write_attribute("kinetic", header.kinetic);
    scalars.write_attribute("potential", header.potential);
    scalars.write_attribute("elastic", header.elastic);
    scalars.write_attribute("dissipated", header.dissipated);
  }
  file.commit();
}

namespace {

template <class T>
void permute(std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (std::size_t i : order) sorted.push_back(values[i]);
  values = std::move(sorted);
}

template <class T>
void expect_rows(const h5::Group& group, const char* name, const std::vector<T>& values, std::size_t expected) {
  if (values.size() != expected) {
    throw InputError("{}/{}: {} rows found, {} expected; the file is damaged", group.path(), name, values.size(), expected);
  }
}

FrameBodies read_bodies(const h5::Group& vtk) {
  FrameBodies b;
  const h5::Group data = vtk.open_group("PointData");
  b.position = vtk.read_vectors("Points");
  b.id = data.read_array<std::int64_t>("id", 1);
  b.shape = data.read_array<std::int32_t>("shape", 1);
  b.material = data.read_array<std::int32_t>("material", 1);
  b.rank = data.read_array<std::int32_t>("rank", 1);
  b.scale = data.read_array<double>("scale", 1);
  b.orientation = data.read_quaternions("quat");
  b.velocity = data.read_vectors("velocity");
  b.angular_velocity = data.read_vectors("angular_velocity");
  const std::size_t n = b.size();
  expect_rows(vtk, "Points", b.position, n);
  expect_rows(data, "shape", b.shape, n);
  expect_rows(data, "material", b.material, n);
  expect_rows(data, "rank", b.rank, n);
  expect_rows(data, "scale", b.scale, n);
  expect_rows(data, "quat", b.orientation, n);
  expect_rows(data, "velocity", b.velocity, n);
  expect_rows(data, "angular_velocity", b.angular_velocity, n);

  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return b.id[i] < b.id[j]; });
  permute(b.id, order);
  permute(b.shape, order);
  permute(b.material, order);
  permute(b.rank, order);
  permute(b.scale, order);
  permute(b.position, order);
  permute(b.orientation, order);
  permute(b.velocity, order);
  permute(b.angular_velocity, order);
  for (std::size_t i = 1; i < n; ++i) {
    if (b.id[i] == b.id[i - 1]) throw InputError("{}: body {} occurs twice; the file is damaged", vtk.path(), b.id[i]);
  }
  return b;
}

FrameContacts read_contacts(const h5::Group& group) {
  FrameContacts c;
  c.body_a = group.read_array<std::int64_t>("body_a", 1);
  c.body_b = group.read_array<std::int64_t>("body_b", 1);
  c.feature = group.read_array<std::int64_t>("feature", 1);
  c.point = group.read_vectors("point");
  c.normal = group.read_vectors("normal");
  c.overlap = group.read_array<double>("depth", 1);
  c.margin = group.read_array<double>("margin", 1);
  c.normal_force = group.read_array<double>("normal_force", 1);
  c.tangential_force = group.read_vectors("tangential_force");
  const std::size_t n = c.size();
  expect_rows(group, "body_b", c.body_b, n);
  expect_rows(group, "feature", c.feature, n);
  expect_rows(group, "point", c.point, n);
  expect_rows(group, "normal", c.normal, n);
  expect_rows(group, "depth", c.overlap, n);
  expect_rows(group, "margin", c.margin, n);
  expect_rows(group, "normal_force", c.normal_force, n);
  expect_rows(group, "tangential_force", c.tangential_force, n);

  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return std::tie(c.body_a[i], c.body_b[i], c.feature[i]) < std::tie(c.body_a[j], c.body_b[j], c.feature[j]);
  });
  permute(c.body_a, order);
  permute(c.body_b, order);
  permute(c.feature, order);
  permute(c.point, order);
  permute(c.normal, order);
  permute(c.overlap, order);
  permute(c.margin, order);
  permute(c.normal_force, order);
  permute(c.tangential_force, order);
  return c;
}

FrameWalls read_walls(const h5::Group& group) {
  FrameWalls w;
  w.id = group.read_array<std::int64_t>("id", 1);
  w.position = group.read_vectors("position");
  w.orientation = group.read_quaternions("orientation");
  w.force = group.read_vectors("force");
  w.torque = group.read_vectors("torque");
  expect_rows(group, "position", w.position, w.id.size());
  expect_rows(group, "orientation", w.orientation, w.id.size());
  expect_rows(group, "force", w.force, w.id.size());
  expect_rows(group, "torque", w.torque, w.id.size());
  return w;
}

}  // namespace

Frame read_frame_file(const std::string& path) {
  const h5::File file(path);
  const h5::Group& root = file.root();
  check_format(root, kFrameFormat, kFrameFormatVersion);
  Frame frame;
  const h5::Group scalars = root.open_group("frame");
  frame.number = scalars.read_integer_attribute("number");
  frame.step = scalars.read_integer_attribute("step");
  frame.time = scalars.read_double_attribute("time");
  frame.kinetic = scalars.read_double_attribute("kinetic");
  frame.potential = scalars.read_double_attribute("potential");
  frame.elastic = scalars.read_double_attribute("elastic");
  frame.dissipated = scalars.read_double_attribute("dissipated");
  frame.bodies = read_bodies(root.open_group("VTKHDF"));
  frame.contacts = read_contacts(root.open_group("contacts"));
  frame.walls = read_walls(root.open_group("walls"));
  frame.provenance = nlohmann::json::parse(root.read_text("provenance"), nullptr, false);
  return frame;
}

std::vector<FrameEntry> list_frames(const std::string& run_folder) {
  const std::filesystem::path folder(run_folder);
  const std::filesystem::path index = folder / "frames.hdf.series";
  if (!std::filesystem::is_directory(folder)) throw InputError("{}: no such run folder", run_folder);
  std::ifstream stream(index);
  if (!stream) {
    throw InputError(
        "{}: no frames.hdf.series in it; either no frame is written yet or this is not a folder that scree-solver "
        "made",
        run_folder);
  }
  const nlohmann::json series = nlohmann::json::parse(stream, nullptr, false);
  std::vector<FrameEntry> frames;
  try {
    for (const nlohmann::json& entry : series.at("files")) {
      frames.push_back({(folder / entry.at("name").get<std::string>()).string(), entry.at("time").get<double>()});
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError("{}: not a list of frames ({}); expected {{\"files\": [{{\"name\": ..., \"time\": ...}}]}}", index.string(),
                     error.what());
  }
  std::stable_sort(frames.begin(), frames.end(), [](const FrameEntry& a, const FrameEntry& b) { return a.time < b.time; });
  return frames;
}

void write_frame_series(const std::string& run_folder, const std::vector<FrameEntry>& frames) {
  nlohmann::ordered_json series;
  series["file-series-version"] = "1.0";
  series["files"] = nlohmann::ordered_json::array();
  for (const FrameEntry& frame : frames) {
    series["files"].push_back({{"name", std::filesystem::path(frame.path).filename().string()}, {"time", frame.time}});
  }
  h5::write_text_file((std::filesystem::path(run_folder) / "frames.hdf.series").string(), json_text(series, 1) + "\n");
}

}  // namespace scree
