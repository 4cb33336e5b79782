// Frames: collective writing (collective_file.hpp), serial reading. The pieces of VTKHDF are exactly the runs of rows of the
// ranks, so that a parallel ParaView reads them without any exchange.
#include "core/storage/frame_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/utf8.hpp"
#include "core/storage/collective_file.hpp"
#include "core/storage/shape_file.hpp"

namespace scree {

namespace {

constexpr std::int64_t kPieceOverhead = 4096;  // [B] piece tables and alignment, per rank

/// All columns have as many rows as the first.
template <class Table>
void check_sizes(const Table& rows) {
  Table::visit([&](const auto& c) {
    if (!has_column(rows, c)) return;
    SCREE_ASSERT((rows.*c.column).size() == rows.size(), "{}: {} rows of {}", c.path, (rows.*c.column).size(), rows.size());
  });
}

template <class Table>
std::int64_t bytes_per_row() {
  std::size_t bytes = 0;
  Table::visit([&](const auto& c) { bytes += sizeof(typename std::decay_t<decltype(c)>::Value); });
  return static_cast<std::int64_t>(bytes);
}

/// Writes the columns of one group. Collective.
template <class Table>
void write_columns(CollectiveFile& file, const h5::Group& group, std::string_view name, const Table& table, const Rows& rows) {
  Table::visit([&](const auto& c) {
    if (!has_column(table, c)) return;
    if (c.group() == name) file.write(group, std::string(c.dataset()), table.*c.column, rows, c.unit);
  });
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
  write_columns(file, vtk, "VTKHDF", bodies, rows);
  file.write(vtk, "Connectivity", connectivity, rows, "");
  file.write(vtk, "Offsets", offsets, {rows.local + 1, rows.start + pieces.start, rows.total + pieces.total}, "");
  file.write(vtk, "Types", types, rows, "");

  write_columns(file, vtk.create_group("PointData"), "VTKHDF/PointData", bodies, rows);
}

}  // namespace

std::int64_t frame_rows_bytes(std::int64_t bodies, std::int64_t contacts) {
  constexpr std::int64_t kCellBytes = 8 + 8 + 1;  // connectivity, offset, type
  return (bytes_per_row<FrameBodies>() + kCellBytes) * bodies + bytes_per_row<FrameContacts>() * contacts;
}

void write_frame_file(MPI_Comm communicator, const std::string& path, const Frame& frame) {
  check_sizes(frame.bodies);
  check_sizes(frame.contacts);
  check_sizes(frame.walls);
  check_sizes(frame.loads);
  check_sizes(frame.wear);
  check_sizes(frame.cell);
  check_sizes(frame.impacts);
  check_sizes(frame.losses);
  check_sizes(frame.bonds);
  int rank = 0, size = 1;
  MPI_Comm_rank(communicator, &rank);
  MPI_Comm_size(communicator, &size);

  // what only rank 0 knows
  struct {
    FrameScalars scalars;
    std::int64_t wall_count, load_count, wear_count, cell_count, impact_count, loss_count;
  } header{frame,
           static_cast<std::int64_t>(frame.walls.size()),
           static_cast<std::int64_t>(frame.loads.size()),
           static_cast<std::int64_t>(frame.wear.size()),
           static_cast<std::int64_t>(frame.cell.size()),
           static_cast<std::int64_t>(frame.impacts.size()),
           static_cast<std::int64_t>(frame.losses.size())};
  static_assert(std::is_trivially_copyable_v<decltype(header)>);
  MPI_Bcast(&header, static_cast<int>(sizeof header), MPI_BYTE, 0, communicator);
  const std::string provenance = broadcast_text(communicator, rank == 0 ? json_text(frame.provenance) : std::string());
  const Rows bodies = distribute(communicator, static_cast<std::int64_t>(frame.bodies.size()));
  const Rows contacts = distribute(communicator, static_cast<std::int64_t>(frame.contacts.size()));
  const auto of_root = [&](std::int64_t rows) { return Rows{rank == 0 ? rows : 0, rank == 0 ? 0 : rows, rows}; };
  const Rows walls = of_root(header.wall_count), loads = of_root(header.load_count), wear = of_root(header.wear_count),
             cell = of_root(header.cell_count);
  const Rows impacts = of_root(header.impact_count), losses = of_root(header.loss_count);

  const Rows bonds = frame.has_bonds ? distribute(communicator, static_cast<std::int64_t>(frame.bonds.size())) : Rows{};

  // room on the disk, uncompressed
  const std::int64_t bytes = frame_rows_bytes(CollectiveFile::rows_on_disk(bodies.total), CollectiveFile::rows_on_disk(contacts.total)) +
                             bytes_per_row<FrameWalls>() * walls.total + bytes_per_row<FrameBonds>() * bonds.total +
                             bytes_per_row<FrameLoads>() * CollectiveFile::rows_on_disk(loads.total) +
                             bytes_per_row<FrameImpacts>() * CollectiveFile::rows_on_disk(impacts.total) +
                             bytes_per_row<FrameLosses>() * CollectiveFile::rows_on_disk(losses.total) +
                             bytes_per_row<FrameWear>() * CollectiveFile::rows_on_disk(wear.total) +
                             bytes_per_row<FrameCell>() * cell.total + static_cast<std::int64_t>(provenance.size()) + kPieceOverhead * size;

  CollectiveFile file(communicator, path, bytes, CollectiveFile::Kind::plain);
  const h5::Group& root = file.root();
  root.write_attribute("format", kFrameFormat);
  root.write_attribute("format_version", kFrameFormatVersion);
  file.write_text(root, "provenance", provenance);
  write_vtkhdf(file, communicator, frame.bodies, bodies);
  write_columns(file, root.create_group("contacts"), "contacts", frame.contacts, contacts);
  write_columns(file, root.create_group("walls"), "walls", rank == 0 ? frame.walls : FrameWalls{}, walls);
  if (loads.total > 0) write_columns(file, root.create_group("loads"), "loads", rank == 0 ? frame.loads : FrameLoads{}, loads);
  if (wear.total > 0) write_columns(file, root.create_group("wear"), "wear", rank == 0 ? frame.wear : FrameWear{}, wear);
  if (cell.total > 0) write_columns(file, root.create_group("cell"), "cell", rank == 0 ? frame.cell : FrameCell{}, cell);
  if (losses.total > 0) {
    write_columns(file, root.create_group("losses"), "losses", rank == 0 ? frame.losses : FrameLosses{}, losses);
    write_columns(file, root.create_group("impacts"), "impacts", rank == 0 ? frame.impacts : FrameImpacts{}, impacts);
  }
  if (frame.has_bonds) write_columns(file, root.create_group("bonds"), "bonds", frame.bonds, bonds);
  {
    const h5::Group scalars = root.create_group("frame");
    FrameScalars::visit(header.scalars, [&](const char* name, const auto& value) { scalars.write_attribute(name, value); });
  }
  file.commit();
}

namespace {

/// Rows in the order that `before(i, j)` gives.
template <class Table, class Before>
void sort_rows(Table& rows, Before&& before) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), before);
  take_rows(rows, order);
}

template <class T>
std::vector<T> read_column(const h5::Group& group, const std::string& name) {
  if constexpr (std::is_same_v<T, Vec3>)
    return group.read_vectors(name);
  else if constexpr (std::is_same_v<T, Quat>)
    return group.read_quaternions(name);
  else
    return group.read_array<T>(name, 1);
}

template <class Table>
Table read_columns(const h5::Group& root) {
  Table rows;
  Table::visit([&](const auto& c) {
    auto& values = rows.*c.column;
    const h5::Group group = root.open_group(std::string(c.group()));
    if ((c.uses & (kOfHeat | kAddedLater)) != 0 && !group.has(std::string(c.dataset()))) {
      values.resize(rows.size());
      return;
    }
    values = read_column<typename std::decay_t<decltype(c)>::Value>(group, std::string(c.dataset()));
    if (values.size() != rows.size()) {
      throw InputError("{}/{}: {} rows found, {} expected; the file is damaged", group.path(), c.dataset(), values.size(), rows.size());
    }
  });
  return rows;
}

FrameBodies read_bodies(const h5::Group& root) {
  FrameBodies b = read_columns<FrameBodies>(root);
  b.has_temperature = root.open_group("VTKHDF/PointData").has("temperature");
  sort_rows(b, [&](std::size_t i, std::size_t j) { return b.id[i] < b.id[j]; });
  for (std::size_t i = 1; i < b.size(); ++i) {
    if (b.id[i] == b.id[i - 1]) throw InputError("{}/VTKHDF: body {} occurs twice; the file is damaged", root.path(), b.id[i]);
  }
  return b;
}

FrameContacts read_contacts(const h5::Group& root) {
  FrameContacts c = read_columns<FrameContacts>(root);
  sort_rows(c, [&](std::size_t i, std::size_t j) {
    return std::tie(c.body_a[i], c.body_b[i], c.feature[i]) < std::tie(c.body_a[j], c.body_b[j], c.feature[j]);
  });
  return c;
}

FrameBonds read_frame_bonds(const h5::Group& root) {
  FrameBonds b = read_columns<FrameBonds>(root);
  sort_rows(b, [&](std::size_t i, std::size_t j) { return b.bond[i] < b.bond[j]; });
  return b;
}

}  // namespace

Frame read_frame_file(const std::string& path, FrameParts parts) {
  const h5::File file(path);
  const h5::Group& root = file.root();
  check_format(root, kFrameFormat, kFrameFormatVersion);
  Frame frame;
  const h5::Group scalars = root.open_group("frame");
  FrameScalars::visit(frame, [&](const char* name, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>)
      value = scalars.read_double_attribute(name);
    else
      value = scalars.read_integer_attribute(name);
  });
  frame.bodies = read_bodies(root);
  frame.walls = read_columns<FrameWalls>(root);
  if (root.has("cell")) frame.cell = read_columns<FrameCell>(root);
  if (parts == FrameParts::bodies) return frame;
  frame.contacts = read_contacts(root);
  if (root.has("loads")) frame.loads = read_columns<FrameLoads>(root);
  if (root.has("wear")) frame.wear = read_columns<FrameWear>(root);
  if (root.has("losses")) frame.losses = read_columns<FrameLosses>(root);
  if (root.has("impacts")) frame.impacts = read_columns<FrameImpacts>(root);
  frame.has_bonds = root.has("bonds");
  if (frame.has_bonds) frame.bonds = read_frame_bonds(root);
  frame.provenance = nlohmann::json::parse(root.read_text("provenance"), nullptr, false);
  return frame;
}

std::vector<FrameEntry> list_frames(const std::string& run_folder) {
  const std::filesystem::path folder(run_folder);
  const std::filesystem::path index = folder / "frames.hdf.series";
  std::error_code failed;
  if (!std::filesystem::is_directory(folder, failed)) throw InputError("{}: no such run folder", run_folder);
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
