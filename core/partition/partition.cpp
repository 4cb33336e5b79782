#include "core/partition/partition.hpp"

#include <zoltan.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "core/base/error.hpp"

namespace scree {

const std::vector<std::string>& cut_method_names() {
  static const std::vector<std::string> names{"rcb", "rib", "hsfc", "body"};
  return names;
}

std::string cut_method_name(CutMethod method) { return cut_method_names()[static_cast<std::size_t>(method)]; }

CutMethod cut_method_of(const std::string& name) {
  const auto& names = cut_method_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw UsageError("cut method '{}' is unknown; use one of {}", name, fmt::join(names, ", "));
  return static_cast<CutMethod>(found - names.begin());
}

namespace {

// Below this many points a part the points are gathered and cut here (see gather_and_cut): a few bodies cost
// less to move than to keep, so nothing is lost when cut directions change between calls.
constexpr std::int64_t kFewPointsPerPart = 8;

// Zoltan's ids are 32-bit in Debian's build; a 64-bit id travels as two entries.
static_assert(2 * sizeof(ZOLTAN_ID_TYPE) == sizeof(std::int64_t), "an id must fit two entries of ZOLTAN_ID_TYPE");

/// What Zoltan's callbacks read.
struct Points {
  std::span<const std::int64_t> ids;
  std::span<const Vec3> points;
  std::span<const double> weights;
};

int object_count(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(static_cast<const Points*>(data)->points.size());
}

void object_list(void* data, int global_entries, int local_entries, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int weight_count,
                 float* weights, int* error) {
  const Points& p = *static_cast<const Points*>(data);
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    std::memcpy(global + static_cast<std::size_t>(global_entries) * i, &p.ids[i], sizeof(std::int64_t));
    local[static_cast<std::size_t>(local_entries) * i] = static_cast<ZOLTAN_ID_TYPE>(i);
    if (weight_count > 0) weights[i] = static_cast<float>(p.weights[i]);
  }
  *error = ZOLTAN_OK;
}

int dimension_count(void* /*data*/, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}

void coordinates(void* data, int /*global_entries*/, int local_entries, int count, ZOLTAN_ID_PTR /*global*/, ZOLTAN_ID_PTR local,
                 int dimension, double* values, int* error) {
  const Points& p = *static_cast<const Points*>(data);
  for (int i = 0; i < count; ++i) {
    const Vec3& x = p.points[local[static_cast<std::ptrdiff_t>(local_entries) * i]];
    for (int k = 0; k < 3; ++k) values[static_cast<std::ptrdiff_t>(dimension) * i + k] = x[k];
  }
  *error = ZOLTAN_OK;
}

/// Zoltan gives a point on a cut to the lower side, we give it to the upper one: the cut moves up by one bit.
double cut_side(double value) {
  if (!(value > -kOuterSide)) return -kOuterSide;
  if (!(value < kOuterSide)) return kOuterSide;
  return std::nextafter(value, kOuterSide);
}

/// All points on every rank, by ascending id.
std::vector<WeightedPoint> gather_points(MPI_Comm communicator, std::span<const std::int64_t> ids, std::span<const Vec3> points,
                                         std::span<const double> weights) {
  std::vector<WeightedPoint> own, all;
  for (std::size_t i = 0; i < points.size(); ++i) own.push_back({points[i], weights[i], ids[i]});
  int size = 1;
  MPI_Comm_size(communicator, &size);
  std::vector<int> counts(static_cast<std::size_t>(size)), offsets(static_cast<std::size_t>(size), 0);
  const int own_count = static_cast<int>(own.size());
  MPI_Allgather(&own_count, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator);
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  all.resize(static_cast<std::size_t>(offsets.back() + counts.back()));
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(sizeof(WeightedPoint)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Allgatherv(own.data(), own_count, type, all.data(), counts.data(), offsets.data(), type, communicator);
  MPI_Type_free(&type);
  std::sort(all.begin(), all.end(), [](const WeightedPoint& a, const WeightedPoint& b) { return a.id < b.id; });
  return all;
}

/// First id of each part: runs of ids with equal work.
std::vector<std::int64_t> cut_ids(std::span<const WeightedPoint> by_id, int parts) {
  double total = 0;
  for (const WeightedPoint& p : by_id) total += p.weight;
  std::vector<std::int64_t> first(static_cast<std::size_t>(parts), std::numeric_limits<std::int64_t>::max());
  first[0] = std::numeric_limits<std::int64_t>::min();
  double sum = 0;
  int part = 0;
  for (const WeightedPoint& p : by_id) {
    // a body goes where the middle of its work lies
    const int here = std::min(parts - 1, static_cast<int>((sum + 0.5 * p.weight) / total * parts));
    while (part < here) first[static_cast<std::size_t>(++part)] = p.id;
    sum += p.weight;
  }
  return first;
}

}  // namespace

struct Partitioner::Impl {
  MPI_Comm communicator;
  int parts;
  CutMethod method;
  bool gathers = false;  // see the constructor
  Zoltan_Struct* zoltan = nullptr;
  Points points;   // of the call in progress
  CutBoxes boxes;  // of the last cut; empty when Zoltan or the ids decide
  std::vector<std::int64_t> first_id;

  void set(const char* name, const std::string& value) {
    if (Zoltan_Set_Param(zoltan, name, value.c_str()) != ZOLTAN_OK) throw SystemError("Zoltan refuses {} = {}", name, value);
  }
  /// Zoltan cannot leave a part empty: its allocation of nothing counts as a failure, and boxes of empty parts
  /// overlap others. So few points, or points that cannot be told apart, are gathered and cut on every rank alike.
  CutBoxes gather_and_cut(std::span<const std::int64_t> ids, std::span<const Vec3> own, std::span<const double> weights) {
    std::vector<WeightedPoint> all = gather_points(communicator, ids, own, weights);
    return cut_few_points(all, parts);
  }
  bool run_zoltan();
  bool read_boxes();
};

Partitioner::Partitioner(MPI_Comm communicator, int parts, CutMethod method) : impl_(std::make_unique<Impl>()) {
  SCREE_ASSERT(parts > 0, "{} parts", parts);
  impl_->communicator = communicator;
  impl_->parts = parts;
  impl_->method = method;
  impl_->boxes = whole_space_first(parts);
  if (method == CutMethod::body) return;
  float version = 0;
  if (Zoltan_Initialize(0, nullptr, &version) != ZOLTAN_OK) throw SystemError("Zoltan cannot be initialised");
  // With several parts on a rank, a rank whose parts stay empty makes Zoltan fail there and hang elsewhere. The
  // solver has one part a rank and the decomposer one rank; any other combination is cut on every rank alike.
  int ranks = 1;
  MPI_Comm_size(communicator, &ranks);
  impl_->gathers = ranks > 1 && parts != ranks;
  impl_->zoltan = Zoltan_Create(impl_->gathers ? MPI_COMM_SELF : communicator);
  if (impl_->zoltan == nullptr) throw SystemError("Zoltan cannot be created");
  impl_->set("DEBUG_LEVEL", "0");
  impl_->set("LB_METHOD", method == CutMethod::rcb ? "RCB" : method == CutMethod::rib ? "RIB" : "HSFC");
  impl_->set("NUM_GID_ENTRIES", "2");
  impl_->set("NUM_LID_ENTRIES", "1");
  impl_->set("OBJ_WEIGHT_DIM", "1");
  impl_->set("NUM_GLOBAL_PARTS", std::to_string(parts));
  impl_->set("RETURN_LISTS", "NONE");  // ownership follows from the cuts
  impl_->set("KEEP_CUTS", "1");
  if (method == CutMethod::rcb) {
    impl_->set("RCB_REUSE", "1");  // these two: without them a tiny motion re-cuts in other directions
    impl_->set("RCB_LOCK_DIRECTIONS", "1");
    impl_->set("RCB_RECTILINEAR_BLOCKS", "1");  // points on a cut go to one side, so that boxes decide ownership
  }
  Zoltan_Set_Num_Obj_Fn(impl_->zoltan, object_count, &impl_->points);
  Zoltan_Set_Obj_List_Fn(impl_->zoltan, object_list, &impl_->points);
  Zoltan_Set_Num_Geom_Fn(impl_->zoltan, dimension_count, &impl_->points);
  Zoltan_Set_Geom_Multi_Fn(impl_->zoltan, coordinates, &impl_->points);
}

Partitioner::~Partitioner() {
  if (impl_->zoltan != nullptr) Zoltan_Destroy(&impl_->zoltan);
}

bool Partitioner::Impl::run_zoltan() {
  int changed = 0, global_entries = 0, local_entries = 0, import_count = 0, export_count = 0;
  ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr, export_local = nullptr;
  int *import_ranks = nullptr, *import_parts = nullptr, *export_ranks = nullptr, *export_parts = nullptr;
  const int status =
      Zoltan_LB_Partition(zoltan, &changed, &global_entries, &local_entries, &import_count, &import_global, &import_local, &import_ranks,
                          &import_parts, &export_count, &export_global, &export_local, &export_ranks, &export_parts);
  return status == ZOLTAN_OK || status == ZOLTAN_WARN;
}

/// Takes over the boxes of a coordinate bisection. False when they are no tiling.
bool Partitioner::Impl::read_boxes() {
  CutBoxes cuts;
  for (int part = 0; part < parts; ++part) {
    Vec3 lower, upper;
    int dimension = 0;
    if (Zoltan_RCB_Box(zoltan, part, &dimension, &lower.x, &lower.y, &lower.z, &upper.x, &upper.y, &upper.z) != ZOLTAN_OK) return false;
    for (int k = 0; k < 3; ++k) {
      lower[k] = cut_side(lower[k]);
      upper[k] = cut_side(upper[k]);
    }
    cuts.lower.push_back(lower);
    cuts.upper.push_back(upper);
  }
  if (!is_tiling(cuts)) return false;
  boxes = ordered_by_cuts(cuts);
  return true;
}

CutBoxes Partitioner::cut(std::span<const std::int64_t> ids, std::span<const Vec3> points, std::span<const double> weights) {
  SCREE_ASSERT(ids.size() == points.size() && ids.size() == weights.size(), "{} ids, {} points, {} weights", ids.size(), points.size(),
               weights.size());
  SCREE_ASSERT(points.size() < static_cast<std::size_t>(std::numeric_limits<int>::max()));
  Impl& m = *impl_;
  m.first_id.clear();
  auto total = static_cast<std::int64_t>(points.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, m.communicator);
  if (total == 0 || m.parts == 1) return m.boxes = whole_space_first(m.parts);
  if (m.method == CutMethod::body) {
    m.first_id = cut_ids(gather_points(m.communicator, ids, points, weights), m.parts);
    return m.boxes = {};
  }
  if (total < kFewPointsPerPart * m.parts) return m.boxes = m.gather_and_cut(ids, points, weights);

  std::vector<std::int64_t> all_ids;
  std::vector<Vec3> all_points;
  std::vector<double> all_weights;
  m.points = {ids, points, weights};
  if (m.gathers) {
    for (const WeightedPoint& p : gather_points(m.communicator, ids, points, weights)) {
      all_ids.push_back(p.id);
      all_points.push_back(p.x);
      all_weights.push_back(p.weight);
    }
    m.points = {all_ids, all_points, all_weights};
  }
  m.boxes = {};
  int usable = m.run_zoltan() && (m.method != CutMethod::rcb || m.read_boxes()) ? 1 : 0;
  m.points = {};
  MPI_Allreduce(MPI_IN_PLACE, &usable, 1, MPI_INT, MPI_MIN, m.communicator);
  // so many points at one place that a part stays empty, which Zoltan does not survive
  if (usable == 0) m.boxes = m.gather_and_cut(ids, points, weights);
  return m.boxes;
}

int Partitioner::part_of(std::int64_t id, const Vec3& point) const {
  const Impl& m = *impl_;
  if (!m.first_id.empty()) {
    return static_cast<int>(std::upper_bound(m.first_id.begin(), m.first_id.end(), id) - m.first_id.begin()) - 1;
  }
  if (!m.boxes.lower.empty()) return m.boxes.rank_of(point);
  double coordinate[3] = {point.x, point.y, point.z};
  int process = 0, part = 0;
  if (Zoltan_LB_Point_PP_Assign(m.zoltan, coordinate, &process, &part) != ZOLTAN_OK) {
    throw SystemError("Zoltan cannot tell the part of the point ({:g}, {:g}, {:g})", point.x, point.y, point.z);
  }
  return part;
}

}  // namespace scree
